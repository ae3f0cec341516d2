//! Scenes to start from.

/// A scene that comes with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// The name.
    pub name: &'static str,
    /// The file, with comments.
    pub text: &'static str,
}

macro_rules! define_presets {
    ($($name:literal),* $(,)?) => {
        /// Every preset.
        pub const PRESETS: &[Preset] =
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
    "bench"
];

impl Preset {
    /// What it shows: the first line of its text.
    pub fn title(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }
}

/// The preset of a name.
pub fn preset(name: &str) -> Option<Preset> {
    PRESETS.iter().copied().find(|preset| preset.name == name)
}
