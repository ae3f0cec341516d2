//! Simulation of particles in a bath. Particles thrown out of the box are counted, and the run continues without them.

use super::checked::CheckedLangevin;
use super::dynamics::{is_loss, stepper};
use super::laws::PairLaw;
use super::losses::Losses;
use super::quantities::{LangevinObservation, OBSERVABLES};
use crate::io::checkpoint::CheckpointColumn;
use crate::method::pairwise::RemovableDiscs;
use crate::method::stepped::{Stepped, Stepwise};
use crate::method::{
    Change, Clock, MethodObservable, PerParticle, PhysicsFailure, RunWarning, Snapshot, StartPurpose,
    SteeredQuantity, Steering, SteeringError, has_no,
};
use crate::number::significant;
use crate::observe::{AxisMotion, temperature};
use crate::particles::{GrainStates, Particle, Particles, in_plane};
use crate::quoted;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::AtomicBool;
use stripmine_kernels::law::ObservationRequest;

/// Columns that are sums of forces; a repeated step starts them at 0.
const SUMS: [&str; 3] = ["Fx", "Fy", "torque"];
/// Name of the number of list builds, in a checkpoint and in the summary.
const LISTS_MADE: &str = "lists_made";
/// Checkpoint names of the energy and virial of the pairs.
const OF_PAIRS: [&str; 2] = ["potential", "virial"];

/// State of a run beside its particles.
pub(super) struct LangevinRunState {
    checked: CheckedLangevin,
    purpose: StartPurpose,
    /// Remaining particles, in the state of the start.
    start: Particles,
    losses: Losses,
    /// Energy and virial of the pairs (energy) at the last step, in a run.
    of_pairs: [f64; 2],
    /// Particle steps so far.
    work: u64,
    /// List builds of earlier steppers, less the builds that the present one needed to replace them; counts wrap around.
    made_before: u64,
}

/// Running simulation: stepper and state of the run.
type LangevinSimulation = Stepped<LangevinRunState>;

/// Creates the simulation at the start.
///
/// # Errors
/// [`PhysicsFailure`] if the start breaks a precondition.
pub(super) fn begin(
    checked: &CheckedLangevin,
    purpose: StartPurpose,
) -> Result<LangevinSimulation, PhysicsFailure> {
    let follows = purpose == StartPurpose::Run;
    let start = checked.particles.clone();
    let stepper = stepper(checked, start.clone(), follows)?;
    let losses = Losses::new(follows && checked.scene.losses);
    let checked = checked.clone();
    let in_run =
        LangevinRunState { checked, purpose, start, losses, of_pairs: [0.0; 2], work: 0, made_before: 0 };
    let mut running = Stepped::new(stepper, in_run);
    running.compute_forces()?;
    Ok(running)
}

impl LangevinSimulation {
    /// Computes all forces at the current positions.
    fn compute_forces(&mut self) -> Result<(), PhysicsFailure> {
        let asked = ObservationRequest {
            energy: self.method.purpose == StartPurpose::Run,
            ..ObservationRequest::default()
        };
        if self.method.checked.has_pairs() {
            self.method.of_pairs = self.state.compute_forces(asked)?.energy;
        } else {
            self.state.skip_forces()?;
        }
        Ok(())
    }

    /// Removes the particles named by a failure and continues.
    fn remove_lost(&mut self, failure: PhysicsFailure) -> Result<(), PhysicsFailure> {
        let unfit: BTreeSet<usize> = self.state.unfit().into_iter().collect();
        let standing = self.state.unwrapped();
        self.state.check_ranks()?;
        if unfit.is_empty() {
            return Err(PhysicsFailure { kind: super::LOST, ..failure });
        }
        let clock = self.clock();
        for &index in &unfit {
            let Particle { id, .. } = self.method.start.all()[index];
            self.method.losses.add(id, clock.steps, clock.time, standing.all()[index].planar_position());
        }
        let (lost, most) = (self.method.losses.count(), self.method.checked.scene.most_lost);
        if lost > most || unfit.len() == self.method.start.len() {
            return Err(self.too_many(failure, lost, most));
        }
        self.remove_particles(&|index, _| unfit.contains(&index)).map_err(|why| {
            PhysicsFailure::new(super::LOST, why, "this is a bug: please report it with the scene").at(clock)
        })?;
        self.state.settle()
    }

