//! The command as a user sees it: data on standard output, everything else on standard error, exit codes.

use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

fn stripmine(arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("stripmine").unwrap().args(arguments).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = stripmine(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The printed column has the counts of the paper, the counted one those of the program, and both clocks are NOP·(n + D).
#[test]
fn table_has_the_printed_counts_and_clocks() {
    let table = json(&["table", "--particles", "2000", "--occupancy", "0.25", "--json"]);
    let rows = |name: &str| table[name].as_array().unwrap();
    let printed = |row: &Value| row["printed_in_1993"].as_u64();
    let source: Vec<u64> = rows("efficiency_table").iter().filter_map(printed).collect();
    assert_eq!(source, [59, 12, 1656, 54, 1781]);
    let step = rows("efficiency_table").last().unwrap();
    let [np, lmax] = ["particles", "lmax"].map(|name| rows("summary")[0][name].as_f64().unwrap());
    assert_eq!(step["clocks_printed"].as_f64().unwrap(), 125.0 * (np + 20.0) + 1656.0 * (lmax + 20.0));
    for (text, sum) in [("printed", "clocks_printed_text"), ("ours", "clocks_ours")] {
        let mut counted = 0.0;
        for row in rows("vector_lengths").iter().filter(|row| row["text"] == text) {
            let clocks = row["nop"].as_f64().unwrap() * (row["n"].as_f64().unwrap() + 20.0);
            assert_eq!(row["clocks"].as_f64().unwrap(), clocks);
            counted += clocks;
        }
        assert_eq!(step[sum].as_f64().unwrap(), counted);
    }
}

/// A listing has as many instructions as the table counts.
#[test]
fn listings_and_table_agree() {
    let table = json(&["table", "--json"]);
    let parts = ["predictor", "box", "index", "halo", "lattice", "forces", "corrector"];
    for text in ["printed", "ours"] {
        for part in parts {
            let listing = String::from_utf8(stripmine(&["listing", part, "--text", text]).stdout).unwrap();
            let instructions = listing.lines().filter(|line| !line.starts_with(';')).count() as u64;
            let rows = table["operation_classes"].as_array().unwrap();
            let counted: u64 = rows.iter().map(|row| row[format!("{part}_{text}")].as_u64().unwrap()).sum();
            assert_eq!(instructions, counted, "{part} {text}");
        }
    }
}

/// BP93's own program is benched by its name, and a scene that runs it lists its programs by equation.
#[test]
fn printed_program_is_benched_and_listed_by_equation() {
    for (arguments, text) in [(&["--text", "printed"][..], "printed"), (&[], "ours")] {
        let bench = ["bench", "lattice", "--particles", "100", "--steps", "5", "--repeats", "1", "--json"];
        let bench = json(&[&bench, arguments, &["--execution", "chained"]].concat());
        assert_eq!(bench["text"], text);
        assert!(bench["contacts"].as_f64().unwrap() > 0.0);
    }
    for (scene, is_printed) in [("dense-gas-printed", true), ("dense-gas", false)] {
        let said = stripmine(&["scene", "programs", scene, "--set", "machine.engine=programs"]);
        let said = String::from_utf8(said.stdout).unwrap();
        assert_eq!(
            ["(2)", "(7)", "(12)", "A 3"].map(|tag| said.contains(&format!(" {tag} "))),
            [is_printed; 4],
            "{said}"
        );
    }
}

/// Lattice programs are counted for every preset with contacts, and a note is shown if the run itself uses another search.
#[test]
fn lattice_programs_of_every_preset_are_counted() {
    let mut said_so = 0;
    for preset in
        ["bench", "dense-gas", "dense-gas-printed", "pipe-small", "pipe-small-printed", "shaken-box"]
    {
        let of = |more: &[&str]| json(&[&["scene", "programs", preset, "--json"], more].concat());
        let (own, on_lattice) = (of(&[]), of(&["--set", "search.by=lattice"]));
        let parts: Vec<&str> =
            own["operations"].as_array().unwrap().iter().map(|it| it["part"].as_str().unwrap()).collect();
        assert!(parts.contains(&"predictor") && parts.contains(&"forces"), "{preset}: {parts:?}");
        assert_eq!(own["operations"], on_lattice["operations"], "{preset}");
        assert!(on_lattice["note"].is_null());
        let checked = json(&["scene", "check", preset, "--json"]);
        let is_by_lattice = checked["choices"].as_array().unwrap().iter().all(|choice| {
            let choice = choice.as_str().unwrap();
            !choice.starts_with("search.by") || choice.starts_with("search.by = \"lattice\"")
        });
        assert_eq!(own["note"].is_null(), is_by_lattice, "{preset}: {}", checked["choices"]);
        said_so += usize::from(!is_by_lattice);
    }
    assert!(said_so > 1, "{said_so}");
    let listing = stripmine(&["scene", "programs", "pipe-small", "--listing"]);
    assert!(String::from_utf8_lossy(&listing.stdout).starts_with("; the programs are those of search.by"));
    assert_eq!(stripmine(&["scene", "programs", "hard-disks"]).status.code(), Some(2));
}

/// Operations that a scene does not need are not executed.
#[test]
fn simpler_scenes_cost_less() {
    let table = json(&["table", "--json"]);
    let savings = table["savings"].as_array().unwrap();
    let relative =
        |name: &str| savings.iter().find(|row| row["scene"] == name).unwrap()["relative"].as_f64().unwrap();
    assert_eq!(relative("as asked"), 1.0);
    assert!(relative("without friction") < 0.7);
    assert!(relative("with equal discs") < 0.95);
    assert!(relative("without friction, with equal discs") < relative("without friction"));
    let listing = String::from_utf8(stripmine(&["listing", "forces", "--frictionless"]).stdout).unwrap();
    assert!(!listing.contains("omega") && !listing.contains("torque"));
}

/// Unknown names exit with 2 and list the known ones; impossible values are named.
#[test]
fn bad_usage_exits_with_2_and_help() {
    for (arguments, words) in [
        (&["table", "--machine", "cray-9"][..], &["cray-9", "paper", "cray-y-mp-el"][..]),
        (&["listing", "foces"], &["foces", "predictor", "forces", "corrector"]),
        (&["table", "--occupancy", "1.5"], &["occupancy", "1.5"]),
        (&["table", "--occupancy", "NaN"], &["occupancy", "NaN"]),
        (&["table", "--particles", "0"], &["at least one"]),
        (&["table", "--particles", "3"], &["needs at least 5"]),
        (&["table", "--particles", "18446744073709551615"], &["number"]),
        (&["reproduce", "--only", "figure-9"], &["table", "listing"]),
        (&["nonsense"], &["nonsense"]),
    ] {
        let output = stripmine(arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(output.stdout.is_empty());
        assert!(words.iter().all(|word| said.contains(word)), "{arguments:?}: {said}");
        assert!(!said.contains("panicked"));
    }
}

/// Files of a folder by name, except those with dates and hosts.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let files =
        entries.map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap()));
    files.filter(|(name, _)| name != "provenance.json").collect()
}

