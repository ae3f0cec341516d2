//! Plans as a user meets them.

use assert_cmd::cargo::CommandCargoExt;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// `explain` in a folder, where it also keeps what it measures.
fn explain(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder).env("XDG_CACHE_HOME", folder.join("cache")).arg("explain");
    command.args(arguments).arg("--quiet").output().unwrap()
}

fn ends_with(output: &Output, code: i32, words: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{said}");
    words.iter().for_each(|word| assert!(said.contains(word), "{word} is not in: {said}"));
}

fn plan(output: &Output) -> Value {
    ends_with(output, 0, &[]);
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A gas whose trials take no time.
const GAS: [&str; 5] = ["hard-disks", "--set", "particles.count=100", "--seconds", "1"];

#[test]
fn a_plan_is_written_carried_out_and_reaches_its_error() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let asked = [&GAS[..], &["--error", "2%", "--write", "plan.toml", "--analyze", "--json"]].concat();
    let found = plan(&explain(folder, &asked));
    let [mean, bar] = [0, 1].map(|place| found["mean"][place].as_f64().unwrap());
    // Z of 100 discs at ν = 0.5.
    assert!(found["quantity"] == "compressibility" && (mean - 4.1).abs() < 0.1 + bar, "{found:#}");
    let chance = found["expected"]["chance"].as_f64().unwrap();
    assert!(found["expected"]["bias"]["shift"] == 0.0 && chance > 0.0 && chance <= 0.0201 * mean, "{chance}");
    assert!(found["analyzed"].as_array().unwrap().len() > 3);
    let mut command = Command::cargo_bin("stripmine").unwrap();
    let run =
        command.current_dir(folder).args(["run", "plan.toml", "--out", "out", "--quiet"]).output().unwrap();
    ends_with(&run, 0, &[]);
    let summary: Value = serde_json::from_slice(&fs::read(folder.join("out/summary.json")).unwrap()).unwrap();
    let all = summary["averages"]["quantities"].as_array().unwrap();
    let z = all.iter().find(|it| it["quantity"] == "compressibility").unwrap();
    // One of its runs: the error is that of all seeds.
    let allowed = 2.5 * 0.02 * mean * found["seeds"].as_f64().unwrap().sqrt();
    assert!(z["says"] == "mean" && (z["mean"].as_f64().unwrap() - mean).abs() < allowed, "{z:#}");
}

#[test]
fn what_was_measured_is_kept_for_this_host_and_may_be_forgotten() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ends_with(&explain(folder, &[&GAS[..3], &["--estimate"]].concat()), 4, &["nothing is known here"]);
    let found = plan(&explain(folder, &[&GAS[..], &["--error", "2%", "--json"]].concat()));
    assert!(found["origin"].as_str().unwrap().contains(" s of trials on "));
    // Another error needs no new trials.
    let again = plan(&explain(folder, &[&GAS[..3], &["--estimate", "--error", "1%", "--json"]].concat()));
    assert!(again["origin"].as_str().unwrap().starts_with("kept from"), "{again:#}");
    assert_eq!(again["mean"], found["mean"]);
    let ratio = again["time"].as_f64().unwrap() / found["time"].as_f64().unwrap();
    assert!(ratio > 1.5 && ratio < 4.01, "{ratio}");
    // What another processor measured is not used.
    let kept: Vec<_> = fs::read_dir(folder.join("cache/stripmine/explain")).unwrap().collect();
    let [file] = kept.as_slice() else { panic!("{kept:?}") };
    let file = file.as_ref().unwrap().path();
    let text =
        fs::read_to_string(&file).unwrap().replace("threads, stripmine", "threads of another, stripmine");
    fs::write(&file, text).unwrap();
    ends_with(&explain(folder, &[&GAS[..3], &["--estimate"]].concat()), 4, &["nothing is known here"]);
    let forgotten = explain(folder, &["--forget"]);
    assert_eq!(String::from_utf8_lossy(&forgotten.stdout), "removed: 1\n");
    assert!(!file.exists());
}

