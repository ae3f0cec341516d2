//! Simulation of bodies: steps, observes and checks them.

use super::bodies::{PointMasses, StateColumns};
use super::checked::CheckedNbody;
use super::conserved::ConservedQuantities;
use super::encounter::{NearestPair, NearestPairSearch};
use super::field::GravityField;
use super::monitor::EnergyMonitor;
use super::quantities::{NbodyObservation, OBSERVABLES};
use super::schemes::{AdaptiveSteps, BodyIntegrator, IntegrationError, SchemeName};
use super::sums::{StopCallback, never_stop};
use crate::io::checkpoint::CheckpointColumn;
use crate::method::pairwise::Elapsed;
use crate::method::stepped::{Stepped, SteppedState, Stepwise};
use crate::method::{
    Change, Clock, Culprit, MethodObservable, PerParticle, PhysicsFailure, RunWarning, Snapshot,
    StartPurpose, SteeredQuantity, Steering, SteeringError, has_no, rank_loss_failure,
};
use crate::number::significant;
use crate::particles::Particles;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};
use stripmine_kernels::isa::ProgramError;

/// Interval of the checks (steps), and the number of bodies up to which every step is checked. A check covers the binding, the energy
/// error and the nearest pair.
const BETWEEN_LOOKS: u64 = 64;
const FEW: usize = 64;

/// Name of the number of force evaluations, in a checkpoint and in the summary.
const EVALUATIONS: &str = "evaluations";

const COLUMNS: [&str; 6] = ["x", "y", "z", "vx", "vy", "vz"];

/// Stepped state of the bodies.
pub(super) struct SteppedBodies {
    pub(super) elapsed: Elapsed,
    pub(super) bodies: PointMasses,
    pub(super) scheme: Box<dyn BodyIntegrator>,
    /// Mutable while observing, because the pair energy is found with the forces.
    pub(super) field: RefCell<GravityField>,
    particles: Particles,
}

/// State of a run beside its bodies.
pub(super) struct NbodyRunState {
    pub(super) softening: f64,
    /// Steps between observed rows, and the last step, which is observed too; none in a measurement.
    rows: Option<[u64; 2]>,
    pub(super) watch: EnergyMonitor,
    pub(super) encounters: NearestPairSearch,
    /// Nearest pair at the last check.
    pub(super) last_encounter: Option<NearestPair>,
    pub(super) before: SavedStep,
    /// Name, damping and tolerance of the integrator.
    integrator: (SchemeName, [f64; 2]),
    /// Cached conserved quantities of the current state.
    seen: RefCell<Option<Result<ConservedQuantities, ProgramError>>>,
}

/// Running simulation: state and observation of the bodies.
pub(super) type NbodySimulation = Stepped<NbodyRunState>;

/// State before a step of many bodies, which an interrupted step restores.
#[derive(Default)]
pub(super) struct SavedStep {
    pub(super) position: StateColumns,
    velocity: StateColumns,
    carried: Vec<StateColumns>,
    numbers: Vec<f64>,
    evaluations: u64,
}

/// Result of a step.
struct StepResult {
    /// First body whose state is not finite, and the number of such bodies.
    not_finite: Option<(usize, usize)>,
    /// Conserved quantities, if observed.
    seen: Option<ConservedQuantities>,
}

