//! Bodies under way, observed.

use super::bodies::{Bodies, Columns};
use super::checked::Checked;
use super::conserved::Conserved;
use super::encounter::{Encounter, Encounters};
use super::field::Attraction;
use super::quantities::{OBSERVABLES, Seen};
use super::schemes::Scheme;
use super::sums::{Stop, never};
use super::watch::Watch;
use crate::io::checkpoint::Column;
use crate::method::pairwise::Elapsed;
use crate::method::stepped::{Stepped, SteppedState, Stepwise};
use crate::method::{
    Clock, Culprit, Failure, FailureKind, Observable, PerParticle, Purpose, RunWarning, Snapshot, ended,
};
use crate::number::significant;
use crate::particles::Particles;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};
use stripmine_kernels::isa::ProgramError;

/// Bodies are looked at this often (steps), and so few of them at every step: whether they are still bound, the error of their energy,
/// and the nearest two.
const BETWEEN_LOOKS: u64 = 64;
const FEW: usize = 64;

/// How often forces were found, in a checkpoint and in the summary.
const EVALUATIONS: &str = "evaluations";

const COLUMNS: [&str; 6] = ["x", "y", "z", "vx", "vy", "vz"];

/// Bodies that are stepped.
pub(super) struct Moved {
    elapsed: Elapsed,
    pub(super) bodies: Bodies,
    scheme: Box<dyn Scheme>,
    /// Observing needs the energy of the pairs, which is found as forces are.
    pub(super) field: RefCell<Attraction>,
    particles: Particles,
}

/// What a run keeps beside its bodies.
pub(super) struct Watched {
    softening: f64,
    /// Rows are observed after multiples of this number of steps, and the last state after the other; none in a measurement.
    rows: Option<[u64; 2]>,
    watch: Watch,
    encounters: Encounters,
    /// The nearest two bodies at the last look.
    last_encounter: Option<Encounter>,
    before: Before,
    /// What the state conserves, where that was asked for already.
    seen: RefCell<Option<Result<Conserved, ProgramError>>>,
}

/// Bodies under way, observed.
pub(super) type Running = Stepped<Watched>;

/// The state before a step of many bodies, to which a step that is interrupted goes back.
#[derive(Default)]
struct Before {
    position: Columns,
    velocity: Columns,
    carried: Vec<Columns>,
    evaluations: u64,
}

/// What a step found.
struct Found {
    /// The first body that is at no finite place, and how many there are.
    not_finite: Option<(usize, usize)>,
    /// Where it was observed.
    seen: Option<Conserved>,
}

/// At the start.
///
/// # Errors
/// [`Failure`] if the processor lacks what is asked for, or bodies cannot be dealt out to so many ranks.
pub(super) fn begin(checked: &Checked, purpose: Purpose) -> Result<Running, Failure> {
    let scene = &checked.scene;
    let all = checked.particles.all();
    let bodies = Bodies::new(all.iter().map(|body| (body.position, body.velocity, body.mass)));
    let mut field = Attraction::new(scene, &bodies)?;
    let potential = field.potential(&bodies.position, &never)?;
    let start = Conserved::of(&bodies, potential);
    let (mut watch, mut encounters) = (Watch::new(&start), Encounters::default());
    let nearest = encounters.nearest(&bodies.position, bodies.len());
    watch.look(start.energy(), nearest, 0);
    let moved = Moved {
        elapsed: Elapsed::of_steps(scene.dt),
        bodies,
        scheme: scene.scheme.scheme(scene.damping),
        field: RefCell::new(field),
        particles: checked.particles.clone(),
    };
    let watched = Watched {
        softening: scene.softening,
        rows: (purpose == Purpose::Run).then_some([scene.run.thermo_every, scene.run.steps]),
        watch,
        encounters,
        last_encounter: nearest,
        before: Before::default(),
        seen: RefCell::new(Some(Ok(start))),
    };
    Ok(Stepped::new(moved, watched))
}

impl Running {
    fn is_few(&self) -> bool {
        self.state.bodies.len() <= FEW
    }

