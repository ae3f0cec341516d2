//! Recorded kernels: their instructions, and everything derived from these alone.

use super::allocation::{FileSizes, allocate};
use super::folding::fold_loads;
use super::instruction::{Instruction, RegisterKind};
use super::recorder::{Recording, TapeRecorder};
use crate::isa::{Element, Footprint, Kernel, OpCounts};

/// A recorded kernel: straight-line vector instructions with registers, and the passes that execute them.
#[derive(Clone, Debug)]
pub struct Tape<L> {
    pub(super) instructions: Vec<Instruction<L>>,
    pub(super) sections: Vec<&'static str>,
    /// Names of the kernel's own arrays.
    pub(super) names: Vec<String>,
    pub(super) sizes: FileSizes,
    pub(super) passes: Vec<Instruction<L>>,
    pub(super) pass_sizes: FileSizes,
}

impl<L: Element> Tape<L> {
    /// Records `text` by running it once on a machine that computes nothing.
    pub fn record<T: Kernel<Lane = L>>(text: &T) -> Self {
        let recorder = TapeRecorder::new();
        text.body(Recording(&recorder));
        let mut instructions = recorder.instructions.into_inner();
        let mut passes = fold_loads(&instructions);
        let sizes = allocate(&mut instructions);
        let pass_sizes = allocate(&mut passes);
        // Copies without spare capacity: the buffers of the recording are free for the next kernel, and no gaps are left.
        let (instructions, passes) = (instructions.as_slice().to_vec(), passes.as_slice().to_vec());
        Tape {
            instructions,
            sections: recorder.sections.into_inner(),
            names: vec![],
            sizes,
            passes,
            pass_sizes,
        }
    }

    /// Gives the kernel's own arrays their names in listings.
    #[must_use]
    pub(crate) fn with_names(self, names: Vec<String>) -> Self {
        Tape { names, ..self }
    }

    /// Memory of the instructions in bytes.
    pub fn bytes(&self) -> usize {
        (self.instructions.len() + self.passes.len()) * size_of::<Instruction<L>>()
    }

    /// Instructions in order.
    pub fn instructions(&self) -> &[Instruction<L>] {
        &self.instructions
    }

    /// Registers of a file that the kernel needs at once.
    pub fn registers(&self, file: RegisterKind) -> usize {
        self.sizes[file as usize]
    }

    /// Operations executed, section by section, in the order of the kernel.
    pub fn tally(&self) -> Vec<(&'static str, OpCounts)> {
        let mut tally: Vec<_> = self.sections.iter().map(|&name| (name, OpCounts::default())).collect();
        for instruction in &self.instructions {
            instruction.operations().for_each(|op| tally[instruction.section].1.record(op));
        }
        tally.retain(|(_, counts)| counts.total() > 0);
        tally
    }

    /// Bytes of an element's loads and stores, section by section as [`Tape::tally`]: what a machine moves that keeps nothing but registers.
    pub fn moved_bytes(&self) -> Vec<u64> {
        let mut moved = vec![None; self.sections.len()];
        for instruction in &self.instructions {
            let bytes = instruction.reference().map_or(0, |it| it.element_bytes());
            *moved[instruction.section].get_or_insert(0) += bytes;
        }
        moved.into_iter().flatten().collect()
    }

    /// Arrays that the kernel accesses, with the range of shifts.
    pub fn footprint(&self) -> Footprint {
        let mut footprint = Footprint::default();
        for instruction in &self.instructions {
            if let Some(reference) = instruction.reference() {
                let shift = (!instruction.is_indexed()).then_some(reference.shift);
                footprint.record(reference.array, reference.element, shift, instruction.to().is_none());
            }
        }
        footprint
    }
}
