//! How long do this host's operations take? Small programs run through the same interpreter and the same compiled code
//! as the method's, timed over vectors of 8 to 4 million elements, and a host model fitted to the times.

mod drills;
mod fit;
mod timing;

use crate::model::host::{
    Estimate, HostModel, LaneCosts, Level, Measured, PassCost, SetUp, Since, beyond, touches,
};
use drills::{Arrays, LONGEST, Pair, ROUNDS, drills};
use std::collections::BTreeMap;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::backend::tape::register_shape;
use stripmine_kernels::isa::{Memory, Op, ProgramError};
use stripmine_kernels::{Execution, InstructionSet, Runnable};
use timing::{Sample, time, timer_resolution};

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Sweeps over all points; between them the machine may calm down.
    pub sweeps: usize,
    /// Repeats of a point in a sweep.
    pub repeats: usize,
}

impl Default for Effort {
    fn default() -> Self {
        Effort { sweeps: 2, repeats: 5 }
    }
}

/// More spread than this and the machine was too busy to be measured.
pub const TOO_NOISY: f64 = 0.15;

/// Vectors that stay in the first-level cache.
const SHORT: [usize; 6] = [8, 16, 32, 64, 128, 256];
/// Vectors that do not.
const LONG: [usize; 13] =
    [512, 1024, 2048, 4096, 8192, 16_384, 32_768, 65_536, 131_072, 262_144, 524_288, 1_300_000, LONGEST];
/// Operations by which the levels are told apart: two and three operands, and stores.
const MOVING: [Op; 3] = [Op::Add, Op::Absolute, Op::Store];
/// Least nanoseconds of a repeat, for short vectors.
const SHORTEST_REPEAT: f64 = 50_000.0;

/// Strips of a run: making registers ready for one long strip would drown what the passes over it take.
const STRIPS: usize = 64;

/// A point of a drill: vectors of `n` elements, passed over strip by strip, or chained code.
struct Point {
    pair: usize,
    n: usize,
    execution: Execution,
    drill: Option<Sample>,
    rest: Option<Sample>,
}

impl Point {
    /// Nanoseconds of one of the drilled passes; none where they drown in the rest.
    fn each(&self) -> Option<f64> {
        let (drill, rest) = (self.drill?.best, self.rest?.best);
        let drowns = self.execution != Execution::Chained && drill < 1.25 * rest;
        if drowns {
            return None;
        }
        Some((self.drill?.best - self.rest?.best).max(0.0) / (ROUNDS * self.strips()) as f64)
    }

    fn strips(&self) -> usize {
        match self.execution {
            Execution::Chained => 1,
            _ => (LONGEST / self.n).clamp(1, STRIPS).min((2_000_000 / self.n).max(1)),
        }
    }
}

/// Everything measured on lanes of one precision.
struct Lane {
    name: &'static str,
    pairs: Vec<Pair>,
    points: Vec<Point>,
    costs: LaneCosts,
    /// Nanoseconds to bind an array.
    bind: f64,
}

/// Measures this host, called `title`, and fits its model. `progress` gets the share that is done.
///
/// # Errors
/// [`ProgramError`] if the processor lacks the instruction set.
pub fn calibrate(
    title: String,
    set: InstructionSet,
    effort: Effort,
    progress: impl Fn(f64),
) -> Result<HostModel, ProgramError> {
    let timer = timer_resolution();
    let f64s = measure::<f64>(set, effort, |share| progress(0.5 * share))?;
    let f32s = measure::<f32>(set, effort, |share| progress(0.5 + 0.5 * share))?;
    let mut lanes = [f64s, f32s];
    let samples = lanes.iter().flat_map(|lane| &lane.points).flat_map(|point| [point.drill, point.rest]);
    let mut spreads: Vec<f64> = samples.flatten().map(|sample| sample.median / sample.best - 1.0).collect();
    spreads.sort_by(f64::total_cmp);
    for lane in &mut lanes {
        lane.fit_operations();
    }
    let (operand, levels, residual) = fit_levels(&lanes);
    let mut model = HostModel {
        format: 1,
        title,
        instruction_set: set.name().to_owned(),
        measured: Measured {
            timer,
            spread: spreads.get(spreads.len() / 2).copied().unwrap_or(0.0),
            shortest: SHORT[0],
            longest: LONGEST,
            residual,
        },
        operand,
        bind: lanes.iter().map(|lane| lane.bind).fold(f64::INFINITY, f64::min),
        chained_run: 0.0,
        chained_overlap: 0.0,
        levels,
        set_up: vec![],
        lanes: lanes.iter().map(|lane| (lane.name.to_owned(), lane.costs.clone())).collect(),
    };
    model.set_up = set_up(&lanes[0], &model);
    let runs = lanes.iter().flat_map(Lane::chained_starts);
    model.chained_run = runs.clone().sum::<f64>() / runs.count().max(1) as f64;
    Ok(model)
}

