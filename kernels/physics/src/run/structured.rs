//! Structure functions of a run: sampled at its rows and snapshots, stored in its checkpoints, written at its end.
//!
//! Samples after the start are summed. The first half of the run counts as the transient. The second half is divided into blocks of time, and an
//! error bar is the half-width of the 95 % confidence interval by Student's t of the block means. It is correct if blocks are longer than the
//! correlation time of the structure. Correlations by lags that start in one block and end in the next are accounted for.
//!
//! If sampling every row or snapshot would exceed its share of the run's work, only every second, third, … is sampled. The work is counted
//! (`structure::strides`), never measured.

use super::RunError;
use super::block_means::BlockFunction;
use super::folder::RunFolder;
use super::functions::{FunctionPoint, Number, csv};
use crate::averages::MeanWithBar;
use crate::io::checkpoint::{Checkpoint, CheckpointColumn};
use crate::io::run_moment::RunMoment;
use crate::method::{Every, Prepared, Snapshot};
use crate::particles::GrainStates;
use crate::scene::Output;
use crate::structure::{
    AveragedFunction, Block, Blocks, FunctionReliability, Headline, MotionHistory, OBSERVABLES, PairForces,
    SampleData, SamplingKind, StructureObservable, StructureSample, StructureSetting, species_numbers,
    strides,
};
use serde::Serialize;
use std::io::Write as _;

/// Structure functions of a run.
pub(super) struct StructureSampler {
    setting: StructureSetting,
    /// Strides of sampled rows and snapshots.
    strides: [u64; 2],
    /// Rows and snapshots so far, without those at the start.
    passed: [u64; 2],
    /// Interval between samples of rows and of snapshots (steps or time).
    spacings: [f64; 2],
    sums: Vec<ObservableSums>,
    /// Samples of snapshots, if an observable needs them.
    look: Option<StructureSample>,
    /// Pair forces, if an observable needs them.
    forces: Option<PairForces>,
    /// Samples at earlier rows, if an observable needs them, and the present state.
    motion: Option<(MotionHistory, GrainStates)>,
    /// True if discs are followed across periodic sides.
    follows: bool,
    /// Species of each grain, if motion by species is sampled.
    species: Vec<u8>,
    /// Initial numbers of particles and of grains.
    particles: usize,
    grains: usize,
}

/// Sums of an observable.
struct ObservableSums {
    observable: &'static StructureObservable,
    looks: u64,
    blocks: Blocks,
}

/// Summary of an observable.
#[derive(Clone, Debug, Serialize)]
pub struct StructureSummary {
    /// Name of the observable.
    pub name: &'static str,
    /// File with its values in the run's folder.
    pub file: &'static str,
    /// Number of samples after the start, the transient included.
    pub looks: u64,
    /// Stride of the sampled rows or snapshots.
    pub every: u64,
    /// Number of blocks for error bars.
    pub(crate) blocks: usize,
    /// Number of samples in each block.
    pub(crate) looks_of_a_block: u64,
    /// Numbers that summarise it; empty if there are too few blocks.
    pub headlines: Vec<Number>,
    /// Reservation about the values, or the reason why there are no headlines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<String>,
}

/// Default of the largest fraction of a run's work for sampling.
const SHARE: f64 = 0.05;

/// Observables that a scene requests, in the order of their list.
pub(super) fn requested_observables(
    output: &Output,
) -> impl Iterator<Item = &'static StructureObservable> + use<'_> {
    OBSERVABLES.iter().filter(|observable| output.structure.iter().any(|name| name == observable.name))
}

/// Strides of sampled rows and snapshots.
pub(super) fn sampling_strides(prepared: &Prepared) -> [u64; 2] {
    let setting = prepared.structure_setting();
    let asked: Vec<&StructureObservable> = requested_observables(&prepared.output).collect();
    let share = prepared.output.structure_share.unwrap_or(SHARE);
    let schedule = prepared.schedule;
    let work = [schedule.rows, schedule.snapshots].map(|every| spacing(every) * prepared.model.work());
    strides(&asked, &setting, prepared.particles().grain_count(), share, work)
}

