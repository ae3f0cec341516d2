//! Forces of the lattice compared with naive ones: all pairs, plain numbers, written from the printed equations. `index.rs` does
//! the same for the Index.

mod support;

use stripmine_kernels::backend::Precision;
use stripmine_kernels::law::granular::{Contact, ContactArm};
use stripmine_kernels::law::{Axis, Law, ParticleSum};
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::{Execution, InstructionSet};
use support::{CONTACT, Case, System, equal, varying};

/// Executions that matter here; `identity.rs` compares the others.
fn configurations() -> [(Execution, InstructionSet); 2] {
    [InstructionSet::Scalar, InstructionSet::best()].map(|set| (Execution::Chained, set))
}

/// A disc in textbook notation.
#[derive(Clone, Copy)]
struct Ball {
    r: [f64; 2],
    v: [f64; 2],
    spin: f64,
    radius: f64,
    mass: f64,
}

/// Events among the pairs of a system, so that a test can require them.
#[derive(Clone, Copy, Debug, Default)]
struct Met {
    contacts: usize,
    across_a_seam: usize,
    sliding: usize,
    sticking: usize,
    pulling: usize,
    /// Power that leaves motion and springs.
    dissipated: f64,
    /// Energy in springs, and virial of all forces.
    energy: [f64; 2],
}

impl Met {
    fn add(&mut self, other: Met) {
        self.contacts += other.contacts;
        self.across_a_seam += other.across_a_seam;
        self.sliding += other.sliding;
        self.sticking += other.sticking;
        self.pulling += other.pulling;
        self.dissipated += other.dissipated;
        self.energy.iter_mut().zip(other.energy).for_each(|(sum, more)| *sum += more);
    }
}

/// Force and torque on every ball: each pair once, action and reaction, the nearest image on periodic sides.
fn naive_forces(
    balls: &[Ball],
    periods: [Option<f64>; 2],
    law: Contact,
    friction: bool,
) -> (Vec<[f64; 3]>, Met) {
    let mut total = vec![[0.0; 3]; balls.len()];
    let mut met = Met::default();
    for i in 0..balls.len() {
        for j in 0..i {
            let (a, b) = (balls[i], balls[j]);
            let mut between = [a.r[0] - b.r[0], a.r[1] - b.r[1]];
            let mut seam = false;
            for axis in 0..2 {
                if let Some(period) = periods[axis] {
                    let images = (between[axis] / period).round();
                    between[axis] -= images * period;
                    seam |= images != 0.0;
                }
            }
            let distance = between[0].hypot(between[1]);
            let xi = a.radius + b.radius - distance;
            if xi <= 0.0 {
                continue;
            }
            met.contacts += 1;
            met.across_a_seam += usize::from(seam);
            let n = [between[0] / distance, between[1] / distance];
            let s = [-n[1], n[0]];
            let v = [a.v[0] - b.v[0], a.v[1] - b.v[1]];
            let reduced = a.mass * b.mass / (a.mass + b.mass);
            let mut normal =
                law.stiffness * xi.powf(1.5) - law.normal_damping * reduced * (v[0] * n[0] + v[1] * n[1]);
            if normal < 0.0 {
                met.pulling += 1;
                if law.cohesionless {
                    normal = 0.0;
                }
            }
            // Reduction of the torque's arm, and of the surface's radius.
            let (shortening, shrinking) = match law.arm {
                ContactArm::Radius => (0.0, 0.0),
                ContactArm::Overlap => (xi / 2.0, xi / 2.0),
                ContactArm::Lammps => (xi / 2.0, 0.0),
            };
            let (arm_a, arm_b) = (a.radius - shortening, b.radius - shortening);
            let (rim_a, rim_b) = (a.radius - shrinking, b.radius - shrinking);
            let mut shear = 0.0;
            if friction {
                let slip = v[0] * s[0] + v[1] * s[1] - rim_a * a.spin - rim_b * b.spin;
                let viscous = law.shear_damping * reduced * slip.abs();
                let bound = law.friction * normal.abs();
                if viscous > bound {
                    met.sliding += 1;
                } else {
                    met.sticking += 1;
                }
                shear = -slip.signum() * viscous.min(bound);
            }
            // Work done on the pair, and energy stored in its spring.
            let spins = if friction { arm_a * a.spin + arm_b * b.spin } else { 0.0 };
            let work = normal * (v[0] * n[0] + v[1] * n[1]) + shear * (v[0] * s[0] + v[1] * s[1] - spins);
            let stored = -law.stiffness * xi.powf(1.5) * (v[0] * n[0] + v[1] * n[1]);
            met.dissipated -= work + stored;
            met.energy[0] += 0.4 * law.stiffness * xi.powf(2.5);
            met.energy[1] += normal * distance;
            for axis in 0..2 {
                let force = normal * n[axis] + shear * s[axis];
                total[i][axis] += force;
                total[j][axis] -= force;
            }
            total[i][2] -= arm_a * shear;
            total[j][2] -= arm_b * shear;
        }
    }
    (total, met)
}

