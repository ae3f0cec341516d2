//! Plane walls of a scene: their keys, and the walls that they make.

use crate::domain::Domain;
use crate::method::pairwise::{PlaneMotion, PlaneWall, WallDrive};
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
    FROM = "walls" "from", Pair(Finite), "length", Otherwise("that of `side`"), ALWAYS,
        "First end at the start.";
    TO = "walls" "to", Pair(Finite), "length", Otherwise("that of `side`"), ALWAYS,
        "Second end at the start.";
    SIDE = "walls" "side", Choice(BoxSide::WORDS), "", Otherwise("none; give `from` and `to`"), ALWAYS,
        "Closed side of the box that this wall is, in place of `from` and `to`: with a motion, friction and dampings of its own.";
    VELOCITY = "walls" "velocity", Pair(Finite), "length/time", Otherwise("at rest"), ALWAYS,
        "Constant velocity v of the wall.";
    AMPLITUDE = "walls" "amplitude", Pair(Finite), "length", Otherwise("no oscillation"), ALWAYS,
        "Amplitude a of the oscillation r(0) + v t + a sin(2π f t); needs `frequency`.";
    FREQUENCY = "walls" "frequency", Number(Positive), "1/time", Otherwise("no oscillation"), ALWAYS,
        "Frequency f of the oscillation.";
    MASS = "walls" "mass", Number(Positive), "mass", Otherwise("its motion is prescribed"), ALWAYS,
        "Mass of a wall that `force` drives against the grains. It moves along the force alone and does not turn; gravity acts on it as far as `force` says.";
    FORCE = "walls" "force", Pair(Finite), "force", Otherwise("its motion is prescribed"), ALWAYS,
        "Force that drives a wall of a `mass`, along x and y.";
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
        "Plane walls, one table `[[walls]]` each: a segment that a grain meets as it meets a fixed disc of radius 0 at the nearest point. Ends that coincide are joined.";
    FLUX = "" "flux", Tables(LINE), "", Otherwise("none"), ALWAYS,
        "Lines through which grains are counted, one table `[[flux]]` each; a centre that crosses to the right of the direction from `from` to `to` counts 1, to the left −1.";
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

define_words! {
    /// Side of the box.
    pub(crate) enum BoxSide {
        /// Lowest x.
        Left = "left",
        /// Highest x.
        Right = "right",
        /// Lowest y.
        Bottom = "bottom",
        /// Highest y.
        Top = "top",
    }
}

impl BoxSide {
    /// Axis at right angles to the side.
    pub(super) fn axis(self) -> usize {
        usize::from(matches!(self, BoxSide::Bottom | BoxSide::Top))
    }

    /// Sign of the direction out of the box along the axis.
    pub(super) fn outwards(self) -> f64 {
        if matches!(self, BoxSide::Right | BoxSide::Top) { 1.0 } else { -1.0 }
    }

    /// Ends of the side of a box (length).
    pub(super) fn ends(self, domain: &Domain) -> [[f64; 2]; 2] {
        let ([left, bottom], [width, height]) = (domain.corner(), domain.lengths());
        let [right, top] = [left + width, bottom + height];
        match self {
            BoxSide::Left => [[left, bottom], [left, top]],
            BoxSide::Right => [[right, bottom], [right, top]],
            BoxSide::Bottom => [[left, bottom], [right, bottom]],
            BoxSide::Top => [[left, top], [right, top]],
        }
    }
}

/// Plane wall of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneWall {
    /// Ends at the start, as stated (length).
    pub(super) ends: [Option<[f64; 2]>; 2],
    /// Side of the box that the wall is.
    pub(super) side: Option<BoxSide>,
    /// Mass and force that drive the wall, as stated.
    pub(super) drive: (Option<f64>, Option<[f64; 2]>),
    /// Prescribed motion.
    pub(super) motion: PlaneMotion,
    /// Normal damping (1/time), tangential damping (1/time) and friction coefficient, where they are not those of the law.
    pub(crate) own: [Option<f64>; 3],
}

/// Keys of the coefficients of a wall, in their order.
const COEFFICIENTS: [&str; 3] = ["normal_damping", "shear_damping", "friction"];

