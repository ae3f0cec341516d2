//! Each pair once, in registers and on threads.

use super::bodies::{Bodies, Columns};
use super::rounded::Rounded;
use super::sums::{Stop, Sums, over};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::gravity::Gravity;
use stripmine_kernels::sweep::all_pairs::{AllPairs, Arithmetic, Manner, padded};

/// Each pair once, in a precision.
pub(super) struct Swept<P> {
    softening: f64,
    count: usize,
    set: InstructionSet,
    arithmetic: Arithmetic,
    forces: AllPairs<P, 3>,
    rates: Option<AllPairs<P, 6>>,
    bodies: Rounded<P>,
    sums: [Vec<P>; 6],
}

impl<P: backend::Precision> Swept<P> {
    /// Of bodies.
    pub(super) fn new(softening: f64, bodies: &Bodies, arithmetic: Arithmetic, set: InstructionSet) -> Self {
        let (count, entries) = (bodies.len(), bodies.entries());
        let bodies = Rounded::new(bodies, entries, 1);
        Swept {
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

    /// Bytes that it takes, with or without rates of the forces.
    pub(super) fn bytes(count: usize, has_rates: bool) -> usize {
        let rates = if has_rates { AllPairs::<P, 6>::bytes(count) } else { 0 };
        padded(count) * (Rounded::<P>::BYTES + 6 * P::BYTES) + AllPairs::<P, 3>::bytes(count) + rates
    }
}

impl<P: backend::Precision> Sums for Swept<P> {
    fn sum(
        &mut self,
        position: &Columns,
        velocity: Option<&Columns>,
        observed: bool,
        stop: Stop<'_>,
    ) -> Result<f64, ProgramError> {
        self.bodies.take(position, velocity);
        let Swept { softening, count, set, arithmetic, forces, rates, bodies, sums } = self;
        let (softening, energy) = (*softening, bodies.units.energy());
        let bodies = bodies.bodies();
        let manner = Manner { observed, arithmetic: *arithmetic, set: *set, interrupted: stop };
        let sums = sums.each_mut().map(Vec::as_mut_slice);
        let [potential, _] = match velocity {
            None => {
                let [x, y, z, ..] = sums;
                forces.sweep(&Gravity::<false> { softening }, &bodies, [x, y, z], &manner)?
            }
            Some(_) => {
                let rates = rates.get_or_insert_with(|| AllPairs::new(*count));
                rates.sweep(&Gravity::<true> { softening }, &bodies, sums, &manner)?
            }
        };
        Ok(energy * potential)
    }

    fn over(&self, inverse_mass: &[f64], [acceleration, jerk]: [Option<&mut Columns>; 2]) {
        let units = self.bodies.units;
        over(&self.sums[..3], units.force(), inverse_mass, acceleration);
        over(&self.sums[3..], units.force_rate(), inverse_mass, jerk);
    }
}
