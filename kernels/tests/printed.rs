//! BP93's own program has the same bits in every execution, the bits of a scalar program with branches, and our own forces up to
//! rounding. Every operation is named by an equation. Readings of an empty cell.

mod support;

use stripmine_kernels::integrator::gear::Acceleration;
use stripmine_kernels::isa::{Array, Memory};
use stripmine_kernels::law::granular::Contact;
use stripmine_kernels::law::{Axis, Law, ParticleSum};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::printed::additions::{IntoBox, PrintedImages};
use stripmine_kernels::printed::{
    ARRAYS, EQUATIONS, Printed, PrintedClear, PrintedCorrector, PrintedEnter, PrintedMap, PrintedPredictor,
    mass_of_fixed_disc,
};
use stripmine_kernels::sweep::lattice::cells::CheckIndex;
use stripmine_kernels::sweep::lattice::forces::Forces;
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame};
use stripmine_kernels::{Execution, InstructionSet, Program, Runnable};
use support::{CONTACT, Case, DT, LATTICE, System, all_configurations, varying};

type Discs = System<f64, f64>;
type Way = (Execution, InstructionSet);

const ORACLE: Way = (Execution::Chained, InstructionSet::Scalar);
/// BP93 has no clamp.
const LAW: Contact = Contact { cohesionless: false, normal_damping: 60.0, ..CONTACT };
const GRAVITY: [f64; 2] = [0.0, -9.81];

fn case(periodic: [bool; 2], seed: u64) -> Case {
    Case { periodic, seed, contact: LAW, coordinates: Coordinates::Absolute, ..Case::new(13, 9) }
}

fn sides() -> [[bool; 2]; 4] {
    [[true, true], [false, false], [true, false], [false, true]]
}

/// Scale factor dt^k/k! of our scheme's derivatives.
fn scale(k: usize) -> f64 {
    (1..=k).map(|k| DT / k as f64).product()
}

/// Converts the state to unscaled derivatives.
fn unscaled(mut system: Discs) -> Discs {
    for row in &mut system.state {
        for (k, q) in row.iter_mut().enumerate() {
            q.iter_mut().for_each(|q| *q /= scale(k));
        }
    }
    system
}

fn run(system: &mut Discs, configuration: Way, programs: &[(&dyn Runnable, Length)]) {
    let (halo, constant) = system.constants();
    let lengths = [0..system.discs, 0..system.shape.padded(), system.shape.swept(), 0..halo[0].len()];
    system.memory(&halo, &constant, |memory: &Memory<'_>| {
        for (program, length) in programs {
            program.run(memory, lengths[*length as usize].clone(), configuration.0, configuration.1).unwrap();
        }
    });
}

#[derive(Clone, Copy)]
enum Length {
    Discs,
    Padded,
    Swept,
    Halo,
}

fn map(system: &mut Discs, configuration: Way) {
    let (shape, frame) = (system.shape, system.frame);
    run(
        system,
        configuration,
        &[
            (&Program::new(IntoBox::<f64>::new(shape, frame)), Length::Discs),
            (&Program::new(PrintedClear::<f64>::default()), Length::Padded),
            (&Program::new(PrintedEnter::<f64, f64>::new(shape, frame)), Length::Discs),
            (&Program::new(CheckIndex), Length::Discs),
            (&Program::new(PrintedImages::<f64>::default()), Length::Halo),
            (&Program::new(PrintedMap::<f64, f64>::new(shape)), Length::Padded),
        ],
    );
    assert_eq!((system.strays, system.conflicts), (0, 0));
}

fn sum(system: &mut Discs, case: &Case, configuration: Way) {
    let mask = Mask::square(case.half_width);
    let law = Printed { contact: case.contact };
    let forces = Forces::<f64, _>::new(law, &mask, system.shape, system.frame, Coordinates::Absolute);
    run(system, configuration, &[(&Program::new(forces), Length::Swept)]);
}

