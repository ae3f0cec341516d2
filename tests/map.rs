//! What the README says of the code is true.

use std::path::Path;

fn readme() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap()
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
        assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(path).exists(), "{path}");
    }
}

/// Every folder and file of the two crates stands in the map.
#[test]
fn the_map_names_every_room() {
    let text = readme();
    let map = text.split("## Map of the code").nth(1).unwrap().split("\n## ").next().unwrap();
    for root in ["kernels/src", "src"] {
        for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(root)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let room = name.trim_end_matches(".rs");
            assert!(["lib", "main"].contains(&room) || map.contains(room), "{root}/{name} is not in the map");
        }
    }
}

/// The commands that the README shows are the ones the checks run.
#[test]
fn the_test_command_stands_alone_on_a_line() {
    assert!(readme().lines().any(|line| line == "cargo test --workspace"));
}
