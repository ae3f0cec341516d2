//! The discs of a fast simulation: columns in the order of their cells, positions seen from the cells' centres.

use super::search::Search;
use super::{FastMd, carried};
use crate::io::checkpoint::Column;
use crate::method::lattice_md::{Discs, Model};
use crate::particles::{Kind, Particle, Particles};
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::gear::STATE;
use stripmine_kernels::isa::{Element, Storage};
use stripmine_kernels::sweep::fast::{self, SENTINELS};

/// A disc with the cell it goes to, its place there, seen from the cell's centre (length), and the periods that it crosses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Move {
    pub(super) disc: usize,
    pub(super) cell: [usize; 2],
    pub(super) place: [f64; 2],
    pub(super) periods: [f64; 2],
}

/// Columns with an entry a disc, grains first, and two discs behind them that never touch.
#[derive(Clone, Debug)]
pub(super) struct State<S> {
    /// Scaled derivatives: for each degree of freedom those that are carried from step to step.
    columns: Vec<Vec<Vec<S>>>,
    /// The radius of every disc (length), where they are alike.
    alike: Option<f64>,
    /// Radii, and inverse masses and moments of inertia, where discs vary.
    radius: Vec<S>,
    inverse: [Vec<S>; 2],
    /// Which of the scene's discs each is.
    numbers: Vec<u32>,
    grains: usize,
}

/// What a pass moves: columns, inverse masses and moments of inertia, and which of the scene's discs each is.
type Moved<'a, S> = (&'a mut [Vec<Vec<S>>], [&'a [S]; 2], &'a [u32]);

impl<S: Precision> State<S> {
    pub(super) fn new(model: &Model, particles: &Particles) -> Self {
        let discs = particles.all();
        let column = |value: &dyn Fn(&Particle) -> f64, sentinel: f64| -> Vec<S> {
            let values = discs.iter().map(value).chain(std::iter::repeat_n(sentinel, SENTINELS));
            values.map(S::from_f64).collect()
        };
        let derivative = |freedom: usize, k: usize| {
            let value = |disc: &Particle| match (k, freedom) {
                (1, 0 | 1) => disc.velocity[freedom] * model.dt,
                (0, 2) => disc.angle,
                (1, _) => disc.omega * model.dt,
                _ => 0.0,
            };
            column(&value, 0.0)
        };
        let mut columns: Vec<Vec<Vec<S>>> = (0..model.freedoms())
            .map(|freedom| (0..carried(model.scheme)).map(|k| derivative(freedom, k)).collect())
            .collect();
        // The sentinels stand farther apart than any contact reaches.
        let largest = particles.radii().map_or(1.0, |[_, largest]| largest);
        columns[0][0][discs.len()] = S::from_f64(8.0 * largest);
        let (mut radius, mut inverse) = (vec![], [vec![], vec![]]);
        if model.discs == Discs::Varying {
            let of_grain = |disc: &Particle, value: f64| if disc.kind == Kind::Wall { 0.0 } else { value };
            radius = column(&|disc| disc.radius, largest);
            inverse[0] = column(&|disc| of_grain(disc, 1.0 / disc.mass), 1.0);
            let inertia = |disc: &Particle| model.inertia_factor * disc.mass * disc.radius * disc.radius;
            inverse[1] = column(&|disc| of_grain(disc, 1.0 / inertia(disc)), 1.0);
        }
        let numbers = (0..discs.len() as u32).collect();
        let alike = match model.discs {
            Discs::Equal { disc, .. } => Some(disc.radius),
            Discs::Varying => None,
        };
        State { columns, alike, radius, inverse, numbers, grains: particles.grain_count() }
    }

    /// Which of the scene's discs a disc is.
    pub(super) fn number(&self, disc: usize) -> usize {
        self.numbers[disc] as usize
    }

    /// The carried derivatives of a disc, the others zero.
    pub(super) fn row(&self, freedom: usize, disc: usize) -> [S; 6] {
        let mut row = [S::default(); 6];
        row.iter_mut().zip(&self.columns[freedom]).for_each(|(q, column)| *q = column[disc]);
        row
    }

    /// The place of a disc, seen from the centre of its cell (length).
    pub(super) fn place(&self, disc: usize) -> [f64; 2] {
        [self.columns[0][0][disc].to_f64(), self.columns[1][0][disc].to_f64()]
    }

