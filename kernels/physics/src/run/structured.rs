//! The structure as a run goes: looked at with its rows and snapshots, kept in its checkpoints, written at its end.
//!
//! Sums are those of the looks after the start. What comes before the middle of the run is taken for the transient; the rest is in
//! blocks of time, and a bar is the half width of the interval of 95 % by Student's t of their means: right where blocks are longer
//! than the structure takes to change.

use super::RunError;
use super::folder::RunFolder;
use crate::averages::of_independent;
use crate::io::checkpoint::{Checkpoint, Column};
use crate::method::{Every, Prepared, Simulation, Snapshot};
use crate::scene::Output;
use crate::structure::{Blocks, Headline, Motion, OBSERVABLES, Observable, Seen, Setting};
use serde::Serialize;
use std::io::Write;

/// What a run sums up of the structure.
pub(super) struct Structured {
    setting: Setting,
    /// What is between two rows and between two snapshots (steps or time).
    spacings: [f64; 2],
    sums: Vec<Sum>,
    /// The discs at earlier rows, where an observable asks for them.
    motion: Option<Motion>,
}

/// The sums of an observable.
struct Sum {
    observable: &'static Observable,
    looks: u64,
    blocks: Blocks,
}

/// What was summed up of an observable.
#[derive(Clone, Debug, Serialize)]
pub struct Summed {
    /// Its name.
    pub name: &'static str,
    /// The file of the run's folder with its values.
    pub file: &'static str,
    /// Looks after the start, those of the transient among them.
    pub looks: u64,
    /// Blocks that bars are from.
    pub blocks: usize,
    /// Looks of each of them.
    pub looks_of_a_block: u64,
    /// What stands for the whole; nothing where there are too few blocks.
    pub headlines: Vec<Headlined>,
    /// What makes the values doubtful.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<&'static str>,
}

/// A number that stands for a whole function.
#[derive(Clone, Debug, Serialize)]
pub struct Headlined {
    /// Its name.
    pub name: &'static str,
    /// Its unit, empty for pure numbers.
    pub unit: &'static str,
    /// The mean over blocks.
    pub mean: f64,
    /// Half the width of its interval of 95 %.
    pub bar: f64,
}

/// Where the ways of discs cannot be known.
const DOUBT: &str =
    "a disc went farther than a quarter of a periodic side between two rows: make them closer";

/// The observables that a scene asks for, in the order of their list.
pub(super) fn chosen(output: &Output) -> impl Iterator<Item = &'static Observable> + use<'_> {
    OBSERVABLES.iter().filter(|observable| output.structure.iter().any(|name| name == observable.name))
}

impl Structured {
    /// Nothing yet of what a scene asks for.
    pub(super) fn new(prepared: &Prepared) -> Structured {
        let setting = Setting::new(prepared.domain, prepared.particles());
        let sum = |observable| Sum { observable, looks: 0, blocks: Blocks::new(width(observable, &setting)) };
        let sums: Vec<Sum> = chosen(&prepared.output).map(sum).collect();
        let moves = sums.iter().any(|sum| matches!(sum.observable.seen, Seen::Twice(_)));
        let schedule = prepared.schedule;
        Structured {
            setting,
            spacings: [schedule.rows, schedule.snapshots].map(spacing),
            sums,
            motion: moves.then(|| Motion::new(prepared.particles().grains())),
        }
    }

