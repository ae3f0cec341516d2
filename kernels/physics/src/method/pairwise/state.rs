//! The discs: columns in the order of their cells, positions seen from the cells' centres.

use super::{Carried, System};
use crate::particles::{Kind, Particle, Particles};
use std::cell::Cell;
use std::ops::Range;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::{DERIVATIVES, Inertia};
use stripmine_kernels::isa::AlignedColumn;
use stripmine_kernels::sweep::fast::{self, SENTINELS};
use stripmine_kernels::{in_pieces, put_in_order, reordered};

/// A disc with the cell it goes to, its place there, seen from the cell's centre (length), and the periods that it crosses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Move {
    pub disc: usize,
    pub cell: [usize; 2],
    pub place: [f64; 2],
    pub periods: [f64; 2],
}

/// Which of the scene's discs there are: those that are moved here, grains that another rank moves, and discs that no force moves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Members {
    /// Their numbers in the scene, in that order.
    pub numbers: Vec<u32>,
    /// How many are moved here.
    pub moving: usize,
    /// How many are grains.
    pub grains: usize,
}

impl Members {
    /// All of a scene's.
    pub(crate) fn all(particles: &Particles) -> Members {
        let grains = particles.grain_count();
        Members { numbers: (0..particles.len() as u32).collect(), moving: grains, grains }
    }
}

/// Columns with an entry a disc, grains first, and two discs behind them that never touch. They begin at lines of their own in large pages: a pass over a
/// million discs takes a fifth less than over vectors, which all begin at a page's border.
#[derive(Clone, Debug)]
pub(crate) struct State<S> {
    /// For each degree of freedom the derivatives that are carried from step to step, as the scheme scales them.
    pub(super) columns: Vec<Vec<AlignedColumn<S>>>,
    /// What velocities are multiplied by in the columns.
    velocity_scale: f64,
    /// The radius of every disc (length), where they are alike.
    alike: Option<f64>,
    /// Radii, and inverse masses and moments of inertia, where discs vary.
    radius: AlignedColumn<S>,
    /// Becomes one of the columns when these are put in order.
    spare: AlignedColumn<S>,
    inverse: [AlignedColumn<S>; 2],
    /// Which of the scene's discs each is.
    numbers: Vec<u32>,
    /// The ids of the discs, by which they draw random numbers.
    ids: Vec<u32>,
    moving: usize,
    grains: usize,
}

/// What a pass moves: columns, inverse masses and moments of inertia, and ids.
type Moved<'a, S> = (&'a mut [Vec<AlignedColumn<S>>], [&'a [S]; 2], &'a [u32]);

/// Which derivatives of each degree of freedom a sweep reads.
const SWEPT: [Range<usize>; 3] = [0..2, 0..2, 1..2];

