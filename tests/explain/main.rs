//! `explain` as a user sees it.

mod bodies;

use assert_cmd::cargo::CommandCargoExt;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Runs `explain` in a folder that also holds its cache.
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

/// A gas whose trials take no noticeable time.
const GAS: [&str; 5] = ["hard-disks", "--set", "particles.count=100", "--seconds", "1"];

#[test]
fn plan_is_written_run_and_reaches_its_error() {
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
    // A run of the first seed only: the planned error is that of all seeds together.
    let allowed = 2.5 * 0.02 * mean * found["seeds"].as_f64().unwrap().sqrt();
    assert!(z["says"] == "mean" && (z["mean"].as_f64().unwrap() - mean).abs() < allowed, "{z:#}");
}

#[test]
fn measurements_are_cached_per_host_and_removable() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ends_with(&explain(folder, &[&GAS[..3], &["--estimate"]].concat()), 4, &["no cached measurements"]);
    let found = plan(&explain(folder, &[&GAS[..], &["--error", "2%", "--json"]].concat()));
    assert!(found["origin"].as_str().unwrap().contains(" s of trials on "));
    // Another error needs no new trials.
    let again = plan(&explain(folder, &[&GAS[..3], &["--estimate", "--error", "1%", "--json"]].concat()));
    assert!(again["origin"].as_str().unwrap().starts_with("cached on"), "{again:#}");
    assert_eq!(again["mean"], found["mean"]);
    let ratio = again["time"].as_f64().unwrap() / found["time"].as_f64().unwrap();
    assert!(ratio > 1.5 && ratio < 4.01, "{ratio}");
    // Measurements of another processor are not used.
    let kept: Vec<_> = fs::read_dir(folder.join("cache/stripmine/explain")).unwrap().collect();
    let [file] = kept.as_slice() else { panic!("{kept:?}") };
    let file = file.as_ref().unwrap().path();
    let text =
        fs::read_to_string(&file).unwrap().replace("threads, stripmine", "threads of another, stripmine");
    fs::write(&file, text).unwrap();
    ends_with(&explain(folder, &[&GAS[..3], &["--estimate"]].concat()), 4, &["no cached measurements"]);
    let forgotten = explain(folder, &["--forget"]);
    assert_eq!(String::from_utf8_lossy(&forgotten.stdout), "removed 1 cached measurement\n");
    assert!(!file.exists());
}

/// An existing file is refused before any trial, whatever its type. With --overwrite a link is replaced, not followed; pipes and folders stay.
#[cfg(unix)]
#[test]
fn plans_overwrite_no_existing_files() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = folder.join("scene.toml");
    let mut show = Command::cargo_bin("stripmine").unwrap();
    fs::write(&scene, show.args(["scene", "show", "hard-disks"]).output().unwrap().stdout).unwrap();
    let own = fs::read(&scene).unwrap();
    fs::write(folder.join("mine.txt"), "mine").unwrap();
    fs::create_dir(folder.join("folder")).unwrap();
    symlink("mine.txt", folder.join("link.toml")).unwrap();
    symlink("nowhere", folder.join("broken.toml")).unwrap();
    assert!(Command::new("mkfifo").arg(folder.join("pipe")).status().unwrap().success());
    let to = |file: &str, more: &[&str]| {
        explain(folder, &[&["scene.toml"], &GAS[1..], &["--error", "5%", "--write", file], more].concat())
    };
    for (file, more, words) in [
        ("scene.toml", &[][..], &["scene.toml", "--overwrite"][..]),
        ("mine.txt", &[], &["mine.txt", "--overwrite"]),
        ("link.toml", &[], &["link.toml", "--overwrite"]),
        ("broken.toml", &[], &["broken.toml", "--overwrite"]),
        ("pipe", &[], &["pipe", "--overwrite"]),
        ("folder", &["--overwrite"], &["folder", "not an ordinary file"]),
        ("pipe", &["--overwrite"], &["pipe", "not an ordinary file"]),
    ] {
        ends_with(&to(file, more), 2, words);
        // No trial was made.
        assert!(!folder.join("cache").exists(), "{file}");
    }
    ends_with(&to("no/such/plan.toml", &[]), 5, &["no/such/plan.toml"]);
    assert!(!folder.join("cache").exists());
    assert_eq!(fs::read(&scene).unwrap(), own);
    ends_with(&to("link.toml", &["--overwrite"]), 0, &[]);
    assert!(fs::symlink_metadata(folder.join("link.toml")).unwrap().is_file());
    assert!(fs::read_to_string(folder.join("link.toml")).unwrap().starts_with("# Plan by stripmine explain"));
    assert_eq!(fs::read_to_string(folder.join("mine.txt")).unwrap(), "mine");
    assert!(fs::metadata(folder.join("pipe")).unwrap().file_type().is_fifo());
    // No temporary file is left.
    let names: Vec<_> = fs::read_dir(folder).unwrap().map(|it| it.unwrap().file_name()).collect();
    assert_eq!(names.len(), 7, "{names:?}");
}

