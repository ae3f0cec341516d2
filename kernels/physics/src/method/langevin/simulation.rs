//! Particles in a bath under way, observed; what is thrown out is counted, and the run goes on without it.

use super::checked::Checked;
use super::dynamics::{is_loss, stepper};
use super::losses::Losses;
use super::quantities::{OBSERVABLES, Seen};
use crate::io::checkpoint::{Column, Counter};
use crate::method::observed::values;
use crate::method::pairwise::Stepping;
use crate::method::{Clock, Failure, Purpose, RunWarning, Simulation, Snapshot, Until};
use crate::number::significant;
use crate::observe::{AxisMotion, temperature};
use crate::particles::{Particle, Particles, States};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicBool, Ordering};
use stripmine_kernels::law::Asked;

/// Columns that are sums of forces; those of a step that is made again begin with none.
const SUMS: [&str; 3] = ["Fx", "Fy", "torque"];
/// How often lists were made, in a checkpoint and in the summary.
const LISTS_MADE: &str = "lists_made";
/// Energy and virial of the pairs in a checkpoint.
const OF_PAIRS: [&str; 2] = ["potential", "virial"];

/// Particles under way.
pub(super) struct Running {
    checked: Checked,
    purpose: Purpose,
    stepper: Box<dyn Stepping>,
    /// The particles of the start that are still there.
    start: Particles,
    losses: Losses,
    /// Energy and virial of the pairs (energy), as of the last step, in a run.
    of_pairs: [f64; 2],
    /// Particles moved so far: particles times steps.
    work: u64,
    /// How often lists were made by other steppers before this one, whatever this one had to make to take their place; counts
    /// wrap around.
    made_before: u64,
}

impl Running {
    /// At the start.
    ///
    /// # Errors
    /// [`Failure`] if it breaks a precondition already.
    pub(super) fn new(checked: &Checked, purpose: Purpose) -> Result<Running, Failure> {
        let follows = purpose == Purpose::Run;
        let start = checked.particles.clone();
        let stepper = stepper(checked, start.clone(), follows)?;
        let losses = Losses::new(follows && checked.scene.losses);
        let checked = checked.clone();
        let mut running =
            Running { checked, purpose, stepper, start, losses, of_pairs: [0.0; 2], work: 0, made_before: 0 };
        running.compute_forces()?;
        Ok(running)
    }

    /// All forces of the places as they stand.
    fn compute_forces(&mut self) -> Result<(), Failure> {
        let asked = Asked { energy: self.purpose == Purpose::Run, ..Asked::default() };
        if self.checked.has_pairs() {
            self.of_pairs = self.stepper.compute_forces(asked)?.energy;
        } else {
            self.stepper.skip_forces();
        }
        Ok(())
    }

    fn step(&mut self) -> Result<(), Failure> {
        let mut done = self.stepper.advance().map(drop);
        loop {
            match done.and_then(|()| self.compute_forces()) {
                Ok(()) => break,
                Err(failure) if is_loss(&failure) => done = self.lose(failure),
                Err(failure) => return Err(failure),
            }
        }
        self.work += self.start.len() as u64;
        Ok(())
    }

    /// Goes on without the particles that a failure is of.
    fn lose(&mut self, failure: Failure) -> Result<(), Failure> {
        let unfit: BTreeSet<usize> = self.stepper.unfit().into_iter().collect();
        if unfit.is_empty() {
            return Err(Failure { kind: super::LOST, ..failure });
        }
        let clock = self.clock();
        let standing = self.stepper.unwrapped();
        for &place in &unfit {
            let Particle { id, .. } = self.start.all()[place];
            self.losses.add(id, clock.steps, clock.time, standing.all()[place].place());
        }
        let (lost, most) = (self.losses.count(), self.checked.scene.most_lost);
        if lost > most || unfit.len() == self.start.len() {
            return Err(self.too_many(failure, lost, most));
        }
        self.without(&|place, _| unfit.contains(&place))
            .map_err(|why| Failure::new(super::LOST, why, "report this with the scene").at(clock))?;
        self.stepper.settle()
    }

