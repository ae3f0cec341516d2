//! Accelerations of bodies, by interchangeable implementations of the same sums.

use super::bodies::{PointMasses, StateColumns};
use super::options::{ArithmeticKind, ForceEngine};
use super::ranked::ranked_sums;
use super::scene::NbodyScene;
use super::schemes::{AccelerationField, SchemeName};
use super::shifted::ShiftedPrograms;
use super::sums::{ForceSums, PrecisePositions, StopCallback, check_stop, displacement, precise_potential};
pub use super::sums::{never_stop, potential};
use super::swept::PairSweep;
use crate::method::{PhysicsFailure, reject_several_ranks};
use crate::ranks::RankError;
use crate::scene::Precision;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::sweep::all_pairs::Arithmetic;

/// Number of bodies from which the direct sums of a step run on threads: below, waking them takes longer.
const MANY: usize = 64;

/// Derivatives of the acceleration available to a start, including the acceleration itself.
const ORDERS: usize = 4;

/// Gravitational field of the bodies.
pub struct GravityField {
    softening: f64,
    constant: f64,
    mass: Vec<f64>,
    /// G m of each body.
    pull: Vec<f64>,
    /// G/m: converts sums of m₁ m₂ d/d³ to accelerations; 0 for padding without mass.
    per_mass: Vec<f64>,
    bodies: usize,
    pub(super) pairs: PairSummation,
    /// Number of evaluations of the accelerations.
    pub evaluations: u64,
}

/// Implementations of the pair sums.
pub(crate) enum PairSummation {
    /// Direct sum.
    Reference,
    /// Force sums in the scene's precision.
    Summed(Box<dyn ForceSums>),
}

/// Field during one step of a scheme.
pub struct StepField<'a> {
    attraction: &'a mut GravityField,
    /// True if the energy at the end of the step is needed.
    observed: bool,
    /// Energy at the end of the step, if it was summed with the forces.
    energy: Option<f64>,
    stop: StopCallback<'a>,
}

impl GravityField {
    /// Creates the field of a scene's bodies, on the current number of ranks.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if the bodies cannot be distributed to the number of ranks.
    pub fn new(scene: &NbodyScene, bodies: &PointMasses) -> Result<Self, PhysicsFailure> {
        if !matches!(scene.engine, ForceEngine::Fast | ForceEngine::Auto) {
            reject_several_ranks(match scene.scheme.is_adaptive() {
                true => "integrator.kind = \"ias15\" sums pair by pair, without bands of rows",
                false => "only machine.engine = \"fast\" has bands of rows",
            })?;
        }
        let arithmetic = match scene.arithmetic {
            ArithmeticKind::Exact => Arithmetic::Exact,
            ArithmeticKind::Estimated => Arithmetic::Estimated,
            ArithmeticKind::Raw => Arithmetic::Raw,
        };
        let set = scene.instructions();
        let (softening, execution) = (scene.softening, (scene.execution, set));
        let pairs = match (scene.engine, scene.precision) {
            (ForceEngine::Reference, _) => PairSummation::Reference,
            // The check has resolved `auto`.
            (ForceEngine::Fast | ForceEngine::Auto, Precision::F64) => {
                PairSummation::Summed(ranked_sums::<f64>(scene, bodies, arithmetic)?)
            }
            (ForceEngine::Fast | ForceEngine::Auto, _) => {
                PairSummation::Summed(ranked_sums::<f32>(scene, bodies, arithmetic)?)
            }
            (ForceEngine::Programs, Precision::F64) => {
                PairSummation::Summed(Box::new(ShiftedPrograms::<f64>::new(softening, bodies, execution)))
            }
            (ForceEngine::Programs, _) => {
                PairSummation::Summed(Box::new(ShiftedPrograms::<f32>::new(softening, bodies, execution)))
            }
        };
        let constant = scene.gravitational_constant;
        let per_mass = bodies.mass.iter().map(|&m| if m > 0.0 { constant / m } else { 0.0 }).collect();
        Ok(GravityField {
            softening: scene.softening,
            constant,
            mass: bodies.mass.clone(),
            pull: bodies.mass.iter().map(|m| constant * m).collect(),
            per_mass,
            bodies: bodies.len(),
            pairs,
            evaluations: 0,
        })
    }

    /// Memory of the field of a scene with `count` bodies, in bytes.
    pub fn bytes(scene: &NbodyScene, count: usize) -> usize {
        let has_rates = scene.scheme == SchemeName::Hermite4;
        let pairs = match (scene.engine, scene.precision) {
            (ForceEngine::Reference, _) => 0,
            (ForceEngine::Fast | ForceEngine::Auto, Precision::F64) => {
                PairSweep::<f64>::bytes(count, has_rates)
            }
            (ForceEngine::Fast | ForceEngine::Auto, _) => PairSweep::<f32>::bytes(count, has_rates),
            (ForceEngine::Programs, Precision::F64) => ShiftedPrograms::<f64>::bytes(count, has_rates),
            (ForceEngine::Programs, _) => ShiftedPrograms::<f32>::bytes(count, has_rates),
        };
        pairs + 3 * size_of::<f64>() * count
    }

