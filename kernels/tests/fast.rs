//! The fast sweep equals the sweep of BP93 up to rounding (`oracle.rs` compares that one with all pairs). It has the same bits
//! for any instruction set, threads and order of the discs in memory.

mod support;

use proptest::prelude::*;
use rand::seq::SliceRandom;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::granular::{Contact, ContactArm};
use stripmine_kernels::law::{Axis, Law, ParticleSum};
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::{Execution, sweep::lattice::Coordinates};
use support::{CONTACT, Case, System, equal, varying};

/// The numbers from 0 in a random order.
fn shuffled(count: usize, seed: u64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count as u32).collect();
    order.shuffle(&mut Stream::new(seed, RandomPurpose::Test, 1));
    order
}

/// Compares fast with chained forces within `bound` of the rms force, and the bits of every way of running the fast sweep.
fn agree<S: Precision, P: Precision, L: Law<2> + Sync>(case: &Case, law: &L, bound: f64) {
    let mut faithful = System::<S, P>::random(case);
    let start = faithful.clone();
    let how = (Execution::Chained, InstructionSet::best());
    faithful.index(case, law, how);
    assert_eq!((faithful.strays, faithful.conflicts), (0, 0));
    faithful.forces(case, law, how).unwrap();
    let in_order: Vec<u32> = (0..start.discs as u32).collect();
    let (forces, met) = start.fast_forces(law, &in_order, InstructionSet::Scalar).unwrap();
    assert!(met.not_finite.is_empty());
    for &sum in L::SUMS {
        let expected = faithful.on_discs(sum);
        let rms = (expected.iter().map(|f| f * f).sum::<f64>() / expected.len().max(1) as f64).sqrt();
        for (disc, (found, expected)) in forces.iter().zip(&expected).enumerate() {
            let off = (found[sum.column::<2>()].to_f64() - expected).abs();
            assert!(
                off <= bound * rms,
                "{sum:?} of disc {disc} differs by {:e} of the rms: {case:?}",
                off / rms
            );
        }
    }
    let bits = |forces: &[[P; 3]]| -> Vec<u64> { forces.iter().flatten().map(|x| x.bits()).collect() };
    let pairs = |mut deep: Vec<[u32; 2]>, order: &[u32]| {
        deep.iter_mut().for_each(|pair| *pair = pair.map(|disc| order[disc as usize]));
        deep.sort_unstable();
        deep
    };
    let deep = pairs(met.deep.clone(), &in_order);
    for set in InstructionSet::available() {
        for order in [in_order.clone(), shuffled(start.discs, case.seed)] {
            for threads in [1, 2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let (again, met_again) = pool.install(|| start.fast_forces(law, &order, set).unwrap());
                assert!(bits(&again) == bits(&forces), "{} on {threads} threads: {case:?}", set.name());
                assert_eq!(met_again.pairs, met.pairs);
                assert_eq!(met_again.energy.map(f64::to_bits), met.energy.map(f64::to_bits));
                assert_eq!(pairs(met_again.deep, &order), deep);
            }
        }
    }
}

fn agree_for_every_law(case: &Case) {
    agree::<f64, f64, _>(case, &varying::<true>(case.contact), 1e-12);
    agree::<f64, f32, _>(case, &varying::<true>(case.contact), 2e-4);
    agree::<f32, f32, _>(case, &equal::<false>(case.contact), 2e-4);
}

#[test]
fn fast_forces_match_on_every_lattice() {
    for (half_width, columns, rows) in [(2, 13, 9), (3, 11, 14), (2, 70, 101), (2, 5, 5), (3, 16, 33)] {
        for periodic in [[true, true], [false, false], [true, false], [false, true]] {
            let (short, least) = (columns.min(rows), 2 * half_width + 1);
            if short < least as usize {
                continue;
            }
            agree_for_every_law(&Case {
                half_width,
                periodic,
                seed: columns as u64,
                ..Case::new(columns, rows)
            });
        }
    }
}

#[test]
fn fast_forces_match_full_sparse_or_empty() {
    for fill in [1.0, 0.05, 0.01, 0.0] {
        agree_for_every_law(&Case { fill, ..Case::new(40, 67) });
    }
    for fill in [0.0, 1.0] {
        agree_for_every_law(&Case { fill, periodic: [false, false], ..Case::new(1, 1) });
    }
}

/// Action and reaction: the sum of all forces vanishes up to rounding.
#[test]
fn fast_forces_sum_to_zero() {
    let case = Case { seed: 9, ..Case::new(60, 75) };
    let system = System::<f64, f64>::random(&case);
    let order: Vec<u32> = (0..system.discs as u32).collect();
    let (forces, _) = system.fast_forces(&varying::<true>(CONTACT), &order, InstructionSet::best()).unwrap();
    for sum in [ParticleSum::Force(Axis::X), ParticleSum::Force(Axis::Y)] {
        let total: f64 = forces.iter().map(|force| force[sum.column::<2>()]).sum();
        let magnitude: f64 = forces.iter().map(|force| force[sum.column::<2>()].abs()).sum();
        assert!(magnitude > 100.0 && total.abs() < 1e-13 * magnitude, "{total:e} of {magnitude:e}");
    }
}

#[test]
fn absent_instruction_sets_are_rejected() {
    let system = System::<f64, f64>::random(&Case::new(9, 9));
    let order: Vec<u32> = (0..system.discs as u32).collect();
    for &set in InstructionSet::ALL {
        let run = system.fast_forces(&varying::<true>(CONTACT), &order, set);
        let refused = run.is_err_and(|error| matches!(error, ProgramError::NoSuchInstructionSet(_)));
        assert_eq!(refused, !set.is_available());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn fast_forces_match_random_lattices(
        columns in 7usize..70,
        rows in 7usize..80,
        half_width in 2u32..4,
        periodic: [bool; 2],
        cohesionless: bool,
        overlap: bool,
        fill in 0.0..1.0,
        seed: u64,
    ) {
        let arm = if overlap { ContactArm::Overlap } else { ContactArm::Radius };
        let contact = Contact { cohesionless, arm, ..CONTACT };
        let case = Case { columns, rows, half_width, periodic, coordinates: Coordinates::CellRelative, contact, fill, seed };
        agree::<f64, f64, _>(&case, &varying::<true>(contact), 1e-12);
    }
}
