//! Diagrams on a synthetic clock: no result depends on the speed of the machine.

use super::{DiagramEffort, made, work_precision};
use crate::model::machines;
use crate::results::{Journal, JournalIdentity};
use crate::study::explain::PlanTarget;
use crate::study::trial::{Stopwatch, TrialControl};
use crate::study::{StudyError, Subject};
use serde_json::Value;
use std::fs;
use std::sync::atomic::{AtomicBool, Ordering};
use stripmine_physics::method::METHODS;
use stripmine_physics::reported::{ErrorClass, Reported};

/// Nanoseconds per particle and step.
const NANOSECONDS: f64 = 20_000.0;

fn subject(scene: &str, sets: &[&str]) -> Subject {
    let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
    Subject::load(scene, &sets, METHODS).unwrap()
}

/// Loads a scene from its text, with overrides.
fn written(text: &str, sets: &[&str]) -> Subject {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, text).unwrap();
    subject(path.to_str().unwrap(), sets)
}

fn effort(budget: f64) -> DiagramEffort {
    DiagramEffort { budget, repeats: 1, phases: 16, machine: None }
}

/// Measured frames by name.
fn measured(subject: &Subject, effort: &DiagramEffort) -> Result<Value, StudyError> {
    let (watch, stop) = (Stopwatch::with_synthetic_time(NANOSECONDS), AtomicBool::new(false));
    let trial = TrialControl { watch: &watch, stop: &stop };
    let data = work_precision(subject, effort, trial, &Journal::none(), &|_| {})?;
    Ok(made(&[("scene".to_owned(), data)]).json())
}

fn rows<'d>(data: &'d Value, frame: &str) -> &'d Vec<Value> {
    data[frame].as_array().unwrap()
}

/// Two discs pressed together for the whole time: forces without a kink.
const PRESSED: &str = include_str!("../../../tests/pressed.toml");

/// Positions converge with the theoretical order: that of velocity Verlet itself, and that of Gear's schemes as their start allows. Energy of discs
/// that start at rest converges with the orders of the schemes.
#[test]
fn smooth_forces_give_theoretical_orders() {
    let orders = |sets: &[&str], measure: &str| -> Vec<(String, f64, Option<f64>)> {
        let data = measured(&written(PRESSED, sets), &effort(4.0)).unwrap();
        let own = rows(&data, "orders").iter().filter(|order| order["error"] == measure);
        own.map(|order| {
            let scheme = order["scheme"].as_str().unwrap().to_owned();
            (scheme, order["order"].as_f64().unwrap(), order["theory"].as_f64())
        })
        .collect()
    };
    let moving = orders(&[], "position, RMS");
    assert_eq!(moving.len(), 4);
    for (scheme, order, theory) in moving {
        assert!((order - theory.unwrap()).abs() < 0.2, "{scheme}: {order}, {theory:?}");
    }
    let at_rest = orders(&["particles.velocities=[[0.0,0.0],[0.0,0.0]]"], "energy balance (relative)");
    let expected = [("velocity-verlet", 2.0), ("gear4", 3.0), ("gear5", 4.0)];
    for (name, theory) in expected {
        let (_, order, _) = at_rest.iter().find(|(scheme, ..)| scheme == name).unwrap();
        assert!((order - theory).abs() < 0.2, "{name}: {order}");
    }
}

/// One collision: over all phases of a step the error has the order of the kink or of the jump, and its mean falls faster.
#[test]
fn collision_error_depends_on_step_phase() {
    let orders = |more: &[&str]| -> Vec<f64> {
        let sets = [&["run.time=2.6", "law.friction=0"], more].concat();
        let data =
            measured(&subject("two-discs", &sets), &DiagramEffort { repeats: 0, ..effort(30.0) }).unwrap();
        let own = rows(&data, "collision").iter().filter(|order| order["outcome"] == "restitution");
        own.map(|it| it["order_of_the_rms"].as_f64().unwrap()).collect()
    };
    let damped = orders(&[]);
    assert!(damped.len() == 4 && damped.iter().all(|spread| (spread - 1.0).abs() < 0.2), "{damped:?}");
    // The first is velocity Verlet, which conserves an energy; Gear's schemes lose some of it even in a smooth contact.
    let elastic = orders(&["law.normal_damping=0"]);
    assert!((elastic[0] - 2.5).abs() < 0.2, "{elastic:?}");
}

