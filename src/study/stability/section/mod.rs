//! The page of where methods work.

mod figures;
mod tables;

use super::conclusions::sentences;
use super::dataset::Stability;
use crate::console::Failure;
use crate::report::{Section, Verdict, csv};
use crate::results::Made;

/// What an item of it is called.
pub const NAME: &str = "stability";

/// The page over maps, each with a name for its files, and `again`, the command that makes it.
///
/// # Errors
/// If the dataset is none that JSON can hold.
pub fn made(maps: &[(String, Stability)], again: String) -> Result<Made, Failure> {
    let said = maps.iter().map(|(name, data)| format!("{name}. {}", sentences(data).join(" ")));
    let section = Section {
        name: NAME.into(),
        title: "Where the method works".into(),
        says: "The sources state a step, and not how far it is from one that fails.".into(),
        came_out: said.collect::<Vec<_>>().join("\n\n"),
        verdict: Verdict::Shown,
        again,
        figures: maps.iter().map(|(name, data)| figures::map(name, data)).collect(),
        tables: tables::of(maps),
        excerpt: None,
        film: None,
        seeds: maps.first().map_or(vec![], |(_, data)| data.seeds.clone()),
        // The time of the runs is as long as the time that is given allows.
        depends_on_host: true,
        provenance: None,
    };
    let all: serde_json::Map<String, serde_json::Value> = maps
        .iter()
        .map(|(name, data)| Ok((name.clone(), serde_json::to_value(data)?)))
        .collect::<serde_json::Result<_>>()
        .map_err(|cause| Failure::writing("JSON")(cause.into()))?;
    let mut made = Made::new(section, &all)?;
    for table in [tables::cells(maps), tables::boundaries(maps)] {
        let mut text = Vec::new();
        csv::write(&table, &mut text).map_err(Failure::writing("CSV"))?;
        made = made.with_file(&format!("{}.csv", table.name), String::from_utf8_lossy(&text).into_owned());
    }
    Ok(made)
}
