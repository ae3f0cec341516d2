//! Maps of stability, warnings of runs, and forecasts before them, as a user sees them.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn stripmine(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn succeeds(output: &Output) -> Value {
    assert!(output.status.success(), "{}", said(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn map(scene: &str, out: &Path, more: &[&str]) -> Output {
    let begin = ["chart", "stability", scene, "--json", "--out", out.to_str().unwrap()];
    let size = if more.contains(&"--size") { &[][..] } else { &["--size", "6"] };
    // A budget for the whole scene: the extent of a map must not depend on the momentary speed of the machine.
    let rest = ["--seeds", "2", "--tolerance", "0.2", "--budget", "3000"];
    stripmine(&[&begin[..], size, &rest, more].concat())
}

fn classes(data: &Value) -> Vec<&str> {
    data["cells"].as_array().unwrap().iter().map(|cell| cell["class"].as_str().unwrap()).collect()
}

/// A scene of two discs that fly side by side and never collide.
fn apart(folder: &Path) -> PathBuf {
    let text = r#"format = 2
units = "reduced"
[method]
kind = "lattice-md"
[domain]
sides = [12.0, 8.0]
[particles]
generate = "list"
positions = [[3.0, 2.0], [3.0, 6.0]]
velocities = [[0.2, 0.0], [0.2, 0.0]]
radius = 0.5
mass = 1.0
[law]
stiffness = 100.0
[integrator]
dt = 2e-3
[run]
time = 4.0
thermo_every = 10
"#;
    let path = folder.join("apart.toml");
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn stable_scenes_show_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    let scene = apart(folder.path());
    let data = succeeds(&map(scene.to_str().unwrap(), &folder.path().join("map"), &[]));
    assert!(classes(&data).iter().all(|class| *class == "works"), "{data}");
    for edge in data["edges"].as_array().unwrap() {
        assert!(edge["smallest_step_that_does_not"].is_null(), "{edge}");
    }
    for scheme in data["integrators"].as_array().unwrap() {
        assert_eq!(scheme["edge_of_works"], "above the map", "{scheme}");
    }
}

/// The edge of stability agrees with theory within a factor: contacts are not springs, and accuracy may end sooner. Without friction, whose drag
/// needs
/// more than a single contact to amplify errors.
#[test]
fn stability_edge_agrees_with_theory() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("map");
    let over = ["--over", "damping", "--set", "run.time=3.2", "--set", "law.friction=0"];
    let data = succeeds(&map("two-discs", &out, &over));
    let found = classes(&data);
    assert!(found.contains(&"works") && found.contains(&"mask outrun"), "{found:?}");
    assert!(found.contains(&"energy growth") || found.contains(&"wrong but silent"), "{found:?}");
    for scheme in data["integrators"].as_array().unwrap() {
        let works = scheme["works_up_to_own_steps"].as_f64().unwrap();
        let theory = scheme["theory_errors_grow_beyond_own_steps"].as_f64().unwrap();
        assert!(works < 2.5 * theory && works > 0.2 * theory, "{scheme}");
    }
    let cells = fs::read_to_string(out.join("host/stability/cells.csv")).unwrap();
    assert_eq!(cells.lines().count(), 37);
    for file in ["edges.csv", "two_discs_stability.svg", "maps.csv"] {
        assert!(out.join("host/stability").join(file).exists(), "{file}");
    }
    // A finished study is only read again.
    let again = map("two-discs", &out, &over);
    assert!(said(&again).contains("resuming with") && succeeds(&again) == data);
}

#[test]
fn impossible_maps_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = apart(folder.path());
    let refused = |more: &[&str], code: i32, words: &[&str]| {
        let out = folder.path().join("refused");
        let output = map(scene.to_str().unwrap(), &out, more);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {said}");
        assert!(words.iter().all(|word| said.contains(word)), "{more:?}: {said}");
        let _ = fs::remove_dir_all(out);
    };
    refused(&["--over", "colour"], 2, &["colour", "stiffness, damping"]);
    refused(&["--over", "damping"], 2, &["does not set damping", "--range"]);
    refused(&["--range", "5", "1"], 2, &["--range 5 1", "rising"]);
    refused(&["--range", "0", "1"], 2, &["--range 0 1"]);
    refused(&["--over", "size-ratio", "--range", "0.5", "2"], 2, &["size-ratio", "from 1 to"]);
    refused(&["--tolerance", "0"], 2, &["tolerance"]);
    let other = folder.path().join("other");
    assert!(map(scene.to_str().unwrap(), &other, &[]).status.success());
    let output = map(scene.to_str().unwrap(), &other, &["--range", "1", "2"]);
    assert!(
        output.status.code() == Some(2) && said(&output).contains("choose another --out"),
        "{}",
        said(&output)
    );
}

/// Without `--over` the first parameter is varied for which the scene has a value; a method without steps is refused, as the help states.
#[test]
fn every_method_with_steps_has_a_map() {
    let folder = tempfile::tempdir().unwrap();
    let small = ["particles.count=64", "domain.sides=[10.0, 10.0]", "run.time=1"];
    let small: Vec<&str> = small.iter().flat_map(|set| ["--set", set]).collect();
    for (scene, more, parameter) in [
        ("langevin-dense", &small[..], "strength"),
        ("kepler", &["--set", "run.time=6.28"], "eccentricity"),
        ("two-discs", &["--set", "run.time=0.5"], "stiffness"),
    ] {
        let data = succeeds(&map(scene, &folder.path().join(scene), &[&["--size", "3"], more].concat()));
        assert_eq!(data["maps"][0]["parameter"], parameter);
    }
    let hard = map("hard-disks", &folder.path().join("hard"), &[]);
    assert_eq!(hard.status.code(), Some(2));
    assert!(said(&hard).contains("hard-disks take no time steps"), "{}", said(&hard));
    let help = stripmine(&["chart", "stability", "--help"]);
    assert!(String::from_utf8_lossy(&help.stdout).contains("Scenes of hard-disks have no time step"));
}

