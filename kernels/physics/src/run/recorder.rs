//! Folder of a run and the schedule of its files.

mod changed;

use super::changes::{CHANGE_COUNT, CHANGES, ChangeLog};
use super::finished::rows_of;
use super::folder::{
    ALWAYS, CHECKPOINTS, LONGEST_SCENE, RUN, RunFolder, SCENE, SUMMARY, THERMO, files_to_resume,
};
use super::goal::{RunGoal, TargetProgress};
use super::growing::{GrowingFiles, run_file_names};
use super::identity::{BITS, RunIdentity, same_scene};
use super::moments::{header_of, moment_of};
use super::structured::StructureSampler;
use super::table::TableReader;
use super::{ExistingRun, RunError, RunJob, Summary};
use crate::averages::{AveragedRows, RunAverages};
use crate::io::checkpoint::{Checkpoint, CheckpointCounter, LatestCheckpoint, NAME, read_latest};
use crate::io::output_format::{FrameWriting, OutputFormat};
use crate::io::run_moment::RunHeader;
use crate::io::sink::WriteOccasion;
use crate::io::{FORMATS, FileError, regular_file};
use crate::method::{
    Clock, Every, FailureKind, ObservedQuantity, PhysicsFailure, Schedule, Simulation, Snapshot, Until,
    is_sound,
};
use crate::quoted;
use crate::scene::Output;
use crate::structure::OBSERVABLES;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Name of the counter of events in a checkpoint.
const EVENT_COUNT: &str = "events";

/// Writer of a run's files.
pub(super) struct RunRecorder {
    identity: RunIdentity,
    schedule: Schedule,
    output: Output,
    header: RunHeader,
    quantities: &'static [ObservedQuantity],
    /// Times at which the next row, snapshot and checkpoint are due.
    due: [Option<Until>; 3],
    growing: GrowingFiles,
    /// Dropped after what grows in it: until the last frame is written, no other process may have the folder.
    folder: RunFolder,
    /// Changes by the user.
    pub(super) changes: ChangeLog,
    /// Structure functions.
    structured: StructureSampler,
    /// Rows of observables, those of earlier sessions included.
    rows: AveragedRows,
    /// Target error that ends the run, if there is one.
    goal: Option<RunGoal>,
    /// Unusual findings, in the order of the run's sessions.
    notes: Vec<String>,
    /// Number of notes of this session.
    new_notes: usize,
    /// Moment of the newest checkpoint, if it is complete.
    checkpointed: Option<Clock>,
    /// Wall time of the last checkpoint or of the start.
    unsaved_since: Instant,
}

/// Results of reading the particles at the start, which a simulation may release.
pub(super) struct OfTheStart {
    identity: RunIdentity,
    /// Structure functions without samples.
    structured: StructureSampler,
}

impl OfTheStart {
    /// Reads the particles of a job whose run is in `folder`.
    pub(super) fn new(job: &RunJob<'_>, folder: &Path) -> OfTheStart {
        OfTheStart {
            identity: RunIdentity::of(job, folder),
            structured: StructureSampler::new(&job.prepared),
        }
    }
}

