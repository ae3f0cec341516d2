//! Interpreter of tapes, strip by strip: each instruction is a pass over the strip. A single strip is the unchained CRAY; short
//! strips keep the registers in the cache.

use super::instruction::{
    Effect, Indices, Instruction, Number, Operand, PredicateInstruction, RegisterName, TapeAction,
};
use super::pool;
use super::recorded::Tape;
use super::register_file::RegisterFile;
use crate::backend::dispatch::{InstructionSet, RegisterTask, dispatch};
use crate::backend::{IndexLanes, Precision, Registers, Scalar, Strip};
use crate::isa::list::for_each_op;
use crate::isa::op::{BinaryOp, CompareOp, UnaryOp};
use crate::isa::{Array, ArrayColumn, LaneCounter, Memory, ProgramError, Slot, Storage, Vector};
use std::cell::Cell;
use std::ops::Range;

impl<L: Precision> Tape<L> {
    /// Executes the kernel with passes compiled for an instruction set. The memory must have been admitted.
    pub(crate) fn interpret(
        &self,
        memory: &Memory<'_>,
        range: Range<usize>,
        strip: usize,
        set: InstructionSet,
    ) -> Result<(), ProgramError> {
        dispatch(set, TapeRun { tape: self, memory, range, strip })
    }

    /// Sizes in bytes of the register files that [`interpret`](Self::interpret) allocates for strips of a number of elements:
    /// numbers, predicates, indices.
    pub(crate) fn register_bytes(
        &self,
        strip: usize,
        set: InstructionSet,
    ) -> Result<[usize; 3], ProgramError> {
        let mut bytes = [0; 3];
        dispatch::<L, _>(set, RegisterSizes { counts: self.pass_sizes, strip, bytes: &mut bytes })?;
        Ok(bytes)
    }
}

/// Task that computes the sizes of the register files.
struct RegisterSizes<'r> {
    counts: [usize; 3],
    strip: usize,
    bytes: &'r mut [usize; 3],
}

impl<L: Precision> RegisterTask<L> for RegisterSizes<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = L>>(self, _: R) {
        let entries = [size_of::<R::V>(), size_of::<TruthOf<R>>(), size_of::<R::Index>()];
        for (file, bytes) in self.bytes.iter_mut().enumerate() {
            *bytes = self.counts[file] * self.strip.div_ceil(R::LANES) * entries[file];
        }
    }
}

/// An admitted run of a tape.
struct TapeRun<'r, L> {
    tape: &'r Tape<L>,
    memory: &'r Memory<'r>,
    range: Range<usize>,
    strip: usize,
}

impl<L: Precision> RegisterTask<L> for TapeRun<'_, L> {
    /// Executes strips of whole hardware registers, and the rest of each element by element: the bits are the same.
    #[inline(always)]
    fn on<R: Registers<Lane = L>>(self, hardware: R) {
        let strip = self.strip.min(self.range.len());
        let mut whole: Box<RegisterFiles<R>> = pool::take_pooled();
        let mut rest: Box<RegisterFiles<Scalar<L>>> = pool::take_pooled();
        whole.provide(hardware, self.tape, strip / R::LANES);
        rest.provide(Scalar::default(), self.tape, strip.min(R::LANES - 1));
        for base in self.range.clone().step_by(strip.max(1)) {
            let length = strip.min(self.range.end - base);
            let registers = length / R::LANES;
            whole.execute(self.tape, StripSpan { hardware, memory: self.memory, base, length: registers });
            let elements = length % R::LANES;
            rest.execute_elements(self.tape, self.memory, base + length - elements, elements);
        }
        pool::return_to_pool(whole);
        pool::return_to_pool(rest);
    }
}

/// Register files of the machine. A vector register is a run of hardware registers.
///
/// They are cells because a result may overwrite an operand: every hardware register is read before it is written.
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

