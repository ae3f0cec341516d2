//! Plane walls of a scene: their keys, and the walls that they make.

use crate::method::pairwise::{PlaneMotion, PlaneWall};
use crate::scene::Fallback::{Otherwise, Required};
use crate::scene::KeyValueKind::{Choice, Number, Pair, Tables};
use crate::scene::NumberRange::{Finite, NonNegative, Positive};
use crate::scene::keys::define_keys;
use crate::scene::{Binding, KeyValue, TableRow, Use};
use crate::words::{Words, define_words};
use stripmine_kernels::law::granular::Contact;

const ALWAYS: Use = None;

define_keys! {
    /// Keys of a plane wall.
    static FIELDS;
    FROM = "walls" "from", Pair(Finite), "length", Required, ALWAYS,
        "First end at the start.";
    TO = "walls" "to", Pair(Finite), "length", Required, ALWAYS,
        "Second end at the start.";
    VELOCITY = "walls" "velocity", Pair(Finite), "length/time", Otherwise("at rest"), ALWAYS,
        "Constant velocity v of the wall.";
    AMPLITUDE = "walls" "amplitude", Pair(Finite), "length", Otherwise("no oscillation"), ALWAYS,
        "Amplitude a of the oscillation r(0) + v t + a sin(2π f t); needs `frequency`.";
    FREQUENCY = "walls" "frequency", Number(Positive), "1/time", Otherwise("no oscillation"), ALWAYS,
        "Frequency f of the oscillation.";
    FRICTION = "walls" "friction", Number(NonNegative), "", Otherwise("`law.friction`"), ALWAYS,
        "Friction coefficient of the wall.";
    NORMAL_DAMPING = "walls" "normal_damping", Number(NonNegative), "1/time", Otherwise("`law.normal_damping`"), ALWAYS,
        "Normal damping at the wall; multiplied by the mass of the grain.";
    SHEAR_DAMPING = "walls" "shear_damping", Number(NonNegative), "1/time", Otherwise("`law.shear_damping`"), ALWAYS,
        "Tangential damping at the wall; multiplied by the mass of the grain.";
}

define_keys! {
    /// Keys of a line.
    static LINE;
    LINE_FROM = "flux" "from", Pair(Finite), "length", Required, ALWAYS,
        "First end of the line.";
    LINE_TO = "flux" "to", Pair(Finite), "length", Required, ALWAYS,
        "Second end of the line.";
}

define_keys! {
    /// Walls of the box and of the user.
    pub(super) static WALL_KEYS;
    WALLS = "" "walls", Tables(FIELDS), "", Otherwise("none"), ALWAYS,
        "Plane walls, one table [[walls]] each: a segment that a grain meets as it meets a fixed disc of radius 0 at the nearest point. Ends that coincide are joined.";
    FLUX = "" "flux", Tables(LINE), "", Otherwise("none"), ALWAYS,
        "Lines through which grains are counted, one table [[flux]] each; a centre that crosses to the right of the direction from `from` to `to` counts 1, to the left −1.";
    CLOSED_SIDES = "domain" "closed_sides", Choice(ClosedSides::WORDS), "", Otherwise("wall; edge where there are wall discs"), ALWAYS,
        "Closed sides of the box: walls with the coefficients of the law, or edges at which a disc that leaves stops the run.";
}

define_words! {
    /// Closed sides of the box.
    pub(crate) enum ClosedSides {
        /// Plane walls.
        Wall = "wall",
        /// Edges that no disc may cross.
        Edge = "edge",
    }
}

/// Plane wall of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneWall {
    /// Ends at the start (length).
    pub ends: [[f64; 2]; 2],
    /// Motion.
    pub motion: PlaneMotion,
    /// Normal damping (1/time), tangential damping (1/time) and friction coefficient, where they are not those of the law.
    pub(crate) own: [Option<f64>; 3],
}

/// Keys of the coefficients of a wall, in their order.
const COEFFICIENTS: [&str; 3] = ["normal_damping", "shear_damping", "friction"];

