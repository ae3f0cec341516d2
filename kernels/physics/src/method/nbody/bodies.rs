//! Column storage of bodies.

use stripmine_kernels::sweep::all_pairs::{padded_length, padding_position};

/// Quantity along three axes, with an entry for every body and padding.
pub(crate) type StateColumns = [Vec<f64>; 3];

/// Returns columns of `entries` zeros.
pub fn zeros(entries: usize) -> StateColumns {
    [0, 1, 2].map(|_| vec![0.0; entries])
}

/// Adds `factor · of` to every entry of `to`.
pub(crate) fn add(to: &mut StateColumns, factor: f64, of: &StateColumns) {
    for (to, of) in to.iter_mut().zip(of) {
        to.iter_mut().zip(of).for_each(|(to, of)| *to += factor * of);
    }
}

/// Point masses in space, padded to whole groups by distant entries without mass.
#[derive(Clone, Debug, PartialEq)]
pub struct PointMasses {
    count: usize,
    /// Positions (length).
    pub position: StateColumns,
    /// Velocities (length/time).
    pub velocity: StateColumns,
    /// Masses.
    pub mass: Vec<f64>,
}

impl PointMasses {
    /// Creates bodies from positions (length), velocities (length/time) and masses.
    pub fn new(bodies: impl ExactSizeIterator<Item = ([f64; 3], [f64; 3], f64)>) -> Self {
        let count = bodies.len();
        let entries = padded_length(count);
        let mut made = PointMasses {
            count,
            position: zeros(entries),
            velocity: zeros(entries),
            mass: vec![0.0; entries],
        };
        for (n, (position, velocity, mass)) in bodies.enumerate() {
            made.mass[n] = mass;
            for axis in 0..3 {
                made.position[axis][n] = position[axis];
                made.velocity[axis][n] = velocity[axis];
            }
        }
        // Padding has no mass and no velocity, so no step moves it.
        made.position[0][count..].iter_mut().enumerate().for_each(|(n, x)| *x = padding_position(n));
        made
    }

    /// Number of bodies, without padding.
    pub fn len(&self) -> usize {
        self.count
    }

    /// True if there are no bodies.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Number of entries of a column.
    pub fn entries(&self) -> usize {
        self.mass.len()
    }

    /// Position of a body (length).
    pub(crate) fn position_of(&self, body: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.position[axis][body])
    }

    /// Velocity of a body (length/time).
    pub(crate) fn velocity_of(&self, body: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.velocity[axis][body])
    }

    /// First body whose position or velocity is not finite, and the number of such bodies.
    pub fn not_finite(&self) -> Option<(usize, usize)> {
        let columns = || self.position.iter().chain(&self.velocity);
        let is_bad = |body: &usize| columns().any(|column| !column[*body].is_finite());
        let mut bad = (0..self.count).filter(is_bad);
        let first = bad.next()?;
        Some((first, 1 + bad.count()))
    }
}
