//! Means over whole runs, of what changes all along: a hopper that empties, a gas that cools. Runs from starts that differ by next to nothing tell
//! how far chance takes such a mean.

use super::findings::{NO_TIME, Way, Work};
use super::sample::{Known, Sample, Span, sample};
use crate::study::first_line;
use crate::study::state::displaced;
use std::time::Instant;
use stripmine_physics::averages::of_independent;
use stripmine_physics::method::Prepared;
use stripmine_physics::number::significant;
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::SEED;

/// Runs of which a mean and its scatter are, at least and at most.
pub(super) const RUNS: [usize; 2] = [3, 16];
/// Where nothing of a start is random, particles are displaced by as much (parts of the largest radius, or of the box where they have none): far
/// more than rounding, and far less than matters before collisions have multiplied it.
const DISPLACED: f64 = 1e-7;

/// What becomes of runs of which a check warns.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Warned {
    /// One is enough to know it.
    Stops,
    /// They are the best that there are.
    GoesOn,
}

impl Work<'_> {
    /// Whether some runs of the scene's whole time can be had in some seconds, where a unit of time costs as much as in a sample.
    pub(super) fn whole_in(&self, cost: f64, seconds: f64) -> Option<f64> {
        self.case.duration().filter(|time| RUNS[0] as f64 * cost * time <= seconds)
    }

    /// What whole runs take, where these are too many seconds.
    pub(super) fn too_dear(&self, cost: f64) -> String {
        self.case.duration().map_or(String::new(), |time| {
            format!(
                "; a mean over the whole run takes {} runs of about {} s",
                RUNS[0],
                significant(cost * time, 2)
            )
        })
    }

    /// A sample with what it says of the mean that is asked for: over a part of a run that has left its start behind, or over whole runs.
    pub(super) fn measured(
        &self,
        way: &Way,
        step: Option<f64>,
        seconds: f64,
        warned: Warned,
    ) -> Result<(Sample, Option<Known>), String> {
        match self.whole {
            Some(time) => self.whole_runs(way, step, [time, seconds], warned),
            None => self.sampled(way, step, seconds).map(|sample| {
                let known = sample.known();
                (sample, known)
            }),
        }
    }

    fn whole_runs(
        &self,
        way: &Way,
        step: Option<f64>,
        [time, seconds]: [f64; 2],
        warned: Warned,
    ) -> Result<(Sample, Option<Known>), String> {
        let begun = Instant::now();
        let cost = way.cost.zip(way.step).zip(step).map(|((cost, longest), step)| cost * longest / step);
        let left = self.left();
        if left == 0.0 {
            return Err(NO_TIME.to_owned());
        }
        if let Some(run) = cost.map(|cost| cost * time).filter(|run| *run > left) {
            return Err(format!("a whole run takes about {} s, and {NO_TIME}", significant(run, 2)));
        }
        let (mut first, mut means): (Option<Sample>, Vec<f64>) = (None, vec![]);
        for run in 0..RUNS[1] {
            let next = begun.elapsed().as_secs_f64() * (run + 1) as f64 / run as f64;
            if run > 0 && next > left || run >= RUNS[0] && next > seconds {
                break;
            }
            let prepared = self.another_start(way, step, run as u64)?;
            let observed = (self.case.entry.quantities, self.target.place);
            let found = sample(&prepared, observed, Span::Time(time, None), self.stop);
            let found = found.map_err(|failure| first_line(&failure.what()))?;
            means.push(found.whole_mean());
            let stops = warned == Warned::Stops && !found.warnings.is_empty();
            first.get_or_insert(found);
            if stops {
                break;
            }
        }
        let known = of_independent(&means).map(|[mean, bar]| Known {
            mean,
            bar,
            square: bar * bar * means.len() as f64 * time,
            transient: 0.0,
            apart: 0.0,
            freedoms: (means.len() - 1) as f64,
        });
        first.map(|sample| (sample, known)).ok_or_else(|| "no run was made".to_owned())
    }

    /// The scene from a start of another number, the first its own.
    fn another_start(&self, way: &Way, step: Option<f64>, number: u64) -> Result<Prepared, String> {
        match self.case.prepared.seed {
            Some(seed) => self.prepared(&way.overrides.clone().set(&SEED, seed.wrapping_add(number)), step),
            None if number == 0 => self.prepared(&way.overrides, step),
            None => {
                let prepared = self.prepared(&way.overrides, step)?;
                Ok(prepared.model.started_from(displaced_start(&prepared, number)))
            }
        }
    }
}

/// The particles of a start of a number, grains displaced by next to nothing.
fn displaced_start(prepared: &Prepared, number: u64) -> Particles {
    let largest = prepared.particles().radii().map_or(0.0, |[_, largest]| largest);
    let scale = if largest > 0.0 { largest } else { prepared.domain.length(0) };
    displaced(prepared.particles(), &prepared.domain, |place, _| {
        // Directions without a pattern, others for each start.
        let angle = 2.399_963_229_728_653 * ((place + 1) as f64 * number as f64);
        [libm::cos(angle), libm::sin(angle)].map(|part| DISPLACED * scale * part)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::{METHODS, load};

    /// Every grain by 10⁻⁷ of the largest radius, walls not at all, and each start in its own way.
    #[test]
    fn starts_differ_by_next_to_nothing() {
        let (prepared, _) = load("shaken-box", &[], METHODS).unwrap();
        let starts = [1, 2].map(|number| displaced_start(&prepared, number));
        let before = prepared.particles();
        let [_, largest] = before.radii().unwrap();
        for (number, start) in starts.iter().enumerate() {
            for (at, (own, now)) in before.all().iter().zip(start.all()).enumerate() {
                let way = prepared.domain.displacement(now.place(), own.place());
                let expected = if at < before.grain_count() { DISPLACED * largest } else { 0.0 };
                assert!(
                    (way[0].hypot(way[1]) - expected).abs() < 1e-3 * DISPLACED * largest,
                    "{number}, {at}"
                );
            }
        }
        let same = starts[0].all().iter().zip(starts[1].all()).filter(|(a, b)| a.position == b.position);
        assert_eq!(same.count(), before.len() - before.grain_count());
    }
}
