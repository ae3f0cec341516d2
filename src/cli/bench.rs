//! `stripmine bench`: one throughput measurement of moving particles.

use super::{Common, Failure, print, print_json};
use crate::scene::{Document, SceneErrors};
use crate::study::throughput::{Measurement, MeasurementError, Throughput, throughput};
use clap::{Args, ValueEnum};

/// One throughput measurement of moving particles
#[derive(Args)]
pub(super) struct BenchVerb {
    /// What to measure
    #[arg(value_enum)]
    what: What,
    /// Number of particles, at least
    #[arg(long, default_value_t = 10_000)]
    particles: usize,
    /// Area of the discs over that of the box
    #[arg(long, default_value_t = 0.84, allow_negative_numbers = true)]
    packing_fraction: f64,
    /// Precision of state and forces
    #[arg(long, default_value = "f64", value_parser = ["f64", "f32", "mixed"])]
    precision: String,
    /// Integrator
    #[arg(long, default_value = "gear5", value_parser = ["gear4", "gear5", "gear6", "velocity-verlet"])]
    integrator: String,
    /// eager, strip:N, chained or fast
    #[arg(long, default_value = "fast")]
    execution: String,
    /// Leave out friction, and with it rotation
    #[arg(long)]
    frictionless: bool,
    /// Side of a lattice cell; the largest that the geometry allows by default
    #[arg(long, allow_negative_numbers = true)]
    cell_edge: Option<f64>,
    /// Steps of each repeat; about a second's worth by default
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    steps: Option<u64>,
    /// Repeats
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    repeats: u16,
    /// scalar, avx2, avx512, wide, or auto for the widest there is
    #[arg(long, default_value = "auto", value_parser = ["scalar", "avx2", "avx512", "wide", "auto"])]
    instruction_set: String,
}

/// What can be measured so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum What {
    /// BP93's lattice method
    Lattice,
    /// Neighbour lists: the source's rival of it
    NeighborList,
    /// Sectors that hold any number of discs
    Sectors,
}

impl BenchVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let method = match self.what {
            What::Lattice => "lattice",
            What::NeighborList => "neighbor-list",
            What::Sectors => "sectors",
        };
        // What the scene is told, and the option that says so.
        let mut told = vec![
            (format!("particles.count={}", self.particles), format!("--particles {}", self.particles)),
            (
                format!("particles.packing_fraction={}", self.packing_fraction),
                format!("--packing-fraction {}", self.packing_fraction),
            ),
            (format!("method.kind=\"{method}\""), method.to_owned()),
            (format!("method.precision=\"{}\"", self.precision), format!("--precision {}", self.precision)),
        ];
        let integrator = match self.integrator.strip_prefix("gear") {
            Some(values) => format!("integrator.values={values}"),
            None => format!("integrator.kind=\"{}\"", self.integrator),
        };
        told.push((integrator, format!("--integrator {}", self.integrator)));
        told.push((
            format!("method.execution=\"{}\"", self.execution),
            format!("--execution {}", self.execution),
        ));
        if self.instruction_set != "auto" {
            told.push((
                format!("method.instruction_set=\"{}\"", self.instruction_set),
                format!("--instruction-set {}", self.instruction_set),
            ));
        }
        if self.frictionless {
            told.push(("law.friction=0".to_owned(), "--frictionless".to_owned()));
        }
        told.extend(
            self.cell_edge.map(|edge| (format!("method.cell_edge={edge}"), format!("--cell-edge {edge}"))),
        );
        let overrides: Vec<String> = told.iter().map(|(told, _)| told.clone()).collect();
        // About 10⁷ particle-steps a second, to the order of magnitude.
        let steps =
            self.steps.unwrap_or_else(|| (10_000_000 / self.particles.max(1) as u64).clamp(20, 20_000));
        let measurement = Measurement {
            document: Document::load("bench", &overrides)
                .map_err(|mistakes| Failure::Options(in_options(mistakes, &told)))?,
            equilibration: 200.max(steps / 10),
            steps,
            repeats: self.repeats.into(),
        };
        let result = throughput(measurement).map_err(|error| match error {
            MeasurementError::Scene(mistakes) => Failure::Options(in_options(mistakes, &told)),
            error => error.into(),
        })?;
        if common.json { print_json(&result) } else { print(&text(&result)) }
    }
}

/// Mistakes of the scene as those of the options that it was made of.
fn in_options(SceneErrors(mut mistakes): SceneErrors, told: &[(String, String)]) -> SceneErrors {
    for mistake in &mut mistakes {
        let option = told.iter().find(|(told, _)| mistake.file == format!("--set {told}"));
        if let Some((_, option)) = option {
            mistake.file.clone_from(option);
        }
    }
    SceneErrors(mistakes)
}

fn text(result: &Throughput) -> String {
    let Throughput { what, particles, packing_fraction, precision, integrator, execution, .. } = result;
    let each = |seconds: f64| 1e9 * seconds / (*particles as f64 * result.steps as f64);
    let phases: Vec<String> =
        result.phases.iter().map(|(phase, &seconds)| format!("{phase} {:.1}", each(seconds))).collect();
    format!(
        "{what}: {particles} discs at packing fraction {packing_fraction:.2}, {precision}, {integrator}, {execution} on {}, \
         {} threads\n{:.2} million particle-steps a second (median {:.2}) over {} repeats of {} steps\nnanoseconds a \
         particle and step: {:.1} in all; {}\ntemperature {:.5} to {:.5}, {} contacts, checksum {}\n",
        result.instruction_set,
        result.threads,
        result.particle_steps_per_second * 1e-6,
        result.particle_steps_per_second_median * 1e-6,
        result.repeats,
        result.steps,
        each(result.seconds),
        phases.join(", "),
        result.temperature[0],
        result.temperature[1],
        result.contacts,
        result.checksum
    )
}
