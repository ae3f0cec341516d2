//! What the README says of the code is true: its paths, its map, and the arrows between rooms.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms of a crate, floor by floor: a room uses rooms of lower floors only, so that there is no circle.
const FLOORS: [(&str, &[&[&str]]); 2] = [
    (
        "kernels/src",
        &[
            &["isa", "mask", "threads"],
            &["backend", "law", "noise"],
            &["flight", "integrator", "program"],
            &["ledger", "sweep"],
            &["printed"],
        ],
    ),
    (
        "src",
        &[
            &["domain", "number", "particles", "quoted", "signals", "statistics", "words"],
            &["grid", "io", "near", "origin"],
            &["observe", "placement"],
            &["scene"],
            &["memory", "reported"],
            &["model", "report", "start"],
            &["console"],
            &["results"],
            &["method"],
            &["run", "study"],
            &["cli"],
        ],
    ),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn readme() -> String {
    fs::read_to_string(root().join("README.md")).unwrap()
}

/// The section with the map: the tree, and the arrows.
fn blocks() -> Vec<String> {
    let text = readme();
    let section = text.split("## Map of the code").nth(1).unwrap().split("\n## ").next().unwrap().to_owned();
    section.split("```text\n").skip(1).map(|block| block.split("```").next().unwrap().to_owned()).collect()
}

/// A line of the map: the folder it stands in, the names before the gap, and what is said of them, lines that go on included.
#[derive(Debug)]
struct Entry {
    folder: PathBuf,
    names: Vec<String>,
    said: String,
}

/// The map, line by line: names begin at the margin (roots), two spaces in (rooms) or four (rooms within the room before).
fn entries() -> Vec<Entry> {
    let mut found: Vec<Entry> = vec![];
    let (mut crate_root, mut room) = (PathBuf::new(), PathBuf::new());
    for line in blocks().first().unwrap().lines() {
        let indent = line.len() - line.trim_start().len();
        let text = line.trim_start();
        let (names, said) = text.split_once("  ").unwrap_or((text, ""));
        if indent > 4 {
            let last = found.last_mut().unwrap();
            last.said.push(' ');
            last.said.push_str(text);
            continue;
        }
        let names: Vec<String> =
            names.split(", ").map(|name| name.trim_end_matches('/').to_owned()).collect();
        let folder = match indent {
            0 => PathBuf::new(),
            2 => crate_root.clone(),
            _ => room.clone(),
        };
        match indent {
            0 => crate_root = PathBuf::from(&names[0]),
            2 => room = crate_root.join(&names[0]),
            _ => {}
        }
        found.push(Entry { folder, names, said: said.to_owned() });
    }
    found
}

/// Every path the README names exists.
#[test]
fn paths_in_the_readme_exist() {
    let text = readme();
    let roots = ["src/", "kernels/", "benches/", "tests/", "reports/"];
    let named: Vec<&str> =
        text.split('`').filter(|word| roots.iter().any(|root| word.starts_with(root))).collect();
    assert!(named.len() > 5);
    for path in named {
        assert!(root().join(path).exists(), "{path}");
    }
}

fn exists(path: &Path) -> bool {
    path.is_dir() || path.with_extension("rs").is_file()
}

/// Whether a folder of that name lies somewhere below.
fn has_folder(below: &Path, name: &str) -> bool {
    let Ok(entries) = fs::read_dir(below) else { return false };
    entries
        .map(|entry| entry.unwrap().path())
        .any(|path| path.is_dir() && (path.file_name().unwrap() == name || has_folder(&path, name)))
}

/// Every room of both crates is a line of the map, and every name of a line is there, as is every folder in its words.
#[test]
fn the_map_names_every_room_and_nothing_else() {
    let map = entries();
    for (crate_root, _) in FLOORS {
        let mapped: BTreeSet<&str> = map
            .iter()
            .filter(|entry| entry.folder == Path::new(crate_root))
            .flat_map(|entry| entry.names.iter().map(String::as_str))
            .collect();
        assert_eq!(mapped, rooms(crate_root).iter().map(String::as_str).collect(), "{crate_root}");
    }
    for Entry { folder, names, said } in &map {
        for name in names {
            assert!(exists(&root().join(folder).join(name)), "{}/{name} is not there", folder.display());
        }
        let words = said.split(|c: char| !(c.is_alphanumeric() || "_/".contains(c)));
        for word in words.filter_map(|word| word.strip_suffix('/')).filter(|word| !word.is_empty()) {
            let is_there = names.iter().any(|name| has_folder(&root().join(folder).join(name), word));
            assert!(is_there, "{names:?}: there is no {word}/");
        }
    }
}

/// The rooms of a crate: its files and folders, without the two that hold it together.
fn rooms(crate_root: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(root().join(crate_root)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let names = names.map(|name| name.trim_end_matches(".rs").to_owned());
    names.filter(|name| !["lib", "main"].contains(&name.as_str())).collect()
}

/// Every source file below a folder, without those of tests.
fn sources(below: &Path) -> Vec<PathBuf> {
    let mut found = vec![];
    for entry in fs::read_dir(below).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|it| it == "rs") && path.file_name().unwrap() != "tests.rs" {
            found.push(path);
        }
    }
    found
}

