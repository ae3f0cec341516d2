//! Power, energy and virial: every sweep gives those of all pairs, and kernels on the lattice contain no operation for
//! observations that are not requested.

mod support;

use stripmine_kernels::isa::Element;
use stripmine_kernels::law::granular::{Contact, ContactArm, Granular};
use stripmine_kernels::law::{Law, ObservationRequest};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::forces::Forces;
use stripmine_kernels::sweep::neighbor_list::{CellOffsets, ListDiscs, NeighbourLists, sweep_lists};
use stripmine_kernels::sweep::pair::{Pair, PairBody};
use stripmine_kernels::{Execution, InstructionSet, Program};
use support::{CONTACT, Case, System, all_configurations, varying};

const ASKED: ObservationRequest = ObservationRequest { watched: None, dissipation: true, energy: true };

/// Discs at random positions, every fifth of them fixed.
fn some_fixed(case: &Case) -> System<f64, f64> {
    let mut system = System::random(case);
    system.lattice_inverse_mass.iter_mut().step_by(5).for_each(|inverse| *inverse = 0.0);
    system
}

/// Totals over all pairs, each evaluated alone.
#[derive(Default)]
struct Alone {
    /// Energy and virial.
    energy: [f64; 2],
    /// Contacts with at least one mobile disc, and the deepest of them.
    contacts: u64,
    deepest: f64,
    /// Contacts between two fixed discs.
    fixed: usize,
}

/// Energy, virial and contacts of all pairs, each evaluated alone. The virial follows from the forces: (r_i − r_j)·F_i, where
/// neither is fixed.
fn by_pairs<L: Law<2>>(system: &System<f64, f64>, law: &L) -> Alone {
    let sides = [system.shape.columns(), system.shape.rows()];
    let body = |disc: usize| PairBody {
        position: [0, 1].map(|axis| system.state[axis][0][disc]),
        velocity: [0, 1].map(|axis| system.velocity[axis][disc]),
        omega: system.velocity[2][disc],
        radius: system.radius[disc],
        inverse_mass: system.lattice_inverse_mass[disc],
    };
    let mut all = Alone::default();
    for i in 0..system.discs {
        for j in 0..i {
            let mut bodies = [body(i), body(j)];
            for (axis, side) in sides.into_iter().enumerate() {
                let period = side as f64 * system.frame.edge[axis];
                if system.shape.periodic()[axis] {
                    let displacement = bodies[0].position[axis] - bodies[1].position[axis];
                    bodies[1].position[axis] += (displacement / period).round() * period;
                }
            }
            let pair = Pair { bodies };
            let fixed = bodies.iter().filter(|body| body.inverse_mass == 0.0).count();
            let [energy, virial] = pair.energy_and_virial(law);
            assert!(fixed < 2 || [energy, virial] == [0.0; 2], "{energy} {virial}");
            if pair.depth() > 0.0 {
                let apart = [0, 1].map(|axis| bodies[0].position[axis] - bodies[1].position[axis]);
                let [[fx, fy, _], _] = pair.sums(law);
                let expected = if fixed == 0 { apart[0] * fx + apart[1] * fy } else { 0.0 };
                assert!(
                    (virial - expected).abs() < 1e-12 * (1.0 + expected.abs()),
                    "virial {virial}, expected {expected}"
                );
                all.fixed += usize::from(fixed == 2);
                all.contacts += u64::from(fixed < 2);
                let reach = bodies[0].radius + bodies[1].radius;
                all.deepest = all.deepest.max(if fixed < 2 { pair.depth() / reach } else { 0.0 });
            }
            all.energy.iter_mut().zip([energy, virial]).for_each(|(sum, more)| *sum += more);
        }
    }
    all
}

/// Power, energy and virial from the lattice's sweep: shares summed over the mobile discs.
fn on_lattice<L: Law<2>>(
    start: &System<f64, f64>,
    case: &Case,
    law: &L,
    how: (Execution, InstructionSet),
) -> [f64; 3] {
    let (mut asked, mut unasked) = (start.clone(), start.clone());
    for system in [&mut asked, &mut unasked] {
        system.index(case, law, how);
        assert_eq!((system.strays, system.conflicts), (0, 0));
    }
    asked.forces_and(case, law, how, ASKED).unwrap();
    unasked.forces(case, law, how).unwrap();
    let bits =
        |system: &System<f64, f64>| -> Vec<u64> { system.sums.iter().flatten().map(|x| x.bits()).collect() };
    assert!(bits(&asked) == bits(&unasked), "observations changed a force");
    assert!(
        unasked.observed.iter().flatten().all(|&x| x == 0.0),
        "an observation was written without a request"
    );
    let moving = (0..start.discs).filter(|&disc| start.lattice_inverse_mass[disc] != 0.0);
    let cells: Vec<usize> = moving.map(|disc| asked.cell[disc] as usize - 1).collect();
    asked.observed.each_ref().map(|column| cells.iter().map(|&cell| column[cell]).sum())
}