impl RunRecorder {
    /// Starts a run in a folder, or resumes the one in it.
    ///
    /// # Errors
    /// [`RunError`] if the folder belongs to others, or its run cannot be resumed.
    pub(super) fn open(
        path: &Path,
        existing: ExistingRun,
        job: (&RunJob<'_>, OfTheStart),
        simulation: &mut dyn Simulation,
    ) -> Result<RunRecorder, RunError> {
        let folder = RunFolder::open(path, RUN, &[])?;
        let mut notes = Vec::new();
        if !folder.is_locked() {
            notes.push(format!(
                "{}: this file system has no locks; make sure that no other process writes there",
                quoted::path(path)
            ));
        }
        match existing {
            ExistingRun::Refuse if folder.has_own() => Err(RunError::Exists(path.to_owned())),
            ExistingRun::Resume { other_version } if folder.has_own() => match read_latest(path)? {
                Some(latest) => RunRecorder::resume(folder, latest, job, simulation, other_version, notes),
                None => {
                    check_scene_of_start(&folder, &job.1.identity.scene)?;
                    notes.push("started again: there was no checkpoint yet".to_owned());
                    RunRecorder::begin(folder, job, simulation, notes)
                }
            },
            _ => RunRecorder::begin(folder, job, simulation, notes),
        }
    }

    /// Creates the files and writes the initial state.
    fn begin(
        mut folder: RunFolder,
        (job, of_the_start): (&RunJob<'_>, OfTheStart),
        simulation: &mut dyn Simulation,
        notes: Vec<String>,
    ) -> Result<RunRecorder, RunError> {
        folder.clear(&CHECKPOINTS)?;
        folder.claim(ALWAYS.into_iter().chain(run_file_names(&job.prepared)), false)?;
        let header = header_of(&job.prepared, job.quantities, simulation);
        let growing = GrowingFiles::begin(&folder, &job.prepared, &header)?;
        let clock = simulation.clock();
        let changes = ChangeLog::begin(folder.file(CHANGES));
        let files = (growing, header, changes);
        let mut recorder = RunRecorder::with(folder, (job, of_the_start), files, &clock, notes);
        recorder.new_notes = recorder.notes.len();
        recorder.write_scene()?;
        if let Some(failure) = recorder.add_thermo_row(simulation)? {
            return Err(RunError::Start(failure));
        }
        recorder.snapshot(simulation)?;
        Ok(recorder)
    }

    fn with(
        folder: RunFolder,
        (&RunJob { ref prepared, quantities, .. }, of_the_start): (&RunJob<'_>, OfTheStart),
        (growing, header, changes): (GrowingFiles, RunHeader, ChangeLog),
        clock: &Clock,
        notes: Vec<String>,
    ) -> RunRecorder {
        let OfTheStart { identity, structured } = of_the_start;
        let schedule = prepared.schedule;
        let due = [schedule.rows, schedule.snapshots, schedule.checkpoints].map(|every| every.next(clock));
        RunRecorder {
            folder,
            identity,
            schedule,
            output: prepared.output.clone(),
            header,
            quantities,
            due,
            growing,
            structured,
            rows: AveragedRows::new(quantities),
            changes,
            goal: RunGoal::of(prepared, quantities),
            notes,
            new_notes: 0,
            checkpointed: None,
            unsaved_since: Instant::now(),
        }
    }

    /// Resumes from a checkpoint and truncates the files at it. Nothing is changed before everything is verified.
    fn resume(
        mut folder: RunFolder,
        latest: LatestCheckpoint,
        (job, mut of_the_start): (&RunJob<'_>, OfTheStart),
        simulation: &mut dyn Simulation,
        other_version: bool,
        session: Vec<String>,
    ) -> Result<RunRecorder, RunError> {
        let &RunJob { ref prepared, quantities, .. } = job;
        let newest = folder.file(NAME);
        let foreign = |reason: String| RunError::Foreign { file: latest.file.clone(), reason };
        let mut checkpoint = latest.checkpoint;
        let [events, made] = [EVENT_COUNT, CHANGE_COUNT].map(|name| take_count(&mut checkpoint, name));
        let clock = Clock { steps: checkpoint.step, time: checkpoint.time, events };
        let changes = ChangeLog::resume(folder.file(CHANGES), made)?;
        let said = checkpoint.origin.get("notes").map_or(0, |notes| notes.lines().count());
        let mut notes = of_the_start.identity.check(folder.path(), &checkpoint, clock, other_version)?;
        notes.extend(session);
        if latest.file != newest {
            notes.push(format!(
                "{} was missing: resumed from the older checkpoint, of {clock}",
                quoted::path(&newest)
            ));
        }
        let asked = prepared.schedule.until;
        if asked.is_exceeded(&clock) && !job.is_open_ended {
            let done = match asked {
                Until::Steps(_) => Until::Steps(clock.steps),
                Until::Time(_) => Until::Time(clock.time),
                Until::Events(_) => Until::Events(clock.events),
            };
            return Err(RunError::FewerSteps { folder: folder.path().to_owned(), done, asked });
        }
        let header = header_of(prepared, quantities, simulation);
        let mut growing =
            GrowingFiles::resume(&folder, prepared, &header, (&checkpoint.counters, &mut notes), foreign)?;
        of_the_start.structured.resume(&checkpoint, &mut notes).map_err(foreign)?;
        let snapshot = Snapshot {
            counters: std::mem::take(&mut checkpoint.counters),
            columns: std::mem::take(&mut checkpoint.columns),
        };
        let restored = simulation.restore(clock, snapshot);
        unless_rank_lost(simulation, restored)?.map_err(foreign)?;

        folder.claim(ALWAYS.into_iter().chain(run_file_names(prepared)), false)?;
        growing.cut(&folder, &header)?;
        // These files describe an end that the resumed run has not reached.
        folder.remove_own(SUMMARY)?;
        let last = FORMATS.iter().filter(|format| matches!(format.writing, FrameWriting::Last(_)));
        let mut of_the_end = last.map(|format| format.file).chain(OBSERVABLES.iter().map(|it| it.file));
        of_the_end.try_for_each(|name| folder.remove_own(name))?;
        let files = (growing, header, changes);
        let mut recorder = RunRecorder::with(folder, (job, of_the_start), files, &clock, notes);
        recorder.new_notes = recorder.notes.len() - said;
        recorder.checkpointed = (recorder.new_notes == 0).then_some(clock);
        recorder.write_scene()?;
        recorder.rows = rows_of(TableReader::open(&recorder.folder.file(THERMO))?, quantities)?;
        Ok(recorder)
    }

    /// Averages over the rows so far.
    pub(super) fn averages(&self) -> RunAverages {
        RunAverages::of(&self.rows)
    }

    /// Returns true if the target error is reached.
    pub(super) fn has_reached_goal(&mut self) -> bool {
        self.goal.as_mut().is_some_and(|goal| goal.is_reached(&self.rows))
    }

    /// Goal and present error; none if there is no goal, or it is reached.
    pub(super) fn missed_goal(&self) -> Option<(&RunGoal, TargetProgress)> {
        let goal = self.goal.as_ref()?;
        let known = goal.progress_to_target(&self.rows);
        (!known.is_enough).then_some((goal, known))
    }

    /// Unusual findings at the start of this session.
    pub(super) fn new_notes(&self) -> &[String] {
        &self.notes[self.notes.len() - self.new_notes..]
    }

    fn write_scene(&self) -> Result<(), RunError> {
        Ok(self.folder.write(SCENE, |out| out.write_all(self.identity.scene.as_bytes())).map(drop)?)
    }

    /// Moments at which something is due.
    pub(super) fn due(&self) -> impl Iterator<Item = Until> {
        self.due.into_iter().flatten()
    }

    /// Writes everything due; returns a failure that only sums over all particles reveal.
    pub(super) fn write_due_outputs(
        &mut self,
        simulation: &mut dyn Simulation,
    ) -> Result<Option<PhysicsFailure>, RunError> {
        let clock = simulation.clock();
        let [rows, snapshots, mut checkpoints] =
            self.due.map(|due| due.is_some_and(|moment| moment.has_been_reached(&clock)));
        let Schedule { rows: row, snapshots: snapshot, checkpoints: checkpoint, .. } = self.schedule;
        if let Every::Seconds(seconds) = checkpoint {
            checkpoints = self.unsaved_since.elapsed().as_secs_f64() >= seconds;
        }
        if rows {
            self.due[0] = row.next(&clock);
            if let Some(failure) = self.add_thermo_row(simulation)? {
                return Ok(Some(failure));
            }
        }
        let moment = moment_of(simulation, &self.header, &self.rows);
        if rows {
            self.structured.row(&moment);
        }
        if snapshots {
            self.due[1] = snapshot.next(&clock);
            self.structured.snapshot(&moment);
            self.growing.add(WriteOccasion::Frame, &moment, clock)?;
        }
        unless_rank_lost(simulation, ())?;
        // A checkpoint needs the memory of its frame.
        drop(moment);
        if checkpoints {
            self.due[2] = checkpoint.next(&clock);
            self.checkpoint(simulation)?;
        }
        Ok(None)
    }

    /// Adds rows of events, if the scene requests them.
    pub(super) fn log(&mut self, simulation: &mut dyn Simulation) -> Result<(), RunError> {
        let events = simulation.take_events();
        let mut moment = moment_of(simulation, &self.header, &self.rows);
        moment.events = &events;
        self.growing.add(WriteOccasion::Events, &moment, simulation.clock())
    }

    /// Adds a row of observables, unless one of them is not finite though it must be.
    fn add_thermo_row(
        &mut self,
        simulation: &mut dyn Simulation,
    ) -> Result<Option<PhysicsFailure>, RunError> {
        if let Err(failure) = simulation.check() {
            return Ok(Some(failure));
        }
        let (clock, row) = (simulation.clock(), simulation.row());
        let row = unless_rank_lost(simulation, row)?;
        let named = self.quantities.iter().zip(&row);
        if let Some((quantity, &value)) = named.into_iter().find(|(it, value)| !is_sound(it.name, **value)) {
            return Ok(Some(overflow(clock, quantity.name, value)));
        }
        let mut moment = moment_of(simulation, &self.header, &self.rows);
        moment.row = Some(&row);
        self.growing.add(WriteOccasion::Row, &moment, clock)?;
        self.rows.add(&row);
        Ok(None)
    }

    /// Adds a frame to the requested files that do not have it yet.
    fn snapshot(&mut self, simulation: &dyn Simulation) -> Result<(), RunError> {
        let moment = moment_of(simulation, &self.header, &self.rows);
        let added = self.growing.add(WriteOccasion::Frame, &moment, simulation.clock());
        unless_rank_lost(simulation, added)?
    }

    /// Writes the state of a failed step, also if no snapshot is due, and its summary. If a rank is lost, its part of the state is unknown and no
    /// frame is written.
    pub(super) fn write_failure(
        &mut self,
        simulation: &dyn Simulation,
        summary: Summary,
    ) -> Result<(), RunError> {
        if simulation.check_ranks().is_ok() {
            let moment = moment_of(simulation, &self.header, &self.rows);
            self.growing.add_to(self.trajectory().file, &moment, simulation.clock())?;
        }
        self.growing.mark()?;
        self.summary(summary).map(drop)
    }

    /// First requested format that can be read back; without one, the first that every run has.
    fn trajectory(&self) -> &'static OutputFormat {
        let mut read = FORMATS.iter().filter(|format| format.is_read());
        read.find(|format| self.output.asks_for(format)).unwrap_or(&FORMATS[0])
    }

    /// Path of the file with the frames.
    pub(super) fn trajectory_path(&self) -> PathBuf {
        self.folder.file(self.trajectory().file)
    }

    /// Writes a checkpoint, after everything before it is on the disk.
    pub(super) fn checkpoint(&mut self, simulation: &dyn Simulation) -> Result<(), RunError> {
        let clock = simulation.clock();
        if self.checkpointed == Some(clock) {
            return Ok(());
        }
        let mut counters = self.growing.mark()?;
        counters.insert("bits".to_owned(), CheckpointCounter::Count(BITS));
        counters.insert(EVENT_COUNT.to_owned(), CheckpointCounter::Count(clock.events));
        if self.changes.made > 0 {
            counters.insert(CHANGE_COUNT.to_owned(), CheckpointCounter::Count(self.changes.made));
        }
        let mut snapshot = unless_rank_lost(simulation, simulation.snapshot())?;
        self.structured.keep(&mut snapshot);
        counters.extend(snapshot.counters);
        let checkpoint = Checkpoint {
            step: clock.steps,
            time: clock.time,
            scene: self.identity.scene.clone(),
            origin: self.identity.origin(&self.notes),
            counters,
            columns: snapshot.columns,
        };
        checkpoint.write_atomically(self.folder.file(NAME))?;
        self.checkpointed = Some(clock);
        self.unsaved_since = Instant::now();
        // This check follows the checkpoint, so that the remaining files can be resumed.
        Ok(self.folder.check_still_there(files_to_resume(true))?)
    }

    /// Ends the run: writes a last checkpoint, the last state in every requested file, and the summary. The frame follows the checkpoint, so that
    /// it is truncated if the run is resumed for more steps.
    pub(super) fn finish(
        &mut self,
        simulation: &dyn Simulation,
        summary: Summary,
    ) -> Result<Summary, RunError> {
        let summary = unless_rank_lost(simulation, summary)?;
        self.checkpoint(simulation)?;
        let moment = moment_of(simulation, &self.header, &self.rows);
        self.growing.add(WriteOccasion::Frame, &moment, simulation.clock())?;
        self.growing.mark()?;
        unless_rank_lost(simulation, ())?;
        for format in FORMATS.iter().filter(|format| self.output.asks_for(format)) {
            if let FrameWriting::Last(write) = format.writing {
                let frame = unless_rank_lost(simulation, moment.frame())?;
                self.folder.write(format.file, |out| write(frame, out))?;
            }
        }
        self.structured.write(&self.folder)?;
        self.summary(summary)
    }

    /// Writes `summary.json`.
    fn summary(&self, mut summary: Summary) -> Result<Summary, RunError> {
        summary.notes.clone_from(&self.notes);
        summary.structure = self.structured.summed();
        self.folder.write(SUMMARY, |out| {
            serde_json::to_writer_pretty(&mut *out, &summary)?;
            writeln!(out)
        })?;
        self.folder.check_still_there(files_to_resume(self.checkpointed.is_some()))?;
        Ok(summary)
    }
}

/// Takes a count out of a checkpoint; 0 if there is none.
fn take_count(checkpoint: &mut Checkpoint, name: &str) -> u64 {
    match checkpoint.counters.remove(name) {
        Some(CheckpointCounter::Count(count)) => count,
        _ => 0,
    }
}

/// Passes on a value read from a simulation; an error if a rank is lost.
fn unless_rank_lost<T>(simulation: &dyn Simulation, seen: T) -> Result<T, RunError> {
    simulation.check_ranks().map(|()| seen).map_err(RunError::Lost)
}

/// Failure of a sum over all particles that overflows.
fn overflow(at: Clock, quantity: &'static str, value: f64) -> PhysicsFailure {
    let what = format!("{quantity} is {value}, which is not a finite number");
    let remedy = "the units make masses, speeds or stiffness too large for double precision; choose units in which they are \
                  nearer to 1";
    PhysicsFailure::new(FailureKind::OVERFLOW, what, remedy).at(at).with([(quantity, value)])
}

/// Refuses another scene than that of a run without a checkpoint.
fn check_scene_of_start(folder: &RunFolder, scene: &str) -> Result<(), RunError> {
    let path = folder.file(SCENE);
    match regular_file::read(&path, LONGEST_SCENE) {
        Ok(theirs) => same_scene(folder.path(), &String::from_utf8_lossy(&theirs), scene),
        Err(cause) if cause.kind() == ErrorKind::NotFound => Ok(()),
        Err(cause) => Err(FileError::at(&path, "reading")(cause).into()),
    }
}