/// Results are written to the requested folder, and two runs write the same bytes.
#[test]
fn reproduce_is_deterministic() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["a", "b"].map(|name| {
        let out = folder.path().join(name);
        let items = ["--only", "table", "--only", "mask", "--only", "misprints"];
        let outcome = json(&[&["reproduce", "--out", out.to_str().unwrap(), "--json"][..], &items].concat());
        assert_eq!(outcome.as_array().unwrap().len(), 3);
        out
    });
    for (item, file) in
        [("table", "efficiency_table.csv"), ("mask", "mask_5x5.svg"), ("misprints", "misprints.csv")]
    {
        let [a, b] = [&first, &second].map(|out| contents(&out.join(item)));
        assert!(a.contains_key(file), "{item}/{file}");
        assert!(a == b, "{item}");
    }
    let page = std::fs::read_to_string(first.join("README.md")).unwrap();
    assert!(page.contains("1\u{202f}656"));
}

/// Making one item again leaves the others unchanged, on disk and on the pages.
#[test]
fn single_items_leave_others_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let make = |item| assert!(stripmine(&["reproduce", "--only", item, "--out", out]).status.success());
    make("mask");
    let before = contents(&folder.path().join("mask"));
    make("table");
    assert!(before == contents(&folder.path().join("mask")));
    for page in ["README.md", "index.html"] {
        let page = std::fs::read_to_string(folder.path().join(page)).unwrap();
        assert!(page.contains("The mask (figure 2)") && page.contains("The efficiency table"));
        assert!(page.contains("stripmine reproduce --only mask"));
    }
}