/// Discs so soft that they pass through each other at any step.
#[test]
fn scenes_that_always_fail_report_the_trials() {
    let folder = tempfile::tempdir().unwrap();
    let output = map("two-discs", &folder.path().join("map"), &["--range", "1e-6", "1e-5"]);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(
        said.contains("tried:") && said.contains("stiffness = 1e-6, step 5e-4") && said.contains("overlap"),
        "{said}"
    );
}

fn run(scene: &str, folder: &Path, more: &[&str]) -> Value {
    let out = folder.join("run");
    let begin = ["run", scene, "--json", "--quiet", "--overwrite", "--out", out.to_str().unwrap()];
    succeeds(&stripmine(&[&begin[..], more].concat()))
}

fn checks(summary: &Value) -> Vec<&str> {
    summary["checks"].as_array().unwrap().iter().map(|check| check["check"].as_str().unwrap()).collect()
}

#[test]
fn runs_report_failed_checks_only() {
    let folder = tempfile::tempdir().unwrap();
    let of = |scene: &str, more: &[&str]| run(scene, folder.path(), more);
    assert_eq!(checks(&of("two-discs", &[])), [] as [&str; 0]);
    let coarse = of("two-discs", &["--set", "integrator.dt=0.018"]);
    assert_eq!(checks(&coarse), ["energy-balance"], "{coarse}");
    let check =
        coarse["checks"].as_array().unwrap().iter().find(|check| check["check"] == "energy-balance").unwrap();
    let (off, limit) = (check["value"].as_f64().unwrap(), check["limit"].as_f64().unwrap());
    assert!(off.abs() > limit && (limit - 0.0667).abs() < 1e-4, "{check}");
    let warnings = coarse["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|text| text == &check["message"]), "{warnings:?}");
    // Steps so small that single precision rounds them away.
    let small = ["machine.precision=f32", "particles.count=64", "run.steps=100", "integrator.dt=3e-7"];
    let small: Vec<&str> = small.iter().flat_map(|set| ["--set", set]).collect();
    assert!(checks(&of("dense-gas", &small)).contains(&"rounding"));
    // Discs at rest have no motion to lose.
    let still = apart(folder.path());
    let still = still.to_str().unwrap();
    let sets = ["particles.velocities=[[0.0, 0.0], [0.0, 0.0]]", "machine.precision=f32"];
    let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
    assert_eq!(checks(&of(still, &sets)), [] as [&str; 0]);
}

/// Checks are part of the checkpoint: a resumed run reports the same as a run in one piece.
#[test]
fn resumed_runs_report_the_same_checks() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = |out: &Path, steps: &str, more: &[&str]| {
        let steps = format!("run.steps={steps}");
        let out = out.to_str().unwrap().to_owned();
        let begin = [
            "run",
            "dense-gas",
            "--json",
            "--quiet",
            "--set",
            "particles.count=64",
            "--set",
            "integrator.dt=0.06",
        ];
        let all: Vec<&str> = begin
            .iter()
            .copied()
            .chain(["--set", steps.as_str(), "--out", out.as_str()])
            .chain(more.iter().copied())
            .collect();
        succeeds(&stripmine(&all))
    };
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    let whole = arguments(&whole, "2000", &[]);
    arguments(&parts, "700", &[]);
    let resumed = arguments(&parts, "2000", &["--resume"]);
    assert!(!checks(&whole).is_empty());
    assert_eq!(whole["checks"], resumed["checks"]);
}

#[test]
fn scene_check_forecasts_limits_and_errors() {
    let facts = succeeds(&stripmine(&["scene", "check", "pipe-small", "--json"]));
    let limits = facts["step_limits"].as_array().unwrap();
    let share =
        |name: &str| limits.iter().find(|limit| limit["name"] == name).unwrap()["share"].as_f64().unwrap();
    // Six values are unstable in the dense plug of this pipe, four are stable.
    assert!(
        share("dense packing") < 1.0 && share("dense packing") > 0.3 && share("mask") < 0.1,
        "{limits:?}"
    );
    let six =
        succeeds(&stripmine(&["scene", "check", "pipe-small", "--json", "--set", "integrator.values=6"]));
    let dense = six["step_limits"]
        .as_array()
        .unwrap()
        .iter()
        .find(|limit| limit["name"] == "dense packing")
        .unwrap()
        .clone();
    assert!(dense["share"].as_f64().unwrap() > 1.0 && dense["beyond"] == "unstable", "{dense}");
    let error = &facts["expected_error"];
    assert!(
        error["energy"].as_f64().unwrap() < 0.1 && (error["order"].as_f64().unwrap() - 1.0).abs() < 0.3,
        "{error}"
    );
    assert!(facts["expected_time"]["seconds"].as_f64().unwrap() > 0.0);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let output = stripmine(&["run", "two-discs", "--set", "run.steps=100", "--out", out.to_str().unwrap()]);
    let text = said(&output);
    for word in
        ["expected: drag of friction: dt is", "expected: error of a contact", "expected: time of a run"]
    {
        assert!(text.contains(word), "{text}");
    }
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert!(
        summary["foreseen"]["step_limits"].is_array() && summary["foreseen"]["expected_error"].is_object()
    );
}
