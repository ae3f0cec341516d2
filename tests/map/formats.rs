//! File formats of particles are named in the files that ARCHITECTURE.md lists, and nowhere else.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::code::{CRATES, Code};
use crate::documents::{root, text};
use crate::recipes::recipe;
use stripmine_physics::io::FORMATS;

/// Other files that name a format, each with the reason.
const OTHERS: [(&str, &str); 1] = [(
    "kernels/physics/src/method/langevin/quantities.rs",
    "the help of a quantity names the file with velocities of another moment",
)];

/// The format of start files and of frames in memory, which others use too.
const FRAMES: &str = "kernels/physics/src/io/extxyz";

/// Readers of start files: one file reads a format that a run may write, too.
const STARTS: &str = "kernels/physics/src/io/start_files";

/// File that accumulates displacements.
const SUMS: &str = "kernels/physics/src/run/structured.rs";

/// Files of the crates that contain some words, outside comments and tests.
fn naming(words: &[String]) -> BTreeSet<String> {
    let mut folders: Vec<_> = CRATES.iter().map(|it| root().join(it.folder)).collect();
    let mut found = BTreeSet::new();
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|kind| kind == "rs") && !path.ends_with("tests.rs") {
                let text = fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
                let mut lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
                if lines.any(|line| words.iter().any(|word| line.contains(word))) {
                    found.insert(path.strip_prefix(root()).unwrap().to_str().unwrap().to_owned());
                }
            }
        }
    }
    found
}

/// A format touches the two files of the recipe: only its own file contains its key and the name of its output, and only
/// the list uses that file.
#[test]
fn formats_are_named_only_where_the_recipe_says() {
    let (_, places) = recipe("A format of trajectories");
    let [folder, example, list] = &places[..] else { panic!("{places:?}") };
    let arrows = Code::read(root()).arrows();
    let mut files = BTreeSet::new();
    for format in FORMATS {
        let mut found = naming(&[format!("\"{}\"", format.key), format.file.to_owned()]);
        OTHERS.iter().for_each(|(other, _)| _ = found.remove(*other));
        let [own] = found.iter().map(String::as_str).collect::<Vec<_>>()[..] else {
            panic!("{}: {found:?}", format.file)
        };
        let module = match Path::new(own).parent() {
            Some(parent) if parent != Path::new(folder) => parent.to_str().unwrap(),
            _ => own,
        };
        assert!(module.starts_with(folder.as_str()), "{own}");
        let is_user = |(from, to): &&(String, String)| {
            to.starts_with(module) && !from.starts_with(module) && !from.starts_with(STARTS)
        };
        let users: BTreeSet<&str> = arrows.iter().filter(is_user).map(|(from, _)| from.as_str()).collect();
        assert!(module == FRAMES || users == BTreeSet::from([list.as_str()]), "{own}: {users:?}");
        files.insert(own.to_owned());
    }
    assert!(files.len() > 3 && files.contains(example), "{files:?}");
}

/// Data of particles are requested only by the code that writes or accumulates them, and by nothing between it and the method.
#[test]
fn particle_data_are_requested_by_writers_only() {
    let (_, places) = recipe("Data of each particle");
    let [home, format] = &places[..] else { panic!("{places:?}") };
    assert!(text(home).contains("pub trait PerParticle {") && text(home).contains("fn images(&self)"));
    let users = naming(&["per_particle.images()", "per_particle().images()"].map(str::to_owned));
    assert_eq!(users, BTreeSet::from([format.as_str(), SUMS].map(str::to_owned)));
}
