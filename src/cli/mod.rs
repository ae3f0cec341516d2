//! Command line, one file per verb. Verbs only combine library calls. Methods add verbs, benches, presets and report items.

mod average;
mod bench;
mod chart;
mod compare;
mod completions;
mod display;
mod emit;
mod explain;
mod man;
mod manual;
mod plot;
mod price;
mod processes;
mod reproduce;
mod run;
mod scan;
mod scene;
mod suggestion;

use crate::console::Verb;
use crate::console::{CommandFailure, Common, MOST_THREADS, clear_progress, print_answer, report_failure};
use crate::laboratory::laboratories;
use crate::laboratory::rates::{VERB, serve};
use crate::provenance::command_line;
use crate::results::Item;
use crate::study;
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};
use processes::ProcessSession;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stripmine_physics::method::{METHODS, Methods};
use stripmine_physics::quoted::quoted;
use stripmine_physics::ranks::RankBackend;
use stripmine_physics::signals;

/// Simulates 2D particle systems, plans runs for a target error, and counts every vector operation.
#[derive(Parser)]
#[command(name = "stripmine", version, arg_required_else_help = true)]
struct CommandLine {
    #[command(subcommand)]
    verb: GeneralVerb,
    #[command(flatten)]
    common: Common,
}

/// Verbs that do not belong to a method.
#[derive(Subcommand)]
enum GeneralVerb {
    Reproduce(reproduce::Reproduce),
    Scene(scene::SceneVerb),
    Run(run::RunVerb),
    Scan(scan::ScanVerb),
    Average(average::AverageVerb),
    Plot(plot::PlotVerb),
    Bench(Box<bench::BenchVerb>),
    Chart(chart::ChartVerb),
    Compare(compare::CompareVerb),
    Emit(emit::EmitVerb),
    Price(price::PriceVerb),
    Explain(Box<explain::ExplainVerb>),
    Completions(completions::Completions),
    Man(man::ManVerb),
    /// Measures the cases read from standard input, for a study of this program
    #[command(name = VERB, hide = true)]
    Measure,
}

/// Verbs of the given methods.
fn verbs_of(methods: Methods) -> impl Iterator<Item = &'static Verb> {
    laboratories(methods).flat_map(|laboratory| laboratory.verbs)
}

/// Studies of the given methods, shown below `chart`.
fn charts_of(methods: Methods) -> impl Iterator<Item = &'static Verb> {
    laboratories(methods).flat_map(|laboratory| laboratory.charts)
}

/// Items of `reproduce` in the order of the page: those of the methods, then those of shared studies.
fn items_of(methods: Methods) -> impl Iterator<Item = &'static Item> {
    laboratories(methods).flat_map(|laboratory| laboratory.items).chain(study::ITEMS)
}

/// Verb of a method as a clap command.
fn subcommand(verb: &Verb) -> clap::Command {
    (verb.command)(clap::Command::new(verb.name))
}

/// Help of the argument of `scene keys`.
fn key_help(methods: Methods) -> String {
    let names: Vec<&str> = methods.iter().map(|method| method.vocabulary.keys.method).collect();
    format!(
        "Method ({}), and words that a key has in its section, name or meaning; without a method, keys of all methods are searched; default: the first method",
        names.join(", ")
    )
}

