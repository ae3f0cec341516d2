//! Does NOP·(n + D) hold on this host for the source's own program? And what did thirty years make of it?
//!
//! Eager runs of the printed text, part by part, over the length of the vectors; and whole steps of one scene by the printed text
//! and by ours, from the CRAY's way to the fast engine.

use super::rounds::Bound;
use super::samples::{PARTS, Samples};
use super::{efficiency_table, running};
use crate::statistics::{Spread, median};
use efficiency_table::{Choice, SOURCES_PARTS, counting_model};
use rand::RngExt;
use serde::Serialize;
use std::f64::consts::PI;
use stripmine_kernels::backend::tape::{Outlines, Place};
use stripmine_kernels::isa::Array;
use stripmine_kernels::noise::{Purpose, Stream};
use stripmine_kernels::sweep::lattice::ShapeError;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::keys::{CELL_EDGE, COHESIONLESS, ENGINE, EXECUTION, SEARCH, TEXT};
use stripmine_physics::method::lattice_md::options::{By, EngineChoice};
use stripmine_physics::method::lattice_md::{
    Arrays, Document, Model, Part, ProgramText, StepProgram, execute, programs,
};
use stripmine_physics::method::throughput::{MeasurementError, TimedRun};
use stripmine_physics::particles::{Kind, Particle, Particles, in_space};
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, Precision};

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// LMAX at occupancy [`OCCUPANCY`].
    pub cells: Vec<usize>,
    /// ρ, each with [`CELLS`] cells.
    pub occupancies: Vec<f64>,
    /// Samples of a length of the vectors.
    pub samples: usize,
    /// Discs of the scene whose steps are compared.
    pub particles: usize,
    /// Rounds over its variants.
    pub rounds: Bound,
}

/// ρ of the measurements over n.
pub const OCCUPANCY: f64 = 0.25;
/// LMAX of the measurements over ρ.
pub const CELLS: usize = 10_000;

/// A part of the eager step at a length of the vectors.
#[derive(Clone, Debug, Serialize)]
pub struct Timed {
    /// The part.
    pub part: &'static str,
    /// ρ.
    pub occupancy: f64,
    /// n: NP or the cells that are swept.
    pub n: usize,
    /// Operations.
    pub nop: u64,
    /// Nanoseconds of the part: the median sample.
    pub ns: f64,
    /// The quartiles.
    pub quartiles: [f64; 2],
    /// Medians of parts of the samples, each spread over the whole measurement.
    pub of_parts: [f64; PARTS],
}

/// NOP·(n + D) of a part on this host.
#[derive(Clone, Debug, Serialize)]
pub struct Fitted {
    /// The part.
    pub part: &'static str,
    /// Operations.
    pub nop: u64,
    /// Nanoseconds of a clock period: what an element more costs an operation. Lowest, middle and highest over parts of the
    /// samples, and over fits that leave out one length.
    pub period_ns: [f64; 3],
    /// D, likewise.
    pub depth: [f64; 3],
    /// The longest vectors at which the line is within [`HOLDS`].
    pub holds_to: usize,
    /// Bytes that a pass may touch again there: registers and arrays of all elements.
    pub bytes: f64,
    /// The largest difference from the line up to there, as a share.
    pub worst: f64,
    /// Measured time over that of the line at the longest vectors.
    pub beyond: f64,
}

/// Within which share of the line it holds.
pub const HOLDS: f64 = 0.1;

/// One way to run the scene.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Way {
    /// Its name.
    pub name: &'static str,
    /// What it changes against the one before.
    pub change: &'static str,
    /// What it sets in the bench scene.
    #[serde(skip)]
    overrides: fn(Overrides) -> Overrides,
}

/// The programs of a text, executed so, on cells of the source's size.
fn on_narrow_cells(scene: Overrides, text: ProgramText, execution: &str) -> Overrides {
    scene.set(&TEXT, text).set(&CELL_EDGE, 0.5).set(&EXECUTION, execution)
}

/// From 1993 to today, each one change further.
pub const WAYS: [Way; 6] = [
    Way {
        name: "printed, eager",
        change: "the CRAY's way: every instruction a pass over the whole lattice",
        overrides: |scene| on_narrow_cells(scene, ProgramText::Printed, "eager"),
    },
    Way {
        name: "printed, strips of 256",
        change: "strip-mining: passes stay in the first cache",
        overrides: |scene| on_narrow_cells(scene, ProgramText::Printed, "strip:256"),
    },
    Way {
        name: "printed, chained",
        change: "registers: every operation of an element before the next element",
        overrides: |scene| on_narrow_cells(scene, ProgramText::Printed, "chained"),
    },
    Way {
        name: "ours, chained",
        change: "our text: a select for the products, inverse masses, no Test; scaled derivatives; positions relative to the cell",
        overrides: |scene| on_narrow_cells(scene, ProgramText::Ours, "chained"),
    },
    Way {
        name: "ours, chained, largest cells",
        change: "the largest cells that the geometry allows",
        overrides: |scene| scene.set(&TEXT, ProgramText::Ours).set(&EXECUTION, "chained"),
    },
    Way {
        name: "fast lattice",
        change: "half the pairs, contacts first: the law for contacts only, each once",
        overrides: |scene| scene.set(&ENGINE, EngineChoice::Fast).set(&SEARCH, By::Lattice),
    },
];

