//! A pair potential given by rows of distance and energy.

use super::potential::PairPotential;
use super::{Env, LawTable};
use crate::isa::Vector;

/// Smallest number of rows: slopes are those of polynomials through five.
const FEWEST: usize = 5;
/// Largest number of intervals: single precision numbers them exactly, with digits left.
const MOST: usize = 65_536;
/// Distance of a row from its place among equally spaced ones, relative to their gap, up to which it counts as there.
const EQUAL: f64 = 1e-6;
/// Row of pairs beyond the end.
const BEYOND: [f64; LawTable::COLUMNS] = [0.0; LawTable::COLUMNS];

/// Pair potential through rows of r and U, cubic in each interval, with a continuous force (piecewise cubic Hermite).
///
/// The slope at a row is that of the polynomial of fourth order through the five nearest rows. It needs no condition at the ends,
/// unlike a natural spline, whose U″ = 0 there costs two orders. So the error of U falls as h⁴ and that of F as h³, h being the
/// distance of rows. Rows at unequal distances are first interpolated so, then taken at equal distances, as many as the smallest gap
/// fits.
///
/// U is shifted to 0 at the last row and stays 0 beyond. Below the first row there is no potential: sweeps give NaN there, and
/// [`energy`](PairPotential::energy) and [`force`](PairPotential::force) are infinite.
///
/// # Examples
/// A parabola is met exactly:
/// ```
/// use stripmine_kernels::law::potential::PairPotential;
/// use stripmine_kernels::law::tabulated::Tabulated;
///
/// let rows: Vec<[f64; 2]> = (0..=8).map(|row| f64::from(row) / 4.0).map(|r| [r, (2.0 - r) * (2.0 - r)]).collect();
/// let potential = Tabulated::new(&rows)?;
/// assert!((potential.energy(0.9) - 1.21).abs() < 1e-14 && (potential.force(0.9) - 2.2).abs() < 1e-13);
/// assert!((potential.curvature(0.9) - 2.0).abs() < 1e-12 && potential.energy(3.0) == 0.0);
/// # Ok::<(), stripmine_kernels::law::tabulated::TabulatedError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// First and last distance (length).
    ends: [f64; 2],
    /// Width of an interval (length), and intervals per length.
    width: f64,
    per_length: f64,
    /// A row for each interval: U at its beginning, and the coefficients of F as a polynomial of the fraction of the interval. A row of zeros
    /// follows, for pairs beyond the end.
    table: LawTable,
}

/// Reason why rows are no potential; rows are numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TabulatedError {
    /// Too few rows.
    #[error("the table has {0} rows; expected at least 5")]
    TooFew(usize),
    /// A number that is not finite, or a negative distance.
    #[error("r = {r} and U = {energy}; expected finite numbers, and r >= 0")]
    NotFinite {
        /// Number of the row.
        row: usize,
        /// Distance.
        r: f64,
        /// Energy.
        energy: f64,
    },
    /// A distance that is not larger than the one before.
    #[error("r = {r} after {before}; expected r to rise from row to row")]
    NotIncreasing {
        /// Number of the row.
        row: usize,
        /// Distance.
        r: f64,
        /// Distance of the row before.
        before: f64,
    },
    /// A gap that is too small beside the length of the table.
    #[error(
        "r is {gap} beyond the row before; expected gaps of at least the length {length} of the table over 65 536"
    )]
    TooUneven {
        /// Number of the row.
        row: usize,
        /// Distance to the row before.
        gap: f64,
        /// Last distance minus the first.
        length: f64,
    },
}

/// No energy up to a distance of 1.
impl Default for Tabulated {
    fn default() -> Self {
        let table = LawTable::new(vec![BEYOND; 2]);
        Tabulated { ends: [0.0, 1.0], width: 1.0, per_length: 1.0, table }
    }
}