    /// As a checkpoint kept it. What it does not know, or knows at other moments, begins now, which `notes` hear.
    ///
    /// # Errors
    /// A sentence, if the checkpoint is not one of this scene.
    pub(super) fn resumed(
        prepared: &Prepared,
        checkpoint: &Checkpoint,
        notes: &mut Vec<String>,
    ) -> Result<Structured, String> {
        let mut structured = Structured::new(prepared);
        let there = Snapshot { counters: checkpoint.counters.clone(), columns: vec![] };
        let column = |name: &str| match checkpoint.column(&key(name)) {
            Some(Column::F64(values)) => Some(values.as_slice()),
            _ => None,
        };
        let at_same_moments =
            SPACINGS.map(|name| there.sum(&key(name)).ok()) == structured.spacings.map(Some);
        let wrong = |name: &str| format!("what it says of the structure ({name}) is not of this scene");
        let is_known = |observable: &Observable| at_same_moments && column(observable.name).is_some();
        // What is seen of two moments goes on together or not at all.
        let motion_is_known = structured.moving().all(|sum| is_known(sum.observable));
        for sum in &mut structured.sums {
            let name = sum.observable.name;
            let goes_on = match sum.observable.seen {
                Seen::Once { .. } => is_known(sum.observable),
                Seen::Twice(_) => motion_is_known,
            };
            let Some(values) = column(name).filter(|_| goes_on) else {
                notes.push(format!("{name} is summed up from here on"));
                continue;
            };
            sum.looks = there.count(&key(&format!("{name} looks")))?;
            let length = there.count(&key(&format!("{name} length")))?;
            let width = width(sum.observable, &structured.setting);
            sum.blocks = Blocks::restored(width, length, values).ok_or_else(|| wrong(name))?;
        }
        if let Some(motion) = structured.motion.as_mut().filter(|_| motion_is_known) {
            let values = column(MOTION).ok_or_else(|| wrong(MOTION))?;
            let looks = there.count(&key(MOTION))?;
            let [first, last, farthest] = MOTIONS.map(|name| there.sum(&key(name)));
            let discs = prepared.particles().grains();
            let restored = Motion::restored(discs, looks, [first?, last?, farthest?], values);
            *motion = restored.ok_or_else(|| wrong(MOTION))?;
        }
        Ok(structured)
    }

    /// The sums of what is seen of two moments.
    fn moving(&self) -> impl Iterator<Item = &Sum> {
        self.sums.iter().filter(|sum| matches!(sum.observable.seen, Seen::Twice(_)))
    }

    /// Looks at a moment of which there is a row.
    pub(super) fn row(&mut self, simulation: &dyn Simulation) {
        let Some(motion) = &mut self.motion else { return };
        let (particles, time) = (simulation.particles(), simulation.clock().time);
        let mut functions = vec![];
        let mut sums = vec![];
        for sum in &mut self.sums {
            if let Seen::Twice(function) = sum.observable.seen {
                functions.push(function);
                sum.looks += 1;
                sums.push(sum);
            }
        }
        motion.look(&self.setting.domain, particles.grains(), time, &functions, |look, place, means| {
            for (sum, &mean) in sums.iter_mut().zip(means) {
                sum.blocks.add(look, place, mean);
            }
        });
    }

    /// Looks at a moment of which there is a snapshot.
    pub(super) fn snapshot(&mut self, simulation: &dyn Simulation) {
        if !self.sums.iter().any(|sum| matches!(sum.observable.seen, Seen::Once { .. })) {
            return;
        }
        let particles = simulation.particles();
        if particles.grain_count() == 0 {
            return;
        }
        for sum in &mut self.sums {
            if let Seen::Once { of, .. } = sum.observable.seen {
                let values = of(&self.setting, particles.grains());
                let places = values.into_iter().enumerate();
                places.for_each(|(place, value)| sum.blocks.add(sum.looks, place, value));
                sum.looks += 1;
            }
        }
    }

    /// Adds everything to what a checkpoint keeps.
    pub(super) fn keep(&self, snapshot: &mut Snapshot) {
        for Sum { observable: Observable { name, .. }, looks, blocks } in &self.sums {
            snapshot.add_count(&key(&format!("{name} looks")), *looks);
            snapshot.add_count(&key(&format!("{name} length")), blocks.length());
            snapshot.add_column(&key(name), Column::F64(blocks.column()));
        }
        if !self.sums.is_empty() {
            let spacings = SPACINGS.into_iter().zip(self.spacings);
            spacings.for_each(|(name, spacing)| snapshot.add_sum(&key(name), spacing));
        }
        if let Some(motion) = &self.motion {
            snapshot.add_count(&key(MOTION), motion.looks());
            let numbers = MOTIONS.into_iter().zip(motion.numbers());
            numbers.for_each(|(name, number)| snapshot.add_sum(&key(name), number));
            snapshot.add_column(&key(MOTION), Column::F64(motion.column()));
        }
    }

