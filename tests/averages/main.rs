//! Averages as a user sees them: at the end of a run, from its files, over several runs, and as a run's stopping criterion.

mod coverage;

use assert_cmd::cargo::CommandCargoExt;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// A gas of hard discs whose runs take no noticeable time.
const GAS: [&str; 4] = ["--set", "run.thermo_every=0.05", "--set", "particles.count=100"];

fn stripmine(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder).args(arguments).arg("--quiet").output().unwrap()
}

fn run(folder: &Path, out: &str, more: &[&str]) -> Output {
    stripmine(folder, &[&["run", "hard-disks", "--out", out], &GAS[..], more].concat())
}

fn ends_with(output: &Output, code: i32, words: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{said}");
    words.iter().for_each(|word| assert!(said.contains(word), "{word} is not in: {said}"));
}

fn averages(folder: &Path, out: &str) -> Value {
    let text = fs::read_to_string(folder.join(out).join("summary.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["averages"].clone()
}

/// Entry of a quantity in the averages.
fn of<'a>(averages: &'a Value, name: &str) -> &'a Value {
    let all = averages["quantities"].as_array().unwrap();
    all.iter().find(|it| it["quantity"] == name).unwrap()
}

#[test]
fn summary_has_means_and_their_errors() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "a", &["--set", "run.events=20000"]);
    ends_with(&output, 0, &[]);
    let text = String::from_utf8_lossy(&output.stdout);
    for words in
        ["at the end: 100 discs", "means, ± 95 % (Student's t):", "compressibility", "constant: kinetic"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    let found = averages(folder.path(), "a");
    let z = of(&found, "compressibility");
    let [mean, bar, samples] = ["mean", "bar", "independent_samples"].map(|name| z[name].as_f64().unwrap());
    assert!(z["says"] == "mean" && z["of"] == "intervals" && samples > 100.0, "{z:#}");
    // Scaled particle theory in two dimensions: Z = 1/(1 − ν)², accurate to 2 % at ν = 0.5.
    assert!((mean - 4.0).abs() < 0.2 && bar < 0.1, "{mean} {bar}");
    assert_eq!(of(&found, "kinetic")["says"], "constant");
    assert_eq!(of(&found, "energy_error")["says"], "kept");
    assert_eq!(of(&found, "collisions")["unit"], "1/time");
    // `average` reports the same from the run's files.
    let again = stripmine(folder.path(), &["average", "a", "--json"]);
    assert_eq!(serde_json::from_slice::<Value>(&again.stdout).unwrap(), found);
    let table = stripmine(folder.path(), &["average", "a", "--csv"]);
    let table = String::from_utf8_lossy(&table.stdout);
    assert!(
        table.starts_with("quantity,mean,mean_error_95,unit,") && table.contains("\ncompressibility,"),
        "{table}"
    );
}

#[test]
fn averages_do_not_depend_on_sessions() {
    let folder = tempfile::tempdir().unwrap();
    ends_with(&run(folder.path(), "whole", &["--set", "run.events=20000"]), 0, &[]);
    ends_with(&run(folder.path(), "parts", &["--set", "run.events=7777"]), 0, &[]);
    ends_with(&run(folder.path(), "parts", &["--set", "run.events=20000", "--resume"]), 0, &[]);
    assert_eq!(averages(folder.path(), "parts"), averages(folder.path(), "whole"));
}

#[test]
fn only_runs_with_different_seeds_are_joined() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (out, seed) in [("a", "particles.seed=1"), ("b", "particles.seed=2"), ("c", "particles.seed=1")] {
        ends_with(&run(folder, out, &["--set", "run.events=10000", "--set", seed]), 0, &[]);
    }
    let output = stripmine(folder, &["average", "a", "b", "--json"]);
    let joined: Value = serde_json::from_slice(&output.stdout).unwrap();
    // The system is closed: each run has its own energy and is one sample. Expected values by hand, from two means.
    let [a, b] = ["a", "b"].map(|out| of(&averages(folder, out), "collision_rate")["mean"].as_f64().unwrap());
    let rate = |name: &str| of(&joined, "collision_rate")[name].as_f64().unwrap();
    assert!(joined["runs"] == 2 && rate("freedoms") == 1.0, "{joined:#}");
    assert!((rate("mean") - 0.5 * (a + b)).abs() < 1e-9, "{joined:#}");
    assert!((rate("bar") / (12.706 * 0.5 * (a - b).abs()) - 1.0).abs() < 1e-4, "{joined:#}");
    ends_with(&stripmine(folder, &["average", "a", "c"]), 2, &["are the same run", "its own seed"]);
    ends_with(&run(folder, "d", &["--set", "run.events=2000", "--set", "law.restitution=0.99"]), 0, &[]);
    ends_with(
        &stripmine(folder, &["average", "a", "d", "--structure", "msd"]),
        2,
        &["a and d have different scenes"],
    );
    ends_with(&stripmine(folder, &["average", "none"]), 5, &["none/thermo.csv"]);
    fs::create_dir(folder.join("odd")).unwrap();
    fs::write(folder.join("odd/thermo.csv"), "step,time,colour\n0,0.0,1.0\n").unwrap();
    ends_with(&stripmine(folder, &["average", "odd"]), 3, &["odd/thermo.csv", "not those of any method"]);
}