/// The clap command with the verbs, benches, presets and items of the methods.
fn command(methods: Methods) -> clap::Command {
    let benches = methods.iter().flat_map(|method| method.benches);
    let benches: Vec<PossibleValue> =
        benches.map(|bench| PossibleValue::new(bench.name).help(bench.doc)).collect();
    let items: Vec<PossibleValue> =
        items_of(methods).map(|item| PossibleValue::new(item.name).help(item.title())).collect();
    let presets: Vec<&str> = scene::presets(methods).map(|preset| preset.name).collect();
    let general = CommandLine::command()
        .mut_subcommand("reproduce", |reproduce| {
            reproduce.mut_arg("only", |only| only.value_parser(PossibleValuesParser::new(items)))
        })
        .mut_subcommand("bench", |bench| {
            bench
                .mut_arg("what", |what| what.value_parser(PossibleValuesParser::new(benches)))
                .args(bench::arguments(methods))
        })
        .mut_subcommand("scene", |scene| {
            scene
                .mut_subcommand("show", |show| {
                    show.mut_arg("name", |name| name.value_parser(PossibleValuesParser::new(presets)))
                })
                .mut_subcommand("keys", |keys| keys.mut_arg("what", |what| what.help(key_help(methods))))
        });
    general
        .mut_subcommand("chart", |chart| chart.subcommands(charts_of(methods).map(subcommand)))
        .subcommands(verbs_of(methods).map(subcommand))
        .after_help(manual::examples(""))
        .after_long_help(manual::text(""))
        .mut_subcommands(|verb| {
            let text = manual::text(verb.get_name());
            verb.after_long_help(text)
        })
}

/// Folder of a run: `name`, or `name.run` if only that exists.
fn run_folder(name: &Path) -> PathBuf {
    let mut with_ending = name.to_owned().into_os_string();
    with_ending.push(".run");
    let with_ending = PathBuf::from(with_ending);
    if !name.exists() && with_ending.is_dir() { with_ending } else { name.to_owned() }
}

/// Runs the command; the first argument is its name.
pub fn run(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    run_with(arguments, METHODS)
}

/// Runs the command with a given list of methods.
pub fn run_with(arguments: impl Iterator<Item = OsString>, methods: Methods) -> ExitCode {
    let arguments: Vec<OsString> = arguments.collect();
    // Read before the arguments are parsed, since a parse error is printed as JSON too.
    let as_data = arguments.iter().any(|argument| argument == "--json");
    let last_words = move |end| {
        clear_progress();
        report_failure(&CommandFailure::Stopped(end), as_data);
    };
    let matches = parse_arguments(&arguments, methods);
    let verb = matches.as_ref().ok().and_then(Option::as_ref).and_then(ArgMatches::subcommand_name);
    let verb = verb.unwrap_or_default().to_owned();
    // Help and version join no other process. A process with wrong arguments joins the others to end them.
    let outcome = match matches.transpose().map(|matches| (ProcessSession::begin(&verb), matches)) {
        None => Ok(()),
        // The session outlives the verb.
        Some((Ok(session), matches)) => {
            let outcome = matches.and_then(|matches| {
                // The handler waits in its own thread, the first thing to fail when memory is short.
                let what = "the interrupt handler (a thread that takes some megabytes of memory)";
                signals::install(last_words).map_err(CommandFailure::writing(what))?;
                execute_verb(&matches, &command_line(&arguments), session.crew(), methods)
            });
            clear_progress();
            session.shared_outcome(outcome)
        }
        Some((Err(failure), Ok(_))) => Err(failure),
        Some((Err(_), Err(mistake))) => Err(mistake),
    };
    clear_progress();
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let code = failure.exit_code();
            // A failure of all processes is printed once.
            if code != 0 && processes::prints_errors(&verb) {
                report_failure(&failure, as_data);
            }
            ExitCode::from(code)
        }
    }
}

/// Rejects an invalid number of threads in `RAYON_NUM_THREADS`.
fn check_environment_threads() -> Result<(), CommandFailure> {
    let Some(given) = std::env::var_os("RAYON_NUM_THREADS").filter(|given| !given.is_empty()) else {
        return Ok(());
    };
    let given = given.to_string_lossy();
    // 0 means one thread per core.
    match given.parse::<u16>() {
        Ok(0..=MOST_THREADS) => Ok(()),
        _ => Err(CommandFailure::ThreadsOfEnvironment(quoted(&given))),
    }
}

