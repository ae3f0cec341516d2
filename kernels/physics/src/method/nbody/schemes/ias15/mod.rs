//! IAS15 (Rein and Spiegel 2015): Gauss–Radau integrator of order 15 whose steps adapt so that its errors are below rounding.
//!
//! A step is an implicit Runge–Kutta step: accelerations at eight nodes define a polynomial, whose integrals give the positions at the nodes, until
//! nothing changes. Its last coefficient over the acceleration sets the length of the next step. Positions and velocities have low parts below
//! their rounding, which forces use: in an encounter, differences of positions stay accurate. Steps know nothing of output: the bodies take the
//! state that the polynomial has at the requested time, and no request changes a later bit.

mod radau;
#[cfg(test)]
mod tests;

use super::{
    AccelerationField, AdaptiveSteps, BodyIntegrator, IntegrationError, PointMasses, StateColumns, padded,
    resize_columns,
};
use crate::method::nbody::encounter::{NearestPair, NearestPairSearch};
use radau::{COEFFICIENTS, NODES, continued, divided_difference, integrals, newton_of, powers_of, two_sum};
use stripmine_kernels::isa::ProgramError;

/// Factor by which a step may grow.
const GROWTH: f64 = 4.0;
/// Factor below which a step is rejected. Rein and Spiegel accept down to 0.25, at which the end of a step is accurate, but not its middle.
const SHRINK: f64 = 0.7;
/// Factor of a step whose accelerations are not finite or do not settle.
const RETREAT: f64 = 0.125;
/// Iterations of a step at most, and fewest before one that gains nothing is the last.
const ITERATIONS: usize = 12;
const FEWEST: usize = 2;
/// Change of the last coefficient over the acceleration: that of settled iterations, and the largest of an accepted step.
const SETTLED: f64 = 1e-16;
const UNSETTLED: f64 = 1e-10;
/// Ratio of successive steps above which the polynomial of the last step predicts nothing.
const FAR: f64 = 20.0;

/// Polynomials of the accelerations of all bodies: coefficients of the powers.
type Polynomials = [StateColumns; COEFFICIENTS];

/// Time and lengths of steps, all carried between steps.
#[derive(Clone, Copy, Debug, Default)]
struct StepClock {
    /// Time at the beginning of the present step, and its low part.
    time: f64,
    time_low: f64,
    /// Length of the present step; 0 before the first.
    length: f64,
    /// Length of the next step.
    next: f64,
    /// Output intervals done.
    outputs: f64,
    accepted: f64,
    rejected: f64,
    /// Length of the shortest accepted step.
    shortest: f64,
}

/// Adaptive integrator of order 15.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ias15 {
    tolerance: f64,
    clock: StepClock,
    /// Positions and velocities at the beginning of the present step, their low parts, and accelerations.
    position: StateColumns,
    position_low: StateColumns,
    velocity: StateColumns,
    velocity_low: StateColumns,
    acceleration: StateColumns,
    /// Polynomials of the present step, and their prediction from the step before.
    powers: Polynomials,
    predicted: Polynomials,
    /// Low parts of the positions of the bodies.
    output_low: StateColumns,
    /// Positions at a node with their low parts, and accelerations there.
    node: [StateColumns; 3],
    newton: Polynomials,
    /// Polynomials of the last step and their prediction, from which rejected steps are predicted again.
    last: [Polynomials; 2],
    encounters: NearestPairSearch,
    /// Nearest pair at the ends of steps in the last output interval.
    nearest: Option<NearestPair>,
}

/// Product of two numbers, and its rounding error.
fn two_product(a: f64, b: f64) -> [f64; 2] {
    let product = a * b;
    [product, a.mul_add(b, -product)]
}

/// Sum of two numbers with low parts.
fn add_low([high, low]: [f64; 2], [more, more_low]: [f64; 2]) -> [f64; 2] {
    let [sum, error] = two_sum(high, more);
    two_sum(sum, error + (low + more_low))
}

fn coefficients(of: &Polynomials, axis: usize, body: usize) -> [f64; COEFFICIENTS] {
    std::array::from_fn(|k| of[k][axis][body])
}

