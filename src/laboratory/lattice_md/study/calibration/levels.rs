//! What waiting for the levels of memory adds: fitted to passes over long vectors, and to whole programs of drill scenes as
//! the interpreter and as compiled loops run them.

use super::capacities::candidates;
use super::fit::median;
use super::point::{ARRAYS, BACK, BEYOND, Beyond, Charged, Costs, FIRST, LINES, Point, streamed};
use crate::model::host::{Level, Transfer};
use crate::statistics::non_negative;
use std::collections::BTreeMap;

/// The levels that suit best.
pub(super) struct Levels {
    /// Nanoseconds an element of a pass with operands from beyond the nearest level, e0.
    pub(super) operand: f64,
    pub(super) levels: Vec<Level>,
    /// Of the shorter of computing and waiting in a loop, the share that hides behind the longer.
    pub(super) overlap: f64,
    /// Median deviation of the fit to passes.
    pub(super) residual: f64,
}

/// Capacities and costs of the levels: those that suit passes and loops best together. Streams are foreseen and hardly tell
/// one level from the next; lines that nothing announces do, and loops wait for these most.
pub(super) fn fit_levels(passes: &[Charged], loops: &[Charged]) -> Levels {
    let mut best = Fitted { error: f64::INFINITY, ..Fitted::default() };
    let candidates = candidates();
    let measured = [passes, loops];
    // Many candidates share a capacity, and what lies beyond it is much to count.
    let mut known: BTreeMap<u64, [Vec<Beyond>; 2]> = BTreeMap::new();
    for capacity in candidates.iter().flatten() {
        let beyond = |all: &[Charged]| all.iter().map(|each| each.beyond(*capacity)).collect();
        known.entry(capacity.to_bits()).or_insert_with(|| measured.map(beyond));
    }
    for capacities in candidates {
        let beyond = capacities.map(|capacity| &known[&capacity.to_bits()]);
        let [passes, loops] = [0, 1].map(|which: usize| {
            let all = measured[which].iter().enumerate();
            all.map(|(at, each)| each.point(beyond.map(|of| of[which][at]))).collect::<Vec<_>>()
        });
        let fitted = Fitted::of(capacities, &passes, &loops);
        if fitted.error < best.error {
            best = fitted;
        }
    }
    best.levels()
}

/// Levels of certain capacities.
#[derive(Default)]
struct Fitted {
    capacities: [f64; BEYOND],
    costs: Costs,
    loops: Loops,
    residual: f64,
    /// Mean deviation of passes and loops together.
    error: f64,
}

impl Fitted {
    fn of(capacities: [f64; BEYOND], passes: &[Point], loops: &[Point]) -> Fitted {
        let mut costs = fit_passes(passes);
        fit_lines(passes, &mut costs);
        let loops = fit_loops(loops, &costs);
        let deviations = || passes.iter().map(|point| point.deviation(point.waiting(&costs)));
        let error = mean(passes, deviations()) + loops.error;
        Fitted { capacities, costs, residual: median(deviations()), error, loops }
    }

    fn levels(self) -> Levels {
        let names =
            ["store buffer", "first-level cache", "second-level cache", "third-level cache", "memory"];
        let capacities = self.capacities.into_iter().map(Some).chain([None]);
        let transfer = |costs: &Costs, level: usize| {
            let upto = |steps: usize| costs[steps..steps + level].iter().fold(0.0, |sum, step| sum + step);
            Transfer {
                fetch: upto(1),
                fetch_array: upto(ARRAYS),
                write_back: upto(BACK),
                first: upto(FIRST),
                line: upto(LINES),
            }
        };
        let levels = names.into_iter().zip(capacities).enumerate().map(|(at, (name, capacity))| Level {
            name: name.to_owned(),
            capacity,
            passes: transfer(&self.costs, at),
            loops: transfer(&self.loops.costs, at),
        });
        Levels {
            operand: self.costs[0],
            levels: levels.collect(),
            overlap: self.loops.overlap,
            residual: self.residual,
        }
    }
}

/// The mean of some deviations, each counted for as much as what it is of.
fn mean(of: &[Point], deviations: impl Iterator<Item = f64>) -> f64 {
    let finite: Vec<(f64, f64)> = of
        .iter()
        .map(|point| point.weight)
        .zip(deviations)
        .filter(|(_, deviation)| deviation.is_finite())
        .collect();
    let weights: f64 = finite.iter().map(|(weight, _)| weight).sum();
    finite.iter().map(|(weight, deviation)| weight * deviation).sum::<f64>() / weights.max(f64::MIN_POSITIVE)
}

/// Rounds in which what is far from the fit weighs less and less.
const ROUNDS: usize = 6;

/// The costs of passes that suit best, everything weighted alike in its relative error.
fn fit_passes(points: &[Point]) -> Costs {
    let mut costs: Option<Costs> = None;
    for _ in 0..ROUNDS {
        let rows = points.iter().map(|point| {
            let far = costs.map_or(0.0, |costs| point.deviation(point.waiting(&costs)));
            let scale = point.scale(far);
            let rest = (point.ns - point.start - point.computing).max(0.0);
            (point.features.map(|feature| feature * scale), rest * scale)
        });
        costs = Some(non_negative(&rows.collect::<Vec<_>>()));
    }
    costs.unwrap_or_default()
}

