//! At which density does the lattice overtake neighbour lists and sectors? Whole steps of the fast engine, on this host.

use super::running;
use serde::Serialize;
use std::collections::BTreeMap;
use stripmine_kernels::InstructionSet;
use stripmine_physics::method::lattice_md::Document;
use stripmine_physics::method::lattice_md::keys::{ENGINE, INTEGRATOR, SEARCH};
use stripmine_physics::method::lattice_md::options::{EngineChoice, IntegratorKind};
use stripmine_physics::method::throughput::{MeasurementError, TimedRun};
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, PRECISION};

/// The searches, as `search.by` names them. The lattice comes first.
pub const METHODS: [&str; 3] = ["lattice", "neighbor-list", "sectors"];

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Precisions, as `machine.precision` names them.
    pub precisions: Vec<&'static str>,
    /// Numbers of discs.
    pub particles: Vec<usize>,
    /// Packing fractions, falling.
    pub packing_fractions: Vec<f64>,
    /// Steps of a repeat: enough for lists to be rebuilt.
    pub steps: u64,
    /// Repeats.
    pub repeats: usize,
}

/// A measurement.
#[derive(Clone, Debug, Serialize)]
pub struct Sample {
    /// One of [`METHODS`].
    pub method: &'static str,
    /// Precision.
    pub precision: &'static str,
    /// Discs asked for.
    pub particles: usize,
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// Discs times steps in a second of processor time: the best repeat.
    pub rate: f64,
    /// The same in wall time: the median repeat.
    pub median: f64,
    /// Nanoseconds a disc and step in each phase, best repeat.
    pub phases: BTreeMap<&'static str, f64>,
    /// Contacts a disc at the end.
    pub contacts: f64,
}

