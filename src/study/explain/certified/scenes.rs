//! Scenes that plans are tested with. No constant of the planner was fitted to them.

use crate::study::{StudyCase, StudyError};
use stripmine_physics::method::METHODS;

/// Kind of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SceneClass {
    /// Grains driven by gravity or a wall.
    Driven,
    /// Soft discs without a drive, elastic or not.
    Granular,
    HardDiscs,
    /// Particles in a heat bath.
    Bath,
    /// Bodies that attract each other.
    Bodies,
}

impl SceneClass {
    pub(crate) const ALL: [SceneClass; 5] = [
        SceneClass::Driven,
        SceneClass::Granular,
        SceneClass::HardDiscs,
        SceneClass::Bath,
        SceneClass::Bodies,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            SceneClass::Driven => "driven granular",
            SceneClass::Granular => "other granular",
            SceneClass::HardDiscs => "hard discs",
            SceneClass::Bath => "baths",
            SceneClass::Bodies => "bodies",
        }
    }
}

/// A scene, a quantity and the target errors, each of which is a plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlanCase {
    pub(crate) class: SceneClass,
    /// Name of the preset, or of a scene with its text.
    preset: &'static str,
    text: Option<&'static str>,
    overrides: &'static [&'static str],
    pub quantity: &'static str,
    /// Target errors of the mean, or of the value of a conserved quantity.
    pub(crate) errors: &'static [&'static str],
    /// Set where plans are compared with the best of a grid.
    pub(crate) is_compared: bool,
    /// Set where trials are repeated for longer if they give no plan.
    pub(crate) is_patient: bool,
}

impl PlanCase {
    /// Loads the scene.
    ///
    /// # Errors
    /// [`StudyError`] if it is invalid.
    pub(crate) fn load(&self) -> Result<StudyCase, StudyError> {
        let overrides: Vec<String> = self.overrides.iter().map(|&text| text.to_owned()).collect();
        Ok(match self.text {
            Some(text) => StudyCase::parse(self.preset, text, &overrides, METHODS)?,
            None => StudyCase::load(self.preset, &overrides, METHODS)?,
        })
    }

    const fn compared(self) -> PlanCase {
        PlanCase { is_compared: true, ..self }
    }

    const fn patient(self) -> PlanCase {
        PlanCase { is_patient: true, ..self }
    }

    const fn with_text(self, text: &'static str) -> PlanCase {
        PlanCase { text: Some(text), ..self }
    }
}

const fn ask(
    class: SceneClass,
    preset: &'static str,
    overrides: &'static [&'static str],
    quantity: &'static str,
    errors: &'static [&'static str],
) -> PlanCase {
    PlanCase { class, preset, text: None, overrides, quantity, errors, is_compared: false, is_patient: false }
}

use SceneClass::{Bath, Bodies, Driven, Granular, HardDiscs};

/// Grains that fall through a funnel, leave at the lower end of the box and return at its upper one: the gallery's hopper with few grains.
const HOPPER: &str = include_str!("hopper.toml");
/// The gallery's chute.
const CHUTE: &str = include_str!("../../../../docs/gallery/chute.toml");
/// The chute with few grains, at 30 degrees.
const SMALL_CHUTE: &[&str] = &[
    "domain.sides=[0.25, 0.4]",
    "domain.gravity=[4.905, -8.496]",
    "particles.count=60",
    "particles.fill_height=0.3",
    "run.time=4.0",
];
const THIN_PIPE: &[&str] = &["domain.sides=[0.405, 0.088]"];
/// Without density waves.
const CALM_PIPE: &[&str] = &["domain.sides=[0.405, 0.088]", "law.normal_damping=100.0"];
const SHAKEN: &[&str] = &["domain.sides=[0.25, 0.8]", "particles.count=50"];
/// Layers on a floor that vibrates fast with a small amplitude.
const LAYERS: &[&str] = &[
    "domain.sides=[0.25, 0.8]",
    "particles.count=50",
    "particles.wall_amplitude=[0.0, 0.003]",
    "particles.wall_spacing=0.019",
    "particles.wall_frequency=20.0",
];
/// Layers sheared by an oscillating floor.
const SHEARED: &[&str] =
    &["domain.sides=[0.25, 0.8]", "particles.count=50", "particles.wall_amplitude=[0.0075, 0.0]"];

