//! What `reproduce` makes of studies.

use super::Subject;
use super::work_precision::section::{NAME, made};
use super::work_precision::{self, work_precision};
use crate::console::Failure;
use crate::method::{Item, METHODS, Progress};
use crate::results::{Effort, Journal, Made};

/// Every item, in the order of the page.
pub const ITEMS: &[Item] = &[Item {
    name: NAME,
    doc: "Speed against accuracy of four scenes: which integrator, step and precision for which wish",
    seconds: [8.0, 80.0],
    is_quick: true,
    make: speed_against_accuracy,
}];

/// The scenes that methods state for it.
fn speed_against_accuracy(effort: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let (budget, repeats, phases) = match effort {
        Effort::Quick => (1.5, 1, 4),
        Effort::Full => (30.0, 3, 16),
    };
    let effort = work_precision::Effort { budget, repeats, phases, machine: None };
    let shown: Vec<_> =
        METHODS.iter().filter_map(|method| method.trials).flat_map(|trials| trials.shown).collect();
    let mut scenes = vec![];
    for (at, (name, preset, overrides)) in shown.iter().enumerate() {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        let subject = Subject::load(preset, &overrides, METHODS)?;
        let share = |part: f64| progress((at as f64 + part) / shown.len() as f64);
        scenes.push(((*name).to_owned(), work_precision(&subject, &effort, &Journal::none(), &share)?));
    }
    made(&scenes, format!("stripmine reproduce --only {NAME}"))
}
