//! Changed simulations, compared with exact motion; changes that are refused.

use super::{BATH, GRAVITY, VELOCITIES, advance, change, started};
use crate::method::{METHODS, Simulation, SteeredQuantity, SteeringError, Until};
use crate::particles::{Particle, Particles};

/// Value of an observed quantity.
fn observed(simulation: &dyn Simulation, method: &str, name: &str) -> f64 {
    let entry = METHODS.iter().find(|entry| entry.vocabulary.keys.method == method).unwrap();
    let at = entry.quantities.iter().position(|quantity| quantity.name == name).unwrap();
    simulation.observe()[at]
}

fn planar(particles: &Particles) -> Vec<[f64; 4]> {
    let of = |it: &Particle| [it.position[0], it.position[1], it.velocity[0], it.velocity[1]];
    particles.all().iter().map(of).collect()
}

/// Steps of 2⁻⁷ and times as sums of powers of two: free flight and fall have no rounding.
const DYADIC: &str = "integrator.dt=0.0078125";
/// Two granular discs far from each other, and integrators that are exact under constant forces.
const APART: [&str; 4] = [DYADIC, "law.stiffness=1.0", "law.normal_damping=0.0", "law.shear_damping=0.0"];

/// Discs at (3, 4) and (6, 4¼) get velocities after 16 steps: x + v t, every digit; later gravity: x + v t + ½ g t².
#[test]
fn changed_discs_fly_and_fall_exactly() {
    let soft = |more: &[&'static str]| [&APART[..], more].concat();
    for (preset, overrides, digits) in [
        ("two-discs", soft(&["integrator.kind=velocity-verlet"]), 0.0),
        ("two-discs", soft(&["integrator.kind=velocity-verlet", "search.by=neighbor-list"]), 0.0),
        ("two-discs", soft(&["integrator.kind=velocity-verlet", "machine.engine=programs"]), 0.0),
        ("two-discs", soft(&[]), 1e-13),
        ("two-discs", soft(&["machine.engine=programs"]), 1e-13),
    ] {
        let mut simulation = started(preset, &overrides);
        // Until then the first disc moves with 1 along x.
        advance(simulation.as_mut(), Until::Steps(16));
        simulation.steer(&change(VELOCITIES, &[0.5, -0.25, -0.125, 1.0])).unwrap();
        advance(simulation.as_mut(), Until::Steps(16 + 128));
        let expected = [[3.125 + 0.5, 4.0 - 0.25, 0.5, -0.25], [6.0 - 0.125, 4.25 + 1.0, -0.125, 1.0]];
        let compare = |simulation: &dyn Simulation, expected: [[f64; 4]; 2]| {
            for (found, expected) in planar(&simulation.particles()).iter().zip(expected) {
                let is_near = found.iter().zip(expected).all(|(it, exact)| (it - exact).abs() <= digits);
                assert!(is_near, "{preset} {overrides:?}: {found:?}, not {expected:?}");
            }
        };
        compare(simulation.as_ref(), expected);
        simulation.steer(&change(GRAVITY, &[0.25, -2.0])).unwrap();
        compare(simulation.as_ref(), expected);
        advance(simulation.as_mut(), Until::Steps(16 + 128 + 64));
        // t = ½: ½ g t² = (1/32, −¼), g t = (⅛, −1).
        let fall = |[x, y, u, v]: [f64; 4]| [x + 0.5 * u + 0.03125, y + 0.5 * v - 0.25, u + 0.125, v - 1.0];
        compare(simulation.as_ref(), expected.map(fall));
        let balance = observed(simulation.as_ref(), "lattice-md", "balance_error");
        assert!(balance.abs() < 1e-13, "{preset} {overrides:?}: {balance}");
        // ½ m Δv² of the change, by hand: (½² + ¼² + ⅛² + 1² − 1²)/2.
        let work = simulation.summary()["work_of_changes"].as_f64().unwrap();
        assert!((work - 0.5 * (0.25 + 0.0625 + 0.015625)).abs() < 1e-13, "{work}");
    }
}

/// Gravity along a periodic side, which did not count crossings before: discs fall through 8 of its periods, and gravity's work is m g · (g t²/2).
#[test]
fn work_of_changed_gravity_crosses_periods() {
    for engine in ["fast", "programs"] {
        let machine = format!("machine.engine={engine}");
        let box_of = ["domain.periodic=[true, true]", "domain.sides=[12.0, 8.0]", &machine];
        let overrides = [
            &APART[..],
            &box_of,
            &["integrator.kind=velocity-verlet", "particles.velocities=[[0, 0], [0, 0]]"],
        ];
        let mut simulation = started("two-discs", &overrides.concat());
        advance(simulation.as_mut(), Until::Steps(8));
        simulation.steer(&change(GRAVITY, &[0.0, -2.0])).unwrap();
        advance(simulation.as_mut(), Until::Steps(8 + 1024));
        let [kinetic, balance] =
            ["kinetic", "balance_error"].map(|name| observed(simulation.as_ref(), "lattice-md", name));
        assert_eq!(kinetic, 2.0 * 0.5 * 16.0 * 16.0);
        assert!(balance.abs() < 1e-10, "{balance}");
        assert_eq!(simulation.summary()["energy"]["gravity_work"], 2.0 * 2.0 * 64.0);
    }
}

/// Hard discs: flight and fall between two events, and the energy error, in which no change appears.
#[test]
fn changed_hard_discs_fly_and_fall_exactly() {
    let overrides = [
        "particles.generate=list",
        "particles.positions=[[3.0, 4.0], [6.0, 4.25]]",
        "particles.velocities=[[1.0, 0.0], [0.0, 0.0]]",
        "domain.sides=[12.0, 8.0]",
        "domain.periodic=[false, false]",
        "run.time=9.0",
    ];
    for engine in ["fast", "reference"] {
        let machine = format!("machine.engine={engine}");
        let mut simulation = started("hard-disks", &[&overrides[..], &[&machine]].concat());
        advance(simulation.as_mut(), Until::Time(0.125));
        simulation.steer(&change(VELOCITIES, &[0.5, -0.25, -0.125, 1.0])).unwrap();
        simulation.steer(&change(GRAVITY, &[0.25, -2.0])).unwrap();
        advance(simulation.as_mut(), Until::Time(0.625));
        let expected = [
            [3.125 + 0.25 + 0.03125, 4.0 - 0.125 - 0.25, 0.625, -1.25],
            [6.0 - 0.0625 + 0.03125, 4.25 + 0.5 - 0.25, 0.0, 0.0],
        ];
        assert_eq!(planar(&simulation.particles()), expected);
        let error = observed(simulation.as_ref(), "hard-disks", "energy_error");
        assert!(error.abs() < 1e-14, "{error}");
        // ½ m Δv², and −m Δg · r of both discs at the change.
        let potential = -0.25 * (3.125 + 6.0) + 2.0 * (4.0 + 4.25);
        let work = simulation.summary()["work_of_changes"].as_f64().unwrap();
        assert!((work - 0.5 * 0.328125 - potential).abs() < 1e-13, "{work}");
        // They bounce for a while, without a loss.
        advance(simulation.as_mut(), Until::Time(8.0));
        let error = observed(simulation.as_ref(), "hard-disks", "energy_error");
        assert!(error.abs() < 1e-12, "{error}");
    }
}

/// Free particles in a bath whose temperature rises from 1 to 3: kT(t) = 3 − 2 exp(−2 γ t/m). Of 20,000 particles the error of kT is 0.7 %.
#[test]
fn temperature_relaxes_to_that_of_the_bath() {
    let overrides = ["particles.count=20000", "integrator.dt=0.05", "domain.sides=[500.0, 500.0]"];
    for scheme in ["baoab", "stochastic"] {
        let integrator = format!("integrator.kind={scheme}");
        let mut simulation = started("langevin-free", &[&overrides[..], &[&integrator]].concat());
        advance(simulation.as_mut(), Until::Steps(10));
        simulation.steer(&change(BATH, &[3.0])).unwrap();
        for steps in [5, 10, 20, 60] {
            advance(simulation.as_mut(), Until::Steps(10 + steps));
            let exact = 3.0 - 2.0 * (-2.0 * 0.05 * steps as f64).exp();
            let found = observed(simulation.as_ref(), "langevin", "temperature");
            assert!((found / exact - 1.0).abs() < 0.03, "{scheme}: {found}, not {exact}");
        }
    }
}

/// Bodies whose velocities are reversed return to the start, with integrators that are reversible and one whose errors are rounding.
#[test]
fn reversed_bodies_return_to_the_start() {
    for (integrator, digits) in [("leapfrog", 1e-11), ("yoshida-4", 1e-11), ("ias15", 1e-11)] {
        let kind = format!("integrator.kind={integrator}");
        let mut simulation = started("kepler", &[&kind]);
        let start = simulation.particles();
        advance(simulation.as_mut(), Until::Steps(100));
        let back: Vec<f64> =
            simulation.particles().all().iter().flat_map(|it| it.velocity.map(|v| -v)).collect();
        simulation.steer(&change(VELOCITIES, &back)).unwrap();
        advance(simulation.as_mut(), Until::Steps(200));
        for (found, start) in simulation.particles().all().iter().zip(start.all()) {
            for axis in 0..3 {
                assert!(
                    (found.position[axis] - start.position[axis]).abs() < digits,
                    "{integrator}: {found:?}"
                );
                assert!(
                    (found.velocity[axis] + start.velocity[axis]).abs() < digits,
                    "{integrator}: {found:?}"
                );
            }
        }
        assert!(observed(simulation.as_ref(), "nbody", "energy_error").abs() < 1e-4);
    }
}

/// A change of the velocities of bodies is no energy error: from ½ m v² by hand.
#[test]
fn work_on_bodies_is_no_error() {
    let mut simulation = started("kepler", &["integrator.kind=ias15"]);
    advance(simulation.as_mut(), Until::Steps(50));
    let twice: Vec<f64> =
        simulation.particles().all().iter().flat_map(|it| it.velocity.map(|v| 1.1 * v)).collect();
    let kinetic = observed(simulation.as_ref(), "nbody", "kinetic");
    simulation.steer(&change(VELOCITIES, &twice)).unwrap();
    let work = simulation.summary()["work_of_changes"].as_f64().unwrap();
    assert!((work - 0.21 * kinetic).abs() < 1e-14, "{work}");
    advance(simulation.as_mut(), Until::Steps(150));
    assert!(observed(simulation.as_ref(), "nbody", "energy_error").abs() < 1e-13);
}

/// Each refusal has its reason and remedy, and changes nothing.
#[test]
fn unsuitable_changes_are_refused_by_name() {
    let omega = SteeredQuantity::AngularVelocities;
    for (preset, overrides, quantity, values, words) in [
        (
            "two-discs",
            &[][..],
            BATH,
            &[1.0][..],
            "no bath_temperature to change: its discs are in no bath\n  help: change velocities",
        ),
        (
            "two-discs",
            &["law.friction=0.0", "law.shear_damping=0.0"],
            omega,
            &[1.0, 1.0],
            "without friction discs do not rotate",
        ),
        (
            "two-discs",
            &[],
            VELOCITIES,
            &[0.0, 1.0, f64::NAN, 0.0],
            "velocities[1, 0] is NaN\n  help: give finite numbers",
        ),
        ("two-discs", &[], omega, &[0.0, f64::INFINITY], "angular_velocities[1] is inf"),
        ("two-discs", &[], GRAVITY, &[0.0, f64::NAN], "gravity[1] is NaN"),
        ("two-discs", &[], VELOCITIES, &[0.0], "velocities has 1 values, which do not fit 2 particles"),
        ("hard-disks", &[], BATH, &[1.0], "no bath_temperature to change: its discs are in no bath"),
        ("hard-disks", &[], GRAVITY, &[0.0, -1.0], "nothing stops the fall across a periodic side"),
        ("langevin-free", &[], GRAVITY, &[0.0, -1.0], "nothing stops the fall across a periodic side"),
        ("langevin-free", &["law.drag=0.0"], BATH, &[1.0], "law.drag is 0"),
        (
            "langevin-free",
            &[],
            BATH,
            &[-1.0],
            "bath_temperature is -1\n  help: give a temperature of 0 or more",
        ),
        ("kepler", &[], GRAVITY, &[0.0, -1.0], "no gravity to change: bodies are points in open space"),
        ("kepler", &[], BATH, &[1.0], "nbody has no bath_temperature"),
    ] {
        let mut simulation = started(preset, overrides);
        let before = simulation.snapshot();
        let refused = simulation.steer(&change(quantity, values)).unwrap_err();
        assert!(
            matches!(refused, SteeringError::Refused { .. }) && refused.to_string().contains(words),
            "{refused}"
        );
        assert_eq!(simulation.snapshot(), before);
    }
    // The velocities of wall discs are those of their motion.
    let mut simulation = started("pipe-small", &[]);
    let particles = simulation.particles();
    let mut velocities: Vec<f64> = particles.all().iter().flat_map(|it| it.planar_velocity()).collect();
    simulation.steer(&change(VELOCITIES, &velocities)).unwrap();
    let last = particles.all().last().unwrap().id;
    *velocities.last_mut().unwrap() += 1.0;
    let refused = simulation.steer(&change(VELOCITIES, &velocities)).unwrap_err().to_string();
    assert!(refused.contains(&format!("moves disc {last}, a wall disc")), "{refused}");
}
