//! Passes of the interpreter: what each kind takes in the first-level cache, and how long it takes beyond.

use super::fit::{self, median};
use super::point::{Charged, Waiting};
use crate::laboratory::lattice_md::study::samples::{PARTS, Samples};
use crate::model::host::{Change, LaneCosts, PassCost, Surroundings, touches};
use stripmine_kernels::backend::tape::{Outline, Outlines, register_shape};
use stripmine_kernels::drills::{Drilled, Kind, LONGEST, ROUNDS};
use stripmine_kernels::isa::{Memory, ProgramError};
use stripmine_kernels::{Execution, InstructionSet, Runnable};

/// Shortest vectors: what is left of hardware registers goes element by element.
pub(super) const SHORTEST_VECTOR: usize = 8;
/// Vectors that stay in the first-level cache, in hardware registers.
const SHORT: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Elements of the longest of these, for registers of any width.
pub(super) const NEAR: usize = 32 * 64;
/// Vectors that do not.
const LONG: [usize; 8] = [520, 1600, 5200, 17_000, 52_000, 170_000, 540_000, LONGEST];
/// Longest vectors that both precisions are drilled on: beyond, bytes are bytes.
const BOTH: usize = 300_000;
/// Passes of the mixtures.
const MIXED: [usize; 4] = [40, 300, 1500, 4000];
/// Vectors of the mixtures.
const MIXED_LENGTHS: [usize; 2] = [16, 64];
/// Least nanoseconds of a sample.
const SHORTEST: f64 = 60_000.0;

/// How much a drilled pass counts beside a whole program where levels are fitted: programs are what will be predicted, where
/// passes of many kinds wait in turns.
const DRILLED: f64 = 0.2;

/// A kind over vectors of `n` elements: long and short drill.
struct Point {
    kind: usize,
    n: usize,
    samples: [Samples; 2],
}

impl Point {
    /// Nanoseconds of one pass, by a quantile of the samples.
    fn each(&self, of: impl Fn(&Samples) -> f64) -> f64 {
        ((of(&self.samples[0]) - of(&self.samples[1])) / (ROUNDS[0] - ROUNDS[1]) as f64).max(1e-3)
    }

    /// Whether the long drill took as much more than the short one as it must at least, and the halves of the measurement
    /// agree: of the longest vectors there are few samples, and all of them may have been disturbed.
    fn is_settled(&self) -> bool {
        let longer = self.samples[0].middle() > 1.15 * self.samples[1].middle();
        longer && self.samples.iter().all(|samples| samples.disagreement() < 0.25)
    }
}

/// Vectors of this length take part in every n-th sweep only: the longest would take most of the time.
fn turn(n: usize) -> usize {
    match n {
        0..=40_000 => 1,
        40_001..=150_000 => 2,
        150_001..=600_000 => 4,
        _ => 16,
    }
}

/// Everything measured on lanes of one precision.
pub(super) struct Lane {
    pub(super) name: &'static str,
    programs: Vec<[Box<dyn Runnable>; 2]>,
    points: Vec<Point>,
    mixtures: Vec<Box<dyn Runnable>>,
    mixed: Vec<(usize, usize, Samples)>,
    pub(super) costs: LaneCosts,
}

impl Lane {
    /// Nothing measured yet; conversions are from and to `O`.
    pub(super) fn new<L: Drilled>(set: InstructionSet) -> Result<Lane, ProgramError> {
        let (register_bytes, lanes) = register_shape::<L>(set)?;
        let mut points = vec![];
        for (at, kind) in Kind::ALL.iter().enumerate() {
            let wide = L::BYTES == 8;
            let long = LONG.iter().filter(|&&n| kind.moves() && (wide || n <= BOTH));
            let lengths = SHORT.map(|registers| registers * lanes).into_iter().chain(long.copied());
            points.extend(lengths.map(|n| Point { kind: at, n, samples: Default::default() }));
        }
        let lengths = (0..MIXED.len()).flat_map(|at| MIXED_LENGTHS.map(|n| (at, n, Samples::default())));
        Ok(Lane {
            name: L::NAME,
            programs: Kind::ALL.iter().map(|&kind| L::drill(kind)).collect(),
            points,
            mixtures: MIXED.map(L::mixture).into_iter().collect(),
            mixed: lengths.collect(),
            costs: LaneCosts { register_bytes, lanes, ..LaneCosts::default() },
        })
    }

