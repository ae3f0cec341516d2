//! Discs as failures name them, and the failures that several searches share.

use crate::domain::Domain;
use crate::method::{Clock, Culprit, FailureKind, PhysicsFailure};
use crate::number::significant;
use crate::particles::in_plane;
use std::ops::Range;

/// Discs that failures can name, by their index in memory.
pub(crate) trait NameableDiscs {
    /// Progress of the simulation.
    fn clock(&self) -> Clock;

    /// The box.
    fn domain(&self) -> Domain;

    /// Indices of the discs that forces move.
    fn grains(&self) -> Range<usize>;

    /// Number of a disc in the scene.
    fn number(&self, disc: usize) -> usize;

    fn id(&self, disc: usize) -> u32;

    /// Position of a disc (length).
    fn position(&self, disc: usize) -> [f64; 2];

    /// Velocity of a disc (length/time).
    fn velocity(&self, disc: usize) -> [f64; 2];

    /// The radius of a disc (length).
    fn radius(&self, disc: usize) -> f64;

    /// Description of a disc for a failure.
    fn culprit(&self, disc: usize) -> Culprit {
        Culprit::in_plane("disc", self.id(disc), self.position(disc), self.velocity(disc))
    }

    /// Penetration of two discs, as a fraction of the sum of their radii.
    fn penetration(&self, [first, second]: [usize; 2]) -> f64 {
        let [dx, dy] = self.domain().displacement(self.position(first), self.position(second));
        1.0 - dx.hypot(dy) / (self.radius(first) + self.radius(second))
    }

    /// Failure of grains outside the box, if any.
    fn beyond_box(&self) -> Option<PhysicsFailure> {
        let domain = self.domain();
        let beyond = || self.grains().filter(|&disc| !domain.contains(self.position(disc)));
        let first = self.culprit(beyond().min_by_key(|&disc| self.number(disc))?);
        Some(out_of_box(self.clock(), beyond().count() as u64, first))
    }
}

/// Failure of discs outside all cells: outside the box, or at a position that is not finite.
pub(crate) fn outside(at: Clock, count: u64, first: Culprit) -> PhysicsFailure {
    match first.position.iter().all(|along| along.is_finite()) {
        true => out_of_box(at, count, first),
        false => not_finite(at, count, first),
    }
}

/// Failure of discs that left the box.
fn out_of_box(at: Clock, count: u64, first: Culprit) -> PhysicsFailure {
    let what = format!("{count} discs left the box, first {first}");
    let remedy = "a disc passed a wall, a wall moved out of the box, or the time step is too large: use a larger box, larger or \
                  stiffer wall discs, slower grains, or a smaller dt";
    PhysicsFailure::new(FailureKind::OUT_OF_BOX, what, remedy).at(at).of(count, [first])
}

/// Failure of discs whose position or force is not finite.
pub(crate) fn not_finite(at: Clock, count: u64, first: Culprit) -> PhysicsFailure {
    let what = format!("{count} discs have a position or force that is not finite, first {first}");
    let remedy =
        "the time step is too large for the stiffness or the damping: halve dt, or use fewer Gear values";
    PhysicsFailure::new(FailureKind::NOT_FINITE, what, remedy).at(at).of(count, [first])
}

/// Failure of two discs in one cell: the exclusive lattice would lose one.
pub(crate) fn conflict(at: Clock, domain: Domain, [first, second]: [Culprit; 2]) -> PhysicsFailure {
    let [first_place, second_place] = [first, second].map(|disc| in_plane(disc.position));
    let [dx, dy] = domain.displacement(first_place, second_place);
    let distance = dx.hypot(dy);
    let what = format!(
        "{first} and {second} are in one cell, {} apart; the exclusive lattice holds one disc a cell",
        significant(distance, 7)
    );
    let remedy = "the discs overlap too deeply (stiffen the contacts), or the cells are too large (set search.cell_edge \
                  towards the largest radius)";
    let failure = PhysicsFailure::new(FailureKind::CONFLICT, what, remedy).at(at).of(2, [first, second]);
    failure.with([("distance", distance)])
}
