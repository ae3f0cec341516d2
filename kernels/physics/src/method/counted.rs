//! Operation counts of a scene's vector programs, section by section.

use super::entry::VectorProgram;
use serde::Serialize;
use stripmine_kernels::isa::{OpClass, OpCounts};

/// Operation counts of one program section in a step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SectionCounts {
    /// The part of the step.
    pub part: &'static str,
    /// The section of the program.
    pub section: &'static str,
    /// Symbol of the vector length.
    pub length: &'static str,
    /// Vector length.
    pub n: usize,
    /// Operations a step (NOP).
    pub operations: u64,
    /// Arithmetic operations among them.
    pub computing: u64,
    /// Divisions and square roots among them.
    pub divisions_and_roots: u64,
    /// Floating-point operations: sums, differences, products, quotients, roots.
    pub flops: u64,
    /// Bytes that loads and stores move for an element.
    pub bytes: u64,
}

impl SectionCounts {
    /// Returns the sections of some programs in order; sections of the same name and length are merged.
    pub fn of(programs: &[VectorProgram]) -> Vec<SectionCounts> {
        let mut counted: Vec<SectionCounts> = vec![];
        for it in programs {
            for ((section, counts), bytes) in it.program.tally().into_iter().zip(it.program.moved_bytes()) {
                let entry = SectionCounts::section(it, section, &counts, bytes);
                let is_same = |known: &&mut SectionCounts| {
                    (known.part, known.section, known.length, known.n) == (it.part, section, it.length, it.n)
                };
                match counted.iter_mut().find(is_same) {
                    Some(known) => {
                        known.operations += entry.operations;
                        known.computing += entry.computing;
                        known.divisions_and_roots += entry.divisions_and_roots;
                        known.flops += entry.flops;
                        known.bytes += entry.bytes;
                    }
                    None => counted.push(entry),
                }
            }
        }
        counted
    }

    /// Floating-point operations a byte.
    pub fn intensity(&self) -> f64 {
        self.flops as f64 / self.bytes as f64
    }

    fn section(it: &VectorProgram, section: &'static str, counts: &OpCounts, bytes: u64) -> SectionCounts {
        let class = |class: OpClass| counts.of_class(class);
        SectionCounts {
            part: it.part,
            section,
            length: it.length,
            n: it.n,
            operations: it.times * counts.total(),
            computing: it.times * counts.filtered(|op| !op.class().moves_data()).total(),
            divisions_and_roots: it.times * (class(OpClass::Divide) + class(OpClass::SquareRoot)),
            flops: it.times * counts.flops(),
            bytes: it.times * bytes,
        }
    }
}
