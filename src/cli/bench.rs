//! `stripmine bench`: measures how many particle steps or events a second a configuration makes.

use super::display::decimals;
use super::processes;
use super::run::{MOST_RANKS, check_total_threads};
use crate::console::{
    CommandFailure, Common, clear_progress, count, print, print_json, print_text, progress,
};
use crate::provenance::built;
use crate::report::{FormattedTable, FrameBuilder, TableCell, terminal};
use crate::study::scaling::{self, Scaling, ThreadResult, scaling};
use clap::{Arg, ArgAction, ArgMatches, Args, value_parser};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use stripmine_physics::method::throughput::{MeasurementError, Throughput, ThroughputRequest, throughput};
use stripmine_physics::method::{Bench, BenchOption, MethodEntry, Methods, StartPurpose};
use stripmine_physics::number::{count_with_noun, significant};
use stripmine_physics::ranks::{self, RankBackend};
use stripmine_physics::scene::{MistakeKind, SceneErrors, SceneValues};

/// Measures throughput: particle steps, or events, a second
#[derive(Args)]
pub(super) struct BenchVerb {
    /// Benchmark
    what: String,
    /// Steps, or collisions, per repeat; default: about one second of work
    #[arg(long, visible_alias = "collisions", value_parser = count)]
    steps: Option<u64>,
    /// Ranks that share the particles, each with --threads threads; a list such as 1,2 is measured in turn
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_RANKS)))]
    ranks: Vec<u16>,
    /// Number of repeats
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    repeats: u16,
}

/// Kind of value that follows an option.
#[derive(Clone, Copy)]
enum OptionKind {
    Nothing,
    /// Whole number, 1 or more.
    Count,
    Number,
    Word,
}

macro_rules! options {
    ($($takes:ident $name:literal $help:literal;)*) => { &[$(($name, OptionKind::$takes, $help)),*] };
}

/// Options of all benchmarks: kind of value, name and help.
const OPTIONS: &[(&str, OptionKind, &str)] = options! {
    Count "particles" "Least number of particles";
    Number "packing-fraction" "Area of the discs over area of the box";
    Word "precision" "Precision of state and forces: f64, f32 or mixed";
    Word "integrator" "Integrator, such as gear4, gear5, gear6, velocity-verlet, baoab or stochastic";
    Word "engine" "Engine: auto, fast, programs (lattice MD) or reference (hard discs); default: the fastest";
    Word "text" "Vector programs: ours, or printed (as in the paper); implies --engine programs";
    Word "execution" "Execution of the programs: eager, strip:N or chained; implies --engine programs";
    Word "instruction-set" "Instruction set: scalar, avx2, avx512, wide, or auto for the widest available";
    Nothing "frictionless" "Without friction and rotation";
    Number "cell-edge" "Side of a lattice cell; default: the largest that the geometry allows";
    Word "mask" "Mask of cells around a disc, such as min or r3; default: the cheapest";
    Word "law" "Pair law of Langevin particles (law.kind)";
    Word "search" "Pair search of Langevin particles: auto, lattice, sectors or neighbor-list";
    Count "sectors" "Sectors along each side";
    Word "sort" "When Langevin particles are sorted by sector: auto, when-needed or every-step";
    Number "skin" "Distance beyond the cut-off up to which pairs are listed";
    Word "arithmetic" "Arithmetic of gravity: exact, estimated or raw inverse roots";
};

/// Kind of value and help of an option; a word for options of methods unknown to this program.
fn kind_and_help(option: &BenchOption) -> (OptionKind, &'static str) {
    let known = OPTIONS.iter().find(|(name, ..)| *name == option.name);
    known.map_or((OptionKind::Word, "A value of the scene"), |&(_, takes, help)| (takes, help))
}

/// Options of all benchmarks, each once.
fn options(methods: Methods) -> impl Iterator<Item = &'static BenchOption> {
    let all = methods.iter().flat_map(|method| method.benches).flat_map(|bench| bench.options);
    let mut seen = BTreeSet::new();
    all.filter(move |option| seen.insert(option.name))
}

/// Options of all benchmarks as clap arguments.
pub(super) fn arguments(methods: Methods) -> impl Iterator<Item = Arg> {
    options(methods).map(|option| {
        let value = option.name.to_uppercase().replace('-', "_");
        let (takes, help) = kind_and_help(option);
        let argument = Arg::new(option.name).long(option.name).value_name(value).help(help);
        match takes {
            OptionKind::Nothing => argument.action(ArgAction::SetTrue),
            OptionKind::Count => argument.value_parser(count),
            OptionKind::Number => argument.value_parser(value_parser!(f64)).allow_negative_numbers(true),
            OptionKind::Word => argument,
        }
    })
}

