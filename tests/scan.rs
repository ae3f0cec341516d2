//! Scans over keys: values against theory, one table in three forms, resumption, failures as rows, refusals.

#![cfg(unix)]

use assert_cmd::cargo::CommandCargoExt;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder).env("COLUMNS", "80").args(arguments).arg("--quiet");
    command
}

fn stripmine(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

fn ends_with(output: &Output, code: i32, words: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{said}");
    words.iter().for_each(|word| assert!(said.contains(word), "{word} is not in: {said}"));
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Outcome of a quantity at a point.
fn of<'a>(averages: &'a Value, name: &str) -> &'a Value {
    averages["quantities"].as_array().unwrap().iter().find(|it| it["quantity"] == name).unwrap()
}

/// Rows of a table in CSV, by the names of its columns.
fn rows(csv: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {row:?}"))
}

/// Hard discs against their virial series, and the same table from `average`.
///
/// B3/B2² = 4/3 − √3/π (Tonks 1936), B4 to B10 from Clisby and McCoy (J. Stat. Phys. 122, 15, 2006). The series is summed to tenth order; the
/// rest is below 10⁻³ at the largest packing fraction.
#[test]
fn hard_discs_follow_the_virial_series() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let gas = ["--set", "particles.count=400", "--set", "run.thermo_every=0.5", "--set", "run.events=1e7"];
    let scan = ["scan", "hard-disks", "--over", "particles.packing_fraction=0.05:0.35:4"];
    let output = stripmine(folder, &[&scan[..], &gas, &["--until", "compressibility=1%"]].concat());
    ends_with(&output, 0, &[]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        text.lines().all(|line| line.chars().count() <= 80) && text.contains("compressibility"),
        "{text}"
    );
    let csv = fs::read_to_string(folder.join("hard-disks.scan/scan.csv")).unwrap();
    let table = rows(&csv);
    let reduced = [
        4.0 / 3.0 - 3_f64.sqrt() / std::f64::consts::PI,
        0.532_231_80,
        0.333_556_04,
        0.198_842_5,
        0.114_868_3,
        0.064_993_0,
        0.036_219_3,
        0.019_953_7,
    ];
    let fractions: Vec<f64> = table.iter().map(|row| number(row, "particles.packing_fraction")).collect();
    assert_eq!(fractions, [0.05, 0.15, 0.25, 0.35]);
    for (row, fraction) in table.iter().zip(fractions) {
        let y = 2.0 * fraction;
        let terms = reduced.iter().enumerate().map(|(at, b)| b * y.powi(at as i32 + 2));
        let known = 1.0 + y + terms.sum::<f64>();
        let [mean, bar, error] =
            ["", "_error_95", "_standard_error"].map(|end| number(row, &format!("compressibility{end}")));
        // The excess of N discs is that of N − 1 partners.
        assert!(
            (mean - known).abs() < 1.5 * bar + (known - 1.0) / 400.0,
            "{fraction}: {mean} ± {bar}, {known}"
        );
        assert!(bar <= 0.01 * mean && error < bar && error > 0.3 * bar, "{row:?}");
        assert!(row["failure"].is_empty() && row["runs"] == "1");
    }
    let again = |more: &[&str]| stripmine(folder, &[&["average", "hard-disks.scan"], more].concat());
    assert_eq!(String::from_utf8_lossy(&again(&["--csv"]).stdout), csv);
    let document: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("hard-disks.scan/scan.json")).unwrap()).unwrap();
    assert_eq!(json(&again(&["--json"])), document);
    for (row, point) in table.iter().zip(document["points"].as_array().unwrap()) {
        let alone = stripmine(folder, &["average", point["folders"][0].as_str().unwrap(), "--json"]);
        assert_eq!(json(&alone), point["averages"]);
        let folder_of_point = point["folders"][0].as_str().unwrap();
        let some =
            json(&stripmine(folder, &["average", folder_of_point, "--of", "compressibility", "--json"]));
        assert_eq!(
            some["quantities"].as_array().unwrap(),
            &[of(&point["averages"], "compressibility").clone()]
        );
        assert_eq!(stripmine(folder, &["average", folder_of_point, "--of", "flow"]).status.code(), Some(2));
        let z = of(&point["averages"], "compressibility");
        assert_eq!(Some(number(row, "compressibility")), z["mean"].as_f64());
        assert_eq!(Some(number(row, "compressibility_standard_error")), z["standard_error"].as_f64());
        assert_eq!(
            Some(number(row, "rate_of_collisions")),
            of(&point["averages"], "collisions")["mean"].as_f64()
        );
    }
    let picture = fs::read_to_string(folder.join("hard-disks.scan/compressibility.svg")).unwrap();
    assert!(picture.contains("packing fraction") && picture.contains("compressibility"), "{picture}");
    let chosen = String::from_utf8(again(&["--of", "collision_rate"]).stdout).unwrap();
    assert!(
        chosen.lines().nth(2).is_some_and(|line| line.contains("collision") && !line.contains("compress"))
    );
    ends_with(&again(&["--of", "colision_rate"]), 2, &["--of colision_rate", "did you mean collision_rate?"]);
}

