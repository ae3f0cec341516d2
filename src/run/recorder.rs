//! The folder of a run: what is written when.

use super::folder::{DATA, DUMP, RunFolder, SCENE, SUMMARY, THERMO, TRAJECTORY};
use super::frames::Frames;
use super::identity::{BITS, Identity, same_scene};
use super::work::{Balance, Work};
use super::{Existing, RunError, Summary};
use crate::io::checkpoint::{Checkpoint, Column, Counter, Latest, NAME, read_latest};
use crate::io::extxyz::{self, Frame};
use crate::io::growing_file::Mark;
use crate::io::table_file::TableFile;
use crate::io::{FileError, lammps};
use crate::method::{Failure, Method, StateColumn, Total, Totals};
use crate::observe::{Observation, Scenery};
use crate::scene::{Checked, Output, Run};
use std::collections::BTreeMap;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The columns of `thermo.csv` after the step.
const COLUMNS: [&str; 17] = [
    "time",
    "kinetic",
    "rotational",
    "elastic",
    "gravitational",
    "dissipated",
    "gravity_work",
    "wall_work",
    "balance_error",
    "momentum_x",
    "momentum_y",
    "temperature",
    "flow",
    "deepest_penetration",
    "contacts",
    "deep_disc_steps",
    "long_steps",
];

/// Writes the files of a run.
pub(super) struct Recorder {
    folder: RunFolder,
    identity: Identity,
    run: Run,
    output: Output,
    seed: Option<u64>,
    scenery: Scenery,
    thermo: TableFile,
    trajectory: Frames,
    dump: Option<Frames>,
    work: Work,
    /// What was out of the ordinary, in the order of the run's sessions.
    notes: Vec<String>,
    /// Which of them are of this session.
    new_notes: usize,
    /// Step of the newest checkpoint, if it says all that there is to say.
    checkpointed: Option<u64>,
}

/// The growing files of a run, verified but not yet cut.
struct Growing {
    thermo: TableFile,
    trajectory: Frames,
    dump: Option<Frames>,
}

impl Recorder {
    /// Begins a run in a folder, or goes on with the one that is there.
    ///
    /// # Errors
    /// [`RunError`]: the folder is another's, or what is there cannot be gone on with.
    pub(super) fn open(
        path: &Path,
        existing: Existing,
        checked: &Checked,
        method: &mut dyn Method,
    ) -> Result<Recorder, RunError> {
        let folder = RunFolder::open(path)?;
        let mut notes = Vec::new();
        if !folder.is_locked() {
            notes.push(format!(
                "{}: this file system has no locks; see that no second process writes there",
                path.display()
            ));
        }
        match existing {
            Existing::Refuse if folder.is_run() => Err(RunError::Exists(path.to_owned())),
            Existing::Resume { other_version } if folder.is_run() => match read_latest(path)? {
                Some(latest) => Recorder::resume(folder, latest, checked, method, other_version, notes),
                None => {
                    begun_with(&folder, &checked.scene.to_toml())?;
                    notes.push("begun again: there was no checkpoint yet".to_owned());
                    Recorder::begin(folder, checked, method, notes)
                }
            },
            _ => Recorder::begin(folder, checked, method, notes),
        }
    }

    /// Begins the files with the state at the start.
    fn begin(
        mut folder: RunFolder,
        checked: &Checked,
        method: &dyn Method,
        notes: Vec<String>,
    ) -> Result<Recorder, RunError> {
        folder.clear()?;
        let output = checked.scene.output;
        folder.claim(&on_request(&output))?;
        let thermo = TableFile::create(folder.file(THERMO), &COLUMNS)?;
        let trajectory = Frames::create(folder.file(TRAJECTORY), extxyz::write)?;
        let dump = match output.lammps_dump {
            true => Some(Frames::create(folder.file(DUMP), lammps::write_dump)?),
            false => None,
        };
        let work = work_from(checked, method);
        let growing = Growing { thermo, trajectory, dump };
        let mut recorder = Recorder::with(folder, checked, growing, work, notes);
        recorder.new_notes = recorder.notes.len();
        recorder.write_scene()?;
        if let Some(failure) = recorder.thermo(method)? {
            return Err(RunError::Start(failure));
        }
        recorder.snapshot(method)?;
        Ok(recorder)
    }

