//! The keys that are this method's own, and what they demand of each other.

use crate::scene::Bounds::{AtMost, NonNegative};
use crate::scene::Fallback::{Is, Otherwise};
use crate::scene::Kind::{Choice, Number, Whole};
use crate::scene::keys::define_keys;
use crate::scene::{
    DISC_RIVALS, DISCS, GRAVITY, HEADING, KeySet, OUTPUT, PLANAR_DOMAIN, Reason, Rivals, SceneError, Use,
    Value, Values, Vocabulary, disagreements,
};

const ALWAYS: Use = None;
/// As many events as a run may have.
const MOST_EVENTS: u64 = 1_000_000_000_000_000;

/// The masks, by the names that scenes give them.
pub(super) const MASKS: &[&str] = &["auto", "min", "r3", "r4", "r5", "r6", "r7", "r8", "r9", "r10"];

define_keys! {
    /// Collisions, search and duration.
    static OWN;
    RESTITUTION = "law" "restitution", Number(AtMost(1.0)), "", Is("1.0"), ALWAYS,
        "Relative normal speed of two discs after a collision over that before.";
    WALL_RESTITUTION = "law" "wall_restitution", Number(AtMost(1.0)), "", Is("1.0"), ALWAYS,
        "The same at sides that are not periodic.";
    CONTACT_DURATION = "law" "contact_duration", Number(NonNegative), "time", Is("0.0"), ALWAYS,
        "A collision that comes sooner than this after another one of either disc is elastic, against inelastic collapse (the TC model); 0 for none.";

    MASK = "search" "mask", Choice(MASKS), "", Is("\"auto\""), ALWAYS,
        "Cells around a disc in which it looks for partners: min is 5 × 5, r3 to r10 are the round masks of these radii. A larger one is filled less often; auto takes what costs least by the source's reckoning.";

    EVENTS = "run" "events", Whole(1, MOST_EVENTS), "", Otherwise("from `time`"), ALWAYS,
        "Collisions to do, of pairs and at walls.";
    TIME = "run" "time", Number(NonNegative), "time", Otherwise("from `events`"), ALWAYS,
        "Duration.";
    THERMO_EVERY = "run" "thermo_every", Number(NonNegative), "time", Is("1.0"), ALWAYS,
        "Time between rows of thermo.csv; 0 for none.";
    SNAPSHOT_EVERY = "run" "snapshot_every", Number(NonNegative), "time", Is("10.0"), ALWAYS,
        "Time between snapshots; 0 for none but the first and the last.";
    CHECKPOINT_EVERY = "run" "checkpoint_every", Number(NonNegative), "time", Is("100.0"), ALWAYS,
        "Time between checkpoints; 0 for one at the end only.";
}

/// A run lasts for a number of events, or for a time.
static DURATION: &[Rivals] = &[Rivals { keys: &[&EVENTS, &TIME], used: ALWAYS, needed: true }];

/// What the scenes of this method may say.
pub(super) static VOCABULARY: Vocabulary = Vocabulary {
    keys: KeySet {
        method: "hard-disks",
        groups: &[HEADING, PLANAR_DOMAIN, DISCS, OWN, OUTPUT],
        rivals: &[DISC_RIVALS, DURATION],
    },
    rules: &[disagreements, own_rules],
    presets: super::presets::PRESETS,
    renamed: &[],
};

/// What this method has no events for.
fn own_rules(values: &Values) -> Vec<SceneError> {
    let mut errors = vec![];
    if let Some(Value::Pair(gravity)) = values.given(&GRAVITY)
        && *gravity != [0.0; 2]
    {
        let message = format!("gravity = {gravity:?}, but hard discs fly straight here");
        let error = values.spot(&GRAVITY).error(Reason::Contradiction, message);
        errors.push(
            error.expecting("gravity = [0.0, 0.0]").advising("method.kind = \"lattice-md\" has gravity"),
        );
    }
    errors
}
