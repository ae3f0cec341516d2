//! What waiting for the levels of memory adds: fitted to passes over long vectors, and to whole programs of drill scenes as
//! the interpreter and as compiled loops run them.

use super::fit::{self, median};
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

/// The levels that suit best.
pub(super) struct Levels {
    /// Nanoseconds an element of a pass with operands from beyond the first level, e0.
    pub(super) operand: f64,
    pub(super) levels: Vec<Level>,
    /// Of the shorter of computing and waiting in a loop, the share that hides behind the longer.
    pub(super) overlap: f64,
    /// Median deviation of the fit to passes.
    pub(super) residual: f64,
}

/// Levels beyond the first.
const BEYOND: usize = 3;
/// What is fitted: e0; what each level beyond the first adds to a byte fetched, to one of an array from before, to a byte
/// that must go back, and to a line that an index vector leads to unforeseen.
const UNKNOWN: usize = 4 * BEYOND + 1;
/// Where the arrays begin.
const ARRAYS: usize = 1 + BEYOND;
/// Where what goes back begins.
const BACK: usize = 1 + 2 * BEYOND;
/// Where the lines begin.
const LINES: usize = 1 + 3 * BEYOND;
type Costs = [f64; UNKNOWN];

impl Charged {
    /// What is paid for: no level is cheaper than a nearer one, so every level adds to those before it.
    fn features(&self, capacities: [f64; BEYOND]) -> Costs {
        let mut features = [0.0; UNKNOWN];
        for Waiting { times, n, touched } in &self.passes {
            for (level, capacity) in capacities.into_iter().enumerate() {
                // A level that costs 1 beyond its capacity, and none before.
                let near = Level { capacity: Some(capacity), ..Level::default() };
                let wait = |passes: Transfer| {
                    let levels = [near.clone(), Level { passes, ..Level::default() }];
                    self.around.wait(&levels, touched, *n, |level| level.passes)
                };
                let own = [
                    wait(Transfer { fetch: 1.0, ..Transfer::default() }),
                    wait(Transfer { fetch_array: 1.0, ..Transfer::default() }),
                    wait(Transfer { write_back: 1.0, ..Transfer::default() }),
                    wait(Transfer { line: 1.0, ..Transfer::default() }),
                ];
                for (kind, own) in own.into_iter().enumerate() {
                    features[1 + kind * BEYOND + level] += times * own.sum();
                }
                if level == 0 {
                    features[0] += times * n * own[0].far;
                }
            }
        }
        features
    }

    /// Nanoseconds by some costs: of passes, which wait before they compute.
    fn waiting(&self, features: &Costs, costs: &Costs) -> f64 {
        self.start + self.computing + product(features, costs)
    }

    /// The same of loops, where a share of the shorter of computing and waiting for streams hides behind the longer, and
    /// nothing hides lines that nobody foresees.
    fn overlapping(&self, features: &Costs, costs: &Costs, overlap: f64) -> f64 {
        let lines = product(&features[LINES..], &costs[LINES..]);
        self.start + overlapped(overlap, self.computing, streamed(features, costs)) + lines
    }

    /// How far off some nanoseconds are, as the logarithm of a ratio.
    fn deviation(&self, ns: f64) -> f64 {
        (ns / self.ns).ln().abs()
    }

    /// How much it counts by its share in what it took, where it is so far off: what is far from the fit weighs less, so that
    /// a busy moment does not count for more than it is.
    fn scale(&self, far: f64) -> f64 {
        (self.weight * 0.05 / (0.05 + far)).sqrt() / self.ns
    }
}

fn product(features: &[f64], costs: &[f64]) -> f64 {
    features.iter().zip(costs).map(|(feature, cost)| feature * cost).sum()
}

fn streamed(features: &Costs, costs: &Costs) -> f64 {
    product(&features[1..LINES], &costs[1..LINES])
}

/// Capacities of the three cache levels that are tried (bytes): what the system says, or parts of it, for whoever shares
/// the core or the last level takes theirs; where it says nothing, what processors have.
fn candidates() -> Vec<[f64; BEYOND]> {
    const KIB: f64 = 1024.0;
    let known: Vec<f64> = (1..=BEYOND).filter_map(cache_size).collect();
    let mut all = vec![];
    if let [l1, l2, l3] = *known.as_slice() {
        for near in [0.5, 1.0] {
            for middle in [0.5, 1.0] {
                all.extend(SHARES.map(|share| [near * l1, middle * l2, share * l3]));
            }
        }
        return all;
    }
    for l1 in [32.0, 48.0, 64.0, 128.0] {
        for l2 in [256.0, 512.0, 1024.0, 2048.0, 4096.0] {
            all.extend([4.0, 8.0, 16.0, 32.0].map(|l3| [l1 * KIB, l2 * KIB, l3 * KIB * KIB]));
        }
    }
    all
}

/// Parts of the last level that are tried: many cores share it.
const SHARES: [f64; 5] = [0.0625, 0.125, 0.25, 0.5, 1.0];

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

