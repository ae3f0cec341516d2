//! Today's hosts: what a pass of the interpreter takes, `t = t0 + n (tau + e0 + sum of e_level)`, with the level of each
//! operand found by reuse distance on the passes that are executed, and t0 and tau of a program's passes together where a
//! calibration has measured it; what compiled loops take; and what a unit of the work takes whose amount depends on the data.

mod file;
mod levels;
mod loops;
mod rates;
mod reuse;

pub use file::{BadEntry, FORMAT, HostFileError, default_model};
pub use levels::{LINE, Level, Surroundings, Transfer, Wait, beyond, from_afar};
pub use loops::{Factors, LoopCosts, ProgramCost, class_counts, overlapped};
pub use rates::{Amounts, RatePoint, Rates};
pub use reuse::{Since, Touch, Vector, element_bytes, touched_arrays, touches};

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::{Outline, Outlines};
use stripmine_kernels::isa::Op;

/// A fitted number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Half the width of its 95 % confidence interval: from the residuals of the fit, and from how far the parts of the
    /// measurement differ.
    pub interval: f64,
}

impl Estimate {
    /// Without another, and as unsure as both; nothing takes less than nought.
    #[must_use]
    pub fn less(self, other: Estimate) -> Estimate {
        Estimate { value: (self.value - other.value).max(0.0), interval: self.interval.hypot(other.interval) }
    }
}

/// A pass of one kind over a vector in the first-level cache: Hockney's `r_inf = 1/tau`, `n_half = t0/tau`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PassCost {
    /// Nanoseconds an element, tau.
    pub element: Estimate,
    /// Nanoseconds of a pass besides, t0.
    pub start: Estimate,
}

/// The costs on lanes of one precision.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaneCosts {
    /// Bytes of an element in a register of each file: numbers, predicates, indices.
    pub register_bytes: [f64; 3],
    /// Lanes of a hardware register.
    pub lanes: usize,
    /// Nanoseconds an element of a pass, besides its tau, for each operand that is an array: its registers lie across
    /// lines.
    pub array_operand: f64,
    /// Nanoseconds that a pass takes besides where the next one is of another kind, by the passes of the program.
    pub change: Vec<Change>,
    /// A pass, by the name of its kind.
    pub passes: BTreeMap<String, PassCost>,
    /// All passes of a program over a strip, by the signature of its instructions: how passes that follow each other get on
    /// is not in their kinds. Others are charged pass by pass.
    pub seen: BTreeMap<String, ProgramCost>,
}

/// What it takes that the next pass is of another kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Passes of the program: of a long one neither the instructions nor the branches stay at hand.
    pub passes: usize,
    /// Nanoseconds a pass.
    pub ns: f64,
}

/// How the numbers were measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// Smallest step of the timer seen (ns).
    pub timer: f64,
    /// Nanoseconds that a yardstick took in quiet moments, a fixed piece of work run beside every sample: all times of this file
    /// are told at this pace.
    pub yardstick: f64,
    /// How many times as long it took most of the time.
    pub pace: f64,
    /// The share of the points that were measured in quiet moments; what others would take then was found from how they
    /// follow the yardstick.
    pub quiet: f64,
    /// Median, over all points, of half the range of the middle half of those samples, as a share.
    pub spread: f64,
    /// Median, over all points, of how far the two halves of the measurement differ.
    pub disagreement: f64,
    /// Shortest vectors.
    pub shortest: usize,
    /// Longest vectors.
    pub longest: usize,
    /// Median deviation of the fitted passes from the measured ones.
    pub residual: f64,
}