fn set_coefficients(of: &mut Polynomials, axis: usize, body: usize, values: [f64; COEFFICIENTS]) {
    of.iter_mut().zip(values).for_each(|(columns, value)| columns[axis][body] = value);
}

/// Largest magnitude of the first `count` entries; NaN if one is NaN.
fn largest(columns: &StateColumns, count: usize) -> f64 {
    let all = columns.iter().flat_map(|column| &column[..count]);
    all.fold(0.0, |largest: f64, value| if value.abs() <= largest { largest } else { value.abs() })
}

impl Ias15 {
    /// Creates the integrator; `tolerance` is the largest ratio of the last coefficient to the acceleration.
    pub(crate) fn new(tolerance: f64) -> Self {
        Ias15 { tolerance, ..Ias15::default() }
    }

    /// Takes the bodies as the beginning of the first step, and chooses its length from the derivatives of the accelerations.
    fn begin(&mut self, bodies: &PointMasses, field: &mut dyn AccelerationField) -> Result<(), ProgramError> {
        let of_motion = [&mut self.position_low, &mut self.velocity_low, &mut self.acceleration];
        let of_steps = self.powers.iter_mut().chain(&mut self.predicted).chain(&mut self.newton);
        let of_last = self.last.iter_mut().flatten().chain(&mut self.node);
        for columns in of_motion.into_iter().chain(of_steps).chain(of_last).chain([&mut self.output_low]) {
            resize_columns(columns, bodies);
        }
        if self.clock.length > 0.0 {
            return Ok(());
        }
        self.position.clone_from(&bodies.position);
        self.velocity.clone_from(&bodies.velocity);
        let mut orders: Vec<StateColumns> = vec![self.acceleration.clone(); 3];
        field.derivatives(&bodies.position, &bodies.velocity, &mut orders)?;
        // Time scale √(2 a² / (a'² + a a'')) of the fastest body, and the step at which the tolerance is expected (Pham, Rein and Spiegel 2024).
        let size = |order: usize, body: usize| -> f64 {
            (0..3).map(|axis| orders[order][axis][body].powi(2)).sum::<f64>().sqrt()
        };
        let scale = (0..bodies.len()).map(|body| {
            let [a, jerk, snap] = [0, 1, 2].map(|order| size(order, body));
            (2.0 * a * a / (jerk * jerk + a * snap)).sqrt()
        });
        let least = scale.filter(|scale| scale.is_finite() && *scale > 0.0).fold(f64::INFINITY, f64::min);
        let scale = if least.is_finite() { least } else { 1.0 };
        self.clock.next = scale * libm::pow(5040.0 * self.tolerance, 1.0 / 7.0);
        Ok(())
    }

    /// Position and velocity of a body after a part `s` of the present step of length `h`, each with its low part.
    fn state_at(&self, s: f64, h: f64, axis: usize, body: usize) -> [[f64; 2]; 2] {
        let powers = coefficients(&self.powers, axis, body);
        let part = h * s;
        let ([mean, mean_low], drift) = integrals(self.acceleration[axis][body], &powers, s, h);
        let [kick, kick_low] = two_product(part, mean);
        let velocity = [self.velocity[axis][body], self.velocity_low[axis][body]];
        let [moved, moved_low] = two_product(part, velocity[0]);
        let moved = add_low([moved, moved_low], [drift, part * velocity[1]]);
        [
            add_low([self.position[axis][body], self.position_low[axis][body]], moved),
            add_low(velocity, [kick, kick_low + part * mean_low]),
        ]
    }

    /// Moves the beginning of the step to its end.
    fn finish(&mut self, count: usize) {
        let h = self.clock.length;
        for axis in 0..3 {
            for body in 0..count {
                let [[x, x_low], [v, v_low]] = self.state_at(1.0, h, axis, body);
                (self.position[axis][body], self.position_low[axis][body]) = (x, x_low);
                (self.velocity[axis][body], self.velocity_low[axis][body]) = (v, v_low);
            }
        }
        let clock = &mut self.clock;
        [clock.time, clock.time_low] = add_low([clock.time, clock.time_low], [h, 0.0]);
        let found = self.encounters.nearest(&self.position, count);
        let known = self.nearest.map_or(f64::INFINITY, |known| known.distance);
        self.nearest = found.filter(|found| found.distance < known).or(self.nearest);
    }