/// What lines cost passes that index vectors lead to, given all else: by what has such vectors alone, and all of that, for
/// among all costs it is too small to be determined.
fn fit_lines(points: &[Point], costs: &mut Costs) {
    costs[LINES..].fill(0.0);
    let rows = points.iter().filter_map(|point| {
        let own: [f64; BEYOND] = std::array::from_fn(|level| point.features[LINES + level] / point.ns);
        let rest = || (point.ns - point.waiting(costs)) / point.ns;
        own.iter().any(|&own| own > 0.0).then(|| (own, rest()))
    });
    let lines: [f64; BEYOND] = non_negative(&rows.collect::<Vec<_>>());
    costs[LINES..].copy_from_slice(&lines);
}

/// How loops wait.
#[derive(Default)]
struct Loops {
    overlap: f64,
    costs: Costs,
    /// Mean deviation.
    error: f64,
}

/// Shares of the shorter of computing and waiting that may hide behind the longer.
const OVERLAPS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// How loops wait: beginning with what passes do, for which of computing and waiting is the shorter must be known first.
fn fit_loops(points: &[Point], passes: &Costs) -> Loops {
    let fitted = |overlap: f64| {
        let mut costs = *passes;
        for round in 0..ROUNDS {
            let rows = points.iter().map(|point| {
                let far = point.deviation(point.overlapping(&costs, overlap));
                let scale = point.scale(if round == 0 { 0.0 } else { far });
                let (computing, streams) = match point.computing >= streamed(&point.features, &costs) {
                    true => (point.computing, 1.0 - overlap),
                    false => ((1.0 - overlap) * point.computing, 1.0),
                };
                let mut row = point.features.map(|feature| feature * scale);
                row[0] = 0.0;
                row[1..LINES].iter_mut().for_each(|feature| *feature *= streams);
                (row, (point.ns - point.start - computing).max(0.0) * scale)
            });
            costs = non_negative(&rows.collect::<Vec<_>>());
        }
        let error =
            mean(points, points.iter().map(|point| point.deviation(point.overlapping(&costs, overlap))));
        Loops { overlap, costs, error }
    };
    OVERLAPS.map(fitted).into_iter().min_by(|a, b| a.error.total_cmp(&b.error)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::super::point::{UNKNOWN, Waiting};
    use super::*;
    use crate::model::host::{Since, Surroundings, Touch, Vector};
    use stripmine_kernels::backend::tape::{File, RegisterName};

    const KIB: f64 = 1024.0;

    /// A pass over a register that was touched `distance` bytes ago, and one that is near.
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

    fn point(charged: &Charged, capacities: [f64; BEYOND]) -> Point {
        charged.point(capacities.map(|capacity| charged.beyond(capacity)))
    }

    #[test]
    fn costs_that_went_in_come_out() {
        let capacities = [2.0 * KIB, 32.0 * KIB, 512.0 * KIB, 8192.0 * KIB];
        let all = [
            charged(1.0 * KIB, true, 0.0),
            charged(200.0 * KIB, false, 0.01),
            charged(200.0 * KIB, true, 0.015),
            charged(3000.0 * KIB, false, 0.03),
            charged(3000.0 * KIB, true, 0.045),
            charged(90_000.0 * KIB, false, 0.1),
            charged(90_000.0 * KIB, true, 0.145),
        ];
        let points = all.map(|each| point(&each, capacities));
        let costs = fit_passes(&points);
        for point in &points {
            assert!(point.deviation(point.waiting(&costs)) < 0.02, "{costs:?}");
        }
        assert!(costs.iter().all(|cost| *cost >= 0.0));
    }

    #[test]
    fn streams_and_lines_of_loops_come_out() {
        let capacities = [2.0 * KIB, 32.0 * KIB, 512.0 * KIB, 8192.0 * KIB];
        // As passes are, and as loops are: twice the wait, half of the shorter hidden, lines of 4 ns and from memory of 20.
        let [mut passes, mut truth] = [[0.0; UNKNOWN]; 2];
        passes[1..ARRAYS].copy_from_slice(&[0.0, 0.001, 0.002, 0.01]);
        truth[1..ARRAYS].copy_from_slice(&[0.0, 0.002, 0.004, 0.02]);
        truth[LINES..].copy_from_slice(&[0.0, 0.0, 4.0, 16.0]);
        let features = |distance: f64, lines: [f64; BEYOND]| {
            let mut features = point(&charged(distance, false, 0.0), capacities).features;
            features[LINES..].copy_from_slice(&lines);
            features
        };
        let none = [0.0; BEYOND];
        let all = [(10.0, none), (200.0, none), (3000.0, none), (90_000.0, none)];
        let lines = [
            (10.0, [5000.0, 0.0, 0.0, 0.0]),
            (200.0, [5000.0, 5000.0, 0.0, 0.0]),
            (3000.0, [900.0, 900.0, 900.0, 0.0]),
            (90_000.0, [2000.0; BEYOND]),
        ];
        // Each with little and with much to compute, or one could not tell what hides behind what.
        let features: Vec<Costs> =
            all.into_iter().chain(lines).flat_map(|(kib, lines)| [features(kib * KIB, lines); 2]).collect();
        let measured = |(&features, &computing): (&Costs, &f64)| {
            let point = Point { computing, features, weight: 1.0, ..Point::default() };
            Point { ns: point.overlapping(&truth, 0.5), ..point }
        };
        let points: Vec<Point> = features.iter().zip([200.0, 2000.0].iter().cycle()).map(measured).collect();
        let found = fit_loops(&points, &passes);
        assert!(found.overlap == 0.5 && found.error < 1e-6, "{}: {}", found.overlap, found.error);
        assert!(
            found.costs.iter().zip(truth).all(|(found, truth)| (found - truth).abs() < 1e-3 * truth + 1e-6)
        );
    }
}
