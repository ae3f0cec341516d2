//! The files that a scene asks for.

use super::folder::{DATA, DCD, DUMP, EVENTS, GSD};
use super::structured::chosen;
use crate::method::Prepared;

/// The files that a scene asks for beyond what every run writes.
pub(super) fn on_request(prepared: &Prepared) -> Vec<&'static str> {
    let output = &prepared.output;
    let asked = [
        (output.lammps_dump, DUMP),
        (output.dcd, DCD),
        (output.gsd, GSD),
        (output.lammps_data, DATA),
        (prepared.event_columns.is_some(), EVENTS),
    ];
    let structure = chosen(output).map(|observable| observable.file);
    asked.into_iter().filter_map(|(asked, name)| asked.then_some(name)).chain(structure).collect()
}
