//! Every key of a scene file, once: parsing, defaults, checks and documentation come from this list.

use super::keys::Bounds::{Finite, NonNegative, Positive, UpTo, Within};
use super::keys::Fallback::{Is, Otherwise, Required};
use super::keys::Kind::{Choice, Number, Numbers, OneOf, Pair, Pairs, Switch, Switches, Text, Whole};
use super::keys::{Key, Selector, Use};

/// The sections, in the order in which they are written, with what they hold.
pub const SECTIONS: [(&str, &str); 7] = [
    ("domain", "the box and the gravity in it"),
    ("particles", "the discs at the start, generated or read"),
    ("law", "what discs in contact do to each other"),
    ("method", "how contacts are found and the arithmetic is done; no choice changes the physics"),
    ("integrator", "how motion follows from forces"),
    ("run", "how long, and how often something is written"),
    ("output", "which files are written"),
];

const ALWAYS: Use = None;
const GENERATED: Use = Some((Selector::Start, &["random", "hexagonal", "pipe", "box", "list"]));
const DRAWN: Use = Some((Selector::Start, &["random", "hexagonal", "pipe", "box"]));
const PLACED: Use = Some((Selector::Start, &["random", "pipe", "box"]));
const SIDED: Use = Some((Selector::Start, &["random", "pipe", "box", "list", "file"]));
const WALLED: Use = Some((Selector::Start, &["pipe", "box", "list"]));
const LINED: Use = Some((Selector::Start, &["pipe", "box"]));
const HOLDING: Use = Some((Selector::Start, &["pipe", "box", "list", "file"]));
const PIPE: Use = Some((Selector::Start, &["pipe"]));
const BOX: Use = Some((Selector::Start, &["box"]));
const LIST: Use = Some((Selector::Start, &["list"]));
const OSCILLATING: Use = Some((Selector::WallMotion, &["oscillating"]));
const GEAR: Use = Some((Selector::Integrator, &["gear"]));
const EXCLUSIVE: Use = Some((Selector::Method, &["lattice"]));
const LISTS: Use = Some((Selector::Method, &["neighbor-list"]));

macro_rules! define_keys {
    ($($constant:ident = $section:literal $name:literal, $kind:expr, $unit:literal, $fallback:expr, $used:expr, $doc:literal;)*) => {
        $(
            #[doc = $doc]
            pub static $constant: Key = Key {
                section: $section, name: $name, kind: $kind, unit: $unit, fallback: $fallback, used: $used, doc: $doc,
            };
        )*

        /// Every key, in the order in which they are written.
        pub static KEYS: &[&Key] = &[$(&$constant),*];
    };
}

