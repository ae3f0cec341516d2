//! Bodies under way, observed.

use super::benches::QUANTITIES;
use super::bodies::Bodies;
use super::conserved::Conserved;
use super::field::Attraction;
use super::prepared::Checked;
use super::schemes::Scheme;
use crate::io::checkpoint::Column;
use crate::method::observed::place;
use crate::method::{Clock, Culprit, Failure, FailureKind, RunWarning, Simulation, Snapshot, Until};
use crate::number::significant;
use crate::particles::{Particles, in_plane};
use serde_json::{Map, Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Bodies are looked at this often (steps), and so few of them at every step, whether they are still bound.
const BETWEEN_LOOKS: u64 = 64;
const FEW: usize = 64;

/// How often forces were found, in a checkpoint and in the summary.
const EVALUATIONS: &str = "evaluations";

const COLUMNS: [&str; 6] = ["x", "y", "z", "vx", "vy", "vz"];

/// Bodies under way.
pub(super) struct Running {
    dt: f64,
    bodies: Bodies,
    scheme: Box<dyn Scheme>,
    /// Observing needs the energy of the pairs, which is found as forces are.
    field: RefCell<Attraction>,
    particles: Particles,
    steps: u64,
    /// Energy at the start.
    energy: f64,
    seconds: f64,
}

impl Running {
    /// At the start.
    ///
    /// # Errors
    /// [`Failure`] if the processor lacks what is asked for.
    pub(super) fn new(checked: &Checked) -> Result<Running, Failure> {
        let scene = &checked.scene;
        let all = checked.particles.all();
        let bodies = Bodies::new(all.iter().map(|body| (body.position, body.velocity, body.mass)));
        let field = Attraction::new(scene, &bodies);
        let mut running = Running {
            dt: scene.dt,
            scheme: scene.scheme.scheme(scene.damping),
            field: RefCell::new(field),
            particles: checked.particles.clone(),
            steps: 0,
            energy: 0.0,
            seconds: 0.0,
            bodies,
        };
        running.energy = running.conserved()?.energy();
        Ok(running)
    }

    fn conserved(&self) -> Result<Conserved, Failure> {
        let potential = self.field.borrow_mut().potential(&self.bodies.position)?;
        Ok(Conserved::of(&self.bodies, potential))
    }

    fn culprit(&self, body: usize) -> Culprit {
        Culprit {
            id: self.particles.all()[body].id,
            position: in_plane(self.bodies.position_of(body)),
            velocity: in_plane(self.bodies.velocity_of(body)),
        }
    }

    fn step(&mut self) -> Result<(), Failure> {
        self.scheme.step(&mut self.bodies, self.dt, self.field.get_mut())?;
        self.steps += 1;
        if let Some((first, count)) = self.bodies.not_finite() {
            let culprit = self.culprit(first);
            let message = format!("{count} bodies are at no finite place, first body {}", culprit.id);
            let remedy =
                "the time step is too long for how near bodies come: take a smaller dt, or a softening";
            return Err(Failure::new(FailureKind::NotFinite, message, remedy)
                .at(self.clock())
                .of(count as u64, [culprit]));
        }
        if self.energy < 0.0 && (self.bodies.len() <= FEW || self.steps.is_multiple_of(BETWEEN_LOOKS)) {
            let energy = self.conserved()?.energy();
            if energy >= 0.0 {
                let message = format!(
                    "bodies that were bound are not any more: the energy was {} and is {energy}",
                    significant(self.energy, 5),
                    energy = significant(energy, 5)
                );
                let remedy =
                    "the integrator loses the orbit: take a smaller dt, another integrator, or a softening";
                let failure = Failure::new(FailureKind::Unbound, message, remedy).at(self.clock());
                return Err(failure.with([("energy", energy), ("energy_at_start", self.energy)]));
            }
        }
        Ok(())
    }
}

impl Simulation for Running {
    fn advance(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), Failure> {
        let begun = Instant::now();
        while !until.iter().any(|moment| moment.has_come(&self.clock())) {
            if interrupted.load(Ordering::Relaxed) {
                break;
            }
            self.step()?;
        }
        self.seconds += begun.elapsed().as_secs_f64();
        Ok(())
    }

    fn clock(&self) -> Clock {
        Clock { steps: self.steps, time: self.steps as f64 * self.dt, events: 0 }
    }

    fn particles(&self) -> Particles {
        let mut particles = self.particles.clone();
        for (number, body) in particles.all_mut().iter_mut().enumerate() {
            body.position = self.bodies.position_of(number);
            body.velocity = self.bodies.velocity_of(number);
        }
        particles
    }

    fn observe(&self) -> Vec<f64> {
        let seen = self.conserved().unwrap_or_default();
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut around: Vec<(f64, f64)> = (0..self.bodies.len())
            .map(|body| {
                let place = self.bodies.position_of(body);
                let way = [0, 1, 2].map(|axis| place[axis] - seen.centre[axis]);
                (length(way), self.bodies.mass[body])
            })
            .collect();
        around.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half = 0.5 * around.iter().map(|(_, mass)| mass).sum::<f64>();
        let mut inside = 0.0;
        let half_mass = around.iter().find(|(_, mass)| {
            inside += mass;
            inside >= half
        });
        let [jx, jy, jz] = seen.angular_momentum;
        vec![
            self.clock().time,
            seen.kinetic,
            seen.potential,
            if self.energy != 0.0 { seen.energy() / self.energy - 1.0 } else { 0.0 },
            if seen.potential != 0.0 { seen.kinetic / seen.potential.abs() } else { 0.0 },
            length(seen.momentum),
            jx,
            jy,
            jz,
            length(seen.centre),
            seen.energy() - self.energy,
            half_mass.map_or(0.0, |(radius, _)| *radius),
        ]
    }

    fn snapshot(&self) -> Snapshot {
        let count = self.bodies.len();
        let state = self.bodies.position.iter().chain(&self.bodies.velocity);
        let named = COLUMNS.iter().map(|name| (*name).to_owned());
        let carried = self.scheme.carried();
        let carried = carried.iter().enumerate().flat_map(|(order, columns)| {
            columns.iter().enumerate().map(move |(axis, column)| (format!("carried.{order}.{axis}"), column))
        });
        let mut kept = Snapshot::default();
        for (name, column) in named.zip(state).chain(carried) {
            kept.add_column(&name, Column::F64(column.iter().take(count).copied().collect()));
        }
        kept.add_sum("energy", self.energy);
        kept.add_count(EVALUATIONS, self.field.borrow().evaluations);
        kept
    }

    fn restore(&mut self, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        clock.of_steps(self.dt)?;
        let count = self.bodies.len();
        let find = |name: &str| snapshot.numbers(name, count);
        let (energy, evaluations) = (snapshot.sum("energy")?, snapshot.count(EVALUATIONS)?);
        let state = self.bodies.position.iter_mut().chain(&mut self.bodies.velocity);
        for (name, column) in COLUMNS.into_iter().zip(state) {
            column[..count].copy_from_slice(find(name)?);
        }
        // Before the first step nothing is carried.
        let orders = if clock.steps == 0 { 0 } else { self.scheme.carries() };
        let mut carried = vec![];
        for order in 0..orders {
            let [x, y, z] =
                [0, 1, 2].map(|axis| find(&format!("carried.{order}.{axis}")).map(<[f64]>::to_vec));
            carried.push([x?, y?, z?]);
        }
        self.scheme.take_up(&self.bodies, carried);
        self.field.get_mut().evaluations = evaluations;
        (self.energy, self.steps) = (energy, clock.steps);
        Ok(())
    }

    fn phases(&self) -> BTreeMap<&'static str, f64> {
        BTreeMap::from([("steps", self.seconds)])
    }

    fn reset_phases(&mut self) {
        self.seconds = 0.0;
    }

    fn work(&self) -> f64 {
        (self.bodies.len() as f64).powi(2) * self.field.borrow().evaluations as f64
    }

    fn summary(&self) -> Map<String, Value> {
        let seen = self.conserved().unwrap_or_default();
        let entries = [
            ("bodies", json!(self.bodies.len())),
            ("energy", json!(seen.energy())),
            ("energy_error", json!(if self.energy != 0.0 { seen.energy() / self.energy - 1.0 } else { 0.0 })),
            (EVALUATIONS, json!(self.field.borrow().evaluations)),
            ("order", json!(self.scheme.order())),
        ];
        entries.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }

    fn warnings(&self) -> Vec<RunWarning> {
        const MOST: f64 = 0.01;
        let error = self.observe()[const { place(QUANTITIES, "energy_error") }];
        let message = format!(
            "the energy is off by {:.2} % of itself: take a smaller dt or an integrator of higher order",
            100.0 * error
        );
        let is_damped = self.scheme.drains();
        let warning = RunWarning { check: "energy-balance", value: error.abs(), limit: MOST, message };
        if error.abs() > MOST && !is_damped { vec![warning] } else { vec![] }
    }

    fn in_words(&self) -> String {
        const SAID: [usize; 3] = [
            place(QUANTITIES, "energy_error"),
            place(QUANTITIES, "virial_ratio"),
            place(QUANTITIES, "momentum"),
        ];
        let seen = self.observe();
        let [energy_error, virial_ratio, momentum] = SAID.map(|at| seen[at]);
        format!(
            "{} bodies; energy error {}, virial ratio {:.3}, momentum {}",
            self.bodies.len(),
            significant(energy_error, 3),
            virial_ratio,
            significant(momentum, 2)
        )
    }
}