    fn too_many(&self, failure: Failure, lost: u64, most: u64) -> Failure {
        let first = failure.culprits.first().map(|culprit| format!(", now {culprit}")).unwrap_or_default();
        let message = format!("{lost} particles were lost{first}; run.most_lost = {most}");
        let remedy = self.remedy(&failure);
        let failure = Failure { message, remedy, kind: super::LOST, ..failure };
        failure.with([("lost", lost as f64), ("most_lost", most as f64)])
    }

    /// What helps against the losses of a failure.
    fn remedy(&self, failure: &Failure) -> String {
        let dt = self.checked.scene.dt;
        let shortest = self.checked.limits().iter().map(|limit| limit.step).fold(f64::INFINITY, f64::min);
        if shortest < dt {
            let of = if self.checked.has_pairs() { "pairs" } else { "friction" };
            return format!(
                "the time step is too long for the {of}: take integrator.dt below {}, or allow losses by run.most_lost",
                significant(shortest, 3)
            );
        }
        let velocity = failure.culprits.first().map_or([0.0; 3], |culprit| culprit.velocity);
        let sides = self.checked.domain.lengths();
        match (0..2).find(|&axis| velocity[axis].is_finite() && velocity[axis].abs() * dt > sides[axis]) {
            Some(axis) => format!(
                "a particle moves {} in the step, farther than the side {} of the box: take integrator.dt below {}, a larger box, or a \
                 lower temperature",
                significant(velocity[axis].abs() * dt, 3),
                significant(sides[axis], 5),
                significant(sides[axis] / velocity[axis].abs(), 3)
            ),
            None => format!("lower integrator.dt (it is {dt}), or allow losses by run.most_lost"),
        }
    }

    /// The same state without particles of some places and ids.
    fn without(&mut self, leaves: &dyn Fn(usize, &Particle) -> bool) -> Result<(), String> {
        let all = self.start.all();
        let stays: Vec<bool> =
            all.iter().enumerate().map(|(place, particle)| !leaves(place, particle)).collect();
        let start = all.iter().zip(&stays).filter(|(_, stays)| **stays).map(|(particle, _)| *particle);
        let start = Particles::new(start.collect());
        let columns: Vec<(String, Column)> =
            self.stepper.columns().into_iter().map(|(name, column)| kept(name, column, &stays)).collect();
        let elapsed = self.stepper.elapsed();
        let (steps, timings, made) = (elapsed.steps, elapsed.timings, self.lists_made());
        let follows = self.purpose == Purpose::Run;
        self.stepper = stepper(&self.checked, start.clone(), follows).map_err(|failure| failure.what())?;
        self.stepper.restore(steps, &columns)?;
        self.stepper.elapsed_mut().timings = timings;
        self.start = start;
        self.count_lists_from(made.unwrap_or_default());
        Ok(())
    }

    /// Particles that are not lost; where a run ends by too many losses, the last ones still are in its state.
    fn left(&self) -> u64 {
        self.checked.particles.len() as u64 - self.losses.count()
    }

    /// How often lists were made since the start; none where there are none.
    fn lists_made(&self) -> Option<u64> {
        self.stepper.lists().map(|(_, made)| self.made_before.wrapping_add(made))
    }

    /// So often they were made so far.
    fn count_lists_from(&mut self, made: u64) {
        let by_this = self.stepper.lists().map_or(0, |(_, made)| made);
        self.made_before = made.wrapping_sub(by_this);
    }

