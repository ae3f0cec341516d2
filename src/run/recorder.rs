//! The folder of a run: what is written when.

use super::work::{Balance, Work};
use super::{RunError, Summary};
use crate::io::checkpoint::{Checkpoint, Column, Counter, NAME, read_latest};
use crate::io::extxyz::{Frame, Trajectory};
use crate::io::table_file::TableFile;
use crate::io::{FileError, lammps};
use crate::method::{Failure, Method, StateColumn, Total, Totals};
use crate::observe::{Observation, Scenery};
use crate::report::origin::Origin;
use crate::scene::Checked;
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// The columns of `thermo.csv` after the step.
const THERMO: [&str; 17] = [
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
    folder: PathBuf,
    scene: String,
    run: crate::scene::Run,
    output: crate::scene::Output,
    seed: Option<u64>,
    scenery: Scenery,
    thermo: TableFile,
    trajectory: Trajectory,
    work: Work,
}

impl Recorder {
    /// Whether a folder holds a run.
    pub(super) fn is_run(folder: &Path) -> bool {
        ["thermo.csv", "summary.json", NAME].iter().any(|name| folder.join(name).exists())
    }

    /// Begins the files with the state at the start.
    pub(super) fn begin(folder: &Path, checked: &Checked, method: &dyn Method) -> Result<Recorder, RunError> {
        fs::create_dir_all(folder).map_err(FileError::at(folder, "creating the folder"))?;
        for stale in ["summary.json", "dump.lammpstrj", "final.data", NAME, "run.checkpoint.previous"] {
            let path = folder.join(stale);
            if path.exists() {
                fs::remove_file(&path)
                    .map_err(FileError::at(&path, "removing the file of an earlier run"))?;
            }
        }
        let thermo = TableFile::create(folder.join("thermo.csv"), &THERMO)?;
        let trajectory = Trajectory::create(folder.join("trajectory.xyz"))?;
        let work = work_from(checked, method);
        let mut recorder = Recorder::with(folder, checked, thermo, trajectory, work);
        recorder.write("scene.toml", &recorder.scene)?;
        recorder.thermo(method)?;
        recorder.snapshot(method)?;
        Ok(recorder)
    }

    fn with(
        folder: &Path,
        checked: &Checked,
        thermo: TableFile,
        trajectory: Trajectory,
        work: Work,
    ) -> Recorder {
        Recorder {
            folder: folder.to_owned(),
            scene: checked.scene.to_toml(),
            run: checked.scene.run,
            output: checked.scene.output,
            seed: super::summary::seed(&checked.scene.start),
            scenery: Scenery::of(&super::model(checked)),
            thermo,
            trajectory,
            work,
        }
    }

    /// Takes up the newest checkpoint of a folder: the files are cut where it was written.
    pub(super) fn resume(
        folder: &Path,
        checked: &Checked,
        method: &mut dyn Method,
    ) -> Result<Recorder, RunError> {
        let latest = read_latest(folder)?.ok_or_else(|| RunError::NothingToResume(folder.to_owned()))?;
        let foreign = |reason: String| RunError::Foreign { file: latest.file.clone(), reason };
        let mut checkpoint = latest.checkpoint;
        same_scene(folder, &checkpoint.scene, &checked.scene.to_toml())?;
        let totals = Totals::from_entries(|name| match checkpoint.counters.get(name)? {
            Counter::Count(count) => Some(Total::Count(*count)),
            Counter::Sum(sum) => Some(Total::Sum(*sum)),
        });
        let totals = totals.map_err(|name| foreign(format!("the total {name} is missing")))?;
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
        let thermo = TableFile::resume(folder.join("thermo.csv"), &THERMO, checkpoint.step)?;
        let trajectory = Trajectory::resume(folder.join("trajectory.xyz"), checkpoint.step)?;
        lammps::cut_dump(&folder.join("dump.lammpstrj"), checkpoint.step)?;
        let recorder = Recorder::with(folder, checked, thermo, trajectory, work);
        recorder.write("scene.toml", &recorder.scene)?;
        Ok(recorder)
    }

    fn write(&self, name: &str, text: &str) -> Result<(), RunError> {
        let path = self.folder.join(name);
        Ok(fs::write(&path, text).map_err(FileError::at(&path, "writing"))?)
    }

    /// What is due after a step.
    pub(super) fn after_step(&mut self, method: &dyn Method) -> Result<(), RunError> {
        let due = |every: u64| every > 0 && method.steps().is_multiple_of(every);
        if due(self.run.thermo_every) {
            self.thermo(method)?;
        }
        if due(self.run.snapshot_every) {
            self.snapshot(method)?;
        }
        if due(self.run.checkpoint_every) {
            self.checkpoint(method)?;
        }
        Ok(())
    }

    fn thermo(&mut self, method: &dyn Method) -> Result<(), RunError> {
        let particles = method.particles();
        let seen = Observation::of(method.steps(), method.time(), &particles, &self.scenery);
        let balance = self.work.balance(&seen, &particles, method);
        let totals = method.totals();
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
        if let Some((&quantity, &value)) = THERMO.iter().zip(&row).find(|(_, value)| !value.is_finite()) {
            let failure = Failure::Overflow { step: seen.step, quantity, value };
            return Err(RunError::Physics { failure, snapshot: self.trajectory_path() });
        }
        Ok(self.thermo.append(seen.step, &row)?)
    }

