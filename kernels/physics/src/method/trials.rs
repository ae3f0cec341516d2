//! Description of a method for studies: what may be varied without changing the physics, and what theory predicts. Studies of speed, accuracy and
//! stability use a method through this description alone.

use super::entry::Prepared;
use crate::particles::Particles;
use crate::scene::{Key, Overrides, SceneErrors, SceneValues};

/// Variations of a method's scenes and quantities to measure.
#[derive(Clone, Debug)]
pub struct Trials {
    /// The key of the step (time).
    pub step: &'static Key,
    /// Settings of the reference, one for each axis it names, the most accurate available; and of a second reference with another integrator that it
    /// is compared with.
    pub references: [&'static [(&'static str, &'static str)]; 2],
    /// Energy balance, if the method observes one.
    pub balance: Option<EnergyBalanceNames>,
    /// Integrators that conserve a shadow energy; none where the method has none.
    pub shadow: Option<ShadowEnergy>,
    /// Scene of an encounter of two particles, which shows the effect of the step on each contact; none where particles do not touch.
    pub encounter: fn(&Prepared, EncounterGeometry) -> Option<String>,
    /// True if runs with different steps follow the same trajectories. With noise they do not, and only means can be compared.
    pub has_trajectories: bool,
    /// True if close encounters late in a run may decide its results, so that part of a run says nothing about the rest.
    pub has_late_encounters: bool,
    /// Settings of the axis that decides the order whose steps adapt: their step is an interval of output.
    pub adaptive: &'static [&'static str],
    /// Unit of distances between states.
    pub length: DistanceUnit,
    /// True if particles touch and separate, so that two particles alone make a collision.
    pub has_contacts: bool,
    /// Quantities that have a mean in a run: what remains comparable after trajectories diverge.
    pub observables: &'static [&'static str],
    /// Observables that come and go with single contacts: their samples have a mean only over independent seeds.
    pub fluctuating: &'static [&'static str],
    /// Moment of inertia over m R², if particles rotate.
    pub inertia: fn(&SceneValues) -> Option<f64>,
    /// Theoretical order of convergence of positions for a setting of the axis that decides it.
    pub theory: fn(&SceneValues, &Prepared, &AxisSetting) -> Option<TheoreticalOrder>,
    /// Parameters that a map of stability may vary beside the step.
    pub parameters: &'static [Parameter],
    /// As the entry's `prepare` at any step: theoretical limits of the step reject nothing.
    pub at_any_step: fn(SceneValues) -> Result<Prepared, SceneErrors>,
}

/// Unit of distances between states.
#[derive(Clone, Copy, Debug)]
pub struct DistanceUnit {
    /// Name of the unit.
    pub unit: &'static str,
    /// Value of the unit (length).
    pub of: fn(&Particles) -> f64,
}

/// The smallest radius.
pub const SMALLEST_RADIUS: DistanceUnit =
    DistanceUnit { unit: "radii", of: |particles| particles.radii().map_or(1.0, |[smallest, _]| smallest) };

/// Energy balance by names of quantities.
#[derive(Clone, Copy, Debug)]
pub struct EnergyBalanceNames {
    /// Balance error: actual minus expected energy.
    pub error: &'static str,
    /// Energies whose magnitudes add up to the energy of motion.
    pub energies: &'static [&'static str],
    /// Work since the start, whose magnitudes add up to the external input.
    pub inputs: &'static [&'static str],
}

/// Integrators that conserve a shadow energy, which differs from the true one by a power of the step (Bond and Leimkuhler, Acta Numerica 16, 2007).
/// Without friction and driving, the true energy then fluctuates about it.
#[derive(Clone, Copy, Debug)]
pub struct ShadowEnergy {
    /// Settings of the axis that decides the order.
    pub integrators: &'static [&'static str],
    /// Name of the quantity that is twice the mean energy of a degree of freedom.
    pub temperature: &'static str,
}

