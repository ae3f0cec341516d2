//! Reports: finished data as tables, figures and pages. Each export is one small file; none of them runs physics.

pub mod csv;
pub mod figure;
pub mod html;
pub mod markdown;
pub mod page;
pub mod section;
pub mod table;
pub mod terminal;

use stripmine_physics::number::counted;

pub use section::{Chapter, Section, Verdict};
pub use table::{Cell, Rows, Table};

/// Who made the items, and where: a sentence for each program and machine, with how many of them, the most first.
fn origins(sections: &[Section]) -> Vec<String> {
    let mut counts: Vec<(String, usize)> = vec![];
    for provenance in sections.iter().filter_map(|section| section.provenance.as_ref()) {
        let made = provenance.of_program_and_machine();
        match counts.iter_mut().find(|(known, _)| *known == made) {
            Some((_, count)) => *count += 1,
            None => counts.push((made, 1)),
        }
    }
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let said = |(made, count): (String, usize)| format!("{} {made}", counted(count, "item", "items"));
    counts.into_iter().map(said).collect()
}