/// Executes the pass of an instruction. Operation and element type are selected outside the loop.
macro_rules! passes {
    ($files:ident $span:ident $action:expr;
     operator { $(($ov:ident, $os:literal, $oc:ident, $od:literal, $trait:ident::$of:ident $($or:tt)*)),* $(,)? }
     binary { $(($bv:ident, $bs:literal, $bc:ident, $bd:literal, $bf:ident $($br:tt)*)),* $(,)? }
     unary { $(($uv:ident, $us:literal, $uc:ident, $ud:literal, $uf:ident $($ur:tt)*)),* $(,)? }
     compare { $(($cv:ident, $cs:literal, $cc:ident, $cd:literal, $cf:ident $($cr:tt)*)),* $(,)? }
     connective $c:tt negation $n:tt merge $m:tt
     machine { $(($v:ident, $s:literal, $class:ident, $d:literal, [$(
         $(#[$about:meta])* $file:ident $form:ident $f:ident $([$($generic:tt)*])?
         $(($($x:ident $(@ $shift:ident)?: {$kind:ident $type:ty}),+))? $(-> {$result:ident $value:ty})?;
     )*])),* $(,)? }) => {
        match $action {
            TapeAction::Number(to, Number::Binary(op, a, b)) => {
                let (to, a, b) = ($files.numbers.register(to.number), $files.source(a, $span), $files.source(b, $span));
                match op {
                    $(BinaryOp::$ov => $span.binary(to, a, b, |_, a, b| std::ops::$trait::$of(a, b)),)*
                    $(BinaryOp::$bv => $span.binary(to, a, b, |_, a, b| a.$bf(b)),)*
                }
            }
            TapeAction::Number(to, Number::Unary(op, a)) => {
                let (to, a) = ($files.numbers.register(to.number), $files.source(a, $span));
                match op {
                    $(UnaryOp::$uv => $span.unary(to, a, |_, a| a.$uf()),)*
                }
            }
            TapeAction::Number(to, Number::Select(predicate, a, b)) => {
                let (to, a, b) = ($files.numbers.register(to.number), $files.source(a, $span), $files.source(b, $span));
                let predicate = $files.predicate(*predicate);
                $span.binary(to, a, b, |i, a, b| R::V::select(predicate[i].get(), a, b));
            }
            TapeAction::Truth(to, PredicateInstruction::Compare(op, a, b)) => {
                let (to, a, b) = ($files.predicate(*to), $files.source(a, $span), $files.source(b, $span));
                match op {
                    $(CompareOp::$cv => $span.binary(to, a, b, |_, a, b| a.$cf(b)),)*
                }
            }
            TapeAction::Truth(to, PredicateInstruction::Connective(op, a, b)) => {
                let (to, a, b) = ($files.predicate(*to), $files.predicate(*a), $files.predicate(*b));
                $span.each(to, |i| op.apply(a[i].get(), b[i].get()));
            }
            TapeAction::Truth(to, PredicateInstruction::Negation(op, a)) => {
                let (to, a) = ($files.predicate(*to), $files.predicate(*a));
                $span.each(to, |i| op.apply(a[i].get()));
            }
            $($(
                TapeAction::$file($(first!(to $result),)? $file::$form $(($($x),+))?) => {
                    $(let to = result!($files to $result);)?
                    pass!($files $span $(to $result)? = $f $($($x $($shift)?: $kind),+)?)
                }
            )*)*
        }
    };
}

/// Expands to the first of two names.
macro_rules! first {
    ($first:ident $second:ident) => {
        $first
    };
}

/// Register that a pass writes.
#[rustfmt::skip]
macro_rules! result {
    ($files:ident $to:ident V) => { $files.numbers.register($to.number) };
    ($files:ident $to:ident I) => { $files.index(*$to) };
}

/// Executes an instruction over the registers of a strip. Operands are looked up before the loop. The implementation is named
/// only once, or the compiler would not inline it.
macro_rules! pass {
    ($files:ident $span:ident $($to:ident $result:ident)? = $f:ident $x:ident $($shift:ident)?: Numbers $($others:tt)*) => {
        match $x.element {
            f64::NAME => pass!($files $span $($to $result)? = $f $x $($shift)?: f64 $($others)*),
            _ => pass!($files $span $($to $result)? = $f $x $($shift)?: f32 $($others)*),
        }
    };
    ($files:ident $span:ident $to:ident $result:ident = $f:ident $($x:ident $($shift:ident)?: $kind:ident),*) => {{
        $($(let $shift = $x.shift;)? let $x = operand!($files $span $x $kind);)*
        $span.each($to, |i| $span.at(i).$f($(at!($span i $x $kind) $(, $shift)?),*));
    }};
    ($files:ident $span:ident = $f:ident $($x:ident: $kind:ident),*) => {{
        $(let $x = operand!($files $span $x $kind);)*
        for i in 0..$span.length {
            $span.at(i).$f($(at!($span i $x $kind)),*);
        }
    }};
}

/// Looks up an operand before the loop, by its kind.
#[rustfmt::skip]
macro_rules! operand {
    ($files:ident $span:ident $x:ident V) => { $files.source($x, $span) };
    ($files:ident $span:ident $x:ident P) => { &$files.predicate(*$x)[..$span.length] };
    ($files:ident $span:ident $x:ident I) => { &$files.index(*$x)[..$span.length] };
    ($files:ident $span:ident $x:ident At) => { &$files.index(*$x)[..$span.length] };
    ($files:ident $span:ident $x:ident Counter) => { LaneCounter(*$x) };
    ($files:ident $span:ident $x:ident Entries) => { $span.column::<u32>($x.array) };
    ($files:ident $span:ident $x:ident $element:ident) => { $span.column::<$element>($x.array) };
}

/// Reads an operand at one register, by its kind.
#[rustfmt::skip]
macro_rules! at {
    ($span:ident $i:ident $x:ident V) => {
        // SAFETY: the source is a register of the file or admitted memory, with all lanes of the span; i is below its length.
        unsafe { $span.lanes($x, $i) }
    };
    ($span:ident $i:ident $x:ident P) => { $x[$i].get() };
    ($span:ident $i:ident $x:ident I) => { $x[$i].get() };
    ($span:ident $i:ident $x:ident At) => { $x[$i].get() };
    ($span:ident $i:ident $x:ident $other:ident) => { $x };
}

/// Source of an operand: consecutive lanes of a register or of memory, or a broadcast number.
#[derive(Clone, Copy)]
enum OperandSource<L> {
    Lanes(*const L),
    Uniform(L),
}

/// Strip of a pass: `length` hardware registers from element `base` on.
#[derive(Clone, Copy)]
struct StripSpan<'m, R> {
    hardware: R,
    memory: &'m Memory<'m>,
    base: usize,
    length: usize,
}

