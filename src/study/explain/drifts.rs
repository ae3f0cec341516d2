//! Distance of quantities that should keep their value, by the cheapest configuration of each integrator at two steps.

use super::ExplainError;
use super::drift::Drift;
use super::findings::{Findings, SHARES, Way, Work, sort};
use crate::study::trial::{Known, Sample, Span};
use stripmine_physics::averages::Outcome;
use stripmine_physics::method::Decides;

/// The highest order of an integrator here.
const MOST_POWER: f64 = 8.0;

impl Work<'_> {
    /// How far what should keep its value goes, by the cheapest way of each integrator at two steps.
    pub(super) fn drifts(&self, mut ways: Vec<Way>) -> Result<Findings, ExplainError> {
        let usable = ways.iter().filter(|way| way.dropped.is_none()).count();
        let seconds = (1.0 - SHARES[0]) * self.seconds / (2.0 * usable.max(1) as f64);
        let span =
            self.case.duration().map_or(Span::Seconds(seconds), |time| Span::Time(time, Some(seconds)));
        let (mut start, mut row) = (0.0, 0.0);
        for way in ways.iter_mut().filter(|way| way.dropped.is_none()) {
            let (Some(longest), trials) = (way.step, self.case.entry.trials) else { continue };
            let both: Result<Vec<Sample>, String> = [1.0, 0.5]
                .into_iter()
                .map(|part| self.sampled_over(way, Some(part * longest), span))
                .collect();
            match both {
                Ok(both) => {
                    let far = |sample: &Sample| match sample.outcome {
                        Outcome::Kept { farthest, .. } => farthest,
                        _ => f64::NAN,
                    };
                    (start, row) = (both[0].start, both[0].row);
                    way.cost = Some(both[0].cost);
                    way.phases = both[0].phases.clone();
                    way.drift = Some(Drift {
                        step: longest,
                        farthest: [far(&both[0]), far(&both[1])],
                        time: both[0].time.min(both[1].time),
                        most_power: self.theory(&self.choice(way)).unwrap_or(MOST_POWER),
                        is_full: trials.is_none_or(|trials| {
                            self.choice(way)
                                .agrees(&self.case.own.with(trials.references[0]), Decides::Digits)
                        }),
                    });
                }
                Err(why) => way.dropped = Some(why),
            }
        }
        sort(&mut ways);
        let threads = rayon::current_num_threads();
        let (without, mean_way) = (vec![], String::new());
        Ok(Findings {
            ways,
            mean: Known::exactly(0.0),
            mean_way,
            whole: None,
            starts_differ: None,
            start,
            row,
            one_thread: 1.0,
            threads,
            without,
        })
    }
}