impl StructureSampler {
    /// Empty sums for the observables of a scene.
    pub(super) fn new(prepared: &Prepared) -> StructureSampler {
        let grains = prepared.particles().grains();
        let setting = prepared.structure_setting();
        let asked: Vec<&StructureObservable> = requested_observables(&prepared.output).collect();
        let strides = sampling_strides(prepared);
        let spacings = [prepared.schedule.rows, prepared.schedule.snapshots].map(spacing);
        let stands = asked.iter().any(|observable| matches!(observable.seen, SamplingKind::Once { .. }));
        let moves = asked.iter().any(|observable| matches!(observable.seen, SamplingKind::Twice { .. }));
        let sum = |observable| ObservableSums {
            observable,
            looks: 0,
            blocks: Blocks::new(width(observable, &setting)),
        };
        let look = stands.then(|| StructureSample::new(setting, prepared.particles(), asked.iter().copied()));
        let meets = look.as_ref().is_some_and(|look| look.needs_data(SampleData::Forces));
        StructureSampler {
            setting,
            strides,
            passed: [0; 2],
            spacings: [0, 1].map(|at| spacings[at] * strides[at] as f64),
            sums: requested_observables(&prepared.output).map(sum).collect(),
            look,
            forces: prepared.model.pair_forces().filter(|_| meets),
            motion: moves.then(|| (MotionHistory::new(grains.len()), GrainStates::of(grains))),
            follows: prepared.output.follows_motion() && prepared.domain.periodic().contains(&true),
            species: match asked
                .iter()
                .any(|it| matches!(it.seen, SamplingKind::Twice { by_species: true, .. }))
            {
                true => species_numbers(grains).0,
                false => vec![],
            },
            particles: prepared.particles().len(),
            grains: grains.len(),
        }
    }

    /// Restores the sums of a checkpoint into empty ones. Observables that it lacks, or sampled at other moments, start now; `notes`
    /// receives their names.
    ///
    /// # Errors
    /// A message, if the checkpoint is not of this scene.
    pub(super) fn resume(&mut self, checkpoint: &Checkpoint, notes: &mut Vec<String>) -> Result<(), String> {
        let there = Snapshot { counters: checkpoint.counters.clone(), columns: vec![] };
        let column = |name: &str| match checkpoint.column(&key(name)) {
            Some(CheckpointColumn::F64(values)) => Some(values.as_slice()),
            _ => None,
        };
        let at_same_moments = SPACINGS.map(|name| there.sum(&key(name)).ok()) == self.spacings.map(Some);
        let wrong = |name: &str| format!("its data of the structure ({name}) are not of this scene");
        // Earlier versions have the default bins.
        let has_same_bins = BINNING
            .iter()
            .zip(self.setting.binning())
            .all(|(name, number)| there.sum(&key(name)).map_or(true, |before| before == number));
        let is_known =
            |observable: &StructureObservable| at_same_moments && column(observable.name).is_some();
        // Functions of two moments are resumed together or not at all.
        let motion_is_known = self.sums_of_two_moments().all(|sum| is_known(sum.observable));
        if at_same_moments {
            self.passed = [there.count(&key(PASSED[0]))?, there.count(&key(PASSED[1]))?];
        }
        for sum in &mut self.sums {
            let name = sum.observable.name;
            let goes_on = match sum.observable.seen {
                SamplingKind::Once { .. } => has_same_bins && is_known(sum.observable),
                SamplingKind::Twice { .. } => motion_is_known,
            };
            let Some(values) = column(name).filter(|_| goes_on) else {
                notes.push(format!("{name} is averaged from here on"));
                continue;
            };
            sum.looks = there.count(&key(&format!("{name} looks")))?;
            let length = there.count(&key(&format!("{name} length")))?;
            let width = width(sum.observable, &self.setting);
            sum.blocks = Blocks::restored(width, length, values).ok_or_else(|| wrong(name))?;
        }
        if let Some((motion, _)) = self.motion.as_mut().filter(|_| motion_is_known) {
            let values = column(MOTION).ok_or_else(|| wrong(MOTION))?;
            let looks = there.count(&key(MOTION))?;
            let [first, last] = MOTIONS.map(|name| there.sum(&key(name)));
            let restored = MotionHistory::restored(self.grains, looks, [first?, last?], values);
            *motion = restored.ok_or_else(|| wrong(MOTION))?;
        }
        Ok(())
    }

    /// Sums of functions of two moments.
    fn sums_of_two_moments(&self) -> impl Iterator<Item = &ObservableSums> {
        self.sums.iter().filter(|sum| matches!(sum.observable.seen, SamplingKind::Twice { .. }))
    }

    /// Counts a row or a snapshot; returns true if it is sampled.
    fn counts_as_sample(&mut self, what: usize) -> bool {
        self.passed[what] += 1;
        self.passed[what].is_multiple_of(self.strides[what])
    }