/// Free particles in a bath have its temperature, whatever their drag. A grid of two keys with two seeds each.
#[test]
fn free_particles_have_the_temperature_of_their_bath() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scan = ["scan", "langevin-free", "--over", "law.bath_temperature=0.5,1,2", "--over", "law.drag=1,4"];
    let more = ["--set", "particles.count=200", "--set", "run.time=60", "--seeds", "2", "--out", "free"];
    let output = stripmine(folder, &[&scan[..], &more].concat());
    ends_with(&output, 0, &[]);
    let csv = fs::read_to_string(folder.join("free/scan.csv")).unwrap();
    let table = rows(&csv);
    let keys =
        |row: &BTreeMap<String, String>| ["law.bath_temperature", "law.drag"].map(|key| number(row, key));
    let grid = [[0.5, 1.0], [0.5, 4.0], [1.0, 1.0], [1.0, 4.0], [2.0, 1.0], [2.0, 4.0]];
    assert_eq!(table.iter().map(keys).collect::<Vec<_>>(), grid);
    for row in &table {
        let [mean, bar] = ["temperature", "temperature_error_95"].map(|column| number(row, column));
        let known = number(row, "law.bath_temperature");
        assert!((mean - known).abs() < 1.5 * bar && bar < 0.03 * known && row["runs"] == "2", "{row:?}");
    }
    assert!(folder.join("free/bath_temperature=0.5,drag=4/seed-1/thermo.csv").is_file());
    let picture = fs::read_to_string(folder.join("free/temperature.svg")).unwrap();
    assert!(
        picture.contains("drag (mass/time) = 1") && picture.contains("drag (mass/time) = 4"),
        "{picture}"
    );
    // The whole folder, all that is in it, and folders of seeds.
    let tables = [&["free"][..], &["free/*"], &["free/*/*"]].map(|patterns| {
        let list = format!("exec \"$0\" average {} --csv --quiet", patterns.join(" "));
        let program = Command::cargo_bin("stripmine").unwrap().get_program().to_owned();
        let output =
            Command::new("sh").current_dir(folder).arg("-c").arg(list).arg(program).output().unwrap();
        ends_with(&output, 0, &[]);
        String::from_utf8(output.stdout).unwrap()
    });
    assert!(tables.iter().all(|table| *table == csv), "{tables:?}\n{csv}");
}

/// Words have an axis of names; of nine series seven are drawn, the first and the last among them.
#[test]
fn charts_have_seven_series_at_most() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scan = ["scan", "langevin-free", "--over", "machine.precision=f64,mixed", "--over", "law.drag=1:9:9"];
    let more = ["--set", "particles.count=20", "--set", "run.time=150", "--out", "words"];
    ends_with(&stripmine(folder, &[&scan[..], &more].concat()), 0, &[]);
    let picture = fs::read_to_string(folder.join("words/temperature.svg")).unwrap();
    let drawn = |drag: u32| picture.contains(&format!("<title>drag (mass/time) = {drag}</title>"));
    assert_eq!((1..=9).filter(|&drag| drawn(drag)).collect::<Vec<_>>(), [1, 2, 3, 5, 6, 7, 9]);
    for words in ["2 of 9 series are not drawn", ">f64</text>", ">mixed</text>"] {
        assert!(picture.contains(words), "{words}: {picture}");
    }
}

/// Files of a folder and of the folders in it, without those that hold wall times.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            all.extend(files(&path).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else if !["summary.json", "run.checkpoint", "run.checkpoint.previous"].contains(&name.as_str()) {
            all.insert(name, fs::read(&path).unwrap());
        }
    }
    all
}