fn step<const VALUES: usize>(system: &mut Discs, case: &Case, configuration: Way) {
    run(
        system,
        configuration,
        &[(&Program::new(PrintedPredictor::<f64, VALUES, 3>::new(DT)), Length::Discs)],
    );
    map(system, configuration);
    sum(system, case, configuration);
    let corrector = PrintedCorrector::<f64, f64, VALUES, 3>::new(DT, Acceleration::OfVelocities, GRAVITY);
    run(system, configuration, &[(&Program::new(corrector), Length::Discs)]);
}

#[test]
fn printed_steps_are_bit_equal_in_every_execution() {
    for periodic in sides() {
        for fill in [0.0, 0.4, 1.0] {
            let case = Case { fill, ..case(periodic, 1) };
            let after = |configuration| {
                let mut system = unscaled(Discs::random(&case));
                step::<4>(&mut system, &case, configuration);
                step::<6>(&mut system, &case, configuration);
                system.bits()
            };
            let oracle = after(ORACLE);
            for configuration in all_configurations() {
                assert!(
                    after(configuration) == oracle,
                    "{configuration:?} differs from the oracle for {case:?}"
                );
            }
        }
    }
}

/// Forces of a scalar program, disc by disc: it visits 24 cells, skips empty cells and discs that do not touch, and sums in the
/// order of the mask.
fn scalar(system: &Discs, case: &Case) -> (Vec<[f64; 3]>, usize) {
    let Contact { stiffness, normal_damping, shear_damping, friction, .. } = case.contact;
    let cells = [system.shape.columns() as isize, system.shape.rows() as isize];
    let LatticeFrame { origin, edge } = system.frame;
    let cell =
        |disc: usize| [0, 1].map(|axis| ((system.state[axis][0][disc] - origin[axis]) / edge[axis]) as isize);
    let mut there = std::collections::HashMap::new();
    for disc in 0..system.discs {
        there.insert(cell(disc), disc);
    }
    let mut contacts = 0;
    let forces = (0..system.discs).map(|i| {
        let (mut fx, mut fy, mut torque) = (0.0, 0.0, 0.0);
        for offset in Mask::square(case.half_width).offsets() {
            let own = cell(i);
            let seen = [own[0] + offset.columns as isize, own[1] + offset.rows as isize];
            let mut home = seen;
            let mut image = [0.0, 0.0];
            for axis in 0..2 {
                if case.periodic[axis] {
                    home[axis] = seen[axis].rem_euclid(cells[axis]);
                    let periods = seen[axis].div_euclid(cells[axis]);
                    image[axis] = periods as f64 * (cells[axis] as f64 * edge[axis]);
                }
            }
            let Some(&j) = there.get(&home) else { continue };
            let of = |row: usize, k: usize, disc: usize| system.state[row][k][disc];
            let dx = of(0, 0, i) - (of(0, 0, j) + image[0]);
            let dy = of(1, 0, i) - (of(1, 0, j) + image[1]);
            let dist = (dx * dx + dy * dy).sqrt();
            let overlap = (system.radius[i] + system.radius[j]) - dist;
            if overlap <= 0.0 {
                continue;
            }
            contacts += 1;
            let m_eff = system.mass[i] * system.mass[j] / (system.mass[i] + system.mass[j]);
            let (vx, vy) = (of(0, 1, i) - of(0, 1, j), of(1, 1, i) - of(1, 1, j));
            let inverse = 1.0 / dist;
            let separation = (vx * dx + vy * dy) * inverse;
            let normal = stiffness * (overlap * overlap.sqrt()) - normal_damping * m_eff * separation;
            let v_rel = (vy * dx - vx * dy) * inverse
                - system.radius[i] * of(2, 1, i)
                - system.radius[j] * of(2, 1, j);
            let limit = friction * normal.abs();
            let shear = (-shear_damping * m_eff * v_rel).min(limit).max(-limit);
            fx += inverse * (dx * normal - dy * shear);
            fy += inverse * (dy * normal + dx * shear);
            torque -= system.radius[i] * shear;
        }
        [fx, fy, torque]
    });
    let forces = forces.collect();
    (forces, contacts)
}