    fn too_many(&self, failure: PhysicsFailure, lost: u64, most: u64) -> PhysicsFailure {
        let first = failure.culprits.first().map(|culprit| format!(", now {culprit}")).unwrap_or_default();
        let message = format!("{lost} particles were lost{first}; run.most_lost = {most}");
        let remedy = self.below_table(&failure).unwrap_or_else(|| self.remedy(&failure));
        let failure = PhysicsFailure { message, remedy, kind: super::LOST, ..failure };
        failure.with([("lost", lost as f64), ("most_lost", most as f64)])
    }

    /// Returns the remedy for a pair nearer than the first row of the law's table.
    fn below_table(&self, failure: &PhysicsFailure) -> Option<String> {
        let (checked, first) = (&self.method.checked, failure.culprits.first()?);
        let table = &checked.scene.parameters.table;
        let least = table.potential.ends()[0];
        let distance =
            |other: &Particle| checked.domain.distance(in_plane(first.position), other.planar_position());
        let particles = self.state.unwrapped();
        let others = particles.all().iter().filter(|other| other.id != first.id);
        let near = others.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        (checked.scene.law == PairLaw::Table && distance(near) < least).then(|| {
            format!(
                "it is {} from particle {}, nearer than {least}, the first row of {}: add rows at smaller distances, lower integrator.dt, or \
                 allow losses with run.most_lost",
                significant(distance(near), 4),
                near.id,
                quoted::path(table.path())
            )
        })
    }

    /// Returns the remedy for the losses of a failure.
    fn remedy(&self, failure: &PhysicsFailure) -> String {
        let dt = self.method.checked.scene.dt;
        let shortest =
            self.method.checked.limits().iter().map(|limit| limit.step).fold(f64::INFINITY, f64::min);
        if shortest < dt {
            let of = if self.method.checked.has_pairs() { "pairs" } else { "friction" };
            return format!(
                "the time step is too long for the {of}: take integrator.dt below {}, or allow losses with run.most_lost",
                significant(shortest, 3)
            );
        }
        let velocity = failure.culprits.first().map_or([0.0; 3], |culprit| culprit.velocity);
        let sides = self.method.checked.domain.lengths();
        match (0..2).find(|&axis| velocity[axis].is_finite() && velocity[axis].abs() * dt > sides[axis]) {
            Some(axis) => format!(
                "a particle moves {} in the step, farther than the side {} of the box: take integrator.dt below {}, a larger box, or a \
                 lower temperature",
                significant(velocity[axis].abs() * dt, 3),
                significant(sides[axis], 5),
                significant(sides[axis] / velocity[axis].abs(), 3)
            ),
            None => format!("lower integrator.dt (it is {dt}), or allow losses with run.most_lost"),
        }
    }

    /// Removes the particles selected by index and properties from the state.
    fn remove_particles(&mut self, leaves: &dyn Fn(usize, &Particle) -> bool) -> Result<(), String> {
        let all = self.method.start.all();
        let stays: Vec<bool> =
            all.iter().enumerate().map(|(index, particle)| !leaves(index, particle)).collect();
        let start = all.iter().zip(&stays).filter(|(_, stays)| **stays).map(|(particle, _)| *particle);
        let start = Particles::new(start.collect());
        let columns: Vec<(String, CheckpointColumn)> = self
            .state
            .columns()
            .into_iter()
            .map(|(name, column)| retained_entries(name, column, &stays))
            .collect();
        self.replace_stepper(start, &columns)
    }

    /// Makes another stepper of the scene, of these particles in this state.
    fn replace_stepper(
        &mut self,
        start: Particles,
        columns: &[(String, CheckpointColumn)],
    ) -> Result<(), String> {
        self.state.check_ranks().map_err(|failure| failure.what_and_when())?;
        let elapsed = self.state.elapsed();
        let (steps, begun, timings, made) =
            (elapsed.steps, elapsed.begun, elapsed.timings, self.lists_made());
        self.begin_stepper(start)?;
        self.state.restore(steps, columns)?;
        (self.state.elapsed_mut().timings, self.state.elapsed_mut().begun) = (timings, begun);
        self.count_lists_from(made.unwrap_or_default());
        Ok(())
    }

