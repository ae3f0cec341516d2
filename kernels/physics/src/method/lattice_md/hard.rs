//! Hard-disc twin of a scene of soft discs: the limit of stiff contacts, for scenes that hard discs can represent.

use super::keys::{COHESIONLESS, FRICTION, LAW, NORMAL_DAMPING, SHEAR_DAMPING, STIFFNESS};
use super::wall_keys::WALLS;
use crate::method::hard_disks::keys::RESTITUTION;
use crate::method::{Prepared, TranslatedScene, Until};
use crate::observe::{AxisMotion, conserved_axes, temperature};
use crate::scene::{DT, Key, KeyValue, SceneValues};
use crate::words::Words;
use std::f64::consts::PI;
use stripmine_kernels::law::spring::Spring;
use toml::{Table, Value as Toml};

/// Tables with the same meaning in both methods.
const SHARED: [&str; 4] = ["format", "units", "domain", "particles"];
/// Rows of a run.
const ROWS: f64 = 100.0;

/// Returns the scene of hard discs. None if there are walls, closed sides or friction, if a single disc has no temperature, or if the quantity has no
/// counterpart.
///
/// The restitution is that of an impact at the mean collision speed at the temperature of the start.
pub(super) fn hard(values: &SceneValues, prepared: &Prepared, quantity: &str) -> Option<TranslatedScene> {
    let particles = prepared.particles();
    let (discs, grains) = (particles.grain_count(), particles.grains());
    let is_zero = |key: &Key| values.number(key) == Some(0.0);
    let has_planes = values.is_given(&WALLS);
    let is_free = discs == particles.len() && prepared.domain.periodic() == [true; 2] && !has_planes;
    let is_smooth = is_zero(&FRICTION) && is_zero(&SHEAR_DAMPING);
    if !is_free || !is_smooth || values.value(&COHESIONLESS) != Some(KeyValue::Switch(true)) {
        return None;
    }
    let all_mass = grains.iter().map(|it| it.mass).sum::<f64>();
    let motion = [0, 1].map(|axis| AxisMotion {
        twice_kinetic: grains.iter().map(|it| it.mass * it.velocity[axis].powi(2)).sum(),
        momentum: grains.iter().map(|it| it.mass * it.velocity[axis]).sum(),
    });
    // A common drift is not heat: it changes nothing between discs.
    let temperature = temperature(motion, conserved_axes(&prepared.domain), all_mass, discs as f64);
    if temperature.is_nan() {
        return None;
    }
    let mass = all_mass / discs as f64;
    let damping = values.number(&NORMAL_DAMPING)?;
    let restitution = if damping == 0.0 {
        1.0
    } else {
        let speed = (PI * temperature / mass).sqrt();
        let spring = values.choice(&LAW).and_then(|word| Spring::parse(&word))?;
        spring.impact(2.0 * values.number(&STIFFNESS)? / mass, damping, speed).restitution
    };
    let (quantity, unit) = match quantity {
        "temperature" | "kinetic" => (if quantity == "kinetic" { "kinetic" } else { "temperature" }, 1.0),
        // p = Z N kT/A, while the temperature is constant.
        "pressure" if damping == 0.0 => {
            ("compressibility", discs as f64 * temperature / prepared.domain.area())
        }
        _ => return None,
    };
    let time = match prepared.schedule.until {
        Until::Time(time) => time,
        Until::Steps(steps) => steps as f64 * values.number(&DT)?,
        Until::Events(_) => return None,
    };
    let mut scene: Table = prepared.scene.parse().ok()?;
    scene.retain(|name, _| SHARED.contains(&name));
    let table = |entries: &[(&str, Toml)]| {
        Toml::Table(entries.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect())
    };
    scene.insert("method".to_owned(), table(&[("kind", Toml::from("hard-disks"))]));
    scene.insert(RESTITUTION.section.to_owned(), table(&[(RESTITUTION.name, Toml::from(restitution))]));
    let rows = time / ROWS;
    scene.insert(
        "run".to_owned(),
        table(&[
            ("time", Toml::from(time)),
            ("thermo_every", Toml::from(rows)),
            ("snapshot_every", Toml::from(0.0)),
        ]),
    );
    Some(TranslatedScene { text: scene.to_string(), quantity, unit })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, prepare, vocabularies};
    use crate::particles::Particles;

    fn soft_and_hard(overrides: &[&str], quantity: &str) -> (Particles, Option<(Prepared, TranslatedScene)>) {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        let known = vocabularies(METHODS);
        let values = SceneValues::load("dense-gas", &overrides, &known).unwrap();
        let (soft, _) = prepare(values.clone(), METHODS).unwrap();
        let twin = hard(&values, &soft, quantity).map(|twin| {
            let values = SceneValues::parse("hard", &twin.text, &[], &known).unwrap();
            (prepare(values, METHODS).unwrap().0, twin)
        });
        (soft.particles().clone(), twin)
    }

    /// Checks the twin's temperature against Σ m |v − v̄|² over 2 N − 2 degrees of freedom: a common drift changes neither the unit of the pressure,
    /// N kT/A, nor the restitution.
    #[test]
    fn a_common_drift_does_not_change_the_twin() {
        let twin = |drift: [f64; 2], law: &[&str], quantity: &str| {
            let overrides: Vec<String> =
                ["particles.count=100"].iter().chain(law).map(|&text| text.to_owned()).collect();
            let values = SceneValues::load("dense-gas", &overrides, &vocabularies(METHODS)).unwrap();
            let (soft, _) = prepare(values.clone(), METHODS).unwrap();
            let mut moved = soft.particles().clone();
            moved.all_mut().iter_mut().for_each(|disc| {
                (disc.velocity[0], disc.velocity[1]) =
                    (disc.velocity[0] + drift[0], disc.velocity[1] + drift[1]);
            });
            let discs = moved.all();
            let n = discs.len() as f64;
            let mean = [0, 1].map(|axis| discs.iter().map(|disc| disc.velocity[axis]).sum::<f64>() / n);
            let about = |disc: &crate::particles::Particle| {
                disc.mass * ((disc.velocity[0] - mean[0]).powi(2) + (disc.velocity[1] - mean[1]).powi(2))
            };
            let by_hand = discs.iter().map(about).sum::<f64>() / (2.0 * n - 2.0);
            let moved = soft.model.started_from(moved);
            let twin = hard(&values, &moved, quantity).unwrap();
            let scene = twin.text.parse::<Table>().unwrap();
            let restitution = scene["law"]["restitution"].as_float().unwrap();
            (twin.unit, restitution, n * by_hand / moved.domain.area())
        };
        for drift in [[0.0; 2], [0.2, 0.0], [0.2, -3.0]] {
            let (unit, _, by_hand) = twin(drift, &[], "pressure");
            assert!((unit / by_hand - 1.0).abs() < 1e-9, "{drift:?}: {unit} {by_hand}");
            let damped = |drift| twin(drift, &["law.normal_damping=0.3"], "temperature").1;
            let [own, at_rest] = [damped(drift), damped([0.0; 2])];
            assert!((own - at_rest).abs() < 1e-9, "{drift:?}: {own} {at_rest}");
        }
    }

    /// The twin has the same discs and the restitution of their law; what hard discs lack has no twin.
    #[test]
    fn the_twin_has_the_same_discs() {
        let (soft, twin) = soft_and_hard(&["particles.count=100"], "pressure");
        let (hard, twin) = twin.unwrap();
        assert_eq!(hard.particles().checksum(), soft.checksum());
        assert_eq!(twin.quantity, "compressibility");
        assert_eq!(twin.text.parse::<Table>().unwrap()["law"]["restitution"].as_float(), Some(1.0));
        let (_, twin) = soft_and_hard(&["law.normal_damping=0.3"], "temperature");
        let (_, twin) = twin.unwrap();
        let restitution = twin.text.parse::<Table>().unwrap()["law"]["restitution"].as_float().unwrap();
        assert!((0.8..0.99).contains(&restitution), "{restitution}");
        for (law, quantity) in [
            ("law.friction=0.2", "temperature"),
            ("law.cohesionless=false", "temperature"),
            ("law.normal_damping=0.3", "pressure"),
            ("law.normal_damping=0.3", "flow"),
        ] {
            assert!(soft_and_hard(&[law], quantity).1.is_none(), "{law} {quantity}");
        }
    }
}
