//! Compiled loops. What the compiler makes of a text (which values spill, how instructions are ordered) does not follow
//! from the operations it counts, so loops that a calibration has seen are charged what they took on short vectors; others
//! by their classes of operations, fitted to those that were seen.

use super::cost::{Estimate, OutOfRange, PassCost};
use super::levels::{Level, Transfer};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_kernels::isa::OpClass;

/// A program as a calibration has seen it in the first-level cache.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProgramCost {
    /// What it does.
    pub what: String,
    /// Nanoseconds an element.
    pub element: Estimate,
    /// Nanoseconds in addition, for each run, or each strip of the interpreter.
    pub start: Estimate,
    /// The same of what is left beyond whole hardware registers, which goes element by element.
    pub rest: PassCost,
    /// How it differs beyond the first-level cache.
    pub factors: Factors,
}

impl ProgramCost {
    /// Nanoseconds to begin, and to compute, over `n` elements in the first-level cache, with `lanes` elements in a hardware
    /// register.
    pub fn near(&self, n: usize, lanes: usize) -> [f64; 2] {
        let left = n % lanes.max(1);
        let whole = n - left;
        let parts = [(whole, self.start, self.element), (left, self.rest.start, self.rest.element)];
        parts.into_iter().filter(|(n, ..)| *n > 0).fold(
            [0.0; 2],
            |[begin, computing], (n, start, element)| {
                [begin + start.value, computing + n as f64 * element.value]
            },
        )
    }
}

/// How a program differs from what is said of all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Factors {
    /// How many times as long it computes on whole vectors as on short ones.
    pub computing: f64,
    /// How many times as long it waits as the levels say.
    pub waiting: f64,
    /// Additional nanoseconds for a byte from beyond each level: in the interpreter, where passes wait that others do
    /// not meet.
    pub beyond: [f64; 4],
}

impl Default for Factors {
    fn default() -> Factors {
        Factors { computing: 1.0, waiting: 1.0, beyond: [0.0; 4] }
    }
}

impl Factors {
    /// The additional costs of the levels for this program.
    pub fn levels(&self, levels: &[Level]) -> Vec<Level> {
        let mut fetch = 0.0;
        let each = |(at, level): (usize, &Level)| {
            fetch += at.checked_sub(1).and_then(|before| self.beyond.get(before)).copied().unwrap_or(0.0);
            let passes = Transfer { fetch, fetch_array: fetch, ..Transfer::default() };
            Level { capacity: level.capacity, passes, ..Level::default() }
        };
        levels.iter().enumerate().map(each).collect()
    }

    /// Nanoseconds of computing, and of waiting for streams and for lines, as this program takes them.
    #[must_use]
    pub fn scaled(self, [computing, streams, lines]: [f64; 3]) -> [f64; 3] {
        [self.computing * computing, self.waiting * streams, self.waiting * lines]
    }
}

/// All that is known of loops.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopCosts {
    /// Nanoseconds that an operation of a class adds to an element, by lanes and class.
    pub classes: BTreeMap<String, BTreeMap<String, f64>>,
    /// Median deviation of the classes' sums from the loops they were fitted to.
    pub residual: f64,
    /// Of the shorter of computing and waiting for streams, the share that hides behind the longer.
    pub overlap: f64,
    /// Loops by the signature of their instructions.
    pub seen: BTreeMap<String, ProgramCost>,
}

impl LoopCosts {
    /// The cost of a program's loop: as it was seen, or by its classes.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where not even its lanes were.
    pub fn of(&self, outlines: &Outlines) -> Result<Cow<'_, ProgramCost>, OutOfRange> {
        if let Some(seen) = self.seen.get(&outlines.signature()) {
            return Ok(Cow::Borrowed(seen));
        }
        self.by_classes(outlines)
            .map(Cow::Owned)
            .ok_or_else(|| OutOfRange::NotMeasured(format!("chained execution of {} lanes", outlines.lane)))
    }

    /// The cost of a loop by its classes of operations.
    fn by_classes(&self, outlines: &Outlines) -> Option<ProgramCost> {
        let classes = self.classes.get(outlines.lane)?;
        let counts = class_counts(outlines);
        let value =
            counts.iter().map(|(class, count)| classes.get(*class).copied().unwrap_or(0.0) * count).sum();
        let mean = |of: fn(&ProgramCost) -> f64| {
            self.seen.values().map(of).sum::<f64>() / self.seen.len().max(1) as f64
        };
        let interval = |value: f64| Estimate { value, interval: self.residual * value };
        let [element, start] = [value, mean(|seen| seen.start.value)].map(interval);
        // The ratio of elements that are left over to those in registers is that of the loops that were measured.
        let longer = mean(|seen| seen.rest.element.value) / mean(|seen| seen.element.value).max(1e-6);
        let [rest, begin] = [longer * value, mean(|seen| seen.rest.start.value)].map(interval);
        Some(ProgramCost {
            what: "by its classes".to_owned(),
            element,
            start,
            rest: PassCost { element: rest, start: begin },
            factors: Factors::default(),
        })
    }

    /// Nanoseconds of the cheapest class that computes: what the trivial baseline charges for everything.
    pub fn operation(&self, lane: &str) -> f64 {
        let classes = self.classes.get(lane);
        classes.and_then(|classes| classes.get(OpClass::Add.name())).copied().unwrap_or(0.0)
    }
}

/// Nanoseconds of computing, and of waiting for streams and for lines, where this share of the shorter of the first two hides
/// behind the longer.
pub fn overlapped(share: f64, [computing, streams, lines]: [f64; 3]) -> f64 {
    computing.max(streams) + (1.0 - share) * computing.min(streams) + lines
}

/// Operations of each class of an element.
pub fn class_counts(outlines: &Outlines) -> BTreeMap<&'static str, f64> {
    let mut counts = BTreeMap::new();
    for op in outlines.instructions.iter().flat_map(|outline| outline.operations()) {
        // Cheap classes share the same units: one number for all of them.
        let class = match op.class() {
            OpClass::Multiply | OpClass::Compare | OpClass::Logical | OpClass::Shift | OpClass::Load => {
                OpClass::Add
            }
            class => class,
        };
        *counts.entry(class.name()).or_insert(0.0) += 1.0;
    }
    counts
}