/// A scan that is killed and resumed has the files of one that was not; finished runs are not repeated, and points can be added.
#[test]
fn killed_scans_resume_to_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    [&whole, &parts].iter().for_each(|folder| fs::create_dir(folder).unwrap());
    let scan = ["scan", "hard-disks", "--threads", "1", "--set", "particles.count=100", "--out", "a.scan"];
    let scan = [&scan[..], &["--set", "run.events=100000", "--set", "run.thermo_every=0.2"]].concat();
    let three = [&scan[..], &["--over", "particles.packing_fraction=0.1,0.2,0.3"]].concat();
    ends_with(&stripmine(&whole, &three), 0, &[]);
    let mut child = command(&parts, &three).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    // One thread makes the runs in turn: the second has begun.
    while !parts.join("a.scan/packing_fraction=0.2/thermo.csv").exists() {
        assert!(child.try_wait().unwrap().is_none(), "the scan has ended");
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!parts.join("a.scan/scan.csv").exists());
    ends_with(
        &stripmine(&parts, &three),
        2,
        &["a.scan/packing_fraction=0.1 already contains a run", "--resume"],
    );
    ends_with(&stripmine(&parts, &[&three[..], &["--resume"]].concat()), 0, &[]);
    assert!(files(&parts) == files(&whole), "{:?}", files(&parts).keys());
    // A run that is repeated removes its files first.
    let file = || fs::metadata(parts.join("a.scan/packing_fraction=0.1/trajectory.xyz")).unwrap().ino();
    let before = file();
    // Another scene is refused before anything runs.
    let other = [&three[..], &["--resume", "--set", "law.restitution=0.9"]].concat();
    ends_with(&stripmine(&parts, &other), 2, &["was run with another scene", "restitution"]);
    assert!(parts.join("a.scan/scan.csv").exists());
    let four = [&scan[..], &["--over", "particles.packing_fraction=0.1:0.4:4", "--resume"]].concat();
    ends_with(&stripmine(&parts, &four), 0, &[]);
    assert_eq!(file(), before);
    let [three, four] = [&whole, &parts].map(|it| fs::read_to_string(it.join("a.scan/scan.csv")).unwrap());
    assert!(four.starts_with(&three) && rows(&four).len() == 4, "{four}");
}

/// Points that fail are rows with their reasons; the others continue, and the table is printed.
#[test]
fn failed_points_are_rows_with_reasons() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // Discs so soft pass through each other.
    let soft = ["scan", "two-discs", "--over", "law.stiffness=1e-3,1e4"];
    let output = stripmine(folder, &[&soft[..], &["--json"]].concat());
    ends_with(&output, 4, &["1 of 2 points failed", "--resume"]);
    let found = json(&output);
    let [broken, done] = [0, 1].map(|at| &found["points"][at]);
    assert!(broken["averages"].is_null() && broken["failure"]["kind"] == "precondition", "{broken:#}");
    assert!(broken["failure"]["message"].as_str().unwrap().contains("overlap"), "{broken:#}");
    assert!(done["failure"].is_null() && done["averages"]["runs"] == 1, "{done:#}");
    let table = rows(&fs::read_to_string(folder.join("two-discs.scan/scan.csv")).unwrap());
    assert!(table[0]["failure"].contains("overlap") && table[1]["failure"].is_empty(), "{table:?}");
    let again = stripmine(folder, &[&soft[..], &["--resume"]].concat());
    ends_with(&again, 4, &[]);
    let text = String::from_utf8_lossy(&again.stdout);
    assert!(text.contains("stiffness = 0.001: ") && text.contains("overlap"), "{text}");
    // A run that does not reach its target error has means, with the reason.
    let scan = ["scan", "hard-disks", "--over", "particles.packing_fraction=0.2,0.3", "--out", "short"];
    let short =
        ["--set", "particles.count=100", "--set", "run.events=20000", "--until", "compressibility=0.001%"];
    let rows_every = ["--set", "run.thermo_every=0.05"];
    ends_with(&stripmine(folder, &[&scan[..], &short, &rows_every].concat()), 4, &["2 of 2 points failed"]);
    for row in rows(&fs::read_to_string(folder.join("short/scan.csv")).unwrap()) {
        assert!(number(&row, "compressibility") > 1.4 && row["failure"].contains("latest end"), "{row:?}");
    }
}

