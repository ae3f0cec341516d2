//! Today's hosts: what a pass of the interpreter takes, `t = t0 + n max(tau, e0 + sum of e_level)`, with the level of each
//! operand found by reuse distance on the passes that are executed, and what chained code takes.

mod file;
mod reuse;

pub use file::{HostFileError, default_model};
pub use reuse::{Since, Touch, element_bytes, touches};

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_kernels::isa::Op;

/// A fitted number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Half the width of its 95 % confidence interval, from the residuals of the fit.
    pub interval: f64,
}

/// A pass of one operation over a vector in the first-level cache: Hockney's `r_inf = 1/tau`, `n_half = t0/tau`.
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
    /// A pass, by the mnemonic of its operation.
    pub passes: BTreeMap<String, PassCost>,
    /// An element in chained code, by the mnemonic (ns).
    pub chained: BTreeMap<String, Estimate>,
}

/// A level of memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Its name.
    pub name: String,
    /// Up to which reuse distance it serves (bytes); none for the last.
    pub capacity: Option<f64>,
    /// Nanoseconds a byte of an operand.
    pub byte: f64,
}

/// What it takes to make one vector register of the interpreter ready.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetUp {
    /// Bytes of the register.
    pub bytes: f64,
    /// Nanoseconds.
    pub ns: f64,
}

/// How the numbers were measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// Smallest step of the timer seen (ns).
    pub timer: f64,
    /// Median, over all points, of how much slower the median repeat was than the best.
    pub spread: f64,
    /// Shortest vectors.
    pub shortest: usize,
    /// Longest vectors.
    pub longest: usize,
    /// Mean deviation of the fitted passes from the measured ones.
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
    /// Nanoseconds an element of a pass whose operands come from memory, besides what their bytes take: e0.
    pub operand: f64,
    /// Nanoseconds to bind an array to a program's memory.
    pub bind: f64,
    /// Nanoseconds of a run of chained code besides its elements.
    pub chained_run: f64,
    /// Of the smaller of what the divider and the other units take in chained code, the share that does not overlap with
    /// the larger.
    pub chained_overlap: f64,
    /// The levels, nearest first.
    pub levels: Vec<Level>,
    /// Making registers ready, by rising size.
    pub set_up: Vec<SetUp>,
    /// Costs by the element type of the lanes.
    pub lanes: BTreeMap<String, LaneCosts>,
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
    /// An execution or precision that was not measured.
    #[error("{0} was not calibrated")]
    NotMeasured(String),
}

/// Operations that are charged as another one, which works in the same way.
pub fn measured_as(op: Op) -> Op {
    match op {
        Op::Subtract => Op::Add,
        Op::Maximum => Op::Minimum,
        Op::LessEqual | Op::Equal | Op::And | Op::Not => Op::LessThan,
        Op::Load | Op::LoadShifted | Op::Widen => Op::Absolute,
        Op::StoreShifted => Op::Store,
        Op::Numbers | Op::ToIndex => Op::FromIndex,
        op => op,
    }
}

impl HostModel {
    /// Nanoseconds a byte of an operand last touched so many bytes ago; half an octave around a capacity belongs to both
    /// levels, for caches do not end sharply.
    pub fn byte(&self, distance: f64) -> f64 {
        let mut cost = self.levels.first().map_or(0.0, |level| level.byte);
        for pair in self.levels.windows(2) {
            if let Some(capacity) = pair[0].capacity {
                cost += beyond(distance, capacity) * (pair[1].byte - pair[0].byte);
            }
        }
        cost
    }

