//! The files of a run that grow: begun, taken up again, cut and brought to the disk together.

use super::RunError;
use super::folder::{DCD, DUMP, EVENTS, GSD, RunFolder, THERMO, TRAJECTORY};
use super::frames::Frames;
use super::pace::Pace;
use crate::io::checkpoint::Counter;
use crate::io::dcd::{self, Positions};
use crate::io::extxyz::{self, Frame};
use crate::io::growing_file::{GrowingFile, Mark};
use crate::io::gsd::{self, LoggedFrame};
use crate::io::table_file::TableFile;
use crate::io::{FileError, lammps};
use crate::method::{Clock, Kind, Prepared, Quantity};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::Arc;

/// The growing files of a run; none where the scene does not ask for one.
pub(super) struct Growing {
    pub(super) thermo: TableFile,
    pub(super) trajectory: Frames<Arc<Frame>>,
    pub(super) dump: Option<Frames<Arc<Frame>>>,
    pub(super) dcd: Option<Frames<Positions, dcd::Writer>>,
    pub(super) gsd: Option<Frames<LoggedFrame, gsd::Writer>>,
    pub(super) events: Option<GrowingFile>,
    /// Distance of the frames of DCD.
    pub(super) pace: Pace,
}

/// What a checkpoint keeps of a file: how far it was written, and the moment of its last frame.
pub(super) struct Kept<'c> {
    counters: &'c BTreeMap<String, Counter>,
}

impl<'c> Kept<'c> {
    pub(super) fn new(counters: &'c BTreeMap<String, Counter>) -> Self {
        Kept { counters }
    }

    fn count(&self, name: &str) -> Result<u64, String> {
        match self.counters.get(name) {
            Some(Counter::Count(count)) => Ok(*count),
            _ => Err(format!("the counter {name} is missing")),
        }
    }

    fn mark(&self, file: &str) -> Result<Mark, String> {
        let checksum = self.count(&format!("{file} checksum"))?;
        let checksum =
            u32::try_from(checksum).map_err(|_| format!("the checksum of {file} has more than 32 bits"))?;
        Ok(Mark { bytes: self.count(&format!("{file} bytes"))?, checksum })
    }

    fn last_frame(&self, file: &str) -> Option<Clock> {
        let [steps, time, events] = last_names(file);
        let Some(Counter::Sum(time)) = self.counters.get(&time) else { return None };
        Some(Clock { steps: self.count(&steps).ok()?, time: *time, events: self.count(&events).ok()? })
    }
}

impl Growing {
    /// Begins the files that a scene asks for.
    pub(super) fn begin(
        folder: &RunFolder,
        prepared: &Prepared,
        quantities: &'static [Quantity],
        pace: Pace,
    ) -> Result<Growing, RunError> {
        let thermo = TableFile::create(folder.file(THERMO), &columns(quantities))?;
        let trajectory = Frames::of(GrowingFile::create(folder.file(TRAJECTORY))?, write_text, None);
        let mut growing =
            Growing { thermo, trajectory, dump: None, dcd: None, gsd: None, events: None, pace };
        growing.begin_missing(folder, prepared, quantities)?;
        Ok(growing)
    }

    /// Begins the files on request that are not there.
    fn begin_missing(
        &mut self,
        folder: &RunFolder,
        prepared: &Prepared,
        quantities: &'static [Quantity],
    ) -> Result<(), RunError> {
        let output = &prepared.output;
        if output.lammps_dump && self.dump.is_none() {
            let file = GrowingFile::create(folder.file(DUMP))?;
            self.dump = Some(Frames::of(file, write_dump, None));
        }
        if output.dcd && self.dcd.is_none() {
            let file = dcd::Writer::create(folder.file(DCD), self.pace.spacing())?;
            self.dcd = Some(Frames::of(file, dcd::write, None));
        }
        if output.gsd && self.gsd.is_none() {
            let file = gsd::Writer::create(folder.file(GSD), &logged(quantities))?;
            self.gsd = Some(Frames::of(file, gsd::write, None));
        }
        if self.events.is_none() {
            self.events = begin_events(folder, prepared)?;
        }
        Ok(())
    }

    /// Opens and verifies the files of a checkpoint; nothing is cut yet. `foreign` says whose counters are wrong; `notes` take up
    /// what is out of the ordinary.
    pub(super) fn resume(
        folder: &RunFolder,
        quantities: &'static [Quantity],
        kept: &Kept<'_>,
        (pace, notes): (Pace, &mut Vec<String>),
        foreign: impl Fn(String) -> RunError,
    ) -> Result<Growing, RunError> {
        let mark = |file: &str| kept.mark(file).map_err(&foreign);
        let thermo = TableFile::resume(folder.file(THERMO), &columns(quantities), mark(THERMO)?)?;
        // A file that the checkpoint does not know was not asked for, or begun after it.
        let known = |file: &str| Some((kept.mark(file).ok()?, kept.last_frame(file)));
        let trajectory = GrowingFile::resume(folder.file(TRAJECTORY), mark(TRAJECTORY)?)?;
        let mut growing = Growing {
            thermo,
            trajectory: Frames::of(trajectory, write_text, kept.last_frame(TRAJECTORY)),
            dump: None,
            dcd: None,
            gsd: None,
            events: None,
            pace,
        };
        if let Some((mark, last)) = known(DUMP) {
            let file = GrowingFile::resume(folder.file(DUMP), mark)?;
            growing.dump = Some(Frames::of(file, write_dump, last));
        }
        if let Some((mark, last)) = known(DCD) {
            let file = dcd::Writer::resume(folder.file(DCD), mark, pace.spacing())?;
            if !file.is_even() {
                notes.push(format!("{DCD} gets no more frames: those it has are otherwise apart than run.snapshot_every now says"));
            }
            growing.dcd = Some(Frames::of(file, dcd::write, last));
        }
        if let Some((mark, last)) = known(GSD) {
            let file = gsd::Writer::resume(folder.file(GSD), &logged(quantities), mark)?;
            growing.gsd = Some(Frames::of(file, gsd::write, last));
        }
        if let Some((mark, _)) = known(EVENTS) {
            growing.events = Some(GrowingFile::resume(folder.file(EVENTS), mark)?);
        }
        Ok(growing)
    }

