//! Tests of the adaptive integrator: orbits with known solutions, output at any time, restarts, threads and collisions.

use crate::method::nbody::bodies::PointMasses;
use crate::method::nbody::checked::{CheckedNbody, check_nbody_scene};
use crate::method::nbody::keys::VOCABULARY;
use crate::method::nbody::schemes::{
    AccelerationField, BodyIntegrator, Ias15, IntegrationError, StateColumns,
};
use crate::method::nbody::simulation::{NbodySimulation, begin};
use crate::method::{PhysicsFailure, Simulation, StartPurpose, Until};
use crate::scene::SceneValues;
use rayon::ThreadPoolBuilder;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
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

fn position(running: &NbodySimulation, body: usize) -> [f64; 3] {
    running.particles().all()[body].position
}

fn number(running: &NbodySimulation, name: &str) -> f64 {
    running.summary()[name].as_f64().unwrap()
}

/// Positions from Taylor series of order 30 with 128 bits and of order 40 with 160 bits, which agree to 15 digits
/// (tests/references/three_bodies.py). REBOUND 5.2.2 with its IAS15 has the first body at (6.93538, 20.26600), with an energy error of 3·10⁻¹¹:
/// its differences of positions are rounded in the encounter at time 15.83.
#[test]
fn pythagorean_problem_matches_taylor_series() {
    let mut running = started("pythagorean", &[]);
    for (steps, bound, expected) in [
        (1000, 1e-11, [[0.778480410138085, 0.141392300290086], [-2.025092477978199, 0.097219384146058]]),
        (2000, 1e-11, [[3.004292636696399, 0.511925235024686], [-1.388626537510896, -0.470476050252722]]),
        (7000, 1e-5, [[6.933463599011887, 20.26180430595171], [-2.003006002605984, -6.872463435824545]]),
    ] {
        advance(&mut running, steps).unwrap();
        for (body, expected) in expected.iter().enumerate() {
            let found = position(&running, body);
            let off = (found[0] - expected[0]).abs().max((found[1] - expected[1]).abs());
            assert!(off < bound, "after {steps}: body {body} is at {found:?}, off by {off:e}");
        }
        for name in ["energy_error", "largest_energy_error"] {
            assert!(number(&running, name).abs() < 1e-13, "{:?}", running.summary());
        }
    }
    // The lightest escapes: it moves away from the other two, faster than their attraction can stop it.
    let all = running.particles();
    let [first, second, third] = all.all() else { panic!() };
    let apart = |axis: usize| first.position[axis] - 0.5 * (second.position[axis] + third.position[axis]);
    assert!(first.velocity[1] > (2.0 * 12.0 / apart(0).hypot(apart(1))).sqrt() * 0.9);
    let nearest = &running.summary()["nearest_encounter"];
    assert!((nearest["distance"].as_f64().unwrap() / 0.00041412517 - 1.0).abs() < 0.05, "{nearest}");
}

/// Position of the second body relative to the first on an ellipse of semi-major axis 1, by Kepler's equation.
fn kepler(eccentricity: f64, time: f64) -> [f64; 2] {
    let mean = time.rem_euclid(2.0 * PI);
    let (mut low, mut high) = (0.0, 2.0 * PI);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle - eccentricity * f64::sin(middle) < mean { low = middle } else { high = middle }
    }
    [low.cos() - eccentricity, (1.0 - eccentricity * eccentricity).sqrt() * low.sin()]
}

/// Eccentric orbits match Kepler's equation over ten periods, at output times that no step ends at.
#[test]
fn eccentric_orbits_match_keplers_equation() {
    for (eccentricity, bound) in [(0.5, 1e-12), (0.9, 1e-11), (0.99, 1e-10)] {
        let kind = ["integrator.kind=ias15", "integrator.dt=0.3", "run.steps=210"];
        let mut running =
            started("kepler", &[&kind[..], &[&format!("particles.eccentricity={eccentricity}")]].concat());
        let mut worst: f64 = 0.0;
        for steps in 1..=210 {
            advance(&mut running, steps).unwrap();
            let [first, second] = [0, 1].map(|body| position(&running, body));
            let expected = kepler(eccentricity, steps as f64 * 0.3);
            let off = |sign: f64| {
                (0..2)
                    .map(|axis| (sign * (second[axis] - first[axis]) - expected[axis]).abs())
                    .fold(0.0, f64::max)
            };
            worst = worst.max(off(1.0).min(off(-1.0)));
        }
        assert!(worst < bound, "{eccentricity}: off by {worst:e}");
        assert!(number(&running, "largest_energy_error").abs() < 1e-14, "{:?}", running.summary());
    }
}

