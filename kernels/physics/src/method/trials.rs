//! What a method states of its trials: what may be varied of a scene without changing what is simulated, and what theory
//! says of it. Studies of speed, accuracy and stability know a method by this alone.

use super::entry::Prepared;
use crate::particles::Particles;
use crate::scene::{Key, Overrides, SceneErrors, Values};

/// How the scenes of a method may be run, and what is measured of them.
#[derive(Clone, Debug)]
pub struct Trials {
    /// The key of the step (time).
    pub step: &'static Key,
    /// The settings of the reference, one for each axis it names, the most accurate there is; and of a second one with
    /// another integrator, against which it is held.
    pub references: [&'static [(&'static str, &'static str)]; 2],
    /// The balance of energy, where the method observes one.
    pub balance: Option<Balance>,
    /// Integrators that keep a shadow energy, where the method has such; none elsewhere.
    pub shadow: Option<Shadow>,
    /// Two particles as a scene has them, whose encounters say what a step changes in each; none where they do not touch.
    pub encounter: fn(&Prepared, Encounter) -> Option<String>,
    /// Whether a run with another step follows the same trajectories; where noise moves particles it does not, and only means can be
    /// compared.
    pub has_trajectories: bool,
    /// What distances between states are measured in.
    pub length: Length,
    /// Whether particles touch and part, so that two of them alone are a collision.
    pub has_contacts: bool,
    /// Quantities that have a mean in a run: what is left of a comparison once trajectories have parted.
    pub observables: &'static [&'static str],
    /// Those of them that come and go with single contacts: looks at them have a mean only over independent seeds.
    pub fluctuating: &'static [&'static str],
    /// Whether particles rotate, and their moment of inertia over m R² if so.
    pub inertia: fn(&Values) -> Option<f64>,
    /// The order of convergence of positions that theory gives for a setting of the axis that decides it.
    pub theory: fn(&Values, &Prepared, &Setting) -> Option<Theory>,
    /// What a map of stability may vary beside the step.
    pub parameters: &'static [Parameter],
    /// As the entry's `prepare`, but whatever the step is: what theory foresees of it refuses nothing.
    pub at_any_step: fn(Values) -> Result<Prepared, SceneErrors>,
}

/// What distances between states are measured in.
#[derive(Clone, Copy, Debug)]
pub struct Length {
    /// What it is called, as a unit.
    pub unit: &'static str,
    /// How long it is (length).
    pub of: fn(&Particles) -> f64,
}

/// The smallest radius.
pub const SMALLEST_RADIUS: Length =
    Length { unit: "radii", of: |particles| particles.radii().map_or(1.0, |[smallest, _]| smallest) };

/// The balance of energy, by names of quantities.
#[derive(Clone, Copy, Debug)]
pub struct Balance {
    /// Its error: the energy that there is, less what there should be.
    pub error: &'static str,
    /// Energies whose magnitudes add up to what moves.
    pub energies: &'static [&'static str],
    /// Work since the start, whose magnitudes add up to what has come from outside.
    pub inputs: &'static [&'static str],
}

/// Integrators that keep an energy that differs from the true one by a power of the step (Bond and Leimkuhler, Acta Numerica 16, 2007): without friction
/// and driving the true one then fluctuates about it.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    /// The settings of the axis that decides the order.
    pub integrators: &'static [&'static str],
    /// The quantity that is the mean energy of a degree of freedom, twice.
    pub temperature: &'static str,
}

/// How two particles meet.
#[derive(Clone, Copy, Debug)]
pub struct Encounter {
    /// Speed of approach (length/time).
    pub speed: f64,
    /// Distance of the line of flight from the other's centre, in sums of the radii: 0 head on, 1 past each other.
    pub offset: f64,
}

/// Something of a scene that a map of stability varies beside the step.
#[derive(Debug)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// What it is, for an axis.
    pub label: &'static str,
    /// Its dimension, such as `1/time`, empty for pure numbers.
    pub unit: &'static str,
    /// The least and the largest value that it may have.
    pub bounds: [f64; 2],
    /// Whether equal ratios lie at equal distances on an axis.
    pub is_logarithmic: bool,
    /// From where to where a map goes if nothing else is asked for; none where the scene has nothing of the kind.
    pub range: fn(&Values) -> Option<[f64; 2]>,
    /// The overrides by which a scene comes to have a value.
    pub overrides: fn(&Values, f64) -> Overrides,
    /// Values that theory names, with what they are.
    pub marks: fn(&Values) -> Vec<(f64, String)>,
}

/// A simpler model of a scene, beside which its results show what it needs.
#[derive(Debug)]
pub struct Twin {
    /// What it lacks.
    pub name: &'static str,
    /// What it is.
    pub becomes: Becomes,
}

