//! Passes of the interpreter: what each kind takes in the first-level cache, and what waiting for the levels beyond adds.

use super::drills::{GAPS, Kind, LONGEST, LONGEST_SPARSE, ROUNDS, drill, mixture};
use super::fit::{self, median};
use super::timing::{PacedClock, Samples};
use crate::model::host::{
    Change, Estimate, LaneCosts, Level, PassCost, Surroundings, Touch, overlapped, touches,
};
use stripmine_kernels::backend::Precision;
use stripmine_kernels::backend::tape::{Outline, register_shape};
use stripmine_kernels::isa::{Array, Memory, Op, ProgramError};
use stripmine_kernels::{Execution, InstructionSet, Runnable};

/// Vectors that stay in the first-level cache.
pub(super) const SHORT: [usize; 6] = [8, 16, 32, 64, 128, 256];
/// Vectors that do not.
const LONG: [usize; 13] =
    [520, 1080, 2200, 4400, 9000, 17_000, 34_000, 68_000, 130_000, 270_000, 540_000, 1_300_000, LONGEST];
/// Longest vectors that both precisions are drilled on: beyond, bytes are bytes.
const BOTH: usize = 300_000;
/// Passes of the mixtures.
const MIXED: [usize; 4] = [40, 300, 1500, 4000];
/// Vectors of the mixtures.
const MIXED_LENGTHS: [usize; 2] = [16, 64];
/// Least nanoseconds of a sample.
const SHORTEST: f64 = 60_000.0;

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
    /// agree: of the longest vectors there are few samples, and all of them may have met a busy moment.
    fn is_settled(&self) -> bool {
        let longer = self.samples[0].typical() > 1.15 * self.samples[1].typical();
        longer && self.samples.iter().all(|samples| samples.disagreement() < 0.25)
    }
}

