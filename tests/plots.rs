//! A run is looked at without another program.

use std::fs;
use std::process::{Command, Output, Stdio};

fn stripmine(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(arguments).stdin(Stdio::null()).output().unwrap()
}

/// Runs of every kind of method become pictures; the terminal has a line for each quantity that changes.
#[test]
fn runs_become_pictures() {
    let folder = tempfile::tempdir().unwrap();
    for (scene, [length, every], has_state) in [
        ("two-discs", ["run.steps=4000", "run.thermo_every=100"], true),
        ("hard-disks", ["run.events=2000", "run.thermo_every=0.05"], true),
        ("langevin-free", ["run.steps=200", "run.thermo_every=10"], true),
        ("kepler", ["run.steps=256", "run.thermo_every=16"], true),
        ("plummer", ["run.steps=32", "run.thermo_every=8"], true),
        ("vibrating-floor", ["run.events=4000", "run.thermo_every=0.5"], true),
    ] {
        let run = folder.path().join(scene);
        let (run, plots) = (run.to_str().unwrap(), folder.path().join(format!("{scene}.pictures")));
        assert!(
            stripmine(&["run", scene, "--quiet", "--set", length, "--set", every, "--out", run])
                .status
                .success()
        );
        let drawn = stripmine(&["plot", run, "--out", plots.to_str().unwrap()]);
        let text = String::from_utf8_lossy(&drawn.stdout).into_owned();
        assert!(drawn.status.success(), "{scene}: {}", String::from_utf8_lossy(&drawn.stderr));
        assert!(text.contains("kinetic") && text.contains('█') && text.contains('▁'), "{text}");
        let names: Vec<String> =
            fs::read_dir(&plots).unwrap().map(|it| it.unwrap().file_name().into_string().unwrap()).collect();
        assert_eq!(names.iter().any(|name| name == "last-state.png"), has_state, "{names:?}");
        let pictures = names.iter().filter(|name| name.ends_with(".svg")).count();
        assert!(pictures >= 2 && 2 * pictures == names.len(), "{names:?}");
        for name in names.iter().filter(|name| name.ends_with(".svg")) {
            let svg = fs::read_to_string(plots.join(name)).unwrap();
            assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{name}");
        }
    }
    let run = folder.path().join("two-discs");
    let some =
        stripmine(&["plot", run.to_str().unwrap(), "--columns", "kinetic,elastik", "--out", "/dev/null/x"]);
    let said = String::from_utf8_lossy(&some.stderr).into_owned();
    assert!(some.status.code() == Some(5) && said.contains("elastik") && said.contains("elastic"), "{said}");
    assert_eq!(stripmine(&["plot", folder.path().join("none").to_str().unwrap()]).status.code(), Some(5));
}