impl SceneWall {
    fn of_row(row: &TableRow) -> SceneWall {
        let value = |name: &str| row.iter().find(|(known, _)| *known == name).map(|(_, value)| value);
        let pair = |name: &str| match value(name) {
            Some(KeyValue::Pair(pair)) => *pair,
            _ => [0.0; 2],
        };
        let number = |name: &str| match value(name) {
            Some(KeyValue::Number(number)) => Some(*number),
            _ => None,
        };
        SceneWall {
            ends: [pair(FROM.name), pair(TO.name)],
            motion: PlaneMotion {
                velocity: pair(VELOCITY.name),
                amplitude: pair(AMPLITUDE.name),
                frequency: number(FREQUENCY.name).unwrap_or(0.0),
            },
            own: COEFFICIENTS.map(number),
        }
    }

    fn row(&self) -> TableRow {
        let PlaneMotion { velocity, amplitude, frequency } = self.motion;
        let moves = |pair: [f64; 2]| Some(pair).filter(|pair| *pair != [0.0; 2]);
        let pairs = [
            (FROM.name, Some(self.ends[0])),
            (TO.name, Some(self.ends[1])),
            (VELOCITY.name, moves(velocity)),
            (AMPLITUDE.name, moves(amplitude)),
        ];
        let numbers = [(FREQUENCY.name, Some(frequency).filter(|&frequency| frequency > 0.0))];
        let numbers = numbers.into_iter().chain(COEFFICIENTS.into_iter().zip(self.own));
        let pairs = pairs.into_iter().filter_map(|(name, pair)| Some((name, KeyValue::Pair(pair?))));
        pairs.chain(numbers.filter_map(|(name, number)| Some((name, KeyValue::Number(number?))))).collect()
    }

    /// The wall with the coefficients of a law where it has none.
    pub(super) fn plane(&self, label: String, law: &Contact) -> PlaneWall {
        let [normal_damping, shear_damping, friction] = self.own;
        PlaneWall {
            label,
            ends: self.ends,
            motion: self.motion,
            normal_damping: normal_damping.unwrap_or(law.normal_damping),
            shear_damping: shear_damping.unwrap_or(law.shear_damping),
            friction: friction.unwrap_or(law.friction),
        }
    }
}

/// Plane walls of a scene, as stated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneWalls {
    /// The walls.
    pub list: Vec<SceneWall>,
    /// Ends of the lines through which grains are counted (length).
    pub lines: Vec<[[f64; 2]; 2]>,
    /// Closed sides of the box, if stated.
    pub(crate) sides: Option<ClosedSides>,
}

impl SceneWalls {
    pub(super) fn bind(&mut self, binding: &mut dyn Binding) {
        let rows: Vec<TableRow> = self.list.iter().map(SceneWall::row).collect();
        let mut rows = Some(rows).filter(|rows| !rows.is_empty());
        binding.tables_if_any(&WALLS, &mut rows);
        self.list = rows.unwrap_or_default().iter().map(SceneWall::of_row).collect();
        let row = |[from, to]: &[[f64; 2]; 2]| {
            vec![(LINE_FROM.name, KeyValue::Pair(*from)), (LINE_TO.name, KeyValue::Pair(*to))]
        };
        let mut lines =
            Some(self.lines.iter().map(row).collect::<Vec<TableRow>>()).filter(|rows| !rows.is_empty());
        binding.tables_if_any(&FLUX, &mut lines);
        let ends = |row: &TableRow| SceneWall::of_row(row).ends;
        self.lines = lines.unwrap_or_default().iter().map(ends).collect();
        let mut word = self.sides.map(|sides| sides.word().to_owned());
        binding.word_if_any(&CLOSED_SIDES, &mut word);
        self.sides = word.and_then(|word| ClosedSides::parse(&word));
    }

    /// Segments of the walls at the start (length).
    pub(super) fn segments(&self) -> Vec<[[f64; 2]; 2]> {
        self.list.iter().map(|wall| wall.ends).collect()
    }
}
