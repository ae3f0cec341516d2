//! Keys of the initial discs.

use super::key_set::ExclusiveKeys;
use super::keys::Fallback::{Is, Otherwise, Required};
use super::keys::KeyValueKind::{Choice, Number, Numbers, Pair, Pairs, Text, Whole};
use super::keys::NumberRange::{Finite, NonNegative, Positive, UpTo, Within};
use super::keys::{Use, define_keys};
use crate::words::{Words, define_words};

const ALWAYS: Use = None;
const GENERATED: Use =
    Some((&GENERATE, &["random", "compressed", "mesh", "hexagonal", "pipe", "box", "list"]));
const DRAWN: Use = Some((&GENERATE, &["random", "compressed", "mesh", "hexagonal", "pipe", "box"]));
const PLACED: Use = Some((&GENERATE, &["random", "compressed", "pipe", "box"]));
pub(super) const SIDED: Use =
    Some((&GENERATE, &["random", "compressed", "mesh", "pipe", "box", "list", "file"]));
const WALLED: Use = Some((&GENERATE, &["pipe", "box", "list"]));
const LINED: Use = Some((&GENERATE, &["pipe", "box"]));
const HOLDING: Use = Some((&GENERATE, &["pipe", "box", "list", "file"]));
const PIPE: Use = Some((&GENERATE, &["pipe"]));
const MESH: Use = Some((&GENERATE, &["mesh"]));
const BOX: Use = Some((&GENERATE, &["box"]));
const LIST: Use = Some((&GENERATE, &["list"]));
const OSCILLATING: Use = Some((&WALL_MOTION, &["oscillating"]));

define_keys! {
    /// Discs of a scene in the plane.
    pub static DISCS;
    GENERATE = "particles" "generate", Choice(&["random", "compressed", "mesh", "hexagonal", "pipe", "box", "list"]), "",
        Otherwise("read `file`"), ALWAYS,
        "Initial placement. random: without overlap. compressed: placed small and grown while they move and collide, for packing fractions up to 0.88. mesh: random sites of a square mesh. hexagonal: a hexagonal lattice with random shifts. pipe: in a pipe along x between two rows of wall discs. box: above a floor of wall discs. list: as listed.";
    FILE = "particles" "file", Text, "", Otherwise("generated"), ALWAYS,
        "Start file, extended XYZ with id, pos, velo, radius, mass, omega; relative to the scene file.",
        implies (&GENERATE, "file");
    SEED = "particles" "seed", Whole(0, u64::MAX), "", Is("1"), DRAWN,
        "Seed of radii, positions and velocities.";
    COUNT = "particles" "count", Whole(1, 268_435_455), "", Otherwise("from `packing_fraction`"), DRAWN,
        "Number of grains; a hexagonal lattice may have a few more to fill its last row.";
    PACKING_FRACTION = "particles" "packing_fraction", Number(Within(0.907)), "", Otherwise("from `count`"), DRAWN,
        "N π radius² over the area open to grains: the box, the clear channel of a pipe, or the box up to its fill height.";
    RADIUS = "particles" "radius", Number(Positive), "length", Required, GENERATED,
        "Radius of a grain; with a spread, the mean.";
    SECOND_RADIUS = "particles" "second_radius", Number(Positive), "length", Otherwise("`radius`"), PLACED,
        "Mean radius of a second kind of discs.";
    SECOND_SHARE = "particles" "second_share", Number(UpTo(1.0)), "", Is("0.0"), PLACED,
        "Fraction of the discs that are of the second kind, from 0 to 1.";
    RADIUS_SPREAD = "particles" "radius_spread", Number(UpTo(1.0)), "", Is("0.0"), PLACED,
        "Standard deviation of the Gaussian radii, relative to `radius`.";
    RADIUS_CUT = "particles" "radius_cut", Number(UpTo(1.0)), "", Otherwise("2 `radius_spread`, at most 0.12"), PLACED,
        "Largest deviation of a radius, relative to `radius`.";
    MASS = "particles" "mass", Number(Positive), "mass", Required, GENERATED,
        "Mass of a disc of radius `radius`; masses scale as (their radius/`radius`)².";
    TEMPERATURE = "particles" "temperature", Number(NonNegative), "mass·length²/time²", Otherwise("see `speed`"), DRAWN,
        "kT of Maxwell velocities; no spin.";
    SPEED = "particles" "speed", Number(NonNegative), "length/time", Otherwise("at rest"), DRAWN,
        "Standard deviation of each component of Gaussian velocities; no spin.";
    CLEAR_WIDTH = "particles" "clear_width", Number(Positive), "length", Required, PIPE,
        "Width of the pipe between the surfaces of its wall discs; its axis is the middle of the box.";
    SPACING = "particles" "spacing", Number(Positive), "length", Otherwise("2 `radius`"), MESH,
        "Smallest distance of neighbouring sites of the mesh; increased until it divides the sides.";
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
        "Centres of wall discs. Only `wall_motion` moves a wall disc: its mass in a contact is infinite.";
    WALL_RADIUS = "particles" "wall_radius", Number(Positive), "length", Otherwise("0.9 `radius`"), WALLED,
        "Radius of the wall discs.";
    WALL_SPACING = "particles" "wall_spacing", Number(Positive), "length", Otherwise("3 `wall_radius`"), LINED,
        "Distance of the centres of neighbouring wall discs; rounded so that it divides the length.";
    WALL_MOTION = "particles" "wall_motion", Choice(WallMotionKind::WORDS), "", Is("\"fixed\""), HOLDING,
        "Motion of the wall discs, all together.";
    WALL_AMPLITUDE = "particles" "wall_amplitude", Pair(Finite), "length", Required, OSCILLATING,
        "Amplitude a of the walls' motion r(0) + a sin(2π f t).";
    WALL_FREQUENCY = "particles" "wall_frequency", Number(Positive), "1/time", Required, OSCILLATING,
        "Frequency f of the walls' motion.";
}

/// Keys of discs that exclude each other.
pub static DISC_RIVALS: &[ExclusiveKeys] = &[
    ExclusiveKeys { keys: &[&GENERATE, &FILE], used: ALWAYS, needed: true },
    ExclusiveKeys { keys: &[&COUNT, &PACKING_FRACTION], used: PLACED, needed: true },
    ExclusiveKeys { keys: &[&COUNT, &PACKING_FRACTION], used: MESH, needed: true },
    ExclusiveKeys { keys: &[&TEMPERATURE, &SPEED], used: ALWAYS, needed: false },
];

define_words! {
    /// Motion of wall discs.
    pub(super) enum WallMotionKind {
        /// At rest.
        Fixed = "fixed",
        /// Sinusoidal.
        Oscillating = "oscillating",
    }
}
