//! Forces between discs at one moment: pair by pair, and as the stress on a grid.

use super::cells::SampleCells;
use super::discs::SampledDiscs;
use super::setting::StructureSetting;
use crate::particles::{Particle, ParticleKind};
use rayon::iter::{
    IndexedParallelIterator, IntoParallelRefIterator, IntoParallelRefMutIterator, ParallelIterator,
};
use std::fmt::{self, Debug, Formatter};
use std::ops::Range;
use std::sync::Arc;
use stripmine_kernels::sweep::pair::{Pair, PairBody};

/// Largest number of cells of the stress grid.
const MOST_CELLS: f64 = 400.0;
/// Number of components of a stress: xx, xy, yy.
const COMPONENTS: usize = 3;

/// Force along x and y on the first of a pair.
pub(crate) type PairForce = dyn Fn(&Pair) -> [f64; 2] + Send + Sync;

/// Pair forces of a method at any moment.
#[derive(Clone)]
pub struct PairForces {
    /// Largest distance (length) at which a pair interacts.
    pub reach: f64,
    /// Force of a pair.
    pub of: Arc<PairForce>,
}

impl Debug for PairForces {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        out.debug_struct("PairForces").field("reach", &self.reach).finish_non_exhaustive()
    }
}

/// Discs, walls included, with their pair forces.
struct InteractingDiscs<'a> {
    particles: &'a [Particle],
    forces: &'a PairForces,
    cells: &'a SampleCells,
    halves: Vec<f64>,
}

impl<'a> InteractingDiscs<'a> {
    /// Sorts the discs into `cells`.
    fn new(
        setting: &StructureSetting,
        particles: &'a [Particle],
        forces: &'a PairForces,
        cells: &'a mut SampleCells,
    ) -> Self {
        let of = |place: fn(&Particle) -> f64| particles.iter().map(place).collect();
        let discs = SampledDiscs {
            x: of(|it| it.position[0]),
            y: of(|it| it.position[1]),
            ..SampledDiscs::default()
        };
        cells.sort(setting, &discs, forces.reach);
        let halves = cells.halves(forces.reach).collect();
        InteractingDiscs { particles, forces, cells, halves }
    }

    /// Visits each pair with a mobile disc of some rows and those above: the numbers, the vector from the second to the first (length), and the
    /// force on the first.
    fn each(&self, rows: Range<usize>, mut each: impl FnMut([usize; 2], [f64; 2], [f64; 2])) {
        let InteractingDiscs { particles, forces, cells, halves } = self;
        for row in rows {
            for own in cells.own(row) {
                for (&half, up) in halves.iter().zip(0..) {
                    let span = cells.span(row, up, cells.x[own], half);
                    let first = if up == 0 { own + 1 } else { span.start };
                    for other in first..span.end {
                        let displacement = [cells.x[own] - cells.x[other], cells.y[own] - cells.y[other]];
                        let numbers = [own, other].map(|at| cells.number[at] as usize);
                        let discs = numbers.map(|number| &particles[number]);
                        let is_near = displacement[0] * displacement[0] + displacement[1] * displacement[1]
                            < forces.reach * forces.reach;
                        if is_near && discs.iter().any(|disc| disc.kind == ParticleKind::Grain) {
                            let [one, two] = discs.map(body);
                            let pair = Pair { bodies: [PairBody { position: displacement, ..one }, two] };
                            each(numbers, displacement, (forces.of)(&pair));
                        }
                    }
                }
            }
        }
    }
}

/// Disc as a law reads it, at the origin.
fn body(disc: &Particle) -> PairBody {
    PairBody {
        position: [0.0; 2],
        velocity: disc.planar_velocity(),
        omega: disc.omega,
        radius: disc.radius,
        inverse_mass: if disc.kind == ParticleKind::Grain { 1.0 / disc.mass } else { 0.0 },
    }
}

/// Sum of the magnitudes of the forces on each disc (force), walls included, in their order.
pub fn forces_on_each(setting: &StructureSetting, particles: &[Particle], forces: &PairForces) -> Vec<f64> {
    let mut sums = vec![0.0; particles.len()];
    let mut cells = SampleCells::default();
    let acting = InteractingDiscs::new(setting, particles, forces, &mut cells);
    for rows in &acting.cells.parts {
        acting.each(rows.clone(), |numbers, _, [x, y]| {
            numbers.into_iter().for_each(|at| sums[at] += x.hypot(y))
        });
    }
    sums
}