    /// The same host with every operand in the first-level cache, registers and bindings for nothing.
    #[must_use]
    pub fn in_cache(&self) -> HostModel {
        let mut model = HostModel { operand: 0.0, bind: 0.0, set_up: vec![], ..self.clone() };
        model.levels.iter_mut().for_each(|level| level.byte = 0.0);
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

    /// Nanoseconds of a run of a program over `n` elements whose arrays were last touched `resident` bytes ago.
    ///
    /// # Errors
    /// [`OutOfRange`] where nothing was measured that could say.
    pub fn program(
        &self,
        outlines: &Outlines,
        n: usize,
        execution: Execution,
        resident: f64,
    ) -> Result<f64, OutOfRange> {
        if n == 0 {
            return Ok(0.0);
        }
        self.admits(n)?;
        let lane = self
            .lanes
            .get(outlines.lane)
            .ok_or_else(|| OutOfRange::NotMeasured(format!("precision {}", outlines.lane)))?;
        match execution {
            Execution::Eager => self.interpreted(lane, outlines, n, n, resident),
            Execution::Strip(strip) => self.interpreted(lane, outlines, n, strip.min(n), resident),
            Execution::Chained => self.chained(lane, outlines, n, resident),
            Execution::Block(_) => Err(OutOfRange::NotMeasured("execution in blocks".to_owned())),
        }
    }

    /// The trivial baseline: operations times elements, each at the cost of a sum in the first-level cache (ns).
    pub fn baseline(&self, outlines: &Outlines, n: usize, execution: Execution) -> f64 {
        let add = Op::Add.mnemonic();
        let each = self.lanes.get(outlines.lane).and_then(|lane| match execution {
            Execution::Chained => lane.chained.get(add).map(|cost| cost.value),
            _ => lane.passes.get(add).map(|cost| cost.element.value),
        });
        let operations: usize =
            outlines.instructions.iter().map(|outline| outline.operations().count()).sum();
        each.unwrap_or(0.0) * (operations * n) as f64
    }

    fn interpreted(
        &self,
        lane: &LaneCosts,
        outlines: &Outlines,
        n: usize,
        strip: usize,
        resident: f64,
    ) -> Result<f64, OutOfRange> {
        let touched = touches(outlines, lane.register_bytes);
        let mut sum = 0.0;
        for (strips, length) in [(n / strip, strip), (1, n % strip)] {
            if strips == 0 || length == 0 {
                continue;
            }
            let mut each = 0.0;
            for (pass, touches) in outlines.passes.iter().zip(&touched) {
                each += self.pass(lane, pass.op, touches, length, resident)?;
            }
            sum += strips as f64 * each;
        }
        let registers = outlines.registers.iter().zip(lane.register_bytes);
        let set_up = registers.map(|(&count, bytes)| count as f64 * self.set_up(bytes * strip as f64));
        Ok(sum + set_up.sum::<f64>())
    }

    /// Nanoseconds of a pass over `n` elements.
    ///
    /// # Errors
    /// [`OutOfRange`] where the operation was not measured.
    pub fn pass(
        &self,
        lane: &LaneCosts,
        op: Op,
        touches: &[Touch],
        n: usize,
        resident: f64,
    ) -> Result<f64, OutOfRange> {
        let cost = cost_of(&lane.passes, op)?;
        let from = touches.iter().map(|touch| {
            let distance = match touch.since {
                Since::Here(distance) => distance * n as f64,
                Since::Before => resident,
            };
            touch.bytes * self.byte(distance)
        });
        let memory = self.operand + from.sum::<f64>();
        // What is left of a strip beyond whole hardware registers goes element by element, in passes of its own.
        let rest = n % lane.lanes.max(1);
        let starts = if rest == 0 || n < lane.lanes { 1.0 } else { 2.0 };
        Ok(starts * cost.start.value + n as f64 * cost.element.value.max(memory))
    }

    fn set_up(&self, bytes: f64) -> f64 {
        let at =
            self.set_up.partition_point(|point| point.bytes < bytes).clamp(1, self.set_up.len().max(2) - 1);
        let (Some(low), Some(high)) = (self.set_up.get(at - 1), self.set_up.get(at)) else { return 0.0 };
        let share = ((bytes / low.bytes).ln() / (high.bytes / low.bytes).ln()).max(0.0);
        (low.ns.max(1e-3).ln() * (1.0 - share) + high.ns.max(1e-3).ln() * share).exp()
    }

    fn chained(
        &self,
        lane: &LaneCosts,
        outlines: &Outlines,
        n: usize,
        resident: f64,
    ) -> Result<f64, OutOfRange> {
        let [mut divider, mut others] = [0.0; 2];
        for outline in &outlines.instructions {
            let cost = cost_of(&lane.chained, outline.op)?.value;
            *(if matches!(outline.op, Op::Divide | Op::SquareRoot) { &mut divider } else { &mut others }) +=
                cost;
        }
        let compute = self.overlapped(divider, others);
        let arrays = touches(outlines, lane.register_bytes).into_iter().flatten();
        let arrays = arrays.filter(|touch| touch.since == Since::Before);
        let memory: f64 = arrays.map(|touch| touch.bytes * self.byte(resident)).sum();
        Ok(self.chained_run + n as f64 * compute.max(memory))
    }

    /// Nanoseconds of work that takes so much of the divider and so much of the other units.
    pub fn overlapped(&self, divider: f64, others: f64) -> f64 {
        divider.max(others) + self.chained_overlap * divider.min(others)
    }
}

/// The cost of an operation, or of the one it is measured as.
fn cost_of<T: Copy>(costs: &BTreeMap<String, T>, op: Op) -> Result<T, OutOfRange> {
    let found = costs.get(op.mnemonic()).or_else(|| costs.get(measured_as(op).mnemonic()));
    found.copied().ok_or_else(|| OutOfRange::NotMeasured(format!("operation {}", op.mnemonic())))
}

/// How much of what lies `distance` bytes back a cache of so many bytes has lost.
pub fn beyond(distance: f64, capacity: f64) -> f64 {
    ((distance / capacity).log2() + 0.5).clamp(0.0, 1.0)
}