/// Creates the simulation at the start.
///
/// # Errors
/// [`PhysicsFailure`] if the processor lacks the instruction set, or the bodies cannot be distributed to the number of ranks.
pub(super) fn begin(
    checked: &CheckedNbody,
    purpose: StartPurpose,
) -> Result<NbodySimulation, PhysicsFailure> {
    let scene = &checked.scene;
    let all = checked.particles.all();
    let bodies = PointMasses::new(all.iter().map(|body| (body.position, body.velocity, body.mass)));
    let mut field = GravityField::new(scene, &bodies)?;
    let potential = field.potential(&bodies.position, None, &never_stop)?;
    let start = ConservedQuantities::of(&bodies, potential);
    let (mut watch, mut encounters) = (EnergyMonitor::new(&start), NearestPairSearch::default());
    let nearest = encounters.nearest(&bodies.position, bodies.len());
    watch.record_state(start.energy(), nearest, 0);
    let moved = SteppedBodies {
        elapsed: Elapsed::of_steps(scene.dt),
        bodies,
        scheme: scene.scheme.scheme(scene.damping, scene.tolerance),
        field: RefCell::new(field),
        particles: checked.particles.clone(),
    };
    let watched = NbodyRunState {
        softening: scene.softening,
        rows: (purpose == StartPurpose::Run).then_some([scene.run.thermo_every, scene.run.steps]),
        watch,
        encounters,
        last_encounter: nearest,
        before: SavedStep::default(),
        integrator: (scene.scheme, [scene.damping, scene.tolerance]),
        seen: RefCell::new(Some(Ok(start))),
    };
    Ok(Stepped::new(moved, watched))
}

impl NbodySimulation {
    pub(super) fn is_few(&self) -> bool {
        self.state.bodies.len() <= FEW
    }

    /// True if a step may take long, so that it can be interrupted.
    fn is_long_step(&self) -> bool {
        !self.is_few() || self.state.scheme.adaptive_steps().is_some()
    }

    /// True if a check is due after a number of steps.
    fn is_check_due(&self, steps: u64) -> bool {
        self.is_few() || self.state.scheme.adaptive_steps().is_some() || steps.is_multiple_of(BETWEEN_LOOKS)
    }

    /// True if a row, or the end, is due after a number of steps.
    fn is_row(&self, steps: u64) -> bool {
        self.method
            .rows
            .is_some_and(|[every, last]| steps == last || (every > 0 && steps.is_multiple_of(every)))
    }

    /// Conserved quantities of the state, calculated once.
    fn conserved(&self) -> Result<ConservedQuantities, ProgramError> {
        let found = || {
            let SteppedBodies { bodies, scheme, field, .. } = &self.state;
            let potential =
                field.borrow_mut().potential(&bodies.position, scheme.position_low(), &never_stop)?;
            Ok(ConservedQuantities::of(&self.state.bodies, potential))
        };
        self.method.seen.borrow_mut().get_or_insert_with(found).clone()
    }

    /// Conserved quantities with NaN if the pair energy is unavailable, which [`check`](crate::method::Simulation::check) has reported before.
    fn conserved_or_nothing(&self) -> ConservedQuantities {
        self.conserved().unwrap_or_else(|_| ConservedQuantities::of(&self.state.bodies, f64::NAN))
    }

    pub(super) fn id(&self, body: usize) -> u32 {
        self.state.particles.all()[body].id
    }

    pub(super) fn culprit(&self, body: usize) -> Culprit {
        Culprit {
            called: "body",
            id: self.id(body),
            position: self.state.bodies.position_of(body),
            velocity: self.state.bodies.velocity_of(body),
        }
    }

    /// Advances the bodies by a step, and calculates the conserved quantities if `observed`.
    fn attempt(&mut self, observed: bool, stop: StopCallback<'_>) -> Result<StepResult, IntegrationError> {
        let mut field = self.state.field.get_mut().for_step(observed, stop);
        self.state.scheme.step(&mut self.state.bodies, self.state.elapsed.dt, &mut field)?;
        let not_finite = self.state.bodies.not_finite();
        let seen = match observed && not_finite.is_none() {
            true => {
                let potential =
                    field.energy(&self.state.bodies.position, self.state.scheme.position_low())?;
                Some(ConservedQuantities::of(&self.state.bodies, potential))
            }
            false => None,
        };
        Ok(StepResult { not_finite, seen })
    }

