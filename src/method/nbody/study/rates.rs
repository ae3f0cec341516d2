//! Interactions a second, and how exact the forces are.

use super::Running;
use crate::console::Failure;
use crate::method::Progress;
use crate::method::nbody::bodies::{Bodies, zeros};
use crate::method::nbody::field::Attraction;
use crate::method::nbody::options::{ArithmeticKind, Engine, StartKind};
use crate::method::nbody::scene::Scene;
use crate::method::nbody::schemes::Field;
use crate::method::nbody::starts::bodies;
use crate::scene::Precision;
use crate::statistics::median;
use crate::words::Words;
use serde::Serialize;
use std::time::Instant;
use stripmine_kernels::InstructionSet;

/// The ways to compute forces.
const WAYS: [(Precision, ArithmeticKind); 4] = [
    (Precision::Mixed, ArithmeticKind::Estimated),
    (Precision::Mixed, ArithmeticKind::Exact),
    (Precision::F64, ArithmeticKind::Estimated),
    (Precision::F64, ArithmeticKind::Exact),
];
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
    /// The largest error of an acceleration over the largest acceleration.
    pub error: f64,
}

/// A Plummer sphere that a leapfrog moves.
#[derive(Clone, Debug, Serialize)]
pub struct Conserving {
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
/// [`Failure`] if threads cannot be had.
pub fn rates(effort: &Effort, progress: Progress<'_>) -> Result<Rates, Failure> {
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
    for precision in [Precision::F64, Precision::Mixed] {
        for steps in [128, 512] {
            conserving.push(conserving_run(precision, steps)?);
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
) -> Result<(Rate, bool), Failure> {
    let mut scene = Scene { softening: 0.01, precision, arithmetic, ..Scene::default() };
    (scene.start.kind, scene.start.count) = (StartKind::Plummer, count);
    let all = Bodies::new(bodies(&scene.start, 0.01).into_iter().map(|(m, r, v)| (r, v, m)));
    let mut found = [vec![], vec![]];
    let mut last = vec![];
    for _ in 0..effort.rounds {
        for (rates, threads) in found.iter_mut().zip(THREADS) {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::Threads)?;
            let (rate, accelerations) = pool.install(|| -> Result<_, Failure> {
                let mut field = Attraction::new(&scene, &all);
                let mut into = zeros(all.entries());
                field.acceleration(&all.position, &mut into).map_err(crate::method::Failure::from)?;
                let (begun, mut sweeps) = (Instant::now(), 0);
                while begun.elapsed().as_secs_f64() < effort.seconds {
                    field.acceleration(&all.position, &mut into).map_err(crate::method::Failure::from)?;
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
    // A few bodies against the sum as it is written.
    let mut reference = Attraction::new(&Scene { engine: Engine::Reference, ..scene }, &all);
    let mut expected = zeros(all.entries());
    reference.acceleration(&all.position, &mut expected).map_err(crate::method::Failure::from)?;
    let largest = expected.iter().flatten().fold(0.0, |most: f64, a| most.max(a.abs()));
    let error = last[0].iter().zip(&expected).flat_map(|(found, expected)| {
        found.iter().zip(expected).take(count).map(|(found, expected)| (found - expected).abs() / largest)
    });
    let error = error.fold(0.0, f64::max);
    let rates = found.map(|rates| median(rates.into_iter()));
    Ok((
        Rate { precision: precision.word(), arithmetic: arithmetic.word(), bodies: count, rates, error },
        same,
    ))
}

fn conserving_run(precision: Precision, steps: u64) -> Result<Conserving, Failure> {
    let overrides = [
        format!("machine.precision={}", precision.word()),
        format!("integrator.dt={:?}", 1.0 / steps as f64),
        "law.softening=0.05".to_owned(),
    ];
    let mut running = Running::begin("plummer", &overrides)?;
    running.steps(2 * steps)?;
    // By the energy of the pairs in double precision: the state is the same.
    let [error] = running.observed(["energy_error"]);
    Ok(Conserving { precision: precision.word(), steps, error: error.abs() })
}
