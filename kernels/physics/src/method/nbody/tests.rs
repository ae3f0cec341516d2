//! Tests of running simulations of bodies: failures, warnings and counts.

use super::bodies::StateColumns;
use super::checked::{CheckedNbody, check_nbody_scene};
use super::field::PairSummation;
use super::keys::VOCABULARY;
use super::schemes::SchemeName;
use super::simulation::{NbodySimulation, begin};
use super::sums::{ForceSums, StopCallback};
use crate::method::{FailureKind, PhysicsFailure, Simulation, StartPurpose, Until};
use crate::scene::SceneValues;
use crate::words::Words;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use stripmine_kernels::isa::ProgramError;

fn scene(preset: &str, sets: &[&str]) -> CheckedNbody {
    let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
    check_nbody_scene(SceneValues::load(preset, &sets, &[&VOCABULARY]).unwrap()).unwrap()
}

fn started(preset: &str, sets: &[&str]) -> NbodySimulation {
    begin(&scene(preset, sets), StartPurpose::Run).unwrap()
}

fn advance(running: &mut NbodySimulation, steps: u64) -> Result<(), PhysicsFailure> {
    running.advance(&[Until::Steps(steps)], &AtomicBool::new(false))
}

/// Sums with a wrapper around them.
struct WrappedSums<F> {
    inner: Option<Box<dyn ForceSums>>,
    with: F,
}

impl<F> ForceSums for WrappedSums<F>
where
    F: Fn(
            Option<&mut dyn ForceSums>,
            &StateColumns,
            Option<&StateColumns>,
            bool,
            StopCallback<'_>,
        ) -> Result<f64, ProgramError>
        + Send
        + Sync,
{
    fn sum(
        &mut self,
        position: &StateColumns,
        velocity: Option<&StateColumns>,
        observed: bool,
        stop: StopCallback<'_>,
    ) -> Result<f64, ProgramError> {
        let inner = self.inner.as_mut().map(|inner| &mut **inner as &mut dyn ForceSums);
        (self.with)(inner, position, velocity, observed, stop)
    }

    fn over(&self, per_mass: &[f64], into: [Option<&mut StateColumns>; 2]) {
        if let Some(inner) = &self.inner {
            inner.over(per_mass, into);
        }
    }
}

/// Wraps the sums of a simulation.
fn wrap_sums<F>(running: &mut NbodySimulation, with: F)
where
    F: Fn(
            Option<&mut dyn ForceSums>,
            &StateColumns,
            Option<&StateColumns>,
            bool,
            StopCallback<'_>,
        ) -> Result<f64, ProgramError>
        + Send
        + Sync
        + 'static,
{
    let pairs = &mut running.state.field.get_mut().pairs;
    let inner = match std::mem::replace(pairs, PairSummation::Reference) {
        PairSummation::Summed(sums) => Some(sums),
        PairSummation::Reference => None,
    };
    *pairs = PairSummation::Summed(Box::new(WrappedSums { inner, with }));
}

/// A failing sweep stops the run before a row is written; unknown values are NaN, not 0.
#[test]
fn failing_sweeps_write_no_row() {
    let mut running = started("plummer", &["particles.count=65"]);
    advance(&mut running, 1).unwrap();
    wrap_sums(&mut running, |_, _, _, _, _| Err(ProgramError::EmptyStrip));
    let failure = running.check().unwrap_err();
    assert_eq!(failure.kind, FailureKind::MACHINE);
    assert!(running.observe()[2].is_nan(), "{:?}", running.observe());
    assert_eq!(advance(&mut running, 9).unwrap_err().kind, FailureKind::MACHINE);
}

/// A row needs no sweep beyond that of its step, and one sweep serves all output of a state.
#[test]
fn rows_need_no_extra_sweep() {
    let mut running = started("plummer", &["particles.count=100", "run.thermo_every=8"]);
    let sweeps = Arc::new([0, 0].map(AtomicUsize::new));
    let counted = Arc::clone(&sweeps);
    wrap_sums(&mut running, move |inner, position, velocity, observed, stop| {
        counted[usize::from(observed)].fetch_add(1, Ordering::Relaxed);
        inner.unwrap().sum(position, velocity, observed, stop)
    });
    for steps in [8, 16, 24, 32] {
        advance(&mut running, steps).unwrap();
        running.check().unwrap();
        let _ = (running.observe(), running.warnings(), running.summary(), running.in_words());
    }
    // The first evaluation is the acceleration at the start.
    assert_eq!([0, 1].map(|which| sweeps[which].load(Ordering::Relaxed)), [29, 4]);
    // A scheme without forces at the end of its step needs one sweep per row.
    let mut running =
        started("plummer", &["particles.count=100", "run.thermo_every=8", "integrator.kind=hermite-4"]);
    let rows = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&rows);
    wrap_sums(&mut running, move |inner, position, velocity, observed, stop| {
        counted.fetch_add(usize::from(observed), Ordering::Relaxed);
        inner.unwrap().sum(position, velocity, observed, stop)
    });
    advance(&mut running, 8).unwrap();
    running.check().unwrap();
    let _ = (running.observe(), running.observe(), running.summary());
    assert_eq!(rows.load(Ordering::Relaxed), 1);
}

