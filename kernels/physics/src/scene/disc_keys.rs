//! Keys of the initial discs.

use super::keys::Fallback::{Is, Otherwise, Required};
use super::keys::KeyValueKind::{Choice, Number, Numbers, Pair, Pairs, Switch, Text, Whole};
use super::keys::NumberRange::{Finite, NonNegative, Positive, UpTo, Within};
use super::keys::{Use, define_keys};
use crate::words::{Words, define_words};

const ALWAYS: Use = None;
const GENERATED: Use =
    Some((&GENERATE, &["random", "compressed", "mesh", "hexagonal", "pipe", "box", "list", "file"]));
const SAMPLED: Use = Some((&GENERATE, &["random", "compressed", "mesh", "hexagonal", "pipe", "box", "file"]));
const READ: Use = Some((&GENERATE, &["file"]));
const DRAWN: Use = Some((&GENERATE, &["random", "compressed", "mesh", "hexagonal", "pipe", "box"]));
pub(super) const PLACED: Use = Some((&GENERATE, &["random", "compressed", "pipe", "box"]));
pub(super) const SIDED: Use =
    Some((&GENERATE, &["random", "compressed", "mesh", "pipe", "box", "list", "file"]));
const WALLED: Use = Some((&GENERATE, &["pipe", "box", "list"]));
const LINED: Use = Some((&GENERATE, &["pipe", "box"]));
const HOLDING: Use = Some((&GENERATE, &["pipe", "box", "list", "file"]));
const PIPE: Use = Some((&GENERATE, &["pipe"]));
pub(super) const MESH: Use = Some((&GENERATE, &["mesh"]));
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
        "Start file: XYZ (extended or plain), GSD, a LAMMPS data file or dump, or .sph; relative to the scene file. `radius`, `mass`, and `temperature` or `speed` supply what the file lacks.",
        implies (&GENERATE, "file");
    FRAME = "particles" "frame", Whole(0, u64::MAX), "", Otherwise("the last one"), READ,
        "Number of the frame of the start file, from 0.";
    SEED = "particles" "seed", Whole(0, u64::MAX), "", Is("1"), SAMPLED,
        "Seed of radii, positions and velocities.";
    COUNT = "particles" "count", Whole(1, 268_435_455), "", Otherwise("from `packing_fraction`"), DRAWN,
        "Number of grains; a hexagonal lattice may have a few more to fill its last row. With `packing_fraction` it determines the box.";
    PACKING_FRACTION = "particles" "packing_fraction", Number(Within(0.907)), "", Otherwise("from `count`"), DRAWN,
        "N π radius² over the area open to grains: the box, the clear channel of a pipe, or the box up to its fill height.";
    RADIUS = "particles" "radius", Number(Positive), "length", Otherwise("those of `file`"), GENERATED,
        "Radius of a grain; with a spread, the mean. With `file`: of every disc, where the file has no radii.";
    SECOND_RADIUS = "particles" "second_radius", Number(Positive), "length", Otherwise("`radius`"), PLACED,
        "Mean radius of a second kind of discs.";
    SECOND_SHARE = "particles" "second_share", Number(UpTo(1.0)), "", Is("0.0"), PLACED,
        "Fraction of the discs that are of the second kind, from 0 to 1.";
    RADIUS_SPREAD = "particles" "radius_spread", Number(UpTo(1.0)), "", Is("0.0"), PLACED,
        "Standard deviation of the Gaussian radii, relative to `radius`.";
    RADIUS_CUT = "particles" "radius_cut", Number(UpTo(1.0)), "", Otherwise("2 `radius_spread`, at most 0.12"), PLACED,
        "Largest deviation of a radius, relative to `radius`.";
    MASS = "particles" "mass", Number(Positive), "mass", Otherwise("those of `file`"), GENERATED,
        "Mass of a disc of radius `radius`; masses scale as (their radius/`radius`)². With `file`: of every disc, where the file has no masses.";
    TEMPERATURE = "particles" "temperature", Number(NonNegative), "mass·length²/time²", Otherwise("see `speed`"), SAMPLED,
        "kT of Maxwell velocities; no spin. The temperature of N drawn discs differs from it by about 1/√N, unless `exact_temperature` is set.";
    SPEED = "particles" "speed", Number(NonNegative), "length/time", Otherwise("at rest"), SAMPLED,
        "Standard deviation of each component of Gaussian velocities; no spin.";
    EXACT_TEMPERATURE = "particles" "exact_temperature", Switch, "", Is("false"), SAMPLED,
        "Scales drawn velocities to exactly `temperature` (or `speed`), after the mean motion is removed along every axis that conserves momentum.";
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
    MASSES = "particles" "masses", Numbers(Positive), "mass", Otherwise("`mass`, by area"), LIST,
        "Masses of the grains.";
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

define_words! {
    /// Motion of wall discs.
    pub(super) enum WallMotionKind {
        /// At rest.
        Fixed = "fixed",
        /// Sinusoidal.
        Oscillating = "oscillating",
    }
}