/// Capacities and costs of the levels: those that suit passes and loops best together. Streams are foreseen and hardly tell
/// one level from the next; lines that nothing announces do, and loops wait for these most.
pub(super) fn fit_levels(passes: &[Charged], loops: &[Charged]) -> Levels {
    let mut best: Option<(f64, Levels)> = None;
    for capacities in candidates() {
        let features = |all: &[Charged]| all.iter().map(|each| each.features(capacities)).collect::<Vec<_>>();
        let of_passes = features(passes);
        let mut costs = fit_passes(passes, &of_passes);
        fit_lines(passes, &of_passes, &mut costs);
        let errors =
            || passes.iter().zip(&of_passes).map(|(each, of)| each.deviation(each.waiting(of, &costs)));
        let loops = fit_loops(loops, &features(loops), &costs);
        let error = mean(passes, errors()) + loops.error;
        if best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, levels(capacities, &costs, &loops, median(errors()))));
        }
    }
    best.map(|(_, levels)| levels)
        .unwrap_or_else(|| levels([0.0; BEYOND], &[0.0; UNKNOWN], &Loops::NONE, 0.0))
}

/// The levels of these costs.
fn levels(capacities: [f64; BEYOND], costs: &Costs, loops: &Loops, residual: f64) -> Levels {
    let names = ["first-level cache", "second-level cache", "third-level cache", "memory"];
    let capacities = capacities.into_iter().map(Some).chain([None]);
    let transfer = |costs: &Costs, level: usize| {
        let upto = |steps: usize| costs[steps..steps + level].iter().fold(0.0, |sum, step| sum + step);
        Transfer { fetch: upto(1), fetch_array: upto(ARRAYS), write_back: upto(BACK), line: upto(LINES) }
    };
    let levels = names.into_iter().zip(capacities).enumerate().map(|(at, (name, capacity))| Level {
        name: name.to_owned(),
        capacity,
        passes: transfer(costs, at),
        loops: transfer(&loops.costs, at),
    });
    Levels { operand: costs[0], levels: levels.collect(), overlap: loops.overlap, residual }
}

/// The mean of some deviations, each counted for as much as what it is of.
fn mean(of: &[Charged], deviations: impl Iterator<Item = f64>) -> f64 {
    let finite: Vec<(f64, f64)> = of
        .iter()
        .map(|each| each.weight)
        .zip(deviations)
        .filter(|(_, deviation)| deviation.is_finite())
        .collect();
    let weights: f64 = finite.iter().map(|(weight, _)| weight).sum();
    finite.iter().map(|(weight, deviation)| weight * deviation).sum::<f64>() / weights.max(f64::MIN_POSITIVE)
}

/// Rounds in which what is far from the fit weighs less and less.
const ROUNDS: usize = 6;

/// The costs of passes that suit best, everything weighted alike in its relative error.
fn fit_passes(charged: &[Charged], features: &[Costs]) -> Costs {
    let mut costs: Option<Costs> = None;
    for _ in 0..ROUNDS {
        let rows = charged.iter().zip(features).map(|(each, features)| {
            let far = costs.map_or(0.0, |costs| each.deviation(each.waiting(features, &costs)));
            let scale = each.scale(far);
            let rest = (each.ns - each.start - each.computing).max(0.0);
            (features.map(|feature| feature * scale), rest * scale)
        });
        costs = Some(fit::non_negative(&rows.collect::<Vec<_>>()));
    }
    costs.unwrap_or_default()
}

/// What lines cost passes that index vectors lead to, given all else: by what has such vectors alone, and all of that, for
/// among everything it is too little to be heard.
fn fit_lines(charged: &[Charged], features: &[Costs], costs: &mut Costs) {
    costs[LINES..].fill(0.0);
    let rows = charged.iter().zip(features).filter_map(|(each, features)| {
        let own: [f64; BEYOND] = std::array::from_fn(|level| features[LINES + level] / each.ns);
        let rest = || (each.ns - each.waiting(features, costs)) / each.ns;
        own.iter().any(|&own| own > 0.0).then(|| (own, rest()))
    });
    let lines: [f64; BEYOND] = fit::non_negative(&rows.collect::<Vec<_>>());
    costs[LINES..].copy_from_slice(&lines);
}

/// How loops wait.
struct Loops {
    overlap: f64,
    costs: Costs,
    /// Mean deviation.
    error: f64,
}

/// Shares of the shorter of computing and waiting that may hide behind the longer.
const OVERLAPS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

impl Loops {
    const NONE: Loops = Loops { overlap: 0.5, costs: [0.0; UNKNOWN], error: f64::INFINITY };
}