    fn keep(&mut self) {
        let SavedStep { position, velocity, carried, numbers, evaluations } = &mut self.method.before;
        position.clone_from(&self.state.bodies.position);
        velocity.clone_from(&self.state.bodies.velocity);
        let now = self.state.scheme.carried_columns();
        carried.resize_with(now.len(), StateColumns::default);
        carried.iter_mut().zip(now).for_each(|(to, from)| to.clone_from(from));
        *numbers = self.state.scheme.carried_numbers().iter().map(|(_, number)| *number).collect();
        *evaluations = self.state.field.get_mut().evaluations;
    }

    fn restore_saved_step(&mut self) {
        let SavedStep { position, velocity, carried, numbers, evaluations } = &mut self.method.before;
        self.state.bodies.position.clone_from(position);
        self.state.bodies.velocity.clone_from(velocity);
        self.state.scheme.take_up(&self.state.bodies, std::mem::take(carried));
        self.state.scheme.take_up_numbers(numbers);
        self.state.field.get_mut().evaluations = *evaluations;
    }

    /// Current observation.
    fn nbody_observation(&self) -> NbodyObservation {
        let conserved = self.conserved_or_nothing();
        NbodyObservation {
            time: self.clock().time,
            conserved,
            energy_error: self.method.watch.relative(conserved.energy()),
            balance_error: conserved.energy() - self.method.watch.start,
            half_mass_radius: half_mass_radius(&self.state.bodies, conserved.centre),
        }
    }

    /// Current energy and number of steps.
    fn now(&self) -> (f64, u64) {
        (self.conserved_or_nothing().energy(), self.state.elapsed.steps)
    }
}

impl PerParticle for SteppedBodies {
    fn particles(&self) -> Particles {
        let mut particles = self.particles.clone();
        for (number, body) in particles.all_mut().iter_mut().enumerate() {
            body.position = self.bodies.position_of(number);
            body.velocity = self.bodies.velocity_of(number);
        }
        particles
    }
}

impl SteppedState for SteppedBodies {
    fn elapsed(&self) -> &Elapsed {
        &self.elapsed
    }

    fn per_particle(&self) -> &dyn PerParticle {
        self
    }

    fn check_ranks(&self) -> Result<(), PhysicsFailure> {
        self.field.borrow().lost().map_or(Ok(()), |lost| Err(rank_loss_failure(lost, self.elapsed.clock())))
    }

    fn columns(&self) -> Vec<(String, CheckpointColumn)> {
        let count = self.bodies.len();
        let state = self.bodies.position.iter().chain(&self.bodies.velocity);
        let named = COLUMNS.iter().map(|name| (*name).to_owned());
        let carried = self.scheme.carried_columns();
        let carried = carried.iter().enumerate().flat_map(|(order, columns)| {
            columns.iter().enumerate().map(move |(axis, column)| (format!("carried.{order}.{axis}"), column))
        });
        let taken = |column: &Vec<f64>| CheckpointColumn::F64(column.iter().take(count).copied().collect());
        named.zip(state).chain(carried).map(|(name, column)| (name, taken(column))).collect()
    }
}

impl Stepwise for NbodyRunState {
    type State = SteppedBodies;
    type Seen = NbodyObservation;
    const OBSERVABLES: &'static [MethodObservable<NbodyObservation>] = &OBSERVABLES;

