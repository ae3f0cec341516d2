//! Timing: many short samples of every point, on an undisturbed core if there is one, taken in turns over the whole
//! measurement, so that a disturbance affects all points alike and none of them always. The reference loop is timed between
//! any two samples.

use crate::method::lattice_md::study::noise_monitor::{ENOUGH, NoiseMonitor, Timed};
use crate::method::lattice_md::study::segment_times::{COUNTS, SegmentTimes};
use std::time::Instant;
use stripmine_kernels::probe::{Probe, probe};

/// The smallest step of the clock that was seen (ns).
pub(super) fn timer_resolution() -> f64 {
    let step = |_| {
        let start = Instant::now();
        loop {
            let passed = start.elapsed().as_nanos();
            if passed > 0 {
                return passed as f64;
            }
        }
    };
    (0..200).map(step).fold(f64::INFINITY, f64::min)
}

/// The times of some works that are done one after the other, each segment by segment.
fn long_runs(
    monitor: &mut NoiseMonitor,
    quiet: &mut usize,
    works: usize,
    mut work: impl FnMut(usize),
) -> Vec<Vec<Timed>> {
    let ((), segments) = monitor.in_segments(quiet, || {
        for at in 0..works {
            probe(Probe::Begins(at));
            work(at);
            probe(Probe::Ends(at));
        }
    });
    let mut times = vec![vec![]; works];
    segments.into_iter().for_each(|(at, timed)| times[at].push(timed));
    times
}

/// A longer run (ns) is timed segment by segment: a core is seldom undisturbed for as long.
const LONG: f64 = 150_000.0;

/// Parts of the samples, each spread over the whole measurement: how far they differ is the uncertainty of a number.
pub(super) const PARTS: usize = 4;

/// The samples of one point.
#[derive(Clone, Debug, Default)]
pub(super) struct Samples {
    /// Runs of a sample: as many as the timer needs. Known after the first; and how long a run is, about (ns).
    runs: usize,
    once: f64,
    /// Samples on an undisturbed core.
    quiet: usize,
    /// Nanoseconds of a run, sample by sample.
    each: SegmentTimes,
    /// Their evaluation, once the reference is known.
    evaluated: Evaluated,
}

/// What follows from samples for an undisturbed core.
#[derive(Clone, Copy, Debug)]
struct Evaluated {
    typical: f64,
    parts: [f64; PARTS],
    quartiles: [f64; 2],
    quiet: f64,
}

impl Default for Evaluated {
    fn default() -> Evaluated {
        Evaluated {
            typical: f64::INFINITY,
            parts: [f64::INFINITY; PARTS],
            quartiles: [f64::NAN; 2],
            quiet: 0.0,
        }
    }
}

impl Samples {
    /// Takes one more sample, at least `shortest` nanoseconds long, unless there are enough undisturbed ones.
    pub(super) fn take(&mut self, monitor: &mut NoiseMonitor, shortest: f64, mut work: impl FnMut()) {
        let mut time = |times: usize| {
            let start = Instant::now();
            (0..times).for_each(|_| work());
            start.elapsed().as_nanos() as f64
        };
        if self.runs == 0 {
            let once = time(1).min(time(1)).max(1.0);
            self.runs = ((shortest / once).ceil() as usize).clamp(1, 1 << 20);
            self.once = once;
        }
        if self.quiet >= ENOUGH {
            return;
        }
        if self.once > LONG {
            if monitor.wait(self.quiet, self.once) {
                work();
            }
            let runs = long_runs(monitor, &mut self.quiet, 1, |_| work());
            runs.iter().for_each(|run| self.each.push(run));
            return;
        }
        let runs = self.runs;
        monitor.wait(self.quiet, shortest);
        let (ns, around) = monitor.around(&mut self.quiet, || {
            // The first run fills the caches.
            time(1);
            time(runs) / runs as f64
        });
        self.each.push(&[Timed { ns, around }]);
    }

    /// Takes one more sample of each of some works that are done one after the other, `times` times in a row, as the parts
    /// of a step are: each finds the caches as the others leave them. A first round fills the caches.
    pub(super) fn take_in_turns(
        all: &mut [Samples],
        monitor: &mut NoiseMonitor,
        times: usize,
        mut work: impl FnMut(usize),
    ) {
        let mut quiet = all.first().map_or(0, |samples| samples.quiet);
        if quiet >= ENOUGH {
            return;
        }
        let start = Instant::now();
        (0..all.len()).for_each(&mut work);
        // The shortest so far: a disturbed one would have short works timed as long ones.
        let mut lasting = start.elapsed().as_nanos() as f64;
        if let Some(first) = all.first_mut() {
            lasting = if first.once > 0.0 { lasting.min(first.once) } else { lasting };
            first.once = lasting;
        }
        if lasting > LONG {
            for _ in 0..times {
                if monitor.wait(quiet, lasting) {
                    (0..all.len()).for_each(&mut work);
                }
                let runs = long_runs(monitor, &mut quiet, all.len(), &mut work);
                for (samples, run) in all.iter_mut().zip(runs) {
                    samples.quiet = quiet;
                    samples.each.push(&run);
                }
            }
            return;
        }
        if monitor.wait(quiet, lasting) {
            (0..all.len()).for_each(&mut work);
        }
        let mut ns = vec![0.0; all.len()];
        let ((), around) = monitor.around(&mut quiet, || {
            for _ in 0..times {
                for (at, ns) in ns.iter_mut().enumerate() {
                    let start = Instant::now();
                    work(at);
                    *ns += start.elapsed().as_nanos() as f64;
                }
            }
        });
        for (samples, ns) in all.iter_mut().zip(ns) {
            samples.quiet = quiet;
            samples.each.push(&[Timed { ns: ns / times as f64, around }]);
        }
    }

