//! Clock of trials: wall time, processor time, or, in tests, synthetic time derived from the work done.

use cpu_time::ProcessTime;
#[cfg(test)]
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use stripmine_physics::method::Simulation;

/// Clock of trials. Tests derive its time from work, so that a plan does not depend on the speed of the machine.
#[derive(Debug)]
pub(crate) struct Stopwatch(StopwatchKind);

#[derive(Debug)]
enum StopwatchKind {
    Wall(Instant),
    Processor(ProcessTime),
    /// Nanoseconds so far, and per unit of work.
    #[cfg(test)]
    Made(AtomicU64, f64),
}

impl Stopwatch {
    /// Starts a wall clock.
    pub(crate) fn wall() -> Stopwatch {
        Stopwatch(StopwatchKind::Wall(Instant::now()))
    }

    /// Starts a processor clock, over all threads of this process.
    pub(crate) fn processor() -> Stopwatch {
        Stopwatch(StopwatchKind::Processor(ProcessTime::now()))
    }

    /// Starts a synthetic clock: each unit of [`Simulation::work`] takes so many nanoseconds.
    #[cfg(test)]
    pub(crate) fn with_synthetic_time(nanoseconds: f64) -> Stopwatch {
        Stopwatch(StopwatchKind::Made(AtomicU64::new(0), nanoseconds))
    }

    /// Seconds since the start.
    pub(crate) fn now(&self) -> f64 {
        match &self.0 {
            StopwatchKind::Wall(begun) => begun.elapsed().as_secs_f64(),
            StopwatchKind::Processor(begun) => begun.elapsed().as_secs_f64(),
            #[cfg(test)]
            StopwatchKind::Made(nanoseconds, _) => 1e-9 * nanoseconds.load(Ordering::Relaxed) as f64,
        }
    }

    /// Runs an action on a simulation, and counts its work.
    pub(crate) fn during<R>(
        &self,
        simulation: &mut dyn Simulation,
        act: impl FnOnce(&mut dyn Simulation) -> R,
    ) -> R {
        #[cfg(test)]
        if let StopwatchKind::Made(nanoseconds, each) = &self.0 {
            let before = simulation.work();
            let done = act(simulation);
            let spent = each * (simulation.work() - before);
            nanoseconds.fetch_add(spent.max(0.0) as u64, Ordering::Relaxed);
            return done;
        }
        act(simulation)
    }
}
