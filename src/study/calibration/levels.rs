//! What waiting for the levels of memory adds: fitted to passes over long vectors and to whole programs of drill scenes.

use super::fit::{self, median};
use crate::model::host::{LINE, Level, Surroundings, Touch};

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
    /// Median deviation of the fit.
    pub(super) residual: f64,
}

/// A level that costs nothing.
const NOWHERE: Level = Level { name: String::new(), capacity: None, fetch: 0.0, write_back: 0.0, line: 0.0 };

/// Levels beyond the first.
const BEYOND: usize = 3;
/// What is fitted: e0, and what each level beyond the first adds to a byte fetched, to a byte that must go back, and to a
/// line that an index vector leads to. Lines from memory are as much more than those from the last cache as their bytes:
/// no drill scene has gathers from there that could say.
/// And the share of a drilled pass's beginning.
const UNKNOWN: usize = 3 * BEYOND + 1;
/// Where that share is.
const BEGIN: usize = 3 * BEYOND;
/// Levels beyond the first whose lines are fitted.
const LINES: usize = BEYOND - 1;
type Costs = [f64; UNKNOWN];

impl Charged {
    /// What is paid for: no level is cheaper than a nearer one, so every level adds to those before it.
    fn features(&self, capacities: [f64; BEYOND]) -> Costs {
        let mut features = [0.0; UNKNOWN];
        features[BEGIN] = self.starts;
        for Waiting { times, n, touched } in &self.passes {
            for (level, capacity) in capacities.into_iter().enumerate() {
                // A level that costs 1 beyond its capacity, and none before.
                let wait = |fetch, write_back, line| {
                    let there = Level { fetch, write_back, line, ..NOWHERE };
                    let levels = [Level { capacity: Some(capacity), ..NOWHERE }, there];
                    times * self.around.wait(&levels, touched, *n).sum()
                };
                let fetched = wait(1.0, 0.0, 0.0);
                features[1 + level] += fetched;
                features[1 + BEYOND + level] += wait(0.0, 1.0, 0.0);
                let lines = wait(0.0, 0.0, 1.0);
                match level {
                    0..LINES => features[1 + 2 * BEYOND + level] += lines,
                    _ => features[1 + level] += LINE * lines,
                }
                // Where everything is near there is nothing to wait for.
                if level == 0 && fetched + lines > 0.0 {
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
/// the core or the last level takes his; where it says nothing, what processors have.
fn candidates() -> Vec<[f64; BEYOND]> {
    const KIB: f64 = 1024.0;
    let known: Vec<f64> = (1..=BEYOND).filter_map(cache_size).collect();
    let mut all = vec![];
    if let [l1, l2, l3] = *known.as_slice() {
        for near in [0.5, 1.0] {
            for middle in [0.5, 1.0] {
                all.extend([0.125, 0.25, 0.5, 1.0].map(|share| [near * l1, middle * l2, share * l3]));
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

/// Capacities and costs of the levels.
pub(super) fn fit_levels(charged: &[Charged]) -> Levels {
    let mut best: Option<(f64, [f64; BEYOND], Costs)> = None;
    for capacities in candidates() {
        let features: Vec<Costs> = charged.iter().map(|each| each.features(capacities)).collect();
        let mut costs = fit_costs(charged, &features);
        fit_lines(charged, &features, &mut costs);
        let error = median(charged.iter().zip(&features).map(|(each, of)| each.deviation(of, &costs)));
        if best.is_none_or(|(least, ..)| error < least) {
            best = Some((error, capacities, costs));
        }
    }
    let (residual, capacities, [operand, steps @ ..]) = best.unwrap_or_default();
    let names = ["first-level cache", "second-level cache", "third-level cache", "memory"];
    let capacities = capacities.into_iter().map(Some).chain([None]);
    let [mut fetch, mut write_back, mut line] = [0.0; 3];
    let levels = names.into_iter().zip(capacities).enumerate().map(|(at, (name, capacity))| {
        if at > 0 {
            fetch += steps[at - 1];
            write_back += steps[BEYOND + at - 1];
            line += if at <= LINES { steps[2 * BEYOND + at - 1] } else { LINE * steps[at - 1] };
        }
        Level { name: name.to_owned(), capacity, fetch, write_back, line }
    });
    Levels { operand, levels: levels.collect(), begin: steps[BEGIN - 1], residual }
}

/// What lines cost that index vectors lead to, given all else: by what has such vectors alone, and all of that, for among
/// everything it is too little to be heard.
fn fit_lines(charged: &[Charged], features: &[Costs], costs: &mut Costs) {
    const FIRST: usize = 1 + 2 * BEYOND;
    let lines = &mut costs[FIRST..FIRST + LINES];
    lines.fill(0.0);
    let rows = charged.iter().zip(features).filter_map(|(each, features)| {
        let own: [f64; LINES] = std::array::from_fn(|level| features[FIRST + level] / each.ns);
        let rest = (each.ns - each.computing - product(features, costs)) / each.ns;
        own.iter().any(|&own| own > 0.0).then_some((own, rest))
    });
    let fitted = fit::non_negative(&rows.collect::<Vec<_>>());
    costs[FIRST..FIRST + LINES].copy_from_slice(&fitted);
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
}