/// Three bodies on the figure of eight take each other's places after a third of the period, 6.325 913 98 for masses of 1 and √3 times that for a
/// total mass of 1 (Simó 2002), within the eight decimals of their start.
#[test]
fn three_bodies_follow_each_other() {
    let third = 6.325_913_98 * 3f64.sqrt() / 3.0;
    let sets = ["integrator.kind=ias15", &format!("integrator.dt={third:?}"), "run.steps=30"];
    let mut running = started("figure-eight", &sets);
    let places = |running: &NbodySimulation| [0, 1, 2].map(|body| position(running, body));
    let start = places(&running);
    let off = |now: [[f64; 3]; 3], by: usize| {
        let of = |body: usize| (0..2).map(move |axis| (now[(body + by) % 3][axis] - start[body][axis]).abs());
        (0..3).flat_map(of).fold(0.0, f64::max)
    };
    advance(&mut running, 1).unwrap();
    let shift = if off(places(&running), 1) < 0.1 { 1 } else { 2 };
    for (steps, by) in [(1, shift), (2, 3 - shift), (30, 0)] {
        advance(&mut running, steps).unwrap();
        let off = off(places(&running), by);
        assert!(off < 1e-7 * steps as f64, "{steps}: off by {off:e}");
    }
    assert!(number(&running, "largest_energy_error").abs() < 1e-14, "{:?}", running.summary());
}

/// Intervals of output change no bit: states at the same time are those of a run with other intervals, and of one that ends there.
#[test]
fn states_do_not_depend_on_output() {
    let of = |dt: f64, steps: u64| {
        let dt = format!("integrator.dt={dt:?}");
        let mut running = started("pythagorean", &[&dt, &format!("run.steps={steps}")]);
        advance(&mut running, steps).unwrap();
        running.particles()
    };
    let whole = of(4.0, 4);
    for (dt, steps) in [(16.0, 1), (0.25, 64), (0.015625, 1024)] {
        assert_eq!(of(dt, steps), whole, "{dt}");
    }
}

/// A restored run has the bits of an uninterrupted one, also where many outputs lie in a step and where many steps lie between two.
#[test]
fn restored_runs_have_the_same_bits() {
    for dt in ["0.001", "0.5", "16.0"] {
        let dt = format!("integrator.dt={dt}");
        let checked = scene("pythagorean", &["run.steps=12", &dt]);
        let start = || begin(&checked, StartPurpose::Run).unwrap();
        let mut whole = start();
        advance(&mut whole, 12).unwrap();
        for at in [0, 1, 2, 3, 7] {
            let mut first = start();
            advance(&mut first, at).unwrap();
            let mut second = start();
            second.restore(first.clock(), first.snapshot()).unwrap();
            advance(&mut second, 12).unwrap();
            assert_eq!(second.snapshot(), whole.snapshot(), "{dt} {at}");
            assert_eq!(second.summary(), whole.summary(), "{dt} {at}");
        }
    }
}

#[test]
fn threads_give_the_same_bits() {
    let sets = ["particles.count=70", "integrator.kind=ias15", "integrator.dt=0.0625", "run.steps=4"];
    let checked = scene("plummer", &sets);
    let of = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut running = begin(&checked, StartPurpose::Run).unwrap();
            advance(&mut running, 4).unwrap();
            assert!(number(&running, "largest_energy_error").abs() < 1e-13, "{:?}", running.summary());
            running.snapshot()
        })
    };
    let one = of(1);
    assert_eq!(of(3), one);
}

