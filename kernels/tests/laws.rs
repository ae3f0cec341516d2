//! Laws can use only the quantities they state, and their energies match their forces.

mod support;

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::granular::Contact;
use stripmine_kernels::law::lennard_jones::LennardJones;
use stripmine_kernels::law::potential::CutOff;
use stripmine_kernels::law::{Axis, Env, Law, LawTable, ParticleField, ParticleSum, StatedEnv, check};
use stripmine_kernels::sweep::pair::Pair;
use stripmine_kernels::{Execution, InstructionSet};
use support::{CONTACT, Case, System, equal, random_pairs, varying};

/// Reads the radius and adds to the torque, and states neither.
#[derive(Clone, Debug, Default)]
struct Forgetful {
    torque: bool,
    /// Reads nothing the first time, so that it passes the check.
    hides: bool,
    tried: std::sync::Arc<AtomicBool>,
}

impl Law<2> for Forgetful {
    type Own<V: Copy> = [V; 2];
    const FIELDS: &'static [ParticleField] =
        &[ParticleField::Velocity(Axis::X), ParticleField::Velocity(Axis::Y)];
    const SUMS: &'static [ParticleSum] = &[ParticleSum::Force(Axis::X), ParticleSum::Force(Axis::Y)];

    fn own<E: Env<2>>(&self, env: E) -> [E::V; 2] {
        env.own_position()
    }

    fn pair<E: Env<2>>(&self, env: E, partner: E::Partner, own: &[E::V; 2]) {
        let [dx, _] = env.displacement(*own, partner);
        env.own_add(ParticleSum::Force(Axis::X), dx);
        if self.hides && !self.tried.swap(true, Ordering::Relaxed) {
            return;
        }
        match self.torque {
            true => env.own_add(ParticleSum::Torque, dx),
            false => {
                env.own_add(ParticleSum::Force(Axis::Y), dx * env.partner(ParticleField::Radius, partner))
            }
        }
    }
}

const RADIUS: ProgramError = ProgramError::Unstated("the radius");
const TORQUE: ProgramError = ProgramError::Unstated("the torque");

fn message<R>(work: impl FnOnce() -> R) -> String {
    let panic = catch_unwind(AssertUnwindSafe(work)).err().expect("a panic");
    panic.downcast_ref::<String>().expect("a formatted message").clone()
}

#[test]
fn incomplete_laws_are_rejected() {
    let system = System::<f64, f64>::random(&Case::new(13, 9));
    let order: Vec<u32> = (0..system.discs as u32).collect();
    for (torque, refusal) in [(false, RADIUS), (true, TORQUE)] {
        let law = Forgetful { torque, ..Forgetful::default() };
        assert_eq!(check(&law), Err(refusal.clone()));
        let swept = system.fast_forces(&law, &order, InstructionSet::best());
        assert_eq!(swept.map(|_| ()), Err(refusal.clone()));
        assert_eq!(message(|| Pair::touching().sums(&law)), refusal.to_string());
        let how = (Execution::Chained, InstructionSet::best());
        let recorded = message(|| system.clone().forces(&Case::new(13, 9), &law, how));
        assert_eq!(recorded, refusal.to_string());
    }
    assert_eq!(
        RADIUS.to_string(),
        "the law uses the radius without stating it; add it to its FIELDS or SUMS"
    );
}

/// A law in safe code that passes the check is stopped at the first unstated quantity; nothing is read out of bounds.
#[test]
fn laws_hiding_unstated_quantities_are_stopped() {
    let system = System::<f64, f64>::random(&Case::new(13, 9));
    let order: Vec<u32> = (0..system.discs as u32).collect();
    for (torque, refusal) in [(false, RADIUS), (true, TORQUE)] {
        let law = Forgetful { torque, hides: true, ..Forgetful::default() };
        let stopped = message(|| system.fast_forces(&law, &order, InstructionSet::best()));
        assert_eq!(stopped, refusal.to_string());
    }
}

/// Dashpots in space: each particle is slowed by its velocity relative to the partner. A planar law would ignore the third axis.
#[derive(Clone, Copy, Debug)]
struct Dashpot {
    /// True if the law also adds a torque, which no law in space can state.
    turns: bool,
}