/// Products by 0 and 1 are exact: the program of whole vectors gives the bits of one with branches.
#[test]
fn products_equal_branches_to_the_bit() {
    let mut met = 0;
    for (seed, periodic) in (0..40).flat_map(|seed| sides().map(|periodic| (seed, periodic))) {
        let case = Case { fill: [0.1, 0.4, 0.9][seed as usize % 3], ..case(periodic, seed) };
        let mut system = unscaled(Discs::random(&case));
        map(&mut system, ORACLE);
        sum(&mut system, &case, (Execution::Eager, InstructionSet::best()));
        let (expected, contacts) = scalar(&system, &case);
        met += contacts;
        for found in ParticleSum::PLANAR {
            let on_discs = system.on_discs(found);
            for (disc, force) in expected.iter().enumerate() {
                let expected = force[found.column::<2>()];
                // 0 and −0 are the same force.
                assert!(
                    on_discs[disc] == expected,
                    "{found:?} of disc {disc}: {}, expected {expected} in {case:?}",
                    on_discs[disc]
                );
            }
        }
    }
    assert!(met > 5000, "{met} contacts");
}

/// Our kernel sums the same forces with another order of operations.
#[test]
fn printed_forces_match_ours_up_to_rounding() {
    let configuration = (Execution::Chained, InstructionSet::best());
    for (seed, periodic) in (0..20).flat_map(|seed| sides().map(|periodic| (seed, periodic))) {
        let case = case(periodic, seed);
        let start = Discs::random(&case);
        let mut ours = start.clone();
        ours.index(&case, &varying::<true>(LAW), configuration);
        ours.forces(&case, &varying::<true>(LAW), configuration).unwrap();
        let mut printed = unscaled(start);
        map(&mut printed, configuration);
        sum(&mut printed, &case, configuration);
        for force in [ParticleSum::Force(Axis::X), ParticleSum::Force(Axis::Y), ParticleSum::Torque] {
            let (ours, printed) = (ours.on_discs(force), printed.on_discs(force));
            let rms = (ours.iter().map(|f| f * f).sum::<f64>() / ours.len() as f64).sqrt();
            for (disc, (ours, printed)) in ours.iter().zip(&printed).enumerate() {
                let off = (ours - printed).abs() / rms;
                assert!(off < 1e-13, "{force:?} of disc {disc} differs by {off} of the rms in {case:?}");
            }
        }
    }
}

/// Whole steps equal ours: the scheme of scaled derivatives is the same scheme.
#[test]
fn printed_steps_match_ours_up_to_rounding() {
    use stripmine_kernels::integrator::Inertia;
    fn beside<const VALUES: usize>(case: &Case) {
        let configuration = (Execution::Chained, InstructionSet::best());
        let mut ours = Discs::random(case);
        for row in &mut ours.state {
            row[VALUES..].iter_mut().flatten().for_each(|q| *q = 0.0);
        }
        let mut printed = unscaled(ours.clone());
        let at_start = ours.state.clone();
        for _ in 0..10 {
            let law = varying::<true>(LAW);
            ours.step::<_, VALUES, 3>(case, &law, Inertia::Varying, configuration);
            step::<VALUES>(&mut printed, case, configuration);
        }
        let mut moved = 0.0f64;
        for (row, (ours, printed)) in ours.state.iter().zip(&printed.state).enumerate() {
            for k in 0..2 {
                for (disc, (ours, printed)) in ours[k].iter().zip(&printed[k]).enumerate() {
                    let ours = ours / scale(k);
                    let off = (ours - printed).abs();
                    assert!(
                        off < 1e-10 * (1.0 + ours.abs()),
                        "{row} {k} of disc {disc}: {ours} and {printed}"
                    );
                    moved = moved.max((ours - at_start[row][k][disc] / scale(k)).abs());
                }
            }
        }
        assert!(moved > 0.1, "nothing moved: {moved}");
    }
    let case = case([true, true], 3);
    beside::<4>(&case);
    beside::<5>(&case);
    beside::<6>(&case);
}