/// Of so many sweeps one is over vectors of this length: the longest would take all the time.
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
    pub(super) fn new<L: Precision, O: Precision>(set: InstructionSet) -> Result<Lane, ProgramError> {
        let mut points = vec![];
        for (at, kind) in Kind::ALL.iter().enumerate() {
            let wide = L::BYTES == 8;
            let long = LONG.iter().filter(|&&n| match kind {
                Kind::Sparse(_) => wide && n <= LONGEST_SPARSE,
                kind => Kind::MOVING.contains(kind) && (wide || n <= BOTH),
            });
            let lengths = SHORT.iter().chain(long);
            points.extend(lengths.map(|&n| Point { kind: at, n, samples: Default::default() }));
        }
        let (register_bytes, lanes) = register_shape::<L>(set)?;
        let lengths = (0..MIXED.len()).flat_map(|at| MIXED_LENGTHS.map(|n| (at, n, Samples::default())));
        Ok(Lane {
            name: L::NAME,
            programs: Kind::ALL.iter().map(|&kind| drill::<L, O>(kind)).collect(),
            points,
            mixtures: MIXED.map(mixture::<L, O>).into_iter().collect(),
            mixed: lengths.collect(),
            costs: LaneCosts { register_bytes, lanes, ..LaneCosts::default() },
        })
    }

    /// The sweep of this number: one more sample of every point, of long vectors only in some sweeps.
    pub(super) fn sweep(
        &mut self,
        clock: &mut PacedClock,
        memory: &Memory<'_>,
        set: InstructionSet,
        number: usize,
    ) {
        let run = |program: &dyn Runnable, n: usize| {
            let outcome = program.run(memory, 0..n, Execution::Eager, set);
            debug_assert!(outcome.is_ok(), "{outcome:?}");
        };
        let takes_turn = |point: &&mut Point| number.is_multiple_of(turn(point.n));
        for point in self.points.iter_mut().filter(takes_turn) {
            for (samples, program) in point.samples.iter_mut().zip(&self.programs[point.kind]) {
                samples.take(clock, SHORTEST, || run(program.as_ref(), point.n));
            }
        }
        for (at, n, samples) in &mut self.mixed {
            samples.take(clock, SHORTEST, || run(self.mixtures[*at].as_ref(), *n));
        }
    }

    /// Tells all samples at the pace of a reference.
    pub(super) fn settle(&mut self, reference: f64) {
        let mixed = self.mixed.iter_mut().map(|(_, _, samples)| samples);
        let points = self.points.iter_mut().flat_map(|point| &mut point.samples);
        points.chain(mixed).for_each(|samples| samples.settle(reference));
    }

    /// All samples.
    pub(super) fn samples(&self) -> impl Iterator<Item = &Samples> {
        let mixed = self.mixed.iter().map(|(_, _, samples)| samples);
        self.points.iter().flat_map(|point| &point.samples).chain(mixed)
    }

    fn short_line(&self, kind: usize, of: impl Fn(&Samples) -> f64) -> PassCost {
        let points = self.points.iter().filter(|point| point.kind == kind && SHORT.contains(&point.n));
        fit::line(&points.map(|point| (point.n as f64, point.each(&of))).collect::<Vec<_>>())
    }

    /// Start and slope of every kind, and what a change of kind costs.
    pub(super) fn fit(&mut self) {
        for (at, kind) in Kind::ALL.iter().enumerate() {
            let mut cost = self.short_line(at, Samples::typical);
            let halves = [0, 1].map(|half| self.short_line(at, |samples| samples.of_half(half)));
            let widen = |of: fn(&PassCost) -> f64| (of(&halves[0]) - of(&halves[1])).abs();
            cost.element.interval += widen(|cost| cost.element.value);
            cost.start.interval += widen(|cost| cost.start.value);
            if !matches!(kind, Kind::Sparse(_)) {
                self.costs.passes.insert(kind.name(), cost);
            }
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
            (samples.typical() - self.in_cache(self.mixtures[at].as_ref(), *n)) / passes as f64
        });
        Change { passes, ns: median(each).max(0.0) }
    }

    /// Nanoseconds of a run besides its passes.
    pub(super) fn run(&self) -> f64 {
        let shortest = self.points.iter().filter(|point| point.n == SHORT[0]);
        median(shortest.map(|point| {
            point.samples[1].typical() - self.in_cache(self.programs[point.kind][1].as_ref(), point.n)
        }))
        .max(0.0)
    }

    /// The passes of some kinds over vectors beyond the first-level cache.
    fn long_passes(&self, kinds: &[Kind]) -> impl Iterator<Item = LongPass> {
        let points = self.points.iter().filter(|point| kinds.contains(&Kind::ALL[point.kind]));
        points.filter(|point| !SHORT.contains(&point.n) && point.is_settled()).filter_map(|point| {
            let outlines = self.programs[point.kind][0].outlines();
            let kind = match Kind::ALL[point.kind] {
                Kind::Shifted => "sub".to_owned(),
                Kind::Sparse(_) => Kind::Plain(Op::Gather).name(),
                kind => kind.name(),
            };
            let alike: Vec<usize> =
                (0..outlines.passes.len()).filter(|&at| outlines.passes[at].kind() == kind).collect();
            // The rounds are alike once every vector has been touched: one in the middle stands for all.
            let middle = *alike.get(alike.len() / 2)?;
            let touched = touches(&outlines, self.costs.register_bytes).swap_remove(middle);
            let cost = self.costs.cost(&outlines.passes[middle]).ok()?;
            let mut around = Surroundings::of_cycle(&[(&outlines, point.n)]).pop()?;
            if let Kind::Sparse(gap) = Kind::ALL[point.kind] {
                around.widen(Array::Radius, (GAPS[gap] * point.n) as f64);
            }
            Some(LongPass { n: point.n as f64, cost, touched, around, ns: point.each(Samples::typical) })
        })
    }
}

/// A measured pass, as the levels see it.
struct LongPass {
    n: f64,
    cost: PassCost,
    touched: Vec<Touch>,
    around: Surroundings,
    ns: f64,
}

/// A level that costs nothing.
const NOWHERE: Level = Level { name: String::new(), capacity: None, fetch: 0.0, write_back: 0.0, line: 0.0 };

/// What is fitted: e0, and what each level beyond the first adds to a byte fetched and to a byte that must go back.
const UNKNOWN: usize = 7;

