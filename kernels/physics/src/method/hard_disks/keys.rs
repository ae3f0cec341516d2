//! The keys that are this method's own, and what they demand of each other.

use super::options::EngineChoice;
use crate::scene::Bounds::{AtMost, NonNegative, Positive};
use crate::scene::Fallback::{Is, Otherwise};
use crate::scene::Kind::{Choice, Number, Switch, Whole};
use crate::scene::keys::define_keys;
use crate::scene::{
    DISC_RIVALS, DISCS, GRAVITY, HEADING, INSTRUCTIONS, KeySet, OUTPUT, PERIODIC, PLANAR_DOMAIN, Reason,
    Rivals, SUMMED, SceneError, TARGETED, Use, Value, Values, Vocabulary, disagreements,
};
use crate::words::Words;

const ALWAYS: Use = None;
const HEATED: Use = Some((&THERMAL_SIDE, &["left", "right", "bottom", "top"]));
/// As many events as a run may have.
pub(super) const MOST_EVENTS: u64 = 1_000_000_000_000_000;

/// The masks, by the names that scenes give them.
pub const MASKS: &[&str] = &["auto", "min", "r3", "r4", "r5", "r6", "r7", "r8", "r9", "r10"];

/// Sides by the names that scenes give them.
pub(super) const THERMAL_SIDES: &[&str] = &["none", "left", "right", "bottom", "top"];

define_keys! {
    /// Collisions, search and duration.
    static OWN;
    RESTITUTION = "law" "restitution", Number(AtMost(1.0)), "", Is("1.0"), ALWAYS,
        "Relative normal speed of two discs after a collision over that before.";
    WALL_RESTITUTION = "law" "wall_restitution", Number(AtMost(1.0)), "", Is("1.0"), ALWAYS,
        "The same at sides that are not periodic.";
    CONTACT_DURATION = "law" "contact_duration", Number(NonNegative), "time", Is("0.0"), ALWAYS,
        "A collision that comes sooner than this after another one of either disc is elastic, against inelastic collapse (the TC model); 0 for none.";

    THERMAL_SIDE = "law" "thermal_side", Choice(THERMAL_SIDES), "", Is("\"none\""), ALWAYS,
        "A side that is not periodic and gives back every disc with a velocity of its own temperature.";
    WALL_TEMPERATURE = "law" "wall_temperature", Number(Positive), "mass·length²/time²", Is("1.0"), HEATED,
        "Its temperature kT.";
    NOISE_SEED = "law" "noise_seed", Whole(0, u64::MAX), "", Otherwise("`particles.seed`; 1 where the start has none"), HEATED,
        "Seed of the velocities that the thermal side gives. Where the start is a file or a list, they depend on the state as well: a run that continues from a frame has new ones.";
    FLOOR_AMPLITUDE = "law" "floor_amplitude", Number(NonNegative), "length", Is("0.0"), ALWAYS,
        "A: the floor, the lower end of the second side, is A (1 − cos 2π f t) above the end of the box; 0 for a floor at rest.";
    FLOOR_FREQUENCY = "law" "floor_frequency", Number(Positive), "1/time", Is("1.0"), ALWAYS,
        "f, the frequency of that.";
    OPEN_TOP = "domain" "open_top", Switch, "", Is("false"), ALWAYS,
        "Whether there is no ceiling: the upper end of the second side is open, and gravity points down.";

    ENGINE = "machine" "engine", Choice(EngineChoice::WORDS), "", Is("\"auto\""), ALWAYS,
        "How events are found, all to the same bits: fast, by lists of each disc's own; or the source's way (reference), masks over the exclusive grid. auto is fast, unless a mask is given or the box is too small for lists.";

    MASK = "search" "mask", Choice(MASKS), "", Is("\"auto\""), ALWAYS,
        "Cells around a disc in which it looks for partners: min is 5 × 5, r3 to r10 are the round masks of these radii. A larger one is filled less often; auto takes what costs least by the source's reckoning.";

    COLLISION_LOG = "output" "collisions", Switch, "", Is("false"), ALWAYS,
        "A row for each collision as events.csv: when, which discs, where, with what impulse, and the free times before it.";

    EVENTS = "run" "events", Whole(1, MOST_EVENTS), "", Otherwise("from `time`"), ALWAYS,
        "Collisions to do, of pairs and at walls.";
    TIME = "run" "time", Number(NonNegative), "time", Otherwise("from `events`"), ALWAYS,
        "Duration.";
    THERMO_EVERY = "run" "thermo_every", Number(NonNegative), "time", Is("1.0"), ALWAYS,
        "Time between rows of thermo.csv; 0 for none.";
    SNAPSHOT_EVERY = "run" "snapshot_every", Number(NonNegative), "time", Is("10.0"), ALWAYS,
        "Time between snapshots; 0 for none but the first and the last.";
    CHECKPOINT_EVERY = "run" "checkpoint_every", Number(NonNegative), "time", Otherwise("by the wall clock"), ALWAYS,
        "Time between checkpoints; 0 for one at the end only. Without it there is one in ten seconds. No result depends on it.";
}