/// Every section is an equation and every array is in the paper. Nothing else is executed: one comparison and one merge, of 1 and
/// 0, both of (7); min and max of (15).
#[test]
fn equations_name_every_operation_and_array() {
    let case = case([true, true], 1);
    let system = Discs::random(&case);
    let (shape, frame, mask) = (system.shape, system.frame, Mask::square(2));
    let forces = Forces::<f64, _>::new(Printed { contact: LAW }, &mask, shape, frame, Coordinates::Absolute);
    let corrector = PrintedCorrector::<f64, f64, 6, 3>::new(DT, Acceleration::OfVelocities, GRAVITY);
    let programs: [&dyn Runnable; 6] = [
        &Program::new(PrintedPredictor::<f64, 6, 3>::new(DT)),
        &Program::new(PrintedClear::<f64>::default()),
        &Program::new(PrintedEnter::<f64, f64>::new(shape, frame)),
        &Program::new(PrintedMap::<f64, f64>::new(shape)),
        &Program::new(forces),
        &Program::new(corrector),
    ];
    let (mut sections, mut arrays) = (vec![], vec![]);
    for line in programs.iter().flat_map(|program| program.lines()) {
        assert!(
            EQUATIONS.iter().any(|(name, _)| *name == line.section),
            "no equation is named {:?}",
            line.section
        );
        sections.push(line.section);
        for word in line.sources.iter().chain([&line.destination]).filter(|word| word.starts_with('[')) {
            let label = word[1..].split([']', '+']).next().unwrap();
            let label = label
                .rsplit_once('-')
                .filter(|(_, shift)| shift.parse::<u32>().is_ok())
                .map_or(label, |(label, _)| label);
            let known = ARRAYS.iter().find(|(array, _)| array.label() == label);
            assert!(known.is_some(), "the paper has no {label}: {line:?}");
            arrays.push(label.to_owned());
        }
        match line.operation {
            "sel" => assert_eq!(
                (line.section, &line.sources[1..]),
                ("(7)", &["#1".to_owned(), "#0".to_owned()][..])
            ),
            "lt" => assert_eq!(line.section, "(7)"),
            "min" | "max" | "abs" => assert_eq!(line.section, "(15)"),
            "le" | "eq" | "and" | "not" | "cnt" => panic!("not in the paper: {line:?}"),
            _ => {}
        }
    }
    for (name, _) in EQUATIONS {
        assert!(sections.contains(name), "nothing is executed for {name}");
    }
    for (array, _) in ARRAYS {
        assert!(arrays.iter().any(|label| label == array.label()), "no kernel uses {}", array.label());
    }
}

/// Readings of an empty cell, as listed in the module's documentation.
#[test]
fn coinciding_empty_cells_give_nan_sums() {
    let case = Case { fill: 0.3, ..case([true, true], 5) };
    let mut right = unscaled(Discs::random(&case));
    map(&mut right, ORACLE);
    let [x, y, test] = [Array::X, Array::Y, Array::Test]
        .map(|array| LATTICE.iter().position(|&other| other == array).unwrap());
    // Sums from the current lattice vectors, with a given position for each empty cell.
    let sums = |place: &dyn Fn(usize) -> Option<[f64; 2]>| {
        let mut system = right.clone();
        for cell in 0..system.shape.padded() {
            if system.lattice[test][cell] == 0.0
                && let Some(place) = place(cell)
            {
                (system.lattice[x][cell], system.lattice[y][cell]) = (place[0], place[1]);
            }
        }
        sum(&mut system, &case, ORACLE);
        let swept = system.shape.swept();
        let finite = system.sums[0][swept].iter().all(|force| force.is_finite());
        (ParticleSum::PLANAR.map(|sum| system.on_discs(sum)), finite)
    };
    let numbers = |forces: &[Vec<f64>; 3]| forces.iter().flatten().all(|force| force.is_finite());

    // A position of its own: everything is finite.
    let (own, finite) = sums(&|_| None);
    assert!(finite && numbers(&own));
    // One common position: the sums of empty cells are NaN, those of discs are right.
    let (one, finite) = sums(&|_| Some([0.1234, 0.5678]));
    assert!(!finite && one == own);
    // The position of a disc: its neighbours in empty cells are at its own centre.
    let disc = right.discs / 2;
    let there = [right.state[0][0][disc], right.state[1][0][disc]];
    let (hit, _) = sums(&|_| Some(there));
    assert!(hit[0][disc].is_nan() && !numbers(&hit));
    // The position of the last disc, which has just left and is close by. Products by Test cancel it.
    let left = right.cell[disc] as usize - 1;
    let (stale, _) = sums(&|cell| (cell == left + 1).then_some([there[0] + 1e-3, there[1]]));
    assert!(right.lattice[test][left + 1] == 0.0 && stale == own);
}

