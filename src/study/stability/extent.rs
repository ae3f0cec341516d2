//! Size of a map and length of its runs, limited by the available time.

use super::STEPS;
use super::reference;
use crate::study::StudyError;

/// Length of a run (in steps of the scene's own) below which the map is made smaller: eight of the largest steps.
const LEAST: f64 = 1024.0;
/// Length of a run in the smallest map: one of the largest steps.
const SHORTEST: f64 = 128.0;
/// Size of the smallest map.
const SMALLEST: usize = 3;
/// Approximate number of runs per boundary, and their cost: each is as long as one with four own steps.
const EDGE: [f64; 2] = [8.0, 8.0 / 4.0];
/// Share of the time that is planned: measured, not derived. The rest covers costs unknown in advance: samples of runs, biased means that are
/// repeated with another seed, boundaries below the scene's own step. Maps of four scenes took 1.7 to 2.6 times the seconds of [`MapCosts::of_map`], and
/// 1/2.6 is 0.38; which scenes these were is not recorded. A test checks the planned time (`planned_maps_fit_their_time`); none checks the actual
/// time.
const PLANNED: f64 = 0.38;

/// Costs of runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MapCosts {
    /// Seconds of a step.
    pub(crate) each: f64,
    /// Seconds before the first step of a run.
    pub start: f64,
    /// Number of integrators whose boundaries are found at the scene's own value.
    pub(crate) schemes: usize,
}

/// Size of a map and length of its runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MapExtent {
    /// Number of values of the parameter, and of steps.
    pub size: usize,
    /// Number of seeds of the boundaries.
    pub seeds: u64,
    /// Length of each run, in steps of the scene's own.
    pub(crate) own_steps: f64,
    pub seconds: f64,
}

/// Steps from the shortest to the longest, in parts of the scene's own.
fn parts(size: usize) -> Vec<f64> {
    super::ladder(STEPS, size, true)
}

impl MapCosts {
    /// Seconds of a map: per own step of a run's length, and for the starts of all runs.
    fn of_map(&self, size: usize, seeds: u64) -> [f64; 2] {
        let parts = parts(size);
        let (count, seeds, schemes) = (size as f64, seeds as f64, self.schemes as f64);
        let references = reference::SEEDS as f64;
        let column: f64 = parts.iter().map(|part| 1.0 / part).sum();
        let reference = references / parts[0];
        let steps = count * (column + reference + seeds * EDGE[1]) + reference + schemes * seeds * EDGE[1];
        let runs = count * (count + references + seeds * EDGE[0]) + references + schemes * seeds * EDGE[0];
        [self.each * steps, self.start * runs]
    }

    /// Returns the largest map that fits into `budget`, up to the requested one: seeds are reduced first, then values and steps, and run lengths
    /// last.
    ///
    /// # Errors
    /// [`StudyError::TooLittleTime`] where the smallest map takes longer.
    pub(crate) fn extent(
        &self,
        budget: f64,
        asked: (usize, u64),
        scene: f64,
    ) -> Result<MapExtent, StudyError> {
        let planned = PLANNED * budget;
        let fitting = |size: usize, seeds: u64, least: f64| {
            let [each, starts] = self.of_map(size, seeds);
            let own_steps = ((planned - starts) / each).min(scene);
            let seconds = starts + each * own_steps;
            (own_steps >= least.min(scene)).then_some(MapExtent { size, seeds, own_steps, seconds })
        };
        let sizes = (SMALLEST.min(asked.0)..=asked.0).rev();
        let mut all = sizes.flat_map(|size| (1..=asked.1).rev().map(move |seeds| (size, seeds)));
        let largest = all.find_map(|(size, seeds)| fitting(size, seeds, LEAST));
        let smallest = SMALLEST.min(asked.0);
        largest.or_else(|| fitting(smallest, 1, SHORTEST)).ok_or_else(|| {
            let [each, starts] = self.of_map(smallest, 1);
            let needed = (starts + each * SHORTEST.min(scene)) / PLANNED;
            StudyError::TooLittleTime { needed, budget }
        })
    }
}

impl MapExtent {
    /// Describes the parts omitted to save time; none where the map is complete.
    pub(crate) fn left_out(&self, (size, seeds): (usize, u64), scene: f64) -> Option<String> {
        let mut all = vec![];
        if self.size < size {
            all.push(format!("values and steps beyond {} of {size}", self.size));
        }
        if self.seeds < seeds {
            all.push(format!("seeds of the boundaries beyond {} of {seeds}", self.seeds));
        }
        if self.own_steps < 0.99 * scene {
            all.push(format!("the time after {:.0} of the scene's {scene:.0} steps", self.own_steps));
        }
        (!all.is_empty()).then(|| all.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASKED: (usize, u64) = (24, 3);

    /// No map is planned beyond the time, however expensive its steps and starts; omissions are reported.
    #[test]
    fn planned_maps_fit_their_time() {
        let mut last = 0;
        for budget in [1.0, 5.0, 30.0, 300.0, 3000.0] {
            for each in [1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.1] {
                for start in [1e-5, 1e-3, 0.02, 0.5] {
                    let costs = MapCosts { each, start, schemes: 3 };
                    match costs.extent(budget, ASKED, 50_000.0) {
                        Ok(extent) => {
                            let [steps, starts] = costs.of_map(extent.size, extent.seeds);
                            let seconds = steps * extent.own_steps + starts;
                            assert!((seconds / extent.seconds - 1.0).abs() < 1e-9);
                            assert!(
                                seconds <= PLANNED * budget * (1.0 + 1e-9),
                                "{budget} {each} {start}: {extent:?}"
                            );
                            assert!(extent.size >= 3 && extent.seeds >= 1 && extent.own_steps >= SHORTEST);
                            let is_whole = (extent.size, extent.seeds, extent.own_steps) == (24, 3, 50_000.0);
                            assert_eq!(extent.left_out(ASKED, 50_000.0).is_none(), is_whole);
                        }
                        Err(error) => {
                            let StudyError::TooLittleTime { needed, .. } = error else { panic!("{error}") };
                            assert!(needed > budget, "{needed} {budget}");
                            // The reported time is enough.
                            assert!(costs.extent(1.001 * needed, ASKED, 50_000.0).is_ok());
                        }
                    }
                }
            }
            let size = MapCosts { each: 5e-5, start: 5e-3, schemes: 3 }
                .extent(budget, ASKED, 50_000.0)
                .map_or(0, |it| it.size);
            assert!(size >= last, "{budget}");
            last = size;
        }
        assert_eq!(last, 24);
    }

    /// By hand: a map of 3 values and steps (0.5, 8 and 128 of the own) from one seed with one integrator. Steps: 3 (2 + 1/8 + 1/128 + 16 + 2) + 16 +
    /// 2, starts: 3 (3 + 8 + 8) + 8 + 8.
    #[test]
    fn a_map_costs_its_steps_and_starts() {
        let [steps, starts] = MapCosts { each: 1.0, start: 1.0, schemes: 1 }.of_map(3, 1);
        assert!((steps - (3.0 * (20.0 + 0.125 + 1.0 / 128.0) + 18.0)).abs() < 1e-9, "{steps}");
        assert_eq!(starts, 73.0);
    }
}