    /// The sweep of this number: one more sample of every point, of long vectors only in some sweeps. `near` has room for
    /// the short ones, `far` for all.
    pub(super) fn sweep(&mut self, [near, far]: [&Memory<'_>; 2], set: InstructionSet, number: usize) {
        let run = |program: &dyn Runnable, n: usize| {
            let memory = if n <= NEAR { near } else { far };
            let outcome = program.run(memory, 0..n, Execution::Eager, set);
            debug_assert!(outcome.is_ok(), "{outcome:?}");
        };
        let takes_turn = |point: &&mut Point| number.is_multiple_of(turn(point.n));
        for point in self.points.iter_mut().filter(takes_turn) {
            for (samples, program) in point.samples.iter_mut().zip(&self.programs[point.kind]) {
                samples.take(SHORTEST, || run(program.as_ref(), point.n));
            }
        }
        for (at, n, samples) in &mut self.mixed {
            samples.take(SHORTEST, || run(self.mixtures[*at].as_ref(), *n));
        }
    }

    /// All samples.
    pub(super) fn samples(&self) -> impl Iterator<Item = &Samples> {
        let mixed = self.mixed.iter().map(|(_, _, samples)| samples);
        self.points.iter().flat_map(|point| &point.samples).chain(mixed)
    }

    fn is_short(&self, point: &Point) -> bool {
        point.n <= SHORT[SHORT.len() - 1] * self.costs.lanes
    }

    fn short_line(&self, kind: usize, of: impl Fn(&Samples) -> f64) -> PassCost {
        let points = self.points.iter().filter(|point| point.kind == kind && self.is_short(point));
        fit::line(&points.map(|point| (point.n as f64, point.each(&of))).collect::<Vec<_>>())
    }

    /// Start and slope of every kind, and what a change of kind costs.
    pub(super) fn fit(&mut self) {
        for (at, kind) in Kind::ALL.iter().enumerate() {
            let mut cost = self.short_line(at, Samples::middle);
            let parts: [PassCost; PARTS] =
                std::array::from_fn(|part| self.short_line(at, |samples| samples.of_part(part)));
            cost.element.interval += fit::half_interval(parts.map(|part| part.element.value));
            cost.start.interval += fit::half_interval(parts.map(|part| part.start.value));
            self.costs.passes.insert(kind.name(), cost);
        }
        // A load is drilled with a store.
        let store = self.costs.passes.get("st").copied().unwrap_or_default();
        if let Some(load) = self.costs.passes.get_mut("ld") {
            load.element = load.element.less(store.element);
            load.start = load.start.less(store.start);
        }
        let shifted = self.costs.passes.remove(&Kind::Shifted.name()).unwrap_or_default();
        let plain = self.costs.passes.get("sub").copied().unwrap_or_default();
        self.costs.array_operand = (shifted.element.value - plain.element.value).max(0.0);
        self.costs.change = MIXED.iter().enumerate().map(|(at, &passes)| self.change(at, passes)).collect();
    }

    /// What the passes of a program take in the first-level cache.
    fn in_cache(&self, program: &dyn Runnable, n: usize) -> f64 {
        let cost = |pass: &Outline| {
            self.costs.cost(pass).map_or(0.0, |cost| cost.start.value + n as f64 * cost.element.value)
        };
        program.outlines().passes.iter().map(cost).sum()
    }

    fn change(&self, at: usize, passes: usize) -> Change {
        let of_mixture = self.mixed.iter().filter(|(mixture, ..)| *mixture == at);
        let each = of_mixture.map(|(_, n, samples)| {
            (samples.middle() - self.in_cache(self.mixtures[at].as_ref(), *n)) / passes as f64
        });
        Change { passes, ns: median(each).max(0.0) }
    }

    /// Nanoseconds of a run in addition to its passes.
    pub(super) fn run(&self) -> f64 {
        let shortest = self.points.iter().filter(|point| point.n == SHORT[0] * self.costs.lanes);
        median(shortest.map(|point| {
            point.samples[1].middle() - self.in_cache(self.programs[point.kind][1].as_ref(), point.n)
        }))
        .max(0.0)
    }

    /// The passes that move vectors and lines, over vectors beyond the first-level cache.
    /// A pass among others takes `begin` times as long to begin as in a drill.
    pub(super) fn long_passes(&self, begin: f64) -> impl Iterator<Item = Charged> {
        let points = self.points.iter().filter(|point| Kind::ALL[point.kind].moves());
        points.filter(|point| !self.is_short(point) && point.is_settled()).filter_map(move |point| {
            let outlines = self.programs[point.kind][0].outlines();
            let kind = match Kind::ALL[point.kind] {
                Kind::Shifted => "sub".to_owned(),
                kind => kind.name(),
            };
            let alike: Vec<usize> =
                (0..outlines.passes.len()).filter(|&at| outlines.passes[at].kind() == kind).collect();
            // The rounds are alike once every vector has been touched: one in the middle stands for all.
            let middle = *alike.get(alike.len() / 2)?;
            let touched = touches(&outlines, self.costs.register_bytes).swap_remove(middle);
            let cost = self.costs.cost(&outlines.passes[middle]).ok()?;
            let around = Surroundings::of_cycle(&[(&outlines, point.n)], Execution::Eager, 0.0).pop()?;
            let n = point.n as f64;
            Some(Charged {
                computing: n * cost.element.value,
                start: begin * cost.start.value,
                passes: vec![Waiting { times: 1.0, n, touched }],
                around,
                ns: point.each(Samples::middle),
                weight: DRILLED,
            })
        })
    }

    /// A program over vectors of `n` elements, in strips, as the levels see it.
    pub(super) fn charged(
        &self,
        outlines: &Outlines,
        (n, strip): (usize, usize),
        begin: f64,
        around: Surroundings,
        ns: f64,
    ) -> Option<Charged> {
        let all = touches(outlines, self.costs.register_bytes);
        let mut charged =
            Charged { computing: 0.0, start: self.run(), passes: vec![], around, ns, weight: 1.0 };
        for (strips, length) in [(n / strip, strip), (1, n % strip)] {
            if strips == 0 || length == 0 {
                continue;
            }
            charged.computing += strips as f64 * self.costs.near(outlines, length, begin).ok()?;
            let waiting = |touched: &Vec<_>| Waiting {
                times: strips as f64,
                n: length as f64,
                touched: touched.clone(),
            };
            charged.passes.extend(all.iter().map(waiting));
        }
        Some(charged)
    }

    /// How many times as long as in drills of nothing but themselves the passes of a program take to begin that took `start`
    /// to begin together; none where one of them was not drilled.
    pub(super) fn begin(&self, outlines: &Outlines, start: f64) -> Option<f64> {
        let change = self.costs.change(outlines.passes.len());
        let drilled =
            outlines.passes.iter().map(|pass| Some(change + self.costs.cost(pass).ok()?.start.value));
        Some(start / drilled.sum::<Option<f64>>()?)
    }
}
