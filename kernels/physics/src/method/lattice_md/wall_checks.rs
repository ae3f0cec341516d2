//! Checks of a scene's plane walls before it runs.

use super::document::GranularDocument;
use super::options::{ProgramVersion, SearchKind};
use super::scene::GranularScene;
use super::wall_keys::{CLOSED_SIDES, ClosedSides, FLUX, SceneWall, WALLS};
use super::wall_law::with_wall_law;
use crate::domain::Domain;
use crate::method::pairwise::{LawTask, PlaneMotion, PlaneWalls, WallTouch, each_touch};
use crate::number::significant;
use crate::particles::{Particles, longest_step};
use crate::scene::{DT, MistakeKind, SceneError, Warning};
use crate::start::rounded_to_nine_digits;
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
        let closed = if sides == ClosedSides::Wall { side_ends(domain) } else { vec![] };
        let stated = self.plane.list.iter().enumerate();
        let stated = stated.map(|(number, wall)| wall.plane((number + 1).to_string(), &self.law.contact));
        let closed = closed.into_iter().map(|(side, ends)| {
            SceneWall { ends, ..SceneWall::default() }.plane(side.to_owned(), &self.law.contact)
        });
        let walls = stated.chain(closed);
        PlaneWalls::new(walls.collect(), domain, reach)
    }
}

/// Closed sides of a box, by their names.
fn side_ends(domain: &Domain) -> Vec<(&'static str, [[f64; 2]; 2])> {
    let ([left, bottom], sides) = (domain.corner(), domain.lengths());
    let [right, top] = [left + sides[0], bottom + sides[1]];
    let all = [
        (0, "left", [[left, bottom], [left, top]]),
        (0, "right", [[right, bottom], [right, top]]),
        (1, "bottom", [[left, bottom], [right, bottom]]),
        (1, "top", [[left, top], [right, top]]),
    ];
    let closed = all.into_iter().filter(|(axis, ..)| !domain.is_periodic(*axis));
    closed.map(|(_, side, ends)| (side, ends)).collect()
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
    let limit = particles.radii().map(|[smallest, _]| longest_step(smallest, scene.law.max_penetration));
    for (number, SceneWall { ends: [a, b], motion, .. }) in scene.plane.list.iter().enumerate() {
        let PlaneMotion { amplitude, frequency, .. } = *motion;
        let refuse = |kind, message: String| values.item_spot(&WALLS, number).error(kind, message);
        let name = format!("wall {}", number + 1);
        if a == b {
            let message = format!("{name} has both ends at ({}, {})", a[0], a[1]);
            errors.push(refuse(MistakeKind::Geometry, message).expecting("two different ends"));
        }
        for axis in (0..2).filter(|&axis| domain.is_periodic(axis)) {
            let (length, period) = ((b[axis] - a[axis]).abs(), domain.length(axis));
            if length > period * (1.0 + 1e-12) {
                let message = format!(
                    "{name} is {length} long along {}, more than the period {period}: it would cover itself",
                    ["x", "y"][axis]
                );
                errors.push(
                    refuse(MistakeKind::Geometry, message).advising("end it after one period: its ends join"),
                );
            }
        }
        if (amplitude == [0.0; 2]) != (frequency == 0.0) {
            let message =
                format!("{name} has an amplitude without a frequency, or a frequency without an amplitude");
            errors.push(refuse(MistakeKind::Contradiction, message).advising("give both, or neither"));
        }
        let (speed, dt) = (motion.fastest(), scene.integrator.dt);
        if let Some(limit) = limit
            && speed * dt > limit
        {
            let message = format!(
                "{name} moves at up to {}, {} in a step; beyond {}, it could pass discs between two steps",
                significant(speed, 5),
                significant(speed * dt, 5),
                significant(limit, 5)
            );
            let error = refuse(MistakeKind::Stability, message);
            errors.push(error.advising(format!(
                "slow it down, or lower {} below {}",
                DT.path(),
                significant(limit / speed, 5)
            )));
        }
    }
    for (number, [a, b]) in scene.plane.lines.iter().enumerate().filter(|(_, [a, b])| a == b) {
        let message = format!("line {} of [[flux]] has both ends at ({}, {})", number + 1, a[0], b[1]);
        let error = values.item_spot(&FLUX, number).error(MistakeKind::Geometry, message);
        errors.push(error.expecting("two different ends"));
    }
    errors.truncate(NAMED);
    errors
}

/// Contacts of discs with walls in double precision, at a time.
pub(super) struct WallTouches<'a> {
    pub(super) walls: &'a PlaneWalls,
    pub(super) particles: &'a Particles,
    pub(super) domain: Domain,
    pub(super) time: f64,
}

impl LawTask for WallTouches<'_> {
    type Output = Vec<(WallTouch, [f64; 2])>;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output {
        let WallTouches { walls, particles, domain, time } = self;
        each_touch(&law, walls, particles, |position| domain.wrapped(position), time)
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
    let task = WallTouches { walls, particles, domain: *domain, time: 0.0 };
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
    let ends = list.iter().enumerate().flat_map(|(number, wall)| wall.ends.map(|end| (number, end)));
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