    /// Makes another stepper of the scene, of these particles at their start.
    fn begin_stepper(&mut self, start: Particles) -> Result<(), String> {
        let follows = self.method.purpose == StartPurpose::Run;
        self.state.end();
        self.state = stepper(&self.method.checked, start.clone(), follows)
            .map_err(|failure| failure.what_and_when())?;
        self.method.start = start;
        Ok(())
    }

    /// Number of particles that are not lost. If too many losses end a run, the last ones are still in its state.
    fn left(&self) -> u64 {
        self.method.checked.particles.len() as u64 - self.method.losses.count()
    }

    /// Number of list builds since the start; none without lists.
    fn lists_made(&self) -> Option<u64> {
        self.state.lists().map(|(_, made)| self.method.made_before.wrapping_add(made))
    }

    /// Sets the number of list builds so far.
    fn count_lists_from(&mut self, made: u64) {
        let by_this = self.state.lists().map_or(0, |(_, made)| made);
        self.method.made_before = made.wrapping_sub(by_this);
    }

    /// Unwrapped displacements since the start (length).
    fn displacements(&self, standing: &Particles) -> Vec<[f64; 2]> {
        let crossed = self.state.elapsed().crossings.counts();
        let sides = self.method.checked.domain.lengths();
        let of = |(index, (now, start)): (usize, (&Particle, &Particle))| {
            let periods = crossed.get(index).copied().unwrap_or_default();
            [0, 1].map(|axis| now.position[axis] + periods[axis] * sides[axis] - start.position[axis])
        };
        standing.all().iter().zip(self.method.start.all()).enumerate().map(of).collect()
    }
}

/// Keeps the entries of the remaining particles; sums of forces restart at 0. Columns without one entry per particle are unchanged.
fn retained_entries(name: String, column: CheckpointColumn, stays: &[bool]) -> (String, CheckpointColumn) {
    fn of<T: Copy>(values: Vec<T>, stays: &[bool]) -> Vec<T> {
        values.into_iter().zip(stays).filter(|(_, stays)| **stays).map(|(value, _)| value).collect()
    }
    if column.len() != stays.len() {
        return (name, column);
    }
    let is_sum = SUMS.contains(&name.as_str());
    let column = match column {
        CheckpointColumn::F64(values) if is_sum => CheckpointColumn::F64(of(vec![0.0; values.len()], stays)),
        CheckpointColumn::F32(values) if is_sum => CheckpointColumn::F32(of(vec![0.0; values.len()], stays)),
        CheckpointColumn::F64(values) => CheckpointColumn::F64(of(values, stays)),
        CheckpointColumn::F32(values) => CheckpointColumn::F32(of(values, stays)),
        CheckpointColumn::U32(values) => CheckpointColumn::U32(of(values, stays)),
        CheckpointColumn::U64(values) => CheckpointColumn::U64(of(values, stays)),
    };
    (name, column)
}

impl LangevinSimulation {
    /// Current observation.
    fn langevin_observation(&self) -> LangevinObservation {
        let (particles, mass) = (self.state.unwrapped(), self.method.checked.mass);
        let count = particles.len() as f64;
        let velocities = || particles.all().iter().map(Particle::planar_velocity);
        let thermal: Vec<[f64; 2]> = match self.method.checked.scene.scheme.is_observed_after_bath() {
            true => self.state.predicted_velocities(),
            false => velocities().collect(),
        };
        let motion = [0, 1].map(|axis| AxisMotion {
            twice_kinetic: mass * thermal.iter().map(|velocity| velocity[axis] * velocity[axis]).sum::<f64>(),
            momentum: mass * thermal.iter().map(|velocity| velocity[axis]).sum::<f64>(),
        });
        // Without friction there is no bath, so momentum is conserved.
        let conserved = [self.method.checked.scene.bath.friction == 0.0; 2];
        let kinetic = 0.5 * mass * thermal.iter().map(|[u, v]| u * u + v * v).sum::<f64>();
        let [potential, virial] = self.method.of_pairs;
        let square = self.displacements(&particles).iter().map(|[x, y]| x * x + y * y).sum::<f64>();
        LangevinObservation {
            time: self.clock().time,
            kinetic,
            potential,
            temperature: temperature(motion, conserved, count * mass, count),
            pressure: (kinetic + 0.5 * virial) / self.method.checked.domain.area(),
            msd: square / count,
            momentum: [0, 1].map(|axis| mass * velocities().map(|velocity| velocity[axis]).sum::<f64>()),
            lost: self.method.losses.count(),
        }
    }
}

