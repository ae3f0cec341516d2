//! Changes that a user makes during a run. A change restarts the integrator, or the search for events, at the state of that moment.

use super::{PhysicsFailure, Snapshot};
use crate::particles::{ParticleKind, Particles};
use crate::reported::{ErrorClass, Reported};
use crate::words::{Words, define_words};

define_words! {
    /// Quantities that may be changed during a run.
    pub enum SteeredQuantity {
        /// Velocities of all particles (length/time).
        Velocities = "velocities",
        /// Angular velocities of all particles (1/time).
        AngularVelocities = "angular_velocities",
        /// Temperature kT of the bath (energy).
        BathTemperature = "bath_temperature",
        /// Acceleration of gravity (length/time²).
        Gravity = "gravity",
        /// Velocities of the scene's `[[walls]]`, without oscillations (length/time).
        WallVelocities = "wall_velocities",
    }
}

impl SteeredQuantity {
    /// Shape of the values for a number of particles in two or three dimensions, and a number of `[[walls]]`.
    pub fn shape(self, particles: usize, dimensions: usize, walls: usize) -> Vec<usize> {
        match self {
            SteeredQuantity::Velocities => vec![particles, dimensions],
            SteeredQuantity::AngularVelocities => vec![particles],
            SteeredQuantity::BathTemperature => vec![],
            SteeredQuantity::Gravity => vec![2],
            SteeredQuantity::WallVelocities => vec![walls, 2],
        }
    }
}

/// New values of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The quantity.
    pub quantity: SteeredQuantity,
    /// Its values, the last axis first.
    pub values: Vec<f64>,
}

/// Reason why a change was not made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SteeringError {
    /// The simulation is as before.
    #[error("{reason}\n  help: {remedy}")]
    Refused {
        /// Reason.
        reason: String,
        /// Remedy.
        remedy: String,
    },
    /// The simulation cannot continue.
    #[error(transparent)]
    Failed(#[from] PhysicsFailure),
}

impl SteeringError {
    /// Refusal of a change, with a remedy.
    pub fn refused(reason: impl Into<String>, remedy: impl Into<String>) -> SteeringError {
        SteeringError::Refused { reason: reason.into(), remedy: remedy.into() }
    }
}

impl Reported for SteeringError {
    fn class(&self) -> ErrorClass {
        match self {
            SteeringError::Refused { .. } => ErrorClass::Usage,
            SteeringError::Failed(failure) => failure.class(),
        }
    }

    fn inner_error(&self) -> Option<&dyn Reported> {
        match self {
            SteeringError::Refused { .. } => None,
            SteeringError::Failed(failure) => Some(failure),
        }
    }
}

impl Change {
    /// Checks the values against the present particles and the number of `[[walls]]`.
    ///
    /// # Errors
    /// Refusal that names the first value that is not finite, or moves a wall disc.
    pub(crate) fn check(&self, particles: &Particles, walls: usize) -> Result<(), SteeringError> {
        let Change { quantity, values } = self;
        let (name, count) = (quantity.word(), particles.len());
        if *quantity == SteeredQuantity::WallVelocities {
            if walls == 0 {
                let remedy = "start another scene with [[walls]]";
                return Err(SteeringError::refused(
                    format!("the scene has no [[walls]], so no {name}"),
                    remedy,
                ));
            }
            if values.len() != 2 * walls {
                let reason = format!("{name} has {} values, which do not fit {walls} walls", values.len());
                let remedy = "give one row [x, y] for each table [[walls]], in their order";
                return Err(SteeringError::refused(reason, remedy));
            }
        }
        let size = |it: &usize| quantity.shape(count, *it, walls).iter().product::<usize>();
        let fits = [2, 3].iter().any(|it| size(it) == values.len());
        if !fits {
            let reason = format!("{name} has {} values, which do not fit {count} particles", values.len());
            return Err(SteeringError::refused(
                reason,
                "give one row for each particle, in the order of the particles",
            ));
        }
        let width = match quantity {
            SteeredQuantity::Velocities => (values.len() / count.max(1)).max(1),
            SteeredQuantity::WallVelocities => 2,
            _ => 1,
        };
        let place = |at: usize| match quantity {
            SteeredQuantity::BathTemperature => name.to_owned(),
            SteeredQuantity::Velocities | SteeredQuantity::WallVelocities => {
                format!("{name}[{}, {}]", at / width, at % width)
            }
            _ => format!("{name}[{at}]"),
        };
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            let reason = format!("{} is {}", place(at), values[at]);
            return Err(SteeringError::refused(reason, "give finite numbers"));
        }
        if *quantity == SteeredQuantity::BathTemperature && values[0] < 0.0 {
            return Err(SteeringError::refused(
                format!("{name} is {}", values[0]),
                "give a temperature of 0 or more",
            ));
        }
        let now = |at: usize, axis: usize| match quantity {
            SteeredQuantity::Velocities => particles.all()[at].velocity[axis],
            _ => particles.all()[at].omega,
        };
        let is_of_particles =
            matches!(quantity, SteeredQuantity::Velocities | SteeredQuantity::AngularVelocities);
        let of_walls = (0..values.len())
            .filter(|at| is_of_particles && particles.all()[at / width].kind == ParticleKind::Wall);
        match of_walls.into_iter().find(|&at| values[at] != now(at / width, at % width)) {
            None => Ok(()),
            Some(at) => {
                let disc = &particles.all()[at / width];
                let reason = format!("{} = {} moves disc {}, a wall disc", place(at), values[at], disc.id);
                Err(SteeringError::refused(
                    reason,
                    format!("leave its value, {}", now(at / width, at % width)),
                ))
            }
        }
    }

    /// Velocity along x, y and z, and angular velocity, of each particle after the change.
    pub(crate) fn motion_of(&self, particles: &Particles) -> Vec<([f64; 3], f64)> {
        let all = particles.all();
        let mut motion: Vec<([f64; 3], f64)> = all.iter().map(|it| (it.velocity, it.omega)).collect();
        match self.quantity {
            SteeredQuantity::Velocities if !all.is_empty() => {
                let rows = self.values.chunks_exact(self.values.len() / all.len());
                motion
                    .iter_mut()
                    .zip(rows)
                    .for_each(|((velocity, _), row)| velocity[..row.len()].copy_from_slice(row));
            }
            SteeredQuantity::AngularVelocities => {
                motion.iter_mut().zip(&self.values).for_each(|((_, omega), value)| *omega = *value);
            }
            _ => {}
        }
        motion
    }

    /// Velocities of the walls, if they change (length/time).
    pub(crate) fn wall_velocities(&self) -> Option<Vec<[f64; 2]>> {
        let rows = || self.values.chunks_exact(2).map(|row| [row[0], row[1]]).collect();
        (self.quantity == SteeredQuantity::WallVelocities).then(rows)
    }

    /// Values of gravity, if it changes.
    pub(crate) fn gravity(&self) -> Option<[f64; 2]> {
        (self.quantity == SteeredQuantity::Gravity).then(|| [self.values[0], self.values[1]])
    }
}

