//! What can be reproduced: the list of items, each a study and its report.

use crate::cli::{Failure, listing};
use crate::method::lattice_md::Part;
use crate::model::host::default_model;
use crate::model::machines;
use crate::origin;
use crate::report::pipe_flow::Showing;
use crate::report::{self, Section};
use crate::study::calibration;
use crate::study::efficiency_table::Question;
use crate::study::model_validation::{self, Calibrated, calibrated_in_turns, model_validation};
use crate::study::rounds::Bound;
use crate::study::{
    break_even, crossover, damping, density_cost, efficiency_table, host_ladder, identity, ladder,
    measured_cost, misprints, pipe_flow, precision, threads, useful_work,
};
use clap::ValueEnum;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use stripmine_kernels::InstructionSet;

/// How much is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Under a minute in all.
    Quick,
    /// As much as the sources show.
    Full,
}

/// A finished item.
pub(in crate::cli) struct Made {
    /// What is shown of it.
    pub(super) section: Section,
    /// The dataset.
    pub(super) data: serde_json::Value,
    /// Further files: name and contents.
    pub(super) files: Vec<(String, String)>,
}

macro_rules! define_items {
    ($(($variant:ident, $name:literal, $quick:expr, $full:expr, $doc:literal)),* $(,)?) => {
        /// What can be reproduced.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
        pub(super) enum Item {
            $(#[doc = $doc] #[value(name = $name)] $variant,)*
        }

        impl Item {
            /// The name on the command line.
            pub(super) const fn name(self) -> &'static str {
                match self { $(Item::$variant => $name),* }
            }

            /// Seconds that an item takes about, for the estimate of what is left.
            pub(super) const fn seconds(self, effort: Effort) -> f64 {
                match self {
                    $(Item::$variant => if matches!(effort, Effort::Quick) { $quick } else { $full },)*
                }
            }
        }
    };
}

define_items! {
    (Table, "table", 0.1, 0.1, "BP93's efficiency table"),
    (Ladder, "ladder", 0.1, 0.1, "What each refinement of the clock adds, machine by machine"),
    (Listing, "listing", 0.1, 0.1, "The vector instructions of every part"),
    (Mask, "mask", 0.1, 0.1, "BP93, figure 2: the mask"),
    (Misprints, "misprints", 0.5, 0.5, "What the misprints of the contact law do"),
    (Cost, "cost", 1.0, 1.0, "BP93, figures 3 and 4: cost over particles and density, by the model"),
    (UsefulWork, "useful-work", 1.0, 1.0, "Operations that act on real contacts, over the density"),
    (Measured, "measured", 8.0, 60.0, "The same, measured on this host"),
    (Validation, "validation", 4.0, 150.0, "The timing model of this host against wall time"),
    (Atlas, "atlas", 5.0, 110.0, "Who wins where: occupancy, number of particles, method and machine"),
    (Crossover, "crossover", 4.0, 150.0, "Lattice, neighbour lists and sectors: which is the fastest at which density, on this host"),
    (Threads, "threads", 3.0, 60.0, "What more threads give, and what the machine has to give"),
    (Identity, "identity", 3.0, 3.0, "Lattice and neighbour lists: the same to the bit"),
    (Precision, "precision", 60.0, 60.0, "What single and mixed precision cost: forces, energy, trajectories"),
    (PipeSmall, "pipe-small", 3.0, 3.0, "BP93, figures 5 and 6, in two fifths of the pipe"),
    (Pipe, "pipe", 120.0, 120.0, "BP93, figures 5 and 6, in the whole pipe"),
    (PipeThin, "pipe-thin", 30.0, 30.0, "The whole pipe with fewer grains: waves both ways"),
    (Waves, "waves", 60.0, 60.0, "Density waves over dissipation, and controls without"),
}

impl Item {
    /// Whether the item is made when none is named.
    pub(super) const fn belongs_to(self, effort: Effort) -> bool {
        matches!(effort, Effort::Full)
            || !matches!(self, Item::Precision | Item::Pipe | Item::PipeThin | Item::Waves)
    }

