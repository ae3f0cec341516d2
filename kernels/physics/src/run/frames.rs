//! A file of frames that grows with a run, no frame twice, written by a thread of its own: a run goes on while a frame is written.

use crate::io::FileError;
use crate::io::growing_file::{GrowingFile, Mark};
use crate::io::{dcd, gsd};
use crate::method::Clock;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

/// A file that grows, which a run begins, or goes on with at a mark.
pub(super) trait Grows: Send + 'static {
    /// The file.
    fn path(&self) -> &Path;

    /// Cuts off what a resumed file has after its mark.
    ///
    /// # Errors
    /// If the system does not let it be cut.
    fn cut(&mut self) -> Result<(), FileError>;

    /// Returns when all that was written is on the disk, and says how far that is.
    ///
    /// # Errors
    /// If the system does not let it be written, or the file has been removed, replaced or changed meanwhile.
    fn sync(&mut self) -> Result<Mark, FileError>;
}

macro_rules! grow {
    ($($file:ty)*) => {
        $(impl Grows for $file {
            fn path(&self) -> &Path {
                self.path()
            }

            fn cut(&mut self) -> Result<(), FileError> {
                self.cut()
            }

            fn sync(&mut self) -> Result<Mark, FileError> {
                self.sync()
            }
        })*
    };
}

grow!(GrowingFile dcd::Writer gsd::Writer);

/// How a frame is written into a file.
pub(super) type Format<F, G> = fn(&F, &mut G) -> io::Result<()>;

/// The file, and the thread that writes it.
#[derive(Debug)]
pub(super) struct Frames<F, G = GrowingFile> {
    path: PathBuf,
    writing: Arc<Mutex<Writing<G>>>,
    format: Format<F, G>,
    /// The moment of the last frame.
    last: Option<Clock>,
    /// Where frames go, from the first one on.
    writer: Option<Writer<F>>,
}

/// What the thread and the run share.
#[derive(Debug)]
struct Writing<G> {
    file: G,
    /// What went wrong with a frame; nothing is written after it.
    failed: Option<io::Error>,
}

/// A thread that writes one frame while the next is computed; a run that is faster waits for it.
#[derive(Debug)]
struct Writer<F> {
    orders: SyncSender<Order<F>>,
    thread: JoinHandle<()>,
}

/// What the thread is to do.
enum Order<F> {
    /// Write.
    Write(Box<F>),
    /// Say when everything before is written.
    Answer(SyncSender<()>),
}

impl<F: Send + 'static> Writer<F> {
    fn begin<G: Grows>(writing: &Arc<Mutex<Writing<G>>>, format: Format<F, G>) -> io::Result<Writer<F>> {
        // Without room: of frames there is one that is written and one that is made.
        let (orders, received) = sync_channel(0);
        let writing = writing.clone();
        let thread = thread::Builder::new().name("frames".to_owned());
        let thread = thread.spawn(move || write(&received, &writing, format))?;
        Ok(Writer { orders, thread })
    }
}

fn write<F, G>(orders: &Receiver<Order<F>>, writing: &Mutex<Writing<G>>, format: Format<F, G>) {
    for order in orders {
        match order {
            Order::Write(frame) => {
                let mut writing = locked(writing);
                if writing.failed.is_none() {
                    writing.failed = format(&frame, &mut writing.file).err();
                }
            }
            // Who asked may have gone.
            Order::Answer(to) => drop(to.send(())),
        }
    }
}

/// A panic of the other side leaves a file that is as long as it says.
fn locked<G>(writing: &Mutex<Writing<G>>) -> MutexGuard<'_, Writing<G>> {
    writing.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<F: Send + 'static, G: Grows> Frames<F, G> {
    /// The frames of a file, of which the last one, if there is one, was of the moment `last`.
    pub(super) fn of(file: G, format: Format<F, G>, last: Option<Clock>) -> Frames<F, G> {
        let path = file.path().to_owned();
        Frames {
            path,
            writing: Arc::new(Mutex::new(Writing { file, failed: None })),
            format,
            last,
            writer: None,
        }
    }

    /// As [`Grows::cut`].
    ///
    /// # Errors
    /// If the system does not let it be cut.
    pub(super) fn cut(&mut self) -> Result<(), FileError> {
        locked(&self.writing).file.cut()
    }

    /// Hands the frame of a moment to the thread that writes, unless the last one is of that moment already.
    ///
    /// # Errors
    /// If the system did not let this one or one before it be written.
    pub(super) fn add(&mut self, moment: Clock, frame: impl FnOnce() -> F) -> Result<(), FileError> {
        if self.last == Some(moment) {
            return Ok(());
        }
        self.last = Some(moment);
        let at = |cause| failed(&self.path, cause);
        if self.writer.is_none() {
            self.writer = Some(Writer::begin(&self.writing, self.format).map_err(at)?);
        }
        self.order(Order::Write(Box::new(frame())))
    }

    fn order(&self, order: Order<F>) -> Result<(), FileError> {
        let sent = self.writer.as_ref().map_or(Ok(()), |writer| writer.orders.send(order));
        sent.map_err(|_| failed(&self.path, io::Error::other("the thread that writes has ended")))
    }

    /// Returns when every frame is on the disk; as [`Grows::sync`], with the moment of the last frame.
    ///
    /// # Errors
    /// If the system does not let it be written, or the file has been removed, replaced or changed meanwhile.
    pub(super) fn sync(&mut self) -> Result<(Mark, Option<Clock>), FileError> {
        if self.writer.is_some() {
            let (answer, answered) = sync_channel(1);
            self.order(Order::Answer(answer))?;
            let ended = |_| failed(&self.path, io::Error::other("the thread that writes has ended"));
            answered.recv().map_err(ended)?;
        }
        let mut writing = locked(&self.writing);
        if let Some(cause) = writing.failed.take() {
            return Err(failed(&self.path, cause));
        }
        Ok((writing.file.sync()?, self.last))
    }
}

impl<F, G> Drop for Frames<F, G> {
    /// What was handed over is written before anything else is done with the folder.
    fn drop(&mut self) {
        if let Some(Writer { orders, thread }) = self.writer.take() {
            drop(orders);
            drop(thread.join());
        }
    }
}

fn failed(path: &Path, cause: io::Error) -> FileError {
    FileError::at(path, "writing a frame")(cause)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// Every frame once, in order, whatever the thread is doing; a failure comes out at the latest when all are to be on the disk.
    #[test]
    fn frames_are_written_in_order_and_failures_come_out() {
        let folder = tempfile::tempdir().unwrap();
        let format: Format<u64, GrowingFile> = |frame, file| match frame {
            7 => Err(io::Error::other("no seven")),
            step => writeln!(file, "{step}"),
        };
        let path = folder.path().join("frames");
        let mut frames = Frames::of(GrowingFile::create(&path).unwrap(), format, None);
        let at = |steps| Clock { steps, ..Clock::default() };
        for step in [0, 1, 1, 2, 5] {
            frames.add(at(step), || step).unwrap();
        }
        let (mark, last) = frames.sync().unwrap();
        assert_eq!((mark.bytes, last), (8, Some(at(5))));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "0\n1\n2\n5\n");
        // A method without steps: frames are of other moments where the time or the events are others.
        for (time, events) in [(1.0, 8), (1.0, 8), (2.0, 8), (2.0, 9)] {
            frames.add(Clock { steps: 0, time, events }, || events).unwrap();
        }
        frames.sync().unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "0\n1\n2\n5\n8\n8\n9\n");
        frames.add(at(7), || 7).unwrap();
        assert!(frames.sync().unwrap_err().to_string().contains("no seven"));
    }
}
