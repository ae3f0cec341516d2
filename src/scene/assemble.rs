//! From values to the scene, and from the scene to values.

use super::document::Entries;
use super::error::{Reason, SceneError};
use super::key_table::*;
use super::keys::{Fallback, Key, Selector, Value};
use super::places::beside;
use super::{
    Amount, Domain, Execution, Grains, Inertia, Integrator, Law, Lining, List, Method, MethodKind,
    OnConflict, OnLongStep, Output, Precision, Rebuild, Run, Scene, Scheme, Speed, Start, WallMotion,
};
use stripmine_kernels::law::granular::{Contact, ContactArm};
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::{Execution as Programs, InstructionSet};

/// A value of a key, given or by default.
struct Values<'e>(&'e Entries);

type Get<T> = Result<T, SceneError>;

macro_rules! define_access {
    ($($($method:ident)?, $optional:ident, $variant:ident, $ty:ty;)*) => {
        impl Values<'_> {
            $(
                fn $optional(&self, key: &Key) -> Option<$ty> {
                    match self.value(key) {
                        Some(Value::$variant(value)) => Some(value),
                        _ => None,
                    }
                }

                $(fn $method(&self, key: &Key) -> Get<$ty> {
                    self.$optional(key).ok_or_else(|| self.missing(key))
                })?
            )*
        }
    };
}

define_access! {
    number, number_if_any, Number, f64;
    whole, whole_if_any, Whole, u64;
    switch, switch_if_any, Switch, bool;
    word, word_if_any, Word, String;
    pair, pair_if_any, Pair, [f64; 2];
    switches, switches_if_any, Switches, [bool; 2];
    pairs, pairs_if_any, Pairs, Vec<[f64; 2]>;
    , numbers_if_any, Numbers, Vec<f64>;
}

impl Values<'_> {
    fn value(&self, key: &Key) -> Option<Value> {
        match (self.0.given(key), key.fallback) {
            (Some(entry), _) => Some(entry.value.clone()),
            (None, Fallback::Is(text)) => {
                let value = toml::de::DeValue::parse(text).ok()?;
                key.kind.read(&value).ok()
            }
            _ => None,
        }
    }

    fn missing(&self, key: &Key) -> SceneError {
        let message = format!("`{}` is missing", key.path());
        self.0.spot(key).error(Reason::Missing, message).expecting(key.expected())
    }
}

/// The scene that the values describe.
pub(super) fn read(entries: &Entries) -> Get<Scene> {
    let from = Values(entries);
    let dt = from.number(&DT)?;
    Ok(Scene {
        units: from.word(&UNITS)?,
        domain: Domain {
            origin: from.pair(&ORIGIN)?,
            sides: from.pair_if_any(&SIDES),
            periodic: from.switches(&PERIODIC)?,
            gravity: from.pair(&GRAVITY)?,
        },
        start: start(&from)?,
        walls: match from.word(&WALL_MOTION)?.as_str() {
            "oscillating" => WallMotion::Oscillating {
                amplitude: from.pair(&WALL_AMPLITUDE)?,
                frequency: from.number(&WALL_FREQUENCY)?,
            },
            _ => WallMotion::Fixed,
        },
        law: law(&from)?,
        method: method(&from)?,
        integrator: Integrator {
            scheme: match from.word(&INTEGRATOR)?.as_str() {
                "velocity-verlet" => Scheme::VelocityVerlet,
                _ => Scheme::Gear { values: from.whole(&VALUES)? as usize },
            },
            dt,
            on_long_step: match from.word(&ON_LONG_STEP)?.as_str() {
                "count" => OnLongStep::Count,
                _ => OnLongStep::Stop,
            },
        },
        run: Run {
            steps: match from.number_if_any(&TIME) {
                Some(time) => (time / dt).round() as u64,
                None => from.whole(&STEPS)?,
            },
            thermo_every: from.whole(&THERMO_EVERY)?,
            snapshot_every: from.whole(&SNAPSHOT_EVERY)?,
            checkpoint_every: from.whole(&CHECKPOINT_EVERY)?,
        },
        output: Output {
            trajectory: from.switch(&TRAJECTORY)?,
            lammps_dump: from.switch(&LAMMPS_DUMP)?,
            lammps_data: from.switch(&LAMMPS_DATA)?,
        },
    })
}

