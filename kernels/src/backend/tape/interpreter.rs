//! Executes a tape strip by strip: each instruction a pass over the strip. One strip over everything is the unchained
//! CRAY; short strips keep the registers in the cache.

use super::instruction::{Action, Effect, Indices, Instruction, Number, Operand, RegisterName, Truth};
use super::pool;
use super::recorded::Tape;
use super::register_file::RegisterFile;
use crate::backend::dispatch::{InstructionSet, Task, dispatch};
use crate::backend::{IndexLanes, Precision, Registers, Scalar, Strip};
use crate::isa::list::for_each_op;
use crate::isa::op::{BinaryOp, CompareOp, UnaryOp};
use crate::isa::{Array, Column, Counter, Element, Machine, Memory, ProgramError, Slot, Storage, Vector};
use std::cell::Cell;
use std::ops::Range;

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

    /// Bytes of the register files that [`interpret`](Self::interpret) keeps for strips of a number of elements: of numbers, of
    /// predicates, of indices.
    pub(crate) fn register_bytes(
        &self,
        strip: usize,
        set: InstructionSet,
    ) -> Result<[usize; 3], ProgramError> {
        let mut bytes = [0; 3];
        dispatch::<L, _>(set, Sizes { counts: self.pass_sizes, strip, bytes: &mut bytes })?;
        Ok(bytes)
    }
}

/// How large the register files are for an instruction set.
struct Sizes<'r> {
    counts: [usize; 3],
    strip: usize,
    bytes: &'r mut [usize; 3],
}

impl<L: Precision> Task<L> for Sizes<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = L>>(self, _: R) {
        let entries = [size_of::<R::V>(), size_of::<TruthOf<R>>(), size_of::<R::Index>()];
        for (file, bytes) in self.bytes.iter_mut().enumerate() {
            *bytes = self.counts[file] * self.strip.div_ceil(R::LANES) * entries[file];
        }
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
    /// Strips of whole hardware registers, and what is left of each element by element: the same bits.
    #[inline(always)]
    fn on<R: Registers<Lane = L>>(self, hardware: R) {
        let strip = self.strip.min(self.range.len());
        let mut whole: Box<RegisterFiles<R>> = pool::take();
        let mut rest: Box<RegisterFiles<Scalar<L>>> = pool::take();
        whole.provide(hardware, self.tape, strip / R::LANES);
        rest.provide(Scalar::default(), self.tape, strip.min(R::LANES - 1));
        for base in self.range.clone().step_by(strip.max(1)) {
            let length = strip.min(self.range.end - base);
            let registers = length / R::LANES;
            whole.execute(self.tape, Span { hardware, memory: self.memory, base, length: registers });
            let elements = length % R::LANES;
            rest.execute_elements(self.tape, self.memory, base + length - elements, elements);
        }
        pool::give_back(whole);
        pool::give_back(rest);
    }
}

/// The register files of the machine. A vector register is a run of hardware registers.
///
/// Cells, because a result may take the place of an operand: every hardware register is read before it is written.
struct RegisterFiles<R: Registers> {
    numbers: RegisterFile<R::V>,
    predicates: RegisterFile<TruthOf<R>>,
    indices: RegisterFile<R::Index>,
}

impl<R: Registers> Default for RegisterFiles<R> {
    fn default() -> Self {
        RegisterFiles {
            numbers: RegisterFile::default(),
            predicates: RegisterFile::default(),
            indices: RegisterFile::default(),
        }
    }
}

type TruthOf<R> = <<R as Registers>::V as Vector>::Predicate;

/// A pass for every number from two. Which operation it is, is asked outside the loop.
macro_rules! binary_passes {
    ($op:ident $span:ident $to:ident $a:ident $b:ident
     operator { $(($ov:ident, $om:literal, $oc:ident, $od:literal, $trait:ident $of:ident)),* $(,)? }
     binary { $(($bv:ident, $bm:literal, $bc:ident, $bd:literal, $bf:ident)),* $(,)? }
     $($others:tt)*) => {
        match $op {
            $(BinaryOp::$ov => $span.binary($to, $a, $b, |_, a, b| std::ops::$trait::$of(a, b)),)*
            $(BinaryOp::$bv => $span.binary($to, $a, $b, |_, a, b| a.$bf(b)),)*
        }
    };
}