fn measure<L: Precision>(
    set: InstructionSet,
    effort: Effort,
    progress: impl Fn(f64),
) -> Result<Lane, ProgramError> {
    let pairs = drills::<L>();
    let mut points = vec![];
    for (pair, Pair { op, .. }) in pairs.iter().enumerate() {
        let long = LONG.iter().filter(|_| MOVING.contains(op));
        let strips = SHORT.iter().chain(long).map(|&n| (n, Execution::Strip(n)));
        // What making registers ready takes is seen best where little else is done.
        let eager = SHORT.iter().chain(&LONG).filter(|_| *op == Op::Add).map(|&n| (n, Execution::Eager));
        // Stores again and again to the same place, and magnitudes of magnitudes, are left out by a compiler.
        let chained = [256, 1024].into_iter().filter(|_| !matches!(op, Op::Store | Op::Absolute | Op::Count));
        points.extend(
            strips.chain(eager).chain(chained.map(|n| (n, Execution::Chained))).map(|(n, execution)| Point {
                pair,
                n,
                execution,
                drill: None,
                rest: None,
            }),
        );
    }
    let mut arrays = Arrays::<L>::new(LONGEST);
    let all = effort.sweeps * points.len();
    let bind = time(effort.repeats, SHORTEST_REPEAT, || drop(std::hint::black_box(arrays.memory()))).best;
    let bind = bind / arrays.count() as f64;
    let memory = arrays.memory();
    for sweep in 0..effort.sweeps {
        for (at, point) in points.iter_mut().enumerate() {
            let Point { n, execution, .. } = *point;
            let elements = n * if execution == Execution::Eager { 1 } else { point.strips() };
            let repeats = if n > 100_000 { effort.repeats.min(2) } else { effort.repeats };
            let sample = |program: &dyn Runnable| -> Result<Sample, ProgramError> {
                program.run(&memory, 0..elements, execution, set)?;
                Ok(time(repeats, SHORTEST_REPEAT, || run(program, &memory, elements, execution, set)))
            };
            let better = |old: Option<Sample>, new: Sample| Some(old.map_or(new, |old| old.better(new)));
            point.drill = better(point.drill, sample(pairs[point.pair].drill.as_ref())?);
            point.rest = better(point.rest, sample(pairs[point.pair].rest.as_ref())?);
            progress((sweep * all / effort.sweeps + at + 1) as f64 / all as f64);
        }
    }
    let (register_bytes, hardware) = register_shape::<L>(set)?;
    let costs = LaneCosts { register_bytes, lanes: hardware, ..LaneCosts::default() };
    Ok(Lane { name: L::NAME, pairs, points, costs, bind })
}

/// One run of a program that has run before on the same memory.
fn run(program: &dyn Runnable, memory: &Memory<'_>, n: usize, execution: Execution, set: InstructionSet) {
    let outcome = program.run(memory, 0..n, execution, set);
    debug_assert!(outcome.is_ok(), "{outcome:?}");
}

impl Lane {
    fn of(&self, op: Op, execution: Execution) -> impl Iterator<Item = &Point> {
        self.points
            .iter()
            .filter(move |point| self.pairs[point.pair].op == op && point.execution == execution)
    }

