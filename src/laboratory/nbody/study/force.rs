//! PWP's force and scheme, one change at a time: the printed formula, softening, damping and the missing ½; and its tester.

use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::study::StudyError;
use stripmine_physics::method::nbody::keys::{COUNT, DAMPING, ECCENTRICITY, ENGINE, INTEGRATOR, SOFTENING};
use stripmine_physics::method::nbody::options::ForceEngine;
use stripmine_physics::method::nbody::schemes::SchemeName;
use stripmine_physics::method::nbody::starts::ORBIT;
use stripmine_physics::scene::{DT, Overrides};
use stripmine_physics::words::Words;

/// Steps per orbit, and orbits.
const STEPS: u64 = 1024;
const ORBITS: u64 = 10;
/// Damping of a step.
const DAMPED: f64 = 0.9999;
/// Eccentricity of an orbit that nearly meets the other body, and its softening.
const CLOSE: f64 = 0.9999;
const SOFT: f64 = 0.1;
/// Relative energy error above which an orbit is lost.
const LOST: f64 = 0.5;
/// Bodies of the tester, and steps before it compares.
const TESTED: u64 = 128;
const TESTER_STEPS: u64 = 200;

/// Form of the attraction of a unit mass at a displacement.
type Attraction = fn([f64; 2]) -> [f64; 2];

/// Forms of the force. Without a vector the same number acts along each axis, the only way in which a program can use it.
const FORCES: [(&str, Attraction); 4] = [
    ("as printed: no vector, no cube", |d| [1.0 / length(d); 2]),
    ("with the vector alone", |d| d.map(|along| along / length(d))),
    ("with the cube alone", |d| [length(d).powi(-3); 2]),
    ("with both", |d| d.map(|along| along / length(d).powi(3))),
];

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// Two bodies of mass ½ on an orbit of eccentricity ½, from the nearest point: positions and velocities.
#[derive(Clone, Copy)]
struct TwoBodies {
    at: [[f64; 2]; 2],
    velocity: [[f64; 2]; 2],
}

impl TwoBodies {
    const MASS: f64 = 0.5;

    /// The orbit's start: a distance of ½ and a relative speed of √3.
    fn start() -> TwoBodies {
        let speed = 0.5 * 3.0_f64.sqrt();
        TwoBodies { at: [[-0.25, 0.0], [0.25, 0.0]], velocity: [[0.0, -speed], [0.0, speed]] }
    }

    fn separation(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.at[1][axis] - self.at[0][axis])
    }

    /// Energy of Newton's law.
    fn energy(&self) -> f64 {
        let kinetic: f64 =
            self.velocity.iter().map(|&velocity| 0.5 * Self::MASS * length(velocity).powi(2)).sum();
        kinetic - Self::MASS * Self::MASS / length(self.separation())
    }

    fn momentum(&self) -> f64 {
        length([0, 1].map(|axis| Self::MASS * (self.velocity[0][axis] + self.velocity[1][axis])))
    }

    /// A step of leapfrog.
    fn step(&mut self, attraction: Attraction, dt: f64) {
        self.kick(attraction, 0.5 * dt);
        for (at, velocity) in self.at.iter_mut().zip(self.velocity) {
            (0..2).for_each(|axis| at[axis] += dt * velocity[axis]);
        }
        self.kick(attraction, 0.5 * dt);
    }

    fn kick(&mut self, attraction: Attraction, dt: f64) {
        let d = self.separation();
        let pulls = [attraction(d), attraction(d.map(|along| -along))];
        for (velocity, pull) in self.velocity.iter_mut().zip(pulls) {
            (0..2).for_each(|axis| velocity[axis] += dt * Self::MASS * pull[axis]);
        }
    }
}

/// Relative energy error and momentum after an orbit with a form of the force.
fn orbit_with(attraction: Attraction) -> [f64; 2] {
    let mut bodies = TwoBodies::start();
    let energy = bodies.energy();
    (0..STEPS).for_each(|_| bodies.step(attraction, ORBIT / STEPS as f64));
    [(bodies.energy() / energy - 1.0).abs(), bodies.momentum()]
}

/// Energy over its initial value after each orbit, for PWP's scheme, with the ½ and with damping, each alone and together.
fn energies(scheme: SchemeName, damping: f64) -> Result<Vec<f64>, StudyError> {
    let overrides = Overrides::new().set(&INTEGRATOR, scheme).set(&DT, ORBIT / STEPS as f64);
    let overrides = match scheme {
        SchemeName::DampedEuler => overrides.set(&DAMPING, damping),
        _ => overrides,
    };
    let mut running = RunningScene::begin_timed("kepler", &overrides)?;
    let start = energy(&running)?;
    let mut found = vec![1.0];
    for _ in 0..ORBITS {
        running.advance_steps(STEPS)?;
        found.push(energy(&running)? / start);
    }
    Ok(found)
}

fn energy(running: &RunningScene) -> Result<f64, StudyError> {
    let [kinetic, potential] = running.observed_values(["kinetic", "potential"])?;
    Ok(kinetic + potential)
}

/// Largest relative energy error along an orbit that nearly meets the other body; none if the orbit is lost.
fn close_orbit(softening: f64) -> Result<Option<f64>, StudyError> {
    let orbit = Overrides::new().set(&ECCENTRICITY, CLOSE).set(&SOFTENING, softening);
    let mut running = RunningScene::begin_timed("kepler", &orbit.set(&DT, ORBIT / STEPS as f64))?;
    let start = energy(&running)?;
    let mut largest = 0.0_f64;
    for _ in 0..STEPS {
        if running.advance_steps(1).is_err() {
            return Ok(None);
        }
        largest = largest.max((energy(&running)? / start - 1.0).abs());
    }
    Ok((largest < LOST).then_some(largest))
}