    fn frame(&self, method: &dyn Method) -> Frame {
        let domain = self.scenery.domain;
        Frame {
            particles: method.particles(),
            cell: domain.sides,
            origin: domain.origin,
            periodic: domain.periodic,
            time: method.time(),
            step: method.steps(),
            seed: self.seed,
        }
    }

    fn snapshot(&mut self, method: &dyn Method) -> Result<(), RunError> {
        let frame = self.frame(method);
        if self.output.trajectory {
            self.trajectory.append(&frame)?;
        }
        if self.output.lammps_dump {
            let path = self.dump_path();
            let file = OpenOptions::new().create(true).append(true).open(&path);
            let mut out = BufWriter::new(file.map_err(FileError::at(&path, "opening"))?);
            lammps::write_dump(&frame, &mut out)
                .and_then(|()| out.flush())
                .map_err(FileError::at(&path, "writing"))?;
        }
        Ok(())
    }

    /// The state of a failed step, whether snapshots are due or not.
    pub(super) fn last_frame(&mut self, method: &dyn Method) -> Result<(), RunError> {
        self.trajectory.append(&self.frame(method))?;
        self.trajectory.sync()?;
        Ok(self.thermo.sync()?)
    }

    /// Where the frames are.
    pub(super) fn trajectory_path(&self) -> PathBuf {
        self.folder.join("trajectory.xyz")
    }

    fn dump_path(&self) -> PathBuf {
        self.folder.join("dump.lammpstrj")
    }

    /// The complete state, after everything before it is on the disk.
    pub(super) fn checkpoint(&mut self, method: &dyn Method) -> Result<(), RunError> {
        self.thermo.sync()?;
        self.trajectory.sync()?;
        let path = self.dump_path();
        if self.output.lammps_dump && path.exists() {
            File::open(&path)
                .and_then(|dump| dump.sync_data())
                .map_err(FileError::at(&path, "writing the dump"))?;
        }
        let counters: BTreeMap<String, Counter> = (method.totals().entries().into_iter())
            .map(|(name, total)| match total {
                Total::Count(count) => (name.to_owned(), Counter::Count(count)),
                Total::Sum(sum) => (name.to_owned(), Counter::Sum(sum)),
            })
            .collect();
        let state = method.state().into_iter().map(|(name, column)| match column {
            StateColumn::F64(values) => (name, Column::F64(values)),
            StateColumn::F32(values) => (name, Column::F32(values)),
        });
        let columns: Vec<(String, Column)> = state.collect();
        let Origin { version, commit, dirty, target } = Origin::here();
        let origin = [
            ("version", version.to_owned()),
            ("commit", commit.to_owned()),
            ("dirty", dirty.to_string()),
            ("target", target.to_owned()),
        ];
        let checkpoint = Checkpoint {
            step: method.steps(),
            time: method.time(),
            scene: self.scene.clone(),
            origin: origin.map(|(name, value)| (name.to_owned(), value)).into(),
            counters,
            columns,
        };
        Ok(checkpoint.write_atomically(self.folder.join(NAME))?)
    }

    /// What is written once at the end.
    pub(super) fn final_files(&mut self, method: &dyn Method) -> Result<(), RunError> {
        if self.output.lammps_data {
            let path = self.folder.join("final.data");
            let mut out = BufWriter::new(File::create(&path).map_err(FileError::at(&path, "creating"))?);
            let frame = self.frame(method);
            lammps::write_data(&frame, &mut out)
                .and_then(|()| out.flush())
                .map_err(FileError::at(&path, "writing"))?;
        }
        Ok(())
    }

    /// The balance of energy as it stands.
    pub(super) fn balance(&self, method: &dyn Method) -> Balance {
        let particles = method.particles();
        let seen = Observation::of(method.steps(), method.time(), &particles, &self.scenery);
        self.work.balance(&seen, &particles, method)
    }

    /// `summary.json`.
    pub(super) fn summary(&self, summary: &Summary) -> Result<(), RunError> {
        let path = self.folder.join("summary.json");
        let text = serde_json::to_string_pretty(summary)
            .map_err(|cause| FileError::at(&path, "writing")(cause.into()))?;
        self.write("summary.json", &(text + "\n"))
    }
}

/// The balance of energy of a run whose method is at the start.
fn work_from(checked: &Checked, method: &dyn Method) -> Work {
    let scenery = Scenery::of(&super::model(checked));
    let particles = method.particles();
    let first = Observation::of(method.steps(), method.time(), &particles, &scenery);
    Work::begin(&first, &particles, scenery.domain, scenery.gravity)
}

/// Refuses a scene that differs from the run's in more than how long and what is written.
fn same_scene(folder: &Path, theirs: &str, ours: &str) -> Result<(), RunError> {
    let physics = |text: &str| -> Vec<String> {
        let mut lines = Vec::new();
        let mut of_run = false;
        for line in text.lines().filter(|line| !line.trim().is_empty()) {
            if line.starts_with('[') {
                of_run = matches!(line.trim(), "[run]" | "[output]");
            }
            if !of_run {
                lines.push(line.to_owned());
            }
        }
        lines
    };
    let (theirs, ours) = (physics(theirs), physics(ours));
    let differs = (0..theirs.len().max(ours.len())).find(|&line| theirs.get(line) != ours.get(line));
    match differs {
        None => Ok(()),
        Some(line) => {
            let text = |lines: &[String]| lines.get(line).cloned().unwrap_or_else(|| "nothing".to_owned());
            Err(RunError::OtherScene { folder: folder.to_owned(), theirs: text(&theirs), ours: text(&ours) })
        }
    }
}