impl Tabulated {
    /// Potential through rows of distance (length) and energy, by rising distance.
    ///
    /// # Errors
    /// [`TabulatedError`] names the first row that does not fit.
    pub fn new(rows: &[[f64; 2]]) -> Result<Tabulated, TabulatedError> {
        if rows.len() < FEWEST {
            return Err(TabulatedError::TooFew(rows.len()));
        }
        for (row, &[r, energy]) in rows.iter().enumerate() {
            if !(r.is_finite() && energy.is_finite() && r >= 0.0) {
                return Err(TabulatedError::NotFinite { row, r, energy });
            }
            if let Some(&[before, _]) = row.checked_sub(1).map(|before| &rows[before])
                && r <= before
            {
                return Err(TabulatedError::NotIncreasing { row, r, before });
            }
        }
        let ends = [rows[0][0], rows[rows.len() - 1][0]];
        let length = ends[1] - ends[0];
        let gap = |row: usize| rows[row][0] - rows[row - 1][0];
        let mean = length / (rows.len() - 1) as f64;
        let is_at = |row: usize| (rows[row][0] - (ends[0] + row as f64 * mean)).abs() <= EQUAL * mean;
        let is_even = (0..rows.len()).all(is_at);
        let row = (2..rows.len()).fold(1, |least, row| if gap(row) < gap(least) { row } else { least });
        let intervals = if is_even { rows.len() - 1 } else { (length / gap(row)).ceil() as usize };
        if intervals > MOST {
            return Err(TabulatedError::TooUneven { row, gap: gap(row), length });
        }
        let last = rows[rows.len() - 1][1];
        let shifted: Vec<[f64; 2]> = rows.iter().map(|[r, energy]| [*r, energy - last]).collect();
        let knots: Vec<[f64; 3]> =
            shifted.iter().enumerate().map(|(row, &[r, energy])| [r, energy, slope(&shifted, row)]).collect();
        let width = length / intervals as f64;
        let at = |knot: usize| match is_even {
            true => knots[knot],
            false => between(&knots, ends[0] + knot as f64 * width),
        };
        let interval = |number: usize| {
            let [[_, left, from], [_, right, to]] = [at(number), at(number + 1)];
            let rise = (right - left) / width;
            [left, -from, -2.0 * (3.0 * rise - (2.0 * from + to)), -3.0 * (from + to - 2.0 * rise)]
        };
        let table = LawTable::new((0..intervals).map(interval).chain([BEYOND]).collect());
        Ok(Tabulated { ends, width, per_length: intervals as f64 / length, table })
    }

    /// Distances of the first and the last row (length).
    pub fn ends(&self) -> [f64; 2] {
        self.ends
    }

    /// The potential times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Tabulated {
        let rows = self.table.rows().iter().map(|row| row.map(|number| factor * number));
        Tabulated { table: LawTable::new(rows.collect()), ..self.clone() }
    }

    /// Rows of the intervals.
    fn intervals(&self) -> &[[f64; LawTable::COLUMNS]] {
        let rows = self.table.rows();
        &rows[..rows.len() - 1]
    }

    /// Coefficients of the interval of a distance, and the fraction of the interval; none outside the table.
    fn interval(&self, distance: f64) -> Option<([f64; LawTable::COLUMNS], f64)> {
        let along = (distance - self.ends[0]) * self.per_length;
        let rows = self.intervals();
        let number = (along as usize).min(rows.len() - 1);
        (distance >= self.ends[0] && distance < self.ends[1]).then(|| (rows[number], along - number as f64))
    }

    /// Value within the table, and otherwise the limit below or 0 beyond it.
    fn value(&self, distance: f64, of: impl Fn([f64; LawTable::COLUMNS], f64) -> f64) -> f64 {
        match self.interval(distance) {
            Some((row, part)) => of(row, part),
            None if distance < self.ends[0] => f64::INFINITY,
            None => 0.0,
        }
    }
}

impl PairPotential for Tabulated {
    fn energy(&self, distance: f64) -> f64 {
        self.value(distance, |[energy, a, b, c], part| {
            energy - self.width * part * (a + part * (0.5 * b + part * (c / 3.0)))
        })
    }

    fn force(&self, distance: f64) -> f64 {
        self.value(distance, |[_, a, b, c], part| a + part * (b + part * c))
    }

