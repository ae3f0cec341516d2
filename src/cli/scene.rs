//! `stripmine scene`: presets, keys, and the check of a scene.

use super::{Common, Failure, print, print_json, warn};
use crate::report::table::{Cell, Table};
use crate::report::terminal;
use crate::run::memory::{self, Foreseen};
use crate::scene::{Checked, Document, Estimates, Fallback, KEYS, PRESETS, SECTIONS, Warning};
use clap::builder::PossibleValuesParser;
use clap::{Args, Subcommand};
use serde::Serialize;

/// Presets, a preset's text to start from, the check of a scene, and every key of a scene file
#[derive(Args)]
pub(super) struct SceneVerb {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// The presets
    List,
    /// The text of a preset
    Show {
        /// The preset
        #[arg(value_parser = PossibleValuesParser::new(PRESETS.iter().map(|preset| preset.name)))]
        name: String,
    },
    /// All mistakes of a scene at once, or its discs, its lattice and what it leaves out
    Check {
        /// A file, or a preset's name
        scene: String,
        /// Overrides a value; may be given several times
        #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
        overrides: Vec<String>,
    },
    /// Every key of a scene file: type, unit, default, meaning
    Keys,
}

impl SceneVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        match &self.action {
            Action::List => list(common),
            Action::Show { name } => show(name, common),
            Action::Check { scene, overrides } => check(scene, overrides, common),
            Action::Keys => keys(common),
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

fn list(common: &Common) -> Result<(), Failure> {
    let lines =
        PRESETS.iter().map(|preset| PresetLine { name: preset.name, title: preset.title(), text: None });
    if common.json {
        return print_json(&lines.collect::<Vec<_>>());
    }
    let table = Table {
        name: "presets".into(),
        title: "Presets".to_owned(),
        columns: ["name", "what it shows"].map(str::to_owned).to_vec(),
        rows: lines.map(|line| vec![line.name.into(), line.title.into()]).collect(),
        notes: vec!["stripmine scene show NAME prints a preset to start from.".to_owned()],
    };
    print(&terminal::render(&table))
}

fn show(name: &str, common: &Common) -> Result<(), Failure> {
    let preset = PRESETS.iter().find(|preset| preset.name == name);
    let text = preset.map(|preset| preset.text).unwrap_or_default();
    match preset {
        Some(preset) if common.json => {
            print_json(&PresetLine { name: preset.name, title: preset.title(), text: Some(text) })
        }
        _ => print(text),
    }
}

/// What a check found, as data.
#[derive(Serialize)]
struct Found<'c> {
    scene: &'c str,
    units: &'c str,
    grains: usize,
    wall_discs: usize,
    discs_alike: bool,
    radii: [f64; 2],
    origin: [f64; 2],
    sides: [f64; 2],
    periodic: [bool; 2],
    columns: usize,
    rows: usize,
    cells: usize,
    cell_edges: [f64; 2],
    cell_edge_bounds: [f64; 2],
    mask: u32,
    occupancy: f64,
    dt: f64,
    steps: u64,
    duration: f64,
    estimates: Estimates,
    memory: Foreseen,
    left_out: &'c [String],
    warnings: &'c [Warning],
}

impl<'c> Found<'c> {
    fn new(name: &'c str, checked: &'c Checked) -> Self {
        let Checked { scene, domain, particles, alike, geometry, estimates, left_out, warnings } = checked;
        Found {
            scene: name,
            units: &scene.units,
            grains: particles.grain_count(),
            wall_discs: particles.len() - particles.grain_count(),
            discs_alike: *alike,
            radii: geometry.radii,
            origin: domain.origin,
            sides: domain.sides,
            periodic: domain.periodic,
            columns: geometry.shape.columns(),
            rows: geometry.shape.rows(),
            cells: geometry.shape.cells(),
            cell_edges: geometry.frame.edge,
            cell_edge_bounds: geometry.edge_bounds,
            mask: 2 * geometry.mask.half_width() + 1,
            occupancy: geometry.occupancy,
            dt: scene.integrator.dt,
            steps: scene.run.steps,
            duration: scene.duration(),
            estimates: *estimates,
            memory: memory::foreseen(checked),
            left_out,
            warnings,
        }
    }

