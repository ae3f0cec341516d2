//! Time as trials see it: that of the wall, of the processor, or, in tests, one that is made of the work done.

use cpu_time::ProcessTime;
#[cfg(test)]
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use stripmine_physics::method::Simulation;

/// Seconds that trials take. A test makes them of work, so that a plan does not depend on how fast the machine is at that moment.
#[derive(Debug)]
pub(crate) struct Stopwatch(Kind);

#[derive(Debug)]
enum Kind {
    Wall(Instant),
    Processor(ProcessTime),
    /// Nanoseconds so far, and those of a unit of work.
    #[cfg(test)]
    Made(AtomicU64, f64),
}

impl Stopwatch {
    /// Of the wall; begins now.
    pub(crate) fn wall() -> Stopwatch {
        Stopwatch(Kind::Wall(Instant::now()))
    }

    /// Of the processor, over all threads of this process; begins now.
    pub(crate) fn processor() -> Stopwatch {
        Stopwatch(Kind::Processor(ProcessTime::now()))
    }

    /// Made of work: each unit of [`Simulation::work`] takes so many nanoseconds.
    #[cfg(test)]
    pub(crate) fn made(nanoseconds: f64) -> Stopwatch {
        Stopwatch(Kind::Made(AtomicU64::new(0), nanoseconds))
    }

    /// Seconds since it began.
    pub(crate) fn now(&self) -> f64 {
        match &self.0 {
            Kind::Wall(begun) => begun.elapsed().as_secs_f64(),
            Kind::Processor(begun) => begun.elapsed().as_secs_f64(),
            #[cfg(test)]
            Kind::Made(nanoseconds, _) => 1e-9 * nanoseconds.load(Ordering::Relaxed) as f64,
        }
    }

    /// Lets a simulation do something, and counts its work.
    pub(crate) fn during<R>(
        &self,
        simulation: &mut dyn Simulation,
        act: impl FnOnce(&mut dyn Simulation) -> R,
    ) -> R {
        #[cfg(test)]
        if let Kind::Made(nanoseconds, each) = &self.0 {
            let before = simulation.work();
            let done = act(simulation);
            let spent = each * (simulation.work() - before);
            nanoseconds.fetch_add(spent.max(0.0) as u64, Ordering::Relaxed);
            return done;
        }
        act(simulation)
    }
}