    /// Displacements since the start, as if there were no sides (length).
    fn displacements(&self, standing: &Particles) -> Vec<[f64; 2]> {
        let crossed = self.stepper.elapsed().crossings.counts();
        let sides = self.checked.domain.lengths();
        let of = |(place, (now, start)): (usize, (&Particle, &Particle))| {
            let periods = crossed.get(place).copied().unwrap_or_default();
            [0, 1].map(|axis| now.position[axis] + periods[axis] * sides[axis] - start.position[axis])
        };
        standing.all().iter().zip(self.start.all()).enumerate().map(of).collect()
    }
}

/// The entries of a column that stay; sums of forces begin with none. What has not an entry a particle stays as it is.
fn kept(name: String, column: Column, stays: &[bool]) -> (String, Column) {
    fn of<T: Copy>(values: Vec<T>, stays: &[bool]) -> Vec<T> {
        values.into_iter().zip(stays).filter(|(_, stays)| **stays).map(|(value, _)| value).collect()
    }
    if column.len() != stays.len() {
        return (name, column);
    }
    let is_sum = SUMS.contains(&name.as_str());
    let column = match column {
        Column::F64(values) if is_sum => Column::F64(of(vec![0.0; values.len()], stays)),
        Column::F32(values) if is_sum => Column::F32(of(vec![0.0; values.len()], stays)),
        Column::F64(values) => Column::F64(of(values, stays)),
        Column::F32(values) => Column::F32(of(values, stays)),
        Column::U32(values) => Column::U32(of(values, stays)),
        Column::U64(values) => Column::U64(of(values, stays)),
    };
    (name, column)
}

impl Running {
    /// All that there is to be seen now.
    fn seen(&self) -> Seen {
        let (particles, mass) = (self.stepper.unwrapped(), self.checked.mass);
        let count = particles.len() as f64;
        let velocities = || particles.all().iter().map(Particle::planar_velocity);
        let thermal: Vec<[f64; 2]> = match self.checked.scene.scheme.is_observed_after_bath() {
            true => self.stepper.predicted_velocities(),
            false => velocities().collect(),
        };
        let motion = [0, 1].map(|axis| AxisMotion {
            twice_kinetic: mass * thermal.iter().map(|velocity| velocity[axis] * velocity[axis]).sum::<f64>(),
            momentum: mass * thermal.iter().map(|velocity| velocity[axis]).sum::<f64>(),
        });
        // Without friction there is no bath, and momentum stays.
        let conserved = [self.checked.scene.bath.friction == 0.0; 2];
        let kinetic = 0.5 * mass * thermal.iter().map(|[u, v]| u * u + v * v).sum::<f64>();
        let [potential, virial] = self.of_pairs;
        let square = self.displacements(&particles).iter().map(|[x, y]| x * x + y * y).sum::<f64>();
        Seen {
            time: self.clock().time,
            kinetic,
            potential,
            temperature: temperature(motion, conserved, count * mass, count),
            pressure: (kinetic + 0.5 * virial) / self.checked.domain.area(),
            msd: square / count,
            momentum: [0, 1].map(|axis| mass * velocities().map(|velocity| velocity[axis]).sum::<f64>()),
            lost: self.losses.count(),
        }
    }
}

impl Simulation for Running {
    fn advance(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), Failure> {
        while !until.iter().any(|moment| moment.has_come(&self.clock())) {
            if interrupted.load(Ordering::Relaxed) {
                break;
            }
            self.step()?;
        }
        Ok(())
    }

    fn clock(&self) -> Clock {
        self.stepper.elapsed().clock()
    }

    fn time_step(&self) -> Option<f64> {
        Some(self.stepper.elapsed().dt)
    }

    fn particles(&self) -> Particles {
        self.stepper.particles()
    }

    fn states(&self, states: &mut States) {
        // The stepper numbers those that are still there.
        match self.start.len() == self.checked.particles.len() {
            true => self.stepper.states(states),
            false => states.take_up(&self.particles()),
        }
    }