    /// Predicts the polynomials of a step of length `h` after the last one.
    fn predict(&mut self, h: f64, count: usize) {
        let ratio = h / self.clock.length;
        let is_known = self.clock.length > 0.0 && ratio <= FAR;
        let [last, last_predicted] = &self.last;
        for axis in 0..3 {
            for body in 0..count {
                let (mut powers, mut predicted) = ([0.0; COEFFICIENTS], [0.0; COEFFICIENTS]);
                if is_known {
                    let old = coefficients(last, axis, body);
                    let missed = coefficients(last_predicted, axis, body);
                    predicted = continued(&old, ratio);
                    // The last prediction was off by as much.
                    powers = std::array::from_fn(|k| predicted[k] + (old[k] - missed[k]));
                }
                set_coefficients(&mut self.predicted, axis, body, predicted);
                set_coefficients(&mut self.powers, axis, body, powers);
                set_coefficients(&mut self.newton, axis, body, newton_of(&powers));
            }
        }
    }

    /// Corrects the polynomials until they settle. Returns the ratio of the last coefficient to the acceleration; NaN if they do not settle.
    fn correct(
        &mut self,
        h: f64,
        count: usize,
        field: &mut dyn AccelerationField,
    ) -> Result<f64, ProgramError> {
        let (mut before, mut size) = (f64::INFINITY, f64::NAN);
        for iteration in 0..ITERATIONS {
            let mut change = 0.0;
            for node in 1..NODES.len() {
                for axis in 0..3 {
                    for body in 0..count {
                        let [[x, low], _] = self.state_at(NODES[node], h, axis, body);
                        (self.node[0][axis][body], self.node[1][axis][body]) = (x, low);
                    }
                }
                let [position, low, acceleration] = &mut self.node;
                field.precise_acceleration(position, low, acceleration)?;
                for axis in 0..3 {
                    for body in 0..count {
                        let mut newton = coefficients(&self.newton, axis, body);
                        let changed = self.node[2][axis][body] - self.acceleration[axis][body];
                        let now = divided_difference(node, changed, &newton);
                        if node == COEFFICIENTS {
                            let by = (now - newton[node - 1]).abs();
                            change = if by <= change { change } else { by };
                        }
                        newton[node - 1] = now;
                        self.newton[node - 1][axis][body] = now;
                        set_coefficients(&mut self.powers, axis, body, powers_of(&newton));
                    }
                }
            }
            size = largest(&self.node[2], count);
            let ratio = if size > 0.0 { change / size } else { change };
            if ratio.is_nan() || ratio < SETTLED || iteration >= FEWEST && ratio >= before {
                before = before.min(ratio);
                break;
            }
            before = ratio;
        }
        let last = largest(&self.powers[COEFFICIENTS - 1], count);
        let ratio = if size > 0.0 { last / size } else { last };
        Ok(if before < UNSETTLED { ratio } else { f64::NAN })
    }

    /// Makes a step from its beginning, as often as it is rejected.
    fn solve(&mut self, count: usize, field: &mut dyn AccelerationField) -> Result<(), IntegrationError> {
        field.precise_acceleration(&self.position, &self.position_low, &mut self.acceleration)?;
        loop {
            let h = self.clock.next;
            if !(self.clock.time + h > self.clock.time && h.is_normal()) {
                return Err(IntegrationError::Unresolved { time: self.clock.time, step: h });
            }
            self.predict(h, count);
            let ratio = self.correct(h, count, field)?;
            let factor = match ratio {
                _ if !ratio.is_finite() => RETREAT,
                _ => libm::pow(self.tolerance / ratio, 1.0 / 7.0).min(GROWTH),
            };
            self.clock.next = factor * h;
            if factor < SHRINK {
                self.clock.rejected += 1.0;
                continue;
            }
            self.clock.accepted += 1.0;
            self.clock.length = h;
            self.clock.shortest = if self.clock.accepted == 1.0 { h } else { self.clock.shortest.min(h) };
            return Ok(());
        }
    }
}

