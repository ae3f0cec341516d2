//! Which of our operations the source's count has, part by part.
//!
//! The source prints one number for each part and no program. The count that agrees with most of them is the one of its own
//! text: arithmetic, stores, gathers and scatters of what its equations ask for. Loads are not counted (an operand comes from
//! memory), nor are changes between numbers and index vectors (a number in a register of a CRAY serves as both), nor what our
//! programs do beside the equations.

use super::printed_nop;
use crate::method::lattice_md::Part;
use serde::Serialize;
use stripmine_kernels::isa::{Op, OpClass};
use stripmine_kernels::ledger::Ledger;

/// The sections of the programs that only ours have, and what they are for. All other sections stand in the source.
const OURS: [(Part, &str, &str); 7] = [
    (
        Part::Predictor,
        "velocities",
        "our derivatives are scaled by powers of dt; the source keeps velocities themselves",
    ),
    (Part::Index, "wrap", "positions return into the periodic box; the source says nothing of it"),
    (
        Part::Index,
        "bounds",
        "a disc outside the lattice is found and named; the source's would write elsewhere",
    ),
    (Part::Index, "copy", "positions once more for the lattice vectors, relative to the cell where asked"),
    (Part::Index, "check", "two discs in one cell are found and named; the source's would lose one"),
    (Part::Index, "images", "the Index repeated beyond periodic sides"),
    (Part::Corrector, "gravity", "gravity; the source's equations have none"),
];

/// A section of the programs, beside the source's count.
#[derive(Clone, Debug, Serialize)]
pub struct DifferenceRow {
    /// The part.
    pub part: &'static str,
    /// The section.
    pub section: &'static str,
    /// Our operations.
    pub ours: u64,
    /// Of these, loads and shifted copies, which are operands.
    pub loads: u64,
    /// Of these, changes between numbers and index vectors.
    pub conversions: u64,
    /// Of these, what the source's count has: all others, where the section stands in the source.
    pub counted: u64,
    /// Why the source does not count the section; none where it does.
    pub only_ours: Option<&'static str>,
}

/// Every section of predictor, index and corrector. The forces have a table of their own, and no program of the source to
/// compare with.
pub fn differences(ledger: &Ledger) -> Vec<DifferenceRow> {
    let mut rows: Vec<DifferenceRow> = Vec::new();
    for part in [Part::Predictor, Part::Index, Part::Corrector] {
        for entry in ledger.entries().iter().filter(|entry| entry.part == part.name()) {
            let of = |keep: fn(Op) -> bool| entry.counts.filtered(keep).total();
            let only_ours = OURS.iter().find(|known| (known.0, known.1) == (part, entry.section));
            let (loads, conversions) = (of(is_load), of(is_conversion));
            let left = entry.counts.total() - loads - conversions;
            rows.push(DifferenceRow {
                part: part.name(),
                section: entry.section,
                ours: entry.counts.total(),
                loads,
                conversions,
                counted: if only_ours.is_some() { 0 } else { left },
                only_ours: only_ours.map(|known| known.2),
            });
        }
    }
    rows
}

/// The factors 2, 3, 4; 3, 6; 4 of the Pascal triangle for each of three degrees of freedom, which scaled derivatives do
/// without.
pub const PASCAL_FACTORS: u64 = 3 * 6;

fn is_load(op: Op) -> bool {
    matches!(op.class(), OpClass::Load | OpClass::Shift)
}

fn is_conversion(op: Op) -> bool {
    matches!(op, Op::Numbers | Op::ToIndex | Op::FromIndex)
}

/// Ours by the source's way of counting, and the printed number.
pub fn by_the_source(rows: &[DifferenceRow], part: Part) -> (u64, Option<u64>) {
    (rows.iter().filter(|row| row.part == part.name()).map(|row| row.counted).sum(), printed_nop(part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::lattice_md::ledger;
    use crate::method::lattice_md::study::efficiency_table::{Question, step};

    #[test]
    fn index_and_corrector_come_out_as_printed_by_the_sources_way_of_counting() {
        let ledger = ledger(&step(&Question::default()).unwrap().0);
        let rows = differences(&ledger);
        assert_eq!(by_the_source(&rows, Part::Index), (12, Some(12)));
        assert_eq!(by_the_source(&rows, Part::Corrector), (54, Some(54)));
        // The predictor does not: with the factors of derivatives that are not scaled it is 60.
        assert_eq!(by_the_source(&rows, Part::Predictor), (42, Some(59)));
        for (part, section, _) in &OURS {
            assert!(
                rows.iter().any(|row| row.part == part.name() && row.section == *section),
                "{section} is a section of {}",
                part.name()
            );
        }
        let ours: u64 = rows.iter().map(|row| row.ours).sum();
        let parts = [Part::Predictor, Part::Index, Part::Corrector];
        assert_eq!(ours, parts.iter().map(|part| ledger.part(part.name()).total()).sum::<u64>());
    }
}
