//! What a scene must hold before it runs, with the numbers.

mod discs;
mod geometry;
mod motion;

use discs::Made;
pub use geometry::Geometry;
pub use motion::Estimates;

use super::error::{Reason, SceneErrors, Warning};
use super::key_table::{FILE, METHOD, POSITIONS, RADIUS, WALL_AMPLITUDE, WALL_POSITIONS};
use super::places::Document;
use super::{Execution, MethodKind, Scene, WallMotion};
use crate::domain::Domain;
use crate::particles::{Kind, Particles};
use crate::placement::{Near, distance, wrapped};

/// A scene that may run: its discs, its lattice, and what is to be said about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// The scene.
    pub scene: Scene,
    /// The box.
    pub domain: Domain,
    /// The discs at the start, inside the box.
    pub particles: Particles,
    /// Whether all discs have one radius and one mass, and there are no walls.
    pub alike: bool,
    /// The lattice.
    pub geometry: Geometry,
    /// What is to be expected of the motion.
    pub estimates: Estimates,
    /// What the scene has no need of, with the reason.
    pub left_out: Vec<String>,
    /// What seldom ends well.
    pub warnings: Vec<Warning>,
}

/// At most this many overlaps or strays are named one by one.
const NAMED: usize = 5;

/// Makes the discs of a scene and holds it against every precondition.
pub(super) fn check(document: Document) -> Result<Checked, SceneErrors> {
    let mut errors = Vec::new();
    let made = match discs::make(&document) {
        Ok(made) => Some(made),
        Err(error) => {
            errors.push(error);
            None
        }
    };
    if let Some(Made { domain, particles, .. }) = &made {
        errors.extend(numbered(&document, particles));
        errors.extend(outside(&document, domain, particles));
        errors.extend(overlaps(&document, domain, particles));
    }
    let radii = made.as_ref().and_then(|made| made.particles.radii());
    let radii = discs::radii(&document.scene, radii);
    let domain = made.as_ref().map(|made| made.domain).or_else(|| discs::domain(&document.scene));
    let count = made.as_ref().map_or(0, |made| made.particles.len());
    let geometry = match (domain, radii) {
        (Some(domain), Some(radii)) => {
            geometry::fit(&document, &domain, radii, count).map_err(|more| errors.extend(more)).ok()
        }
        _ => None,
    };
    errors.extend(motion::instability(&document));
    if let (Some(Made { domain, particles, .. }), Some(geometry)) = (&made, &geometry) {
        errors.extend(motion::long_steps(&document, domain, particles, geometry));
    }
    SceneErrors::none_of(errors)?;
    let (Some(Made { domain, particles, mut warnings }), Some(geometry)) = (made, geometry) else {
        // Whatever is not there has left an error above.
        let error = document.spot(&RADIUS).error(Reason::Geometry, "there is nothing to simulate");
        return Err(error.into());
    };
    let scene = document.scene;
    let estimates = Estimates::of(&scene, &particles);
    warnings.extend(motion::warnings(&scene, &domain, &particles, &geometry, &estimates));
    let alike = all_alike(&particles);
    let left_out = left_out(&scene, &particles, alike);
    Ok(Checked { scene, domain, particles, alike, geometry, estimates, left_out, warnings })
}

fn all_alike(particles: &Particles) -> bool {
    let Some(first) = particles.all().first() else { return false };
    let same = |disc: &crate::particles::Particle| {
        disc.kind == Kind::Grain && disc.radius == first.radius && disc.mass == first.mass
    };
    particles.all().iter().all(same)
}

/// More discs than the partners in a fast method's lists have bits for.
fn numbered(document: &Document, particles: &Particles) -> Option<super::SceneError> {
    const MOST: usize = (1 << 29) - 3;
    let method = &document.scene.method;
    let listed = method.execution == Execution::Fast && method.kind != MethodKind::Lattice;
    (listed && particles.len() > MOST).then(|| {
        let message = format!("{} discs; sectors and fast lists number at most {MOST}", particles.len());
        document
            .spot(&METHOD)
            .error(Reason::Placement, message)
            .advising("method.kind = \"lattice\" numbers more")
    })
}

