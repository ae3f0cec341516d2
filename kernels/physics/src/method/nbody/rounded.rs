//! Bodies in the precision of a sweep. In single precision they are relative to their centre and in scaled units.

use super::bodies::{PointMasses, StateColumns};
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::AlignedColumn;
use stripmine_kernels::isa::aligned_column::column_memory;
use stripmine_kernels::sweep::all_pairs::{self, is_split, padding_position};

/// Distance from the mean, in units of length, beyond which bodies count as escaped. Escaped bodies must not move the origin to where
/// the number format is coarse for the others.
const FAR: f64 = 1024.0;

/// Units of a sweep: powers of two, so that scaling is exact; 1 in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SweepUnits {
    length: f64,
    mass: f64,
}

impl SweepUnits {
    /// Chooses the units. In single precision the heaviest body has a mass of 1 to 2, and the root mean square distance from the mean is
    /// 1 to 2: products of masses and cubes of distances then neither underflow nor overflow. If a few bodies are far away, the
    /// median distance is used instead.
    fn of<P: Precision>(bodies: &PointMasses) -> SweepUnits {
        if P::BYTES == size_of::<f64>() {
            return SweepUnits { length: 1.0, mass: 1.0 };
        }
        let (position, count) = (&bodies.position, bodies.len());
        let heaviest = bodies.mass[..count].iter().copied().fold(0.0, f64::max);
        let distances = |about: [f64; 3]| {
            let square = move |body: usize| {
                (0..3).map(|axis| (position[axis][body] - about[axis]).powi(2)).sum::<f64>()
            };
            (0..count).map(square)
        };
        let size = (distances(mean(position, count)).sum::<f64>() / count as f64).sqrt();
        let typical = median(distances(medians(position, count)).collect()).sqrt();
        let size = if typical > 0.0 && size > FAR * typical { typical } else { size };
        SweepUnits { length: power_of_two(size), mass: power_of_two(heaviest) }
    }

    /// Converts a length to these units.
    pub(super) fn length(self, length: f64) -> f64 {
        length / self.length
    }

    /// Unit of force.
    pub(super) fn force(self) -> f64 {
        (self.mass / self.length).powi(2)
    }

    /// Unit of the rate of a force; velocities are not scaled.
    pub(super) fn force_rate(self) -> f64 {
        self.force() / self.length
    }

    /// Unit of energy.
    pub(super) fn energy(self) -> f64 {
        self.mass * self.mass / self.length
    }
}

/// Largest power of two not above a number; 1 if there is none.
fn power_of_two(number: f64) -> f64 {
    if number.is_normal() { libm::scalbn(1.0, libm::ilogb(number)) } else { 1.0 }
}

/// Mean of the first entries.
fn mean(columns: &StateColumns, count: usize) -> [f64; 3] {
    columns.each_ref().map(|column| column[..count].iter().sum::<f64>() / count as f64)
}

/// Median of the first entries.
fn medians(columns: &StateColumns, count: usize) -> [f64; 3] {
    columns.each_ref().map(|column| median(column[..count].to_vec()))
}

/// Upper median; 0 without numbers.
fn median(mut numbers: Vec<f64>) -> f64 {
    match numbers.len() {
        0 => 0.0,
        count => *numbers.select_nth_unstable_by(count / 2, f64::total_cmp).1,
    }
}

/// Columns of bodies in precision `P`, repeated as often as a sweep needs.
pub(super) struct RoundedBodies<P> {
    pub(super) units: SweepUnits,
    /// Number of bodies, and of entries including padding.
    sizes: [usize; 2],
    pub(super) position: [AlignedColumn<P>; 3],
    /// Remainder of the positions after rounding to single precision; empty in double precision.
    pub(super) rest: [AlignedColumn<P>; 3],
    pub(super) velocity: [AlignedColumn<P>; 3],
    pub(super) mass: AlignedColumn<P>,
}

impl<P: Precision> RoundedBodies<P> {
    /// Creates columns of `entries` bodies (padding included), repeated `times` times.
    pub(super) fn new(bodies: &PointMasses, entries: usize, times: usize) -> Self {
        let units = SweepUnits::of::<P>(bodies);
        let columns = |first: usize, entries: usize| {
            [0, 1, 2].map(|axis| AlignedColumn::zeros(first + axis, times * entries))
        };
        let mass = bodies.mass[..entries].iter().map(|m| P::from_f64(m / units.mass));
        let mass = (0..times).flat_map(|_| mass.clone());
        RoundedBodies {
            units,
            sizes: [bodies.len(), entries],
            position: columns(0, entries),
            rest: columns(3, if is_split::<P>() { entries } else { 0 }),
            velocity: columns(6, entries),
            mass: AlignedColumn::new(9, mass),
        }
    }

    /// Memory of the columns in bytes.
    pub(super) fn bytes(entries: usize, times: usize) -> usize {
        let columns = if is_split::<P>() { 10 } else { 7 };
        columns * column_memory((P::BYTES * entries * times) as f64) as usize
    }

    /// Converts positions and, if given, velocities.
    pub(super) fn convert_bodies(&mut self, position: &StateColumns, velocity: Option<&StateColumns>) {
        let [count, entries] = self.sizes;
        if !is_split::<P>() {
            let velocity = velocity.into_iter().flatten();
            let columns =
                self.position.iter_mut().zip(position).chain(self.velocity.iter_mut().zip(velocity));
            columns.for_each(|(to, from)| fill(to, &from[..entries], P::from_f64));
            return;
        }
        self.place_about(position, mean(position, count));
        let is_far = |x: &P| x.to_f64().abs() > FAR;
        let has_far =
            self.position.iter().any(|column| column[..count].iter().filter(|x| is_far(x)).count() > 0);
        if has_far {
            self.place_about(position, medians(position, count));
        }
        for (n, entry) in (count..entries).enumerate() {
            self.position[0][entry] = padding_position(n);
            self.rest[0][entry] = P::default();
        }
        // A common velocity has no effect on relative motion.
        if let Some(velocity) = velocity {
            let drift = if has_far { medians(velocity, count) } else { mean(velocity, count) };
            for ((to, from), drift) in self.velocity.iter_mut().zip(velocity).zip(drift) {
                fill(to, &from[..entries], |v| P::from_f64(v - drift));
            }
        }
    }

    /// Converts positions relative to an origin (length), and stores the remainders of rounding.
    fn place_about(&mut self, position: &StateColumns, about: [f64; 3]) {
        let ([_, entries], units) = (self.sizes, self.units);
        for (axis, from) in position.iter().enumerate() {
            let place = |x: f64| units.length(x - about[axis]);
            let rest = |x: f64| P::from_f64(place(x) - P::from_f64(place(x)).to_f64());
            fill(&mut self.position[axis], &from[..entries], |x| P::from_f64(place(x)));
            fill(&mut self.rest[axis], &from[..entries], rest);
        }
    }

    /// Borrows the columns as input of a sweep over all pairs.
    pub(super) fn bodies(&self) -> all_pairs::BodyColumns<'_, P> {
        all_pairs::BodyColumns {
            position: self.position.each_ref().map(|column| &**column),
            rest: self.rest.each_ref().map(|column| &**column),
            velocity: self.velocity.each_ref().map(|column| &**column),
            mass: &self.mass,
        }
    }
}

/// Fills every copy of a column.
fn fill<P>(to: &mut [P], from: &[f64], of: impl Fn(f64) -> P) {
    for copy in to.chunks_exact_mut(from.len().max(1)) {
        copy.iter_mut().zip(from).for_each(|(to, &from)| *to = of(from));
    }
}
