//! A program that runs emitted kernels on arrays from a file, and writes these to its standard output.

use super::EmittedKernel;
use crate::isa::Storage;
use crate::isa::{Array, COUNTERS, LaneCounter, Memory};
use std::ops::Range;

/// Alignment of every array in the file (bytes).
const ALIGNMENT: usize = 64;

/// A call of a kernel.
#[derive(Clone, Debug)]
pub struct KernelCall<'k> {
    /// Name of its function.
    pub name: &'k str,
    /// The kernel.
    pub kernel: &'k EmittedKernel,
    /// Elements that it runs over.
    pub range: Range<usize>,
}

/// Arrays of a memory in a file, one after the other, and the counters behind them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ArrayFile {
    arrays: Vec<(Array, &'static str, Range<usize>)>,
    /// Contents of the file.
    pub bytes: Vec<u8>,
}

impl ArrayFile {
    /// Copies the arrays that some kernels name.
    pub fn of(memory: &Memory<'_>, calls: &[KernelCall<'_>]) -> ArrayFile {
        let mut file = ArrayFile::default();
        for named in calls.iter().flat_map(|call| &call.kernel.arrays) {
            let is_there = file
                .arrays
                .iter()
                .any(|(array, element, _)| (*array, *element) == (named.array, named.element));
            if let Some(bytes) = memory.bytes(named.array, named.element).filter(|_| !is_there) {
                let start = file.bytes.len();
                file.bytes.extend(bytes);
                file.arrays.push((named.array, named.element, start..file.bytes.len()));
                file.bytes.resize(file.bytes.len().next_multiple_of(ALIGNMENT), 0);
            }
        }
        for counter in 0..COUNTERS {
            file.bytes.extend(memory.counted(LaneCounter(counter as u8)).to_le_bytes());
        }
        file
    }

    /// Array that has the byte at a position of the file, and the number of its element, from 0.
    pub fn element_at(&self, position: usize) -> Option<(&'static str, usize)> {
        let (array, element, range) = self.arrays.iter().find(|(.., range)| range.contains(&position))?;
        let bytes = if *element == u32::NAME { u32::BYTES } else { f64::BYTES };
        Some((array.label(), (position - range.start) / bytes))
    }
}

/// Text of a program that calls some kernels in order, for a number of steps, on the arrays of a file in its folder. The functions of the kernels are
/// in other texts.
pub fn driver(calls: &[KernelCall<'_>], file: &ArrayFile, name_of_file: &str, steps: u64) -> String {
    let mut text = format!(
        "    .text
    .globl _start
_start:
    li s0, {steps}
step:
    beqz s0, done
    addi s0, s0, -1
"
    );
    let mut line = |words: std::fmt::Arguments<'_>| text.push_str(&format!("{words}\n"));
    for (at, KernelCall { name, range, .. }) in calls.iter().enumerate() {
        line(format_args!("    la a0, pointers_{at}"));
        line(format_args!("    li a1, {}", range.len()));
        line(format_args!("    li a2, {}", range.start + 1));
        line(format_args!("    call {name}"));
    }
    line(format_args!(
        "    j step
done:
    la s1, arrays
    li s2, {}
more:
    beqz s2, leave
    li a7, 64
    li a0, 1
    mv a1, s1
    mv a2, s2
    ecall
    blez a0, fail
    add s1, s1, a0
    sub s2, s2, a0
    j more
fail:
    li a0, 1
    j out
leave:
    li a0, 0
out:
    li a7, 93
    ecall

    .data
    .balign {ALIGNMENT}
arrays:
    .incbin \"{name_of_file}\"",
        file.bytes.len()
    ));
    let counters = file.bytes.len() - 8 * COUNTERS;
    for (at, KernelCall { kernel, range, .. }) in calls.iter().enumerate() {
        line(format_args!(
            "    .balign 8\npointers_{at}:\n    .quad constants_{at}, arrays + {counters}, spills"
        ));
        for named in &kernel.arrays {
            let of = |it: &&(Array, &'static str, Range<usize>)| (it.0, it.1) == (named.array, named.element);
            let start = file.arrays.iter().find(of).map_or(0, |(.., range)| range.start);
            let bytes = if named.element == u32::NAME { u32::BYTES } else { f64::BYTES };
            let first = if named.indexed { 0 } else { range.start * bytes };
            line(format_args!(
                "    .quad arrays + {}    # {} {}",
                start + first,
                named.array.label(),
                named.element
            ));
        }
        line(format_args!("constants_{at}:"));
        for constant in &kernel.constants {
            line(format_args!("    .quad {:#018x}    # {constant}", constant.to_bits()));
        }
    }
    let places = calls.iter().map(|call| call.kernel.places).max().unwrap_or(0);
    // The longest register that a processor may have is 65,536 bits.
    line(format_args!(
        "    .bss\n    .balign {ALIGNMENT}\nspills:\n    .space {}",
        (places * 8 * 1024).max(8)
    ));
    text
}