    /// Whether a look is due after a number of steps.
    fn is_look(&self, steps: u64) -> bool {
        self.is_few() || steps.is_multiple_of(BETWEEN_LOOKS)
    }

    /// Whether a row, or the end, is due after a number of steps.
    fn is_row(&self, steps: u64) -> bool {
        self.method
            .rows
            .is_some_and(|[every, last]| steps == last || (every > 0 && steps.is_multiple_of(every)))
    }

    /// What the state conserves; found once.
    fn conserved(&self) -> Result<Conserved, ProgramError> {
        let found = || {
            let potential = self.state.field.borrow_mut().potential(&self.state.bodies.position, &never)?;
            Ok(Conserved::of(&self.state.bodies, potential))
        };
        self.method.seen.borrow_mut().get_or_insert_with(found).clone()
    }

    /// The same; no numbers where the pairs' energy could not be found, which [`check`](crate::method::Simulation::check) has reported before.
    fn conserved_or_nothing(&self) -> Conserved {
        self.conserved().unwrap_or_else(|_| Conserved::of(&self.state.bodies, f64::NAN))
    }

    fn id(&self, body: usize) -> u32 {
        self.state.particles.all()[body].id
    }

    fn culprit(&self, body: usize) -> Culprit {
        Culprit {
            called: "body",
            id: self.id(body),
            position: self.state.bodies.position_of(body),
            velocity: self.state.bodies.velocity_of(body),
        }
    }

    /// Moves bodies on, and finds what they conserve if that is wanted.
    fn attempt(&mut self, observed: bool, stop: Stop<'_>) -> Result<Found, ProgramError> {
        let mut field = self.state.field.get_mut().asking(observed, stop);
        self.state.scheme.step(&mut self.state.bodies, self.state.elapsed.dt, &mut field)?;
        let not_finite = self.state.bodies.not_finite();
        let seen = match observed && not_finite.is_none() {
            true => Some(Conserved::of(&self.state.bodies, field.energy(&self.state.bodies.position)?)),
            false => None,
        };
        Ok(Found { not_finite, seen })
    }

    fn keep(&mut self) {
        let Before { position, velocity, carried, evaluations } = &mut self.method.before;
        position.clone_from(&self.state.bodies.position);
        velocity.clone_from(&self.state.bodies.velocity);
        let now = self.state.scheme.carried();
        carried.resize_with(now.len(), Columns::default);
        carried.iter_mut().zip(now).for_each(|(to, from)| to.clone_from(from));
        *evaluations = self.state.field.get_mut().evaluations;
    }

    fn go_back(&mut self) {
        let Before { position, velocity, carried, evaluations } = &mut self.method.before;
        self.state.bodies.position.clone_from(position);
        self.state.bodies.velocity.clone_from(velocity);
        self.state.scheme.take_up(&self.state.bodies, std::mem::take(carried));
        self.state.field.get_mut().evaluations = *evaluations;
    }

    /// Bodies at no finite place, with the two that were the nearest to each other before.
    fn not_finite(&mut self, first: usize, count: usize) -> Failure {
        let before = match self.is_few() {
            true => self.method.last_encounter,
            false => self.method.encounters.nearest(&self.method.before.position, self.state.bodies.len()),
        };
        let culprit = self.culprit(first);
        let message = format!("{count} bodies are at no finite place, first body {}", culprit.id);
        let met =
            before.map_or(String::new(), |before| format!("; a step before, {}", self.met(&before, "were")));
        self.of_encounter(FailureKind::NOT_FINITE, message + &met, before).of(count as u64, [culprit])
    }

    /// Two bodies in words, that `are` or `were` near each other.
    fn met(&self, encounter: &Encounter, are: &str) -> String {
        let Encounter { bodies, distance, place: [x, y, z] } = *encounter;
        let [first, second] = bodies.map(|body| self.id(body));
        let place = format!("({}, {}, {})", significant(x, 6), significant(y, 6), significant(z, 6));
        let apart = match distance {
            0.0 => "both".to_owned(),
            distance => format!("{} apart", significant(distance, 3)),
        };
        let softened = match self.method.softening {
            0.0 => "nothing softens their attraction".to_owned(),
            softening => format!("their attraction is softened by {softening}"),
        };
        format!("bodies {first} and {second} {are} {apart} at {place}, and {softened}")
    }