    /// Samples a moment with a row.
    pub(super) fn row(&mut self, moment: &RunMoment<'_>) {
        if self.motion.is_none() || !self.counts_as_sample(ROWS) {
            return;
        }
        let StructureSampler { setting, sums, motion, species, .. } = self;
        let Some((motion, states)) = motion else { return };
        states.mark_all_lost();
        moment.per_particle.states(states);
        if self.follows {
            let images = moment.per_particle.images();
            // Lost particles have no images.
            let left = (images.len() < self.particles).then(|| moment.per_particle.particles());
            states.unfold(setting.domain.lengths(), &images, left.as_ref());
        }
        if !moment.per_particle.is_whole() {
            return;
        }
        let of = |sum: &ObservableSums| match sum.observable.seen {
            SamplingKind::Twice { of, by_species, .. } => Some((of, by_species)),
            SamplingKind::Once { .. } => None,
        };
        motion.add_sample(states.rows(), moment.time, species, |look, place, own, means| {
            for sum in &mut *sums {
                if let Some((of, by_species)) = of(sum)
                    && by_species == own.is_some()
                {
                    let first = own.map_or(0, |own| own * MotionHistory::lags().len());
                    sum.blocks.add(look, first + place, of(means), 1.0);
                }
            }
        });
        sums.iter_mut().filter(|sum| of(sum).is_some()).for_each(|sum| sum.looks += 1);
    }

    /// Samples a moment with a snapshot.
    pub(super) fn snapshot(&mut self, moment: &RunMoment<'_>) {
        if self.look.is_none() || !self.counts_as_sample(SNAPSHOTS) {
            return;
        }
        let Some(look) = &mut self.look else { return };
        let is_any_left = look.take_sample(|states| {
            states.mark_all_lost();
            moment.per_particle.states(states);
            if !moment.per_particle.is_whole() {
                states.mark_all_lost();
            }
        });
        if !is_any_left {
            return;
        }
        if let Some(forces) = &self.forces {
            let particles = &moment.frame().particles;
            if !moment.per_particle.is_whole() {
                return;
            }
            look.add_pair_forces(particles, forces);
        }
        for sum in &mut self.sums {
            if let SamplingKind::Once { .. } = sum.observable.seen {
                let [values, weights] = look.values(sum.observable);
                for (place, (value, weight)) in values.into_iter().zip(weights).enumerate() {
                    if !value.is_nan() {
                        sum.blocks.add(sum.looks, place, value, weight);
                    }
                }
                sum.looks += 1;
            }
        }
    }

    /// Adds all sums to a checkpoint.
    pub(super) fn keep(&self, snapshot: &mut Snapshot) {
        for ObservableSums { observable: StructureObservable { name, .. }, looks, blocks } in &self.sums {
            snapshot.add_count(&key(&format!("{name} looks")), *looks);
            snapshot.add_count(&key(&format!("{name} length")), blocks.length());
            snapshot.add_column(&key(name), CheckpointColumn::F64(blocks.column()));
        }
        if !self.sums.is_empty() {
            let spacings = SPACINGS.into_iter().zip(self.spacings);
            spacings.for_each(|(name, spacing)| snapshot.add_sum(&key(name), spacing));
            let binning = BINNING.into_iter().zip(self.setting.binning());
            binning.for_each(|(name, number)| snapshot.add_sum(&key(name), number));
            let passed = PASSED.into_iter().zip(self.passed);
            passed.for_each(|(name, passed)| snapshot.add_count(&key(name), passed));
        }
        if let Some((motion, _)) = &self.motion {
            snapshot.add_count(&key(MOTION), motion.looks());
            let numbers = MOTIONS.into_iter().zip(motion.ends());
            numbers.for_each(|(name, number)| snapshot.add_sum(&key(name), number));
            snapshot.add_column(&key(MOTION), CheckpointColumn::F64(motion.column()));
        }
    }

    /// Writes the file of each observable: coordinates, mean and error bar.
    pub(super) fn write(&self, folder: &RunFolder) -> Result<(), RunError> {
        for sum in &self.sums {
            let BlockFunction { over, means, .. } = self.function(sum);
            let point = |(over, [value, bar]): (Vec<f64>, [f64; 2])| FunctionPoint {
                over,
                mean: MeanWithBar { value, bar },
            };
            let points: Vec<FunctionPoint> = over.into_iter().zip(means).map(point).collect();
            let text = csv(sum.observable, &points);
            folder.write(sum.observable.file, |out| out.write_all(text.as_bytes()))?;
        }
        Ok(())
    }

    /// Entries of `summary.json`.
    pub(super) fn summed(&self) -> Vec<StructureSummary> {
        self.sums.iter().map(|sum| self.summed_of(sum)).collect()
    }