/// A cache that cannot be read or written causes a warning, and the plan is still made: a file instead of its folder, or a pipe or an endless device
/// instead of a cached file.
#[cfg(unix)]
#[test]
fn unusable_cache_does_not_prevent_a_plan() {
    use std::os::unix::fs::symlink;
    let begin = |folder: &Path| {
        let mut command = Command::cargo_bin("stripmine").unwrap();
        command.current_dir(folder).env("XDG_CACHE_HOME", folder.join("cache")).arg("explain").args(GAS);
        command.args(["--error", "5%", "--json"]).output().unwrap()
    };
    let warned = |output: &Output| {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && said.contains("warning: trials are not cached"), "{said}");
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(found["mean"][0].as_f64().unwrap() > 3.0, "{found:#}");
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cache"), "mine").unwrap();
    warned(&begin(folder.path()));
    assert_eq!(fs::read_to_string(folder.path().join("cache")).unwrap(), "mine");
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert!(begin(folder).status.success());
    let kept = fs::read_dir(folder.join("cache/stripmine/explain")).unwrap().next().unwrap().unwrap().path();
    let pipe = |file: &Path| assert!(Command::new("mkfifo").arg(file).status().unwrap().success());
    let endless = |file: &Path| symlink("/dev/zero", file).unwrap();
    let long = |file: &Path| fs::write(file, vec![b' '; 5 << 20]).unwrap();
    let half = |file: &Path| fs::write(file, "{\"scene\": \"").unwrap();
    let all: [&dyn Fn(&Path); 4] = [&pipe, &endless, &long, &half];
    for make in all {
        fs::remove_file(&kept).unwrap();
        make(&kept);
        warned(&begin(folder));
        // The measurements are cached again in its place.
        assert!(fs::symlink_metadata(&kept).unwrap().is_file());
    }
}

/// A relative XDG_CACHE_HOME is ignored.
#[test]
fn a_relative_cache_folder_is_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let home = folder.path().join("home");
    fs::create_dir(&home).unwrap();
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder.path()).env("XDG_CACHE_HOME", "cache").env("HOME", &home).arg("explain");
    ends_with(&command.args(GAS).args(["--error", "5%", "--quiet"]).output().unwrap(), 0, &[]);
    assert!(!folder.path().join("cache").exists());
    assert_eq!(fs::read_dir(home.join(".cache/stripmine/explain")).unwrap().count(), 1);
}