impl<'m, R: Registers> StripSpan<'m, R> {
    /// The machine at one hardware register.
    #[inline(always)]
    fn at(self, register: usize) -> Strip<'m, R> {
        Strip::new(self.hardware, self.memory, self.base + register * R::LANES)
    }

    /// Column of an array.
    #[inline(always)]
    fn column<T: Storage>(self, array: Array) -> ArrayColumn<T> {
        self.memory.column(Slot::new(array))
    }

    /// Reads the lanes of one hardware register.
    ///
    /// # Safety
    /// `from` points to as many lanes as the span has.
    #[inline(always)]
    unsafe fn read(self, from: *const R::Lane, register: usize) -> R::V {
        // SAFETY: the caller promises `length` registers of lanes from `from` on, and the register is one of these.
        unsafe { self.hardware.load(from.add(register * R::LANES)) }
    }

    /// Reads the lanes of a source at one hardware register.
    ///
    /// # Safety
    /// The source has the span's lanes.
    #[inline(always)]
    unsafe fn lanes(self, source: OperandSource<R::Lane>, register: usize) -> R::V {
        match source {
            // SAFETY: the caller promises that the source has as many lanes as the span.
            OperandSource::Lanes(from) => unsafe { self.read(from, register) },
            OperandSource::Uniform(value) => self.hardware.splat(value),
        }
    }

    /// Writes `make(register)` to every register.
    #[inline(always)]
    fn each<X>(self, to: &[Cell<X>], make: impl Fn(usize) -> X) {
        for (i, to) in to[..self.length].iter().enumerate() {
            to.set(make(i));
        }
    }

    /// Writes `f(register, a)` to every register.
    #[inline(always)]
    fn unary<X: Copy>(self, to: &[Cell<X>], a: OperandSource<R::Lane>, f: impl Fn(usize, R::V) -> X) {
        match a {
            // SAFETY: a source is a register of the file or admitted memory, with all lanes of the span; i is below its length.
            OperandSource::Lanes(a) => self.each(to, |i| f(i, unsafe { self.read(a, i) })),
            OperandSource::Uniform(a) => {
                let a = self.hardware.splat(a);
                self.each(to, |i| f(i, a));
            }
        }
    }

    /// Writes `f(register, a, b)` to every register.
    #[inline(always)]
    fn binary<X: Copy>(
        self,
        to: &[Cell<X>],
        a: OperandSource<R::Lane>,
        b: OperandSource<R::Lane>,
        f: impl Fn(usize, R::V, R::V) -> X,
    ) {
        match (a, b) {
            (OperandSource::Lanes(a), OperandSource::Lanes(b)) => {
                // SAFETY: sources are registers of the file or admitted memory, with all lanes of the span; i is below its length.
                self.each(to, |i| f(i, unsafe { self.read(a, i) }, unsafe { self.read(b, i) }));
            }
            (a, OperandSource::Uniform(b)) => {
                let b = self.hardware.splat(b);
                self.unary(to, a, |i, a| f(i, a, b));
            }
            (OperandSource::Uniform(a), b) => {
                let a = self.hardware.splat(a);
                self.unary(to, b, |i, b| f(i, a, b));
            }
        }
    }
}

