//! Runs of bodies from within: what stops them, what they are warned of, what they count.

use super::bodies::Columns;
use super::checked::{Checked, checked};
use super::field::Pairs;
use super::keys::VOCABULARY;
use super::schemes::SchemeName;
use super::simulation::Running;
use super::sums::{Stop, Sums};
use crate::method::{Failure, FailureKind, Purpose, Simulation, Until};
use crate::scene::Values;
use crate::words::Words;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use stripmine_kernels::isa::ProgramError;

fn scene(preset: &str, sets: &[&str]) -> Checked {
    let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
    checked(Values::load(preset, &sets, &[&VOCABULARY]).unwrap()).unwrap()
}

fn started(preset: &str, sets: &[&str]) -> Running {
    Running::new(&scene(preset, sets), Purpose::Run).unwrap()
}

fn advance(running: &mut Running, steps: u64) -> Result<(), Failure> {
    running.advance(&[Until::Steps(steps)], &AtomicBool::new(false))
}

/// Sums that do something else as well.
struct Instead<F> {
    inner: Option<Box<dyn Sums>>,
    with: F,
}

impl<F> Sums for Instead<F>
where
    F: Fn(Option<&mut dyn Sums>, &Columns, Option<&Columns>, bool, Stop<'_>) -> Result<f64, ProgramError>
        + Send
        + Sync,
{
    fn sum(
        &mut self,
        position: &Columns,
        velocity: Option<&Columns>,
        observed: bool,
        stop: Stop<'_>,
    ) -> Result<f64, ProgramError> {
        let inner = self.inner.as_mut().map(|inner| &mut **inner as &mut dyn Sums);
        (self.with)(inner, position, velocity, observed, stop)
    }

    fn over(&self, inverse_mass: &[f64], into: [Option<&mut Columns>; 2]) {
        if let Some(inner) = &self.inner {
            inner.over(inverse_mass, into);
        }
    }
}

/// Puts something between a run and its sums.
fn between<F>(running: &mut Running, with: F)
where
    F: Fn(Option<&mut dyn Sums>, &Columns, Option<&Columns>, bool, Stop<'_>) -> Result<f64, ProgramError>
        + Send
        + Sync
        + 'static,
{
    let pairs = &mut running.field.get_mut().pairs;
    let inner = match std::mem::replace(pairs, Pairs::Reference) {
        Pairs::Summed(sums) => Some(sums),
        Pairs::Reference => None,
    };
    *pairs = Pairs::Summed(Box::new(Instead { inner, with }));
}

/// A sweep that fails stops the run before a row is written; no zeros stand for what is not known.
#[test]
fn a_sweep_that_fails_is_no_row_of_zeros() {
    let mut running = started("plummer", &["particles.count=65"]);
    advance(&mut running, 1).unwrap();
    between(&mut running, |_, _, _, _, _| Err(ProgramError::EmptyStrip));
    let failure = running.check().unwrap_err();
    assert_eq!(failure.kind, FailureKind::MACHINE);
    assert!(running.observe()[2].is_nan(), "{:?}", running.observe());
    assert_eq!(advance(&mut running, 9).unwrap_err().kind, FailureKind::MACHINE);
}

/// A row takes no sweep more than its step, and one is enough for all that is said of a state.
#[test]
fn a_row_is_observed_once() {
    let mut running = started("plummer", &["particles.count=100", "run.thermo_every=8"]);
    let sweeps = Arc::new([0, 0].map(AtomicUsize::new));
    let counted = Arc::clone(&sweeps);
    between(&mut running, move |inner, position, velocity, observed, stop| {
        counted[usize::from(observed)].fetch_add(1, Ordering::Relaxed);
        inner.unwrap().sum(position, velocity, observed, stop)
    });
    for steps in [8, 16, 24, 32] {
        advance(&mut running, steps).unwrap();
        running.check().unwrap();
        let _ = (running.observe(), running.warnings(), running.summary(), running.in_words());
    }
    // The first of all is the acceleration of the start.
    assert_eq!([0, 1].map(|which| sweeps[which].load(Ordering::Relaxed)), [29, 4]);
    // What has no forces at the end of its step takes one sweep for a row.
    let mut running =
        started("plummer", &["particles.count=100", "run.thermo_every=8", "integrator.kind=hermite-4"]);
    let rows = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&rows);
    between(&mut running, move |inner, position, velocity, observed, stop| {
        counted.fetch_add(usize::from(observed), Ordering::Relaxed);
        inner.unwrap().sum(position, velocity, observed, stop)
    });
    advance(&mut running, 8).unwrap();
    running.check().unwrap();
    let _ = (running.observe(), running.observe(), running.summary());
    assert_eq!(rows.load(Ordering::Relaxed), 1);
}

/// A step that is interrupted between two tiles is not taken: the state is that of the last whole step, and what goes on from there
/// has the bits, and the counts, of a run in one piece. For every scheme and engine, wherever in the step that is.
#[test]
fn an_interrupted_step_is_not_taken() {
    for (scheme, _) in SchemeName::ALL {
        for engine in ["fast", "programs"] {
            let sets = [
                format!("integrator.kind={}", scheme.word()),
                format!("machine.engine={engine}"),
                "particles.count=100".to_owned(),
                "run.steps=6".to_owned(),
                "run.thermo_every=2".to_owned(),
            ];
            let checked = scene_of(&sets);
            let start = || Running::new(&checked, Purpose::Run).unwrap();
            let mut whole = start();
            advance(&mut whole, 6).unwrap();
            for most in [0, 1, 5, 12, 40] {
                let mut running = start();
                advance(&mut running, 3).unwrap();
                let (before, clock) = (running.snapshot(), running.clock());
                let interrupted = Arc::new(AtomicBool::new(false));
                let (asked, flag) = (AtomicUsize::new(0), Arc::clone(&interrupted));
                between(&mut running, move |inner, position, velocity, observed, stop| {
                    let stop = || {
                        flag.fetch_or(asked.fetch_add(1, Ordering::Relaxed) == most, Ordering::Relaxed);
                        stop()
                    };
                    inner.unwrap().sum(position, velocity, observed, &stop)
                });
                running.advance(&[Until::Steps(6)], &interrupted).unwrap();
                let here = format!("{} by {engine}, interrupted at {most}", scheme.word());
                if !interrupted.load(Ordering::Relaxed) {
                    assert_eq!(running.snapshot(), whole.snapshot(), "{here}");
                    continue;
                }
                assert!(running.clock().steps < 6, "{here}");
                if running.clock() == clock {
                    assert_eq!(running.snapshot(), before, "{here}");
                }
                let mut resumed = start();
                resumed.restore(running.clock(), running.snapshot()).unwrap();
                advance(&mut resumed, 6).unwrap();
                assert_eq!(resumed.snapshot(), whole.snapshot(), "{here}");
                assert_eq!(resumed.summary(), whole.summary(), "{here}");
                // So has the one that was interrupted and goes on itself.
                advance(&mut running, 6).unwrap();
                assert_eq!(running.snapshot(), whole.snapshot(), "{here}");
            }
        }
    }
}

fn scene_of(sets: &[String]) -> Checked {
    scene("plummer", &sets.iter().map(String::as_str).collect::<Vec<_>>())
}

/// The largest error of the energy along a run.
fn largest_error(running: &mut Running, steps: u64) -> f64 {
    advance(running, steps).unwrap();
    running.summary()["largest_energy_error"].as_f64().unwrap().abs()
}

/// A hard pair far from the middle keeps its energy in mixed precision as it does in double.
#[test]
fn a_hard_pair_is_as_good_far_from_the_middle() {
    // Two masses of 1 at a distance of 0.001 on a circle: the speed of each is √500.
    let v = 500f64.sqrt();
    let bodies = format!(
        "particles.bodies=[[1.0, 1000.0005, 7.0, 0.0, 0.0, {v:?}, 0.0], [1.0, 999.9995, 7.0, 0.0, 0.0, {back:?}, 0.0], \
         [0.5, -1000.0, 0.0, 0.0, 0.0, 0.0, 0.0]]",
        back = -v
    );
    for engine in ["fast", "programs"] {
        for kind in ["leapfrog", "hermite-4"] {
            let off = |precision: &str| {
                let [engine, kind] = [format!("machine.engine={engine}"), format!("integrator.kind={kind}")];
                let precision = format!("machine.precision={precision}");
                let list = ["particles.generate=list", &bodies, "integrator.dt=1e-6", "run.steps=600"];
                let sets = [&list[..], &[&engine, &kind, &precision]].concat();
                largest_error(&mut started("figure-eight", &sets), 600)
            };
            let [double, mixed] = ["f64", "mixed"].map(off);
            assert!(mixed < double + 1e-6, "{engine} {kind}: {mixed} {double}");
        }
    }
}

/// Masses and lengths far from 1 are scaled where numbers have a narrow range.
#[test]
fn light_bodies_do_not_fly_straight() {
    for (mass, length) in [(1e-25, 1.0), (1.0, 1e-15), (1e25, 1e12)] {
        // A circle of two equal bodies; a quarter of it in 50 steps.
        let speed = 0.5 * f64::sqrt(2.0 * mass / length);
        let dt = std::f64::consts::FRAC_PI_2 * 0.5 * length / speed / 50.0;
        let (r, back) = (0.5 * length, -speed);
        let bodies = format!(
            "particles.bodies=[[{mass:?}, {r:?}, 0.0, 0.0, 0.0, {speed:?}, 0.0], [{mass:?}, {:?}, 0.0, 0.0, 0.0, {back:?}, 0.0]]",
            -r
        );
        let dt = format!("integrator.dt={dt:?}");
        for engine in ["fast", "programs"] {
            let engine = format!("machine.engine={engine}");
            let sets =
                ["particles.generate=list", &bodies, &dt, &engine, "machine.precision=mixed", "run.steps=50"];
            let mut running = started("figure-eight", &sets);
            advance(&mut running, 50).unwrap();
            let [x, y, _] = running.particles().all()[0].position.map(|x| x / r);
            assert!(x.abs() < 0.01 && (y - 1.0).abs() < 0.01, "{mass} {length} {engine}: {x} {y}");
        }
    }
}

/// An error of the energy on the way is warned of with its moment and the two that came near, though it is gone at the end.
#[test]
fn an_encounter_followed_badly_is_warned_of() {
    // Two bodies on an ellipse of eccentricity 0.97, from their farthest and back to it.
    let bodies = "particles.bodies=[[0.5, 0.985, 0.0, 0.0, 0.0, 0.0617, 0.0], [0.5, -0.985, 0.0, 0.0, 0.0, -0.0617, 0.0]]";
    let leapfrog = ["integrator.kind=leapfrog", "integrator.dt=0.001", "run.steps=6283"];
    let sets = [&["particles.generate=list", bodies][..], &leapfrog].concat();
    let mut running = started("figure-eight", &sets);
    advance(&mut running, 6283).unwrap();
    let [warning] = &running.warnings()[..] else { panic!("{:?}", running.warnings()) };
    for words in ["at step", "bodies 1 and 2 were the nearest, 0.0"] {
        assert!(warning.message.contains(words), "{}", warning.message);
    }
    let summary = running.summary();
    assert!(summary["energy_error"].as_f64().unwrap().abs() < 0.5 * warning.value, "{summary:?}");
    assert_eq!(summary["nearest_encounter"]["bodies"], serde_json::json!([1, 2]));
    // What keeps its energy is not warned of.
    let mut good = started("kepler", &["integrator.kind=yoshida-8"]);
    advance(&mut good, 256).unwrap();
    assert!(good.warnings().is_empty(), "{:?}", good.warnings());
}

/// Many bodies are looked at every 64 steps, and at the end: what was lost since is found, and nothing is said in percent of an energy
/// that means nothing.
#[test]
fn what_is_lost_in_the_last_steps_is_found() {
    let mut running = started("plummer", &["particles.count=100", "run.steps=70", "run.thermo_every=0"]);
    advance(&mut running, 66).unwrap();
    running.bodies.velocity.iter_mut().flatten().for_each(|v| *v *= 300.0);
    let failure = advance(&mut running, 70).unwrap_err();
    assert_eq!(failure.kind, super::UNBOUND);
    assert!(failure.message.contains("not any more"), "{failure}");
    let [warning] = &running.warnings()[..] else { panic!() };
    assert!(!warning.message.contains('%') && warning.message.contains("at the start and"), "{warning:?}");
}

/// Two bodies that meet are named, with the place and what would help.
#[test]
fn bodies_that_meet_are_named() {
    for engine in ["fast", "reference"] {
        // In half a unit of time they come to one place, by the one scheme before its forces and by the other after.
        for (kind, v) in [("damped-euler", 0.5), ("leapfrog", 0.75)] {
            let bodies = format!(
                "particles.bodies=[[1.0, 1.5, 2.0, 3.0, -{v}, 0, 0], [1.0, 0.5, 2.0, 3.0, {v}, 0, 0]]"
            );
            let [engine, kind] = [format!("machine.engine={engine}"), format!("integrator.kind={kind}")];
            let sets =
                ["particles.generate=list", &bodies, "integrator.dt=0.5", "run.steps=9", &engine, &kind];
            let mut running = started("figure-eight", &sets);
            let failure = advance(&mut running, 9).unwrap_err();
            let said = failure.to_string();
            let words = ["bodies 1 and 2", "at (1", "nothing softens", "law.softening", "integrator.dt"];
            assert!(words.iter().all(|word| said.contains(word)), "{engine} {kind}: {said}");
            assert!(!said.contains("units"), "{said}");
        }
    }
}
