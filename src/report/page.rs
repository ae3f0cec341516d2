//! The page of a reproduction in Markdown, as a repository's site shows it.

use super::{Section, markdown};
use std::fmt::Write;

/// What stands near the beginning of every such page and of no other.
pub const MARK: &str = "Written by `stripmine reproduce`; do not edit.";

/// Tables of an item that the page shows; further ones are linked.
const SHOWN: usize = 2;

/// The page. Pictures and data lie in a folder for each item, which bears its name.
pub fn render(sections: &[Section]) -> String {
    let mut page = format!(
        "# What came out\n\n{MARK} The same with charts to hover over and a film \
         to play: [index.html](index.html), one file, to be opened from a copy on the disk.\n\n| | verdict |\n|---|---|\n",
    );
    for section in sections {
        let _ = writeln!(
            page,
            "| [{}](#{}) | {} |",
            section.title,
            anchor(&section.title),
            section.verdict.word()
        );
    }
    for section in sections {
        page.push_str(&item(section));
    }
    page.push_str(
        "\n---\n\nWhat depends on the host lies under `host/`; everything else but this page, `index.html` and the files \
         `provenance.json` is the same everywhere, byte by byte.\n",
    );
    page
}

fn item(section: &Section) -> String {
    let Section { title, says, came_out, verdict, again, .. } = section;
    let folder = section.folder();
    let mut text = format!(
        "\n## {title}\n\n*The source says:* {says}\n\n*What came out:* **{}**. {came_out}\n",
        verdict.word()
    );
    for figure in &section.figures {
        let _ = write!(text, "\n![{}]({folder}/{}.svg)\n\n{}\n", figure.title, figure.name, figure.caption);
    }
    for table in section.tables.iter().take(SHOWN) {
        let _ = write!(text, "\n{}", markdown::render(table, &folder));
    }
    let further: Vec<String> = section
        .tables
        .iter()
        .skip(SHOWN)
        .map(|table| format!("[{}]({folder}/{}.csv)", table.title, table.name))
        .collect();
    if !further.is_empty() {
        let _ = writeln!(text, "\nFurther tables: {}.", further.join("; "));
    }
    if let Some((what, lines)) = &section.excerpt {
        let _ = write!(text, "\n{what}\n\n```text\n{lines}\n```\n");
    }
    let seeds: Vec<_> = section.seeds.iter().map(u64::to_string).collect();
    let seeds = if seeds.is_empty() { String::new() } else { format!(" *Seeds:* {}.", seeds.join(", ")) };
    let _ = write!(text, "\n*To get it again:* `{again}`. *Data:* [{folder}/]({folder}/).{seeds}\n");
    if let Some(provenance) = &section.provenance {
        let _ = write!(text, "\n{}\n", provenance.sentence());
    }
    text
}

/// What a heading is called in links, by the rule of the common hosts: lower case, words joined by dashes.
fn anchor(title: &str) -> String {
    title
        .chars()
        .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
        .map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() })
        .collect()
}
