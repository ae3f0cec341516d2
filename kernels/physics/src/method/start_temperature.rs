//! Temperature of a generated start compared with the one that the scene asks for.

use super::{Fact, Prepared};
use crate::number::significant;
use crate::observe::{AxisMotion, conserved_axes, temperature};
use crate::particles::{Particle, Particles};
use crate::scene::{Key, KeySet, KeyValueKind, SceneValues, TEMPERATURE};
use serde_json::json;

/// Relative difference worth reporting.
const WORTH_A_WORD: f64 = 0.01;

/// The name of the fact.
pub(crate) const START_TEMPERATURE: &str = "start_temperature";

/// Temperature requested for a generated start; none where a bath or a wall sets the temperature.
pub(super) fn requested_temperature(values: &SceneValues, keys: &KeySet) -> Option<f64> {
    let keeps =
        |key: &&Key| key.name.ends_with("_temperature") && matches!(key.kind, KeyValueKind::Number(_));
    let is_kept = keys.keys().filter(keeps).any(|key| values.is_used(key));
    let is_asked = !is_kept && values.is_given(&TEMPERATURE) && values.is_used(&TEMPERATURE);
    values.number(&TEMPERATURE).filter(|asked| is_asked && *asked > 0.0)
}

/// Reports a start whose temperature differs from the requested one: velocities are drawn, and nothing corrects them later.
pub(super) fn start_temperature(asked: f64, prepared: &Prepared) -> Option<Fact> {
    let found = temperature_of(prepared.particles(), conserved_axes(&prepared.domain));
    if !found.is_finite() || (found / asked - 1.0).abs() <= WORTH_A_WORD {
        return None;
    }
    let needed = if found > 0.0 { asked * (asked / found) } else { f64::NAN };
    let words = format!(
        "{}, not the requested `{}` = {asked}: velocities are drawn at random, and no bath corrects them",
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

/// Temperature of the grains about their mean motion along axes that conserve momentum.
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

    /// The suggested setting starts with the requested temperature: the same draws, scaled. With a bath, or a small difference, there is no report.
    #[test]
    fn start_temperature_deviation_is_reported_with_remedy() {
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
            assert!(words.contains("not the requested `particles.temperature` = 0.1"), "{words}");
            let remedy = words.rsplit("; ").next().unwrap().split(" starts").next().unwrap().replace(' ', "");
            let scaled = said(scene, &[&sets[..], &[&remedy]].concat()).unwrap();
            assert!(scaled.starts_with("0.1, not the requested"), "{words}: {scaled}");
        }
        assert_eq!(said("langevin-free", &["particles.count=10"]), None);
        assert_eq!(said("hard-disks", &["particles.count=200000"]), None);
        assert_eq!(said("hot-floor", &["particles.count=10"]), None);
    }
}