fn start(from: &Values<'_>) -> Get<Start> {
    let amount = || match from.number_if_any(&PACKING_FRACTION) {
        Some(fraction) => Ok(Amount::PackingFraction(fraction)),
        None => from.whole(&COUNT).map(|count| Amount::Count(count as usize)),
    };
    let wall_radius = |radius: f64| from.number_if_any(&WALL_RADIUS).unwrap_or(0.9 * radius);
    let lining = || -> Get<Lining> {
        let radius = wall_radius(from.number(&RADIUS)?);
        Ok(Lining { radius, spacing: from.number_if_any(&WALL_SPACING).unwrap_or(3.0 * radius) })
    };
    let choice = Selector::Start.choice(from.0).unwrap_or_default();
    Ok(match choice.as_str() {
        "file" => Start::File(beside(&from.0.file, &from.word(&FILE)?)),
        "list" => {
            let positions = from.pairs(&POSITIONS)?;
            let (count, radius) = (positions.len(), from.number(&RADIUS)?);
            Start::List(List {
                velocities: from.pairs_if_any(&VELOCITIES).unwrap_or_else(|| vec![[0.0; 2]; count]),
                omegas: from.numbers_if_any(&OMEGAS).unwrap_or_else(|| vec![0.0; count]),
                radii: from.numbers_if_any(&RADII).unwrap_or_else(|| vec![radius; count]),
                positions,
                radius,
                mass: from.number(&MASS)?,
                wall_positions: from.pairs_if_any(&WALL_POSITIONS).unwrap_or_default(),
                wall_radius: wall_radius(radius),
            })
        }
        "hexagonal" => Start::Hexagonal {
            count: from.whole(&COUNT)? as usize,
            packing_fraction: from.number(&PACKING_FRACTION)?,
            grains: grains(from)?,
        },
        "pipe" => Start::Pipe {
            amount: amount()?,
            grains: grains(from)?,
            lining: lining()?,
            clear_width: from.number(&CLEAR_WIDTH)?,
        },
        "box" => Start::Box {
            amount: amount()?,
            grains: grains(from)?,
            lining: lining()?,
            fill_height: from.number(&FILL_HEIGHT)?,
        },
        _ => Start::Random { amount: amount()?, grains: grains(from)? },
    })
}

fn grains(from: &Values<'_>) -> Get<Grains> {
    let spread = from.number(&RADIUS_SPREAD)?;
    Ok(Grains {
        radius: from.number(&RADIUS)?,
        spread,
        cut: from.number_if_any(&RADIUS_CUT).unwrap_or_else(|| (2.0 * spread).min(0.12)),
        mass: from.number(&MASS)?,
        speed: match from.number_if_any(&TEMPERATURE) {
            Some(kt) => Speed::Temperature(kt),
            None => Speed::Deviation(from.number_if_any(&SPEED).unwrap_or(0.0)),
        },
        seed: from.whole(&SEED)?,
    })
}

fn law(from: &Values<'_>) -> Get<Law> {
    Ok(Law {
        contact: Contact {
            stiffness: from.number(&STIFFNESS)?,
            normal_damping: from.number(&NORMAL_DAMPING)?,
            shear_damping: from.number(&SHEAR_DAMPING)?,
            friction: from.number(&FRICTION)?,
            cohesionless: from.switch(&COHESIONLESS)?,
            arm: match from.word(&CONTACT_ARM)?.as_str() {
                "overlap" => ContactArm::Overlap,
                "lammps" => ContactArm::Lammps,
                _ => ContactArm::Radius,
            },
        },
        inertia: match from.word(&INERTIA)?.as_str() {
            "sphere" => Inertia::Sphere,
            _ => Inertia::Disc,
        },
        max_penetration: from.number(&MAX_PENETRATION)?,
        stop_penetration: from.number(&STOP_PENETRATION)?,
    })
}

fn method(from: &Values<'_>) -> Get<Method> {
    let execution = from.word(&EXECUTION)?;
    let instruction_set = from.word(&INSTRUCTION_SET)?;
    Ok(Method {
        kind: match from.word(&METHOD)?.as_str() {
            "neighbor-list" => MethodKind::NeighborList {
                rebuild: match from.word(&REBUILD)?.as_str() {
                    "all-pairs" => Rebuild::AllPairs,
                    _ => Rebuild::Cells,
                },
                skin: from.number_if_any(&SKIN),
            },
            "sectors" => MethodKind::Sectors,
            _ => MethodKind::Lattice,
        },
        on_conflict: match from.word(&ON_CONFLICT)?.as_str() {
            "resolve" => OnConflict::Resolve,
            _ => OnConflict::Stop,
        },
        cell_edge: from.number_if_any(&CELL_EDGE),
        mask: from.whole_if_any(&MASK).map(|width| width as usize),
        coordinates: match from.word(&COORDINATES)?.as_str() {
            "absolute" => Coordinates::Absolute,
            _ => Coordinates::CellRelative,
        },
        precision: match from.word(&PRECISION)?.as_str() {
            "f32" => Precision::F32,
            "mixed" => Precision::Mixed,
            _ => Precision::F64,
        },
        execution: match execution.strip_prefix("strip:").map(str::parse) {
            Some(Ok(length)) => Execution::Programs(Programs::Strip(length)),
            _ if execution == "eager" => Execution::Programs(Programs::Eager),
            _ if execution == "fast" => Execution::Fast,
            _ => Execution::Programs(Programs::Chained),
        },
        instruction_set: InstructionSet::ALL.iter().copied().find(|set| set.name() == instruction_set),
    })
}

