//! The ledger of a method's step: which part executes which operations, over vectors of which length. Filled from
//! the tallies of the programs that run; the clocks read it.

use crate::Runnable;
use crate::isa::OpCounts;

/// The length of the vectors a program runs over, before a scene says how much that is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Length {
    /// The discs that move: the source's NP.
    Grains,
    /// The discs with those of the walls.
    Discs,
    /// The cells with the halo at the ends of each row: the source's LMAX and a little.
    SweptCells,
    /// The cells with the whole halo.
    PaddedCells,
    /// The halo cells that repeat a cell.
    HaloCells,
    /// Entries of neighbour lists: depends on the data.
    Candidates,
    /// Candidates near enough for the law to be asked: depends on the data.
    Pairs,
}

impl Length {
    /// The symbol in tables.
    pub const fn symbol(self) -> &'static str {
        match self {
            Length::Grains => "NP",
            Length::Discs => "NP + walls",
            Length::SweptCells => "LMAX + row ends",
            Length::PaddedCells => "LMAX + halo",
            Length::HaloCells => "halo",
            Length::Candidates => "candidates",
            Length::Pairs => "pairs",
        }
    }
}

/// What one section of one program executes, once a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// The part of the method.
    pub part: &'static str,
    /// The section of the program's text.
    pub section: &'static str,
    /// Length of the vectors.
    pub length: Length,
    /// The operations.
    pub counts: OpCounts,
}

/// All that a step executes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ledger(Vec<Entry>);

impl Ledger {
    /// Enters a program's tally.
    pub fn enter(&mut self, part: &'static str, length: Length, program: &dyn Runnable) {
        let entry = |(section, counts)| Entry { part, section, length, counts };
        self.0.extend(program.tally().into_iter().map(entry));
    }

    /// Enters counts that no program of its own stands behind.
    pub fn enter_counts(
        &mut self,
        part: &'static str,
        section: &'static str,
        length: Length,
        counts: OpCounts,
    ) {
        self.0.push(Entry { part, section, length, counts });
    }

    /// The entries, in the order of the step.
    pub fn entries(&self) -> &[Entry] {
        &self.0
    }

    /// The parts and the lengths they run over, in the order of the step, with all they execute there.
    pub fn parts(&self) -> Vec<(&'static str, Length, OpCounts)> {
        let mut parts: Vec<(&'static str, Length, OpCounts)> = Vec::new();
        for entry in &self.0 {
            match parts.iter_mut().find(|(part, length, _)| (*part, *length) == (entry.part, entry.length)) {
                Some((.., counts)) => counts.add(&entry.counts),
                None => parts.push((entry.part, entry.length, entry.counts.clone())),
            }
        }
        parts
    }

    /// All operations of a part, whatever their length.
    pub fn part(&self, part: &str) -> OpCounts {
        let mut sum = OpCounts::default();
        self.0.iter().filter(|entry| entry.part == part).for_each(|entry| sum.add(&entry.counts));
        sum
    }
}
