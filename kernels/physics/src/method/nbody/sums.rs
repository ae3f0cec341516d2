//! Interface of the force sums over pairs of bodies, and their shared functions.

use super::bodies::StateColumns;
use crate::ranks::RankError;
use stripmine_kernels::backend;
use stripmine_kernels::isa::ProgramError;

/// Callback that returns true if a sum must stop; called now and then.
pub(crate) type StopCallback<'a> = &'a (dyn Fn() -> bool + Sync);

/// Callback that never stops a sum.
pub fn never_stop() -> bool {
    false
}

/// Implementation of the sums of forces and, if velocities are given, of their rates.
pub(crate) trait ForceSums: Send + Sync {
    /// Sums for a gravitational constant of 1. Returns the energy of the pairs if `observed`, else 0.
    ///
    /// # Errors
    /// [`ProgramError`] if the processor lacks the instruction set, or `stop` returns true.
    fn sum(
        &mut self,
        position: &StateColumns,
        velocity: Option<&StateColumns>,
        observed: bool,
        stop: StopCallback<'_>,
    ) -> Result<f64, ProgramError>;

    /// Writes the forces, and their rates, times `per_mass`.
    fn over(&self, per_mass: &[f64], into: [Option<&mut StateColumns>; 2]);

    /// Returns the lost rank, if there are several. The sums stay correct; the first rank alone calculates them from then on.
    fn lost(&self) -> Option<RankError> {
        None
    }
}

/// Returns an error if the sum must stop.
pub(super) fn check_stop(stop: StopCallback<'_>) -> Result<(), ProgramError> {
    if stop() { Err(ProgramError::Interrupted) } else { Ok(()) }
}

/// Positions, and their low parts below rounding if they have any.
pub(super) type PrecisePositions<'p> = (&'p StateColumns, Option<&'p StateColumns>);

/// Displacement from a body to another (length).
pub(super) fn displacement((position, low): PrecisePositions<'_>, body: usize, other: usize) -> [f64; 3] {
    let rounded = [0, 1, 2].map(|axis| position[axis][other] - position[axis][body]);
    match low {
        None => rounded,
        Some(low) => [0, 1, 2].map(|axis| rounded[axis] + (low[axis][other] - low[axis][body])),
    }
}

/// Energy of all pairs by the direct sum, for a gravitational constant of 1.
///
/// # Errors
/// [`ProgramError::Interrupted`] if `stop` returns true.
pub fn potential(
    mass: &[f64],
    position: &StateColumns,
    softening: f64,
    stop: StopCallback<'_>,
) -> Result<f64, ProgramError> {
    precise_potential(mass, (position, None), softening, stop)
}

/// Energy of all pairs as [`potential`], at positions with low parts.
pub(super) fn precise_potential(
    mass: &[f64],
    positions: PrecisePositions<'_>,
    softening: f64,
    stop: StopCallback<'_>,
) -> Result<f64, ProgramError> {
    let mut energy = 0.0;
    for body in 0..mass.len() {
        check_stop(stop)?;
        for other in 0..body {
            let squares = displacement(positions, body, other).map(|d| d * d);
            energy -= mass[body] * mass[other] / (squares.iter().sum::<f64>() + softening * softening).sqrt();
        }
    }
    Ok(energy)
}

/// Writes three sums, converted from their unit, times `per_mass`.
pub(super) fn over<P: backend::Precision>(
    sums: &[Vec<P>],
    unit: f64,
    per_mass: &[f64],
    into: Option<&mut StateColumns>,
) {
    for (into, sum) in into.into_iter().flatten().zip(sums) {
        for ((into, sum), per_mass) in into.iter_mut().zip(sum).zip(per_mass) {
            *into = unit * sum.to_f64() * per_mass;
        }
    }
}
