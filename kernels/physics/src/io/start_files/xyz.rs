//! XYZ, extended by `key=value` in the second line or plain.

use super::{QuantitySource, StartBox, StartFileError, StartFormat, StartFrame, StartRequest, lines};
use crate::io::extxyz::{ParsedFrame, read_start};
use std::path::Path;

pub(super) static FORMAT: StartFormat = StartFormat {
    name: "XYZ (extended or plain)",
    recognises: |head| lines(head).find(|line| !line.is_empty()).is_some_and(begins_with_number),
    read,
    columns: ["velo:R:3 (or velo:R:2, momenta:R:3)", "radius:R:1", "mass:R:1 (or masses:R:1)"],
};

/// True if the first word of a line is a number; a wrong count has the message of the format.
fn begins_with_number(line: &[u8]) -> bool {
    let text = String::from_utf8_lossy(line);
    text.split_ascii_whitespace().next().is_some_and(|word| word.parse::<f64>().is_ok())
}

fn read(path: &Path, request: StartRequest) -> Result<StartFrame, StartFileError> {
    let ParsedFrame { frame, columns, line } = read_start(path, request.frame, request.is_planar)?
        .map_err(|count| StartFileError::beyond(path, request, count))?;
    let source = |is_there| if is_there { QuantitySource::Stated } else { QuantitySource::Missing };
    let cell =
        StartBox { corner: frame.origin, sides: frame.cell, is_movable: false, precision: StartBox::DOUBLE };
    Ok(StartFrame {
        particles: frame.particles,
        cell: frame.cell.iter().all(|side| side.is_finite()).then_some(cell),
        periodic: frame.periodic,
        sources: [columns.velocity, columns.radius, columns.mass].map(source),
        has_momenta: columns.has_momenta_only,
        line: Some(line),
        columns: FORMAT.columns,
        has_raised_ids: frame.has_raised_ids,
    })
}