/// Bad input is refused by name before anything runs, all of it at once.
#[test]
fn bad_scans_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scan = |more: &[&str]| stripmine(folder, &[&["scan", "hard-disks", "--out", "out"], more].concat());
    for (options, code, words) in [
        (
            &["--over", "particles.packing_fracton=0.1,0.2"][..],
            3,
            &["did you mean `particles.packing_fraction`"][..],
        ),
        (&["--over", "packing_fraction=0.1"], 3, &["did you mean `particles.packing_fraction`"]),
        (
            &["--over", "particles.packing_fraction=0.1,0.95,-1", "--over", "law.restitution=1,7"],
            3,
            &[
                "--over particles.packing_fraction=0.95",
                "--over particles.packing_fraction=-1",
                "--over law.restitution=7",
            ],
        ),
        (&["--over", "law.restitution="], 2, &["--over law.restitution=: `law.restitution` has no values"]),
        (&["--over", "law.restitution=1:2"], 2, &["1:2 is no range", "n points evenly"]),
        (&["--over", "law.restitution"], 2, &["needs a key and its values"]),
        (
            &["--over", "law.restitution=1", "--over", "law.restitution=0.9"],
            2,
            &["`law.restitution` is given twice"],
        ),
        (
            &["--over", "law.restitution=1,0.9", "--set", "law.restitution=1"],
            2,
            &["--set law.restitution=1: the key `law.restitution`"],
        ),
        (&["--over", "particles.seed=1,2", "--seeds", "2"], 3, &["--seeds varies `particles.seed`"]),
        (
            &["--over", "law.restitution=1", "--until", "compressibility"],
            2,
            &["--until compressibility", "QUANTITY=ERROR"],
        ),
        (
            &["--over", "law.restitution=1", "--until", "compresibility=1%"],
            3,
            &["--until compresibility=1%", "did you mean"],
        ),
        (&["--over", "law.restitution=1", "--of", "pressur"], 2, &["--of pressur", "compressibility"]),
        (&["--over", "particles.count=1e12,100"], 3, &["particles.count"]),
    ] {
        ends_with(&scan(options), code, words);
        assert!(!folder.join("out").exists(), "{options:?}");
    }
    // A mistake of one point alone is named by its values.
    let output = stripmine(folder, &["scan", "dense-gas", "--over", "law.stiffness=187,1e9"]);
    ends_with(&output, 3, &["law.stiffness=1e9: a contact at speed", "lower integrator.dt"]);
    fs::create_dir(folder.join("out")).unwrap();
    fs::write(folder.join("out/thesis.tex"), "mine").unwrap();
    for more in [&[][..], &["--resume"], &["--overwrite"]] {
        let over = ["--over", "law.restitution=1,0.9"];
        ends_with(&scan(&[&over[..], more].concat()), 2, &["thesis.tex", "scan.files"]);
    }
    assert_eq!(fs::read_dir(folder.join("out")).unwrap().count(), 1);
}

/// `average` finds the keys in which scenes differ; choices that do not change the physics are no keys.
#[test]
fn average_finds_the_keys_that_differ() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = |out: &str, more: &[&str]| {
        let gas =
            ["run", "hard-disks", "--out", out, "--set", "particles.count=100", "--set", "run.events=20000"];
        let rows = ["--set", "run.thermo_every=0.05"];
        ends_with(&stripmine(folder, &[&gas[..], &rows, more].concat()), 0, &[]);
    };
    run("a", &["--set", "law.restitution=0.99"]);
    run("b", &["--set", "machine.engine=cell-crossing"]);
    run("c", &["--set", "particles.seed=2", "--set", "machine.engine=cell-crossing"]);
    let found = json(&stripmine(folder, &["average", "b", "a", "c", "--json"]));
    assert_eq!(
        (&found["keys"][0]["key"], found["keys"].as_array().unwrap().len()),
        (&"law.restitution".into(), 1)
    );
    let folders = |at: usize| found["points"][at]["folders"].clone();
    assert_eq!([folders(0), folders(1)], [serde_json::json!(["a"]), serde_json::json!(["b", "c"])]);
    let joined = json(&stripmine(folder, &["average", "b", "c", "--json"]));
    assert_eq!(found["points"][1]["averages"], joined);
    // Alone, a choice is a key: such runs are the same physics, but not the same bits.
    run("d", &[]);
    let found = json(&stripmine(folder, &["average", "b", "d", "--json"]));
    assert_eq!(found["keys"][0]["key"], "machine.engine");
    ends_with(&stripmine(folder, &["run", "two-discs", "--out", "e"]), 0, &[]);
    ends_with(&stripmine(folder, &["average", "a", "e"]), 2, &["a and e have different scenes"]);
    ends_with(
        &stripmine(folder, &["average", "a", "b", "--structure", "g(r)"]),
        2,
        &["a and b have different scenes"],
    );
}

/// Keys of walls are scanned by the number of the wall.
#[test]
fn values_of_walls_are_scanned() {
    let folder = tempfile::tempdir().unwrap();
    let scan = ["scan", "hopper", "--over", "walls.1.friction=0.1,0.9", "--set", "run.steps=40", "--json"];
    let table = json(&stripmine(folder.path(), &scan));
    let values: Vec<f64> = table["points"]
        .as_array()
        .unwrap()
        .iter()
        .map(|point| point["values"][0].as_f64().unwrap())
        .collect();
    assert_eq!(values, [0.1, 0.9]);
}
