//! Arrays of a step.

use super::lattice_walls::LatticeWalls;
use super::options::ProgramVersion;
use super::programs::scales;
use super::{DiscUniformity, GranularModel};
use crate::method::pairwise::{PrescribedMotion, WallTouch, WallTracks};
use crate::particles::{Particle, ParticleKind, Particles};
use std::ops::Range;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::gear::STATE;
use stripmine_kernels::isa::{AlignedColumn, Array, Memory, Slot};
use stripmine_kernels::law::granular::EqualDiscs;
use stripmine_kernels::ledger::VectorLength;
use stripmine_kernels::printed;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::sweep::walls::TouchingDisc;

/// Vector lengths of a step for a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lengths {
    /// NP: discs that move.
    pub grains: usize,
    /// Number of discs including wall discs.
    pub discs: usize,
    /// LMAX: cells that discs may occupy.
    pub cells: usize,
    swept: Range<usize>,
    padded: usize,
    halo: usize,
    walls: Vec<Range<usize>>,
}

impl Lengths {
    /// Lengths for `grains`, and `discs` with wall discs, on a model's lattice.
    pub fn new(model: &GranularModel, grains: usize, discs: usize) -> Self {
        let shape = &model.shape;
        Lengths {
            grains,
            discs,
            cells: shape.cells(),
            swept: shape.swept(),
            padded: shape.padded(),
            halo: shape.images().len(),
            walls: LatticeWalls::<f64>::new(model, WallTracks::new(&model.walls).now()).runs(),
        }
    }

    /// Element ranges of programs of this length, run one after the other: several for walls only.
    pub(crate) fn ranges(&self, length: VectorLength) -> Vec<Range<usize>> {
        match length {
            VectorLength::WallElements => self.walls.clone(),
            _ => vec![self.range(length)],
        }
    }

    /// Element range of programs of this length.
    pub fn range(&self, length: VectorLength) -> Range<usize> {
        match length {
            VectorLength::Grains => 0..self.grains,
            VectorLength::Discs => 0..self.discs,
            VectorLength::SweptCells => self.swept.clone(),
            VectorLength::PaddedCells => 0..self.padded,
            VectorLength::HaloCells => 0..self.halo,
            VectorLength::WallElements => 0..self.walls.last().map_or(0, |run| run.end),
            // Known only when the lists are traversed.
            VectorLength::Candidates | VectorLength::Pairs => 0..0,
        }
    }
}

/// Discs and lattice vectors of a model, with the state in precision `S` and the lattice in precision `P`. Parts that the model leaves out have no
/// array.
#[derive(Clone, Debug)]
pub struct ProgramArrays<S, P> {
    lengths: Lengths,
    /// Columns in state precision.
    state: ArrayColumns<S>,
    /// Columns in force precision that programs write.
    lattice: ArrayColumns<P>,
    /// Columns in force precision that never change.
    constant: ArrayColumns<P>,
    cell: AlignedColumn<u32>,
    /// Index of each disc's forces if it differs from its cell: numbered from 1.
    force_at: Option<AlignedColumn<u32>>,
    index: AlignedColumn<u32>,
    halo_cell: AlignedColumn<u32>,
    halo_source: AlignedColumn<u32>,
    walls: LatticeWalls<P>,
}

/// Columns of the machine's arrays.
type ArrayColumns<T> = Vec<(Array, AlignedColumn<T>)>;

/// Binds state and lattice columns to their slots.
fn bound<'a, S: Precision, P: Precision>(
    state: &'a mut ArrayColumns<S>,
    lattice: &'a mut ArrayColumns<P>,
    constant: &'a ArrayColumns<P>,
) -> Memory<'a> {
    let mut memory = Memory::new();
    // Constants first: if state and lattice have one precision, the state's copy of a quantity replaces them.
    for (array, column) in constant {
        memory.bind_read(Slot::new(*array), column);
    }
    for (array, column) in lattice {
        memory.bind_write(Slot::new(*array), column);
    }
    for (array, column) in state {
        memory.bind_write(Slot::new(*array), column);
    }
    memory
}

