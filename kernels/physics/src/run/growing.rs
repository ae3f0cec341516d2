//! Growing files of a run: created, resumed, truncated and synced together.

use super::RunError;
use super::folder::{EVENTS, RunFolder, THERMO};
use super::structured::requested_observables;
use crate::io::checkpoint::CheckpointCounter;
use crate::io::growing_file::FileMark;
use crate::io::open_sinks::{OpenSink, SinkKind};
use crate::io::output_format::{FrameWriting, OutputFormat};
use crate::io::run_moment::{RunHeader, RunMoment};
use crate::io::sink::{TextSink, WriteOccasion};
use crate::io::table_file::{EventRows, ObservedRows};
use crate::io::{FORMATS, FileError};
use crate::method::{Clock, Prepared};
use std::collections::BTreeMap;

/// File that may grow during a run.
struct GrowingSink {
    name: &'static str,
    kind: SinkKind,
    /// True if every run creates it.
    is_always_there: bool,
    /// True if the scene requests it, so that it is appended to.
    is_asked: bool,
    /// Open sink; none before the file is created.
    sink: Option<Box<dyn OpenSink>>,
    /// Moment of the last frame.
    last: Option<Clock>,
}

impl GrowingSink {
    fn new(name: &'static str, kind: SinkKind, [is_always_there, is_asked]: [bool; 2]) -> GrowingSink {
        GrowingSink { name, kind, is_always_there, is_asked, sink: None, last: None }
    }

    fn is_begun(&self) -> bool {
        self.is_always_there || self.is_asked
    }

    /// Adds a moment, unless it is that of the last frame.
    fn add(&mut self, moment: &RunMoment<'_>, clock: Clock) -> Result<(), FileError> {
        let Some(sink) = &mut self.sink else { return Ok(()) };
        let is_frame = self.kind.due == WriteOccasion::Frame;
        if is_frame && self.last == Some(clock) {
            return Ok(());
        }
        if sink.add(moment)? && is_frame {
            self.last = Some(clock);
        }
        Ok(())
    }
}

/// Growing files of a run.
pub(super) struct GrowingFiles(Vec<GrowingSink>);

/// Returns the names of the files that a run creates, at the start or at its end.
pub(super) fn run_file_names(prepared: &Prepared) -> Vec<&'static str> {
    let begun = GrowingFiles::of(prepared).0.into_iter().filter(GrowingSink::is_begun).map(|it| it.name);
    let last = FORMATS.iter().filter(|it| matches!(it.writing, FrameWriting::Last(_)));
    let last = last.filter(|format| prepared.output.asks_for(format)).map(|format| format.file);
    begun
        .chain(last)
        .chain(requested_observables(&prepared.output).map(|observable| observable.file))
        .collect()
}

/// Counters of a checkpoint.
type Counters = BTreeMap<String, CheckpointCounter>;

fn count(kept: &Counters, name: &str) -> Result<u64, String> {
    match kept.get(name) {
        Some(CheckpointCounter::Count(count)) => Ok(*count),
        _ => Err(format!("the counter {name} is missing")),
    }
}

/// Returns the mark of a file.
fn mark_of(kept: &Counters, file: &str) -> Result<FileMark, String> {
    let checksum = count(kept, &format!("{file} checksum"))?;
    let checksum =
        u32::try_from(checksum).map_err(|_| format!("the checksum of {file} has more than 32 bits"))?;
    Ok(FileMark { bytes: count(kept, &format!("{file} bytes"))?, checksum })
}

/// Returns the moment of a file's last frame.
fn last_of(kept: &Counters, file: &str) -> Option<Clock> {
    let [steps, time, events] = last_names(file);
    let Some(CheckpointCounter::Sum(time)) = kept.get(&time) else { return None };
    Some(Clock { steps: count(kept, &steps).ok()?, time: *time, events: count(kept, &events).ok()? })
}

impl GrowingFiles {
    /// Lists all files that may grow, without creating one.
    fn of(prepared: &Prepared) -> GrowingFiles {
        let rows = GrowingSink::new(THERMO, SinkKind::of::<TextSink<ObservedRows>>(), [true; 2]);
        let of_format = |format: &OutputFormat| match format.writing {
            FrameWriting::Growing(kind) => {
                let is_asked = prepared.output.asks_for(format);
                Some(GrowingSink::new(format.file, kind, [format.is_default, is_asked]))
            }
            FrameWriting::Last(_) => None,
        };
        let has_events = prepared.event_columns.is_some();
        let events = GrowingSink::new(EVENTS, SinkKind::of::<TextSink<EventRows>>(), [false, has_events]);
        GrowingFiles([rows].into_iter().chain(FORMATS.iter().filter_map(of_format)).chain([events]).collect())
    }

    /// Creates the files that a scene requests.
    pub(super) fn begin(
        folder: &RunFolder,
        prepared: &Prepared,
        header: &RunHeader,
    ) -> Result<GrowingFiles, RunError> {
        let mut growing = GrowingFiles::of(prepared);
        growing.begin_missing(folder, header)?;
        Ok(growing)
    }

    fn begin_missing(&mut self, folder: &RunFolder, header: &RunHeader) -> Result<(), RunError> {
        for file in self.0.iter_mut().filter(|file| file.sink.is_none() && file.is_begun()) {
            file.sink = Some((file.kind.begin)(folder.file(file.name), header)?);
        }
        Ok(())
    }