    fn with(
        folder: RunFolder,
        checked: &Checked,
        Growing { thermo, trajectory, dump }: Growing,
        work: Work,
        notes: Vec<String>,
    ) -> Recorder {
        Recorder {
            folder,
            identity: Identity::of(checked),
            run: checked.scene.run,
            output: checked.scene.output,
            seed: super::summary::seed(&checked.scene.start),
            scenery: Scenery::of(&super::model(checked)),
            thermo,
            trajectory,
            dump,
            work,
            notes,
            new_notes: 0,
            checkpointed: None,
        }
    }

    /// Takes up a checkpoint: the files are cut where it was written. Nothing is changed before everything is verified.
    fn resume(
        mut folder: RunFolder,
        latest: Latest,
        checked: &Checked,
        method: &mut dyn Method,
        other_version: bool,
        session: Vec<String>,
    ) -> Result<Recorder, RunError> {
        let newest = folder.file(NAME);
        let foreign = |reason: String| RunError::Foreign { file: latest.file.clone(), reason };
        let mut checkpoint = latest.checkpoint;
        let said = checkpoint.origin.get("notes").map_or(0, |notes| notes.lines().count());
        let mut notes = Identity::of(checked).check(folder.path(), &checkpoint, other_version)?;
        notes.extend(session);
        if latest.file != newest {
            notes.push(format!(
                "{} was missing: gone on from the older checkpoint, of step {}",
                newest.display(),
                checkpoint.step
            ));
        }
        let (done, asked) = (checkpoint.step, checked.scene.run.steps);
        if done > asked {
            return Err(RunError::FewerSteps { folder: folder.path().to_owned(), done, asked });
        }
        let count = |name: &str| match checkpoint.counters.get(name) {
            Some(Counter::Count(count)) => Ok(*count),
            _ => Err(foreign(format!("the counter {name} is missing"))),
        };
        let totals = Totals::from_entries(|name| match checkpoint.counters.get(name)? {
            Counter::Count(count) => Some(Total::Count(*count)),
            Counter::Sum(sum) => Some(Total::Sum(*sum)),
        });
        let totals = totals.map_err(|name| foreign(format!("the total {name} is missing")))?;
        let mark = |file: &str| -> Result<Mark, RunError> {
            let checksum = count(&format!("{file} checksum"))?;
            let checksum = u32::try_from(checksum)
                .map_err(|_| foreign(format!("the checksum of {file} has more than 32 bits")))?;
            Ok(Mark { bytes: count(&format!("{file} bytes"))?, checksum })
        };
        let last_frame = |file: &str| count(&format!("{file} last")).ok();
        let mut growing = Growing {
            thermo: TableFile::resume(folder.file(THERMO), &COLUMNS, mark(THERMO)?)?,
            trajectory: Frames::resume(
                folder.file(TRAJECTORY),
                extxyz::write,
                mark(TRAJECTORY)?,
                last_frame(TRAJECTORY),
            )?,
            dump: match mark(DUMP) {
                Ok(mark) => {
                    Some(Frames::resume(folder.file(DUMP), lammps::write_dump, mark, last_frame(DUMP))?)
                }
                Err(_) => None,
            },
        };
        let mut state = Vec::new();
        for (name, column) in std::mem::take(&mut checkpoint.columns) {
            match column {
                Column::F64(values) => state.push((name, StateColumn::F64(values))),
                Column::F32(values) => state.push((name, StateColumn::F32(values))),
                _ => return Err(foreign(format!("the column {name} is of no state"))),
            }
        }
        // The method is at the start still, as it was when the run began.
        let work = work_from(checked, method);
        method.restore(checkpoint.step, totals, state).map_err(foreign)?;

        let output = checked.scene.output;
        folder.claim(&on_request(&output))?;
        growing.thermo.cut()?;
        growing.trajectory.cut()?;
        match &mut growing.dump {
            Some(dump) => dump.cut()?,
            // Begun after the checkpoint, if it is there at all.
            None => folder.remove_own(DUMP)?,
        }
        if growing.dump.is_none() && output.lammps_dump {
            growing.dump = Some(Frames::create(folder.file(DUMP), lammps::write_dump)?);
        }
        // They speak of an end that is not reached yet.
        folder.remove_own(SUMMARY)?;
        folder.remove_own(DATA)?;
        let mut recorder = Recorder::with(folder, checked, growing, work, notes);
        recorder.new_notes = recorder.notes.len() - said;
        recorder.checkpointed = (recorder.new_notes == 0).then_some(checkpoint.step);
        recorder.write_scene()?;
        Ok(recorder)
    }

