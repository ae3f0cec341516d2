//! What a step is judged and accounted by, beside its forces: steps that are too long, periods crossed, powers.

use super::LatticeMd;
use crate::method::Failure;
use crate::method::lattice_md::Engine;
use crate::method::lattice_md::OnLongStep;
use crate::method::lattice_md::walls::walls_at;
use crate::scene::WallMotion;
use stripmine_kernels::backend;
use stripmine_kernels::isa::Array;

impl<S: backend::Precision, P: backend::Precision> LatticeMd<S, P> {
    /// Discs that are so fast that contacts may pass unseen in a step.
    pub(super) fn judge_steps(&mut self) -> Result<(), Failure> {
        let Some(watch) = self.model.watch else { return Ok(()) };
        let column = |array| self.arrays.state(array).unwrap_or(&[]);
        let (x, y) = (column(Array::X1), column(Array::Y1));
        let square = S::from_f64(watch.longest_step() * watch.longest_step());
        // What is no number is found when the cells are.
        let is_far = |&(x, y): &(&S, &S)| square.less_than(*x * *x + *y * *y);
        let grains = || x.iter().zip(y).take(self.arrays.lengths().grains);
        let count = grains().filter(is_far).count() as u64;
        if count == 0 {
            return Ok(());
        }
        self.totals.long_steps += count;
        match (watch.on_long_step, grains().position(|step| is_far(&step))) {
            (OnLongStep::Stop, Some(first)) => {
                Err(self.names().long_step(count, first, watch.longest_step()))
            }
            _ => Ok(()),
        }
    }

    /// Periods that discs crossed when the Index wrapped them: no step is as long as half the box.
    pub(super) fn count_crossings(&mut self) {
        if !self.crossings.is_followed() {
            return;
        }
        let counts = [self.model.shape.columns(), self.model.shape.rows()];
        for (disc, (&from, &to)) in self.anchor.iter().zip(self.arrays.cell()).enumerate() {
            if from == to || from == 0 || to == 0 {
                continue;
            }
            let [from, to] = [from, to].map(|cell| self.model.shape.column_and_row(cell as usize - 1));
            let crossed = [0, 1].map(|axis| {
                let moved = to[axis] - from[axis];
                if 2 * moved.unsigned_abs() > counts[axis] { -(moved.signum() as f64) } else { 0.0 }
            });
            self.crossings.add(disc, crossed);
        }
    }

    /// What moving walls put in (energy/time): all walls have one velocity, and what they do to the grains is the sum of
    /// the grains' forces, for those of two grains cancel.
    pub(super) fn wall_power(&self) -> f64 {
        if self.walls == WallMotion::Fixed || !self.model.follows_energy() {
            return 0.0;
        }
        let (_, velocity) = walls_at(self.walls, self.time());
        let grains = self.arrays.lengths().grains;
        let along = |axis: usize| -> f64 {
            let column = self.arrays.lattice([Array::Fx, Array::Fy][axis]).unwrap_or(&[]);
            let forces = (0..grains).filter_map(|disc| Some(column[self.arrays.force_at(disc)?].to_f64()));
            velocity[axis] * forces.sum::<f64>()
        };
        along(0) + along(1)
    }

    /// What the contacts found in the sweep of the lattice dissipate (energy/time).
    pub(super) fn power_on_lattice(&self) -> f64 {
        let Some(power) = self.arrays.lattice(Array::Power) else { return 0.0 };
        let grains = &self.arrays.cell()[..self.arrays.lengths().grains];
        grains.iter().map(|&cell| power[cell as usize - 1].to_f64()).sum()
    }
}
