//! Beginning of the integrator at the end of a step, with other velocities or another gravity.

use super::PairEngine;
use super::search::PairSearch;
use super::state::StepEndRow;
use crate::method::PhysicsFailure;
use stripmine_kernels::backend::Precision;

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> PairEngine<S, P, Q> {
    /// Takes the end of the step as a start, with the velocities and angular velocities of all discs in the scene's order. Forces must be computed next.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if a disc belongs to no cell.
    pub(super) fn begin_from_step_end(&mut self, motion: &[([f64; 3], f64)]) -> Result<(), PhysicsFailure> {
        let grains: Vec<u32> = (0..self.state.moving() as u32).collect();
        let mut rows = vec![StepEndRow::default(); grains.len()];
        self.correct(&grains, &mut rows);
        let carried: Vec<(usize, usize)> = self.state.carried().collect();
        for (disc, row) in rows.iter().enumerate() {
            let ([u, v, _], omega) = motion[self.state.number(disc)];
            for &(freedom, derivative) in &carried {
                let value = match derivative {
                    0 => row[freedom][0],
                    1 => [u, v, omega][freedom] * self.state.velocity_scale(),
                    _ => 0.0,
                };
                self.state.set_derivative((freedom, derivative), disc, S::from_f64(value));
            }
        }
        self.settle_all()?;
        self.sums.clear(0..self.state.len());
        self.elapsed.begun = self.elapsed.steps;
        Ok(())
    }

    /// Replaces gravity (length/time²), and counts crossings along these axes from now on, too.
    pub(super) fn replace_gravity(&mut self, gravity: [f64; 2], followed: [bool; 2]) {
        self.system.gravity = gravity;
        self.system.followed = followed;
        self.elapsed.crossings.follow(followed, self.start.len());
    }
}
