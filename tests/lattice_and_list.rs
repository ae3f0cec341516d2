//! The lattice and its rival, the neighbour list, are the same physics: "no differences in the results" (BP93,
//! section 4), here to the bit.

mod support;

use stripmine::method::lattice_md::{Contacts, ListOptions, Rebuild};
use stripmine::scene::Precision;
use stripmine_kernels::sweep::lattice::Coordinates;
use support::{advance, fast, gas, simulate};

fn trajectories_agree(precision: Precision, coordinates: Coordinates, rebuild: Rebuild, steps: u64) {
    let mut start = gas(400, 0.84, 7);
    start.0.coordinates = coordinates;
    let mut lattice = simulate(precision, &start, Contacts::Lattice, fast());
    let mut list = simulate(precision, &start, Contacts::Lists(ListOptions { rebuild, skin: 0.2 }), fast());
    for _ in 0..10 {
        advance(lattice.as_mut(), steps / 10);
        advance(list.as_mut(), steps / 10);
        // Lists keep beside it where they were made.
        let of_list = list.state();
        let same = |column| of_list.contains(column);
        assert!(lattice.state().iter().all(same), "they differ after {} steps", lattice.steps());
    }
    let (_, rebuilds) = list.lists().unwrap();
    assert!(rebuilds > 2, "the discs must have moved through the lists");
    let touching = lattice.forces().iter().filter(|force| force[0] != 0.0).count();
    assert!(touching > 100, "the scene must have contacts");
}

#[test]
fn trajectories_are_equal_to_the_bit_over_ten_thousand_steps() {
    trajectories_agree(Precision::F64, Coordinates::CellRelative, Rebuild::Cells, 10_000);
}

#[test]
fn trajectories_are_equal_to_the_bit_with_absolute_positions_and_lists_of_all_pairs() {
    trajectories_agree(Precision::F64, Coordinates::Absolute, Rebuild::AllPairs, 2_000);
}

#[test]
fn trajectories_are_equal_to_the_bit_in_single_precision() {
    trajectories_agree(Precision::F32, Coordinates::CellRelative, Rebuild::Cells, 2_000);
}
