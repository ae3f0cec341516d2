//! Signals: every interrupted or terminated verb ends with exit code 130 and leaves no partial files.
#![cfg(unix)]

use assert_cmd::cargo::CommandCargoExt;
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

/// Starts a command and waits until its signal handlers are installed.
fn begun(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder).args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    wait_for_handlers(child.id());
    child
}

/// Waits a fixed time on systems that do not report the caught signals.
fn wait_for_handlers(process: u32) {
    const INTERRUPT: u64 = 1 << 1;
    let status = Path::new("/proc").join(process.to_string()).join("status");
    if !cfg!(target_os = "linux") {
        return std::thread::sleep(Duration::from_millis(500));
    }
    loop {
        let text = std::fs::read_to_string(&status).unwrap();
        let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap().trim();
        if u64::from_str_radix(caught, 16).unwrap() & INTERRUPT != 0 {
            return;
        }
        std::thread::yield_now();
    }
}

fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A run that is interrupted while it places, checks or starts ends before it has written anything.
#[test]
fn interrupted_starts_leave_no_files() {
    let folder = tempfile::tempdir().unwrap();
    for (signal, moment) in [("-INT", 100), ("-TERM", 100), ("-INT", 700)] {
        let many = ["--set", "particles.count=2000000"];
        let child = begun(folder.path(), &[&["run", "dense-gas", "--out", "run"][..], &many].concat());
        std::thread::sleep(Duration::from_millis(moment));
        send(signal, &child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{}", said(&output));
        assert!(said(&output).contains("interrupted") && output.stdout.is_empty());
        assert!(!folder.path().join("run").exists(), "{signal} after {moment} ms");
    }
}

/// Interrupted measurements end with a message, and print nothing that looks like a result.
#[test]
fn measurements_end_without_a_result() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["bench", "lattice", "--particles", "100000"][..],
        &["bench", "neighbor-list", "--execution", "chained", "--particles", "100000"],
        &["calibrate", "--out", "host.toml"],
        &["validate-model"],
        &["validate-model", "--calibrate"],
        &["chart", "density-cost"],
        &["reproduce", "--only", "precision", "--out", "pages"],
        &["scene", "check", "dense-gas", "--set", "particles.count=2000000"],
    ] {
        for (signal, as_data) in [("-TERM", &[][..]), ("-INT", &["--json"])] {
            let child = begun(folder.path(), &[arguments, as_data].concat());
            std::thread::sleep(Duration::from_millis(50));
            send(signal, &child);
            let output = child.wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(130), "{arguments:?}: {}", said(&output));
            assert!(said(&output).contains("error: interrupted"), "{arguments:?}: {}", said(&output));
            if as_data.is_empty() {
                assert!(output.stdout.is_empty(), "{arguments:?}");
            } else {
                let data: Value = serde_json::from_slice(&output.stdout).unwrap();
                assert_eq!(data["error"]["kind"], "interrupted", "{arguments:?}");
            }
        }
        assert!(!folder.path().join("host.toml").exists());
    }
}

/// Interrupted at any moment, `reproduce` leaves the finished items whole, and pages that show them.
#[test]
fn finished_items_are_kept_whole() {
    let folder = tempfile::tempdir().unwrap();
    let items = ["table", "ladder", "listing", "mask"];
    for moment in 0..8 {
        let out = folder.path().join(moment.to_string());
        let only: Vec<&str> = items.iter().flat_map(|item| ["--only", item]).collect();
        let path = out.to_str().unwrap().to_owned();
        let child = begun(folder.path(), &[&["reproduce", "--out", &path][..], &only].concat());
        while !out.join("table").exists() {
            std::thread::yield_now();
        }
        std::thread::sleep(Duration::from_millis(40 * moment));
        send("-INT", &child);
        let output = child.wait_with_output().unwrap();
        assert!(matches!(output.status.code(), Some(130 | 0)), "{}", said(&output));
        let page = std::fs::read_to_string(out.join("README.md")).unwrap();
        assert!(out.join("index.html").exists());
        for entry in std::fs::read_dir(&out).unwrap() {
            let entry = entry.unwrap().path();
            if entry.is_dir() {
                let name = entry.file_name().unwrap().to_str().unwrap();
                assert!(items.contains(&name), "{name}");
                assert!(entry.join("provenance.json").exists(), "{name}");
                assert!(page.contains(&format!("]({name}/)")), "{name} is not on the page");
            }
        }
    }
}

/// A run started with an ignored hangup survives it.
#[test]
fn an_ignored_hangup_stays_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let program = assert_cmd::cargo::cargo_bin("stripmine");
    let line = "trap '' HUP; exec \"$0\" run pipe-small --out run --quiet --set run.steps=3000";
    let mut shell = Command::new("sh");
    shell.current_dir(folder.path()).args(["-c", line]).arg(program).stdout(Stdio::null());
    let mut child = shell.spawn().unwrap();
    while !folder.path().join("run/thermo.csv").exists() {
        std::thread::yield_now();
    }
    send("-HUP", &child);
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(folder.path().join("run/summary.json").exists());
}