/// With a fixed disc the effective mass is the other's.
#[test]
fn fixed_discs_leave_the_grains_mass_unchanged() {
    for largest in [1e-6, 0.37, 1.0, 1.5, 4e12] {
        let fixed = mass_of_fixed_disc(largest);
        for share in [1.0, 0.9, 0.123_456_789, 1e-3] {
            let mass: f64 = largest * share;
            assert_eq!(mass * fixed / (mass + fixed), mass);
        }
    }
}

/// A position that would be rounded up into a cell beyond the lattice is moved down by a period.
#[test]
fn every_position_in_the_box_has_a_cell() {
    for seed in 0..200u64 {
        let case = Case { fill: 0.0, ..case([true, true], seed) };
        let mut system = Discs::random(&case);
        system.frame.edge = [1.0 + seed as f64 / 37.0, 0.1 + seed as f64 / 91.0];
        system.frame.origin = [seed as f64 / 7.0 - 9.0, -(seed as f64) / 3.0];
        let high: [f64; 2] = [0, 1].map(|axis| {
            let cells = [system.shape.columns(), system.shape.rows()][axis];
            system.frame.origin[axis] + cells as f64 * system.frame.edge[axis]
        });
        let mut discs = vec![];
        let mut at = high;
        for _ in 0..8 {
            at = at.map(f64::next_down);
            discs.push(at);
        }
        discs.push(system.frame.origin.map(|r| r - 1e-18));
        for row in 0..2 {
            system.state[row][0] = discs.iter().map(|at| at[row]).collect();
        }
        system.discs = discs.len();
        system.cell = vec![0; discs.len()];
        let (shape, frame) = (system.shape, system.frame);
        run(
            &mut system,
            ORACLE,
            &[
                (&Program::new(IntoBox::<f64>::new(shape, frame)), Length::Discs),
                (&Program::new(PrintedEnter::<f64, f64>::new(shape, frame)), Length::Discs),
            ],
        );
        assert_eq!(system.strays, 0);
        for &cell in &system.cell {
            let [column, row] = shape.column_and_row(cell as usize - 1);
            assert!((0..13).contains(&column) && (0..9).contains(&row), "column {column}, row {row}");
        }
    }
}

/// Observations beyond the paper equal those of our own law.
#[test]
fn printed_observations_match_ours() {
    use stripmine_kernels::law::ObservationRequest;
    let case = case([true, true], 11);
    let configuration = (Execution::Chained, InstructionSet::best());
    let asked = ObservationRequest { watched: None, dissipation: true, energy: true };
    let mut ours = Discs::random(&case);
    ours.index(&case, &varying::<true>(LAW), configuration);
    ours.forces_and(&case, &varying::<true>(LAW), configuration, asked).unwrap();
    let mut printed = unscaled(Discs::random(&case));
    map(&mut printed, configuration);
    let law = Printed { contact: LAW };
    printed.forces_and(&case, &law, configuration, asked).unwrap();
    let total = |column: &[f64]| -> f64 { printed.cell.iter().map(|&cell| column[cell as usize - 1]).sum() };
    for (kind, (ours, printed)) in ours.observed.iter().zip(&printed.observed).enumerate() {
        let (ours, printed) = (total(ours), total(printed));
        assert!(ours.abs() > 0.1 && (ours / printed - 1.0).abs() < 1e-12, "{kind}: {ours} and {printed}");
    }
}

/// The law reads only the quantities it states.
#[test]
fn the_printed_law_passes_its_check() {
    stripmine_kernels::law::check(&Printed { contact: LAW }).unwrap();
    assert!(<Printed as Law<2>>::FIELDS.len() == 6);
}