impl PerParticle for LangevinSimulation {
    fn particles(&self) -> Particles {
        self.state.particles()
    }

    fn is_whole(&self) -> bool {
        self.state.check_ranks().is_ok()
    }

    fn states(&self, states: &mut GrainStates) {
        // The stepper numbers only the remaining particles.
        match self.method.start.len() == self.method.checked.particles.len() {
            true => self.state.states(states),
            false => states.store_grains(&self.state.particles()),
        }
    }

    fn positions(&self) -> Vec<[f32; 3]> {
        let (there, all) = (self.state.positions(), self.method.checked.particles.all());
        if there.len() == all.len() {
            return there;
        }
        let mut left = self.method.start.all().iter().zip(there).peekable();
        let position = |particle: &Particle| {
            left.next_if(|(still, _)| still.id == particle.id).map_or([f32::NAN; 3], |(_, position)| position)
        };
        all.iter().map(position).collect()
    }

    fn images(&self) -> Vec<[i32; 2]> {
        self.state.images()
    }
}

impl Stepwise for LangevinRunState {
    type State = Box<dyn RemovableDiscs>;
    type Seen = LangevinObservation;
    const OBSERVABLES: &'static [MethodObservable<LangevinObservation>] = &OBSERVABLES;

    fn step(run: &mut Stepped<Self>, _interrupted: &AtomicBool) -> Result<bool, PhysicsFailure> {
        let mut done = run.state.advance().map(drop);
        loop {
            match done.and_then(|()| run.compute_forces()) {
                Ok(()) => break,
                Err(failure) if is_loss(&failure) => done = run.remove_lost(failure),
                Err(failure) => return Err(failure),
            }
        }
        run.method.work += run.method.start.len() as u64;
        Ok(true)
    }

    fn with_observation<R>(run: &Stepped<Self>, work: impl FnOnce(&LangevinObservation) -> R) -> R {
        work(&run.langevin_observation())
    }

    fn per_particle(run: &Stepped<Self>) -> &dyn PerParticle {
        run
    }

    fn save_into(run: &Stepped<Self>, kept: &mut Snapshot) {
        for (name, sum) in OF_PAIRS.into_iter().zip(run.method.of_pairs) {
            kept.add_sum(name, sum);
        }
        if let Some(made) = run.lists_made() {
            kept.add_count(LISTS_MADE, made);
        }
        kept.columns.extend(run.method.losses.columns());
    }

    fn restore(run: &mut Stepped<Self>, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        for (name, sum) in OF_PAIRS.into_iter().zip(&mut run.method.of_pairs) {
            *sum = snapshot.sum(name)?;
        }
        let made = if run.state.lists().is_some() { snapshot.count(LISTS_MADE)? } else { 0 };
        let columns = snapshot.columns;
        let ids: BTreeSet<u32> = run.method.start.all().iter().map(|particle| particle.id).collect();
        run.method.losses.take_up(clock.steps, &ids, &columns)?;
        let lost: BTreeSet<u32> = run.method.losses.ids().collect();
        if !lost.is_empty() {
            run.remove_particles(&|_, particle| lost.contains(&particle.id))?;
        }
        run.state.restore(clock.steps, &columns)?;
        run.count_lists_from(made);
        Ok(())
    }

