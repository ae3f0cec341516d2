//! What can be reproduced of this method: each item a study and its section of the report.

use super::sections::{self, pipe_flow::Showing};
use super::study::calibration;
use super::study::efficiency_table::Question;
use super::study::model_validation::{self, Calibrated, model_validation};
use super::study::rounds::Bound;
use super::study::{
    break_even, crossover, damping, density_cost, efficiency_table, host_ladder, identity, ladder, listing,
    measured_cost, misprints, pipe_flow, precision, printed_cost, threads, useful_work,
};
use crate::console::Failure;
use crate::model::host::{HostModel, default_model};
use crate::model::machines;
use crate::report::Chapter::{Beyond, Host, Sources};
use crate::report::Section;
use crate::results::{Item, Lab, Made, Meter, Progress, Size};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use std::sync::OnceLock;
use std::time::Duration;
use stripmine_kernels::InstructionSet;
use stripmine_physics::method::lattice_md::Part;
use stripmine_physics::origin;
use stripmine_physics::scene::{Overrides, PACKING_FRACTION, STEPS};

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::quick("table", Sources, [0.1, 0.2], table, "BP93's efficiency table"),
    Item::quick(
        "ladder",
        Beyond,
        [0.1, 0.1],
        ladder,
        "What each refinement of the clock adds, machine by machine",
    ),
    Item::quick("listing", Sources, [0.1, 0.1], listing, "The vector instructions of every part"),
    Item::quick("mask", Sources, [0.1, 0.1], mask, "BP93, figure 2: the mask"),
    Item::quick("misprints", Sources, [0.1, 0.1], misprints, "What the misprints of the contact law do"),
    Item::quick(
        "cost",
        Sources,
        [0.5, 0.5],
        cost,
        "BP93, figures 3 and 4: cost over particles and density, by the model",
    ),
    Item::quick(
        "useful-work",
        Beyond,
        [0.3, 0.3],
        useful_work,
        "Operations that act on real contacts, over the density",
    ),
    Item::quick(
        "printed",
        Sources,
        [6.0, 45.0],
        printed,
        "The printed text run the CRAY's way: NOP·(n + D) against wall time, and what thirty years made of it",
    )
    .with_memory(900),
    Item::quick("measured", Host, [8.0, 21.0], measured, "The same, measured on this host"),
    Item::quick(
        "validation",
        Host,
        [4.0, 31.0],
        validation,
        "The timing model of a host against wall time here",
    ),
    Item::full(
        "atlas",
        Host,
        36.0,
        atlas,
        "Who wins where: occupancy, number of particles, method and machine",
    ),
    Item::quick(
        "crossover",
        Host,
        [4.0, 34.0],
        crossover,
        "Lattice, neighbour lists and sectors: which is the fastest at which density, on this host",
    ),
    Item::quick(
        "threads",
        Host,
        [3.0, 16.0],
        threads,
        "What more threads give, and what the machine has to give",
    ),
    Item::quick(
        "identity",
        Sources,
        [1.0, 1.0],
        identity,
        "Lattice and neighbour lists: the same to the bit",
    ),
    Item::full(
        "precision",
        Beyond,
        23.0,
        precision,
        "What single and mixed precision cost: forces, energy, trajectories",
    ),
    Item::quick(
        "pipe-small",
        Sources,
        [1.0, 1.0],
        pipe_small,
        "BP93, figures 5 and 6, in two fifths of the pipe",
    ),
    Item::full("pipe", Sources, 15.0, pipe, "BP93, figures 5 and 6, in the whole pipe"),
    Item::full(
        "pipe-thin",
        Sources,
        13.0,
        pipe_thin,
        "The whole pipe with fewer grains: do waves run both ways?",
    ),
    Item::full("waves", Sources, 20.0, waves, "Density waves over dissipation, and controls without"),
];

fn table(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let data = efficiency_table::efficiency_table(&Question::default(), &machines::preset("paper")?)?;
    made(sections::efficiency_table::section(&data), &data)
}

fn ladder(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let ladders: Vec<_> = ["cray-y-mp-el", "cray-1", "sx-aurora"]
        .into_iter()
        .map(|name| Ok(ladder::ladder(&Question::default(), &machines::preset(name)?)?))
        .collect::<Result<_, Failure>>()?;
    made(sections::ladder::section(&ladders), &ladders)
}

fn listing(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    listings()
}

fn mask(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    made(sections::mask::section(), &())
}

fn misprints(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let data = misprints::misprints();
    made(sections::misprints::section(&data), &data)
}

fn cost(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let data = density_cost::density_cost(&machines::preset("paper")?)?;
    made(sections::density_cost::section(&data), &data)
}

fn useful_work(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let data = useful_work::useful_work()?;
    made(sections::useful_work::section(&data), &data)
}

