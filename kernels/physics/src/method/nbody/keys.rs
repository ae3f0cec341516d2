//! Keys of this method, and their constraints on each other.

use super::options::{ArithmeticKind, ForceEngine};
use super::schemes::SchemeName;
use crate::io::FORMATS;
use crate::scene::Fallback::{Is, Otherwise, Required};
use crate::scene::KeyValueKind::{Choice, Number, Rows, Text, Whole};
use crate::scene::NumberRange::{AtMost, Finite, NonNegative, Positive, UpTo};
use crate::scene::keys::define_keys;
use crate::scene::{
    ARITHMETIC, DURATION, ExclusiveKeys, HEADING, INSTRUCTIONS, KeySet, KeyValue, MistakeKind, OUTPUT,
    STEPPED_RUN, SceneError, SceneValues, TARGETED, TIME, Use, Vocabulary, too_many_steps,
};
use crate::words::Words;

const ALWAYS: Use = None;
const GENERATORS: &[&str] = &["kepler", "figure-eight", "plummer", "sphere", "shell", "two-clusters", "list"];
const COUNTED: Use = Some((&GENERATE, &["plummer", "sphere", "shell", "two-clusters"]));
const DRAWN: Use = Some((&GENERATE, &["plummer", "sphere", "shell", "two-clusters", "file"]));
const SPHERES: Use = Some((&GENERATE, &["sphere", "shell"]));
const STIRRED: Use = Some((&GENERATE, &["sphere", "shell", "file"]));
const READ: Use = Some((&GENERATE, &["file"]));
const KEPLER: Use = Some((&GENERATE, &["kepler"]));
const CLUSTERS: Use = Some((&GENERATE, &["two-clusters"]));
const LISTED: Use = Some((&GENERATE, &["list"]));
const DAMPED: Use = Some((&INTEGRATOR, &["damped-euler"]));

const ADAPTIVE: Use = Some((&INTEGRATOR, &["ias15"]));

const PROGRAMS: Use = Some((&ENGINE, &["programs"]));
const SWEPT: Use = Some((&ENGINE, &["auto", "fast"]));

define_keys! {
    /// Bodies, softening, integrator and machine.
    static OWN;
    GENERATE = "particles" "generate", Choice(GENERATORS), "", Otherwise("read `file`"), ALWAYS,
        "Initial state: two bodies on an ellipse of semi-major axis 1, at the nearest point; three on the figure of eight; Plummer's sphere of scale 1; a uniform sphere or shell of radius 1; two Plummer spheres; or a list. Unless listed, the total mass is 1, the total momentum is 0, and velocities due to gravity scale with √G.";
    FILE = "particles" "file", Text, "", Otherwise("generated"), ALWAYS,
        "Start file: XYZ (extended or plain), GSD, a LAMMPS data file or dump, or .sph; relative to the scene file. `mass` and `virial` supply what the file lacks.",
        implies (&GENERATE, "file");
    FRAME = "particles" "frame", Whole(0, u64::MAX), "", Otherwise("the last one"), READ,
        "Number of the frame of the start file, from 0.";
    MASS = "particles" "mass", Number(Positive), "mass", Otherwise("those of `file`"), READ,
        "Mass of every body, where the file has no masses.";
    COUNT = "particles" "count", Whole(2, 1_000_000), "", Is("1024"), COUNTED,
        "Number of bodies.";
    SEED = "particles" "seed", Whole(0, u64::MAX), "", Is("1"), DRAWN,
        "Seed of positions and velocities.";
    VIRIAL = "particles" "virial", Number(NonNegative), "", Otherwise("0 for spheres; velocities of `file`"), STIRRED,
        "Ratio of the kinetic energy of random velocities to the magnitude of the potential energy: 0.5 is equilibrium, 0 is cold. With `file`: where the file has no velocities.";
    EXPANSION = "particles" "expansion", Number(Finite), "1/time", Is("0.0"), SPHERES,
        "Outward velocity over the distance from the centre.";
    ECCENTRICITY = "particles" "eccentricity", Number(UpTo(1.0)), "", Is("0.5"), KEPLER,
        "Eccentricity of the ellipse.";
    MASS_RATIO = "particles" "mass_ratio", Number(AtMost(1.0)), "", Is("1.0"), KEPLER,
        "Ratio of the second body's mass to the first body's.";
    SEPARATION = "particles" "separation", Number(Positive), "length", Is("8.0"), CLUSTERS,
        "Distance of the centres of the two spheres.";
    APPROACH = "particles" "approach", Number(Finite), "length/time", Is("0.3"), CLUSTERS,
        "Speed of approach of the two spheres along the line between them, with half that speed across it.";
    BODIES = "particles" "bodies", Rows(7), "", Required, LISTED,
        "List of bodies, a row each: mass, position along x, y, z (length), velocity along x, y, z (length/time); ids are 1, 2, …";

    SOFTENING = "law" "softening", Number(NonNegative), "length", Is("0.0"), ALWAYS,
        "Softening ε: the attraction of a unit mass is G d/(d² + ε²)^{3/2}.";

    CONSTANT = "law" "gravitational_constant", Number(Positive), "length³/(mass·time²)", Otherwise("6.6743e-11 where `units` is \"SI\", else 1"), ALWAYS,
        "Gravitational constant G: two bodies attract each other with G m₁ m₂/d². Masses may be given as G m instead, with a constant of 1.";

    INTEGRATOR = "integrator" "kind", Choice(SchemeName::WORDS), "", Is("\"leapfrog\""), ALWAYS,
        "Integrator: damped-euler is PWP's; euler and euler-with-half are there to show how they fail; leapfrog, yoshida-4, -6 and -8 are symplectic; runge-kutta-4, hermite-4 and gear-6 (started exactly) drift in energy; ias15 (order 15) adapts its steps to encounters and conserves energy to rounding.";
    DAMPING = "integrator" "damping", Number(AtMost(1.0)), "", Is("1.0"), DAMPED,
        "Factor of the velocities at every step: a friction −ln(damping)/dt.";

    TOLERANCE = "integrator" "tolerance", Number(AtMost(1e-3)), "", Is("1e-9"), ADAPTIVE,
        "Tolerance of a step: largest ratio of the last coefficient of the accelerations in the step to the acceleration. At 1e-9 the error of a step is below rounding.";
    STEP_LENGTH = "integrator" "dt", Number(Positive), "time", Otherwise("required; with ias15 a thousandth of `run.time`"), ALWAYS,
        "Time step. With ias15, whose steps adapt, it is the interval in which `run.steps`, rows and frames are counted; no result at a time depends on it.";

    ENGINE = "machine" "engine", Choice(ForceEngine::WORDS), "", Is("\"auto\""), ALWAYS,
        "Force engine: fast visits each pair once; programs uses whole-array operations at every cyclic shift; reference is the direct sum, in double precision. auto takes reference for up to a dozen bodies, and fast for more bodies, single precision or estimated roots.";
    EXECUTION = "machine" "execution", Choice(&["chained", "eager", "strip:N"]), "", Is("\"chained\""), PROGRAMS,
        "Execution of programs: chained, register by register; eager, one pass over all bodies per instruction; or strip:N, in strips of N. All give the same bits.";
    ROOTS = "machine" "arithmetic", Choice(ArithmeticKind::WORDS), "", Is("\"exact\""), SWEPT,
        "Arithmetic: exact rounds every operation, to the same bits on every instruction set; estimated fuses products and sums and corrects the processor's estimate of inverse roots; raw omits the correction, to show its effect.";
}