    fn of_encounter(&self, kind: FailureKind, message: String, encounter: Option<Encounter>) -> Failure {
        let remedy = format!(
            "the time step is too long for how near bodies come: take a smaller integrator.dt (it is {}), or a law.softening above {}",
            self.state.elapsed.dt, self.method.softening
        );
        let distance = encounter.map(|it| ("distance", it.distance));
        Failure::new(kind, message, remedy).at(self.clock()).with(distance.into_iter().collect::<Vec<_>>())
    }

    /// Holds against each other what is conserved now and what it was at the start.
    fn sound(&self, seen: &Conserved) -> Result<(), Failure> {
        if !seen.is_finite() {
            let bodies = &self.state.bodies;
            let nearest = Encounters::default().nearest(&bodies.position, bodies.len());
            let met = nearest.map_or(String::new(), |nearest| format!("; {}", self.met(&nearest, "are")));
            let message = format!(
                "the kinetic energy is {} and the potential energy {}{met}",
                significant(seen.kinetic, 5),
                significant(seen.potential, 5)
            );
            let failure = self.of_encounter(FailureKind::OVERFLOW, message, nearest);
            let culprits = nearest.map_or(vec![], |it| it.bodies.map(|body| self.culprit(body)).to_vec());
            return Err(failure.of(culprits.len() as u64, culprits));
        }
        let energy = seen.energy();
        if !self.method.watch.is_unbound(energy) {
            return Ok(());
        }
        let nearest = self.method.watch.nearest_in_words(|body| self.id(body));
        let message = format!(
            "bodies that were bound are not any more: the energy was {} and is {}{}",
            significant(self.method.watch.start, 5),
            significant(energy, 5),
            nearest.map_or(String::new(), |words| format!("; {words}"))
        );
        let remedy = "the integrator loses the orbit: take a smaller dt, another integrator, or a softening";
        let failure = Failure::new(super::UNBOUND, message, remedy).at(self.clock());
        Err(failure.with([("energy", energy), ("energy_at_start", self.method.watch.start)]))
    }

    /// All that there is to be seen now.
    fn seen(&self) -> Seen {
        let conserved = self.conserved_or_nothing();
        Seen {
            time: self.clock().time,
            conserved,
            energy_error: self.method.watch.relative(conserved.energy()),
            balance_error: conserved.energy() - self.method.watch.start,
            half_mass_radius: half_mass_radius(&self.state.bodies, conserved.centre),
        }
    }

    /// The energy as it stands, and after how many steps.
    fn now(&self) -> (f64, u64) {
        (self.conserved_or_nothing().energy(), self.state.elapsed.steps)
    }
}

impl PerParticle for Moved {
    fn particles(&self) -> Particles {
        let mut particles = self.particles.clone();
        for (number, body) in particles.all_mut().iter_mut().enumerate() {
            body.position = self.bodies.position_of(number);
            body.velocity = self.bodies.velocity_of(number);
        }
        particles
    }
}

impl SteppedState for Moved {
    fn elapsed(&self) -> &Elapsed {
        &self.elapsed
    }

    fn per_particle(&self) -> &dyn PerParticle {
        self
    }

    fn check_ranks(&self) -> Result<(), Failure> {
        self.field.borrow().lost().map_or(Ok(()), |lost| Err(ended(lost, self.elapsed.clock())))
    }

    fn columns(&self) -> Vec<(String, Column)> {
        let count = self.bodies.len();
        let state = self.bodies.position.iter().chain(&self.bodies.velocity);
        let named = COLUMNS.iter().map(|name| (*name).to_owned());
        let carried = self.scheme.carried();
        let carried = carried.iter().enumerate().flat_map(|(order, columns)| {
            columns.iter().enumerate().map(move |(axis, column)| (format!("carried.{order}.{axis}"), column))
        });
        let taken = |column: &Vec<f64>| Column::F64(column.iter().take(count).copied().collect());
        named.zip(state).chain(carried).map(|(name, column)| (name, taken(column))).collect()
    }
}

