//! Temperature of a start beside the one that the scene asks for.

use super::{Fact, Prepared};
use crate::number::significant;
use crate::observe::{AxisMotion, conserved_axes, temperature};
use crate::particles::{Particle, Particles};
use crate::scene::{KeySet, TEMPERATURE, Values};
use serde_json::json;

/// A difference that is worth a word, as a part of what was asked for.
const WORTH_A_WORD: f64 = 0.01;

/// The name of the fact.
pub(crate) const START_TEMPERATURE: &str = "start_temperature";

/// The temperature that a generated start is asked to have; none where a bath or a wall brings it to its own.
pub(super) fn asked_temperature(values: &Values, keys: &KeySet) -> Option<f64> {
    let is_kept = keys.keys().any(|key| key.name.ends_with("_temperature") && values.is_used(key));
    let is_asked = !is_kept && values.gives(&TEMPERATURE) && values.is_used(&TEMPERATURE);
    values.number(&TEMPERATURE).filter(|asked| is_asked && *asked > 0.0)
}

/// Says where the start's temperature is not the one that was asked for: velocities are drawn, and nothing brings them there later.
pub(super) fn start_temperature(asked: f64, prepared: &Prepared) -> Option<Fact> {
    let found = temperature_of(prepared.particles(), conserved_axes(&prepared.domain));
    if !found.is_finite() || (found / asked - 1.0).abs() <= WORTH_A_WORD {
        return None;
    }
    let needed = if found > 0.0 { asked * (asked / found) } else { f64::NAN };
    let words = format!(
        "{}, where `{}` = {asked} was asked for: velocities are drawn at random, and no bath brings them there",
        significant(found, 4),
        TEMPERATURE.path()
    );
    let remedy = if needed.is_finite() {
        format!("; {} = {} starts with {asked}", TEMPERATURE.path(), significant(needed, 5))
    } else {
        String::new()
    };
    let data = json!({ "asked": asked, "found": found });
    Some(Fact::new(START_TEMPERATURE, data, "temperature of the start", words + &remedy))
}

/// Temperature of the grains, about their mean motion along axes that conserve it.
fn temperature_of(particles: &Particles, conserved: [bool; 2]) -> f64 {
    let grains = particles.grains();
    let sum = |of: &dyn Fn(&Particle) -> f64| grains.iter().map(of).sum::<f64>();
    let motion = [0, 1].map(|axis| AxisMotion {
        twice_kinetic: sum(&|grain| grain.mass * grain.velocity[axis] * grain.velocity[axis]),
        momentum: sum(&|grain| grain.mass * grain.velocity[axis]),
    });
    temperature(motion, conserved, sum(&|grain| grain.mass), grains.len() as f64)
}

#[cfg(test)]
mod tests {
    use crate::method::{METHODS, load};

    /// What is said to start with a temperature does: the same draws, scaled. Where a bath is, or the difference is small, nothing is said.
    #[test]
    fn a_start_that_is_colder_than_asked_is_said_to_be() {
        let said = |scene: &str, sets: &[&str]| {
            let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
            let (prepared, _) = load(scene, &sets, METHODS).unwrap();
            let facts = prepared.facts.iter().filter_map(|fact| fact.words.clone());
            facts.filter(|(label, _)| *label == "temperature of the start").map(|(_, words)| words).next()
        };
        for (scene, sets) in [
            ("hard-disks", ["particles.count=50", "particles.seed=11", "domain.periodic=[false, false]"]),
            ("dense-gas", ["particles.count=50", "particles.seed=3", "particles.temperature=0.1"]),
        ] {
            let temperature = "particles.temperature=0.1";
            let sets = [
                &sets[..],
                &["domain.sides=[30, 30]", "particles.generate=random", "particles.radius=0.5", temperature],
            ]
            .concat();
            let words = said(scene, &sets).unwrap();
            assert!(words.contains("= 0.1 was asked for"), "{words}");
            let remedy = words.rsplit("; ").next().unwrap().split(" starts").next().unwrap().replace(' ', "");
            let scaled = said(scene, &[&sets[..], &[&remedy]].concat()).unwrap();
            assert!(scaled.starts_with("0.1, where"), "{words}: {scaled}");
        }
        assert_eq!(said("langevin-free", &["particles.count=10"]), None);
        assert_eq!(said("hard-disks", &["particles.count=200000"]), None);
        assert_eq!(said("hot-floor", &["particles.count=10"]), None);
    }
}