/// A pass for every number from one.
macro_rules! unary_passes {
    ($op:ident $span:ident $to:ident $a:ident operator $o:tt binary $b:tt
     unary { $(($uv:ident, $um:literal, $uc:ident, $ud:literal, $uf:ident)),* $(,)? }
     $($others:tt)*) => {
        match $op {
            $(UnaryOp::$uv => $span.unary($to, $a, |_, a| a.$uf()),)*
        }
    };
}

/// A pass for every comparison.
macro_rules! compare_passes {
    ($op:ident $span:ident $to:ident $a:ident $b:ident operator $o:tt binary $bin:tt unary $u:tt
     compare { $(($cv:ident, $cm:literal, $cc:ident, $cd:literal, $cf:ident)),* $(,)? }
     $($others:tt)*) => {
        match $op {
            $(CompareOp::$cv => $span.binary($to, $a, $b, |_, a, b| a.$cf(b)),)*
        }
    };
}

/// What an instruction reads: consecutive lanes of a register or of memory, or the same number in every lane.
#[derive(Clone, Copy)]
enum Source<L> {
    Lanes(*const L),
    Uniform(L),
}

/// The strip that instructions pass over: `length` hardware registers from element `base` on.
#[derive(Clone, Copy)]
struct Span<'m, R> {
    hardware: R,
    memory: &'m Memory<'m>,
    base: usize,
    length: usize,
}

impl<'m, R: Registers> Span<'m, R> {
    /// The machine at the place of one hardware register.
    #[inline(always)]
    fn at(self, register: usize) -> Strip<'m, R> {
        Strip::new(self.hardware, self.memory, self.base + register * R::LANES)
    }

    /// Where an array is.
    #[inline(always)]
    fn column<T: Storage>(self, array: Array) -> Column<T> {
        self.memory.column(Slot::new(array))
    }

    /// The lanes at the place of one hardware register.
    ///
    /// # Safety
    /// `from` begins as many lanes as the span holds.
    #[inline(always)]
    unsafe fn read(self, from: *const R::Lane, register: usize) -> R::V {
        // SAFETY: the caller promises `length` registers' worth of lanes from `from` on, and the register is one of these.
        unsafe { self.hardware.load(from.add(register * R::LANES)) }
    }

    /// The lanes of a source at the place of one hardware register.
    ///
    /// # Safety
    /// The source has the span's lanes.
    #[inline(always)]
    unsafe fn lanes(self, source: Source<R::Lane>, register: usize) -> R::V {
        match source {
            // SAFETY: the caller promises that the source begins as many lanes as the span holds.
            Source::Lanes(from) => unsafe { self.read(from, register) },
            Source::Uniform(value) => self.hardware.splat(value),
        }
    }

    /// A pass of something made at each place.
    #[inline(always)]
    fn each<X>(self, to: &[Cell<X>], make: impl Fn(usize) -> X) {
        for (i, to) in to[..self.length].iter().enumerate() {
            to.set(make(i));
        }
    }

    /// A pass of `f(place, a)`.
    #[inline(always)]
    fn unary<X: Copy>(self, to: &[Cell<X>], a: Source<R::Lane>, f: impl Fn(usize, R::V) -> X) {
        match a {
            // SAFETY: a source is a register of the file or admitted memory, with all lanes of the span; i is below its length.
            Source::Lanes(a) => self.each(to, |i| f(i, unsafe { self.read(a, i) })),
            Source::Uniform(a) => {
                let a = self.hardware.splat(a);
                self.each(to, |i| f(i, a));
            }
        }
    }

    /// A pass of `f(place, a, b)`.
    #[inline(always)]
    fn binary<X: Copy>(
        self,
        to: &[Cell<X>],
        a: Source<R::Lane>,
        b: Source<R::Lane>,
        f: impl Fn(usize, R::V, R::V) -> X,
    ) {
        match (a, b) {
            (Source::Lanes(a), Source::Lanes(b)) => {
                // SAFETY: sources are registers of the file or admitted memory, with all lanes of the span; i is below its length.
                self.each(to, |i| f(i, unsafe { self.read(a, i) }, unsafe { self.read(b, i) }));
            }
            (a, Source::Uniform(b)) => {
                let b = self.hardware.splat(b);
                self.unary(to, a, |i, a| f(i, a, b));
            }
            (Source::Uniform(a), b) => {
                let a = self.hardware.splat(a);
                self.unary(to, b, |i, b| f(i, a, b));
            }
        }
    }
}