    fn curvature(&self, distance: f64) -> f64 {
        self.value(distance, |[_, _, b, c], part| -(b + 2.0 * part * c) * self.per_length)
    }

    type Shared<V: Vector> = [V; 5];

    #[inline(always)]
    fn swept_force<E: Env<2>>(&self, env: E, square: E::V) -> (E::V, [E::V; 5]) {
        let distance = square.sqrt();
        // Pairs beyond the end read the row of zeros.
        let last = env.uniform(self.table.rows().len() as f64 + 0.5);
        let along = (distance - env.uniform(self.ends[0])) * env.uniform(self.per_length) + env.uniform(1.0);
        let along = along.min(last);
        let number = along.truncate();
        let part = along - number;
        let [a, b, c] = env.lookup(&self.table, [1, 2, 3], number);
        let force = c.times_plus(part, b).times_plus(part, a);
        (force / distance, [number, part, a, b, c])
    }

    #[inline(always)]
    fn swept_energy<E: Env<2>>(&self, env: E, [number, part, a, b, c]: [E::V; 5]) -> E::V {
        let [energy] = env.lookup(&self.table, [0], number);
        let (half, third) = (b * env.uniform(0.5), c * env.uniform(1.0 / 3.0));
        let mean = third.times_plus(part, half).times_plus(part, a);
        mean.times_from(part * env.uniform(self.width), energy)
    }

    fn table(&self) -> Option<&LawTable> {
        Some(&self.table)
    }

    fn stiffness(&self, nearest: f64) -> f64 {
        let first = ((nearest - self.ends[0]) * self.per_length).max(0.0) as usize;
        let ends = |[_, _, b, c]: &[f64; LawTable::COLUMNS]| b.abs().max((b + 2.0 * c).abs());
        self.intervals().iter().skip(first).map(ends).fold(0.0, f64::max) * self.per_length
    }

    /// Distance at which a pair that comes from beyond the table turns; the first row if it passes all of them, 0 if that is at 0.
    fn closest(&self, energy: f64) -> f64 {
        let Some(number) = self.intervals().iter().rposition(|row| row[0] >= energy) else {
            return self.ends[0];
        };
        let end = |number: usize| self.ends[0] + number as f64 * self.width;
        let (mut near, mut far) = (end(number), end(number + 1).min(self.ends[1]));
        loop {
            let middle = 0.5 * (near + far);
            if middle <= near || middle >= far {
                return middle;
            }
            if self.energy(middle) < energy { far = middle } else { near = middle }
        }
    }
}

/// Slope at a row of the polynomial through the five nearest rows, by Lagrange.
fn slope(rows: &[[f64; 2]], row: usize) -> f64 {
    let first = row.saturating_sub(FEWEST / 2).min(rows.len() - FEWEST);
    let (near, own) = (&rows[first..first + FEWEST], row - first);
    let away = |from: usize, to: usize| near[from][0] - near[to][0];
    // As differences from the own energy, which a constant does not change.
    let weight = |other: usize| {
        let rest = || (0..FEWEST).filter(|&it| it != other && it != own);
        let product: f64 = rest().map(|it| away(own, it) / away(other, it)).product();
        product / away(other, own)
    };
    let others = (0..FEWEST).filter(|&other| other != own);
    others.map(|other| weight(other) * (near[other][1] - near[own][1])).sum()
}

/// Distance, energy and slope between knots of unequal distances.
fn between(knots: &[[f64; 3]], distance: f64) -> [f64; 3] {
    let right = knots.partition_point(|knot| knot[0] <= distance).clamp(1, knots.len() - 1);
    let [[near, left, from], [far, high, to]] = [knots[right - 1], knots[right]];
    let (width, part) = (far - near, (distance - near) / (far - near));
    let rise = (high - left) / width;
    let [b, c] = [3.0 * rise - 2.0 * from - to, from + to - 2.0 * rise];
    let energy = left + width * part * (from + part * (b + part * c));
    [distance, energy, from + part * (2.0 * b + 3.0 * part * c)]
}
