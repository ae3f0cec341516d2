//! Checks of a scene's plane walls before it runs.

use super::document::GranularDocument;
use super::options::{ProgramVersion, SearchKind};
use super::scene::GranularScene;
use super::wall_keys::{BoxSide, CLOSED_SIDES, ClosedSides, FLUX, SceneWall, WALLS};
use super::wall_law::with_wall_law;
use crate::domain::Domain;
use crate::method::pairwise::{
    LawTask, PlaneMotion, PlaneWalls, PrescribedMotion, WallTouch, WallTracks, each_touch,
};
use crate::number::significant;
use crate::particles::{Particles, longest_step};
use crate::scene::{DT, MistakeKind, SceneError, Warning};
use crate::start::rounded_to_nine_digits;
use crate::words::Words;
use stripmine_kernels::law::Law;

/// Largest number of errors of one kind that are listed.
const NAMED: usize = 5;

/// Reason why an engine has no plane walls; none if it has them.
fn unsupported(scene: &GranularScene) -> Option<&'static str> {
    if scene.machine.text == ProgramVersion::Printed {
        Some("BP93's printed program has no plane walls; use text = \"ours\"")
    } else if !scene.machine.is_fast() && scene.search.by == SearchKind::NeighborList {
        Some(
            "the programs with neighbour lists have no plane walls; use engine = \"fast\" or search.by = \"lattice\"",
        )
    } else {
        None
    }
}

/// Closed sides of a scene: walls, unless the scene says otherwise, has wall discs, or is run by an engine without plane walls.
pub(super) fn closed_sides(scene: &GranularScene, particles: &Particles) -> ClosedSides {
    let has_wall_discs = particles.grain_count() < particles.len();
    scene.plane.sides.unwrap_or(match has_wall_discs || unsupported(scene).is_some() {
        true => ClosedSides::Edge,
        false => ClosedSides::Wall,
    })
}

impl GranularScene {
    /// Plane walls of the scene in its box, those of the user first, then those of closed sides; `reach` is the largest radius (length).
    pub(super) fn plane_walls(&self, domain: &Domain, reach: f64, sides: ClosedSides) -> PlaneWalls {
        let own: Vec<BoxSide> = self.plane.list.iter().filter_map(|wall| wall.side).collect();
        let others = BoxSide::ALL.iter().map(|(side, _)| side).filter(|side| !own.contains(side));
        let closed = others.filter(|side| sides == ClosedSides::Wall && !domain.is_periodic(side.axis()));
        let closed = closed.map(|side| SceneWall { side: Some(*side), ..SceneWall::default() });
        let all = self.plane.list.iter().cloned().chain(closed).zip(1..);
        // A wall without ends is an error, reported before its place matters.
        let walls = all.map(|(wall, number)| {
            let ends = wall.ends_in(domain).unwrap_or_default();
            wall.plane(wall.label(number), ends, &self.law.contact)
        });
        PlaneWalls::new(walls.collect(), domain, reach)
    }
}

/// Errors of walls and lines that do not depend on where the discs are.
pub(super) fn shapes(document: &GranularDocument, domain: &Domain, particles: &Particles) -> Vec<SceneError> {
    let GranularDocument { scene, values } = document;
    let mut errors = vec![];
    if let Some(why) = unsupported(scene) {
        let keys = [
            (!scene.plane.list.is_empty(), &WALLS),
            (scene.plane.sides == Some(ClosedSides::Wall), &CLOSED_SIDES),
        ];
        let refused = keys.into_iter().filter(|(is_given, _)| *is_given);
        errors.extend(refused.map(|(_, key)| values.spot(key).error(MistakeKind::Contradiction, why)));
    }
    let longest = particles.radii().map(|[smallest, _]| longest_step(smallest, scene.law.max_penetration));
    for (number, wall) in scene.plane.list.iter().enumerate() {
        let name = wall_name(&wall.label(number + 1));
        let earlier = &scene.plane.list[..number];
        let mistakes = [
            ends_mistake(wall, domain, earlier.iter().any(|it| it.side.is_some() && it.side == wall.side)),
            motion_mistake(wall),
            longest.and_then(|limit| speed_mistake(wall, scene.integrator.dt, limit)),
        ];
        errors.extend(mistakes.into_iter().flatten().map(|WallMistake { kind, message, remedy }| {
            let error = values.item_spot(&WALLS, number).error(kind, format!("{name} {message}"));
            error.advising(remedy)
        }));
    }
    for (number, [a, b]) in scene.plane.lines.iter().enumerate().filter(|(_, [a, b])| a == b) {
        let message = format!("line {} of [[flux]] has both ends at ({}, {})", number + 1, a[0], b[1]);
        let error = values.item_spot(&FLUX, number).error(MistakeKind::Geometry, message);
        errors.push(error.expecting("two different ends"));
    }
    errors.truncate(NAMED);
    errors
}

