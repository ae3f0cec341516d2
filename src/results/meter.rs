//! How much of a piece of work is done, while its parts go on side by side.

use super::Progress;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use std::sync::Mutex;

/// Hears of work that is done, and says the share that it is.
pub(crate) struct Meter<'p> {
    done: Mutex<f64>,
    all: Mutex<f64>,
    progress: Progress<'p>,
}

impl<'p> Meter<'p> {
    /// Of work that is expected to come to `all`: cases, steps or seconds.
    pub(crate) fn new(all: f64, progress: Progress<'p>) -> Self {
        Meter { done: Mutex::new(0.0), all: Mutex::new(all), progress }
    }

    /// The rest of the work is expected to come to `rest`.
    pub(crate) fn expect(&self, rest: f64) {
        let done = self.done.lock().map_or(0.0, |done| *done);
        if let Ok(mut all) = self.all.lock() {
            *all = done + rest;
        }
    }

    /// So much more is done.
    pub(crate) fn add(&self, more: f64) {
        let done = self.done.lock().map_or(0.0, |mut done| {
            *done += more;
            *done
        });
        let all = self.all.lock().map_or(1.0, |all| *all);
        (self.progress)((done / all.max(f64::MIN_POSITIVE)).min(1.0));
    }

    /// Does the work of every case on all threads, each of them one unit of the whole: what comes of them, in their order.
    ///
    /// # Errors
    /// That of a case.
    pub(crate) fn each<C: Sync, T: Send, E: Send>(
        &self,
        cases: &[C],
        work: impl Fn(&C) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        cases.par_iter().map(|case| work(case).inspect(|_| self.add(1.0))).collect()
    }

    /// The same, begun with the last case: for cases that take longer and longer.
    ///
    /// # Errors
    /// That of a case.
    pub(crate) fn each_from_last<C: Sync, T: Send, E: Send>(
        &self,
        cases: &[C],
        work: impl Fn(&C) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        let all = cases.par_iter().rev().map(|case| work(case).inspect(|_| self.add(1.0)));
        let mut all: Vec<T> = all.collect::<Result<_, E>>()?;
        all.reverse();
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In order whichever is begun first; every share is heard once, and an error ends it.
    #[test]
    fn cases_come_back_in_their_order() {
        let heard = Mutex::new(vec![]);
        let progress = |share: f64| heard.lock().unwrap().push(share);
        let meter = Meter::new(8.0, &progress);
        let square = |case: &u32| Ok::<_, ()>(case * case);
        assert_eq!(meter.each(&[1, 2, 3, 4], square), Ok(vec![1, 4, 9, 16]));
        assert_eq!(meter.each_from_last(&[1, 2, 3, 4], square), Ok(vec![1, 4, 9, 16]));
        let mut heard = heard.lock().unwrap().clone();
        heard.sort_by(f64::total_cmp);
        assert_eq!(heard, [1, 2, 3, 4, 5, 6, 7, 8].map(|done| f64::from(done) / 8.0));
        let meter = Meter::new(2.0, &|_| ());
        assert_eq!(meter.each(&[1, 2], |&case| if case == 2 { Err(case) } else { Ok(()) }), Err(2));
    }
}
