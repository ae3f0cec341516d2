//! The page of a reproduction in Markdown, as a repository's site shows it.

use super::{Part, Section, Verdict, markdown};
use std::fmt::Write;

/// What stands near the beginning of every such page and of no other.
pub const MARK: &str = "Written by `stripmine reproduce`; do not edit.";

/// Tables and pictures of an item that the page shows; further ones are linked.
const TABLES: usize = 1;
const FIGURES: usize = 1;
/// Lines of a program's text that it shows.
const LINES: usize = 8;
/// Letters of an item's details that it shows; more stand on the page with charts.
const DETAILS: usize = 200;
/// Letters of a picture's caption that it shows, in whole sentences; the rest stands on the page with charts.
const CAPTION: usize = 110;

/// The page. Pictures and data lie in a folder for each item, which bears its name. `left_out` names items that the folder has,
/// but of another version of the program.
pub fn render(sections: &[Section], left_out: &[String]) -> String {
    let mut page = format!(
        "# What came out\n\n{MARK} The same with charts to hover over and films to play: [index.html](index.html), one file, to \
         be opened from a copy on the disk.\n\n",
    );
    for verdict in Verdict::ALL {
        let _ = writeln!(page, "- **{}**: {}.", verdict.word(), verdict.meaning());
    }
    for part in Part::ALL {
        let of_part: Vec<&Section> = sections.iter().filter(|section| section.part == part).collect();
        if of_part.is_empty() {
            continue;
        }
        let _ = write!(page, "\n**{}**\n\n| item | answer | verdict |\n|---|---|---|\n", part.title());
        for section in of_part {
            let Section { title, answer, verdict, .. } = section;
            let answer = answer.replace('|', "\\|");
            let _ = writeln!(page, "| [{title}](#{}) | {answer} | {} |", anchor(title), verdict.word());
        }
    }
    for part in Part::ALL {
        for section in sections.iter().filter(|section| section.part == part) {
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

fn item(section: &Section) -> String {
    let Section { title, question, expected, verdict, again, .. } = section;
    let folder = section.folder();
    let mut text = format!("\n## {title}\n\n*Question:* {question}\n\n*Expected:* {expected}\n\n");
    let _ = write!(text, "*Answer:* **{}**. ", verdict.word());
    let _ = write!(text, "{}\n\n", section.answer);
    let mut letters = 0;
    let shown = section.details.iter().take_while(|detail| {
        letters += detail.len();
        letters <= DETAILS
    });
    let shown: Vec<&str> = shown.map(String::as_str).collect();
    shown.iter().for_each(|detail| {
        let _ = write!(text, "{detail}\n\n");
    });
    if shown.len() < section.details.len() {
        let _ = write!(text, "More in words: [index.html](index.html#{}).\n\n", section.name);
    }
    for figure in section.figures.iter().take(FIGURES) {
        let caption = beginning(&figure.caption, CAPTION);
        let _ = write!(text, "![{}]({folder}/{}.svg)\n\n{caption}\n\n", figure.title, figure.name);
    }
    for table in section.tables.iter().take(TABLES) {
        let _ = writeln!(text, "{}", markdown::render(table, &folder));
    }
    let further = [
        ("picture", section.figures.len().saturating_sub(FIGURES)),
        ("table", section.tables.len().saturating_sub(TABLES)),
    ];
    let further: Vec<String> = further
        .into_iter()
        .filter(|(_, count)| *count > 0)
        .map(|(what, count)| format!("{count} {what}{}", if count == 1 { "" } else { "s" }))
        .collect();
    let further =
        if further.is_empty() { String::new() } else { format!(", with {} more", further.join(" and ")) };
    if let Some((what, lines)) = &section.excerpt {
        let lines: Vec<&str> = lines.lines().take(LINES).collect();
        let _ = write!(text, "{what}\n\n```text\n{}\n```\n\n", lines.join("\n"));
    }
    let seeds: Vec<_> = section.seeds.iter().map(u64::to_string).collect();
    let seeds = if seeds.is_empty() { String::new() } else { format!(" Seeds {}.", seeds.join(", ")) };
    let _ = write!(text, "*Again:* `{again}`. *Data:* [folder]({folder}/){further}.{seeds}");
    if let Some(provenance) = &section.provenance {
        let _ = write!(text, " {}", provenance.in_short(&format!("{folder}/provenance.json")));
    }
    text.push('\n');
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