/// Completions and the manual page know every verb; for an unknown verb, `man` lists the known ones.
#[test]
fn completions_and_manual_know_the_verbs() {
    let text = |arguments: &[&str]| String::from_utf8(stripmine(arguments).stdout).unwrap();
    for page in [text(&["completions", "bash"]), text(&["man"])] {
        assert!(
            ["reproduce", "table", "listing", "run", "scene", "bench"].iter().all(|verb| page.contains(verb))
        );
    }
    assert!(text(&["man", "reproduce"]).contains("quick"));
    let output = stripmine(&["man", "fly"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("reproduce"));
}

/// An unwritable folder is an input/output failure that names it.
#[test]
fn an_unwritable_folder_exits_with_5() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let output = stripmine(&["reproduce", "--out", file.join("below").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(5));
    assert!(String::from_utf8_lossy(&output.stderr).contains("below"));
}

/// A misspelt word, or one that belongs elsewhere, is answered with the intended one.
#[test]
fn misspelt_words_get_the_intended_word() {
    for (arguments, code, meant) in [
        (&["rnu", "two-discs"][..], 2, "'run'"),
        (&["polt", "x"], 2, "'plot'"),
        (&["scene", "chekc", "x"], 2, "'check'"),
        (&["run", "two-discs", "--seed", "3"], 2, "--set particles.seed=3"),
        (&["run", "two-discs", "--seed=3"], 2, "--set particles.seed=3"),
        (&["run", "two-discs", "--dt", "1e-5"], 2, "--set integrator.dt=1e-5"),
        (
            &["scene", "check", "two-discs", "--packing-fraction", "0.3"],
            2,
            "--set particles.packing_fraction=0.3",
        ),
        (&["compare", "two-discs", "--against", "engine=programs"], 3, "--against engine=programs: "),
        (&["compare", "two-discs", "--against", "engine=programs"], 3, "`machine.engine`"),
        (&["compare", "two-discs", "--against", "engin=programs"], 3, "`machine.engine`"),
        (&["scene", "check", "two-discs", "--set", "stiffnes=1"], 3, "`law.stiffness`"),
        (&["scene", "check", "two-discs", "--set", "search.engine=fast"], 3, "`machine.engine`"),
        (&["plot", ".", "--columns", "x"], 5, "thermo.csv"),
    ] {
        let output = stripmine(arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(meant), "{arguments:?} is not answered by {meant}: {said}");
    }
}

/// A bench on several numbers of threads gives the same bits and reports the serial part of every phase.
#[test]
fn bench_on_several_thread_counts_reports_serial_parts() {
    let bench = ["bench", "lattice", "--particles", "6000", "--steps", "20", "--repeats", "2", "--quiet"];
    let run = |more: &[&str]| {
        let mut command = Command::cargo_bin("stripmine").unwrap();
        command.args([&bench[..], more].concat()).output().unwrap()
    };
    let output = run(&["--threads", "2,1", "--json"]);
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let threads: Vec<u64> =
        said["by_threads"].as_array().unwrap().iter().map(|it| it["threads"].as_u64().unwrap()).collect();
    assert!(threads == [1, 2] && said["same_bits"] == true, "{said:#}");
    let phases = said["phases"].as_array().unwrap();
    for name in ["whole step", "forces", "start", "row", "particles", "snapshot"] {
        let phase = phases.iter().find(|phase| phase["name"] == name).unwrap();
        assert!(
            phase["serial"].is_number() && phase["nanoseconds"].as_array().unwrap().len() == 2,
            "{phase:#}"
        );
    }
    let text = String::from_utf8(run(&["--threads", "1,2"]).stdout).unwrap();
    assert!(text.contains("same bits on all") && text.contains("serial part (%)"), "{text}");
    let mut command = Command::cargo_bin("stripmine").unwrap();
    let refused = command.args(["run", "two-discs", "--threads", "1,2"]).output().unwrap();
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("only bench takes several"), "{said}");
}