impl SceneWall {
    fn of_row(row: &TableRow) -> SceneWall {
        let value = |name: &str| row.iter().find(|(known, _)| *known == name).map(|(_, value)| value);
        let pair = |name: &str| match value(name) {
            Some(KeyValue::Pair(pair)) => Some(*pair),
            _ => None,
        };
        let number = |name: &str| match value(name) {
            Some(KeyValue::Number(number)) => Some(*number),
            _ => None,
        };
        SceneWall {
            ends: [pair(FROM.name), pair(TO.name)],
            side: match value(SIDE.name) {
                Some(KeyValue::Word(word)) => BoxSide::parse(word),
                _ => None,
            },
            drive: (number(MASS.name), pair(FORCE.name)),
            motion: PlaneMotion {
                velocity: pair(VELOCITY.name).unwrap_or_default(),
                amplitude: pair(AMPLITUDE.name).unwrap_or_default(),
                frequency: number(FREQUENCY.name).unwrap_or(0.0),
                drive: None,
            },
            own: COEFFICIENTS.map(number),
        }
    }

    fn row(&self) -> TableRow {
        let PlaneMotion { velocity, amplitude, frequency, .. } = self.motion;
        let (mass, force) = self.drive;
        let moves = |pair: [f64; 2]| Some(pair).filter(|pair| *pair != [0.0; 2]);
        let pairs = [
            (FROM.name, self.ends[0]),
            (TO.name, self.ends[1]),
            (FORCE.name, force),
            (VELOCITY.name, moves(velocity)),
            (AMPLITUDE.name, moves(amplitude)),
        ];
        let numbers =
            [(FREQUENCY.name, Some(frequency).filter(|&frequency| frequency > 0.0)), (MASS.name, mass)];
        let numbers = numbers.into_iter().chain(COEFFICIENTS.into_iter().zip(self.own));
        let pairs = pairs.into_iter().filter_map(|(name, pair)| Some((name, KeyValue::Pair(pair?))));
        let side = self.side.map(|side| (SIDE.name, KeyValue::Word(side.word().to_owned())));
        let pairs = pairs.chain(side);
        pairs.chain(numbers.filter_map(|(name, number)| Some((name, KeyValue::Number(number?))))).collect()
    }

    /// Drive of a wall with a mass and a force.
    fn driven(&self) -> Option<WallDrive> {
        let (mass, force) = self.drive;
        Some(WallDrive { mass: mass?, force: force? })
    }

    /// Ends in a box at the start (length); none if the wall has no side and lacks an end.
    pub(super) fn ends_in(&self, domain: &Domain) -> Option<[[f64; 2]; 2]> {
        match (self.side, self.ends) {
            (Some(side), _) => Some(side.ends(domain)),
            (None, [from, to]) => Some([from?, to?]),
        }
    }

    /// Label: the side, or the number of the wall among those of the scene, from 1.
    pub(super) fn label(&self, number: usize) -> String {
        self.side.map_or_else(|| number.to_string(), |side| side.word().to_owned())
    }

    /// The wall between two ends with the coefficients of a law where it has none.
    pub(super) fn plane(&self, label: String, ends: [[f64; 2]; 2], law: &Contact) -> PlaneWall {
        let [normal_damping, shear_damping, friction] = self.own;
        PlaneWall {
            label,
            ends,
            motion: PlaneMotion { drive: self.driven(), ..self.motion },
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
        let row = |[from, to]: &[[f64; 2]; 2]| -> TableRow {
            vec![(LINE_FROM.name, KeyValue::Pair(*from)), (LINE_TO.name, KeyValue::Pair(*to))]
        };
        let mut lines =
            Some(self.lines.iter().map(row).collect::<Vec<TableRow>>()).filter(|rows| !rows.is_empty());
        binding.tables_if_any(&FLUX, &mut lines);
        let ends = |row: &TableRow| SceneWall::of_row(row).ends.map(Option::unwrap_or_default);
        self.lines = lines.unwrap_or_default().iter().map(ends).collect();
        let mut word = self.sides.map(|sides| sides.word().to_owned());
        binding.word_if_any(&CLOSED_SIDES, &mut word);
        self.sides = word.and_then(|word| ClosedSides::parse(&word));
    }

    /// Segments of the walls at the start, without sides of the box (length).
    pub(super) fn segments(&self) -> Vec<[[f64; 2]; 2]> {
        self.list.iter().filter_map(|wall| Some([wall.ends[0]?, wall.ends[1]?])).collect()
    }
}
