//! The larger drill scenes, whose arrays lie in the levels beyond the first: the programs of a step one after the other, by
//! the interpreter and as compiled loops.

use super::passes::Lane;
use super::point::{Charged, Waiting};
use super::step::{INTERPRETED, Step};
use crate::laboratory::lattice_md::study::samples::Samples;
use crate::model::host::{LoopCosts, Surroundings, touched_arrays};
use std::rc::Rc;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::Outlines;

/// NP and ρ: lattices of 600 to 400 000 cells, few of them more than half as large again as the one before, some with many
/// discs and some with few, whose gathers meet other levels; where a level ends, a third more can take half as long again.
pub(super) const SCENES: [(usize, f64); 12] = [
    (70, 0.12),
    (480, 0.21),
    (210, 0.06),
    (1300, 0.13),
    (720, 0.06),
    (3300, 0.21),
    (2400, 0.13),
    (5800, 0.21),
    (4300, 0.06),
    (19_000, 0.21),
    (8200, 0.06),
    (24_000, 0.06),
];

/// A program as it was run on one of the scenes.
pub(super) struct Ran {
    outlines: Rc<Outlines>,
    n: usize,
    execution: Execution,
    around: Surroundings,
    ns: f64,
}

/// The programs of a scene in every execution; `look` is what looking at the clock takes.
pub(super) fn ran(step: &Step, lanes: &[Lane], look: f64) -> Vec<Ran> {
    let outlines: Vec<Rc<Outlines>> =
        step.programs.iter().map(|step| Rc::new(step.program.outlines())).collect();
    let lengths = || step.ranges.iter().map(ExactSizeIterator::len);
    let cycle: Vec<(&Outlines, usize)> = outlines.iter().map(Rc::as_ref).zip(lengths()).collect();
    let interpreted = INTERPRETED.into_iter().zip(&step.interpreted);
    let executions = interpreted.chain([(Execution::Chained, &step.whole)]);
    let of_execution = |(execution, samples): (Execution, &Vec<Samples>)| {
        let extent = |(outlines, n): &(&Outlines, usize)| match execution {
            Execution::Chained => Some(0.0),
            _ => Some(of(lanes, outlines)?.costs.register_extent(outlines, length(*n, execution))),
        };
        let registers = cycle.iter().filter_map(extent).fold(0.0, f64::max);
        let around = Surroundings::of_cycle(&cycle, execution, registers);
        let programs = outlines.iter().zip(lengths()).zip(around).zip(samples);
        let all = programs.map(move |(((outlines, n), around), samples)| Ran {
            outlines: Rc::clone(outlines),
            n,
            execution,
            around,
            ns: samples.middle() - look,
        });
        all.filter(|ran| ran.n > 0 && ran.ns.is_finite() && ran.ns > 0.0).collect::<Vec<_>>()
    };
    executions.flat_map(of_execution).collect()
}

fn of<'a>(lanes: &'a [Lane], outlines: &Outlines) -> Option<&'a Lane> {
    lanes.iter().find(|lane| lane.name == outlines.lane)
}

/// Elements of what an execution goes over at once.
fn length(n: usize, execution: Execution) -> usize {
    if let Execution::Strip(strip) = execution { strip.min(n) } else { n }
}

impl Ran {
    fn is_loop(&self) -> bool {
        self.execution == Execution::Chained
    }

    /// As the levels see it, by the interpreter; none of loops.
    pub(super) fn passes(&self, lanes: &[Lane], begin: f64) -> Option<Charged> {
        let Ran { outlines, n, execution, around, ns } = self;
        let strip = (*n, length(*n, *execution));
        let lane = of(lanes, outlines).filter(|_| !self.is_loop())?;
        lane.charged(outlines, strip, begin, around.clone(), *ns)
    }

    /// The same as a loop, whose cost in the first-level cache is known; none of the interpreter's.
    pub(super) fn compiled(&self, costs: &LoopCosts, lanes: &[Lane]) -> Option<Charged> {
        let lanes = of(lanes, &self.outlines).filter(|_| self.is_loop())?.costs.lanes;
        let [start, computing] = costs.near(&self.outlines, self.n, lanes).ok()?;
        let n = self.n as f64;
        Some(Charged {
            computing,
            start,
            passes: vec![Waiting { times: 1.0, n, touched: touched_arrays(&self.outlines) }],
            around: self.around.clone(),
            ns: self.ns,
            weight: 1.0,
        })
    }
}
