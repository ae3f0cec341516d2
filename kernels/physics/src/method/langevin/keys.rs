//! The keys that are this method's own, and what they demand of each other.

use super::laws;
use super::options::{By, SchemeKind, SortKind};
use crate::scene::Bounds::{NonNegative, Positive};
use crate::scene::Fallback::{Is, Otherwise};
use crate::scene::Kind::{Choice, Number, Switch, Whole};
use crate::scene::keys::define_keys;
use crate::scene::{
    ARITHMETIC, DISC_RIVALS, DISCS, DURATION, GRAVITY, HEADING, INSTRUCTIONS, KeySet, OUTPUT, PERIODIC,
    PLANAR_DOMAIN, Reason, STEP, STEPPED_RUN, SUMMED, SceneError, TARGETED, Use, Value, Values, Vocabulary,
    disagreements, too_many_steps,
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
        "Seed of the bath's noise: runs of one start with different seeds are independent replicas. Where the start is a file or a list, the noise depends on the state as well: a run that continues from a frame has new noise.";

    SEARCH = "search" "by", Choice(By::WORDS), "", Is("\"auto\""), ALWAYS,
        "How pairs are found: on a lattice of cells that are one particle's each (for laws of short reach, such as wca), in sectors, or by lists of neighbours; auto takes the fastest that the scene allows.";
    PER_SIDE = "search" "sectors", Whole(3, 1_000_000), "", Otherwise("as is fastest"), SECTORS,
        "Sectors along each side; none may be narrower than the cut-off.";
    SORT = "search" "sort", Choice(SortKind::WORDS), "", Is("\"auto\""), SECTORS,
        "When particles are put in the order of their sectors, by a counting sort: when a quarter of them has changed sectors, or at every step, as the source; auto is when-needed, which was cheaper wherever both were measured. No result depends on it.";
    SKIN = "search" "skin", Number(Positive), "length", Otherwise("by the density"), LISTS,
        "Listed pairs are up to this much farther apart than the cut-off.";

    INTEGRATOR = "integrator" "kind", Choice(SchemeKind::WORDS), "", Is("\"baoab\""), ALWAYS,
        "baoab; or the source's velocity Verlet with friction and noise in the acceleration (stochastic), also with friction by the velocity of the step before, as printed, which heats.";

    MOST_LOST = "run" "most_lost", Whole(0, 2_147_483_647), "", Is("0"), ALWAYS,
        "The number of particles that may be lost: thrown out of the box farther than a period, or to no finite place. They are counted and listed, and the run goes on without them.";
    LOSSES = "output" "losses", Switch, "", Is("true"), ALWAYS,
        "A row for each particle lost, as events.csv.";
}

/// What the scenes of this method may say.
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
    rules: &[disagreements, too_many_steps, own_rules],
    presets: super::presets::PRESETS,
    renamed: &[],
};

/// What the method has no place for.
fn own_rules(values: &Values) -> Vec<SceneError> {
    let mut errors = vec![];
    let refused = |key, message: &str| values.spot(key).error(Reason::Contradiction, message.to_owned());
    if matches!(values.value(&PERIODIC), Some(Value::Switches(periodic)) if periodic != [true; 2]) {
        let error = refused(&PERIODIC, "`domain.periodic` is false, but the bath has no walls");
        errors.push(error.expecting("periodic = [true, true]"));
    }
    if matches!(values.value(&GRAVITY), Some(Value::Pair(gravity)) if gravity != [0.0; 2]) {
        let error =
            refused(&GRAVITY, "`domain.gravity` is not 0, but nothing stops the fall across a periodic side");
        errors.push(error.expecting("gravity = [0.0, 0.0]"));
    }
    if values.gives(&PER_SIDE) && values.gives(&SKIN) {
        let error = refused(&PER_SIDE, "`search.sectors` and `search.skin` are of two ways to find pairs");
        errors.push(error.advising("leave one out"));
    }
    errors
}
