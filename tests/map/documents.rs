//! Statements of the documents about the code: paths, links, the map, the drawing of arrows, the invariants.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub fn text(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

/// Paths of the documents.
pub fn documents() -> Vec<PathBuf> {
    let docs = fs::read_dir(root().join("docs")).unwrap();
    let docs = docs.map(|entry| Path::new("docs").join(entry.unwrap().file_name()));
    let docs = docs.filter(|path| path.extension().is_some_and(|kind| kind == "md"));
    ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].iter().map(PathBuf::from).chain(docs).collect()
}

/// A section of a text, up to the next one.
pub fn section(text: &str, heading: &str) -> String {
    let heading = format!("## {heading}\n");
    let behind = text.split_once(&heading).unwrap_or_else(|| panic!("there is no {heading}")).1;
    behind.split("\n## ").next().unwrap().to_owned()
}

/// Blocks of plain text in a section.
fn blocks(section: &str) -> Vec<&str> {
    section.split("```text\n").skip(1).map(|block| block.split("```").next().unwrap()).collect()
}

/// A line of the map: its folder, and the names before the gap.
#[derive(Debug)]
pub struct Line {
    pub folder: PathBuf,
    pub names: Vec<String>,
}

/// Lines of the map: names begin at the margin (crates), two spaces in (rooms) or four (parts of the room before); deeper
/// indentation continues the line before.
pub fn map(architecture: &str) -> Vec<Line> {
    let section = section(architecture, "Map of the code");
    let mut found = vec![];
    let (mut of_crate, mut room) = (PathBuf::new(), PathBuf::new());
    for line in blocks(&section)[0].lines() {
        let indent = line.len() - line.trim_start().len();
        let names = line.trim_start().split("  ").next().unwrap();
        let names: Vec<String> =
            names.split(", ").map(|name| name.trim_end_matches('/').to_owned()).collect();
        let folder = match indent {
            0 => PathBuf::new(),
            2 => of_crate.clone(),
            4 => room.clone(),
            _ => continue,
        };
        match indent {
            0 => of_crate = PathBuf::from(&names[0]),
            2 => room = of_crate.join(&names[0]),
            _ => {}
        }
        found.push(Line { folder, names });
    }
    found
}

/// Arrows of the drawing, each with the name at the start of its line: `{a, b} → c → d`; chains are separated by two spaces.
pub fn drawn(architecture: &str) -> Vec<(String, String, String)> {
    let section = section(architecture, "Arrows");
    let mut of = String::new();
    let mut found = vec![];
    for line in blocks(&section)[0].lines() {
        let chains = match line.split_once(':') {
            Some((name, chains)) => {
                of = name.to_owned();
                chains
            }
            None => line,
        };
        for chain in chains.split("  ").filter(|chain| chain.contains('→')) {
            let groups = chain.split('→').map(|group| group.trim().trim_matches(['{', '}']).split(", "));
            let groups: Vec<Vec<&str>> = groups.map(Iterator::collect).collect();
            for pair in groups.windows(2) {
                for from in &pair[0] {
                    let to = pair[1].iter();
                    found.extend(to.map(|to| (of.clone(), (*from).to_owned(), (*to).to_owned())));
                }
            }
        }
    }
    found
}

/// Rows of a table, cell by cell, without its heading.
pub fn rows(section: &str) -> Vec<Vec<String>> {
    let rows = section.lines().filter(|line| line.starts_with('|')).skip(2);
    rows.map(|row| row.trim_matches('|').split(" | ").map(|cell| cell.trim().to_owned()).collect()).collect()
}

/// Text between backticks, except in code blocks.
pub fn quoted(text: &str) -> Vec<&str> {
    let prose = text.split("```").step_by(2);
    prose.flat_map(|prose| prose.split('`').skip(1).step_by(2)).collect()
}

/// Targets of a text's links, except those to the web: a path, and a heading in it.
pub fn links(text: &str) -> Vec<(&str, Option<&str>)> {
    let targets = text.split("](").skip(1).filter_map(|behind| behind.split(')').next());
    let targets = targets.filter(|target| !target.contains("://"));
    targets.map(|target| target.split_once('#').map_or((target, None), |(at, to)| (at, Some(to)))).collect()
}

/// Anchors of a text's headings.
pub fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| -> String {
        let kept = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = kept.chars().filter(|&c| c.is_alphanumeric() || " -_".contains(c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(anchor).collect()
}

/// Every ignored test: its file, relative to the repository, and its name.
pub fn ignored_tests() -> Vec<(PathBuf, String)> {
    let mut folders = ["src", "kernels", "tests"].map(|folder| root().join(folder)).to_vec();
    let mut found = vec![];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|kind| kind == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                let short = path.strip_prefix(root()).unwrap();
                let mut lines = text.lines().map(str::trim_start);
                while lines.any(|line| line.starts_with("#[ignore")) {
                    let name = lines.find_map(|line| line.strip_prefix("fn ")?.split('(').next());
                    found.extend(name.map(|name| (short.to_owned(), name.to_owned())));
                }
            }
        }
    }
    found
}
