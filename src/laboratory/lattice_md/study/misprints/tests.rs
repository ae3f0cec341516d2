//! Each of BP93's four misprints fails a test that the corrected law passes, and the study reports the same.

use super::*;

/// Random pairs in contact.
fn random_pairs(seed: u64, count: usize) -> impl Iterator<Item = Pair> {
    let mut random = Stream::new(seed, RandomPurpose::Test, 0);
    (0..count).map(move |_| Pair::random(&mut random))
}

/// Control of the tests below: without a misprint this law equals the corrected law.
#[test]
fn without_misprint_the_laws_agree() {
    let (ours, theirs) = (ours(CONTACT), AsPrinted { contact: CONTACT, misprint: None });
    for pair in random_pairs(9, 500) {
        let (ours, theirs) = (pair.sums(&ours), pair.sums(&theirs));
        for (ours, theirs) in ours.as_flattened().iter().zip(theirs.as_flattened()) {
            assert!((ours - theirs).abs() < 1e-12, "{ours} {theirs}");
        }
    }
}

/// Kinetic energy before and after a collision on lines of flight `offset` apart.
fn energies<L: Law<2>>(law: &L, offset: f64, stiffness: Option<f64>) -> (f64, f64) {
    let mut pair = Pair::colliding(offset);
    let before = pair.kinetic_energy();
    let mut total = before;
    for now in pair.trajectory(law, 1e-4).take(30_001) {
        // With a given stiffness the energy including the elastic part must never grow.
        if let Some(stiffness) = stiffness {
            let energy = now.kinetic_energy() + elastic_energy(&now, stiffness);
            assert!(energy <= total + 1e-10, "energy grew from {total} to {energy}");
            total = energy;
        }
        pair = now;
    }
    assert!(pair.depth() < 0.0, "the collision must be over");
    (before, pair.kinetic_energy())
}

/// (14) as printed adds energy: a frictionless head-on collision ends faster than it began. With the corrected law it ends slower, and
/// without damping equally fast.
#[test]
fn printed_14_adds_kinetic_energy_head_on() {
    let contact =
        Contact { normal_damping: 0.18, friction: 0.0, shear_damping: 0.0, cohesionless: false, ..CONTACT };
    let (before, printed) = energies(&printed(Misprint::NormalDamping, contact), 0.0, None);
    let (_, ours) = energies(&super::ours(contact), 0.0, Some(contact.stiffness));
    let elastic = Contact { normal_damping: 0.0, ..contact };
    let (_, undamped) = energies(&super::ours(elastic), 0.0, Some(contact.stiffness));
    println!("kinetic energy {before:.3}: printed (14) {printed:.3}, ours {ours:.3}, undamped {undamped:.6}");
    assert!(printed > 1.01 * before, "{printed}");
    assert!(ours < 0.99 * before, "{ours}");
    assert!((undamped - before).abs() < 1e-6, "{undamped}");
}

/// (15) as printed bounds only positive forces: a sliding contact violates the Coulomb bound for v_t > 0, satisfies it for v_t < 0, and
/// is not mirror symmetric.
#[test]
fn printed_15_bounds_positive_forces_only() {
    let contact = Contact { shear_damping: 1000.0, cohesionless: false, ..CONTACT };
    let (printed, ours) = (printed(Misprint::CoulombBound, contact), ours(contact));
    for speed in [1.0, -1.0] {
        let mut pair = Pair::touching();
        pair.bodies[0].velocity[1] = speed;
        let slip = pair.slip();
        let excess = |[normal, shear]: [f64; 2]| shear.abs() / (contact.friction * normal.abs());
        let (theirs, here) = (excess(pair.normal_and_shear(&printed)), excess(pair.normal_and_shear(&ours)));
        println!("slip {slip:+}: |F_S| / (mu |F_N|) printed (15) {theirs:.2}, ours {here:.2}");
        assert!((here - 1.0).abs() < 1e-12, "{here}");
        if slip > 0.0 {
            assert!(theirs > 10.0, "{theirs}");
        } else {
            assert!((theirs - 1.0).abs() < 1e-12, "{theirs}");
        }
        assert!(pair.asymmetry(&printed) > 10.0);
        assert_eq!(pair.asymmetry(&ours), 0.0);
    }
}

/// (16) as printed gives slip for rolling discs and none for equal spins.
#[test]
fn printed_16_lets_rolling_discs_slip() {
    let contact = Contact { cohesionless: false, ..CONTACT };
    let (printed, ours) = (printed(Misprint::Slip, contact), ours(contact));
    let gears = Pair::gears(1.0);
    let mut rubbing = gears;
    rubbing.bodies[1].omega = rubbing.bodies[0].omega;
    let shear = |pair: Pair| (pair.normal_and_shear(&printed)[1], pair.normal_and_shear(&ours)[1]);
    println!("shear force (printed, ours): gear pair {:?}, equal spins {:?}", shear(gears), shear(rubbing));
    assert!(shear(gears).0.abs() > 0.5);
    assert_eq!(shear(gears).1, 0.0);
    assert_eq!(shear(rubbing).0, 0.0);
    assert!(shear(rubbing).1.abs() > 0.5);
}

