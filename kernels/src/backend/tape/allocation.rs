//! Register allocation: few registers, each reused after its last reader.

use super::instruction::{Instruction, RegisterKind};
use crate::isa::Element;
use std::collections::HashMap;

/// Number of registers per file, in the order of [`RegisterKind::ALL`].
pub(super) type FileSizes = [usize; RegisterKind::ALL.len()];

/// Renames the registers of straight-line code (each written once) to as few as possible.
///
/// A result may take the register of an operand that is read for the last time: instructions work lane by lane, and a lane is
/// read before it is written. So few registers are in use, and they stay in the cache.
pub(super) fn allocate<L: Element>(instructions: &mut [Instruction<L>]) -> FileSizes {
    let mut last_use = HashMap::new();
    for (at, instruction) in instructions.iter_mut().enumerate() {
        instruction.registers(|name| {
            last_use.insert(*name, at);
        });
    }
    let mut renamed = HashMap::new();
    let mut free: [Vec<u32>; RegisterKind::ALL.len()] = Default::default();
    let mut sizes: FileSizes = Default::default();
    for (at, instruction) in instructions.iter_mut().enumerate() {
        instruction.registers(|name| {
            let file = name.file as usize;
            let number = *renamed.entry(*name).or_insert_with(|| {
                free[file].pop().unwrap_or_else(|| {
                    sizes[file] += 1;
                    sizes[file] as u32 - 1
                })
            });
            if last_use[name] == at && !free[file].contains(&number) {
                free[file].push(number);
            }
            name.number = number;
        });
    }
    sizes
}