/// The scene as TOML, every key that is used with its value and unit.
pub(super) fn write(scene: &Scene) -> String {
    let values = values(scene);
    let mut text = String::new();
    let sections = std::iter::once("").chain(SECTIONS.iter().map(|(name, _)| *name));
    for section in sections {
        if !section.is_empty() {
            text.push_str(&format!("\n[{section}]\n"));
        }
        for key in KEYS.iter().filter(|key| key.section == section) {
            if let Some((_, value)) = values.iter().find(|(written, _)| written.id() == key.id()) {
                let unit = if key.unit.is_empty() { String::new() } else { format!(" # {}", key.unit) };
                text.push_str(&format!("{} = {}{unit}\n", key.name, value.to_toml()));
            }
        }
    }
    text
}

fn word(word: &str) -> Value {
    Value::Word(word.to_owned())
}

/// The values that describe a scene.
fn values(scene: &Scene) -> Vec<(&'static Key, Value)> {
    let Scene { units, domain, start, walls, law, method, integrator, run, output } = scene;
    let mut values = vec![
        (&FORMAT, Value::Whole(super::FORMAT)),
        (&UNITS, word(units)),
        (&ORIGIN, Value::Pair(domain.origin)),
        (&PERIODIC, Value::Switches(domain.periodic)),
        (&GRAVITY, Value::Pair(domain.gravity)),
        (&LAW, word("granular")),
        (&STIFFNESS, Value::Number(law.contact.stiffness)),
        (&NORMAL_DAMPING, Value::Number(law.contact.normal_damping)),
        (&SHEAR_DAMPING, Value::Number(law.contact.shear_damping)),
        (&FRICTION, Value::Number(law.contact.friction)),
        (&COHESIONLESS, Value::Switch(law.contact.cohesionless)),
        (&INERTIA, word(if law.inertia == Inertia::Sphere { "sphere" } else { "disc" })),
        (
            &CONTACT_ARM,
            word(match law.contact.arm {
                ContactArm::Radius => "radius",
                ContactArm::Overlap => "overlap",
                ContactArm::Lammps => "lammps",
            }),
        ),
        (&MAX_PENETRATION, Value::Number(law.max_penetration)),
        (&STOP_PENETRATION, Value::Number(law.stop_penetration)),
        (&DT, Value::Number(integrator.dt)),
        (&ON_LONG_STEP, word(if integrator.on_long_step == OnLongStep::Count { "count" } else { "stop" })),
        (&STEPS, Value::Whole(run.steps)),
        (&THERMO_EVERY, Value::Whole(run.thermo_every)),
        (&SNAPSHOT_EVERY, Value::Whole(run.snapshot_every)),
        (&CHECKPOINT_EVERY, Value::Whole(run.checkpoint_every)),
        (&TRAJECTORY, Value::Switch(output.trajectory)),
        (&LAMMPS_DUMP, Value::Switch(output.lammps_dump)),
        (&LAMMPS_DATA, Value::Switch(output.lammps_data)),
    ];
    values.extend(domain.sides.map(|sides| (&SIDES, Value::Pair(sides))));
    start_values(start, &mut values);
    match *walls {
        WallMotion::Oscillating { amplitude, frequency } => values.extend([
            (&WALL_MOTION, word("oscillating")),
            (&WALL_AMPLITUDE, Value::Pair(amplitude)),
            (&WALL_FREQUENCY, Value::Number(frequency)),
        ]),
        WallMotion::Fixed if matches!(start, Start::Random { .. } | Start::Hexagonal { .. }) => {}
        WallMotion::Fixed => values.push((&WALL_MOTION, word("fixed"))),
    }
    method_values(method, &mut values);
    match integrator.scheme {
        Scheme::Gear { values: count } => {
            values.extend([(&INTEGRATOR, word("gear")), (&VALUES, Value::Whole(count as u64))]);
        }
        Scheme::VelocityVerlet => values.push((&INTEGRATOR, word("velocity-verlet"))),
    }
    values
}