/// A run lasts for a number of events, or for a time.
static DURATION: &[Rivals] = &[Rivals { keys: &[&EVENTS, &TIME], used: ALWAYS, needed: true }];

/// What the scenes of this method may say.
pub(super) static VOCABULARY: Vocabulary = Vocabulary {
    keys: KeySet {
        method: "hard-disks",
        groups: &[HEADING, PLANAR_DOMAIN, DISCS, OWN, INSTRUCTIONS, TARGETED, OUTPUT, SUMMED],
        rivals: &[DISC_RIVALS, DURATION],
        advice: &[
            (
                "law.temperature",
                "the start has `particles.temperature`, a thermal side `law.wall_temperature`",
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
            ("run.steps", "hard discs take no steps: give `run.events` or `run.time`"),
            (
                "law.bath_temperature",
                "hard discs have no bath: `particles.temperature` is that of the start, and a thermal side (`law.thermal_side`) keeps one",
            ),
            ("law.drag", "hard discs have no bath: they fly freely between collisions"),
            ("law.friction", "hard discs are smooth: collisions change no spin"),
            ("law.stiffness", "hard discs are rigid: `law.restitution` says what a collision takes"),
            ("machine.precision", "hard discs are always in double precision"),
        ],
    },
    rules: &[disagreements, own_rules],
    presets: super::presets::PRESETS,
    renamed: &[],
};

/// What belongs together.
fn own_rules(values: &Values) -> Vec<SceneError> {
    let mut errors = vec![];
    let periodic = match values.value(&PERIODIC) {
        Some(Value::Switches(periodic)) => periodic,
        _ => [true; 2],
    };
    let gravity = match values.value(&GRAVITY) {
        Some(Value::Pair(gravity)) => gravity,
        _ => [0.0; 2],
    };
    for axis in (0..2).filter(|&axis| periodic[axis] && gravity[axis] != 0.0) {
        let message = format!("gravity = {gravity:?}, but nothing stops the fall across a periodic side");
        let error = values.spot(&GRAVITY).error(Reason::Contradiction, message);
        errors.push(error.advising(match axis {
            0 => "close the first side: periodic = [false, …]",
            _ => "close the second side: periodic = [true, false]",
        }));
    }
    if values.value(&OPEN_TOP) == Some(Value::Switch(true)) && (periodic[1] || gravity[1] >= 0.0) {
        let message = "`domain.open_top` needs a floor and gravity that points down";
        let error = values.spot(&OPEN_TOP).error(Reason::Contradiction, message.to_owned());
        errors.push(error.expecting("periodic = [true, false] and gravity = [0.0, -1.0], for example"));
    }
    let shaken = matches!(values.value(&FLOOR_AMPLITUDE), Some(Value::Number(amplitude)) if amplitude > 0.0);
    if shaken && periodic[1] {
        let message = "`law.floor_amplitude` needs a floor, but the second side is periodic".to_owned();
        let error = values.spot(&FLOOR_AMPLITUDE).error(Reason::Contradiction, message);
        errors.push(error.expecting("periodic = [true, false], for example"));
    }
    let heated = match values.value(&THERMAL_SIDE) {
        Some(Value::Word(side)) => side,
        _ => String::new(),
    };
    if shaken && heated == "bottom" {
        let message =
            "the floor is thermal by `law.thermal_side`, and moves by `law.floor_amplitude`".to_owned();
        let error = values.spot(&FLOOR_AMPLITUDE).error(Reason::Contradiction, message);
        errors.push(error.advising("take one of the two"));
    }
    if let Some((axis, _)) = side(&heated).filter(|(axis, _)| periodic[*axis]) {
        let message = format!("`law.thermal_side` is \"{heated}\", but that side is periodic");
        let error = values.spot(&THERMAL_SIDE).error(Reason::Contradiction, message);
        errors.push(error.advising(match axis {
            0 => "close the first side: periodic = [false, …]",
            _ => "close the second side: periodic = [true, false]",
        }));
    }
    errors
}

/// A side by its name: axis, and whether it is the upper one.
pub(super) fn side(name: &str) -> Option<(usize, bool)> {
    match name {
        "left" => Some((0, false)),
        "right" => Some((0, true)),
        "bottom" => Some((1, false)),
        "top" => Some((1, true)),
        _ => None,
    }
}
