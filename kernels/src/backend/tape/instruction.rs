//! Instructions of a tape: one per vector operation.

use crate::isa::list::for_each_op;
use crate::isa::op::{BinaryOp, CompareOp, ConnectiveOp, NegationOp, UnaryOp};
use crate::isa::{Array, Element, Op, Storage};

/// Register files of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RegisterKind {
    /// Vectors of numbers, `V`.
    Number,
    /// Vectors of truth values, `P`.
    Predicate,
    /// Index vectors, `I`.
    Index,
}

impl RegisterKind {
    /// Every register file.
    pub const ALL: [RegisterKind; 3] = [RegisterKind::Number, RegisterKind::Predicate, RegisterKind::Index];

    /// Letter in a listing.
    pub(crate) const fn letter(self) -> char {
        match self {
            RegisterKind::Number => 'V',
            RegisterKind::Predicate => 'P',
            RegisterKind::Index => 'I',
        }
    }
}

/// A vector register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RegisterName {
    /// Register file.
    pub file: RegisterKind,
    /// Number in the file.
    pub number: u32,
}

/// Operand of numbers: a register, a broadcast number or an array.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operand<L> {
    /// A register of numbers.
    Register(RegisterName),
    /// A scalar operand.
    Uniform(L),
    /// An array as stored in memory: a folded load in a pass, never on the recorded tape.
    Memory(ArrayReference),
}

/// Access of an instruction to an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArrayReference {
    /// The array.
    pub array: Array,
    /// Name of its element type.
    pub element: &'static str,
    /// Distance in elements from the own one.
    pub shift: isize,
}

impl ArrayReference {
    /// Bytes of an element.
    pub fn element_bytes(&self) -> u64 {
        if self.element == <f64 as Storage>::NAME { 8 } else { 4 }
    }
}