/// A step interrupted between two tiles is discarded: the state is that of the last whole step. Resumption from there gives the bits and
/// the counts of an uninterrupted run. Holds for every scheme and engine, and any moment of the step.
#[test]
fn interrupted_steps_are_discarded() {
    for (scheme, _) in SchemeName::ALL.iter().filter(|(scheme, _)| !scheme.is_adaptive()) {
        for engine in ["fast", "programs"] {
            let sets = [
                format!("integrator.kind={}", scheme.word()),
                format!("machine.engine={engine}"),
                "particles.count=100".to_owned(),
                "run.steps=6".to_owned(),
                "run.thermo_every=2".to_owned(),
            ];
            let checked = scene_of(&sets);
            let start = || begin(&checked, StartPurpose::Run).unwrap();
            let mut whole = start();
            advance(&mut whole, 6).unwrap();
            for most in [0, 1, 5, 12, 40] {
                let mut running = start();
                advance(&mut running, 3).unwrap();
                let (before, clock) = (running.snapshot(), running.clock());
                let interrupted = Arc::new(AtomicBool::new(false));
                let (asked, flag) = (AtomicUsize::new(0), Arc::clone(&interrupted));
                wrap_sums(&mut running, move |inner, position, velocity, observed, stop| {
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
                // The interrupted simulation itself continues to the same state.
                advance(&mut running, 6).unwrap();
                assert_eq!(running.snapshot(), whole.snapshot(), "{here}");
            }
        }
    }
}

fn scene_of(sets: &[String]) -> CheckedNbody {
    scene("plummer", &sets.iter().map(String::as_str).collect::<Vec<_>>())
}

/// Largest energy error during a run.
fn largest_error(running: &mut NbodySimulation, steps: u64) -> f64 {
    advance(running, steps).unwrap();
    running.summary()["largest_energy_error"].as_f64().unwrap().abs()
}

/// A hard pair far from the centre conserves its energy in mixed precision as well as in double precision.
#[test]
fn distant_hard_pairs_conserve_energy() {
    // Two masses of 1 on a circle of diameter 0.001: the speed of each is √500.
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

/// Masses and lengths far from 1 are scaled if the number format has a narrow range.
#[test]
fn mixed_precision_scales_masses_and_lengths() {
    for (mass, length) in [(1e-25, 1.0), (1.0, 1e-15), (1e25, 1e12)] {
        // Two equal bodies on a circle; a quarter of an orbit in 50 steps.
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

/// A temporary energy error causes a warning with its time and the nearest pair, even if it is gone at the end.
#[test]
fn inaccurate_encounters_cause_a_warning() {
    // Two bodies on an ellipse of eccentricity 0.97, from the farthest point back to it.
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
    // A run that conserves its energy has no warning.
    let mut good = started("kepler", &["integrator.kind=yoshida-8"]);
    advance(&mut good, 256).unwrap();
    assert!(good.warnings().is_empty(), "{:?}", good.warnings());
}

/// Many bodies are checked every 64 steps and at the end: a loss in between is found, and a meaningless energy is not reported in
/// percent.
#[test]
fn losses_in_the_last_steps_are_detected() {
    let mut running = started("plummer", &["particles.count=100", "run.steps=70", "run.thermo_every=0"]);
    advance(&mut running, 66).unwrap();
    running.state.bodies.velocity.iter_mut().flatten().for_each(|v| *v *= 300.0);
    let failure = advance(&mut running, 70).unwrap_err();
    assert_eq!(failure.kind, super::UNBOUND);
    assert!(failure.message.contains("have become unbound"), "{failure}");
    let [warning] = &running.warnings()[..] else { panic!() };
    let message = warning.message.replace("the limit 1 %", "the limit");
    assert!(!message.contains('%') && warning.message.contains("at the start and"), "{warning:?}");
}

/// Two bodies that meet are reported with their position and a remedy.
#[test]
fn colliding_bodies_are_reported() {
    for engine in ["fast", "reference"] {
        // After half a unit of time they are at one position: before the forces in one scheme, after them in the other.
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
            let words = ["bodies 1 and 2", "at (1", "not softened", "law.softening", "integrator.dt"];
            assert!(words.iter().all(|word| said.contains(word)), "{engine} {kind}: {said}");
            assert!(!said.contains("units"), "{said}");
        }
    }
}

/// Two spheres of 1 kg, 0.1 m apart, in SI units: each falls G/d² · t²/2, in 0.2 s 1.33486e-10 m, with every engine. A given constant is
/// used in any units; other units default to 1.
#[test]
fn gravitational_constant_follows_the_units() {
    let bodies = "particles.bodies=[[1.0, -0.05, 0, 0, 0, 0, 0], [1.0, 0.05, 0, 0, 0, 0, 0]]";
    let constant = |units: &str, dt: f64, more: &[&str]| {
        let (units, step) = (format!("units={units}"), format!("integrator.dt={dt:?}"));
        let sets = ["particles.generate=list", bodies, "run.steps=20", &units, &step];
        let mut running = started("figure-eight", &[&sets[..], more].concat());
        advance(&mut running, 20).unwrap();
        (running.particles().all()[0].position[0] + 0.05) * 0.01 * 2.0 / (20.0 * dt).powi(2)
    };
    for engine in ["reference", "fast", "programs"] {
        for kind in ["leapfrog", "yoshida-4", "hermite-4", "gear-6", "runge-kutta-4"] {
            for precision in if engine == "reference" { &["f64"][..] } else { &["f64", "mixed"] } {
                let [engine, kind] = [format!("machine.engine={engine}"), format!("integrator.kind={kind}")];
                let precision = format!("machine.precision={precision}");
                let found = constant("SI", 0.01, &[&engine, &kind, &precision]);
                assert!((found / 6.6743e-11 - 1.0).abs() < 1e-5, "{engine} {kind} {precision}: {found}");
            }
        }
    }
    for (units, dt, more, expected) in [
        ("SI", 0.01, &["law.gravitational_constant=2e-9"][..], 2e-9),
        ("kpc", 0.01, &["law.gravitational_constant=2e-9"], 2e-9),
        ("SI, masses as G m", 1e-6, &[], 1.0),
    ] {
        let found = constant(units, dt, more);
        assert!((found / expected - 1.0).abs() < 1e-5, "{units}: {found}");
    }
}

/// The Earth returns to its position after a sidereal year of 365.25636 days, and is on the other side of the Sun after half a year.
#[test]
fn the_earth_orbits_in_a_sidereal_year() {
    let bodies =
        "particles.bodies=[[1.98841e30, 0, 0, 0, 0, 0, 0], [5.9722e24, 1.49598e11, 0, 0, 0, 29784.7, 0]]";
    let dt = format!("integrator.dt={:?}", 365.25636 * 86400.0 / 2000.0);
    let sets =
        ["particles.generate=list", bodies, &dt, "run.steps=2000", "units=SI", "integrator.kind=yoshida-4"];
    let mut running = started("figure-eight", &sets);
    let seen = scene("figure-eight", &sets).prepared();
    let said = seen
        .facts
        .iter()
        .filter_map(|fact| fact.words.clone())
        .find(|(label, _)| *label == "gravitational constant");
    assert!(said.clone().is_some_and(|(_, words)| words.starts_with("6.6743e-11 m³/(kg s²)")), "{said:?}");
    for (steps, side) in [(1000, -1.0), (2000, 1.0)] {
        advance(&mut running, steps).unwrap();
        let all = running.particles();
        let [x, y] =
            [0, 1].map(|axis| (all.all()[1].position[axis] - all.all()[0].position[axis]) / 1.49598e11);
        assert!((x - side).abs() < 1e-3 && y.abs() < 2e-3, "{steps}: {x} {y}");
    }
}

/// Sixteen stars within a parsec, in metres: every engine, scheme and precision gives the energies of the direct sum.
#[test]
fn parsec_distances_run_without_softening() {
    let rows: Vec<String> = (0..17)
        .map(|n| {
            let place = |k: usize| 3e16 * ((n * k) as f64 * 0.7548776662466927).fract() - 1.5e16;
            let speed = |k: usize| 300.0 * (((n + 3) * k) as f64 * 0.5698402909980532).fract() - 150.0;
            let numbers = [1.327e20, place(1), place(3), place(5), speed(1), speed(2), speed(3)];
            format!("{numbers:?}")
        })
        .collect();
    for count in [2, 16, 17] {
        let bodies = format!("particles.bodies=[{}]", rows[..count].join(", "));
        let list =
            ["particles.generate=list", &bodies, "integrator.dt=1e9", "run.steps=8", "law.softening=0"];
        let seen = |engine: &str, more: &[&str]| {
            let engine = format!("machine.engine={engine}");
            let mut running = started("figure-eight", &[&list[..], &[&engine], more].concat());
            advance(&mut running, 8).unwrap_or_else(|failure| panic!("{engine} {more:?}: {failure}"));
            running.observe()
        };
        for kind in ["leapfrog", "hermite-4", "gear-6"] {
            let kind = format!("integrator.kind={kind}");
            let [_, kinetic, potential, ..] = seen("reference", &[&kind])[..] else { panic!() };
            for engine in ["fast", "programs"] {
                for more in [&[][..], &["machine.precision=mixed"], &["machine.arithmetic=estimated"]] {
                    if engine == "programs" && more.iter().any(|set| set.contains("arithmetic")) {
                        continue;
                    }
                    let found = seen(engine, &[&[kind.as_str()], more].concat());
                    let off = |found: f64, expected: f64| (found / expected - 1.0).abs();
                    let here = format!("{count} {engine} {kind} {more:?}: {found:?}");
                    assert!(off(found[1], kinetic) < 1e-6 && off(found[2], potential) < 1e-6, "{here}");
                }
            }
        }
    }
}

/// A light body escapes at speed 1e18, to where numbers are coarser than 1: the others move as without it.
#[test]
fn escaping_bodies_disturb_no_others() {
    let rows: Vec<String> = (0..15)
        .map(|n| {
            let place = |k: usize| 2.0 * ((n * k) as f64 * 0.7548776662466927).fract() - 1.0;
            format!("{:?}", [0.0625, place(1), place(3), place(5), 0.0, 0.0, 0.0])
        })
        .collect();
    let places = |with: bool, more: &[&str]| {
        let escaper = if with { ", [1e-6, 5e15, 0.0, 0.0, 1e18, 0.0, 0.0]" } else { "" };
        let bodies = format!("particles.bodies=[{}{escaper}]", rows.join(", "));
        let list = ["particles.generate=list", &bodies, "integrator.dt=1e-4", "run.steps=200"];
        let mut running = started("figure-eight", &[&list[..], more].concat());
        advance(&mut running, 200).unwrap_or_else(|failure| panic!("{more:?}: {failure}"));
        let all = running.particles();
        all.all()[..15].iter().map(|body| body.position).collect::<Vec<_>>()
    };
    let alone = places(false, &["machine.engine=reference"]);
    for more in [
        &["machine.engine=reference"][..],
        &["machine.engine=fast"],
        &["machine.engine=fast", "machine.arithmetic=estimated"],
        &["machine.engine=fast", "machine.precision=mixed"],
        &["machine.engine=programs", "machine.precision=mixed"],
        &["machine.engine=fast", "integrator.kind=hermite-4"],
        &["machine.engine=fast", "integrator.kind=hermite-4", "machine.precision=mixed"],
    ] {
        for (body, (found, expected)) in places(true, more).iter().zip(&alone).enumerate() {
            let off = (0..3).map(|axis| (found[axis] - expected[axis]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-7, "{more:?}: body {body} is off by {off}");
        }
    }
}

/// Two bodies on a parabola have zero energy up to rounding. Its error is relative to the kinetic energy at the start, ¼, also for
/// speeds with eight decimals.
#[test]
fn the_energy_error_of_a_parabola_is_small() {
    for speed in ["0.7071067811865476", "0.70710678", "0.7"] {
        let bodies =
            format!("particles.bodies=[[0.5, -0.5, 0, 0, 0, -{speed}, 0], [0.5, 0.5, 0, 0, 0, {speed}, 0]]");
        let sets = [
            "particles.generate=list",
            &bodies,
            "integrator.dt=0.001",
            "integrator.kind=leapfrog",
            "run.steps=5000",
        ];
        let mut running = started("figure-eight", &sets);
        advance(&mut running, 5000).unwrap();
        let [error, balance] = [3, 10].map(|column| running.observe()[column]);
        let kinetic = 0.5 * speed.parse::<f64>().unwrap().powi(2);
        assert!(
            (error - balance / kinetic).abs() < 1e-3 * error.abs() && error.abs() < 1e-6,
            "{error} {balance}"
        );
        assert_eq!(running.summary()["energy_error"].as_f64().unwrap(), error);
        assert!(running.in_words().contains("e-") && running.warnings().is_empty(), "{}", running.in_words());
    }
}
