//! How much of a study is done, while its runs go on side by side.

use crate::results::Progress;
use std::sync::Mutex;

/// Hears of expected seconds of work that are done.
pub struct Meter<'p> {
    done: Mutex<f64>,
    all: Mutex<f64>,
    progress: Progress<'p>,
}

impl<'p> Meter<'p> {
    /// Of a study that is expected to take `all` seconds of work.
    pub fn new(all: f64, progress: Progress<'p>) -> Self {
        Meter { done: Mutex::new(0.0), all: Mutex::new(all), progress }
    }

    /// The rest of the work is expected to take `rest` seconds.
    pub fn expect(&self, rest: f64) {
        let done = self.done.lock().map_or(0.0, |done| *done);
        if let Ok(mut all) = self.all.lock() {
            *all = done + rest;
        }
    }

    /// Work that was expected to take `seconds` is done.
    pub fn add(&self, seconds: f64) {
        let done = self.done.lock().map_or(0.0, |mut done| {
            *done += seconds;
            *done
        });
        let all = self.all.lock().map_or(1.0, |all| *all);
        (self.progress)((done / all.max(f64::MIN_POSITIVE)).min(1.0));
    }
}
