//! Keys of this method, and their constraints on each other.

use super::options::EngineChoice;
use crate::scene::Fallback::{Is, Otherwise};
use crate::scene::KeyValueKind::{Choice, Number, Switch, Whole};
use crate::scene::NumberRange::{AtMost, NonNegative, Positive};
use crate::scene::keys::define_keys;
use crate::scene::{
    DISC_RIVALS, DISCS, ExclusiveKeys, GRAVITY, HEADING, INSTRUCTIONS, KeySet, KeyValue, MistakeKind, OUTPUT,
    PERIODIC, PLANAR_DOMAIN, SUMMED, SceneError, SceneValues, TARGETED, Use, Vocabulary,
    start_inconsistencies,
};
use crate::words::Words;

const ALWAYS: Use = None;
const CROSSED: Use = Some((&ENGINE, &["cell-crossing"]));
const HEATED: Use = Some((&THERMAL_SIDE, &["left", "right", "bottom", "top"]));
/// Maximum number of events of a run.
pub(super) const MOST_EVENTS: u64 = 1_000_000_000_000_000;

/// Names of the masks in scenes.
pub const MASKS: &[&str] = &["auto", "min", "r3", "r4", "r5", "r6", "r7", "r8", "r9", "r10"];

/// Names of the sides in scenes.
pub(super) const THERMAL_SIDES: &[&str] = &["none", "left", "right", "bottom", "top"];

define_keys! {
    /// Collisions, search and duration.
    static OWN;
    RESTITUTION = "law" "restitution", Number(AtMost(1.0)), "", Is("1.0"), ALWAYS,
        "Restitution of disc collisions: ratio of the relative normal speeds after and before.";
    WALL_RESTITUTION = "law" "wall_restitution", Number(AtMost(1.0)), "", Is("1.0"), ALWAYS,
        "Restitution at sides that are not periodic.";
    CONTACT_DURATION = "law" "contact_duration", Number(NonNegative), "time", Is("0.0"), ALWAYS,
        "Contact duration of the TC model, against inelastic collapse: a collision sooner than this after another one of either disc is elastic; 0 for none.";

    THERMAL_SIDE = "law" "thermal_side", Choice(THERMAL_SIDES), "", Is("\"none\""), ALWAYS,
        "Thermal side: a side that is not periodic and re-emits every disc with a velocity of its own temperature.";
    WALL_TEMPERATURE = "law" "wall_temperature", Number(Positive), "mass·length²/time²", Is("1.0"), HEATED,
        "Temperature kT of the thermal side.";
    NOISE_SEED = "law" "noise_seed", Whole(0, u64::MAX), "", Otherwise("`particles.seed`; 1 where the start has none"), HEATED,
        "Seed of the velocities drawn by the thermal side. If the start is a file or a list, they also depend on the state: a run that continues from a frame draws new ones.";
    FLOOR_AMPLITUDE = "law" "floor_amplitude", Number(NonNegative), "length", Is("0.0"), ALWAYS,
        "Amplitude A of the floor, the lower end of the second side: it is A (1 − cos 2π f t) above the end of the box; 0 for a floor at rest.";
    FLOOR_FREQUENCY = "law" "floor_frequency", Number(Positive), "1/time", Is("1.0"), ALWAYS,
        "Frequency f of the floor.";
    OPEN_TOP = "domain" "open_top", Switch, "", Is("false"), ALWAYS,
        "Removes the ceiling: the upper end of the second side is open, and gravity points down.";

    ENGINE = "machine" "engine", Choice(EngineChoice::WORDS), "", Is("\"auto\""), ALWAYS,
        "Search for events; all engines give the same bits. fast keeps a neighbour list for each disc; reference uses masks over the exclusive grid, as in ISO99; cell-crossing uses linked cells with crossing events, the rival in ISO99. auto is fast, unless a mask is given or the box is too small for lists.";

    MASK = "search" "mask", Choice(MASKS), "", Is("\"auto\""), ALWAYS,
        "Mask of cells in which a disc searches for partners: min is 5 × 5, r3 to r10 are round masks of these radii. A larger mask needs fewer refills of the grid; auto takes the cheapest by ISO99's cost formula.";

    DISCS_IN_CELL = "search" "discs_in_cell", Number(Positive), "", Is("1.0"), CROSSED,
        "Mean number of discs in a linked cell. Fewer need fewer predictions of pairs and more crossings; a cell is at least as wide as the largest disc.";

    COLLISION_LOG = "output" "collisions", Switch, "", Is("false"), ALWAYS,
        "Writes each collision as a row of events.csv: time, discs, point of contact, impulse and the free times before it.";

    EVENTS = "run" "events", Whole(1, MOST_EVENTS), "", Otherwise("from `time`"), ALWAYS,
        "Number of collisions, of pairs and at walls.";
    TIME = "run" "time", Number(NonNegative), "time", Otherwise("from `events`"), ALWAYS,
        "Duration of the run.";
    THERMO_EVERY = "run" "thermo_every", Number(NonNegative), "time", Is("1.0"), ALWAYS,
        "Time between rows of thermo.csv; 0 for none.";
    SNAPSHOT_EVERY = "run" "snapshot_every", Number(NonNegative), "time", Is("10.0"), ALWAYS,
        "Time between snapshots; 0 for the first and the last only.";
    CHECKPOINT_EVERY = "run" "checkpoint_every", Number(NonNegative), "time", Otherwise("by the wall clock"), ALWAYS,
        "Time between checkpoints; 0 for one at the end only. Default: one every ten seconds of wall-clock time. No result depends on it.";
}