    /// Opens and verifies the files of a checkpoint without truncating them. `foreign` creates the error for wrong counters; `notes` receives
    /// unusual findings.
    pub(super) fn resume(
        folder: &RunFolder,
        prepared: &Prepared,
        header: &RunHeader,
        (kept, notes): (&Counters, &mut Vec<String>),
        foreign: impl Fn(String) -> RunError,
    ) -> Result<GrowingFiles, RunError> {
        let mut growing = GrowingFiles::of(prepared);
        for file in &mut growing.0 {
            let mark = match mark_of(kept, file.name) {
                Ok(mark) => mark,
                Err(reason) if file.is_always_there => return Err(foreign(reason)),
                // A file unknown to the checkpoint was not requested, or created after it.
                Err(_) => continue,
            };
            file.sink = Some((file.kind.resume)(folder.file(file.name), header, mark, notes)?);
            file.last = last_of(kept, file.name);
        }
        Ok(growing)
    }

    /// Truncates the files at the checkpoint. Existing files unknown to the checkpoint were created after it: they are created again if the scene
    /// requests them.
    pub(super) fn cut(&mut self, folder: &RunFolder, header: &RunHeader) -> Result<(), RunError> {
        for file in &mut self.0 {
            match &mut file.sink {
                Some(sink) => sink.cut()?,
                None => folder.remove_own(file.name)?,
            }
        }
        self.begin_missing(folder, header)
    }

    /// Adds a moment to the requested files in which something is due.
    pub(super) fn add(
        &mut self,
        due: WriteOccasion,
        moment: &RunMoment<'_>,
        clock: Clock,
    ) -> Result<(), RunError> {
        let mut asked = self.0.iter_mut().filter(|it| it.kind.due == due && it.is_asked);
        Ok(asked.try_for_each(|it| it.add(moment, clock))?)
    }

    /// Adds a moment to a file, also if the scene does not request it.
    pub(super) fn add_to(
        &mut self,
        name: &str,
        moment: &RunMoment<'_>,
        clock: Clock,
    ) -> Result<(), RunError> {
        let mut there = self.0.iter_mut().filter(|it| it.name == name);
        Ok(there.try_for_each(|it| it.add(moment, clock))?)
    }

    /// Syncs everything to the disk and returns the counters for a checkpoint.
    pub(super) fn mark(&mut self) -> Result<Counters, RunError> {
        let mut counters = Counters::new();
        for GrowingSink { name, sink, last, .. } in &mut self.0 {
            let Some(sink) = sink else { continue };
            let FileMark { bytes, checksum } = sink.mark()?;
            counters.insert(format!("{name} bytes"), CheckpointCounter::Count(bytes));
            counters.insert(format!("{name} checksum"), CheckpointCounter::Count(checksum.into()));
            let Some(Clock { steps, time, events }) = *last else { continue };
            let moment = [
                CheckpointCounter::Count(steps),
                CheckpointCounter::Sum(time),
                CheckpointCounter::Count(events),
            ];
            counters.extend(last_names(name).into_iter().zip(moment));
        }
        Ok(counters)
    }
}

/// Names of the counters for the moment of a file's last frame: step, time and events.
fn last_names(file: &str) -> [String; 3] {
    ["last", "last time", "last events"].map(|what| format!("{file} {what}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, load};
    use crate::particles::{Particles, PerParticle};

    struct Nothing;

    impl PerParticle for Nothing {
        fn particles(&self) -> Particles {
            Particles::default()
        }
    }

    /// Sink that adds every moment but the third.
    struct Numbers(Vec<u64>);

    impl OpenSink for Numbers {
        fn add(&mut self, moment: &RunMoment<'_>) -> Result<bool, FileError> {
            self.0.push(moment.number);
            Ok(moment.number != 3)
        }

        fn cut(&mut self) -> Result<(), FileError> {
            Ok(())
        }

        fn mark(&mut self) -> Result<FileMark, FileError> {
            Ok(FileMark { bytes: self.0.len() as u64, checksum: 0 })
        }
    }

    /// Frames are written once. Without steps, frames differ if the time or the events do. A moment that adds nothing to a file is not that of
    /// its last frame.
    #[test]
    fn frames_are_written_once() {
        let (prepared, _) = load("two-discs", &[], METHODS).unwrap();
        let mut growing = GrowingFiles::of(&prepared);
        growing.0[1].sink = Some(Box::new(Numbers(vec![])));
        let header = RunHeader::default();
        let at = |steps, time, events| Clock { steps, time, events };
        for (clock, count) in [
            (at(0, 0.0, 0), 1),
            (at(1, 0.1, 0), 2),
            (at(1, 0.1, 0), 2),
            (at(0, 1.0, 8), 3),
            (at(0, 2.0, 8), 4),
            (at(0, 2.0, 9), 5),
            (at(0, 2.0, 9), 5),
        ] {
            let moment = RunMoment::new(&header, &Nothing, (clock.steps, clock.number(), clock.time));
            growing.add(WriteOccasion::Frame, &moment, clock).unwrap();
            let counters = growing.mark().unwrap();
            assert_eq!(counters["trajectory.xyz bytes"], CheckpointCounter::Count(count), "{clock:?}");
            assert_eq!(
                counters["trajectory.xyz last events"],
                CheckpointCounter::Count(clock.events),
                "{clock:?}"
            );
        }
        let third = RunMoment::new(&header, &Nothing, (3, 3, 3.0));
        growing.add(WriteOccasion::Frame, &third, at(3, 3.0, 0)).unwrap();
        assert_eq!(growing.mark().unwrap()["trajectory.xyz last"], CheckpointCounter::Count(0));
    }
}
