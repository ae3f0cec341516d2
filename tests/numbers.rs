//! Numbers in documents are cells of the committed report: `<!-- n: NAME -->NUMBER<!-- / -->`, and at the end of the document, in a
//! comment that begins with `numbers:`, a line `NAME = ITEM: EXPRESSION` for each. Those of the README are in `docs/readme-numbers.txt`.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use stripmine::claims::{self, ClaimVerdict};
use stripmine::frame::{ExpressionScope, Expressions, FrameBuilder};
use stripmine::report::tally::Tally;
use stripmine::results::Folder;

const BEGIN: &str = "<!-- n: ";
const END: &str = "<!-- / -->";
const DEFINITIONS: &str = "<!-- numbers:";

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

/// The numbers that a text defines: name, item and expression.
fn definitions(text: &str) -> BTreeMap<&str, (&str, &str)> {
    let Some((_, block)) = text.split_once(DEFINITIONS) else { return BTreeMap::new() };
    let lines = block.split("-->").next().unwrap_or_default().lines().skip(1);
    let define = |line: &'_ str| -> Option<(usize, usize)> {
        let equals = line.find(" = ")?;
        Some((equals, equals + 3 + line[equals + 3..].find(": ")?))
    };
    lines
        .filter_map(|line| {
            define(line).map(|(name, item)| (&line[..name], (&line[name + 3..item], &line[item + 2..])))
        })
        .collect()
}

/// Claims by source and verdict, as the report's first table has them.
fn claims_of(folder: &Folder) -> ExpressionScope {
    let items = [root().join("reports"), root().join("reports/host")]
        .into_iter()
        .flat_map(|it| fs::read_dir(it).unwrap());
    let names = items.map(|it| it.unwrap().file_name().into_string().unwrap());
    let sections: Vec<_> = names.filter_map(|name| folder.section(&name).unwrap()).collect();
    let tally = Tally::of(&sections, &claims::all().unwrap());
    let mut rows = FrameBuilder::of(tally.rows()).text("source", |(source, _)| *source);
    for (at, verdict) in ClaimVerdict::ALL.into_iter().enumerate() {
        rows = rows.count(verdict.words(), move |(_, counts)| counts[at]);
    }
    ExpressionScope::of([rows.frame("sources", "Claims by source and verdict")])
}

/// Checks the numbers of a text. Returns the text with the numbers of the report, how many there are, and faults with their lines:
/// numbers that are not those of their cells, and cells that are gone.
fn checked(text: &str, defined: &str, folder: &Folder) -> (String, usize, Vec<String>) {
    let (expressions, known, claims) = (Expressions::new(), definitions(defined), OnceCell::new());
    let (mut renewed, mut held, mut faults, mut rest) = (String::new(), 0, vec![], text);
    while let Some((before, after)) = rest.split_once(BEGIN) {
        renewed += before;
        let line = text[..text.len() - after.len()].matches('\n').count() + 1;
        let value = || {
            let (name, after) = after.split_once(" -->").ok_or("the comment has no end")?;
            let (shown, after) = after.split_once(END).ok_or(format!("no `{END}` follows"))?;
            let names = || known.keys().copied().collect::<Vec<_>>().join(", ");
            let (item, expression) =
                known.get(name).ok_or_else(|| format!("`{name}` is not defined; there are {}", names()))?;
            let scope = match *item {
                "claims" => Some(claims.get_or_init(|| claims_of(folder)).clone()),
                item => folder.scope(item).map_err(|cause| cause.to_string())?,
            };
            let scope = scope.ok_or(format!("the report has no item `{item}`"))?;
            let value = expressions.text(&format!("{{{{ {expression} }}}}"), &scope).map_err(|(_, it)| it)?;
            Ok::<_, String>((name, shown, value, after))
        };
        rest = after;
        match value() {
            Err(cause) => {
                faults.push(format!("line {line}: {cause}"));
                renewed += BEGIN;
            }
            Ok((name, shown, value, after)) => {
                held += 1;
                if value != shown {
                    faults.push(format!("line {line}: {shown} is {value}, by {name}"));
                }
                renewed += &format!("{BEGIN}{name} -->{value}{END}");
                rest = after;
            }
        }
    }
    (renewed + rest, held, faults)
}

/// With `BLESS=1` the documents get the numbers of the report.
#[test]
fn numbers_in_documents_are_those_of_the_report() {
    let folder = Folder::opened_elsewhere(&root().join("reports"));
    let (mut wrong, mut all) = (vec![], 0);
    for path in documents() {
        let text = fs::read_to_string(&path).unwrap();
        // The first page is for readers: its definitions are in a file of their own.
        let is_first = path.file_name().is_some_and(|it| it == "README.md");
        let beside = root().join("docs/readme-numbers.txt");
        let defined = if is_first { fs::read_to_string(beside).unwrap() } else { text.clone() };
        let (renewed, held, faults) = checked(&text, &defined, &folder);
        if std::env::var_os("BLESS").is_some() && renewed != text {
            fs::write(&path, renewed).unwrap();
        }
        all += held;
        wrong.extend(
            faults.iter().map(|it| format!("{}, {it}", path.strip_prefix(root()).unwrap().display())),
        );
    }
    assert!(wrong.is_empty(), "{}\nBLESS=1 cargo test --test numbers writes them", wrong.join("\n"));
    assert!(all >= 60, "{all} numbers");
}

/// Faults name the line, and what exists.
#[test]
fn numbers_without_a_cell_are_faults() {
    let folder = Folder::opened_elsewhere(&root().join("reports"));
    let of = |name: &str, number: &str, definition: &str| {
        let text = format!("a\nb {BEGIN}{name} -->{number}{END}.\n{DEFINITIONS}\n{definition}\n-->\n");
        checked(&text, &text, &folder).2.join("; ")
    };
    let mask = "m = mask: reach[0].mask";
    assert_eq!(of("m", "5×5", mask), "");
    for (name, number, definition, named) in [
        ("m", "7×7", mask, "line 2: 7×7 is 5×5, by m"),
        ("n", "5×5", mask, "`n` is not defined; there are m"),
        ("m", "1", "m = mask: reach[0].masks", "it has mask, "),
        ("m", "1", "m = mask: gone[0].mask", "reach"),
        ("m", "1", "m = mosk: reach[0].mask", "the report has no item `mosk`"),
    ] {
        let said = of(name, number, definition);
        assert!(said.contains(named), "{said}");
    }
    let text = format!("{BEGIN}m -->5×5");
    let cut = checked(&text, &text, &folder).2.join("; ");
    assert!(cut.contains("line 1: no `<!-- / -->` follows"), "{cut}");
}
