//! `stripmine scene`: lists presets and keys, and checks scenes.

use crate::console::{CommandFailure, Common, print, print_json, warn};
use crate::emission::{EmissionError, ListingTarget, listing_text};
use crate::frame::{FormattedTable, FrameBuilder, csv};
use crate::laboratory::programs::operation_frames;
use crate::model::machine::MachineModel;
use crate::model::machines;
use crate::report::terminal;
use crate::study::StudyError;
use clap::{Args, Subcommand};
use serde::Serialize;
use serde_json::{Map, json};
use stripmine_kernels::backend::ListingLine;
use stripmine_kernels::emit::GroupSize;
use stripmine_physics::method::{Fact, MethodEntry, Methods, Prepared, VectorProgram, load, method};
use stripmine_physics::quoted;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::run::forecast;
use stripmine_physics::scene::{Fallback, Key, KeyValueKind, Preset, SECTIONS};

/// Lists presets and keys, checks a scene
#[derive(Args)]
pub(super) struct SceneVerb {
    #[command(subcommand)]
    action: SceneAction,
}

#[derive(Subcommand)]
enum SceneAction {
    /// Lists the presets
    List,
    /// Prints a preset as a scene file
    Show {
        /// Preset name
        name: String,
    },
    /// Checks a scene: all mistakes, or its step limits, time and memory
    Check {
        /// Preset name or scene file
        scene: String,
        /// Overrides a value; can be repeated
        #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
        overrides: Vec<String>,
    },
    /// Counts the vector operations of a step, and clock periods on a machine
    Programs {
        /// Preset name or scene file
        scene: String,
        /// Overrides a value; can be repeated
        #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
        overrides: Vec<String>,
        /// Machine: a preset of `table`, or a machine file
        #[arg(long, default_value = "cray-y-mp-el")]
        machine: String,
        /// Prints the vector instructions as an assembly listing instead
        #[arg(long)]
        listing: bool,
        /// Prints the operations, flops and bytes of every section as comma-separated values instead
        #[arg(long, conflicts_with = "listing")]
        csv: bool,
        #[command(flatten)]
        target: ListingTarget,
    },
    /// Lists keys of a scene file: type, unit, default, meaning
    Keys {
        /// Method whose keys are listed, or a word in keys of all methods
        what: Option<String>,
    },
}

impl SceneVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        match &self.action {
            SceneAction::List => list(common, methods),
            SceneAction::Show { name } => show(name, common, methods),
            SceneAction::Check { scene, overrides } => check(scene, overrides, common, methods),
            SceneAction::Programs { scene, overrides, machine, listing, csv, target } => {
                let (prepared, _) = load(scene, overrides, methods)?;
                let machine = machines::find(machine)?;
                let listing = (*listing || target.size().is_some()).then(|| target.size());
                let output = match listing {
                    Some(target) => ProgramOutput::Listing(target),
                    None if *csv => ProgramOutput::Csv,
                    None => ProgramOutput::Tables,
                };
                programs(scene, &prepared, &machine, output, common)
            }
            SceneAction::Keys { what } => keys(what.as_deref(), common, methods),
        }
    }
}

#[derive(Serialize)]
struct PresetLine {
    name: &'static str,
    title: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<&'static str>,
}

fn list(common: &Common, methods: Methods) -> Result<(), CommandFailure> {
    let lines =
        presets(methods).map(|preset| PresetLine { name: preset.name, title: preset.title(), text: None });
    if common.json {
        return print_json(&lines.collect::<Vec<_>>());
    }
    let table = FrameBuilder::of(lines)
        .text("name", |line| line.name)
        .text("what it shows", |line| line.title)
        .table("presets", "Presets")
        .note("stripmine scene show NAME prints a preset as a starting point.");
    print(&terminal::render(&table))
}

fn show(name: &str, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
    let preset = presets(methods).find(|preset| preset.name == name);
    let text = preset.map(|preset| preset.text).unwrap_or_default();
    match preset {
        Some(preset) if common.json => {
            print_json(&PresetLine { name: preset.name, title: preset.title(), text: Some(text) })
        }
        _ => print(text),
    }
}

/// Presets of the given methods.
pub(super) fn presets(methods: Methods) -> impl Iterator<Item = &'static Preset> {
    methods.iter().flat_map(|method| method.vocabulary.presets)
}

fn scene_table(name: &str, facts: &[Fact], prepared: &Prepared) -> FormattedTable {
    let chosen = prepared.choices.iter().map(|choice| format!("chosen: {choice}"));
    let left_out = prepared.left_out.iter().map(|what| format!("left out: {what}"));
    let limits = prepared.step_limits.iter().map(|limit| format!("{}: {}", limit.name, limit.why));
    FrameBuilder::of(facts.iter().filter_map(|fact| fact.words.as_ref()))
        .text("property", |(label, _)| *label)
        .text("value", |(_, words)| words)
        .table("scene", format!("{}: valid scene", quoted::path(name.as_ref())))
        .notes(chosen)
        .notes(left_out)
        .notes(limits)
}

