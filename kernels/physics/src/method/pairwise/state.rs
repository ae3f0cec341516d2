//! State of the discs: records in the order of their cells, positions relative to the cells' centres.

use super::{CarriedState, PairSystem};
use crate::particles::{Particle, ParticleKind, Particles};
use std::cell::Cell;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::{DERIVATIVES, Inertia};
use stripmine_kernels::isa::AlignedColumn;
use stripmine_kernels::isa::aligned_column::column_memory;
use stripmine_kernels::sweep::fast::{RecordEntry, StateRecords};
use stripmine_kernels::{in_pieces, reorder_into, reordered};

/// Discs that are corrected together.
pub(super) const AT_A_TIME: usize = 128;

/// Value and rate of each degree of freedom of a disc at the end of a step; zeros where it has fewer.
pub(super) type StepEndRow = [[f64; 2]; 3];

/// Change of cell of a disc, its position relative to the new centre (length), and the periods that it crosses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CellMove {
    pub disc: usize,
    pub cell: [usize; 2],
    pub place: [f64; 2],
    pub periods: [f64; 2],
}

/// Discs of an engine: owned grains, grains of other ranks, and discs that no force moves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Members {
    /// Numbers in the scene, in that order.
    pub numbers: Vec<u32>,
    /// Number of owned grains.
    pub moving: usize,
    /// Number of grains.
    pub grains: usize,
}

impl Members {
    /// All discs of a scene.
    pub(crate) fn all(particles: &Particles) -> Members {
        let grains = particles.grain_count();
        Members { numbers: (0..particles.len() as u32).collect(), moving: grains, grains }
    }
}

/// Sizes of the state and the sums of an engine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StateSize {
    /// Number of discs.
    pub discs: f64,
    /// Degrees of freedom of a disc.
    pub freedoms: f64,
    /// True if discs vary.
    pub vary: bool,
    /// Number of derivatives carried from step to step, including the value.
    pub carried: f64,
    /// Bytes of a number of the state, and of a number of the forces.
    pub number: [f64; 2],
}

impl StateSize {
    /// Numbers of columns, scratch space for sorting included: of 16 bytes a disc, and of a number of the state a disc.
    fn columns(&self) -> [f64; 2] {
        let StateSize { freedoms, vary, carried, number: [state, force], .. } = *self;
        let entries = if vary { 8.0 } else { 2.0 * freedoms };
        let blocks = (entries * state / 16.0).ceil();
        let columns = freedoms * (carried - 2.0) + f64::from(u8::from(vary));
        // The scratch space of the blocks is one of them, that of the columns one more, and that of the sums as large as they.
        let sums = 2.0 * 4.0 * force / 16.0;
        [blocks + 1.0 + sums, columns + f64::from(u8::from(columns > 0.0))]
    }

    /// Bytes of the state and the sums.
    pub(crate) fn bytes(&self) -> f64 {
        let [blocks, columns] = self.columns();
        blocks * column_memory(16.0 * self.discs) + columns * column_memory(self.number[0] * self.discs)
    }

    /// Rows in memory of 16 bytes per disc, and the bytes of each.
    pub(crate) fn rows(&self) -> [f64; 2] {
        let [blocks, columns] = self.columns();
        [blocks + columns * self.number[0] / 16.0, 16.0 * self.discs]
    }
}

/// Records and columns with an entry for each disc, grains first; behind the records are two sentinels that touch nothing. They start at different
/// cache lines in large pages: a pass over a million discs takes a fifth less time than over vectors, which all start at page borders.
#[derive(Clone, Debug)]
pub(crate) struct MovingDiscs<S> {
    /// Values and rates of change, the latter scaled by the scheme, radii and inverse masses.
    pub(super) records: StateRecords<S>,
    /// Carried derivatives of each degree of freedom from the second on, scaled by the scheme.
    pub(super) higher: Vec<Vec<AlignedColumn<S>>>,
    /// Scale factor of velocities in the records.
    velocity_scale: f64,
    /// Radius of every disc (length), if all are equal.
    alike: Option<f64>,
    /// Inverse moments of inertia, if discs vary.
    inverse_inertia: AlignedColumn<S>,
    /// Scratch column, swapped with a column when discs are sorted.
    spare: AlignedColumn<S>,
    /// Number of each disc in the scene.
    numbers: Vec<u32>,
    /// Ids of the discs, which select their random numbers.
    ids: Vec<u32>,
    moving: usize,
    grains: usize,
}