/// Programs have clock periods on any machine; configurations whose work depends on the data have none.
#[test]
fn clock_periods_are_those_of_programs() {
    let machine = Some(machines::find("cray-1").unwrap());
    let data = measured(&written(PRESSED, &[]), &DiagramEffort { machine, ..effort(2.0) }).unwrap();
    assert!(data["scenes"][0]["machine"].as_str().is_some_and(|name| name.contains("CRAY-1")));
    for run in rows(&data, "runs").iter().filter(|run| run["failed"].is_null()) {
        let (label, clocks) = (run["configuration"].as_str().unwrap(), run["clock_periods"].as_f64());
        assert_eq!(
            clocks.is_some_and(|clocks| clocks > 1e3),
            !label.ends_with("fast"),
            "{label}: {clocks:?}"
        );
    }
    assert!(rows(&data, "drawn").iter().any(|point| point["chart"] == "clocks"));
}

/// Discs that fall for the first hundredth of a scene in which they finally rest on a floor: nothing touches in the compared time.
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

/// A scene with too few events in the compared time gets no recommendation, neither for an error nor relative to its own configuration.
#[test]
fn too_few_events_give_no_recommendation() {
    let data = measured(&written(FALLING, &[]), &effort(2.0)).unwrap();
    let scene = &data["scenes"][0];
    let why = scene["why_nothing_is_decided"].as_str().unwrap();
    assert!(why.contains("contacts on average, fewer than 3"), "{why}");
    assert!(data["references"][0]["in_that_time_a_particle_has"].as_f64().unwrap() < 3.0);
    assert!(scene["compared"].as_f64().unwrap() < 0.1 * 200.0);
    assert!(scene["as_accurate"] == "" && scene["its_cost_over_the_own_cost"].is_null(), "{scene}");
    let wishes = rows(&data, "wishes");
    assert!(!wishes.is_empty());
    for wish in wishes {
        let said = wish["cheapest_configuration"].as_str().unwrap();
        assert!(said.starts_with("not decided: in the compared time"), "{wish}");
        assert!(wish["step"].is_null(), "{wish}");
    }
}

/// Trajectories of shaken grains diverge within a fiftieth of the scene, and those in a heat bath at once: both errors name a chart to use instead.
#[test]
fn diverging_trajectories_are_refused() {
    for (scene, why) in
        [("shaken-box", "diverge after a time of"), ("langevin-dense", "noise moves the particles")]
    {
        let error = measured(&subject(scene, &[]), &effort(2000.0)).err().unwrap();
        let said = error.to_string();
        assert!(
            matches!(error, StudyError::NoTrajectories { .. }) && error.class() == ErrorClass::Usage,
            "{said}"
        );
        assert!(said.contains(why), "{said}");
        assert!(said.contains(&format!("stripmine chart accuracy {scene} --of temperature")), "{said}");
        assert!(PlanTarget::of(&subject(scene, &[]), Some("temperature"), None).is_ok());
    }
}

/// Runs with a warning are cheaper, and none of them is recommended or on a front.
#[test]
fn runs_with_warnings_are_never_recommended() {
    // Close enough to collide at once, and so damped that every integrator gives a warning at sixteen times the step.
    let near = ["particles.positions=[[3.0, 4.0], [4.05, 4.25]]", "run.time=0.3", "law.normal_damping=20"];
    let data = measured(&subject("two-discs", &near), &effort(6.0)).unwrap();
    assert_eq!(data["scenes"][0]["why_nothing_is_decided"], "");
    assert!(data["references"][0]["in_that_time_a_particle_has"].as_f64().unwrap() >= 1.0);
    let runs = rows(&data, "runs");
    let objection = |run: &Value| run["what_speaks_against_it"].as_str().unwrap_or_default().to_owned();
    // Sixteen times its own step would be the cheapest for some error.
    let own = data["scenes"][0]["own_step"].as_f64().unwrap();
    let is_coarse = |run: &&Value| {
        let multiple = run["step"].as_f64().unwrap() / own;
        (multiple - 16.0).abs() < 1e-6 && run["position_rms"].is_number()
    };
    let coarse: Vec<&Value> = runs.iter().filter(is_coarse).collect();
    assert!(coarse.iter().any(|run| run["position_rms"].as_f64().unwrap() < 3e-2), "{coarse:?}");
    assert!(coarse.iter().all(|run| !objection(run).is_empty()), "{coarse:?}");
    assert!(runs.iter().any(|run| objection(run).contains("theoretical limit")));
    let named: Vec<&Value> = rows(&data, "wishes").iter().filter(|wish| wish["step"].is_number()).collect();
    assert!(!named.is_empty(), "{data}");
    for wish in named {
        let is_it = |run: &&Value| {
            run["configuration"] == wish["cheapest_configuration"] && run["step"] == wish["step"]
        };
        let run = runs.iter().find(is_it).unwrap();
        assert!(objection(run).is_empty(), "{wish}: {run}");
    }
    let front: Vec<&Value> = rows(&data, "drawn").iter().filter(|point| point["kind"] == "front").collect();
    assert!(!front.is_empty());
    for point in front {
        let measure = if point["chart"] == "position" { "position_rms" } else { "energy_balance" };
        let mut own =
            runs.iter().filter(|run| run["cost"] == point["cost"] && run[measure] == point["error"]);
        assert!(own.all(|run| objection(run).is_empty()), "{point}");
    }
}