fn printed(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    // Short vectors for the line, up to the first cache; long ones for where it breaks.
    let short = [25, 49, 100, 170, 290, 500, 1000, 10_000, 100_000];
    let long = [2000, 5000, 30_000, 300_000, 1_000_000, 3_000_000];
    let effort = match effort {
        Size::Quick => printed_cost::Effort {
            cells: short.to_vec(),
            occupancies: vec![1.0],
            samples: 8,
            particles: 1000,
            rounds: Bound::of(3),
        },
        Size::Full | Size::All => printed_cost::Effort {
            cells: [&short[..], &long].concat(),
            occupancies: vec![0.05, 0.1, 0.5, 1.0],
            samples: 24,
            particles: 10_000,
            rounds: bound(15, 20),
        },
    };
    let data = printed_cost::printed_cost(&effort, progress)?;
    made(sections::printed_cost::section(&data), &data)
}

fn measured(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let data = measured_cost::measured_cost(&measured_effort(effort), progress)?;
    made(sections::measured_cost::section(&data), &data)
}

fn crossover(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let data = crossover::crossover(&crossover_effort(effort), progress)?;
    made(sections::crossover::section(&data), &data)
}

fn threads(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let data = threads::threads(cores, &threads_effort(effort), progress)?;
    made(sections::threads::section(&data), &data)
}

fn identity(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let data = identity::identity(progress)?;
    made(sections::identity::section(&data), &data)
}

fn precision(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let data = precision::precision(progress)?;
    made(sections::precision::section(&data), &data)
}

fn pipe_small(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let title = "Density waves in a short pipe (figures 5 and 6)";
    let question = "Do grains that fall through two fifths of the pipe form density waves?";
    let showing = Showing { name: "pipe-small", title, question, asks_ways: false, from: 0.0, snapshots: 0 };
    pipes(showing, ("pipe-small", Overrides::new()), &[1], progress)
}

fn pipe(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let title = "Density waves in the whole pipe (figures 5 and 6)";
    let question = "Do grains that fall through the source's whole pipe form density waves?";
    let showing = Showing { name: "pipe", title, question, asks_ways: false, from: 10.0, snapshots: 14 };
    pipes(showing, ("pipe", Overrides::new()), &[1, 2], progress)
}

fn pipe_thin(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let title = "Density waves in a thinner filling";
    let question = "Do the waves run both ways where the pipe is filled less?";
    let showing = Showing { name: "pipe-thin", title, question, asks_ways: true, from: 0.0, snapshots: 0 };
    let thin = Overrides::new().set(&PACKING_FRACTION, 0.35);
    pipes(showing, ("pipe", thin), &[1, 2], progress)
}

fn waves(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let seeds = [1, 2, 3, 4, 5, 6];
    let data = damping::damping(&seeds, progress)?;
    made(sections::damping::section(&data), &data)
}

fn made(section: Section, data: &impl Serialize) -> Result<Made, Failure> {
    Made::new(section, data)
}

/// The shipped host model on few cases, or, in full, a fresh calibration and more of them.
fn validation(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let runs = |particles, occupancies, rounds| model_validation::Effort {
        particles,
        occupancies,
        rounds,
        particle_steps: 10_000,
    };
    match effort {
        Size::Quick => {
            let (host, runs) = (default_model()?, runs(vec![300], vec![0.2], Bound::of(2)));
            validated(&host, Calibrated::Shipped, &runs, &progress)
        }
        Size::Full | Size::All => {
            let host = this_host(&|share| progress(0.5 * share))?;
            let runs = runs(vec![150, 4000], vec![0.072, 0.24], bound(6, VALIDATION));
            validated(host, Calibrated::Now, &runs, &|share| progress(0.5 + 0.5 * share))
        }
    }
}

fn validated(
    host: &HostModel,
    calibrated: Calibrated,
    runs: &model_validation::Effort,
    progress: Progress<'_>,
) -> Result<Made, Failure> {
    let data = model_validation(host, calibrated, runs, progress)?;
    let ladder = host_ladder::host_ladder(&Question::default(), host, calibrated)?;
    let section = sections::model_validation::section(&data).tables([sections::ladder::of_host(&ladder)]);
    made(section, &serde_json::json!({ "validation": data, "ladder": ladder }))
}

