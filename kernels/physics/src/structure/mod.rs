//! The structure of discs in a box and how it changes with time: what a run may sum up as it goes.
//!
//! Each observable is a row of one list (`list`). What is seen of one moment is averaged over the snapshots of a run, what is seen of two
//! over its rows; sums are kept by blocks of time (`blocks`), from which errors come.

mod blocks;
mod cells;
mod diffusion;
mod discs;
mod forces;
mod heights;
mod ideal;
mod list;
mod look;
mod motion;
mod neighbours;
mod pairs;
mod setting;
mod single;
mod waves;
mod work;

pub(crate) use blocks::{Block, Blocks};
pub use forces::{PairForces, forces_on_each, net_forces};
pub use list::OBSERVABLES;
pub use look::{Look, hexatic_orders, seen};
pub use motion::{Motion, widening};
pub use pairs::{pair_counts, pair_counts_of_all};
pub use setting::Setting;
pub(crate) use work::bytes;
pub use work::strides;

/// A function of a distance, a time or the like that a run may sum up.
#[derive(Debug)]
pub struct Observable {
    /// Its name in scenes.
    pub name: &'static str,
    /// The file of a run's folder that it is written to.
    pub file: &'static str,
    /// What it is a function of, one thing or the two coordinates, each with the unit; empty for pure numbers.
    pub over: &'static [[&'static str; 2]],
    /// What its values are, with the unit.
    pub value: [&'static str; 2],
    /// What it is.
    pub doc: &'static str,
    /// Where its definition comes from.
    pub source: &'static str,
    /// How it is seen.
    pub seen: Seen,
    /// The numbers that stand for the whole.
    pub headlines: &'static [Headline],
    /// Whether these, and the function, can be relied on.
    pub judged: fn(&Whole<'_>) -> Verdict,
}

impl Observable {
    /// Whether discs are followed across periodic sides for it.
    pub(crate) fn follows_motion(&self) -> bool {
        matches!(self.seen, Seen::Twice { follows: true, .. })
    }

    /// Whether it counts discs by place: 0 says that none was seen, and not how seldom one is there.
    pub(crate) fn is_density_of_places(&self) -> bool {
        self.name.starts_with("density(")
    }
}

/// How an observable is seen.
#[derive(Clone, Copy, Debug)]
pub enum Seen {
    /// Of the discs as they stand, at each snapshot.
    Once {
        /// What it is a function of: the middles of bins.
        over: Over,
        /// Its values, and more that are for headlines only; and by what each counts in a mean, which is 1 if nothing else is said. Not a
        /// number, or without weight, where there is nothing to be seen.
        of: fn(&Look, &mut [f64], &mut [f64]),
        /// How many these are.
        further: usize,
        /// What is found for it.
        asks: Asks,
    },
    /// Of discs at two moments, at each row.
    Twice {
        /// Its value by means over the discs: of Δx², Δy², v(0)·v(t) along x and along y.
        of: fn([f64; 4]) -> f64,
        /// Whether that takes discs that are followed across periodic sides.
        follows: bool,
    },
}

/// What a look finds for several observables together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asks {
    /// Nothing but the discs.
    Discs,
    /// Pairs by their distance.
    Distances,
    /// The discs around each.
    Neighbours,
    /// Density waves.
    Waves,
    /// What discs, walls among them, do to each other.
    Forces,
}

/// The middles of bins, or wave vectors.
#[derive(Clone, Copy, Debug)]
pub enum Over {
    /// Along an axis.
    Axis(fn(&Setting) -> Vec<f64>),
    /// Of the cells of a grid over the box, row by row.
    Grid,
    /// Wave vectors, each along one of the periodic axes.
    Waves,
}

impl Over {
    /// One or two coordinates of each.
    pub fn places(&self, setting: &Setting) -> Vec<Vec<f64>> {
        match self {
            Over::Axis(middles) => middles(setting).into_iter().map(|middle| vec![middle]).collect(),
            Over::Grid => forces::grid(setting).into_iter().map(|middle| middle.to_vec()).collect(),
            Over::Waves => waves::vectors(setting).into_iter().map(|vector| vector.to_vec()).collect(),
        }
    }
}

/// A number that stands for a whole function.
#[derive(Debug)]
pub struct Headline {
    /// Its name.
    pub name: &'static str,
    /// Its unit, empty for pure numbers.
    pub unit: &'static str,
    /// Its value in a block of a function.
    pub of: fn(&Whole<'_>, &[f64]) -> f64,
    /// What its mean may be off by beyond its statistical error (part of it).
    pub bias: fn(&Whole<'_>) -> f64,
}

/// The mean over blocks of a number of each, with its bar; of a number that is of lags up to one at a place. None where blocks are too few.
pub(crate) type Estimator<'e> = dyn Fn(&dyn Fn(&[f64]) -> f64, usize) -> Option<[f64; 2]> + 'e;

/// A function that was summed up, at least one value of it.
pub struct Whole<'w> {
    /// The box and the discs at the start.
    pub setting: &'w Setting,
    /// What it is over: of wave vectors and places their length.
    pub over: &'w [f64],
    /// Its means, each with its bar.
    pub means: &'w [[f64; 2]],
    /// The time of the run so far; 0 where it is not of lags.
    pub elapsed: f64,
    /// What means over blocks are found by.
    pub mean: &'w Estimator<'w>,
}

/// Whether a function, and the numbers that stand for it, can be relied on.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// They can.
    Sound,
    /// They stand, but for this.
    Doubt(String),
    /// The numbers cannot be had, for this reason.
    None(String),
}

/// Their names, for scenes.
pub static NAMES: [&str; OBSERVABLES.len()] = {
    let mut names = [""; OBSERVABLES.len()];
    let mut place = 0;
    while place < names.len() {
        names[place] = OBSERVABLES[place].name;
        place += 1;
    }
    names
};

/// The observable of a name.
pub fn observable(name: &str) -> Option<&'static Observable> {
    OBSERVABLES.iter().find(|observable| observable.name == name)
}