define_keys! {
    FORMAT = "" "format", OneOf(&[1]), "", Required, ALWAYS,
        "Version of the scene format.";
    UNITS = "" "units", Text, "", Required, ALWAYS,
        "The unit system, stated once: \"SI\", \"reduced\", … A label; nothing is converted.";

    ORIGIN = "domain" "origin", Pair(Finite), "length", Is("[0.0, 0.0]"), ALWAYS,
        "Lower left corner of the box.";
    SIDES = "domain" "sides", Pair(Positive), "length", Required, SIDED,
        "Sides of the box; a hexagonal start sets them itself, from its packing fraction.";
    PERIODIC = "domain" "periodic", Switches, "", Is("[true, true]"), ALWAYS,
        "Which sides are periodic; a disc that leaves through another one stops the run.";
    GRAVITY = "domain" "gravity", Pair(Finite), "length/time²", Is("[0.0, 0.0]"), ALWAYS,
        "Acceleration of gravity.";

    GENERATE = "particles" "generate", Choice(&["random", "hexagonal", "pipe", "box", "list"]), "",
        Otherwise("read `file`"), ALWAYS,
        "How discs are made: at random without overlap; on a shaken hexagonal lattice; in a pipe along x between two rows of wall discs; above a floor of wall discs; as listed.";
    FILE = "particles" "file", Text, "", Otherwise("generated"), ALWAYS,
        "Start file, extended XYZ with id, pos, velo, radius, mass, omega; relative to the scene file.";
    SEED = "particles" "seed", Whole(0, u64::MAX), "", Is("1"), DRAWN,
        "Seed of radii, positions and velocities.";
    COUNT = "particles" "count", Whole(1, 2_147_483_647), "", Otherwise("from `packing_fraction`"), DRAWN,
        "Number of grains; a hexagonal lattice may take a few more, to close.";
    PACKING_FRACTION = "particles" "packing_fraction", Number(Within(0.907)), "", Otherwise("from `count`"), DRAWN,
        "N π radius² over the area that is open to grains: the box, the clear channel of a pipe, the fill height of a box.";
    RADIUS = "particles" "radius", Number(Positive), "length", Required, GENERATED,
        "Radius of a grain; with a spread, the mean.";
    RADIUS_SPREAD = "particles" "radius_spread", Number(UpTo(1.0)), "", Is("0.0"), PLACED,
        "Standard deviation of the Gaussian radii, relative to `radius`.";
    RADIUS_CUT = "particles" "radius_cut", Number(UpTo(1.0)), "", Otherwise("2 `radius_spread`, at most 0.12"), PLACED,
        "Largest deviation of a radius, relative to `radius`.";
    MASS = "particles" "mass", Number(Positive), "mass", Required, GENERATED,
        "Mass of a disc of radius `radius`; others have it times (their radius/`radius`)².";
    TEMPERATURE = "particles" "temperature", Number(NonNegative), "mass·length²/time²", Otherwise("see `speed`"), DRAWN,
        "kT of Maxwell velocities; no spin.";
    SPEED = "particles" "speed", Number(NonNegative), "length/time", Otherwise("at rest"), DRAWN,
        "Standard deviation of each component of Gaussian velocities; no spin.";
    CLEAR_WIDTH = "particles" "clear_width", Number(Positive), "length", Required, PIPE,
        "Width of the pipe between the surfaces of its wall discs; its axis is the middle of the box.";
    FILL_HEIGHT = "particles" "fill_height", Number(Positive), "length", Required, BOX,
        "Height above the floor up to which grains are placed.";
    POSITIONS = "particles" "positions", Pairs, "length", Required, LIST,
        "Centres of the grains; ids are 1, 2, …";
    VELOCITIES = "particles" "velocities", Pairs, "length/time", Otherwise("at rest"), LIST,
        "Velocities of the grains.";
    OMEGAS = "particles" "omegas", Numbers(Finite), "1/time", Otherwise("no spin"), LIST,
        "Angular velocities of the grains, counter-clockwise.";
    RADII = "particles" "radii", Numbers(Positive), "length", Otherwise("all `radius`"), LIST,
        "Radii of the grains.";
    WALL_POSITIONS = "particles" "wall_positions", Pairs, "length", Otherwise("no walls"), LIST,
        "Centres of wall discs; nothing moves a wall disc but wall_motion: its mass in a contact is infinite.";
    WALL_RADIUS = "particles" "wall_radius", Number(Positive), "length", Otherwise("0.9 `radius`"), WALLED,
        "Radius of the wall discs.";
    WALL_SPACING = "particles" "wall_spacing", Number(Positive), "length", Otherwise("3 `wall_radius`"), LINED,
        "Distance of the centres of neighbouring wall discs; the nearest that divides the length is taken.";
    WALL_MOTION = "particles" "wall_motion", Choice(&["fixed", "oscillating"]), "", Is("\"fixed\""), HOLDING,
        "Motion of the wall discs, all together.";
    WALL_AMPLITUDE = "particles" "wall_amplitude", Pair(Finite), "length", Required, OSCILLATING,
        "Amplitude a of the walls' motion r(0) + a sin(2π f t).";
    WALL_FREQUENCY = "particles" "wall_frequency", Number(Positive), "1/time", Required, OSCILLATING,
        "Frequency f of the walls' motion.";

    LAW = "law" "kind", Choice(&["granular"]), "", Is("\"granular\""), ALWAYS,
        "The contact law: Hertz contacts, viscous damping, Coulomb friction, rotation (BP93).";
    STIFFNESS = "law" "stiffness", Number(Positive), "force/length^1.5", Required, ALWAYS,
        "Hertz stiffness k_N.";
    NORMAL_DAMPING = "law" "normal_damping", Number(NonNegative), "1/time", Is("0.0"), ALWAYS,
        "Normal damping γ_N; multiplied by the effective mass, which with a wall disc is the grain's own, twice that of two equal grains.";
    SHEAR_DAMPING = "law" "shear_damping", Number(NonNegative), "1/time", Is("0.0"), ALWAYS,
        "Tangential damping γ_S; multiplied by the effective mass, as normal_damping.";
    FRICTION = "law" "friction", Number(NonNegative), "", Is("0.0"), ALWAYS,
        "Coulomb friction coefficient μ.";
    COHESIONLESS = "law" "cohesionless", Switch, "", Is("true"), ALWAYS,
        "Whether the normal force is never negative, so that separating discs do not pull; false leaves the damping as the source has it, which pulls at the end of a contact.";
    INERTIA = "law" "inertia", Choice(&["disc", "sphere"]), "", Is("\"disc\""), ALWAYS,
        "Moment of inertia: disc ½ m R², sphere ⅖ m R².";
    CONTACT_ARM = "law" "contact_arm", Choice(&["radius", "overlap", "lammps"]), "", Is("\"radius\""), ALWAYS,
        "Where the tangential force acts, seen from a centre: at R, as the source has it; at R − ξ/2, which shortens both the torque and the velocity of the surface; or, as in LAMMPS, the torque at R − ξ/2 and the velocity at R.";
    MAX_PENETRATION = "law" "max_penetration", Number(Within(0.5)), "", Is("0.1"), ALWAYS,
        "Penetration, as a fraction of the sum of the radii, up to which the lattice is exact; deeper contacts are counted.";
    STOP_PENETRATION = "law" "stop_penetration", Number(Within(1.0)), "", Is("0.3"), ALWAYS,
        "Penetration that stops the run.";

    METHOD = "method" "kind", Choice(&["lattice", "sectors", "neighbor-list"]), "", Is("\"lattice\""), ALWAYS,
        "How contacts are found: on the exclusive lattice of BP93, in sectors that hold any number of discs (with execution = \"fast\" only), or by lists of neighbours.";
    CELL_EDGE = "method" "cell_edge", Number(Positive), "length", Otherwise("the fewest cells"), ALWAYS,
        "Side d of a lattice cell; fitted to periodic sides. The source has d = R_max.";
    MASK = "method" "mask", OneOf(&[5, 7]), "", Otherwise("the smallest that serves"), ALWAYS,
        "Width of the neighbourhood in cells: 5×5 or 7×7.";
    ON_CONFLICT = "method" "on_conflict", Choice(&["stop", "resolve"]), "", Is("\"stop\""), EXCLUSIVE,
        "What becomes of a disc whose lattice cell is another's: the run stops, or the disc is kept in a list beside the lattice and counted (with execution = \"fast\" only; a cell_edge may then be too large for one disc a cell).";
    COORDINATES = "method" "coordinates", Choice(&["cell-relative", "absolute"]), "", Is("\"cell-relative\""), ALWAYS,
        "What positions on the lattice are measured from.";
    PRECISION = "method" "precision", Choice(&["f64", "f32", "mixed"]), "", Is("\"f64\""), ALWAYS,
        "Precision; mixed keeps the state in f64 and computes forces in f32.";
    EXECUTION = "method" "execution", Choice(&["chained", "eager", "strip:N", "fast"]), "", Is("\"chained\""), ALWAYS,
        "How a step is executed: instructions register by register, one whole-lattice pass each, or by strips of N, all to the same bits; or fast, each pair once and the law for contacts only, with cell-relative coordinates, equal but for rounding.";
    INSTRUCTION_SET = "method" "instruction_set", Choice(&["auto", "scalar", "wide", "neon", "avx2", "avx512"]), "",
        Is("\"auto\""), ALWAYS,
        "The SIMD instructions; auto takes the widest that the processor has.";
    REBUILD = "method" "rebuild", Choice(&["cells", "all-pairs"]), "", Is("\"cells\""), LISTS,
        "How neighbour lists are made: by cells, or by all pairs as in the source.";
    SKIN = "method" "skin", Number(Positive), "length", Otherwise("0.3 R_max; with execution = \"fast\" half of the mean gap, from there to R_max"), LISTS,
        "Listed pairs are up to this far from contact.";

    INTEGRATOR = "integrator" "kind", Choice(&["gear", "velocity-verlet"]), "", Is("\"gear\""), ALWAYS,
        "Gear's predictor-corrector, or velocity Verlet, whose velocity-dependent forces are those after half a kick.";
    VALUES = "integrator" "values", OneOf(&[4, 5, 6]), "", Is("4"), GEAR,
        "Derivatives carried, from the position on; fewer are stabler with damping, more are more accurate without.";
    DT = "integrator" "dt", Number(Positive), "time", Required, ALWAYS,
        "Time step.";
    ON_LONG_STEP = "integrator" "on_long_step", Choice(&["stop", "count"]), "", Is("\"stop\""), ALWAYS,
        "What becomes of a disc that moves so far in a step that a contact deeper than law.max_penetration may pass unseen: the run stops, or the disc is counted.";

    STEPS = "run" "steps", Whole(0, 1_000_000_000_000), "", Otherwise("from `time`"), ALWAYS,
        "Number of steps.";
    TIME = "run" "time", Number(NonNegative), "time", Otherwise("from `steps`"), ALWAYS,
        "Duration; the nearest whole number of steps.";
    THERMO_EVERY = "run" "thermo_every", Whole(0, 1_000_000_000_000), "steps", Is("100"), ALWAYS,
        "Steps between rows of thermo.csv; 0 for none.";
    SNAPSHOT_EVERY = "run" "snapshot_every", Whole(0, 1_000_000_000_000), "steps", Is("1000"), ALWAYS,
        "Steps between snapshots; 0 for none but the first and the last.";
    CHECKPOINT_EVERY = "run" "checkpoint_every", Whole(0, 1_000_000_000_000), "steps", Is("10000"), ALWAYS,
        "Steps between checkpoints; 0 for one at the end only.";

    TRAJECTORY = "output" "trajectory", Switch, "", Is("true"), ALWAYS,
        "Snapshots as trajectory.xyz, extended XYZ.";
    LAMMPS_DUMP = "output" "lammps_dump", Switch, "", Is("false"), ALWAYS,
        "Snapshots as a LAMMPS dump.";
    LAMMPS_DATA = "output" "lammps_data", Switch, "", Is("false"), ALWAYS,
        "The final state as a LAMMPS data file.";
}

