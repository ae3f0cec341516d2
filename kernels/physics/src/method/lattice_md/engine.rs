//! What the ways of stepping granular discs have in common: vector programs, the fast sweeps, and the source's rival.

use super::balance::Way;
use super::{Elapsed, Timings, Totals};
use crate::io::checkpoint::Column;
use crate::method::Failure;
use crate::observe::{Scenery, Sums};
use crate::particles::{Particles, States};
use stripmine_kernels::ledger::{Ledger, Length};

/// Steps granular discs. It never prints and never writes a file.
pub trait Engine: Send {
    /// Advances by one time step.
    ///
    /// # Errors
    /// [`Failure`] says what broke, which particles, where, and what to do; the state is that of the failing step.
    fn step(&mut self) -> Result<(), Failure>;

    /// Steps, periods and seconds since the start of the scene.
    fn elapsed(&self) -> &Elapsed;

    /// The same, to be changed.
    fn elapsed_mut(&mut self) -> &mut Elapsed;

    /// The particles as they stand, positions inside the box.
    fn particles(&self) -> Particles;

    /// Places inside the box and velocities of the grains.
    fn states(&self, states: &mut States) {
        states.take_up(&self.particles());
    }

    /// Positions alone, inside the box and in single precision.
    fn positions(&self) -> Vec<[f32; 3]> {
        self.particles().positions()
    }

    /// How many periods each has moved along x and y since the start; empty where a periodic side is not followed.
    fn images(&self) -> Vec<[i32; 2]>;

    /// The same as the state has them: the last correction may have taken a position beyond a periodic side, and no
    /// [crossing](Self::crossings) is counted before the next step.
    fn unwrapped(&self) -> Particles;

    /// Sums over the discs and their contacts as they stand, with what gravity has done on their way. Summed in an order that
    /// depends on the scene alone.
    fn sums(&self, scenery: &Scenery, way: &Way) -> Sums;

    /// Force along x and y and torque on every particle, as of the last step.
    fn forces(&self) -> Vec<[f64; 3]>;

    /// What has been counted and summed up since the start.
    fn totals(&self) -> Totals;

    /// Everything that the next step depends on, by name.
    fn state(&self) -> Vec<(String, Column)>;

    /// Takes a state up again.
    ///
    /// # Errors
    /// A sentence, if the columns are not those of this engine and scene.
    fn restore(&mut self, steps: u64, totals: Totals, columns: Vec<(String, Column)>) -> Result<(), String>;

    /// What a step executes.
    fn ledger(&self) -> Ledger;

    /// How long vectors of a symbolic length are, or were in the last step.
    fn length(&self, length: Length) -> u64;

    /// Entries of the neighbour lists, and how often they were made again; none where there are no lists.
    fn lists(&self) -> Option<(usize, u64)>;

    /// Steps done since the start of the scene.
    fn steps(&self) -> u64 {
        self.elapsed().steps
    }

    /// Time since the start of the scene.
    fn time(&self) -> f64 {
        self.elapsed().time()
    }

    /// How many periods each particle has moved along x and y since the start, in the order of
    /// [`particles`](Self::particles); empty where that is not followed.
    fn crossings(&self) -> &[[f64; 2]] {
        self.elapsed().crossings.counts()
    }

    /// Seconds spent in each phase.
    fn timings(&self) -> &Timings {
        &self.elapsed().timings
    }

    /// Forgets the seconds spent so far.
    fn reset_timings(&mut self) {
        self.elapsed_mut().timings = Timings::default();
    }
}