/// Mistake in a wall: its kind, the message after the wall's name, and the remedy.
struct WallMistake {
    kind: MistakeKind,
    message: String,
    remedy: String,
}

impl WallMistake {
    fn new(kind: MistakeKind, message: impl Into<String>, remedy: impl Into<String>) -> Option<WallMistake> {
        Some(WallMistake { kind, message: message.into(), remedy: remedy.into() })
    }
}

/// Mistake in the ends of a wall; `is_repeated` if an earlier wall is the same side.
fn ends_mistake(wall: &SceneWall, domain: &Domain, is_repeated: bool) -> Option<WallMistake> {
    use MistakeKind::{Contradiction, Geometry};
    let axes = ["x", "y"];
    if let Some(side) = wall.side {
        let axis = side.axis();
        return if wall.ends != [None; 2] {
            WallMistake::new(
                Contradiction,
                "has `from` or `to` beside `side`",
                "leave out `from` and `to`, or `side`",
            )
        } else if domain.is_periodic(axis) {
            let message = format!("is periodic along {}: there is no wall", axes[axis]);
            WallMistake::new(
                Contradiction,
                message,
                "close the side in domain.periodic, or give `from` and `to`",
            )
        } else if is_repeated {
            WallMistake::new(Contradiction, "is given twice", "leave out one of the two tables")
        } else {
            None
        };
    }
    let [Some(a), Some(b)] = wall.ends else {
        let missing = if wall.ends[0].is_none() { "from" } else { "to" };
        return WallMistake::new(Geometry, format!("has no `{missing}`"), "give `from` and `to`, or `side`");
    };
    if a == b {
        let message = format!("has both ends at ({}, {})", a[0], a[1]);
        return WallMistake::new(Geometry, message, "give two different ends");
    }
    let covers = |axis: &usize| {
        domain.is_periodic(*axis) && (b[*axis] - a[*axis]).abs() > domain.length(*axis) * (1.0 + 1e-12)
    };
    let axis = (0..2).find(covers)?;
    let message = format!(
        "is {} long along {}, more than the period {}: it would cover itself",
        (b[axis] - a[axis]).abs(),
        axes[axis],
        domain.length(axis)
    );
    WallMistake::new(Geometry, message, "end it after one period: its ends join")
}

/// Mistake in the motion of a wall: keys that contradict each other.
fn motion_mistake(wall: &SceneWall) -> Option<WallMistake> {
    use MistakeKind::Contradiction;
    let PlaneMotion { velocity, amplitude, frequency, .. } = wall.motion;
    let is_prescribed = (velocity, amplitude, frequency) != ([0.0; 2], [0.0; 2], 0.0);
    match wall.drive {
        (Some(_), None) | (None, Some(_)) => WallMistake::new(
            Contradiction,
            "has a mass without a force, or a force without a mass",
            "give both: the force moves the wall along its direction",
        ),
        (Some(_), Some([0.0, 0.0])) => WallMistake::new(
            Contradiction,
            "has a force of 0, which gives no direction to move along",
            "give the force that holds the grains, [0.0, -1.0] for example",
        ),
        (Some(_), Some(_)) if is_prescribed => WallMistake::new(
            Contradiction,
            "has a mass and a prescribed motion",
            "leave out `mass` and `force`, or `velocity`, `amplitude` and `frequency`",
        ),
        _ if (amplitude == [0.0; 2]) != (frequency == 0.0) => WallMistake::new(
            Contradiction,
            "has an amplitude without a frequency, or a frequency without an amplitude",
            "give both, or neither",
        ),
        _ => None,
    }
}

/// Mistake in the speed of a wall whose motion is prescribed, for steps of `dt` (time) of at most `longest` (length).
fn speed_mistake(wall: &SceneWall, dt: f64, longest: f64) -> Option<WallMistake> {
    let speed = wall.motion.fastest();
    if speed * dt <= longest {
        return None;
    }
    let message = format!(
        "moves at up to {}, {} in a step; beyond {}, it could pass discs between two steps",
        significant(speed, 5),
        significant(speed * dt, 5),
        significant(longest, 5)
    );
    let remedy = format!("slow it down, or lower {} below {}", DT.path(), significant(longest / speed, 5));
    WallMistake::new(MistakeKind::Stability, message, remedy)
}