    /// The places of all discs and sentinels.
    pub(super) fn places(&self) -> [&[S]; 2] {
        [&self.columns[0][0], &self.columns[1][0]]
    }

    /// Puts a disc at a place.
    pub(super) fn put(&mut self, disc: usize, place: [f64; 2]) {
        (0..2).for_each(|axis| self.columns[axis][0][disc] = S::from_f64(place[axis]));
    }

    /// Gives all wall discs a velocity (length/time).
    pub(super) fn turn_walls(&mut self, velocity: [f64; 2], dt: f64) {
        let discs = self.numbers.len();
        (0..2).for_each(|axis| {
            self.columns[axis][1][self.grains..discs].fill(S::from_f64(velocity[axis] * dt))
        });
    }

    /// Radius of a disc (length).
    pub(super) fn radius(&self, disc: usize) -> f64 {
        self.alike.unwrap_or_else(|| self.radius[disc].to_f64())
    }

    /// Inverse masses or moments of inertia, for a degree of freedom.
    pub(super) fn inverse(&self, freedom: usize) -> &[S] {
        &self.inverse[freedom / 2]
    }

    /// Which of the scene's discs each is.
    pub(super) fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// What a pass moves.
    pub(super) fn for_advance(&mut self) -> Moved<'_, S> {
        (&mut self.columns, [&self.inverse[0], &self.inverse[1]], &self.numbers)
    }

    /// The discs as a sweep reads them.
    pub(super) fn discs(&self, model: &Model) -> fast::Discs<'_, S> {
        let omega = if model.friction { self.columns[2][1].as_slice() } else { &[] };
        fast::Discs {
            place: self.places(),
            velocity: [&self.columns[0][1], &self.columns[1][1], omega],
            per_time: 1.0 / model.dt,
            radius: &self.radius,
            inverse_mass: &self.inverse[0],
        }
    }

    /// Disc `n` is from now on what disc `order[n]` was.
    pub(super) fn renumber(&mut self, order: &[u32]) {
        let derivatives = self.columns.iter_mut().flatten();
        for column in derivatives.chain([&mut self.radius]).chain(&mut self.inverse) {
            if !column.is_empty() {
                let mut anew = Vec::with_capacity(column.len());
                anew.extend(order.iter().map(|&disc| column[disc as usize]));
                anew.extend_from_slice(&column[order.len()..]);
                *column = anew;
            }
        }
        self.numbers = order.iter().map(|&disc| self.numbers[disc as usize]).collect();
    }
}

/// A column in its precision, in the order of the scene's discs.
fn to_column<T: Element>(numbers: &[u32], value: impl Fn(usize) -> T) -> Column {
    let mut column = vec![0.0; numbers.len()];
    numbers.iter().enumerate().for_each(|(disc, &number)| column[number as usize] = value(disc).to_f64());
    match T::NAME {
        f64::NAME => Column::F64(column),
        _ => Column::F32(column.into_iter().map(|x| x as f32).collect()),
    }
}

const SUMS: [&str; 3] = ["Fx", "Fy", "torque"];
const CELL: [&str; 2] = ["cell.column", "cell.row"];
const MADE_AT: [&str; 2] = ["listed.x", "listed.y"];

impl<S: Precision, P: Precision, Q: Search<S, P>> FastMd<S, P, Q> {
    /// Where a disc is, seen from the origin (length), when it is at `place` in its cell.
    pub(super) fn position(&self, disc: usize, place: [f64; 2]) -> [f64; 2] {
        let frame = self.search.grid().frame;
        let cell = self.search.cell(disc).unwrap_or_default();
        [0, 1].map(|axis| frame.origin[axis] + (cell[axis] as f64 + 0.5) * frame.edge[axis] + place[axis])
    }