/// Discs of the system, read back from the numbers given to the kernels.
fn balls<P: Precision>(system: &System<f64, P>, all_alike: bool) -> Vec<Ball> {
    let number = |column: &[P], disc: usize| column[disc].to_f64();
    (0..system.discs)
        .map(|disc| Ball {
            r: [system.state[0][0][disc], system.state[1][0][disc]],
            v: [number(&system.velocity[0], disc), number(&system.velocity[1], disc)],
            spin: number(&system.velocity[2], disc),
            radius: if all_alike { 1.0 } else { number(&system.radius, disc) },
            mass: if all_alike { 1.0 } else { 1.0 / number(&system.lattice_inverse_mass, disc) },
        })
        .collect()
}

fn periods<S, P>(system: &System<S, P>) -> [Option<f64>; 2] {
    let cells = [system.shape.columns(), system.shape.rows()];
    std::array::from_fn(|axis| {
        system.shape.periodic()[axis].then(|| cells[axis] as f64 * system.frame.edge[axis])
    })
}

/// Compares every component of every disc within 10⁻¹² of the system's rms force (torque).
fn compare<L: Law<2> + Sync>(case: &Case, law: &L, all_alike: bool, friction: bool) -> (f64, Met) {
    let start = System::<f64, f64>::random(case);
    let (expected, met) = naive_forces(&balls(&start, all_alike), periods(&start), case.contact, friction);
    let mut worst = 0.0f64;
    let faithful = |how| {
        let mut system = start.clone();
        system.index(case, law, how);
        assert_eq!((system.strays, system.conflicts), (0, 0), "{case:?}");
        system.forces(case, law, how).unwrap();
        ParticleSum::PLANAR.map(|sum| system.on_discs(sum))
    };
    let fast = {
        let order: Vec<u32> = (0..start.discs as u32).collect();
        let (forces, found) = start.fast_forces(law, &order, InstructionSet::best()).unwrap();
        let off = (found.dissipated / met.dissipated - 1.0).abs();
        assert!(met.dissipated > 0.0 && off < 1e-11, "{found:?} but {met:?} in {case:?}");
        for (found, expected) in found.energy.into_iter().zip(met.energy) {
            let scale = met.energy[0].max(expected.abs());
            assert!(
                scale > 0.0 && (found - expected).abs() < 1e-11 * scale,
                "{found} but {met:?} in {case:?}"
            );
        }
        ParticleSum::PLANAR
            .map(|sum| forces.iter().map(|force| force[sum.column::<2>()]).collect::<Vec<f64>>())
    };
    for forces in configurations().map(faithful).into_iter().chain([fast]) {
        for &sum in L::SUMS {
            let found = &forces[sum.column::<2>()];
            let rms = (expected.iter().map(|f| f[sum.column::<2>()].powi(2)).sum::<f64>()
                / found.len() as f64)
                .sqrt();
            assert!(rms > 1e-3, "no forces to compare in {case:?}");
            for (disc, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let difference = (found - expected[sum.column::<2>()]).abs() / rms;
                assert!(
                    difference < 1e-12,
                    "{sum:?} of disc {disc} differs by {difference} of the rms in {case:?}"
                );
                worst = worst.max(difference);
            }
        }
    }
    (worst, met)
}