    fn positions(&self) -> Vec<[f32; 3]> {
        let (there, all) = (self.stepper.positions(), self.checked.particles.all());
        if there.len() == all.len() {
            return there;
        }
        let mut left = self.start.all().iter().zip(there).peekable();
        let place = |particle: &Particle| {
            left.next_if(|(still, _)| still.id == particle.id).map_or([f32::NAN; 3], |(_, place)| place)
        };
        all.iter().map(place).collect()
    }

    fn images(&self) -> Vec<[i32; 2]> {
        self.stepper.images()
    }

    fn observe(&self) -> Vec<f64> {
        values(&OBSERVABLES, &self.seen())
    }

    fn snapshot(&self) -> Snapshot {
        let counters = OF_PAIRS.into_iter().zip(self.of_pairs);
        let made = self.lists_made().map(|made| (LISTS_MADE, Counter::Count(made)));
        let counters = counters.map(|(name, sum)| (name, Counter::Sum(sum))).chain(made);
        let counters = counters.map(|(name, counter)| (name.to_owned(), counter));
        let columns = self.stepper.columns().into_iter().chain(self.losses.columns());
        Snapshot { counters: counters.collect(), columns: columns.collect() }
    }

    fn restore(&mut self, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        clock.of_steps(self.checked.scene.dt)?;
        for (name, sum) in OF_PAIRS.into_iter().zip(&mut self.of_pairs) {
            *sum = snapshot.sum(name)?;
        }
        let made = if self.stepper.lists().is_some() { snapshot.count(LISTS_MADE)? } else { 0 };
        let columns = snapshot.columns;
        let ids: BTreeSet<u32> = self.start.all().iter().map(|particle| particle.id).collect();
        self.losses.take_up(clock.steps, &ids, &columns)?;
        let lost: BTreeSet<u32> = self.losses.ids().collect();
        if !lost.is_empty() {
            self.without(&|_, particle| lost.contains(&particle.id))?;
        }
        self.stepper.restore(clock.steps, &columns)?;
        self.count_lists_from(made);
        Ok(())
    }

    fn phases(&self) -> BTreeMap<&'static str, f64> {
        self.stepper.elapsed().timings.named()
    }

    fn reset_phases(&mut self) {
        self.stepper.elapsed_mut().timings = Default::default();
    }

    fn work(&self) -> f64 {
        self.work as f64
    }

    fn summary(&self) -> Map<String, Value> {
        let entries = [
            ("particles", json!(self.left())),
            ("lost", json!(self.losses.count())),
            ("losses", self.losses.listed()),
            ("listed_pairs", json!(self.stepper.lists().map(|(entries, _)| entries))),
            (LISTS_MADE, json!(self.lists_made())),
            ("potential", json!(self.of_pairs[0])),
            ("noise_seed", json!(self.checked.seed)),
        ];
        entries.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }

    fn take_events(&mut self) -> String {
        self.losses.take_rows()
    }

    fn warnings(&self) -> Vec<RunWarning> {
        let (lost, all) = (self.losses.count(), self.checked.particles.len());
        let first = self.losses.first_in_words().unwrap_or_default();
        let of_pairs = if self.checked.has_pairs() { " for the pairs" } else { "" };
        let listed = if self.checked.lists_losses() { "events.csv" } else { "summary.json" };
        let message = format!(
            "{lost} of {all} particles were thrown out of the box and lost, {first}: the time step is too long{of_pairs}; \
             {listed} lists them"
        );
        let warning = RunWarning { check: "lost", value: lost as f64, limit: 0.0, message };
        if lost > 0 { vec![warning] } else { vec![] }
    }

    fn in_words(&self) -> String {
        let Seen { temperature, pressure, msd, .. } = self.seen();
        format!(
            "{} particles, {} lost{}; temperature {}, pressure {}, mean square displacement {}",
            self.left(),
            self.losses.count(),
            self.losses.first_in_words().map(|first| format!(", {first}")).unwrap_or_default(),
            significant(temperature, 4),
            significant(pressure, 5),
            significant(msd, 5)
        )
    }
}
