//! The Index of the lattice compared with plain arithmetic: cells, strays, conflicts, and positions on the lattice.

mod support;

use rand::RngExt;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame};
use stripmine_kernels::sweep::pair::PairBody;
use stripmine_kernels::{Execution, InstructionSet};
use support::{Case, System, equal};

/// Executions that matter here; `identity.rs` compares the others.
fn configurations() -> [(Execution, InstructionSet); 2] {
    [InstructionSet::Scalar, InstructionSet::best()].map(|set| (Execution::Chained, set))
}

/// Expected result of the Index kernels.
#[derive(Debug, Default, PartialEq)]
struct Cells {
    /// Number of each disc's cell, from 1.
    cell: Vec<u32>,
    strays: u64,
    conflicts: u64,
}

/// The Index by plain arithmetic: wrapped once, divided, rounded down.
fn naive_cells(places: &[[f64; 2]], frame: LatticeFrame, case: &Case) -> Cells {
    let cells = [case.columns, case.rows];
    let halo = case.half_width as usize;
    let stride = case.columns + 2 * halo;
    let lead = (halo * (stride + 1)).div_ceil(16) * 16;
    let mut found = Cells::default();
    let mut owner = std::collections::HashMap::new();
    for (disc, place) in places.iter().enumerate() {
        let mut at = [0usize; 2];
        let mut stray = false;
        for axis in 0..2 {
            let length = cells[axis] as f64 * frame.edge[axis];
            let mut from_low = place[axis] - frame.origin[axis];
            if case.periodic[axis] {
                if from_low < 0.0 {
                    from_low += length;
                } else if from_low >= length {
                    from_low -= length;
                }
            }
            if from_low.is_nan() || from_low < 0.0 || from_low > length {
                stray = true;
                continue;
            }
            at[axis] = ((from_low / frame.edge[axis]).floor() as usize).min(cells[axis] - 1);
        }
        found.strays += u64::from(stray);
        let number = if stray { 0 } else { (lead + at[1] * stride + halo + at[0] + 1) as u32 };
        found.cell.push(number);
        if !stray {
            owner.insert(number, disc);
        }
    }
    found.conflicts =
        found.cell.iter().enumerate().filter(|(disc, number)| owner.get(number) != Some(disc)).count() as u64;
    found
}

/// Indexes discs at `places` with every execution and returns the first of the equal results.
fn indexed<S: Precision>(case: &Case, frame: LatticeFrame, places: &[[f64; 2]]) -> System<S, f64> {
    let discs: Vec<_> = places.iter().map(|&[x, y]| PairBody::at(x, y)).collect();
    let law = equal::<false>(case.contact);
    let [first, second] = configurations().map(|how| {
        let mut system = System::<S, f64>::placed(case, frame, &discs);
        system.index(case, &law, how);
        system
    });
    assert_eq!(first.cell, second.cell);
    assert_eq!((first.strays, first.conflicts), (second.strays, second.conflicts));
    first
}

fn result<S>(system: &System<S, f64>) -> Cells {
    Cells { cell: system.cell.clone(), strays: system.strays, conflicts: system.conflicts }
}

/// Positions in space from the lattice's coordinates.
fn places_on_the_lattice<S>(system: &System<S, f64>, case: &Case) -> Vec<[f64; 2]> {
    (0..system.discs)
        .map(|disc| {
            let position = system.cell[disc] as usize - 1 - system.shape.position(0, 0);
            let at = [position % system.shape.stride(), position / system.shape.stride()];
            std::array::from_fn(|axis| {
                let found = system.on_lattice[axis][disc];
                match case.coordinates {
                    Coordinates::Absolute => found,
                    Coordinates::CellRelative => {
                        let middle = (at[axis] as f64 + 0.5) * system.frame.edge[axis];
                        system.frame.origin[axis] + middle + found
                    }
                }
            })
        })
        .collect()
}

