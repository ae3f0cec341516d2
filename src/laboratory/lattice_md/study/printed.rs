//! BP93's printed program on this host: NOP·(n + D) compared with wall time by part, and whole steps from the CRAY's execution to today's engine.

use super::density_cost::CEILING;
use super::efficiency_table::{SOURCES_PARTS, TableFeatures, counting_model};
use super::samples::Samples;
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::laboratory::rates::{
    self, CaseReading, MeasuredCase, ProcessSpread, RateCase, StudyWork, measure_rates, parse_parameters,
};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use rand::RngExt;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::keys::{CELL_EDGE, COHESIONLESS, ENGINE, EXECUTION, SEARCH, TEXT};
use stripmine_physics::method::lattice_md::options::{EngineChoice, SearchKind};
use stripmine_physics::method::lattice_md::{
    GranularModel, Part, ProgramArrays, ProgramVersion, StepProgram, execute, programs,
};
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::particles::{Particle, ParticleKind, Particles, in_space};
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, Precision};

/// ρ of the measurements over n.
const OCCUPANCY: f64 = 0.25;
/// LMAX of the measurements over ρ.
const CELLS: usize = 10_000;
/// LMAX of the scalar execution: within the range of the line.
const SCALAR: usize = 500;
/// Share of the line within which it holds.
const HOLDS: f64 = 0.1;
/// ρ of the scene for the comparison of whole steps.
const SCENE: f64 = 0.2;

/// LMAX of the measurements over n: short vectors, up to the first-level cache, for the line; long vectors to find where it fails.
const SHORT: [usize; 9] = [25, 49, 100, 170, 290, 500, 1000, CELLS, 100_000];
const LONG: [usize; 5] = [2000, 5000, 30_000, 300_000, 1_000_000];

/// Configurations from 1993 to today, each with one more change: name, program, execution, and true for cells of the paper's size.
const CONFIGURATIONS: [(&str, ProgramVersion, &str, bool); 6] = [
    ("printed, eager", ProgramVersion::Printed, "eager", true),
    ("printed, strips of 256", ProgramVersion::Printed, "strip:256", true),
    ("printed, chained", ProgramVersion::Printed, "chained", true),
    ("ours, chained", ProgramVersion::Ours, "chained", true),
    ("ours, chained, largest cells", ProgramVersion::Ours, "chained", false),
    ("fast lattice", ProgramVersion::Ours, FAST, false),
];

/// Name of the fast engine as an execution.
const FAST: &str = "fast";

/// Measured work: the parts of an eager step.
pub(crate) const EAGER: StudyWork = StudyWork {
    name: "eager-parts",
    measure: |parameters| {
        let (cells, occupancy, kind, samples): (usize, f64, StepKind, usize) = parse_parameters(parameters)?;
        Ok(time_eager_step(cells, occupancy, kind, samples)?)
    },
};

/// Program of a measured step, and its execution.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
enum StepKind {
    Printed,
    /// The printed program, one element of an operation after the other.
    PrintedScalar,
    Ours,
}

/// Times of a part of the eager step on a lattice.
struct TimedPart {
    part: &'static str,
    cells: usize,
    occupancy: f64,
    /// NP, or the number of swept cells.
    n: usize,
    nop: u64,
    /// Nanoseconds of each process.
    each: Vec<f64>,
}

impl TimedPart {
    fn of(part: &'static str, cells: usize, occupancy: f64, measured: &MeasuredCase) -> TimedPart {
        let count = |kind: &str| measured.count(&format!("{kind} of {part}"));
        let each = measured.readings.iter().map(|it| 1e9 * it.parts.get(part).copied().unwrap_or(f64::NAN));
        let each = each.collect();
        TimedPart { part, cells, occupancy, n: count("n") as usize, nop: count("NOP") as u64, each }
    }

    fn ns(&self) -> ProcessSpread {
        ProcessSpread::of(self.each.iter().copied())
    }
}

