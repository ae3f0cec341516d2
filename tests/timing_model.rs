//! The timing model on the command line: machine files of users, bad files, and requests beyond the calibrated range.

use assert_cmd::Command;

fn stripmine(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("stripmine").unwrap().args(arguments).assert()
}

fn file(folder: &tempfile::TempDir, text: &str) -> String {
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

const MACHINE: &str = r#"format = 1
title = "Mine"
year = { value = 2026, provenance = "assumed", note = "a test" }
clock_period_ns = { value = 1, provenance = "assumed", note = "a test" }
[start_up]
default = { value = 20, provenance = "assumed", note = "a test" }
"#;

#[test]
fn user_machine_files_are_used_by_every_clock() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, MACHINE);
    let out = stripmine(&["table", "--ladder", "--machine", &path, "--json"]).success();
    let data: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    assert_eq!(data["machines"][0]["machine"], "Mine");
    assert_eq!(data["ladder"].as_array().unwrap().len(), 7);
    assert!(data["machines"][0]["share_of_the_last_rung_from_assumed_start_ups"].as_f64().unwrap() > 0.0);
}

#[test]
fn bad_machine_files_are_reported_with_their_location() {
    let folder = tempfile::tempdir().unwrap();
    for (old, new, said) in [
        ("value = 20", "value = -20", "mine.toml:6:21: `start_up.default` is -20"),
        ("default =", "subtract =", "`subtract` is not a class of operations"),
        ("year = ", "jahr = ", "unknown field `jahr`"),
        ("title = \"Mine\"\n", "", "missing field `title`"),
    ] {
        let path = file(&folder, &MACHINE.replace(old, new));
        let out = stripmine(&["table", "--machine", &path]).code(3);
        let complaint = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
        assert!(complaint.contains(said) && complaint.contains("mine.toml:"), "{complaint}");
    }
}

#[test]
fn all_wrong_values_of_machine_files_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        MACHINE.replace("value = 20,", "value = -20,").replace("2026", "2026.5").replace("\"Mine\"", "7");
    let path = file(&folder, &text);
    let out = stripmine(&["table", "--machine", &path]).code(3);
    let complaint = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
    for said in [
        "mine.toml:2:9: `title`: invalid type: integer `7`\n  expected: a string",
        "mine.toml:3:18: `year` is 2026.5\n  expected: a whole number",
        "mine.toml:6:21: `start_up.default` is -20",
    ] {
        assert!(complaint.contains(said), "{said}: {complaint}");
    }
}

#[test]
fn wrong_whole_registers_are_reported_with_their_location() {
    let folder = tempfile::tempdir().unwrap();
    let measured = MACHINE.split("[start_up]").next().unwrap().to_owned()
        + r#"[whole_registers]
vlen = { value = 256, provenance = "assumed", note = "a test" }
group = { value = 4, provenance = "assumed", note = "a test" }
[whole_registers.periods]
add = { value = [1, 2, 4, 8], provenance = "assumed", note = "a test" }
"#;
    let ladder = |text: &str| stripmine(&["table", "--ladder", "--machine", &file(&folder, text), "--json"]);
    let out = ladder(&measured).success();
    let data: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    assert_eq!(data["machines"][0]["machine"], "Mine");
    for (old, new, said) in [
        ("value = 4,", "value = 3,", "mine.toml:7:1: `whole_registers.group` is 3"),
        ("value = 256", "value = 100", "mine.toml:6:1: `whole_registers.vlen` is 100"),
        ("value = 256", "value = -64", "`whole_registers.vlen` is -64"),
        ("[1, 2, 4, 8]", "[1, 2, 4]", "mine.toml:9:"),
        ("[1, 2, 4, 8]", "[1, 2, 4, 0]", "`whole_registers.periods.add` is 0"),
        ("add =", "plus =", "`plus` is not a class of operations"),
    ] {
        assert!(measured.contains(old), "{old}");
        let out = ladder(&measured.replace(old, new)).code(3);
        let complaint = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
        assert!(complaint.contains(said) && complaint.contains("mine.toml:"), "{said}: {complaint}");
    }
}

#[test]
fn unknown_machine_lists_the_known_ones() {
    stripmine(&["table", "--machine", "eniac"]).code(2);
    stripmine(&["table", "--machine", "eniac.toml"]).code(5);
}

#[test]
fn no_prediction_beyond_the_calibrated_range() {
    for (arguments, said) in [
        (["--particles", "5000000"], "calibrated range of 8 to 4000000"),
        (["--particles", "200000"], "200000 discs are outside the calibrated range of 60 to 32000"),
    ] {
        let out = stripmine(&[&["validate-model"][..], &arguments].concat()).code(4);
        let complaint = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
        assert!(complaint.contains(said), "{complaint}");
    }
    stripmine(&["validate-model", "--calibrate", "--host", "host.toml"]).code(2);
}

#[test]
fn shipped_host_model_is_named_when_used() {
    let out = stripmine(&["validate-model", "--particles", "5000000"]).code(4);
    assert!(String::from_utf8_lossy(&out.get_output().stderr).contains("shipped with the program"));
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "format = 3\n");
    let out = stripmine(&["validate-model", "--host", &path]).code(3);
    assert!(String::from_utf8_lossy(&out.get_output().stderr).contains("`format` is 3\n"));
}
