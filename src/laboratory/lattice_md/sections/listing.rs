//! The vector instructions of a step, as text.

use crate::report::{Section, Verdict};

/// One program of a part, as text.
#[derive(Clone, Debug)]
pub struct PartListing {
    /// The part.
    pub part: String,
    /// The listing.
    pub text: String,
    /// Vector instructions in it.
    pub instructions: usize,
}

/// Sections of the printed forces before and after the first place of the mask: what is loaded once, and the next place.
const FIRST_PLACE: &str = "; (5), (6)";

/// What came out.
pub fn section(parts: &[PartListing]) -> Section {
    let of = |is_printed: bool| {
        let those = parts.iter().filter(|part| part.part.starts_with("printed_") == is_printed);
        let words =
            those.map(|part| format!("{} {}", part.part.trim_start_matches("printed_"), part.instructions));
        words.collect::<Vec<_>>().join(", ")
    };
    let forces = parts.iter().find(|part| part.part == "printed_forces");
    let excerpt = forces.map(|part| {
        let place: Vec<&str> = part.text.split(FIRST_PLACE).collect();
        let lines = place.get(1).map_or(String::new(), |lines| format!("{FIRST_PLACE}{lines}"));
        ("The printed text, place 1 of the mask, each line below its equation:".to_owned(), lines)
    });
    Section::new("listing", "The vector instructions")
        .asks("Which vector instructions does a step consist of?")
        .expects("BP93 gives the algorithm in vector notation and prints no code.")
        .verdict(Verdict::Computed)
        .answers(format!(
            "Vector instructions of the source's own text, written as printed: {}; of ours: {}. A section of the printed text is named by its \
             equation; box and halo are beside them.",
            of(true),
            of(false)
        ))
        .excerpt(excerpt)
}
