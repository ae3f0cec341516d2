//! A run is looked at without another program.

use std::fs;
use std::process::{Command, Output, Stdio};

fn stripmine(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(arguments).stdin(Stdio::null()).output().unwrap()
}

/// The terminal has a line for each quantity that changes; what cannot be drawn is refused with what can.
#[test]
fn runs_are_seen_in_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("two-discs");
    let (run, plots) = (run.to_str().unwrap(), folder.path().join("pictures"));
    let short = ["--set", "run.steps=4000", "--set", "run.thermo_every=100", "--out", run];
    assert!(stripmine(&[&["run", "two-discs", "--quiet"][..], &short].concat()).status.success());
    let drawn = stripmine(&["plot", run, "--out", plots.to_str().unwrap()]);
    let text = String::from_utf8_lossy(&drawn.stdout).into_owned();
    assert!(text.contains("kinetic") && text.contains('█') && text.contains('▁'), "{text}");
    for file in fs::read_dir(&plots).unwrap().map(|file| file.unwrap().path()) {
        let is_svg = file.extension().is_some_and(|kind| kind == "svg");
        let svg = if is_svg { fs::read_to_string(&file).unwrap() } else { continue };
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{}", file.display());
    }
    let some = stripmine(&["plot", run, "--columns", "kinetic,elastik", "--out", "/dev/null/x"]);
    let said = String::from_utf8_lossy(&some.stderr).into_owned();
    assert!(some.status.code() == Some(2) && said.contains("elastik") && said.contains("elastic"), "{said}");
    assert_eq!(stripmine(&["plot", folder.path().join("none").to_str().unwrap()]).status.code(), Some(5));
}

/// What a run wrote may have been changed: whatever stands there, pictures or an exit code, never a panic.
#[test]
fn a_run_that_was_changed_is_drawn_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("two-discs");
    let short = ["--set", "run.steps=40", "--set", "run.thermo_every=10", "--set", "run.snapshot_every=20"];
    let begun =
        stripmine(&[&["run", "two-discs", "--quiet", "--out", run.to_str().unwrap()][..], &short].concat());
    assert!(begun.status.success());
    let [table, frames] =
        ["thermo.csv", "trajectory.xyz"].map(|name| fs::read_to_string(run.join(name)).unwrap());
    let radius = frames.lines().nth(2).unwrap().split(' ').nth(8).unwrap().to_owned();
    let second = table.lines().nth(2).unwrap().to_owned();
    let number = second.split(',').nth(2).unwrap();
    let table_with = |value: &str| table.replace(&second, &second.replacen(number, value, 1));
    let frames_with = |value: &str| frames.replace(&format!(" {radius} "), &format!(" {value} "));
    let cases = [
        ("radius 1e300", table.clone(), frames_with("1e300"), 0),
        ("radius 1e-300", table.clone(), frames_with("1e-300"), 0),
        ("radius 1e9", table.clone(), frames_with("1e9"), 0),
        (
            "places 1e300",
            table.clone(),
            frames.replace("Si ", "Si 1e300 ").replace(":1:velo", ":1:x:R:1:velo"),
            0,
        ),
        (
            "a box of 1e300",
            table.clone(),
            frames.replacen("Lattice=\"", "Lattice=\"1e300 0 0 0 1e-300 0 0 0 1\" was=\"", 9),
            0,
        ),
        ("no frames", table.clone(), String::new(), 0),
        ("no number", table_with("nan"), frames.clone(), 3),
        ("infinite", table_with("inf"), frames.clone(), 3),
        ("enormous", table_with("1.7e308"), frames.clone(), 0),
        ("both ways enormous", table_with("-1.7e308").replacen(number, "1.7e308", 1), frames.clone(), 0),
        ("a word", table_with("x"), frames.clone(), 3),
        ("a heading only", table.lines().next().unwrap().to_owned() + "\n", frames.clone(), 3),
        ("nothing", String::new(), frames.clone(), 3),
        ("columns out of the folder", table.replacen("kinetic", "../../kinetic", 1), frames.clone(), 0),
        ("columns of one name", table.replacen("kinetic", "elastic", 1), frames.clone(), 0),
    ];
    for (what, table, frames, code) in cases {
        fs::write(run.join("thermo.csv"), table).unwrap();
        fs::write(run.join("trajectory.xyz"), frames).unwrap();
        let out = folder.path().join(what);
        let drawn = stripmine(&["plot", run.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        let said = String::from_utf8_lossy(&drawn.stderr).into_owned();
        assert_eq!(drawn.status.code(), Some(code), "{what}: {said}");
        assert!(!said.contains("panicked"), "{what}: {said}");
    }
    assert!(
        fs::read_dir(folder.path()).unwrap().all(|it| !it
            .unwrap()
            .file_name()
            .to_str()
            .unwrap()
            .contains("kinetic"))
    );
}

/// The folder of a run by the name of its scene.
#[test]
fn a_run_is_found_by_the_name_of_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let stripmine = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
        command.args(arguments).current_dir(folder.path()).stdin(Stdio::null()).output().unwrap()
    };
    let short = ["--set", "run.steps=20", "--set", "run.thermo_every=5"];
    assert!(stripmine(&[&["run", "two-discs", "--quiet"][..], &short].concat()).status.success());
    assert!(stripmine(&["plot", "two-discs"]).status.success());
    assert!(folder.path().join("two-discs.plots/last-state.png").exists());
}