#[test]
fn run_until_stops_at_the_target_error() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let target = r#"run.until={ quantity = "compressibility", error = "2%" }"#;
    let wanted = ["--set", "run.events=10000000", "--set", target];
    ends_with(&run(folder, "whole", &wanted), 0, &[]);
    let found = averages(folder, "whole");
    let z = of(&found, "compressibility");
    let [mean, bar] = ["mean", "bar"].map(|name| z[name].as_f64().unwrap());
    assert!(bar <= 0.02 * mean && bar > 0.01 * mean, "{mean} {bar}");
    // In two sessions, of which the first stops early: the same rows and the same end.
    ends_with(&run(folder, "parts", &["--set", "run.events=3000"]), 0, &[]);
    ends_with(&run(folder, "parts", &[&wanted[..], &["--resume"]].concat()), 0, &[]);
    let bytes = |out: &str, file: &str| fs::read(folder.join(out).join(file)).unwrap();
    assert_eq!(bytes("parts", "thermo.csv"), bytes("whole", "thermo.csv"));
    // The run is complete.
    ends_with(&run(folder, "whole", &[&wanted[..], &["--resume"]].concat()), 0, &[]);
    assert_eq!(bytes("parts", "thermo.csv"), bytes("whole", "thermo.csv"));
    // A limit of events that is reached first.
    let short =
        ["--set", "run.events=20000", "--set", r#"run.until={ quantity = "compressibility", error = 1e-4 }"#];
    let output = run(folder, "short", &short);
    ends_with(
        &output,
        4,
        &["latest end, run.events=20000,", "known to ± 0.", "not to ± 1e-4 (95 %)", "about time"],
    );
    assert_eq!(of(&averages(folder, "short"), "compressibility")["says"], "mean");
}

#[test]
fn seeds_make_an_ensemble() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let wanted = ["--set", "run.events=5000", "--seeds", "3", "--json"];
    let output = run(folder, "all", &wanted);
    ends_with(&output, 0, &[]);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let members = ["all/seed-1", "all/seed-2", "all/seed-3"];
    let folders: Vec<&str> =
        found["runs"].as_array().unwrap().iter().map(|run| run["folder"].as_str().unwrap()).collect();
    assert_eq!(folders, members);
    // `average` reports the same from these folders, and each folder equals a single run of its seed.
    let joined = stripmine(folder, &[&["average"], &members[..], &["--json"]].concat());
    assert_eq!(serde_json::from_slice::<Value>(&joined.stdout).unwrap(), found["averages"]);
    // So it does from the folder, and from all that is in it.
    let all = ["all/seed-1", "all/seed-2", "all/seed-3", "all/seeds.files", "all/seeds.json"];
    for paths in [&["all"][..], &all] {
        let joined = stripmine(folder, &[&["average"], paths, &["--json"]].concat());
        assert_eq!(serde_json::from_slice::<Value>(&joined.stdout).unwrap(), found["averages"]);
    }
    ends_with(&stripmine(folder, &["average", "all/seeds.files"]), 5, &["all/seeds.files"]);
    ends_with(&run(folder, "two", &["--set", "run.events=5000", "--set", "particles.seed=2"]), 0, &[]);
    let bytes = |out: &str| fs::read(folder.join(out).join("thermo.csv")).unwrap();
    assert_eq!(bytes("two"), bytes("all/seed-2"));
    assert!(folder.join("all/seeds.json").is_file());
    ends_with(&run(folder, "all", &wanted), 2, &["all/seed-1 already contains a run"]);
    ends_with(&run(folder, "all", &[&wanted[..], &["--resume"]].concat()), 0, &[]);
    let output = stripmine(folder, &["run", "two-discs", "--seeds", "2"]);
    ends_with(&output, 2, &["this scene has no random numbers"]);
}

