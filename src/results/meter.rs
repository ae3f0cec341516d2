//! Progress of work whose parts run in parallel.

use super::Progress;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Computes all cases on all threads and returns the results in order. After a failure no further case is begun.
///
/// # Errors
/// The first error, in the order of the cases.
pub(crate) fn run_in_parallel<C: Sync, T: Send, E: Send>(
    cases: &[C],
    work: impl Fn(&C) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let results: Vec<Mutex<Option<Result<T, E>>>> = cases.iter().map(|_| Mutex::new(None)).collect();
    let has_failed = AtomicBool::new(false);
    for_each_below(cases.len(), &|at| {
        if !has_failed.load(Ordering::Relaxed) {
            let result = work(&cases[at]);
            has_failed.fetch_or(result.is_err(), Ordering::Relaxed);
            *results[at].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        }
    });
    results.into_iter().filter_map(|it| it.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
}

/// Calls `work` for every number below `count` on all threads; not generic, so that it is compiled once.
pub(super) fn for_each_below(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(work);
}

/// Meter of progress: adds up finished work and reports its fraction.
pub(crate) struct ProgressMeter<'p> {
    done: Mutex<f64>,
    all: Mutex<f64>,
    progress: Progress<'p>,
}

impl<'p> ProgressMeter<'p> {
    /// Meter of work that is expected to total `all` cases, steps or seconds.
    pub(crate) fn new(all: f64, progress: Progress<'p>) -> Self {
        ProgressMeter { done: Mutex::new(0.0), all: Mutex::new(all), progress }
    }

    /// Sets the expected remaining work.
    pub(crate) fn expect(&self, rest: f64) {
        let done = self.done.lock().map_or(0.0, |done| *done);
        if let Ok(mut all) = self.all.lock() {
            *all = done + rest;
        }
    }

    /// Adds finished work.
    pub(crate) fn add(&self, more: f64) {
        let done = self.done.lock().map_or(0.0, |mut done| {
            *done += more;
            *done
        });
        let all = self.all.lock().map_or(1.0, |all| *all);
        (self.progress)((done / all.max(f64::MIN_POSITIVE)).min(1.0));
    }

    /// Computes all cases on all threads, one unit of work each, and returns the results in order.
    ///
    /// # Errors
    /// First error of a case.
    pub(crate) fn run_cases<C: Sync, T: Send, E: Send>(
        &self,
        cases: &[C],
        work: impl Fn(&C) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        run_in_parallel(cases, |case| work(case).inspect(|_| self.add(1.0)))
    }

    /// As [`run_cases`](Self::run_cases), but starts with the last case, for cases of increasing cost.
    ///
    /// # Errors
    /// First error of a case.
    pub(crate) fn run_cases_from_last<C: Sync, T: Send, E: Send>(
        &self,
        cases: &[C],
        work: impl Fn(&C) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        let cases: Vec<&C> = cases.iter().rev().collect();
        let mut all = run_in_parallel(&cases, |case| work(case).inspect(|_| self.add(1.0)))?;
        all.reverse();
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Results are in order, every fraction is reported once, and an error ends the work.
    #[test]
    fn results_are_in_the_order_of_cases() {
        let heard = Mutex::new(vec![]);
        let progress = |share: f64| heard.lock().unwrap().push(share);
        let meter = ProgressMeter::new(8.0, &progress);
        let square = |case: &u32| Ok::<_, ()>(case * case);
        assert_eq!(meter.run_cases(&[1, 2, 3, 4], square), Ok(vec![1, 4, 9, 16]));
        assert_eq!(meter.run_cases_from_last(&[1, 2, 3, 4], square), Ok(vec![1, 4, 9, 16]));
        let mut heard = heard.lock().unwrap().clone();
        heard.sort_by(f64::total_cmp);
        assert_eq!(heard, [1, 2, 3, 4, 5, 6, 7, 8].map(|done| f64::from(done) / 8.0));
        let meter = ProgressMeter::new(2.0, &|_| ());
        assert_eq!(meter.run_cases(&[1, 2], |&case| if case == 2 { Err(case) } else { Ok(()) }), Err(2));
    }
}
