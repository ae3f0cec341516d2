//! What was measured, by what it is charged for: bytes and lines from beyond each level, and passes.

use crate::model::host::{Level, Surroundings, Touch, Transfer, overlapped};

/// Something measured, as the levels see it.
pub(super) struct Charged {
    /// Nanoseconds it takes in the first-level cache.
    pub(super) computing: f64,
    /// Nanoseconds before it begins, during which nothing comes.
    pub(super) start: f64,
    /// Its passes.
    pub(super) passes: Vec<Waiting>,
    /// What lies around it.
    pub(super) around: Surroundings,
    /// Nanoseconds it took.
    pub(super) ns: f64,
    /// How much it counts.
    pub(super) weight: f64,
}

/// A pass that is made some times.
pub(super) struct Waiting {
    /// How often.
    pub(super) times: f64,
    /// Elements.
    pub(super) n: f64,
    /// What it touches.
    pub(super) touched: Vec<Touch>,
}

/// Levels beyond the nearest.
pub(super) const BEYOND: usize = 4;
/// What is fitted: e0; what each level beyond the nearest adds to a byte fetched, to one of an array from before, to a byte
/// that must go back, to the first one of a pass, and to a line that an index vector leads to unforeseen.
pub(super) const UNKNOWN: usize = KINDS * BEYOND + 1;
/// Where the arrays begin.
pub(super) const ARRAYS: usize = 1 + BEYOND;
/// Where what goes back begins.
pub(super) const BACK: usize = 1 + 2 * BEYOND;
/// Where the first bytes of a pass begin.
pub(super) const FIRST: usize = 1 + 3 * BEYOND;
/// Where the lines begin.
pub(super) const LINES: usize = 1 + 4 * BEYOND;
pub(super) type Costs = [f64; UNKNOWN];

/// Kinds of costs of a level.
const KINDS: usize = 5;

/// What is paid for that comes from beyond a capacity.
#[derive(Clone, Copy)]
pub(super) struct Beyond {
    /// Bytes, lines and passes by the kind of their cost.
    kinds: [f64; KINDS],
    /// Elements of passes any of whose operands do.
    elements: f64,
}

impl Charged {
    pub(super) fn beyond(&self, capacity: f64) -> Beyond {
        let mut beyond = Beyond { kinds: [0.0; KINDS], elements: 0.0 };
        // A level that costs 1 beyond its capacity, and none before.
        let near = Level { capacity: Some(capacity), ..Level::default() };
        let costs = [
            Transfer { fetch: 1.0, ..Transfer::default() },
            Transfer { fetch_array: 1.0, ..Transfer::default() },
            Transfer { write_back: 1.0, ..Transfer::default() },
            Transfer { first: 1.0, ..Transfer::default() },
            Transfer { line: 1.0, ..Transfer::default() },
        ];
        let levels = costs.map(|passes| [near.clone(), Level { passes, ..Level::default() }]);
        for Waiting { times, n, touched } in &self.passes {
            let wait = |levels: &[Level; 2]| self.around.wait(levels, touched, *n, |level| level.passes);
            let own = levels.each_ref().map(wait);
            beyond.elements += times * n * own[0].far;
            beyond.kinds.iter_mut().zip(own).for_each(|(kind, own)| *kind += times * own.sum());
        }
        beyond
    }

    /// What is paid for: no level is cheaper than a nearer one, so every level adds to those before it.
    pub(super) fn point(&self, beyond: [Beyond; BEYOND]) -> Point {
        let mut features = [0.0; UNKNOWN];
        features[0] = beyond[0].elements;
        for (level, beyond) in beyond.iter().enumerate() {
            for (kind, paid) in beyond.kinds.iter().enumerate() {
                features[1 + kind * BEYOND + level] = *paid;
            }
        }
        let Charged { computing, start, ns, weight, .. } = *self;
        Point { computing, start, ns, weight, features }
    }
}

/// The same where the levels have certain capacities.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    pub(super) computing: f64,
    pub(super) start: f64,
    pub(super) ns: f64,
    pub(super) weight: f64,
    pub(super) features: Costs,
}

impl Point {
    /// Nanoseconds of computing, and of waiting for streams and for lines, by the costs of passes.
    pub(super) fn parts_of_passes(&self, costs: &Costs) -> [f64; 3] {
        [self.computing, product(&self.features, costs), 0.0]
    }

    /// The same by the costs of loops.
    pub(super) fn parts_of_loops(&self, costs: &Costs) -> [f64; 3] {
        let lines = product(&self.features[LINES..], &costs[LINES..]);
        [self.computing, streamed(&self.features, costs), lines]
    }

    /// Nanoseconds by some costs: of passes, which wait before they compute.
    pub(super) fn waiting(&self, costs: &Costs) -> f64 {
        in_turns(self.start, self.parts_of_passes(costs))
    }

    /// The same of loops, which wait while they compute.
    pub(super) fn overlapping(&self, costs: &Costs, overlap: f64) -> f64 {
        self.start + overlapped(overlap, self.parts_of_loops(costs))
    }

    /// How far off some nanoseconds are, as the logarithm of a ratio.
    pub(super) fn deviation(&self, ns: f64) -> f64 {
        (ns / self.ns).ln().abs()
    }

    /// How much it counts by its share in what it took, where it is so far off: what is far from the fit weighs less, so that
    /// a disturbed sample has little weight.
    pub(super) fn scale(&self, far: f64) -> f64 {
        (self.weight * 0.05 / (0.05 + far)).sqrt() / self.ns
    }
}

/// Nanoseconds of one thing after the other.
fn in_turns(start: f64, parts: [f64; 3]) -> f64 {
    start + parts.iter().sum::<f64>()
}

fn product(features: &[f64], costs: &[f64]) -> f64 {
    features.iter().zip(costs).map(|(feature, cost)| feature * cost).sum()
}

pub(super) fn streamed(features: &Costs, costs: &Costs) -> f64 {
    product(&features[1..LINES], &costs[1..LINES])
}
