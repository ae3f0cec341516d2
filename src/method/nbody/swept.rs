//! Each pair once, in registers and on threads.

use super::bodies::{Bodies, Columns};
use super::field::Sums;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::gravity::Gravity;
use stripmine_kernels::sweep::all_pairs::{self, AllPairs, Arithmetic};

/// Each pair once, in a precision.
pub(super) struct Swept<P> {
    softening: f64,
    bodies: usize,
    set: InstructionSet,
    arithmetic: Arithmetic,
    forces: AllPairs<P, 3>,
    rates: Option<AllPairs<P, 6>>,
    position: [Vec<P>; 3],
    velocity: [Vec<P>; 3],
    mass: Vec<P>,
    sums: [Vec<P>; 6],
}

impl<P: backend::Precision> Swept<P> {
    /// Of bodies.
    pub(super) fn new(softening: f64, bodies: &Bodies, arithmetic: Arithmetic, set: InstructionSet) -> Self {
        let entries = bodies.entries();
        let zeros = || vec![P::default(); entries];
        Swept {
            softening,
            bodies: bodies.len(),
            set,
            arithmetic,
            forces: AllPairs::new(bodies.len()),
            rates: None,
            position: [zeros(), zeros(), zeros()],
            velocity: [zeros(), zeros(), zeros()],
            mass: bodies.mass.iter().map(|&m| P::from_f64(m)).collect(),
            sums: std::array::from_fn(|_| zeros()),
        }
    }
}

impl<P: backend::Precision> Sums for Swept<P> {
    fn sum(
        &mut self,
        position: &Columns,
        velocity: Option<&Columns>,
        observed: bool,
    ) -> Result<[f64; 2], ProgramError> {
        let (softening, count) = (self.softening, self.bodies);
        let take = |to: &mut [Vec<P>; 3], from: &Columns| {
            for (to, from) in to.iter_mut().zip(from) {
                to.iter_mut().zip(from).for_each(|(to, &from)| *to = P::from_f64(from));
            }
        };
        take(&mut self.position, position);
        if let Some(velocity) = velocity {
            take(&mut self.velocity, velocity);
        }
        let Swept { set, arithmetic, forces, rates, position, velocity: at_velocity, mass, sums, .. } = self;
        let bodies = all_pairs::Bodies {
            position: position.each_ref().map(Vec::as_slice),
            velocity: at_velocity.each_ref().map(Vec::as_slice),
            mass,
        };
        let [fx, fy, fz, rates_x, rates_y, rates_z] = sums.each_mut().map(Vec::as_mut_slice);
        match velocity {
            None => {
                let law = Gravity::<false> { softening };
                forces.sweep(&law, &bodies, [fx, fy, fz], observed, *arithmetic, *set)
            }
            Some(_) => {
                let law = Gravity::<true> { softening };
                let rates = rates.get_or_insert_with(|| AllPairs::new(count));
                rates.sweep(
                    &law,
                    &bodies,
                    [fx, fy, fz, rates_x, rates_y, rates_z],
                    observed,
                    *arithmetic,
                    *set,
                )
            }
        }
    }

    fn over(&self, inverse_mass: &[f64], first: usize, into: &mut Columns) {
        for (into, sum) in into.iter_mut().zip(&self.sums[first..]) {
            for ((into, sum), inverse) in into.iter_mut().zip(sum).zip(inverse_mass) {
                *into = sum.to_f64() * inverse;
            }
        }
    }
}