/// Keys of which at most one may be given.
pub(super) struct Rivals {
    /// The keys.
    pub(super) keys: &'static [&'static Key],
    /// Where they are rivals.
    pub(super) used: Use,
    /// Whether one must be given.
    pub(super) needed: bool,
}

/// Every such choice.
pub(super) static RIVALS: [Rivals; 4] = [
    Rivals { keys: &[&GENERATE, &FILE], used: ALWAYS, needed: true },
    Rivals { keys: &[&COUNT, &PACKING_FRACTION], used: PLACED, needed: true },
    Rivals { keys: &[&TEMPERATURE, &SPEED], used: ALWAYS, needed: false },
    Rivals { keys: &[&STEPS, &TIME], used: ALWAYS, needed: true },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::keys::Fallback;

    #[test]
    fn every_key_is_documented_and_its_default_is_a_value_of_its_type() {
        for key in KEYS {
            assert!(key.doc.ends_with(['.', '…']) && key.doc.len() > 8, "{}", key.path());
            assert!(key.section.is_empty() || SECTIONS.iter().any(|(name, _)| *name == key.section));
            assert_eq!(KEYS.iter().filter(|other| other.path() == key.path()).count(), 1, "{}", key.path());
            if let Fallback::Is(text) = key.fallback {
                let value = toml::de::DeValue::parse(text).unwrap();
                let Ok(value) = key.kind.read(&value) else { panic!("default of {}", key.path()) };
                assert_eq!(value.to_toml(), text, "{}", key.path());
            }
        }
    }

    /// A key that measures something says in what.
    #[test]
    fn dimensional_keys_have_units() {
        let pure = [
            "count",
            "packing_fraction",
            "radius_spread",
            "radius_cut",
            "friction",
            "max_penetration",
            "stop_penetration",
        ];
        for key in KEYS {
            let measures = matches!(key.kind, Number(_) | Pair(_) | Pairs | Numbers(_));
            assert_eq!(
                measures && !pure.contains(&key.name),
                measures && !key.unit.is_empty(),
                "{}",
                key.path()
            );
        }
    }
}