impl<L: Precision> RegisterFiles<Scalar<L>> {
    /// The program on `length` elements from `base` on: the same for every instruction set.
    #[inline(never)]
    fn execute_elements(&self, tape: &Tape<L>, memory: &Memory<'_>, base: usize, length: usize) {
        self.execute(tape, Span { hardware: Scalar::default(), memory, base, length });
    }
}

impl<R: Registers> RegisterFiles<R> {
    /// Sees to it that there are the registers that a tape needs for strips of `length` hardware registers. What an
    /// earlier run left in them is never read: code writes a register before it reads it.
    #[inline(always)]
    fn provide(&mut self, hardware: R, tape: &Tape<R::Lane>, length: usize) {
        const { assert!(size_of::<R::V>() == R::LANES * size_of::<R::Lane>()) }
        let zero = hardware.splat(R::Lane::default());
        let [numbers, predicates, indices] = tape.pass_sizes;
        self.numbers.provide(numbers, length, zero);
        self.predicates.provide(predicates, length, zero.less_than(zero));
        self.indices.provide(indices, length, R::Index::none());
    }

    /// The program on one strip, instruction by instruction.
    #[inline(always)]
    fn execute(&self, tape: &Tape<R::Lane>, span: Span<'_, R>) {
        if span.length == 0 {
            return;
        }
        for pass in &tape.passes {
            self.step(pass, span);
        }
    }

    #[inline(always)]
    fn source(&self, operand: &Operand<R::Lane>, span: Span<'_, R>) -> Source<R::Lane> {
        match operand {
            Operand::Register(name) => {
                Source::Lanes(self.numbers.register(name.number)[..span.length].as_ptr().cast())
            }
            Operand::Uniform(value) => Source::Uniform(*value),
            Operand::Memory(from) => {
                let column = span.column::<R::Lane>(from.array);
                // SAFETY: the memory was admitted: the footprint covers base + shift and the span's lanes behind it.
                Source::Lanes(unsafe { column.at(span.base.wrapping_add_signed(from.shift)) })
            }
        }
    }

    #[inline(always)]
    fn predicate(&self, name: RegisterName) -> &[Cell<TruthOf<R>>] {
        self.predicates.register(name.number)
    }

    #[inline(always)]
    fn index(&self, name: RegisterName) -> &[Cell<R::Index>] {
        self.indices.register(name.number)
    }

    /// One instruction over one strip.
    #[inline(always)]
    fn step(&self, pass: &Instruction<R::Lane>, span: Span<'_, R>) {
        match &pass.action {
            Action::Number(to, number) => self.number(number, span, self.numbers.register(to.number)),
            Action::Truth(to, truth) => self.truth(truth, span, self.predicates.register(to.number)),
            Action::Indices(to, indices) => self.indices(indices, span, self.indices.register(to.number)),
            Action::Effect(effect) => self.effect(effect, span),
        }
    }

    /// What writes a register of numbers.
    #[inline(always)]
    fn number(&self, number: &Number<R::Lane>, span: Span<'_, R>, to: &[Cell<R::V>]) {
        match number {
            Number::Binary(op, a, b) => {
                let (a, b) = (self.source(a, span), self.source(b, span));
                for_each_op!(binary_passes op span to a b);
            }
            Number::Unary(op, a) => {
                let a = self.source(a, span);
                for_each_op!(unary_passes op span to a);
            }
            Number::Select(predicate, a, b) => {
                let predicate = self.predicate(*predicate);
                let (a, b) = (self.source(a, span), self.source(b, span));
                span.binary(to, a, b, |i, a, b| R::V::select(predicate[i].get(), a, b));
            }
            Number::Load(from) | Number::LoadShifted(from) => match from.element {
                f64::NAME => {
                    let (column, shift) = (span.column::<f64>(from.array), from.shift);
                    span.each(to, |i| span.at(i).load_from(column, shift));
                }
                _ => {
                    let (column, shift) = (span.column::<f32>(from.array), from.shift);
                    span.each(to, |i| span.at(i).load_from(column, shift));
                }
            },
            Number::Gather(from, index, elsewhere) => match from.element {
                f64::NAME => self.gather(span, to, span.column::<f64>(from.array), *index, elsewhere),
                _ => self.gather(span, to, span.column::<f32>(from.array), *index, elsewhere),
            },
            Number::Numbers => span.each(to, |i| span.at(i).numbers()),
            Number::FromIndex(index) => {
                let index = self.index(*index);
                span.each(to, |i| span.at(i).index_numbers(index[i].get()));
            }
        }
    }

