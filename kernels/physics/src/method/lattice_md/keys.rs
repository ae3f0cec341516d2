//! Keys of this method: law, search, integrator, machine; and the rules between them.

use super::model::OnLongStep;
use super::neighbor_list::Rebuild;
use super::options::{EngineChoice, Inertia, IntegratorKind, ProgramVersion, SearchKind};
use super::wall_keys::WALL_KEYS;
use crate::method::pairwise::search::OnConflict;
use crate::scene::Fallback::{Is, Otherwise, Required};
use crate::scene::KeyValueKind::{Choice, Number, OneOf, Switch};
use crate::scene::NumberRange::{NonNegative, Positive, Within};
use crate::scene::keys::define_keys;
use crate::scene::{
    ARITHMETIC, DISC_RIVALS, DISCS, DURATION, HEADING, INSTRUCTIONS, Key, KeySet, KeyValue, MistakeKind,
    OUTPUT, PLANAR_DOMAIN, PRECISION, RenamedKey, STEP, STEPPED_RUN, SUMMED, SceneError, SceneValues,
    TARGETED, Use, Vocabulary, start_inconsistencies, too_many_steps,
};
use crate::words::Words;
use stripmine_kernels::law::granular::ContactArm;
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::sweep::lattice::Coordinates;

const ALWAYS: Use = None;
const GEAR: Use = Some((&INTEGRATOR, &["gear"]));
const ON_LATTICE: Use = Some((&SEARCH, &["auto", "lattice"]));
const ON_CELLS: Use = Some((&SEARCH, &["auto", "lattice", "neighbor-list"]));
const LISTS: Use = Some((&SEARCH, &["neighbor-list"]));
const PROGRAMS: Use = Some((&ENGINE, &["auto", "programs"]));

