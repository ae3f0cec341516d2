//! Vector instructions of a step, as text.

use super::efficiency_table::{Question, QuestionError, step};
use crate::console::Failure;
use crate::frame::{Frame, Rows};
use crate::results::{Lab, Made, Size};
use stripmine_physics::method::lattice_md::Part;

/// Instructions and listing of the programs of a part.
pub(crate) fn listing(part: Part, question: &Question) -> Result<(Frame, String), QuestionError> {
    let (programs, lengths) = step(question)?;
    let (mut rows, mut text) = (vec![], String::new());
    for step in programs.iter().filter(|step| step.part == part) {
        let (length, n) = (step.length.symbol(), lengths.range(step.length).len());
        text +=
            &format!("; {}: vectors of n = {length} = {n} elements\n{}", part.name(), step.program.listing());
        rows.extend(step.program.lines().into_iter().map(|line| (length, n, line)));
    }
    let frame = Rows::of(rows)
        .text("n is", |(length, ..)| *length)
        .count("n", |(_, n, _)| *n)
        .text("section", |(.., line)| line.section)
        .text("operation", |(.., line)| line.operation)
        .text("destination", |(.., line)| line.destination.clone())
        .text("sources", |(.., line)| line.sources.join(" "))
        .frame("instructions", part.meaning());
    Ok((frame, text))
}

/// Lists BP93's program, then ours.
pub(crate) fn made(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let ours = Question::default();
    let printed = ours.printed();
    let (mut rows, mut files) = (vec![], vec![]);
    for (text, prefix, question) in [("printed", "printed_", &printed), ("ours", "", &ours)] {
        for part in Part::ALL {
            let (instructions, listing) = listing(*part, question)?;
            if !instructions.rows.is_empty() {
                rows.push((text, part.name(), instructions.rows.len()));
                files.push((format!("{prefix}{}.txt", part.name()), listing));
            }
        }
    }
    let frame = Rows::of(rows)
        .text("text", |(text, ..)| *text)
        .text("part", |(_, part, _)| *part)
        .count("instructions", |(.., instructions)| *instructions)
        .frame("instructions", "Vector instructions of a step");
    Ok(Made { files, ..Made::of([frame]) })
}
