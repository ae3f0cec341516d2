//! Identifies the discs that violated a precondition, after a counter reported one.

use super::LatticeMd;
use crate::domain::Domain;
use crate::method::lattice_md::options::ProgramVersion;
use crate::method::pairwise::{NameableDiscs, conflict, not_finite, outside};
use crate::method::{Clock, PhysicsFailure};
use std::ops::Range;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::Array;

impl<S: Precision, P: Precision> NameableDiscs for LatticeMd<S, P> {
    fn clock(&self) -> Clock {
        self.elapsed.clock()
    }

    fn domain(&self) -> Domain {
        self.model.domain()
    }

    fn grains(&self) -> Range<usize> {
        0..self.arrays.lengths().grains
    }

    fn number(&self, disc: usize) -> usize {
        disc
    }

    fn id(&self, disc: usize) -> u32 {
        self.start.all()[disc].id
    }

    fn position(&self, disc: usize) -> [f64; 2] {
        let place = [Array::X0, Array::Y0]
            .map(|axis| self.arrays.state(axis).map_or(f64::NAN, |column| column[disc].to_f64()));
        if !self.model.is_anchored::<S>() {
            return place;
        }
        let own = self.arrays.cell()[disc];
        // A stray has no cell now, but had one before.
        let cell = if own == 0 { self.anchor.get(disc).copied().unwrap_or_default() } else { own };
        self.model.position(cell, place)
    }

    fn velocity(&self, disc: usize) -> [f64; 2] {
        match self.model.text {
            ProgramVersion::Ours => [Array::DiscVx, Array::DiscVy]
                .map(|axis| self.arrays.lattice(axis).map_or(f64::NAN, |column| column[disc].to_f64())),
            ProgramVersion::Printed => [Array::X1, Array::Y1]
                .map(|axis| self.arrays.state(axis).map_or(f64::NAN, |column| column[disc].to_f64())),
        }
    }

    fn radius(&self, disc: usize) -> f64 {
        let column = || self.arrays.constant(Array::DiscRadius);
        let own = || column().map_or(f64::NAN, |radius| radius[disc].to_f64());
        self.model.radius().unwrap_or_else(own)
    }
}

impl<S: Precision, P: Precision> LatticeMd<S, P> {
    /// True if a disc belongs to no cell.
    fn is_stray(&self, disc: usize) -> bool {
        match self.model.text {
            ProgramVersion::Ours => self.arrays.cell()[disc] == 0,
            // Cells are not computed where there is a stray.
            ProgramVersion::Printed => {
                let (at, domain) = (self.position(disc), self.model.domain());
                let [low, sides] = [domain.corner(), domain.lengths()];
                (0..2).any(|axis| !(low[axis]..=low[axis] + sides[axis]).contains(&at[axis]))
            }
        }
    }

    /// Failure of discs that belong to no cell.
    pub(super) fn stray(&self, count: u64) -> Option<PhysicsFailure> {
        let strays = || (0..self.start.len()).filter(|&disc| self.is_stray(disc));
        let lost = |disc: &usize| self.position(*disc).iter().any(|r| !r.is_finite());
        // Positions that are not finite are reported before positions outside.
        let (first, count) = match strays().find(lost) {
            Some(first) => (first, strays().filter(lost).count() as u64),
            None => (strays().next()?, count),
        };
        Some(outside(self.clock(), count, self.culprit(first)))
    }

    /// Failure of discs whose cell is taken by another disc.
    pub(super) fn conflicting(&self) -> Option<PhysicsFailure> {
        let cell = self.arrays.cell();
        let index = self.arrays.index();
        let taken = |disc: &usize| cell[*disc] != 0 && index[cell[*disc] as usize - 1] != *disc as u32 + 1;
        let first = (0..self.start.len()).find(taken)?;
        let second = index[cell[first] as usize - 1] as usize - 1;
        Some(conflict(self.clock(), self.domain(), [self.culprit(first), self.culprit(second)]))
    }

    /// Failure of discs whose correction is not finite.
    pub(super) fn not_finite(&self, count: u64) -> Option<PhysicsFailure> {
        let disc = (0..self.start.len()).find(|&disc| {
            let moved =
                [Array::X2, Array::Y2, Array::Phi2].into_iter().filter_map(|array| self.arrays.state(array));
            moved.into_iter().any(|column| !column[disc].to_f64().is_finite())
        })?;
        Some(not_finite(self.clock(), count, self.culprit(disc)))
    }

    /// Pairs that may be too deep: those around the cells that the sweep marked.
    pub(super) fn marked_on_lattice(&self, depth: f64) -> Vec<[u32; 2]> {
        let Some(deepest) = self.arrays.lattice(Array::Deepest) else { return vec![] };
        let index = self.arrays.index();
        let marked = |position: &usize| index[*position] != 0 && deepest[*position].to_f64() > depth;
        let around = |position: usize| {
            let own = index[position] as usize - 1;
            let shifts = self.model.mask.offsets().iter().map(|&offset| self.model.shape.shift(offset));
            let partners = shifts.map(move |shift| index[position.wrapping_add_signed(shift)] as usize);
            partners
                .filter(move |&there| there != 0 && there - 1 != own)
                .map(move |there| [own, there - 1].map(|disc| disc as u32))
        };
        self.model.shape.swept().filter(marked).flat_map(around).collect()
    }
}