fn check(name: &str, overrides: &[String], common: &Common, methods: Methods) -> Result<(), CommandFailure> {
    let (prepared, entry) = load(name, overrides, methods)?;
    prepared.memory.fits(name)?;
    let above = forecast::above_limits(&prepared);
    if !common.quiet {
        prepared.warnings.iter().chain(&above).for_each(warn);
    }
    let mut facts = prepared.facts.clone();
    facts.extend(forecast::step_forecast(&prepared));
    facts.extend(forecast::output_forecast(&prepared));
    facts.extend(forecast::time_forecast(&prepared));
    facts.push(forecast::memory_forecast(&prepared));
    if !common.json {
        return print(&terminal::render(&scene_table(name, &facts, &prepared)));
    }
    let mut data = Map::new();
    data.insert("scene".to_owned(), json!(name));
    data.insert("method".to_owned(), json!(entry.vocabulary.keys.method));
    data.extend(forecast::as_data(facts));
    data.insert("choices".to_owned(), json!(prepared.choices));
    data.insert("left_out".to_owned(), json!(prepared.left_out));
    data.insert("warnings".to_owned(), json!(prepared.warnings.iter().chain(&above).collect::<Vec<_>>()));
    print_json(&data)
}

/// Program as data.
#[derive(Serialize)]
struct ProgramListing {
    part: &'static str,
    length: &'static str,
    n: usize,
    times: u64,
    instructions: Vec<ListingLine>,
    #[serde(skip)]
    text: String,
}

/// Columns of operations, in a table of their own.
const COUNTED: [&str; 4] = ["n is", "operations (NOP)", "of them computing", "divisions and roots"];
/// Columns of flops and bytes, in a table of their own.
const MOVED: [&str; 3] = ["flops", "bytes", "flop a byte"];

/// Output of the programs of a scene.
enum ProgramOutput {
    /// Operations and clock periods, as tables.
    Tables,
    /// Operations as comma-separated values.
    Csv,
    /// Instructions of the vector machine, or those of a processor with registers in groups.
    Listing(Option<GroupSize>),
}

fn programs(
    name: &str,
    prepared: &Prepared,
    machine: &MachineModel,
    output: ProgramOutput,
    common: &Common,
) -> Result<(), CommandFailure> {
    let (programs, note) = (prepared.model.programs(), prepared.model.programs_note());
    if programs.is_empty() {
        return Err(StudyError::NoPrograms(name.to_owned()).into());
    }
    let ProgramOutput::Listing(target) = output else {
        let frames = operation_frames(name, &programs, std::slice::from_ref(machine));
        if common.json {
            let mut data = Map::from_iter(frames.iter().map(|frame| (frame.name.clone(), frame.json())));
            data.extend([("scene".to_owned(), json!(name)), ("note".to_owned(), json!(note))]);
            return print_json(&data);
        }
        if let ProgramOutput::Csv = output {
            let mut bytes = vec![];
            csv::write(&frames[0], &mut bytes).map_err(CommandFailure::writing("standard output"))?;
            return print(&String::from_utf8_lossy(&bytes));
        }
        let [operations, clocks] = frames.each_ref().map(FormattedTable::from);
        // Side by side, all columns would be wider than a page.
        let title = format!(
            "{name}: floating-point operations and bytes of a section, for one element of its vectors"
        );
        let moved = FormattedTable { title, ..operations.clone().without(&COUNTED) };
        let tables = [operations.without(&MOVED).notes(note), moved, clocks];
        return print(&tables.each_ref().map(terminal::render).join("\n"));
    };
    let of = |it: &VectorProgram| {
        Ok(ProgramListing {
            part: it.part,
            length: it.length,
            n: it.n,
            times: it.times,
            instructions: it.program.lines(),
            text: listing_text(it.part, it.program.as_ref(), target)
                .map_err(|cause| EmissionError::NoCode { part: it.part, cause })?,
        })
    };
    let listings: Vec<ProgramListing> = programs.iter().map(of).collect::<Result<_, EmissionError>>()?;
    if common.json {
        return print_json(&listings);
    }
    let text = |it: &ProgramListing| {
        let ProgramListing { part, length, n, times, text, .. } = it;
        let comment = if target.is_some() { '#' } else { ';' };
        format!("{comment} {part}: vectors of n = {length} = {n} elements, {times} times a step\n{text}")
    };
    let note = note.map_or(String::new(), |note| format!("; {note}\n"));
    print(&(note + &listings.iter().map(text).collect::<String>()))
}