impl LongPass {
    /// What is paid for: no level is cheaper than a nearer one, so every level adds to those before it.
    fn features(&self, capacities: [f64; 3]) -> [f64; UNKNOWN] {
        let mut features = [0.0; UNKNOWN];
        for (level, capacity) in capacities.into_iter().enumerate() {
            // A level that costs 1 a byte beyond its capacity, and none before.
            let step = |fetch, write_back| {
                let level = |capacity, fetch, write_back| Level { capacity, fetch, write_back, ..NOWHERE };
                [level(Some(capacity), 0.0, 0.0), level(None, fetch, write_back)]
            };
            features[1 + 2 * level] = self.around.wait(&step(1.0, 0.0), &self.touched, self.n).sum() / self.n;
            features[2 + 2 * level] = self.around.wait(&step(0.0, 1.0), &self.touched, self.n).sum() / self.n;
        }
        // Where everything is near there is nothing to wait for.
        features[0] = if features[1] > 0.0 { 1.0 } else { 0.0 };
        features
    }
}

/// The levels that suit the long passes best.
pub(super) struct Levels {
    pub(super) operand: f64,
    pub(super) overlap: f64,
    pub(super) levels: Vec<Level>,
    pub(super) residual: f64,
}

/// Shares of the shorter of computing and waiting that may hide behind the longer.
pub(super) const OVERLAPS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Capacities of the three cache levels that are tried (bytes): what the system says, of the last level, which others
/// share, also parts; where it says nothing, what processors have.
fn candidates() -> Vec<[f64; 3]> {
    const KIB: f64 = 1024.0;
    let known: Vec<f64> = (1..=3).filter_map(cache_size).collect();
    if let [l1, l2, l3] = *known.as_slice() {
        return [0.125, 0.25, 0.5, 1.0].map(|share| [l1, l2, share * l3]).to_vec();
    }
    let mut all = vec![];
    for l1 in [32.0, 48.0, 64.0, 128.0] {
        for l2 in [256.0, 512.0, 1024.0, 2048.0, 4096.0] {
            for l3 in [4.0, 8.0, 16.0, 32.0] {
                all.push([l1 * KIB, l2 * KIB, l3 * KIB * KIB]);
            }
        }
    }
    all
}

/// Bytes of this processor's data cache of a level, where the system says it.
fn cache_size(level: usize) -> Option<f64> {
    let read = |index: usize, what: &str| {
        let path = format!("/sys/devices/system/cpu/cpu0/cache/index{index}/{what}");
        Some(std::fs::read_to_string(path).ok()?.trim().to_owned())
    };
    let of_level = |index: &usize| {
        read(*index, "level") == Some(level.to_string())
            && read(*index, "type").as_deref() != Some("Instruction")
    };
    let size = read((0..8).find(of_level)?, "size")?;
    let kib: f64 = size.strip_suffix('K')?.parse().ok()?;
    Some(1024.0 * kib)
}

/// Capacities and costs of the levels, and how much of the waiting hides behind computing.
pub(super) fn fit_levels(lanes: &[Lane]) -> Levels {
    let passes: Vec<LongPass> = lanes.iter().flat_map(|lane| lane.long_passes(&Kind::MOVING)).collect();
    let mut best: Option<(f64, [f64; 3], f64, [f64; UNKNOWN])> = None;
    for capacities in candidates() {
        let features: Vec<[f64; UNKNOWN]> = passes.iter().map(|pass| pass.features(capacities)).collect();
        for overlap in OVERLAPS {
            let costs = fit_costs(&passes, &features, overlap);
            let error = deviation(&passes, &features, overlap, &costs);
            if best.is_none_or(|(least, ..)| error < least) {
                best = Some((error, capacities, overlap, costs));
            }
        }
    }
    let (residual, capacities, overlap, [operand, bytes @ ..]) = best.unwrap_or_default();
    let names = ["first-level cache", "second-level cache", "third-level cache", "memory"];
    let capacities = capacities.into_iter().map(Some).chain([None]);
    let [mut fetch, mut write_back] = [0.0; 2];
    let levels = names.into_iter().zip(capacities).enumerate().map(|(at, (name, capacity))| {
        if at > 0 {
            fetch += bytes[2 * at - 2];
            write_back += bytes[2 * at - 1];
        }
        Level { name: name.to_owned(), capacity, fetch, write_back, line: 0.0 }
    });
    let mut levels = Levels { operand, overlap, levels: levels.collect(), residual };
    let kinds: [Kind; GAPS.len()] = std::array::from_fn(Kind::Sparse);
    let sparse: Vec<LongPass> = lanes.iter().flat_map(|lane| lane.long_passes(&kinds)).collect();
    levels.fit_lines(&sparse);
    levels
}

