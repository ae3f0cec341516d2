//! Preset scenes of hard discs.

use crate::scene::Preset;

/// All presets of this method.
pub(super) const PRESETS: &[Preset] = &[
    Preset { name: "hard-disks", text: include_str!("presets/hard-disks.toml") },
    Preset { name: "cooling-gas", text: include_str!("presets/cooling-gas.toml") },
    Preset { name: "melting", text: include_str!("presets/melting.toml") },
    Preset { name: "row-of-discs", text: include_str!("presets/row-of-discs.toml") },
    Preset { name: "vibrating-floor", text: include_str!("presets/vibrating-floor.toml") },
    Preset { name: "hot-floor", text: include_str!("presets/hot-floor.toml") },
];
