//! Open sinks of a run, independent of the format. A separate thread writes frames while the run continues.

use super::FileError;
use super::growing_file::{FileMark, GrowingFileError};
use super::run_moment::{RunHeader, RunMoment};
use super::sink::{Sink, WriteOccasion};
use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

/// Open sink; its functions match those of [`Sink`].
pub(crate) trait OpenSink: Send {
    fn cut(&mut self) -> Result<(), FileError>;

    /// Adds a moment; returns true if there was something to add.
    fn add(&mut self, moment: &RunMoment<'_>) -> Result<bool, FileError>;

    fn mark(&mut self) -> Result<FileMark, FileError>;
}

/// Kind of a sink: its schedule and how it is opened.
#[derive(Clone, Copy, Debug)]
pub struct SinkKind {
    pub(crate) due: WriteOccasion,
    pub(crate) begin: Begin,
    pub(crate) resume: Resume,
}

type Begin = fn(PathBuf, &RunHeader) -> Result<Box<dyn OpenSink>, FileError>;
type Resume =
    fn(PathBuf, &RunHeader, FileMark, &mut Vec<String>) -> Result<Box<dyn OpenSink>, GrowingFileError>;

impl SinkKind {
    pub const fn of<S: Sink>() -> SinkKind {
        SinkKind {
            due: S::DUE,
            begin: |path, header| Ok(ThreadedSink::boxed(S::begin(path.clone(), header)?, path)),
            resume: |path, header, mark, notes| {
                Ok(ThreadedSink::boxed(S::resume(path.clone(), header, mark, notes)?, path))
            },
        }
    }
}

/// Sink, or the thread that owns it once there is a frame.
struct ThreadedSink<S: Sink> {
    path: PathBuf,
    sink: Option<S>,
    /// Thread that writes one frame while the next is computed; a faster run waits for it.
    thread: Option<Writing<S>>,
}

/// Channel to the writing thread, which returns the sink when it ends.
struct Writing<S: Sink> {
    entries: SyncSender<S::Entry>,
    thread: JoinHandle<(S, io::Result<()>)>,
}

fn write<S: Sink>(mut sink: S, entries: Receiver<S::Entry>) -> (S, io::Result<()>) {
    let mut written = Ok(());
    for entry in entries {
        // After an error nothing more is written.
        written = written.and_then(|()| sink.write(entry));
    }
    (sink, written)
}

impl<S: Sink> ThreadedSink<S> {
    fn boxed(sink: S, path: PathBuf) -> Box<dyn OpenSink> {
        Box::new(ThreadedSink { path, sink: Some(sink), thread: None })
    }

    /// Sends an entry to the thread, which starts with the first one.
    fn send(&mut self, entry: S::Entry) -> io::Result<()> {
        if let Some(sink) = self.sink.take() {
            // The channel has no buffer: one frame is written while one is made.
            let (entries, received) = sync_channel(0);
            let thread = thread::Builder::new().name("frames".to_owned());
            let thread = thread.spawn(move || write(sink, received))?;
            self.thread = Some(Writing { entries, thread });
        }
        let sent = self.thread.as_ref().map(|writing| writing.entries.send(entry));
        sent.and_then(Result::ok).ok_or_else(thread_has_ended)
    }

    /// Returns the sink after everything added is written.
    fn joined_sink(&mut self) -> io::Result<&mut S> {
        if let Some(Writing { entries, thread }) = self.thread.take() {
            drop(entries);
            let (sink, written) = thread.join().map_err(|_| thread_has_ended())?;
            self.sink = Some(sink);
            written?;
        }
        self.sink.as_mut().ok_or_else(thread_has_ended)
    }

    fn failed(&self, cause: io::Error) -> FileError {
        let action = match S::DUE {
            WriteOccasion::Events => "writing events",
            WriteOccasion::Row => "writing a row",
            WriteOccasion::Frame => "writing a frame",
        };
        FileError::at(&self.path, action)(cause)
    }
}

fn thread_has_ended() -> io::Error {
    io::Error::other("the writing thread has ended")
}

impl<S: Sink> OpenSink for ThreadedSink<S> {
    fn cut(&mut self) -> Result<(), FileError> {
        match self.joined_sink() {
            Ok(sink) => sink.cut(),
            Err(cause) => Err(self.failed(cause)),
        }
    }

    fn add(&mut self, moment: &RunMoment<'_>) -> Result<bool, FileError> {
        let Some(entry) = S::entry(moment).filter(|_| moment.per_particle.is_whole()) else {
            return Ok(false);
        };
        let added = match S::DUE {
            WriteOccasion::Frame => self.send(entry),
            WriteOccasion::Events | WriteOccasion::Row => {
                self.joined_sink().and_then(|sink| sink.write(entry))
            }
        };
        added.map(|()| true).map_err(|cause| self.failed(cause))
    }

    fn mark(&mut self) -> Result<FileMark, FileError> {
        match self.joined_sink() {
            Ok(sink) => sink.mark(),
            Err(cause) => Err(self.failed(cause)),
        }
    }
}

impl<S: Sink> Drop for ThreadedSink<S> {
    /// Completes all writes before the folder is used otherwise.
    fn drop(&mut self) {
        drop(self.joined_sink());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::growing_file::GrowingFile;
    use crate::io::sink::{TextFormat, TextSink};
    use crate::particles::{Particles, PerParticle};
    use std::io::Write;

    struct Numbers;

    impl TextFormat for Numbers {
        type Entry = u64;

        fn entry(moment: &RunMoment<'_>) -> Option<u64> {
            Some(moment.number).filter(|&number| number != 6)
        }

        fn write(number: u64, out: &mut GrowingFile) -> io::Result<()> {
            match number {
                7 => Err(io::Error::other("no seven")),
                _ => writeln!(out, "{number}"),
            }
        }
    }

    struct Nothing;

    impl PerParticle for Nothing {
        fn particles(&self) -> Particles {
            Particles::default()
        }
    }

    /// Frames are written in order, whatever the thread is doing; an error is reported by the next sync at the latest.
    #[test]
    fn frames_keep_their_order_and_failures_surface() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frames");
        let header = RunHeader::default();
        let mut sink = (SinkKind::of::<TextSink<Numbers>>().begin)(path.clone(), &header).unwrap();
        let add = |sink: &mut Box<dyn OpenSink>, number| {
            sink.add(&RunMoment::new(&header, &Nothing, (number, number, 0.0))).unwrap()
        };
        for (numbers, bytes) in [(&[0, 1, 1, 2, 5, 6][..], 10), (&[8, 9], 14), (&[], 14)] {
            for &number in numbers {
                assert_eq!(add(&mut sink, number), number != 6);
            }
            assert_eq!(sink.mark().unwrap().bytes, bytes);
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "0\n1\n1\n2\n5\n8\n9\n");
        add(&mut sink, 7);
        add(&mut sink, 8);
        assert!(sink.mark().unwrap_err().to_string().contains("no seven"));
        drop(sink);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "0\n1\n1\n2\n5\n8\n9\n");
    }
}
