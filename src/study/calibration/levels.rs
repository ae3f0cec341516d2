//! What waiting for the levels of memory adds: fitted to passes over long vectors, and to whole programs of drill scenes as
//! the interpreter and as compiled loops run them.

use super::fit::{self, median};
use crate::model::host::{Level, Surroundings, Touch, overlapped};

/// Something measured, as the levels see it.
pub(super) struct Charged {
    /// Nanoseconds it takes in the first-level cache, without the beginnings of its passes.
    pub(super) computing: f64,
    /// Nanoseconds of these beginnings, each as long as in a drill.
    pub(super) starts: f64,
    /// Its passes.
    pub(super) passes: Vec<Waiting>,
    /// What lies around it.
    pub(super) around: Surroundings,
    /// Nanoseconds it took.
    pub(super) ns: f64,
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
    /// How long a pass of a program takes to begin, as a share of what it takes in a drill of nothing but that pass.
    pub(super) begin: f64,
    /// How many times as long as a pass a loop waits for the same bytes.
    pub(super) streams: f64,
    /// Of the shorter of computing and waiting in a loop, the share that hides behind the longer.
    pub(super) overlap: f64,
    /// Median deviation of the fit to passes.
    pub(super) residual: f64,
}

/// Levels beyond the first.
const BEYOND: usize = 3;
/// What is fitted: e0; what each level beyond the first adds to a byte fetched, to one of an array from before, to a byte
/// that must go back, and to a line that an index vector leads to unforeseen; and the share of a drilled pass's beginning.
const UNKNOWN: usize = 4 * BEYOND + 2;
/// Where the arrays begin.
const ARRAYS: usize = 1 + BEYOND;
/// Where what goes back begins.
const BACK: usize = 1 + 2 * BEYOND;
/// Where the lines begin.
const LINES: usize = 1 + 3 * BEYOND;
/// Where that share is.
const BEGIN: usize = 1 + 4 * BEYOND;
type Costs = [f64; UNKNOWN];

impl Charged {
    /// What is paid for: no level is cheaper than a nearer one, so every level adds to those before it.
    fn features(&self, capacities: [f64; BEYOND]) -> Costs {
        let mut features = [0.0; UNKNOWN];
        features[BEGIN] = self.starts;
        for Waiting { times, n, touched } in &self.passes {
            for (level, capacity) in capacities.into_iter().enumerate() {
                // A level that costs 1 beyond its capacity, and none before.
                let wait = |there: Level| {
                    let levels = [Level { capacity: Some(capacity), ..Level::FREE }, there];
                    times * self.around.wait(&levels, touched, *n, |level| level.line).sum()
                };
                let own = [
                    wait(Level { fetch: 1.0, ..Level::FREE }),
                    wait(Level { fetch_array: 1.0, ..Level::FREE }),
                    wait(Level { write_back: 1.0, ..Level::FREE }),
                    wait(Level { line: 1.0, ..Level::FREE }),
                ];
                for (kind, own) in own.into_iter().enumerate() {
                    features[1 + kind * BEYOND + level] += own;
                }
                // Where everything is near there is nothing to wait for.
                if level == 0 && own.iter().any(|&own| own > 0.0) {
                    features[0] += times * n;
                }
            }
        }
        features
    }

    /// How far off some costs are, as the logarithm of a ratio.
    fn deviation(&self, features: &Costs, costs: &Costs) -> f64 {
        ((self.computing + product(features, costs)) / self.ns).ln().abs()
    }
}

fn product(features: &Costs, costs: &Costs) -> f64 {
    features.iter().zip(costs).map(|(feature, cost)| feature * cost).sum()
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
        let mut costs = fit_costs(passes, &of_passes);
        fit_lines(passes, &of_passes, &mut costs);
        let errors = || passes.iter().zip(&of_passes).map(|(each, of)| each.deviation(of, &costs));
        let loops = fit_loops(loops, &features(loops), &costs);
        let error = mean(errors()) + loops.error;
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
    let upto = |steps: &[f64], level: usize| steps[..level].iter().fold(0.0, |sum, step| sum + step);
    let levels = names.into_iter().zip(capacities).enumerate().map(|(at, (name, capacity))| Level {
        name: name.to_owned(),
        capacity,
        fetch: upto(&costs[1..], at),
        fetch_array: upto(&costs[ARRAYS..], at),
        write_back: upto(&costs[BACK..], at),
        line: upto(&costs[LINES..], at),
        loop_line: upto(&loops.lines, at),
    });
    let Loops { streams, overlap, .. } = *loops;
    Levels { operand: costs[0], levels: levels.collect(), begin: costs[BEGIN], streams, overlap, residual }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let finite: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    finite.iter().sum::<f64>() / finite.len().max(1) as f64
}

/// What lines cost that index vectors lead to, given all else: by what has such vectors alone, and all of that, for among
/// everything it is too little to be heard.
fn fit_lines(charged: &[Charged], features: &[Costs], costs: &mut Costs) {
    costs[LINES..BEGIN].fill(0.0);
    let rest = |each: &Charged, features: &Costs| each.ns - each.computing - product(features, costs);
    let lines = steps_of_lines(charged, features, rest);
    costs[LINES..BEGIN].copy_from_slice(&lines);
}

/// What each level adds to a line, by the time that is left of everything else.
fn steps_of_lines(
    charged: &[Charged],
    features: &[Costs],
    rest: impl Fn(&Charged, &Costs) -> f64,
) -> [f64; BEYOND] {
    let rows = charged.iter().zip(features).filter_map(|(each, features)| {
        let own: [f64; BEYOND] = std::array::from_fn(|level| features[LINES + level] / each.ns);
        own.iter().any(|&own| own > 0.0).then(|| (own, rest(each, features) / each.ns))
    });
    fit::non_negative(&rows.collect::<Vec<_>>())
}

