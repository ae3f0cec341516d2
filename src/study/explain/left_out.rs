//! Simpler models of every scene: the change of a mean, and the time saved.

use super::PlanTarget;
use super::decisions::left_out;
use super::recommended::SimplerModelReport;
use super::simpler_models::has_simpler;
use super::trial_runs::measure_with_simpler_models;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::results::{FinishedItem, Progress, ProgressMeter};
use crate::study::trial::{Stopwatch, TrialControl};
use crate::study::{StudyCase, StudyError, first_line};
use std::sync::atomic::AtomicBool;
use stripmine_physics::method::METHODS;
use stripmine_physics::number::significant;

/// Largest change, in parts of the mean, at which a part may be left out.
const MOST: f64 = 0.1;

/// Scenes of the gallery, by name and text.
macro_rules! gallery {
    ($($name:literal),*) => {
        &[$(($name, include_str!(concat!("../../../docs/gallery/", $name, ".toml")))),*]
    };
}

const GALLERY: &[(&str, &str)] = gallery![
    "chute",
    "collapse",
    "cooling-clusters",
    "encounter",
    "equipartition",
    "hopper",
    "leidenfrost",
    "melting",
    "pipe-waves",
    "polycrystal",
    "pythagorean",
    "spinodal"
];

/// A simpler model of a scene.
struct SimplerModelRow {
    scene: &'static str,
    quantity: &'static str,
    mean: f64,
    twin: SimplerModelReport,
}

/// A scene that was not compared.
struct UncomparedScene {
    scene: &'static str,
    quantity: &'static str,
    why: String,
}

/// Lists every preset and every scene of the gallery, by name and text.
fn scenes() -> Vec<(&'static str, &'static str)> {
    let presets = METHODS.iter().flat_map(|entry| entry.vocabulary.presets);
    presets.map(|preset| (preset.name, preset.text)).chain(GALLERY.iter().copied()).collect()
}

