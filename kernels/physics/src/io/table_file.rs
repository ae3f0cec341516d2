//! CSV tables that grow during a run: rows of observables and rows of events.

use super::growing_file::GrowingFile;
use super::run_moment::{RunHeader, RunMoment};
use super::sink::{TextFormat, WriteOccasion};
use std::io::{self, Write};
use std::iter::once;

/// Rows of observables: the column `step`, then numbers in the shortest form that reads back to the same bits.
#[derive(Debug)]
pub struct ObservedRows;

impl TextFormat for ObservedRows {
    const DUE: WriteOccasion = WriteOccasion::Row;

    type Entry = io::Result<String>;

    fn heading(header: &RunHeader) -> Option<String> {
        Some(once("step").chain(header.columns.iter().copied()).collect::<Vec<_>>().join(","))
    }

    fn entry(moment: &RunMoment<'_>) -> Option<io::Result<String>> {
        let (numbers, columns) = (moment.row?, moment.header.columns.len());
        let mut row = moment.number.to_string();
        for number in numbers {
            row.push_str(&format!(",{number:?}"));
        }
        row.push('\n');
        if numbers.len() != columns {
            let what = format!("a row of {} numbers for {columns} columns after `step`", numbers.len());
            return Some(Err(io::Error::other(what)));
        }
        Some(Ok(row))
    }

    fn write(row: io::Result<String>, out: &mut GrowingFile) -> io::Result<()> {
        out.write_all(row?.as_bytes())
    }
}

/// Rows of events, as formatted by the method.
#[derive(Debug)]
pub(crate) struct EventRows;

impl TextFormat for EventRows {
    const DUE: WriteOccasion = WriteOccasion::Events;

    type Entry = String;

    fn heading(header: &RunHeader) -> Option<String> {
        header.event_columns.map(str::to_owned)
    }

    fn entry(moment: &RunMoment<'_>) -> Option<String> {
        Some(moment.events.to_owned()).filter(|rows| !rows.is_empty())
    }

    fn write(rows: String, out: &mut GrowingFile) -> io::Result<()> {
        out.write_all(rows.as_bytes())
    }
}
