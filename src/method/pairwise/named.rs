//! Discs as failures name them.

use crate::domain::Domain;
use crate::method::{Culprit, Failure};
use std::ops::Range;

/// Discs that can be named, by their numbers in memory.
pub trait Named {
    /// The step.
    fn step(&self) -> u64;

    /// The box.
    fn domain(&self) -> Domain;

    /// The discs that forces move.
    fn grains(&self) -> Range<usize>;

    /// Which of the scene's discs a disc is.
    fn number(&self, disc: usize) -> usize;

    /// The id of a disc.
    fn id(&self, disc: usize) -> u32;

    /// Where a disc is (length).
    fn position(&self, disc: usize) -> [f64; 2];

    /// How fast a disc is (length/time).
    fn velocity(&self, disc: usize) -> [f64; 2];

    /// The radius of a disc (length).
    fn radius(&self, disc: usize) -> f64;

    /// A disc, where it is.
    fn culprit(&self, disc: usize) -> Culprit {
        Culprit { id: self.id(disc), position: self.position(disc), velocity: self.velocity(disc) }
    }

    /// Penetration of two discs, as a fraction of the sum of their radii.
    fn penetration(&self, [first, second]: [usize; 2]) -> f64 {
        let [dx, dy] = self.domain().displacement(self.position(first), self.position(second));
        1.0 - dx.hypot(dy) / (self.radius(first) + self.radius(second))
    }

    /// The failure of grains outside the box, if there are such.
    fn beyond_box(&self) -> Option<Failure> {
        let domain = self.domain();
        let beyond = || self.grains().filter(|&disc| !domain.contains(self.position(disc)));
        let first = self.culprit(beyond().min_by_key(|&disc| self.number(disc))?);
        Some(Failure::OutOfBox { step: self.step(), count: beyond().count() as u64, first })
    }
}

/// The failure of discs that no cell takes: outside the box, or at no finite place.
pub fn outside(step: u64, count: u64, first: Culprit) -> Failure {
    if first.position.iter().all(|along| along.is_finite()) {
        Failure::OutOfBox { step, count, first }
    } else {
        Failure::NotFinite { step, count, first }
    }
}

/// The failure of two discs in one cell.
pub fn conflict(step: u64, domain: Domain, [first, second]: [Culprit; 2]) -> Failure {
    let [dx, dy] = domain.displacement(first.position, second.position);
    Failure::Conflict { step, first, second, distance: dx.hypot(dy) }
}
