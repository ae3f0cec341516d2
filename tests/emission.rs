//! Code for a vector processor, and kernels of a user, from the command line: listings, folders, prices, and what is refused.

use assert_cmd::Command;
use std::fs;
use std::path::Path;

fn stripmine(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder).args(arguments).output().unwrap()
}

fn printed(folder: &Path, arguments: &[&str]) -> String {
    let output = stripmine(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The root of x² + y², as the Python package traces it.
const LENGTH: &str = r#"{
    "inputs": ["x", "y"],
    "nodes": [
        {"input": [0, 0]}, {"input": [1, 0]},
        {"binary": ["multiply", 0, 0]}, {"binary": ["multiply", 1, 1]},
        {"binary": ["add", 2, 3]}, {"unary": ["square_root", 4]}
    ],
    "outputs": [["length", 5]]
}"#;

#[test]
fn listings_have_code_with_operations_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let tape = printed(folder.path(), &["listing", "forces", "--json"]);
    let tape: serde_json::Value = serde_json::from_str(&tape).unwrap();
    let operations = tape["instructions"].as_array().unwrap().len();
    for lmul in ["1", "8"] {
        let code = printed(folder.path(), &["listing", "forces", "--isa", "rvv", "--lmul", lmul]);
        // Every operation stands once beside its first instruction.
        let beside = code.lines().filter(|line| line.starts_with("    ") && line.contains('#')).count();
        assert_eq!(beside, operations, "LMUL {lmul}");
        for words in ["# normal force", "vfsqrt.v", "Expansion table", "vmerge.vvm"] {
            assert!(code.contains(words), "{words}");
        }
    }
    let law = printed(folder.path(), &["scene", "programs", "langevin-dense", "--isa", "rvv"]);
    assert!(law.contains("vfmul") && law.contains("# forces"), "{law}");
}

#[test]
fn folders_of_code_are_complete_and_own() {
    let folder = tempfile::tempdir().unwrap();
    let emit = ["emit", "bench", "--set", "particles.count=40", "--isa", "rvv", "--steps", "2"];
    let to = |out: &'static str| [&emit[..], &["--out", out]].concat();
    let said = printed(folder.path(), &to("code"));
    assert!(said.contains("8 programs"), "{said}");
    let size = |name: &str| fs::metadata(folder.path().join("code").join(name)).unwrap().len();
    assert_eq!(size("arrays.bin"), size("expected.bin"));
    let driver = fs::read_to_string(folder.path().join("code/driver.S")).unwrap();
    assert!(driver.contains("li s0, 2") && driver.contains("call forces_7"), "{driver}");
    // Written again, and refused beside files of others.
    printed(folder.path(), &to("code"));
    fs::create_dir(folder.path().join("other")).unwrap();
    fs::write(folder.path().join("other/notes.txt"), "own").unwrap();
    let refused = stripmine(folder.path(), &to("other"));
    assert!(!refused.status.success());
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(said.contains("other has files") && said.contains("notes.txt"), "{said}");
    assert_eq!(fs::read_dir(folder.path().join("other")).unwrap().count(), 1);
}

#[test]
fn scenes_without_code_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for (scene, set, expected) in [
        ("hard-disks", "particles.count=40", "hard-disks has no vector programs"),
        ("bench", "machine.precision=f32", "program `predictor`: lanes of f32 have no vector code"),
        ("langevin-free", "particles.count=40", "langevin-free has no vector programs"),
    ] {
        let arguments = ["emit", scene, "--set", set, "--isa", "rvv", "--out", "code"];
        let output = stripmine(folder.path(), &arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && said.contains(expected), "{scene}: {said}");
        assert!(!folder.path().join("code").exists(), "{scene}");
    }
}

/// By hand: two loads, two products, a sum, a root and a store.
#[test]
fn kernels_of_a_user_are_priced() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("length.json"), LENGTH).unwrap();
    let arguments = ["price", "length.json", "--machine", "paper", "--elements", "100", "--json"];
    let data: serde_json::Value = serde_json::from_str(&printed(folder.path(), &arguments)).unwrap();
    assert_eq!(data["operations"][0]["operations"], 7);
    let clocks = data["clocks"].as_array().unwrap();
    let of = |name: &str| &clocks.iter().find(|row| row["clock"] == name).unwrap()["clock_periods"];
    assert_eq!(of("paper"), 7.0 * 120.0);
    assert_eq!(of("scalar"), 7.0 * 100.0 * 20.0);
    let code = printed(folder.path(), &["price", "length.json", "--isa", "rvv"]);
    assert!(code.contains("vfsqrt.v"), "{code}");
    assert!(printed(folder.path(), &["price", "length.json"]).contains("SpacemiT A100"));
}

#[test]
fn wrong_kernels_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    for (old, new, expected) in [
        ("\"add\"", "\"plus\"", "k.json:6:"),
        ("[1, 0]", "[2, 0]", "node 1 reads a node or an input that does not exist"),
        ("\"square_root\", 4", "\"square_root\", 9", "node 5 reads"),
        ("\"y\"]", "\"x\"]", "two inputs or outputs are named `x`"),
        ("[[\"length\", 5]]", "[]", "returns nothing"),
        ("}\"#", "", "k.json"),
    ] {
        let text = if LENGTH.contains(old) { LENGTH.replace(old, new) } else { "{".to_owned() };
        fs::write(folder.path().join("k.json"), text).unwrap();
        let output = stripmine(folder.path(), &["price", "k.json"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && said.contains(expected), "{new}: {said}");
    }
    let missing = stripmine(folder.path(), &["price", "none.json"]);
    assert!(String::from_utf8_lossy(&missing.stderr).contains("none.json"));
}
