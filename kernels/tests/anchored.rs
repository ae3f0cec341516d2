//! The Index of discs with positions relative to their last cells: compared with plain arithmetic, and bit-equal in every
//! execution.

mod support;

use rand::RngExt;
use stripmine_kernels::isa::{Array, LaneCounter, Memory, Slot};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::sweep::lattice::cells::{EnterDiscs, STRAYS};
use stripmine_kernels::sweep::lattice::{LatticeFrame, LatticeShape};
use stripmine_kernels::{Execution, InstructionSet, Program};

const DISCS: usize = 300;

/// Inputs and outputs of the kernel.
#[derive(Clone, Debug, PartialEq)]
struct Discs {
    cell: Vec<u32>,
    place: [Vec<f32>; 2],
    on_lattice: [Vec<f32>; 2],
    strays: u64,
}

fn entered(
    start: &Discs,
    shape: LatticeShape,
    frame: LatticeFrame,
    how: (Execution, InstructionSet),
) -> Discs {
    let mut discs = start.clone();
    let mut index = vec![0; shape.padded()];
    let Discs { cell, place: [x, y], on_lattice: [lattice_x, lattice_y], strays } = &mut discs;
    let mut memory = Memory::new();
    memory.bind_write(Slot::new(Array::DiscCell), cell);
    memory.bind_write(Slot::new(Array::Index), &mut index);
    memory.bind_write(Slot::new(Array::X0), x);
    memory.bind_write(Slot::new(Array::Y0), y);
    memory.bind_write(Slot::new(Array::DiscX), lattice_x);
    memory.bind_write(Slot::new(Array::DiscY), lattice_y);
    Program::new(EnterDiscs::<f32, f32>::anchored(shape, frame))
        .run(&memory, 0..DISCS, how.0, how.1)
        .unwrap();
    let LaneCounter(number) = STRAYS;
    *strays = memory.counted(LaneCounter(number));
    discs
}

#[test]
fn discs_are_indexed_from_their_last_cells() {
    // A box far from the origin, where single precision could not distinguish cells.
    let frame = LatticeFrame { origin: [-3e7, 5e8], edge: [0.7, 0.9] };
    for (periodic, half_width) in [([true, true], 2), ([true, false], 3), ([false, false], 2)] {
        let (columns, rows) = (23_usize, 11_usize);
        let mask = Mask::square(half_width);
        let shape = LatticeShape::new(columns, rows, &mask, periodic).unwrap();
        let mut random = Stream::new(5, RandomPurpose::Test, half_width);
        let mut draw = |most: f64| (most * random.random::<f64>()) as usize;
        let from: Vec<[usize; 2]> = (0..DISCS).map(|_| [draw(columns as f64), draw(rows as f64)]).collect();
        let mut random = Stream::new(6, RandomPurpose::Test, half_width);
        // A third of the discs stays in its cell, the others move up to three cells away.
        let place: [Vec<f32>; 2] = [0, 1].map(|axis| {
            let reach = |disc: usize| if disc.is_multiple_of(3) { 0.49 } else { 3.0 };
            (0..DISCS)
                .map(|disc| (frame.edge[axis] * reach(disc) * random.random_range(-1.0..1.0)) as f32)
                .collect()
        });
        let number = |[column, row]: [usize; 2]| shape.position(column as isize, row as isize) as u32 + 1;
        let start = Discs {
            cell: from.iter().map(|&from| number(from)).collect(),
            on_lattice: place.clone(),
            place,
            strays: 0,
        };
        let first = entered(&start, shape, frame, (Execution::Chained, InstructionSet::Scalar));
        let mut strays = 0;
        for (disc, &from) in from.iter().enumerate() {
            let counts = [columns, rows];
            let mut to = [0; 2];
            let mut moved = [0.0; 2];
            let mut inside = true;
            for axis in 0..2 {
                let (count, edge) = (counts[axis] as f64, frame.edge[axis]);
                let r = f64::from(start.place[axis][disc]);
                let there = (from[axis] as f64 + 0.5 + r / edge).floor();
                let wrapped = if periodic[axis] { there.rem_euclid(count) } else { there };
                inside &= (0.0..count).contains(&wrapped);
                to[axis] = wrapped.max(0.0) as usize;
                moved[axis] = r + (from[axis] as f64 - there) * edge;
            }
            if !inside {
                strays += 1;
                assert_eq!(first.cell[disc], 0);
                let stays = (0..2).all(|axis| first.place[axis][disc] == start.place[axis][disc]);
                assert!(stays, "a stray must keep its reference cell");
                continue;
            }
            assert_eq!(first.cell[disc], number(to), "disc {disc}");
            for (axis, moved) in moved.into_iter().enumerate() {
                let found = first.place[axis][disc];
                assert!((f64::from(found) - moved).abs() < 1e-6, "disc {disc}");
                assert_eq!(found, first.on_lattice[axis][disc]);
                assert!(
                    !disc.is_multiple_of(3) || found == start.place[axis][disc],
                    "a disc that stays in its cell must not change"
                );
            }
        }
        assert_eq!(first.strays, strays);
        assert_eq!(strays > 5, periodic != [true, true]);
        for how in support::all_configurations() {
            // A stray's copy for the lattice is never read.
            assert_eq!(entered(&start, shape, frame, how), first, "{how:?}");
        }
    }
}
