//! Ledger of a step: the operations that each part executes, and the lengths of its vectors. It is filled from the tallies of the
//! kernels that run; the clocks read it.

use crate::Runnable;
use crate::isa::OpCounts;

/// Symbolic length of the vectors of a kernel; a scene gives its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VectorLength {
    /// Discs that move: NP of BP93.
    Grains,
    /// All discs, with those of the walls.
    Discs,
    /// Cells with the halo at the ends of each row: LMAX of BP93 and a little more.
    SweptCells,
    /// Cells with the whole halo.
    PaddedCells,
    /// Halo cells that repeat a cell.
    HaloCells,
    /// Elements of walls, once for each cell that can touch them.
    WallElements,
    /// Entries of neighbour lists; depends on the data.
    Candidates,
    /// Candidates near enough to evaluate the law; depends on the data.
    Pairs,
}

impl VectorLength {
    /// Symbol in tables.
    pub const fn symbol(self) -> &'static str {
        match self {
            VectorLength::Grains => "NP",
            VectorLength::Discs => "NP + walls",
            VectorLength::SweptCells => "LMAX + row ends",
            VectorLength::PaddedCells => "LMAX + halo",
            VectorLength::HaloCells => "halo",
            VectorLength::WallElements => "wall cells",
            VectorLength::Candidates => "candidates",
            VectorLength::Pairs => "pairs",
        }
    }
}

/// Operations of one section of one kernel, once a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LedgerEntry {
    /// Part of the method.
    pub part: &'static str,
    /// Section of the kernel.
    pub section: &'static str,
    /// Length of the vectors.
    pub length: VectorLength,
    /// Operations.
    pub counts: OpCounts,
}

/// All operations of a step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ledger(Vec<LedgerEntry>);

impl Ledger {
    /// Enters the tally of a kernel.
    pub fn enter(&mut self, part: &'static str, length: VectorLength, program: &dyn Runnable) {
        let entry = |(section, counts)| LedgerEntry { part, section, length, counts };
        self.0.extend(program.tally().into_iter().map(entry));
    }

    /// Enters counts that come from no kernel.
    pub fn enter_counts(
        &mut self,
        part: &'static str,
        section: &'static str,
        length: VectorLength,
        counts: OpCounts,
    ) {
        self.0.push(LedgerEntry { part, section, length, counts });
    }

    /// Entries in the order of the step.
    pub fn entries(&self) -> &[LedgerEntry] {
        &self.0
    }

    /// Parts and their vector lengths in the order of the step, each with its operations.
    pub fn parts(&self) -> Vec<(&'static str, VectorLength, OpCounts)> {
        let mut parts: Vec<(&'static str, VectorLength, OpCounts)> = Vec::new();
        for entry in &self.0 {
            match parts.iter_mut().find(|(part, length, _)| (*part, *length) == (entry.part, entry.length)) {
                Some((.., counts)) => counts.add(&entry.counts),
                None => parts.push((entry.part, entry.length, entry.counts.clone())),
            }
        }
        parts
    }

    /// All operations of a part, summed over vector lengths.
    pub fn part(&self, part: &str) -> OpCounts {
        let mut sum = OpCounts::default();
        self.0.iter().filter(|entry| entry.part == part).for_each(|entry| sum.add(&entry.counts));
        sum
    }
}