/// Compares all options of the law and the lattice for one of the law's four compilations.
fn compare_everywhere<L: Law<2> + Sync>(law: impl Fn(Contact) -> L, all_alike: bool, friction: bool) {
    let (mut worst, mut met, mut seed) = (0.0f64, Met::default(), 100);
    for (half_width, columns, rows) in [(2, 13, 9), (3, 11, 14)] {
        for periodic in [[true, true], [false, false], [true, false], [false, true]] {
            for coordinates in [Coordinates::CellRelative, Coordinates::Absolute] {
                for cohesionless in [true, false] {
                    for arm in [ContactArm::Radius, ContactArm::Overlap, ContactArm::Lammps] {
                        seed += 1;
                        let contact = Contact { cohesionless, arm, normal_damping: 60.0, ..CONTACT };
                        let case = Case {
                            half_width,
                            periodic,
                            coordinates,
                            contact,
                            seed,
                            ..Case::new(columns, rows)
                        };
                        let (off, here) = compare(&case, &law(contact), all_alike, friction);
                        assert!(here.across_a_seam == 0 || periodic != [false, false], "{case:?}");
                        worst = worst.max(off);
                        met.add(here);
                    }
                }
            }
        }
    }
    println!("largest difference {worst:.1e} of the rms, {met:?}");
    assert!(met.contacts > 1000 && met.across_a_seam > 100 && met.pulling > 100, "{met:?}");
    assert!(!friction || met.sliding.min(met.sticking) > 100, "{met:?}");
}

/// Lattice and all-pairs forces agree for varying discs with friction and rotation.
#[test]
fn varying_discs_with_friction_match_all_pairs() {
    compare_everywhere(varying::<true>, false, true);
}

/// Lattice and all-pairs forces agree for varying discs without friction.
#[test]
fn varying_discs_without_friction_match_all_pairs() {
    compare_everywhere(varying::<false>, false, false);
}

/// Lattice and all-pairs forces agree for equal discs with friction and rotation.
#[test]
fn equal_discs_with_friction_match_all_pairs() {
    compare_everywhere(equal::<true>, true, true);
}

/// Lattice and all-pairs forces agree for equal discs without friction.
#[test]
fn equal_discs_without_friction_match_all_pairs() {
    compare_everywhere(equal::<false>, true, false);
}

/// On the smallest periodic lattice, 2h + 1 cells a side, every pair is visited exactly once.
#[test]
fn shortest_periodic_sides_visit_pairs_once() {
    for seed in 0..50 {
        let case = Case { fill: 0.6, seed, ..Case::new(5, 5) };
        compare(&case, &varying::<true>(case.contact), false, true);
    }
}

/// Relative rms error of single-precision forces at a distance of 10⁴ from the origin of coordinates.
fn single_precision_error(coordinates: Coordinates) -> f64 {
    let how = (Execution::Chained, InstructionSet::best());
    let (mut square, mut scale) = (0.0, 0.0);
    for seed in 0..5 {
        let case = Case { coordinates, seed, ..Case::new(20, 15) };
        let law = varying::<true>(case.contact);
        let mut system = System::<f64, f32>::random(&case);
        for (axis, far) in [1e4, -1e4].into_iter().enumerate() {
            system.frame.origin[axis] += far;
            system.state[axis][0].iter_mut().for_each(|x| *x += far);
        }
        let (expected, met) = naive_forces(&balls(&system, false), periods(&system), case.contact, true);
        assert!(met.contacts > 100 && met.across_a_seam > 0, "{met:?}");
        system.index(&case, &law, how);
        assert_eq!((system.strays, system.conflicts), (0, 0));
        system.forces(&case, &law, how).unwrap();
        for sum in [ParticleSum::Force(Axis::X), ParticleSum::Force(Axis::Y)] {
            for (found, expected) in system.on_discs(sum).iter().zip(&expected) {
                square += (found - expected[sum.column::<2>()]).powi(2);
                scale += expected[sum.column::<2>()].powi(2);
            }
        }
    }
    (square / scale).sqrt()
}

/// Cell-relative coordinates preserve single precision far from the origin; absolute ones do not.
#[test]
fn single_precision_needs_cell_relative_coordinates() {
    let relative = single_precision_error(Coordinates::CellRelative);
    let absolute = single_precision_error(Coordinates::Absolute);
    println!("relative rms error: cell-relative {relative:.2e}, absolute {absolute:.2e}");
    assert!(relative < 1e-5, "{relative}");
    assert!(absolute > 10.0 * relative, "{absolute} against {relative}");
}