    /// The points of an operation in strips.
    fn in_strips(&self, op: Op) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(move |point| {
            self.pairs[point.pair].op == op && point.execution == Execution::Strip(point.n)
        })
    }

    /// Start and slope of every operation, in passes and chained.
    fn fit_operations(&mut self) {
        let ops: Vec<Op> = self.pairs.iter().map(|pair| pair.op).collect();
        let count = self.short_line(Op::Count);
        for op in ops {
            let mut cost = self.short_line(op);
            match op {
                // Drilled together with a count, and with a conversion to indices that is as long.
                Op::LessThan => cost = minus(cost, count),
                Op::FromIndex => cost = times(cost, 0.5),
                _ => {}
            }
            self.costs.passes.insert(op.mnemonic().to_owned(), cost);
            let slope = self.chained_slope(op).map(|ns| if op == Op::FromIndex { 0.5 * ns } else { ns });
            if let Some(ns) = slope {
                let interval = self.chained_interval(op);
                self.costs.chained.insert(op.mnemonic().to_owned(), Estimate { value: ns, interval });
            }
        }
        // What a compiler would leave out of a drill is as long as what it resembles.
        for (like, op) in [(Op::Select, Op::Absolute), (Op::Select, Op::Count), (Op::Add, Op::Store)] {
            if let Some(&cost) = self.costs.chained.get(like.mnemonic()) {
                self.costs.chained.insert(op.mnemonic().to_owned(), cost);
            }
        }
    }

    fn short_line(&self, op: Op) -> PassCost {
        let points = self.in_strips(op).filter(|point| SHORT.contains(&point.n));
        let points = points.filter_map(|point| Some((point.n as f64, point.each()?.max(1e-3))));
        fit::line(&points.collect::<Vec<_>>())
    }

    /// Nanoseconds an element that an operation adds to chained code.
    fn chained_slope(&self, op: Op) -> Option<f64> {
        let slopes = self.of(op, Execution::Chained).filter_map(|point| Some(point.each()? / point.n as f64));
        slopes.reduce(f64::min)
    }

    fn chained_interval(&self, op: Op) -> f64 {
        let slopes: Vec<f64> = self
            .of(op, Execution::Chained)
            .filter_map(|point| Some(point.each()? / point.n as f64))
            .collect();
        let [low, high] =
            [slopes.iter().copied().fold(f64::MAX, f64::min), slopes.iter().copied().fold(0.0, f64::max)];
        high - low
    }

    /// What runs of chained code take besides their elements, from each drill's beginning and end.
    fn chained_starts(&self) -> impl Iterator<Item = f64> + Clone {
        self.pairs.iter().filter_map(|pair| {
            let mut rests = self
                .of(pair.op, Execution::Chained)
                .filter_map(|point| Some((point.n as f64, point.rest?.best)));
            let (short, long) = (rests.next()?, rests.next()?);
            let slope = (long.1 - short.1) / (long.0 - short.0);
            Some((short.1 - slope * short.0).max(0.0))
        })
    }
}

fn minus(a: PassCost, b: PassCost) -> PassCost {
    let difference = |a: Estimate, b: Estimate| Estimate {
        value: (a.value - b.value).max(0.0),
        interval: a.interval.hypot(b.interval),
    };
    PassCost { element: difference(a.element, b.element), start: difference(a.start, b.start) }
}

fn times(a: PassCost, factor: f64) -> PassCost {
    let scaled = |a: Estimate| Estimate { value: factor * a.value, interval: factor * a.interval };
    PassCost { element: scaled(a.element), start: scaled(a.start) }
}

/// A measured pass, as the levels see it.
struct LongPass {
    n: f64,
    cost: PassCost,
    /// Bytes an element and reuse distance of each vector it touches.
    touched: Vec<(f64, f64)>,
    ns: f64,
}

impl LongPass {
    /// What is paid for: the element itself, every byte in the nearest level, and every byte again at each level beyond,
    /// for no level is cheaper than a nearer one.
    fn features(&self, capacities: [f64; 3]) -> [f64; 5] {
        let mut features = [1.0, 0.0, 0.0, 0.0, 0.0];
        for &(bytes, distance) in &self.touched {
            features[1] += bytes;
            for (level, capacity) in capacities.into_iter().enumerate() {
                features[level + 2] += bytes * beyond(distance, capacity);
            }
        }
        features
    }

    fn predicted(&self, capacities: [f64; 3], costs: &[f64; 5]) -> f64 {
        let memory: f64 = self.features(capacities).iter().zip(costs).map(|(f, c)| f * c).sum();
        self.cost.start.value + self.n * self.cost.element.value.max(memory)
    }
}

