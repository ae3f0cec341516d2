//! Reports: finished data as tables, figures and pages. No exporter runs physics.

pub mod figure;
pub(crate) mod html;
pub(crate) mod markdown;
pub(crate) mod page;
pub(crate) mod section;
pub mod tally;
pub(crate) mod terminal;

use crate::provenance::Provenance;
use stripmine_physics::number::count_with_noun;

pub(crate) use crate::frame::FormattedTable;
pub use crate::frame::{FrameBuilder, TableCell};
pub(crate) use section::Chapter;
pub use section::Section;

/// Sentences on the origin of the items, one for each machine, with the number of items by program, in decreasing order.
fn origin_sentences(sections: &[Section]) -> Vec<String> {
    let made = || sections.iter().filter_map(|section| section.provenance.as_ref());
    let of_machine = |(machine, _): (String, usize)| {
        let here = made().filter(|it| it.machine_phrase() == machine);
        let programs = count_equal(here.map(Provenance::program_phrase)).into_iter();
        let programs =
            programs.map(|(made, count)| format!("{} {made}", count_with_noun(count, "item", "items")));
        format!("{}; {machine}.", programs.collect::<Vec<_>>().join("; "))
    };
    count_equal(made().map(Provenance::machine_phrase)).into_iter().map(of_machine).collect()
}

/// Counts equal texts, the most frequent first.
fn count_equal(texts: impl Iterator<Item = String>) -> Vec<(String, usize)> {
    let mut counts: Vec<(String, usize)> = vec![];
    for text in texts {
        match counts.iter_mut().find(|(known, _)| *known == text) {
            Some((_, count)) => *count += 1,
            None => counts.push((text, 1)),
        }
    }
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts
}