    /// One place that calls for the body, or the compiler would call it for every hardware register.
    #[inline(always)]
    fn gather<T: Element>(
        &self,
        span: Span<'_, R>,
        to: &[Cell<R::V>],
        column: Column<T>,
        index: RegisterName,
        elsewhere: &Operand<R::Lane>,
    ) {
        let (index, elsewhere) = (self.index(index), self.source(elsewhere, span));
        span.each(to, |i| {
            // SAFETY: the source is a register of the file or admitted memory, with all lanes of the span; i is below its length.
            span.at(i).gather_from(column, index[i].get(), unsafe { span.lanes(elsewhere, i) })
        });
    }

    /// What writes a predicate.
    #[inline(always)]
    fn truth(&self, truth: &Truth<R::Lane>, span: Span<'_, R>, to: &[Cell<TruthOf<R>>]) {
        match truth {
            Truth::Compare(op, a, b) => {
                let (a, b) = (self.source(a, span), self.source(b, span));
                for_each_op!(compare_passes op span to a b);
            }
            Truth::Connective(op, a, b) => {
                let (a, b) = (self.predicate(*a), self.predicate(*b));
                span.each(to, |i| op.apply(a[i].get(), b[i].get()));
            }
            Truth::Negation(op, a) => {
                let a = self.predicate(*a);
                span.each(to, |i| op.apply(a[i].get()));
            }
        }
    }

    /// What writes an index vector.
    #[inline(always)]
    fn indices(&self, indices: &Indices<R::Lane>, span: Span<'_, R>, to: &[Cell<R::Index>]) {
        match indices {
            Indices::ToIndex(a) => span.unary(to, self.source(a, span), |i, a| span.at(i).to_index(a)),
            Indices::Load(from) => {
                let column = span.column(from.array);
                span.each(to, |i| span.at(i).load_index_from(column));
            }
            Indices::Gather(from, index) => {
                let (column, index) = (span.column(from.array), self.index(*index));
                span.each(to, |i| span.at(i).gather_index_from(column, index[i].get()));
            }
        }
    }

    /// What writes memory or a counter.
    #[inline(always)]
    fn effect(&self, effect: &Effect<R::Lane>, span: Span<'_, R>) {
        match effect {
            Effect::Store(to, value) => match to.element {
                f64::NAME => self.store(span, span.column::<f64>(to.array), value),
                _ => self.store(span, span.column::<f32>(to.array), value),
            },
            Effect::StoreIndex(to, value) => {
                let (column, value) = (span.column(to.array), self.index(*value));
                for (i, value) in value[..span.length].iter().enumerate() {
                    span.at(i).store_index_to(column, value.get());
                }
            }
            Effect::Scatter(to, index, value) => match to.element {
                f64::NAME => self.scatter(span, span.column::<f64>(to.array), *index, value),
                _ => self.scatter(span, span.column::<f32>(to.array), *index, value),
            },
            Effect::ScatterIndex(to, index, value) => {
                let (column, index, value) = (span.column(to.array), self.index(*index), self.index(*value));
                for (i, (index, value)) in index[..span.length].iter().zip(value).enumerate() {
                    span.at(i).scatter_index_to(column, index.get(), value.get());
                }
            }
            Effect::Count(predicate, counter) => {
                for (i, predicate) in self.predicate(*predicate)[..span.length].iter().enumerate() {
                    span.at(i).count(Counter(*counter), predicate.get());
                }
            }
        }
    }

    #[inline(always)]
    fn store<T: Element>(&self, span: Span<'_, R>, column: Column<T>, value: &Operand<R::Lane>) {
        let value = self.source(value, span);
        for i in 0..span.length {
            // SAFETY: the source is a register of the file or admitted memory, with all lanes of the span; i is below its length.
            let value = unsafe { span.lanes(value, i) };
            span.at(i).store_to(column, value);
        }
    }

    #[inline(always)]
    fn scatter<T: Element>(
        &self,
        span: Span<'_, R>,
        column: Column<T>,
        index: RegisterName,
        value: &Operand<R::Lane>,
    ) {
        let value = self.source(value, span);
        for (i, index) in self.index(index)[..span.length].iter().enumerate() {
            // SAFETY: the source is a register of the file or admitted memory, with all lanes of the span; i is below its length.
            let value = unsafe { span.lanes(value, i) };
            span.at(i).scatter_to(column, index.get(), value);
        }
    }
}
