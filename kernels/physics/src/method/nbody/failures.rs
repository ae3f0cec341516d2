//! Failures of a simulation of bodies: what broke, the bodies nearest to each other, and what to do.

use super::conserved::ConservedQuantities;
use super::encounter::{NearestPair, NearestPairSearch};
use super::simulation::NbodySimulation;
use crate::method::{FailureKind, PhysicsFailure};
use crate::number::significant;

impl NbodySimulation {
    /// Advice for a smaller energy error.
    pub(super) fn accuracy_remedy(&self) -> &'static str {
        match self.state.scheme.adaptive_steps() {
            None => {
                "lower integrator.dt, set integrator.kind = \"ias15\" or another of higher order, or raise law.softening"
            }
            Some(_) => "lower integrator.tolerance, or raise law.softening",
        }
    }

    /// Failure of a step that the clock cannot resolve: the nearest bodies collide.
    pub(super) fn unresolved(&self, time: f64, step: f64) -> PhysicsFailure {
        let bodies = &self.state.bodies;
        let nearest = NearestPairSearch::default().nearest(&bodies.position, bodies.len());
        let met = nearest
            .map_or(String::new(), |nearest| format!(": {}", self.encounter_in_words(&nearest, "are")));
        let message = format!(
            "at time {}, the motion needs a step of {}, which the time cannot resolve{met}",
            significant(time, 10),
            significant(step, 3)
        );
        let failure = self.of_encounter(super::COLLISION, message, nearest);
        let culprits = nearest.map_or(vec![], |it| it.bodies.map(|body| self.culprit(body)).to_vec());
        failure.of(culprits.len() as u64, culprits)
    }

    /// Failure of bodies whose state is not finite, with the nearest pair before the step.
    pub(super) fn not_finite(&mut self, first: usize, count: usize) -> PhysicsFailure {
        let before = match self.is_few() {
            true => self.method.last_encounter,
            false => self.method.encounters.nearest(&self.method.before.position, self.state.bodies.len()),
        };
        let culprit = self.culprit(first);
        let message = format!(
            "the positions or velocities of {count} bodies are not finite, first body {}",
            culprit.id
        );
        let met = before.map_or(String::new(), |before| {
            format!("; one step before, {}", self.encounter_in_words(&before, "were"))
        });
        self.of_encounter(FailureKind::NOT_FINITE, message + &met, before).of(count as u64, [culprit])
    }

    /// Describes a pair of bodies that `are` or `were` near each other.
    fn encounter_in_words(&self, encounter: &NearestPair, are: &str) -> String {
        let NearestPair { bodies, distance, place: [x, y, z] } = *encounter;
        let [first, second] = bodies.map(|body| self.id(body));
        let place = format!("({}, {}, {})", significant(x, 6), significant(y, 6), significant(z, 6));
        let apart = match distance {
            0.0 => "both".to_owned(),
            distance => format!("{} apart", significant(distance, 3)),
        };
        let softened = match self.method.softening {
            0.0 => "their attraction is not softened".to_owned(),
            softening => format!("their attraction is softened by {softening}"),
        };
        format!("bodies {first} and {second} {are} {apart} at {place}, and {softened}")
    }

    fn of_encounter(
        &self,
        kind: FailureKind,
        message: String,
        encounter: Option<NearestPair>,
    ) -> PhysicsFailure {
        let remedy = match self.state.scheme.adaptive_steps() {
            None => format!(
                "the time step is too long for this encounter: lower integrator.dt (it is {}), raise law.softening above {}, or \
                 set integrator.kind = \"ias15\", whose steps adapt",
                self.state.elapsed.dt, self.method.softening
            ),
            Some(_) => "points that collide have no motion afterwards: set law.softening above 0, or end the run before".to_owned(),
        };
        let distance = encounter.map(|it| ("distance", it.distance));
        PhysicsFailure::new(kind, message, remedy)
            .at(self.clock())
            .with(distance.into_iter().collect::<Vec<_>>())
    }

    /// Checks the conserved quantities against those at the start.
    pub(super) fn check_conserved(&self, seen: &ConservedQuantities) -> Result<(), PhysicsFailure> {
        if !seen.is_finite() {
            let bodies = &self.state.bodies;
            let nearest = NearestPairSearch::default().nearest(&bodies.position, bodies.len());
            let met = nearest
                .map_or(String::new(), |nearest| format!("; {}", self.encounter_in_words(&nearest, "are")));
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
            "the bodies have become unbound: the energy was {} at the start and is {} now{}",
            significant(self.method.watch.start, 5),
            significant(energy, 5),
            nearest.map_or(String::new(), |words| format!("; {words}"))
        );
        let remedy = format!("the integrator loses the orbit: {}", self.accuracy_remedy());
        let failure = PhysicsFailure::new(super::UNBOUND, message, remedy).at(self.clock());
        Err(failure.with([("energy", energy), ("energy_at_start", self.method.watch.start)]))
    }
}