    fn step(run: &mut Stepped<Self>, interrupted: &AtomicBool) -> Result<bool, PhysicsFailure> {
        let (steps, is_long) = (run.state.elapsed.steps + 1, run.is_long_step());
        let stop = || is_long && interrupted.load(Ordering::Relaxed);
        if is_long {
            run.keep();
        }
        let stepped = match run.attempt(run.is_check_due(steps) || run.is_row(steps), &stop) {
            Err(IntegrationError::Field(ProgramError::Interrupted)) => {
                run.restore_saved_step();
                return Ok(false);
            }
            Err(IntegrationError::Field(failure)) => return Err(failure.into()),
            Err(IntegrationError::Unresolved { time, step }) => return Err(run.unresolved(time, step)),
            Ok(stepped) => stepped,
        };
        run.state.elapsed.steps = steps;
        *run.method.seen.get_mut() = stepped.seen.map(Ok);
        if let Some((first, count)) = stepped.not_finite {
            return Err(run.not_finite(first, count));
        }
        if run.is_check_due(steps) {
            let NbodyRunState { encounters, last_encounter, .. } = &mut run.method;
            let now = encounters.nearest(&run.state.bodies.position, run.state.bodies.len());
            let within = run.state.scheme.adaptive_steps().and_then(|steps| steps.nearest);
            let both = now.into_iter().chain(within);
            *last_encounter = both.min_by(|a, b| a.distance.total_cmp(&b.distance));
        }
        let Some(seen) = stepped.seen else { return Ok(true) };
        run.check_conserved(&seen)?;
        if run.is_check_due(steps) {
            run.method.watch.record_state(seen.energy(), run.method.last_encounter, steps);
        }
        Ok(true)
    }

    fn with_observation<R>(run: &Stepped<Self>, work: impl FnOnce(&NbodyObservation) -> R) -> R {
        work(&run.nbody_observation())
    }

    fn check(run: &Stepped<Self>) -> Result<(), PhysicsFailure> {
        run.check_conserved(&run.conserved()?)
    }

    fn save_into(run: &Stepped<Self>, kept: &mut Snapshot) {
        kept.columns.extend(run.method.watch.columns());
        kept.add_sum("energy", run.method.watch.start);
        kept.add_count(EVALUATIONS, run.state.field.borrow().evaluations);
        for (name, number) in run.state.scheme.carried_numbers() {
            kept.add_sum(name, number);
        }
    }

    fn restore(run: &mut Stepped<Self>, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        let count = run.state.bodies.len();
        let find = |name: &str| snapshot.numbers(name, count);
        let (energy, evaluations) = (snapshot.sum("energy")?, snapshot.count(EVALUATIONS)?);
        run.method.watch.take_up(energy, &snapshot.columns, count)?;
        let state = run.state.bodies.position.iter_mut().chain(&mut run.state.bodies.velocity);
        for (name, column) in COLUMNS.into_iter().zip(state) {
            column[..count].copy_from_slice(find(name)?);
        }
        // Before its first step the integrator carries no derivatives.
        let begun = run.state.elapsed.begun;
        let orders = if clock.steps == begun { 0 } else { run.state.scheme.carries() };
        let mut carried = vec![];
        for order in 0..orders {
            let [x, y, z] =
                [0, 1, 2].map(|axis| find(&format!("carried.{order}.{axis}")).map(<[f64]>::to_vec));
            carried.push([x?, y?, z?]);
        }
        run.state.scheme.take_up(&run.state.bodies, carried);
        let names = run.state.scheme.carried_numbers().into_iter();
        let numbers: Vec<f64> = names.map(|(name, _)| snapshot.sum(name)).collect::<Result<_, _>>()?;
        run.state.scheme.take_up_numbers(&numbers);
        run.state.scheme.check_numbers(clock.steps - begun, run.state.elapsed.dt)?;
        run.state.elapsed.steps = clock.steps;
        run.state.field.get_mut().evaluations = evaluations;
        *run.method.seen.get_mut() = None;
        Ok(())
    }

