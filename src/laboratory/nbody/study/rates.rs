//! Interactions a second, and how exact the forces are.

use crate::laboratory::running::{Running, on_threads};
use crate::results::Progress;
use crate::statistics::median;
use crate::study::StudyError;
use serde::Serialize;
use std::time::Instant;
use stripmine_kernels::InstructionSet;
use stripmine_physics::method::Failure;
use stripmine_physics::method::nbody::bodies::{Bodies, zeros};
use stripmine_physics::method::nbody::field::{Attraction, never, potential};
use stripmine_physics::method::nbody::keys::{ROOTS, SOFTENING};
use stripmine_physics::method::nbody::options::{ArithmeticKind, StartKind};
use stripmine_physics::method::nbody::scene::Scene;
use stripmine_physics::method::nbody::schemes::Field;
use stripmine_physics::method::nbody::starts::bodies;
use stripmine_physics::particles::{Particle, Particles};
use stripmine_physics::scene::{DT, Overrides, PRECISION, Precision};
use stripmine_physics::words::Words;

/// The ways to compute forces.
const WAYS: [(Precision, ArithmeticKind); 5] = [
    (Precision::Mixed, ArithmeticKind::Raw),
    (Precision::Mixed, ArithmeticKind::Estimated),
    (Precision::Mixed, ArithmeticKind::Exact),
    (Precision::F64, ArithmeticKind::Estimated),
    (Precision::F64, ArithmeticKind::Exact),
];
/// Bodies whose forces are held against the sum as it is written.
const SAMPLED: usize = 512;
/// Softening of the sphere whose energy is followed (length).
const SOFTENED: f64 = 0.05;
/// Threads compared.
pub const THREADS: [usize; 2] = [1, 2];

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Numbers of bodies.
    pub bodies: Vec<usize>,
    /// Seconds of a measurement, at least.
    pub seconds: f64,
    /// Alternating repeats.
    pub rounds: usize,
}

/// A way and a number of bodies.
#[derive(Clone, Debug, Serialize)]
pub struct Rate {
    /// Precision of the forces.
    pub precision: &'static str,
    /// How roots are formed.
    pub arithmetic: &'static str,
    /// Bodies.
    pub bodies: usize,
    /// Directed interactions a second, N² counted, in 10⁹, by threads: medians.
    pub rates: [f64; 2],
    /// The largest error of an acceleration over the largest acceleration: of the kernel, for masses as it sees them; and with what
    /// rounding of the masses adds where forces are in single precision.
    pub error: [f64; 2],
}