/// Fit of NOP·(n + D) to the times of a part on this host.
struct FittedPart {
    part: &'static str,
    nop: u64,
    /// Nanoseconds of a clock period, the cost of one more element per operation. The range is over processes and over fits that leave out
    /// one length.
    period: ProcessSpread,
    /// Pipeline depth D, with the same range.
    depth: ProcessSpread,
    /// Longest vectors at which the line holds within [`HOLDS`].
    holds_to: usize,
    /// Largest relative difference from the line up to this length.
    worst: f64,
    /// Measured time over the line at the longest vectors.
    beyond: f64,
}

/// Measures the parts of the eager step and every configuration.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (cells, occupancies, samples, discs): (Vec<usize>, &[f64], u64, usize) = match size {
        StudySize::Quick => (SHORT.to_vec(), &[1.0], 3, 1000),
        StudySize::Full | StudySize::All => ([&SHORT[..], &LONG].concat(), &[0.05, 0.1, 0.5, 1.0], 8, 10_000),
    };
    let over_n = cells.into_iter().map(|cells| (cells, OCCUPANCY, StepKind::Printed));
    let over_density = occupancies.iter().map(|&occupancy| (CELLS, occupancy, StepKind::Printed));
    let others = [(SCALAR, OCCUPANCY, StepKind::PrintedScalar), (CELLS, OCCUPANCY, StepKind::Ours)];
    let places: Vec<_> = over_n.chain(over_density).chain(others).collect();
    let parts = places.iter().map(|&(cells, occupancy, kind)| {
        let parameters = serde_json::json!([cells, occupancy, kind, samples]);
        let occupancy = TableCell::Number(occupancy, 2);
        RateCase::own(&EAGER, parameters).label("cells", cells as u64).label("occupancy", occupancy)
    });
    let scene =
        Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, SCENE * PI).set(&COHESIONLESS, false);
    let configurations = CONFIGURATIONS.map(|(name, text, execution, is_narrow)| {
        let is_fast = execution == FAST;
        let set = match is_fast {
            true => scene.clone().set(&ENGINE, EngineChoice::Fast).set(&SEARCH, SearchKind::Lattice),
            false => scene.clone().set(&TEXT, text).set(&EXECUTION, execution),
        };
        let set = if is_narrow { set.set(&CELL_EDGE, 0.5) } else { set };
        // Only the work of the fast engine depends on the discs.
        let warm_up = if is_fast { 200 } else { 2 };
        let steps = (200_000 / discs).clamp(4, 200) as u64;
        RateCase::steps("bench", &set, warm_up, steps).for_seconds(0.1).label("way", name)
    });
    let measured = measure_rates(lab, &parts.chain(configurations).collect::<Vec<_>>())?;
    let (eager, configurations) = measured.split_at(places.len());
    let times_of = |wanted: StepKind| -> Vec<TimedPart> {
        let all = places.iter().zip(eager).filter(|((.., kind), _)| *kind == wanted);
        all.flat_map(|(&(cells, occupancy, _), it)| {
            SOURCES_PARTS.map(|part| TimedPart::of(part.name(), cells, occupancy, it))
        })
        .collect()
    };
    let (timed, scalar) = (times_of(StepKind::Printed), times_of(StepKind::PrintedScalar));
    let fitted = SOURCES_PARTS.map(|part| fit_clock_line(part.name(), &timed));
    let frames = [
        vector_frame(&timed, &fitted),
        fits(&fitted, &scalar),
        densities(&timed),
        configuration_costs(configurations),
    ];
    let at = places.iter().position(|place| *place == (CELLS, OCCUPANCY, StepKind::Printed));
    let summary = FrameBuilder::of(at.map(|at| [&eager[at], &eager[eager.len() - 1]]))
        .cell("printed text, eager (µs)", |[printed, _]| printed.cost().cell(1e6, 0))
        .cell("our text, eager (µs)", |[_, ours]| ours.cost().cell(1e6, 0))
        .count("discs", |_| discs)
        .text("instruction set", |_| InstructionSet::best().name())
        .frame("summary", "The eager step of both texts, and the scene of the development");
    let made = FinishedItem::of(frames.into_iter().chain([summary])).with_seeds([1]);
    Ok(FinishedItem { processes: Some(rates::PROCESSES), ..made })
}

