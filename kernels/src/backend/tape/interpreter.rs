//! Executes a tape strip by strip: each instruction a pass over the strip. One strip over everything is the unchained
//! CRAY; short strips keep the registers in the cache.

use super::Tape;
use super::instruction::{Action, File, Instruction, Operand, RegisterName};
use crate::backend::{Precision, Registers};
use crate::isa::{Element, Memory, Op, ProgramError, Slot, Storage};
use crate::program::{InstructionSet, Task, dispatch};
use std::mem::take;
use std::ops::Range;

/// The register files, each register as long as a strip.
struct RegisterFiles<L> {
    numbers: Vec<Vec<L>>,
    predicates: Vec<Vec<u8>>,
    indices: Vec<Vec<u32>>,
}

/// What an instruction reads, lane by lane.
#[derive(Clone, Copy)]
enum Source<'r, L> {
    Lanes(&'r [L]),
    Uniform(L),
}

/// The strip an instruction works on.
#[derive(Clone, Copy)]
struct Span {
    base: usize,
    length: usize,
}

impl<L: Precision> Tape<L> {
    /// Executes the program with passes compiled for an instruction set. The memory was admitted.
    pub(crate) fn interpret(
        &self,
        memory: &Memory<'_>,
        range: Range<usize>,
        strip: usize,
        set: InstructionSet,
    ) -> Result<(), ProgramError> {
        dispatch(set, Passes { tape: self, memory, range, strip })
    }
}

/// An admitted run of a tape.
struct Passes<'r, L> {
    tape: &'r Tape<L>,
    memory: &'r Memory<'r>,
    range: Range<usize>,
    strip: usize,
}

impl<L: Precision> Task<L> for Passes<'_, L> {
    #[inline(always)]
    fn on<R: Registers<Lane = L>>(self, _: R) {
        // The passes are plain loops: the instruction set they are inlined into is what vectorises them.
        self.tape.execute(self.memory, self.range, self.strip);
    }
}

impl<L: Element> Tape<L> {
    /// Executes the program for the elements of `range`, in strips of at most `strip`.
    ///
    /// Inlined into a function of the processor's instruction set, where the compiler vectorises the passes.
    #[inline(always)]
    fn execute(&self, memory: &Memory<'_>, range: Range<usize>, strip: usize) {
        let strip = strip.min(range.len());
        let mut files = RegisterFiles {
            numbers: vec![vec![L::default(); strip]; self.registers(File::Number)],
            predicates: vec![vec![0; strip]; self.registers(File::Predicate)],
            indices: vec![vec![0; strip]; self.registers(File::Index)],
        };
        let mut base = range.start;
        while base < range.end {
            let span = Span { base, length: strip.min(range.end - base) };
            for instruction in &self.instructions {
                files.step(instruction, memory, span);
            }
            base += span.length;
        }
    }
}

#[inline(always)]
fn unary<L: Copy, R>(to: &mut [R], a: Source<'_, L>, f: impl Fn(L) -> R) {
    match a {
        Source::Lanes(a) => to.iter_mut().zip(a).for_each(|(to, &a)| *to = f(a)),
        Source::Uniform(a) => to.iter_mut().for_each(|to| *to = f(a)),
    }
}

#[inline(always)]
fn binary<L: Copy, R>(to: &mut [R], a: Source<'_, L>, b: Source<'_, L>, f: impl Fn(L, L) -> R) {
    match (a, b) {
        (Source::Lanes(a), Source::Lanes(b)) => {
            to.iter_mut().zip(a).zip(b).for_each(|((to, &a), &b)| *to = f(a, b));
        }
        (Source::Lanes(a), Source::Uniform(b)) => to.iter_mut().zip(a).for_each(|(to, &a)| *to = f(a, b)),
        (Source::Uniform(a), b) => unary(to, b, |b| f(a, b)),
    }
}

/// One lane of what an instruction reads.
#[inline(always)]
fn lane<L: Copy>(source: Source<'_, L>, i: usize) -> L {
    match source {
        Source::Lanes(lanes) => lanes[i],
        Source::Uniform(value) => value,
    }
}

/// The strip of an array in memory.
///
/// # Safety
/// The memory was admitted for the program's footprint, and no writer of the array is alive.
#[inline(always)]
unsafe fn strip_of<'m, T: Storage>(
    memory: &'m Memory<'_>,
    slot: Slot<T>,
    shift: isize,
    span: Span,
) -> &'m [T] {
    // SAFETY: the footprint covers base + shift and `length` elements from there on.
    unsafe {
        std::slice::from_raw_parts(memory.column(slot).at(span.base.wrapping_add_signed(shift)), span.length)
    }
}

