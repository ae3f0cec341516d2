//! Preset scenes.

use crate::scene::Preset;

macro_rules! define_presets {
    ($($name:literal),* $(,)?) => {
        /// All presets of this method.
        pub(super) const PRESETS: &[Preset] =
            &[$(Preset { name: $name, text: include_str!(concat!("presets/", $name, ".toml")) }),*];
    };
}

define_presets![
    "pipe",
    "pipe-small",
    "pipe-as-printed",
    "dense-gas",
    "two-discs",
    "shaken-box",
    "wide-sizes",
    "hopper",
    "shear-cell",
    "piston",
    "bench",
    "pipe-small-printed",
    "dense-gas-printed"
];
