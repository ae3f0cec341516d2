//! The page of a reproduction in Markdown, as a repository's site shows it.

#![expect(clippy::let_underscore_must_use, reason = "a string takes whatever is written")]

use super::section::JudgedClaim;
use super::tally::Tally;
use super::{Chapter, Section, markdown};
use crate::claims::Verdict;
use std::fmt::Write;

/// What stands near the beginning of every such page and of no other.
pub(crate) const MARK: &str = "Written by `stripmine reproduce`; do not edit.";

/// Letters of an item's table of conclusions that the page shows below a picture; a longer one is linked.
const TABLE: usize = 560;
/// Lines of a program's text that it shows.
const LINES: usize = 8;
/// Letters of a picture's caption that it shows, in whole sentences; the rest stands on the page with charts.
const CAPTION: usize = 110;

/// The page. Pictures and data lie in a folder for each item, which bears its name. `left_out` names items that the folder has,
/// but of another version of the program.
pub(crate) fn render(sections: &[Section], left_out: &[String], tally: &Tally) -> String {
    let mut page = format!(
        "# What came out\n\n{MARK} With charts to hover over and films: [index.html](index.html), one file, to be opened from a copy.\n\n",
    );
    page.push_str(&claims(tally));
    for chapter in Chapter::ALL {
        let of_chapter: Vec<&Section> =
            sections.iter().filter(|section| section.chapter == chapter).collect();
        if of_chapter.is_empty() {
            continue;
        }
        let _ = write!(page, "\n**{}**\n\n| item | claims |\n|---|---|\n", chapter.title());
        for section in of_chapter {
            let title = &section.title;
            let _ = writeln!(page, "| [{title}](#{}) | {} |", anchor(title), section.outcome());
        }
    }
    for made in super::origins(sections) {
        let _ = write!(page, "\n{made}\n");
    }
    for chapter in Chapter::ALL {
        for section in sections.iter().filter(|section| section.chapter == chapter) {
            page.push_str(&item(section));
        }
    }
    if !left_out.is_empty() {
        let _ = write!(
            page,
            "\nLeft out, for another version of the program made them: {}.\n",
            left_out.join(", ")
        );
    }
    page.push_str(
        "\n---\n\nWhat depends on the host lies under `host/`; everything else but this page, `index.html` and the files \
         `provenance.json` is the same everywhere, byte by byte.\n",
    );
    page
}

/// Table of claims by source and verdict, and the claims that failed.
fn claims(tally: &Tally) -> String {
    if tally.is_empty() {
        return String::new();
    }
    let mut text = "**Claims by source and verdict**\n\n| source |".to_owned();
    for verdict in Verdict::ALL {
        let _ = write!(text, " {} |", verdict.words());
    }
    let _ = writeln!(text, "\n|---|{}", "--:|".repeat(Verdict::ALL.len()));
    for (source, counts) in tally.rows() {
        let counts = counts.map(|count| count.to_string()).join(" | ");
        let _ = writeln!(text, "| {source} | {counts} |");
    }
    let _ =
        write!(text, "\n**Not reproduced**\n\n| claim | source | expected | value |\n|---|---|---|---|\n");
    for ((_, title), claim) in tally.failed() {
        let JudgedClaim { text: words, place, expected, value, .. } = claim;
        let words = words.replace('|', "\\|");
        let _ =
            writeln!(text, "| [{words}](#{}) | {} | {expected} | {value} |", anchor(title), place.join(", "));
    }
    text
}

/// The answer, the picture and the table of conclusions, then what was asked. All further words, pictures and tables stand on the page
/// with charts.
fn item(section: &Section) -> String {
    let Section { name, title, question, expected, .. } = section;
    let again = section.again();
    let folder = section.folder();
    let mut text = format!("\n## {title}\n\n**{}**: {}\n\n", section.outcome(), section.answer);
    if let Some(figure) = section.figures.first() {
        let caption = beginning(&figure.caption, CAPTION);
        let _ = write!(text, "![{}]({folder}/{}.svg)\n\n{caption}\n\n", figure.title, figure.name);
    }
    if let Some(table) = section.tables.first() {
        let table = markdown::render(table, &folder);
        if section.figures.is_empty() || table.len() <= TABLE {
            let _ = writeln!(text, "{table}");
        }
    }
    if let Some((what, lines)) = &section.excerpt {
        let lines: Vec<&str> = lines.lines().take(LINES).collect();
        let _ = write!(text, "{what}\n\n```text\n{}\n```\n\n", lines.join("\n"));
    }
    let seeds: Vec<_> = section.seeds.iter().map(u64::to_string).collect();
    let seeds = if seeds.is_empty() { String::new() } else { format!(", seeds {}", seeds.join(", ")) };
    let _ = writeln!(
        text,
        "{question} *Expected:* {expected}\n\n`{again}`{seeds}; [all of it](index.html#{name}), [data]({folder}/)."
    );
    text
}

/// The first sentences of a text, one at least, and as many as have no more letters than `most`.
fn beginning(text: &str, most: usize) -> &str {
    let ends = text.match_indices(". ").map(|(at, _)| at + 1).chain([text.len()]);
    let (mut kept, mut ends) = (text.len(), ends.peekable());
    if let Some(first) = ends.next() {
        kept = first;
    }
    while let Some(end) = ends.next_if(|end| text[..*end].chars().count() <= most) {
        kept = end;
    }
    &text[..kept]
}

/// What a heading is called in links, by the rule of the common hosts: lower case, words joined by dashes.
fn anchor(title: &str) -> String {
    title
        .chars()
        .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
        .map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() })
        .collect()
}