/// Value of an option as text, if it was given.
fn value_of(option: &BenchOption, given: &ArgMatches) -> Option<String> {
    match kind_and_help(option).0 {
        OptionKind::Nothing => given.get_flag(option.name).then(String::new),
        OptionKind::Count => given.get_one::<u64>(option.name).map(u64::to_string),
        OptionKind::Number => given.get_one::<f64>(option.name).map(f64::to_string),
        OptionKind::Word => given.get_one::<String>(option.name).cloned(),
    }
}

/// Override of the scene, with the option that caused it.
struct OptionOverride {
    text: String,
    option: String,
}

impl BenchVerb {
    /// Overrides of the scene from the options, defaults included.
    fn overrides(
        &self,
        bench: &Bench,
        given: &ArgMatches,
        methods: Methods,
    ) -> Result<Vec<OptionOverride>, CommandFailure> {
        let mut all: Vec<OptionOverride> = bench
            .overrides
            .iter()
            .map(|text| OptionOverride { text: (*text).to_owned(), option: bench.name.to_owned() })
            .collect();
        let has = |name: &str| bench.options.iter().any(|known| known.name == name);
        if let Some(foreign) = options(methods).find(|it| !has(it.name) && value_of(it, given).is_some()) {
            return Err(CommandFailure::NoSuchOption { bench: bench.name, option: foreign.name });
        }
        for known in bench.options {
            let default = bench.defaults.iter().find(|(name, _)| *name == known.name);
            let default = default.map(|(_, value)| (*value).to_owned());
            let Some(value) = value_of(known, given).or(default) else { continue };
            if !known.values.is_empty() && !known.values.contains(&value.as_str()) {
                return Err(CommandFailure::NoSuchValue { option: known.name, value, values: known.values });
            }
            let option = format!("--{} {value}", known.name).trim_end().to_owned();
            let overrides = (known.overrides)(&value).into_iter();
            all.extend(overrides.map(|text| OptionOverride { text, option: option.clone() }));
        }
        Ok(all)
    }

    pub(super) fn run(
        &self,
        matches: &ArgMatches,
        common: &Common,
        methods: Methods,
    ) -> Result<(), CommandFailure> {
        let benches = methods.iter().flat_map(|&entry| entry.benches.iter().map(move |it| (entry, it)));
        let found = benches.into_iter().find(|(_, bench)| bench.name == self.what);
        let Some((entry, bench)) = found else {
            return Err(CommandFailure::NoSuchOption { bench: "bench", option: "what" });
        };
        let given = self.overrides(bench, matches, methods)?;
        let is_of_several = common.threads.len() > 1 || self.ranks.len() > 1;
        let threads =
            common.threads.iter().copied().max().map_or_else(rayon::current_num_threads, usize::from);
        check_total_threads(self.ranks.iter().copied().max().unwrap_or(1), threads)?;
        if is_of_several {
            return self.measure_scaling(entry, bench, &given, common);
        }
        let RankBackend::Processes(join) = common.crew else {
            let ranks = self.ranks.first().copied().map_or(1, usize::from);
            return self.measure_once((entry, bench, &given), RankBackend::Threads(ranks), common);
        };
        if !self.ranks.is_empty() {
            return Err(processes::duplicate_ranks_failure());
        }
        let measurement =
            self.measurement(entry, bench, &given).map_err(|error| measurement_failure(error, &given))?;
        measurement.prepared.memory.clone().for_crew(common.crew).fits(bench.name)?;
        let same = format!("bench\n{:?}\n{}", built(), measurement.prepared.scene);
        processes::run_jointly(join, &same, |is_first| match is_first {
            true => self.measure_once((entry, bench, &given), common.crew, common),
            false => {
                processes::serve(common.crew, || {
                    measurement.prepared.start(StartPurpose::Measurement).map(drop)
                });
                Ok(())
            }
        })
    }

    /// Measures on one crew of ranks.
    fn measure_once(
        &self,
        (entry, bench, given): (&'static MethodEntry, &'static Bench, &[OptionOverride]),
        crew: RankBackend,
        common: &Common,
    ) -> Result<(), CommandFailure> {
        let bar = progress(common, "bench");
        let show = |share: f64| bar.set_position((1e3 * share) as u64);
        let result = ranks::with_backend(crew, || throughput(self.measurement(entry, bench, given)?, show));
        clear_progress();
        let result = result.map_err(|error| measurement_failure(error, given))?;
        if common.json { print_json(&result) } else { print_text(&throughput_text(&result)) }
    }