/// Compares every scene, or the named ones, with its simpler models, in trials of some seconds each.
///
/// # Errors
/// [`StudyError`] if a scene is invalid.
pub(crate) fn compared(
    only: Option<&[&str]>,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<FinishedItem, StudyError> {
    let scenes: Vec<_> =
        scenes().into_iter().filter(|(name, _)| only.is_none_or(|only| only.contains(name))).collect();
    let meter = ProgressMeter::new(scenes.len() as f64, progress);
    let (watch, stop) = (Stopwatch::wall(), AtomicBool::new(false));
    let (mut rows, mut without) = (vec![], vec![]);
    for (scene, text) in scenes {
        let case = StudyCase::parse(scene, text, &[], METHODS)?;
        let target = PlanTarget::of(&case, None, None).map_err(|error| StudyError::Own(Box::new(error)))?;
        let quantity = target.quantity.name;
        let of = |why: String| UncomparedScene { scene, quantity, why };
        let trial = TrialControl { watch: &watch, stop: &stop };
        match has_simpler(&case, quantity)
            .then(|| measure_with_simpler_models(&case, &target, seconds, trial))
        {
            None => without.push(of("it has no simpler model".to_owned())),
            Some(Ok(found)) => {
                let mean = found.mean.mean;
                let twins = left_out(&found, MOST * mean.abs(), mean);
                rows.extend(twins.into_iter().map(|twin| SimplerModelRow { scene, quantity, mean, twin }));
            }
            Some(Err(error)) => without.push(of(first_line(&error.to_string()))),
        }
        meter.add(1.0);
    }
    Ok(FinishedItem::of([table(&rows), not_compared(&without), summary(&rows, &without, seconds)]))
}

impl SimplerModelRow {
    /// Upper bound of the change of the mean with 95 % confidence, in parts of it.
    fn most(&self) -> Option<f64> {
        self.twin.change.map(|[change, bar]| (change.abs() + bar) / self.mean.abs())
    }

    fn verdict(&self) -> String {
        match (self.twin.change, self.most()) {
            (Some(_), Some(most)) if most <= MOST => {
                format!("may be left out at {} %", significant(100.0 * most, 2))
            }
            (Some([change, bar]), _) if change.abs() > bar => "changes the mean".to_owned(),
            (Some(_), _) => "undecided".to_owned(),
            (None, _) => self.twin.says.clone(),
        }
    }
}

fn table(rows: &[SimplerModelRow]) -> ResultFrame {
    let share = |it: &SimplerModelRow, at: usize| Some(100.0 * it.twin.change?[at] / it.mean.abs());
    FrameBuilder::of(rows)
        .text("scene", |it| it.scene)
        .text("quantity", |it| it.quantity)
        .text("without", |it| it.twin.name.clone())
        .short("mean", |it| it.mean)
        .short("change", |it| Some(it.twin.change?[0]))
        .short("± (95 %)", |it| Some(it.twin.change?[1]))
        .number("change of the mean (%)", 1, |it| share(it, 0))
        .number("± (95 %) of that", 1, |it| share(it, 1))
        .number("time saved (%)", 0, |it| Some(100.0 * (1.0 - it.twin.cost?)))
        .text("verdict", |it| it.verdict())
        .frame("left-out", "Effect of simpler models")
}

fn not_compared(without: &[UncomparedScene]) -> ResultFrame {
    FrameBuilder::of(without)
        .text("scene", |it| it.scene)
        .text("quantity", |it| it.quantity)
        .text("because", |it| it.why.clone())
        .frame("not-compared", "Scenes without a comparison")
}

fn summary(rows: &[SimplerModelRow], without: &[UncomparedScene], seconds: f64) -> ResultFrame {
    let mut scenes: Vec<&str> = rows.iter().map(|it| it.scene).collect();
    scenes.dedup();
    let count = |verdict: &str| rows.iter().filter(|it| it.verdict().starts_with(verdict)).count();
    FrameBuilder::of([()])
        .count("scenes compared", |()| scenes.len())
        .count("scenes that are compared with nothing", |()| without.len())
        .count("twins", |()| rows.len())
        .count("may be left out", |()| count("may be left out"))
        .count("change the mean", |()| count("changes the mean"))
        .count("undecided", |()| count("undecided"))
        .number("trials of a scene (s)", 1, |()| seconds)
        .number("largest change at which something may be left out (%)", 0, |()| 100.0 * MOST)
        .frame("summary", "Simpler models in numbers")
}

#[cfg(test)]
mod tests {
    use super::super::recommended::NecessityVerdict;
    use super::*;
    use std::fs;
    use std::path::Path;

    /// By hand, for a mean of −2: the upper bound is (|change| + bar)/2.
    #[test]
    fn a_verdict_follows_from_change_and_bar() {
        for (change, verdict) in [
            (Some([0.01, 0.03]), "may be left out at 2 %"),
            // Significant, and small.
            (Some([-0.1, 0.02]), "may be left out at 6 %"),
            (Some([0.5, 0.1]), "changes the mean"),
            (Some([0.15, 0.1]), "changes the mean"),
            (Some([0.1, 0.3]), "undecided"),
            (None, "not compared: it broke"),
        ] {
            let twin = SimplerModelReport {
                name: "friction".to_owned(),
                change,
                cost: Some(0.8),
                need: NecessityVerdict::Undecided,
                says: "not compared: it broke".to_owned(),
            };
            let row = SimplerModelRow { scene: "a", quantity: "flow", mean: -2.0, twin };
            assert_eq!(row.verdict(), verdict, "{change:?}");
        }
    }

    #[test]
    fn every_scene_of_the_gallery_is_compared() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/gallery");
        let files = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
        let mut scenes: Vec<String> = files
            .filter(|path| path.extension().is_some_and(|it| it == "toml"))
            .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
            .collect();
        scenes.sort();
        assert_eq!(GALLERY.iter().map(|(name, _)| *name).collect::<Vec<_>>(), scenes);
    }
}
