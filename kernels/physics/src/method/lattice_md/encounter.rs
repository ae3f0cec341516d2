//! Collision of two discs of a scene, alone in a box, as a scene of its own.

use crate::method::{EncounterGeometry, Prepared};
use toml::{Table, Value};

/// Tables of a scene that an encounter copies; gravity and moving walls are not among them.
const SHARED: [&str; 6] = ["format", "units", "method", "law", "integrator", "machine"];
/// Distance of the surfaces at the start, in sums of the radii.
const GAP: f64 = 0.1;
/// Side of the box, and centre of the disc at rest, in sums of the radii.
const SIDE: f64 = 40.0;
/// Duration, in flight times across the sum of the radii: the discs have separated by then.
const FLIGHT: f64 = 3.0;

/// Returns the scene of an encounter of two discs of mean radius and mass; none where nothing moves.
pub(super) fn encounter(
    prepared: &Prepared,
    EncounterGeometry { speed, offset }: EncounterGeometry,
) -> Option<String> {
    let grains = prepared.particles().grains();
    let count = grains.len() as f64;
    if !(speed > 0.0 && speed.is_finite()) || grains.is_empty() {
        return None;
    }
    let radius = grains.iter().map(|it| it.radius).sum::<f64>() / count;
    let mass = grains.iter().map(|it| it.mass).sum::<f64>() / count;
    let both = 2.0 * radius;
    let middle = 0.5 * SIDE * both;
    let before = both * ((1.0 - offset * offset).max(0.0).sqrt() + GAP);
    let pairs = |pairs: [[f64; 2]; 2]| Value::from(pairs.map(|pair| Value::from(pair.to_vec())).to_vec());
    let mut scene: Table = prepared.scene.parse().ok()?;
    scene.retain(|name, _| SHARED.contains(&name));
    let mut table = |name: &str, entries: &[(&str, Value)]| {
        let entries = entries.iter().map(|(name, value)| ((*name).to_owned(), value.clone()));
        scene.insert(name.to_owned(), Value::Table(entries.collect()));
    };
    let side = Value::from(SIDE * both);
    table(
        "domain",
        &[("sides", Value::from(vec![side.clone(), side])), ("periodic", Value::from(vec![false; 2]))],
    );
    table(
        "particles",
        &[
            ("generate", Value::from("list")),
            ("positions", pairs([[middle - before, middle], [middle, middle + offset * both]])),
            ("velocities", pairs([[0.5 * speed, 0.0], [-0.5 * speed, 0.0]])),
            ("radius", Value::from(radius)),
            ("mass", Value::from(mass)),
        ],
    );
    table("run", &[("time", Value::from(FLIGHT * both / speed))]);
    Some(scene.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::lattice_md::keys::STIFFNESS;
    use crate::method::{METHODS, StartPurpose, prepare, vocabularies};
    use crate::scene::SceneValues;
    use std::sync::atomic::AtomicBool;
    use stripmine_kernels::law::spring::Spring;

    /// Relative velocities before and after an encounter in a scene with a damping, integrated with a step.
    fn speeds(damping: f64, encounter: EncounterGeometry, step: f64) -> [[f64; 2]; 2] {
        let known = vocabularies(METHODS);
        let overrides = ["particles.count=100".to_owned(), format!("law.normal_damping={damping}")];
        let (gas, _) = prepare(SceneValues::load("dense-gas", &overrides, &known).unwrap(), METHODS).unwrap();
        let text = super::encounter(&gas, encounter).unwrap();
        let step = format!("integrator.dt={step}");
        let values = SceneValues::parse("encounter", &text, &[step], &known).unwrap();
        let (scene, _) = prepare(values, METHODS).unwrap();
        let mut simulation = scene.start(StartPurpose::Run).unwrap();
        simulation.advance(&[scene.schedule.until], &AtomicBool::new(false)).unwrap();
        [scene.particles().clone(), simulation.particles()].map(|particles| {
            let [a, b] = [0, 1].map(|at| particles.grains()[at].planar_velocity());
            [a[0] - b[0], a[1] - b[1]]
        })
    }

    /// Head-on discs separate with the restitution of the law, checked by another solver; beyond contact they fly on; an elastic encounter conserves
    /// the speed.
    #[test]
    fn encounter_restitution_matches_the_law() {
        let known = vocabularies(METHODS);
        let gas = SceneValues::load("dense-gas", &["particles.count=100".to_owned()], &known).unwrap();
        let stiffness = gas.number(&STIFFNESS).unwrap();
        let (prepared, _) = prepare(gas, METHODS).unwrap();
        let mass = prepared.particles().grains()[0].mass;
        let head_on = EncounterGeometry { speed: 0.3, offset: 0.0 };
        for damping in [0.0, 1.0, 4.0] {
            let [before, after] = speeds(damping, head_on, 1e-4);
            let expected = match damping {
                0.0 => 1.0,
                _ => Spring::Hertz.impact(2.0 * stiffness / mass, damping, 0.3).restitution,
            };
            assert!((before[0] - 0.3).abs() < 1e-12 && before[1] == 0.0, "{before:?}");
            assert!((-after[0] / 0.3 - expected).abs() < 1e-3, "{damping}: {after:?}, {expected}");
        }
        let [before, after] = speeds(1.0, EncounterGeometry { offset: 1.01, ..head_on }, 1e-3);
        assert_eq!(before, after);
        let [_, after] = speeds(0.0, EncounterGeometry { offset: 0.5, ..head_on }, 1e-4);
        assert!((after[0].hypot(after[1]) / 0.3 - 1.0).abs() < 1e-6 && after[1].abs() > 0.1, "{after:?}");
    }
}