    fn measurement(
        &self,
        entry: &'static MethodEntry,
        bench: &'static Bench,
        given: &[OptionOverride],
    ) -> Result<ThroughputRequest, MeasurementError> {
        let overrides: Vec<String> = given.iter().map(|given| given.text.clone()).collect();
        let values = SceneValues::load(bench.preset, &overrides, &[entry.vocabulary])?;
        let prepared = (entry.prepare)(values)?;
        let steps = self.steps.unwrap_or_else(|| (bench.amount)(prepared.particles().grain_count() as u64));
        let repeats = self.repeats.into();
        Ok(ThroughputRequest { bench, prepared, steps, repeats })
    }

    /// Measures on several numbers of ranks and threads in turn.
    fn measure_scaling(
        &self,
        entry: &'static MethodEntry,
        bench: &'static Bench,
        given: &[OptionOverride],
        common: &Common,
    ) -> Result<(), CommandFailure> {
        let or_one = |given: &[u16], default: usize| -> Vec<usize> {
            let given = given.iter().copied().map(usize::from);
            if given.len() == 0 { vec![default] } else { given.collect() }
        };
        let threads = or_one(&common.threads, 1);
        let of_ranks =
            |ranks: usize| threads.iter().map(move |&threads| scaling::ThreadLayout { ranks, threads });
        let crews: Vec<scaling::ThreadLayout> =
            or_one(&self.ranks, 1).into_iter().flat_map(of_ranks).collect();
        let bar = progress(common, "bench");
        let show = |share: f64| bar.set_position((1e3 * share) as u64);
        let found = scaling(&|| self.measurement(entry, bench, given), &crews, show);
        clear_progress();
        let found = found.map_err(|error| measurement_failure(error, given))?;
        if common.json {
            return print_json(&scaling_json(&found));
        }
        print(&[threads_table(&found), phases_table(&found)].map(|table| terminal::render(&table)).join("\n"))
    }
}

/// JSON of a measurement on several numbers of ranks and threads.
fn scaling_json(found: &Scaling) -> Value {
    let Scaling { what, particles, steps, repeats, settings, same_bits, by_threads, phases } = found;
    let of_threads = |it: &ThreadResult| {
        let scaling::ThreadLayout { ranks, threads } = it.crew;
        json!({ "ranks": ranks, "threads": threads, "rate": it.rate, "gain": it.gain })
    };
    let of_phase = |it: &scaling::Phase| {
        let (name, nanoseconds, is_beside, serial) = (&it.name, &it.nanoseconds, it.is_beside, it.serial);
        json!({ "name": name, "nanoseconds": nanoseconds, "is_beside": is_beside, "serial": serial })
    };
    json!({
        "what": what,
        "particles": particles,
        "steps": steps,
        "repeats": repeats,
        "settings": settings,
        "same_bits": same_bits,
        "by_threads": by_threads.iter().map(of_threads).collect::<Vec<_>>(),
        "phases": phases.iter().map(of_phase).collect::<Vec<_>>(),
    })
}

/// Numbers of threads for which Amdahl's law predicts the gain.
const FORESEEN: [usize; 2] = [8, 16];

/// Table of rate and gain for each number of threads.
fn threads_table(found: &Scaling) -> FormattedTable {
    let bits = if found.same_bits { "same bits on all" } else { "bits DIFFER" };
    let foreseen = FORESEEN.map(|threads| {
        let gain = found.predicted_speedup(threads).map_or("–".to_owned(), |gain| significant(gain, 3));
        format!("{gain} times on {threads} threads")
    });
    FrameBuilder::of(&found.by_threads)
        .count("ranks", |it| it.crew.ranks)
        .count("threads of each", |it| it.crew.threads)
        .cell("million a second, best", |it| rounded(1e-6 * it.rate[0], 4))
        .cell("median", |it| rounded(1e-6 * it.rate[1], 4))
        .number("gain", 2, |it| it.gain)
        .number("efficiency", 2, |it| it.gain * found.by_threads[0].crew.all() as f64 / it.crew.all() as f64)
        .table(
            "threads",
            format!(
                "{}: {}, {}, {} in turn; {bits}",
                found.what,
                count_with_noun(found.particles, "particle", "particles"),
                count_with_noun(found.steps, "step", "steps"),
                count_with_noun(found.repeats, "repeat", "repeats"),
            ),
        )
        .note(format!("Predicted by Amdahl's law alone: {}.", foreseen.join(", ")))
}

/// Number with some significant digits.
fn rounded(value: f64, digits: i32) -> TableCell {
    TableCell::Number(value, decimals(value, digits))
}

