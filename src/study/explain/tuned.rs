//! What `auto` of a scene becomes by what was measured on this host: of the scene itself, or of one that is alike.

use super::kept::{Kept, KeptError};
use crate::study::Case;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use stripmine_physics::method::Decides;

/// Scenes are alike up to this factor of particles, and this difference of packing fractions: crossings lie farther apart.
const PARTICLES: f64 = 2.0;
const PACKING: f64 = 0.05;

/// What decides which way to run a scene is the cheapest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alike {
    method: String,
    particles: usize,
    /// Area of the particles over that of the box; 0 where there is none.
    packing_fraction: f64,
}

impl Alike {
    /// Of a scene.
    pub fn of(case: &Case) -> Alike {
        let particles = case.prepared.particles();
        let discs: f64 = particles.grains().iter().map(|it| PI * it.radius * it.radius).sum();
        let packing_fraction = discs / case.prepared.domain.area();
        Alike {
            method: case.entry.vocabulary.keys.method.to_owned(),
            particles: particles.grain_count(),
            packing_fraction: if packing_fraction.is_finite() { packing_fraction } else { 0.0 },
        }
    }

    /// How far two scenes are from each other, 0 for equal ones; none where they are not alike.
    pub(super) fn apart(&self, other: &Alike) -> Option<f64> {
        let of_particles = (self.particles.max(1) as f64 / other.particles.max(1) as f64).ln().abs();
        let apart = (of_particles / PARTICLES.ln())
            .max((self.packing_fraction - other.packing_fraction).abs() / PACKING);
        (self.method == other.method && apart <= 1.0).then_some(apart)
    }
}

/// What `auto` becomes.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// The overrides that say so.
    pub overrides: Vec<String>,
    /// Where it comes from.
    pub origin: String,
}

/// What is `auto` in a scene, by the cheapest way that was measured with the scene's own integrator and digits; none where nothing is kept of it or
/// of one that is alike, or nothing is open. Nothing that a scene states is changed.
///
/// # Errors
/// [`KeptError`] if what is kept cannot be read.
pub fn tuned(case: &Case, kept: &Kept) -> Result<Option<Tuned>, KeptError> {
    let Some((findings, origin)) = kept.alike(case)? else { return Ok(None) };
    let stated = |text: &str| {
        let (path, _) = text.split_once('=')?;
        let key = case.entry.vocabulary.keys.keys().find(|key| key.path() == path)?;
        case.values.choice(key)
    };
    let is_open = |text: &String| stated(text).as_deref() == Some("auto");
    let holds = |text: &String| {
        let now = stated(text);
        now.as_deref() == text.split_once('=').map(|(_, word)| word) || now.is_none()
    };
    // Those that were timed come with the cheapest first.
    for way in findings.ways.iter().filter(|way| way.cost.is_some()) {
        let settings: Vec<(&str, &str)> =
            way.settings.iter().map(|(axis, name)| (axis.as_str(), name.as_str())).collect();
        let choice = case.own.with(&settings);
        let is_own = [Decides::Order, Decides::Digits].iter().all(|&it| choice.agrees(&case.own, it));
        let overrides: Vec<String> = choice.overrides().collect();
        if is_own && overrides.iter().all(|text| is_open(text) || holds(text)) {
            let overrides: Vec<String> = overrides.into_iter().filter(is_open).collect();
            return Ok((!overrides.is_empty()).then_some(Tuned { overrides, origin }));
        }
    }
    Ok(None)
}