/// What `auto` becomes by what is kept of a scene that is alike is said, stands in the resolved scene, and is what a resumption goes on with; nothing that
/// the scene states is changed, and a scene that is not alike is run as ever.
#[test]
fn a_run_may_be_tuned_by_what_was_measured_of_a_scene_that_is_alike() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let gas = |count: &'static str| ["dense-gas", "--set", count, "--set", "particles.packing_fraction=0.3"];
    plan(&explain(folder, &[&gas("particles.count=100")[..], &["--seconds", "1", "--json"]].concat()));
    let run = |count: &'static str, more: &[&str]| {
        let mut command = Command::cargo_bin("stripmine").unwrap();
        command.current_dir(folder).env("XDG_CACHE_HOME", folder.join("cache")).arg("run");
        command.args(gas(count)).args(["--set", "run.steps=20", "--out", "out", "--tuned"]).args(more);
        let output = command.output().unwrap();
        ends_with(&output, 0, &[]);
        let scene = fs::read_to_string(folder.join("out/scene.toml")).unwrap();
        (String::from_utf8_lossy(&output.stderr).into_owned(), scene)
    };
    // The cheapest way of what is kept.
    let kept = fs::read_dir(folder.join("cache/stripmine/explain")).unwrap().next().unwrap().unwrap().path();
    let kept: Value = serde_json::from_slice(&fs::read(kept).unwrap()).unwrap();
    let is_own = |way: &&Value| {
        let label = way["label"].as_str().unwrap();
        label.starts_with("gear6 f64") && label.ends_with("fast") && !way["cost"].is_null()
    };
    let ways = kept["findings"]["ways"].as_array().unwrap();
    let cheapest = ways.iter().find(is_own).unwrap()["settings"].as_array().unwrap();
    let search = cheapest.iter().find(|it| it[0] == "search").unwrap()[1].as_str().unwrap();
    let (said, scene) = run("particles.count=150", &[]);
    assert!(said.contains(&format!("tuned: search.by={search}")) && said.contains("measured"), "{said}");
    assert!(scene.contains(&format!("by = \"{search}\"")), "{scene}");
    let (said, again) = run("particles.count=150", &["--resume"]);
    assert!(!said.contains("tuned:") && again == scene, "{said}");
    let (said, scene) = run("particles.count=150", &["--overwrite", "--set", "search.by=sectors"]);
    assert!(!said.contains("search.by=") && scene.contains("by = \"sectors\""), "{said}");
    let (said, _) = run("particles.count=1500", &["--overwrite"]);
    assert!(said.contains("nothing is kept of a scene that is alike"), "{said}");
}

#[test]
fn what_should_keep_its_value_gets_the_step_that_keeps_it() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let asked = ["kepler", "--of", "energy_error", "--error", "1e-6", "--seconds", "2", "--json"];
    let found = plan(&explain(folder, &[&asked[..], &["--write", "plan.toml"]].concat()));
    assert!(found["mean"].is_null() && found["expected"]["most"].as_f64().unwrap() <= 0.5e-6, "{found:#}");
    let mut command = Command::cargo_bin("stripmine").unwrap();
    let run =
        command.current_dir(folder).args(["run", "plan.toml", "--out", "out", "--quiet"]).output().unwrap();
    ends_with(&run, 0, &[]);
    let summary: Value = serde_json::from_slice(&fs::read(folder.join("out/summary.json")).unwrap()).unwrap();
    let all = summary["averages"]["quantities"].as_array().unwrap();
    let error = all.iter().find(|it| it["quantity"] == "energy_error").unwrap();
    assert!(error["says"] == "kept" && error["farthest"].as_f64().unwrap() <= 1e-6, "{error:#}");
    // The scene's own leapfrog is not that good.
    let own = found["own"]["error"]["most"].as_f64().unwrap();
    assert!(own > 1e-5, "{own}");
}

#[test]
fn what_cannot_be_planned_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let bad = |arguments: &[&str]| explain(folder, arguments);
    ends_with(&bad(&["hard-disks", "--of", "colour"]), 2, &["`colour`", "one of events", "compressibility"]);
    ends_with(&bad(&["hard-disks", "--error", "little"]), 2, &["above 0, or a part such as 1%"]);
    ends_with(&bad(&["nothing.toml"]), 3, &["nothing.toml"]);
    let cooling = ["cooling-gas", "--of", "temperature", "--error", "1%", "--seconds", "1"];
    ends_with(&bad(&cooling), 4, &["temperature comes to no mean", "still changing", "--patient"]);
    let kepler = ["kepler", "--of", "energy_error", "--error", "1e-30", "--seconds", "1"];
    ends_with(
        &bad(&kepler),
        4,
        &["no way to run the scene is known to come to an error of 1e-30", "at best"],
    );
}

