//! Times of work told at the pace of quiet moments: from the samples that were taken then, or from how the others follow the
//! pace; and of work that lasts longer than a quiet moment piece by piece.

use super::pace::Timed;
use super::statistics::quantile;

/// So many quiet samples are enough.
const FEW: usize = 2;
/// How far the paces of two samples are apart at least that tell how a time follows the pace, as a logarithm.
const APART: f64 = 0.1;
/// A sample is compared with so many after it.
const COMPARED: usize = 8;
/// So many pairs of samples say beforehand that it goes with the pace itself: a few samples tell little.
const BEFOREHAND: usize = 50;
/// The highest power of the pace that is believed: what a neighbour slows down most goes with its square.
const HIGHEST: f64 = 2.5;

/// The times of some work, run by run, each from rest to rest.
#[derive(Clone, Debug, Default)]
pub struct Pieces {
    /// Runs that consisted of so many pieces each: the times piece by piece.
    of: Vec<Vec<Vec<Timed>>>,
}

impl Pieces {
    /// One more run.
    pub fn push(&mut self, run: &[Timed]) {
        if self.of.len() <= run.len() {
            self.of.resize(run.len() + 1, vec![]);
        }
        let pieces = &mut self.of[run.len()];
        pieces.resize(run.len(), vec![]);
        pieces.iter_mut().zip(run).for_each(|(piece, timed)| piece.push(*timed));
    }

    /// The runs of others too.
    pub fn join(&mut self, more: &Pieces) {
        for pieces in &more.of {
            for run in 0..pieces.first().map_or(0, Vec::len) {
                self.push(&pieces.iter().map(|piece| piece[run]).collect::<Vec<_>>());
            }
        }
    }

    /// The runs, piece by piece: where not all had as many, the most that had.
    fn pieces(&self) -> &[Vec<Timed>] {
        let runs = |pieces: &&Vec<Vec<Timed>>| pieces.first().map_or(0, Vec::len);
        self.of.iter().max_by_key(runs).map_or(&[], Vec::as_slice)
    }

    fn run(&self, run: usize) -> Vec<Timed> {
        self.pieces().iter().map(|piece| piece[run]).collect()
    }

    /// Runs.
    pub fn runs(&self) -> usize {
        self.pieces().first().map_or(0, Vec::len)
    }

    /// Every so manieth run, from one on.
    #[must_use]
    pub fn every(&self, step: usize, from: usize) -> Pieces {
        let mut part = Pieces::default();
        (from..self.runs()).step_by(step).for_each(|run| part.push(&self.run(run)));
        part
    }

    /// Nanoseconds of a run in a quiet moment: the sum over its pieces of those below which such a share of the samples lies.
    /// None without runs.
    pub fn quantiles<const N: usize>(&self, reference: f64, shares: [f64; N]) -> Option<[f64; N]> {
        let pieces = self.pieces();
        if self.runs() == 0 {
            return None;
        }
        let mut known = None;
        let mut sums = [0.0; N];
        for piece in pieces {
            let mut told: Vec<f64> =
                piece.iter().filter(|timed| timed.was_quiet(reference)).map(|timed| timed.ns).collect();
            let of_quiet = told.len() >= FEW;
            if !of_quiet {
                let power = *known.get_or_insert_with(|| power(pieces));
                told = piece.iter().map(|timed| timed.ns / timed.pace(reference).powf(power)).collect();
            }
            told.sort_by(f64::total_cmp);
            // What is told is sometimes told too short.
            let least = if of_quiet { 0.0 } else { TOLD };
            for (sum, share) in sums.iter_mut().zip(shares) {
                *sum += quantile(&told, share.max(least)).unwrap_or(0.0);
            }
        }
        Some(sums)
    }

    /// The same of the share that counts.
    pub fn typical(&self, reference: f64) -> Option<f64> {
        self.quantiles(reference, [COUNTS]).map(|[typical]| typical)
    }

    /// The share of the time that was measured in quiet moments, and not only told at their pace.
    pub fn quiet(&self, reference: f64) -> f64 {
        let [mut quiet, mut all] = [0.0; 2];
        for piece in self.pieces() {
            let ns: f64 = piece.iter().map(|timed| timed.ns).sum();
            all += ns;
            if piece.iter().filter(|timed| timed.was_quiet(reference)).count() >= FEW {
                quiet += ns;
            }
        }
        if all > 0.0 { quiet / all } else { 0.0 }
    }

    /// How much slower than where the reference was taken the host was in each piece of each run.
    pub fn paces(&self, reference: f64) -> impl Iterator<Item = f64> {
        self.pieces().iter().flatten().map(move |timed| timed.pace(reference))
    }
}

