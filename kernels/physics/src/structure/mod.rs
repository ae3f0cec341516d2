//! Structure of discs in a box and its change in time, averaged during a run.
//!
//! Each observable is an entry of one list (`list`). Functions of one moment are averaged over the snapshots of a run, functions of two over its
//! rows. Sums are stored by blocks of time (`blocks`), which yield the errors.

mod blocks;
mod cells;
mod diffusion;
mod discs;
mod forces;
mod heights;
mod ideal;
mod list;
mod motion;
mod neighbours;
mod pairs;
mod sample;
mod setting;
mod single;
mod waves;
mod work;

pub(crate) use blocks::{Block, Blocks};
pub use forces::{PairForces, forces_on_each, net_forces};
pub use list::OBSERVABLES;
pub use motion::{MotionHistory, widening};
pub use pairs::{pair_counts, pair_counts_of_all};
pub use sample::{StructureSample, hexatic_orders, sampled_values};
pub use setting::StructureSetting;
pub(crate) use setting::{MOST_SPECIES, species_numbers};
pub(crate) use work::bytes;
pub use work::strides;

/// Function of a distance, a time or the like that a run can average.
#[derive(Debug)]
pub struct StructureObservable {
    /// Name in scenes.
    pub name: &'static str,
    /// File in the run's folder.
    pub file: &'static str,
    /// Arguments of the function, one quantity or two coordinates, each with its unit; the unit is empty for pure numbers. The numbers of one
    /// species, `a`, or of two, `a` and `b`, may come before.
    pub over: &'static [[&'static str; 2]],
    /// Quantity of the values, with the unit.
    pub value: [&'static str; 2],
    /// Definition in words.
    pub doc: &'static str,
    /// Source of the definition.
    pub source: &'static str,
    /// Sampling of the function.
    pub seen: SamplingKind,
    /// Numbers that summarise it.
    pub headlines: &'static [Headline],
    /// Decides whether the function and its headlines are reliable.
    pub judged: fn(&AveragedFunction<'_>) -> FunctionReliability,
}

impl StructureObservable {
    /// True if it needs discs followed across periodic sides.
    pub(crate) fn follows_motion(&self) -> bool {
        matches!(self.seen, SamplingKind::Twice { follows: true, .. })
    }

    /// Number of leading arguments that are numbers of species.
    pub fn species(&self) -> usize {
        self.over.iter().take_while(|[name, _]| ["a", "b"].contains(name)).count()
    }

    /// True if it counts discs by position: a value of 0 then means that none was sampled, not that the density is 0.
    pub(crate) fn is_density_of_places(&self) -> bool {
        self.name.starts_with("density(")
    }
}

/// Sampling of an observable.
#[derive(Clone, Copy, Debug)]
pub enum SamplingKind {
    /// At single moments: the snapshots.
    Once {
        /// Arguments: centres of bins.
        over: FunctionArguments,
        /// Computes its values, then further ones for headlines only, and their weights in a mean, which are 1 by default. A value is NaN or has no
        /// weight if a sample does not define it.
        of: fn(&StructureSample, &mut [f64], &mut [f64]),
        /// Number of further values.
        further: usize,
        /// Data that it needs.
        asks: SampleData,
    },
    /// At pairs of moments: the rows.
    Twice {
        /// Value as a function of means over the discs: of Δx², Δy², v(0)·v(t) along x and along y.
        of: fn([f64; 4]) -> f64,
        /// True if it needs discs followed across periodic sides.
        follows: bool,
        /// True if the means are over the discs of each species.
        by_species: bool,
    },
}

/// Data that a sample provides to several observables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleData {
    /// Discs only.
    Discs,
    /// Pairs by their distance.
    Distances,
    /// Neighbours of each disc.
    Neighbours,
    /// Pairs of species by their distance.
    DistancesOfSpecies,
    /// Density waves.
    Waves,
    /// Density waves of each species.
    WavesOfSpecies,
    /// Forces between discs, walls included.
    Forces,
}

/// Arguments of a function: centres of bins, or wave vectors.
#[derive(Clone, Copy, Debug)]
pub enum FunctionArguments {
    /// Along an axis.
    Axis(fn(&StructureSetting) -> Vec<f64>),
    /// Cells of a grid over the box, row by row.
    Grid,
    /// Wave vectors, each along one of the periodic axes.
    Waves,
    /// Coordinates that begin with the numbers of one or two species, from 1.
    Species(fn(&StructureSetting) -> Vec<Vec<f64>>),
}

impl FunctionArguments {
    /// Coordinates of each.
    pub fn places(&self, setting: &StructureSetting) -> Vec<Vec<f64>> {
        match self {
            FunctionArguments::Axis(middles) => {
                middles(setting).into_iter().map(|middle| vec![middle]).collect()
            }
            FunctionArguments::Grid => {
                forces::grid(setting).into_iter().map(|middle| middle.to_vec()).collect()
            }
            FunctionArguments::Waves => {
                waves::vectors(setting).into_iter().map(|vector| vector.to_vec()).collect()
            }
            FunctionArguments::Species(places) => places(setting),
        }
    }
}

/// Number that summarises a function.
#[derive(Debug)]
pub struct Headline {
    /// Name of the number.
    pub name: &'static str,
    /// Unit; empty for pure numbers.
    pub unit: &'static str,
    /// Value for a block of the function.
    pub of: fn(&AveragedFunction<'_>, &[f64]) -> f64,
    /// Relative bias of the mean beyond its statistical error.
    pub bias: fn(&AveragedFunction<'_>) -> f64,
}

/// Mean over blocks of a number computed from each, with its error bar. The second argument is the index of the largest lag that the number uses.
/// None if blocks are too few.
pub(crate) type Estimator<'e> = dyn Fn(&dyn Fn(&[f64]) -> f64, usize) -> Option<[f64; 2]> + 'e;

/// Averaged function with at least one value.
pub struct AveragedFunction<'w> {
    /// Box and initial discs.
    pub setting: &'w StructureSetting,
    /// Arguments; of wave vectors and positions their length.
    pub over: &'w [f64],
    /// Means with their error bars.
    pub means: &'w [[f64; 2]],
    /// Time of the run so far; 0 unless the arguments are lags.
    pub elapsed: f64,
    /// Estimator of means over blocks.
    pub mean: &'w Estimator<'w>,
}

/// Reliability of a function and its headlines.
#[derive(Clone, Debug, PartialEq)]
pub enum FunctionReliability {
    /// Reliable.
    Sound,
    /// Usable with this reservation.
    Doubt(String),
    /// Not available, for this reason.
    None(String),
}

/// Names of all observables, for scenes.
pub static NAMES: [&str; OBSERVABLES.len()] = {
    let mut names = [""; OBSERVABLES.len()];
    let mut place = 0;
    while place < names.len() {
        names[place] = OBSERVABLES[place].name;
        place += 1;
    }
    names
};

/// Observable with a name.
pub fn observable(name: &str) -> Option<&'static StructureObservable> {
    OBSERVABLES.iter().find(|observable| observable.name == name)
}