/// Sixty plans: packing fractions from 0.01 to 0.7, 2 to 50 000 particles, gas to liquid and cluster, elastic to sticky, flows and shaken beds, all
/// methods.
pub(crate) const SCENES: &[PlanCase] = &[
    ask(Driven, "pipe-small", THIN_PIPE, "flow", &["10%", "3%", "1%"]).patient(),
    ask(Driven, "pipe-small", CALM_PIPE, "flow", &["10%", "3%", "1%"]).compared(),
    ask(Driven, "hopper", &[], "flow", &["10%", "3%", "1%"]).with_text(HOPPER).patient(),
    ask(Driven, "chute", SMALL_CHUTE, "flow", &["10%", "3%", "1%"]).with_text(CHUTE).patient(),
    ask(Driven, "shaken-box", SHAKEN, "temperature", &["10%", "3%"]).compared(),
    ask(Driven, "shaken-box", SHAKEN, "gravitational", &["3%", "1%"]).compared(),
    ask(Driven, "shaken-box", LAYERS, "contacts", &["10%", "3%"]),
    ask(Driven, "shaken-box", LAYERS, "gravitational", &["3%", "1%"]),
    ask(Driven, "shaken-box", SHEARED, "gravitational", &["3%", "1%"]),
    ask(Driven, "vibrating-floor", &["particles.count=100"], "collision_rate", &["10%"]),
    ask(Granular, "dense-gas", &[], "pressure", &["1%"]).compared(),
    ask(Granular, "dense-gas", &[], "temperature", &["0.2%"]),
    ask(Granular, "dense-gas", &["particles.packing_fraction=0.3"], "pressure", &["1%"]),
    ask(Granular, "dense-gas", &["particles.packing_fraction=0.05"], "pressure", &["1%"]),
    ask(
        Granular,
        "dense-gas",
        &["particles.count=10000", "particles.packing_fraction=0.5"],
        "pressure",
        &["0.5%"],
    ),
    ask(Granular, "dense-gas", &["law.stiffness=1000.0", "integrator.dt=0.002"], "pressure", &["1%"]),
    ask(Granular, "dense-gas", &["particles.temperature=0.0025"], "contacts", &["2%"]),
    ask(Granular, "dense-gas", &[], "balance_error", &["1e-4"]),
    ask(Granular, "dense-gas", &["particles.count=100"], "balance_error", &["1e-6"]),
    // A cooling gas: its mean is taken over the whole run.
    ask(
        Granular,
        "dense-gas",
        &["particles.count=100", "particles.packing_fraction=0.3", "law.normal_damping=1.0"],
        "temperature",
        &["3%"],
    ),
    ask(Granular, "wide-sizes", &[], "pressure", &["2%"]),
    ask(
        HardDiscs,
        "hard-disks",
        &["particles.count=100", "particles.packing_fraction=0.01"],
        "compressibility",
        &["0.5%"],
    ),
    ask(
        HardDiscs,
        "hard-disks",
        &["particles.count=100", "particles.packing_fraction=0.3"],
        "compressibility",
        &["0.3%"],
    ),
    ask(
        HardDiscs,
        "hard-disks",
        &["particles.count=1000", "particles.packing_fraction=0.5"],
        "compressibility",
        &["0.3%"],
    )
    .compared(),
    ask(
        HardDiscs,
        "hard-disks",
        &["particles.count=10000", "particles.packing_fraction=0.3"],
        "collision_rate",
        &["0.3%"],
    ),
    ask(
        HardDiscs,
        "hard-disks",
        &["particles.count=10000", "particles.packing_fraction=0.65"],
        "compressibility",
        &["0.5%"],
    ),
    ask(
        HardDiscs,
        "hard-disks",
        &["particles.count=50000", "particles.packing_fraction=0.1"],
        "compressibility",
        &["0.2%"],
    ),
    ask(
        HardDiscs,
        "melting",
        &["particles.count=1000", "particles.packing_fraction=0.7"],
        "compressibility",
        &["1%"],
    ),
    ask(
        HardDiscs,
        "hard-disks",
        &["particles.count=400", "particles.packing_fraction=0.6"],
        "collision_rate",
        &["1%"],
    ),
    ask(Bath, "langevin-free", &["particles.count=100"], "temperature", &["1%"]),
    ask(Bath, "langevin-free", &["particles.count=10000"], "temperature", &["0.3%"]),
    ask(Bath, "langevin-dense", &[], "potential", &["0.5%"]).compared(),
    ask(Bath, "langevin-dense", &[], "pressure", &["2%"]),
    ask(Bath, "langevin-dense", &[], "temperature", &["1%"]),
    ask(Bath, "langevin-dense", &["law.kind=wca"], "pressure", &["1%"]).compared(),
    ask(Bath, "langevin-dense", &["law.kind=wca", "domain.sides=[200.0, 200.0]"], "pressure", &["2%"]),
    ask(Bath, "langevin-dense", &["law.drag=10.0"], "potential", &["0.5%"]),
    ask(Bath, "langevin-dense", &["law.drag=0.1"], "potential", &["0.5%"]),
    ask(Bath, "langevin-dense", &["particles.count=100", "domain.sides=[12.0, 12.0]"], "potential", &["1%"]),
    ask(
        Bath,
        "langevin-dense",
        &["particles.count=10000", "domain.sides=[120.0, 120.0]"],
        "potential",
        &["0.5%"],
    ),
    ask(Bath, "langevin-dense", &["law.bath_temperature=2.0"], "pressure", &["1%"]),
    ask(Bodies, "kepler", &[], "energy_error", &["1e-4"]).compared(),
    ask(Bodies, "kepler", &["particles.eccentricity=0.9"], "energy_error", &["1e-6"]),
    ask(Bodies, "figure-eight", &[], "energy_error", &["1e-9"]),
    ask(Bodies, "plummer", &["particles.count=128"], "balance_error", &["1e-3"]),
    ask(Bodies, "plummer", &[], "balance_error", &["1e-4"]),
    ask(Bodies, "two-clusters", &[], "balance_error", &["1e-3"]),
];

