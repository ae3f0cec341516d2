//! The structure as a run goes: looked at with its rows and snapshots, kept in its checkpoints, written at its end.
//!
//! Sums are those of the looks after the start. What comes before the middle of the run is taken for the transient; the rest is in
//! blocks of time, and a bar is the half width of the interval of 95 % by Student's t of their means: right where blocks are longer
//! than the structure takes to change. What blocks share by lags that begin in one and end in the next is allowed for.
//!
//! Where rows or snapshots are so close that looking would take more than its share of the run's work, it is done at every second,
//! third, … of them. The work is counted (`structure::strides`), never measured.

use super::RunError;
use super::folder::RunFolder;
use super::functions::{Point, write_csv};
use crate::averages::of_independent;
use crate::io::checkpoint::{Checkpoint, Column};
use crate::method::{Every, Prepared, Simulation, Snapshot};
use crate::particles::States;
use crate::scene::Output;
use crate::structure::{
    Asks, Blocks, Headline, Look, Motion, OBSERVABLES, Observable, PairForces, Seen, Setting, strides,
    widening,
};
use serde::Serialize;

/// What a run sums up of the structure.
pub(super) struct Structured {
    setting: Setting,
    /// Every how many rows and snapshots are looked at.
    strides: [u64; 2],
    /// Rows and snapshots so far, those at the start left out.
    passed: [u64; 2],
    /// What is between two looks at rows and at snapshots (steps or time).
    spacings: [f64; 2],
    sums: Vec<Sum>,
    /// What is found at snapshots, where an observable asks for them.
    look: Option<Look>,
    /// What discs do to each other, where an observable asks for it.
    forces: Option<PairForces>,
    /// The discs at earlier rows, where an observable asks for them, and as they stand.
    motion: Option<(Motion, States)>,
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
    /// Every how many rows or snapshots are looked at.
    pub every: u64,
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

/// The share of a run's work that looking takes at most, where the scene does not say.
const SHARE: f64 = 0.05;
/// Where the ways of discs cannot be known.
const DOUBT: &str =
    "a disc went farther than a quarter of a periodic side between two rows: make them closer";

/// The observables that a scene asks for, in the order of their list.
pub(super) fn chosen(output: &Output) -> impl Iterator<Item = &'static Observable> + use<'_> {
    OBSERVABLES.iter().filter(|observable| output.structure.iter().any(|name| name == observable.name))
}

/// Every how many rows and snapshots are looked at.
pub(super) fn every(prepared: &Prepared) -> [u64; 2] {
    let setting = Setting::new(prepared.domain, prepared.particles());
    let asked: Vec<&Observable> = chosen(&prepared.output).collect();
    let share = prepared.output.structure_share.unwrap_or(SHARE);
    let schedule = prepared.schedule;
    let work = [schedule.rows, schedule.snapshots].map(|every| spacing(every) * prepared.model.work());
    strides(&asked, &setting, prepared.particles().grain_count(), share, work)
}

impl Structured {
    /// Nothing yet of what a scene asks for.
    pub(super) fn new(prepared: &Prepared) -> Structured {
        let grains = prepared.particles().grains();
        let setting = Setting::new(prepared.domain, prepared.particles());
        let asked: Vec<&Observable> = chosen(&prepared.output).collect();
        let strides = every(prepared);
        let spacings = [prepared.schedule.rows, prepared.schedule.snapshots].map(spacing);
        let stands = asked.iter().any(|observable| matches!(observable.seen, Seen::Once { .. }));
        let moves = asked.iter().any(|observable| matches!(observable.seen, Seen::Twice { .. }));
        let sum = |observable| Sum { observable, looks: 0, blocks: Blocks::new(width(observable, &setting)) };
        let look = stands.then(|| Look::new(setting, grains, asked.iter().copied()));
        let meets = look.as_ref().is_some_and(|look| look.asks(Asks::Forces));
        Structured {
            setting,
            strides,
            passed: [0; 2],
            spacings: [0, 1].map(|at| spacings[at] * strides[at] as f64),
            sums: chosen(&prepared.output).map(sum).collect(),
            look,
            forces: prepared.model.pair_forces().filter(|_| meets),
            motion: moves.then(|| (Motion::new(grains.len()), States::of(grains))),
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
        if at_same_moments {
            structured.passed = [there.count(&key(PASSED[0]))?, there.count(&key(PASSED[1]))?];
        }
        for sum in &mut structured.sums {
            let name = sum.observable.name;
            let goes_on = match sum.observable.seen {
                Seen::Once { .. } => is_known(sum.observable),
                Seen::Twice { .. } => motion_is_known,
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
        if let Some((motion, _)) = structured.motion.as_mut().filter(|_| motion_is_known) {
            let values = column(MOTION).ok_or_else(|| wrong(MOTION))?;
            let looks = there.count(&key(MOTION))?;
            let [first, last, farthest] = MOTIONS.map(|name| there.sum(&key(name)));
            let discs = prepared.particles().grain_count();
            let restored = Motion::restored(discs, looks, [first?, last?, farthest?], values);
            *motion = restored.ok_or_else(|| wrong(MOTION))?;
        }
        Ok(structured)
    }

    /// The sums of what is seen of two moments.
    fn moving(&self) -> impl Iterator<Item = &Sum> {
        self.sums.iter().filter(|sum| matches!(sum.observable.seen, Seen::Twice { .. }))
    }

    /// Whether a row or a snapshot more is one that is looked at.
    fn passes(&mut self, what: usize) -> bool {
        self.passed[what] += 1;
        self.passed[what].is_multiple_of(self.strides[what])
    }

    /// Looks at a moment of which there is a row.
    pub(super) fn row(&mut self, simulation: &dyn Simulation) {
        if self.motion.is_none() || !self.passes(ROWS) {
            return;
        }
        let Structured { setting, sums, motion, .. } = self;
        let Some((motion, states)) = motion else { return };
        states.forget();
        simulation.states(states);
        let of = |sum: &Sum| match sum.observable.seen {
            Seen::Twice { of } => Some(of),
            Seen::Once { .. } => None,
        };
        motion.look(&setting.domain, states.rows(), simulation.clock().time, |look, place, means| {
            for sum in &mut *sums {
                if let Some(of) = of(sum) {
                    sum.blocks.add(look, place, of(means));
                }
            }
        });
        sums.iter_mut().filter(|sum| of(sum).is_some()).for_each(|sum| sum.looks += 1);
    }

    /// Looks at a moment of which there is a snapshot.
    pub(super) fn snapshot(&mut self, simulation: &dyn Simulation) {
        if self.look.is_none() || !self.passes(SNAPSHOTS) {
            return;
        }
        let Some(look) = &mut self.look else { return };
        let is_any_left = look.at(|states| {
            states.forget();
            simulation.states(states);
        });
        if !is_any_left {
            return;
        }
        if let Some(forces) = &self.forces {
            look.meet(&simulation.particles(), forces);
        }
        for sum in &mut self.sums {
            if let Seen::Once { .. } = sum.observable.seen {
                let values = look.values(sum.observable).into_iter().enumerate();
                let seen = values.filter(|(_, value)| !value.is_nan());
                seen.for_each(|(place, value)| sum.blocks.add(sum.looks, place, value));
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
            let passed = PASSED.into_iter().zip(self.passed);
            passed.for_each(|(name, passed)| snapshot.add_count(&key(name), passed));
        }
        if let Some((motion, _)) = &self.motion {
            snapshot.add_count(&key(MOTION), motion.looks());
            let numbers = MOTIONS.into_iter().zip(motion.numbers());
            numbers.for_each(|(name, number)| snapshot.add_sum(&key(name), number));
            snapshot.add_column(&key(MOTION), Column::F64(motion.column()));
        }
    }

    /// Each observable in its file: what it is a function of, its mean, and the bar.
    pub(super) fn write(&self, folder: &RunFolder) -> Result<(), RunError> {
        for sum in &self.sums {
            let Function { over, means, .. } = self.function(sum);
            let point = |(over, [mean, bar]): (Vec<f64>, [f64; 2])| Point { over, mean, bar };
            let points: Vec<Point> = over.into_iter().zip(means).map(point).collect();
            folder.write(sum.observable.file, |out| write_csv(sum.observable, &points, out))?;
        }
        Ok(())
    }

    /// What `summary.json` says of each.
    pub(super) fn summed(&self) -> Vec<Summed> {
        let of = |sum: &Sum| {
            let function = self.function(sum);
            let Function { over, blocks, .. } = &function;
            let over: Vec<f64> = over.iter().map(|place| place[0]).collect();
            let mean: Vec<f64> = function.means.iter().map(|[mean, _]| *mean).collect();
            let headlines: &[Headline] = if over.len() > 1 { sum.observable.headlines } else { &[] };
            let never = headlines.iter().find_map(|headline| (headline.never)(&over, &mean));
            let headline = |headline: &Headline| {
                let of = |block: &Vec<f64>| (headline.of)(&over, &mean, block);
                let [mean, bar] = function.mean(of, over.len() - 1)?;
                Some(Headlined { name: headline.name, unit: headline.unit, mean, bar })
            };
            let is_far = matches!(sum.observable.seen, Seen::Twice { .. })
                && self.motion.as_ref().is_some_and(|(motion, _)| !motion.is_certain());
            Summed {
                name: sum.observable.name,
                file: sum.observable.file,
                looks: sum.looks,
                blocks: blocks.len(),
                looks_of_a_block: sum.blocks.length(),
                headlines: match never {
                    Some(_) => vec![],
                    None => headlines.iter().filter_map(headline).collect(),
                },
                every: self.strides[match sum.observable.seen {
                    Seen::Once { .. } => SNAPSHOTS,
                    Seen::Twice { .. } => ROWS,
                }],
                doubt: is_far.then_some(DOUBT).or(never),
            }
        };
        self.sums.iter().map(of).collect()
    }

    /// The function that an observable is, as far as it is known.
    fn function(&self, sum: &Sum) -> Function {
        let length = sum.blocks.length();
        let (over, lags, last) = match sum.observable.seen {
            Seen::Once { over, .. } => (over.places(&self.setting), vec![], 0),
            Seen::Twice { .. } => {
                // Lags no longer than a block, so that blocks share no more than their ends, and all of them are whole.
                let motion = self.motion.iter().flat_map(|(motion, _)| motion.times());
                let short = Motion::lags().zip(motion).filter(|(lag, _)| *lag <= length);
                let (lags, times) = short.map(|(lag, time)| (lag, vec![time])).unzip();
                (times, lags, 1)
            }
        };
        let blocks = sum.blocks.second_half(sum.looks, last);
        let mut function = Function { over, means: vec![], blocks, lags, length };
        let means = (0..function.over.len()).map_while(|place| function.mean(|block| block[place], place));
        function.means = means.collect();
        function.over.truncate(function.means.len());
        function
    }
}

/// What a function is over, its means with their bars, and its values in each block.
struct Function {
    over: Vec<Vec<f64>>,
    /// Not a number where fewer than two blocks have a value.
    means: Vec<[f64; 2]>,
    blocks: Vec<Vec<f64>>,
    /// The lags (looks) where it is over lags, and the looks of a block.
    lags: Vec<u64>,
    length: u64,
}

impl Function {
    /// The mean over blocks of a number that is of lags up to that at `place`, with its bar; none where there are too few blocks.
    fn mean(&self, of: impl Fn(&Vec<f64>) -> f64, place: usize) -> Option<[f64; 2]> {
        if self.blocks.len() < 2 {
            return None;
        }
        let values: Vec<f64> = self.blocks.iter().map(of).filter(|value| !value.is_nan()).collect();
        let Some([mean, bar]) = of_independent(&values) else { return Some([f64::NAN; 2]) };
        let wider = self.lags.get(place).map_or(1.0, |&lag| widening(lag, self.length, values.len()));
        Some([mean, wider * bar])
    }
}

/// Their places where both are kept.
const ROWS: usize = 0;
const SNAPSHOTS: usize = 1;

/// What checkpoints call the spacings of rows and snapshots, the motion, and its numbers.
const SPACINGS: [&str; 2] = ["rows", "snapshots"];
const PASSED: [&str; 2] = ["rows passed", "snapshots passed"];
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
        Seen::Once { over, further, .. } => over.places(setting).len() + further,
        Seen::Twice { .. } => Motion::lags().len(),
    }
}
