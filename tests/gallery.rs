//! The gallery shows what its scenes give: every scene runs and is drawn as its page says, and its figures are the report's.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// Pictures are read on a page: no larger each, and all together (bytes).
const LARGEST: u64 = 150_000;
const ALL: u64 = 1_200_000;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn page() -> String {
    fs::read_to_string(root().join("docs/gallery.md")).unwrap()
}

/// The arguments of the page's commands of a verb.
fn commands(verb: &str) -> Vec<Vec<String>> {
    let begin = format!("stripmine {verb} ");
    let text = page();
    let lines = text.lines().filter_map(|line| line.strip_prefix(&begin));
    lines.map(|line| line.split(' ').map(str::to_owned).collect()).collect()
}

/// The names of the files of a kind in the gallery's folder.
fn files(kind: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(root().join("docs/gallery")).unwrap().map(|entry| entry.unwrap().path());
    let names = entries.filter(|path| path.extension().is_some_and(|it| it == kind));
    names.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect()
}

/// Each scene has one picture and one command that runs it, and the page shows the picture.
#[test]
fn every_scene_has_a_picture_of_a_size_to_be_read() {
    let (scenes, pictures) = (files("toml"), files("svg"));
    assert_eq!(scenes.len(), 12);
    assert_eq!(scenes, pictures);
    let run: Vec<String> = commands("run").into_iter().map(|words| words[0].clone()).collect();
    assert_eq!(run.len(), scenes.len());
    let mut all = 0;
    for scene in &scenes {
        assert!(run.contains(&format!("docs/gallery/{scene}.toml")), "{scene} has no command");
        assert_eq!(page().matches(&format!("](gallery/{scene}.svg)")).count(), 1, "{scene} is not shown");
        let size = fs::metadata(root().join(format!("docs/gallery/{scene}.svg"))).unwrap().len();
        assert!(size <= LARGEST, "{scene}: {size} bytes");
        all += size;
    }
    assert!(all <= ALL, "{all} bytes");
}

/// The page's commands, a few steps long.
#[test]
fn every_scene_runs_and_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let stripmine = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
        let done = command.args(arguments).current_dir(&folder).stdin(Stdio::null()).output().unwrap();
        assert!(done.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
    };
    for words in commands("run") {
        let file = root().join(&words[0]);
        let text = fs::read_to_string(&file).unwrap();
        // No command of the page takes more: what it says is what is run here.
        assert_eq!(words.len(), 1, "{words:?}");
        let is_of_events = text.contains("kind = \"hard-disks\"");
        let short = if is_of_events { "run.events=500" } else { "run.steps=10" };
        stripmine(&["run", file.to_str().unwrap(), "--quiet", "--set", short]);
    }
    for words in commands("plot") {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        stripmine(&[&["plot", "--quiet"], &words[..]].concat());
        let plots = folder.path().join(words[0].replace(".run", ".plots"));
        assert!(plots.join("last-state.svg").exists(), "{}", plots.display());
    }
}

/// What a paragraph says to be of the report stands there: a report that is made anew with other numbers asks for another page.
#[test]
fn figures_are_those_of_the_report() {
    let report = fs::read_to_string(root().join("reports/README.md")).unwrap();
    let text = page();
    let learned: Vec<&str> = text.split("*Learned:*").skip(1).collect();
    assert_eq!(learned.len(), 12);
    let mut held = 0;
    for said in learned {
        let said = said.split("\n\n").next().unwrap();
        let Some((said, link)) = said.split_once("([report](../reports/README.md#") else { continue };
        let anchor = link.split(')').next().unwrap();
        let is_it = |section: &&str| {
            let title = section.lines().next().unwrap().to_lowercase();
            let kept = title.chars().filter(|it| it.is_alphanumeric() || " -".contains(*it));
            kept.collect::<String>().replace(' ', "-") == anchor
        };
        let section = report.split("\n## ").find(is_it).unwrap_or_else(|| panic!("no section {anchor}"));
        let of_numbers = |it: char| it.is_ascii_digit() || it == '.';
        let numbers = said.split(|it| !of_numbers(it)).map(|number| number.trim_matches('.'));
        for number in numbers.filter(|number| number.contains('.')) {
            assert!(section.contains(number), "{number} is not in {anchor}: {said}");
            held += 1;
        }
    }
    assert!(held >= 16, "{held}");
}