/// Alternative durations of a run: a number of events, or a time.
static DURATION: &[ExclusiveKeys] =
    &[ExclusiveKeys { keys: &[&EVENTS, &TIME], used: ALWAYS, needed: true, with: None }];

/// Vocabulary of the scenes of this method.
pub(super) static VOCABULARY: Vocabulary = Vocabulary {
    keys: KeySet {
        method: "hard-disks",
        groups: &[HEADING, PLANAR_DOMAIN, DISCS, OWN, INSTRUCTIONS, TARGETED, OUTPUT, SUMMED],
        rivals: &[DISC_RIVALS, DURATION],
        advice: &[
            (
                "law.temperature",
                "use `particles.temperature` for the start, `law.wall_temperature` for a thermal side",
            ),
            ("integrator.dt", "hard discs have no time step: they fly freely from one collision to the next"),
            (
                "integrator.kind",
                "hard discs have no time step: they fly freely from one collision to the next",
            ),
            (
                "integrator.scheme",
                "hard discs have no time step: they fly freely from one collision to the next",
            ),
            ("run.steps", "hard discs take no steps: set `run.events` or `run.time`"),
            (
                "law.bath_temperature",
                "hard discs have no bath: set the temperature of the start with `particles.temperature`, or use a thermal side (`law.thermal_side`)",
            ),
            ("law.drag", "hard discs have no bath: they fly freely between collisions"),
            ("law.friction", "hard discs are smooth and do not spin"),
            ("law.stiffness", "hard discs are rigid: `law.restitution` sets the energy lost in a collision"),
            ("machine.precision", "hard discs are always in double precision"),
        ],
    },
    rules: &[start_inconsistencies, own_rules],
    presets: super::presets::PRESETS,
    renamed: &[],
};

/// Checks the keys that depend on each other.
fn own_rules(values: &SceneValues) -> Vec<SceneError> {
    let mut errors = vec![];
    let periodic = match values.value(&PERIODIC) {
        Some(KeyValue::Switches(periodic)) => periodic,
        _ => [true; 2],
    };
    let gravity = match values.value(&GRAVITY) {
        Some(KeyValue::Pair(gravity)) => gravity,
        _ => [0.0; 2],
    };
    for axis in (0..2).filter(|&axis| periodic[axis] && gravity[axis] != 0.0) {
        let message = format!("gravity = {gravity:?}, but nothing stops the fall across a periodic side");
        let error = values.spot(&GRAVITY).error(MistakeKind::Contradiction, message);
        errors.push(error.advising(match axis {
            0 => "close the first side: periodic = [false, …]",
            _ => "close the second side: periodic = [true, false]",
        }));
    }
    if values.value(&OPEN_TOP) == Some(KeyValue::Switch(true)) && (periodic[1] || gravity[1] >= 0.0) {
        let message = "`domain.open_top` needs a floor and gravity that points down";
        let error = values.spot(&OPEN_TOP).error(MistakeKind::Contradiction, message.to_owned());
        errors.push(error.expecting("periodic = [true, false] and gravity = [0.0, -1.0], for example"));
    }
    let shaken =
        matches!(values.value(&FLOOR_AMPLITUDE), Some(KeyValue::Number(amplitude)) if amplitude > 0.0);
    if shaken && periodic[1] {
        let message = "`law.floor_amplitude` needs a floor, but the second side is periodic".to_owned();
        let error = values.spot(&FLOOR_AMPLITUDE).error(MistakeKind::Contradiction, message);
        errors.push(error.expecting("periodic = [true, false], for example"));
    }
    let heated = match values.value(&THERMAL_SIDE) {
        Some(KeyValue::Word(side)) => side,
        _ => String::new(),
    };
    if shaken && heated == "bottom" {
        let message =
            "the floor is both thermal (`law.thermal_side`) and moving (`law.floor_amplitude`)".to_owned();
        let error = values.spot(&FLOOR_AMPLITUDE).error(MistakeKind::Contradiction, message);
        errors.push(error.advising("remove one of the two"));
    }
    if let Some((axis, _)) = side(&heated).filter(|(axis, _)| periodic[*axis]) {
        let message = format!("`law.thermal_side` is \"{heated}\", but that side is periodic");
        let error = values.spot(&THERMAL_SIDE).error(MistakeKind::Contradiction, message);
        errors.push(error.advising(match axis {
            0 => "close the first side: periodic = [false, …]",
            _ => "close the second side: periodic = [true, false]",
        }));
    }
    errors
}

/// Axis of a named side; true for the upper one.
pub(super) fn side(name: &str) -> Option<(usize, bool)> {
    match name {
        "left" => Some((0, false)),
        "right" => Some((0, true)),
        "bottom" => Some((1, false)),
        "top" => Some((1, true)),
        _ => None,
    }
}