/// Quantities without scatter are cached too, including infinitely many degrees of freedom.
#[test]
fn constant_quantities_are_cached() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // The temperature of elastic hard discs is constant; the energy of two bodies is conserved.
    for (scene, quantity) in [("hard-disks", "temperature"), ("kepler", "energy_error")] {
        let asked = [scene, "--of", quantity, "--json"];
        let found = plan(&explain(folder, &[&asked[..], &["--seconds", "1"]].concat()));
        let again = plan(&explain(folder, &[&asked[..], &["--estimate"]].concat()));
        assert!(again["origin"].as_str().unwrap().starts_with("cached on"), "{again:#}");
        assert_eq!(again["mean"], found["mean"]);
        assert!(
            again["time"].as_f64().unwrap() > 0.0 && again["expected"]["most"].as_f64().is_some(),
            "{again:#}"
        );
    }
}

/// Files of the user in the cache stay.
#[test]
fn forgetting_removes_cached_measurements_only() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    plan(&explain(folder, &[&GAS[..], &["--error", "5%", "--json"]].concat()));
    let cache = folder.join("cache/stripmine/explain");
    let key = "0123456789abcdef01234567.json";
    let mine =
        [("mine.json", "{\"scene\":\"mine\"}"), (key, "{\"scene\":\"another\"}"), ("notes.txt", "mine")];
    mine.iter().for_each(|(name, text)| fs::write(cache.join(name), text).unwrap());
    let forgotten = explain(folder, &["--forget"]);
    assert_eq!(String::from_utf8_lossy(&forgotten.stdout), "removed 1 cached measurement\n");
    let mut left: Vec<_> = fs::read_dir(&cache).unwrap().map(|it| it.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, [key, "mine.json", "notes.txt"]);
    assert!(mine.iter().all(|(name, text)| fs::read_to_string(cache.join(name)).unwrap() == *text));
}

/// A scene is read once: trials, plan and plan file use the scene as it was at the start.
#[test]
fn plans_use_the_scene_as_first_read() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = folder.join("scene.toml");
    let mut show = Command::cargo_bin("stripmine").unwrap();
    fs::write(&scene, show.args(["scene", "show", "hard-disks"]).output().unwrap().stdout).unwrap();
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder).env("XDG_CACHE_HOME", folder.join("cache")).args(["explain", "scene.toml"]);
    command
        .args(&GAS[1..])
        .args(["--error", "5%", "--write", "plan.toml"])
        .stderr(std::process::Stdio::piped());
    let mut running = command.spawn().unwrap();
    // The first message comes after the scene is read.
    let mut said = std::io::BufReader::new(running.stderr.take().unwrap());
    std::io::BufRead::read_line(&mut said, &mut String::new()).unwrap();
    fs::write(&scene, "none").unwrap();
    std::io::copy(&mut said, &mut std::io::sink()).unwrap();
    assert!(running.wait().unwrap().success());
    assert!(fs::read_to_string(folder.join("plan.toml")).unwrap().contains("hard-disks"));
}

/// A plan that takes more than a minute is printed but not carried out if no terminal can confirm it.
#[test]
fn long_plans_run_only_when_confirmed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let long = explain(folder, &[&GAS[..], &["--error", "0.001%", "--limit", "1e9", "--analyze"]].concat());
    ends_with(&long, 2, &["was not executed", "takes about", "--yes"]);
    let page = String::from_utf8_lossy(&long.stdout).into_owned();
    assert!(
        page.contains("stripmine run hard-disks") && page.contains("expected: compressibility"),
        "{page}"
    );
    ends_with(&explain(folder, &["hard-disks", "--yes"]), 2, &["--analyze"]);
}

