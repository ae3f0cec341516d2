//! The gallery matches its scenes: every scene runs and is drawn with the commands of the page.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// Size limits in bytes of each picture and of all together, since they are read on one page.
const LARGEST: u64 = 150_000;
const ALL: u64 = 1_200_000;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn page() -> String {
    fs::read_to_string(root().join("docs/gallery.md")).unwrap()
}

/// Arguments of the page's commands with a verb.
fn commands(verb: &str) -> Vec<Vec<String>> {
    let begin = format!("stripmine {verb} ");
    let text = page();
    let lines = text.lines().filter_map(|line| line.strip_prefix(&begin));
    lines.map(|line| line.split(' ').map(str::to_owned).collect()).collect()
}

/// Names of the files of a type in the gallery's folder.
fn files(kind: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(root().join("docs/gallery")).unwrap().map(|entry| entry.unwrap().path());
    let names = entries.filter(|path| path.extension().is_some_and(|it| it == kind));
    names.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect()
}

/// Each scene has one picture and one command that runs it, and the page shows the picture.
#[test]
fn every_gallery_scene_has_a_small_picture() {
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

/// The page's commands, shortened to a few steps.
#[test]
fn every_gallery_scene_runs_and_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let stripmine = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
        let done = command.args(arguments).current_dir(&folder).stdin(Stdio::null()).output().unwrap();
        assert!(done.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
    };
    for words in commands("run") {
        let file = root().join(&words[0]);
        let text = fs::read_to_string(&file).unwrap();
        // The page's commands have no further arguments, so this is the whole command.
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

/// Each picture has a lesson with a number and the run's time; a link leads to an item of the report. `tests/numbers.rs` checks
/// numbers quoted from the report.
#[test]
fn lessons_have_numbers_and_run_times() {
    let pages = fs::read_dir(root().join("pages")).unwrap().map(|page| page.unwrap().path());
    let anchor = |path: std::path::PathBuf| {
        let text = fs::read_to_string(&path).unwrap();
        let title =
            text.lines().find_map(|line| line.strip_prefix("title = \"")).unwrap().trim_end_matches('"');
        let kept = title.to_lowercase();
        let kept = kept.chars().filter(|it| it.is_alphanumeric() || " -".contains(*it));
        kept.collect::<String>().replace(' ', "-")
    };
    let anchors: BTreeSet<String> = pages.map(anchor).collect();
    let text = page();
    let lessons: Vec<&str> =
        text.split("*Learned:*").skip(1).map(|it| it.split("\n\n").next().unwrap()).collect();
    assert_eq!(lessons.len(), 12);
    for lesson in lessons {
        let (said, time) =
            lesson.split_once(" Run time: ").unwrap_or_else(|| panic!("no run time: {lesson}"));
        let seconds = time.trim_end().strip_suffix(" s.").and_then(|it| it.parse::<u32>().ok());
        assert!(seconds.is_some(), "{time}");
        let own = said.split("([report]").next().unwrap();
        assert!(own.chars().any(|it| it.is_ascii_digit()), "no number: {lesson}");
        for link in said.split("](../reports/README.md#").skip(1) {
            let to = link.split(')').next().unwrap();
            assert!(anchors.contains(to), "no item `{to}`; there are {anchors:?}");
        }
    }
}
