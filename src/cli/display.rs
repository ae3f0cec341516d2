//! Numbers and units as the terminal and the pictures show them.

use std::path::Path;
use stripmine_physics::averages::RunAverages;
use stripmine_physics::io::regular_file;
use stripmine_physics::quoted::quoted;
use stripmine_physics::units;

/// Limit of the size of a scene file (bytes).
const LONGEST_SCENE: u64 = 1 << 24;

/// Decimals that show a number of significant digits.
pub(super) fn decimals(value: f64, digits: i32) -> usize {
    let magnitude = value.abs().log10().floor();
    if magnitude.is_finite() { (digits - 1 - magnitude as i32).max(0) as usize } else { 0 }
}

/// Scene of a run, if it can be read.
pub(super) fn scene_of(run: &Path) -> Option<toml::Table> {
    let text = regular_file::read(&run.join("scene.toml"), LONGEST_SCENE).ok()?;
    String::from_utf8(text).ok()?.parse().ok()
}

/// System of units of a scene.
pub(super) enum UnitSystem {
    /// Metres, seconds, kilograms.
    Si,
    /// Name that the scene gives its units.
    Other(String),
}

impl UnitSystem {
    /// Units of a scene.
    pub(super) fn of(scene: Option<&toml::Table>) -> UnitSystem {
        match scene.and_then(|scene| scene.get("units")?.as_str()) {
            Some("SI") => UnitSystem::Si,
            Some(name) => UnitSystem::Other(quoted(name)),
            None => UnitSystem::Other("the scene's unit".to_owned()),
        }
    }

    /// Symbol of a unit: `m/s` for `length/time` in SI. Other systems keep the words.
    pub(super) fn symbol(&self, unit: &str) -> String {
        match self {
            UnitSystem::Si => units::symbol("SI", unit).unwrap_or_default(),
            UnitSystem::Other(_) => unit.to_owned(),
        }
    }

    /// Averages with the symbols of this system.
    pub(super) fn averages(&self, averages: &RunAverages) -> RunAverages {
        let mut averages = averages.clone();
        averages.quantities.iter_mut().for_each(|average| average.unit = self.symbol(&average.unit));
        averages
    }

    /// Labels of lengths and times at axes.
    pub(super) fn at_axes(&self) -> [String; 2] {
        match self {
            UnitSystem::Si => ["m", "s"].map(str::to_owned),
            UnitSystem::Other(name) => [name.clone(), name.clone()],
        }
    }

    /// Labels of lengths and times after a number.
    pub(super) fn of_length_and_time(&self) -> [String; 2] {
        match self {
            UnitSystem::Si => ["m", "s"].map(str::to_owned),
            UnitSystem::Other(name) => [format!("({name})"), format!("({name})")],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_follow_the_units_of_the_scene() {
        let system = |text: &str| UnitSystem::of(text.parse().ok().as_ref());
        let symbols =
            ["SI", "reduced"].map(|name| system(&format!("units = \"{name}\"")).symbol("length/time"));
        assert_eq!(symbols, ["m/s", "length/time"]);
    }

    #[test]
    fn small_numbers_keep_their_digits() {
        assert_eq!([0.012_34, 12.34, 1234.0, 0.0].map(|value| decimals(value, 3)), [4, 1, 0, 0]);
    }
}