/// Where the lattice and the best of its rivals are equally fast.
#[derive(Clone, Debug, Serialize)]
pub struct Crossing {
    /// Precision.
    pub precision: &'static str,
    /// Discs.
    pub particles: usize,
    /// The packing fraction, between two measured ones; none if one side is the faster at all of them.
    pub packing_fraction: Option<f64>,
    /// Rate of the lattice over that of its best rival at the densest and at the thinnest.
    pub ratios: [f64; 2],
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Crossover {
    /// Instructions.
    pub instruction_set: &'static str,
    /// All measurements.
    pub samples: Vec<Sample>,
    /// Where the lattice overtakes.
    pub crossings: Vec<Crossing>,
}

/// Measures, on one thread. `progress` gets the share that is done.
///
/// # Errors
/// [`MeasurementError`] if the scene breaks.
pub fn crossover(effort: &Effort, progress: impl Fn(f64) + Sync) -> Result<Crossover, MeasurementError> {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
    let mut cases = Vec::new();
    for &precision in &effort.precisions {
        for &particles in &effort.particles {
            cases.extend(effort.packing_fractions.iter().map(|&phi| (precision, particles, phi)));
        }
    }
    let mut samples = Vec::new();
    for (done, &case) in cases.iter().enumerate() {
        samples.extend(alone.install(|| case_samples(case, effort))?);
        progress((done + 1) as f64 / cases.len() as f64);
    }
    let groups = effort.precisions.iter().flat_map(|&p| effort.particles.iter().map(move |&n| (p, n)));
    let crossings = groups.filter_map(|(precision, particles)| crossing(precision, particles, &samples));
    Ok(Crossover { instruction_set: InstructionSet::best().name(), crossings: crossings.collect(), samples })
}

/// All methods on one case, repeat by repeat in turns, so that a disturbance affects them alike.
fn case_samples(
    case @ (precision, particles, packing_fraction): (&'static str, usize, f64),
    effort: &Effort,
) -> Result<Vec<Sample>, MeasurementError> {
    let mut running =
        METHODS.iter().map(|method| begin(method, case, effort)).collect::<Result<Vec<_>, _>>()?;
    for _ in 0..effort.repeats {
        running.iter_mut().try_for_each(TimedRun::repeat)?;
    }
    let samples = METHODS.into_iter().zip(running).map(|(method, running)| {
        let measured = running.measured();
        let contacts = measured.at_end.iter().map(|(_, contacts)| contacts).sum::<f64>();
        let discs = measured.particles as f64;
        let work = discs * measured.steps as f64;
        let phases = measured.phases.into_iter();
        Sample {
            method,
            precision,
            particles,
            packing_fraction,
            rate: work / measured.cpu_seconds,
            median: measured.median_rate,
            phases: phases.map(|(phase, seconds)| (phase, 1e9 * seconds / work)).collect(),
            contacts: contacts / discs,
        }
    });
    Ok(samples.collect())
}

fn begin(
    method: &str,
    (precision, particles, packing_fraction): (&str, usize, f64),
    effort: &Effort,
) -> Result<TimedRun, MeasurementError> {
    let scene = Overrides::new().set(&COUNT, particles).set(&PACKING_FRACTION, packing_fraction);
    let overrides = scene
        .set(&SEARCH, method)
        .set(&PRECISION, precision)
        .set(&ENGINE, EngineChoice::Fast)
        .set(&INTEGRATOR, IntegratorKind::VelocityVerlet);
    running(Document::load("bench", &overrides)?, 200, effort.steps)
}

/// Rate of the lattice over that of its best rival, at each packing fraction, falling.
fn ratios(precision: &str, particles: usize, samples: &[Sample]) -> Vec<(f64, f64)> {
    let of_group = || samples.iter().filter(|s| s.precision == precision && s.particles == particles);
    let lattice = of_group().filter(|sample| sample.method == METHODS[0]);
    let mut ratios: Vec<(f64, f64)> = lattice
        .filter_map(|own| {
            let rivals = of_group()
                .filter(|s| s.method != METHODS[0] && s.packing_fraction == own.packing_fraction)
                .map(|s| s.rate);
            Some((own.packing_fraction, own.rate / rivals.reduce(f64::max)?))
        })
        .collect();
    ratios.sort_by(|a, b| b.0.total_cmp(&a.0));
    ratios
}

fn crossing(precision: &'static str, particles: usize, samples: &[Sample]) -> Option<Crossing> {
    let ratios = ratios(precision, particles, samples);
    let [first, .., last] = ratios.as_slice() else { return None };
    // From the dense side on: the first change of the faster one, straight in the logarithms.
    let packing_fraction = ratios.windows(2).find_map(|pair| {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]].map(|(phi, ratio)| (phi.ln(), ratio.ln()));
        (y0 >= 0.0 && y1 < 0.0).then(|| (x0 + (x1 - x0) * y0 / (y0 - y1)).exp())
    });
    Some(Crossing { precision, particles, packing_fraction, ratios: [first.1, last.1] })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(method: &'static str, packing_fraction: f64, rate: f64) -> Sample {
        let (phases, contacts) = (BTreeMap::new(), 0.0);
        Sample {
            method,
            precision: "f64",
            particles: 100,
            packing_fraction,
            rate,
            median: rate,
            phases,
            contacts,
        }
    }

    #[test]
    fn the_crossing_is_where_the_logarithms_cross() {
        let lattice = [(0.8, 40.0), (0.2, 10.0)].map(|(phi, rate)| at("lattice", phi, rate));
        let lists = [(0.8, 20.0), (0.2, 20.0)].map(|(phi, rate)| at("neighbor-list", phi, rate));
        let sectors = [(0.8, 5.0), (0.2, 5.0)].map(|(phi, rate)| at("sectors", phi, rate));
        let samples: Vec<Sample> = lattice.into_iter().chain(lists).chain(sectors).collect();
        let crossing = crossing("f64", 100, &samples).unwrap();
        assert!((crossing.packing_fraction.unwrap() - 0.4).abs() < 1e-12);
        assert_eq!(crossing.ratios, [2.0, 0.5]);
    }
}