    /// Cuts the files where the checkpoint was written. Those that it does not know were begun after it, if they are there at
    /// all: they are begun again if the scene asks for them.
    pub(super) fn cut(
        &mut self,
        folder: &mut RunFolder,
        prepared: &Prepared,
        quantities: &'static [Quantity],
    ) -> Result<(), RunError> {
        self.thermo.cut()?;
        self.trajectory.cut()?;
        match &mut self.dump {
            Some(dump) => dump.cut()?,
            None => folder.remove_own(DUMP)?,
        }
        match &mut self.dcd {
            Some(dcd) => dcd.cut()?,
            None => folder.remove_own(DCD)?,
        }
        match &mut self.gsd {
            Some(gsd) => gsd.cut()?,
            None => folder.remove_own(GSD)?,
        }
        match &mut self.events {
            Some(events) => events.cut()?,
            None => folder.remove_own(EVENTS)?,
        }
        self.begin_missing(folder, prepared, quantities)
    }

    /// Returns when everything is on the disk; gives what a checkpoint keeps of it.
    pub(super) fn sync(&mut self) -> Result<BTreeMap<String, Counter>, RunError> {
        let mut counters = BTreeMap::new();
        let mut keep = |file: &str, mark: Mark, last: Option<Clock>| {
            counters.insert(format!("{file} bytes"), Counter::Count(mark.bytes));
            counters.insert(format!("{file} checksum"), Counter::Count(mark.checksum.into()));
            let Some(Clock { steps, time, events }) = last else { return };
            let moment = [Counter::Count(steps), Counter::Sum(time), Counter::Count(events)];
            counters.extend(last_names(file).into_iter().zip(moment));
        };
        keep(THERMO, self.thermo.sync()?, None);
        let (mark, last) = self.trajectory.sync()?;
        keep(TRAJECTORY, mark, last);
        if let Some(dump) = &mut self.dump {
            let (mark, last) = dump.sync()?;
            keep(DUMP, mark, last);
        }
        if let Some(dcd) = &mut self.dcd {
            let (mark, last) = dcd.sync()?;
            keep(DCD, mark, last);
        }
        if let Some(gsd) = &mut self.gsd {
            let (mark, last) = gsd.sync()?;
            keep(GSD, mark, last);
        }
        if let Some(events) = &mut self.events {
            keep(EVENTS, events.sync()?, None);
        }
        Ok(counters)
    }
}

/// The counters of the moment of a file's last frame: step, time and events.
fn last_names(file: &str) -> [String; 3] {
    ["last", "last time", "last events"].map(|what| format!("{file} {what}"))
}

/// The names of the columns of `thermo.csv` after the step.
fn columns(quantities: &'static [Quantity]) -> Vec<&'static str> {
    quantities.iter().map(|quantity| quantity.name).collect()
}

/// Frames are shared by the files that have them.
fn write_text(frame: &Arc<Frame>, file: &mut GrowingFile) -> io::Result<()> {
    extxyz::write(frame, file)
}

fn write_dump(frame: &Arc<Frame>, file: &mut GrowingFile) -> io::Result<()> {
    lammps::write_dump(frame, file)
}

/// What a trajectory logs of a row: the frame has the time.
fn is_logged(quantity: &Quantity) -> bool {
    quantity.kind != Kind::Time
}

/// The names of what a trajectory logs.
fn logged(quantities: &'static [Quantity]) -> Vec<&'static str> {
    quantities.iter().filter(|it| is_logged(it)).map(|it| it.name).collect()
}

/// What a trajectory logs of a row; not a number where there is no row.
pub(super) fn logged_of(quantities: &'static [Quantity], row: Option<&[f64]>) -> Vec<f64> {
    let value = |(place, quantity)| is_logged(quantity).then(|| row.map_or(f64::NAN, |row| row[place]));
    quantities.iter().enumerate().filter_map(value).collect()
}

/// The file of events with its heading, where the scene asks for them.
fn begin_events(folder: &RunFolder, prepared: &Prepared) -> Result<Option<GrowingFile>, RunError> {
    let Some(columns) = prepared.event_columns else { return Ok(None) };
    let mut file = GrowingFile::create(folder.file(EVENTS))?;
    writeln!(file, "{columns}").map_err(FileError::at(file.path(), "writing"))?;
    Ok(Some(file))
}
