//! Changes by the user: logged as they are made, and made again where a run resumes from an earlier checkpoint.
//!
//! A line of `changes.csv` has the moment, the quantity and its values, exact to the bit. A checkpoint counts the changes before it.

#[cfg(test)]
mod tests;

use super::RunError;
use crate::io::{FileError, regular_file};
use crate::method::{Change, Clock, SteeredQuantity, Until};
use crate::words::Words;
use std::collections::VecDeque;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::PathBuf;

/// Name of the log.
pub(super) const CHANGES: &str = "changes.csv";
/// Name of the number of changes in a checkpoint.
pub(super) const CHANGE_COUNT: &str = "changes";
const HEADING: &str = "step,time,events,quantity,values\n";
/// Longest log that is read (bytes).
const LONGEST: u64 = 16 << 30;

/// Log of the changes of a run.
#[derive(Debug)]
pub(super) struct ChangeLog {
    path: PathBuf,
    /// Number of changes made so far.
    pub(super) made: u64,
    /// Changes after the checkpoint, to be made again.
    pending: VecDeque<(Clock, Change)>,
}

impl ChangeLog {
    /// Log of a run that begins.
    pub(super) fn begin(path: PathBuf) -> ChangeLog {
        ChangeLog { path, made: 0, pending: VecDeque::new() }
    }

    /// Reads the log of a run that resumes from a checkpoint after `made` changes. An incomplete last line was not made and is removed.
    ///
    /// # Errors
    /// [`RunError::Changes`] for a line that is no change, or if changes of the checkpoint are missing.
    pub(super) fn resume(path: PathBuf, made: u64) -> Result<ChangeLog, RunError> {
        let text = match regular_file::read(&path, LONGEST) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(cause) if cause.kind() == ErrorKind::NotFound => String::new(),
            Err(cause) => return Err(FileError::at(&path, "reading")(cause).into()),
        };
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let wrong = |line: u64, reason: String| RunError::Changes { file: path.clone(), line, reason };
        let mut pending = VecDeque::new();
        let mut count = 0;
        for (line, number) in text[..whole].lines().zip(0..) {
            match number {
                0 if format!("{line}\n") == HEADING => {}
                0 => return Err(wrong(1, format!("it does not begin with {}", HEADING.trim_end()))),
                _ => {
                    count += 1;
                    let entry = entry(line).ok_or_else(|| wrong(number + 1, "it is no change".to_owned()))?;
                    pending.extend((count > made).then_some(entry));
                }
            }
        }
        if count < made {
            let reason = format!("{made} changes were made up to the checkpoint, but it has {count}");
            return Err(wrong(count + 1, reason));
        }
        if whole < text.len() {
            let cut = File::options().write(true).open(&path).and_then(|file| file.set_len(whole as u64));
            cut.map_err(FileError::at(&path, "truncating"))?;
        }
        Ok(ChangeLog { path, made, pending })
    }

    /// Moment of the next change to be made again: its number of events first, then its time.
    pub(super) fn next_moment(&self, now: &Clock) -> Option<Until> {
        let (at, _) = self.pending.front()?;
        Some(match at {
            Clock { steps, .. } if *steps > 0 => Until::Steps(*steps),
            Clock { events, .. } if *events > now.events => Until::Events(*events),
            Clock { time, .. } => Until::Time(*time),
        })
    }

    /// Takes the next change if it is to be made again at this moment.
    pub(super) fn take_due(&mut self, now: &Clock) -> Option<Change> {
        let is_due = |at: &Clock| now.steps >= at.steps && now.time >= at.time && now.events >= at.events;
        let (_, change) = self.pending.pop_front_if(|(at, _)| is_due(at))?;
        Some(change)
    }

    /// Moment of the last change to be made again, if there is one.
    pub(super) fn last_pending(&self) -> Option<Clock> {
        self.pending.back().map(|(at, _)| *at)
    }

    /// Adds a change to the file, and syncs it to the disk.
    ///
    /// # Errors
    /// If the system refuses to write.
    pub(super) fn append(&mut self, now: &Clock, change: &Change) -> Result<(), RunError> {
        let Clock { steps, time, events } = now;
        // The shortest decimals that read back as the same bits.
        let values: Vec<String> = change.values.iter().map(|value| format!("{value:?}")).collect();
        let line = format!("{steps},{time:?},{events},{},{}\n", change.quantity.word(), values.join(" "));
        let written = OpenOptions::new().append(true).create(true).open(&self.path).and_then(|mut file| {
            let heading = if file.metadata()?.len() == 0 { HEADING } else { "" };
            file.write_all(format!("{heading}{line}").as_bytes())?;
            file.sync_data()
        });
        Ok(written.map_err(FileError::at(&self.path, "writing a change"))?)
    }
}

/// Moment and change of a line.
fn entry(line: &str) -> Option<(Clock, Change)> {
    let fields: Vec<&str> = line.split(',').collect();
    let [steps, time, events, quantity, values] = fields[..] else { return None };
    let clock = Clock { steps: steps.parse().ok()?, time: time.parse().ok()?, events: events.parse().ok()? };
    let values = values.split(' ').map(|value| value.parse().ok()).collect::<Option<Vec<f64>>>()?;
    let is_finite = clock.time.is_finite() && values.iter().all(|value| value.is_finite());
    is_finite.then_some(())?;
    Some((clock, Change { quantity: SteeredQuantity::parse(quantity)?, values }))
}