    /// Each observable in its file: what it is a function of, its mean, and the bar.
    pub(super) fn write(&self, folder: &RunFolder) -> Result<(), RunError> {
        for sum in &self.sums {
            let Observable { file, over, value, .. } = sum.observable;
            let function = self.function(sum);
            folder.write(file, |out| {
                writeln!(out, "{},{},error", with_unit(*over), with_unit(*value))?;
                let rows = function.over.iter().zip(&function.means);
                rows.into_iter()
                    .try_for_each(|(over, [mean, bar])| writeln!(out, "{over:?},{mean:?},{bar:?}"))
            })?;
        }
        Ok(())
    }

    /// What `summary.json` says of each.
    pub(super) fn summed(&self) -> Vec<Summed> {
        let of = |sum: &Sum| {
            let Function { over, means, blocks } = self.function(sum);
            let mean: Vec<f64> = means.iter().map(|[mean, _]| *mean).collect();
            let headline = |headline: &Headline| {
                let values: Vec<f64> =
                    blocks.iter().map(|block| (headline.of)(&over, &mean, block)).collect();
                let [mean, bar] = of_independent(&values)?;
                Some(Headlined { name: headline.name, unit: headline.unit, mean, bar })
            };
            let doubt = matches!(sum.observable.seen, Seen::Twice(_))
                && self.motion.as_ref().is_some_and(|motion| !motion.is_certain());
            Summed {
                name: sum.observable.name,
                file: sum.observable.file,
                looks: sum.looks,
                blocks: blocks.len(),
                looks_of_a_block: sum.blocks.length(),
                headlines: match over.len() {
                    0 | 1 => vec![],
                    _ => sum.observable.headlines.iter().filter_map(headline).collect(),
                },
                doubt: doubt.then_some(DOUBT),
            }
        };
        self.sums.iter().map(of).collect()
    }

    /// The function that an observable is, as far as it is known.
    fn function(&self, sum: &Sum) -> Function {
        let (over, last) = match sum.observable.seen {
            Seen::Once { over, .. } => (over(&self.setting), 0),
            Seen::Twice(_) => {
                // Lags no longer than a block, so that blocks share no more than their ends, and all of them are whole.
                let lags = Motion::lags().into_iter().zip(self.motion.iter().flat_map(Motion::times));
                let short = lags.filter(|(lag, _)| *lag <= sum.blocks.length());
                (short.map(|(_, time)| time).collect(), 1)
            }
        };
        let blocks = sum.blocks.second_half(sum.looks, last);
        let of = |place: usize| of_independent(&blocks.iter().map(|block| block[place]).collect::<Vec<_>>());
        let means: Vec<[f64; 2]> = (0..over.len()).map_while(of).collect();
        Function { over: over[..means.len()].to_vec(), means, blocks }
    }
}

/// What a function is over, its means with their bars, and its values in each block.
struct Function {
    over: Vec<f64>,
    means: Vec<[f64; 2]>,
    blocks: Vec<Vec<f64>>,
}

/// What checkpoints call the spacings of rows and snapshots, the motion, and its numbers.
const SPACINGS: [&str; 2] = ["rows", "snapshots"];
const MOTION: &str = "motion";
const MOTIONS: [&str; 3] = ["motion first", "motion last", "motion farthest"];

/// What checkpoints call something of the structure.
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

/// Values of an observable, those for headlines only among them.
fn width(observable: &Observable, setting: &Setting) -> usize {
    match observable.seen {
        Seen::Once { over, further, .. } => over(setting).len() + further,
        Seen::Twice(_) => Motion::lags().len(),
    }
}

fn with_unit([name, unit]: [&str; 2]) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}