    fn change(run: &mut Stepped<Self>, change: &Change) -> Result<f64, SteeringError> {
        let refused =
            |why: &str, remedy: &str| Err(has_no("this scene of langevin", change.quantity, why, remedy));
        match change.quantity {
            SteeredQuantity::Gravity => {
                return refused("nothing stops the fall across a periodic side", "change velocities instead");
            }
            SteeredQuantity::AngularVelocities => {
                return refused("its particles do not rotate", "change velocities instead");
            }
            SteeredQuantity::BathTemperature if run.method.checked.scene.bath.friction == 0.0 => {
                return refused("law.drag is 0, so there is no bath", "start it with law.drag above 0");
            }
            _ => {}
        }
        let particles = run.state.unwrapped();
        let motion = change.motion_of(&particles);
        run.state.restart(&motion)?;
        if change.quantity == SteeredQuantity::BathTemperature {
            run.method.checked.scene.bath.temperature = change.values[0];
            let (start, columns) = (run.method.start.clone(), run.state.columns());
            let bug = "this is a bug: please report it with the scene";
            let replaced = run.replace_stepper(start, &columns);
            replaced.map_err(|why| PhysicsFailure::new(super::LOST, why, bug).at(run.clock()))?;
        }
        run.compute_forces()?;
        let squares = |velocity: &[f64; 3]| velocity[0] * velocity[0] + velocity[1] * velocity[1];
        let change =
            motion.iter().zip(particles.all()).map(|((new, _), old)| squares(new) - squares(&old.velocity));
        Ok(0.5 * run.method.checked.mass * change.sum::<f64>())
    }

    fn take_up(run: &mut Stepped<Self>, steering: &Steering, begun: u64) -> Result<(), String> {
        if let Some(temperature) = steering.bath_temperature {
            run.method.checked.scene.bath.temperature = temperature;
            run.begin_stepper(run.method.start.clone())?;
        }
        run.state.elapsed_mut().begun = begun;
        Ok(())
    }

    fn phases(run: &Stepped<Self>) -> BTreeMap<&'static str, f64> {
        run.state.elapsed().timings.named()
    }

    fn reset_phases(run: &mut Stepped<Self>) {
        run.state.elapsed_mut().timings = Default::default();
    }

    fn work(run: &Stepped<Self>) -> f64 {
        run.method.work as f64
    }

    fn summary(run: &Stepped<Self>) -> Vec<(&'static str, Value)> {
        vec![
            ("particles", json!(run.left())),
            ("lost", json!(run.method.losses.count())),
            ("losses", run.method.losses.listed()),
            ("listed_pairs", json!(run.state.lists().map(|(entries, _)| entries))),
            (LISTS_MADE, json!(run.lists_made())),
            ("potential", json!(run.method.of_pairs[0])),
            ("noise_seed", json!(run.method.checked.seed)),
        ]
    }

    fn take_events(run: &mut Stepped<Self>) -> String {
        run.method.losses.take_rows()
    }

    fn warnings(run: &Stepped<Self>) -> Vec<RunWarning> {
        let (lost, all) = (run.method.losses.count(), run.method.checked.particles.len());
        let first = run.method.losses.first_in_words().unwrap_or_default();
        let of_pairs = if run.method.checked.has_pairs() { " for the pairs" } else { "" };
        let listed = if run.method.checked.lists_losses() { "events.csv" } else { "summary.json" };
        let message = format!(
            "{lost} of {all} particles were thrown out of the box and lost, {first}: the time step is too long{of_pairs}; \
             {listed} lists them"
        );
        let warning = RunWarning { check: "lost", value: lost as f64, limit: 0.0, message };
        if lost > 0 { vec![warning] } else { vec![] }
    }

    fn in_words(run: &Stepped<Self>) -> String {
        let LangevinObservation { temperature, pressure, msd, .. } = run.langevin_observation();
        format!(
            "{} particles, {} lost{}; temperature {}, pressure {}, mean square displacement {}",
            run.left(),
            run.method.losses.count(),
            run.method.losses.first_in_words().map(|first| format!(", {first}")).unwrap_or_default(),
            significant(temperature, 4),
            significant(pressure, 5),
            significant(msd, 5)
        )
    }
}