    /// What this session found out of the ordinary when it began.
    pub(super) fn new_notes(&self) -> &[String] {
        &self.notes[self.notes.len() - self.new_notes..]
    }

    fn write_scene(&self) -> Result<(), RunError> {
        Ok(self.folder.write(SCENE, |out| out.write_all(self.identity.scene.as_bytes()))?)
    }

    /// What is due after a step; gives the failure that only sums over all discs show.
    pub(super) fn after_step(&mut self, method: &dyn Method) -> Result<Option<Failure>, RunError> {
        let due = |every: u64| every > 0 && method.steps().is_multiple_of(every);
        if due(self.run.thermo_every)
            && let Some(failure) = self.thermo(method)?
        {
            return Ok(Some(failure));
        }
        if due(self.run.snapshot_every) {
            self.snapshot(method)?;
        }
        if due(self.run.checkpoint_every) {
            self.checkpoint(method)?;
        }
        Ok(None)
    }

    /// The balance of energy as it stands.
    pub(super) fn balance(&self, method: &dyn Method) -> Balance {
        let particles = method.particles();
        let seen = Observation::of(method.steps(), method.time(), &particles, &self.scenery);
        self.work.balance(&seen, &particles, method)
    }

    /// A row of observables, unless one of them is no finite number.
    fn thermo(&mut self, method: &dyn Method) -> Result<Option<Failure>, RunError> {
        let particles = method.particles();
        let seen = Observation::of(method.steps(), method.time(), &particles, &self.scenery);
        let (balance, totals) = (self.work.balance(&seen, &particles, method), method.totals());
        let row = [
            seen.time,
            seen.kinetic,
            seen.rotational,
            seen.elastic,
            seen.gravitational,
            balance.dissipated,
            balance.gravity_work,
            balance.wall_work,
            balance.balance_error,
            seen.momentum_x,
            seen.momentum_y,
            seen.temperature,
            seen.flow,
            seen.deepest_penetration,
            seen.contacts as f64,
            totals.deep_disc_steps as f64,
            totals.long_steps as f64,
        ];
        if let Some((&quantity, &value)) = COLUMNS.iter().zip(&row).find(|(_, value)| !value.is_finite()) {
            return Ok(Some(Failure::Overflow { step: seen.step, quantity, value }));
        }
        self.thermo.append(seen.step, &row)?;
        Ok(None)
    }

    fn frame(&self, method: &dyn Method) -> Frame {
        let domain = self.scenery.domain;
        Frame {
            particles: method.particles(),
            cell: domain.sides,
            origin: domain.origin,
            periodic: Some(domain.periodic),
            time: method.time(),
            step: method.steps(),
            seed: self.seed,
        }
    }

    /// A frame in each of the files that are asked for and do not have it yet.
    fn snapshot(&mut self, method: &dyn Method) -> Result<(), RunError> {
        let frame = self.frame(method);
        if self.output.trajectory {
            self.trajectory.add(&frame)?;
        }
        if let Some(dump) = self.dump.as_mut().filter(|_| self.output.lammps_dump) {
            dump.add(&frame)?;
        }
        Ok(())
    }

    /// The state of a failed step, whether snapshots are due or not, and what there is to say of it.
    pub(super) fn fail(&mut self, method: &dyn Method, summary: Summary) -> Result<(), RunError> {
        self.trajectory.add(&self.frame(method))?;
        self.sync()?;
        self.summary(summary).map(drop)
    }

    /// Where the frames are.
    pub(super) fn trajectory_path(&self) -> PathBuf {
        self.folder.file(TRAJECTORY)
    }