/// What a source file takes of its own crate: the first names behind `crate::`, without comments and tests.
fn used(text: &str) -> BTreeSet<String> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    let code: String =
        code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = BTreeSet::new();
    for behind in code.split("crate::").skip(1) {
        match behind.strip_prefix('{') {
            None => drop(names.insert(word(behind))),
            Some(group) => {
                // A comma within deeper braces is of a deeper name.
                let mut depth = 0;
                let ends = |c: char| {
                    depth += match c {
                        '{' => 1,
                        '}' => -1,
                        _ => 0,
                    };
                    depth == 0 && c == ',' || depth < 0
                };
                let parts: Vec<&str> = group.split(';').next().unwrap().split(ends).collect();
                names.extend(
                    parts.into_iter().map(|part| word(part.trim_start())).filter(|name| !name.is_empty()),
                );
            }
        }
    }
    names
}

/// Names that the crate takes out of its rooms, and the room of each.
fn taken_out(crate_root: &str) -> BTreeMap<String, String> {
    let text = fs::read_to_string(root().join(crate_root).join("lib.rs")).unwrap();
    let lines = text.lines().filter_map(|line| line.strip_prefix("pub use "));
    let lines = lines.filter_map(|line| line.trim_end_matches(';').split_once("::"));
    let names = |names: &str| -> Vec<String> {
        names.trim_matches(['{', '}']).split(", ").map(str::to_owned).collect()
    };
    lines.flat_map(|(room, all)| names(all).into_iter().map(move |name| (name, room.to_owned()))).collect()
}

/// No file uses a room of its own floor or of a higher one.
#[test]
fn no_arrow_goes_up_and_there_is_no_circle() {
    for (crate_root, floors) in FLOORS {
        let all: BTreeSet<String> = floors.iter().copied().flatten().map(|&room| room.to_owned()).collect();
        assert_eq!(all, rooms(crate_root), "{crate_root}");
        let floor = |room: &str| floors.iter().position(|rooms| rooms.contains(&room));
        let outside = taken_out(crate_root);
        let (mut wrong, mut arrows) = (vec![], 0);
        for file in sources(&root().join(crate_root)) {
            let within = file.strip_prefix(root().join(crate_root)).unwrap();
            let own =
                within.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs");
            let Some(own_floor) = floor(own) else { continue };
            for name in used(&fs::read_to_string(&file).unwrap()) {
                let room = outside.get(&name).map_or(name.as_str(), String::as_str);
                if room == own {
                    continue;
                }
                arrows += 1;
                match floor(room) {
                    Some(floor) if floor < own_floor => {}
                    _ => wrong.push(format!("{} uses {room}", within.display())),
                }
            }
        }
        assert!(wrong.is_empty() && arrows > 20, "{crate_root}, {arrows} arrows: {wrong:#?}");
    }
}

/// The arrows that the README draws, "is used by", go from lower floors to higher ones.
#[test]
fn drawn_arrows_go_up_from_what_is_used() {
    let mut seen = 0;
    let arrows = blocks().remove(1);
    let mut crate_root = "";
    for line in arrows.lines() {
        for (name, of) in [("kernels:", "kernels/src"), ("src:", "src")] {
            if line.trim_start().starts_with(name) {
                crate_root = of;
            }
        }
        let floors = FLOORS.iter().find(|(of, _)| *of == crate_root).unwrap().1;
        let floor = |room: &str| floors.iter().position(|rooms| rooms.contains(&room));
        for chain in line.split("  ").filter(|chain| chain.contains('→')) {
            let names = |part: &str| -> Vec<usize> {
                let words = part.split(|c: char| !(c.is_alphanumeric() || c == '_'));
                let words = words.filter(|word| !word.is_empty() && *word != "kernels" && *word != "src");
                words.map(|word| floor(word).unwrap_or_else(|| panic!("{word} is no room"))).collect()
            };
            let steps: Vec<Vec<usize>> = chain.split('→').map(names).collect();
            for pair in steps.windows(2) {
                let is_up = pair[0].iter().all(|from| pair[1].iter().all(|to| from < to));
                assert!(is_up, "{chain}");
                seen += 1;
            }
        }
    }
    assert!(seen > 8, "{seen}");
}

/// The commands that the README shows are the ones the checks run.
#[test]
fn the_test_command_stands_alone_on_a_line() {
    assert!(readme().lines().any(|line| line == "cargo test --workspace"));
}