    /// Forgets how many were undisturbed, so that more samples of works done in turns are taken.
    pub(super) fn go_on(all: &mut [Samples]) {
        all.iter_mut().for_each(|samples| samples.quiet = 0);
    }

    /// One more that was timed.
    #[cfg(test)]
    pub(super) fn push(&mut self, timed: Timed) {
        self.each.push(&[timed]);
    }

    /// Evaluates the samples for an undisturbed core, on which the reference loop takes `reference`.
    pub(super) fn evaluate(&mut self, reference: f64) {
        let Some([low, typical, high]) = self.each.quantiles(reference, [0.25, COUNTS, 0.75]) else { return };
        let part = |from| self.each.every(PARTS, from).typical(reference).unwrap_or(typical);
        self.evaluated = Evaluated {
            typical,
            parts: std::array::from_fn(part),
            quartiles: [low, high],
            quiet: self.each.quiet(reference),
        };
    }

    /// The sample that counts; infinite before there is one.
    pub(super) fn typical(&self) -> f64 {
        self.evaluated.typical
    }

    /// The same of every [`PARTS`]th sample, from this one on.
    pub(super) fn of_part(&self, part: usize) -> f64 {
        self.evaluated.parts[part]
    }

    /// Half the range between the quartiles, as a share of the sample that counts.
    pub(super) fn spread(&self) -> f64 {
        let [low, high] = self.evaluated.quartiles;
        0.5 * (high - low) / self.typical()
    }

    /// How far the two halves differ, as a share: the even parts and the odd ones.
    pub(super) fn disagreement(&self) -> f64 {
        let half = |from: usize| self.evaluated.parts.iter().skip(from).step_by(2).sum::<f64>();
        let [a, b] = [half(0), half(1)];
        (a - b).abs() / a.min(b)
    }

    /// The share that was measured on an undisturbed core, and not corrected for a slowdown.
    pub(super) fn quiet(&self) -> f64 {
        self.evaluated.quiet
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_low_sample_counts_and_parts_are_evaluated_apart() {
        let mut samples = Samples::default();
        for ns in [3.0, 2.0, 4.0, 6.0, 5.0, 3.0, 4.0, 6.0] {
            samples.each.push(&[Timed { ns, around: [1.0; 2] }]);
        }
        assert!(samples.typical().is_infinite());
        samples.evaluate(1.0);
        assert_eq!((samples.typical(), samples.of_part(0), samples.of_part(1)), (3.0, 3.0, 2.0));
        assert_eq!((samples.spread(), samples.quiet()), (1.0 / 3.0, 1.0));
        assert!(samples.disagreement() > 0.0);
    }

    #[test]
    fn a_sample_is_as_long_as_the_timer_needs() {
        let (mut samples, mut monitor) = (Samples::default(), NoiseMonitor::default());
        samples.take(&mut monitor, 20_000.0, || drop(std::hint::black_box(vec![0_u8; 64])));
        samples.evaluate(monitor.reference());
        assert!(samples.runs > 10 && samples.typical() > 0.0);
    }

    #[test]
    fn works_in_turns_are_done_once_before_and_timed_each_by_itself() {
        let (mut all, mut monitor) = (vec![Samples::default(); 2], NoiseMonitor::default());
        let mut order = vec![];
        Samples::take_in_turns(&mut all, &mut monitor, 2, |at| order.push(at));
        assert_eq!(order, [0, 1, 0, 1, 0, 1]);
        assert!(all.iter().all(|samples| samples.each.runs() >= 1));
    }

    #[test]
    fn long_works_are_timed_in_segments() {
        let (mut all, mut monitor) = (vec![Samples::default(); 2], NoiseMonitor::default());
        let at_rest = |_| {
            std::thread::sleep(std::time::Duration::from_micros(300));
            probe(Probe::Within);
        };
        Samples::take_in_turns(&mut all, &mut monitor, 1, at_rest);
        assert!(all.iter().all(|samples| samples.each.runs() == 1));
        assert!(monitor.usual_slowdown() >= 1.0);
    }
}