/// What a scene becomes in a simpler model; none where it has nothing of the kind.
#[derive(Debug)]
pub enum Becomes {
    /// The same with overrides.
    Overridden(fn(&Values) -> Option<Overrides>),
    /// The scene of another method, for a quantity that is asked for.
    Rewritten(fn(&Values, &Prepared, &str) -> Option<Rewritten>),
}

/// A scene as another method has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rewritten {
    /// Its text.
    pub text: String,
    /// The quantity there that stands for the one here.
    pub quantity: &'static str,
    /// What a value of it is here, over that there.
    pub unit: f64,
}

/// Something that may be chosen.
#[derive(Debug)]
pub struct Axis {
    /// Its name.
    pub name: &'static str,
    /// What the choice decides.
    pub decides: Decides,
    /// The settings.
    pub settings: &'static [Setting],
    /// The setting of a scene as it was prepared; none if it is not among these.
    pub own: fn(&Prepared) -> Option<String>,
}

/// What a choice decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decides {
    /// The order of convergence.
    Order,
    /// The digits.
    Digits,
    /// The cost; results are equal but for rounding.
    Cost,
}

/// A setting of an axis.
#[derive(Debug)]
pub struct Setting {
    /// Its name.
    pub name: &'static str,
    /// The overrides that it makes in a scene.
    pub overrides: fn() -> Overrides,
}

/// The settings of an axis, each with the values that it gives to keys.
macro_rules! settings {
    ($($name:literal [$($key:ident = $value:expr),*],)*) => {
        &[$($crate::method::Setting {
            name: $name,
            overrides: || $crate::scene::Overrides::new()$(.set(&$key, $value))*,
        }),*]
    };
}
pub(super) use settings;

/// What theory says of the error of positions at the end of a short run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Theory {
    /// The power of the step with which the error falls.
    pub order: f64,
    /// What decides it.
    pub why: &'static str,
}

impl Axis {
    /// The setting of a name.
    pub fn setting(&self, name: &str) -> Option<&'static Setting> {
        self.settings.iter().find(|setting| setting.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, method, prepare, vocabularies};
    use crate::scene::{COUNT, DT, SEED, STEPS};

    /// Presets with overrides that a user typed. Some of these put values of the text aside: the six values of a Gear scheme, how
    /// programs are executed, a number of steps.
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

    /// All overrides of studies, and some that a scene refuses or that no method has.
    fn all_overrides(values: &Values) -> Vec<Overrides> {
        let entry = method(METHODS, values.method()).unwrap();
        let settings = entry.axes.iter().flat_map(|axis| axis.settings);
        let mut all: Vec<Overrides> = settings.map(|setting| (setting.overrides)()).collect();
        for parameter in entry.trials.iter().flat_map(|trials| trials.parameters) {
            let range = (parameter.range)(values).into_iter().flatten();
            all.extend(range.map(|value| (parameter.overrides)(values, value)));
        }
        all.extend(entry.twins.iter().filter_map(|twin| match twin.becomes {
            Becomes::Overridden(overrides) => overrides(values),
            Becomes::Rewritten(_) => None,
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
            // Gear's scheme again, with the values that the text gives it.
            one().set(entry.vocabulary.keys.key("integrator", "kind").unwrap_or(&DT), "gear"),
        ]);
        all
    }

    #[test]
    fn typed_overrides_mean_the_same_as_typed_texts() {
        let known = vocabularies(METHODS);
        let outcome = |values: Result<Values, SceneErrors>| {
            let prepared = values.and_then(|values| prepare(values, METHODS));
            prepared.map(|(prepared, _)| (prepared.particles().checksum(), prepared.scene))
        };
        let (mut refused, mut compared) = (0, 0);
        for (preset, given) in SCENES {
            let given: Vec<String> = given.iter().map(|&text| text.to_owned()).collect();
            let values = Values::load(preset, &given, &known).unwrap();
            for overrides in all_overrides(&values) {
                let all = [&given[..], &overrides.texts()].concat();
                let by_texts = outcome(Values::load(preset, &all, &known));
                assert_eq!(outcome(values.with(&overrides)), by_texts, "{preset} {all:?}");
                refused += usize::from(by_texts.is_err());
                compared += 1;
            }
        }
        assert!(refused > 30 && compared - refused > 100, "{refused} of {compared}");
    }

    /// The values that overrides put aside come back by further ones: two-discs gives five values of Gear's scheme.
    #[test]
    fn values_put_aside_come_back() {
        let known = vocabularies(METHODS);
        let given = ["integrator.kind=velocity-verlet".to_owned()];
        let values = Values::load("two-discs", &given, &known).unwrap();
        let key = |name| method(METHODS, values.method()).unwrap().vocabulary.keys.key("integrator", name);
        let (kind, carried) = (key("kind").unwrap(), key("values").unwrap());
        assert!(!values.gives(carried));
        let again = values.with(&Overrides::new().set(kind, "gear")).unwrap();
        assert_eq!(again.given(carried), Some(&crate::scene::Value::Whole(5)));
    }
}
