//! What the colours of particles say: one list for pictures, films, help and errors.

use super::window;
use crate::statistics::quantile;
use clap::builder::PossibleValue;
use stripmine_physics::domain::Domain;
use stripmine_physics::io::extxyz::Frame;
use stripmine_physics::particles::Particle;
use stripmine_physics::quoted::quoted;
use stripmine_physics::reported::{Class, Reported};
use stripmine_physics::structure::{Setting, hexatic_orders};

/// Few values are much larger than the others: they look like the largest of a hundred.
const MOST: f64 = 0.99;

/// What the colours of particles say.
pub(super) struct Colouring {
    /// The word on the command line.
    pub(super) word: &'static str,
    /// What it is.
    doc: &'static str,
    /// Its name at the colours.
    label: &'static str,
    /// Its unit where the scene's are SI; none for pure numbers.
    si: Option<&'static str>,
    /// Its value for each grain of a frame, or why it has none.
    of: fn(&Frame) -> Result<Vec<f64>, &'static str>,
    /// The values of the lowest and the highest colour, of all values in order, or why they say nothing.
    ends: fn(&[f64]) -> Result<[f64; 2], &'static str>,
}

/// All of them, the usual one first. Forces are not among them: no file of a run holds any.
pub(super) static COLOURINGS: [Colouring; 5] = [
    Colouring {
        word: "speed",
        doc: "how fast it moves",
        label: "speed",
        si: Some("m/s"),
        of: |frame| Ok(of_each(frame, |it| it.velocity.iter().map(|v| v * v).sum::<f64>().sqrt())),
        ends: |speeds| Ok([0.0, quantile(speeds, MOST).unwrap_or(0.0)]),
    },
    Colouring {
        word: "psi6",
        doc: "hexatic order |ψ6|, 1 in a hexagonal crystal; of discs in a box",
        label: "|ψ6|",
        si: None,
        of: orders,
        ends: |_| Ok([0.0, 1.0]),
    },
    Colouring {
        word: "spin",
        doc: "angular velocity, counter-clockwise; of discs that turn",
        label: "spin",
        si: Some("1/s"),
        of: |frame| Ok(of_each(frame, |disc| disc.omega)),
        ends: |spins| {
            let [low, high] = [1.0 - MOST, MOST].map(|part| quantile(spins, part).unwrap_or(0.0));
            let most = high.abs().max(low.abs());
            if most > 0.0 { Ok([-most, most]) } else { Err("none of them turns") }
        },
    },
    Colouring {
        word: "radius",
        doc: "its radius",
        label: "radius",
        si: Some("m"),
        of: |frame| Ok(of_each(frame, |disc| disc.radius)),
        ends: first_and_last,
    },
    Colouring {
        word: "id",
        doc: "its number, from which it is seen how particles mix",
        label: "id",
        si: None,
        of: |frame| Ok(of_each(frame, |particle| f64::from(particle.id))),
        ends: first_and_last,
    },
];

fn of_each(frame: &Frame, value: impl Fn(&Particle) -> f64) -> Vec<f64> {
    frame.particles.grains().iter().map(value).collect()
}

fn first_and_last(values: &[f64]) -> Result<[f64; 2], &'static str> {
    Ok([values.first(), values.last()].map(|end| end.copied().unwrap_or(0.0)))
}

/// |ψ6| of each grain, in the box, or where there is none above, in a closed one around the discs.
fn orders(frame: &Frame) -> Result<Vec<f64>, &'static str> {
    let grains = frame.particles.grains();
    if grains.iter().any(|grain| grain.position[2] != 0.0) {
        return Err("bodies in space have no hexatic order");
    }
    if grains.is_empty() {
        return Ok(vec![]);
    }
    let domain = if window::is_endless(frame) {
        let ends = |axis: usize| {
            let places = || grains.iter().map(|grain| grain.position[axis]);
            [places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max)]
        };
        let largest = grains.iter().map(|grain| grain.radius).fold(0.0, f64::max);
        let [x, y] = [0, 1].map(ends).map(|[low, high]| [low - largest, high + largest]);
        Domain::planar([x[0], y[0]], [x[1] - x[0], y[1] - y[0]], [false; 2])
    } else {
        Domain::planar(frame.origin, frame.cell, frame.periodic.unwrap_or([true; 2]))
    };
    let setting = Setting::new(domain, &frame.particles);
    Ok(hexatic_orders(&setting, &frame.particles).into_iter().map(|[x, y]| x.hypot(y)).collect())
}

/// A colouring that a run does not have.
#[derive(Debug, thiserror::Error)]
#[error("particles cannot be coloured by {word}: {why}; the others are: {}", others.join(", "))]
pub(super) struct ColouringError {
    word: &'static str,
    why: &'static str,
    others: Vec<&'static str>,
}

impl Reported for ColouringError {
    fn class(&self) -> Class {
        Class::Usage
    }
}

impl Colouring {
    /// All of them, for the command line.
    pub(super) fn possible_values() -> Vec<PossibleValue> {
        COLOURINGS.iter().map(|it| PossibleValue::new(it.word).help(it.doc)).collect()
    }

    /// That of a word.
    pub(super) fn of_word(word: &str) -> Option<&'static Colouring> {
        COLOURINGS.iter().find(|it| it.word == word)
    }

    /// A value for each grain of a frame.
    ///
    /// # Errors
    /// If its particles have no such values.
    pub(super) fn values(&self, frame: &Frame) -> Result<Vec<f64>, ColouringError> {
        (self.of)(frame).map_err(|why| self.none(why))
    }

    /// The values that have the lowest and the highest colour.
    ///
    /// # Errors
    /// If the values say nothing.
    pub(super) fn ends(&self, mut values: Vec<f64>) -> Result<[f64; 2], ColouringError> {
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        let ends = (self.ends)(&values).map_err(|why| self.none(why))?;
        // Where all are one, that one is in the middle; at rest nothing is fast.
        Ok(match ends {
            [low, high] if low < high => ends,
            [0.0, _] => [0.0, 1.0],
            [low, _] => [low - 0.5 * low.abs(), low + 0.5 * low.abs()],
        })
    }

    fn none(&self, why: &'static str) -> ColouringError {
        let others = COLOURINGS.iter().map(|it| it.word).filter(|word| *word != self.word).collect();
        ColouringError { word: self.word, why, others }
    }

    /// What stands at the colours: the quantity and its unit.
    pub(super) fn label(&self, scene: Option<&toml::Table>) -> String {
        match (self.si, units(scene)) {
            (None, _) => self.label.to_owned(),
            (Some(si), Units::Si) => format!("{} ({si})", self.label),
            (Some(_), Units::Other(name)) => format!("{} ({name})", self.label),
        }
    }
}

/// The units of a run.
pub(super) enum Units {
    /// Metres, seconds.
    Si,
    /// As the scene calls them.
    Other(String),
}

/// Those of a scene.
pub(super) fn units(scene: Option<&toml::Table>) -> Units {
    match scene.and_then(|scene| scene.get("units")?.as_str()) {
        Some("SI") => Units::Si,
        Some(name) => Units::Other(quoted(name)),
        None => Units::Other("the scene's unit".to_owned()),
    }
}

impl Units {
    /// Those of lengths and times.
    pub(super) fn of_length_and_time(self) -> [String; 2] {
        match self {
            Units::Si => ["m", "s"].map(str::to_owned),
            Units::Other(name) => [format!("({name})"), format!("({name})")],
        }
    }
}