/// A host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HostModel {
    /// Version of the file format.
    pub format: u32,
    /// The processor and the platform.
    pub title: String,
    /// The instructions it was measured with.
    pub instruction_set: String,
    /// How it was measured.
    pub measured: Measured,
    /// Nanoseconds an element of a pass any of whose operands come from beyond the nearest level, besides what their bytes
    /// take: e0.
    pub operand: f64,
    /// How long a pass of a program takes to begin, as a share of what it takes in a drill of nothing but that pass: the
    /// processor looks ahead from one to the next.
    pub begin: f64,
    /// Nanoseconds to bind an array to a program's memory.
    pub bind: f64,
    /// Nanoseconds of a run of an interpreted program besides its passes.
    pub run: f64,
    /// Nanoseconds that timing a phase adds to it.
    pub clock: f64,
    /// The levels, nearest first.
    pub levels: Vec<Level>,
    /// Costs by the element type of the lanes.
    pub lanes: BTreeMap<String, LaneCosts>,
    /// Compiled loops.
    pub loops: LoopCosts,
    /// Work whose amount hangs on the data, by method.
    pub rates: BTreeMap<String, Rates>,
}

/// Why there is no prediction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutOfRange {
    /// Vectors longer or shorter than those that were measured.
    #[error(
        "vectors of {n} elements lie outside the calibrated range of {shortest} to {longest}: calibrate on them, or ask \
         for another number of particles"
    )]
    Length {
        /// Elements asked for.
        n: usize,
        /// Shortest vectors.
        shortest: usize,
        /// Longest vectors.
        longest: usize,
    },
    /// More or fewer discs than those that were measured.
    #[error(
        "{discs} discs lie outside the calibrated range of {fewest} to {most}: ask for another number of particles"
    )]
    Discs {
        /// Discs asked for.
        discs: usize,
        /// Fewest discs.
        fewest: usize,
        /// Most discs.
        most: usize,
    },
    /// An execution, precision or program that was not measured.
    #[error("{0} was not calibrated")]
    NotMeasured(String),
}

/// Kinds of passes that are charged as another one, which works in the same way.
fn measured_as(kind: &str) -> &str {
    match kind {
        "lds" => Op::Load.mnemonic(),
        "sts" => Op::Store.mnemonic(),
        "lds.convert" => "ld.convert",
        "sts.convert" => "st.convert",
        kind => kind,
    }
}

impl HostModel {
    /// The same host with every program of the interpreter charged pass by pass, as those are that were not seen.
    #[must_use]
    pub fn pass_by_pass(&self) -> HostModel {
        let mut model = self.clone();
        model.lanes.values_mut().for_each(|lane| lane.seen.clear());
        model
    }

    /// The same host pass by pass with every operand in the first-level cache, and programs started and arrays bound for nothing.
    #[must_use]
    pub fn in_cache(&self) -> HostModel {
        let mut model = HostModel { operand: 0.0, bind: 0.0, run: 0.0, clock: 0.0, ..self.pass_by_pass() };
        for level in &mut model.levels {
            *level = Level { name: level.name.clone(), capacity: level.capacity, ..Level::default() };
        }
        model
    }

    /// Whether vectors of `n` elements lie within what was measured.
    ///
    /// # Errors
    /// [`OutOfRange::Length`] where they do not.
    pub fn admits(&self, n: usize) -> Result<(), OutOfRange> {
        let Measured { shortest, longest, .. } = self.measured;
        if n < shortest || n > longest {
            return Err(OutOfRange::Length { n, shortest, longest });
        }
        Ok(())
    }

    /// Nanoseconds of a run of a program over `n` elements.
    ///
    /// # Errors
    /// [`OutOfRange`] where nothing was measured that could say.
    pub fn program(
        &self,
        outlines: &Outlines,
        n: usize,
        execution: Execution,
        around: &Surroundings,
    ) -> Result<f64, OutOfRange> {
        if n == 0 {
            return Ok(0.0);
        }
        self.admits(n)?;
        match execution {
            Execution::Eager => self.interpreted(outlines, n, None, around),
            Execution::Strip(strip) => self.interpreted(outlines, n, Some(strip), around),
            Execution::Chained => self.chained(outlines, n, around),
            Execution::Block(_) => Err(OutOfRange::NotMeasured("execution in blocks".to_owned())),
        }
    }