/// Net pair force on each disc (force), in their order. Walls are included, pairs of walls are not. A `forces.reach` of 0 gives none.
pub fn net_forces(setting: &StructureSetting, particles: &[Particle], forces: &PairForces) -> Vec<[f64; 2]> {
    let mut sums = vec![[0.0; 2]; particles.len()];
    let mut cells = SampleCells::default();
    let acting = InteractingDiscs::new(setting, particles, forces, &mut cells);
    for rows in &acting.cells.parts {
        acting.each(rows.clone(), |[first, second], _, force| {
            for (axis, force) in force.into_iter().enumerate() {
                sums[first][axis] += force;
                sums[second][axis] -= force;
            }
        });
    }
    sums
}

/// Number of cells of the grid along each axis: nearly square, each wider than a disc.
fn counts(setting: &StructureSetting) -> [usize; 2] {
    let [x, y] = setting.domain.lengths();
    let edge = (x * y / MOST_CELLS).sqrt().max(setting.diameter);
    [x, y].map(|side| (side / edge).floor().clamp(1.0, MOST_CELLS) as usize)
}

/// Centres of the cells of the grid (length), row by row.
pub(super) fn grid(setting: &StructureSetting) -> Vec<[f64; 2]> {
    let [columns, rows] = counts(setting);
    let middle = |axis: usize, at: usize, count: usize| {
        setting.domain.origin[axis] + (at as f64 + 0.5) * setting.domain.length(axis) / count as f64
    };
    (0..rows * columns)
        .map(|cell| [middle(0, cell % columns, columns), middle(1, cell / columns, rows)])
        .collect()
}

/// Momentum flux in each cell of the grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Stress {
    /// Components cell by cell (force/length).
    sums: Vec<f64>,
    /// Components of each task (energy).
    parts: Vec<Vec<f64>>,
    cells: SampleCells,
}

impl Stress {
    /// Sums the motion of the grains, and half of each pair in the cell of either disc. Tasks are added in their order.
    pub(super) fn sum(&mut self, setting: &StructureSetting, particles: &[Particle], forces: &PairForces) {
        let [columns, rows] = counts(setting);
        let domain = setting.domain;
        let cell = |disc: &Particle| {
            let along = |axis: usize, count: usize| {
                let at = (disc.position[axis] - domain.origin[axis]) / domain.length(axis) * count as f64;
                (at as usize).min(count - 1)
            };
            COMPONENTS * (along(1, rows) * columns + along(0, columns))
        };
        let width = COMPONENTS * rows * columns;
        let acting = InteractingDiscs::new(setting, particles, forces, &mut self.cells);
        self.parts.resize(acting.cells.parts.len(), vec![]);
        self.parts.par_iter_mut().zip(acting.cells.parts.par_iter()).for_each(|(sums, rows)| {
            sums.clear();
            sums.resize(width, 0.0);
            acting.each(rows.clone(), |numbers, [right, up], [fx, fy]| {
                for number in numbers {
                    let adds = [right * fx, 0.5 * (right * fy + up * fx), up * fy].map(|virial| 0.5 * virial);
                    add(&mut sums[cell(&particles[number])..], adds);
                }
            });
        });
        self.sums.clear();
        self.sums.resize(width, 0.0);
        for disc in particles.iter().filter(|disc| disc.kind == ParticleKind::Grain) {
            let [x, y] = disc.planar_velocity();
            add(&mut self.sums[cell(disc)..], [x * x, x * y, y * y].map(|square| disc.mass * square));
        }
        for part in &self.parts {
            self.sums.iter_mut().zip(part).for_each(|(sum, of_part)| *sum += of_part);
        }
        let by_area = (rows * columns) as f64 / domain.area();
        self.sums.iter_mut().for_each(|sum| *sum *= by_area);
    }

    /// Component in each cell (force/length).
    pub(super) fn component(&self, component: usize, values: &mut [f64]) {
        let cells = self.sums.chunks_exact(COMPONENTS);
        values.iter_mut().zip(cells).for_each(|(value, cell)| *value = cell[component]);
    }
}

fn add(sums: &mut [f64], adds: [f64; COMPONENTS]) {
    sums.iter_mut().zip(adds).for_each(|(sum, it)| *sum += it);
}