/// Among runs whose costs agree within a tenth the scene's own configuration is named, or the first in the order of the settings. On a clock in which
/// a step of every configuration takes the same time, all of them tie.
#[test]
fn ties_go_to_the_scene_s_own_configuration() {
    let data = measured(&written(PRESSED, &[]), &effort(4.0)).unwrap();
    let own = data["scenes"][0]["own_configuration"].as_str().unwrap();
    let mut ties = 0;
    for wish in rows(&data, "wishes").iter().filter(|wish| wish["step"].is_number()) {
        let error = wish["error_wished_for_at_most_radii_sizes_of_a_system_of_bodies"].as_f64().unwrap();
        let serves = |run: &&Value| {
            run["position_rms"].as_f64().is_some_and(|it| it <= error)
                && run["what_speaks_against_it"].as_str().unwrap_or_default().is_empty()
        };
        let timed: Vec<(&str, f64)> = (rows(&data, "runs").iter().filter(serves))
            .filter_map(|run| Some((run["configuration"].as_str()?, run["cost"].as_f64()?)))
            .collect();
        let least = timed.iter().map(|(_, cost)| *cost).reduce(f64::min).unwrap();
        let tied: Vec<&str> = timed.iter().filter(|(_, cost)| *cost <= 1.1 * least).map(|it| it.0).collect();
        ties += usize::from(tied.len() > 1);
        let named = wish["cheapest_configuration"].as_str().unwrap();
        assert!(tied.contains(&named) && (named == own || !tied.contains(&own)), "{wish}: {tied:?}");
    }
    assert!(ties > 0);
}

/// An interrupted study keeps its finished runs, and gives the same result when resumed.
#[test]
fn an_interrupted_study_resumes() {
    let folder = tempfile::tempdir().unwrap();
    let identity = JournalIdentity { of: "pressed".to_owned(), digest: "12345678".to_owned() };
    let subject = written(PRESSED, &[]);
    let run = |stop: &AtomicBool, until: f64| {
        let watch = Stopwatch::with_synthetic_time(NANOSECONDS);
        let journal = Journal::open(folder.path(), &identity, None).unwrap();
        let progress = |share: f64| stop.fetch_or(share > until, Ordering::Relaxed);
        let trial = TrialControl { watch: &watch, stop };
        let data = work_precision(&subject, &effort(2.0), trial, &journal, &|share| _ = progress(share));
        (journal.len(), data.map(|data| made(&[("scene".to_owned(), data)]).json()))
    };
    let (before, interrupted) = run(&AtomicBool::new(false), 0.02);
    assert!(before == 0 && matches!(interrupted, Err(StudyError::Interrupted)), "{interrupted:?}");
    let (kept, resumed) = run(&AtomicBool::new(false), 2.0);
    assert!(kept > 4, "{kept}");
    let (all, again) = run(&AtomicBool::new(false), 2.0);
    assert!(all > kept, "{kept} of {all}");
    let all = [measured(&subject, &effort(2.0)), resumed, again].map(Result::unwrap);
    // Recalled runs leave more synthetic time for repeats, so costs differ.
    for frame in ["orders", "references", "errors", "growth"] {
        let [whole, resumed, again] = all.each_ref().map(|data| {
            let mut rows = rows(data, frame).clone();
            rows.iter_mut().for_each(|row| _ = row.as_object_mut().unwrap().remove("cost_of_a_unit_of_time"));
            rows
        });
        assert!(!whole.is_empty() && whole == resumed && whole == again, "{frame}");
    }
}