/// Geometry of an encounter of two particles.
#[derive(Clone, Copy, Debug)]
pub struct EncounterGeometry {
    /// Speed of approach (length/time).
    pub speed: f64,
    /// Distance of the line of flight from the other's centre, in sums of the radii: 0 is head on, 1 is grazing.
    pub offset: f64,
}

/// Parameter of a scene that a map of stability varies beside the step.
#[derive(Debug)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// Label for an axis.
    pub label: &'static str,
    /// Its dimension, such as `1/time`, empty for pure numbers.
    pub unit: &'static str,
    /// Smallest and largest allowed value.
    pub bounds: [f64; 2],
    /// True if the axis is logarithmic.
    pub is_logarithmic: bool,
    /// Default range of a map; none where the scene lacks the parameter.
    pub range: fn(&SceneValues) -> Option<[f64; 2]>,
    /// Overrides that set a value in a scene.
    pub overrides: fn(&SceneValues, f64) -> Overrides,
    /// Special values named by theory, with their descriptions.
    pub marks: fn(&SceneValues) -> Vec<(f64, String)>,
}

/// Simpler model of a scene, used to show which parts the scene needs.
#[derive(Debug)]
pub struct Twin {
    /// Name of the missing part.
    pub name: &'static str,
    /// Simplified scene.
    pub becomes: SimplifiedModel,
}

/// Simplification of a scene; none where the scene lacks the part.
#[derive(Debug)]
pub enum SimplifiedModel {
    /// Scene with overrides.
    Overridden(fn(&SceneValues) -> Option<Overrides>),
    /// Scene of another method, for a requested quantity.
    Rewritten(fn(&SceneValues, &Prepared, &str) -> Option<TranslatedScene>),
}

/// Scene translated to another method.
#[derive(Clone, Debug, PartialEq)]
pub struct TranslatedScene {
    /// Scene as TOML.
    pub text: String,
    /// Quantity there that corresponds to the one here.
    pub quantity: &'static str,
    /// Factor from a value there to a value here.
    pub unit: f64,
}

/// Choice between settings that leave the physics unchanged.
#[derive(Debug)]
pub struct SettingAxis {
    /// Its name.
    pub name: &'static str,
    /// Effect of the choice.
    pub decides: ChoiceEffect,
    /// The settings.
    pub settings: &'static [AxisSetting],
    /// Setting of a prepared scene; none if it is not among these.
    pub own: fn(&Prepared) -> Option<String>,
}

/// Effect of a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChoiceEffect {
    /// The order of convergence.
    Order,
    /// The precision.
    Precision,
    /// The cost; results agree up to rounding.
    Cost,
}

/// A setting of an axis.
#[derive(Debug)]
pub struct AxisSetting {
    /// Its name.
    pub name: &'static str,
    /// Overrides of the setting.
    pub overrides: fn() -> Overrides,
}

/// Builds the settings of an axis, each with the values of its keys.
macro_rules! settings {
    ($($name:literal [$($key:ident = $value:expr),*],)*) => {
        &[$($crate::method::AxisSetting {
            name: $name,
            overrides: || $crate::scene::Overrides::new()$(.set(&$key, $value))*,
        }),*]
    };
}
pub(super) use settings;

/// Theoretical error of positions at the end of a short run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TheoreticalOrder {
    /// Power of the step with which the error falls.
    pub order: f64,
    /// Reason.
    pub why: &'static str,
}

impl SettingAxis {
    /// Returns the setting of a name.
    pub fn setting(&self, name: &str) -> Option<&'static AxisSetting> {
        self.settings.iter().find(|setting| setting.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, method, prepare, vocabularies};
    use crate::scene::{COUNT, DT, SEED, STEPS};

