//! Contact law: conservation, bounds and symmetry, on the lattice and without it.

mod support;

use rand::RngExt;
use stripmine_kernels::law::granular::{Contact, ContactArm, EqualDiscs, Granular};
use stripmine_kernels::law::{Axis, ParticleSum};
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::sweep::lattice::LatticeFrame;
use stripmine_kernels::sweep::pair::{Pair, PairBody};
use stripmine_kernels::{Execution, InstructionSet};
use support::{CONTACT, Case, System, contacts, random_pairs, varying};

/// Executions that matter here; `identity.rs` compares the others.
fn configurations() -> [(Execution, InstructionSet); 2] {
    [InstructionSet::Scalar, InstructionSet::best()].map(|set| (Execution::Chained, set))
}

// ---- on the lattice -------------------------------------------------------------------------------------

/// Sums of a pair on an 8×8 lattice, periodic both ways, placed anywhere within the box; true if a seam is between the two.
fn pair_on_the_lattice(
    contact: Contact,
    pair: Pair,
    how: (Execution, InstructionSet),
) -> ([[f64; 3]; 2], bool) {
    let case = Case { contact, ..Case::new(8, 8) };
    let frame = LatticeFrame { origin: [-3.0, 2.0], edge: [1.1, 1.1] };
    let law = varying::<true>(contact);
    let mut system = System::<f64, f64>::placed(&case, frame, &pair.bodies);
    system.index(&case, &law, how);
    assert_eq!((system.strays, system.conflicts), (0, 0));
    system.forces(&case, &law, how).unwrap();
    let sums = ParticleSum::PLANAR.map(|sum| system.on_discs(sum));
    let on = |disc: usize| [sums[0][disc], sums[1][disc], sums[2][disc]];
    let wrapped = |axis: usize| {
        let stored = &system.state[axis][0];
        (stored[0] - stored[1]).abs() > 4.4
    };
    ([on(0), on(1)], wrapped(0) || wrapped(1))
}

/// In cell-relative coordinates the two forces of a pair are opposite to the bit, also across a seam.
#[test]
fn action_equals_reaction_to_the_bit() {
    let (mut seams, mut inside, mut random) = (0, 0, Stream::new(1, RandomPurpose::Test, 1));
    for contact in contacts() {
        for mut pair in random_pairs(2, 300) {
            let to = [-3.0 + 8.8 * random.random::<f64>(), 2.0 + 8.8 * random.random::<f64>()];
            let from = pair.bodies[0].position;
            for body in &mut pair.bodies {
                body.position = [0, 1].map(|axis| body.position[axis] + (to[axis] - from[axis]));
            }
            let [([first, second], seam), other] =
                configurations().map(|how| pair_on_the_lattice(contact, pair, how));
            assert_eq!(([first, second], seam), other);
            assert!(first[0] != 0.0 || first[1] != 0.0 || contact.cohesionless, "{pair:?}");
            for axis in 0..2 {
                assert_eq!(first[axis], -second[axis], "component {axis} for {pair:?}");
            }
            *(if seam { &mut seams } else { &mut inside }) += 1;
        }
    }
    println!("{seams} pairs across a seam, {inside} not");
    assert!(seams > 100 && inside > 100);
}

/// A pair on the lattice has the same forces and torques as without a lattice.
#[test]
fn lattice_pairs_match_free_pairs() {
    for contact in contacts() {
        for mut pair in random_pairs(3, 50) {
            pair.bodies.iter_mut().for_each(|body| body.position[1] += 6.0);
            let expected = pair.sums(&varying::<true>(contact));
            let (found, _) = pair_on_the_lattice(contact, pair, configurations()[1]);
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 1e-11, "{found} for {expected}");
            }
        }
    }
}

/// The forces of a random system sum to zero.
#[test]
fn the_total_force_of_a_system_is_zero() {
    for periodic in [[true, true], [false, false], [true, false]] {
        let case = Case { periodic, ..Case::new(30, 20) };
        let law = varying::<true>(case.contact);
        let mut system = System::<f64, f64>::random(&case);
        system.index(&case, &law, configurations()[1]);
        system.forces(&case, &law, configurations()[1]).unwrap();
        for sum in [ParticleSum::Force(Axis::X), ParticleSum::Force(Axis::Y)] {
            let forces = system.on_discs(sum);
            let (total, scale) = (forces.iter().sum::<f64>(), forces.iter().map(|f| f.abs()).sum::<f64>());
            assert!(scale > 100.0, "the case has no contacts");
            assert!(total.abs() < 1e-14 * scale, "{total} of {scale} on {periodic:?}");
        }
    }
}