/// Discs that are not in the box.
fn outside(document: &Document, domain: &Domain, particles: &Particles) -> Vec<super::SceneError> {
    let [[left, bottom], [right, top]] =
        [domain.origin, [domain.origin[0] + domain.sides[0], domain.origin[1] + domain.sides[1]]];
    let sweep = match document.scene.walls {
        WallMotion::Fixed => [0.0; 2],
        WallMotion::Oscillating { amplitude, .. } => amplitude.map(f64::abs),
    };
    let leaves = |position: [f64; 2]| {
        (0..2).any(|axis| {
            let (low, high) = (position[axis] - sweep[axis], position[axis] + sweep[axis]);
            let end = domain.origin[axis] + domain.sides[axis];
            !domain.periodic[axis] && (low < domain.origin[axis] || high >= end)
        })
    };
    let mut errors = Vec::new();
    for (number, disc) in particles.all().iter().enumerate() {
        let ([x, y], what) = (disc.position.map(readable), noun(disc.kind));
        let spot = spot_of(document, particles, number);
        if !domain.contains(disc.position) {
            let message = format!("{what} {} at ({x}, {y}) is outside the box", disc.id);
            let inside = format!("a position from ({left}, {bottom}) to below ({right}, {top})");
            errors.push(spot.error(Reason::Outside, message).expecting(inside));
        } else if disc.kind == Kind::Wall && leaves(disc.position) {
            let message = format!(
                "{what} {} at ({x}, {y}) swings by ({}, {}) out of the box, which reaches from ({left}, {bottom}) to \
                 ({right}, {top})",
                disc.id, sweep[0], sweep[1]
            );
            let error = document.spot(&WALL_AMPLITUDE).error(Reason::Outside, message);
            errors.push(error.advising("lower the amplitude, or put the walls farther inside"));
        }
        if errors.len() == NAMED {
            break;
        }
    }
    errors
}

fn noun(kind: Kind) -> &'static str {
    match kind {
        Kind::Grain => "disc",
        Kind::Wall => "wall disc",
    }
}

/// A number to nine digits: the last ones of a sum say nothing.
fn readable(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}

/// Where a disc is listed, or what made it.
fn spot_of(document: &Document, particles: &Particles, number: usize) -> super::error::Spot {
    use super::Start;
    match document.scene.start {
        Start::List(_) => match number.checked_sub(particles.grain_count()) {
            None => document.item_spot(&POSITIONS, number),
            Some(number) => document.item_spot(&WALL_POSITIONS, number),
        },
        Start::File(_) => document.spot(&FILE),
        _ => document.spot(&super::key_table::GENERATE),
    }
}

/// Pairs that overlap too deep: how many, and the deepest of them, in the order of their depth.
#[derive(Default)]
struct Deep {
    worst: Vec<(usize, usize, f64)>,
    count: usize,
}

/// So many pairs are counted: where all discs lie on a heap there are as many as the square of their number.
const COUNTED: usize = 1_000_000;

impl Deep {
    fn add(&mut self, pair: (usize, usize, f64)) {
        self.count += 1;
        let at = self.worst.partition_point(|(_, _, penetration)| *penetration >= pair.2);
        if at < NAMED {
            self.worst.insert(at, pair);
            self.worst.truncate(NAMED);
        }
    }
}

/// Pairs that overlap deeper than the scene allows.
fn overlaps(document: &Document, domain: &Domain, particles: &Particles) -> Vec<super::SceneError> {
    let limit = document.scene.law.max_penetration;
    let Some([_, largest]) = particles.radii() else { return Vec::new() };
    let mut near = Near::new(*domain, 2.0 * largest);
    let discs = particles.all();
    let mut deep = Deep::default();
    'all: for (number, disc) in discs.iter().enumerate() {
        let position = wrapped(domain, disc.position);
        for (other, there) in near.of(position) {
            let reach = disc.radius + discs[other as usize].radius;
            let penetration = 1.0 - distance(domain, position, there) / reach;
            if penetration > limit {
                deep.add((other as usize, number, penetration));
            }
            if deep.count == COUNTED {
                break 'all;
            }
        }
        near.add(number as u32, position);
    }
    let Deep { worst, count } = deep;
    let mut errors: Vec<super::SceneError> = Vec::new();
    for (first, second, penetration) in worst {
        let [a, b] = [first, second].map(|number| {
            let disc = &discs[number];
            let [x, y] = disc.position.map(readable);
            format!("{} {} at ({x}, {y})", noun(disc.kind), disc.id)
        });
        let reach = discs[first].radius + discs[second].radius;
        let message = format!(
            "{a} and {b} overlap at the start by {penetration:.4} of the sum of their radii, {:.4e}; the limit is \
             law.max_penetration = {limit}",
            penetration * reach
        );
        let least = format!("centres at least {:.6e} apart", (1.0 - limit) * reach);
        errors.push(spot_of(document, particles, second).error(Reason::Overlap, message).expecting(least));
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

/// What is not modelled because the scene has no need of it.
fn left_out(scene: &Scene, particles: &Particles, alike: bool) -> Vec<String> {
    let contact = &scene.law.contact;
    let mut left_out = Vec::new();
    let mut leave = |condition: bool, what: &str| {
        if condition {
            left_out.push(what.to_owned());
        }
    };
    leave(contact.friction == 0.0, "friction, spin and torque: law.friction is 0");
    leave(
        contact.friction > 0.0 && contact.shear_damping == 0.0,
        "friction, spin and torque: law.shear_damping is 0",
    );
    leave(contact.normal_damping == 0.0, "normal damping: law.normal_damping is 0");
    leave(alike, "radius and mass of each disc: all are alike, so they are numbers, not vectors");
    leave(scene.domain.gravity == [0.0; 2], "gravity: domain.gravity is 0");
    leave(particles.grain_count() == particles.len(), "walls: there are no wall discs");
    leave(scene.domain.periodic == [false; 2], "periodic images: both sides are open");
    left_out
}
