//! Studies that any method joins: speed against accuracy, as a user meets it.

use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
#[cfg(unix)]
use std::time::Duration;

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(arguments).stdin(Stdio::null());
    command
}

fn study(scene: &Path, out: &Path, more: &[&str]) -> Output {
    let paths = ["chart", "work-precision", scene.to_str().unwrap(), "--out", out.to_str().unwrap()];
    command(&[&paths[..], &["--json"], more].concat()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn succeeds(output: &Output) -> Value {
    assert!(output.status.success(), "{}", said(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Two discs that are pressed together for the whole time: forces without a kink.
const PRESSED: &str = r#"format = 2
units = "reduced"
[method]
kind = "lattice-md"
[domain]
sides = [12.0, 8.0]
periodic = [false, false]
[particles]
generate = "list"
positions = [[5.0, 4.0], [5.94, 4.0]]
velocities = [[0.2, 0.0], [-0.2, 0.0]]
radius = 0.5
mass = 1.0
[law]
stiffness = 100.0
[integrator]
values = 5
dt = 2e-3
[run]
time = 0.1
thermo_every = 10
"#;

fn pressed(folder: &Path) -> std::path::PathBuf {
    let scene = folder.join("pressed.toml");
    fs::write(&scene, PRESSED).unwrap();
    scene
}

/// Positions converge as theory says; velocity Verlet by its own order, Gear's schemes as their start allows. Energy of discs that
/// begin at rest converges with the orders of the schemes.
#[test]
fn orders_in_smooth_forces_are_those_of_theory() {
    let folder = tempfile::tempdir().unwrap();
    let scene = pressed(folder.path());
    let orders = |out: &str, more: &[&str], measure: &str| -> Vec<(String, f64, Option<f64>)> {
        let data = succeeds(&study(&scene, &folder.path().join(out), &[&["--budget", "4"], more].concat()));
        let of = data["orders"].as_array().unwrap().iter().filter(|order| order["error"] == measure);
        of.map(|order| {
            let scheme = order["scheme"].as_str().unwrap().to_owned();
            (scheme, order["order"].as_f64().unwrap(), order["theory"].as_f64())
        })
        .collect()
    };
    let moving = orders("moving", &[], "position, RMS");
    assert_eq!(moving.len(), 4);
    for (scheme, order, theory) in moving {
        assert!((order - theory.unwrap()).abs() < 0.2, "{scheme}: {order}, {theory:?}");
    }
    let at_rest =
        orders("rest", &["--set", "particles.velocities=[[0.0,0.0],[0.0,0.0]]"], "energy balance (relative)");
    let expected = [("velocity-verlet", 2.0), ("gear4", 3.0), ("gear5", 4.0)];
    for (name, theory) in expected {
        let (_, order, _) = at_rest.iter().find(|(scheme, ..)| scheme == name).unwrap();
        assert!((order - theory).abs() < 0.2, "{name}: {order}");
    }
}

/// One collision: over all phases of a step the error has the order of the kink or of the jump, and its mean falls faster.
#[test]
fn a_collision_errs_by_the_phase_of_its_step() {
    let folder = tempfile::tempdir().unwrap();
    let orders = |out: &str, more: &[&str]| -> Vec<(f64, f64)> {
        let undone = ["--budget", "20", "--set", "run.time=2.6", "--set", "law.friction=0"];
        let output = study(Path::new("two-discs"), &folder.path().join(out), &[&undone, more].concat());
        let data = succeeds(&output);
        let orders = data["collision"].as_array().unwrap();
        let of = orders.iter().filter(|order| order["outcome"] == "restitution");
        of.map(|it| {
            let [of_rms, of_mean] = ["order_of_the_rms", "order_of_the_mean"].map(|order| it[order].as_f64());
            (of_rms.unwrap(), of_mean.unwrap_or(f64::NAN))
        })
        .collect()
    };
    let damped = orders("damped", &[]);
    assert!(damped.iter().all(|(spread, _)| (spread - 1.0).abs() < 0.2), "{damped:?}");
    let elastic = orders("elastic", &["--set", "law.normal_damping=0"]);
    // The first is velocity Verlet, which keeps an energy; Gear's schemes lose some of it in a smooth contact, too.
    let (spread, _) = elastic[0];
    assert!((spread - 2.5).abs() < 0.2, "{elastic:?}");
}

#[cfg(unix)]
#[test]
fn a_study_that_was_interrupted_goes_on_and_another_scenes_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (pressed(folder.path()), folder.path().join("study"));
    let journal = out.join("journal.jsonl");
    let arguments =
        ["chart", "work-precision", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--budget", "3"];
    let mut child = command(&arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let lines = || fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
    while lines() < 100 {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it was interrupted");
        std::thread::sleep(Duration::from_millis(5));
    }
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    assert!(!out.join("host").exists());
    let kept = lines();
    let gone_on = command(&arguments).output().unwrap();
    assert!(gone_on.status.success() && said(&gone_on).contains("going on with"), "{}", said(&gone_on));
    assert!(lines() > kept && out.join("host/work-precision/orders.csv").exists());

    let before = fs::read(&journal).unwrap();
    for more in [&["--set", "law.stiffness=90"][..], &["--repeats", "5"], &["--machine", "cray-1"]] {
        let refused = study(&scene, &out, &[&["--budget", "3"], more].concat());
        assert_eq!(refused.status.code(), Some(2), "{more:?}: {}", said(&refused));
        assert!(said(&refused).contains("journal.jsonl") && said(&refused).contains("choose another --out"));
    }
    assert_eq!(fs::read(&journal).unwrap(), before);
}

#[test]
fn scenes_without_an_answer_are_refused_with_what_was_tried() {
    let folder = tempfile::tempdir().unwrap();
    let scene = pressed(folder.path());
    let refused = |more: &[&str], code: i32, words: &[&str]| {
        let out = folder.path().join("refused");
        let output = study(&scene, &out, more);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {said}");
        assert!(words.iter().all(|word| said.contains(word)), "{more:?}: {said}");
        let data: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(data["error"]["message"].is_string());
        let _ = fs::remove_dir_all(out);
    };
    refused(&["--set", "run.time=0.01"], 4, &["over after 5 steps", "run.thermo_every"]);
    let soft = ["--set", "law.stiffness=1e-6", "--set", "run.time=5"];
    refused(&soft, 4, &["tried were", "overlap", "step 0.002", "step 2.5e-4"]);
    refused(&["--set", "law.friction=-1"], 3, &["law.friction"]);
    refused(&["--budget", "0"], 2, &["1..=86400"]);
    refused(&["--repeats", "101"], 2, &["1..=100"]);
    refused(&["--machine", "cray-9"], 2, &["cray-9", "cray-1"]);
}

/// Programs have clock periods on any machine, and what depends on the data has none.
#[test]
fn clock_periods_are_those_of_programs() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    let data = succeeds(&study(&pressed(folder.path()), &out, &["--budget", "4", "--machine", "cray-1"]));
    assert!(data["scenes"][0]["machine"].as_str().is_some_and(|name| name.contains("CRAY-1")));
    for run in data["runs"].as_array().unwrap().iter().filter(|run| run["failed"].is_null()) {
        let (way, clocks) = (run["way"].as_str().unwrap(), run["clock_periods"].as_f64());
        assert_eq!(clocks.is_some_and(|clocks| clocks > 1e3), !way.ends_with("fast"), "{way}: {clocks:?}");
    }
    assert!(out.join("host/work-precision/pressed_clocks.svg").exists());
}

/// The rows of a CSV file, cut at commas outside of quotes.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path).unwrap();
    let cut = |line: &str| {
        let mut is_quoted = false;
        let mut cells = vec![String::new()];
        for c in line.chars() {
            match c {
                '"' => is_quoted = !is_quoted,
                ',' if !is_quoted => cells.push(String::new()),
                c => cells.last_mut().unwrap().push(c),
            }
        }
        cells
    };
    text.lines().skip(1).map(cut).collect()
}

/// Discs that fall for a hundredth of a scene in which they lie on a floor at last: in the time that is compared nothing touches.
const FALLING: &str = r#"format = 2
units = "reduced"
[method]
kind = "lattice-md"
[domain]
sides = [40.0, 400.0]
periodic = [true, false]
gravity = [0.0, -1.0]
[particles]
generate = "box"
count = 300
fill_height = 300.0
radius = 0.5
wall_radius = 0.45
wall_spacing = 1.25
mass = 1.0
speed = 0.0
[law]
stiffness = 1e6
normal_damping = 10.0
[integrator]
dt = 2e-4
[run]
time = 200.0
"#;

/// A scene of which the compared time shows nothing gets no advice: neither on the page nor in the data nor in the wishes.
#[test]
fn where_hardly_anything_happens_nothing_is_decided() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (folder.path().join("falling.toml"), folder.path().join("study"));
    fs::write(&scene, FALLING).unwrap();
    let data = succeeds(&study(&scene, &out, &["--budget", "2", "--repeats", "1"]));
    let why = data["scenes"][0]["why_nothing_is_decided"].as_str().unwrap();
    assert!(why.contains("contacts in the mean, fewer than 3"), "{why}");
    assert!(data["references"][0]["in_that_time_a_particle_has"].as_f64().unwrap() < 3.0);
    assert!(data["scenes"][0]["compared"].as_f64().unwrap() < 0.1 * 200.0);
    let wishes = rows(&out.join("host/work-precision/wishes.csv"));
    assert!(!wishes.is_empty());
    for row in &wishes {
        assert!(
            row[2].starts_with("not decided: in the time that is compared") && row[3].is_empty(),
            "{row:?}"
        );
    }
    let page = fs::read_to_string(out.join("README.md")).unwrap();
    assert!(
        page.contains("Not decided, because too little happens in the time that is compared: falling."),
        "{page}"
    );
    assert!(!page.contains("at least as accurate"), "{page}");
}

/// What is recommended is no run that theory, a check or a warning speaks against; there are such runs.
#[test]
fn no_way_is_recommended_that_something_speaks_against() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    // Near enough to meet at once: a scene that is compared as a whole however slow the machine is.
    let near = ["--set", "particles.positions=[[3.0, 4.0], [4.05, 4.25]]", "--set", "run.time=0.4"];
    let data = succeeds(&study(Path::new("two-discs"), &out, &[&["--budget", "8"][..], &near].concat()));
    assert_eq!(data["scenes"][0]["why_nothing_is_decided"], "");
    assert!(data["references"][0]["in_that_time_a_particle_has"].as_f64().unwrap() >= 1.0);
    let runs = data["runs"].as_array().unwrap();
    let objected = |run: &Value| run["what_speaks_against_it"].as_str().is_some_and(|it| !it.is_empty());
    // Sixteen times its own step is beyond what theory allows, and would be the cheapest for some wish.
    let own = data["scenes"][0]["own_step"].as_f64().unwrap();
    let is_coarse = |run: &&Value| {
        let multiple = run["step"].as_f64().unwrap() / own;
        (multiple - 16.0).abs() < 1e-6 && run["position_rms"].is_number()
    };
    let coarse: Vec<&Value> = runs.iter().filter(is_coarse).collect();
    assert!(coarse.iter().any(|run| run["position_rms"].as_f64().unwrap() < 3e-2), "{coarse:?}");
    assert!(coarse.iter().all(|run| objected(run)), "{coarse:?}");
    assert!(
        runs.iter()
            .any(|run| run["what_speaks_against_it"].as_str().is_some_and(|it| it.contains("of theory")))
    );
    let wishes = rows(&out.join("host/work-precision/wishes.csv"));
    let named: Vec<&Vec<String>> = wishes.iter().filter(|row| !row[3].is_empty()).collect();
    assert!(!named.is_empty(), "{wishes:?}");
    for row in named {
        let step: f64 = row[3].parse().unwrap();
        let is_it =
            |run: &&Value| run["way"] == row[2] && (run["step"].as_f64().unwrap() / step - 1.0).abs() < 1e-6;
        let run = runs.iter().find(is_it).unwrap();
        assert!(!objected(run), "{row:?}: {run}");
    }
    // No point of a front is of a run that something speaks against.
    let drawn = data["drawn"].as_array().unwrap();
    let front: Vec<&Value> = drawn.iter().filter(|point| point["kind"] == "front").collect();
    assert!(!front.is_empty());
    for point in front {
        let measure = if point["chart"] == "position" { "position_rms" } else { "energy_balance" };
        let is_it = |run: &&Value| run["cost"] == point["cost"] && run[measure] == point["error"];
        assert!(runs.iter().filter(is_it).all(|run| !objected(run)), "{point}");
    }
}

/// A case as the program sends it to a process of its own that measures.
fn case(events: u64, discs: u64) -> Value {
    let overrides = [format!("particles.count={discs}")];
    let amount = [0, events];
    let scene = serde_json::json!({
        "preset": "hard-disks", "overrides": overrides, "in_events": true, "amount": amount, "seconds": 0.0
    });
    serde_json::json!([{ "Scene": scene }, null])
}

/// A measuring process prints a line for each case, and ends at the first that fails, with the exit code of its failure.
#[test]
fn a_process_measures_the_cases_of_its_input() {
    let mut child = command(&["measure-cases", "--quiet"]);
    let pipes = child.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = pipes.spawn().unwrap();
    let mut asked = child.stdin.take().unwrap();
    let cases = serde_json::json!([case(100, 20), case(200, 20), case(100, 0)]);
    writeln!(asked, "{cases}").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    let lines = String::from_utf8(output.stdout.clone()).unwrap();
    let works: Vec<f64> = lines
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap()["work"].as_f64().unwrap())
        .collect();
    assert_eq!(works, [100.0, 200.0]);
    assert!(said(&output).starts_with("error: "), "{}", said(&output));
}

/// A measuring process ends at once where the program that asked is gone.
#[test]
fn a_measuring_process_ends_with_its_program() {
    let mut child = command(&["measure-cases", "--quiet"]);
    let mut child =
        child.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    writeln!(child.stdin.as_mut().unwrap(), "{}", serde_json::json!([case(1 << 50, 1000)])).unwrap();
    assert!(child.try_wait().unwrap().is_none());
    drop(child.stdin.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(130), 0), "{}", said(&output));
}
