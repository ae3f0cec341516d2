//! Numbers of files in the recipes of ARCHITECTURE.md equal those of real commits.

use crate::documents::{quoted, root, section, text};
use std::process::Command;

/// Recipes with a number of files: the subject of the commit made for each. All but the pair law were reverted at once.
const COUNTED: [(&str, &str); 6] = [
    ("A pair law", "Yukawa pairs in Langevin scenes: law.kind = \"yukawa\" with law.screening"),
    ("A key of scenes", "Files of a key of scenes, to count them: particles.angle of an ellipse"),
    ("A format of trajectories", "Files of a format, to count them: plain XYZ"),
    ("A quantity that is observed", "Files of a quantity, to count them: momentum of bodies along x"),
    ("A study of one method", "Files of a study, to count them: the leapfrog on ellipses"),
    ("A machine", "Files of a machine, to count them: a CRAY-1 that does not chain"),
];

/// Numbers in words, from one.
const WORDS: [&str; 6] = ["one file", "two files", "three files", "four files", "five files", "six files"];

/// Text of a recipe, and the files and folders of the crates that it names.
pub fn recipe(name: &str) -> (String, Vec<String>) {
    let recipes = section(&text("ARCHITECTURE.md"), "Files to touch for");
    let recipe = recipes.split("\n- ").find(|item| item.starts_with(&format!("*{name}*"))).unwrap();
    let places = quoted(recipe).into_iter().filter(|word| word.starts_with("kernels/"));
    (recipe.to_owned(), places.map(str::to_owned).collect())
}

/// Output of git; `None` without git or a history.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").arg("-C").arg(root()).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8(output.stdout).unwrap())
}

/// Tests and documents are not counted.
fn is_counted(path: &str) -> bool {
    let is_document = path.ends_with(".md") && (path.starts_with("docs/") || !path.contains('/'));
    !is_document && !path.starts_with("tests/") && !path.contains("/tests/")
}

/// Files changed by the commit with a subject; `None` if the history does not reach so far.
fn files(subject: &str) -> Option<Vec<String>> {
    let log = git(&["log", "--format=%H %s", "--fixed-strings", &format!("--grep={subject}")])?;
    let commit = log.lines().find_map(|line| line.split_once(' ').filter(|(_, it)| *it == subject))?.0;
    let changed = git(&["show", "--format=", "--name-only", commit])?;
    Some(changed.lines().filter(|path| is_counted(path)).map(str::to_owned).collect())
}

/// A number in bold is the number of files of its commit, and a recipe without a commit has none.
#[test]
fn recipes_match_their_commits() {
    let recipes = section(&text("ARCHITECTURE.md"), "Files to touch for");
    for item in recipes.split("\n- ").skip(1) {
        let stated = item.split("**").nth(1);
        match COUNTED.iter().find(|(name, _)| item.starts_with(&format!("*{name}*")) && stated.is_some()) {
            None => assert_eq!(stated, None, "no commit counts the files of this: {item}"),
            Some((name, subject)) => match files(subject) {
                None => println!("SKIPPED: {name} (the history lacks its commit)"),
                Some(files) => assert_eq!(stated, Some(WORDS[files.len() - 1]), "{name}: {files:?}"),
            },
        }
    }
    let stated = recipes.split("\n- ").skip(1).filter(|item| item.contains("**")).count();
    assert_eq!(stated, COUNTED.len());
}