/// Changes so far, as far as the future depends on them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Steering {
    /// Gravity instead of the scene's (length/time²).
    pub(crate) gravity: Option<[f64; 2]>,
    /// Temperature of the bath instead of the scene's (energy).
    pub(crate) bath_temperature: Option<f64>,
    /// Work of all changes (energy): what they have added to the energy of the particles.
    pub(crate) work: f64,
}

/// Entry of a summary: the work of all changes.
pub(crate) const WORK_OF_CHANGES: &str = "work_of_changes";
const GRAVITY: [&str; 2] = ["steered.gravity.x", "steered.gravity.y"];
const BATH_TEMPERATURE: &str = "steered.bath_temperature";
const WORK: &str = "steered.work";

impl Steering {
    /// Adds a change that has done `work` (energy).
    pub(crate) fn add(&mut self, change: &Change, work: f64) {
        self.gravity = change.gravity().or(self.gravity);
        if change.quantity == SteeredQuantity::BathTemperature {
            self.bath_temperature = Some(change.values[0]);
        }
        self.work += work;
    }

    /// Adds the changes to a snapshot; nothing before the first one.
    pub(crate) fn keep(&self, kept: &mut Snapshot) {
        if let Some(gravity) = self.gravity {
            GRAVITY.into_iter().zip(gravity).for_each(|(name, value)| kept.add_sum(name, value));
        }
        if let Some(temperature) = self.bath_temperature {
            kept.add_sum(BATH_TEMPERATURE, temperature);
        }
        if self.work != 0.0 {
            kept.add_sum(WORK, self.work);
        }
    }

    /// Changes of a snapshot.
    ///
    /// # Errors
    /// Names an entry that is no finite number, or a negative temperature.
    pub(crate) fn of(kept: &Snapshot) -> Result<Steering, String> {
        let find = |name: &str| kept.counters.contains_key(name).then(|| kept.sum(name)).transpose();
        let gravity = match (find(GRAVITY[0])?, find(GRAVITY[1])?) {
            (Some(x), Some(y)) => Some([x, y]),
            (None, None) => None,
            _ => return Err(format!("one of the sums {GRAVITY:?} is missing")),
        };
        let bath_temperature = find(BATH_TEMPERATURE)?;
        match bath_temperature.filter(|&it| it < 0.0) {
            Some(it) => Err(format!("the sum {BATH_TEMPERATURE} is {it}, not a temperature")),
            None => Ok(Steering { gravity, bath_temperature, work: find(WORK)?.unwrap_or_default() }),
        }
    }
}

/// Refusal by a method that has no such quantity.
pub(crate) fn has_no(method: &str, quantity: SteeredQuantity, why: &str, remedy: &str) -> SteeringError {
    SteeringError::refused(format!("{method} has no {} to change: {why}", quantity.word()), remedy)
}