impl<S: Precision> State<S> {
    /// Of those of `particles` that are members, in the form in which the scheme carries them from step to step.
    pub(crate) fn new(system: &System, carried: &Carried, particles: &Particles, members: Members) -> Self {
        let velocity_scale = carried.scales[1];
        let Members { numbers: discs, moving, grains } = members;
        // The thread that fills a piece is the first to touch its memory.
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
        // The sentinels stand farther apart than any pair acts.
        columns[0][0][discs.len()] = S::from_f64(4.0 * system.reach);
        let (mut radius, mut inverse) =
            (AlignedColumn::default(), [(); 2].map(|()| AlignedColumn::default()));
        if system.inertia == Inertia::Varying {
            let of_grain = |disc: &Particle, value: f64| if disc.kind == Kind::Wall { 0.0 } else { value };
            let largest = particles.radii().map_or(1.0, |[_, largest]| largest);
            radius = column(&|disc| disc.radius, largest);
            inverse[0] = column(&|disc| of_grain(disc, 1.0 / disc.mass), 1.0);
            let inertia = |disc: &Particle| system.inertia_factor * disc.mass * disc.radius * disc.radius;
            inverse[1] = column(&|disc| of_grain(disc, 1.0 / inertia(disc)), 1.0);
        }
        State {
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

    /// How many discs there are here.
    pub(crate) fn len(&self) -> usize {
        self.numbers.len()
    }

    /// How many of them are moved here: the first ones.
    pub(crate) fn moving(&self) -> usize {
        self.moving
    }

    /// How many of them are grains: those that are moved here, and those that another rank moves behind them.
    pub(crate) fn grains(&self) -> usize {
        self.grains
    }

    /// Which of the scene's discs a disc is.
    pub(crate) fn number(&self, disc: usize) -> usize {
        self.numbers[disc] as usize
    }

    /// The carried derivatives of a disc, the others zero.
    pub(crate) fn row(&self, freedom: usize, disc: usize) -> [S; DERIVATIVES] {
        let mut row = [S::default(); DERIVATIVES];
        row.iter_mut().zip(&self.columns[freedom]).for_each(|(q, column)| *q = column[disc]);
        row
    }

    /// The rate of change (of a position, of the angle) that a row has in the scene's units.
    pub(crate) fn rate(&self, row: &[S; DERIVATIVES]) -> f64 {
        row[1].to_f64() / self.velocity_scale
    }

    /// The first entry of a row (a position, the angle) and its rate of change, in the scene's units.
    pub(crate) fn value_and_rate(&self, row: &[S; DERIVATIVES]) -> [f64; 2] {
        [row[0].to_f64(), self.rate(row)]
    }

    /// The place of a disc, seen from the centre of its cell (length).
    pub(crate) fn place(&self, disc: usize) -> [f64; 2] {
        [self.columns[0][0][disc].to_f64(), self.columns[1][0][disc].to_f64()]
    }

    /// The places of all discs and sentinels.
    pub(crate) fn places(&self) -> [&[S]; 2] {
        [&self.columns[0][0], &self.columns[1][0]]
    }

    /// Places and velocities of the discs, as the columns have them, and their spins where discs turn: all that a sweep reads of them and that changes.
    pub(crate) fn swept(&self) -> impl Iterator<Item = &[S]> {
        self.columns.iter().zip(SWEPT).flat_map(|(columns, swept)| &columns[swept]).map(|column| &**column)
    }

    /// The same, to be changed.
    pub(crate) fn swept_mut(&mut self) -> impl Iterator<Item = &mut [S]> {
        let columns = self.columns.iter_mut().zip(SWEPT);
        columns.flat_map(|(columns, swept)| &mut columns[swept]).map(|column| &mut **column)
    }

    /// Puts a disc at a place.
    pub(crate) fn put(&mut self, disc: usize, place: [f64; 2]) {
        (0..2).for_each(|axis| self.columns[axis][0][disc] = S::from_f64(place[axis]));
    }

    /// Gives all wall discs a velocity (length/time).
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

    /// Inverse masses or moments of inertia, for a degree of freedom.
    pub(crate) fn inverse(&self, freedom: usize) -> &[S] {
        &self.inverse[freedom / 2]
    }

    pub(crate) fn id(&self, disc: usize) -> u32 {
        self.ids[disc]
    }

    /// Which of the scene's discs each is.
    pub(crate) fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// What a pass moves.
    pub(crate) fn for_advance(&mut self) -> Moved<'_, S> {
        (&mut self.columns, [&self.inverse[0], &self.inverse[1]], &self.ids)
    }

    /// The discs as a sweep reads them.
    pub(crate) fn discs(&self, system: &System) -> fast::Discs<'_, S> {
        let omega = if system.freedoms == 3 { &*self.columns[2][1] } else { &[] };
        fast::Discs {
            place: self.places(),
            velocity: [&self.columns[0][1], &self.columns[1][1]],
            omega,
            per_time: 1.0 / self.velocity_scale,
            radius: &self.radius,
            inverse_mass: &self.inverse[0],
        }
    }

    /// Disc `n` is from now on what disc `order[n]` was.
    pub(crate) fn renumber(&mut self, order: &[u32]) {
        let discs = order.len() as u32;
        let with_sentinels: Vec<u32> = order.iter().copied().chain(discs..discs + SENTINELS as u32).collect();
        let derivatives = self.columns.iter_mut().flatten();
        for column in derivatives.chain([&mut self.radius]).chain(&mut self.inverse) {
            if !column.is_empty() {
                put_in_order(&mut self.spare, column, &with_sentinels);
                std::mem::swap(column, &mut self.spare);
            }
        }
        self.numbers = reordered(&self.numbers, order);
        self.ids = reordered(&self.ids, order);
    }
}
