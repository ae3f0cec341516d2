//! Which discs broke a precondition, once a counter says that one did.

use super::{Arrays, Model};
use crate::method::{Culprit, Failure};
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::Array;

/// What is needed to name a disc.
pub(super) struct Names<'a, S, P> {
    pub(super) model: &'a Model,
    pub(super) arrays: &'a Arrays<S, P>,
    /// The cells from which discs are seen while these are looked for; empty if they are those of the arrays.
    pub(super) anchor: &'a [u32],
    pub(super) ids: &'a [u32],
    pub(super) step: u64,
}

impl<S: Precision, P: Precision> Names<'_, S, P> {
    fn position(&self, disc: usize) -> [f64; 2] {
        let place = [Array::X0, Array::Y0]
            .map(|axis| self.arrays.state(axis).map_or(f64::NAN, |column| column[disc].to_f64()));
        if !self.model.is_anchored::<S>() {
            return place;
        }
        let own = self.arrays.cell()[disc];
        // A stray is in no cell, but was in one.
        let cell = if own == 0 { self.anchor.get(disc).copied().unwrap_or_default() } else { own };
        self.model.position(cell, place)
    }

    fn culprit(&self, disc: usize) -> Culprit {
        let velocity = [Array::DiscVx, Array::DiscVy]
            .map(|axis| self.arrays.lattice(axis).map_or(f64::NAN, |column| column[disc].to_f64()));
        Culprit { id: self.ids[disc], position: self.position(disc), velocity }
    }

    fn distance(&self, first: usize, second: usize) -> f64 {
        let [dx, dy] = self.model.domain().way(self.position(first), self.position(second));
        dx.hypot(dy)
    }

    /// Discs that belong to no cell.
    pub(super) fn stray(&self, count: u64) -> Option<Failure> {
        let strays = || (0..self.ids.len()).filter(|&disc| self.arrays.cell()[disc] == 0);
        let lost = |disc: &usize| self.position(*disc).iter().any(|r| !r.is_finite());
        if let Some(first) = strays().find(lost) {
            let count = strays().filter(lost).count() as u64;
            return Some(Failure::NotFinite { step: self.step, count, first: self.culprit(first) });
        }
        let first = self.culprit(strays().next()?);
        Some(Failure::OutOfBox { step: self.step, count, first })
    }

    /// Grains outside the box, where the lattice reaches beyond it.
    pub(super) fn beyond_box(&self) -> Option<Failure> {
        let domain = self.model.domain();
        let grains = 0..self.arrays.lengths().grains;
        let beyond = || grains.clone().filter(|&disc| !domain.contains(self.position(disc)));
        let first = self.culprit(beyond().next()?);
        Some(Failure::OutOfBox { step: self.step, count: beyond().count() as u64, first })
    }

    /// Discs whose cell another one took.
    pub(super) fn conflict(&self) -> Option<Failure> {
        let cell = self.arrays.cell();
        let index = self.arrays.index();
        let taken = |disc: &usize| cell[*disc] != 0 && index[cell[*disc] as usize - 1] != *disc as u32 + 1;
        let first = (0..self.ids.len()).find(taken)?;
        let second = index[cell[first] as usize - 1] as usize - 1;
        let distance = self.distance(first, second);
        let (first, second) = (self.culprit(first), self.culprit(second));
        Some(Failure::Conflict { step: self.step, first, second, distance })
    }

    /// Discs whose correction was no finite number.
    pub(super) fn not_finite(&self, count: u64) -> Option<Failure> {
        let disc = (0..self.ids.len()).find(|&disc| {
            let moved =
                [Array::X2, Array::Y2, Array::Phi2].into_iter().filter_map(|array| self.arrays.state(array));
            moved.into_iter().any(|column| !column[disc].to_f64().is_finite())
        })?;
        Some(Failure::NotFinite { step: self.step, count, first: self.culprit(disc) })
    }

    fn radius(&self, disc: usize) -> f64 {
        match self.model.discs {
            super::Discs::Equal { disc, .. } => disc.radius,
            super::Discs::Varying => {
                self.arrays.constant(Array::DiscRadius).map_or(f64::NAN, |radius| radius[disc].to_f64())
            }
        }
    }

    /// Penetration of two discs, as a fraction of the sum of their radii.
    pub(super) fn penetration(&self, first: usize, second: usize) -> f64 {
        let reach = self.radius(first) + self.radius(second);
        1.0 - self.distance(first, second) / reach
    }

    /// Pairs that may be too deep: around the cells that the sweep marked.
    pub(super) fn marked_on_lattice(&self, depth: f64) -> Vec<(usize, usize)> {
        let Some(deepest) = self.arrays.lattice(Array::Deepest) else { return vec![] };
        let index = self.arrays.index();
        let marked = |position: &usize| index[*position] != 0 && deepest[*position].to_f64() > depth;
        let around = |position: usize| {
            let own = index[position] as usize - 1;
            let shifts = self.model.mask.offsets().iter().map(|&offset| self.model.shape.shift(offset));
            let partners = shifts.map(move |shift| index[position.wrapping_add_signed(shift)] as usize);
            partners.filter(move |&there| there != 0 && there - 1 != own).map(move |there| (own, there - 1))
        };
        self.model.shape.swept().filter(marked).flat_map(around).collect()
    }

    /// Of pairs, each from both sides and with the pairs of one disc side by side: how many grains are deeper in one than
    /// the limit, and the deepest contact of a grain: penetration and the two discs.
    pub(super) fn deep(&self, pairs: &[(usize, usize)], limit: f64) -> (u64, Option<(f64, usize, usize)>) {
        let mut grains = 0;
        let mut deepest: Option<(f64, usize, usize)> = None;
        let is_grain = |disc: usize| disc < self.arrays.lengths().grains;
        for of_disc in pairs.chunk_by(|a, b| a.0 == b.0).filter(|pairs| is_grain(pairs[0].0)) {
            let penetrations = of_disc.iter().map(|&(own, there)| (self.penetration(own, there), own, there));
            let Some(worst) = penetrations.max_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            if worst.0 > limit {
                grains += 1;
                if deepest.is_none_or(|(deepest, ..)| worst.0 > deepest) {
                    deepest = Some(worst);
                }
            }
        }
        (grains, deepest)
    }

    /// The failure of grains that are too fast.
    pub(super) fn long_step(&self, count: u64, first: usize, limit: f64) -> Failure {
        let first = self.culprit(first);
        let dt = limit / first.velocity[0].hypot(first.velocity[1]);
        Failure::LongStep { step: self.step, count, first, limit, dt }
    }

    /// The failure of a contact that is too deep.
    pub(super) fn too_deep(&self, (penetration, first, second): (f64, usize, usize), limit: f64) -> Failure {
        let (first, second) = (self.culprit(first), self.culprit(second));
        Failure::TooDeep { step: self.step, first, second, penetration, limit }
    }
}
