//! Sums over pairs of bodies: what every way to them gives, and what the ways share.

use super::bodies::Columns;
use crate::ranks::RankError;
use stripmine_kernels::backend;
use stripmine_kernels::isa::ProgramError;

/// Asked now and then whether to stop.
pub(crate) type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Never stops.
pub fn never() -> bool {
    false
}

/// A way to sum up forces and, where velocities are given, their rates.
pub(crate) trait Sums: Send + Sync {
    /// Sums up for a gravitational constant of 1; gives the energy of the pairs if it is observed, else 0.
    ///
    /// # Errors
    /// [`ProgramError`] if the processor lacks what is asked for, or `stop` says so.
    fn sum(
        &mut self,
        position: &Columns,
        velocity: Option<&Columns>,
        observed: bool,
        stop: Stop<'_>,
    ) -> Result<f64, ProgramError>;

    /// The forces, and their rates, times `per_mass`.
    fn over(&self, per_mass: &[f64], into: [Option<&mut Columns>; 2]);

    /// The rank that was lost, where there are several: sums are right, and are those of the first rank alone since.
    fn lost(&self) -> Option<RankError> {
        None
    }
}

/// Stops where it should.
pub(super) fn go_on(stop: Stop<'_>) -> Result<(), ProgramError> {
    if stop() { Err(ProgramError::Interrupted) } else { Ok(()) }
}

/// The energy of all pairs, as it is written, for a gravitational constant of 1.
///
/// # Errors
/// [`ProgramError::Interrupted`] if `stop` says so.
pub fn potential(
    mass: &[f64],
    position: &Columns,
    softening: f64,
    stop: Stop<'_>,
) -> Result<f64, ProgramError> {
    let mut energy = 0.0;
    for body in 0..mass.len() {
        go_on(stop)?;
        for other in 0..body {
            let squares = position.iter().map(|column| (column[body] - column[other]).powi(2));
            energy -= mass[body] * mass[other] / (squares.sum::<f64>() + softening * softening).sqrt();
        }
    }
    Ok(energy)
}

/// Three sums in their unit times `per_mass`.
pub(super) fn over<P: backend::Precision>(
    sums: &[Vec<P>],
    unit: f64,
    per_mass: &[f64],
    into: Option<&mut Columns>,
) {
    for (into, sum) in into.into_iter().flatten().zip(sums) {
        for ((into, sum), per_mass) in into.iter_mut().zip(sum).zip(per_mass) {
            *into = unit * sum.to_f64() * per_mass;
        }
    }
}