    fn summed_of(&self, sum: &ObservableSums) -> StructureSummary {
        let StructureObservable { name, file, headlines, judged, seen, .. } = *sum.observable;
        let function = self.function(sum);
        let over: Vec<f64> = function.over.iter().map(|place| length(place)).collect();
        let every = self.strides[match seen {
            SamplingKind::Once { .. } => SNAPSHOTS,
            SamplingKind::Twice { .. } => ROWS,
        }];
        let whole = AveragedFunction {
            setting: &self.setting,
            over: &over,
            means: &function.means,
            elapsed: self.motion.as_ref().map_or(0.0, |(motion, _)| motion.ends()[1]),
            mean: &|of, place| function.mean(|block| of(&block.means), place),
        };
        let verdict = match function.missing(sum.looks, every) {
            Some(why) => FunctionReliability::None(why),
            None => judged(&whole),
        };
        let headline = |headline: &Headline| {
            let of = |block: &Block| (headline.of)(&whole, &block.means);
            let [value, bar] = function.mean(of, over.len() - 1)?;
            let mean = MeanWithBar { value, bar: bar + ((headline.bias)(&whole) * value).abs() };
            Some(Number { name: headline.name, unit: headline.unit, mean }).filter(|_| !value.is_nan())
        };
        let (headlines, doubt) = match verdict {
            FunctionReliability::Sound => (headlines, None),
            FunctionReliability::Doubt(why) => (headlines, Some(why)),
            FunctionReliability::None(why) => (&[][..], Some(why)),
        };
        StructureSummary {
            name,
            file,
            looks: sum.looks,
            blocks: function.blocks.len(),
            looks_of_a_block: sum.blocks.length(),
            headlines: headlines.iter().filter_map(headline).collect(),
            every,
            doubt,
        }
    }

    /// Function of an observable, as far as it has values.
    fn function(&self, sum: &ObservableSums) -> BlockFunction {
        let length = sum.blocks.length();
        let (over, lags, last) = match sum.observable.seen {
            SamplingKind::Once { over, .. } => (over.places(&self.setting), vec![], 0),
            SamplingKind::Twice { .. } => {
                // Lags are at most a block, so that blocks share only their ends, and the last block is dropped.
                let motion = self.motion.iter().flat_map(|(motion, _)| motion.times());
                let short = MotionHistory::lags().zip(motion).filter(|(lag, _)| *lag <= length);
                let (lags, times) = short.map(|(lag, time)| (lag, vec![time])).unzip();
                (times, lags, 1)
            }
        };
        let mut blocks = sum.blocks.second_half(sum.looks, last);
        let (mut over, mut lags) = (over, lags);
        if let SamplingKind::Twice { by_species: true, .. } = sum.observable.seen {
            // Each species has a row of all lags, of which the short ones remain.
            let (all, species) = (MotionHistory::lags().len(), self.setting.species);
            let short = |row: &[f64]| row.chunks(all).flat_map(|row| &row[..over.len()]).copied().collect();
            for block in &mut blocks {
                (block.means, block.weights) = (short(&block.means), short(&block.weights));
            }
            let numbered = |own: usize| over.iter().map(move |lag| [&[own as f64][..], lag].concat());
            over = (1..=species).flat_map(numbered).collect();
            lags = lags.repeat(species);
        }
        let mut function = BlockFunction { over, means: vec![], blocks, lags, length };
        let is_density = sum.observable.is_density_of_places();
        let means = (0..function.over.len()).map_while(|place| {
            let [mean, bar] = function.mean_at(place)?;
            // Positions where no disc was sampled have no known error.
            Some([mean, if is_density && mean == 0.0 { f64::NAN } else { bar }])
        });
        function.means = means.collect();
        function.over.truncate(function.means.len());
        function
    }
}

/// Coordinate itself, or the distance of two coordinates from the origin.
fn length(place: &[f64]) -> f64 {
    match *place {
        [along] => along,
        _ => place.iter().map(|along| along * along).sum::<f64>().sqrt(),
    }
}

/// Indices of rows and snapshots in pairs of values.
const ROWS: usize = 0;
const SNAPSHOTS: usize = 1;

/// Names in checkpoints: the spacings and counts of rows and snapshots, the bins of distances, the motion, and its times.
const SPACINGS: [&str; 2] = ["rows", "snapshots"];
const PASSED: [&str; 2] = ["rows passed", "snapshots passed"];
const BINNING: [&str; 2] = ["range", "bins"];
const MOTION: &str = "motion";
const MOTIONS: [&str; 2] = ["motion first", "motion last"];

/// Name of a structure entry in checkpoints.
fn key(name: &str) -> String {
    format!("structure {name}")
}

fn spacing(every: Every) -> f64 {
    match every {
        Every::Never => 0.0,
        Every::Steps(steps) => steps as f64,
        Every::Time(time) | Every::Seconds(time) => time,
    }
}

/// Number of values of an observable, those for headlines only included.
fn width(observable: &StructureObservable, setting: &StructureSetting) -> usize {
    match observable.seen {
        SamplingKind::Once { over, further, .. } => over.places(setting).len() + further,
        SamplingKind::Twice { by_species: true, .. } => setting.species * MotionHistory::lags().len(),
        SamplingKind::Twice { .. } => MotionHistory::lags().len(),
    }
}