    /// The trivial baseline: operations times elements, each at the cost of a sum in the first-level cache (ns).
    pub fn baseline(&self, outlines: &Outlines, n: usize, execution: Execution) -> f64 {
        let each = match execution {
            Execution::Chained => self.loops.operation(outlines.lane),
            _ => {
                let add = self.lanes.get(outlines.lane).and_then(|lane| lane.passes.get(Op::Add.mnemonic()));
                add.map_or(0.0, |cost| cost.element.value)
            }
        };
        let operations: usize =
            outlines.instructions.iter().map(|outline| outline.operations().count()).sum();
        each * (operations * n) as f64
    }

    fn lane(&self, name: &str) -> Result<&LaneCosts, OutOfRange> {
        self.lanes.get(name).ok_or_else(|| OutOfRange::NotMeasured(format!("precision {name}")))
    }

    fn interpreted(
        &self,
        outlines: &Outlines,
        n: usize,
        strips: Option<usize>,
        around: &Surroundings,
    ) -> Result<f64, OutOfRange> {
        let strip = strips.map_or(n, |strip| strip.min(n));
        let lane = self.lane(outlines.lane)?;
        let touched = touches(outlines, lane.register_bytes);
        let factors = lane.factors(outlines);
        let own = factors.levels(&self.levels);
        let mut sum = self.run;
        for (strips, length) in [(n / strip, strip), (1, n % strip)] {
            if strips == 0 || length == 0 {
                continue;
            }
            let near = lane.near(outlines, length, self.begin)?;
            let wait = touched.iter().map(|touches| self.wait(touches, length, around)).sum();
            let besides: f64 = touched
                .iter()
                .map(|touches| around.wait(&own, touches, length as f64, |level| level.passes).sum())
                .sum();
            let parts = factors.scaled([near, wait, 0.0]);
            sum += strips as f64 * (parts.iter().sum::<f64>() + besides);
        }
        Ok(sum)
    }

    /// Nanoseconds that a pass over `n` elements waits for what it touches.
    fn wait(&self, touches: &[Touch], n: usize, around: &Surroundings) -> f64 {
        let wait = around.wait(&self.levels, touches, n as f64, |level| level.passes);
        wait.sum() + wait.far * self.operand * n as f64
    }

    /// What each of some programs finds around it that are run one after the other, over vectors of these lengths.
    ///
    /// # Errors
    /// [`OutOfRange`] for lanes that were not measured.
    pub fn surroundings(
        &self,
        programs: &[(&Outlines, usize)],
        execution: Execution,
    ) -> Result<Vec<Surroundings>, OutOfRange> {
        let mut registers = 0.0_f64;
        for (outlines, n) in programs {
            let length = match execution {
                Execution::Eager => *n,
                Execution::Strip(strip) => strip.min(*n),
                Execution::Chained | Execution::Block(_) => 0,
            };
            registers = registers.max(self.lane(outlines.lane)?.register_extent(outlines, length));
        }
        Ok(Surroundings::of_cycle(programs, execution, registers))
    }

    fn chained(&self, outlines: &Outlines, n: usize, around: &Surroundings) -> Result<f64, OutOfRange> {
        let cost = self.loops.of(outlines)?;
        let [begin, computing] = cost.near(n, self.lane(outlines.lane)?.lanes);
        let wait = around.wait(&self.levels, &touched_arrays(outlines), n as f64, |level| level.loops);
        let parts = cost.factors.scaled([computing, wait.streamed, wait.indexed]);
        Ok(begin + overlapped(self.loops.overlap, parts))
    }
}

impl LaneCosts {
    /// How often a pass over `n` elements begins: what is left of it beyond whole hardware registers goes element by element,
    /// in a pass of its own.
    pub fn starts(&self, n: usize) -> f64 {
        if n < self.lanes || n.is_multiple_of(self.lanes.max(1)) { 1.0 } else { 2.0 }
    }