/// Values that `auto` takes from cached measurements of a similar scene are reported, written to the resolved scene, and used by a resumption. Keys
/// that the
/// scene sets stay as they are, and a scene without similar measurements runs as usual.
#[test]
fn runs_are_tuned_by_measurements_of_similar_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let gas = |count: &'static str| ["dense-gas", "--set", count, "--set", "particles.packing_fraction=0.3"];
    plan(&explain(folder, &[&gas("particles.count=100")[..], &["--seconds", "4", "--json"]].concat()));
    let run = |count: &'static str, more: &[&str]| {
        let mut command = Command::cargo_bin("stripmine").unwrap();
        command.current_dir(folder).env("XDG_CACHE_HOME", folder.join("cache")).arg("run");
        command.args(gas(count)).args(["--set", "run.steps=20", "--out", "out", "--tuned"]).args(more);
        let output = command.output().unwrap();
        ends_with(&output, 0, &[]);
        let scene = fs::read_to_string(folder.join("out/scene.toml")).unwrap();
        (String::from_utf8_lossy(&output.stderr).into_owned(), scene)
    };
    // The cheapest cached configuration.
    let kept = fs::read_dir(folder.join("cache/stripmine/explain")).unwrap().next().unwrap().unwrap().path();
    let kept: Value = serde_json::from_slice(&fs::read(kept).unwrap()).unwrap();
    let is_own = |configuration: &&Value| {
        let label = configuration["label"].as_str().unwrap();
        label.starts_with("gear6 f64") && label.ends_with("fast") && !configuration["cost"].is_null()
    };
    let configurations = kept["findings"]["configurations"].as_array().unwrap();
    let cheapest = configurations.iter().find(is_own).unwrap()["settings"].as_array().unwrap();
    let search = cheapest.iter().find(|it| it[0] == "search").unwrap()[1].as_str().unwrap();
    let (said, scene) = run("particles.count=150", &[]);
    assert!(said.contains(&format!("tuned: search.by={search}")) && said.contains("measured"), "{said}");
    assert!(scene.contains(&format!("by = \"{search}\"")), "{scene}");
    let (said, again) = run("particles.count=150", &["--resume"]);
    assert!(!said.contains("tuned:") && again == scene, "{said}");
    let (said, scene) = run("particles.count=150", &["--overwrite", "--set", "search.by=sectors"]);
    assert!(!said.contains("search.by=") && scene.contains("by = \"sectors\""), "{said}");
    let (said, _) = run("particles.count=1500", &["--overwrite"]);
    assert!(said.contains("no similar scene was measured"), "{said}");
}

#[test]
fn conserved_quantities_determine_the_step() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let asked = ["kepler", "--of", "energy_error", "--error", "1e-6", "--seconds", "2", "--json"];
    let found = plan(&explain(folder, &[&asked[..], &["--write", "plan.toml"]].concat()));
    assert!(found["mean"].is_null() && found["expected"]["most"].as_f64().unwrap() <= 1e-6, "{found:#}");
    let mut command = Command::cargo_bin("stripmine").unwrap();
    let run =
        command.current_dir(folder).args(["run", "plan.toml", "--out", "out", "--quiet"]).output().unwrap();
    ends_with(&run, 0, &[]);
    let summary: Value = serde_json::from_slice(&fs::read(folder.join("out/summary.json")).unwrap()).unwrap();
    let all = summary["averages"]["quantities"].as_array().unwrap();
    let error = all.iter().find(|it| it["quantity"] == "energy_error").unwrap();
    assert!(error["says"] == "kept" && error["farthest"].as_f64().unwrap() <= 1e-6, "{error:#}");
    // The scene's own leapfrog is less accurate.
    let own = found["own"]["error"]["most"].as_f64().unwrap();
    assert!(own > 1e-5, "{own}");
}

#[test]
fn impossible_plans_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let bad = |arguments: &[&str]| explain(folder, arguments);
    ends_with(&bad(&["hard-disks", "--of", "colour"]), 2, &["`colour`", "one of events", "compressibility"]);
    ends_with(&bad(&["hard-disks", "--error", "little"]), 2, &["above 0, or a percentage such as 1%"]);
    ends_with(&bad(&["nothing.toml"]), 3, &["nothing.toml"]);
    let cooling = ["cooling-gas", "--of", "temperature", "--error", "1%", "--seconds", "1"];
    ends_with(
        &bad(&cooling),
        4,
        &["temperature did not become stationary during the trials", "still changing"],
    );
    let kepler = ["kepler", "--of", "energy_error", "--error", "1e-30", "--seconds", "1"];
    ends_with(
        &bad(&kepler),
        4,
        &["no configuration tried reaches an error of 1e-30 of energy_error", "the smallest error found is"],
    );
}