/// What changes all along has no mean that a run comes to; what is asked for is that over the whole run, by runs from starts of their own.
#[test]
fn what_changes_all_along_is_meant_over_the_whole_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let falling =
        ["shaken-box", "--set", "particles.wall_motion=\"fixed\"", "--set", "law.normal_damping=2000.0"];
    let asked = [
        "--set",
        "run.time=0.3",
        "--set",
        "particles.count=30",
        "--of",
        "kinetic",
        "--error",
        "40%",
        "--seconds",
        "8",
    ];
    let found = plan(&explain(folder, &[&falling[..], &asked, &["--analyze", "--json"]].concat()));
    assert!(found["is_whole"] == true && found["time"] == 0.3, "{found:#}");
    let [mean, bar] = [0, 1].map(|place| found["mean"][place].as_f64().unwrap());
    // Grains fall some centimetres, and have less than the energy of that for a part of the time.
    let most = 30.0 * 1e-6 * 9.81 * 0.15;
    assert!((0.001 * most..most).contains(&mean) && bar < 0.5 * mean, "{mean} {bar}");
    let rows = found["analyzed"].as_array().unwrap();
    assert!(
        rows.iter().any(|row| row["what"].as_str().unwrap().starts_with("kinetic over the whole run")),
        "{rows:#?}"
    );
    assert!(rows.iter().any(|row| row["what"] == "of it: forces") && rows.len() > 4, "{rows:#?}");
}

#[test]
fn a_plan_for_a_time_has_the_least_error_that_it_allows() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let within = |seconds: &str| plan(&explain(folder, &[&GAS[..], &["--time", seconds, "--json"]].concat()));
    let [short, long] = ["0.5", "2"].map(within);
    for (found, seconds) in [(&short, 0.5), (&long, 2.0)] {
        let likely = found["seconds"]["likely"].as_f64().unwrap();
        assert!(likely <= seconds && likely > 0.5 * seconds, "{likely} of {seconds}");
    }
    let [short, long] = [short, long].map(|found| found["expected"]["most"].as_f64().unwrap());
    // The root of four times the time.
    assert!((1.5..3.0).contains(&(short / long)), "{short} {long}");
    let quick = explain(folder, &[&GAS[..], &["--time", "1e-7"]].concat());
    ends_with(
        &quick,
        4,
        &["no run tells a mean of compressibility in 1e-7 s", "the shortest takes about", "--time"],
    );
    for wrong in ["0", "-1", "nan", "soon"] {
        ends_with(&explain(folder, &["hard-disks", &format!("--time={wrong}")]), 2, &["seconds above 0"]);
    }
    ends_with(&explain(folder, &["hard-disks", "--time", "1", "--error", "1%"]), 2, &["cannot be used with"]);
}

/// A diagram of a mean for methods without comparable trajectories: errors fall with the root of the time, and the steps' biases are beside.
#[test]
fn the_error_of_a_mean_is_charted_over_its_cost() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (scene, quantity, ways) in [("langevin-dense", "potential", 6), ("hard-disks", "compressibility", 2)]
    {
        let mut command = Command::cargo_bin("stripmine").unwrap();
        command.current_dir(folder).args([
            "chart",
            "work-precision",
            scene,
            "--budget",
            "6",
            "--json",
            "--quiet",
        ]);
        let output = command.args(["--set", "particles.count=100", "--of", quantity]).output().unwrap();
        let all = plan(&output);
        let data = &all[scene];
        let curves = data["curves"].as_array().unwrap();
        assert!(data["quantity"] == quantity && curves.len() == ways, "{data:#}");
        for curve in curves {
            let points = curve["points"].as_array().unwrap();
            let [first, last] =
                [&points[0], &points[points.len() - 1]].map(|point| point[1].as_f64().unwrap());
            assert!(points.len() > 3 && last < first, "{curve:#}");
        }
        let pictures = folder.join(format!("{scene}.work-precision/host/work-precision"));
        let svg = fs::read_dir(pictures)
            .unwrap()
            .flatten()
            .filter(|file| file.path().extension().is_some_and(|it| it == "svg"));
        assert_eq!(svg.count(), if ways > 2 { 2 } else { 1 });
    }
}
