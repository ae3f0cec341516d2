//! Accounting of a step beside its forces: steps that are too long, crossed periods, powers.

use super::LatticeMd;
use crate::method::lattice_md::programs::scales;
use stripmine_kernels::backend;
use stripmine_kernels::isa::Array;

impl<S: backend::Precision, P: backend::Precision> LatticeMd<S, P> {
    /// Discs so fast that a step may miss their contacts.
    pub(super) fn far(&self) -> Vec<u32> {
        let Some(watch) = self.model.watch else { return vec![] };
        let column = |array| self.arrays.state(array).unwrap_or(&[]);
        let velocities = column(Array::X1).iter().zip(column(Array::Y1)).take(self.arrays.lengths().grains);
        // Velocity of such a step, in the scale of the state.
        let fastest = watch.longest_step() * (scales(&self.model)[1] / self.model.dt);
        let square = S::from_f64(fastest * fastest);
        let is_far = |(x, y): (&S, &S)| square.less_than(*x * *x + *y * *y);
        (0..).zip(velocities).filter(|&(_, velocity)| is_far(velocity)).map(|(disc, _)| disc).collect()
    }

    /// Counts the periods that discs crossed when the Index wrapped them: no step is as long as half the box.
    pub(super) fn count_crossings(&mut self) {
        if !self.elapsed.crossings.is_followed() {
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
            self.elapsed.crossings.add(disc, crossed);
        }
    }

    /// Power dissipated by the contacts of the lattice sweep (energy/time).
    pub(super) fn power_on_lattice(&self) -> f64 {
        let Some(power) = self.arrays.lattice(Array::Power) else { return 0.0 };
        let grains = &self.arrays.cell()[..self.arrays.lengths().grains];
        grains.iter().map(|&cell| power[cell as usize - 1].to_f64()).sum()
    }
}