/// Two points that fall onto each other from rest meet after π/(2 √2) d^{3/2} / √(G M) = 1.110721 for a distance and total mass of 1.
#[test]
fn head_on_collisions_are_reported() {
    let bodies = "particles.bodies=[[0.25, 0.75, 2.0, 0.0, 0, 0, 0], [0.75, -0.25, 2.0, 0.0, 0, 0, 0]]";
    let sets =
        ["particles.generate=list", bodies, "integrator.kind=ias15", "integrator.dt=0.1", "run.steps=20"];
    let mut running = started("figure-eight", &sets);
    let failure = advance(&mut running, 20).unwrap_err();
    assert_eq!(failure.kind.name(), "collision", "{failure}");
    assert_eq!(failure.culprits.iter().map(|body| body.id).collect::<Vec<_>>(), [1, 2]);
    for word in ["bodies 1 and 2", "at time 1.1107207", "2, 0)", "law.softening"] {
        assert!(failure.to_string().contains(word), "{word}: {failure}");
    }
    // Softened, they pass through each other and keep their energy.
    let mut softened = started("figure-eight", &[&sets[..], &["law.softening=0.01"]].concat());
    advance(&mut softened, 20).unwrap();
    assert!(number(&softened, "largest_energy_error").abs() < 1e-13, "{:?}", softened.summary());
}

/// Field of a fixed centre that is interrupted after some evaluations.
struct FixedCentre {
    left: u64,
}

impl AccelerationField for FixedCentre {
    fn acceleration(&mut self, position: &StateColumns, into: &mut StateColumns) -> Result<(), ProgramError> {
        self.left = self.left.checked_sub(1).ok_or(ProgramError::Interrupted)?;
        let cube = (0..3).map(|axis| position[axis][0].powi(2)).sum::<f64>().powf(1.5);
        (0..3).for_each(|axis| into[axis][0] = -position[axis][0] / cube);
        Ok(())
    }

    fn precise_acceleration(
        &mut self,
        position: &StateColumns,
        _: &StateColumns,
        into: &mut StateColumns,
    ) -> Result<(), ProgramError> {
        self.acceleration(position, into)
    }

    fn derivatives(
        &mut self,
        position: &StateColumns,
        _: &StateColumns,
        orders: &mut [StateColumns],
    ) -> Result<(), ProgramError> {
        self.acceleration(position, &mut orders[0])
    }
}

/// An interval interrupted at any evaluation and restored gives the bits of an uninterrupted one.
#[test]
fn interrupted_intervals_are_repeated() {
    let start = || PointMasses::new([([1.0, 0.0, 0.0], [0.0, 0.3, 0.0], 1.0)].into_iter());
    let free = &mut FixedCentre { left: u64::MAX };
    let (mut whole, mut bodies) = (Ias15::new(1e-9), start());
    (0..2).for_each(|_| whole.step(&mut bodies, 0.7, free).unwrap());
    for evaluations in [0, 3, 8, 50, 200] {
        let (mut scheme, mut moved) = (Ias15::new(1e-9), start());
        scheme.step(&mut moved, 0.7, free).unwrap();
        let before = moved.clone();
        let carried: Vec<StateColumns> = scheme.carried_columns().into_iter().cloned().collect();
        let numbers: Vec<f64> = scheme.carried_numbers().iter().map(|(_, number)| *number).collect();
        let ended = scheme.step(&mut moved, 0.7, &mut FixedCentre { left: evaluations });
        assert_eq!(ended, Err(IntegrationError::Field(ProgramError::Interrupted)), "{evaluations}");
        moved = before;
        scheme.take_up(&moved, carried);
        scheme.take_up_numbers(&numbers);
        assert!(scheme.check_numbers(1, 0.7).is_ok() && scheme.check_numbers(2, 0.7).is_err());
        scheme.step(&mut moved, 0.7, free).unwrap();
        assert_eq!(moved, bodies, "{evaluations}");
    }
}

/// A written scene reads back as the same scene; an interval of output that is left out is a thousandth of the run.
#[test]
fn written_scenes_read_back_equal() {
    let fine = ["integrator.kind=ias15", "integrator.tolerance=1e-10", "run.steps=64"];
    for checked in [scene("kepler", &fine), scene("pythagorean", &["run.time=35"])] {
        let values = SceneValues::parse("again", &checked.scene.to_toml(), &[], &[&VOCABULARY]).unwrap();
        assert_eq!(check_nbody_scene(values).unwrap().scene, checked.scene);
    }
    let text = include_str!("../../presets/pythagorean.toml");
    let without: String =
        text.lines().filter(|line| !line.starts_with("dt =")).map(|line| format!("{line}\n")).collect();
    let values = SceneValues::parse("without", &without, &[], &[&VOCABULARY]).unwrap();
    let checked = check_nbody_scene(values).unwrap();
    assert_eq!((checked.scene.dt, checked.scene.run.steps), (0.07, 1000));
}
