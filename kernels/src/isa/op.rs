//! Operations with their names, classes and counts, generated from the table in `list.rs`.

use super::list::for_each_op;
use super::vector::{Predicate, Vector};

macro_rules! define_ops {
    ($($group:ident { $(($variant:ident, $mnemonic:literal, $class:ident, $doc:literal, $($rest:tt)*)),* $(,)? })*) => {
        /// A vector operation of the machine.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Op {
            $($(#[doc = $doc] $variant,)*)*
        }

        impl Op {
            /// Every operation, in the order of the list.
            pub const ALL: &'static [Op] = &[$($(Op::$variant),*),*];

            /// Name in a listing.
            #[inline]
            pub const fn mnemonic(self) -> &'static str {
                match self { $($(Op::$variant => $mnemonic,)*)* }
            }

            /// Class that determines the cost on a machine.
            #[inline]
            pub const fn class(self) -> OpClass {
                match self { $($(Op::$variant => OpClass::$class,)*)* }
            }

            /// Meaning of the operation, in one line.
            #[inline]
            pub const fn meaning(self) -> &'static str {
                match self { $($(Op::$variant => $doc,)*)* }
            }
        }
    };
}
for_each_op!(define_ops);

/// Defines the operations of one group, each as a function of its operands.
macro_rules! define_group {
    ($(#[doc = $what:literal])+ $name:ident, $taking:ident ($($parameters:tt)*) $operands:tt -> $result:ty {
        $(($variant:ident, $doc:literal, $method:path)),*
    }) => {
        $(#[doc = $what])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum $name {
            $(#[doc = $doc] $variant,)*
        }

        impl $name {
            /// The operation.
            #[inline]
            pub const fn op(self) -> Op {
                match self { $($name::$variant => Op::$variant,)* }
            }

            /// Executes the operation.
            #[inline(always)]
            pub fn apply<V: $taking>(self, $($parameters)*) -> $result {
                match self { $($name::$variant => $method $operands,)* }
            }
        }
    };
}

macro_rules! define_groups {
    (operator { $(($ov:ident, $os:literal, $oc:ident, $od:literal, $trait:ident::$of:ident $($or:tt)*)),* $(,)? }
     binary { $(($bv:ident, $bs:literal, $bc:ident, $bd:literal, $bf:ident $($br:tt)*)),* $(,)? }
     unary { $(($uv:ident, $us:literal, $uc:ident, $ud:literal, $uf:ident $($ur:tt)*)),* $(,)? }
     compare { $(($cv:ident, $cs:literal, $cc:ident, $cd:literal, $cf:ident $($cr:tt)*)),* $(,)? }
     connective { $(($av:ident, $as:literal, $ac:ident, $ad:literal, $af:ident $($ar:tt)*)),* $(,)? }
     negation { $(($nv:ident, $ns:literal, $nc:ident, $nd:literal, $nf:ident $($nr:tt)*)),* $(,)? }
     $($others:tt)*) => {
        define_group! {
            /// Operations from two numbers to a number.
            BinaryOp, Vector (a: V, b: V) (a, b) -> V { $(($ov, $od, std::ops::$trait::$of),)* $(($bv, $bd, Vector::$bf)),* }
        }
        define_group! {
            /// Operations from one number to a number.
            UnaryOp, Vector (a: V) (a) -> V { $(($uv, $ud, Vector::$uf)),* }
        }
        define_group! {
            /// Operations from two numbers to a predicate.
            CompareOp, Vector (a: V, b: V) (a, b) -> V::Predicate { $(($cv, $cd, Vector::$cf)),* }
        }
        define_group! {
            /// Operations from two predicates to a predicate.
            ConnectiveOp, Predicate (a: V, b: V) (a, b) -> V { $(($av, $ad, Predicate::$af)),* }
        }
        define_group! {
            /// Operations from one predicate to a predicate.
            NegationOp, Predicate (a: V) (a) -> V { $(($nv, $nd, Predicate::$nf)),* }
        }
    };
}
for_each_op!(define_groups);

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

            /// Name in tables and machine files.
            #[inline]
            pub const fn name(self) -> &'static str {
                match self { $(OpClass::$variant => $name),* }
            }

            /// Description of the operations in this class.
            #[inline]
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
    (Load, "load", "loads of unit stride of the own element"),
    (Shift, "shift", "loads of unit stride at a shift of the lattice"),
    (Store, "store", "stores of unit stride"),
    (Gather, "gather", "loads through an index vector"),
    (Scatter, "scatter", "stores through an index vector"),
}

impl OpClass {
    /// True if the class moves data between memory and registers rather than computing.
    #[inline]
    pub const fn moves_data(self) -> bool {
        matches!(self, OpClass::Load | OpClass::Shift | OpClass::Store | OpClass::Gather | OpClass::Scatter)
    }
}

/// Number of executions of each operation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpCounts([u64; Op::ALL.len()]);

impl Default for OpCounts {
    #[inline]
    fn default() -> Self {
        OpCounts([0; Op::ALL.len()])
    }
}

impl OpCounts {
    /// Counts one more execution of `op`.
    #[inline]
    pub fn record(&mut self, op: Op) {
        self.0[op as usize] += 1;
    }

    /// Adds all counts of `other`.
    #[inline]
    pub fn add(&mut self, other: &OpCounts) {
        for (count, more) in self.0.iter_mut().zip(&other.0) {
            *count += more;
        }
    }

    /// Counts of the operations for which `keep` is true.
    #[must_use]
    #[inline]
    pub fn filtered(&self, keep: impl Fn(Op) -> bool) -> OpCounts {
        let mut kept = OpCounts::default();
        Op::ALL.iter().filter(|&&op| keep(op)).for_each(|&op| kept.0[op as usize] = self.of(op));
        kept
    }

    /// Executions of one operation.
    #[inline]
    pub fn of(&self, op: Op) -> u64 {
        self.0[op as usize]
    }

    /// Executions of all operations of a class.
    #[inline]
    pub fn of_class(&self, class: OpClass) -> u64 {
        Op::ALL.iter().filter(|op| op.class() == class).map(|&op| self.of(op)).sum()
    }

    /// Floating-point operations as rates count them: sums, differences, products, quotients and roots.
    #[inline]
    pub fn flops(&self) -> u64 {
        let counted = [OpClass::Add, OpClass::Multiply, OpClass::Divide, OpClass::SquareRoot];
        counted.into_iter().map(|class| self.of_class(class)).sum()
    }

    /// Number of all executions: NOP of BP93.
    #[inline]
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flops_are_sums_products_quotients_and_roots() {
        let mut counts = OpCounts::default();
        Op::ALL.iter().for_each(|&op| counts.record(op));
        assert_eq!(counts.flops(), 5);
    }

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
    fn classes_partition_all_operations() {
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
