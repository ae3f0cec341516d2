//! Numbers and units as the terminal and the pictures show them.

use std::path::Path;
use stripmine_physics::averages::{Average, AverageOutcome, Estimate, RunAverages};
use stripmine_physics::io::regular_file;
use stripmine_physics::number::{significant, with_error_bar};
use stripmine_physics::quoted::quoted;
use stripmine_physics::run::Number;
use stripmine_physics::units;

/// Limit of the size of a scene file (bytes).
const LONGEST_SCENE: u64 = 1 << 24;

/// Decimals that show a number of significant digits.
pub(super) fn decimals(value: f64, digits: i32) -> usize {
    let magnitude = value.abs().log10().floor();
    if magnitude.is_finite() { (digits - 1 - magnitude as i32).max(0) as usize } else { 0 }
}

/// Mean of a quantity with its error, `rate` before that of a counter; or the reason in a word or two why there is none.
pub(super) fn mean_or_reason(average: &Average) -> String {
    let rate = if average.of == "rate" { "rate " } else { "" };
    match &average.outcome {
        AverageOutcome::Mean(Estimate { mean, bar, .. }) => format!("{rate}{}", with_error_bar(*mean, *bar)),
        AverageOutcome::Constant { mean } => format!("{rate}always {}", significant(*mean, 6)),
        AverageOutcome::TooShort { enough_at, .. } => format!("needs time {}", significant(*enough_at, 2)),
        AverageOutcome::Changing { .. } => "changing".to_owned(),
        AverageOutcome::Undefined => "undefined".to_owned(),
        AverageOutcome::Kept { farthest, .. } => format!("kept within {}", significant(*farthest, 2)),
    }
}

/// Explanations of the reasons that [`mean_or_reason`] gives for some quantities.
pub(super) fn reasons<'a>(averages: impl IntoIterator<Item = &'a Average>) -> Vec<&'static str> {
    let mut found: Vec<&str> = averages
        .into_iter()
        .filter_map(|average| match average.outcome {
            AverageOutcome::TooShort { .. } => Some("needs time T: the run is too short for a mean."),
            AverageOutcome::Changing { .. } => Some("changing: not stationary at the end of the run."),
            AverageOutcome::Undefined => Some("undefined: NaN in some rows."),
            AverageOutcome::Kept { .. } => Some("kept within X: largest deviation from the first value."),
            AverageOutcome::Mean(_) | AverageOutcome::Constant { .. } => None,
        })
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Lines of the numbers that summarise structure functions, with their 95 % confidence intervals, and of doubts about them.
pub(super) fn structure_lines<'s>(
    functions: impl IntoIterator<Item = (&'static str, &'s [Number], Option<&'s str>)>,
    units: &UnitSystem,
) -> String {
    let (mut numbers, mut doubts) = (String::new(), String::new());
    for (function, headlines, doubt) in functions {
        for Number { name, unit, mean } in headlines {
            let line = format!(
                "  {function}: {name} {} {}",
                with_error_bar(mean.value, mean.bar),
                units.symbol(unit)
            );
            numbers += &format!("{}\n", line.trim_end());
        }
        doubt.iter().for_each(|doubt| doubts += &format!("{function}: {doubt}\n"));
    }
    let heading = if numbers.is_empty() { "" } else { "structure, ± 95 %:\n" };
    format!("{heading}{numbers}{doubts}")
}

/// Text of a run's scene, if it can be read.
pub(super) fn scene_text(run: &Path) -> Option<String> {
    String::from_utf8(regular_file::read(&run.join("scene.toml"), LONGEST_SCENE).ok()?).ok()
}

/// Scene of a run, if it can be read.
pub(super) fn scene_of(run: &Path) -> Option<toml::Table> {
    scene_text(run)?.parse().ok()
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