    /// Returns the lost rank, if any.
    pub fn lost(&self) -> Option<RankError> {
        match &self.pairs {
            PairSummation::Reference => None,
            PairSummation::Summed(sums) => sums.lost(),
        }
    }

    /// Returns the field for one step; `observed` requests the energy at its end, `stop` may interrupt it.
    pub fn for_step<'a>(&'a mut self, observed: bool, stop: StopCallback<'a>) -> StepField<'a> {
        StepField { attraction: self, observed, energy: None, stop }
    }

    /// Energy of all pairs, at positions that the direct sum takes with their low parts, if they have any.
    ///
    /// # Errors
    /// [`ProgramError`] if the processor lacks the instruction set, or `stop` returns true.
    pub fn potential(
        &mut self,
        position: &StateColumns,
        low: Option<&StateColumns>,
        stop: StopCallback<'_>,
    ) -> Result<f64, ProgramError> {
        let energy = match &mut self.pairs {
            PairSummation::Reference => {
                precise_potential(&self.mass[..self.bodies], (position, low), self.softening, stop)
            }
            PairSummation::Summed(sums) => sums.sum(position, None, true, stop),
        };
        energy.map(|energy| self.constant * energy)
    }

    /// Acceleration of a body: the direct sum in the order of the bodies.
    fn direct_sum(&self, (position, low): PrecisePositions<'_>, body: usize) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for other in (0..self.bodies).filter(|&other| other != body) {
            let displacement = displacement((position, low), body, other);
            let squares = displacement.iter().map(|d| d * d);
            let square = squares.sum::<f64>() + self.softening * self.softening;
            let pull = self.pull[other] / (square * square.sqrt());
            (0..3).for_each(|axis| sum[axis] += pull * displacement[axis]);
        }
        sum
    }

    /// Direct sums of all bodies, on threads where there are many.
    fn direct_sums(
        &self,
        positions: PrecisePositions<'_>,
        into: &mut StateColumns,
        stop: StopCallback<'_>,
    ) -> Result<(), ProgramError> {
        let of = |body: usize| check_stop(stop).map(|()| self.direct_sum(positions, body));
        let mut put = |body: usize, sum: [f64; 3]| (0..3).for_each(|axis| into[axis][body] = sum[axis]);
        if self.bodies < MANY {
            return (0..self.bodies).try_for_each(|body| of(body).map(|sum| put(body, sum)));
        }
        let sums: Vec<[f64; 3]> = (0..self.bodies).into_par_iter().map(of).collect::<Result<_, _>>()?;
        sums.into_iter().enumerate().for_each(|(body, sum)| put(body, sum));
        Ok(())
    }

    /// Derivatives of the acceleration at a start, order by order, from Taylor series of the positions and pairs. The sums of the bodies
    /// are independent and run on threads.
    fn series(
        &self,
        position: &StateColumns,
        velocity: &StateColumns,
        orders: &mut [StateColumns],
        stop: StopCallback<'_>,
    ) -> Result<(), ProgramError> {
        let count = self.bodies;
        // Taylor coefficients of every position.
        let mut path = vec![[[0.0; ORDERS + 2]; 3]; count];
        for (body, path) in path.iter_mut().enumerate() {
            for axis in 0..3 {
                path[axis][0] = position[axis][body];
                path[axis][1] = velocity[axis][body];
            }
        }
        let mut factorial = 1.0;
        for (order, into) in orders.iter_mut().enumerate().take(ORDERS) {
            factorial *= if order > 0 { order as f64 } else { 1.0 };
            let of = |body: usize| check_stop(stop).map(|()| self.coefficient(&path, body, order));
            let found: Vec<[f64; 3]> = (0..count).into_par_iter().map(of).collect::<Result<_, _>>()?;
            for (body, found) in found.iter().enumerate() {
                for axis in 0..3 {
                    into[axis][body] = factorial * found[axis];
                    path[body][axis][order + 2] = found[axis] / ((order + 1) * (order + 2)) as f64;
                }
            }
        }
        Ok(())
    }

    /// Taylor coefficient of an order of a body's acceleration.
    fn coefficient(&self, path: &[[[f64; ORDERS + 2]; 3]], body: usize, order: usize) -> [f64; 3] {
        let mut found = [0.0; 3];
        for other in (0..path.len()).filter(|&other| other != body) {
            let displacement: [[f64; ORDERS]; 3] =
                std::array::from_fn(|axis| {
                    std::array::from_fn(|k| {
                        if k <= order { path[other][axis][k] - path[body][axis][k] } else { 0.0 }
                    })
                });
            let mut square = [0.0; ORDERS];
            square[0] = self.softening * self.softening;
            for along in &displacement {
                for k in 0..=order {
                    square[k] += (0..=k).map(|i| along[i] * along[k - i]).sum::<f64>();
                }
            }
            let cube = power(&square, -1.5, order);
            for axis in 0..3 {
                let term: f64 = (0..=order).map(|i| displacement[axis][i] * cube[order - i]).sum();
                found[axis] += self.pull[other] * term;
            }
        }
        found
    }
}

