//! The structure as a run goes: looked at with its rows and snapshots, kept in its checkpoints, written at its end.
//!
//! Sums are those of the looks after the start. What comes before the middle of the run is taken for the transient; the rest is in
//! blocks of time, and a bar is the half width of the interval of 95 % by Student's t of their means: right where blocks are longer
//! than the structure takes to change. What blocks share by lags that begin in one and end in the next is allowed for.
//!
//! Where rows or snapshots are so close that looking would take more than its share of the run's work, it is done at every second,
//! third, … of them. The work is counted (`structure::strides`), never measured.

use super::RunError;
use super::block_means::Function;
use super::folder::RunFolder;
use super::functions::{Number, Point, csv};
use crate::io::checkpoint::{Checkpoint, Column};
use crate::io::run_moment::RunMoment;
use crate::method::{Every, Prepared, Snapshot};
use crate::particles::States;
use crate::scene::Output;
use crate::structure::{
    Asks, Block, Blocks, Headline, Look, Motion, OBSERVABLES, Observable, PairForces, Seen, Setting, Verdict,
    Whole, strides,
};
use serde::Serialize;
use std::io::Write as _;

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
    /// Whether discs are followed across periodic sides, and how many particles there are at the start.
    follows: bool,
    particles: usize,
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
    pub(crate) blocks: usize,
    /// Looks of each of them.
    pub(crate) looks_of_a_block: u64,
    /// What stands for the whole; nothing where there are too few blocks.
    pub headlines: Vec<Number>,
    /// What makes the values doubtful, or why no number stands for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<String>,
}

/// The share of a run's work that looking takes at most, where the scene does not say.
const SHARE: f64 = 0.05;

/// The observables that a scene asks for, in the order of their list.
pub(super) fn chosen(output: &Output) -> impl Iterator<Item = &'static Observable> + use<'_> {
    OBSERVABLES.iter().filter(|observable| output.structure.iter().any(|name| name == observable.name))
}

/// Every how many rows and snapshots are looked at.
pub(super) fn every(prepared: &Prepared) -> [u64; 2] {
    let setting = setting_of(prepared);
    let asked: Vec<&Observable> = chosen(&prepared.output).collect();
    let share = prepared.output.structure_share.unwrap_or(SHARE);
    let schedule = prepared.schedule;
    let work = [schedule.rows, schedule.snapshots].map(|every| spacing(every) * prepared.model.work());
    strides(&asked, &setting, prepared.particles().grain_count(), share, work)
}

fn setting_of(prepared: &Prepared) -> Setting {
    let of = if prepared.model.has_open_top() { Setting::with_open_top } else { Setting::new };
    of(prepared.domain, prepared.particles())
}