impl Law<3> for Dashpot {
    type Own<V: Copy> = [V; 3];
    const FIELDS: &'static [ParticleField] = &[
        ParticleField::Velocity(Axis::X),
        ParticleField::Velocity(Axis::Y),
        ParticleField::Velocity(Axis::Z),
    ];
    const SUMS: &'static [ParticleSum] =
        &[ParticleSum::Force(Axis::X), ParticleSum::Force(Axis::Y), ParticleSum::Force(Axis::Z)];

    fn own<E: Env<3>>(&self, env: E) -> [E::V; 3] {
        Axis::ALL.map(|axis| env.own(ParticleField::Velocity(axis)))
    }

    fn pair<E: Env<3>>(&self, env: E, partner: E::Partner, own: &[E::V; 3]) {
        for axis in Axis::ALL {
            let force = env.partner(ParticleField::Velocity(axis), partner) - own[axis as usize];
            env.own_add(ParticleSum::Force(axis), force);
            if E::BOTH_PARTNERS {
                env.partner_sub(ParticleSum::Force(axis), partner, force);
            }
        }
        if self.turns {
            env.own_add(ParticleSum::Torque, env.uniform(1.0));
        }
    }
}

/// Environment of two particles in space, with their sums.
struct InSpace {
    velocity: [[f64; 3]; 2],
    sums: RefCell<[[f64; 3]; 2]>,
}

impl InSpace {
    fn velocity(&self, particle: usize, field: ParticleField) -> f64 {
        match field {
            ParticleField::Velocity(axis) => self.velocity[particle][axis as usize],
            _ => panic!("particles in space have velocities only, not {}", field.name()),
        }
    }
}

impl Env<3> for &InSpace {
    type V = f64;
    type Partner = ();
    const BOTH_PARTNERS: bool = true;