/// Power of a series, up to an order.
fn power(of: &[f64; ORDERS], exponent: f64, order: usize) -> [f64; ORDERS] {
    let mut result = [0.0; ORDERS];
    result[0] = of[0].powf(exponent);
    for k in 1..=order {
        let terms = (1..=k).map(|i| ((exponent + 1.0) * i as f64 / k as f64 - 1.0) * of[i] * result[k - i]);
        result[k] = terms.sum::<f64>() / of[0];
    }
    result
}

impl StepField<'_> {
    /// Energy of all pairs at the positions at the end of the step.
    ///
    /// # Errors
    /// As [`GravityField::potential`].
    pub fn energy(
        &mut self,
        position: &StateColumns,
        low: Option<&StateColumns>,
    ) -> Result<f64, ProgramError> {
        self.energy.take().map_or_else(|| self.attraction.potential(position, low, self.stop), Ok)
    }

    fn acceleration_and(
        &mut self,
        position: &StateColumns,
        into: &mut StateColumns,
        observed: bool,
    ) -> Result<Option<f64>, ProgramError> {
        let StepField { attraction, stop, .. } = self;
        attraction.evaluations += 1;
        let GravityField { pairs: PairSummation::Summed(sums), per_mass, constant, .. } = &mut **attraction
        else {
            return attraction.direct_sums((position, None), into, stop).map(|()| None);
        };
        let energy = sums.sum(position, None, observed, stop)?;
        sums.over(per_mass, [Some(into), None]);
        Ok(observed.then_some(*constant * energy))
    }
}

