//! Bodies as columns.

use stripmine_kernels::sweep::all_pairs::{padded, padding};

/// A quantity along three axes, an entry for every body and padding.
pub(crate) type Columns = [Vec<f64>; 3];

/// Columns of zeros for `entries` bodies.
pub fn zeros(entries: usize) -> Columns {
    [0, 1, 2].map(|_| vec![0.0; entries])
}

/// `to += factor · of`, for every entry.
pub(crate) fn add(to: &mut Columns, factor: f64, of: &Columns) {
    for (to, of) in to.iter_mut().zip(of) {
        to.iter_mut().zip(of).for_each(|(to, of)| *to += factor * of);
    }
}

/// Point masses in space. Behind the last there are entries without mass, far from the others, up to whole groups.
#[derive(Clone, Debug, PartialEq)]
pub struct Bodies {
    count: usize,
    /// Positions (length).
    pub position: Columns,
    /// Velocities (length/time).
    pub velocity: Columns,
    /// Masses.
    pub mass: Vec<f64>,
}

impl Bodies {
    /// Bodies at places (length) with velocities (length/time) and masses.
    pub fn new(bodies: impl ExactSizeIterator<Item = ([f64; 3], [f64; 3], f64)>) -> Self {
        let count = bodies.len();
        let entries = padded(count);
        let mut made =
            Bodies { count, position: zeros(entries), velocity: zeros(entries), mass: vec![0.0; entries] };
        for (n, (position, velocity, mass)) in bodies.enumerate() {
            made.mass[n] = mass;
            for axis in 0..3 {
                made.position[axis][n] = position[axis];
                made.velocity[axis][n] = velocity[axis];
            }
        }
        // Padding has no mass and no velocity: no step moves it.
        made.position[0][count..].iter_mut().enumerate().for_each(|(n, x)| *x = padding(n));
        made
    }

    /// How many there are, without the padding.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Entries of a column.
    pub fn entries(&self) -> usize {
        self.mass.len()
    }

    /// The position of a body (length).
    pub(crate) fn position_of(&self, body: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.position[axis][body])
    }

    /// The velocity of a body (length/time).
    pub(crate) fn velocity_of(&self, body: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.velocity[axis][body])
    }

    /// The first body whose position or velocity is no finite number, and how many there are.
    pub fn not_finite(&self) -> Option<(usize, usize)> {
        let columns = || self.position.iter().chain(&self.velocity);
        let is_bad = |body: &usize| columns().any(|column| !column[*body].is_finite());
        let mut bad = (0..self.count).filter(is_bad);
        let first = bad.next()?;
        Some((first, 1 + bad.count()))
    }
}
