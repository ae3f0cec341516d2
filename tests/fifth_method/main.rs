//! A method is one folder and one line of a list: the unchanged verbs read the scenes of a method that only this test contains,
//! and run, resume, observe, measure and document it.
//!
//! The test is its own command: with an environment variable set, it carries out its arguments with that list of methods.

#[path = "../promises/configurations.rs"]
mod configurations;
#[path = "../promises/files.rs"]
mod files;
mod free_flight;
#[path = "../promises/short.rs"]
mod short;
#[path = "../promises/table.rs"]
mod table;

use std::path::Path;
use std::process::{Command, ExitCode, Output};
use stripmine_physics::method::{Methods, lattice_md};

static METHODS: Methods = &[&lattice_md::ENTRY, &free_flight::ENTRY];

const AS_COMMAND: &str = "STRIPMINE_TEST_AS_COMMAND";

fn main() -> ExitCode {
    if std::env::var_os(AS_COMMAND).is_some() {
        return stripmine::cli::run_with(std::env::args_os(), METHODS);
    }
    scenes_are_listed_checked_and_refused();
    a_run_is_observed();
    free_flight_keeps_all_promises();
    it_is_measured();
    it_is_studied();
    it_is_documented();
    println!("the fifth method works in every verb");
    ExitCode::SUCCESS
}

fn command() -> Command {
    let mut command = Command::new(std::env::current_exe().expect("the test has a path"));
    command.env(AS_COMMAND, "1");
    command
}

fn stripmine(arguments: &[&str]) -> Output {
    command().args(arguments).output().expect("the test can be run")
}

fn succeeds(arguments: &[&str]) -> String {
    let output = stripmine(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("it prints text")
}

fn data(arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&succeeds(arguments)).expect("it prints JSON")
}

fn scenes_are_listed_checked_and_refused() {
    let list = succeeds(&["scene", "list"]);
    assert!(list.contains("drift") && list.contains("two-discs"), "{list}");
    let found = data(&["scene", "check", "drift", "--json"]);
    assert_eq!((found["method"].as_str(), found["discs"].as_u64()), (Some("free-flight"), Some(20)));
    for (set, words) in [
        ("law.stiffness=1", "it is a key of scenes with method.kind = \"lattice-md\""),
        ("particles.cuont=3", "did you mean `particles.count`?"),
        ("method.kind=free-fligth", "did you mean \"free-flight\"?"),
        ("particles.count=4000", "random placement jams"),
    ] {
        let refused = stripmine(&["scene", "check", "drift", "--set", set]);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(3) && said.contains(words), "{set}: {said}");
    }
}

fn a_run_is_observed() {
    let folder = tempfile::tempdir().expect("there is room");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let whole = path("whole");
    succeeds(&["run", "drift", "--out", &whole]);
    let read = |run: &str, file: &str| std::fs::read_to_string(Path::new(run).join(file)).expect(file);
    let rows: Vec<Vec<f64>> = read(&whole, "thermo.csv")
        .lines()
        .skip(1)
        .map(|row| row.split(',').map(|number| number.parse().expect("a number")).collect())
        .collect();
    assert!(read(&whole, "thermo.csv").starts_with("step,time,kinetic\n"));
    assert_eq!((rows.len(), rows[8][0], rows[8][1]), (9, 64.0, 8.0));
    assert!(rows.iter().all(|row| row[2] == rows[0][2] && row[2] > 1.0));
    let summary: serde_json::Value = serde_json::from_str(&read(&whole, "summary.json")).expect("JSON");
    assert_eq!((summary["discs"].as_u64(), summary["steps"].as_u64()), (Some(20), Some(64)));
    let refused = stripmine(&["run", "drift", "--out", &whole, "--resume", "--set", "run.steps=3"]);
    assert_eq!(refused.status.code(), Some(2));
}

fn free_flight_keeps_all_promises() {
    static FIFTH: Methods = &[&free_flight::ENTRY];
    let held = table::hold(FIFTH, command, table::Extent::Quick);
    assert!(held.presets == 1 && held.engines == 1 && held.sessions > 2, "{held:?}");
}

fn it_is_measured() {
    let measured = data(&["bench", "free-flight", "--json", "--repeats", "2", "--particles", "30"]);
    assert_eq!((measured["what"].as_str(), measured["particles"].as_u64()), (Some("free-flight"), Some(30)));
    assert!(measured["particle_steps_per_second"].as_f64().is_some_and(|rate| rate > 0.0));
    assert_eq!(measured["kinetic"][0], measured["kinetic"][1]);
    let refused = stripmine(&["bench", "free-flight", "--precision", "f32"]);
    assert_eq!(refused.status.code(), Some(2), "{}", String::from_utf8_lossy(&refused.stderr));
}

fn it_is_studied() {
    let folder = tempfile::tempdir().expect("there is room");
    let out = folder.path().join("study").display().to_string();
    let study = ["chart", "work-precision", "drift", "--out", &out, "--budget", "1", "--json"];
    let found = data(&study);
    let runs = found["runs"].as_array().expect("there are runs");
    // Free flight is exact for any step, except for rounding.
    let error = |run: &serde_json::Value| run["position_rms"].as_f64();
    assert!(
        runs.len() > 4 && runs.iter().all(|run| error(run).is_some_and(|error| error < 1e-9)),
        "{runs:?}"
    );
    assert!(Path::new(&out).join("host/work-precision/drift_searches.svg").metadata().is_err());
}

fn it_is_documented() {
    let help = succeeds(&["bench", "--help"]);
    assert!(help.contains("free-flight") && help.contains("Discs that do not meet"), "{help}");
    let keys = succeeds(&["scene", "keys", "free-flight"]);
    assert!(keys.contains("dt") && !keys.contains("stiffness"), "{keys}");
}
