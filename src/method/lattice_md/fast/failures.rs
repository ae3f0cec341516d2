//! Who broke a precondition.

use super::FastMd;
use super::search::Search;
use super::state::Move;
use crate::method::lattice_md::OnLongStep;
use crate::method::{Culprit, Failure};
use stripmine_kernels::backend::Precision;
use stripmine_kernels::sweep::fast::Met;

impl<S: Precision, P: Precision, Q: Search<S, P>> FastMd<S, P, Q> {
    fn culprit_at(&self, disc: usize, position: [f64; 2]) -> Culprit {
        let velocity = [0, 1].map(|axis| self.state.row(axis, disc)[1].to_f64() / self.model.dt);
        let number = self.state.number(disc);
        Culprit { id: self.start.all()[number].id, position, velocity }
    }

    fn culprit(&self, disc: usize) -> Culprit {
        self.culprit_at(disc, self.position(disc, self.state.place(disc)))
    }

    /// A disc that no cell takes: outside the box, or nowhere.
    pub(super) fn stray(&self, Move { disc, cell, place, .. }: Move, count: u64) -> Failure {
        let frame = self.search.grid().frame;
        let centre = [0, 1].map(|axis| frame.origin[axis] + (cell[axis] as f64 + 0.5) * frame.edge[axis]);
        let first = self.culprit_at(disc, [centre[0] + place[0], centre[1] + place[1]]);
        let step = self.steps;
        if place.iter().all(|along| along.is_finite()) {
            Failure::OutOfBox { step, count, first }
        } else {
            Failure::NotFinite { step, count, first }
        }
    }

    /// Grains outside the box, where the lattice reaches beyond it.
    pub(super) fn refuse_beyond_box(&self) -> Result<(), Failure> {
        if !self.model.reaches_beyond_box() {
            return Ok(());
        }
        let domain = self.model.domain();
        let is_beyond = |disc: &usize| !domain.contains(self.position(*disc, self.state.place(*disc)));
        let beyond: Vec<usize> = (0..self.start.grain_count()).filter(is_beyond).collect();
        match beyond.iter().copied().min_by_key(|&disc| self.state.number(disc)) {
            Some(first) => {
                let (step, count) = (self.steps, beyond.len() as u64);
                Err(Failure::OutOfBox { step, count, first: self.culprit(first) })
            }
            None => Ok(()),
        }
    }

    /// Two discs that want one cell, with where they go if they are moving.
    pub(super) fn conflict(&self, discs: [(usize, Option<&Move>); 2]) -> Failure {
        let frame = self.search.grid().frame;
        let [first, second] = discs.map(|(disc, to)| match to {
            None => self.culprit(disc),
            Some(to) => {
                let along = |axis: usize| (to.cell[axis] as f64 + 0.5) * frame.edge[axis] + to.place[axis];
                self.culprit_at(disc, [0, 1].map(|axis| frame.origin[axis] + along(axis)))
            }
        });
        let [dx, dy] = self.model.domain().way(first.position, second.position);
        Failure::Conflict { step: self.steps, first, second, distance: dx.hypot(dy) }
    }

    /// Penetration of two discs, as a fraction of the sum of their radii.
    fn penetration(&self, [first, second]: [usize; 2]) -> f64 {
        let at = |disc: usize| self.position(disc, self.state.place(disc));
        let [dx, dy] = self.model.domain().way(at(first), at(second));
        let reach = self.state.radius(first) + self.state.radius(second);
        1.0 - dx.hypot(dy) / reach
    }

    /// Counts discs that are so fast that contacts may pass unseen in a step, and stops if there must be none.
    pub(super) fn judge_steps(&mut self, far: &[u32]) -> Result<(), Failure> {
        let Some(watch) = self.model.watch.filter(|_| !far.is_empty()) else { return Ok(()) };
        let speed = |disc: usize| {
            let [x, y] = [0, 1].map(|axis| self.state.row(axis, disc)[1].to_f64() / self.model.dt);
            x.hypot(y)
        };
        // What is no number has been found with the cells.
        let discs = || far.iter().map(|&disc| disc as usize).filter(|&disc| !speed(disc).is_nan());
        let count = discs().count() as u64;
        self.totals.long_steps += count;
        let Some(first) = discs().min_by_key(|&disc| self.state.number(disc)) else { return Ok(()) };
        let (limit, step) = (watch.longest_step(), self.steps);
        match watch.on_long_step {
            OnLongStep::Count => Ok(()),
            OnLongStep::Stop => {
                let dt = limit / speed(first);
                Err(Failure::LongStep { step, count, first: self.culprit(first), limit, dt })
            }
        }
    }

    /// Counts deep contacts, and stops at what must not be.
    pub(super) fn judge(&mut self, met: &Met) -> Result<(), Failure> {
        let grains = self.start.grain_count();
        let pairs = |list: &[[u32; 2]]| -> Vec<[usize; 2]> {
            list.iter().map(|pair| pair.map(|disc| disc as usize)).collect()
        };
        // Two fixed discs have no effective mass: what they do to each other means nothing.
        let of_grains =
            pairs(&met.not_finite).into_iter().filter(|pair| pair.iter().any(|&disc| disc < grains));
        let lost: Vec<usize> = of_grains.flatten().collect();
        // A disc that is lost itself is named before one that only touches it.
        let is_lost = |disc: usize| {
            (0..self.model.freedoms()).any(|freedom| !self.state.row(freedom, disc)[1].to_f64().is_finite())
        };
        let first = lost.iter().min_by_key(|&&disc| (!is_lost(disc), self.state.number(disc)));
        if let Some(&first) = first {
            let first = self.culprit(first);
            return Err(Failure::NotFinite { step: self.steps, count: lost.len() as u64, first });
        }
        let Some(watch) = self.model.watch else { return Ok(()) };
        let is_grain = |disc: usize| disc < grains;
        let of_grains = pairs(&met.deep).into_iter().filter(|pair| pair.iter().any(|&disc| is_grain(disc)));
        let penetrations = of_grains.map(|pair| (self.penetration(pair), pair));
        let deep: Vec<(f64, [usize; 2])> =
            penetrations.filter(|deep| deep.0 > watch.max_penetration).collect();
        let mut discs: Vec<usize> =
            deep.iter().flat_map(|deep| deep.1).filter(|&disc| is_grain(disc)).collect();
        discs.sort_unstable();
        discs.dedup();
        let deepest = deep.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((penetration, [first, second])) = deepest else { return Ok(()) };
        self.totals.add_deep(self.steps, discs.len() as u64, penetration);
        if penetration > watch.stop_penetration {
            let (first, second) = (self.culprit(first), self.culprit(second));
            let (step, limit) = (self.steps, watch.stop_penetration);
            return Err(Failure::TooDeep { step, first, second, penetration, limit });
        }
        Ok(())
    }
}