impl<L: Precision> RegisterFiles<Scalar<L>> {
    /// Executes the kernel on `length` elements from `base` on; shared by all instruction sets.
    #[inline(never)]
    fn execute_elements(&self, tape: &Tape<L>, memory: &Memory<'_>, base: usize, length: usize) {
        self.execute(tape, StripSpan { hardware: Scalar::default(), memory, base, length });
    }
}

impl<R: Registers> RegisterFiles<R> {
    /// Allocates the registers that a tape needs for strips of `length` hardware registers. Values left by an earlier run are
    /// never read: code writes a register before it reads it.
    #[inline(always)]
    fn provide(&mut self, hardware: R, tape: &Tape<R::Lane>, length: usize) {
        const { assert!(size_of::<R::V>() == R::LANES * size_of::<R::Lane>()) }
        let zero = hardware.splat(R::Lane::default());
        let [numbers, predicates, indices] = tape.pass_sizes;
        self.numbers.provide(numbers, length, zero);
        self.predicates.provide(predicates, length, zero.less_than(zero));
        self.indices.provide(indices, length, R::Index::none());
    }

    /// Executes the kernel on one strip, instruction by instruction.
    #[inline(always)]
    fn execute(&self, tape: &Tape<R::Lane>, span: StripSpan<'_, R>) {
        if span.length == 0 {
            return;
        }
        for pass in &tape.passes {
            self.step(pass, span);
        }
    }

    #[inline(always)]
    fn source(&self, operand: &Operand<R::Lane>, span: StripSpan<'_, R>) -> OperandSource<R::Lane> {
        match operand {
            Operand::Register(name) => {
                OperandSource::Lanes(self.numbers.register(name.number)[..span.length].as_ptr().cast())
            }
            Operand::Uniform(value) => OperandSource::Uniform(*value),
            Operand::Memory(from) => {
                let column = span.column::<R::Lane>(from.array);
                // SAFETY: the memory was admitted: the footprint covers base + shift and the span's lanes behind it.
                OperandSource::Lanes(unsafe { column.at(span.base.wrapping_add_signed(from.shift)) })
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

    /// Executes one instruction on one strip.
    #[inline(always)]
    fn step(&self, pass: &Instruction<R::Lane>, span: StripSpan<'_, R>) {
        for_each_op!(passes self span &pass.action;)
    }
}