// ---- the law --------------------------------------------------------------------------------------------

/// d(L_orbital + L_spin)/dt = −ξ F_S with arms R, and 0 with arms R − ξ/2.
#[test]
fn angular_momentum_rate_is_depth_times_shear() {
    let mut largest = 0.0f64;
    for contact in contacts() {
        for pair in random_pairs(4, 1000) {
            let law = varying::<true>(contact);
            let depth = pair.depth();
            let [normal, shear] = pair.normal_and_shear(&law);
            let expected = if contact.arm == ContactArm::Radius { -depth * shear } else { 0.0 };
            let off = (pair.angular_momentum_rate(&law) - expected).abs();
            assert!(
                off < 1e-13 * (1.0 + normal.abs()),
                "angular momentum rate differs by {off} for {pair:?}"
            );
            largest = largest.max(depth * shear.abs());
        }
    }
    assert!(largest > 0.1, "the test is void: largest term {largest}");
}

/// |F_S| ≤ μ|F_N|; F_S opposes the slip; below the bound it is γ_S M_eff times the slip; both signs occur.
#[test]
fn friction_opposes_slip_within_the_coulomb_bound() {
    let contact = Contact { shear_damping: 20.0, ..CONTACT };
    let law = varying::<true>(contact);
    let (mut bound, mut free) = ([0; 2], [0; 2]);
    for pair in random_pairs(5, 3000) {
        let [normal, shear] = pair.normal_and_shear(&law);
        let (slip, limit) = (pair.slip(), contact.friction * normal.abs());
        let side = usize::from(slip > 0.0);
        let [own, partner] = pair.bodies.map(|body| body.inverse_mass);
        let viscous = contact.shear_damping * slip.abs() / (own + partner);
        assert!(shear.abs() <= limit + 1e-13, "{shear} beyond {limit}");
        assert!(shear * slip <= 0.0, "{shear} along the slip {slip}");
        if viscous > limit {
            bound[side] += 1
        } else {
            free[side] += 1
        }
        assert!((shear.abs() - viscous.min(limit)).abs() < 1e-12, "{shear} for {viscous} and {limit}");
    }
    assert!(bound.into_iter().chain(free).all(|met| met > 100), "{bound:?} {free:?}");
}

/// A mirrored pair has the mirrored forces, to the bit.
#[test]
fn the_law_is_mirror_symmetric() {
    for contact in contacts() {
        for pair in random_pairs(6, 500) {
            assert_eq!(pair.asymmetry(&varying::<true>(contact)), 0.0, "{pair:?}");
        }
    }
}

/// Gears that roll on each other have no shear force and no torque; equal spins rub.
#[test]
fn gears_roll_and_equal_spins_rub() {
    for arm in [ContactArm::Radius, ContactArm::Overlap] {
        let law = varying::<true>(Contact { arm, ..CONTACT });
        let [normal, shear] = Pair::gears(1.0).normal_and_shear(&law);
        assert!(normal > 1.0);
        assert_eq!(shear, 0.0);
        assert_eq!(Pair::gears(1.0).sums(&law).map(|sums| sums[2]), [0.0, 0.0]);
        let mut rubbing = Pair::gears(1.0);
        rubbing.bodies[1].omega = 3.0;
        // The first disc's surface faces its partner at +x and moves up, so it is pushed down.
        assert!(rubbing.normal_and_shear(&law)[1].abs() > 0.5);
        let sums = rubbing.sums(&law);
        assert!(sums[0][1] < -0.5 && sums[1][1] > 0.5);
        assert!(sums.iter().all(|sums| sums[2] < -0.5), "rubbing does not slow both spins");
    }
    let law = varying::<true>(CONTACT);
    for radius in [0.9, 1.05, 1.1] {
        assert!(Pair::gears(radius).normal_and_shear(&law)[1].abs() < 1e-14);
    }
}

