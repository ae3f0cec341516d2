//! Studies for all methods: speed against accuracy, as a user sees them.

use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
#[cfg(unix)]
use std::time::Duration;

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(arguments).stdin(Stdio::null());
    command
}

fn study(scene: &Path, out: &Path, more: &[&str]) -> Output {
    let paths = ["chart", "work-precision", scene.to_str().unwrap(), "--out", out.to_str().unwrap()];
    command(&[&paths[..], &["--json"], more].concat()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Two discs that are pressed together for the whole time: forces without a kink.
const PRESSED: &str = include_str!("pressed.toml");

fn pressed(folder: &Path) -> std::path::PathBuf {
    let scene = folder.join("pressed.toml");
    fs::write(&scene, PRESSED).unwrap();
    scene
}

#[cfg(unix)]
#[test]
fn interrupted_study_resumes_only_with_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (pressed(folder.path()), folder.path().join("study"));
    let journal = out.join("journal.jsonl");
    let arguments =
        ["chart", "work-precision", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--budget", "3"];
    let mut child = command(&arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let lines = || fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
    while lines() < 20 {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it was interrupted");
        std::thread::sleep(Duration::from_millis(5));
    }
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    assert!(!out.join("host").exists());
    let kept = lines();
    let gone_on = command(&arguments).output().unwrap();
    assert!(gone_on.status.success() && said(&gone_on).contains("resuming with"), "{}", said(&gone_on));
    assert!(lines() > kept && out.join("host/work-precision/orders.csv").exists());

    let before = fs::read(&journal).unwrap();
    for more in [&["--set", "law.stiffness=90"][..], &["--repeats", "5"], &["--machine", "cray-1"]] {
        let refused = study(&scene, &out, &[&["--budget", "3"], more].concat());
        assert_eq!(refused.status.code(), Some(2), "{more:?}: {}", said(&refused));
        assert!(said(&refused).contains("journal.jsonl") && said(&refused).contains("choose another --out"));
    }
    assert_eq!(fs::read(&journal).unwrap(), before);
}

#[test]
fn studies_without_result_report_their_trials() {
    let folder = tempfile::tempdir().unwrap();
    let scene = pressed(folder.path());
    let refused = |more: &[&str], code: i32, words: &[&str]| {
        let out = folder.path().join("refused");
        let output = study(&scene, &out, more);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {said}");
        assert!(words.iter().all(|word| said.contains(word)), "{more:?}: {said}");
        let data: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(data["error"]["message"].is_string());
        let _ = fs::remove_dir_all(out);
    };
    refused(&["--set", "run.time=0.01"], 4, &["ends after 5 steps", "run.thermo_every"]);
    let soft = ["--set", "law.stiffness=1e-6", "--set", "run.time=5"];
    refused(&soft, 4, &["tried:", "overlap", "step 0.002", "step 2.5e-4"]);
    refused(&["--set", "law.friction=-1"], 3, &["law.friction"]);
    refused(&["--budget", "0"], 2, &["1..=86400"]);
    refused(&["--repeats", "101"], 2, &["1..=100"]);
    refused(&["--machine", "cray-9"], 2, &["cray-9", "cray-1"]);
}

/// Trajectories of shaken grains diverge at once: the command names a chart that can be made.
#[test]
fn chaotic_scenes_are_referred_to_accuracy_charts() {
    let folder = tempfile::tempdir().unwrap();
    let refused = study(Path::new("shaken-box"), &folder.path().join("study"), &["--budget", "5"]);
    let said = said(&refused);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("positions of shaken-box cannot be compared: trajectories diverge"), "{said}");
    assert!(said.contains("stripmine chart accuracy shaken-box --of temperature"), "{said}");
}

/// A case in the format that the program sends to a measuring process.
fn case(events: u64, discs: u64) -> Value {
    let overrides = [format!("particles.count={discs}")];
    let amount = [0, events];
    let scene = serde_json::json!({
        "preset": "hard-disks", "overrides": overrides, "in_events": true, "amount": amount, "seconds": 0.0
    });
    serde_json::json!([{ "Scene": scene }, null])
}

/// A measuring process prints a line for each case, and ends at the first failure with its exit code.
#[test]
fn a_process_measures_the_cases_of_its_input() {
    let mut child = command(&["measure-cases", "--quiet"]);
    let pipes = child.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = pipes.spawn().unwrap();
    let mut asked = child.stdin.take().unwrap();
    let cases = serde_json::json!([case(100, 20), case(200, 20), case(100, 0)]);
    writeln!(asked, "{cases}").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    let lines = String::from_utf8(output.stdout.clone()).unwrap();
    let works: Vec<f64> = lines
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap()["work"].as_f64().unwrap())
        .collect();
    assert_eq!(works, [100.0, 200.0]);
    assert!(said(&output).starts_with("error: "), "{}", said(&output));
}

/// A measuring process ends at once when the program that started it is gone.
#[test]
fn a_measuring_process_ends_with_its_program() {
    let mut child = command(&["measure-cases", "--quiet"]);
    let mut child =
        child.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    writeln!(child.stdin.as_mut().unwrap(), "{}", serde_json::json!([case(1 << 50, 1000)])).unwrap();
    assert!(child.try_wait().unwrap().is_none());
    drop(child.stdin.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(130), 0), "{}", said(&output));
}
