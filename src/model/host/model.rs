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
    /// In which state the machine was: quiet, or how noisy.
    pub state: String,
    /// Seconds that it took.
    pub seconds: f64,
    /// Samples of a number, the median.
    pub samples: f64,
    /// Smallest step of the clock seen (ns).
    pub timer: f64,
    /// Median, over all points, of half the range of the middle half of the samples, as a share.
    pub spread: f64,
    /// Median, over all points, of how much lower the lowest tenth of the samples is than the middle, as a share.
    pub low: f64,
    /// Median, over all points, of how far the two halves of the measurement differ.
    pub disagreement: f64,
    /// Shortest vectors.
    pub shortest: usize,
    /// Longest vectors.
    pub longest: usize,
    /// Median deviation of the fitted passes from the measured ones.
    pub residual: f64,
}

impl Measured {
    /// With a larger half range of the samples the machine was noisy.
    const NOISY: f64 = 0.05;
    /// With a larger difference between the halves of the measurement it changed meanwhile.
    const CHANGED: f64 = 0.05;

    /// The state of a machine whose samples lie so far apart, and the halves of whose measurement so.
    pub fn state_of(spread: f64, disagreement: f64) -> String {
        match (spread > Measured::NOISY, disagreement > Measured::CHANGED) {
            (false, false) => "quiet".to_owned(),
            (true, false) => format!("noisy: half of the samples lie within {:.0} %", 100.0 * spread),
            (noisy, true) => format!(
                "{}: the halves of the measurement differ by {:.0} %",
                if noisy { "noisy and changing" } else { "changing" },
                100.0 * disagreement
            ),
        }
    }

    /// Whether it was quiet.
    pub fn was_quiet(&self) -> bool {
        self.state == "quiet"
    }
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
    /// The same host with every operand in the first-level cache, and no cost of starting programs and of binding arrays.
    #[must_use]
    pub fn in_cache(&self) -> HostModel {
        let mut model = HostModel { operand: 0.0, bind: 0.0, run: 0.0, clock: 0.0, ..self.clone() };
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
        let mut sum = self.run;
        for (strips, length) in [(n / strip, strip), (1, n % strip)] {
            if strips == 0 || length == 0 {
                continue;
            }
            let near = lane.near(outlines, length, self.begin)?;
            let wait: f64 = touched.iter().map(|touches| self.wait(touches, length, around)).sum();
            sum += strips as f64 * (near + wait);
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
        let [begin, computing] = self.loops.near(outlines, n, self.lane(outlines.lane)?.lanes)?;
        let wait = around.wait(&self.levels, &touched_arrays(outlines), n as f64, |level| level.loops);
        let parts = [computing, wait.streamed, wait.indexed];
        Ok(begin + overlapped(self.loops.overlap, parts))
    }
}

#[cfg(test)]
mod tests {
    use super::super::cost::{Estimate, PassCost};
    use super::*;
    use stripmine_kernels::backend::tape::Outline;

    /// A host on which a pass takes 10 ns to begin and 0.5 an element, and a run 100.
    fn host() -> HostModel {
        let of = |value: f64| Estimate { value, interval: 0.0 };
        let add = PassCost { element: of(0.5), start: of(10.0) };
        let lane =
            LaneCosts { lanes: 1, passes: BTreeMap::from([("add".to_owned(), add)]), ..LaneCosts::default() };
        HostModel {
            format: 0,
            title: String::new(),
            instruction_set: String::new(),
            measured: Measured {
                state: String::new(),
                seconds: 1.0,
                samples: 1.0,
                timer: 1.0,
                spread: 0.0,
                low: 0.0,
                disagreement: 0.0,
                shortest: 8,
                longest: 1000,
                residual: 0.0,
            },
            operand: 0.0,
            begin: 1.0,
            bind: 0.0,
            run: 100.0,
            clock: 0.0,
            levels: vec![Level::default()],
            lanes: BTreeMap::from([("f64".to_owned(), lane)]),
            loops: LoopCosts::default(),
            rates: BTreeMap::new(),
        }
    }

    fn sums(count: usize) -> Outlines {
        let pass = Outline { op: Op::Add, converts: false, reads: vec![], writes: None };
        Outlines { lane: "f64", instructions: vec![], passes: vec![pass; count], registers: [0; 3] }
    }

    /// By hand: two passes over 100 elements at once, or in strips of 32 of which the last has 4.
    #[test]
    fn every_strip_begins_and_the_last_is_charged_what_is_left() {
        let (host, around) = (host(), Surroundings::default());
        let ns = |execution| host.program(&sums(2), 100, execution, &around);
        assert_eq!(ns(Execution::Eager), Ok(100.0 + 2.0 * (10.0 + 50.0)));
        assert_eq!(ns(Execution::Strip(32)), Ok(100.0 + 2.0 * (4.0 * 10.0 + 50.0)));
        assert_eq!(ns(Execution::Strip(50)), Ok(100.0 + 2.0 * (2.0 * 10.0 + 50.0)));
        assert_eq!(host.program(&sums(2), 0, Execution::Eager, &around), Ok(0.0));
        assert!(matches!(
            host.program(&sums(2), 1001, Execution::Eager, &around),
            Err(OutOfRange::Length { n: 1001, .. })
        ));
    }

    #[test]
    fn the_baseline_charges_every_operation_of_every_element() {
        let instruction = Outline { op: Op::Add, converts: false, reads: vec![], writes: None };
        let program = Outlines { instructions: vec![instruction; 3], ..sums(1) };
        assert_eq!(host().baseline(&program, 40, Execution::Eager), 0.5 * 120.0);
    }
}