    fn table(&self) -> Table {
        let sides = |[x, y]: [f64; 2]| format!("{x:.6} × {y:.6}");
        let e = &self.estimates;
        let or_none =
            |value: Option<f64>, words: fn(f64) -> String| value.map_or("nothing moves".into(), words);
        let rows: Vec<(&str, String)> = vec![
            ("units", self.units.to_owned()),
            ("grains", self.grains.to_string()),
            ("wall discs", self.wall_discs.to_string()),
            ("radii", format!("{:.6} to {:.6}", self.radii[0], self.radii[1])),
            ("box", sides(self.sides)),
            ("cells", format!("{} × {} = {}", self.columns, self.rows, self.cells)),
            ("cell", sides(self.cell_edges)),
            (
                "cell edge allowed",
                format!("{:.6} to {:.6}", self.cell_edge_bounds[0], self.cell_edge_bounds[1]),
            ),
            ("mask", format!("{0} × {0}", self.mask)),
            ("occupancy", format!("{:.4}", self.occupancy)),
            ("steps", format!("{} of {} are {:.6}", self.steps, self.dt, self.duration)),
            ("approach speed", format!("{:.4e}", e.approach_speed)),
            ("steps per contact", or_none(e.steps_per_contact, |steps| format!("{steps:.1}"))),
            ("penetration of an impact", format!("{:.4}", e.impact_penetration)),
            ("memory of a run", {
                let left = self.memory.available.map(|bytes| format!(" of {} left", memory::in_words(bytes)));
                memory::in_words(self.memory.needed) + &left.unwrap_or_default()
            }),
            ("damping γ dt, dense 3 γ dt, limit", {
                format!("{:.4}, {:.4}, {}", e.damping, e.network_damping, e.damping_limit)
            }),
        ];
        let rows = rows.into_iter().map(|(name, value)| vec![Cell::from(name), Cell::Text(value)]);
        Table {
            name: "scene".into(),
            title: format!("{}: nothing forbids it", self.scene),
            columns: ["of the scene", "value"].map(str::to_owned).to_vec(),
            rows: rows.collect(),
            notes: self.left_out.iter().map(|what| format!("left out: {what}")).collect(),
        }
    }
}

fn check(name: &str, overrides: &[String], common: &Common) -> Result<(), Failure> {
    let fits = |checked: Checked| memory::foreseen(&checked).fits(name).map(|()| checked);
    let checked = Document::load(name, overrides).and_then(Document::check).and_then(fits)?;
    if !common.quiet {
        checked.warnings.iter().for_each(warn);
    }
    let found = Found::new(name, &checked);
    if common.json { print_json(&found) } else { print(&terminal::render(&found.table())) }
}

/// A key, as data.
#[derive(Serialize)]
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

fn keys(common: &Common) -> Result<(), Failure> {
    let line = |key: &crate::scene::Key| KeyLine {
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
    };
    let lines = KEYS.iter().map(|key| line(key));
    if common.json {
        return print_json(&lines.collect::<Vec<_>>());
    }
    let lines: Vec<KeyLine> = lines.collect();
    let sections = std::iter::once(("", "at the top of the file")).chain(SECTIONS);
    let tables: Vec<String> = sections
        .map(|(section, holds)| {
            let title = if section.is_empty() { holds.to_owned() } else { format!("[{section}]: {holds}") };
            let row = |line: &KeyLine| {
                let with = match line.used_with.as_slice() {
                    [] => String::new(),
                    choices => format!(" Used with {}.", choices.join(", ")),
                };
                let default = line.default.unwrap_or("required");
                let meaning = format!("{}{with}", line.meaning);
                [line.key, &line.r#type, line.unit, default, &meaning].map(Cell::from).to_vec()
            };
            let rows = lines.iter().filter(|line| line.section == section).map(row).collect();
            let columns = ["key", "value", "unit", "default", "meaning"].map(str::to_owned).to_vec();
            terminal::render(&Table { name: "keys".into(), title, columns, rows, notes: Vec::new() })
        })
        .collect();
    print(&tables.join("\n"))
}
