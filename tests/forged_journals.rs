//! Journals of studies whose lines have valid checksums and impossible values: they are measured again, and nothing panics.

use crc32fast::Hasher;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// Change of a value.
type Forgery<'f> = &'f dyn Fn(&Value) -> Value;

/// Runs a study in a folder; returns its exit code and standard error.
fn study(arguments: &[&str], out: &Path) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(arguments).args(["--quiet", "--out"]).arg(out).stdin(Stdio::null());
    let output = command.output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Copy of a value with each of its numbers, lists, tables and words changed.
fn changed(value: &Value, number: &dyn Fn(f64) -> Value, shorter: bool) -> Value {
    let below = |value: &Value| changed(value, number, shorter);
    match value {
        Value::Number(it) => number(it.as_f64().unwrap()),
        Value::Array(all) => all.iter().skip(usize::from(shorter)).map(below).collect(),
        Value::Object(all) => {
            let all = all.iter().skip(usize::from(shorter && all.len() > 1));
            Value::Object(all.map(|(name, value)| (name.clone(), below(value))).collect())
        }
        _ => value.clone(),
    }
}

/// Copy of a journal with every line's value changed and its checksum updated: CRC-32 of the digest and of the text after the checksum.
fn forged(journal: &str, change: &dyn Fn(&Value) -> Value) -> String {
    let mut lines = journal.lines();
    let heading = lines.next().unwrap();
    let digest = serde_json::from_str::<Value>(heading).unwrap()["digest"].as_str().unwrap().to_owned();
    let forge = |line: &str| {
        let read: Value = serde_json::from_str(line).unwrap();
        let text = format!("\"key\":{},\"value\":{}}}", read["key"], change(&read["value"]));
        let mut sum = Hasher::new();
        sum.update(digest.as_bytes());
        sum.update(text.as_bytes());
        format!("{{\"checksum\":\"{:08x}\",{text}\n", sum.finalize())
    };
    // Checks the format assumed above against a line of the program.
    let first = lines.clone().next().unwrap();
    let same: Value = serde_json::from_str(first).unwrap();
    assert!(first.contains(&format!("\"key\":{}", same["key"])), "{first}");
    format!("{heading}\n") + &lines.map(forge).collect::<String>()
}

#[test]
fn forged_journal_lines_are_measured_again() {
    let folder = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        (
            "work-precision",
            &[
                "chart",
                "work-precision",
                "two-discs",
                "--set",
                "run.time=0.4",
                "--budget",
                "2",
                "--repeats",
                "1",
            ][..],
        ),
        (
            "stability",
            &[
                "chart",
                "stability",
                "two-discs",
                "--set",
                "run.time=0.4",
                "--budget",
                "40",
                "--size",
                "4",
                "--seeds",
                "1",
            ],
        ),
    ] {
        let out = folder.path().join(name);
        let (code, said) = study(arguments, &out);
        assert_eq!(code, Some(0), "{name}: {said}");
        let journal = out.join("journal.jsonl");
        let own = fs::read_to_string(&journal).unwrap();
        let forgeries: [(&str, Forgery); 5] = [
            ("20000001", &|value| changed(value, &|_| json!(20_000_001), false)),
            ("-1", &|value| changed(value, &|_| json!(-1), false)),
            ("1e300", &|value| {
                changed(value, &|it| if it.fract() == 0.0 { json!(it as i64) } else { json!(1e300) }, false)
            }),
            ("shorter", &|value| changed(value, &|it| json!(it), true)),
            ("null", &|_| Value::Null),
        ];
        for (forgery, change) in forgeries {
            fs::write(&journal, forged(&own, change)).unwrap();
            let (code, said) = study(arguments, &out);
            // A forged rate may leave too little time for any run.
            assert!([Some(0), Some(2), Some(4)].contains(&code), "{name}, {forgery}: {code:?} {said}");
            assert!(!said.contains("panicked"), "{name}, {forgery}: {said}");
        }
    }
}