/// Compares cells, strays, conflicts, Index and coordinates for random positions up to most of a period outside.
fn index_agrees<S: Precision>(case: &Case) {
    let mut random = Stream::new(case.seed, RandomPurpose::Test, 1);
    let frame = LatticeFrame { origin: [-3.0, 2.0], edge: [1.1, 1.3] };
    let cells = [case.columns, case.rows];
    let mut draw = |axis: usize| {
        let there = (2.8 * random.random::<f64>() - 0.9) * cells[axis] as f64 * frame.edge[axis];
        S::from_f64(frame.origin[axis] + there).to_f64()
    };
    let places: Vec<_> = (0..200).map(|_| [draw(0), draw(1)]).collect();
    let expected = naive_cells(&places, frame, case);
    assert!(expected.conflicts > 10, "the case has no conflicts");
    assert_eq!(expected.strays > 10, case.periodic != [true, true]);
    let system = indexed::<S>(case, frame, &places);
    assert_eq!(result(&system), expected, "{case:?}");

    // Of two discs in a cell the later stays; all other cells are empty; images repeat.
    let mut index = vec![0; system.shape.padded()];
    for (disc, &cell) in expected.cell.iter().enumerate().filter(|(_, cell)| **cell != 0) {
        index[cell as usize - 1] = disc as u32 + 1;
    }
    let halo = case.half_width as isize;
    for row in -halo..case.rows as isize + halo {
        for column in -halo..case.columns as isize + halo {
            let home = [column.rem_euclid(case.columns as isize), row.rem_euclid(case.rows as isize)];
            if (home[0] == column || case.periodic[0]) && (home[1] == row || case.periodic[1]) {
                index[system.shape.position(column, row)] = index[system.shape.position(home[0], home[1])];
            }
        }
    }
    assert_eq!(system.index, index, "{case:?}");
}

/// Cells, Index, strays and conflicts equal those of plain arithmetic, in both state precisions.
#[test]
fn the_index_matches_plain_arithmetic() {
    for periodic in [[true, true], [false, false], [true, false], [false, true]] {
        for (half_width, seed) in [(2, 1), (2, 2), (3, 3)] {
            let case = Case { periodic, half_width, seed, ..Case::new(13, 9) };
            index_agrees::<f64>(&case);
            index_agrees::<f32>(&case);
        }
    }
}

/// The lattice's copy of a position is the disc's position, absolute or relative to the centre of its cell, and never beyond the
/// cell.
#[test]
fn lattice_coordinates_match_disc_positions() {
    for coordinates in [Coordinates::Absolute, Coordinates::CellRelative] {
        let case = Case { coordinates, ..Case::new(13, 9) };
        let frame = LatticeFrame { origin: [-3.0, 2.0], edge: [1.1, 1.3] };
        let mut random = Stream::new(7, RandomPurpose::Test, 2);
        let places: Vec<[f64; 2]> = (0..100)
            .map(|_| [-3.0 + 14.3 * random.random::<f64>(), 2.0 + 11.7 * random.random::<f64>()])
            .collect();
        let system = indexed::<f64>(&case, frame, &places);
        assert_eq!(system.strays, 0);
        for (found, place) in places_on_the_lattice(&system, &case).iter().zip(&places) {
            assert!((0..2).all(|axis| (found[axis] - place[axis]).abs() < 1e-14), "{found:?} for {place:?}");
        }
        if coordinates == Coordinates::CellRelative {
            for (axis, edge) in frame.edge.iter().enumerate() {
                assert!(system.on_lattice[axis].iter().all(|x| x.abs() <= 0.5 * edge + 1e-14));
            }
        }
    }
}

/// Discs outside a closed side, at NaN or infinity, or more than a period away are in no cell. They count as strays and (their
/// Index entry is missing) as conflicts; no other disc is affected.
#[test]
fn strays_belong_to_no_cell_and_are_counted() {
    let frame = LatticeFrame { origin: [-3.0, 2.0], edge: [1.5, 1.25] };
    let [width, height] = [15.0, 10.0]; // 10 × 8 cells
    let home = [1.0, 5.0];
    let stray_anywhere = [
        [f64::NAN, 5.0],
        [1.0, f64::NAN],
        [f64::INFINITY, 5.0],
        [1.0, f64::NEG_INFINITY],
        [f64::NAN, f64::INFINITY],
        [-3.0 - 1.001 * width, 5.0],
        [-3.0 + 2.001 * width, 5.0],
        [1.0, 2.0 - 1.001 * height],
        [1.0, 2.0 + 2.001 * height],
        [1e300, 5.0],
        [1.0, -1e300],
        [f64::MAX, f64::MAX],
    ];
    let stray_where_closed =
        [[-3.001, 5.0], [-3.0 + 1.001 * width, 5.0], [1.0, 1.999], [1.0, 2.0 + 1.001 * height]];
    for periodic in [[true, true], [false, false]] {
        let case = Case { periodic, ..Case::new(10, 8) };
        for place in stray_anywhere.into_iter().chain(stray_where_closed) {
            let stray =
                stray_anywhere.iter().any(|p| p.map(f64::to_bits) == place.map(f64::to_bits)) || !periodic[0];
            let system = indexed::<f64>(&case, frame, &[home, place]);
            assert_eq!(system.strays, u64::from(stray), "{place:?} on {periodic:?}");
            assert_eq!(system.conflicts, u64::from(stray), "{place:?} on {periodic:?}");
            assert_eq!(system.cell[1] == 0, stray, "{place:?} on {periodic:?}");
            assert_eq!(system.cell[0] as usize - 1, system.shape.position(2, 2));
            assert_eq!(system.index[system.cell[0] as usize - 1], 1);
        }
    }
}