/// A Plummer sphere that a leapfrog moves.
#[derive(Clone, Debug, Serialize)]
pub struct Conserving {
    /// How roots are formed.
    pub arithmetic: &'static str,
    /// Precision of the forces.
    pub precision: &'static str,
    /// Steps of a unit of time.
    pub steps: u64,
    /// |ΔE/E| after two units of time.
    pub error: f64,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Rates {
    /// The instruction set.
    pub instruction_set: &'static str,
    /// Rates.
    pub rates: Vec<Rate>,
    /// Energy errors of single and double precision.
    pub conserving: Vec<Conserving>,
    /// Whether two threads gave the bits of one, everywhere.
    pub same_bits: bool,
}

/// Measures every way.
///
/// # Errors
/// [`StudyError`] if threads cannot be had.
pub fn rates(effort: &Effort, progress: Progress<'_>) -> Result<Rates, StudyError> {
    let (mut rates, mut same_bits) = (vec![], true);
    let all = (effort.bodies.len() * WAYS.len() + 1) as f64;
    for &count in &effort.bodies {
        for (precision, arithmetic) in WAYS {
            let (rate, same) = rate(count, precision, arithmetic, effort)?;
            rates.push(rate);
            same_bits &= same;
            progress(rates.len() as f64 / all);
        }
    }
    let mut conserving = vec![];
    for (arithmetic, precision) in [
        (ArithmeticKind::Exact, Precision::F64),
        (ArithmeticKind::Exact, Precision::Mixed),
        (ArithmeticKind::Estimated, Precision::Mixed),
        (ArithmeticKind::Raw, Precision::Mixed),
    ] {
        for steps in [128, 512] {
            conserving.push(conserving_run(arithmetic, precision, steps)?);
        }
    }
    progress(1.0);
    Ok(Rates { instruction_set: InstructionSet::best().name(), rates, conserving, same_bits })
}

fn rate(
    count: usize,
    precision: Precision,
    arithmetic: ArithmeticKind,
    effort: &Effort,
) -> Result<(Rate, bool), StudyError> {
    let mut scene = Scene { softening: 0.01, precision, arithmetic, ..Scene::default() };
    (scene.start.kind, scene.start.count) = (StartKind::Plummer, count);
    let all = Bodies::new(bodies(&scene.start, 0.01, 1.0).into_iter().map(|(m, r, v)| (r, v, m)));
    let mut found = [vec![], vec![]];
    let mut last = vec![];
    for _ in 0..effort.rounds {
        for (rates, threads) in found.iter_mut().zip(THREADS) {
            let (rate, accelerations) = on_threads(threads, || {
                let mut field = Attraction::new(&scene, &all)?;
                let mut into = zeros(all.entries());
                field.asking(false, &never).acceleration(&all.position, &mut into).map_err(Failure::from)?;
                let (begun, mut sweeps) = (Instant::now(), 0);
                while begun.elapsed().as_secs_f64() < effort.seconds {
                    field
                        .asking(false, &never)
                        .acceleration(&all.position, &mut into)
                        .map_err(Failure::from)?;
                    sweeps += 1;
                }
                let seconds = begun.elapsed().as_secs_f64() / f64::from(sweeps);
                Ok((1e-9 * (count as f64).powi(2) / seconds, into))
            })?;
            rates.push(rate);
            last.push(accelerations);
        }
    }
    let same = last.windows(2).all(|pair| pair[0] == pair[1]);
    let error = |is_rounded: bool| {
        let (mut largest, mut worst) = (0.0_f64, 0.0_f64);
        // Some bodies, spread over all.
        for body in (0..count).step_by((count / SAMPLED).max(1)) {
            let expected = written_down(&all, body, scene.softening, is_rounded);
            for (axis, expected) in expected.into_iter().enumerate() {
                largest = largest.max(expected.abs());
                worst = worst.max((last[0][axis][body] - expected).abs());
            }
        }
        worst / largest
    };
    let error = [error(precision != Precision::F64), error(false)];
    let rates = found.map(|rates| median(rates.into_iter()));
    Ok((
        Rate { precision: precision.word(), arithmetic: arithmetic.word(), bodies: count, rates, error },
        same,
    ))
}

/// The acceleration of a body, its partners one after the other and summed with the digits that additions lose (Neumaier);
/// masses rounded to single precision first, where a kernel sees them so.
fn written_down(all: &Bodies, body: usize, softening: f64, is_rounded: bool) -> [f64; 3] {
    let seen = |value: f64| if is_rounded { f64::from(value as f32) } else { value };
    let mut sums = [[0.0_f64; 2]; 3];
    for other in (0..all.len()).filter(|&other| other != body) {
        let way = [0, 1, 2].map(|axis| all.position[axis][other] - all.position[axis][body]);
        let square = way.iter().map(|part| part * part).sum::<f64>() + seen(softening).powi(2);
        let pull = seen(all.mass[other]) / (square * square.sqrt());
        for (sum, part) in sums.iter_mut().zip(way) {
            let [before, lost] = *sum;
            let term = pull * part;
            let after = before + term;
            let rest =
                if before.abs() >= term.abs() { (before - after) + term } else { (term - after) + before };
            *sum = [after, lost + rest];
        }
    }
    sums.map(|[sum, lost]| sum + lost)
}

/// Kinetic energy and that of the pairs, in double precision.
fn energy(particles: &Particles, softening: f64) -> Result<f64, StudyError> {
    let all = particles.all();
    let mass: Vec<f64> = all.iter().map(|body| body.mass).collect();
    let position = [0, 1, 2].map(|axis| all.iter().map(|body| body.position[axis]).collect());
    let square = |body: &Particle| body.velocity.iter().map(|v| v * v).sum::<f64>();
    let kinetic: f64 = all.iter().map(|body| 0.5 * body.mass * square(body)).sum();
    let potential = potential(&mass, &position, softening, &never).map_err(Failure::from)?;
    Ok(kinetic + potential)
}

fn conserving_run(
    arithmetic: ArithmeticKind,
    precision: Precision,
    steps: u64,
) -> Result<Conserving, StudyError> {
    let machine = Overrides::new().set(&PRECISION, precision).set(&ROOTS, arithmetic);
    let overrides = machine.set(&DT, 1.0 / steps as f64).set(&SOFTENING, SOFTENED);
    let mut running = Running::timed("plummer", &overrides)?;
    let begin = energy(&running.simulation.particles(), SOFTENED)?;
    running.steps(2 * steps)?;
    let error = energy(&running.simulation.particles(), SOFTENED)? / begin - 1.0;
    Ok(Conserving { arithmetic: arithmetic.word(), precision: precision.word(), steps, error: error.abs() })
}