impl Levels {
    /// What a line costs that is met through an index vector, from each level, given what all else costs.
    fn fit_lines(&mut self, passes: &[LongPass]) {
        let capacities: Vec<f64> = self.levels.iter().filter_map(|level| level.capacity).collect();
        let rows = passes.iter().map(|pass| {
            let lines = |capacity: f64| {
                let level = |capacity, line| Level { capacity, line, ..NOWHERE };
                let step = [level(Some(capacity), 0.0), level(None, 1.0)];
                pass.around.wait(&step, &pass.touched, pass.n).indexed / pass.ns
            };
            let features: [f64; 3] =
                std::array::from_fn(|at| capacities.get(at).map_or(0.0, |&capacity| lines(capacity)));
            let streams = pass.around.wait(&self.levels, &pass.touched, pass.n).sum();
            let compute = pass.cost.start.value + pass.n * pass.cost.element.value;
            let rest = (1.0 - self.overlap) * compute + streams;
            // Where computing is the longer, waiting shows by what does not hide.
            (features, ((pass.ns - rest) / pass.ns).max(0.0))
        });
        let lines = fit::non_negative(&rows.collect::<Vec<_>>());
        let mut line = 0.0;
        for (level, more) in self.levels.iter_mut().skip(1).zip(lines) {
            line += more;
            level.line = line;
        }
    }
}

fn waits(features: &[f64; UNKNOWN], costs: &[f64; UNKNOWN]) -> f64 {
    features.iter().zip(costs).map(|(feature, cost)| feature * cost).sum()
}

/// The costs that suit the passes, weighted alike in their relative error; some rounds, in which points far from the fit
/// weigh less and less, so that a busy moment does not count for more than it is.
fn fit_costs(passes: &[LongPass], features: &[[f64; UNKNOWN]], overlap: f64) -> [f64; UNKNOWN] {
    let mut costs: Option<[f64; UNKNOWN]> = None;
    for _ in 0..6 {
        let rows = passes.iter().zip(features).filter_map(|(pass, features)| {
            let value = (pass.ns - pass.cost.start.value) / pass.n;
            let compute = pass.cost.element.value;
            // Which of computing and waiting is the longer shows in what both take together.
            let waits_longer = value > (2.0 - overlap) * compute;
            let (weight, rest) = if waits_longer {
                (1.0, value - (1.0 - overlap) * compute)
            } else {
                (1.0 - overlap, (value - compute).max(0.0))
            };
            let far = costs.map_or(0.0, |costs| {
                (overlapped(overlap, compute, waits(features, &costs)) / value - 1.0).abs()
            });
            let scale = (0.05 / (0.05 + far)).sqrt() * pass.n / pass.ns;
            (weight > 0.0 && features[1] > 0.0)
                .then(|| (features.map(|feature| weight * feature * scale), rest * scale))
        });
        costs = Some(fit::non_negative(&rows.collect::<Vec<_>>()));
    }
    costs.unwrap_or_default()
}

fn deviation(passes: &[LongPass], features: &[[f64; UNKNOWN]], overlap: f64, costs: &[f64; UNKNOWN]) -> f64 {
    let errors = passes.iter().zip(features).map(|(pass, features)| {
        let each = overlapped(overlap, pass.cost.element.value, waits(features, costs));
        ((pass.cost.start.value + pass.n * each) / pass.ns).ln().abs()
    });
    median(errors)
}

/// A number with the difference of two halves as its interval.
pub(super) fn estimate(of: impl Fn(&dyn Fn(&Samples) -> f64) -> f64) -> Estimate {
    let value = of(&Samples::typical);
    let halves = [0, 1].map(|half| of(&|samples: &Samples| samples.of_half(half)));
    Estimate { value, interval: (halves[0] - halves[1]).abs() + 0.01 * value }
}
