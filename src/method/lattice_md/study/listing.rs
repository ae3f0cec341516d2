//! The vector instructions of a part of the step.

use super::efficiency_table::{Question, QuestionError, step};
use crate::method::lattice_md::Part;
use serde::Serialize;

/// One program of a part.
#[derive(Serialize)]
pub struct ProgramListing {
    part: &'static str,
    length: &'static str,
    n: usize,
    lines: Vec<String>,
}

/// The programs of a part for a question.
///
/// # Errors
/// [`QuestionError`] if there is no such lattice.
pub fn listings(part: Part, question: &Question) -> Result<Vec<ProgramListing>, QuestionError> {
    let (programs, lengths) = step(question)?;
    let of_part = programs.iter().filter(|step| step.part == part).map(|step| ProgramListing {
        part: part.name(),
        length: step.length.symbol(),
        n: lengths.range(step.length).len(),
        lines: step.program.listing().lines().map(str::to_owned).collect(),
    });
    Ok(of_part.collect())
}

/// Instructions of all programs: lines that are no comments.
pub fn instructions(listings: &[ProgramListing]) -> usize {
    listings.iter().flat_map(|listing| &listing.lines).filter(|line| !line.starts_with(';')).count()
}

/// The listing as text.
pub fn text(listings: &[ProgramListing]) -> String {
    let mut text = String::new();
    for ProgramListing { part, length, n, lines } in listings {
        text.push_str(&format!("; {part}: vectors of n = {length} = {n} elements\n"));
        for line in lines {
            text.push_str(line);
            text.push('\n');
        }
    }
    text
}