/// A window of a free fall: from rest, the mean kinetic energy over a window from t to T is m g² (T³ − t³)/(6 (T − t)) before any impact.
#[test]
fn means_over_a_window_are_planned() {
    let folder = tempfile::tempdir().unwrap();
    let disc = [
        "two-discs",
        "--set",
        "domain.gravity=[0.0, -1e-8]",
        "--set",
        "particles.velocities=[[0.0, 0.0], [0.0, 0.0]]",
        "--set",
        "particles.positions=[[3.0, 6.0], [8.0, 6.0]]",
        "--seconds",
        "2",
        "--of",
        "kinetic",
    ];
    let at = |window: [&str; 2]| {
        let asked = [&disc[..], &["--error", "1%", "--json", "--window"], &window].concat();
        explain(folder.path(), &asked)
    };
    let found = plan(&at(["1", "2"]));
    // Two discs of mass 1; gravity is so weak that they fall for as long as trials may take.
    let expected = 1e-16 * 2.0 * (8.0 - 1.0) / 6.0;
    let [mean, bar] = [0, 1].map(|place| found["mean"][place].as_f64().unwrap());
    assert!((mean - expected).abs() < 0.01 * expected + bar && found["time"] == 2.0, "{found:#}");
    ends_with(&at(["2", "1"]), 2, &["is not a time window", "--window 2 8"]);
}

/// Stopped trials leave a journal, from which the same command resumes; then the measurements are cached and the journal is removed.
#[cfg(unix)]
#[test]
fn stopped_trials_resume() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder).env("XDG_CACHE_HOME", folder.join("cache")).arg("explain");
    let asked = ["plummer", "--set", "particles.count=256", "--of", "balance_error", "--error", "1e-30"];
    command.args(asked).args(["--seconds", "3", "--quiet"]);
    let journals = || {
        let all = fs::read_dir(folder.join("cache/stripmine/explain")).into_iter().flatten().flatten();
        all.map(|it| it.path().join("journal.jsonl")).filter(|it| it.is_file()).collect::<Vec<_>>()
    };
    let runs = || journals().first().map_or(0, |file| fs::read_to_string(file).unwrap().lines().count());
    let mut child = command.stderr(std::process::Stdio::piped()).spawn().unwrap();
    while runs() < 3 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let ended = child.wait_with_output().unwrap();
    // On a busy machine the command may have finished first.
    let code = ended.status.code();
    if code == Some(130) {
        assert!(runs() >= 3);
    } else {
        ends_with(&ended, 4, &["no configuration tried reaches"]);
    }
    ends_with(&command.output().unwrap(), 4, &["no configuration tried reaches an error of 1e-30"]);
    assert_eq!((journals(), runs()), (vec![], 0));
}

/// A quantity that changes all the time has no stationary mean: `explain` estimates the mean over the whole run, from runs with different starts.
#[test]
fn nonstationary_quantities_are_averaged_over_the_run() {
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
    // Grains fall some centimetres, and have less than that energy for part of the time.
    let most = 30.0 * 1e-6 * 9.81 * 0.15;
    assert!((0.001 * most..most).contains(&mean) && bar < 0.5 * mean, "{mean} {bar}");
    let rows = found["analyzed"].as_array().unwrap();
    assert!(
        rows.iter().any(|row| row["what"].as_str().unwrap().starts_with("mean kinetic over the run")),
        "{rows:#?}"
    );
    assert!(rows.iter().any(|row| row["what"] == "of it: forces") && rows.len() > 4, "{rows:#?}");
}

