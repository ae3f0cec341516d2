//! The page of speed against accuracy.

mod figures;
mod tables;

use super::conclusions::sentences;
use super::dataset::WorkPrecision;
use crate::console::Failure;
use crate::report::{Section, Verdict, csv};
use crate::results::Made;

/// What an item of it is called.
pub const NAME: &str = "work-precision";

/// The page over scenes, each with a name for its files, and `again`, the command that makes it.
///
/// # Errors
/// If the dataset is none that JSON can hold.
pub fn made(scenes: &[(String, WorkPrecision)], again: String) -> Result<Made, Failure> {
    let said = scenes.iter().map(|(name, data)| format!("{name}. {}", sentences(data).join(" ")));
    let mut seeds: Vec<u64> = scenes.iter().flat_map(|(_, data)| data.seeds.clone()).collect();
    seeds.sort_unstable();
    seeds.dedup();
    let section = Section {
        name: NAME.into(),
        title: "Speed against accuracy".into(),
        says: "The sources state a scheme and a step, and no error.".into(),
        came_out: said.collect::<Vec<_>>().join("\n\n"),
        verdict: Verdict::Shown,
        again,
        figures: scenes.iter().flat_map(|(name, data)| figures::of(name, data)).collect(),
        tables: tables::of(scenes),
        excerpt: None,
        film: None,
        seeds,
        depends_on_host: true,
        provenance: None,
    };
    let all: serde_json::Map<String, serde_json::Value> = scenes
        .iter()
        .map(|(name, data)| Ok((name.clone(), serde_json::to_value(data)?)))
        .collect::<serde_json::Result<_>>()
        .map_err(|cause| Failure::writing("JSON")(cause.into()))?;
    let mut made = Made::new(section, &all)?;
    for table in [tables::runs(scenes), tables::all_means(scenes)] {
        let mut text = Vec::new();
        csv::write(&table, &mut text).map_err(Failure::writing("CSV"))?;
        made = made.with_file(&format!("{}.csv", table.name), String::from_utf8_lossy(&text).into_owned());
    }
    Ok(made)
}
