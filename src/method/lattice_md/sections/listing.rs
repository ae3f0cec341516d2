//! The vector instructions of a step, as text.

use crate::report::{Part, Section, Verdict};

/// One program of a part, as text.
#[derive(Clone, Debug)]
pub struct PartListing {
    /// The part.
    pub part: &'static str,
    /// The listing.
    pub text: String,
    /// Vector instructions in it.
    pub instructions: usize,
}

/// How much of the longest listing a page shows.
const LINES: usize = 24;

/// What came out.
pub fn section(parts: &[PartListing]) -> Section {
    let lengths: Vec<_> = parts.iter().map(|part| format!("{} {}", part.part, part.instructions)).collect();
    let longest = parts.iter().max_by_key(|part| part.instructions);
    let excerpt = longest.map(|part| {
        let lines = part.text.lines().take(LINES).collect::<Vec<_>>().join("\n");
        (format!("The first lines of the {}:", part.part), lines)
    });
    Section {
        name: "listing".into(),
        title: "The vector instructions".into(),
        part: Part::Machine,
        question: "Which vector instructions does a step consist of?".into(),
        expected: "BP93 gives the algorithm in vector notation and prints no code.".into(),
        answer: format!("Vector instructions of the programs that run: {}.", lengths.join(", ")),
        details: vec![],
        verdict: Verdict::Measured,
        again: "stripmine reproduce --only listing".into(),
        figures: vec![],
        tables: vec![],
        excerpt,
        film: None,
        seeds: vec![],
        depends_on_host: false,
        provenance: None,
    }
}