/// Table of the time of each phase, and of the part of it that does not scale.
fn phases_table(found: &Scaling) -> FormattedTable {
    let mut rows = FrameBuilder::of(&found.phases).text("phase", |it| it.name.clone());
    for (at, ThreadResult { crew: scaling::ThreadLayout { ranks, threads }, .. }) in
        found.by_threads.iter().enumerate()
    {
        rows = rows.cell(format!("ns, {ranks} × {threads}"), move |it| rounded(it.nanoseconds[at], 3));
    }
    rows.number("serial part (%)", 1, |it| it.serial.map(|part| 100.0 * part))
        .text("per", |it| if it.is_beside { "particle and call" } else { "particle and step" })
        .table("phases", "Time of each phase by ranks × threads, and its serial part")
        .note("Best repeats. A serial part below 0 means more gain than threads, from caches.".to_owned())
}

/// Advice for a value that needs a key of the scene.
const NO_KEY: &str = "a benchmark has a scene of its own, and no option for this key: set it in your scene, and `stripmine run SCENE` prints steps and wall time";

/// Failure of a measurement; mistakes of the scene are reported as mistakes of the options.
fn measurement_failure(error: MeasurementError, given: &[OptionOverride]) -> CommandFailure {
    match error {
        MeasurementError::Scene(mistakes) if mistakes.0.iter().all(|it| it.reason != MistakeKind::Memory) => {
            CommandFailure::Options(mistakes_of_options(mistakes, given))
        }
        error => error.into(),
    }
}

/// Replaces the location of each mistake by the option that caused it. A key that the scene of the benchmark lacks is missing because of an option of
/// the same section, and no option can give it.
fn mistakes_of_options(SceneErrors(mut mistakes): SceneErrors, given: &[OptionOverride]) -> SceneErrors {
    for mistake in &mut mistakes {
        let option = given.iter().find(|given| mistake.file == format!("--set {}", given.text));
        if let Some(given) = option {
            mistake.file.clone_from(&given.option);
        }
        let section = |text: &str| text.split_once('.').map(|(section, _)| section.to_owned());
        let lacking = mistake.message.strip_prefix('`').filter(|_| mistake.reason == MistakeKind::Missing);
        let option = lacking.and_then(|key| given.iter().find(|it| section(&it.text) == section(key)));
        if let Some(given) = option {
            mistake.file.clone_from(&given.option);
            mistake.place = None;
            mistake.suggestion = Some(NO_KEY.to_owned());
        }
    }
    SceneErrors(mistakes)
}

/// A setting for reading: numbers to five digits.
fn setting_text(value: &Value) -> String {
    match value {
        Value::Number(number) if number.is_f64() => significant(number.as_f64().unwrap_or(f64::NAN), 5),
        Value::String(word) => word.clone(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.to_owned(),
        Value::Null => "none".to_owned(),
        Value::Array(items) => items.iter().map(setting_text).collect::<Vec<_>>().join(" × "),
        other => other.to_string(),
    }
}

fn throughput_text(result: &Throughput) -> String {
    let Throughput { what, particles, settings, .. } = result;
    let each = |seconds: f64| 1e9 * seconds / (*particles as f64 * result.steps as f64);
    let phases: Vec<String> = result
        .phases
        .iter()
        .map(|(phase, &seconds)| format!("{} {}", phase.replace('_', " "), significant(each(seconds), 3)))
        .collect();
    let settings: Vec<String> = settings
        .iter()
        .map(|(name, value)| format!("{} {}", name.replace('_', " "), setting_text(value)))
        .collect();
    let compared = result
        .compared
        .iter()
        .map(|(name, [from, to])| format!("{name} {} to {}", significant(*from, 6), significant(*to, 6)));
    let at_end = result.at_end.iter().map(|(name, value)| format!("{name} {}", significant(*value, 6)));
    let observed: Vec<String> = compared.chain(at_end).collect();
    format!(
        "{what}: {}, {}, {}\n{} million {} a second (median {}) over {} of {}\n\
         nanoseconds per particle and step: {} in total; {}\n{}\nchecksum {}\n",
        count_with_noun(particles, "particle", "particles"),
        settings.join(", "),
        count_with_noun(result.threads, "thread", "threads"),
        significant(result.rate * 1e-6, 4),
        result.rate_name.trim_end_matches("_per_second").replace('_', "-"),
        significant(result.median_rate * 1e-6, 4),
        count_with_noun(result.repeats, "repeat", "repeats"),
        count_with_noun(result.steps, "step", "steps"),
        significant(each(result.seconds), 3),
        phases.join(", "),
        observed.join(", "),
        result.checksum
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::METHODS;

    #[test]
    fn every_bench_option_has_help() {
        let names: BTreeSet<&str> = options(METHODS).map(|option| option.name).collect();
        assert_eq!(names, OPTIONS.iter().map(|(name, ..)| *name).collect());
    }
}