/// Each disc that lost its cell counts once: of k discs in one cell, k − 1; the last one stays.
#[test]
fn discs_that_share_a_cell_are_counted() {
    let case = Case::new(10, 8);
    let frame = LatticeFrame { origin: [0.0, 0.0], edge: [1.0, 1.0] };
    let places = [[3.5, 4.5], [7.5, 1.5], [3.1, 4.9], [0.5, 0.5], [3.9, 4.1], [7.9, 1.9]];
    let system = indexed::<f64>(&case, frame, &places);
    assert_eq!((system.strays, system.conflicts), (0, 3));
    assert_eq!(system.cell[0], system.cell[2]);
    assert_eq!(system.index[system.shape.position(3, 4)], 5);
    assert_eq!(system.index[system.shape.position(7, 1)], 6);
    assert_eq!(system.index[system.shape.position(0, 0)], 4);
    // Touching across a seam is no conflict; being in the same cell after wrapping is.
    let places = [[9.99, 4.5], [0.01, 4.5], [10.02, 4.4]];
    let system = indexed::<f64>(&case, frame, &places);
    assert_eq!((system.strays, system.conflicts), (0, 1));
    assert_eq!(system.index[system.shape.position(0, 4)], 3);
}

/// With exactly representable borders, a disc on a border belongs to the cell to its right or above. On the far side it belongs
/// to the last cell of a closed lattice and to the first of a periodic one.
#[test]
fn border_discs_belong_to_the_upper_cell() {
    let frame = LatticeFrame { origin: [-3.0, 2.0], edge: [1.5, 1.25] };
    for periodic in [[true, true], [false, false]] {
        for coordinates in [Coordinates::Absolute, Coordinates::CellRelative] {
            let case = Case { periodic, coordinates, ..Case::new(10, 8) };
            for column in 0..=10 {
                for row in 0..=8 {
                    let place = [-3.0 + 1.5 * column as f64, 2.0 + 1.25 * row as f64];
                    let system = indexed::<f64>(&case, frame, &[place]);
                    let cell =
                        |at: usize, cells: usize| if periodic[0] { at % cells } else { at.min(cells - 1) };
                    let (c, r) = (cell(column, 10) as isize, cell(row, 8) as isize);
                    assert_eq!(
                        system.cell[0] as usize - 1,
                        system.shape.position(c, r),
                        "{place:?} {periodic:?}"
                    );
                    assert_eq!(system.conflicts + system.strays, 0);
                    if coordinates == Coordinates::CellRelative {
                        let beyond =
                            |at: usize, cells: usize| if periodic[0] || at < cells { -0.5 } else { 0.5 };
                        assert_eq!(system.on_lattice[0][0], 1.5 * beyond(column, 10));
                        assert_eq!(system.on_lattice[1][0], 1.25 * beyond(row, 8));
                    }
                }
            }
        }
    }
}

/// On borders that no double represents, the disc is in one of the two cells, and its position is unchanged.
#[test]
fn rounded_borders_assign_a_neighbouring_cell() {
    let frame = LatticeFrame { origin: [-3.1, 2.7], edge: [1.1, 0.7] };
    let case = Case::new(23, 19);
    for column in 1..23 {
        for row in 1..19 {
            let place = [-3.1 + 1.1 * column as f64, 2.7 + 0.7 * row as f64];
            let system = indexed::<f64>(&case, frame, &[place]);
            let position = system.cell[0] as usize - 1 - system.shape.position(0, 0);
            let (c, r) = (position % system.shape.stride(), position / system.shape.stride());
            assert!(c == column || c + 1 == column, "{place:?} in column {c}");
            assert!(r == row || r + 1 == row, "{place:?} in row {r}");
            let found = places_on_the_lattice(&system, &case)[0];
            assert!((0..2).all(|axis| (found[axis] - place[axis]).abs() < 1e-13), "{found:?} for {place:?}");
        }
    }
}

