//! What a law states is held to, and its energy is that of its force.

mod support;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::granular::Contact;
use stripmine_kernels::law::{Env, Field, Law, Sum, check};
use stripmine_kernels::sweep::pair::Pair;
use stripmine_kernels::{Execution, InstructionSet};
use support::{CONTACT, Case, System, equal, random_pairs, varying};

/// Asks for the radius and adds to the torque, and states neither.
#[derive(Clone, Debug, Default)]
struct Forgetful {
    torque: bool,
    /// It asks for nothing the first time, so that it looks right when it is tried.
    hides: bool,
    tried: std::sync::Arc<AtomicBool>,
}

impl Law<2> for Forgetful {
    type Own<V: Copy> = [V; 2];
    const FIELDS: &'static [Field] = &[Field::Vx, Field::Vy];
    const SUMS: &'static [Sum] = &[Sum::Fx, Sum::Fy];

    fn own<E: Env<2>>(&self, env: E) -> [E::V; 2] {
        env.own_position()
    }

    fn pair<E: Env<2>>(&self, env: E, place: E::Place, own: &[E::V; 2]) {
        let [dx, _] = env.displacement(*own, place);
        env.own_add(Sum::Fx, dx);
        if self.hides && !self.tried.swap(true, Ordering::Relaxed) {
            return;
        }
        match self.torque {
            true => env.own_add(Sum::Torque, dx),
            false => env.own_add(Sum::Fy, dx * env.partner(Field::Radius, place)),
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
fn a_law_that_forgets_a_field_or_a_sum_is_refused() {
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
    assert_eq!(RADIUS.to_string(), "the law asks for the radius, which it does not state");
}

/// A law in safe code that looks right when it is tried stops at what it did not state; nothing is read out of bounds.
#[test]
fn a_law_that_hides_what_it_asks_for_is_stopped() {
    let system = System::<f64, f64>::random(&Case::new(13, 9));
    let order: Vec<u32> = (0..system.discs as u32).collect();
    for (torque, refusal) in [(false, RADIUS), (true, TORQUE)] {
        let law = Forgetful { torque, hides: true, ..Forgetful::default() };
        let stopped = message(|| system.fast_forces(&law, &order, InstructionSet::best()));
        assert_eq!(stopped, refusal.to_string());
    }
}

#[test]
fn the_laws_that_run_state_what_they_ask_for() {
    assert_eq!(check(&varying::<true>(CONTACT)), Ok(()));
    assert_eq!(check(&varying::<false>(CONTACT)), Ok(()));
    assert_eq!(check(&equal::<true>(CONTACT)), Ok(()));
    assert_eq!(check(&equal::<false>(CONTACT)), Ok(()));
}

/// Of springs alone the force is the energy's slope, and the virial is that force along the way between the centres.
#[test]
fn the_energy_is_that_of_the_force_and_the_virial_is_the_forces() {
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
        let way = [0, 1].map(|axis| pair.bodies[0].position[axis] - pair.bodies[1].position[axis]);
        let by_force = way[0] * force[0] + way[1] * force[1];
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