impl AccelerationField for StepField<'_> {
    fn acceleration(&mut self, position: &StateColumns, into: &mut StateColumns) -> Result<(), ProgramError> {
        self.acceleration_and(position, into, false).map(drop)
    }

    fn last_acceleration(
        &mut self,
        position: &StateColumns,
        into: &mut StateColumns,
    ) -> Result<(), ProgramError> {
        self.energy = self.acceleration_and(position, into, self.observed)?;
        Ok(())
    }

    fn precise_acceleration(
        &mut self,
        position: &StateColumns,
        low: &StateColumns,
        into: &mut StateColumns,
    ) -> Result<(), ProgramError> {
        self.attraction.evaluations += 1;
        self.attraction.direct_sums((position, Some(low)), into, self.stop)
    }

    fn derivatives(
        &mut self,
        position: &StateColumns,
        velocity: &StateColumns,
        orders: &mut [StateColumns],
    ) -> Result<(), ProgramError> {
        let StepField { attraction, stop, .. } = self;
        attraction.evaluations += 1;
        match (&mut **attraction, orders) {
            (GravityField { pairs: PairSummation::Summed(sums), per_mass, .. }, [acceleration, jerk]) => {
                sums.sum(position, Some(velocity), false, stop)?;
                sums.over(per_mass, [Some(acceleration), Some(jerk)]);
                Ok(())
            }
            (attraction, orders) => attraction.series(position, velocity, orders, stop),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::options::StartKind;
    use super::super::schemes::AccelerationField as _;
    use super::super::starts::initial_bodies;
    use super::*;
    use crate::method::nbody::bodies::zeros;
    use stripmine_kernels::Execution;

    /// The series derivatives match finite differences of the acceleration along the path, and the sweep's jerk.
    #[test]
    fn derivatives_match_the_motion() {
        let mut scene = NbodyScene { softening: 0.2, gravitational_constant: 3.7, ..NbodyScene::default() };
        (scene.start.kind, scene.start.count) = (StartKind::Plummer, 12);
        let of = initial_bodies(&scene.start, 0.2, 1.0);
        let all = PointMasses::new(of.iter().map(|&(m, r, v)| (r, v, m)));
        let mut field = GravityField::new(&scene, &all).unwrap();
        let mut orders: Vec<StateColumns> = (0..ORDERS).map(|_| zeros(all.entries())).collect();
        field.for_step(false, &never_stop).derivatives(&all.position, &all.velocity, &mut orders).unwrap();
        // Along the Taylor path the acceleration has these derivatives.
        let h = 0.004;
        let at = |time: f64| {
            let mut position = all.position.clone();
            for axis in 0..3 {
                for body in 0..all.len() {
                    let mut term = time * time / 2.0;
                    position[axis][body] += time * all.velocity[axis][body];
                    for (order, column) in orders.iter().enumerate() {
                        position[axis][body] += term * column[axis][body];
                        term *= time / (order + 3) as f64;
                    }
                }
            }
            position
        };
        let mut acceleration = |time: f64| {
            let mut into = zeros(all.entries());
            field.for_step(false, &never_stop).acceleration(&at(time), &mut into).unwrap();
            into
        };
        let seen: Vec<StateColumns> = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| acceleration(k * h)).to_vec();
        let mut fast = [zeros(all.entries()), zeros(all.entries())];
        field.for_step(false, &never_stop).derivatives(&all.position, &all.velocity, &mut fast).unwrap();
        let mut programs = [zeros(all.entries()), zeros(all.entries())];
        let mut field =
            GravityField::new(&NbodyScene { engine: ForceEngine::Programs, ..scene.clone() }, &all).unwrap();
        field.for_step(false, &never_stop).derivatives(&all.position, &all.velocity, &mut programs).unwrap();
        for axis in 0..3 {
            for body in 0..all.len() {
                let a: Vec<f64> = seen.iter().map(|column| column[axis][body]).collect();
                let found = [0, 1, 2, 3].map(|order| orders[order][axis][body]);
                let expected = [
                    a[2],
                    (a[0] - 8.0 * a[1] + 8.0 * a[3] - a[4]) / (12.0 * h),
                    (-a[0] + 16.0 * a[1] - 30.0 * a[2] + 16.0 * a[3] - a[4]) / (12.0 * h * h),
                    (-a[0] + 2.0 * a[1] - 2.0 * a[3] + a[4]) / (2.0 * h * h * h),
                ];
                for (order, tolerance) in [1e-12, 1e-6, 1e-5, 2e-3].into_iter().enumerate() {
                    let scale = orders[order][axis].iter().fold(1.0, |most: f64, x| most.max(x.abs()));
                    assert!(
                        (found[order] - expected[order]).abs() < tolerance * scale,
                        "{order}: {found:?} {expected:?}"
                    );
                }
                for jerk in [&fast[1], &programs[1]] {
                    assert!((jerk[axis][body] - found[1]).abs() < 1e-12 * (1.0 + found[1].abs()));
                }
            }
        }
    }

    /// The reference and all other engines agree within their precision.
    #[test]
    fn force_engines_agree() {
        let mut scene = NbodyScene { softening: 0.05, gravitational_constant: 0.31, ..NbodyScene::default() };
        (scene.start.kind, scene.start.count) = (StartKind::Plummer, 301);
        let of = initial_bodies(&scene.start, 0.05, 1.0);
        let all = PointMasses::new(of.iter().map(|&(m, r, v)| (r, v, m)));
        let found = |engine, execution, precision, arithmetic| {
            let scene = NbodyScene { engine, execution, precision, arithmetic, ..scene.clone() };
            let mut field = GravityField::new(&scene, &all).unwrap();
            let mut into = zeros(all.entries());
            field.for_step(false, &never_stop).acceleration(&all.position, &mut into).unwrap();
            (into, field.potential(&all.position, None, &never_stop).unwrap())
        };
        let (expected, potential) =
            found(ForceEngine::Reference, Execution::Chained, Precision::F64, ArithmeticKind::Exact);
        let largest = expected.iter().flatten().fold(0.0, |most: f64, a| most.max(a.abs()));
        for (precision, arithmetic, tolerance) in [
            (Precision::F64, ArithmeticKind::Exact, 1e-14),
            (Precision::F64, ArithmeticKind::Estimated, 1e-14),
            (Precision::Mixed, ArithmeticKind::Exact, 3e-6),
            (Precision::Mixed, ArithmeticKind::Estimated, 3e-6),
        ] {
            for engine in [ForceEngine::Fast, ForceEngine::Programs] {
                let (into, energy) = found(engine, Execution::Chained, precision, arithmetic);
                for (a, b) in into.iter().zip(&expected) {
                    assert!(
                        a.iter().zip(b).take(all.len()).all(|(a, b)| (a - b).abs() < tolerance * largest)
                    );
                }
                assert!((energy / potential - 1.0).abs() < tolerance, "{energy} {potential}");
            }
        }
        // The programs give the same bits in every execution.
        let by = |execution| found(ForceEngine::Programs, execution, Precision::F64, ArithmeticKind::Exact);
        let chained = by(Execution::Chained);
        assert!([Execution::Eager, Execution::Strip(64)].into_iter().all(|other| by(other) == chained));
    }
}
