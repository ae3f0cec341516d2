//! Report page in Markdown, as shown on the site of a repository.

#![expect(clippy::let_underscore_must_use, reason = "a string takes whatever is written")]

use super::section::JudgedClaim;
use super::tally::Tally;
use super::{Chapter, Section, markdown};
use crate::claims::ClaimVerdict;
use std::fmt::Write;

/// Text near the beginning of every such page, by which our pages are recognised.
pub(crate) const MARK: &str = "Written by `stripmine reproduce`; do not edit.";

/// Maximum letters of an item's first table below a picture; a longer table is omitted.
const TABLE: usize = 560;
/// Maximum lines of an excerpt.
const LINES: usize = 8;
/// Maximum letters of a caption, in whole sentences; the rest is on the HTML page.
const CAPTION: usize = 110;

/// Renders the page. Pictures and data are in one folder per item. `left_out` names items made by another version of the program.
pub(crate) fn render(sections: &[Section], left_out: &[String], tally: &Tally) -> String {
    let mut page = format!(
        "# Results\n\nStripmine compared with the four papers that it implements, with theory, and with other programs. {MARK} Download \
         [index.html](index.html), a single file, for interactive charts and films.\n\n",
    );
    page.push_str(&front(sections));
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
            let _ = writeln!(page, "| [{title}](#{}) | {} |", anchor(title), section.claim_summary());
        }
    }
    for made in super::origin_sentences(sections) {
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
            "\nOmitted, because another version of the program made them: {}.\n",
            left_out.join(", ")
        );
    }
    page.push_str(
        "\n---\n\nResults under `host/` depend on the host. All other files except this page, `index.html` and \
        `provenance.json` are byte-identical on every host.\n",
    );
    page
}

/// Results of the first screen: answer and first picture of each.
fn front(sections: &[Section]) -> String {
    let mut shown: Vec<&Section> = sections.iter().filter(|section| section.front.is_some()).collect();
    shown.sort_by_key(|section| section.front);
    let mut text = String::new();
    for section in shown {
        let Section { title, answer, .. } = section;
        let _ = write!(text, "**[{title}](#{})**: {answer}\n\n", anchor(title));
        if let Some(figure) = section.figures.first() {
            let _ = write!(text, "![{}]({}/{}.svg)\n\n", figure.title, section.folder(), figure.name);
        }
    }
    text
}

/// Table of claims by source and verdict, and the claims that failed.
fn claims(tally: &Tally) -> String {
    if tally.is_empty() {
        return String::new();
    }
    let mut text = "**Claims by source and verdict**\n\n| source |".to_owned();
    for verdict in ClaimVerdict::ALL {
        let _ = write!(text, " {} |", verdict.words());
    }
    let _ = writeln!(text, "\n|---|{}", "--:|".repeat(ClaimVerdict::ALL.len()));
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

/// Renders an item: the answer, the first picture and table, then the question. All else is on the HTML page.
fn item(section: &Section) -> String {
    let Section { name, title, question, expected, .. } = section;
    let again = section.reproduce_command();
    let folder = section.folder();
    let mut text = format!("\n## {title}\n\n**{}**: {}\n\n", section.claim_summary(), section.answer);
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
        "{question} *Expected:* {expected}\n\n`{again}`{seeds}; [details](index.html#{name}), [data]({folder}/)."
    );
    text
}

/// First sentences of a text: at least one, and as many as fit into `most` letters.
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

/// Anchor of a heading by the rule of common repository hosts: lower case, words joined by dashes.
fn anchor(title: &str) -> String {
    title
        .chars()
        .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
        .map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() })
        .collect()
}