/// (16) as printed adds energy in an oblique collision without normal damping; the corrected law dissipates.
#[test]
fn printed_16_adds_energy_in_oblique_collisions() {
    let contact =
        Contact { normal_damping: 0.0, shear_damping: 40.0, friction: 5.0, cohesionless: false, ..CONTACT };
    let (before, printed) = energies(&printed(Misprint::Slip, contact), 1.4, None);
    let (_, ours) = energies(&super::ours(contact), 1.4, Some(contact.stiffness));
    println!("kinetic energy {before:.3}: printed (16) {printed:.3}, ours {ours:.3}");
    assert!(printed > 1.01 * before, "{printed}");
    assert!(ours < 0.99 * before, "{ours}");
}

/// (10)–(11) as printed, with the tangent (n_y, −n_x), change the angular momentum of the pair by −(2(R_i + R_j) − ξ) F_S instead of
/// −ξ F_S.
#[test]
fn printed_10_and_11_violate_angular_momentum() {
    let contact = Contact { cohesionless: false, ..CONTACT };
    let (printed, ours) = (printed(Misprint::Tangent, contact), ours(contact));
    let mut largest = 0.0f64;
    for pair in random_pairs(10, 500) {
        let depth = pair.depth();
        let [first, second] = pair.bodies.map(|body| body.radius);
        // The torque on the first disc is −R F_S in either law.
        let shear = -pair.sums(&printed)[0][2] / first;
        let arms = 2.0 * (first + second) - depth;
        assert!((pair.angular_momentum_rate(&printed) + arms * shear).abs() < 1e-12);
        let off = |found: f64| (found + depth * shear).abs();
        assert!(off(pair.angular_momentum_rate(&ours)) < 1e-12);
        largest = largest.max(off(pair.angular_momentum_rate(&printed)));
        assert!(off(pair.angular_momentum_rate(&printed)) > 3.0 * shear.abs());
    }
    println!("printed (10)-(11): off the rule by up to {largest:.2}");
    assert!(largest > 1.0);
}

/// Rounding error of a correct value.
const ROUNDING: f64 = 1e-9;
/// Smallest error visible in a table.
const VISIBLE: f64 = 0.01;

#[test]
fn printed_forms_fail_and_corrected_forms_hold() {
    for finding in findings(&head_on(), &sliding()) {
        let MisprintFinding {
            misprint, quantity, right: (relation, right), by: [by_printed, by_ours], ..
        } = finding;
        let missed = |value: f64| match relation {
            "at most" => (value - right).max(0.0),
            _ => (value - right).abs(),
        };
        assert!(missed(by_printed) > VISIBLE, "{misprint:?} {quantity}: {by_printed}");
        assert!(by_ours.is_finite() && missed(by_ours) <= ROUNDING, "{misprint:?} {quantity}: {by_ours}");
    }
}

/// As printed the energy rises from 0.500 to 0.536; with the corrected law it never rises, and without damping it is conserved.
#[test]
fn printed_14_raises_total_energy() {
    let head_on = head_on();
    let ([start, before, _, undamped], [end, printed, ours, undamped_last]) =
        (head_on[0], head_on[head_on.len() - 1]);
    assert_eq!([start, end], [0.0, 0.7]);
    assert!((before - 0.5).abs() < 1e-12 && (printed - 0.536).abs() < 5e-4, "{printed}");
    assert!((undamped_last - undamped).abs() < 1e-6);
    assert!(ours < 0.47, "{ours}");
    assert!(head_on.is_sorted_by(|now, later| later[2] <= now[2] + 1e-10));
    assert!(head_on.is_sorted_by(|now, later| later[1] >= now[1] - 1e-10));
}

#[test]
fn collisions_end_before_they_are_judged() {
    fn depth<L: Law<2>>(law: L, offset: f64, steps: usize) -> f64 {
        path(Pair::colliding(offset), &law).nth(steps).unwrap().depth()
    }
    for depth in [
        depth(printed(Misprint::NormalDamping, HEAD_ON), 0.0, HEAD_ON_STEPS),
        depth(ours(HEAD_ON), 0.0, HEAD_ON_STEPS),
        depth(printed(Misprint::Slip, OBLIQUE), OBLIQUE_OFFSET, OBLIQUE_STEPS),
        depth(ours(OBLIQUE), OBLIQUE_OFFSET, OBLIQUE_STEPS),
    ] {
        assert!(depth < -0.1, "{depth}");
    }
}

/// For v_t > 0 the printed form exceeds the bound, for v_t < 0 it equals the corrected form; below the bound both are viscous.
#[test]
fn printed_15_exceeds_the_bound_for_positive_slip() {
    let sliding = sliding();
    let ends = [sliding[0], sliding[sliding.len() - 1]];
    assert_eq!(ends.map(|at| at[0]), [-LARGEST_SLIP, LARGEST_SLIP]);
    assert!(ends[0][1] <= 1.0 + ROUNDING && ends[1][1] > 6.0, "{ends:?}");
    for [slip, printed, ours] in sliding {
        assert!((slide(slip).slip() - slip).abs() < 1e-12, "{slip}");
        let normal = SLIDING.stiffness * 0.1f64.powf(1.5);
        let viscous = SLIDING.shear_damping * 0.5 * slip.abs() / (SLIDING.friction * normal);
        let expected = [if slip > 0.0 { viscous } else { viscous.min(1.0) }, viscous.min(1.0)];
        for (found, expected) in [printed, ours].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9, "{slip}: {found} for {expected}");
        }
    }
}
