//! The lattice and its rival, the neighbour list, are the same physics: "no differences in the results" (BP93,
//! section 4), here to the bit.

mod support;

use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::SteppedState;
use stripmine_physics::method::lattice_md::{
    ContactSearch, GranularModel, ListOptions, ProgramExecution, ProgramVersion, Rebuild, SteppedGrains,
};
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::Precision;
use support::{advance, fast, gas, printed_gas, simulate};

fn trajectories_agree(precision: Precision, coordinates: Coordinates, rebuild: Rebuild, steps: u64) {
    let mut start = gas(400, 0.84, 7);
    start.0.coordinates = coordinates;
    agree(precision, &start, rebuild, steps);
}

fn agree(precision: Precision, start: &(GranularModel, Particles), rebuild: Rebuild, steps: u64) {
    let mut lattice = simulate(precision, start, ContactSearch::Lattice, fast());
    let mut list =
        simulate(precision, start, ContactSearch::Lists(ListOptions { rebuild, skin: 0.2 }), fast());
    for _ in 0..10 {
        advance(&mut lattice, steps / 10);
        advance(&mut list, steps / 10);
        // Lists also store the positions of their last rebuild.
        let of_list = list.columns();
        let same = |column| of_list.contains(column);
        assert!(lattice.columns().iter().all(same), "they differ after {} steps", lattice.steps());
    }
    let (_, rebuilds) = list.lists().unwrap();
    assert!(rebuilds > 2, "the discs must have moved through the lists");
    let touching = lattice.forces().iter().filter(|force| force[0] != 0.0).count();
    assert!(touching > 100, "the scene must have contacts");
}

#[test]
fn bits_agree_over_ten_thousand_steps() {
    trajectories_agree(Precision::F64, Coordinates::CellRelative, Rebuild::Cells, 10_000);
}

#[test]
fn bits_agree_with_absolute_positions() {
    trajectories_agree(Precision::F64, Coordinates::Absolute, Rebuild::AllPairs, 2_000);
}

#[test]
fn bits_agree_in_single_precision() {
    trajectories_agree(Precision::F32, Coordinates::CellRelative, Rebuild::Cells, 2_000);
}

#[test]
fn bits_agree_with_the_printed_program() {
    agree(Precision::F64, &printed_gas(400, 0.84, 7), Rebuild::AllPairs, 2_000);
}

/// All executions of BP93's own program, on every instruction set, give the same run; our program agrees except for rounding.
#[test]
fn printed_program_agrees_for_every_execution() {
    const STEPS: u64 = 200;
    let start = printed_gas(200, 0.84, 3);
    let after = |start: &(GranularModel, Particles), execution, set| {
        let mut engine =
            simulate(Precision::F64, start, ContactSearch::Lattice, ProgramExecution { execution, set });
        advance(&mut engine, STEPS);
        engine
    };
    let state = |engine: &SteppedGrains| engine.columns();
    let printed = after(&start, Execution::Chained, InstructionSet::Scalar);
    for set in InstructionSet::available() {
        for execution in [Execution::Eager, Execution::Strip(64), Execution::Strip(7), Execution::Chained] {
            let same = state(&after(&start, execution, set)) == state(&printed);
            assert!(same, "{execution:?} on {set:?} differs");
        }
    }
    let ours = GranularModel { text: ProgramVersion::Ours, ..start.0.clone() };
    let ours = after(&(ours, start.1.clone()), Execution::Chained, InstructionSet::best());
    let (printed, ours) = (printed.particles(), ours.particles());
    let mut moved = 0.0_f64;
    for ((printed, ours), begun) in printed.all().iter().zip(ours.all()).zip(start.1.all()) {
        for axis in 0..2 {
            let off = (printed.velocity[axis] - ours.velocity[axis]).abs();
            assert!(off < 1e-10, "disc {}: velocities differ by {off}", printed.id);
            moved = moved.max((printed.velocity[axis] - begun.velocity[axis]).abs());
        }
        assert!((printed.omega - ours.omega).abs() < 1e-9, "disc {}", printed.id);
    }
    assert!(moved > 0.05, "collisions must have happened: {moved}");
}

/// The small pipe with both programs: fixed and moving walls, a closed side, gravity.
#[test]
fn printed_program_gives_our_pipe_within_rounding() {
    use stripmine_physics::method::lattice_md::{GranularDocument, assemble};
    let run = |preset: &str, overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        let mut engine =
            assemble(&GranularDocument::load(preset, &overrides).unwrap().check().unwrap()).unwrap();
        advance(&mut engine, 300);
        engine.particles()
    };
    let walls = [
        "particles.wall_motion=oscillating",
        "particles.wall_amplitude=[0.0002,0.0]",
        "particles.wall_frequency=30",
    ];
    for more in [&[][..], &walls] {
        let printed = run("pipe-small-printed", more);
        let same_law = ["law.cohesionless=false", "machine.engine=programs", "machine.coordinates=absolute"];
        let ours = run("pipe-small", &[&same_law, more].concat());
        for (printed, ours) in printed.all().iter().zip(ours.all()) {
            for axis in 0..2 {
                let off = (printed.position[axis] - ours.position[axis]).abs();
                assert!(off < 1e-9, "disc {}: {:?} and {:?}", ours.id, printed.position, ours.position);
            }
        }
    }
}
