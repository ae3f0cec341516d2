//! Force program of a pair law for the vector machine, over the offsets of a mask on the lattice.

use super::checked::CheckedLangevin;
use super::chosen_search::widest_cell;
use super::dynamics::BathDynamics;
use super::laws::bind_table;
use crate::method::pairwise::{Dynamics, LawTask};
use crate::method::{BoundPrograms, ProgramCall, VectorProgram};
use stripmine_kernels::isa::{Array, Memory, Slot};
use stripmine_kernels::law::Law;
use stripmine_kernels::ledger::VectorLength;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::forces::Forces;
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame, LatticeShape};
use stripmine_kernels::{Program, Runnable};

/// Largest half-width of a mask, in cells.
const WIDEST: u32 = 12;

/// Returns the lattice whose cells hardly any two particles share, with the smallest mask that covers the cut-off; none if the box is
/// too small.
pub(super) fn lattice(checked: &CheckedLangevin) -> Option<(LatticeShape, LatticeFrame, Mask)> {
    let (domain, reach) = (checked.domain, checked.reach);
    let largest = widest_cell(&checked.scene, checked.diameter);
    let half_width = (1..=WIDEST).find(|&width| reach / f64::from(width) <= largest)?;
    let least = reach / f64::from(half_width);
    let counts = [0, 1].map(|axis| (domain.length(axis) / least).floor());
    if counts.iter().any(|&count| count < 1.0 || count > f64::from(u32::MAX)) {
        return None;
    }
    let edge = [0, 1].map(|axis| domain.length(axis) / counts[axis]);
    let mask = Mask::square(half_width);
    let [columns, rows] = counts.map(|count| count as usize);
    let shape = LatticeShape::new(columns, rows, &mask, domain.periodic()).ok()?;
    Some((shape, LatticeFrame { origin: domain.corner(), edge }, mask))
}

/// Programs of the forces of a step; none without pairs or without a lattice.
pub(super) fn programs(checked: &CheckedLangevin) -> Vec<VectorProgram> {
    let Some((shape, frame, mask)) = checked.has_pairs().then(|| lattice(checked)).flatten() else {
        return vec![];
    };
    let length = VectorLength::SweptCells;
    let program = BathDynamics::of(checked).with_law(LatticeForceProgram(&mask, shape, frame));
    vec![VectorProgram { part: "forces", length: length.symbol(), n: shape.swept().len(), times: 1, program }]
}

/// Calls `task` with the program of the forces and the lattice vectors at the start; returns false without a program. Of two particles in a cell the
/// later one counts.
pub(super) fn with_bound_programs(checked: &CheckedLangevin, task: &mut BoundPrograms<'_>) -> bool {
    let Some((shape, frame, mask)) = checked.has_pairs().then(|| lattice(checked)).flatten() else {
        return false;
    };
    let (mut x, mut y) = (vec![1e30; shape.padded()], vec![1e30; shape.padded()]);
    for particle in checked.particles.all() {
        let place: [f64; 2] =
            std::array::from_fn(|axis| (particle.position[axis] - frame.origin[axis]) / frame.edge[axis]);
        let cell = shape.position(place[0].floor() as isize, place[1].floor() as isize);
        let [from_x, from_y] =
            [0, 1].map(|axis| (place[axis] - place[axis].floor() - 0.5) * frame.edge[axis]);
        (x[cell], y[cell]) = (from_x, from_y);
    }
    for image in shape.images() {
        (x[image.cell], y[image.cell]) = (x[image.source], y[image.source]);
    }
    let (mut fx, mut fy) = (vec![0.0; shape.padded()], vec![0.0; shape.padded()]);
    let program = BathDynamics::of(checked).with_law(LatticeForceProgram(&mask, shape, frame));
    let columns = checked.scene.law_at(checked.diameter).table_columns();
    let memory = Memory::new()
        .read(Slot::new(Array::X), &x)
        .read(Slot::new(Array::Y), &y)
        .write(Slot::new(Array::Fx), &mut fx)
        .write(Slot::new(Array::Fy), &mut fy);
    let memory = bind_table(memory, &columns);
    task(&[ProgramCall { part: "forces", program: program.as_ref(), range: shape.swept() }], &memory);
    true
}

/// Builds the program of the forces of a law on a lattice.
struct LatticeForceProgram<'m>(&'m Mask, LatticeShape, LatticeFrame);

