//! The vector instructions of a part of the step.

use super::efficiency_table::{Question, QuestionError, step};
use serde::Serialize;
use stripmine_kernels::backend::Line;
use stripmine_physics::method::lattice_md::Part;

/// One program of a part.
#[derive(Serialize)]
pub struct ProgramListing {
    part: &'static str,
    length: &'static str,
    n: usize,
    instructions: Vec<Line>,
    #[serde(skip)]
    text: String,
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
        instructions: step.program.lines(),
        text: step.program.listing(),
    });
    Ok(of_part.collect())
}

/// Instructions of all programs.
pub fn instructions(listings: &[ProgramListing]) -> usize {
    listings.iter().map(|listing| listing.instructions.len()).sum()
}

/// The listing as text.
pub fn text(listings: &[ProgramListing]) -> String {
    let of = |it: &ProgramListing| {
        let ProgramListing { part, length, n, text, .. } = it;
        format!("; {part}: vectors of n = {length} = {n} elements\n{text}")
    };
    listings.iter().map(of).collect()
}