fn start_values(start: &Start, values: &mut Vec<(&'static Key, Value)>) {
    let amount = |amount: &Amount| match *amount {
        Amount::Count(count) => (&COUNT, Value::Whole(count as u64)),
        Amount::PackingFraction(fraction) => (&PACKING_FRACTION, Value::Number(fraction)),
    };
    let grains = |grains: &Grains, spread: bool, values: &mut Vec<(&'static Key, Value)>| {
        values.extend([
            (&RADIUS, Value::Number(grains.radius)),
            (&MASS, Value::Number(grains.mass)),
            (&SEED, Value::Whole(grains.seed)),
            match grains.speed {
                Speed::Deviation(speed) => (&SPEED, Value::Number(speed)),
                Speed::Temperature(kt) => (&TEMPERATURE, Value::Number(kt)),
            },
        ]);
        if spread {
            values.push((&RADIUS_SPREAD, Value::Number(grains.spread)));
            values.push((&RADIUS_CUT, Value::Number(grains.cut)));
        }
    };
    let lining = |lining: &Lining| {
        [(&WALL_RADIUS, Value::Number(lining.radius)), (&WALL_SPACING, Value::Number(lining.spacing))]
    };
    match start {
        Start::File(path) => values.push((&FILE, word(&path.to_string_lossy()))),
        Start::List(list) => values.extend([
            (&GENERATE, word("list")),
            (&RADIUS, Value::Number(list.radius)),
            (&MASS, Value::Number(list.mass)),
            (&POSITIONS, Value::Pairs(list.positions.clone())),
            (&VELOCITIES, Value::Pairs(list.velocities.clone())),
            (&OMEGAS, Value::Numbers(list.omegas.clone())),
            (&RADII, Value::Numbers(list.radii.clone())),
            (&WALL_POSITIONS, Value::Pairs(list.wall_positions.clone())),
            (&WALL_RADIUS, Value::Number(list.wall_radius)),
        ]),
        Start::Hexagonal { count, packing_fraction, grains: discs } => {
            values.push((&GENERATE, word("hexagonal")));
            values.push((&COUNT, Value::Whole(*count as u64)));
            values.push((&PACKING_FRACTION, Value::Number(*packing_fraction)));
            grains(discs, false, values);
        }
        Start::Random { amount: how_many, grains: discs } => {
            values.extend([(&GENERATE, word("random")), amount(how_many)]);
            grains(discs, true, values);
        }
        Start::Pipe { amount: how_many, grains: discs, lining: walls, clear_width } => {
            values.extend([(&GENERATE, word("pipe")), amount(how_many)]);
            values.push((&CLEAR_WIDTH, Value::Number(*clear_width)));
            values.extend(lining(walls));
            grains(discs, true, values);
        }
        Start::Box { amount: how_many, grains: discs, lining: walls, fill_height } => {
            values.extend([(&GENERATE, word("box")), amount(how_many)]);
            values.push((&FILL_HEIGHT, Value::Number(*fill_height)));
            values.extend(lining(walls));
            grains(discs, true, values);
        }
    }
}

fn method_values(method: &Method, values: &mut Vec<(&'static Key, Value)>) {
    match method.kind {
        MethodKind::Lattice => {
            values.push((&METHOD, word("lattice")));
            let resolves = method.on_conflict == OnConflict::Resolve;
            values.push((&ON_CONFLICT, word(if resolves { "resolve" } else { "stop" })));
        }
        MethodKind::Sectors => values.push((&METHOD, word("sectors"))),
        MethodKind::NeighborList { rebuild, skin } => {
            values.push((&METHOD, word("neighbor-list")));
            values.push((&REBUILD, word(if rebuild == Rebuild::Cells { "cells" } else { "all-pairs" })));
            values.extend(skin.map(|skin| (&SKIN, Value::Number(skin))));
        }
    }
    values.extend(method.cell_edge.map(|edge| (&CELL_EDGE, Value::Number(edge))));
    values.extend(method.mask.map(|width| (&MASK, Value::Whole(width as u64))));
    let relative = method.coordinates == Coordinates::CellRelative;
    values.push((&COORDINATES, word(if relative { "cell-relative" } else { "absolute" })));
    values.push((
        &PRECISION,
        word(match method.precision {
            Precision::F64 => "f64",
            Precision::F32 => "f32",
            Precision::Mixed => "mixed",
        }),
    ));
    values.push((&EXECUTION, Value::Word(method.execution.name())));
    values.push((&INSTRUCTION_SET, word(method.instruction_set.map_or("auto", InstructionSet::name))));
}
