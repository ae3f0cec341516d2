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
use crate::method::observed::values;
use crate::method::{Clock, Culprit, Failure, FailureKind, Purpose, RunWarning, Simulation, Snapshot, Until};
use crate::number::significant;
use crate::particles::Particles;
use serde_json::{Map, Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use stripmine_kernels::isa::ProgramError;

/// Bodies are looked at this often (steps), and so few of them at every step: whether they are still bound, the error of their energy,
/// and the nearest two.
const BETWEEN_LOOKS: u64 = 64;
const FEW: usize = 64;

/// How often forces were found, in a checkpoint and in the summary.
const EVALUATIONS: &str = "evaluations";

const COLUMNS: [&str; 6] = ["x", "y", "z", "vx", "vy", "vz"];

/// Bodies under way.
pub(super) struct Running {
    dt: f64,
    softening: f64,
    pub(super) bodies: Bodies,
    scheme: Box<dyn Scheme>,
    /// Observing needs the energy of the pairs, which is found as forces are.
    pub(super) field: RefCell<Attraction>,
    particles: Particles,
    steps: u64,
    /// Rows are observed after multiples of this number of steps, and the last state after the other; none in a measurement.
    rows: Option<[u64; 2]>,
    watch: Watch,
    encounters: Encounters,
    /// The nearest two bodies at the last look.
    last_encounter: Option<Encounter>,
    before: Before,
    /// What the state conserves, where that was asked for already.
    seen: RefCell<Option<Result<Conserved, ProgramError>>>,
    seconds: f64,
}

/// The state before a step of many bodies, to which a step that is interrupted goes back.
#[derive(Default)]
struct Before {
    position: Columns,
    velocity: Columns,
    carried: Vec<Columns>,
    evaluations: u64,
}

/// What a step found.
struct Stepped {
    /// The first body that is at no finite place, and how many there are.
    not_finite: Option<(usize, usize)>,
    /// Where it was observed.
    seen: Option<Conserved>,
}

impl Running {
    /// At the start.
    ///
    /// # Errors
    /// [`Failure`] if the processor lacks what is asked for, or bodies cannot be dealt out to so many ranks.
    pub(super) fn new(checked: &Checked, purpose: Purpose) -> Result<Running, Failure> {
        let scene = &checked.scene;
        let all = checked.particles.all();
        let bodies = Bodies::new(all.iter().map(|body| (body.position, body.velocity, body.mass)));
        let mut field = Attraction::new(scene, &bodies)?;
        let potential = field.potential(&bodies.position, &never)?;
        let start = Conserved::of(&bodies, potential);
        let (mut watch, mut encounters) = (Watch::new(&start), Encounters::default());
        let nearest = encounters.nearest(&bodies.position, bodies.len());
        watch.look(start.energy(), nearest, 0);
        Ok(Running {
            dt: scene.dt,
            softening: scene.softening,
            scheme: scene.scheme.scheme(scene.damping),
            field: RefCell::new(field),
            particles: checked.particles.clone(),
            steps: 0,
            rows: (purpose == Purpose::Run).then_some([scene.run.thermo_every, scene.run.steps]),
            watch,
            encounters,
            last_encounter: nearest,
            before: Before::default(),
            seen: RefCell::new(Some(Ok(start))),
            seconds: 0.0,
            bodies,
        })
    }

    fn is_few(&self) -> bool {
        self.bodies.len() <= FEW
    }

    /// Whether a look is due after a number of steps.
    fn is_look(&self, steps: u64) -> bool {
        self.is_few() || steps.is_multiple_of(BETWEEN_LOOKS)
    }

    /// Whether a row, or the end, is due after a number of steps.
    fn is_row(&self, steps: u64) -> bool {
        self.rows.is_some_and(|[every, last]| steps == last || (every > 0 && steps.is_multiple_of(every)))
    }

    /// What the state conserves; found once.
    fn conserved(&self) -> Result<Conserved, ProgramError> {
        let found = || {
            let potential = self.field.borrow_mut().potential(&self.bodies.position, &never)?;
            Ok(Conserved::of(&self.bodies, potential))
        };
        self.seen.borrow_mut().get_or_insert_with(found).clone()
    }

    /// The same; no numbers where the pairs' energy could not be found, which [`Simulation::check`] has said before.
    fn conserved_or_nothing(&self) -> Conserved {
        self.conserved().unwrap_or_else(|_| Conserved::of(&self.bodies, f64::NAN))
    }

    fn id(&self, body: usize) -> u32 {
        self.particles.all()[body].id
    }

    fn culprit(&self, body: usize) -> Culprit {
        Culprit {
            called: "body",
            id: self.id(body),
            position: self.bodies.position_of(body),
            velocity: self.bodies.velocity_of(body),
        }
    }

    /// A step, unless it is interrupted: then the state is the one before it, and nothing is given.
    fn step(&mut self, interrupted: &AtomicBool) -> Result<bool, Failure> {
        let (steps, is_few) = (self.steps + 1, self.is_few());
        // A step of few bodies is over before anybody would notice.
        let stop = || !is_few && interrupted.load(Ordering::Relaxed);
        if !is_few {
            self.keep();
        }
        let stepped = match self.attempt(self.is_look(steps) || self.is_row(steps), &stop) {
            Err(ProgramError::Interrupted) => {
                self.go_back();
                return Ok(false);
            }
            stepped => stepped?,
        };
        self.steps = steps;
        *self.seen.get_mut() = stepped.seen.map(Ok);
        if let Some((first, count)) = stepped.not_finite {
            return Err(self.not_finite(first, count));
        }
        if self.is_look(steps) {
            self.last_encounter = self.encounters.nearest(&self.bodies.position, self.bodies.len());
        }
        let Some(seen) = stepped.seen else { return Ok(true) };
        self.sound(&seen)?;
        if self.is_look(steps) {
            self.watch.look(seen.energy(), self.last_encounter, steps);
        }
        Ok(true)
    }

    /// Moves bodies on, and finds what they conserve if that is wanted.
    fn attempt(&mut self, observed: bool, stop: Stop<'_>) -> Result<Stepped, ProgramError> {
        let mut field = self.field.get_mut().asking(observed, stop);
        self.scheme.step(&mut self.bodies, self.dt, &mut field)?;
        let not_finite = self.bodies.not_finite();
        let seen = match observed && not_finite.is_none() {
            true => Some(Conserved::of(&self.bodies, field.energy(&self.bodies.position)?)),
            false => None,
        };
        Ok(Stepped { not_finite, seen })
    }

    fn keep(&mut self) {
        let Before { position, velocity, carried, evaluations } = &mut self.before;
        position.clone_from(&self.bodies.position);
        velocity.clone_from(&self.bodies.velocity);
        let now = self.scheme.carried();
        carried.resize_with(now.len(), Columns::default);
        carried.iter_mut().zip(now).for_each(|(to, from)| to.clone_from(from));
        *evaluations = self.field.get_mut().evaluations;
    }

    fn go_back(&mut self) {
        let Before { position, velocity, carried, evaluations } = &mut self.before;
        self.bodies.position.clone_from(position);
        self.bodies.velocity.clone_from(velocity);
        self.scheme.take_up(&self.bodies, std::mem::take(carried));
        self.field.get_mut().evaluations = *evaluations;
    }

    /// Bodies at no finite place, with the two that were the nearest to each other before.
    fn not_finite(&mut self, first: usize, count: usize) -> Failure {
        let before = match self.is_few() {
            true => self.last_encounter,
            false => self.encounters.nearest(&self.before.position, self.bodies.len()),
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
        let softened = match self.softening {
            0.0 => "nothing softens their attraction".to_owned(),
            softening => format!("their attraction is softened by {softening}"),
        };
        format!("bodies {first} and {second} {are} {apart} at {place}, and {softened}")
    }

    fn of_encounter(&self, kind: FailureKind, message: String, encounter: Option<Encounter>) -> Failure {
        let remedy = format!(
            "the time step is too long for how near bodies come: take a smaller integrator.dt (it is {}), or a law.softening above {}",
            self.dt, self.softening
        );
        let distance = encounter.map(|it| ("distance", it.distance));
        Failure::new(kind, message, remedy).at(self.clock()).with(distance.into_iter().collect::<Vec<_>>())
    }

    /// Holds against each other what is conserved now and what it was at the start.
    fn sound(&self, seen: &Conserved) -> Result<(), Failure> {
        if !seen.is_finite() {
            let bodies = &self.bodies;
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
        if !self.watch.is_unbound(energy) {
            return Ok(());
        }
        let nearest = self.watch.nearest_in_words(|body| self.id(body));
        let message = format!(
            "bodies that were bound are not any more: the energy was {} and is {}{}",
            significant(self.watch.start, 5),
            significant(energy, 5),
            nearest.map_or(String::new(), |words| format!("; {words}"))
        );
        let remedy = "the integrator loses the orbit: take a smaller dt, another integrator, or a softening";
        let failure = Failure::new(super::UNBOUND, message, remedy).at(self.clock());
        Err(failure.with([("energy", energy), ("energy_at_start", self.watch.start)]))
    }

    /// All that there is to be seen now.
    fn seen(&self) -> Seen {
        let conserved = self.conserved_or_nothing();
        Seen {
            time: self.clock().time,
            conserved,
            energy_error: self.watch.relative(conserved.energy()),
            balance_error: conserved.energy() - self.watch.start,
            half_mass_radius: half_mass_radius(&self.bodies, conserved.centre),
        }
    }

    /// The energy as it stands, and after how many steps.
    fn now(&self) -> (f64, u64) {
        (self.conserved_or_nothing().energy(), self.steps)
    }
}

impl Simulation for Running {
    fn advance(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), Failure> {
        let begun = Instant::now();
        while !until.iter().any(|moment| moment.has_come(&self.clock())) {
            if interrupted.load(Ordering::Relaxed) || !self.step(interrupted)? {
                break;
            }
        }
        self.seconds += begun.elapsed().as_secs_f64();
        Ok(())
    }

    fn clock(&self) -> Clock {
        Clock { steps: self.steps, time: self.steps as f64 * self.dt, events: 0 }
    }

    fn time_step(&self) -> Option<f64> {
        Some(self.dt)
    }

    fn particles(&self) -> Particles {
        let mut particles = self.particles.clone();
        for (number, body) in particles.all_mut().iter_mut().enumerate() {
            body.position = self.bodies.position_of(number);
            body.velocity = self.bodies.velocity_of(number);
        }
        particles
    }

    fn check(&self) -> Result<(), Failure> {
        self.sound(&self.conserved()?)
    }

    fn observe(&self) -> Vec<f64> {
        values(&OBSERVABLES, &self.seen())
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
        kept.columns.extend(self.watch.columns());
        kept.add_sum("energy", self.watch.start);
        kept.add_count(EVALUATIONS, self.field.borrow().evaluations);
        kept
    }

    fn restore(&mut self, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        clock.of_steps(self.dt)?;
        let count = self.bodies.len();
        let find = |name: &str| snapshot.numbers(name, count);
        let (energy, evaluations) = (snapshot.sum("energy")?, snapshot.count(EVALUATIONS)?);
        self.watch.take_up(energy, &snapshot.columns, count)?;
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
        self.steps = clock.steps;
        self.field.get_mut().evaluations = evaluations;
        *self.seen.get_mut() = None;
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
        let (energy, _) = self.now();
        let entries = [
            ("bodies", json!(self.bodies.len())),
            ("energy", json!(energy)),
            ("energy_error", json!(self.watch.relative(energy))),
            (EVALUATIONS, json!(self.field.borrow().evaluations)),
            ("order", json!(self.scheme.order())),
        ];
        let watched = self.watch.entries(self.now(), |body| self.id(body));
        entries.into_iter().chain(watched).map(|(name, value)| (name.to_owned(), value)).collect()
    }

    fn warnings(&self) -> Vec<RunWarning> {
        // What drains energy on purpose does not keep it.
        let is_watched = !self.scheme.drains();
        let warning = is_watched.then(|| self.watch.warning(self.now(), self.dt, |body| self.id(body)));
        warning.flatten().into_iter().collect()
    }

    fn in_words(&self) -> String {
        let seen = self.seen();
        format!(
            "{} bodies; energy error {}, virial ratio {:.3}, momentum {}",
            self.bodies.len(),
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
