//! O(N) of the vector method: time and counted operations of a step over the number of cells, and BP93's figure 3 as it is drawn, measured.

use super::searches::{ALL_PAIRS, CHAINED, DENSE, SearchCase};
use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::rates::{MeasuredCase, ProcessSpread, measure_rates};
use crate::laboratory::running::prepare_preset;
use crate::provenance::MachineDescription;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::statistics::{MeanWithBar, slope, slope_error};
use std::f64::consts::PI;

/// Methods over the number of cells: the programs of the lattice, and the fast engine by lattice and by lists.
const METHODS: [&str; 3] = [CHAINED, "lattice", "neighbor-list"];
/// Methods on given lattices: the programs, lists of all pairs as printed, and lists from cells.
const ON_LATTICES: [&str; 3] = [CHAINED, ALL_PAIRS, "neighbor-list"];
/// Lattices of the figure, and occupancies of their cells.
const LATTICES: [usize; 2] = [1000, 10_000];
const OCCUPANCIES: [f64; 6] = [0.02, 0.05, 0.1, 0.15, 0.2, DENSE];

/// A method with a number of cells and discs, and the time of a step.
struct StepTime {
    case: SearchCase,
    cells: usize,
    /// Counted vector operations times their lengths; none where there are no programs.
    operations: Option<f64>,
    seconds: ProcessSpread,
    /// Memory of a run (bytes).
    memory: f64,
}

/// Measures every method.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (halves, seconds) = match size {
        StudySize::Quick => (6..=8, 0.02),
        StudySize::Full => (6..=12, 0.06),
        StudySize::All => (6..=14, 0.06),
    };
    let counts: Vec<usize> = halves.map(|half| 10f64.powf(0.5 * f64::from(half)).round() as usize).collect();
    let of = |search, cells: usize, occupancy: f64| {
        let discs = (occupancy * cells as f64).round() as usize;
        (SearchCase::of(search, discs, PI * discs as f64 / cells as f64), cells)
    };
    let given =
        METHODS.into_iter().flat_map(|method| counts.iter().map(move |&cells| of(method, cells, DENSE)));
    let figure = ON_LATTICES.into_iter().flat_map(|method| {
        LATTICES.into_iter().flat_map(move |cells| OCCUPANCIES.map(|occupancy| of(method, cells, occupancy)))
    });
    let (given, figure): (Vec<_>, Vec<_>) = (given.collect(), figure.collect());
    let cases = given.iter().chain(&figure).map(|(case, _)| case.case(seconds));
    let measured = measure_rates(lab, &cases.collect::<Vec<_>>())?;
    let time = |((case, cells), measured): (&(SearchCase, usize), &MeasuredCase)| {
        let scene = prepare_preset("bench", &case.scene())?;
        let discs = scene.particles().grain_count() as f64;
        let programs = if case.search == CHAINED { scene.model.programs() } else { vec![] };
        let operations = programs.iter().map(|it| {
            let counts = it.program.tally();
            it.times as f64
                * it.n as f64
                * counts.iter().map(|(_, counts)| counts.total()).sum::<u64>() as f64
        });
        let operations = (case.search == CHAINED).then(|| operations.sum());
        let per_disc = measured.cost();
        let seconds =
            ProcessSpread { median: discs * per_disc.median, range: per_disc.range.map(|it| discs * it) };
        let memory = scene.memory.needed as f64;
        Ok(StepTime { case: *case, cells: *cells, operations, seconds, memory })
    };
    let all =
        given.iter().chain(&figure).zip(&measured).map(time).collect::<Result<Vec<_>, CommandFailure>>()?;
    let (given, figure) = all.split_at(given.len());
    let exponents = METHODS.map(|method| {
        let own = given.iter().filter(|it| it.case.search == method);
        let logarithms =
            |of: &dyn Fn(&StepTime) -> f64| own.clone().map(|it| of(it).ln()).collect::<Vec<_>>();
        let (cells, times) = (logarithms(&|it| it.cells as f64), logarithms(&|it| it.seconds.median));
        let operations =
            (method == CHAINED).then(|| slope(&cells, &logarithms(&|it| it.operations.unwrap_or(1.0))));
        (method, slope(&cells, &times), slope_error(&cells, &times), operations)
    });
    let programs = || given.iter().filter(|it| it.case.search == CHAINED);
    let [cells, memory] = [|it: &StepTime| it.cells as f64, |it: &StepTime| it.memory]
        .map(|of| programs().map(of).collect::<Vec<_>>());
    let bytes = slope(&cells, &memory);
    let rows = |some: &[StepTime], name: &str, title: &str| {
        FrameBuilder::of(some)
            .text("method", |it| it.case.search)
            .count("LMAX", |it| it.cells as u64)
            .count("NP", |it| it.case.discs as u64)
            .cell("time of a step (ms)", |it| it.seconds.cell(1e3, 4))
            .number("time of a cell (ns)", 1, |it| 1e9 * it.seconds.median / it.cells as f64)
            .short("operations times lengths", |it| it.operations)
            .frame(name, title)
    };
    Ok(FinishedItem::of([
        rows(given, "given-density", "Time of a step at an occupancy of 0.25"),
        rows(figure, "given-lattice", "Time of a step on given lattices: BP93's figure 3"),
        FrameBuilder::of(exponents)
            .text("method", |(method, ..)| *method)
            .mean("power of the time", 3, |(_, power, error, _)| MeanWithBar { value: *power, bar: *error })
            .number("power of the operations", 4, |(.., operations)| *operations)
            .frame("exponents", "Power of the number of cells by which time and operations of a step grow"),
        FrameBuilder::of(MachineDescription::here().data_caches())
            .text("cache", |(name, _)| name.clone())
            .number("cells", 0, |(_, size)| size / bytes)
            .frame("caches", "Cells of the vector method that a data cache holds"),
    ])
    .with_seeds([1]))
}
