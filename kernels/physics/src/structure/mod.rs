//! The structure of discs in a box and how it changes with time: what a run may sum up as it goes.
//!
//! Each observable is a row of one list. What is seen of one moment is averaged over the snapshots of a run, what is seen of two
//! over its rows; sums are kept by blocks of time (`blocks`), from which errors come.

mod blocks;
mod cells;
mod discs;
mod forces;
mod look;
mod motion;
mod pairs;
mod setting;
mod single;
mod waves;
mod work;

pub use blocks::Blocks;
pub use forces::{PairForce, PairForces, forces_on_each, net_forces};
pub use look::{Look, hexatic_orders, seen};
pub use motion::{Motion, widening};
pub use pairs::{pair_counts, pair_counts_of_all};
pub use setting::Setting;
pub use work::{bytes, strides};

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
}

/// How an observable is seen.
#[derive(Clone, Copy, Debug)]
pub enum Seen {
    /// Of the discs as they stand, at each snapshot.
    Once {
        /// What it is a function of: the middles of bins.
        over: Over,
        /// Its values, and more that are for headlines only; not a number where there is nothing to be seen.
        of: fn(&Look, &mut [f64]),
        /// How many these are.
        further: usize,
        /// What is found for it.
        asks: Asks,
    },
    /// Of discs at two moments, at each row.
    Twice {
        /// Its value by means over the discs: of Δx², Δy², v(0)·v(t) along x and along y.
        of: fn([f64; 4]) -> f64,
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

/// The middles of bins.
#[derive(Clone, Copy, Debug)]
pub enum Over {
    /// Along an axis.
    Axis(fn(&Setting) -> Vec<f64>),
    /// Of the cells of a grid over the box, row by row.
    Grid,
}

impl Over {
    /// One or two coordinates of each.
    pub fn places(&self, setting: &Setting) -> Vec<Vec<f64>> {
        match self {
            Over::Axis(middles) => middles(setting).into_iter().map(|middle| vec![middle]).collect(),
            Over::Grid => forces::grid(setting).into_iter().map(|middle| middle.to_vec()).collect(),
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
    /// Of what the function is over, its mean, and its values in a block.
    pub of: fn(&[f64], &[f64], &[f64]) -> f64,
    /// Why it cannot be had of a function, by what that is over and its mean.
    pub never: fn(&[f64], &[f64]) -> Option<&'static str>,
}

/// It can be had of every function.
const ALWAYS: fn(&[f64], &[f64]) -> Option<&'static str> = |_, _| None;

/// A grid over the box.
const PLACES: &[[&str; 2]] = &[["x", "length"], ["y", "length"]];
/// Where the definition of the stress comes from.
const STRESS: &str = "Irving and Kirkwood 1950, half of a pair to either disc (Thompson, Plimpton and Mattson 2009); velocities as seen from the box";
/// The number that stands for a component of the stress.
const OVER_BOX: [Headline; 1] = [Headline {
    name: "mean over the box",
    unit: "force/length",
    of: |_, _, block| block.iter().sum::<f64>() / block.len() as f64,
    never: ALWAYS,
}];

/// All of them.
pub static OBSERVABLES: [Observable; 16] = [
    Observable {
        name: "g(r)",
        file: "g.csv",
        over: &[["r", "length"]],
        value: ["g", ""],
        doc: "Pairs at a distance over those of an ideal gas in the same box, closed sides allowed for.",
        source: "Hansen and McDonald, Theory of Simple Liquids, section 2.5; closed sides by the set covariance of a rectangle (Stoyan \
                 and Stoyan 1994)",
        seen: Seen::Once {
            over: Over::Axis(pairs::distances),
            of: |it, values| pairs::correlation(&it.setting, &it.discs, &it.distances, values),
            further: 0,
            asks: Asks::Distances,
        },
        headlines: &[
            Headline {
                name: "height of the first peak",
                unit: "",
                of: |_, mean, block| block[peak(mean)],
                never: ALWAYS,
            },
            Headline {
                name: "place of the first peak",
                unit: "length",
                of: |over, _, block| over[peak(block)],
                never: ALWAYS,
            },
        ],
    },
    Observable {
        name: "S(k)",
        file: "s.csv",
        over: &[["k", "1/length"]],
        value: ["S", ""],
        doc: "The structure factor |Σ exp(ikr)|²/N of waves along the periodic axes of the box.",
        source: "Hansen and McDonald, Theory of Simple Liquids, section 4.1",
        seen: Seen::Once {
            over: Over::Axis(waves::numbers),
            of: |it, values| waves::factor(&it.waves, values),
            further: 0,
            asks: Asks::Waves,
        },
        headlines: &[
            Headline {
                name: "height of the main peak",
                unit: "",
                of: |_, mean, block| block[peak(mean)],
                never: ALWAYS,
            },
            Headline {
                name: "place of the main peak",
                unit: "1/length",
                of: |over, _, block| over[peak(block)],
                never: ALWAYS,
            },
        ],
    },
    Observable {
        name: "coordination",
        file: "coordination.csv",
        over: &[["neighbours", ""]],
        value: ["share of discs", ""],
        doc: "Shares of discs by their number of neighbours: others nearer than 1.5 times the sum of the radii.",
        source: "the first minimum of g(r) of dense discs lies there",
        seen: Seen::Once {
            over: Over::Axis(pairs::neighbour_numbers),
            of: |it, values| pairs::coordination(&it.discs, &it.neighbours, values),
            further: 0,
            asks: Asks::Neighbours,
        },
        headlines: &[Headline {
            name: "mean number of neighbours",
            unit: "",
            of: |over, _, block| over.iter().zip(block).map(|(number, share)| number * share).sum(),
            never: ALWAYS,
        }],
    },
    Observable {
        name: "psi6",
        file: "psi6.csv",
        over: &[["|psi6| of a disc", ""]],
        value: ["density", ""],
        doc: "Distribution of the hexatic order of single discs, ψ6 = ⟨exp(6iθ)⟩ over the six nearest.",
        source: "Nelson and Halperin 1979; six nearest neighbours in place of Voronoi's",
        seen: Seen::Once {
            over: Over::Axis(pairs::orders),
            of: |it, values| pairs::hexatic(&it.discs, &it.neighbours, values),
            further: 2,
            asks: Asks::Neighbours,
        },
        headlines: &[
            Headline {
                name: "global order |Ψ6|",
                unit: "",
                of: |over, _, block| block[over.len()],
                never: ALWAYS,
            },
            Headline {
                name: "mean order of a disc",
                unit: "",
                of: |over, _, block| block[over.len() + 1],
                never: ALWAYS,
            },
        ],
    },
    Observable {
        name: "velocities",
        file: "velocities.csv",
        over: &[["v/sqrt(kT/m)", ""]],
        value: ["density", ""],
        doc: "Distribution of both components of the velocity over √(kT/m), kT by the kinetic energy of the same moment.",
        source: "Maxwell 1860: the normal distribution in equilibrium",
        seen: Seen::Once {
            over: Over::Axis(single::speeds),
            of: |it, values| single::velocities(&it.discs, values),
            further: 1,
            asks: Asks::Discs,
        },
        headlines: &[Headline {
            name: "kurtosis",
            unit: "",
            of: |over, _, block| block[over.len()],
            never: ALWAYS,
        }],
    },
    Observable {
        name: "density(x)",
        file: "density-x.csv",
        over: &[["x", "length"]],
        value: ["density", "1/length²"],
        doc: "Centres of discs by area in a hundred slices along the first axis.",
        source: "Hansen and McDonald, Theory of Simple Liquids, section 2.5: the single-particle density, averaged across the axis",
        seen: Seen::Once {
            over: Over::Axis(single::slices::<0>),
            of: |it, values| single::density::<0>(&it.setting.domain, &it.discs, values),
            further: 0,
            asks: Asks::Discs,
        },
        headlines: &[],
    },
    Observable {
        name: "density(y)",
        file: "density-y.csv",
        over: &[["y", "length"]],
        value: ["density", "1/length²"],
        doc: "Centres of discs by area in a hundred slices along the second axis.",
        source: "Hansen and McDonald, Theory of Simple Liquids, section 2.5: the single-particle density, averaged across the axis",
        seen: Seen::Once {
            over: Over::Axis(single::slices::<1>),
            of: |it, values| single::density::<1>(&it.setting.domain, &it.discs, values),
            further: 0,
            asks: Asks::Discs,
        },
        headlines: &[],
    },
    Observable {
        name: "flow(x)",
        file: "flow-x.csv",
        over: &[["x", "length"]],
        value: ["velocity along y", "length/time"],
        doc: "Velocity of the discs along y, weighted by mass, in a hundred slices along x.",
        source: "Irving and Kirkwood 1950: momentum density over mass density",
        seen: Seen::Once {
            over: Over::Axis(single::slices::<0>),
            of: |it, values| single::flow::<0>(&it.setting.domain, &it.discs, values),
            further: 0,
            asks: Asks::Discs,
        },
        headlines: &[],
    },
    Observable {
        name: "flow(y)",
        file: "flow-y.csv",
        over: &[["y", "length"]],
        value: ["velocity along x", "length/time"],
        doc: "Velocity of the discs along x, weighted by mass, in a hundred slices along y.",
        source: "Irving and Kirkwood 1950: momentum density over mass density",
        seen: Seen::Once {
            over: Over::Axis(single::slices::<1>),
            of: |it, values| single::flow::<1>(&it.setting.domain, &it.discs, values),
            further: 0,
            asks: Asks::Discs,
        },
        headlines: &[],
    },
    Observable {
        name: "temperature(x)",
        file: "temperature-x.csv",
        over: &[["x", "length"]],
        value: ["kT", "energy"],
        doc: "Kinetic energy beside the flow of the slice, Σm|v − u|²/(2(n − 1)), in a hundred slices along the first axis.",
        source: "Irving and Kirkwood 1950: the kinetic part, with one disc less for the mean velocity",
        seen: Seen::Once {
            over: Over::Axis(single::slices::<0>),
            of: |it, values| single::temperature::<0>(&it.setting.domain, &it.discs, values),
            further: 0,
            asks: Asks::Discs,
        },
        headlines: &[],
    },
    Observable {
        name: "temperature(y)",
        file: "temperature-y.csv",
        over: &[["y", "length"]],
        value: ["kT", "energy"],
        doc: "Kinetic energy beside the flow of the slice, Σm|v − u|²/(2(n − 1)), in a hundred slices along the second axis.",
        source: "Irving and Kirkwood 1950: the kinetic part, with one disc less for the mean velocity",
        seen: Seen::Once {
            over: Over::Axis(single::slices::<1>),
            of: |it, values| single::temperature::<1>(&it.setting.domain, &it.discs, values),
            further: 0,
            asks: Asks::Discs,
        },
        headlines: &[],
    },
    Observable {
        name: "stress_xx(x,y)",
        file: "stress-xx.csv",
        over: PLACES,
        value: ["stress xx", "force/length"],
        doc: "Flow of momentum along x through a line across x, positive under pressure: Σm v_x v_x of the discs of a cell and half of r_x F_x of each of their pairs, walls among them, over its area.",
        source: STRESS,
        seen: Seen::Once {
            over: Over::Grid,
            of: |it, values| it.stress.component(0, values),
            further: 0,
            asks: Asks::Forces,
        },
        headlines: &OVER_BOX,
    },
    Observable {
        name: "stress_xy(x,y)",
        file: "stress-xy.csv",
        over: PLACES,
        value: ["stress xy", "force/length"],
        doc: "Flow of momentum along y through a line across x, as the stress xx: the symmetric part, (r_x F_y + r_y F_x)/2 of each pair.",
        source: STRESS,
        seen: Seen::Once {
            over: Over::Grid,
            of: |it, values| it.stress.component(1, values),
            further: 0,
            asks: Asks::Forces,
        },
        headlines: &OVER_BOX,
    },
    Observable {
        name: "stress_yy(x,y)",
        file: "stress-yy.csv",
        over: PLACES,
        value: ["stress yy", "force/length"],
        doc: "Flow of momentum along y through a line across y, as the stress xx.",
        source: STRESS,
        seen: Seen::Once {
            over: Over::Grid,
            of: |it, values| it.stress.component(2, values),
            further: 0,
            asks: Asks::Forces,
        },
        headlines: &OVER_BOX,
    },
    Observable {
        name: "msd",
        file: "msd.csv",
        over: &[["lag", "time"]],
        value: ["mean square displacement", "length²"],
        doc: "Mean square of the way of a disc within a time, across periodic sides.",
        source: "Einstein 1905: 4 D t in the plane after long times",
        seen: Seen::Twice { of: motion::square_displacement },
        headlines: &[Headline {
            name: "diffusion constant",
            unit: "length²/time",
            of: motion::by_displacements,
            never: ALWAYS,
        }],
    },
    Observable {
        name: "vacf",
        file: "vacf.csv",
        over: &[["lag", "time"]],
        value: ["velocity autocorrelation", "length²/time²"],
        doc: "⟨v(0)·v(t)⟩/2: the autocorrelation of a component of the velocity.",
        source: "Green and Kubo: its integral is D",
        seen: Seen::Twice { of: motion::velocity_product },
        headlines: &[Headline {
            name: "diffusion constant",
            unit: "length²/time",
            of: motion::by_velocities,
            never: motion::unresolved,
        }],
    },
];

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

/// Where a function is largest; the first place of several.
fn peak(values: &[f64]) -> usize {
    let larger = |best: usize, at: usize| if values[at] > values[best] { at } else { best };
    (0..values.len()).fold(0, larger)
}
