//! The list of operations. Names, classes, counts and listings all derive from it.

/// Calls the macro `$apply` with every operation of the machine: `(variant, mnemonic, class, what it does)`.
macro_rules! for_each_op {
    ($apply:ident) => {
        $apply! {
            (Add, "add", Add, "sum of two vectors"),
            (Subtract, "sub", Add, "difference of two vectors"),
            (Multiply, "mul", Multiply, "product of two vectors"),
            (Divide, "div", Divide, "quotient of two vectors"),
            (SquareRoot, "sqrt", SquareRoot, "square root"),
            (Absolute, "abs", Logical, "magnitude: the sign bit cleared"),
            (Minimum, "min", Compare, "the smaller of two; the second where they do not compare"),
            (Maximum, "max", Compare, "the larger of two; the second where they do not compare"),
            (Truncate, "int", Convert, "integer part, rounded towards zero"),
            (LessThan, "lt", Compare, "predicate a < b"),
            (LessEqual, "le", Compare, "predicate a <= b"),
            (Equal, "eq", Compare, "predicate a = b"),
            (And, "and", Logical, "conjunction of two predicates"),
            (Not, "not", Logical, "negation of a predicate"),
            (Select, "sel", Logical, "merge: a where the predicate holds, else b"),
            (Count, "cnt", Reduce, "population count of a predicate, added to a counter"),
            (Numbers, "iota", Convert, "the element numbers 1, 2, 3, ..."),
            (ToIndex, "toidx", Convert, "numbers to an index vector"),
            (FromIndex, "fromidx", Convert, "an index vector to numbers"),
            (Widen, "cvt", Convert, "change of precision at a load, gather or store"),
            (Load, "ld", Load, "load at the own place, unit stride"),
            (LoadShifted, "lds", Shift, "load at a shift: the shifted copy of a lattice vector"),
            (Store, "st", Store, "store at the own place"),
            (Gather, "gth", Gather, "load through an index vector"),
            (Scatter, "sct", Scatter, "store through an index vector"),
        }
    };
}

macro_rules! define_ops {
    ($(($variant:ident, $mnemonic:literal, $class:ident, $doc:literal)),* $(,)?) => {
        /// One vector operation of the machine.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Op {
            $(#[doc = $doc] $variant,)*
        }

        impl Op {
            /// Every operation, in the order of the list.
            pub const ALL: &'static [Op] = &[$(Op::$variant),*];

            /// The name in a listing.
            pub const fn mnemonic(self) -> &'static str {
                match self { $(Op::$variant => $mnemonic),* }
            }

            /// The class whose cost a machine states.
            pub const fn class(self) -> OpClass {
                match self { $(Op::$variant => OpClass::$class),* }
            }

            /// What the operation does, in one line.
            pub const fn meaning(self) -> &'static str {
                match self { $(Op::$variant => $doc),* }
            }
        }
    };
}
for_each_op!(define_ops);

macro_rules! define_classes {
    ($(($variant:ident, $name:literal, $doc:literal)),* $(,)?) => {
        /// A class of operations that a machine executes in one kind of unit, at one cost.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum OpClass {
            $(#[doc = $doc] $variant,)*
        }

        impl OpClass {
            /// Every class, in the order of the list.
            pub const ALL: &'static [OpClass] = &[$(OpClass::$variant),*];

            /// The name in tables and machine files.
            pub const fn name(self) -> &'static str {
                match self { $(OpClass::$variant => $name),* }
            }

            /// What belongs to the class.
            pub const fn meaning(self) -> &'static str {
                match self { $(OpClass::$variant => $doc),* }
            }
        }
    };
}

define_classes! {
    (Add, "add", "sums and differences"),
    (Multiply, "multiply", "products"),
    (Divide, "divide", "quotients"),
    (SquareRoot, "square_root", "square roots"),
    (Compare, "compare", "comparisons, minimum, maximum"),
    (Logical, "logical", "bit operations and merges under a predicate"),
    (Convert, "convert", "conversions between numbers, indices and precisions"),
    (Reduce, "reduce", "reductions of a predicate to a scalar"),
    (Load, "load", "loads of unit stride at the own place"),
    (Shift, "shift", "loads of unit stride at a shift of the lattice"),
    (Store, "store", "stores of unit stride"),
    (Gather, "gather", "loads through an index vector"),
    (Scatter, "scatter", "stores through an index vector"),
}

impl OpClass {
    /// Whether the class moves data between memory and registers rather than computing.
    pub const fn moves_data(self) -> bool {
        matches!(self, OpClass::Load | OpClass::Shift | OpClass::Store | OpClass::Gather | OpClass::Scatter)
    }
}

/// How often each operation of the list was executed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpCounts([u64; Op::ALL.len()]);

impl Default for OpCounts {
    fn default() -> Self {
        OpCounts([0; Op::ALL.len()])
    }
}

impl OpCounts {
    /// Counts one more execution of `op`.
    pub fn record(&mut self, op: Op) {
        self.0[op as usize] += 1;
    }

    /// Adds all counts of `other`.
    pub fn add(&mut self, other: &OpCounts) {
        for (count, more) in self.0.iter_mut().zip(&other.0) {
            *count += more;
        }
    }

    /// The executions of operations that `keep` holds.
    #[must_use]
    pub fn filtered(&self, keep: impl Fn(Op) -> bool) -> OpCounts {
        let mut kept = OpCounts::default();
        Op::ALL.iter().filter(|&&op| keep(op)).for_each(|&op| kept.0[op as usize] = self.of(op));
        kept
    }

    /// Executions of one operation.
    pub fn of(&self, op: Op) -> u64 {
        self.0[op as usize]
    }

    /// Executions of all operations of a class.
    pub fn of_class(&self, class: OpClass) -> u64 {
        Op::ALL.iter().filter(|op| op.class() == class).map(|&op| self.of(op)).sum()
    }

    /// All executions: the source's NOP.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mnemonics_and_class_names_are_distinct() {
        let mut mnemonics: Vec<_> = Op::ALL.iter().map(|op| op.mnemonic()).collect();
        mnemonics.sort_unstable();
        mnemonics.dedup();
        assert_eq!(mnemonics.len(), Op::ALL.len());
        let mut names: Vec<_> = OpClass::ALL.iter().map(|class| class.name()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), OpClass::ALL.len());
    }

    #[test]
    fn every_class_has_an_operation_and_classes_partition_the_total() {
        let mut counts = OpCounts::default();
        for &op in Op::ALL {
            counts.record(op);
        }
        assert!(OpClass::ALL.iter().all(|&class| counts.of_class(class) > 0));
        let by_class: u64 = OpClass::ALL.iter().map(|&class| counts.of_class(class)).sum();
        assert_eq!(by_class, counts.total());
        assert_eq!(counts.total(), Op::ALL.len() as u64);
    }
}