impl Structured {
    /// Nothing yet of what a scene asks for.
    pub(super) fn new(prepared: &Prepared) -> Structured {
        let grains = prepared.particles().grains();
        let setting = setting_of(prepared);
        let asked: Vec<&Observable> = chosen(&prepared.output).collect();
        let strides = every(prepared);
        let spacings = [prepared.schedule.rows, prepared.schedule.snapshots].map(spacing);
        let stands = asked.iter().any(|observable| matches!(observable.seen, Seen::Once { .. }));
        let moves = asked.iter().any(|observable| matches!(observable.seen, Seen::Twice { .. }));
        let sum = |observable| Sum { observable, looks: 0, blocks: Blocks::new(width(observable, &setting)) };
        let look = stands.then(|| Look::new(setting, prepared.particles(), asked.iter().copied()));
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
            follows: prepared.output.follows_motion() && prepared.domain.periodic().contains(&true),
            particles: prepared.particles().len(),
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
            let [first, last] = MOTIONS.map(|name| there.sum(&key(name)));
            let discs = prepared.particles().grain_count();
            let restored = Motion::restored(discs, looks, [first?, last?], values);
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
    pub(super) fn row(&mut self, moment: &RunMoment<'_>) {
        if self.motion.is_none() || !self.passes(ROWS) {
            return;
        }
        let Structured { setting, sums, motion, .. } = self;
        let Some((motion, states)) = motion else { return };
        states.forget();
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
        let of = |sum: &Sum| match sum.observable.seen {
            Seen::Twice { of, .. } => Some(of),
            Seen::Once { .. } => None,
        };
        motion.look(states.rows(), moment.time, |look, place, means| {
            for sum in &mut *sums {
                if let Some(of) = of(sum) {
                    sum.blocks.add(look, place, of(means), 1.0);
                }
            }
        });
        sums.iter_mut().filter(|sum| of(sum).is_some()).for_each(|sum| sum.looks += 1);
    }

    /// Looks at a moment of which there is a snapshot.
    pub(super) fn snapshot(&mut self, moment: &RunMoment<'_>) {
        if self.look.is_none() || !self.passes(SNAPSHOTS) {
            return;
        }
        let Some(look) = &mut self.look else { return };
        let is_any_left = look.at(|states| {
            states.forget();
            moment.per_particle.states(states);
            if !moment.per_particle.is_whole() {
                states.forget();
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
            look.meet(particles, forces);
        }
        for sum in &mut self.sums {
            if let Seen::Once { .. } = sum.observable.seen {
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
            let numbers = MOTIONS.into_iter().zip(motion.ends());
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
            let text = csv(sum.observable, &points);
            folder.write(sum.observable.file, |out| out.write_all(text.as_bytes()))?;
        }
        Ok(())
    }

    /// What `summary.json` says of each.
    pub(super) fn summed(&self) -> Vec<Summed> {
        self.sums.iter().map(|sum| self.summed_of(sum)).collect()
    }

    fn summed_of(&self, sum: &Sum) -> Summed {
        let Observable { name, file, headlines, judged, seen, .. } = *sum.observable;
        let function = self.function(sum);
        let over: Vec<f64> = function.over.iter().map(|place| length(place)).collect();
        let every = self.strides[match seen {
            Seen::Once { .. } => SNAPSHOTS,
            Seen::Twice { .. } => ROWS,
        }];
        let whole = Whole {
            setting: &self.setting,
            over: &over,
            means: &function.means,
            elapsed: self.motion.as_ref().map_or(0.0, |(motion, _)| motion.ends()[1]),
            mean: &|of, place| function.mean(|block| of(&block.means), place),
        };
        let verdict = match function.missing(sum.looks, every) {
            Some(why) => Verdict::None(why),
            None => judged(&whole),
        };
        let headline = |headline: &Headline| {
            let of = |block: &Block| (headline.of)(&whole, &block.means);
            let [mean, bar] = function.mean(of, over.len() - 1)?;
            let bar = bar + ((headline.bias)(&whole) * mean).abs();
            Some(Number { name: headline.name, unit: headline.unit, mean, bar })
                .filter(|it| !it.mean.is_nan())
        };
        let (headlines, doubt) = match verdict {
            Verdict::Sound => (headlines, None),
            Verdict::Doubt(why) => (headlines, Some(why)),
            Verdict::None(why) => (&[][..], Some(why)),
        };
        Summed {
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
        let is_density = sum.observable.is_density_of_places();
        let means = (0..function.over.len()).map_while(|place| {
            let [mean, bar] = function.mean_at(place)?;
            // Where no disc was ever seen, nothing tells how seldom one is there.
            Some([mean, if is_density && mean == 0.0 { f64::NAN } else { bar }])
        });
        function.means = means.collect();
        function.over.truncate(function.means.len());
        function
    }
}

/// Of one coordinate itself, of two the distance from the origin.
fn length(place: &[f64]) -> f64 {
    match *place {
        [along] => along,
        _ => place.iter().map(|along| along * along).sum::<f64>().sqrt(),
    }
}

/// Their places where both are kept.
const ROWS: usize = 0;
const SNAPSHOTS: usize = 1;

/// What checkpoints call the spacings of rows and snapshots, the motion, and its numbers.
const SPACINGS: [&str; 2] = ["rows", "snapshots"];
const PASSED: [&str; 2] = ["rows passed", "snapshots passed"];
const MOTION: &str = "motion";
const MOTIONS: [&str; 2] = ["motion first", "motion last"];

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