/// Positions and velocities of PWP's two clusters after some steps by an engine.
fn tested(engine: ForceEngine) -> Result<Vec<[f64; 6]>, StudyError> {
    let scene = Overrides::new().set(&COUNT, TESTED).set(&ENGINE, engine);
    let mut running = RunningScene::begin_timed("two-clusters", &scene)?;
    running.advance_steps(TESTER_STEPS)?;
    let state = |[x, y, z]: [f64; 3], [u, v, w]: [f64; 3]| [x, y, z, u, v, w];
    Ok(running.simulation.particles().all().iter().map(|body| state(body.position, body.velocity)).collect())
}

/// Accelerations of a sphere's bodies with and without the term of the body itself: number of numbers that differ in any bit.
fn self_term_differences(softening: f64) -> Result<usize, StudyError> {
    let sphere = RunningScene::begin_timed("plummer", &Overrides::new().set(&COUNT, TESTED))?;
    let bodies = sphere.simulation.particles();
    let sum = |own: usize, with_self: bool| {
        let mut sum = [0.0_f64; 3];
        for (number, other) in bodies.all().iter().enumerate() {
            if number == own && !with_self {
                continue;
            }
            let d: [f64; 3] =
                std::array::from_fn(|axis| other.position[axis] - bodies.all()[own].position[axis]);
            let square = d.iter().map(|along| along * along).sum::<f64>() + softening * softening;
            (0..3).for_each(|axis| sum[axis] += other.mass * d[axis] / (square * square.sqrt()));
        }
        sum
    };
    let differ = |own: usize| {
        let [with_self, without] = [true, false].map(|with_self| sum(own, with_self));
        (0..3).filter(|&axis| with_self[axis].to_bits() != without[axis].to_bits()).count()
    };
    Ok((0..bodies.all().len()).map(differ).sum())
}

/// Makes every comparison.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    use SchemeName::{DampedEuler, EulerWithHalf, Leapfrog};
    let schemes = [
        ("PWP's scheme", DampedEuler, 1.0),
        ("with damping alone", DampedEuler, DAMPED),
        ("with the ½ alone", EulerWithHalf, 1.0),
        ("leapfrog", Leapfrog, 1.0),
    ];
    let meter = ProgressMeter::new(schemes.len() as f64, lab.progress);
    let energies = meter.run_cases(&schemes, |&(_, scheme, damping)| energies(scheme, damping))?;
    let orbits = schemes.iter().zip(&energies).flat_map(|((name, ..), energies)| {
        energies.iter().enumerate().map(move |(orbit, energy)| (*name, orbit, *energy))
    });
    let engines = [ForceEngine::Reference, ForceEngine::Fast, ForceEngine::Programs];
    let states = engines.into_iter().map(tested).collect::<Result<Vec<_>, _>>()?;
    let farthest = |at: usize| {
        let apart =
            |(a, b): (&[f64; 6], &[f64; 6])| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        states[0].iter().zip(&states[at]).map(apart).fold(0.0, f64::max)
    };
    let close = [0.0, SOFT].map(|softening| close_orbit(softening).map(|error| (softening, error)));
    let close = close.into_iter().collect::<Result<Vec<_>, _>>()?;
    let differing = self_term_differences(SOFT)?;
    Ok(FinishedItem::of([
        FrameBuilder::of(FORCES.map(|(name, attraction)| (name, orbit_with(attraction))))
            .text("force", |(name, _)| *name)
            .short("|ΔE/E| after an orbit", |(_, [error, _])| *error)
            .short("momentum after an orbit", |(_, [_, momentum])| *momentum)
            .frame("forces", "Two bodies, e = 0.5, leapfrog with 1024 steps an orbit"),
        FrameBuilder::of(orbits)
            .text("scheme", |(name, ..)| *name)
            .count("orbits", |(_, orbit, _)| *orbit)
            .number("energy over that of the start", 4, |(.., energy)| *energy)
            .frame("energies", "Energy after each orbit, e = 0.5, 1024 steps an orbit"),
        FrameBuilder::of(close)
            .number("softening", 2, |(softening, _)| *softening)
            .short("largest |ΔE/E|", |(_, error)| *error)
            .text("keeps the orbit", |(_, error)| if error.is_some() { "yes" } else { "no" })
            .frame("close", "An orbit of eccentricity 0.9999, 1024 steps of leapfrog"),
        FrameBuilder::of(1..engines.len())
            .text("engine", |&at| engines[at].word())
            .short("farthest from the reference", |&at| farthest(at))
            .frame(
                "tester",
                "Positions and velocities of two clusters of 64 bodies after 200 steps, compared with the direct sum",
            ),
        FrameBuilder::of([()])
            .count("numbers that differ", |()| differing)
            .count("numbers", |()| 3 * TESTED)
            .frame("self_term", "Accelerations with and without the term of the body itself, softening 0.1"),
    ])
    .with_seeds([1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: a circular orbit of two bodies of mass ½ at distance 1 has an energy of −1/8; Newton's law keeps the ellipse.
    #[test]
    fn newtons_law_alone_keeps_the_orbit() {
        let speed = 0.5;
        let circle = TwoBodies { at: [[-0.5, 0.0], [0.5, 0.0]], velocity: [[0.0, -speed], [0.0, speed]] };
        assert!((circle.energy() + 0.125).abs() < 1e-15);
        assert!((TwoBodies::start().energy() + 0.125).abs() < 1e-15);
        let errors = FORCES.map(|(_, attraction)| orbit_with(attraction));
        assert!(errors[3][0] < 2e-4 && errors[3][1] < 1e-13, "{errors:?}");
        assert!(errors[..3].iter().all(|[error, _]| *error > 0.1), "{errors:?}");
    }
}