/// An operand of an action, by its kind in the table of operations.
pub(super) enum OperandRef<'a, L> {
    V(&'a mut Operand<L>),
    P(&'a mut RegisterName),
    I(&'a mut RegisterName),
    At(&'a mut RegisterName),
    Numbers(&'a mut ArrayReference),
    Entries(&'a mut ArrayReference),
    Counter(&'a mut u8),
}

/// Defines actions and the functions that follow from their operands. Instructions of the group `machine` go one by one into the
/// enumeration that the table names.
macro_rules! define_actions {
    (operator $o:tt binary $b:tt unary $u:tt compare $c:tt connective $a:tt negation $n:tt merge $m:tt
     machine { $(($v:ident, $s:literal, $class:ident, $d:literal, [$(
         $(#[$about:meta])* $file:ident $form:ident $f:ident $([$($generic:tt)*])?
         $(($($x:ident $(@ $shift:ident)?: {$kind:ident $type:ty}),+))? $(-> {$result:ident $value:ty})?;
     )*])),* $(,)? }) => {
        define_actions! { {} {} {} $($($file { #[doc = $d] $form $(($($type),+))?, })*)* }

        impl<L> TapeAction<L> {
            /// The operation, which determines name and class.
            pub fn op(&self) -> Op {
                match self {
                    TapeAction::Number(_, Number::Binary(op, ..)) => op.op(),
                    TapeAction::Number(_, Number::Unary(op, _)) => op.op(),
                    TapeAction::Number(_, Number::Select(..)) => Op::Select,
                    TapeAction::Truth(_, PredicateInstruction::Compare(op, ..)) => op.op(),
                    TapeAction::Truth(_, PredicateInstruction::Connective(op, ..)) => op.op(),
                    TapeAction::Truth(_, PredicateInstruction::Negation(op, _)) => op.op(),
                    $($(TapeAction::$file(.., $file::$form { .. }) => Op::$v,)*)*
                }
            }

            /// Calls `visit` with every operand, in the order of the table.
            pub(super) fn parts(&mut self, mut visit: impl FnMut(OperandRef<'_, L>)) {
                match self {
                    TapeAction::Number(_, Number::Unary(_, a)) => visit(OperandRef::V(a)),
                    TapeAction::Number(_, Number::Binary(_, a, b)) | TapeAction::Truth(_, PredicateInstruction::Compare(_, a, b)) => {
                        [a, b].into_iter().for_each(|operand| visit(OperandRef::V(operand)));
                    }
                    TapeAction::Number(_, Number::Select(predicate, a, b)) => {
                        visit(OperandRef::P(predicate));
                        [a, b].into_iter().for_each(|operand| visit(OperandRef::V(operand)));
                    }
                    TapeAction::Truth(_, PredicateInstruction::Connective(_, a, b)) => {
                        [a, b].into_iter().for_each(|predicate| visit(OperandRef::P(predicate)));
                    }
                    TapeAction::Truth(_, PredicateInstruction::Negation(_, a)) => visit(OperandRef::P(a)),
                    $($(TapeAction::$file(.., $file::$form $(($($x),+))?) => { $($(visit(OperandRef::$kind($x));)+)? })*)*
                }
            }
        }
    };
    ({$($number:tt)*} {$($indices:tt)*} {$($effect:tt)*}) => {
        /// Instructions that write a register of numbers.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Number<L> {
            /// One operand.
            Unary(UnaryOp, Operand<L>),
            /// Two operands.
            Binary(BinaryOp, Operand<L>, Operand<L>),
            /// A merge under a predicate.
            Select(RegisterName, Operand<L>, Operand<L>),
            $($number)*
        }

        /// Instructions that write an index vector.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Indices<L> {
            $($indices)*
        }

        /// Instructions that write memory or a counter.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Effect<L> {
            $($effect)*
        }
    };
    ({$($number:tt)*} $indices:tt $effect:tt Number {$($form:tt)*} $($others:tt)*) => {
        define_actions! { {$($number)* $($form)*} $indices $effect $($others)* }
    };
    ($number:tt {$($indices:tt)*} $effect:tt Indices {$($form:tt)*} $($others:tt)*) => {
        define_actions! { $number {$($indices)* $($form)*} $effect $($others)* }
    };
    ($number:tt $indices:tt {$($effect:tt)*} Effect {$($form:tt)*} $($others:tt)*) => {
        define_actions! { $number $indices {$($effect)* $($form)*} $($others)* }
    };
}
for_each_op! {
    @({V Operand<L>} {P RegisterName} {I RegisterName} {At RegisterName} {Numbers ArrayReference} {Entries ArrayReference} {Counter u8})
    define_actions
}

/// Instructions that write a predicate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PredicateInstruction<L> {
    /// Two numbers.
    Compare(CompareOp, Operand<L>, Operand<L>),
    /// Two predicates.
    Connective(ConnectiveOp, RegisterName, RegisterName),
    /// One predicate.
    Negation(NegationOp, RegisterName),
}

/// Effect of an instruction on its operands, and the register that it writes, in the file given by the variant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TapeAction<L> {
    /// Writes a register of numbers.
    Number(RegisterName, Number<L>),
    /// Writes a predicate.
    Truth(RegisterName, PredicateInstruction<L>),
    /// Writes an index vector.
    Indices(RegisterName, Indices<L>),
    /// Writes memory or a counter.
    Effect(Effect<L>),
}

/// One recorded vector instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instruction<L> {
    /// Index of its section.
    pub section: usize,
    /// Operation with operands.
    pub action: TapeAction<L>,
}

impl<L: Element> Instruction<L> {
    /// The operation, which determines name and class.
    pub fn op(&self) -> Op {
        self.action.op()
    }

    /// Register that it writes, if any.
    pub fn to(&self) -> Option<RegisterName> {
        match self.action {
            TapeAction::Number(to, _) | TapeAction::Truth(to, _) | TapeAction::Indices(to, _) => Some(to),
            TapeAction::Effect(_) => None,
        }
    }

    /// Memory that it touches.
    pub fn reference(&self) -> Option<ArrayReference> {
        let (mut found, mut action) = (None, self.action);
        action.parts(|part| {
            if let OperandRef::Numbers(reference) | OperandRef::Entries(reference) = part {
                found = Some(*reference);
            }
        });
        found
    }

    /// True if it accesses memory through an index vector.
    pub(super) fn is_indexed(&self) -> bool {
        let (mut found, mut action) = (false, self.action);
        action.parts(|part| found |= matches!(part, OperandRef::At(_)));
        found
    }

    /// Operations it counts as: its own, and a conversion if the array has another precision than the lanes.
    pub fn operations(&self) -> impl Iterator<Item = Op> {
        let (mut converts, mut action) = (false, self.action);
        action.parts(|part| {
            if let OperandRef::Numbers(reference) = part {
                converts = reference.element != L::NAME;
            }
        });
        std::iter::once(self.op()).chain(converts.then_some(Op::Widen))
    }

    /// True if it writes to the array that `reference` names.
    pub(crate) fn overwrites(&self, reference: ArrayReference) -> bool {
        let is = |to: ArrayReference| (to.array, to.element) == (reference.array, reference.element);
        matches!(self.action, TapeAction::Effect(_)) && self.reference().is_some_and(is)
    }

    /// Calls `visit` with every operand of numbers.
    pub(crate) fn operands(&mut self, mut visit: impl FnMut(&mut Operand<L>)) {
        self.action.parts(|part| {
            if let OperandRef::V(operand) = part {
                visit(operand);
            }
        });
    }

    /// Calls `visit` with every register it reads, number registers first.
    pub fn reads(&mut self, mut visit: impl FnMut(&mut RegisterName)) {
        self.operands(|operand| {
            if let Operand::Register(name) = operand {
                visit(name);
            }
        });
        self.action.parts(|part| {
            if let OperandRef::P(name) | OperandRef::I(name) | OperandRef::At(name) = part {
                visit(name);
            }
        });
    }

    /// Calls `visit` with every register it reads, then with the one it writes, if any.
    pub fn registers(&mut self, mut visit: impl FnMut(&mut RegisterName)) {
        self.reads(&mut visit);
        if let TapeAction::Number(to, _) | TapeAction::Truth(to, _) | TapeAction::Indices(to, _) =
            &mut self.action
        {
            visit(to);
        }
    }
}
