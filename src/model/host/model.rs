//! A host: all that is known of it, and what a program takes there.

use super::cost::OutOfRange;
use super::lane::LaneCosts;
use super::levels::{Level, Surroundings};
use super::loops::{LoopCosts, overlapped};
use super::rates::Rates;
use super::reuse::{Touch, touched_arrays, touches};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_kernels::isa::Op;

/// How the numbers were measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// Smallest step of the timer seen (ns).
    pub timer: f64,
    /// Nanoseconds that the reference loop took on an undisturbed core, a fixed piece of work timed beside every sample. All
    /// times of this file are for such a core.
    pub reference_loop: f64,
    /// How many times as long it took in the median.
    pub slowdown: f64,
    /// The share of the points that were measured on an undisturbed core; the others were corrected by how they depend on
    /// the slowdown of the reference loop.
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
    /// Nanoseconds an element of a pass any of whose operands come from beyond the nearest level, in addition to what their
    /// bytes take: e0.
    pub operand: f64,
    /// How long a pass of a program takes to begin, as a share of what it takes in a drill of nothing but that pass: the
    /// processor looks ahead from one to the next.
    pub begin: f64,
    /// Nanoseconds to bind an array to a program's memory.
    pub bind: f64,
    /// Nanoseconds of a run of an interpreted program in addition to its passes.
    pub run: f64,
    /// Nanoseconds that timing a phase adds to it.
    pub clock: f64,
    /// The levels, nearest first.
    pub levels: Vec<Level>,
    /// Costs by the element type of the lanes.
    pub lanes: BTreeMap<String, LaneCosts>,
    /// Compiled loops.
    pub loops: LoopCosts,
    /// Work whose amount depends on the data, by method.
    pub rates: BTreeMap<String, Rates>,
}

impl HostModel {
    /// The same host with every program of the interpreter charged pass by pass, as those are that were not seen.
    #[must_use]
    pub fn pass_by_pass(&self) -> HostModel {
        let mut model = self.clone();
        model.lanes.values_mut().for_each(|lane| lane.seen.clear());
        model
    }

    /// The same host pass by pass with every operand in the first-level cache, and no cost of starting programs and of
    /// binding arrays.
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
            let extra: f64 = touched
                .iter()
                .map(|touches| around.wait(&own, touches, length as f64, |level| level.passes).sum())
                .sum();
            let parts = factors.scaled([near, wait, 0.0]);
            sum += strips as f64 * (parts.iter().sum::<f64>() + extra);
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
                Execution::Chained => 0,
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