/// Arguments of a pass: records, higher derivatives, inverse moments of inertia, and ids.
pub(super) type PassColumns<'a, S> =
    (&'a mut StateRecords<S>, &'a mut [Vec<AlignedColumn<S>>], &'a [S], &'a [u32]);

/// First alignment number of the columns; the blocks of the records have smaller ones.
const FIRST_COLUMN: usize = 4;

impl<S: Precision> MovingDiscs<S> {
    /// State of the members of `particles`, in the form that the scheme carries from step to step.
    pub(crate) fn new(
        system: &PairSystem,
        carried: &CarriedState,
        particles: &Particles,
        members: Members,
    ) -> Self {
        let velocity_scale = carried.scales[1];
        let Members { numbers: discs, moving, grains } = members;
        let (all, count) = (particles.all(), discs.len());
        let vary = system.inertia == Inertia::Varying;
        // The thread that fills a piece touches its memory first.
        let mut records = StateRecords::zeros(0, count, [system.freedoms == 3, vary], 1.0 / velocity_scale);
        let mut fill = |entry: RecordEntry, value: &(dyn Fn(&Particle) -> f64 + Sync), sentinel: f64| {
            let of = |disc: usize| discs.get(disc).map_or(sentinel, |&number| value(&all[number as usize]));
            records.fill(entry, |disc| S::from_f64(of(disc)));
        };
        for axis in 0..2 {
            fill(RecordEntry::of(axis, 1), &|disc| disc.velocity[axis] * velocity_scale, 0.0);
        }
        if system.freedoms == 3 {
            fill(RecordEntry::Angle, &|disc| disc.angle, 0.0);
            fill(RecordEntry::Omega, &|disc| disc.omega * velocity_scale, 0.0);
        }
        let numbers = Cell::new(0);
        let zeros = || AlignedColumn::zeros(numbers.replace(numbers.get() + 1) + FIRST_COLUMN, count);
        let mut inverse_inertia = AlignedColumn::default();
        if vary {
            let of_grain =
                |disc: &Particle, value: f64| if disc.kind == ParticleKind::Wall { 0.0 } else { value };
            let largest = particles.radii().map_or(1.0, |[_, largest]| largest);
            fill(RecordEntry::Radius, &|disc| disc.radius, largest);
            fill(RecordEntry::InverseMass, &|disc| of_grain(disc, 1.0 / disc.mass), 1.0);
            let inertia = |disc: &Particle| system.inertia_factor * disc.mass * disc.radius * disc.radius;
            inverse_inertia = zeros();
            in_pieces(&mut inverse_inertia, |first, piece| {
                let values = discs[first..].iter().map(|&number| &all[number as usize]);
                piece.iter_mut().zip(values).for_each(|(to, disc)| {
                    *to = S::from_f64(of_grain(disc, 1.0 / inertia(disc)));
                });
            });
        }
        // The sentinels are farther apart than any pair acts.
        records.set(RecordEntry::X, count, S::from_f64(4.0 * system.reach));
        let higher: Vec<Vec<AlignedColumn<S>>> =
            (0..system.freedoms).map(|_| (2..carried.derivatives).map(|_| zeros()).collect()).collect();
        let has_columns = vary || carried.derivatives > 2;
        MovingDiscs {
            records,
            velocity_scale,
            alike: system.radius,
            spare: if has_columns { zeros() } else { AlignedColumn::default() },
            inverse_inertia,
            higher,
            ids: discs.iter().map(|&number| all[number as usize].id).collect(),
            numbers: discs,
            moving,
            grains,
        }
    }

    /// Factor from velocities to rates in the records.
    pub(super) fn velocity_scale(&self) -> f64 {
        self.velocity_scale
    }

    /// Number of discs.
    pub(crate) fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Number of owned grains: the first discs.
    pub(crate) fn moving(&self) -> usize {
        self.moving
    }

    /// Number of grains: owned ones, followed by those of other ranks.
    pub(crate) fn grains(&self) -> usize {
        self.grains
    }

    /// Number of a disc in the scene.
    pub(crate) fn number(&self, disc: usize) -> usize {
        self.numbers[disc] as usize
    }

    /// Degrees of freedom and derivatives that are carried from step to step, in order.
    pub(super) fn carried(&self) -> impl Iterator<Item = (usize, usize)> + use<S> {
        let counts: Vec<usize> = self.higher.iter().map(|columns| 2 + columns.len()).collect();
        counts.into_iter().enumerate().flat_map(|(freedom, count)| (0..count).map(move |k| (freedom, k)))
    }