    /// Makes the item. `progress` gets the share that is done.
    pub(super) fn make(self, effort: Effort, progress: &(dyn Fn(f64) + Sync)) -> Result<Made, Failure> {
        match self {
            Item::Table => {
                let data =
                    efficiency_table::efficiency_table(&Question::default(), &machines::preset("paper")?)?;
                made(report::efficiency_table::section(&data), &data)
            }
            Item::Ladder => {
                let ladders: Vec<_> = ["cray-y-mp-el", "cray-1", "cray-c90", "sx-aurora"]
                    .into_iter()
                    .map(|name| Ok(ladder::ladder(&Question::default(), &machines::preset(name)?)?))
                    .collect::<Result<_, Failure>>()?;
                let host = host_ladder::host_ladder(&Question::default(), &default_model()?)?;
                let mut section = report::ladder::section(&ladders);
                section.tables.push(report::ladder::of_host(&host));
                made(section, &serde_json::json!({ "machines": ladders, "host": host }))
            }
            Item::Listing => listings(),
            Item::Mask => made(report::mask::section(), &()),
            Item::Misprints => {
                let data = misprints::misprints();
                made(report::misprints::section(&data), &data)
            }
            Item::Cost => {
                let data = density_cost::density_cost(&machines::preset("paper")?)?;
                made(report::density_cost::section(&data), &data)
            }
            Item::UsefulWork => {
                let data = useful_work::useful_work()?;
                made(report::useful_work::section(&data), &data)
            }
            Item::Measured => {
                let data = measured_cost::measured_cost(&measured_effort(effort), progress)?;
                made(report::measured_cost::section(&data), &data)
            }
            Item::Validation => validation(effort, progress),
            Item::Atlas => atlas(effort, progress),
            Item::Crossover => {
                let data = crossover::crossover(&crossover_effort(effort), progress)?;
                made(report::crossover::section(&data), &data)
            }
            Item::Threads => {
                let cores = std::thread::available_parallelism().map_or(1, usize::from);
                let data = threads::threads(cores, &threads_effort(effort), progress)?;
                made(report::threads::section(&data), &data)
            }
            Item::Identity => {
                let data = identity::identity(progress)?;
                made(report::identity::section(&data), &data)
            }
            Item::Precision => {
                let data = precision::precision(progress)?;
                made(report::precision::section(&data), &data)
            }
            Item::PipeSmall => {
                let title = "Density waves in a short pipe (figures 5 and 6)";
                let showing = Showing { name: self.name(), title, from: 0.0, snapshots: 11 };
                pipes(showing, ("pipe-small", &[]), &[1], progress)
            }
            Item::Pipe => {
                let title = "Density waves in the whole pipe (figures 5 and 6)";
                let showing = Showing { name: self.name(), title, from: 10.0, snapshots: 14 };
                pipes(showing, ("pipe", &[]), &[1, 2, 3, 4], progress)
            }
            Item::PipeThin => {
                let title = "Density waves both ways in a thinner filling";
                let showing = Showing { name: self.name(), title, from: 0.0, snapshots: 0 };
                pipes(showing, ("pipe", &["particles.packing_fraction=0.35"]), &[1, 2], progress)
            }
            Item::Waves => {
                let seeds = [1, 2, 3, 4, 5, 6];
                let data = damping::damping(&seeds, progress)?;
                made(report::damping::section(&data), &data)
            }
        }
    }
}

impl Made {
    /// Of a section and its dataset.
    pub(in crate::cli) fn new(section: Section, data: &impl Serialize) -> Result<Made, Failure> {
        let data = serde_json::to_value(data).map_err(|cause| Failure::writing("JSON")(cause.into()))?;
        Ok(Made { section, data, files: vec![] })
    }

    /// With one more file.
    #[must_use]
    pub(in crate::cli) fn with_file(mut self, name: &str, text: String) -> Made {
        self.files.push((name.to_owned(), text));
        self
    }
}

fn made(section: Section, data: &impl Serialize) -> Result<Made, Failure> {
    Made::new(section, data)
}

/// The shipped host model on few cases, or, in full, a fresh calibration in turns with more of them.
fn validation(effort: Effort, progress: &(dyn Fn(f64) + Sync)) -> Result<Made, Failure> {
    let runs = |particles, occupancies, rounds| model_validation::Effort {
        particles,
        occupancies,
        rounds,
        further: 0,
        repeats: 1,
        particle_steps: 10_000,
    };
    match effort {
        Effort::Quick => {
            let (host, runs) = (default_model()?, runs(vec![100, 2000], vec![0.2], Bound::of(6)));
            let data = model_validation(&host, Calibrated::Shipped, &runs, progress)?;
            made(report::model_validation::section(&data), &data)
        }
        Effort::Full => {
            let (sweeps, best) = (calibration::Effort { sweeps: 6 }, InstructionSet::best());
            let runs = runs(vec![150, 4000], vec![0.05, 0.24], bound(6, VALIDATION));
            let (host, data) = calibrated_in_turns(origin::host(), best, sweeps, &runs, progress)?;
            made(report::model_validation::section(&data), &data)
                .map(|made| made.with_file("host.toml", host.to_toml()))
        }
    }
}

