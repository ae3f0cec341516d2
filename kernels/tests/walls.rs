//! The vector program of plane walls: every execution has the bits of the law evaluated for one disc and one element at a time.

use rand::RngExt;
use stripmine_kernels::isa::{Array, Memory, Slot};
use stripmine_kernels::law::granular::{Contact, ContactArm, EqualDiscs, Granular};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::sweep::fast::CellGrid;
use stripmine_kernels::sweep::lattice::LatticeFrame;
use stripmine_kernels::sweep::walls::{
    ELEMENT_NUMBERS, TouchingDisc, WALL_ARRAYS, WallForces, WallSurface, elements, pieces, touch,
};
use stripmine_kernels::{Execution, InstructionSet, Program};

const CONTACT: Contact = Contact {
    spring: Spring::Hertz,
    stiffness: 300.0,
    normal_damping: 2.0,
    shear_damping: 3.0,
    friction: 0.4,
    cohesionless: true,
    arm: ContactArm::Overlap,
};
const COUNTS: [usize; 2] = [12, 9];
const EDGE: [f64; 2] = [0.7, 0.8];

/// Lattice vectors of the discs: x, y, their velocities, the angular velocity, radius and inverse mass; and the three sums.
type Columns = [Vec<f32>; 10];

const ARRAYS: [Array; 10] = [
    Array::X,
    Array::Y,
    Array::Vx,
    Array::Vy,
    Array::Omega,
    Array::Radius,
    Array::InverseMass,
    Array::Fx,
    Array::Fy,
    Array::Torque,
];

#[test]
fn programs_have_the_bits_of_single_contacts() {
    let frame = LatticeFrame { origin: [0.0; 2], edge: EDGE };
    let grid = CellGrid { frame, counts: COUNTS, periodic: [true, false] };
    let segments = [[[0.0, 2.0], [8.4, 2.0]], [[1.0, 6.5], [4.0, 3.0]], [[4.0, 3.0], [7.0, 5.5]]];
    let all = pieces(&segments, [Some(8.4), None], 1e-9, |_, _| true);
    let found = elements(&grid, &all, 0.5, 0.0);
    // Elements with the same place among those of their cell make a run.
    let mut runs: Vec<Vec<usize>> = vec![];
    for (number, element) in found.iter().enumerate() {
        let place = found[..number].iter().filter(|other| other.cell == element.cell).count();
        runs.resize_with(runs.len().max(place + 1), Vec::new);
        runs[place].push(number);
    }
    let mut random = Stream::new(3, RandomPurpose::Test, 0);
    let mut draw = |low: f64, high: f64| random.random_range(low..high) as f32;
    let discs = COUNTS[0] * COUNTS[1];
    let start: Columns = std::array::from_fn(|column| {
        let range = match column {
            0 => [-0.35, 0.35],
            1 => [-0.4, 0.4],
            5 => [0.4, 0.5],
            6 => [0.5, 2.0],
            _ => [-2.0, 2.0],
        };
        (0..discs).map(|_| draw(range[0], range[1])).collect()
    });
    let surface = |wall: u32| WallSurface {
        velocity: [0.3 * f64::from(wall), -0.2],
        normal_damping: 2.0,
        shear_damping: 3.0 + f64::from(wall),
        friction: 0.2 * f64::from(wall),
    };
    let numbers: Vec<[f32; ELEMENT_NUMBERS]> = found
        .iter()
        .map(|it| it.shape.numbers(&surface(it.wall), [0.0; 2]).map(|number| number as f32))
        .collect();
    let cell = |number: usize| found[number].cell[1] * COUNTS[0] + found[number].cell[0];
    for equal in [None, Some(EqualDiscs { radius: 0.45, inverse_mass: 1.5 })] {
        let law = Granular::<true, false> {
            contact: CONTACT,
            disc: EqualDiscs { radius: f64::NAN, inverse_mass: f64::NAN },
        };
        let mut expected = start.clone();
        let mut touching = 0;
        for number in runs.iter().flatten().copied() {
            let at = cell(number);
            let [radius, inverse_mass] = match equal {
                Some(EqualDiscs { radius, inverse_mass }) => [radius as f32, inverse_mass as f32],
                None => [start[5][at], start[6][at]],
            };
            let disc = TouchingDisc {
                position: [start[0][at], start[1][at]],
                velocity: [start[2][at], start[3][at]],
                omega: start[4][at],
                radius,
                inverse_mass,
            };
            if let Some(contact) = touch(&law, &disc, &numbers[number]) {
                touching += 1;
                (0..3).for_each(|sum| expected[7 + sum][at] += contact.sums[sum]);
            }
        }
        assert!(touching > 20 && runs.len() > 1, "{touching} {}", runs.len());
        for set in InstructionSet::ALL.iter().copied().filter(|set| set.is_available()) {
            for execution in [Execution::Chained, Execution::Eager, Execution::Strip(16)] {
                let mut columns = start.clone();
                let order: Vec<usize> = runs.concat();
                let cells: Vec<u32> = order.iter().map(|&number| cell(number) as u32 + 1).collect();
                let element: Vec<Vec<f32>> = (0..ELEMENT_NUMBERS)
                    .map(|column| order.iter().map(|&number| numbers[number][column]).collect())
                    .collect();
                {
                    let mut memory = Memory::new();
                    memory.bind_read(Slot::new(Array::WallCell), &cells);
                    for (array, column) in WALL_ARRAYS.into_iter().zip(&element) {
                        memory.bind_read(Slot::new(array), column);
                    }
                    for (array, column) in ARRAYS.into_iter().zip(&mut columns) {
                        memory.bind_write(Slot::new(array), column);
                    }
                    let program = Program::new(WallForces::<f32, _>::new(law, equal));
                    let mut first = 0;
                    for run in &runs {
                        program.run(&memory, first..first + run.len(), execution, set).unwrap();
                        first += run.len();
                    }
                }
                // Elements that do not touch add zero: −0 becomes 0.
                let bits = |columns: &Columns| -> Vec<u32> {
                    columns.iter().flatten().map(|value| (value + 0.0).to_bits()).collect()
                };
                assert_eq!(bits(&columns), bits(&expected), "{set:?} {execution:?}");
            }
        }
    }
}