    /// A carried derivative of a degree of freedom of a disc.
    pub(super) fn derivative(&self, (freedom, k): (usize, usize), disc: usize) -> S {
        match k {
            0 | 1 => self.records.get(RecordEntry::of(freedom, k), disc),
            _ => self.higher[freedom][k - 2][disc],
        }
    }

    /// Sets a carried derivative of a degree of freedom of a disc.
    pub(super) fn set_derivative(&mut self, (freedom, k): (usize, usize), disc: usize, value: S) {
        match k {
            0 | 1 => self.records.set(RecordEntry::of(freedom, k), disc, value),
            _ => self.higher[freedom][k - 2][disc] = value,
        }
    }

    /// Carried derivatives of a disc; the others are zero.
    pub(crate) fn row(&self, freedom: usize, disc: usize) -> [S; DERIVATIVES] {
        let mut row = [S::default(); DERIVATIVES];
        let carried = 2 + self.higher[freedom].len();
        row.iter_mut().enumerate().take(carried).for_each(|(k, q)| *q = self.derivative((freedom, k), disc));
        row
    }

    /// Rate of change (of a position or the angle) of a row, in the scene's units.
    pub(crate) fn rate(&self, row: &[S; DERIVATIVES]) -> f64 {
        row[1].to_f64() / self.velocity_scale
    }

    /// Value (a position or the angle) and rate of change of a row, in the scene's units.
    pub(crate) fn value_and_rate(&self, row: &[S; DERIVATIVES]) -> [f64; 2] {
        [row[0].to_f64(), self.rate(row)]
    }

    /// Rates of change of x, y and the angle of a disc; 0 where it does not rotate.
    pub(crate) fn rates(&self, disc: usize) -> [f64; 3] {
        let rate = |freedom: usize| match self.records.has(RecordEntry::of(freedom, 1)) {
            true => self.records.get(RecordEntry::of(freedom, 1), disc).to_f64() / self.velocity_scale,
            false => 0.0,
        };
        [0, 1, 2].map(rate)
    }

    /// Position of a disc relative to the centre of its cell (length).
    pub(crate) fn place(&self, disc: usize) -> [f64; 2] {
        self.records.position(disc)
    }

    /// Sets the position of a disc.
    pub(crate) fn put(&mut self, disc: usize, place: [f64; 2]) {
        (0..2).for_each(|axis| self.set_derivative((axis, 0), disc, S::from_f64(place[axis])));
    }

    /// Sets the velocity of all wall discs (length/time).
    pub(crate) fn set_wall_velocity(&mut self, velocity: [f64; 2]) {
        for disc in self.grains..self.len() {
            for (axis, along) in velocity.into_iter().enumerate() {
                self.set_derivative((axis, 1), disc, S::from_f64(along * self.velocity_scale));
            }
        }
    }

    /// Radius of a disc (length).
    pub(crate) fn radius(&self, disc: usize) -> f64 {
        self.alike.unwrap_or_else(|| self.records.get(RecordEntry::Radius, disc).to_f64())
    }

    /// Inverse mass or moment of inertia of a disc for a degree of freedom, if discs vary.
    pub(crate) fn inverse(&self, freedom: usize, disc: usize) -> S {
        match freedom {
            0 | 1 => self.records.get(RecordEntry::InverseMass, disc),
            _ => self.inverse_inertia[disc],
        }
    }

    pub(crate) fn id(&self, disc: usize) -> u32 {
        self.ids[disc]
    }

    /// Numbers of the discs in the scene.
    pub(crate) fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// Returns the arguments of a pass.
    pub(super) fn for_advance(&mut self) -> PassColumns<'_, S> {
        (&mut self.records, &mut self.higher, &self.inverse_inertia, &self.ids)
    }

    /// Renumbers: disc `n` becomes what disc `order[n]` was.
    pub(crate) fn renumber(&mut self, order: &[u32]) {
        self.records.renumber(order);
        for column in self.higher.iter_mut().flatten().chain([&mut self.inverse_inertia]) {
            if !column.is_empty() {
                reorder_into(&mut self.spare, column, order);
                std::mem::swap(column, &mut self.spare);
            }
        }
        self.numbers = reordered(&self.numbers, order);
        self.ids = reordered(&self.ids, order);
    }
}