/// A disc so slightly below a periodic side that adding a period rounds to exactly the far side stays inside.
#[test]
fn positions_rounded_to_the_period_stay_inside() {
    let frame = LatticeFrame { origin: [0.0, 0.0], edge: [1.5, 1.25] };
    let case = Case::new(10, 8);
    for little in [f64::MIN_POSITIVE, 1e-300, 1e-30, 1e-17] {
        assert_eq!(-little + 15.0, 15.0, "the case does not round to the period");
        let system = indexed::<f64>(&case, frame, &[[-little, -little]]);
        assert_eq!((system.strays, system.conflicts), (0, 0), "{little}");
        let stored = [system.state[0][0][0], system.state[1][0][0]];
        assert!((0.0..15.0).contains(&stored[0]) && (0.0..10.0).contains(&stored[1]), "{stored:?}");
        let corner = [(0, 0), (9, 0), (0, 7), (9, 7)];
        let at = system.cell[0] as usize - 1;
        assert!(corner.iter().any(|&(c, r)| at == system.shape.position(c, r)), "cell {at}");
    }
    // In single precision the stored coordinate may be the far side itself; the wrap of the next step corrects it.
    let frame = LatticeFrame { origin: [0.0, 0.0], edge: [1.1, 1.3] };
    let mut system = indexed::<f32>(&case, frame, &[[-1e-9, -1e-9]]);
    for _ in 0..3 {
        assert_eq!((system.strays, system.conflicts), (0, 0));
        system.index(&case, &equal::<false>(case.contact), configurations()[0]);
    }
}

/// Positions on a side and one number of the precision further in or out.
fn next_to(side: f64) -> [f64; 3] {
    [side.next_down(), side, side.next_up()]
}

/// Discs next to the periodic sides of random lattices that become strays.
fn strays_at_periodic_sides(origin: impl Fn(&mut Stream) -> f64) -> Vec<String> {
    let mut random = Stream::new(11, RandomPurpose::Test, 3);
    let mut found = vec![];
    for _ in 0..300 {
        let columns = 5 + (40.0 * random.random::<f64>()) as usize;
        let edge = 0.5 + random.random::<f64>();
        let low = origin(&mut random);
        let frame = LatticeFrame { origin: [low, 0.0], edge: [edge, 1.0] };
        let case = Case::new(columns, 6);
        for x in next_to(low).into_iter().chain(next_to(low + columns as f64 * edge)) {
            let system = indexed::<f64>(&case, frame, &[[x, 3.5]]);
            if system.strays != 0 {
                found.push(format!("x = {x:?} with origin {low:?}, {columns} columns of {edge:?}"));
            }
        }
    }
    found
}

/// A disc within a rounding error of a periodic side belongs to the first or the last column, for any origin.
#[test]
fn discs_near_periodic_sides_are_no_strays() {
    let found = strays_at_periodic_sides(|random| 20.0 * random.random::<f64>() - 10.0);
    assert!(found.is_empty(), "{} strays of 1800, the first: {}", found.len(), found[0]);
}

/// With the lattice at the origin of coordinates no disc becomes a stray either; there the far side is the period.
#[test]
fn lattices_at_the_origin_have_no_strays() {
    let found = strays_at_periodic_sides(|_| 0.0);
    assert!(found.is_empty(), "{} strays of 1800, the first: {}", found.len(), found[0]);
}

/// A disc inside a closed lattice is no stray, however near the far side it is.
#[test]
fn discs_inside_closed_sides_are_no_strays() {
    let case = Case { periodic: [false, false], ..Case::new(17, 6) };
    let frame = LatticeFrame { origin: [-3.0, 2.0], edge: [1.1, 1.25] };
    let x = (-3.0 + 17.0 * 1.1f64).next_down();
    assert_eq!(indexed::<f64>(&case, frame, &[[x, 4.0]]).strays, 0, "x = {x:?}");
}