/// Warnings about driven walls that are lighter than the grains beside them: they oscillate faster than a grain.
pub(super) fn light_walls(scene: &GranularScene, domain: &Domain, particles: &Particles) -> Vec<Warning> {
    let grains = particles.grains().iter();
    let (mass, radius) = grains.fold((0.0, f64::INFINITY), |(mass, radius): (f64, f64), grain| {
        (mass.max(grain.mass), radius.min(grain.radius))
    });
    let of = |(wall, number): (&SceneWall, usize)| {
        let (own, [a, b]) = (wall.drive.0?, wall.ends_in(domain)?);
        let beside = (b[0] - a[0]).hypot(b[1] - a[1]) / (2.0 * radius);
        let ratio = beside.max(1.0) * mass / own;
        (ratio > 1.0).then(|| Warning {
            check: "light wall",
            share: ratio,
            is_refusal: false,
            key: WALLS.path(),
            message: format!(
                "{} has a mass of {own}, {} times less than the grains that fit beside it: it can oscillate {} times faster than a grain",
                wall_name(&wall.label(number)),
                significant(ratio, 3),
                significant((1.0 + ratio).sqrt(), 3)
            ),
            suggestion: "give the wall the mass of the grains beside it, or lower integrator.dt by that factor where it is near its limit".to_owned(),
        })
    };
    scene.plane.list.iter().zip(1..).filter_map(of).collect()
}

/// Contacts of discs with moved walls in double precision.
pub(super) struct WallTouches<'a> {
    pub(super) walls: &'a PlaneWalls,
    pub(super) particles: &'a Particles,
    pub(super) domain: Domain,
    pub(super) motions: &'a [PrescribedMotion],
}

impl LawTask for WallTouches<'_> {
    type Output = Vec<(WallTouch, [f64; 2])>;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output {
        let WallTouches { walls, particles, domain, motions } = self;
        each_touch(&law, walls, particles, |position| domain.wrapped(position), motions)
    }
}

/// Errors of walls that cut discs at the start.
pub(super) fn cut_discs(
    document: &GranularDocument,
    domain: &Domain,
    walls: &PlaneWalls,
    particles: &Particles,
) -> Vec<SceneError> {
    let GranularDocument { scene, values } = document;
    let limit = scene.law.max_penetration;
    let start = WallTracks::new(walls);
    let task = WallTouches { walls, particles, domain: *domain, motions: start.now() };
    let mut deep = with_wall_law((scene.law.contact, scene.has_friction()), task);
    deep.retain(|(touch, _)| touch.penetration > limit);
    deep.sort_by(|(a, _), (b, _)| b.penetration.total_cmp(&a.penetration));
    let of = |(touch, _): &(WallTouch, [f64; 2])| {
        let disc = &particles.all()[touch.disc as usize];
        let [x, y] = disc.planar_position().map(rounded_to_nine_digits);
        let (wall, user) = (touch.wall as usize, scene.plane.list.len());
        let name = wall_name(&walls.all()[wall].label);
        let spot = if wall < user { values.item_spot(&WALLS, wall) } else { values.spot(&CLOSED_SIDES) };
        let message = format!(
            "{name} cuts disc {} at ({x}, {y}) at the start by {} of its radius; the limit is law.max_penetration = {limit}",
            disc.id,
            significant(touch.penetration, 4)
        );
        let advice = if wall < user {
            "move the wall or the disc; generate = \"random\" places discs beside walls"
        } else {
            "move the disc inside, or set domain.closed_sides = \"edge\""
        };
        spot.error(MistakeKind::Overlap, message).advising(advice)
    };
    deep.iter().take(NAMED).map(of).collect()
}

/// Name of a wall in messages, by its label.
pub(super) fn wall_name(label: &str) -> String {
    match label.parse::<usize>() {
        Ok(number) => format!("wall {number}"),
        Err(_) => format!("the {label} side of the box"),
    }
}

/// Warnings about gaps between walls that one grain can pass, but not two: they are seldom meant.
pub(super) fn gaps(
    scene: &GranularScene,
    domain: &Domain,
    walls: &PlaneWalls,
    particles: &Particles,
) -> Vec<Warning> {
    let Some([smallest, _]) = particles.radii() else { return vec![] };
    let list = &scene.plane.list;
    let stated = list.iter().enumerate().filter(|(_, wall)| wall.side.is_none());
    let ends =
        stated.flat_map(|(number, wall)| wall.ends.into_iter().flatten().map(move |end| (number, end)));
    let gap = |(number, end): (usize, [f64; 2])| {
        let others = walls.all().iter().enumerate().filter(move |(other, _)| *other != number);
        let nearest =
            others.map(|(other, wall)| (domain.distance_to_segment(domain.wrapped(end), &wall.ends), other));
        let (width, other) = nearest.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (2.0 * smallest..4.0 * smallest).contains(&width).then(|| Warning {
            check: "gap between walls",
            share: width / (2.0 * smallest),
            is_refusal: false,
            key: WALLS.path(),
            message: format!(
                "the end ({}, {}) of wall {} is {} from {}: a grain of diameter {} passes, two do not",
                end[0],
                end[1],
                number + 1,
                significant(width, 4),
                wall_name(&walls.all()[other].label),
                significant(2.0 * smallest, 4)
            ),
            suggestion: "let the ends coincide where a closed shape is meant".to_owned(),
        })
    };
    ends.filter_map(gap).take(NAMED).collect()
}
