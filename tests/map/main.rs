//! Statements of ARCHITECTURE.md about the code are true: crates, rooms, arrows, limits; and every path named by the documents exists.

mod budgets;
mod code;
mod documents;
mod formats;
mod graph;
mod recipes;
mod reports;
mod tokens;

use code::{Arrow, CRATES, Code, Crate};
use documents::{anchors, documents, drawn, links, map, quoted, root, rows, section, text};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Complete dependencies of the lower crates, none of which reads a command line, draws, or writes pages; and of the package for Python, which does
/// not need the laboratory.
const DEPENDENCIES: [(&str, &[&str]); 3] = [
    ("kernels", &["libm", "memmap2", "pulp", "rand", "rayon", "serde", "thiserror", "wide"]),
    (
        "kernels/physics",
        &[
            "cpu-time",
            "crc32fast",
            "ctrlc",
            "gethostname",
            "humantime",
            "libm",
            "mpi",
            "nix",
            "postcard",
            "rand",
            "rayon",
            "serde",
            "serde_json",
            "sha2",
            "stripmine-kernels",
            "strsim",
            "tempfile",
            "thiserror",
            "toml",
            "zmij",
        ],
    ),
    (
        "python",
        &[
            "arrow-array",
            "arrow-schema",
            "numpy",
            "pyo3",
            "serde_json",
            "stripmine-kernels",
            "stripmine-physics",
            "tempfile",
        ],
    ),
];

/// Known circles of files, each with the reason.
const KNOWN_CIRCLES: [(&[&str], &str); 5] = [
    (
        &["kernels/src/backend/dispatch.rs", "kernels/src/backend/precision.rs"],
        "a precision says which programs are compiled for it, and work is dispatched by precision",
    ),
    (
        &["kernels/src/law/granular.rs", "kernels/src/law/spring.rs"],
        "a contact has a spring, and energy, depth and duration of a contact follow from its spring's formula",
    ),
    (
        &["kernels/physics/src/method/entry.rs", "kernels/physics/src/method/trials.rs"],
        "an entry states its trials, and a setting is checked against the prepared scene",
    ),
    (
        &[
            "kernels/physics/src/method/lattice_md/arrays.rs",
            "kernels/physics/src/method/lattice_md/programs.rs",
        ],
        "arrays ask programs for their memory, and programs run on the arrays",
    ),
    (
        &["src/console/failure.rs", "src/console/output.rs"],
        "output that cannot be written is a failure, and a failure is written by the output's rules",
    ),
];

/// Folders of methods, in the physics and in the laboratory.
const METHODS: [&str; 4] = ["hard_disks", "langevin", "lattice_md", "nbody"];
const FOLDERS_OF_METHODS: [&str; 2] = ["kernels/physics/src/method", "src/laboratory"];

/// Files that may name a method: the lists, and two that compare methods; and the one file of a method that others use.
const LISTS: [&str; 4] = [
    "kernels/physics/src/method/list.rs",
    "src/laboratory/mod.rs",
    "src/laboratory/hard_disks/study/soft_hard.rs",
    "kernels/physics/src/method/lattice_md/hard.rs",
];
const SHARED: &str = "kernels/physics/src/method/hard_disks/compress.rs";

fn code() -> Code {
    Code::read(root())
}