/// Scenes that take little time.
pub(crate) const QUICK: &[PlanCase] = &[
    ask(Driven, "shaken-box", SHAKEN, "gravitational", &["20%"]).compared(),
    ask(Bath, "langevin-free", &["particles.count=100"], "temperature", &["5%"]),
    ask(Bodies, "kepler", &["run.time=31.4"], "energy_error", &["1e-4"]),
];

#[cfg(test)]
mod tests {
    use super::super::super::PlanTarget;
    use super::*;
    use stripmine_physics::scene::Width;

    fn plans(belongs: impl Fn(&&PlanCase) -> bool) -> usize {
        SCENES.iter().filter(belongs).map(|asked| asked.errors.len()).sum()
    }

    #[test]
    fn there_are_sixty_plans_of_every_class() {
        assert_eq!(plans(|_| true), 60);
        assert!(plans(|it| it.class == Driven) >= 20);
        assert!(SceneClass::ALL.iter().all(|class| plans(|it| it.class == *class) >= 6));
        let driven = SCENES.iter().filter(|it| it.class == Driven);
        let errors: Vec<&str> = driven.flat_map(|it| it.errors).copied().collect();
        assert!(["10%", "3%", "1%"].iter().all(|error| errors.iter().filter(|it| *it == error).count() >= 5));
        assert_eq!(plans(|it| it.is_compared), 12);
        assert!(plans(|it| it.is_compared && it.class == Driven) >= 5);
    }

    #[test]
    fn every_scene_loads_and_has_its_quantity() {
        for asked in SCENES.iter().chain(QUICK) {
            let case = asked.load().unwrap_or_else(|error| panic!("{asked:?}: {error}"));
            for error in asked.errors {
                let width = Width::parse(error);
                assert!(width.is_some(), "{asked:?}: {error}");
                PlanTarget::of(&case, Some(asked.quantity), width).unwrap();
            }
        }
    }
}