/// Capacities and costs of the levels, and the mean deviation of the passes they were fitted to.
fn fit_levels(lanes: &[Lane]) -> (f64, Vec<Level>, f64) {
    let mut passes = vec![];
    for lane in lanes {
        for op in MOVING {
            for point in lane.in_strips(op) {
                let Some(ns) = point.each() else { continue };
                let outlines = lane.pairs[point.pair].drill.outlines();
                let touched = touches(&outlines, lane.costs.register_bytes);
                // The rounds are alike once every vector has been touched: one in the middle stands for all.
                let middle =
                    outlines.passes.iter().rposition(|pass| pass.op == op).map_or(0, |at| at - ROUNDS / 4);
                let middle = outlines.passes[..=middle].iter().rposition(|pass| pass.op == op).unwrap_or(0);
                let far = LONGEST as f64 * 8.0;
                let touched = touched[middle].iter().map(|touch| match touch.since {
                    Since::Here(distance) => (touch.bytes, distance * point.n as f64),
                    Since::Before => (touch.bytes, far),
                });
                let cost = lane.costs.passes.get(op.mnemonic()).copied().unwrap_or_default();
                passes.push(LongPass { n: point.n as f64, cost, touched: touched.collect(), ns });
            }
        }
    }
    let mut best: Option<(f64, [f64; 3], [f64; 5])> = None;
    const KIB: f64 = 1024.0;
    for l1 in [24.0, 32.0, 48.0, 64.0] {
        for l2 in [256.0, 384.0, 512.0, 768.0, 1024.0, 2048.0] {
            for l3 in [4.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0] {
                let capacities = [l1 * KIB, l2 * KIB, l3 * KIB * KIB];
                let costs = fit_costs(&passes, capacities);
                let error = deviation(&passes, capacities, &costs);
                if best.is_none_or(|(least, ..)| error < least) {
                    best = Some((error, capacities, costs));
                }
            }
        }
    }
    let (error, capacities, [operand, bytes @ ..]) = best.unwrap_or_default();
    let names = ["first-level cache", "second-level cache", "third-level cache", "memory"];
    let capacities = capacities.into_iter().map(Some).chain([None]);
    let mut byte = 0.0;
    let levels = names.into_iter().zip(capacities).zip(bytes).map(|((name, capacity), more)| {
        byte += more;
        Level { name: name.to_owned(), capacity, byte }
    });
    (operand, levels.collect(), error)
}

/// The costs that suit the passes bound by memory, those weighted alike in their relative error.
fn fit_costs(passes: &[LongPass], capacities: [f64; 3]) -> [f64; 5] {
    let bound = passes.iter().filter(|pass| {
        pass.n >= 256.0 && pass.ns > 1.1 * (pass.cost.start.value + pass.n * pass.cost.element.value)
    });
    let rows = bound.map(|pass| {
        let value = (pass.ns - pass.cost.start.value) / pass.n;
        (pass.features(capacities).map(|feature| feature / value), 1.0)
    });
    fit::non_negative(&rows.collect::<Vec<_>>())
}

fn deviation(passes: &[LongPass], capacities: [f64; 3], costs: &[f64; 5]) -> f64 {
    let errors = passes.iter().map(|pass| (pass.predicted(capacities, costs) / pass.ns.max(1e-3)).ln().abs());
    errors.sum::<f64>() / passes.len().max(1) as f64
}

/// What making a register ready takes: what a drill without rounds takes beyond its passes, shared among its registers.
fn set_up(lane: &Lane, model: &HostModel) -> Vec<SetUp> {
    let mut points = BTreeMap::new();
    for point in lane.of(Op::Add, Execution::Eager) {
        let Some(rest) = point.rest else { continue };
        let outlines = lane.pairs[point.pair].rest.outlines();
        let touched = touches(&outlines, lane.costs.register_bytes);
        let arrays = 4.0 * 8.0 * point.n as f64;
        let passes: f64 = outlines
            .passes
            .iter()
            .zip(&touched)
            .filter_map(|(pass, touched)| model.pass(&lane.costs, pass.op, touched, point.n, arrays).ok())
            .sum();
        let registers: usize = outlines.registers.iter().sum();
        let each = (rest.best - passes).max(1.0) / registers.max(1) as f64;
        points.insert(point.n, each);
    }
    points.into_iter().map(|(n, ns)| SetUp { bytes: 8.0 * n as f64, ns }).collect()
}
