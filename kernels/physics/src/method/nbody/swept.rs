//! Force sum that visits each pair once, in vector registers and on threads.

use super::bodies::{PointMasses, StateColumns};
use super::rounded::RoundedBodies;
use super::sums::{ForceSums, StopCallback, over};
use crate::ranks::{RankError, numbers};
use std::ops::Range;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend;
use stripmine_kernels::isa::{AlignedColumn, ProgramError};
use stripmine_kernels::law::gravity::Gravity;
use stripmine_kernels::sweep::all_pairs::{AllPairs, AllPairsOptions, Arithmetic, padded_length};

/// Sweep over all pairs in precision `P`.
pub(super) struct PairSweep<P> {
    softening: f64,
    count: usize,
    set: InstructionSet,
    arithmetic: Arithmetic,
    forces: AllPairs<P, 3>,
    rates: Option<AllPairs<P, 6>>,
    bodies: RoundedBodies<P>,
    sums: [Vec<P>; 6],
}

impl<P: backend::Precision> PairSweep<P> {
    pub(super) fn new(
        softening: f64,
        bodies: &PointMasses,
        arithmetic: Arithmetic,
        set: InstructionSet,
    ) -> Self {
        let (count, entries) = (bodies.len(), bodies.entries());
        let bodies = RoundedBodies::new(bodies, entries, 1);
        PairSweep {
            softening: bodies.units.length(softening),
            count,
            set,
            arithmetic,
            forces: AllPairs::new(count),
            rates: None,
            bodies,
            sums: std::array::from_fn(|_| vec![P::default(); entries]),
        }
    }

    /// Memory in bytes, with or without rates of the forces.
    pub(super) fn bytes(count: usize, has_rates: bool) -> usize {
        let rates = if has_rates { AllPairs::<P, 6>::bytes(count) } else { 0 };
        let entries = padded_length(count);
        RoundedBodies::<P>::bytes(entries, 1)
            + entries * 6 * P::BYTES
            + AllPairs::<P, 3>::bytes(count)
            + rates
    }
}

impl<P: backend::Precision> PairSweep<P> {
    /// Number of bands of rows.
    pub(super) fn bands(&self) -> usize {
        self.forces.bands()
    }

    /// Entries of a column: bodies and padding.
    pub(super) fn entries(&self) -> usize {
        self.sums[0].len()
    }

    /// Visits the pairs of some bands.
    ///
    /// # Errors
    /// As [`sum`](ForceSums::sum).
    pub(super) fn visit_bands(
        &mut self,
        (position, velocity): (&StateColumns, Option<&StateColumns>),
        bands: Range<usize>,
        observed: bool,
        stop: StopCallback<'_>,
    ) -> Result<(), ProgramError> {
        self.bodies.convert_bodies(position, velocity);
        let PairSweep { softening, count, set, arithmetic, forces, rates, bodies, .. } = self;
        let (softening, bodies) = (*softening, bodies.bodies());
        let manner = AllPairsOptions { observed, arithmetic: *arithmetic, set: *set, interrupted: stop };
        match velocity {
            None => forces.sweep_bands(&Gravity::<false> { softening }, &bodies, bands, &manner),
            Some(_) => {
                let rates = rates.get_or_insert_with(|| AllPairs::new(*count));
                rates.sweep_bands(&Gravity::<true> { softening }, &bodies, bands, &manner)
            }
        }
    }

    /// Adds up the sums of all bands, with or without the rates of the forces. Returns the energy.
    ///
    /// # Errors
    /// As [`sum`](ForceSums::sum).
    pub(super) fn finish(&mut self, has_rates: bool) -> Result<f64, ProgramError> {
        let energy = self.bodies.units.energy();
        let PairSweep { forces, rates, sums, .. } = self;
        let sums = sums.each_mut().map(Vec::as_mut_slice);
        let [potential, _] = match rates.as_ref().filter(|_| has_rates) {
            None => {
                let [x, y, z, ..] = sums;
                forces.finish([x, y, z])?
            }
            Some(rates) => rates.finish(sums)?,
        };
        Ok(energy * potential)
    }

    /// Sums of a band as numbers: energy and virial, then every force sum.
    pub(super) fn band(&self, number: usize, has_rates: bool) -> Vec<f64> {
        fn of<P: backend::Precision>(sums: &[AlignedColumn<P>], energy: [f64; 2]) -> Vec<f64> {
            energy
                .into_iter()
                .chain(sums.iter().flat_map(|sums| sums.iter()).map(|sum| sum.to_f64()))
                .collect()
        }
        match self.rates.as_ref().filter(|_| has_rates) {
            None => {
                let (sums, energy) = self.forces.band(number);
                of(sums, energy)
            }
            Some(rates) => {
                let (sums, energy) = rates.band(number);
                of(sums, energy)
            }
        }
    }

    /// Stores the result of [`band`](Self::band) from another rank.
    ///
    /// # Errors
    /// [`RankError`] if the number of values differs.
    pub(super) fn store_band(
        &mut self,
        number: usize,
        has_rates: bool,
        (rank, bytes): (usize, &[u8]),
    ) -> Result<(), RankError> {
        let PairSweep { count, forces, rates, .. } = self;
        let (sums, energy) = match has_rates {
            false => {
                let (sums, energy) = forces.band_mut(number);
                (sums.as_mut_slice(), energy)
            }
            true => {
                let (sums, energy) = rates.get_or_insert_with(|| AllPairs::new(*count)).band_mut(number);
                (sums.as_mut_slice(), energy)
            }
        };
        let count = energy.len() + sums.iter().map(|sums| sums.len()).sum::<usize>();
        let mut numbers = numbers(bytes, rank, count)?;
        energy.iter_mut().zip(numbers.by_ref()).for_each(|(energy, number)| *energy = number);
        sums.iter_mut()
            .flat_map(|sums| sums.iter_mut())
            .zip(numbers)
            .for_each(|(sum, number)| *sum = P::from_f64(number));
        Ok(())
    }
}

impl<P: backend::Precision> ForceSums for PairSweep<P> {
    fn sum(
        &mut self,
        position: &StateColumns,
        velocity: Option<&StateColumns>,
        observed: bool,
        stop: StopCallback<'_>,
    ) -> Result<f64, ProgramError> {
        self.visit_bands((position, velocity), 0..self.bands(), observed, stop)?;
        self.finish(velocity.is_some())
    }

    fn over(&self, per_mass: &[f64], [acceleration, jerk]: [Option<&mut StateColumns>; 2]) {
        let units = self.bodies.units;
        over(&self.sums[..3], units.force(), per_mass, acceleration);
        over(&self.sums[3..], units.force_rate(), per_mass, jerk);
    }
}