/// Stores an array's elements in cache lines of their own.
fn aligned_array<X: Copy>(array: Array, values: impl IntoIterator<Item = X>) -> AlignedColumn<X> {
    AlignedColumn::new(array as usize, values)
}

impl<S: Precision, P: Precision> ProgramArrays<S, P> {
    /// Stores `particles`; derivatives above the velocity start at zero. Forces are stored by cell.
    pub fn new(model: &GranularModel, particles: &Particles) -> Self {
        ProgramArrays::with_layout(model, particles, false)
    }

    /// Stores `particles` with forces by disc: for searches that let discs share a cell.
    pub(crate) fn with_forces_by_disc(model: &GranularModel, particles: &Particles) -> Self {
        ProgramArrays::with_layout(model, particles, true)
    }

    fn with_layout(model: &GranularModel, particles: &Particles, by_disc: bool) -> Self {
        let lengths = Lengths::new(model, particles.grain_count(), particles.len());
        let (discs, padded) = (lengths.discs, lengths.padded);
        let convert =
            |array, values: Vec<f64>| (array, aligned_array(array, values.into_iter().map(S::from_f64)));
        let on_lattice =
            |array, values: Vec<f64>| (array, aligned_array(array, values.into_iter().map(P::from_f64)));

        let anchored: Option<Vec<(u32, [f64; 2])>> = model
            .is_anchored::<S>()
            .then(|| particles.all().iter().map(|disc| model.anchored(disc.planar_position())).collect());
        let positions: Vec<[f64; 2]> = match &anchored {
            Some(anchored) => anchored.iter().map(|(_, position)| *position).collect(),
            None => particles.all().iter().map(Particle::planar_position).collect(),
        };
        let velocity_scale = scales(model)[1];
        let mut state = Vec::new();
        for (freedom, row) in STATE.iter().enumerate().take(model.freedoms()) {
            for (k, &array) in row.iter().enumerate().take(model.scheme.values()) {
                let column =
                    particles.all().iter().zip(&positions).map(|(disc, position)| match (k, freedom) {
                        (0, 0 | 1) => position[freedom],
                        (1, 0 | 1) => disc.velocity[freedom] * velocity_scale,
                        (0, _) => disc.angle,
                        (1, _) => disc.omega * velocity_scale,
                        _ => 0.0,
                    });
                state.push(convert(array, column.collect()));
            }
        }

        let mut constant = vec![(Array::FarX, aligned_array(Array::FarX, model.shape.far(model.frame)))];
        if model.discs == DiscUniformity::Varying {
            let of_grains = |inverse: fn(&Particle, f64) -> f64| -> Vec<f64> {
                let value = |disc: &Particle| match disc.kind {
                    ParticleKind::Grain => inverse(disc, model.inertia_factor),
                    ParticleKind::Wall => 0.0,
                };
                particles.all().iter().map(value).collect()
            };
            let inverse_mass = of_grains(|disc, _| 1.0 / disc.mass);
            state.push(convert(Array::DiscInverseMass, inverse_mass.clone()));
            if model.friction {
                let inertia =
                    of_grains(|disc, factor| 1.0 / (factor * disc.mass * disc.radius * disc.radius));
                state.push(convert(Array::DiscInverseInertia, inertia));
            }
            match model.text {
                ProgramVersion::Ours => constant.push(on_lattice(Array::DiscInverseMass, inverse_mass)),
                ProgramVersion::Printed => {
                    let heaviest = particles.grains().iter().map(|disc| disc.mass).fold(0.0, f64::max);
                    let fixed = printed::mass_of_fixed_disc(heaviest);
                    let mass =
                        |disc: &Particle| if disc.kind == ParticleKind::Grain { disc.mass } else { fixed };
                    let masses = particles.all().iter().map(mass).collect();
                    constant.push(on_lattice(Array::DiscMass, masses));
                }
            }
            let radii = particles.all().iter().map(|disc| disc.radius).collect();
            constant.push(on_lattice(Array::DiscRadius, radii));
        }
        let images = model.shape.images();
        if model.coordinates == Coordinates::Absolute {
            for (axis, array) in [Array::ImageX, Array::ImageY].into_iter().enumerate() {
                let cells = [model.shape.columns(), model.shape.rows()][axis];
                let period = cells as f64 * model.frame.edge[axis];
                let mut shift = AlignedColumn::filled(array as usize, P::from_f64(0.0), padded);
                for image in &images {
                    shift[image.cell] = P::from_f64(f64::from(image.periods[axis]) * period);
                }
                constant.push((array, shift));
            }
        }

        let mut lattice: ArrayColumns<P> = Vec::new();
        let mut columns = |arrays: &[Array], length| {
            let zeros = |array| AlignedColumn::filled(array as usize, P::from_f64(0.0), length);
            lattice.extend(arrays.iter().map(|&array| (array, zeros(array))));
        };
        let is_printed = model.text == ProgramVersion::Printed;
        if is_printed {
            columns(&[Array::Test, Array::Mass], padded);
        } else {
            columns(&[Array::DiscX, Array::DiscY, Array::DiscVx, Array::DiscVy], discs);
            if model.friction {
                columns(&[Array::DiscOmega], discs);
            }
        }
        let forces = if by_disc { discs } else { padded };
        columns(&[Array::X, Array::Y, Array::Vx, Array::Vy], padded);
        columns(&[Array::Fx, Array::Fy], forces);
        if model.friction {
            columns(&[Array::Omega], padded);
            columns(&[Array::Torque], forces);
        }
        if model.discs == DiscUniformity::Varying {
            columns(&[Array::Radius], padded);
            if !is_printed {
                columns(&[Array::InverseMass], padded);
            }
        }
        let asked = model.asked();
        if asked.watched.is_some() {
            columns(&[Array::Deepest], padded);
            constant.push((Array::Interior, aligned_array(Array::Interior, model.shape.interior())));
        }
        if asked.dissipation {
            columns(&[Array::Power], padded);
        }
        if asked.energy {
            columns(&[Array::Energy, Array::Virial], padded);
        }
        // The predictor passes on the grains' velocities; those of a wall stay until the wall is moved.
        let velocity = |disc: &Particle| [disc.velocity[0], disc.velocity[1], disc.omega];
        for (component, array) in [Array::DiscVx, Array::DiscVy, Array::DiscOmega].into_iter().enumerate() {
            if let Some((_, column)) = lattice.iter_mut().find(|(name, _)| *name == array) {
                let own = particles.all().iter().map(|disc| P::from_f64(velocity(disc)[component]));
                *column = aligned_array(array, own);
            }
        }

        ProgramArrays {
            state,
            lattice,
            constant,
            cell: match anchored {
                Some(anchored) => aligned_array(Array::DiscCell, anchored.into_iter().map(|(cell, _)| cell)),
                None => AlignedColumn::filled(Array::DiscCell as usize, 0, discs),
            },
            force_at: by_disc.then(|| aligned_array(Array::DiscCell, 1..=discs as u32)),
            index: AlignedColumn::filled(Array::Index as usize, 0, padded),
            halo_cell: aligned_array(Array::HaloCell, images.iter().map(|image| image.cell as u32 + 1)),
            halo_source: aligned_array(Array::HaloSource, images.iter().map(|image| image.source as u32 + 1)),
            walls: LatticeWalls::new(model, WallTracks::new(&model.walls).now()),
            lengths,
        }
    }

