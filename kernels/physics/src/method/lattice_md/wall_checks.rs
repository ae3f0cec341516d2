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
use std::collections::BTreeSet;
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
    let smallest = particles.radii().map_or(f64::INFINITY, |[smallest, _]| smallest);
    for (number, wall) in scene.plane.list.iter().enumerate() {
        let name = wall_name(&wall.label(number + 1));
        let earlier = &scene.plane.list[..number];
        let mistakes = [
            ends_mistake(wall, domain, earlier.iter().any(|it| it.side.is_some() && it.side == wall.side)),
            motion_mistake(wall, scene.run.steps as f64 * scene.integrator.dt, smallest),
            longest.and_then(|limit| speed_mistake(wall, scene.integrator.dt, limit)),
        ];
        errors.extend(mistakes.into_iter().flatten().map(
            |WallMistake { kind, message, expected, remedy }| {
                let error = values.item_spot(&WALLS, number).error(kind, format!("{name} {message}"));
                error.expecting(expected).advising(remedy)
            },
        ));
    }
    for (number, [a, b]) in scene.plane.lines.iter().enumerate().filter(|(_, [a, b])| a == b) {
        let message = format!("line {} of [[flux]] has both ends at ({}, {})", number + 1, a[0], b[1]);
        let error = values.item_spot(&FLUX, number).error(MistakeKind::Geometry, message);
        errors.push(error.expecting("two different ends"));
    }
    errors.truncate(NAMED);
    errors
}

/// Mistake in a wall: its kind, the message after the wall's name, the expectation and the remedy.
struct WallMistake {
    kind: MistakeKind,
    message: String,
    expected: &'static str,
    remedy: String,
}

impl WallMistake {
    fn new(
        kind: MistakeKind,
        message: impl Into<String>,
        expected: &'static str,
        remedy: impl Into<String>,
    ) -> Option<WallMistake> {
        Some(WallMistake { kind, message: message.into(), expected, remedy: remedy.into() })
    }
}

/// Mistake in the ends of a wall; `is_repeated` if an earlier wall is the same side.
fn ends_mistake(wall: &SceneWall, domain: &Domain, is_repeated: bool) -> Option<WallMistake> {
    use MistakeKind::{Contradiction, Geometry};
    let axes = ["x", "y"];
    if let Some(side) = wall.side {
        let axis = side.axis();
        return if wall.ends != [None; 2] {
            let expected = "a side, or two ends";
            let remedy = "leave out `from` and `to`, or `side`";
            WallMistake::new(Contradiction, "has `from` or `to` beside `side`", expected, remedy)
        } else if domain.is_periodic(axis) {
            let message = format!("is periodic along {}: there is no wall", axes[axis]);
            let remedy = "close the side in domain.periodic, or give `from` and `to`";
            WallMistake::new(Contradiction, message, "a closed side", remedy)
        } else if is_repeated {
            let remedy = "leave out one of the two tables";
            WallMistake::new(Contradiction, "is given twice", "each side once", remedy)
        } else {
            None
        };
    }
    let [Some(a), Some(b)] = wall.ends else {
        let missing = if wall.ends[0].is_none() { "from" } else { "to" };
        let message = format!("has no `{missing}`");
        return WallMistake::new(Geometry, message, "two ends, or a side", "give `from` and `to`, or `side`");
    };
    if a == b {
        let message = format!("has both ends at ({}, {})", a[0], a[1]);
        return WallMistake::new(Geometry, message, "two different ends", "move one of them");
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
    WallMistake::new(Geometry, message, "at most one period", "end it after one period: its ends join")
}

/// Mistake in the motion of a wall: keys that contradict each other, or a side that leaves the box and takes the grains with it, in a run of a duration
/// (time) with grains of at least `radius` (length).
fn motion_mistake(wall: &SceneWall, time: f64, radius: f64) -> Option<WallMistake> {
    use MistakeKind::{Contradiction, Geometry};
    let PlaneMotion { velocity, amplitude, frequency, .. } = wall.motion;
    let is_prescribed = (velocity, amplitude, frequency) != ([0.0; 2], [0.0; 2], 0.0);
    match wall.drive {
        (Some(_), None) => {
            let remedy = "give `force`, which moves the wall along its direction";
            return WallMistake::new(Contradiction, "has a mass without a force", "both or neither", remedy);
        }
        (None, Some(_)) => {
            let remedy = "give `mass`: the force moves it";
            return WallMistake::new(Contradiction, "has a force without a mass", "both or neither", remedy);
        }
        (Some(_), Some([0.0, 0.0])) => {
            let message = "has a force of 0, which gives no direction to move along";
            let remedy = "give the force that holds the grains, [0.0, -1.0] for example";
            return WallMistake::new(Contradiction, message, "a force that is not 0", remedy);
        }
        (Some(_), Some(_)) if is_prescribed => {
            let remedy = "leave out `mass` and `force`, or `velocity`, `amplitude` and `frequency`";
            let expected = "one of the two motions";
            return WallMistake::new(Contradiction, "has a mass and a prescribed motion", expected, remedy);
        }
        _ if (amplitude == [0.0; 2]) != (frequency == 0.0) => {
            let message = "has an amplitude without a frequency, or a frequency without an amplitude";
            return WallMistake::new(Contradiction, message, "both or neither", "give the other one, too");
        }
        _ => {}
    }
    let side = wall.side?;
    let (axis, out) = (side.axis(), side.outwards());
    if let (_, Some(force)) = wall.drive
        && force[axis] * out >= 0.0
    {
        let message = format!("is driven by [{}, {}], which does not press it inwards", force[0], force[1]);
        let remedy = "turn the force towards the grains";
        return WallMistake::new(Contradiction, message, "a force into the box", remedy);
    }
    let drift = velocity[axis] * out * time;
    let beyond = drift.max(0.0) + amplitude[axis].abs();
    (beyond >= radius).then(|| WallMistake {
        kind: Geometry,
        message: format!(
            "moves out of the box by up to {}, the radius of a grain or more: grains would leave the box with it",
            significant(beyond, 4)
        ),
        expected: "a wall that stays in the box",
        remedy: "make the box larger and give the wall with `from` and `to`, or lower its amplitude or velocity".to_owned(),
    })
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
    WallMistake::new(MistakeKind::Stability, message, "a slower wall or a shorter step", remedy)
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
    let mut found = BTreeSet::new();
    let gap = |(number, end): (usize, [f64; 2])| {
        let others = walls.all().iter().enumerate().filter(move |(other, _)| *other != number);
        let nearest =
            others.map(|(other, wall)| (domain.distance_to_segment(domain.wrapped(end), &wall.ends), other));
        let (width, other) = nearest.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let is_new = found.insert([number.min(other), number.max(other)]);
        (is_new && (2.0 * smallest..4.0 * smallest).contains(&width)).then(|| Warning {
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
            suggestion: "let the ends coincide where a closed shape is meant, or widen an outlet to 4 radii"
                .to_owned(),
        })
    };
    ends.filter_map(gap).take(NAMED).collect()
}