    fn change(run: &mut Stepped<Self>, change: &Change) -> Result<f64, SteeringError> {
        if change.quantity != SteeredQuantity::Velocities {
            let why = "bodies are points in open space, with no gravity but their own";
            return Err(has_no("nbody", change.quantity, why, "change velocities instead"));
        }
        let bodies = &mut run.state.bodies;
        let square = |velocity: [f64; 3]| velocity.iter().map(|along| along * along).sum::<f64>();
        let mut work = 0.0;
        for (body, (velocity, _)) in change.motion_of(&run.state.particles).into_iter().enumerate() {
            work += 0.5 * bodies.mass[body] * (square(velocity) - square(bodies.velocity_of(body)));
            bodies.velocity.iter_mut().zip(velocity).for_each(|(column, along)| column[body] = along);
        }
        let (name, [damping, tolerance]) = run.method.integrator;
        run.state.scheme = name.scheme(damping, tolerance);
        run.state.elapsed.begun = run.state.elapsed.steps;
        run.method.watch.add_work(work);
        *run.method.seen.get_mut() = None;
        Ok(work)
    }

    fn take_up(run: &mut Stepped<Self>, _: &Steering, begun: u64) -> Result<(), String> {
        run.state.elapsed.begun = begun;
        Ok(())
    }

    fn work(run: &Stepped<Self>) -> f64 {
        (run.state.bodies.len() as f64).powi(2) * run.state.field.borrow().evaluations as f64
    }

    fn summary(run: &Stepped<Self>) -> Vec<(&'static str, Value)> {
        let (energy, _) = run.now();
        let entries = [
            ("bodies", json!(run.state.bodies.len())),
            ("energy", json!(energy)),
            ("energy_error", json!(run.method.watch.relative(energy))),
            (EVALUATIONS, json!(run.state.field.borrow().evaluations)),
            ("order", json!(run.state.scheme.order())),
        ];
        let watched = run.method.watch.entries(run.now(), |body| run.id(body));
        let adaptive = run.state.scheme.adaptive_steps().into_iter().flat_map(adaptive_entries);
        entries.into_iter().chain(adaptive).chain(watched).collect()
    }

    fn warnings(run: &Stepped<Self>) -> Vec<RunWarning> {
        // A scheme with deliberate dissipation does not conserve energy.
        let is_watched = !run.state.scheme.is_dissipative();
        let warning = is_watched.then(|| {
            run.method
                .watch
                .warning(run.now(), run.state.elapsed.dt, run.accuracy_remedy(), |body| run.id(body))
        });
        warning.flatten().into_iter().collect()
    }

    fn in_words(run: &Stepped<Self>) -> String {
        let seen = run.nbody_observation();
        let steps = run.state.scheme.adaptive_steps().map_or(String::new(), |steps| {
            format!("; {} adaptive steps, {} rejected", steps.accepted, steps.rejected)
        });
        format!(
            "{} bodies; energy error {}, virial ratio {:.3}, momentum {}{steps}",
            run.state.bodies.len(),
            significant(seen.energy_error, 3),
            seen.virial_ratio(),
            significant(seen.momentum(), 2)
        )
    }
}

/// Entries of adaptive steps in `summary.json`.
fn adaptive_entries(steps: AdaptiveSteps) -> [(&'static str, Value); 4] {
    [
        ("tolerance", json!(steps.tolerance)),
        ("accepted_steps", json!(steps.accepted)),
        ("rejected_steps", json!(steps.rejected)),
        ("shortest_step", json!(steps.shortest)),
    ]
}

/// Radius around the centre of mass that contains half of the mass.
fn half_mass_radius(bodies: &PointMasses, centre: [f64; 3]) -> f64 {
    let mut around: Vec<(f64, f64)> = (0..bodies.len())
        .map(|body| {
            let place = bodies.position_of(body);
            let displacement = [0, 1, 2].map(|axis| place[axis] - centre[axis]);
            (displacement.iter().map(|x| x * x).sum::<f64>().sqrt(), bodies.mass[body])
        })
        .collect();
    around.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * around.iter().map(|(_, mass)| mass).sum::<f64>();
    let mut inside = 0.0;
    let half_mass = around.iter().find(|(_, mass)| {
        inside += mass;
        inside >= half
    });
    // If the mass is NaN, no radius contains half of it.
    half_mass.map_or(f64::NAN, |(radius, _)| *radius)
}