/// The strip of an array in memory, to be written.
///
/// # Safety
/// As [`strip_of`]; moreover the array is writable and no other reader of it is alive.
#[inline(always)]
#[expect(clippy::mut_from_ref, reason = "the memory owns exclusive borrows behind its columns")]
unsafe fn strip_of_mut<'m, T: Storage>(
    memory: &'m Memory<'_>,
    slot: Slot<T>,
    shift: isize,
    span: Span,
) -> &'m mut [T] {
    // SAFETY: the footprint covers base + shift and `length` elements from there on.
    unsafe {
        std::slice::from_raw_parts_mut(
            memory.column(slot).at(span.base.wrapping_add_signed(shift)),
            span.length,
        )
    }
}

impl<L: Element> RegisterFiles<L> {
    #[inline(always)]
    fn source<'r>(&'r self, operand: &Operand<L>, length: usize) -> Source<'r, L> {
        match operand {
            Operand::Register(name) => Source::Lanes(&self.numbers[name.number as usize][..length]),
            Operand::Uniform(value) => Source::Uniform(*value),
        }
    }

    #[inline(always)]
    fn predicate(&self, name: RegisterName, length: usize) -> &[u8] {
        &self.predicates[name.number as usize][..length]
    }

    #[inline(always)]
    fn index(&self, name: RegisterName, length: usize) -> &[u32] {
        &self.indices[name.number as usize][..length]
    }

    /// One instruction over one strip. The allocation keeps results apart from operands, so the result's register
    /// is taken out of its file while the operands are read.
    #[inline(always)]
    fn step(&mut self, instruction: &Instruction<L>, memory: &Memory<'_>, span: Span) {
        let Some(name) = instruction.to else {
            return self.effect(instruction, memory, span);
        };
        let number = name.number as usize;
        match name.file {
            File::Number => {
                let mut to = take(&mut self.numbers[number]);
                self.number(instruction, memory, span, &mut to[..span.length]);
                self.numbers[number] = to;
            }
            File::Predicate => {
                let mut to = take(&mut self.predicates[number]);
                self.truth(instruction, span, &mut to[..span.length]);
                self.predicates[number] = to;
            }
            File::Index => {
                let mut to = take(&mut self.indices[number]);
                self.indexing(instruction, memory, span, &mut to[..span.length]);
                self.indices[number] = to;
            }
        }
    }

    /// Instructions that write a register of numbers.
    #[inline(always)]
    fn number(&self, instruction: &Instruction<L>, memory: &Memory<'_>, span: Span, to: &mut [L]) {
        match &instruction.action {
            Action::Binary(a, b) => {
                let (a, b) = (self.source(a, span.length), self.source(b, span.length));
                match instruction.op {
                    Op::Add => binary(to, a, b, |a, b| a + b),
                    Op::Subtract => binary(to, a, b, |a, b| a - b),
                    Op::Multiply => binary(to, a, b, |a, b| a * b),
                    Op::Divide => binary(to, a, b, |a, b| a / b),
                    Op::Minimum => binary(to, a, b, L::min),
                    Op::Maximum => binary(to, a, b, L::max),
                    op => unreachable!("{op:?} is no number of two"),
                }
            }
            Action::Unary(a) => {
                let a = self.source(a, span.length);
                match instruction.op {
                    Op::SquareRoot => unary(to, a, L::sqrt),
                    Op::Absolute => unary(to, a, L::abs),
                    Op::Truncate => unary(to, a, L::truncate),
                    op => unreachable!("{op:?} is no number of one"),
                }
            }
            Action::Select(predicate, a, b) => {
                let (a, b) = (self.source(a, span.length), self.source(b, span.length));
                let predicate = self.predicate(*predicate, span.length);
                match (a, b) {
                    (Source::Lanes(a), Source::Lanes(b)) => {
                        to.iter_mut().zip(predicate).zip(a.iter().zip(b)).for_each(
                            |((to, &holds), (&a, &b))| {
                                *to = if holds != 0 { a } else { b };
                            },
                        );
                    }
                    (Source::Lanes(a), Source::Uniform(b)) => {
                        to.iter_mut().zip(predicate).zip(a).for_each(|((to, &holds), &a)| {
                            *to = if holds != 0 { a } else { b };
                        });
                    }
                    (Source::Uniform(a), b) => {
                        to.iter_mut().zip(predicate).enumerate().for_each(|(i, (to, &holds))| {
                            *to = if holds != 0 { a } else { lane(b, i) };
                        });
                    }
                }
            }
            Action::Load(from) => match from.element {
                f64::NAME => {
                    // SAFETY: admitted; nothing writes the array while this strip is copied.
                    let from = unsafe { strip_of(memory, Slot::<f64>::new(from.array), from.shift, span) };
                    unary(to, Source::Lanes(from), L::from_f64);
                }
                _ => {
                    // SAFETY: as above.
                    let from = unsafe { strip_of(memory, Slot::<f32>::new(from.array), from.shift, span) };
                    unary(to, Source::Lanes(from), |x| L::from_f64(x.to_f64()));
                }
            },
            Action::Gather(from, index, elsewhere) => {
                let elsewhere = self.source(elsewhere, span.length);
                let index = self.index(*index, span.length);
                match from.element {
                    f64::NAME => gather(memory, Slot::<f64>::new(from.array), index, elsewhere, to),
                    _ => gather(memory, Slot::<f32>::new(from.array), index, elsewhere, to),
                }
            }
            Action::Numbers => {
                to.iter_mut().enumerate().for_each(|(i, to)| *to = L::from_f64((span.base + i + 1) as f64));
            }
            Action::FromIndex(index) => {
                let index = self.index(*index, span.length);
                to.iter_mut().zip(index).for_each(|(to, &number)| *to = L::from_f64(number.into()));
            }
            action => unreachable!("{action:?} writes no register of numbers"),
        }
    }

    /// Instructions that write a predicate.
    #[inline(always)]
    fn truth(&self, instruction: &Instruction<L>, span: Span, to: &mut [u8]) {
        match &instruction.action {
            Action::Compare(a, b) => {
                let (a, b) = (self.source(a, span.length), self.source(b, span.length));
                match instruction.op {
                    Op::LessThan => binary(to, a, b, |a, b| u8::from(a < b)),
                    Op::LessEqual => binary(to, a, b, |a, b| u8::from(a <= b)),
                    Op::Equal => binary(to, a, b, |a, b| u8::from(a == b)),
                    op => unreachable!("{op:?} is no comparison"),
                }
            }
            Action::Logic(a, b) => {
                let a = Source::Lanes(self.predicate(*a, span.length));
                match b {
                    Some(b) => binary(to, a, Source::Lanes(self.predicate(*b, span.length)), |a, b| a & b),
                    None => unary(to, a, |a| a ^ 1),
                }
            }
            action => unreachable!("{action:?} writes no predicate"),
        }
    }

    /// Instructions that write an index vector.
    #[inline(always)]
    fn indexing(&self, instruction: &Instruction<L>, memory: &Memory<'_>, span: Span, to: &mut [u32]) {
        match &instruction.action {
            Action::ToIndex(a) => unary(to, self.source(a, span.length), |a| a.to_f64() as u32),
            Action::LoadIndex(from) => {
                // SAFETY: admitted; nothing writes the array while this strip is copied.
                to.copy_from_slice(unsafe { strip_of(memory, Slot::new(from.array), from.shift, span) });
            }
            Action::GatherIndex(from, index) => {
                let column = memory.column(Slot::<u32>::new(from.array));
                let index = self.index(*index, span.length);
                to.iter_mut().zip(index).for_each(|(to, &number)| {
                    *to = if number == 0 { 0 } else { column.read(number as usize - 1) };
                });
            }
            action => unreachable!("{action:?} writes no index vector"),
        }
    }

    /// Instructions that write memory or a counter.
    #[inline(always)]
    fn effect(&self, instruction: &Instruction<L>, memory: &Memory<'_>, span: Span) {
        match &instruction.action {
            Action::Store(to, value) => {
                let value = self.source(value, span.length);
                match to.element {
                    f64::NAME => {
                        // SAFETY: admitted as written; registers do not alias memory.
                        let to = unsafe { strip_of_mut(memory, Slot::<f64>::new(to.array), to.shift, span) };
                        unary(to, value, L::to_f64);
                    }
                    _ => {
                        // SAFETY: as above.
                        let to = unsafe { strip_of_mut(memory, Slot::<f32>::new(to.array), to.shift, span) };
                        unary(to, value, |x| f32::from_f64(x.to_f64()));
                    }
                }
            }
            Action::StoreIndex(to, value) => {
                // SAFETY: admitted as written; registers do not alias memory.
                unsafe { strip_of_mut(memory, Slot::new(to.array), to.shift, span) }
                    .copy_from_slice(self.index(*value, span.length));
            }
            Action::ScatterIndex(to, index, value) => {
                let column = memory.column(Slot::<u32>::new(to.array));
                let (index, value) = (self.index(*index, span.length), self.index(*value, span.length));
                index.iter().zip(value).filter(|(number, _)| **number != 0).for_each(|(&number, &value)| {
                    column.write(number as usize - 1, value);
                });
            }
            Action::Count(predicate, counter) => {
                let holding =
                    self.predicate(*predicate, span.length).iter().map(|&holds| u64::from(holds)).sum();
                memory.count(crate::isa::Counter(*counter), holding);
            }
            action => unreachable!("{action:?} writes a register"),
        }
    }
}

#[inline(always)]
fn gather<T: Element, L: Element>(
    memory: &Memory<'_>,
    slot: Slot<T>,
    index: &[u32],
    elsewhere: Source<'_, L>,
    to: &mut [L],
) {
    let column = memory.column(slot);
    to.iter_mut().zip(index).enumerate().for_each(|(i, (to, &number))| {
        *to = match number {
            0 => lane(elsewhere, i),
            _ => L::from_f64(column.read(number as usize - 1).to_f64()),
        };
    });
}
