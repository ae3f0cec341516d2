//! Preset scenes of Langevin dynamics.

use crate::scene::Preset;

/// All presets of this method.
pub(super) const PRESETS: &[Preset] = &[
    Preset { name: "langevin-free", text: include_str!("presets/langevin-free.toml") },
    Preset { name: "langevin-dense", text: include_str!("presets/langevin-dense.toml") },
    Preset { name: "langevin-report", text: include_str!("presets/langevin-report.toml") },
];