/// How loops wait.
struct Loops {
    streams: f64,
    overlap: f64,
    /// What each level beyond the first adds to a line.
    lines: [f64; BEYOND],
    /// Mean deviation.
    error: f64,
}

/// Shares of the shorter of computing and waiting that may hide behind the longer.
const OVERLAPS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Nanoseconds of a line that would be felt if lines took so long, as a share: loops below go over streams alone.
const FELT: f64 = 0.01;

impl Loops {
    const NONE: Loops = Loops { streams: 1.0, overlap: 0.5, lines: [0.0; BEYOND], error: f64::INFINITY };

    /// Nanoseconds of a loop, its lines left out.
    fn streaming(&self, each: &Charged, features: &Costs, costs: &Costs) -> f64 {
        let streamed: f64 = (1..LINES).map(|at| features[at] * costs[at]).sum();
        each.starts + overlapped(self.overlap, each.computing, self.streams * streamed)
    }

    /// Nanoseconds of all of it.
    fn all(&self, each: &Charged, features: &Costs, costs: &Costs) -> f64 {
        let lines = features[LINES..].iter().zip(self.lines).map(|(feature, line)| feature * line);
        self.streaming(each, features, costs) + lines.sum::<f64>()
    }
}

/// How loops wait, given what passes do: those that hardly meet lines through index vectors say how streams are waited for,
/// and then the others what lines cost.
fn fit_loops(charged: &[Charged], features: &[Costs], costs: &Costs) -> Loops {
    let streams = (-8..=16).map(|quarter| 2_f64.powf(f64::from(quarter) / 4.0));
    let tried = streams
        .flat_map(|streams| OVERLAPS.map(|overlap| Loops { streams, overlap, ..Loops::NONE }))
        .map(|loops| {
            let plain = charged.iter().zip(features).filter(|(each, features)| {
                features[LINES..BEGIN].iter().all(|&lines| lines < FELT * each.ns)
            });
            let error = mean(
                plain.map(|(each, features)| (loops.streaming(each, features, costs) / each.ns).ln().abs()),
            );
            Loops { error, ..loops }
        });
    let mut best = tried.min_by(|a, b| a.error.total_cmp(&b.error)).unwrap_or(Loops::NONE);
    best.lines =
        steps_of_lines(charged, features, |each, features| each.ns - best.streaming(each, features, costs));
    best.error =
        mean(charged.iter().zip(features).map(|(each, of)| (best.all(each, of, costs) / each.ns).ln().abs()));
    best
}

/// The costs that suit best, everything weighted alike in its relative error; some rounds, in which what is far from the fit
/// weighs less and less, so that a busy moment does not count for more than it is.
fn fit_costs(charged: &[Charged], features: &[Costs]) -> Costs {
    let mut costs: Option<Costs> = None;
    for _ in 0..6 {
        let rows = charged.iter().zip(features).map(|(each, features)| {
            let far = costs.map_or(0.0, |costs| each.deviation(features, &costs));
            let scale = (0.05 / (0.05 + far)).sqrt() / each.ns;
            (features.map(|feature| feature * scale), (each.ns - each.computing).max(0.0) * scale)
        });
        costs = Some(fit::non_negative(&rows.collect::<Vec<_>>()));
    }
    costs.unwrap_or_default()
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
            starts: 0.0,
            passes,
            around: Surroundings::default(),
            ns: computing + 3.0 * n * 8.0 * wait,
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
        let costs = fit_costs(&all, &features);
        for (each, features) in all.iter().zip(&features) {
            assert!(each.deviation(features, &costs) < 0.02, "{costs:?}");
        }
        assert!(costs.iter().all(|cost| *cost >= 0.0));
    }

    #[test]
    fn streams_and_lines_of_loops_come_out() {
        let capacities = [32.0 * KIB, 512.0 * KIB, 8192.0 * KIB];
        let mut costs = [0.0; UNKNOWN];
        costs[1..ARRAYS].copy_from_slice(&[0.001, 0.002, 0.01]);
        // As they are: twice the wait of passes, half of the shorter hidden, lines of 4 ns and from memory of 20.
        let truth = Loops { streams: 2.0, overlap: 0.5, lines: [0.0, 4.0, 16.0], error: 0.0 };
        let features = |distance: f64, lines: [f64; BEYOND]| {
            let mut features = charged(distance, false, 0.0).features(capacities);
            features[LINES..BEGIN].copy_from_slice(&lines);
            features
        };
        let none = [0.0; BEYOND];
        let all = [(200.0, none), (3000.0, none), (90_000.0, none), (3000.0, [900.0, 900.0, 0.0])];
        let lines = [(200.0, [5000.0, 0.0, 0.0]), (90_000.0, [2000.0; BEYOND])];
        let features: Vec<Costs> =
            all.into_iter().chain(lines).map(|(kib, lines)| features(kib * KIB, lines)).collect();
        let measured = |features: &Costs| {
            let each = charged(0.0, false, 0.0);
            Charged { ns: truth.all(&each, features, &costs), ..each }
        };
        let charged: Vec<Charged> = features.iter().map(measured).collect();
        let found = fit_loops(&charged, &features, &costs);
        assert!((found.streams, found.overlap) == (2.0, 0.5) && found.error < 1e-6, "{}", found.error);
        assert!((found.lines[1] - 4.0).abs() < 1e-3 && (found.lines[2] - 16.0).abs() < 1e-3);
    }
}
