//! Colourings of particles: one list for pictures, films, help and errors.

use super::window;
use crate::cli::display::UnitSystem;
use crate::statistics::quantile;
use clap::builder::PossibleValue;
use std::path::Path;
use stripmine_physics::domain::Domain;
use stripmine_physics::io::extxyz::ParticleFrame;
use stripmine_physics::method::{Methods, load};
use stripmine_physics::particles::Particle;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::structure::{PairForces, StructureSetting, forces_on_each, hexatic_orders};

/// Quantile of the values that has the last colour, so that few large values do not darken all others.
const MOST: f64 = 0.99;

/// Colouring of particles by a quantity.
pub(super) struct Colouring {
    /// Word on the command line.
    word: &'static str,
    /// Help text.
    doc: &'static str,
    /// Name beside the colour scale.
    label: &'static str,
    /// SI unit; none for pure numbers.
    si: Option<&'static str>,
    /// Value of each grain of a frame, or the reason why it has none.
    of: fn(&ParticleFrame, Option<&PairForces>) -> Result<Vec<f64>, &'static str>,
    /// True if it needs the forces of the run's scene.
    takes_forces: bool,
    /// Values of the lowest and the highest colour, from all sorted values, or the reason why there are none.
    ends: fn(&[f64]) -> Result<[f64; 2], &'static str>,
}

/// All colourings, the default first.
static COLOURINGS: [Colouring; 6] = [
    Colouring {
        word: "speed",
        doc: "speed",
        label: "speed",
        si: Some("m/s"),
        of: |frame, _| Ok(grain_values(frame, |it| it.velocity.iter().map(|v| v * v).sum::<f64>().sqrt())),
        takes_forces: false,
        ends: |speeds| Ok([0.0, quantile(speeds, MOST).unwrap_or(0.0)]),
    },
    Colouring {
        word: "psi6",
        doc: "hexatic order |ψ6|, 1 in a hexagonal crystal (discs in a box)",
        label: "hexatic order |ψ6|",
        si: None,
        of: |frame, _| hexatic_magnitudes(frame),
        takes_forces: false,
        ends: |_| Ok([0.0, 1.0]),
    },
    Colouring {
        word: "force",
        doc: "sum of the magnitudes of all pair forces on it (discs with pair forces)",
        label: "force",
        si: Some("N"),
        of: forces_on,
        takes_forces: true,
        ends: |forces| Ok([0.0, quantile(forces, MOST).unwrap_or(0.0)]),
    },
    Colouring {
        word: "spin",
        doc: "angular velocity, counter-clockwise (rotating discs)",
        label: "spin",
        si: Some("1/s"),
        of: |frame, _| Ok(grain_values(frame, |disc| disc.omega)),
        takes_forces: false,
        ends: |spins| {
            let [low, high] = [1.0 - MOST, MOST].map(|part| quantile(spins, part).unwrap_or(0.0));
            let most = high.abs().max(low.abs());
            if most > 0.0 { Ok([-most, most]) } else { Err("no disc rotates") }
        },
    },
    Colouring {
        word: "radius",
        doc: "radius",
        label: "radius",
        si: Some("m"),
        of: |frame, _| Ok(grain_values(frame, |disc| disc.radius)),
        takes_forces: false,
        ends: first_and_last,
    },
    Colouring {
        word: "id",
        doc: "particle number, to see mixing",
        label: "number",
        si: None,
        of: |frame, _| Ok(grain_values(frame, |particle| f64::from(particle.id))),
        takes_forces: false,
        ends: first_and_last,
    },
];

fn grain_values(frame: &ParticleFrame, value: impl Fn(&Particle) -> f64) -> Vec<f64> {
    frame.particles.grains().iter().map(value).collect()
}

fn first_and_last(values: &[f64]) -> Result<[f64; 2], &'static str> {
    Ok([values.first(), values.last()].map(|end| end.copied().unwrap_or(0.0)))
}

/// Box of a frame, or a closed box around the discs if the frame has none.
fn frame_domain(frame: &ParticleFrame) -> Domain {
    let grains = frame.particles.grains();
    if window::is_endless(frame) {
        let ends = |axis: usize| {
            let places = || grains.iter().map(|grain| grain.position[axis]);
            [places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max)]
        };
        let largest = grains.iter().map(|grain| grain.radius).fold(0.0, f64::max);
        let [x, y] = [0, 1].map(ends).map(|[low, high]| [low - largest, high + largest]);
        Domain::planar([x[0], y[0]], [x[1] - x[0], y[1] - y[0]], [false; 2])
    } else {
        Domain::planar(frame.origin, frame.cell, frame.periodic.unwrap_or([true; 2]))
    }
}