    /// Moves the plane walls.
    pub(super) fn move_plane_walls(&mut self, model: &GranularModel, motions: &[PrescribedMotion]) {
        self.walls = LatticeWalls::new(model, motions);
        self.lengths.walls = self.walls.runs();
    }

    /// Lists the contacts of the discs in lattice vectors with plane walls.
    pub(super) fn wall_touches(&self, model: &GranularModel) -> Vec<WallTouch> {
        let column = |array: Array| self.lattice(array).unwrap_or(&[]);
        let at = |array: Array, position: usize| column(array).get(position).copied();
        let equal = match model.discs {
            DiscUniformity::Equal { disc, .. } => Some(disc),
            DiscUniformity::Varying => None,
        };
        self.walls.touches(model, |position| {
            let number = (*self.index.get(position)? as usize).checked_sub(1)?;
            let equal = |of: fn(EqualDiscs) -> f64| equal.map(|disc| P::from_f64(of(disc)));
            let disc = TouchingDisc {
                position: [at(Array::X, position)?, at(Array::Y, position)?],
                velocity: [at(Array::Vx, position)?, at(Array::Vy, position)?],
                omega: at(Array::Omega, position).unwrap_or_default(),
                radius: equal(|disc| disc.radius).or_else(|| at(Array::Radius, position))?,
                inverse_mass: equal(|disc| disc.inverse_mass).or_else(|| at(Array::InverseMass, position))?,
            };
            (number < self.lengths.grains).then_some((number, disc))
        })
    }

