//! State of the discs: columns in the order of their cells, positions relative to the cells' centres.

use super::{CarriedState, PairSystem};
use crate::particles::{Particle, ParticleKind, Particles};
use std::cell::Cell;
use std::ops::Range;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::{DERIVATIVES, Inertia};
use stripmine_kernels::isa::AlignedColumn;
use stripmine_kernels::sweep::fast::{self, SENTINELS};
use stripmine_kernels::{in_pieces, reorder_into, reordered};

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

/// Columns with an entry for each disc, grains first, followed by two sentinels that touch nothing. They start at different cache lines in large
/// pages: a pass over a million discs takes a fifth less time than over vectors, which all start at page borders.
#[derive(Clone, Debug)]
pub(crate) struct MovingDiscs<S> {
    /// Carried derivatives of each degree of freedom, scaled by the scheme.
    pub(super) columns: Vec<Vec<AlignedColumn<S>>>,
    /// Scale factor of velocities in the columns.
    velocity_scale: f64,
    /// Radius of every disc (length), if all are equal.
    alike: Option<f64>,
    /// Radii if discs vary; `inverse` then holds inverse masses and moments of inertia.
    radius: AlignedColumn<S>,
    /// Scratch column, swapped with a column when discs are sorted.
    spare: AlignedColumn<S>,
    inverse: [AlignedColumn<S>; 2],
    /// Number of each disc in the scene.
    numbers: Vec<u32>,
    /// Ids of the discs, which select their random numbers.
    ids: Vec<u32>,
    moving: usize,
    grains: usize,
}

/// Arguments of a pass: columns, inverse masses and moments of inertia, and ids.
type PassColumns<'a, S> = (&'a mut [Vec<AlignedColumn<S>>], [&'a [S]; 2], &'a [u32]);