    /// Nanoseconds of all passes of a program over a strip of `n` elements in the first-level cache, where a pass that was not
    /// seen among others takes `begin` times as long to begin as in a drill.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where a kind of pass was not measured.
    pub fn near(&self, outlines: &Outlines, n: usize, begin: f64) -> Result<f64, OutOfRange> {
        if let Some(seen) = self.seen.get(&outlines.signature()) {
            return Ok(seen.near(n, self.lanes).iter().sum());
        }
        let at = |start: f64, element: f64| self.starts(n) * start + n as f64 * element;
        let change = begin * self.change(outlines.passes.len());
        let each = |pass| {
            let PassCost { element, start } = self.cost(pass)?;
            Ok(change + at(begin * start.value, element.value))
        };
        outlines.passes.iter().map(each).sum()
    }

    /// How a program differs from what its passes and the levels say.
    pub fn factors(&self, outlines: &Outlines) -> Factors {
        self.seen.get(&outlines.signature()).map(|seen| seen.factors).unwrap_or_default()
    }

    /// Bytes of all registers of a program over vectors or strips of `n` elements.
    pub fn register_extent(&self, outlines: &Outlines, n: usize) -> f64 {
        let files = outlines.registers.iter().zip(self.register_bytes);
        files.map(|(&count, bytes)| count as f64 * bytes * n as f64).sum()
    }

    /// What a pass takes in the first-level cache.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where its kind was not measured.
    pub fn cost(&self, pass: &Outline) -> Result<PassCost, OutOfRange> {
        let kind = pass.kind();
        let found = self.passes.get(&kind).or_else(|| self.passes.get(measured_as(&kind)));
        let mut cost = *found.ok_or_else(|| OutOfRange::NotMeasured(format!("operation {kind}")))?;
        if pass.computes() {
            cost.element.value += self.array_operand * pass.array_operands() as f64;
        }
        Ok(cost)
    }

    /// Nanoseconds a pass of a program of so many, because the next one is of another kind.
    pub fn change(&self, passes: usize) -> f64 {
        let points: Vec<(f64, f64)> =
            self.change.iter().map(|change| (change.passes as f64, change.ns)).collect();
        interpolated(&points, passes as f64)
    }
}

/// Between points of rising positive abscissae, linearly over their logarithm; beyond the ends as there.
pub(super) fn interpolated(points: &[(f64, f64)], at: f64) -> f64 {
    let Some(&(first, value)) = points.first() else { return 0.0 };
    if at <= first {
        return value;
    }
    for pair in points.windows(2) {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        if at <= x1 {
            return y0 + (y1 - y0) * (at / x0).ln() / (x1 / x0).ln();
        }
    }
    points.last().map_or(0.0, |&(_, value)| value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::backend::tape::Place;

    #[test]
    fn a_program_is_charged_as_it_was_seen_and_else_pass_by_pass() {
        let sum = Outline { op: Op::Add, converts: false, reads: Vec::<Place>::new(), writes: None };
        let outlines =
            Outlines { lane: "f64", instructions: vec![], passes: vec![sum.clone(), sum], registers: [0; 3] };
        let of = |value: f64| Estimate { value, interval: 0.0 };
        let pass = PassCost { element: of(0.5), start: of(10.0) };
        let mut lane = LaneCosts { lanes: 4, ..LaneCosts::default() };
        lane.passes.insert(outlines.passes[0].kind(), pass);
        lane.change.push(Change { passes: 1, ns: 2.0 });
        // Passes begin twice where elements are left over.
        assert_eq!(lane.near(&outlines, 8, 0.5).unwrap(), 2.0 * (0.5 * (2.0 + 10.0) + 8.0 * 0.5));
        assert_eq!(lane.near(&outlines, 9, 0.5).unwrap(), 2.0 * (0.5 * (2.0 + 20.0) + 9.0 * 0.5));
        let seen = ProgramCost {
            what: "two sums".to_owned(),
            element: of(0.75),
            start: of(7.0),
            rest: PassCost { element: of(1.5), start: of(3.0) },
            factors: Factors::default(),
        };
        lane.seen.insert(outlines.signature(), seen);
        let near = [3, 8, 9].map(|n| lane.near(&outlines, n, 0.5).unwrap());
        assert_eq!(near, [3.0 + 3.0 * 1.5, 7.0 + 8.0 * 0.75, 7.0 + 8.0 * 0.75 + 3.0 + 1.5]);
    }
}