    /// Vector lengths.
    pub fn lengths(&self) -> &Lengths {
        &self.lengths
    }

    /// Binds all arrays to their slots; also returns the vector lengths.
    pub fn memory(&mut self) -> (Memory<'_>, &Lengths) {
        let ProgramArrays {
            lengths,
            state,
            lattice,
            constant,
            cell,
            index,
            halo_cell,
            halo_source,
            walls,
            ..
        } = self;
        let mut memory = bound(state, lattice, constant);
        memory.bind_write(Slot::new(Array::DiscCell), cell);
        memory.bind_write(Slot::new(Array::Index), index);
        memory.bind_read(Slot::new(Array::HaloCell), halo_cell);
        memory.bind_read(Slot::new(Array::HaloSource), halo_source);
        walls.bind(&mut memory);
        (memory, lengths)
    }

    /// Binds the arrays for the corrector: its cell of a disc is the index of the disc's forces.
    pub(crate) fn memory_of_corrector(&mut self) -> (Memory<'_>, &Lengths) {
        let ProgramArrays { lengths, state, lattice, constant, cell, force_at, .. } = self;
        let mut memory = bound(state, lattice, constant);
        memory.bind_read(Slot::new(Array::DiscCell), force_at.as_deref().unwrap_or(cell));
        (memory, lengths)
    }

    /// Returns the index of a disc's forces in their columns.
    pub(crate) fn force_at(&self, disc: usize) -> Option<usize> {
        let number = self.force_at.as_deref().unwrap_or(&self.cell)[disc];
        (number as usize).checked_sub(1)
    }

    /// Returns a column in state precision.
    pub fn state(&self, array: Array) -> Option<&[S]> {
        self.state.iter().find(|(name, _)| *name == array).map(|(_, column)| &**column)
    }

    /// Returns a column in state precision to modify.
    pub(crate) fn state_mut(&mut self, array: Array) -> Option<&mut [S]> {
        self.state.iter_mut().find(|(name, _)| *name == array).map(|(_, column)| &mut **column)
    }

    /// Returns all columns in state precision.
    pub fn states(&self) -> impl Iterator<Item = (Array, &[S])> {
        self.state.iter().map(|(array, column)| (*array, &**column))
    }

    /// Returns a column in force precision to modify.
    pub(crate) fn lattice_mut(&mut self, array: Array) -> Option<&mut [P]> {
        self.lattice.iter_mut().find(|(name, _)| *name == array).map(|(_, column)| &mut **column)
    }

    /// Returns a column in force precision that never changes.
    pub(crate) fn constant(&self, array: Array) -> Option<&[P]> {
        self.constant.iter().find(|(name, _)| *name == array).map(|(_, column)| &**column)
    }

    /// Returns the cell of every disc, numbered from 1; 0 means none.
    pub fn cell(&self) -> &[u32] {
        &self.cell
    }

    /// Returns the cell of every disc to modify.
    pub(crate) fn cell_mut(&mut self) -> &mut [u32] {
        &mut self.cell
    }

    /// Returns the disc in every cell, numbered from 1; 0 means none.
    pub fn index(&self) -> &[u32] {
        &self.index
    }

    /// Returns a column in force precision.
    pub fn lattice(&self, array: Array) -> Option<&[P]> {
        self.lattice.iter().find(|(name, _)| *name == array).map(|(_, column)| &**column)
    }
}
