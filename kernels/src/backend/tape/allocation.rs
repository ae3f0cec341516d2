//! Register allocation: few registers, each written again once its last reader is past.

use super::instruction::{File, Instruction, Role};
use crate::isa::Element;
use std::collections::HashMap;

/// How many registers of each file a program needs, in the order of [`File::ALL`].
pub(super) type FileSizes = [usize; File::ALL.len()];

/// Renames the registers of straight-line code (each written once) to as few as possible.
///
/// A result never takes the register of an operand of the same instruction, so that executing one never overwrites
/// what it still reads.
pub(super) fn allocate<L: Element>(instructions: &mut [Instruction<L>]) -> FileSizes {
    let mut last_use = HashMap::new();
    for (at, instruction) in instructions.iter_mut().enumerate() {
        instruction.registers(|name, _| {
            last_use.insert(*name, at);
        });
    }
    let mut homes = HashMap::new();
    let mut free: [Vec<u32>; File::ALL.len()] = Default::default();
    let mut sizes: FileSizes = Default::default();
    for (at, instruction) in instructions.iter_mut().enumerate() {
        let mut dying = Vec::new();
        instruction.registers(|name, role| {
            let file = name.file as usize;
            if last_use[name] == at {
                dying.push(*name);
            }
            if role == Role::Writes {
                let home = free[file].pop().unwrap_or_else(|| {
                    sizes[file] += 1;
                    sizes[file] as u32 - 1
                });
                homes.insert(*name, home);
            }
            name.number = homes[name];
        });
        dying.dedup();
        for name in dying {
            if let Some(home) = homes.remove(&name) {
                free[name.file as usize].push(home);
            }
        }
    }
    sizes
}