/// Parses the arguments; returns none after printing help or the version.
fn parse_arguments(arguments: &[OsString], methods: Methods) -> Result<Option<ArgMatches>, CommandFailure> {
    let mut command = command(methods);
    match command.try_get_matches_from_mut(arguments) {
        Ok(matches) => Ok(Some(matches)),
        Err(mistake) if mistake.use_stderr() => {
            Err(CommandFailure::Arguments(suggestion::with_suggestion(mistake, arguments, &command, methods)))
        }
        Err(answer) => print_answer(&answer).map(|()| None),
    }
}

fn execute_verb(
    matches: &ArgMatches,
    command: &str,
    crew: RankBackend,
    methods: Methods,
) -> Result<(), CommandFailure> {
    let common = Common::from_arg_matches(matches).map_err(CommandFailure::Arguments)?;
    let rank = processes::rank(crew);
    let common = Common { command: command.to_owned(), crew, quiet: common.quiet || rank > 0, ..common };
    // Other verbs run on the first rank only.
    let verb = matches.subcommand_name().unwrap_or_default();
    if rank > 0 && !["run", "bench", "chart", "reproduce"].contains(&verb) {
        return Ok(());
    }
    // Without --threads the default pool has a thread for each core, or as many as the environment sets.
    let threads = common.threads.iter().copied().max().map_or(0, usize::from);
    if threads == 0 {
        check_environment_threads()?;
    }
    if let Some((verb, _)) =
        matches.subcommand().filter(|(verb, _)| *verb != "bench" && common.threads.len() > 1)
    {
        return Err(CommandFailure::SeveralThreads(verb.to_owned()));
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(CommandFailure::Threads)?;
    let named = |verb: &&Verb, name: &str| verb.name == name;
    let of_method = match matches.subcommand() {
        Some(("chart", below)) => below
            .subcommand()
            .and_then(|(name, matches)| Some((charts_of(methods).find(|verb| named(verb, name))?, matches))),
        Some((name, matches)) => verbs_of(methods).find(|verb| named(verb, name)).map(|verb| (verb, matches)),
        None => None,
    };
    match of_method {
        // Verbs of methods run in one process.
        Some(_) if rank > 0 => return Ok(()),
        Some((verb, matches)) => return (verb.run)(matches, &common),
        None => {}
    }
    match CommandLine::from_arg_matches(matches).map_err(CommandFailure::Arguments)?.verb {
        GeneralVerb::Reproduce(verb) => verb.run(&common, methods),
        GeneralVerb::Scene(verb) => verb.run(&common, methods),
        GeneralVerb::Run(verb) => verb.run(&common, methods),
        GeneralVerb::Scan(verb) => verb.run(&common, methods),
        GeneralVerb::Average(verb) => verb.run(&common, methods),
        GeneralVerb::Plot(verb) => verb.run(&common, methods),
        GeneralVerb::Bench(verb) => {
            let given = matches.subcommand().map_or(matches, |(_, below)| below);
            verb.run(given, &common, methods)
        }
        // Once all processes have begun, the first one reports an error of any.
        GeneralVerb::Chart(verb) if rank > 0 => match verb.run(&common, methods) {
            Err(_) if processes::has_exchanged() => Ok(()),
            outcome => outcome,
        },
        GeneralVerb::Chart(verb) => verb.run(&common, methods),
        GeneralVerb::Compare(verb) => verb.run(&common, methods),
        GeneralVerb::Emit(verb) => verb.run(&common, methods),
        GeneralVerb::Price(verb) => verb.run(&common),
        GeneralVerb::Explain(verb) => verb.run(&common, methods),
        GeneralVerb::Completions(verb) => verb.run(methods),
        GeneralVerb::Man(verb) => verb.run(methods),
        GeneralVerb::Measure => {
            let works: Vec<_> = laboratories(methods).flat_map(|laboratory| laboratory.works).collect();
            serve(&works)
        }
    }
}
