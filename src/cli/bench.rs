//! `stripmine bench`: one throughput measurement of moving particles.

use crate::console::{Common, Failure, clear_progress, count, print, print_json, progress};
use crate::report::terminal;
use clap::Args;
use serde_json::Value;
use stripmine_physics::method::throughput::{Measurement, MeasurementError, Throughput, throughput};
use stripmine_physics::method::{Bench, Entry, Methods};
use stripmine_physics::number::counted;
use stripmine_physics::scene::{SceneErrors, Values};

/// One throughput measurement of moving particles
#[derive(Args)]
pub(super) struct BenchVerb {
    /// What to measure
    what: String,
    /// Number of particles, at least
    #[arg(long, value_parser = count)]
    particles: Option<u64>,
    /// Area of the discs over that of the box
    #[arg(long, allow_negative_numbers = true)]
    packing_fraction: Option<f64>,
    /// Precision of state and forces
    #[arg(long, value_parser = ["f64", "f32", "mixed"])]
    precision: Option<String>,
    /// Integrator, such as gear4, gear5, gear6, velocity-verlet, baoab or stochastic
    #[arg(long)]
    integrator: Option<String>,
    /// What moves the particles: auto, fast, or programs of lattice MD, reference of hard discs; the fastest by default
    #[arg(long)]
    engine: Option<String>,
    /// Whose programs: ours, or printed for the source's own; implies programs
    #[arg(long)]
    text: Option<String>,
    /// How programs are executed: eager, strip:N or chained; implies programs
    #[arg(long)]
    execution: Option<String>,
    /// Leave out friction, and with it rotation
    #[arg(long)]
    frictionless: bool,
    /// Side of a lattice cell; the largest that the geometry allows by default
    #[arg(long, allow_negative_numbers = true)]
    cell_edge: Option<f64>,
    /// Mask of cells around a disc, such as min or r3; the cheapest by default
    #[arg(long)]
    mask: Option<String>,
    /// How products and roots of bodies are formed: exact, estimated or raw
    #[arg(long)]
    arithmetic: Option<String>,
    /// Pair law of particles in a bath: none, wca or lennard-jones
    #[arg(long)]
    law: Option<String>,
    /// How pairs of particles in a bath are found: auto, lattice, sectors or neighbor-list
    #[arg(long)]
    search: Option<String>,
    /// Sectors along each side
    #[arg(long)]
    sectors: Option<u64>,
    /// When particles in a bath are put in the order of their sectors: auto, when-needed or every-step
    #[arg(long)]
    sort: Option<String>,
    /// How much farther than the cut-off listed pairs may be
    #[arg(long, allow_negative_numbers = true)]
    skin: Option<f64>,
    /// Steps, or collisions, of each repeat; about a second's worth by default
    #[arg(long, visible_alias = "collisions", value_parser = count)]
    steps: Option<u64>,
    /// Repeats
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    repeats: u16,
    /// scalar, avx2, avx512, wide, or auto for the widest there is
    #[arg(long, value_parser = ["scalar", "avx2", "avx512", "wide", "auto"])]
    instruction_set: Option<String>,
}

/// An override, and the option that it stands for.
struct Override {
    text: String,
    option: String,
}

impl BenchVerb {
    /// The options given, by name, with their values; those without a value are there or not.
    fn given(&self) -> Vec<(&'static str, Option<String>)> {
        vec![
            ("particles", self.particles.map(|count| count.to_string())),
            ("packing-fraction", self.packing_fraction.map(|fraction| fraction.to_string())),
            ("precision", self.precision.clone()),
            ("integrator", self.integrator.clone()),
            ("engine", self.engine.clone()),
            ("text", self.text.clone()),
            ("execution", self.execution.clone()),
            ("instruction-set", self.instruction_set.clone()),
            ("frictionless", self.frictionless.then(String::new)),
            ("mask", self.mask.clone()),
            ("arithmetic", self.arithmetic.clone()),
            ("law", self.law.clone()),
            ("search", self.search.clone()),
            ("sectors", self.sectors.map(|count| count.to_string())),
            ("sort", self.sort.clone()),
            ("skin", self.skin.map(|skin| skin.to_string())),
            ("cell-edge", self.cell_edge.map(|edge| edge.to_string())),
        ]
    }