/// Steps of the scene by one way.
#[derive(Clone, Debug, Serialize)]
pub struct Price {
    /// The way.
    pub way: Way,
    /// Nanoseconds of processor time a disc and step: median over the rounds.
    pub ns: f64,
    /// The lowest and the highest.
    pub ends: [f64; 2],
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct PrintedCost {
    /// Instructions.
    pub instruction_set: &'static str,
    /// Every part over n and ρ.
    pub timed: Vec<Timed>,
    /// The fit of each part over n.
    pub fitted: Vec<Fitted>,
    /// Our text's eager step over that of the printed one at [`CELLS`]: parts of the source's table.
    pub ours_eager_ns: f64,
    /// The same of the printed text.
    pub printed_eager_ns: f64,
    /// Discs of the scene.
    pub particles: usize,
    /// Its packing fraction.
    pub packing_fraction: f64,
    /// Rounds over the ways.
    pub rounds: usize,
    /// The ways, in order.
    pub prices: Vec<Price>,
}

/// Measures, on one thread. `progress` gets the share that is done.
///
/// # Errors
/// [`MeasurementError`] if the scene breaks.
pub fn printed_cost(effort: &Effort, progress: impl Fn(f64) + Sync) -> Result<PrintedCost, MeasurementError> {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
    alone.install(|| measured(effort, &progress))
}

fn measured(effort: &Effort, progress: &dyn Fn(f64)) -> Result<PrintedCost, MeasurementError> {
    let mut cells = effort.cells.clone();
    cells.sort_unstable();
    let over_n = cells.iter().map(|&cells| (cells, OCCUPANCY));
    let over_density = effort.occupancies.iter().map(|&occupancy| (CELLS, occupancy));
    let places: Vec<(usize, f64)> = over_n.chain(over_density).collect();
    let all: f64 = places.iter().map(|&(cells, _)| weight(cells)).sum();
    let (mut timed, mut done) = (vec![], 0.0);
    for &(cells, occupancy) in &places {
        timed.extend(eager(cells, occupancy, Choice::default().printed(), effort.samples)?);
        done += weight(cells);
        progress(0.6 * done / all);
    }
    let step = |choice| {
        let timed = eager(CELLS, OCCUPANCY, choice, effort.samples)?;
        Ok::<f64, MeasurementError>(timed.iter().map(|timed| timed.ns).sum())
    };
    let (ours_eager_ns, printed_eager_ns) = (step(Choice::default())?, step(Choice::default().printed())?);
    let fitted = SOURCES_PARTS.iter().map(|part| fit(part.name(), &timed)).collect::<Result<_, _>>()?;
    let packing_fraction = 0.2 * PI;
    let (prices, rounds) = prices(effort, packing_fraction, |share| progress(0.6 + 0.4 * share))?;
    Ok(PrintedCost {
        instruction_set: InstructionSet::best().name(),
        timed,
        fitted,
        ours_eager_ns,
        printed_eager_ns,
        particles: effort.particles,
        packing_fraction,
        rounds,
        prices,
    })
}

/// How long a lattice takes beside others: a short one is repeated.
fn weight(cells: usize) -> f64 {
    cells as f64 + 1e5
}

/// Discs on a share of the cells at random, one a cell, almost at rest.
fn scattered(model: &Model, occupancy: f64) -> Particles {
    let mut random = Stream::new(1, Purpose::Placement, 0);
    let mut discs = vec![];
    for row in 0..model.shape.rows() {
        for column in 0..model.shape.columns() {
            if random.random::<f64>() >= occupancy {
                continue;
            }
            let place = [column, row].map(|cell| cell as f64 + 0.02 + 0.96 * random.random::<f64>());
            let at = [0, 1].map(|axis| model.frame.origin[axis] + place[axis] * model.frame.edge[axis]);
            let velocity = [0, 1].map(|_| random.random::<f64>() - 0.5);
            discs.push(Particle {
                id: discs.len() as u32 + 1,
                kind: Kind::Grain,
                position: in_space(at),
                velocity: in_space(velocity),
                angle: 0.0,
                omega: random.random::<f64>() - 0.5,
                radius: 0.5,
                mass: 1.0,
            });
        }
    }
    Particles::new(discs)
}

/// Every part of an eager step on a lattice of about a number of cells. Nothing in it depends on the data, so the discs need not move: the
/// step is so short that none leaves its cell.
fn eager(
    cells: usize,
    occupancy: f64,
    choice: Choice,
    samples: usize,
) -> Result<Vec<Timed>, MeasurementError> {
    let model = Model { dt: 1e-9, ..counting_model(cells, choice)? };
    let particles = scattered(&model, occupancy);
    let mut arrays = Arrays::<f64, f64>::new(&model, &particles);
    drop(particles);
    let step = programs(&model, Precision::F64);
    let parts: Vec<Part> =
        Part::ALL.iter().copied().filter(|part| step.iter().any(|step| step.part == *part)).collect();
    let mut all = vec![Samples::default(); parts.len()];
    let set = InstructionSet::best();
    // About 20 ms a sample on short lattices; of the longest, far beyond where the line holds, one.
    let times = (3_000_000 / (cells * 40)).clamp(1, 200);
    let samples = (4_000_000 / cells).clamp(1, samples);
    for _ in 0..samples {
        Samples::take_in_turns(&mut all, times, |at| {
            let (memory, lengths) = arrays.memory();
            execute(&step, &parts[at..=at], &memory, lengths, Execution::Eager, set)
        })?;
    }
    let timed = parts.iter().zip(&all).filter(|(part, _)| SOURCES_PARTS.contains(part));
    let timed = timed.map(|(part, samples)| {
        let of_part = |program: &&StepProgram| program.part == *part;
        let nop = |program: &StepProgram| -> u64 {
            program.program.tally().iter().map(|(_, counts)| counts.total()).sum()
        };
        let length = step.iter().rfind(of_part).map(|program| program.length);
        Timed {
            part: part.name(),
            occupancy,
            n: length.map_or(0, |length| arrays.lengths().range(length).len()),
            nop: step.iter().filter(of_part).map(nop).sum(),
            ns: samples.middle(),
            quartiles: samples.quartiles(),
            of_parts: std::array::from_fn(|part| samples.of_part(part)),
        }
    });
    Ok(timed.collect())
}

/// The straight line through the shortest vectors, up to where it holds.
fn fit(part: &'static str, timed: &[Timed]) -> Result<Fitted, ShapeError> {
    let mut points: Vec<&Timed> =
        timed.iter().filter(|timed| timed.part == part && timed.occupancy == OCCUPANCY).collect();
    points.sort_by_key(|timed| timed.n);
    let nop = points.first().map_or(1, |timed| timed.nop);
    let off = |line: [f64; 2], timed: &Timed| {
        (timed.ns / (line[0] * (timed.n as f64 + line[1]) * nop as f64) - 1.0).abs()
    };
    // Through the shortest, but for the one left out.
    let line = |count: usize, left_out: Option<usize>, ns: &dyn Fn(&Timed) -> f64| {
        let kept = points[..count].iter().enumerate().filter(|(at, _)| Some(*at) != left_out);
        let points: Vec<(f64, f64)> =
            kept.map(|(_, timed)| (timed.n as f64, ns(timed) / nop as f64)).collect();
        straight(&points)
    };
    let worst = |count: usize| {
        let line = line(count, None, &|timed| timed.ns);
        points[..count].iter().map(|timed| off(line, timed)).fold(0.0, f64::max)
    };
    let held = (3..=points.len()).rev().find(|&count| worst(count) <= HOLDS).unwrap_or(points.len().min(3));
    let middle = line(held, None, &|timed| timed.ns);
    let of_parts = (0..PARTS).map(|part| line(held, None, &|timed| timed.of_parts[part]));
    // Two points have a line that says nothing of the others.
    let without = (0..held).filter(|_| held > 3).map(|at| line(held, Some(at), &|timed| timed.ns));
    let others: Vec<[f64; 2]> = of_parts.chain(without).collect();
    let ends = |at: usize| {
        let spread = Spread::of(&others.iter().map(|line| line[at]).collect::<Vec<f64>>());
        [spread.lowest.min(middle[at]), middle[at], spread.highest.max(middle[at])]
    };
    let holds_to = points.get(held.saturating_sub(1)).map_or(0, |timed| timed.n);
    Ok(Fitted {
        part,
        nop,
        period_ns: ends(0),
        depth: ends(1),
        holds_to,
        bytes: holds_to as f64 * bytes_an_element(part)?,
        worst: worst(held),
        beyond: points
            .last()
            .map_or(1.0, |timed| timed.ns / (middle[0] * (timed.n as f64 + middle[1]) * nop as f64)),
    })
}

/// Slope τ and D of y = τ (x + D) by least squares of the relative differences.
fn straight(points: &[(f64, f64)]) -> [f64; 2] {
    let [mut w, mut wx, mut wxx, mut wy, mut wxy] = [0.0; 5];
    for &(x, y) in points {
        let weight = 1.0 / (y * y);
        w += weight;
        wx += weight * x;
        wxx += weight * x * x;
        wy += weight * y;
        wxy += weight * x * y;
    }
    let slope = (w * wxy - wx * wy) / (w * wxx - wx * wx);
    let at_zero = (wy - slope * wx) / w;
    [slope, at_zero / slope]
}

/// Bytes of registers and arrays that the passes of a part hold for an element.
fn bytes_an_element(part: &str) -> Result<f64, ShapeError> {
    let model = counting_model(400, Choice::default().printed())?;
    let of_part = programs(&model, Precision::F64).into_iter().filter(|step| step.part.name() == part);
    let bytes = of_part.map(|step| {
        let Outlines { registers, passes, .. } = step.program.outlines();
        let mut arrays: Vec<Array> = vec![];
        for place in passes.iter().flat_map(|pass| pass.reads.iter().chain(&pass.writes)) {
            if let Place::Memory(from) | Place::Indexed(from) = place
                && !arrays.contains(&from.array)
            {
                arrays.push(from.array);
            }
        }
        8.0 * (registers[0] + arrays.len()) as f64 + 4.0 * registers[2] as f64
    });
    Ok(bytes.fold(0.0, f64::max))
}

/// The ways of the scene, in turns.
fn prices(
    effort: &Effort,
    packing_fraction: f64,
    progress: impl Fn(f64),
) -> Result<(Vec<Price>, usize), MeasurementError> {
    let steps = (200_000 / effort.particles.max(1)).clamp(4, 200) as u64;
    let mut ways: Vec<(TimedRun, Vec<f64>)> = vec![];
    let scene = Overrides::new().set(&COUNT, effort.particles).set(&PACKING_FRACTION, packing_fraction);
    let unclamped = scene.set(&COHESIONLESS, false);
    for way in &WAYS {
        let document = Document::load("bench", &(way.overrides)(unclamped.clone()))?;
        ways.push((running(document, 200, steps)?, vec![]));
    }
    let mut rounds = effort.rounds.begin();
    let mut made = 0;
    while rounds.next().is_some() {
        for (at, (running, ns)) in ways.iter_mut().enumerate() {
            running.repeat()?;
            ns.push(1e9 / running.last_rate());
            progress(rounds.share((at + 1) as f64 / WAYS.len() as f64));
        }
        made += 1;
    }
    let prices = WAYS.iter().zip(&ways).map(|(way, (_, ns))| {
        let Spread { lowest, highest, .. } = Spread::of(ns);
        Price { way: *way, ns: median(ns.iter().copied()), ends: [lowest, highest] }
    });
    Ok((prices.collect(), made))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_gives_its_clock_period_and_depth() {
        let points: Vec<(f64, f64)> = [10.0, 100.0, 1000.0, 1e5].map(|n| (n, 0.3 * (n + 20.0))).to_vec();
        let [period, depth] = straight(&points);
        assert!((period - 0.3).abs() < 1e-12 && (depth - 20.0).abs() < 1e-9, "{period} {depth}");
    }

    /// A line that breaks at a cache is fitted below it only, and says by how much it is passed.
    #[test]
    fn the_fit_ends_where_the_line_breaks() {
        let timed: Vec<Timed> = [100, 1000, 10_000, 100_000, 1_000_000]
            .map(|n| {
                let slow = if n > 50_000 { 3.0 } else { 1.0 };
                let ns = 100.0 * 0.2 * (n as f64 + 30.0) * slow;
                let of_parts = [ns * 0.99, ns, ns, ns * 1.01];
                Timed { part: "forces", occupancy: OCCUPANCY, n, nop: 100, ns, quartiles: [ns; 2], of_parts }
            })
            .to_vec();
        let fitted = fit("forces", &timed).unwrap();
        assert_eq!(fitted.holds_to, 10_000);
        assert!((fitted.period_ns[1] - 0.2).abs() < 1e-9 && (fitted.depth[1] - 30.0).abs() < 1e-6);
        assert!(fitted.period_ns[0] < 0.2 && fitted.period_ns[2] > 0.2);
        assert!((fitted.beyond - 3.0).abs() < 1e-6 && fitted.worst < 1e-9);
    }

    #[test]
    fn every_part_of_the_sources_table_is_timed() {
        let timed = eager(400, 0.5, Choice::default().printed(), 1).unwrap();
        let parts: Vec<&str> = timed.iter().map(|timed| timed.part).collect();
        assert_eq!(parts, SOURCES_PARTS.map(Part::name));
        assert!(timed.iter().all(|timed| timed.n > 100 && timed.ns > 0.0 && timed.nop > 10), "{timed:?}");
        assert!(bytes_an_element("forces").unwrap() > 100.0);
    }
}