    /// Returns when everything is on the disk; gives what a checkpoint keeps of it.
    fn sync(&mut self) -> Result<BTreeMap<String, Counter>, RunError> {
        let mut counters = BTreeMap::new();
        let mut keep = |file: &str, mark: Mark, last: Option<u64>| {
            counters.insert(format!("{file} bytes"), Counter::Count(mark.bytes));
            counters.insert(format!("{file} checksum"), Counter::Count(mark.checksum.into()));
            last.map(|step| counters.insert(format!("{file} last"), Counter::Count(step)));
        };
        keep(THERMO, self.thermo.sync()?, None);
        let (mark, last) = self.trajectory.sync()?;
        keep(TRAJECTORY, mark, last);
        if let Some(dump) = &mut self.dump {
            let (mark, last) = dump.sync()?;
            keep(DUMP, mark, last);
        }
        Ok(counters)
    }

    /// The complete state, after everything before it is on the disk.
    pub(super) fn checkpoint(&mut self, method: &dyn Method) -> Result<(), RunError> {
        if self.checkpointed == Some(method.steps()) {
            return Ok(());
        }
        let mut counters = self.sync()?;
        counters.insert("bits".to_owned(), Counter::Count(BITS));
        counters.extend(method.totals().entries().into_iter().map(|(name, total)| match total {
            Total::Count(count) => (name.to_owned(), Counter::Count(count)),
            Total::Sum(sum) => (name.to_owned(), Counter::Sum(sum)),
        }));
        let state = method.state().into_iter().map(|(name, column)| match column {
            StateColumn::F64(values) => (name, Column::F64(values)),
            StateColumn::F32(values) => (name, Column::F32(values)),
        });
        let columns: Vec<(String, Column)> = state.collect();
        let checkpoint = Checkpoint {
            step: method.steps(),
            time: method.time(),
            scene: self.identity.scene.clone(),
            origin: self.identity.origin(&self.notes),
            counters,
            columns,
        };
        checkpoint.write_atomically(self.folder.file(NAME))?;
        self.checkpointed = Some(method.steps());
        // Later than the checkpoint, so that what is still there can be gone on with.
        Ok(self.folder.check(true)?)
    }

    /// The end: a last checkpoint, the last state in every file that is asked for, and what there is to say. The frame comes
    /// after the checkpoint, so that it is cut off again where a run goes on to more steps.
    pub(super) fn finish(&mut self, method: &dyn Method, summary: Summary) -> Result<Summary, RunError> {
        self.checkpoint(method)?;
        self.snapshot(method)?;
        self.sync()?;
        if self.output.lammps_data {
            let frame = self.frame(method);
            self.folder.write(DATA, |out| lammps::write_data(&frame, out))?;
        }
        self.summary(summary)
    }

    /// `summary.json`.
    fn summary(&self, mut summary: Summary) -> Result<Summary, RunError> {
        summary.notes.clone_from(&self.notes);
        self.folder.write(SUMMARY, |out| {
            serde_json::to_writer_pretty(&mut *out, &summary)?;
            writeln!(out)
        })?;
        self.folder.check(self.checkpointed.is_some())?;
        Ok(summary)
    }
}

/// The balance of energy of a run whose method is at the start.
fn work_from(checked: &Checked, method: &dyn Method) -> Work {
    let scenery = Scenery::of(&super::model(checked));
    let particles = method.particles();
    let first = Observation::of(method.steps(), method.time(), &particles, &scenery);
    Work::begin(&first, &particles, scenery.domain, scenery.gravity)
}

/// The files that a scene asks for beyond what every run writes.
fn on_request(output: &Output) -> Vec<&'static str> {
    let asked = [(output.lammps_dump, DUMP), (output.lammps_data, DATA)];
    asked.into_iter().filter_map(|(asked, name)| asked.then_some(name)).collect()
}

/// Refuses another scene than that of a run which has no checkpoint yet.
fn begun_with(folder: &RunFolder, scene: &str) -> Result<(), RunError> {
    let path = folder.file(SCENE);
    match fs::read_to_string(&path) {
        Ok(theirs) => same_scene(folder.path(), &theirs, scene),
        Err(cause) if cause.kind() == ErrorKind::NotFound => Ok(()),
        Err(cause) => Err(FileError::at(&path, "reading")(cause).into()),
    }
}
