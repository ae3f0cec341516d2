//! Events per particle in a time: contacts that begin, or, without contacts, turns of the velocity. A comparison over a time with hardly any
//! events says nothing about a scene.

use super::growth::own_in_full_precision;
use crate::study::StudyError;
use crate::study::runs::StudyRuns;
use crate::study::trial::RunSampling;
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, HashSet};
use std::f64::consts::{PI, TAU};
use stripmine_physics::domain::Domain;
use stripmine_physics::method::{Simulation, StartPurpose};
use stripmine_physics::near::NeighbourSearch;
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::Overrides;

/// Most samples of a run: contacts that begin and end between two samples are missed.
const LOOKS: u64 = 1024;

/// Mean number of events per particle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ParticleEvents {
    /// True if contacts are counted, false for turns of the velocity.
    pub(crate) of_contacts: bool,
    /// Contacts that begin, including those of the start; or full turns of the velocity.
    pub(crate) each: f64,
}

impl ParticleEvents {
    pub(crate) fn name(&self) -> &'static str {
        if self.of_contacts { "contacts" } else { "turns of the velocity" }
    }
}

/// Counts events along a run of the scene's own configuration at some step (time), over `duration` (time). If the run fails, events before the
/// failure count.
///
/// # Errors
/// [`StudyError`] as for [`StudyRuns::recall`].
pub(crate) fn encounters(
    runs: &StudyRuns<'_>,
    step: f64,
    duration: f64,
    each: f64,
) -> Result<ParticleEvents, StudyError> {
    let of_contacts = runs.subject.trials.has_contacts;
    let fits = |it: &ParticleEvents| it.of_contacts == of_contacts && it.each.is_finite() && it.each >= 0.0;
    let counted = runs.recall("encounters", fits, || {
        let mut counts = (ContactCounter::new(runs.subject.prepared.domain), TurnCounter::default());
        let scene =
            runs.subject.prepared_as(&own_in_full_precision(runs.subject), step, &Overrides::new())?;
        let steps = (duration / step).round() as u64;
        let course = RunSampling { steps, looks: LOOKS.min(steps), each };
        let look = |simulation: &dyn Simulation| {
            let particles = simulation.particles();
            if of_contacts { counts.0.look(&particles) } else { counts.1.look(&particles) }
        };
        match runs.follow(&scene, StartPurpose::Measurement, course, look) {
            Err(failure) if failure.is_interruption() => return Err(failure),
            Ok(_) | Err(_) => {}
        }
        let grains = runs.subject.prepared.particles().grain_count().max(1) as f64;
        let all = if of_contacts { counts.0.begun as f64 } else { counts.1.angle / TAU };
        Ok(ParticleEvents { of_contacts, each: all / grains })
    })?;
    // A scene that is refused has no events.
    Ok(counted.unwrap_or(ParticleEvents { of_contacts, each: 0.0 }))
}

/// Counter of contacts that begin.
struct ContactCounter {
    domain: Domain,
    standing: HashSet<[u32; 2]>,
    /// Number so far: a contact between two grains counts for each.
    begun: u64,
}

impl ContactCounter {
    fn new(domain: Domain) -> ContactCounter {
        ContactCounter { domain, standing: HashSet::new(), begun: 0 }
    }

    fn look(&mut self, particles: &Particles) {
        let (discs, grains) = (particles.all(), particles.grain_count());
        let largest = particles.radii().map_or(0.0, |[_, largest]| largest);
        let places = discs.iter().map(|disc| self.domain.wrapped(disc.planar_position()));
        let near = NeighbourSearch::over_positions(self.domain, places, 2.0 * largest);
        let mut standing = HashSet::new();
        for (disc, number) in discs[..grains].iter().zip(0_u32..) {
            let place = self.domain.wrapped(disc.planar_position());
            for (other, there) in near.candidates_near(place).filter(|(other, _)| *other > number) {
                let partner = &discs[other as usize];
                if self.domain.distance(place, there) < disc.radius + partner.radius {
                    let pair = [disc.id, partner.id];
                    if standing.insert(pair) && !self.standing.contains(&pair) {
                        self.begun += if (other as usize) < grains { 2 } else { 1 };
                    }
                }
            }
        }
        self.standing = standing;
    }
}

/// Counter of turns of the velocity.
#[derive(Default)]
struct TurnCounter {
    directions: HashMap<u32, f64>,
    /// Total angle so far, summed over the particles (radian).
    angle: f64,
}

impl TurnCounter {
    fn look(&mut self, particles: &Particles) {
        for body in particles.grains() {
            let [u, v] = body.planar_velocity();
            if u == 0.0 && v == 0.0 {
                continue;
            }
            let direction = libm::atan2(v, u);
            if let Some(before) = self.directions.insert(body.id, direction) {
                let turn = (direction - before).abs();
                self.angle += if turn > PI { TAU - turn } else { turn };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::particles::{Particle, ParticleKind, in_space};

    fn disc(id: u32, kind: ParticleKind, x: f64, velocity: [f64; 2]) -> Particle {
        Particle {
            id,
            kind,
            species: 0,
            position: in_space([x, 1.0]),
            velocity: in_space(velocity),
            angle: 0.0,
            omega: 0.0,
            radius: 0.5,
            mass: 1.0,
        }
    }

    /// By hand: a contact across the periodic side, which ends and begins again, and one with a wall disc.
    #[test]
    fn a_contact_counts_when_it_begins() {
        let domain = Domain::planar([0.0; 2], [10.0, 4.0], [true, false]);
        let mut contacts = ContactCounter::new(domain);
        let mut look = |x: [f64; 3]| {
            let kinds = [ParticleKind::Grain, ParticleKind::Grain, ParticleKind::Wall];
            let all = kinds.iter().zip(x).zip(1..);
            contacts.look(&Particles::new(all.map(|((&kind, x), id)| disc(id, kind, x, [0.0; 2])).collect()));
            contacts.begun
        };
        let seen = [[0.2, 9.5, 5.0], [0.2, 9.4, 5.0], [0.2, 9.1, 5.0], [0.2, 9.4, 1.1], [0.2, 9.4, 1.1]]
            .map(&mut look);
        assert_eq!(seen, [2, 2, 2, 5, 5]);
    }

    #[test]
    fn circle_counts_as_one_turn() {
        let mut turns = TurnCounter::default();
        for step in 0..=16 {
            let angle = TAU * f64::from(step) / 16.0;
            let velocities = [[angle.cos(), angle.sin()], [angle.cos(), -angle.sin()]];
            let all = velocities.iter().zip(1..);
            turns.look(&Particles::new(all.map(|(&v, id)| disc(id, ParticleKind::Grain, 2.0, v)).collect()));
        }
        assert!((turns.angle / TAU - 2.0).abs() < 1e-12, "{}", turns.angle);
    }
}
