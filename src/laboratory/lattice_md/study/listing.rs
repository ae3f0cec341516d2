//! Vector instructions of a step, as text.

use super::efficiency_table::{TableScene, programs_of_step};
use crate::console::CommandFailure;
use crate::emission::{EmissionError, listing_text};
use crate::frame::{FrameBuilder, ResultFrame};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use stripmine_kernels::emit::GroupSize;
use stripmine_physics::method::lattice_md::Part;

/// Instructions and listing of the programs of a part, on the tape or for the register groups of a vector processor.
///
/// # Errors
/// If the scene is invalid, or a program has no code for the processor.
pub(crate) fn listing(
    part: Part,
    question: &TableScene,
    target: Option<GroupSize>,
) -> Result<(ResultFrame, String), CommandFailure> {
    let (programs, lengths) = programs_of_step(question)?;
    let (mut rows, mut text) = (vec![], String::new());
    for (number, step) in (1..).zip(programs.iter().filter(|step| step.part == part)) {
        let (length, n) = (step.length.symbol(), lengths.range(step.length).len());
        let listed = listing_text(&format!("{}_{number}", part.name()), step.program.as_ref(), target)
            .map_err(|cause| EmissionError::NoCode { part: part.name(), cause })?;
        let comment = if target.is_some() { '#' } else { ';' };
        text += &format!("{comment} {}: vectors of n = {length} = {n} elements\n{listed}", part.name());
        rows.extend(step.program.lines().into_iter().map(|line| (length, n, line)));
    }
    let frame = FrameBuilder::of(rows)
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
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let ours = TableScene::default();
    let printed = ours.printed();
    let (mut rows, mut files) = (vec![], vec![]);
    for (text, prefix, question) in [("printed", "printed_", &printed), ("ours", "", &ours)] {
        for part in Part::ALL {
            let (instructions, listing) = listing(*part, question, None)?;
            if !instructions.rows.is_empty() {
                rows.push((text, part.name(), instructions.rows.len()));
                files.push((format!("{prefix}{}.txt", part.name()), listing));
            }
        }
    }
    let frame = FrameBuilder::of(rows)
        .text("text", |(text, ..)| *text)
        .text("part", |(_, part, _)| *part)
        .count("instructions", |(.., instructions)| *instructions)
        .frame("instructions", "Vector instructions of a step");
    Ok(FinishedItem { files, ..FinishedItem::of([frame]) })
}
