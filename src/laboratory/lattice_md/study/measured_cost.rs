//! What does a step take on this host, over the number of particles and their density?

use serde::Serialize;
use std::f64::consts::PI;
use stripmine_kernels::InstructionSet;
use stripmine_physics::method::lattice_md::Document;
use stripmine_physics::method::lattice_md::keys::{
    CELL_EDGE, COHESIONLESS, EXECUTION, REBUILD, SEARCH, TEXT,
};
use stripmine_physics::method::throughput::{Measurement, MeasurementError, Throughput, throughput};
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// Method and execution that the bench scene is run with.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Variant {
    /// Its name in a legend.
    pub name: &'static str,
    /// Whose programs: `machine.text`.
    pub text: &'static str,
    /// `search.by`.
    pub kind: &'static str,
    /// `machine.execution`, for the lattice.
    pub execution: Option<&'static str>,
    /// How lists are rebuilt, for the lists.
    pub rebuild: Option<&'static str>,
}

/// The variants that are compared.
pub const VARIANTS: [Variant; 5] = [
    Variant {
        name: "printed, eager (the CRAY's way)",
        text: "printed",
        kind: "lattice",
        execution: Some("eager"),
        rebuild: None,
    },
    Variant {
        name: "printed, strips of 256",
        text: "printed",
        kind: "lattice",
        execution: Some("strip:256"),
        rebuild: None,
    },
    Variant {
        name: "ours, chained",
        text: "ours",
        kind: "lattice",
        execution: Some("chained"),
        rebuild: None,
    },
    Variant {
        name: "printed law, scalar lists of all pairs",
        text: "printed",
        kind: "neighbor-list",
        execution: None,
        rebuild: Some("all-pairs"),
    },
    Variant {
        name: "ours, scalar lists by cells",
        text: "ours",
        kind: "neighbor-list",
        execution: None,
        rebuild: Some("cells"),
    },
];

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// NP at occupancy [`OCCUPANCY`].
    pub particles: Vec<usize>,
    /// ρ at [`PARTICLES`].
    pub occupancies: Vec<f64>,
    /// Steps before the clock starts, at most.
    pub equilibration: u64,
    /// Elements times steps of a repeat: cells on the lattice, particles with lists.
    pub element_steps: usize,
    /// Repeats.
    pub repeats: usize,
}

impl Effort {
    /// As much as a chart needs: under half a minute.
    pub fn chart() -> Effort {
        Effort {
            particles: vec![100, 300, 1000, 3000],
            occupancies: vec![0.03, 0.1, 0.2, 0.25],
            equilibration: 50,
            element_steps: 300_000,
            repeats: 3,
        }
    }
}

/// ρ of the measurements over NP, on cells as wide as the radius.
pub const OCCUPANCY: f64 = 0.2;
/// NP of the measurements over ρ.
pub const PARTICLES: usize = 1000;

/// A measurement.
#[derive(Clone, Debug, Serialize)]
pub struct Sample {
    /// Index into [`VARIANTS`].
    pub variant: usize,
    /// NP.
    pub particles: usize,
    /// ρ on cells as wide as the radius.
    pub occupancy: f64,
    /// Seconds a step, the median repeat: a single repeat may meet a making of lists or not.
    pub seconds: f64,
    /// Processor seconds a step of the best repeat.
    pub best: f64,
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct MeasuredCost {
    /// Instructions.
    pub instruction_set: &'static str,
    /// The variants.
    pub variants: [Variant; VARIANTS.len()],
    /// Over NP at [`OCCUPANCY`].
    pub over_particles: Vec<Sample>,
    /// Over ρ with [`PARTICLES`].
    pub over_density: Vec<Sample>,
}

/// Measures, on one thread. `progress` gets the share that is done.
///
/// # Errors
/// [`MeasurementError`] if the scene breaks.
pub fn measured_cost(
    effort: &Effort,
    progress: impl Fn(f64) + Sync,
) -> Result<MeasuredCost, MeasurementError> {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
    let cases: Vec<(usize, f64)> = effort
        .particles
        .iter()
        .map(|&particles| (particles, OCCUPANCY))
        .chain(effort.occupancies.iter().map(|&occupancy| (PARTICLES, occupancy)))
        .collect();
    let mut samples = Vec::new();
    for (done, &(particles, occupancy)) in cases.iter().enumerate() {
        // The variants of a case one after the other, so that a disturbance affects them alike.
        for variant in 0..VARIANTS.len() {
            samples.push(alone.install(|| sample(variant, particles, occupancy, effort))?);
            progress((done * VARIANTS.len() + variant + 1) as f64 / (cases.len() * VARIANTS.len()) as f64);
        }
    }
    let over_density = samples.split_off(effort.particles.len() * VARIANTS.len());
    Ok(MeasuredCost {
        instruction_set: InstructionSet::best().name(),
        variants: VARIANTS,
        over_particles: samples,
        over_density,
    })
}

fn sample(
    variant: usize,
    particles: usize,
    occupancy: f64,
    effort: &Effort,
) -> Result<Sample, MeasurementError> {
    let Variant { text, kind, execution, rebuild, .. } = VARIANTS[variant];
    let scene = Overrides::new().set(&COUNT, particles).set(&PACKING_FRACTION, PI * occupancy);
    // The source has no clamp.
    let scene = scene.set(&SEARCH, kind).set(&TEXT, text).set(&COHESIONLESS, false);
    let scene = scene.set(&EXECUTION, execution.unwrap_or("chained"));
    let overrides = match rebuild {
        Some(rebuild) => scene.set(&REBUILD, rebuild),
        // As the source has it; the largest cell that the geometry allows would need fewer.
        None => scene.set(&CELL_EDGE, 0.5),
    };
    let elements = if kind == "lattice" { (particles as f64 / occupancy) as usize } else { particles };
    let steps = (effort.element_steps / elements).clamp(4, 2000) as u64;
    let document = Document::load("bench", &overrides)?;
    let Throughput { cpu_seconds, particles, median_rate, .. } = throughput(
        Measurement {
            bench: document.bench(),
            prepared: document.prepare()?,
            equilibration: steps.min(effort.equilibration),
            steps,
            repeats: effort.repeats,
        },
        |_| (),
    )?;
    Ok(Sample {
        variant,
        particles,
        occupancy,
        seconds: particles as f64 / median_rate,
        best: cpu_seconds / steps as f64,
    })
}
