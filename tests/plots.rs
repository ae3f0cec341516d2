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
    assert!(some.status.code() == Some(5) && said.contains("elastik") && said.contains("elastic"), "{said}");
    assert_eq!(stripmine(&["plot", folder.path().join("none").to_str().unwrap()]).status.code(), Some(5));
}