/// Discs almost at rest, in a random share of the cells, one per cell.
fn scattered_discs(model: &GranularModel, occupancy: f64) -> Particles {
    let mut random = Stream::new(1, RandomPurpose::Placement, 0);
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
                kind: ParticleKind::Grain,
                species: 0,
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

/// Median times of every part of an eager step on a lattice of about `cells` cells. The time does not depend on the data, so discs need not
/// move; the step is so short that none leaves its cell.
fn time_eager_step(
    cells: usize,
    occupancy: f64,
    kind: StepKind,
    samples: usize,
) -> Result<CaseReading, MeasurementError> {
    let ours = TableFeatures::default();
    let choice = if kind == StepKind::Ours { ours } else { ours.printed() };
    let model = GranularModel { dt: 1e-9, ..counting_model(cells, choice)? };
    let particles = scattered_discs(&model, occupancy);
    let mut arrays = ProgramArrays::<f64, f64>::new(&model, &particles);
    drop(particles);
    let step = programs(&model, Precision::F64);
    let is_there = |part: &Part| step.iter().any(|step| step.part == *part);
    let parts: Vec<Part> = Part::ALL.iter().copied().filter(is_there).collect();
    let mut all = vec![Samples::default(); parts.len()];
    let set = match kind {
        StepKind::PrintedScalar => InstructionSet::Scalar,
        StepKind::Printed | StepKind::Ours => InstructionSet::best(),
    };
    // About 20 ms per sample on short lattices; one step on the longest, far beyond the validity of the line.
    let times = (3_000_000 / (cells * 40)).clamp(1, 200);
    for _ in 0..(4_000_000 / cells / rates::PROCESSES).clamp(1, samples) {
        Samples::take_in_turns(&mut all, times, |at| {
            let (memory, lengths) = arrays.memory();
            execute(&step, &parts[at..=at], &memory, lengths, Execution::Eager, set)
        })?;
    }
    let mut reading = CaseReading { work: 1.0, ..CaseReading::default() };
    for (part, samples) in parts.iter().zip(&all).filter(|(part, _)| SOURCES_PARTS.contains(part)) {
        let own = || step.iter().filter(|program| program.part == *part);
        let nop = |program: &StepProgram| -> u64 {
            program.program.tally().iter().map(|(_, counts)| counts.total()).sum()
        };
        let n = own().next_back().map_or(0, |program| arrays.lengths().range(program.length).len());
        let counts = [("n", n as f64), ("NOP", own().map(nop).sum::<u64>() as f64)];
        let counts = counts.map(|(kind, count)| (format!("{kind} of {}", part.name()), count));
        reading.counts.extend(counts);
        reading.parts.insert(part.name().to_owned(), 1e-9 * samples.median().unwrap_or(f64::NAN));
    }
    reading.seconds = reading.parts.values().sum();
    Ok(reading)
}

/// Fits a straight line to the shortest vectors, up to the length at which it fails.
fn fit_clock_line(part: &'static str, timed: &[TimedPart]) -> FittedPart {
    let mut points: Vec<&TimedPart> =
        timed.iter().filter(|timed| timed.part == part && timed.occupancy == OCCUPANCY).collect();
    points.sort_by_key(|timed| timed.n);
    let nop = points.first().map_or(1, |timed| timed.nop);
    let over = |line: [f64; 2], timed: &TimedPart| {
        timed.ns().median / (line[0] * (timed.n as f64 + line[1]) * nop as f64)
    };
    // Through the shortest vectors, except one left out.
    let line = |count: usize, left_out: Option<usize>, ns: &dyn Fn(&TimedPart) -> f64| {
        let kept = points[..count].iter().enumerate().filter(|(at, _)| Some(*at) != left_out);
        straight_line(&kept.map(|(_, timed)| (timed.n as f64, ns(timed) / nop as f64)).collect::<Vec<_>>())
    };
    let median = |timed: &TimedPart| timed.ns().median;
    let worst = |count: usize| {
        let line = line(count, None, &median);
        points[..count].iter().map(|timed| (over(line, timed) - 1.0).abs()).fold(0.0, f64::max)
    };
    let held = (3..=points.len()).rev().find(|&count| worst(count) <= HOLDS).unwrap_or(points.len().min(3));
    let middle = line(held, None, &median);
    let processes = points.first().map_or(0, |timed| timed.each.len());
    let of_processes = (0..processes).map(|at| line(held, None, &|timed: &TimedPart| timed.each[at]));
    // A line through two points is not a test of the others.
    let without = (0..held).filter(|_| held > 3).map(|at| line(held, Some(at), &median));
    let others: Vec<[f64; 2]> = of_processes.chain(without).chain([middle]).collect();
    let spread = |at: usize| ProcessSpread {
        median: middle[at],
        ..ProcessSpread::of(others.iter().map(|line| line[at]))
    };
    let holds_to = points.get(held.saturating_sub(1)).map_or(0, |timed| timed.n);
    FittedPart {
        part,
        nop,
        period: spread(0),
        depth: spread(1),
        holds_to,
        worst: worst(held),
        beyond: points.last().map_or(1.0, |timed| over(middle, timed)),
    }
}

/// Slope τ and D of y = τ (x + D), from least squares of the relative differences.
fn straight_line(points: &[(f64, f64)]) -> [f64; 2] {
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

/// Time per element and operation, with the line as far as it holds; no line for a part without a valid fit.
fn vector_frame(timed: &[TimedPart], fitted: &[FittedPart]) -> ResultFrame {
    let of_part = |part: &str| fitted.iter().find(|fitted| fitted.part == part && fitted.worst <= HOLDS);
    let line = |it: &TimedPart| {
        let fit = of_part(it.part).filter(|fit| it.n <= fit.holds_to)?;
        Some(fit.period.median * (it.n as f64 + fit.depth.median) / it.n as f64)
    };
    FrameBuilder::of(timed.iter().filter(|it| it.occupancy == OCCUPANCY))
        .text("part", |it| it.part)
        .count("n", |it| it.n)
        .cell("an element and operation (ns)", |it| it.ns().cell(1.0 / (it.nop as f64 * it.n as f64), 4))
        .number("line (ns)", 4, |it| line(it))
        .count("processes", |it| it.each.len())
        .frame("vectors", "Time an element and operation of the printed text, eager")
}

/// `scalar` has a part for each fit.
fn fits(fitted: &[FittedPart], scalar: &[TimedPart]) -> ResultFrame {
    let per_element = |it: &TimedPart| it.ns().median / (it.nop * it.n as u64) as f64;
    FrameBuilder::of(fitted.iter().zip(scalar))
        .text("part", |(fitted, _)| fitted.part)
        .count("NOP", |(fitted, _)| fitted.nop)
        .cell("clock period (ns)", |(fitted, _)| fitted.period.cell(1.0, 3))
        .cell("D", |(fitted, _)| fitted.depth.cell(1.0, 0))
        .count("holds to n", |(fitted, _)| fitted.holds_to)
        .number("largest difference (%)", 1, |(fitted, _)| 100.0 * fitted.worst)
        .number("times the line at the longest n", 2, |(fitted, _)| fitted.beyond)
        .number("scalar, an element and operation (ns)", 3, |(_, scalar)| per_element(scalar))
        .number("scalar over D clock periods", 2, |(fitted, scalar)| {
            per_element(scalar) / (fitted.period.median * fitted.depth.median)
        })
        .frame("fits", "NOP·(n + D) on this host, part by part")
}

fn densities(timed: &[TimedPart]) -> ResultFrame {
    let mut of_places: Vec<&[TimedPart]> = timed.chunks(SOURCES_PARTS.len()).collect();
    of_places.retain(|parts| parts[0].cells == CELLS);
    of_places.sort_by(|a, b| a[0].occupancy.total_cmp(&b[0].occupancy));
    FrameBuilder::of(of_places)
        .number("occupancy ρ", 2, |parts| parts[0].occupancy)
        .cells(SOURCES_PARTS.map(|part| format!("{} (µs)", part.name())), |parts| {
            parts.iter().map(|it| it.ns().cell(1e-3, 2)).collect::<Vec<_>>()
        })
        .text("reachable", |parts| if parts[0].occupancy > CEILING { "no packing of discs" } else { "" })
        .frame("densities", format!("The eager step over the occupancy, on {CELLS} cells"))
}

fn configuration_costs(configurations: &[MeasuredCase]) -> ResultFrame {
    let first = &configurations[0];
    let before = std::iter::once(first).chain(configurations);
    FrameBuilder::of(CONFIGURATIONS.iter().zip(configurations).zip(before).enumerate())
        .count("step", |(at, _)| at + 1)
        .text("way", |(_, (((name, ..), _), _))| *name)
        .cell("ns a disc and step", |(_, ((_, own), _))| own.cost().cell(1e9, 1))
        .number("times faster than the one before", 2, |(_, ((_, own), before))| {
            own.rate_ratio(before).median
        })
        .number("times faster than the first", 1, |(_, ((_, own), _))| own.rate_ratio(first).median)
        .frame("prices", "What each step of the development made of one scene")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_gives_its_clock_period_and_depth() {
        let points: Vec<(f64, f64)> = [10.0, 100.0, 1000.0, 1e5].map(|n| (n, 0.3 * (n + 20.0))).to_vec();
        let [period, depth] = straight_line(&points);
        assert!((period - 0.3).abs() < 1e-12 && (depth - 20.0).abs() < 1e-9, "{period} {depth}");
    }

    fn timed(ns: impl Fn(usize) -> f64) -> Vec<TimedPart> {
        let one = |n: usize| {
            let each = [0.99, 1.0, 1.01].map(|share| share * ns(n)).to_vec();
            TimedPart { part: "forces", cells: n, occupancy: OCCUPANCY, n, nop: 100, each }
        };
        [100, 1000, 10_000, 100_000, 1_000_000].map(one).into()
    }

    /// A line that fails beyond a cache is fitted below it only, and the excess beyond it is reported.
    #[test]
    fn the_fit_ends_where_the_line_breaks() {
        let slow = |n| if n > 50_000 { 3.0 } else { 1.0 };
        let timed = timed(|n| 100.0 * 0.2 * (n as f64 + 30.0) * slow(n));
        let fitted = fit_clock_line("forces", &timed);
        assert_eq!(fitted.holds_to, 10_000);
        assert!((fitted.period.median - 0.2).abs() < 1e-9 && (fitted.depth.median - 30.0).abs() < 1e-6);
        assert!(fitted.period.range[0] < 0.199 && fitted.period.range[1] > 0.201);
        assert!((fitted.beyond - 3.0).abs() < 1e-6 && fitted.worst < 1e-9);
    }

    /// No line is drawn for a part without a valid fit.
    #[test]
    fn a_line_that_fails_is_not_drawn() {
        let drawn = |timed: &[TimedPart]| {
            let frame = vector_frame(timed, &[fit_clock_line("forces", timed)]);
            let at = frame.position("line").unwrap();
            frame.rows.iter().filter(|row| matches!(row[at], crate::frame::FrameValue::Number(_))).count()
        };
        assert_eq!(drawn(&timed(|n| 100.0 * (n as f64 + 30.0))), 5);
        assert_eq!(drawn(&timed(|n| (n as f64).powi(3))), 0);
    }

    #[test]
    fn every_part_of_the_table_is_timed() {
        let reading = time_eager_step(400, 0.5, StepKind::Printed, 1).unwrap();
        for part in SOURCES_PARTS.map(Part::name) {
            let count = |kind: &str| reading.counts[&format!("{kind} of {part}")];
            assert!(count("n") > 100.0 && count("NOP") > 10.0 && reading.parts[part] > 0.0, "{reading:?}");
        }
    }
}