static START: &[ExclusiveKeys] =
    &[ExclusiveKeys { keys: &[&GENERATE, &FILE], used: ALWAYS, needed: true, with: None }];

/// Vocabulary of the scenes of this method.
pub(super) static VOCABULARY: Vocabulary = Vocabulary {
    keys: KeySet {
        method: "nbody",
        groups: &[HEADING, OWN, ARITHMETIC, INSTRUCTIONS, STEPPED_RUN, TARGETED, OUTPUT],
        rivals: &[START, DURATION],
        advice: &[
            ("integrator.step", "did you mean `integrator.dt`?"),
            ("integrator.timestep", "did you mean `integrator.dt`?"),
            ("integrator.time_step", "did you mean `integrator.dt`?"),
            ("law.G", "did you mean `law.gravitational_constant`?"),
            ("law.g", "did you mean `law.gravitational_constant`?"),
            ("law.epsilon", "did you mean `law.softening`?"),
            ("domain.sides", "bodies are in open space: there is no box and no gravity but their own"),
            ("domain.gravity", "bodies are in open space: there is no box and no gravity but their own"),
            ("domain.periodic", "bodies are in open space: there is no box and no gravity but their own"),
            ("particles.radius", "bodies are points: their only length is `law.softening`"),
            (
                "particles.temperature",
                "bodies have no temperature: `particles.virial` is the ratio of kinetic to potential energy of a sphere",
            ),
            ("particles.positions", "list bodies in `particles.bodies`: mass, position and velocity of each"),
        ],
    },
    rules: &[too_many_steps, own_rules],
    presets: super::presets::PRESETS,
    renamed: &[],
};

/// Smallest tolerance: below, rounding of the accelerations decides the step.
const FINEST: f64 = 1e-12;

/// Error for a scene without a step, or without the time from which steps that adapt take their interval of output.
fn missing_step(values: &SceneValues) -> Option<SceneError> {
    let is_adaptive = values.choice(&INTEGRATOR).is_some_and(|kind| kind == SchemeName::Ias15.word());
    if let Some(tolerance) = values.number(&TOLERANCE).filter(|tolerance| is_adaptive && *tolerance < FINEST)
    {
        let message =
            format!("`{}` = {tolerance:e} is below the rounding of accelerations", TOLERANCE.path());
        let error = values.spot(&TOLERANCE).error(MistakeKind::Range, message);
        return Some(error.expecting(format!("{FINEST:e} to 1e-3; 1e-9 is accurate to rounding")));
    }
    if values.is_given(&STEP_LENGTH)
        || values.is_faulty(&STEP_LENGTH)
        || is_adaptive && values.is_given(&TIME)
    {
        return None;
    }
    let error = values.spot(&STEP_LENGTH).error(MistakeKind::Missing, "`integrator.dt` is missing");
    Some(match is_adaptive {
        true => {
            error.expecting("run.time, or the interval integrator.dt in which run.steps are counted (time)")
        }
        false => error
            .expecting(STEP_LENGTH.expected())
            .advising("or set integrator.kind = \"ias15\", which needs none"),
    })
}

/// Checks the keys that depend on each other.
fn own_rules(values: &SceneValues) -> Vec<SceneError> {
    let mut errors: Vec<SceneError> = missing_step(values).into_iter().collect();
    let of_boxes = FORMATS.iter().zip(OUTPUT).filter(|(format, _)| format.needs_box);
    for key in of_boxes.map(|(_, key)| key) {
        if values.value(key) == Some(KeyValue::Switch(true)) {
            let error = values.spot(key).error(
                MistakeKind::Contradiction,
                format!("`{}` needs a box, but bodies have none", key.path()),
            );
            errors.push(error.advising(format!("remove it: {} has the same data", FORMATS[0].file)));
        }
    }
    errors
}