    fn own_position(self) -> [f64; 3] {
        [0.0; 3]
    }
    fn own(self, field: ParticleField) -> f64 {
        self.velocity(0, field)
    }
    fn displacement(self, _: [f64; 3], (): ()) -> [f64; 3] {
        [1.0; 3]
    }
    fn partner(self, field: ParticleField, (): ()) -> f64 {
        self.velocity(1, field)
    }
    fn uniform(self, value: f64) -> f64 {
        value
    }
    fn lookup<const N: usize>(self, table: &LawTable, columns: [usize; N], number: f64) -> [f64; N] {
        table.numbers(columns, number)
    }
    fn none(self, predicate: bool) -> bool {
        !predicate
    }
    fn own_add(self, sum: ParticleSum, value: f64) {
        self.sums.borrow_mut()[0][sum.column::<3>()] += value;
    }
    fn partner_sub(self, sum: ParticleSum, (): (), value: f64) {
        self.sums.borrow_mut()[1][sum.column::<3>()] -= value;
    }
    fn watches(self) -> bool {
        false
    }
    fn watch(self, _: f64) {}
    fn counts_dissipation(self) -> bool {
        false
    }
    fn dissipate(self, _: f64) {}
    fn observes_energy(self) -> bool {
        false
    }
    fn energy(self, _: f64) {}
    fn virial(self, _: f64) {}
    fn section(self, _: &'static str) {}
}

#[test]
fn laws_in_space_use_z_without_torque() {
    let meet = |law: Dashpot| {
        let pair = InSpace { velocity: [[1.0, 2.0, 3.0], [5.0, 4.0, -3.0]], sums: RefCell::default() };
        let env = StatedEnv::new(&pair, &law);
        let own = law.own(env);
        law.pair(env, (), &own);
        pair.sums.into_inner()
    };
    let dashpot = Dashpot { turns: false };
    assert_eq!(check(&dashpot), Ok(()));
    assert_eq!(meet(dashpot), [[4.0, 2.0, -6.0], [-4.0, -2.0, 6.0]]);
    let turning = Dashpot { turns: true };
    assert_eq!(check(&turning), Err(TORQUE));
    assert_eq!(message(|| meet(turning)), TORQUE.to_string());
}

/// A law of the plane that reads a quantity of the third axis is rejected like any that reads an unstated one.
#[test]
fn planar_laws_cannot_read_z() {
    #[derive(Clone)]
    struct Lifting;
    impl Law<2> for Lifting {
        type Own<V: Copy> = V;
        const FIELDS: &'static [ParticleField] =
            &[ParticleField::Velocity(Axis::X), ParticleField::Velocity(Axis::Y)];
        const SUMS: &'static [ParticleSum] = &[ParticleSum::Force(Axis::X)];
        fn own<E: Env<2>>(&self, env: E) -> E::V {
            env.own(ParticleField::Velocity(Axis::Z))
        }
        fn pair<E: Env<2>>(&self, env: E, _: E::Partner, own: &E::V) {
            env.own_add(ParticleSum::Force(Axis::X), *own);
        }
    }
    let refusal = ProgramError::Unstated("the velocity along z");
    assert_eq!(check(&Lifting), Err(refusal.clone()));
    assert_eq!(message(|| Pair::touching().sums(&Lifting)), refusal.to_string());
}

/// The lists contain every field and sum of their dimensions, each in one column.
#[test]
fn planar_lists_omit_z() {
    let planar: Vec<ParticleField> = ParticleField::ALL.into_iter().filter(|field| field.is_in(2)).collect();
    assert_eq!(planar, ParticleField::PLANAR);
    let planar: Vec<ParticleSum> = ParticleSum::ALL.into_iter().filter(|sum| sum.is_in(2)).collect();
    assert_eq!(planar, ParticleSum::PLANAR);
    assert_eq!(ParticleSum::PLANAR.map(ParticleSum::column::<2>), [0, 1, 2]);
    let spatial = ParticleSum::ALL.into_iter().filter(|sum| sum.is_in(3)).map(ParticleSum::column::<3>);
    assert_eq!(spatial.collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
}

#[test]
fn granular_laws_pass_their_check() {
    assert_eq!(check(&varying::<true>(CONTACT)), Ok(()));
    assert_eq!(check(&varying::<false>(CONTACT)), Ok(()));
    assert_eq!(check(&equal::<true>(CONTACT)), Ok(()));
    assert_eq!(check(&equal::<false>(CONTACT)), Ok(()));
}

/// For springs alone, the force is the slope of the energy, and the virial is that force times the vector between the centres.
#[test]
fn spring_energy_and_virial_match_the_force() {
    let springs = Contact { normal_damping: 0.0, shear_damping: 0.0, friction: 0.0, ..CONTACT };
    let law = varying::<true>(springs);
    let (mut touching, mut apart) = (0, 0);
    for pair in random_pairs(5, 300) {
        let [force, _] = pair.sums(&law);
        let [energy, virial] = pair.energy_and_virial(&law);
        if pair.depth() <= 0.0 {
            apart += 1;
            assert_eq!([energy, virial], [0.0, 0.0]);
            continue;
        }
        touching += 1;
        let displacement = [0, 1].map(|axis| pair.bodies[0].position[axis] - pair.bodies[1].position[axis]);
        let by_force = displacement[0] * force[0] + displacement[1] * force[1];
        assert!((virial - by_force).abs() < 1e-12 * by_force.abs().max(1.0), "{virial} {by_force}");
        for axis in 0..2 {
            let h = 1e-6;
            let moved = |by: f64| {
                let mut pair = pair;
                pair.bodies[0].position[axis] += by;
                pair.energy_and_virial(&law)[0]
            };
            let slope = (moved(h) - moved(-h)) / (2.0 * h);
            assert!((slope + force[axis]).abs() < 1e-4, "{slope} {force:?}");
        }
    }
    assert!(touching > 100, "{touching} touch, {apart} do not");
}

/// The Lennard-Jones force is minus the slope of its energy, opposite on the two particles, and zero beyond the cut-off, where
/// the energy reaches 0. With the cut-off at 2^(1/6) σ the force vanishes there too.
#[test]
fn lennard_jones_forces_are_slopes_of_the_energy() {
    let sigma = 0.7;
    for (cutoff, only_repels) in [(2.5 * sigma, false), (2f64.powf(1.0 / 6.0) * sigma, true)] {
        let law = CutOff::new(LennardJones::new(1.3, sigma), cutoff);
        let at = |distance: f64| {
            let angle = 0.4f64;
            let mut pair = Pair::touching();
            pair.bodies[0].position = [1.0, 2.0];
            pair.bodies[1].position = [1.0 + distance * angle.cos(), 2.0 + distance * angle.sin()];
            let [own, partner] = pair.sums(&law);
            assert_eq!([own[0], own[1], own[2]], [-partner[0], -partner[1], 0.0]);
            // Positive if the particles repel each other.
            let outwards = -(own[0] * angle.cos() + own[1] * angle.sin());
            let [energy, virial] = pair.energy_and_virial(&law);
            assert!((virial - outwards * distance).abs() <= 1e-13 * (1.0 + virial.abs()));
            (outwards, energy)
        };
        for step in 0..200 {
            let distance = sigma * (0.85 + 0.01 * f64::from(step));
            let (force, energy) = at(distance);
            // At the very edge either value is right.
            if (distance / cutoff - 1.0).abs() < 1e-12 {
                continue;
            }
            if distance >= cutoff {
                assert_eq!((force, energy), (0.0, 0.0));
                continue;
            }
            let sixth = (sigma / distance).powi(6);
            let shift = 5.2 * (sigma / cutoff).powi(6) * ((sigma / cutoff).powi(6) - 1.0);
            assert!((energy - (5.2 * sixth * (sixth - 1.0) - shift)).abs() < 1e-12 * (1.0 + energy.abs()));
            assert!(!only_repels || force >= 0.0);
            let h = 1e-6 * distance;
            if distance + h < cutoff {
                let slope = (at(distance - h).1 - at(distance + h).1) / (2.0 * h);
                assert!((force - slope).abs() < 1e-6 * (1.0 + force.abs()), "{distance}: {force} {slope}");
            }
        }
        assert!(at(cutoff * (1.0 - 1e-12)).1.abs() < 1e-10);
    }
}
