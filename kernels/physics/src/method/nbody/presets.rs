//! Preset scenes of bodies.

use crate::scene::Preset;

/// All presets of this method.
pub(super) const PRESETS: &[Preset] = &[
    Preset { name: "kepler", text: include_str!("presets/kepler.toml") },
    Preset { name: "figure-eight", text: include_str!("presets/figure-eight.toml") },
    Preset { name: "pythagorean", text: include_str!("presets/pythagorean.toml") },
    Preset { name: "plummer", text: include_str!("presets/plummer.toml") },
    Preset { name: "cold-collapse", text: include_str!("presets/cold-collapse.toml") },
    Preset { name: "two-clusters", text: include_str!("presets/two-clusters.toml") },
];
