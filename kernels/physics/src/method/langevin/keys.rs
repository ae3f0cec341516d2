//! Keys of this method, and their constraints on each other.

use super::laws;
use super::options::{PairSearchKind, SchemeKind, SortKind};
use crate::scene::Fallback::{Is, Otherwise};
use crate::scene::KeyValueKind::{Choice, Number, Switch, Whole};
use crate::scene::NumberRange::{NonNegative, Positive};
use crate::scene::keys::define_keys;
use crate::scene::{
    ARITHMETIC, DISC_RIVALS, DISCS, DURATION, GRAVITY, HEADING, INSTRUCTIONS, KeySet, KeyValue, MistakeKind,
    OUTPUT, PERIODIC, PLANAR_DOMAIN, STEP, STEPPED_RUN, SUMMED, SceneError, SceneValues, TARGETED, Use,
    Vocabulary, start_inconsistencies, too_many_steps,
};
use crate::words::Words;

const ALWAYS: Use = None;
const LISTS: Use = Some((&SEARCH, &["auto", "neighbor-list"]));
const SECTORS: Use = Some((&SEARCH, &["auto", "sectors"]));

define_keys! {
    /// Bath, search and integrator.
    static OWN;
    DRAG = "law" "drag", Number(NonNegative), "mass/time", Is("1.0"), ALWAYS,
        "Friction γ of the bath.";
    BATH_TEMPERATURE = "law" "bath_temperature", Number(NonNegative), "energy", Is("1.0"), ALWAYS,
        "Temperature kT of the bath.";
    NOISE_SEED = "law" "noise_seed", Whole(0, u64::MAX), "", Otherwise("`particles.seed`; 1 where the start has none"), ALWAYS,
        "Seed of the bath's noise: runs of one start with different seeds are independent replicas. If the start is a file or a list, the noise also depends on the state: a run that continues from a frame draws new noise.";

    SEARCH = "search" "by", Choice(PairSearchKind::WORDS), "", Is("\"auto\""), ALWAYS,
        "Pair search: lattice, with cells of one particle each (for laws of short range, such as wca); sectors; or neighbor-list. auto takes the fastest that the scene allows.";
    PER_SIDE = "search" "sectors", Whole(3, 1_000_000), "", Otherwise("as is fastest"), SECTORS,
        "Sectors along each side; none may be narrower than the cut-off.";
    SORT = "search" "sort", Choice(SortKind::WORDS), "", Is("\"auto\""), SECTORS,
        "Condition for sorting particles by sector (counting sort): when-needed, once a quarter of them has changed sectors; or every-step, as in LAN17. auto is when-needed, the cheaper one in all measured cases. No result depends on it.";
    SKIN = "search" "skin", Number(Positive), "length", Otherwise("by the density"), LISTS,
        "Skin: neighbour lists reach this far beyond the cut-off.";

    INTEGRATOR = "integrator" "kind", Choice(SchemeKind::WORDS), "", Is("\"baoab\""), ALWAYS,
        "Integrator: baoab; stochastic, LAN17's velocity Verlet with friction and noise in the acceleration; or as-printed, the same with friction by the velocity of the previous step, as LAN17 prints it, which heats the system.";

    MOST_LOST = "run" "most_lost", Whole(0, 2_147_483_647), "", Is("0"), ALWAYS,
        "Number of particles that may be lost: thrown out of the box farther than a period, or to a position that is not finite. They are counted and listed, and the run continues without them.";
    LOSSES = "output" "losses", Switch, "", Is("true"), ALWAYS,
        "Writes each lost particle as a row of events.csv.";
}

/// Vocabulary of the scenes of this method.
pub(super) static VOCABULARY: Vocabulary = Vocabulary {
    keys: KeySet {
        method: "langevin",
        groups: &[
            HEADING,
            PLANAR_DOMAIN,
            DISCS,
            laws::KEYS,
            OWN,
            STEP,
            ARITHMETIC,
            INSTRUCTIONS,
            STEPPED_RUN,
            TARGETED,
            OUTPUT,
            SUMMED,
        ],
        rivals: &[DISC_RIVALS, DURATION],
        advice: &[
            ("integrator.step", "did you mean `integrator.dt`?"),
            ("integrator.timestep", "did you mean `integrator.dt`?"),
            ("integrator.time_step", "did you mean `integrator.dt`?"),
            ("law.friction", "the friction of the bath is `law.drag`"),
            ("law.gamma", "the friction of the bath is `law.drag`"),
            ("law.epsilon", "the depth of the pair potential is `law.strength`"),
            ("law.sigma", "the diameter σ is twice `particles.radius`"),
        ],
    },
    rules: &[start_inconsistencies, too_many_steps, own_rules],
    presets: super::presets::PRESETS,
    renamed: &[],
};

/// Rejects values that the method does not support.
fn own_rules(values: &SceneValues) -> Vec<SceneError> {
    let mut errors = vec![];
    let refused = |key, message: &str| values.spot(key).error(MistakeKind::Contradiction, message.to_owned());
    if matches!(values.value(&PERIODIC), Some(KeyValue::Switches(periodic)) if periodic != [true; 2]) {
        let error = refused(&PERIODIC, "`domain.periodic` is false, but the bath has no walls");
        errors.push(error.expecting("periodic = [true, true]"));
    }
    if matches!(values.value(&GRAVITY), Some(KeyValue::Pair(gravity)) if gravity != [0.0; 2]) {
        let error =
            refused(&GRAVITY, "`domain.gravity` is not 0, but nothing stops the fall across a periodic side");
        errors.push(error.expecting("gravity = [0.0, 0.0]"));
    }
    if values.is_given(&PER_SIDE) && values.is_given(&SKIN) {
        let error =
            refused(&PER_SIDE, "`search.sectors` and `search.skin` belong to two different pair searches");
        errors.push(error.advising("remove one of the two"));
    }
    errors
}