/// Seconds that rounds of the validation and of the atlas may take in full, so that all that is said of this host's model takes
/// four minutes: scenes are laid out before, and the model is fitted after.
const VALIDATION: u64 = 105;
const ATLAS: u64 = 85;

fn bound(most: usize, seconds: u64) -> Bound {
    Bound { most, within: Some(Duration::from_secs(seconds)) }
}

/// The machine of the source, the CRAY of the application, and this host, by the model that comes with the program.
fn atlas(effort: Effort, progress: &(dyn Fn(f64) + Sync)) -> Result<Made, Failure> {
    let machines = [machines::preset("paper")?, machines::preset("cray-y-mp-el")?];
    let host = default_model()?;
    let (measured, rounds): (&[usize], Bound) = match effort {
        Effort::Quick => (&[300], Bound::of(2)),
        Effort::Full => (&[100, 300, 1000, 3000, 10_000], bound(6, ATLAS)),
    };
    let data = break_even::atlas(&machines, &host, measured, rounds, progress)?;
    made(report::break_even::section(&data, "stripmine reproduce --only atlas"), &data)
}

fn measured_effort(effort: Effort) -> measured_cost::Effort {
    match effort {
        Effort::Quick => measured_cost::Effort {
            particles: vec![100, 1000],
            occupancies: vec![0.1, 0.2],
            equilibration: 50,
            element_steps: 200_000,
            repeats: 3,
        },
        Effort::Full => measured_cost::Effort {
            particles: vec![100, 300, 1000, 3000, 10_000],
            occupancies: vec![0.01, 0.03, 0.1, 0.2, 0.25],
            equilibration: 100,
            element_steps: 1_000_000,
            repeats: 5,
        },
    }
}

fn crossover_effort(effort: Effort) -> crossover::Effort {
    match effort {
        Effort::Quick => crossover::Effort {
            precisions: vec!["f64"],
            particles: vec![4000],
            packing_fractions: vec![0.84, 0.3, 0.1],
            steps: 60,
            repeats: 2,
        },
        Effort::Full => crossover::Effort {
            precisions: vec!["f64", "mixed", "f32"],
            particles: vec![10_000, 100_000],
            packing_fractions: vec![0.84, 0.8, 0.6, 0.3, 0.1, 0.03],
            steps: 120,
            repeats: 3,
        },
    }
}

fn threads_effort(effort: Effort) -> threads::Effort {
    match effort {
        Effort::Quick => threads::Effort {
            particles: vec![20_000],
            packing_fractions: vec![0.84],
            rounds: 3,
            particle_steps: 1_000_000,
        },
        Effort::Full => threads::Effort {
            particles: vec![10_000, 100_000, 1_000_000],
            packing_fractions: vec![0.84, 0.3],
            rounds: 7,
            particle_steps: 10_000_000,
        },
    }
}

/// Runs of a scene with overrides, side by side; the first keeps its frames if snapshots are shown.
fn pipes(
    showing: Showing,
    (scene, overrides): (&'static str, &[&str]),
    seeds: &[u64],
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Made, Failure> {
    const PARTS: f64 = 1000.0;
    let done: Vec<AtomicUsize> = seeds.iter().map(|_| AtomicUsize::new(0)).collect();
    let numbered: Vec<(usize, u64)> = seeds.iter().copied().enumerate().collect();
    let flows = numbered.par_iter().map(|&(at, seed)| {
        let question = pipe_flow::Question {
            scene,
            overrides: overrides.iter().map(|&text| text.to_owned()).collect(),
            seed,
            keep_frames: at == 0 && showing.snapshots > 0,
        };
        pipe_flow::pipe_flow(&question, |share| {
            done[at].store((PARTS * share) as usize, Ordering::Relaxed);
            let sum: usize = done.iter().map(|part| part.load(Ordering::Relaxed)).sum();
            progress(sum as f64 / PARTS / seeds.len() as f64);
        })
    });
    let flows: Vec<pipe_flow::PipeFlow> = flows.collect::<Result<_, _>>()?;
    made(report::pipe_flow::section(showing, &flows), &flows)
}

fn listings() -> Result<Made, Failure> {
    let mut parts = vec![];
    for &part in Part::ALL {
        let listings = listing::listings(part, &Question::default())?;
        let (text, instructions) = (listing::text(&listings), listing::instructions(&listings));
        parts.push(report::listing::PartListing { part: part.name(), text, instructions });
    }
    let mut made = made(report::listing::section(&parts), &())?;
    made.files = parts.into_iter().map(|part| (format!("{}.txt", part.part), part.text)).collect();
    Ok(made)
}