impl BodyIntegrator for Ias15 {
    fn step(
        &mut self,
        bodies: &mut PointMasses,
        dt: f64,
        field: &mut dyn AccelerationField,
    ) -> Result<(), IntegrationError> {
        let count = bodies.len();
        self.begin(bodies, field)?;
        self.nearest = None;
        let target = (self.clock.outputs + 1.0) * dt;
        while self.clock.length == 0.0 || self.clock.time + self.clock.length < target {
            if self.clock.length > 0.0 {
                self.finish(count);
                self.last = [self.powers.clone(), self.predicted.clone()];
            }
            if let Err(failure) = self.solve(count, field) {
                bodies.position.clone_from(&self.position);
                bodies.velocity.clone_from(&self.velocity);
                return Err(failure);
            }
        }
        let StepClock { time, time_low, length, .. } = self.clock;
        let s = (((target - time) - time_low) / length).min(1.0);
        for axis in 0..3 {
            for body in 0..count {
                let [[x, low], [v, _]] = self.state_at(s, length, axis, body);
                (bodies.position[axis][body], bodies.velocity[axis][body]) = (x, v);
                self.output_low[axis][body] = low;
            }
        }
        self.clock.outputs += 1.0;
        Ok(())
    }

    fn order(&self) -> u32 {
        15
    }

    fn carried_columns(&self) -> Vec<&StateColumns> {
        if self.clock.length == 0.0 {
            return vec![];
        }
        let of_motion = [&self.position, &self.position_low, &self.velocity, &self.velocity_low];
        let of_step = [&self.acceleration, &self.output_low].into_iter().chain(&self.powers);
        of_motion.into_iter().chain(of_step).chain(&self.predicted).collect()
    }

    fn carries(&self) -> usize {
        6 + 2 * COEFFICIENTS
    }

    fn take_up(&mut self, bodies: &PointMasses, carried: Vec<StateColumns>) {
        let of_motion =
            [&mut self.position, &mut self.position_low, &mut self.velocity, &mut self.velocity_low];
        let of_step = [&mut self.acceleration, &mut self.output_low].into_iter().chain(&mut self.powers);
        let all = of_motion.into_iter().chain(of_step).chain(&mut self.predicted);
        all.zip(carried).for_each(|(own, columns)| *own = padded(columns, bodies));
    }

    fn carried_numbers(&self) -> Vec<(&'static str, f64)> {
        let StepClock { time, time_low, length, next, outputs, accepted, rejected, shortest } = self.clock;
        vec![
            ("step.time", time),
            ("step.time_low", time_low),
            ("step.length", length),
            ("step.next", next),
            ("step.outputs", outputs),
            ("step.accepted", accepted),
            ("step.rejected", rejected),
            ("step.shortest", shortest),
        ]
    }

    fn take_up_numbers(&mut self, numbers: &[f64]) {
        if let &[time, time_low, length, next, outputs, accepted, rejected, shortest] = numbers {
            self.clock = StepClock { time, time_low, length, next, outputs, accepted, rejected, shortest };
        }
    }

    fn check_numbers(&self, intervals: u64, dt: f64) -> Result<(), String> {
        let StepClock { time, length, next, outputs, .. } = self.clock;
        let now = intervals as f64 * dt;
        let is_begun = length > 0.0 && next > 0.0 && time >= 0.0 && time <= now && now <= time + length;
        match outputs == intervals as f64 && (is_begun || intervals == 0 && length == 0.0) {
            true => Ok(()),
            false => Err(format!("a step of {length} from time {time} does not contain the time {now}")),
        }
    }

    fn position_low(&self) -> Option<&StateColumns> {
        (self.clock.length > 0.0).then_some(&self.output_low)
    }

    fn adaptive_steps(&self) -> Option<AdaptiveSteps> {
        let StepClock { accepted, rejected, shortest, .. } = self.clock;
        Some(AdaptiveSteps {
            accepted: accepted as u64,
            rejected: rejected as u64,
            shortest,
            tolerance: self.tolerance,
            nearest: self.nearest,
        })
    }
}