impl LawTask for LatticeForceProgram<'_> {
    type Output = Box<dyn Runnable>;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Box<dyn Runnable> {
        let LatticeForceProgram(mask, shape, frame) = self;
        Box::new(Program::new(Forces::<f64, _>::new(law, mask, shape, frame, Coordinates::CellRelative)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::checked::check_langevin_scene;
    use super::super::keys::VOCABULARY;
    use super::super::laws::PairLaw;
    use super::*;
    use crate::particles::{Particle, Particles};
    use crate::scene::SceneValues;
    use crate::words::Words;
    use stripmine_kernels::law::lennard_jones::LennardJones;
    use stripmine_kernels::law::potential::PairPotential;
    use stripmine_kernels::noise::{RandomPurpose, normals};
    use stripmine_kernels::{Execution, InstructionSet};

    /// Forces from the potential, summed over all pairs.
    fn forces_by_pairs(checked: &CheckedLangevin, particles: &Particles) -> Vec<[f64; 2]> {
        let law = checked.scene.law_at(checked.diameter);
        let force = |a: &Particle| {
            let mut sum = [0.0; 2];
            for b in particles.all().iter().filter(|b| b.id != a.id) {
                let displacement = checked.domain.displacement(b.planar_position(), a.planar_position());
                let square = displacement[0] * displacement[0] + displacement[1] * displacement[1];
                if square < checked.reach * checked.reach {
                    let strength = law.potential().force(square.sqrt()) / square.sqrt();
                    (0..2).for_each(|axis| sum[axis] += strength * displacement[axis]);
                }
            }
            sum
        };
        particles.all().iter().map(force).collect()
    }

    /// Forces of the program over the whole lattice match the sum over all pairs to rounding, in eager, strip-mined and chained execution.
    #[test]
    fn program_forces_match_all_pairs() {
        let file = std::env::temp_dir().join(format!("stripmine-pair-table-{}.csv", std::process::id()));
        let rows = (80..=112).map(|row| f64::from(row) / 100.0);
        let repulsion = LennardJones::new(1.0, 1.0);
        let rows: String = rows.map(|r| format!("{r},{}\n", repulsion.energy(r))).collect();
        std::fs::write(&file, rows).unwrap();
        for (kind, law) in PairLaw::ALL.iter().filter(|(law, _)| law.has_pairs()) {
            let table = (*kind == PairLaw::Table).then(|| format!("law.file={}", file.display()));
            let overrides: Vec<String> = table
                .into_iter()
                .chain([
                    format!("law.kind={law}"),
                    "particles.count=200".to_owned(),
                    "domain.sides=[18.0, 18.0]".to_owned(),
                ])
                .collect();
            let values = SceneValues::load("langevin-dense", &overrides, &[&VOCABULARY]).unwrap();
            let checked = check_langevin_scene(values).unwrap();
            let (shape, frame, mask) = lattice(&checked).unwrap();
            let mut particles = checked.particles.clone();
            for particle in particles.all_mut() {
                let off = normals(1, RandomPurpose::Test, particle.id, 0);
                (0..2).for_each(|axis| particle.position[axis] += 0.06 * off[axis]);
                particle.position = checked.domain.wrapped(particle.position);
            }
            let fits = |axis: usize, at: f64| ((at - frame.origin[axis]) / frame.edge[axis]).floor();
            let padded = shape.padded();
            // Input of the programs: positions relative to the cell centre, far away in empty cells.
            let (mut x, mut y) = (vec![1e30; padded], vec![1e30; padded]);
            let mut cell_of = vec![];
            for particle in particles.all() {
                let [column, row] = [0, 1].map(|axis| fits(axis, particle.position[axis]));
                let cell = shape.position(column as isize, row as isize);
                let centre =
                    [0, 1].map(|axis| frame.origin[axis] + ([column, row][axis] + 0.5) * frame.edge[axis]);
                assert_eq!(x[cell], 1e30, "two share a cell");
                (x[cell], y[cell]) = (particle.position[0] - centre[0], particle.position[1] - centre[1]);
                cell_of.push(cell);
            }
            for image in shape.images() {
                (x[image.cell], y[image.cell]) = (x[image.source], y[image.source]);
            }
            let program = BathDynamics::of(&checked).with_law(LatticeForceProgram(&mask, shape, frame));
            let columns = checked.scene.law_at(checked.diameter).table_columns();
            let expected = forces_by_pairs(&checked, &particles);
            let largest = expected.iter().flatten().fold(0.0, |most: f64, it| most.max(it.abs()));
            assert!(largest > 0.1);
            for execution in [Execution::Eager, Execution::Strip(64), Execution::Chained] {
                let (mut fx, mut fy) = (vec![0.0; padded], vec![0.0; padded]);
                let memory = Memory::new()
                    .read(Slot::new(Array::X), &x)
                    .read(Slot::new(Array::Y), &y)
                    .write(Slot::new(Array::Fx), &mut fx)
                    .write(Slot::new(Array::Fy), &mut fy);
                let memory = bind_table(memory, &columns);
                program.run(&memory, shape.swept(), execution, InstructionSet::best()).unwrap();
                for (&cell, force) in cell_of.iter().zip(&expected) {
                    for (found, expected) in [fx[cell], fy[cell]].into_iter().zip(force) {
                        assert!((found - expected).abs() < 1e-11 * largest, "{law}: {found} {expected}");
                    }
                }
            }
        }
    }
}