impl Stepwise for Watched {
    type State = Moved;
    type Seen = Seen;
    const OBSERVABLES: &'static [Observable<Seen>] = &OBSERVABLES;

    fn step(run: &mut Stepped<Self>, interrupted: &AtomicBool) -> Result<bool, Failure> {
        let (steps, is_few) = (run.state.elapsed.steps + 1, run.is_few());
        // A step of few bodies is over before anybody would notice.
        let stop = || !is_few && interrupted.load(Ordering::Relaxed);
        if !is_few {
            run.keep();
        }
        let stepped = match run.attempt(run.is_look(steps) || run.is_row(steps), &stop) {
            Err(ProgramError::Interrupted) => {
                run.go_back();
                return Ok(false);
            }
            stepped => stepped?,
        };
        run.state.elapsed.steps = steps;
        *run.method.seen.get_mut() = stepped.seen.map(Ok);
        if let Some((first, count)) = stepped.not_finite {
            return Err(run.not_finite(first, count));
        }
        if run.is_look(steps) {
            run.method.last_encounter =
                run.method.encounters.nearest(&run.state.bodies.position, run.state.bodies.len());
        }
        let Some(seen) = stepped.seen else { return Ok(true) };
        run.sound(&seen)?;
        if run.is_look(steps) {
            run.method.watch.look(seen.energy(), run.method.last_encounter, steps);
        }
        Ok(true)
    }

    fn with_seen<R>(run: &Stepped<Self>, work: impl FnOnce(&Seen) -> R) -> R {
        work(&run.seen())
    }

    fn check(run: &Stepped<Self>) -> Result<(), Failure> {
        run.sound(&run.conserved()?)
    }

    fn keep(run: &Stepped<Self>, kept: &mut Snapshot) {
        kept.columns.extend(run.method.watch.columns());
        kept.add_sum("energy", run.method.watch.start);
        kept.add_count(EVALUATIONS, run.state.field.borrow().evaluations);
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
        // Before the first step nothing is carried.
        let orders = if clock.steps == 0 { 0 } else { run.state.scheme.carries() };
        let mut carried = vec![];
        for order in 0..orders {
            let [x, y, z] =
                [0, 1, 2].map(|axis| find(&format!("carried.{order}.{axis}")).map(<[f64]>::to_vec));
            carried.push([x?, y?, z?]);
        }
        run.state.scheme.take_up(&run.state.bodies, carried);
        run.state.elapsed.steps = clock.steps;
        run.state.field.get_mut().evaluations = evaluations;
        *run.method.seen.get_mut() = None;
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
        entries.into_iter().chain(watched).collect()
    }

    fn warnings(run: &Stepped<Self>) -> Vec<RunWarning> {
        // What drains energy on purpose does not keep it.
        let is_watched = !run.state.scheme.drains();
        let warning = is_watched
            .then(|| run.method.watch.warning(run.now(), run.state.elapsed.dt, |body| run.id(body)));
        warning.flatten().into_iter().collect()
    }

    fn in_words(run: &Stepped<Self>) -> String {
        let seen = run.seen();
        format!(
            "{} bodies; energy error {}, virial ratio {:.3}, momentum {}",
            run.state.bodies.len(),
            significant(seen.energy_error, 3),
            seen.virial_ratio(),
            significant(seen.momentum(), 2)
        )
    }
}

/// The distance from the centre of mass within which half of the mass is.
fn half_mass_radius(bodies: &Bodies, centre: [f64; 3]) -> f64 {
    let mut around: Vec<(f64, f64)> = (0..bodies.len())
        .map(|body| {
            let place = bodies.position_of(body);
            let way = [0, 1, 2].map(|axis| place[axis] - centre[axis]);
            (way.iter().map(|x| x * x).sum::<f64>().sqrt(), bodies.mass[body])
        })
        .collect();
    around.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * around.iter().map(|(_, mass)| mass).sum::<f64>();
    let mut inside = 0.0;
    let half_mass = around.iter().find(|(_, mass)| {
        inside += mass;
        inside >= half
    });
    // Half of a mass that is no number is nowhere.
    half_mass.map_or(f64::NAN, |(radius, _)| *radius)
}