/// For discs that separate fast, the clamped normal force is zero and the unclamped one pulls. Slow ones repel with either law.
#[test]
fn only_the_unclamped_law_pulls() {
    let mut pulled = 0;
    for mut pair in random_pairs(7, 1000) {
        let n = pair.normal();
        let [clamped, free] = [true, false]
            .map(|cohesionless| varying::<true>(Contact { cohesionless, normal_damping: 40.0, ..CONTACT }));
        let [held, drawn] = [&clamped, &free].map(|law| pair.normal_and_shear(law)[0]);
        assert!(held >= -1e-13, "{held}");
        assert!((held - drawn.max(0.0)).abs() < 1e-12, "{held} for {drawn}");
        pulled += usize::from(drawn < 0.0);
        pair.bodies[0].velocity = n.map(|n| 10.0 * n);
        pair.bodies[1].velocity = [0.0; 2];
        assert_eq!(pair.sums(&clamped), [[0.0; 3]; 2], "friction without a normal force");
        assert!(pair.normal_and_shear(&free)[0] < -1.0);
    }
    assert!(pulled > 100, "{pulled}");
}

/// A fixed disc has infinite mass: the effective mass is the other's, twice that of an equal pair.
#[test]
fn fixed_discs_have_infinite_mass() {
    let contact = Contact { cohesionless: false, friction: 1e6, ..CONTACT };
    let law = varying::<true>(contact);
    for mut pair in random_pairs(8, 200) {
        let mass = 1.0 / pair.bodies[0].inverse_mass;
        let n = pair.normal();
        let [own, partner] = pair.bodies.map(|body| body.velocity);
        let apart = (own[0] - partner[0]) * n[0] + (own[1] - partner[1]) * n[1];
        let elastic = contact.stiffness * pair.depth().powf(1.5);
        for (inverse_mass, effective) in [(0.0, mass), (1.0 / mass, 0.5 * mass)] {
            pair.bodies[1].inverse_mass = inverse_mass;
            let [first, second] = pair.bodies;
            for pair in [pair, Pair { bodies: [second, first] }] {
                let [normal, shear] = pair.normal_and_shear(&law);
                let expected = elastic - contact.normal_damping * effective * apart;
                assert!((normal - expected).abs() < 1e-12, "{normal} for {expected}");
                let expected = -contact.shear_damping * effective * pair.slip();
                assert!((shear - expected).abs() < 1e-12, "{shear} for {expected}");
            }
        }
    }
}

/// Sums of two fixed discs in contact, as in a wall. The forces move nothing, so they must be numbers.
fn fixed_pair(cohesionless: bool) -> [[f64; 3]; 2] {
    let bodies = Pair::touching().bodies.map(|body| PairBody { inverse_mass: 0.0, ..body });
    Pair { bodies }.sums(&varying::<true>(Contact { cohesionless, ..CONTACT }))
}

/// With the clamp, two fixed discs in contact have finite forces.
#[test]
fn clamped_fixed_contacts_have_finite_forces() {
    assert!(fixed_pair(true).as_flattened().iter().all(|f| f.is_finite()), "{:?}", fixed_pair(true));
}

/// Without the clamp the sums of two touching fixed discs may be NaN; those of a grain beside them are finite.
#[test]
fn fixed_contacts_do_not_affect_other_discs() {
    let case = Case {
        periodic: [false; 2],
        contact: Contact { cohesionless: false, ..CONTACT },
        ..Case::new(13, 9)
    };
    let frame = LatticeFrame { origin: [0.0; 2], edge: [1.1, 1.1] };
    let fixed = |x, y| PairBody { inverse_mass: 0.0, ..PairBody::at(x, y) };
    let discs = [PairBody::at(6.0, 6.6), fixed(5.05, 5.0), fixed(6.95, 5.0)];
    let law = varying::<true>(case.contact);
    let mut system = System::<f64, f64>::placed(&case, frame, &discs);
    system.index(&case, &law, (Execution::Chained, InstructionSet::best()));
    system.forces(&case, &law, (Execution::Chained, InstructionSet::best())).unwrap();
    let on_grain = ParticleSum::PLANAR.map(|sum| system.on_discs(sum)[0]);
    assert!(on_grain.iter().all(|f| f.is_finite()), "{on_grain:?}");
    assert!(on_grain[1] > 1.0, "the grain does not rest on both: {on_grain:?}");
}

/// Equal discs need no arrays of radii and masses: the law's constants give the same forces.
#[test]
fn equal_and_varying_compilations_agree() {
    for contact in contacts() {
        let disc = EqualDiscs { radius: 1.05, inverse_mass: 0.4 };
        let alike = Granular::<true, true> { contact, disc };
        for pair in random_pairs(12, 200) {
            let EqualDiscs { radius, inverse_mass } = disc;
            let pair = Pair { bodies: pair.bodies.map(|body| PairBody { radius, inverse_mass, ..body }) };
            assert_eq!(pair.sums(&alike), pair.sums(&varying::<true>(contact)));
        }
    }
}