/// How loops wait: beginning with what passes do, for which of computing and waiting is the shorter must be known first.
fn fit_loops(charged: &[Charged], features: &[Costs], passes: &Costs) -> Loops {
    let fitted = |overlap: f64| {
        let mut costs = *passes;
        for round in 0..ROUNDS {
            let rows = charged.iter().zip(features).map(|(each, features)| {
                let far = each.deviation(each.overlapping(features, &costs, overlap));
                let scale = each.scale(if round == 0 { 0.0 } else { far });
                let (computing, streams) = match each.computing >= streamed(features, &costs) {
                    true => (each.computing, 1.0 - overlap),
                    false => ((1.0 - overlap) * each.computing, 1.0),
                };
                let mut row = features.map(|feature| feature * scale);
                row[0] = 0.0;
                row[1..LINES].iter_mut().for_each(|feature| *feature *= streams);
                (row, (each.ns - each.start - computing).max(0.0) * scale)
            });
            costs = fit::non_negative(&rows.collect::<Vec<_>>());
        }
        let of_all = charged.iter().zip(features);
        let error =
            mean(charged, of_all.map(|(each, of)| each.deviation(each.overlapping(of, &costs, overlap))));
        Loops { overlap, costs, error }
    };
    OVERLAPS.map(fitted).into_iter().min_by(|a, b| a.error.total_cmp(&b.error)).unwrap_or(Loops::NONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::host::{Since, Vector};
    use stripmine_kernels::backend::tape::{File, RegisterName};

    const KIB: f64 = 1024.0;

    /// A pass over a register that was touched so many bytes ago, beside one that is near.
    fn charged(distance: f64, written: bool, wait: f64) -> Charged {
        let n = 1000.0;
        let register = |number, distance, written| Touch {
            vector: Vector::Register(RegisterName { file: File::Number, number }),
            bytes: 8.0,
            since: Since::Here(distance / n),
            written,
            indexed: false,
        };
        let touched = vec![register(0, distance, written), register(1, 64.0, false)];
        let passes = vec![Waiting { times: 3.0, n, touched }];
        let computing = 200.0;
        Charged {
            computing,
            start: 0.0,
            passes,
            around: Surroundings::default(),
            ns: computing + 3.0 * n * 8.0 * wait,
            weight: 1.0,
        }
    }

    #[test]
    fn costs_that_went_in_come_out() {
        let capacities = [32.0 * KIB, 512.0 * KIB, 8192.0 * KIB];
        let all = [
            charged(1.0 * KIB, true, 0.0),
            charged(200.0 * KIB, false, 0.01),
            charged(200.0 * KIB, true, 0.015),
            charged(3000.0 * KIB, false, 0.03),
            charged(3000.0 * KIB, true, 0.045),
            charged(90_000.0 * KIB, false, 0.1),
            charged(90_000.0 * KIB, true, 0.145),
        ];
        let features: Vec<Costs> = all.iter().map(|each| each.features(capacities)).collect();
        let costs = fit_passes(&all, &features);
        for (each, features) in all.iter().zip(&features) {
            assert!(each.deviation(each.waiting(features, &costs)) < 0.02, "{costs:?}");
        }
        assert!(costs.iter().all(|cost| *cost >= 0.0));
    }

    #[test]
    fn streams_and_lines_of_loops_come_out() {
        let capacities = [32.0 * KIB, 512.0 * KIB, 8192.0 * KIB];
        // As passes are, and as loops are: twice the wait, half of the shorter hidden, lines of 4 ns and from memory of 20.
        let [mut passes, mut truth] = [[0.0; UNKNOWN]; 2];
        passes[1..ARRAYS].copy_from_slice(&[0.001, 0.002, 0.01]);
        truth[1..ARRAYS].copy_from_slice(&[0.002, 0.004, 0.02]);
        truth[LINES..].copy_from_slice(&[0.0, 4.0, 16.0]);
        let features = |distance: f64, lines: [f64; BEYOND]| {
            let mut features = charged(distance, false, 0.0).features(capacities);
            features[LINES..].copy_from_slice(&lines);
            features
        };
        let none = [0.0; BEYOND];
        let all = [(200.0, none), (3000.0, none), (90_000.0, none), (3000.0, [900.0, 900.0, 0.0])];
        let lines = [(200.0, [5000.0, 0.0, 0.0]), (90_000.0, [2000.0; BEYOND])];
        // Each with little and with much to compute, or one could not tell what hides behind what.
        let features: Vec<Costs> =
            all.into_iter().chain(lines).flat_map(|(kib, lines)| [features(kib * KIB, lines); 2]).collect();
        let measured = |(features, computing): (&Costs, &f64)| {
            let each = Charged { computing: *computing, ..charged(0.0, false, 0.0) };
            Charged { ns: each.overlapping(features, &truth, 0.5), ..each }
        };
        let charged: Vec<Charged> =
            features.iter().zip([200.0, 2000.0].iter().cycle()).map(measured).collect();
        let found = fit_loops(&charged, &features, &passes);
        assert!(found.overlap == 0.5 && found.error < 1e-6, "{}: {}", found.overlap, found.error);
        assert!(
            found.costs.iter().zip(truth).all(|(found, truth)| (found - truth).abs() < 1e-3 * truth + 1e-6)
        );
    }
}
