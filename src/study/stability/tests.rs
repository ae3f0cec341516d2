//! Stability maps on a synthetic clock: no extent depends on the speed of the machine.

use super::{MapEffort, VariedRange, made, stability};
use crate::results::{Journal, JournalIdentity};
use crate::study::trial::{Stopwatch, TrialControl};
use crate::study::{StudyError, Subject};
use serde_json::Value;
use std::sync::atomic::{AtomicBool, Ordering};
use stripmine_physics::method::METHODS;

const EFFORT: MapEffort = MapEffort { budget: 600.0, size: 4, seeds: 1, tolerance: 0.2 };

fn subject(scene: &str, sets: &[&str]) -> Subject {
    let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
    Subject::load(scene, &sets, METHODS).unwrap()
}

/// Computes a map on a clock with some nanoseconds per particle and step.
fn mapped(
    subject: &Subject,
    nanoseconds: f64,
    journal: &Journal,
    stop: &AtomicBool,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Value, StudyError> {
    let watch = Stopwatch::with_synthetic_time(nanoseconds);
    let over = VariedRange::of(subject, None, None)?;
    let trial = TrialControl { watch: &watch, stop };
    let map = stability(subject, over, &EFFORT, trial, journal, progress)?;
    Ok(made(&[("scene".to_owned(), map)]).json())
}

fn whole(subject: &Subject, nanoseconds: f64) -> Result<Value, StudyError> {
    mapped(subject, nanoseconds, &Journal::none(), &AtomicBool::new(false), &|_| {})
}

/// By hand: steps of 0.5, 8 and 128 own steps cost 3 (2 + 1/8 + 1/128 + 16 + 2) + 16 own steps, and 2 with each of four integrators; these are 128
/// own steps of two discs at 0.5 s each, of which 38 % are planned.
#[test]
fn map_without_enough_time_is_refused() {
    let error = whole(&subject("two-discs", &["run.time=3.2"]), 0.5e9).err().unwrap();
    let StudyError::TooLittleTime { needed, budget } = error else { panic!("{error}") };
    let own_steps = 3.0 * (20.0 + 0.125 + 1.0 / 128.0) + 16.0 + 4.0 * 2.0;
    assert!((needed / (own_steps * 128.0 / 0.38) - 1.0).abs() < 1e-6 && budget == 600.0, "{needed}");
}

/// An interrupted map keeps its finished runs, and gives the same result when resumed.
#[test]
fn an_interrupted_map_resumes() {
    let folder = tempfile::tempdir().unwrap();
    let identity = JournalIdentity { of: "two discs".to_owned(), digest: "12345678".to_owned() };
    let subject = subject("two-discs", &["run.time=0.4"]);
    let run = |until: f64| {
        let stop = AtomicBool::new(false);
        let progress = |share: f64| _ = stop.fetch_or(share > until, Ordering::Relaxed);
        let journal = Journal::open(folder.path(), &identity, None).unwrap();
        (journal.len(), mapped(&subject, 1000.0, &journal, &stop, &progress))
    };
    let (before, interrupted) = run(0.3);
    assert!(before == 0 && matches!(interrupted, Err(StudyError::Interrupted)), "{interrupted:?}");
    let (kept, resumed) = run(2.0);
    let (all, again) = run(2.0);
    assert!(3 < kept && kept < all, "{kept} of {all}");
    let [straight, resumed, again] = [whole(&subject, 1000.0), resumed, again].map(Result::unwrap);
    assert!(straight == resumed && straight == again);
    assert!(!straight["cells"].as_array().unwrap().is_empty());
}
