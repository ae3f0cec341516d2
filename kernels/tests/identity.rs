//! Every execution of every kernel gives the same bits, on every instruction set of this processor.

mod support;

use proptest::prelude::*;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::Inertia;
use stripmine_kernels::law::Law;
use stripmine_kernels::law::granular::ContactArm;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::{Execution, InstructionSet};
use support::{CONTACT, Case, System, all_configurations, equal, varying};

const ORACLE: (Execution, InstructionSet) = (Execution::Chained, InstructionSet::Scalar);

/// Compares two whole steps of every execution with the scalar oracle.
fn whole_steps_agree<S: Precision, P: Precision, L: Law<2>, const VALUES: usize, const FREEDOMS: usize>(
    case: &Case,
    law: &L,
    inertia: Inertia,
) {
    let start = System::<S, P>::random(case);
    let after = |how| {
        let mut system = start.clone();
        system.step::<L, VALUES, FREEDOMS>(case, law, inertia, how);
        system.step::<L, VALUES, FREEDOMS>(case, law, inertia, how);
        system.bits()
    };
    let oracle = after(ORACLE);
    for how in all_configurations() {
        assert!(after(how) == oracle, "{how:?} differs from the oracle for {case:?}");
    }
}

fn every_program_agrees(case: &Case) {
    let all_alike = Inertia::Equal { inverse_mass: 1.0, inverse_inertia: 2.0 };
    whole_steps_agree::<f64, f64, _, 6, 3>(case, &varying::<true>(case.contact), Inertia::Varying);
    whole_steps_agree::<f32, f32, _, 5, 3>(case, &varying::<true>(case.contact), Inertia::Varying);
    whole_steps_agree::<f64, f32, _, 4, 3>(case, &equal::<true>(case.contact), all_alike);
    whole_steps_agree::<f64, f64, _, 4, 2>(case, &varying::<false>(case.contact), Inertia::Varying);
    whole_steps_agree::<f32, f32, _, 6, 2>(case, &equal::<false>(case.contact), all_alike);
}

#[test]
fn executions_agree_on_lattices_of_every_kind() {
    for periodic in [[true, true], [false, false], [true, false], [false, true]] {
        for coordinates in [Coordinates::CellRelative, Coordinates::Absolute] {
            every_program_agrees(&Case { periodic, coordinates, ..Case::new(13, 9) });
        }
    }
}

#[test]
fn executions_agree_on_an_empty_lattice() {
    every_program_agrees(&Case { fill: 0.0, ..Case::new(11, 5) });
}

#[test]
fn executions_agree_on_a_full_lattice() {
    every_program_agrees(&Case { fill: 1.0, ..Case::new(17, 6) });
}

#[test]
fn executions_agree_on_one_cell() {
    for fill in [0.0, 1.0] {
        every_program_agrees(&Case { fill, periodic: [false, false], ..Case::new(1, 1) });
    }
}

#[test]
fn executions_agree_with_wider_masks_and_options() {
    let contact = stripmine_kernels::law::granular::Contact {
        cohesionless: false,
        arm: ContactArm::Overlap,
        ..CONTACT
    };
    every_program_agrees(&Case { half_width: 3, contact, ..Case::new(9, 12) });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn executions_agree_on_random_lattices(
        columns in 5usize..40, rows in 5usize..20, fill in 0.0..1.0f64, seed: u64, x: bool, y: bool, relative: bool,
    ) {
        let coordinates = if relative { Coordinates::CellRelative } else { Coordinates::Absolute };
        let case = Case { fill, seed, periodic: [x, y], coordinates, ..Case::new(columns, rows) };
        whole_steps_agree::<f64, f64, _, 5, 3>(&case, &varying::<true>(case.contact), Inertia::Varying);
        whole_steps_agree::<f32, f32, _, 5, 3>(&case, &varying::<true>(case.contact), Inertia::Varying);
    }
}
