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

/// By hand, for five values of three coordinates: 15 values are loaded and 12 stored, each sum is a flop; three products become velocities. A place of
/// the mask loads two positions. The index is scattered as numbers of four bytes.
#[test]
fn sections_have_flops_and_bytes() {
    let set = ["--set", "particles.count=40", "--set", "search.by=lattice"];
    let out = stripmine(&[&["scene", "programs", "bench", "--json"][..], &set].concat()).success();
    let data: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    let rows = data["operations"].as_array().unwrap();
    let of = |section: &str| {
        let row = rows.iter().find(|row| row["section"] == section).unwrap();
        [&row["flops"], &row["bytes"]].map(|it| it.as_u64().unwrap())
    };
    assert_eq!(of("expansion"), [30, 8 * (15 + 12)]);
    assert_eq!(of("velocities"), [3, 8 * 3]);
    assert_eq!(of("distance")[1], 8 * 2 * 24);
    assert_eq!(of("scatter")[1], 4);
    let expansion = rows.iter().find(|row| row["section"] == "expansion").unwrap();
    assert!((expansion["flop_a_byte"].as_f64().unwrap() - 30.0 / 216.0).abs() < 1e-12);
    let out = stripmine(&[&["scene", "programs", "bench", "--csv"][..], &set].concat()).success();
    let text = String::from_utf8(out.get_output().stdout.clone()).unwrap();
    let mut lines = text.lines();
    assert!(lines.next().unwrap().ends_with("flops,bytes,flop_a_byte"), "{text}");
    assert!(lines.next().unwrap().starts_with("predictor,expansion,NP,42,57,30,0,30,216,"), "{text}");
    assert_eq!(text.lines().count(), rows.len() + 1);
}

/// Every part of a scene is run in every execution; its sums are those of the scene's counts.
#[test]
fn scenes_are_timed_beside_the_host_model() {
    let set = ["--set", "particles.count=40", "--set", "search.by=lattice"];
    let out = stripmine(&[&["table", "bench", "--host", "--json", "--quiet"][..], &set].concat()).success();
    let data: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    let rows = data["host"].as_array().unwrap();
    assert_eq!(rows.len(), 3 * 8);
    for row in rows {
        assert!(row["measured"].as_f64().unwrap() > 0.0 && row["predicted"].as_f64().unwrap() > 0.0, "{row}");
    }
    // 63 operations and 33 flops a disc; whole rows of a hexagonal lattice hold 42.
    let predictor = &rows[0];
    assert_eq!(predictor["part"], "predictor 1");
    assert!((predictor["nop_n"].as_f64().unwrap() - 63.0 * 42.0 * 1e-6).abs() < 1e-12, "{predictor}");
    assert!((predictor["mflop"].as_f64().unwrap() - 33.0 * 42.0 * 1e-6).abs() < 1e-12, "{predictor}");
    for (arguments, said) in [
        (&["table", "--host"][..], "<TIMED>"),
        (&["table", "bench"][..], "--host"),
        (&["table", "hard-disks", "--host", "--quiet"][..], "no vector programs"),
        (&["table", "bench", "--host=none.toml", "--quiet"][..], "none.toml"),
    ] {
        let out = stripmine(arguments).failure();
        let text = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
        assert!(text.contains(said), "{said} is not in: {text}");
    }
}

#[test]
fn machines_state_fused_products_and_single_lanes() {
    let folder = tempfile::tempdir().unwrap();
    let mine = MACHINE.replace(
        "[start_up]",
        "fma = { value = true, provenance = \"assumed\", note = \"a test\" }\n\
         lanes_32 = { value = 2, provenance = \"assumed\", note = \"a test\" }\n[start_up]",
    );
    let path = file(&folder, &mine);
    let out = stripmine(&["table", "--ladder", "--machine", &path, "--json"]).success();
    let data: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    let gains = &data["gains"][0];
    assert_eq!(gains["has_them"], "fma, lanes of 32 bits");
    // Start-ups are negligible on lattices of 4,000 cells, so that two lanes take nearly half of the time.
    assert!((1.9..2.0).contains(&gains["gain_by_two_lanes_of_32_bits"].as_f64().unwrap()), "{gains}");
    assert!((1.05..1.5).contains(&gains["gain_by_fma"].as_f64().unwrap()), "{gains}");
    let wrong = file(&folder, &mine.replace("lanes_32 = { value = 2,", "lanes_32 = { value = 1.5,"));
    let out = stripmine(&["table", "--machine", &wrong]).code(3);
    let text = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
    assert!(text.contains("`lanes_32.value` is 1.5") || text.contains("`lanes_32` is 1.5"), "{text}");
}
