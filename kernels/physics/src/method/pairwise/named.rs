//! Discs as failures name them.

use crate::domain::Domain;
use crate::method::{Clock, Culprit, Failure, FailureKind};
use crate::number::significant;
use crate::particles::in_plane;
use std::ops::Range;

/// Discs that can be named, by their numbers in memory.
pub(crate) trait Named {
    /// How far the simulation has come.
    fn clock(&self) -> Clock;

    /// The box.
    fn domain(&self) -> Domain;

    /// The discs that forces move.
    fn grains(&self) -> Range<usize>;

    /// Which of the scene's discs a disc is.
    fn number(&self, disc: usize) -> usize;

    fn id(&self, disc: usize) -> u32;

    /// Where a disc is (length).
    fn position(&self, disc: usize) -> [f64; 2];

    /// How fast a disc is (length/time).
    fn velocity(&self, disc: usize) -> [f64; 2];

    /// The radius of a disc (length).
    fn radius(&self, disc: usize) -> f64;

    /// A disc, where it is.
    fn culprit(&self, disc: usize) -> Culprit {
        Culprit::in_plane("disc", self.id(disc), self.position(disc), self.velocity(disc))
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
        Some(out_of_box(self.clock(), beyond().count() as u64, first))
    }
}

/// The failure of discs that no cell takes: outside the box, or at no finite place.
pub(crate) fn outside(at: Clock, count: u64, first: Culprit) -> Failure {
    match first.position.iter().all(|along| along.is_finite()) {
        true => out_of_box(at, count, first),
        false => not_finite(at, count, first),
    }
}

/// The failure of discs that left the box.
fn out_of_box(at: Clock, count: u64, first: Culprit) -> Failure {
    let what = format!("{count} discs left the box, first {first}");
    let remedy = "a wall was passed or the time step is too large: use larger or stiffer wall discs, slower grains, or a \
                  smaller dt";
    Failure::new(FailureKind::OUT_OF_BOX, what, remedy).at(at).of(count, [first])
}

/// The failure of discs that are nowhere, or that no finite force acts on.
pub(crate) fn not_finite(at: Clock, count: u64, first: Culprit) -> Failure {
    let what = format!("{count} discs have a position or force that is no finite number, first {first}");
    let remedy =
        "the time step is too large for the stiffness or the damping: halve dt, or use fewer Gear values";
    Failure::new(FailureKind::NOT_FINITE, what, remedy).at(at).of(count, [first])
}

/// The failure of two discs in one cell: the exclusive lattice would lose one.
pub(crate) fn conflict(at: Clock, domain: Domain, [first, second]: [Culprit; 2]) -> Failure {
    let [first_place, second_place] = [first, second].map(|disc| in_plane(disc.position));
    let [dx, dy] = domain.displacement(first_place, second_place);
    let distance = dx.hypot(dy);
    let what = format!(
        "{first} and {second} are in one cell, {} apart; the exclusive lattice holds one disc a cell",
        significant(distance, 7)
    );
    let remedy = "the discs overlap too deeply (stiffen the contacts), or the cells are too large (set search.cell_edge \
                  towards the largest radius)";
    let failure = Failure::new(FailureKind::CONFLICT, what, remedy).at(at).of(2, [first, second]);
    failure.with([("distance", distance)])
}
