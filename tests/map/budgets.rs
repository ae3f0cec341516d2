//! Budgets of modules: their largest numbers of lines.

use std::fs;
use std::path::Path;

use crate::code::{CRATES, Crate};
use crate::documents::{root, text};

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Budgets {
    room: Vec<Room>,
}

/// A folder or file, and its largest number of lines without tests.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Room {
    path: String,
    lines: usize,
    #[serde(default)]
    raised: Vec<Raise>,
}

/// Increase of a budget, with its reason.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Raise {
    by: usize,
    reason: String,
}

/// Number of lines of the Rust files below a path, without unit tests.
fn lines(path: &Path) -> usize {
    if path.is_file() {
        let is_test = path.ends_with("tests.rs") || path.extension().is_none_or(|it| it != "rs");
        let text = if is_test { String::new() } else { text(path) };
        return text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default().lines().count();
    }
    let entries = fs::read_dir(path).unwrap_or_else(|_| panic!("there is no {}", path.display()));
    let entries = entries.map(|entry| entry.unwrap().path());
    entries.filter(|path| !path.ends_with("tests")).map(|path| lines(&path)).sum()
}

#[test]
fn modules_keep_their_budgets() {
    let budgets: Budgets = toml::from_str(&text("tests/map/budgets.toml")).unwrap();
    let mut over = vec![];
    for Room { path, lines: budget, raised } in &budgets.room {
        assert!(
            raised.iter().all(|raise| raise.reason.split(' ').count() > 3),
            "{path}: a raise needs a reason"
        );
        let (count, budget) =
            (lines(&root().join(path)), budget + raised.iter().map(|it| it.by).sum::<usize>());
        if count > budget {
            over.push(format!("{path} has {count} lines; its budget is {budget}"));
        }
    }
    assert!(over.is_empty(), "{}; budgets are in tests/map/budgets.toml", over.join("; "));
}

/// Every top folder of a crate has a budget, and so has a crate whose modules are all files.
#[test]
fn every_top_module_has_a_budget() {
    let budgets: Budgets = toml::from_str(&text("tests/map/budgets.toml")).unwrap();
    for Crate { folder, .. } in CRATES {
        let entries = fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
        let rooms = entries.filter(|entry| entry.is_dir());
        let mut rooms: Vec<String> =
            rooms.map(|room| room.strip_prefix(root()).unwrap().to_str().unwrap().to_owned()).collect();
        if rooms.is_empty() {
            rooms.push(folder.to_owned());
        }
        for room in rooms {
            assert!(budgets.room.iter().any(|it| it.path == room), "{room} has no budget");
        }
    }
}