define_keys! {
    /// Law, search, machine and integrator.
    static OWN;
    LAW = "law" "kind", Choice(Spring::WORDS), "", Is("\"granular\""), ALWAYS,
        "The contact law: granular, Hertz contacts, viscous damping, Coulomb friction, rotation (BP93); or linear, the same with the force k_N ξ of a linear spring, as LAMMPS's gran/hooke.";
    STIFFNESS = "law" "stiffness", Number(Positive), "force/length^1.5", Required, ALWAYS,
        "Stiffness k_N of the Hertz force k_N ξ^1.5; of the linear force k_N ξ in force/length.";
    NORMAL_DAMPING = "law" "normal_damping", Number(NonNegative), "1/time", Is("0.0"), ALWAYS,
        "Normal damping γ_N; multiplied by the effective mass, which with a wall disc is the grain's own, twice that of two equal grains.";
    SHEAR_DAMPING = "law" "shear_damping", Number(NonNegative), "1/time", Is("0.0"), ALWAYS,
        "Tangential damping γ_S; multiplied by the effective mass, as normal_damping.";
    FRICTION = "law" "friction", Number(NonNegative), "", Is("0.0"), ALWAYS,
        "Coulomb friction coefficient μ.";
    COHESIONLESS = "law" "cohesionless", Switch, "", Is("true"), ALWAYS,
        "True if the normal force is never negative, so that separating discs do not attract; false keeps the damping of BP93, which attracts at the end of a contact.";
    INERTIA = "law" "inertia", Choice(Inertia::WORDS), "", Is("\"disc\""), ALWAYS,
        "Moment of inertia: disc ½ m R², sphere ⅖ m R².";
    CONTACT_ARM = "law" "contact_arm", Choice(ContactArm::WORDS), "", Is("\"radius\""), ALWAYS,
        "Distance of the tangential force from a centre: R, as in BP93; R − ξ/2, which reduces both the torque and the velocity of the surface; or, as in LAMMPS, R − ξ/2 for the torque and R for the velocity.";
    MAX_PENETRATION = "law" "max_penetration", Number(Within(0.5)), "", Is("0.1"), ALWAYS,
        "Penetration, as a fraction of the sum of the radii, up to which the lattice is exact; deeper contacts are counted.";
    STOP_PENETRATION = "law" "stop_penetration", Number(Within(1.0)), "", Is("0.3"), ALWAYS,
        "Penetration that stops the run.";

    SEARCH = "search" "by", Choice(SearchKind::WORDS), "", Is("\"auto\""), ALWAYS,
        "Search for contacts: on the exclusive lattice of BP93, in sectors that hold any number of discs (fast engine only), or by neighbour lists; auto uses the fastest that the scene allows.";
    CELL_EDGE = "search" "cell_edge", Number(Positive), "length", Otherwise("the fewest cells"), ON_CELLS,
        "Side d of a lattice cell; fitted to periodic sides. BP93 has d = R_max.";
    MASK = "search" "mask", OneOf(&[5, 7]), "", Otherwise("the smallest that works"), ON_CELLS,
        "Width of the neighbourhood in cells: 5×5 or 7×7.";
    ON_CONFLICT = "search" "on_conflict", Choice(OnConflict::WORDS), "", Is("\"stop\""), ON_LATTICE,
        "Action for a disc in an occupied lattice cell: the run stops, or the disc is kept in a list beside the lattice and counted (fast engine only; a cell_edge may then be too large for one disc a cell).";
    REBUILD = "search" "rebuild", Choice(Rebuild::WORDS), "", Is("\"cells\""), LISTS,
        "Construction of neighbour lists: by cells, or by all pairs as in BP93 (programs only).";
    SKIN = "search" "skin", Number(Positive), "length", Otherwise("0.3 R_max; for the fast engine half of the mean gap, from there to R_max"), LISTS,
        "Largest gap between the discs of a listed pair.";

    INTEGRATOR = "integrator" "kind", Choice(IntegratorKind::WORDS), "", Is("\"gear\""), ALWAYS,
        "Gear's predictor-corrector, or velocity Verlet, whose velocity-dependent forces use the velocity after half a kick.";
    VALUES = "integrator" "values", OneOf(&[4, 5, 6]), "", Is("4"), GEAR,
        "Number of derivatives, including the position; fewer are more stable with damping, more are more accurate without.";
    ON_LONG_STEP = "integrator" "on_long_step", Choice(OnLongStep::WORDS), "", Is("\"stop\""), ALWAYS,
        "Action for a disc that moves so far in a step that a contact deeper than law.max_penetration may be missed: the run stops, or the disc is counted.";

    ENGINE = "machine" "engine", Choice(EngineChoice::WORDS), "", Is("\"auto\""), ALWAYS,
        "Engine: fast visits each pair once and evaluates the law for contacts only; programs are BP93's vector programs over the whole lattice, equal up to rounding. auto is fast, unless a key of the programs is given.";
    TEXT = "machine" "text", Choice(ProgramVersion::WORDS), "", Is("\"ours\""), PROGRAMS,
        "Version of the programs: ours, or those printed in BP93, with its vectors Index, Test and contact_i, products instead of branches, and unscaled Gear derivatives.";
    EXECUTION = "machine" "execution", Choice(&["chained", "eager", "strip:N"]), "", Is("\"chained\""), PROGRAMS,
        "Execution of programs: chained in registers, one whole-lattice pass for each instruction, or in strips of N; all give the same bits.";
    COORDINATES = "machine" "coordinates", Choice(Coordinates::WORDS), "", Otherwise("cell-relative; absolute with text = \"printed\""), PROGRAMS,
        "Origin of the positions on the lattice in programs.";
}

/// Vocabulary of this method's scenes.
pub(super) static VOCABULARY: Vocabulary = Vocabulary {
    keys: KeySet {
        method: "lattice-md",
        groups: &[
            HEADING,
            PLANAR_DOMAIN,
            DISCS,
            OWN,
            WALL_KEYS,
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
        ],
    },
    rules: &[start_inconsistencies, too_many_steps, own_rules],
    presets: super::presets::PRESETS,
    renamed: RENAMED,
};

macro_rules! renamed {
    ($($old:literal => $new:literal,)*) => {
        &[$(RenamedKey { old: $old, new: $new }),*]
    };
}

/// Keys of format 1 that have been renamed.
const RENAMED: &[RenamedKey] = renamed! {
    "method.kind" => "[search] by = \"lattice\", \"sectors\" or \"neighbor-list\", whichever it was; [method] kind = \"lattice-md\"",
    "method.cell_edge" => "the same in [search]",
    "method.mask" => "the same in [search]",
    "method.on_conflict" => "the same in [search]",
    "method.rebuild" => "the same in [search]",
    "method.skin" => "the same in [search]",
    "method.execution" => "[machine] engine = \"fast\" where it was \"fast\"; else engine = \"programs\", and execution as it was",
    "method.coordinates" => "the same in [machine]",
    "method.precision" => "the same in [machine]",
    "method.instruction_set" => "the same in [machine]",
};