/// A key of some methods.
#[derive(Serialize)]
struct MatchingKey {
    methods: Vec<&'static str>,
    #[serde(flatten)]
    line: KeyLine,
}

/// Lists the keys of all methods with a word in their section, name or meaning.
fn matching_keys(word: &str, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
    let wanted = word.to_lowercase();
    let mut found: Vec<MatchingKey> = vec![];
    for entry in methods {
        for line in key_lines(entry) {
            let text = format!("{}.{} {}", line.section, line.key, line.meaning).to_lowercase();
            if !text.contains(&wanted) {
                continue;
            }
            let is_same = |known: &&mut MatchingKey| known.line == line;
            match found.iter_mut().find(is_same) {
                Some(known) => known.methods.push(entry.vocabulary.keys.method),
                None => found.push(MatchingKey { methods: vec![entry.vocabulary.keys.method], line }),
            }
        }
    }
    if found.is_empty() {
        return Err(NoSuchKey(word.to_owned()).into());
    }
    if common.json {
        return print_json(&found);
    }
    let table = FrameBuilder::of(&found)
        .text("key", |it| match it.line.section {
            "" => it.line.key.to_owned(),
            section => format!("{section}.{}", it.line.key),
        })
        .text("methods", |it| {
            if it.methods.len() == methods.len() { "all".to_owned() } else { it.methods.join(", ") }
        })
        .text("value", |it| &it.line.r#type)
        .text("default", |it| it.line.default.unwrap_or("required"))
        .text("meaning", |it| it.line.meaning)
        .table("keys", format!("Keys with `{word}` in their name or meaning"));
    print(&terminal::render(&table))
}

/// A word that is neither a method nor in a key.
#[derive(Debug, thiserror::Error)]
#[error(
    "no method is called `{0}`, and no key has it in its name or meaning; `stripmine scene keys` lists the keys of a method"
)]
struct NoSuchKey(String);

impl Reported for NoSuchKey {
    fn class(&self) -> ErrorClass {
        ErrorClass::Usage
    }
}

/// Key as data.
#[derive(PartialEq, Serialize)]
struct KeyLine {
    section: &'static str,
    key: &'static str,
    r#type: String,
    unit: &'static str,
    default: Option<&'static str>,
    required: bool,
    used_with: Vec<&'static str>,
    meaning: &'static str,
}

impl KeyLine {
    fn of(key: &Key) -> KeyLine {
        KeyLine {
            section: key.section,
            key: key.name,
            r#type: key.kind.words(),
            unit: key.unit,
            default: match key.fallback {
                Fallback::Required => None,
                Fallback::Is(text) | Fallback::Otherwise(text) => Some(text),
            },
            required: key.fallback == Fallback::Required,
            used_with: key.used.map_or(Vec::new(), |(_, choices)| choices.to_vec()),
            meaning: key.doc,
        }
    }
}

/// Keys of a method, those of the tables of a list after all others.
fn key_lines(entry: &MethodEntry) -> Vec<KeyLine> {
    let keys = || entry.vocabulary.keys.keys();
    let fields = keys().flat_map(|key| match key.kind {
        KeyValueKind::Tables(fields) => fields.iter().copied(),
        _ => [].iter().copied(),
    });
    keys().chain(fields).map(KeyLine::of).collect()
}

fn keys(name: Option<&str>, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
    let entry = match name {
        Some(name) => method(methods, name),
        None => methods.first().copied(),
    };
    let Some(entry) = entry else { return matching_keys(name.unwrap_or_default(), common, methods) };
    let lines = key_lines(entry);
    if common.json {
        return print_json(&lines);
    }
    let sections = std::iter::once(("", "at the top of the file")).chain(SECTIONS);
    let titles = sections.map(|(section, holds)| match section {
        "" => (section, holds.to_owned()),
        _ => (section, format!("[{section}]: {holds}")),
    });
    let lists = entry.vocabulary.keys.keys().filter(|key| matches!(key.kind, KeyValueKind::Tables(_)));
    let titles = titles.chain(lists.map(|key| (key.name, format!("[[{}]]: each", key.name))));
    let tables: Vec<String> = titles
        .filter(|(section, _)| lines.iter().any(|line| line.section == *section))
        .map(|(section, title)| {
            let with = |line: &KeyLine| match line.used_with.as_slice() {
                [] => String::new(),
                choices => format!(" Used with {}.", choices.join(", ")),
            };
            let table = FrameBuilder::of(lines.iter().filter(|line| line.section == section))
                .text("key", |line| line.key)
                .text("value", |line| &line.r#type)
                .text("unit", |line| line.unit)
                .text("default", |line| line.default.unwrap_or("required"))
                .text("meaning", |line| format!("{}{}", line.meaning, with(line)))
                .table("keys", title);
            terminal::render(&table)
        })
        .collect();
    print(&tables.join("\n"))
}