/// Rooms of a crate: its files and folders, except `lib` and `main`.
fn rooms(of: Crate) -> BTreeSet<String> {
    let entries = fs::read_dir(root().join(of.folder)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let names = names.map(|name| name.trim_end_matches(".rs").to_owned());
    names.filter(|name| !["lib", "main"].contains(&name.as_str())).collect()
}

/// Arrows between rooms of each crate, and between crates: crate, user, used, and the files.
fn arrows_of_rooms(arrows: &BTreeSet<Arrow>) -> Vec<(&str, &str, &str, &Arrow)> {
    let of = |arrow| {
        let (from, to): &(String, String) = arrow;
        let (user, used) = (Crate::of(from), Crate::of(to));
        match user.name == used.name {
            true => (user.short, user.room(from), used.room(to), arrow),
            false => ("crates", user.short, used.short, arrow),
        }
    };
    let is_room = |name: &str| !["lib", "main"].contains(&name);
    let arrows = arrows.iter().map(of);
    arrows.filter(|(_, from, to, _)| from != to && is_room(from) && is_room(to)).collect()
}

/// The arrows of the code are the drawn ones, directly or along a chain, and every drawn arrow occurs in the code. The drawing has no circle, so no
/// arrow
/// goes up.
#[test]
fn drawn_arrows_match_the_code() {
    let (drawn, code) = (drawn(&text("ARCHITECTURE.md")), code());
    let arrows = code.arrows();
    let found = arrows_of_rooms(&arrows);
    assert!(found.len() > 500, "{} arrows", found.len());
    for of in CRATES.iter().map(|it| it.short).chain(["crates"]) {
        // A drawn arrow means "is used by".
        let drawn = drawn.iter().filter(|(name, ..)| name == of);
        let drawn: Vec<(&str, &str)> = drawn.map(|(_, used, user)| (user.as_str(), used.as_str())).collect();
        assert_eq!(graph::circles(drawn.iter().copied()), BTreeSet::new(), "{of}: the drawing has circles");
        let is_in_code =
            |&(from, to): &(&str, &str)| found.iter().any(|it| (it.0, it.1, it.2) == (of, from, to));
        let idle: Vec<_> = drawn.iter().filter(|arrow| !is_in_code(arrow)).collect();
        assert!(idle.is_empty(), "{of}: drawn, but not in the code (user, used): {idle:?}");
        let allowed = graph::reached(drawn.iter().copied());
        let is_allowed = |from: &str, to: &str| allowed.get(from).is_some_and(|all| all.contains(to));
        let wrong: Vec<_> =
            found.iter().filter(|it| it.0 == of && !is_allowed(it.1, it.2)).map(|it| it.3).collect();
        assert!(wrong.is_empty(), "{of}: the drawing does not lead from (user) to (used): {wrong:#?}");
    }
}

/// Dependencies listed in a manifest, except those of tests.
fn dependencies(manifest: &str) -> impl Iterator<Item = &str> {
    let sections = manifest.split("\n[").filter(|section| !section.starts_with("dev-"));
    sections.flat_map(|section| {
        let heading = section.split(']').next().unwrap();
        let lines = section.lines().skip(1).filter(|line| line.contains('=') && !line.starts_with('#'));
        let names = lines.map(|line| line.split([' ', '.', '=']).next().unwrap());
        let listed = names.filter(|_| heading.ends_with("dependencies"));
        // A dependency may have its own section.
        listed.chain(heading.split_once("dependencies.").map(|(_, name)| name))
    })
}

/// The kernels name neither physics nor laboratory, the physics and the package for Python do not name the laboratory, and none of them
/// depends on a crate beyond its list.
#[test]
fn lower_crates_do_not_name_higher_ones() {
    for (folder, expected) in DEPENDENCIES {
        let manifest = text(Path::new(folder).join("Cargo.toml"));
        let found: BTreeSet<&str> = dependencies(&manifest).collect();
        assert_eq!(found, expected.iter().copied().collect(), "{folder}/Cargo.toml");
    }
    let code = code();
    for (path, name) in code.foreign() {
        let is_laboratory = Crate::of(path).short == "src";
        let is_allowed = ["std", "core", "alloc"].contains(&name)
            || is_laboratory
            || DEPENDENCIES.iter().any(|(_, names)| names.iter().any(|it| it.replace('-', "_") == name))
            // Names in scope: variants of an enumeration, items of a trait.
            || name.starts_with(char::is_uppercase);
        assert!(is_allowed, "{path} uses {name}");
    }
    let place = |path: &str| CRATES.iter().position(|it| it.name == Crate::of(path).name);
    let up: Vec<Arrow> = code.arrows().into_iter().filter(|(from, to)| place(from) < place(to)).collect();
    assert!(up.is_empty(), "{up:#?}");
}

/// Circles of files are the known ones. A module and the files of its folder count as one: they may name shared definitions of
/// the module.
#[test]
fn files_have_no_unknown_circles() {
    let all = code().arrows();
    let is_to_own_module = |(from, to): &&Arrow| {
        let (from, to) = (Path::new(from), Path::new(to));
        to.file_name().unwrap() == "mod.rs" && from.starts_with(to.parent().unwrap())
            || from.starts_with(to.with_extension(""))
    };
    let arrows = all.iter().filter(|arrow| !is_to_own_module(arrow));
    let found = graph::circles(arrows.map(|(from, to)| (from.as_str(), to.as_str())));
    let known: BTreeSet<Vec<&str>> = KNOWN_CIRCLES.iter().map(|(files, _)| files.to_vec()).collect();
    let new: Vec<_> = found.difference(&known).collect();
    assert!(new.is_empty(), "new circles: {new:#?}");
    let gone: Vec<_> = known.difference(&found).collect();
    assert!(gone.is_empty(), "known circles that no longer exist; remove them from the list: {gone:#?}");
}

/// Only a method's own folders and the lists name it.
#[test]
fn only_lists_name_methods() {
    let method = |path: &str| {
        let within = FOLDERS_OF_METHODS.iter().find_map(|folder| path.strip_prefix(folder));
        let name = within.and_then(|it| it.split('/').nth(1)).map(str::to_owned);
        name.filter(|name| METHODS.contains(&name.as_str()))
    };
    let is_wrong = |(from, to): &Arrow| {
        method(to).is_some() && method(to) != method(from) && !LISTS.contains(&from.as_str()) && to != SHARED
    };
    let wrong: Vec<Arrow> = code().arrows().into_iter().filter(is_wrong).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Every room of the crates has a line in the map, and every name of a line exists.
#[test]
fn map_names_exactly_the_existing_rooms() {
    let map = map(&text("ARCHITECTURE.md"));
    for of in CRATES {
        let lines = map.iter().filter(|line| line.folder == Path::new(of.folder));
        let mapped: BTreeSet<String> = lines.flat_map(|line| line.names.iter().cloned()).collect();
        assert_eq!(mapped, rooms(of), "{}", of.folder);
    }
    for path in map.iter().flat_map(|line| line.names.iter().map(|name| line.folder.join(name))) {
        let full = root().join(&path);
        assert!(full.is_dir() || full.with_extension("rs").is_file(), "{} is not there", path.display());
    }
}

/// Every path named by a document exists, and every link leads to an existing file and heading.
#[test]
fn paths_in_documents_exist() {
    let roots = ["src/", "kernels/", "python/", "benches/", "tests/", "reports/", "docs/"];
    for document in documents() {
        let text = text(&document);
        for path in quoted(&text).into_iter().filter(|word| roots.iter().any(|it| word.starts_with(it))) {
            assert!(root().join(path).exists(), "{}: `{path}`", document.display());
        }
        for (path, heading) in links(&text) {
            let target = match path {
                "" => root().join(&document),
                path => root().join(&document).parent().unwrap().join(path),
            };
            assert!(target.exists(), "{}: {path}", document.display());
            if let Some(heading) = heading {
                let there = anchors(&fs::read_to_string(target).unwrap());
                assert!(there.contains(heading), "{}: {path}#{heading}", document.display());
            }
        }
    }
}

/// Every invariant names an existing test, or is marked as untested.
#[test]
fn invariants_name_their_tests() {
    let rows = rows(&section(&text("ARCHITECTURE.md"), "Invariants"));
    assert!(rows.len() > 10, "{}", rows.len());
    for row in rows {
        let [invariant, held] = row.as_slice() else { panic!("{row:?}") };
        if ["untested", "the compiler"].contains(&held.as_str()) {
            continue;
        }
        let names = quoted(held);
        assert!(!names.is_empty(), "{invariant}: neither a test nor \"untested\"");
        let mut file = String::new();
        for name in names {
            if name.contains('/') {
                file = text(name);
            } else {
                assert!(file.contains(&format!("fn {name}(")), "{invariant}: there is no test {name}");
            }
        }
    }
}

/// The README is short, and contains the command that the checks run.
#[test]
fn readme_is_short_and_has_the_test_command() {
    let text = text("README.md");
    assert!(text.lines().count() <= 90);
    assert!(text.lines().any(|line| line == "cargo test --workspace"));
}

/// The list of long suites equals the one in docs/report.md, and each line has a command and a description.
#[test]
fn documents_list_the_long_suites() {
    let list = text(".ci/long-suites");
    assert!(section(&text("docs/report.md"), "The long suites").contains(&format!("```text\n{list}```\n")));
    for suite in list.lines() {
        let parts: Vec<&str> = suite.split("   ").filter(|part| !part.trim().is_empty()).collect();
        assert_eq!(parts.len(), 2, "expected a command, three or more spaces, a description: {suite}");
    }
}

/// Every test ignored for its length runs in a long suite, selected by its file and, where the suite has a filter, by its name.
#[test]
fn every_ignored_test_is_in_a_long_suite() {
    let list = text(".ci/long-suites");
    let ignored = documents::ignored_tests();
    assert!(ignored.len() > 10, "{} ignored tests", ignored.len());
    for (path, name) in ignored {
        let target = match path.strip_prefix("tests") {
            Ok(within) => {
                format!("--test {} ", within.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs"))
            }
            Err(_) => "--lib ".to_owned(),
        };
        let is_run = list.lines().any(|suite| {
            let command = suite.split("   ").next().unwrap();
            let filter = command.split_once("--ignored").map(|(_, filter)| filter.trim());
            command.contains(&target) && filter.is_some_and(|filter| name.contains(filter))
        });
        assert!(is_run, "{}: {name} is ignored, and no line of .ci/long-suites runs it", path.display());
    }
}
