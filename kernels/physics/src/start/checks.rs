//! Checks of the initial discs: inside the box, without overlap.

use super::StatedStart;
use crate::domain::Domain;
use crate::near::NeighbourSearch;
use crate::number::significant;
use crate::particles::{ParticleKind, Particles};
use crate::scene::{
    DiscStart, FILE, GENERATE, MistakeKind, POSITIONS, SceneError, Spot, WALL_AMPLITUDE, WALL_POSITIONS,
    WallMotion,
};

/// Largest number of overlaps or discs outside that are listed.
const NAMED: usize = 5;

/// Lists discs outside the box.
pub fn outside(stated: &StatedStart<'_>, domain: &Domain, particles: &Particles) -> Vec<SceneError> {
    let [[left, bottom], [right, top]] =
        [domain.corner(), [domain.origin[0] + domain.length(0), domain.origin[1] + domain.length(1)]];
    let sweep = match stated.walls {
        WallMotion::Fixed => [0.0; 2],
        WallMotion::Oscillating { amplitude, .. } => amplitude.map(f64::abs),
    };
    let leaves = |position: [f64; 2]| {
        (0..2).any(|axis| {
            let (low, high) = (position[axis] - sweep[axis], position[axis] + sweep[axis]);
            let end = domain.origin[axis] + domain.length(axis);
            !domain.is_periodic(axis) && (low < domain.origin[axis] || high >= end)
        })
    };
    let mut errors = Vec::new();
    for (number, disc) in particles.all().iter().enumerate() {
        let ([x, y], what) = (disc.planar_position().map(rounded_to_nine_digits), disc_noun(disc.kind));
        let spot = location_of_disc(stated, particles, number);
        if !domain.contains(disc.position) {
            let message = format!("{what} {} at ({x}, {y}) is outside the box", disc.id);
            let inside = format!("a position from ({left}, {bottom}) to below ({right}, {top})");
            errors.push(spot.error(MistakeKind::Outside, message).expecting(inside));
        } else if disc.kind == ParticleKind::Wall && leaves(disc.planar_position()) {
            let message = format!(
                "{what} {} at ({x}, {y}) oscillates by ({}, {}) out of the box, which extends from ({left}, {bottom}) to \
                 ({right}, {top})",
                disc.id, sweep[0], sweep[1]
            );
            let error = stated.spot(&WALL_AMPLITUDE).error(MistakeKind::Outside, message);
            errors.push(error.advising("lower the amplitude, or place the walls farther inside"));
        }
        if errors.len() == NAMED {
            break;
        }
    }
    errors
}

/// Noun for a disc of a kind.
pub(crate) fn disc_noun(kind: ParticleKind) -> &'static str {
    match kind {
        ParticleKind::Grain => "disc",
        ParticleKind::Wall => "wall disc",
    }
}

/// Rounds a number to nine digits, without the rounding errors of sums.
pub(crate) fn rounded_to_nine_digits(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}

/// Location where a disc is listed, or of the key that created it.
fn location_of_disc(stated: &StatedStart<'_>, particles: &Particles, number: usize) -> Spot {
    match *stated.start {
        DiscStart::List(_) => match number.checked_sub(particles.grain_count()) {
            None => stated.item_spot(&POSITIONS, number),
            Some(number) => stated.item_spot(&WALL_POSITIONS, number),
        },
        DiscStart::File(_) => stated.spot(&FILE),
        _ => stated.spot(&GENERATE),
    }
}

/// Pairs that overlap too deeply: their number, and the deepest ones sorted by depth.
#[derive(Default)]
struct DeepOverlaps {
    worst: Vec<(usize, usize, f64)>,
    count: usize,
}

/// Largest number of pairs counted: if all discs overlap, pairs grow with the square of their number.
const COUNTED: usize = 1_000_000;

impl DeepOverlaps {
    fn add(&mut self, pair: (usize, usize, f64)) {
        self.count += 1;
        let at = self.worst.partition_point(|(_, _, penetration)| *penetration >= pair.2);
        if at < NAMED {
            self.worst.insert(at, pair);
            self.worst.truncate(NAMED);
        }
    }
}

/// Visits the pairs that overlap deeper than `limit`, a fraction of the sum of their radii, as (first, second, penetration), until `visit` returns
/// false.
fn visit_overlaps(
    domain: &Domain,
    particles: &Particles,
    limit: f64,
    mut visit: impl FnMut(usize, usize, f64) -> bool,
) {
    let Some([_, largest]) = particles.radii() else { return };
    let mut near = NeighbourSearch::new(*domain, 2.0 * largest);
    let discs = particles.all();
    for (number, disc) in discs.iter().enumerate() {
        let position = domain.wrapped(disc.planar_position());
        for (other, there) in near.candidates_near(position) {
            let reach = disc.radius + discs[other as usize].radius;
            let penetration = 1.0 - domain.distance(position, there) / reach;
            if penetration > limit && !visit(other as usize, number, penetration) {
                return;
            }
        }
        near.add(number as u32, position);
    }
}

/// Number of pairs that overlap deeper than `limit` and the deepest overlap, both as fractions of the sum of their radii. Counting ends at the
/// first pair that overlaps deeper than `enough`.
pub(crate) fn deepest_overlap(
    domain: &Domain,
    particles: &Particles,
    limit: f64,
    enough: f64,
) -> (usize, f64) {
    let (mut count, mut deepest) = (0, 0.0);
    visit_overlaps(domain, particles, limit, |_, _, penetration| {
        (count, deepest) = (count + 1, f64::max(deepest, penetration));
        penetration <= enough
    });
    (count, deepest)
}

/// Reports pairs that overlap deeper than `limit`, a fraction of the sum of the radii; `reason` explains why they must not.
pub(crate) fn overlaps(
    stated: &StatedStart<'_>,
    domain: &Domain,
    particles: &Particles,
    limit: f64,
    reason: &str,
) -> Vec<SceneError> {
    let (discs, mut deep) = (particles.all(), DeepOverlaps::default());
    visit_overlaps(domain, particles, limit, |first, second, penetration| {
        // Wall discs may overlap each other: no force acts between them.
        let is_wall = |number: usize| discs[number].kind == ParticleKind::Wall;
        if !(is_wall(first) && is_wall(second)) {
            deep.add((first, second, penetration));
        }
        deep.count < COUNTED
    });
    let DeepOverlaps { worst, count } = deep;
    let mut errors: Vec<SceneError> = Vec::new();
    for (first, second, penetration) in worst {
        let [a, b] = [first, second].map(|number| {
            let disc = &discs[number];
            let [x, y] = disc.planar_position().map(rounded_to_nine_digits);
            format!("{} {} at ({x}, {y})", disc_noun(disc.kind), disc.id)
        });
        let reach = discs[first].radius + discs[second].radius;
        let message = format!(
            "{a} and {b} overlap at the start by {} of the sum of their radii, {}; {reason}",
            significant(penetration, 4),
            significant(penetration * reach, 4)
        );
        let least = format!("centres at least {} apart", significant((1.0 - limit) * reach, 9));
        errors.push(
            location_of_disc(stated, particles, second).error(MistakeKind::Overlap, message).expecting(least),
        );
    }
    if let (Some(last), true) = (errors.last_mut(), count > NAMED) {
        let more = count - NAMED;
        last.suggestion = Some(match count {
            COUNTED => format!("at least {more} more pairs overlap; the search ended there"),
            _ => format!("{more} more pairs overlap, no deeper"),
        });
    }
    errors
}