/// With which power of the pace the times of some work go: the median over pairs of samples of a piece (Theil and Sen's). A
/// neighbour on the same core slows down what keeps the core busy by more than the yardstick, and what waits for memory by
/// less; and what takes longer than the pace lasts follows two readings hardly at all.
fn power(pieces: &[Vec<Timed>]) -> f64 {
    let mut slopes = vec![1.0; BEFOREHAND];
    for piece in pieces {
        let points: Vec<[f64; 2]> = piece
            .iter()
            .filter(|timed| timed.ns > 0.0)
            .map(|timed| [timed.pace(1.0).ln(), timed.ns.ln()])
            .collect();
        let pairs = points
            .iter()
            .enumerate()
            .flat_map(|(at, a)| points[at + 1..].iter().take(COMPARED).map(move |b| (a, b)));
        let apart = pairs.filter(|(a, b)| (a[0] - b[0]).abs() > APART);
        slopes.extend(apart.map(|(a, b)| (a[1] - b[1]) / (a[0] - b[0])));
    }
    let middle = slopes.len() / 2;
    slopes.select_nth_unstable_by(middle, f64::total_cmp).1.clamp(0.0, HIGHEST)
}

/// The share of samples that lie below the one that counts: whatever disturbs makes them longer, and what others have left in
/// the larger caches does so even in quiet moments; but the very shortest may be one that the clock cut short.
pub const COUNTS: f64 = 0.1;
/// No lower share than this counts where the samples were told at the pace of quiet moments.
const TOLD: f64 = 0.25;

#[cfg(test)]
mod tests {
    use super::*;

    fn timed(ns: f64, before: f64, after: f64) -> Timed {
        Timed { ns, around: [before, after] }
    }

    fn pieces(runs: &[Timed]) -> Pieces {
        let mut pieces = Pieces::default();
        runs.iter().for_each(|run| pieces.push(&[*run]));
        pieces
    }

    #[test]
    fn quiet_samples_count_alone_where_there_are_enough() {
        let noisy = [timed(300.0, 20.0, 20.0), timed(90.0, 10.0, 20.0), timed(95.0, 20.0, 10.0)];
        let quiet = [
            timed(101.0, 10.0, 10.2),
            timed(102.0, 10.1, 10.0),
            timed(103.0, 10.0, 10.0),
            timed(103.0, 10.0, 10.0),
        ];
        let both = pieces(&[noisy.as_slice(), &quiet].concat());
        assert_eq!(both.quantiles(10.0, [0.0, 1.0]), Some([101.0, 103.0]));
        assert_eq!((both.quiet(10.0), pieces(&noisy).quiet(10.0)), (1.0, 0.0));
        assert_eq!(Pieces::default().typical(10.0), None);
    }

    #[test]
    fn how_times_follow_the_pace_is_their_own() {
        for power in [0.3, 1.8] {
            let each = |i: i32| {
                let pace = 1.1 + 0.05 * f64::from(i % 10);
                timed(100.0 * pace.powf(power), 10.0 * pace, 10.0 * pace)
            };
            let mut samples: Vec<Timed> = (0..40).map(each).collect();
            // One that was interrupted says nothing of the others.
            samples.push(timed(9000.0, 15.0, 15.0));
            let [low, high] = pieces(&samples).quantiles(10.0, [0.0, 0.95]).unwrap();
            assert!(
                (low / 100.0 - 1.0).abs() < 0.03 && (high / 100.0 - 1.0).abs() < 0.03,
                "{power}: {low} {high}"
            );
        }
        // A few samples are believed less than what is known beforehand, and what cannot be is not believed of any.
        let few = [timed(100.0, 20.0, 20.0), timed(100.0, 40.0, 40.0)];
        assert_eq!(pieces(&few).quantiles(10.0, [0.0, 1.0]), Some([25.0, 50.0]));
        let wild: Vec<Timed> =
            (0..40).map(|at| timed(f64::from(1 << (at % 10)), 10.0 + f64::from(at % 10), 10.0)).collect();
        assert_eq!(power(&[wild]), HIGHEST);
    }

    #[test]
    fn a_long_run_is_the_sum_of_its_pieces() {
        // Never quiet from end to end, but each piece now and then.
        let mut all = Pieces::default();
        for run in 0..16 {
            let piece = |at: usize| {
                let [before, after] = [at, at + 1].map(|rest| if (run + rest) % 4 < 2 { 10.0 } else { 17.0 });
                let slow = if before + after > 20.0 { 1.5 } else { 1.0 };
                timed(slow * (at + 1) as f64, before, after)
            };
            all.push(&(0..9).map(piece).collect::<Vec<_>>());
        }
        // One that rested elsewhere is not compared with the others.
        all.push(&[timed(1.0, 10.0, 10.0)]);
        assert_eq!((all.typical(10.0), all.runs(), all.quiet(10.0)), (Some(45.0), 16, 1.0));
        let mut joined = all.every(2, 0);
        joined.join(&all.every(2, 1));
        assert_eq!((joined.typical(10.0), joined.runs()), (Some(45.0), 16));
    }
}