    /// What the options say in a scene, defaults included.
    fn overrides(&self, bench: &Bench) -> Result<Vec<Override>, Failure> {
        let mut all: Vec<Override> = bench
            .overrides
            .iter()
            .map(|text| Override { text: (*text).to_owned(), option: bench.name.to_owned() })
            .collect();
        for (name, given) in self.given() {
            let default = bench.defaults.iter().find(|(known, _)| *known == name);
            let Some(value) = given.or_else(|| default.map(|(_, value)| (*value).to_owned())) else {
                continue;
            };
            let Some(known) = bench.options.iter().find(|known| known.name == name) else {
                return Err(Failure::NoSuchOption { bench: bench.name, option: name });
            };
            if !known.values.is_empty() && !known.values.contains(&value.as_str()) {
                return Err(Failure::NoSuchValue { option: name, value, values: known.values });
            }
            let option = format!("--{name} {value}").trim_end().to_owned();
            let overrides = (known.overrides)(&value).into_iter();
            all.extend(overrides.map(|text| Override { text, option: option.clone() }));
        }
        Ok(all)
    }

    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        let benches = methods.iter().flat_map(|&entry| entry.benches.iter().map(move |it| (entry, it)));
        let found = benches.into_iter().find(|(_, bench)| bench.name == self.what);
        let Some((entry, bench)) = found else {
            return Err(Failure::NoSuchOption { bench: "bench", option: "what" });
        };
        let given = self.overrides(bench)?;
        let bar = progress(common, "bench");
        let show = |share: f64| bar.set_position((1e3 * share) as u64);
        let result = self.measured(entry, bench, &given, show);
        clear_progress();
        let result = result.map_err(|error| match error {
            MeasurementError::Scene(mistakes) => Failure::Options(in_options(mistakes, &given)),
            error => error.into(),
        })?;
        if common.json { print_json(&result) } else { print(&(terminal::fitted(&text(&result)) + "\n")) }
    }

    fn measured(
        &self,
        entry: &'static Entry,
        bench: &'static Bench,
        given: &[Override],
        show: impl Fn(f64),
    ) -> Result<Throughput, MeasurementError> {
        let overrides: Vec<String> = given.iter().map(|given| given.text.clone()).collect();
        let values = Values::load(bench.preset, &overrides, &[entry.vocabulary])?;
        let prepared = (entry.prepare)(values)?;
        let steps = self.steps.unwrap_or_else(|| (bench.amount)(prepared.particles().grain_count() as u64));
        let repeats = self.repeats.into();
        let measurement = Measurement { bench, prepared, equilibration: 200.max(steps / 10), steps, repeats };
        throughput(measurement, show)
    }
}

/// Mistakes of the scene as those of the options that it was made of.
fn in_options(SceneErrors(mut mistakes): SceneErrors, given: &[Override]) -> SceneErrors {
    for mistake in &mut mistakes {
        let option = given.iter().find(|given| mistake.file == format!("--set {}", given.text));
        if let Some(given) = option {
            mistake.file.clone_from(&given.option);
        }
    }
    SceneErrors(mistakes)
}

/// A setting as a person reads it: numbers to four digits.
fn brief(value: &Value) -> String {
    match value {
        Value::Number(number) if number.is_f64() => format!("{:.4}", number.as_f64().unwrap_or(f64::NAN)),
        Value::String(word) => word.clone(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.to_owned(),
        Value::Null => "none".to_owned(),
        Value::Array(items) => items.iter().map(brief).collect::<Vec<_>>().join(" × "),
        other => other.to_string(),
    }
}

fn text(result: &Throughput) -> String {
    let Throughput { what, particles, settings, .. } = result;
    let each = |seconds: f64| 1e9 * seconds / (*particles as f64 * result.steps as f64);
    let phases: Vec<String> = result
        .phases
        .iter()
        .map(|(phase, &seconds)| format!("{} {:.1}", phase.replace('_', " "), each(seconds)))
        .collect();
    let settings: Vec<String> =
        settings.iter().map(|(name, value)| format!("{} {}", name.replace('_', " "), brief(value))).collect();
    let compared = result.compared.iter().map(|(name, [from, to])| format!("{name} {from:.5} to {to:.5}"));
    let at_end = result.at_end.iter().map(|(name, value)| format!("{name} {value}"));
    let observed: Vec<String> = compared.chain(at_end).collect();
    format!(
        "{what}: {}, {}, {}\n{:.2} million {} a second (median {:.2}) over {} of {}\n\
         nanoseconds a particle and step: {:.1} in all; {}\n{}\nchecksum {}\n",
        counted(particles, "particle", "particles"),
        settings.join(", "),
        counted(result.threads, "thread", "threads"),
        result.rate * 1e-6,
        result.rate_name.trim_end_matches("_per_second").replace('_', "-"),
        result.median_rate * 1e-6,
        counted(result.repeats, "repeat", "repeats"),
        counted(result.steps, "step", "steps"),
        each(result.seconds),
        phases.join(", "),
        observed.join(", "),
        result.checksum
    )
}
