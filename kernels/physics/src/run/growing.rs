//! The files of a run that grow: begun, taken up again, cut and brought to the disk together.

use super::RunError;
use super::folder::{DCD, DUMP, EVENTS, RunFolder, THERMO, TRAJECTORY};
use super::frames::Frames;
use crate::io::checkpoint::Counter;
use crate::io::dcd::{self, Positions};
use crate::io::extxyz::{self, Frame};
use crate::io::growing_file::{GrowingFile, Mark};
use crate::io::table_file::TableFile;
use crate::io::{FileError, lammps};
use crate::method::{Clock, Prepared, Quantity};
use std::collections::BTreeMap;
use std::io::Write;

/// The growing files of a run; none where the scene does not ask for one.
pub(super) struct Growing {
    pub(super) thermo: TableFile,
    pub(super) trajectory: Frames<Frame>,
    pub(super) dump: Option<Frames<Frame>>,
    pub(super) dcd: Option<Frames<Positions>>,
    pub(super) events: Option<GrowingFile>,
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
    ) -> Result<Growing, RunError> {
        let output = &prepared.output;
        let thermo = TableFile::create(folder.file(THERMO), &columns(quantities))?;
        let trajectory = Frames::create(folder.file(TRAJECTORY), extxyz::write)?;
        let dump = output.lammps_dump.then(|| Frames::create(folder.file(DUMP), lammps::write_dump));
        let dcd = output.dcd.then(|| Frames::create(folder.file(DCD), dcd::write));
        let (dump, dcd) = (dump.transpose()?, dcd.transpose()?);
        Ok(Growing { thermo, trajectory, dump, dcd, events: begin_events(folder, prepared)? })
    }

    /// Opens and verifies the files of a checkpoint; nothing is cut yet. `foreign` says whose counters are wrong.
    pub(super) fn resume(
        folder: &RunFolder,
        quantities: &'static [Quantity],
        kept: &Kept<'_>,
        foreign: impl Fn(String) -> RunError,
    ) -> Result<Growing, RunError> {
        let mark = |file: &str| kept.mark(file).map_err(&foreign);
        let thermo = TableFile::resume(folder.file(THERMO), &columns(quantities), mark(THERMO)?)?;
        let (trajectory, last) = (folder.file(TRAJECTORY), kept.last_frame(TRAJECTORY));
        Ok(Growing {
            thermo,
            trajectory: Frames::resume(trajectory, extxyz::write, mark(TRAJECTORY)?, last)?,
            dump: match kept.mark(DUMP) {
                Ok(mark) => {
                    let last = kept.last_frame(DUMP);
                    Some(Frames::resume(folder.file(DUMP), lammps::write_dump, mark, last)?)
                }
                Err(_) => None,
            },
            dcd: match kept.mark(DCD) {
                Ok(mark) => Some(Frames::resume(folder.file(DCD), dcd::write, mark, kept.last_frame(DCD))?),
                Err(_) => None,
            },
            events: match kept.mark(EVENTS) {
                Ok(mark) => Some(GrowingFile::resume(folder.file(EVENTS), mark)?),
                Err(_) => None,
            },
        })
    }

    /// Cuts the files where the checkpoint was written. Those that it does not know were begun after it, if they are there at
    /// all: they are begun again if the scene asks for them.
    pub(super) fn cut(&mut self, folder: &mut RunFolder, prepared: &Prepared) -> Result<(), RunError> {
        let output = &prepared.output;
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
        if self.dump.is_none() && output.lammps_dump {
            self.dump = Some(Frames::create(folder.file(DUMP), lammps::write_dump)?);
        }
        if self.dcd.is_none() && output.dcd {
            self.dcd = Some(Frames::create(folder.file(DCD), dcd::write)?);
        }
        match &mut self.events {
            Some(events) => events.cut()?,
            None => {
                folder.remove_own(EVENTS)?;
                self.events = begin_events(folder, prepared)?;
            }
        }
        Ok(())
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

/// The file of events with its heading, where the scene asks for them.
fn begin_events(folder: &RunFolder, prepared: &Prepared) -> Result<Option<GrowingFile>, RunError> {
    let Some(columns) = prepared.event_columns else { return Ok(None) };
    let mut file = GrowingFile::create(folder.file(EVENTS))?;
    writeln!(file, "{columns}").map_err(FileError::at(file.path(), "writing"))?;
    Ok(Some(file))
}