/// Two particles in a bath that collide in some runs only: runs without a collision report no mean, and no run is left out of a join.
#[test]
fn rare_events_give_no_mean_before_they_happen() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let pair = [
        "run",
        "langevin-free",
        "--set",
        "particles.count=2",
        "--set",
        "law.kind=wca",
        "--set",
        "particles.radius=0.5",
    ];
    let pair =
        [&pair[..], &["--set", "particles.generate=random", "--set", "domain.sides=[14.0, 14.0]"]].concat();
    let pair = [&pair[..], &["--set", "run.thermo_every=20", "--set", "run.time=60"]].concat();
    let target = r#"run.until={ quantity = "potential", error = "20%" }"#;
    let alone = ["--set", "domain.sides=[400.0, 400.0]", "--set", target, "--out", "alone"];
    ends_with(&stripmine(folder, &[&pair[..], &alone].concat()), 4, &["mean of potential is not known"]);
    let mut folders = vec![];
    for seed in 1..=6 {
        let (seed, out) = (format!("particles.seed={seed}"), format!("{seed}.run"));
        ends_with(&stripmine(folder, &[&pair[..], &["--set", &seed, "--out", &out]].concat()), 0, &[]);
        folders.push(out);
    }
    let joined = |folders: &[String]| -> Value {
        let folders: Vec<&str> = folders.iter().map(String::as_str).collect();
        let output = stripmine(folder, &[&["average"], &folders[..], &["--json"]].concat());
        of(&serde_json::from_slice::<Value>(&output.stdout).unwrap(), "potential").clone()
    };
    let first = joined(&folders);
    folders.reverse();
    let last = joined(&folders);
    assert!(first["says"] == last["says"] && first["says"] != "constant", "{first:#} {last:#}");
    let samples = |it: &Value| it["independent_samples"].as_f64().unwrap();
    assert!((samples(&last) - samples(&first)).abs() < 1e-9, "{first:#} {last:#}");
    // Rows so close that no hard discs collide between them.
    let target = r#"run.until={ quantity = "compressibility", error = "1%" }"#;
    let close = [
        "run",
        "hard-disks",
        "--set",
        "particles.count=100",
        "--set",
        "run.thermo_every=1e-5",
        "--out",
        "close",
    ];
    let output = stripmine(folder, &[&close[..], &["--set", "run.events=100", "--set", target]].concat());
    ends_with(&output, 4, &["latest end, run.events=100"]);
}

/// Different starts with the same noise converge to one run in a bath.
#[test]
fn runs_with_the_same_noise_are_not_joined() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (out, seed, noise) in [
        ("a", 1, "law.noise_seed=7"),
        ("b", 2, "law.noise_seed=7"),
        ("c", 7, "law.drag=1"),
        ("d", 1, "law.noise_seed=8"),
    ] {
        let seed = format!("particles.seed={seed}");
        let free =
            ["run", "langevin-free", "--set", "particles.count=50", "--set", "run.time=20", "--out", out];
        ends_with(&stripmine(folder, &[&free[..], &["--set", &seed, "--set", noise]].concat()), 0, &[]);
    }
    ends_with(&stripmine(folder, &["average", "a", "b"]), 2, &["a and b have the same noise, of seed 7"]);
    ends_with(&stripmine(folder, &["average", "a", "c"]), 2, &["have the same noise"]);
    ends_with(&stripmine(folder, &["average", "a", "d"]), 0, &[]);
}

/// Particles that start at 50 000 times the temperature of their bath equilibrate within ten time units: the mean is that of the bath.
#[test]
fn short_transients_are_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    for every in ["60", "20"] {
        let hot =
            ["run", "langevin-free", "--set", "particles.count=100", "--set", "particles.temperature=5e4"];
        let hot = [
            &hot[..],
            &["--set", "integrator.dt=0.05", "--set", "run.time=3000", "--set", "run.snapshot_every=0"],
        ]
        .concat();
        let every = format!("run.thermo_every={every}");
        let own = ["--set", &every, "--overwrite", "--out", "hot"];
        ends_with(&stripmine(folder.path(), &[&hot[..], &own].concat()), 0, &[]);
        let found = averages(folder.path(), "hot");
        let [mean, bar, from] =
            ["mean", "bar", "equilibrated_at"].map(|name| of(&found, "temperature")[name].as_f64().unwrap());
        assert!(
            (mean - 1.0).abs() < bar && bar < 0.02 && (6.0..200.0).contains(&from),
            "{mean} {bar} {from}"
        );
    }
}

/// A single disc in a periodic box moves with the mean motion, so its temperature is undefined.
#[test]
fn undefined_quantities_are_reported_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let one = ["run", "hard-disks", "--set", "particles.count=1", "--set", "particles.generate=random"];
    let more = ["--set", "domain.sides=[20.0, 20.0]", "--set", "run.time=100", "--out", "one"];
    let output = stripmine(folder.path(), &[&one[..], &more].concat());
    ends_with(&output, 0, &[]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("not defined in some rows, without a mean: ") && !text.contains("NaN"), "{text}");
    assert_eq!(of(&averages(folder.path(), "one"), "temperature")["says"], "undefined");
}
