//! Numbers in documents are cells of the committed report: `<!-- n: ITEM: EXPRESSION -->NUMBER<!-- / -->`.

use std::fs;
use std::path::{Path, PathBuf};
use stripmine::frame::Expressions;
use stripmine::results::Folder;

const BEGIN: &str = "<!-- n: ";
const END: &str = "<!-- / -->";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// README, CHANGELOG and all documents.
fn documents() -> Vec<PathBuf> {
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let mut all: Vec<PathBuf> = docs.filter(|path| path.extension().is_some_and(|it| it == "md")).collect();
    all.extend(["README.md", "CHANGELOG.md"].map(|name| root().join(name)));
    all.sort();
    all
}

/// Faults of a text, each with its line: numbers that are not those of their cells, and cells that are gone.
fn faults(text: &str, folder: &Folder) -> (usize, Vec<String>) {
    let (expressions, mut held, mut faults) = (Expressions::new(), 0, vec![]);
    for (at, _) in text.match_indices(BEGIN) {
        let line = text[..at].matches('\n').count() + 1;
        let mut check = || {
            let rest = &text[at + BEGIN.len()..];
            let (head, rest) = rest.split_once(" -->").ok_or("the comment has no end")?;
            let (shown, _) = rest.split_once(END).ok_or(format!("no `{END}` follows"))?;
            let (item, expression) = head.split_once(": ").ok_or("no `ITEM: EXPRESSION`")?;
            let scope = folder.scope(item).map_err(|cause| cause.to_string())?;
            let scope = scope.ok_or(format!("the report has no item `{item}`"))?;
            let value = expressions.text(&format!("{{{{ {expression} }}}}"), &scope).map_err(|(_, it)| it)?;
            held += 1;
            if value == shown { Ok(()) } else { Err(format!("{shown} is {value}, by {item}: {expression}")) }
        };
        if let Err(cause) = check() {
            faults.push(format!("line {line}: {cause}"));
        }
    }
    (held, faults)
}

#[test]
fn numbers_in_documents_are_those_of_the_report() {
    let folder = Folder::of_another(&root().join("reports"));
    let mut wrong = vec![];
    for path in documents() {
        let (_, faults) = faults(&fs::read_to_string(&path).unwrap(), &folder);
        wrong.extend(
            faults.iter().map(|it| format!("{}, {it}", path.strip_prefix(root()).unwrap().display())),
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Faults name the line, and what exists.
#[test]
fn a_number_whose_cell_is_gone_is_a_fault() {
    let folder = Folder::of_another(&root().join("reports"));
    let said = |text: &str| faults(text, &folder).1.join("; ");
    let with = |head: &str, number: &str| format!("a\nb <!-- n: {head} -->{number}<!-- / -->.");
    assert_eq!(said(&with("mask: reach[0].mask", "5×5")), "");
    for (text, named) in [
        (with("mask: reach[0].mask", "7×7"), "line 2: 7×7 is 5×5, by mask: reach[0].mask"),
        (with("mask: reach[0].masks", "1"), "it has mask, "),
        (with("mask: gone[0].mask", "1"), "reach"),
        (with("mosk: reach[0].mask", "1"), "the report has no item `mosk`"),
        ("<!-- n: mask: reach[0].mask -->1".to_owned(), "line 1: no `<!-- / -->` follows"),
    ] {
        assert!(said(&text).contains(named), "{}", said(&text));
    }
}