/// Power, energy and virial from lists, disc by disc.
fn by_lists<L: Law<2>>(start: &System<f64, f64>, case: &Case, law: &L) -> [f64; 3] {
    let mut system = start.clone();
    system.index(case, law, (Execution::Chained, InstructionSet::best()));
    let mask = Mask::square(case.half_width);
    let offsets = CellOffsets::new(system.shape, system.frame, &mask, true);
    let lists = NeighbourLists::by_all_pairs(system.discs, |i, _| system.lattice_inverse_mass[i] != 0.0);
    let [vx, vy, omega] = &system.velocity;
    let discs = ListDiscs {
        position: [&system.on_lattice[0], &system.on_lattice[1]],
        velocity: [vx, vy],
        omega,
        radius: &system.radius,
        inverse_mass: &system.lattice_inverse_mass,
        mass: &system.mass,
        cell: &system.cell,
    };
    let met = sweep_lists(law, &lists, &offsets, discs, system.discs, 2.3, ASKED, |_, _| ());
    [met.dissipated, met.energy[0], met.energy[1]]
}

#[test]
fn all_sweeps_give_power_energy_and_virial() {
    let mut fixed_pairs = 0;
    for (seed, periodic) in [[true, true], [false, true], [false, false]].into_iter().enumerate() {
        let case = Case { periodic, seed: seed as u64, fill: 0.6, ..Case::new(23, 17) };
        let arm = [ContactArm::Radius, ContactArm::Overlap, ContactArm::Lammps][seed];
        let law = varying::<true>(Contact { arm, ..CONTACT });
        let system = some_fixed(&case);
        let alone = by_pairs(&system, &law);
        let pairs = alone.energy;
        fixed_pairs += alone.fixed;
        let order: Vec<u32> = (0..system.discs as u32).collect();
        let (_, fast) = system.fast_forces(&law, &order, InstructionSet::best()).unwrap();
        let power = fast.dissipated;
        assert_eq!(fast.contacts, alone.contacts);
        assert!((fast.deepest / alone.deepest - 1.0).abs() < 1e-11, "{} {}", fast.deepest, alone.deepest);
        let expected = [power, pairs[0], pairs[1]];
        assert!(expected.iter().all(|&sum| sum > 1.0), "{expected:?}");
        let agrees = |found: [f64; 3], by: &str| {
            for (found, expected) in found.into_iter().zip(expected) {
                assert!(
                    (found / expected - 1.0).abs() < 1e-11,
                    "{by}: {found}, expected {expected}, in {case:?}"
                );
            }
        };
        agrees([power, fast.energy[0], fast.energy[1]], "fast");
        agrees(by_lists(&system, &case, &law), "lists");
        for how in all_configurations() {
            agrees(on_lattice(&system, &case, &law, how), &format!("{how:?}"));
        }
    }
    assert!(fixed_pairs > 0, "the cases have no contact of two fixed discs");
}

/// Energy is a section of its own on the tape; without requests, the kernel contains no observation.
#[test]
fn unrequested_observations_are_not_recorded() {
    let case = Case::new(9, 7);
    let system = System::<f64, f64>::random(&case);
    let contact = Contact { arm: ContactArm::Overlap, ..CONTACT };
    let sections = |asked: ObservationRequest| {
        let law: Granular<true, false> = varying(contact);
        let mask = Mask::square(case.half_width);
        let forces = Forces::<f64, _>::new(law, &mask, system.shape, system.frame, case.coordinates);
        Program::new(forces.asked(asked)).tape().tally()
    };
    let total = |asked: ObservationRequest, name: &str| {
        let of_name = sections(asked).into_iter().filter(|(section, _)| *section == name);
        of_name.map(|(_, counts)| counts.total()).sum::<u64>()
    };
    let (unasked, energy) =
        (ObservationRequest::default(), ObservationRequest { energy: true, ..ObservationRequest::default() });
    assert_eq!(total(unasked, "energy"), 0);
    assert!(total(energy, "energy") > 0);
    for section in ["own disc", "distance", "contact", "normal force", "shear force"] {
        assert_eq!(total(unasked, section), total(energy, section), "{section}");
    }
    // The sums with their two stores.
    assert_eq!(total(unasked, "sums") + 2, total(energy, "sums"));
}