#[test]
fn plans_for_a_time_minimise_the_error() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let within = |seconds: &str| plan(&explain(folder, &[&GAS[..], &["--time", seconds, "--json"]].concat()));
    let [short, long] = ["0.5", "2"].map(within);
    for (found, seconds) in [(&short, 0.5), (&long, 2.0)] {
        let likely = found["seconds"]["likely"].as_f64().unwrap();
        assert!(likely <= seconds && likely > 0.5 * seconds, "{likely} of {seconds}");
    }
    let [short, long] = [short, long].map(|found| found["expected"]["most"].as_f64().unwrap());
    // Twice the error: the square root of four times the time.
    assert!((1.5..3.0).contains(&(short / long)), "{short} {long}");
    let quick = explain(folder, &[&GAS[..], &["--time", "1e-7"]].concat());
    ends_with(
        &quick,
        4,
        &["compressibility cannot be estimated within 1e-7 s", "the shortest run takes about", "--time"],
    );
    for wrong in ["0", "-1", "nan", "soon"] {
        ends_with(&explain(folder, &["hard-disks", &format!("--time={wrong}")]), 2, &["seconds above 0"]);
    }
    ends_with(&explain(folder, &["hard-disks", "--time", "1", "--error", "1%"]), 2, &["cannot be used with"]);
}

/// Errors fall with cost, and the biases of steps are shown with them; `work-precision` of a mean is the same chart.
#[test]
fn error_of_a_mean_is_charted_against_cost() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (chart, scene, quantity, configurations) in [
        ("accuracy", "langevin-dense", "potential", 2..=2),
        // A configuration that costs several times as much is left out and named.
        ("work-precision", "hard-disks", "compressibility", 1..=2),
    ] {
        let mut command = Command::cargo_bin("stripmine").unwrap();
        command.current_dir(folder).args(["chart", chart, scene, "--budget", "6", "--json", "--quiet"]);
        let output = command.args(["--set", "particles.count=100", "--of", quantity]).output().unwrap();
        let data = plan(&output);
        let mut curves: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for point in data["points"].as_array().unwrap() {
            let errors = curves.entry(point["configuration"].as_str().unwrap()).or_default();
            errors.push(point["error"].as_f64().unwrap());
        }
        assert!(
            data["summary"][0]["quantity"] == quantity && configurations.contains(&curves.len()),
            "{data:#}"
        );
        for (curve, errors) in curves {
            assert!(errors.len() > 3 && errors.last() < errors.first(), "{curve}: {errors:?}");
        }
        let name = "accuracy";
        let pictures = folder.join(format!("{scene}.{name}/host/{name}"));
        let svg = fs::read_dir(pictures)
            .unwrap()
            .flatten()
            .filter(|file| file.path().extension().is_some_and(|it| it == "svg"));
        assert_eq!(svg.count(), if chart == "accuracy" { 2 } else { 1 });
    }
}

/// Walls and lines of a scene have quantities of their own, which are known by their numbers.
#[test]
fn quantities_of_walls_and_lines_are_known() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let hopper = ["hopper", "--set", "particles.count=40", "--set", "run.time=20", "--seconds", "6"];
    ends_with(
        &explain(folder, &[&hopper[..], &["--of", "flux_9_count"]].concat()),
        2,
        &["does not observe `flux_9_count`", "flux_1_count", "wall_1_impulse_y"],
    );
    for quantity in ["flux_1_count", "wall_1_impulse_y"] {
        let output =
            explain(folder, &[&hopper[..], &["--of", quantity, "--error", "50%", "--json"]].concat());
        if output.status.code() == Some(0) {
            let found = plan(&output);
            let mean = found["mean"][0].as_f64().unwrap();
            assert!(found["quantity"] == quantity && mean.is_finite(), "{found:#}");
            // Grains fall to the right of the line, and press the inclined wall down.
            assert_eq!(mean > 0.0, quantity == "flux_1_count", "{quantity}: {found:#}");
        } else {
            ends_with(&output, 4, &[quantity, "help: "]);
        }
    }
}