/// Sum of the magnitudes of the forces on each grain.
fn forces_on(frame: &ParticleFrame, forces: Option<&PairForces>) -> Result<Vec<f64>, &'static str> {
    let forces = forces.ok_or("the scene has no continuous pair forces, or cannot be read")?;
    let setting = StructureSetting::new(frame_domain(frame), &frame.particles);
    let mut sums = forces_on_each(&setting, frame.particles.all(), forces);
    sums.truncate(frame.particles.grain_count());
    Ok(sums)
}

/// |ψ6| of each grain.
fn hexatic_magnitudes(frame: &ParticleFrame) -> Result<Vec<f64>, &'static str> {
    let grains = frame.particles.grains();
    if grains.iter().any(|grain| grain.position[2] != 0.0) {
        return Err("bodies in space have no hexatic order");
    }
    if grains.is_empty() {
        return Ok(vec![]);
    }
    let setting = StructureSetting::new(frame_domain(frame), &frame.particles);
    Ok(hexatic_orders(&setting, &frame.particles).into_iter().map(|[x, y]| x.hypot(y)).collect())
}

/// Colouring that is not available for a run.
#[derive(Debug, thiserror::Error)]
#[error("particles cannot be coloured by {word}: {why}; use one of: {}", others.join(", "))]
pub(super) struct ColouringError {
    word: &'static str,
    why: &'static str,
    others: Vec<&'static str>,
}

impl Reported for ColouringError {
    fn class(&self) -> ErrorClass {
        ErrorClass::Usage
    }
}

impl Colouring {
    /// All colourings as values of `--color`.
    pub(super) fn possible_values() -> Vec<PossibleValue> {
        COLOURINGS.iter().map(|it| PossibleValue::new(it.word).help(it.doc)).collect()
    }
}

/// Colouring of the particles of one run or scene.
pub(super) struct RunColouring {
    colouring: &'static Colouring,
    /// True if `--color` was given.
    pub(super) is_chosen: bool,
    /// Pair forces of the scene, if the colouring needs them.
    forces: Option<PairForces>,
}

impl RunColouring {
    /// Colouring named by a word, or the default, with the pair forces of a run's scene.
    pub(super) fn of_run(word: Option<&str>, run: &Path, methods: Methods) -> RunColouring {
        RunColouring::new(word, || {
            let scene = run.join("scene.toml");
            let (prepared, _) = load(&scene.to_string_lossy(), &[], methods).ok()?;
            prepared.model.pair_forces()
        })
    }

    /// Colouring named by a word, or the default. `forces` gives the pair forces of the scene; it is called if the colouring needs them.
    pub(super) fn new(word: Option<&str>, forces: impl FnOnce() -> Option<PairForces>) -> RunColouring {
        let colouring = COLOURINGS.iter().find(|it| Some(it.word) == word).unwrap_or(&COLOURINGS[0]);
        let forces = if colouring.takes_forces { forces() } else { None };
        RunColouring { colouring, is_chosen: word.is_some(), forces }
    }

    /// Values of the grains of a frame.
    ///
    /// # Errors
    /// If the particles have no such values.
    pub(super) fn values(&self, frame: &ParticleFrame) -> Result<Vec<f64>, ColouringError> {
        (self.colouring.of)(frame, self.forces.as_ref()).map_err(|why| self.unavailable(why))
    }

    /// Values of the lowest and the highest colour.
    ///
    /// # Errors
    /// If the values define no scale.
    pub(super) fn ends(&self, mut values: Vec<f64>) -> Result<[f64; 2], ColouringError> {
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        let ends = (self.colouring.ends)(&values).map_err(|why| self.unavailable(why))?;
        // Equal values get the middle colour; zeros get the lowest.
        Ok(match ends {
            [low, high] if low < high => ends,
            [0.0, _] => [0.0, 1.0],
            [low, _] => [low - 0.5 * low.abs(), low + 0.5 * low.abs()],
        })
    }

    fn unavailable(&self, why: &'static str) -> ColouringError {
        let others =
            COLOURINGS.iter().map(|it| it.word).filter(|word| *word != self.colouring.word).collect();
        ColouringError { word: self.colouring.word, why, others }
    }

    pub(super) fn quantity(&self) -> &'static str {
        self.colouring.label
    }

    /// Label of the colour scale: the quantity and its unit.
    pub(super) fn label(&self, scene: Option<&toml::Table>) -> String {
        let Colouring { label, si, .. } = *self.colouring;
        match (si, UnitSystem::of(scene)) {
            (None, _) => label.to_owned(),
            (Some(si), UnitSystem::Si) => format!("{label} ({si})"),
            (Some(_), UnitSystem::Other(name)) => format!("{label} ({name})"),
        }
    }
}