/// Contradictions between the keys of law, search and machine.
fn own_rules(values: &SceneValues) -> Vec<SceneError> {
    let mut errors = Vec::new();
    let [low, high] = [&MAX_PENETRATION, &STOP_PENETRATION];
    if let (Some(a), Some(b)) = (values.number(low), values.number(high))
        && a > b
    {
        let later = if values.is_given(low) { low } else { high };
        let message = format!(
            "`{}` = {a} is above `{}` = {b}; a run must warn before it stops",
            low.path(),
            high.path()
        );
        errors.push(values.spot(later).error(MistakeKind::Contradiction, message));
    }
    errors.extend(search_and_engine(values));
    if values.choice(&TEXT).as_deref() == Some(ProgramVersion::Printed.word()) {
        errors.extend(unsupported_by_paper(values));
    }
    errors
}

/// Rejects what the paper has no equation for.
fn unsupported_by_paper(values: &SceneValues) -> Vec<SceneError> {
    let demands: [(&Key, &str, &str); 6] = [
        (&PRECISION, "\"f64\"", "BP93 has one precision, that of a CRAY's 64-bit words"),
        (&COORDINATES, "\"absolute\"", "(5) and (6) subtract the positions themselves"),
        (&INTEGRATOR, "\"gear\"", "appendix A is Gear's predictor-corrector"),
        (&LAW, "\"granular\"", "(14) has the force of Hertz"),
        (&COHESIONLESS, "false", "(14) has no clamp"),
        (&CONTACT_ARM, "\"radius\"", "the arm of (12) is the radius"),
    ];
    let differs = |key: &Key, demanded: &str| match values.value(key) {
        Some(KeyValue::Word(word)) => format!("\"{word}\"") != demanded,
        Some(KeyValue::Switch(is_on)) => is_on.to_string() != demanded,
        _ => false,
    };
    let refused = demands.into_iter().filter(|(key, demanded, _)| differs(key, demanded));
    refused
        .map(|(key, demanded, why)| {
            let by = if values.is_given(key) { key } else { &TEXT };
            let message = format!("BP93's printed program does not support this: {why}");
            let error = values.spot(by).error(MistakeKind::Contradiction, message);
            error.expecting(format!("{} = {demanded}, or text = \"ours\"", key.path()))
        })
        .collect()
}

/// True if a scene requests programs: by name, or by a key that only they have.
pub(super) fn asks_for_programs(values: &SceneValues) -> bool {
    let is = |key: &Key, word: &str| values.choice(key).as_deref() == Some(word);
    is(&ENGINE, "programs")
        || is(&ENGINE, "auto")
            && (values.is_given(&TEXT)
                || values.is_given(&EXECUTION)
                || values.is_given(&COORDINATES)
                || is(&REBUILD, "all-pairs"))
}

/// Error of an engine and a search that do not work together.
fn search_and_engine(values: &SceneValues) -> Option<SceneError> {
    let is = |key: &Key, word: &str| values.choice(key).as_deref() == Some(word);
    if values.is_faulty(&ENGINE) || values.is_faulty(&SEARCH) {
        return None;
    }
    let given = |keys: &[&'static Key]| keys.iter().copied().find(|key| values.is_given(key));
    let refused = |key: &Key, message: &str| values.spot(key).error(MistakeKind::Contradiction, message);
    if asks_for_programs(values) {
        let by = given(&[&ENGINE, &TEXT, &EXECUTION, &COORDINATES, &REBUILD]).unwrap_or(&ENGINE);
        if is(&SEARCH, "sectors") {
            let message = "sectors have no vector programs: only the fast engine supports them";
            return Some(refused(by, message).expecting("engine = \"fast\", and no key of programs"));
        }
        let is_chained = values.choice(&EXECUTION).is_none_or(|execution| execution == "chained");
        if is(&SEARCH, "neighbor-list") && !is_chained {
            let message = "lists are traversed pair by pair, not as whole arrays";
            return Some(
                refused(&EXECUTION, message).expecting("execution = \"chained\", or search.by = \"lattice\""),
            );
        }
        if is(&ON_CONFLICT, "resolve") {
            let message = "BP93's programs hold one disc a cell: only the fast engine resolves conflicts";
            return Some(
                refused(&ON_CONFLICT, message).expecting("engine = \"fast\", and no key of programs"),
            );
        }
        None
    } else if is(&REBUILD, "all-pairs") {
        let error = refused(&REBUILD, "the fast engine builds its lists by cells");
        Some(error.advising("leave it out, or set engine = \"programs\""))
    } else {
        None
    }
}