/// The model of this host, calibrated by the first item that asks for it.
fn this_host(progress: Progress<'_>) -> Result<&'static HostModel, Failure> {
    static MODEL: OnceLock<HostModel> = OnceLock::new();
    if let Some(known) = MODEL.get() {
        return Ok(known);
    }
    let (effort, best) = (calibration::Effort { seconds: 25.0 }, InstructionSet::best());
    let model = calibration::calibrate(origin::host(), best, effort, progress)?;
    Ok(MODEL.get_or_init(|| model))
}

/// Seconds that rounds of the validation and of the atlas may take in full, so that all that is said of this host's model takes
/// a minute and a half: scenes are laid out before, and the model is fitted after.
const VALIDATION: u64 = 15;
const ATLAS: u64 = 12;

fn bound(most: usize, seconds: u64) -> Bound {
    Bound { most, within: Some(Duration::from_secs(seconds)) }
}

/// The machine of the source, the CRAY of the application, and this host, beside what is measured here.
fn atlas(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let machines = [machines::preset("paper")?, machines::preset("cray-y-mp-el")?];
    let host = this_host(&|_| {})?;
    let (measured, rounds): (&[usize], Bound) = match effort {
        Size::Quick => (&[300], Bound::of(2)),
        Size::Full | Size::All => (&[100, 300, 1000, 3000, 10_000], bound(6, ATLAS)),
    };
    let data = break_even::atlas(&machines, (host, Calibrated::Now), measured, rounds, progress)?;
    made(sections::break_even::section(&data, "stripmine reproduce --only atlas"), &data)
}

fn measured_effort(effort: Size) -> measured_cost::Effort {
    match effort {
        Size::Quick => measured_cost::Effort {
            particles: vec![100, 1000],
            occupancies: vec![0.1, 0.2],
            equilibration: 50,
            element_steps: 200_000,
            repeats: 3,
        },
        Size::Full | Size::All => measured_cost::Effort {
            particles: vec![100, 300, 1000, 3000, 10_000],
            occupancies: vec![0.01, 0.03, 0.1, 0.2, 0.25],
            equilibration: 100,
            element_steps: 400_000,
            repeats: 5,
        },
    }
}

fn crossover_effort(effort: Size) -> crossover::Effort {
    match effort {
        Size::Quick => crossover::Effort {
            precisions: vec!["f64"],
            particles: vec![4000],
            packing_fractions: vec![0.84, 0.3, 0.1],
            steps: 60,
            repeats: 2,
        },
        Size::Full | Size::All => crossover::Effort {
            precisions: vec!["f64", "mixed", "f32"],
            particles: vec![10_000, 100_000],
            packing_fractions: vec![0.84, 0.8, 0.6, 0.3, 0.1, 0.03],
            steps: 40,
            repeats: 2,
        },
    }
}

fn threads_effort(effort: Size) -> threads::Effort {
    match effort {
        Size::Quick => threads::Effort {
            particles: vec![20_000],
            packing_fractions: vec![0.84],
            rounds: 3,
            particle_steps: 1_000_000,
        },
        Size::Full | Size::All => threads::Effort {
            particles: vec![10_000, 100_000, 300_000],
            packing_fractions: vec![0.84, 0.3],
            rounds: 5,
            particle_steps: 4_000_000,
        },
    }
}

/// Runs of a scene with overrides and a control without waves, side by side; the first keeps its frames if snapshots are shown.
fn pipes(
    showing: Showing,
    (scene, overrides): (&'static str, Overrides),
    seeds: &[u64],
    progress: Progress<'_>,
) -> Result<Made, Failure> {
    let of = |overrides: &Overrides, seed: u64, keep_frames: bool| pipe_flow::Question {
        scene,
        overrides: overrides.clone(),
        seed,
        keep_frames,
    };
    let control = pipe_flow::elastic(&overrides).set(&STEPS, CONTROL);
    let mut questions: Vec<_> =
        seeds.iter().map(|&seed| of(&overrides, seed, seed == seeds[0] && showing.snapshots > 0)).collect();
    questions.push(of(&control, seeds[0], false));
    let meter = Meter::new(questions.len() as f64, progress);
    let flows = questions.par_iter().map(|question| {
        let mut before = 0.0;
        pipe_flow::pipe_flow(question, |share| meter.add(share - std::mem::replace(&mut before, share)))
    });
    let mut flows: Vec<pipe_flow::PipeFlow> = flows.collect::<Result<_, _>>()?;
    let control = flows.pop().into_iter().collect::<Vec<_>>();
    let section = sections::pipe_flow::section(showing, &flows, &control[0]);
    made(section, &serde_json::json!({ "runs": flows, "control": control[0] }))
}

/// Steps of the control: 2 s.
const CONTROL: u64 = 40_000;

/// The source's own text first, as a reader wants it; then ours.
fn listings() -> Result<Made, Failure> {
    let ours = Question::default();
    let printed = Question { choice: ours.choice.printed(), ..ours.clone() };
    let mut parts = vec![];
    for (name, question) in [("printed_", &printed), ("", &ours)] {
        for &part in Part::ALL {
            let listings = listing::listings(part, question)?;
            let (text, instructions) = (listing::text(&listings), listing::instructions(&listings));
            if instructions > 0 {
                let part = format!("{name}{}", part.name());
                parts.push(sections::listing::PartListing { part, text, instructions });
            }
        }
    }
    let mut made = made(sections::listing::section(&parts), &())?;
    made.files = parts.into_iter().map(|part| (format!("{}.txt", part.part), part.text)).collect();
    Ok(made)
}