    /// Presets with overrides typed by a user. Some of these deactivate values of the file: the six values of a Gear scheme, how programs are
    /// executed, a number of steps.
    const SCENES: &[(&str, &[&str])] = &[
        ("two-discs", &["run.time=3.2"]),
        ("dense-gas", &["particles.count=100", "integrator.kind=velocity-verlet"]),
        ("pipe-small-printed", &["machine.engine=fast"]),
        ("wide-sizes", &["domain.sides=[14.0, 14.0]", "search.by=lattice", "search.mask=5"]),
        ("hard-disks", &["particles.count=100"]),
        ("langevin-dense", &["particles.count=300", "domain.sides=[20.7, 20.7]"]),
        ("langevin-free", &["particles.count=30"]),
        ("kepler", &[]),
        ("plummer", &["particles.count=64"]),
    ];

    /// All overrides of studies, and some that a scene rejects or that no method has.
    fn all_overrides(values: &SceneValues) -> Vec<Overrides> {
        let entry = method(METHODS, values.method()).unwrap();
        let settings = entry.axes.iter().flat_map(|axis| axis.settings);
        let mut all: Vec<Overrides> = settings.map(|setting| (setting.overrides)()).collect();
        for parameter in entry.trials.iter().flat_map(|trials| trials.parameters) {
            let range = (parameter.range)(values).into_iter().flatten();
            all.extend(range.map(|value| (parameter.overrides)(values, value)));
        }
        all.extend(entry.twins.iter().filter_map(|twin| match twin.becomes {
            SimplifiedModel::Overridden(overrides) => overrides(values),
            SimplifiedModel::Rewritten(_) => None,
        }));
        assert!(!all.is_empty());
        let one = Overrides::new;
        all.extend([
            one(),
            one().set(&SEED, 7_u64).set(&SEED, 8_u64),
            one().set(&STEPS, 12_u64),
            one().set(&DT, 0.5).set(&DT, 1e-4),
            one().set(&DT, -1.0).set(&COUNT, 3_u64),
            one().set(&DT, f64::INFINITY),
            one().set(entry.vocabulary.keys.key("machine", "engine").unwrap_or(&DT), "reverse"),
            // Gear's scheme again, with the values of the file.
            one().set(entry.vocabulary.keys.key("integrator", "kind").unwrap_or(&DT), "gear"),
        ]);
        all
    }

    #[test]
    fn overrides_equal_their_text_form() {
        let known = vocabularies(METHODS);
        let outcome = |values: Result<SceneValues, SceneErrors>| {
            let prepared = values.and_then(|values| prepare(values, METHODS));
            prepared.map(|(prepared, _)| (prepared.particles().checksum(), prepared.scene))
        };
        let (mut refused, mut compared) = (0, 0);
        for (preset, given) in SCENES {
            let given: Vec<String> = given.iter().map(|&text| text.to_owned()).collect();
            let values = SceneValues::load(preset, &given, &known).unwrap();
            for overrides in all_overrides(&values) {
                let all = [&given[..], &overrides.texts()].concat();
                let by_texts = outcome(SceneValues::load(preset, &all, &known));
                assert_eq!(outcome(values.with(&overrides)), by_texts, "{preset} {all:?}");
                refused += usize::from(by_texts.is_err());
                compared += 1;
            }
        }
        assert!(refused > 30 && compared - refused > 100, "{refused} of {compared}");
    }

    /// Further overrides reactivate values that earlier ones deactivated: two-discs gives five values of Gear's scheme.
    #[test]
    fn deactivated_values_are_restored() {
        let known = vocabularies(METHODS);
        let given = ["integrator.kind=velocity-verlet".to_owned()];
        let values = SceneValues::load("two-discs", &given, &known).unwrap();
        let key = |name| method(METHODS, values.method()).unwrap().vocabulary.keys.key("integrator", name);
        let (kind, carried) = (key("kind").unwrap(), key("values").unwrap());
        assert!(!values.is_given(carried));
        let again = values.with(&Overrides::new().set(kind, "gear")).unwrap();
        assert_eq!(again.given(carried), Some(&crate::scene::KeyValue::Whole(5)));
    }
}