    /// All columns, in the order of the scene's discs.
    pub(super) fn columns(&self) -> Vec<(String, Column)> {
        let numbers = &self.state.numbers;
        let mut columns = Vec::new();
        for (names, rows) in STATE.iter().zip(&self.state.columns) {
            for (name, column) in names.iter().zip(rows) {
                columns.push((name.label().to_owned(), to_column(numbers, |disc| column[disc])));
            }
        }
        for (name, sum) in SUMS.iter().zip(&self.sums) {
            columns.push(((*name).to_owned(), to_column(numbers, |disc| sum[disc])));
        }
        for (axis, name) in CELL.iter().enumerate() {
            let cell = |disc| self.search.cell(disc).map_or(f64::NAN, |cell| cell[axis] as f64);
            columns.push(((*name).to_owned(), to_column(numbers, cell)));
        }
        if let Some(lists) = self.search.lists() {
            for (axis, name) in MADE_AT.iter().enumerate() {
                let made_at = lists.made_at(axis);
                columns.push(((*name).to_owned(), to_column(numbers, |disc| made_at[disc])));
            }
        }
        let crossings = self.crossings.columns().into_iter();
        columns.extend(crossings.map(|(name, counts)| (name.to_owned(), Column::F64(counts))));
        columns
    }

    /// Takes up columns that [`columns`](Self::columns) gave.
    pub(super) fn take_up(&mut self, columns: Vec<(String, Column)>) -> Result<(), String> {
        let numbers = self.state.numbers.clone();
        let find = |name: &str, precision: &str| -> Result<Vec<f64>, String> {
            let (_, column) = columns
                .iter()
                .find(|(there, _)| there == name)
                .ok_or_else(|| format!("the column {name} is missing"))?;
            let (found, values) = match column {
                Column::F64(values) => (f64::NAME, values.clone()),
                Column::F32(values) => (f32::NAME, values.iter().map(|&x| x.into()).collect()),
                Column::U32(_) | Column::U64(_) => ("whole numbers", vec![]),
            };
            if found != precision {
                return Err(format!("the column {name} has another precision"));
            }
            if values.len() != numbers.len() {
                return Err(format!("the column {name} has {} entries, not {}", values.len(), numbers.len()));
            }
            Ok(numbers.iter().map(|&number| values[number as usize]).collect())
        };
        let mut state = self.state.clone();
        for (names, rows) in STATE.iter().zip(&mut state.columns) {
            for (name, column) in names.iter().zip(rows) {
                let values = find(name.label(), S::NAME)?;
                column.iter_mut().zip(values).for_each(|(to, value)| *to = S::from_f64(value));
            }
        }
        let mut sums = self.sums.clone();
        for (name, sum) in SUMS.iter().zip(&mut sums) {
            *sum = find(name, P::NAME)?.into_iter().map(P::from_f64).collect();
        }
        let cells = [find(CELL[0], f64::NAME)?, find(CELL[1], f64::NAME)?];
        let counts = self.search.grid().counts;
        let inside = |axis: usize, &cell: &f64| (0.0..counts[axis] as f64).contains(&cell);
        if (0..2).any(|axis| !cells[axis].iter().all(|cell| inside(axis, cell))) {
            return Err("a cell lies outside the lattice".to_owned());
        }
        let made_at = match self.search.lists() {
            Some(_) => Some([find(MADE_AT[0], S::NAME)?, find(MADE_AT[1], S::NAME)?]),
            None => None,
        };
        self.crossings.take_up(|name| match columns.iter().find(|(known, _)| known == name) {
            Some((_, Column::F64(values))) => Ok(values.clone()),
            _ => Err(format!("the column {name} is missing")),
        })?;
        (0..numbers.len()).for_each(|disc| self.search.leave(disc));
        for (disc, (&column, &row)) in cells[0].iter().zip(&cells[1]).enumerate() {
            let cell = [column as usize, row as usize];
            let to = Move { disc, cell, place: state.place(disc), periods: [0.0; 2] };
            let entered = self.search.enter(&to, &state);
            entered.map_err(|_| "two discs are in one cell".to_owned())?;
        }
        self.search.arrange(&state);
        (self.state, self.sums) = (state, sums);
        // Lists are made of the places of then.
        let now: Vec<[f64; 2]> = (0..numbers.len()).map(|disc| self.state.place(disc)).collect();
        for (disc, axis) in (0..numbers.len()).flat_map(|disc| [(disc, 0), (disc, 1)]) {
            if let Some(made_at) = &made_at {
                self.state.columns[axis][0][disc] = S::from_f64(made_at[axis][disc]);
            }
        }
        let order = self.put_in_order();
        for (disc, before) in order.into_iter().enumerate() {
            self.state.put(disc, now[before as usize]);
        }
        Ok(())
    }
}