/// Derivatives of each degree of freedom that a sweep reads.
const SWEPT: [Range<usize>; 3] = [0..2, 0..2, 1..2];

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
        // The thread that fills a piece touches its memory first.
        let numbers = Cell::new(0);
        let zeros = || AlignedColumn::zeros(numbers.replace(numbers.get() + 1), discs.len() + SENTINELS);
        let column = |value: &(dyn Fn(&Particle) -> f64 + Sync), sentinel: f64| -> AlignedColumn<S> {
            let mut values = zeros();
            let (of_discs, of_sentinels) = values.split_at_mut(discs.len());
            of_sentinels.fill(S::from_f64(sentinel));
            in_pieces(of_discs, |first, piece| {
                let all = particles.all();
                let values = discs[first..].iter().map(|&number| value(&all[number as usize]));
                piece.iter_mut().zip(values).for_each(|(to, value)| *to = S::from_f64(value));
            });
            values
        };
        let derivative = |freedom: usize, k: usize| match (k, freedom) {
            (1, 0 | 1) => column(&|disc| disc.velocity[freedom] * velocity_scale, 0.0),
            (0, 2) => column(&|disc| disc.angle, 0.0),
            (1, _) => column(&|disc| disc.omega * velocity_scale, 0.0),
            _ => zeros(),
        };
        let mut columns: Vec<Vec<AlignedColumn<S>>> = (0..system.freedoms)
            .map(|freedom| (0..carried.derivatives).map(|k| derivative(freedom, k)).collect())
            .collect();
        // The sentinels are farther apart than any pair acts.
        columns[0][0][discs.len()] = S::from_f64(4.0 * system.reach);
        let (mut radius, mut inverse) =
            (AlignedColumn::default(), [(); 2].map(|()| AlignedColumn::default()));
        if system.inertia == Inertia::Varying {
            let of_grain =
                |disc: &Particle, value: f64| if disc.kind == ParticleKind::Wall { 0.0 } else { value };
            let largest = particles.radii().map_or(1.0, |[_, largest]| largest);
            radius = column(&|disc| disc.radius, largest);
            inverse[0] = column(&|disc| of_grain(disc, 1.0 / disc.mass), 1.0);
            let inertia = |disc: &Particle| system.inertia_factor * disc.mass * disc.radius * disc.radius;
            inverse[1] = column(&|disc| of_grain(disc, 1.0 / inertia(disc)), 1.0);
        }
        MovingDiscs {
            columns,
            velocity_scale,
            alike: system.radius,
            radius,
            spare: zeros(),
            inverse,
            ids: discs.iter().map(|&number| particles.all()[number as usize].id).collect(),
            numbers: discs,
            moving,
            grains,
        }
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

    /// Carried derivatives of a disc; the others are zero.
    pub(crate) fn row(&self, freedom: usize, disc: usize) -> [S; DERIVATIVES] {
        let mut row = [S::default(); DERIVATIVES];
        row.iter_mut().zip(&self.columns[freedom]).for_each(|(q, column)| *q = column[disc]);
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

    /// Position of a disc relative to the centre of its cell (length).
    pub(crate) fn place(&self, disc: usize) -> [f64; 2] {
        [self.columns[0][0][disc].to_f64(), self.columns[1][0][disc].to_f64()]
    }

    /// Positions of all discs and sentinels.
    pub(crate) fn places(&self) -> [&[S]; 2] {
        [&self.columns[0][0], &self.columns[1][0]]
    }

    /// Columns that a sweep reads and that change: positions, velocities, and spins if discs rotate.
    pub(crate) fn swept(&self) -> impl Iterator<Item = &[S]> {
        self.columns.iter().zip(SWEPT).flat_map(|(columns, swept)| &columns[swept]).map(|column| &**column)
    }

    /// Mutable access to these columns.
    pub(crate) fn swept_mut(&mut self) -> impl Iterator<Item = &mut [S]> {
        let columns = self.columns.iter_mut().zip(SWEPT);
        columns.flat_map(|(columns, swept)| &mut columns[swept]).map(|column| &mut **column)
    }

    /// Sets the position of a disc.
    pub(crate) fn put(&mut self, disc: usize, place: [f64; 2]) {
        (0..2).for_each(|axis| self.columns[axis][0][disc] = S::from_f64(place[axis]));
    }

    /// Sets the velocity of all wall discs (length/time).
    pub(crate) fn set_wall_velocity(&mut self, velocity: [f64; 2]) {
        let (discs, scale) = (self.numbers.len(), self.velocity_scale);
        (0..2).for_each(|axis| {
            self.columns[axis][1][self.grains..discs].fill(S::from_f64(velocity[axis] * scale))
        });
    }

    /// Radius of a disc (length).
    pub(crate) fn radius(&self, disc: usize) -> f64 {
        self.alike.unwrap_or_else(|| self.radius[disc].to_f64())
    }

    /// Inverse masses or moments of inertia for a degree of freedom.
    pub(crate) fn inverse(&self, freedom: usize) -> &[S] {
        &self.inverse[freedom / 2]
    }

    pub(crate) fn id(&self, disc: usize) -> u32 {
        self.ids[disc]
    }

    /// Numbers of the discs in the scene.
    pub(crate) fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// Returns the arguments of a pass.
    pub(crate) fn for_advance(&mut self) -> PassColumns<'_, S> {
        (&mut self.columns, [&self.inverse[0], &self.inverse[1]], &self.ids)
    }

    /// Discs as a sweep reads them.
    pub(crate) fn discs(&self, system: &PairSystem) -> fast::DiscColumns<'_, S> {
        let omega = if system.freedoms == 3 { &*self.columns[2][1] } else { &[] };
        fast::DiscColumns {
            position: self.places(),
            velocity: [&self.columns[0][1], &self.columns[1][1]],
            omega,
            per_time: 1.0 / self.velocity_scale,
            radius: &self.radius,
            inverse_mass: &self.inverse[0],
        }
    }

    /// Renumbers: disc `n` becomes what disc `order[n]` was.
    pub(crate) fn renumber(&mut self, order: &[u32]) {
        let discs = order.len() as u32;
        let with_sentinels: Vec<u32> = order.iter().copied().chain(discs..discs + SENTINELS as u32).collect();
        let derivatives = self.columns.iter_mut().flatten();
        for column in derivatives.chain([&mut self.radius]).chain(&mut self.inverse) {
            if !column.is_empty() {
                reorder_into(&mut self.spare, column, &with_sentinels);
                std::mem::swap(column, &mut self.spare);
            }
        }
        self.numbers = reordered(&self.numbers, order);
        self.ids = reordered(&self.ids, order);
    }
}
