//! Table of operations. It generates names, classes and counts, the methods of `Vector`, `Predicate` and `Machine` for registers
//! and recorders, the instructions of a tape with their operands, and the passes that execute them.
//!
//! An operation is a row: its name, its symbol in listings, its class, and its meaning in words. The row of a computing operation
//! ends with its method, the kinds of its operands and its result, and the result for one lane, which is the oracle. The row of
//! an operation that accesses the machine ends with the instructions that count as it, each with its method of `Machine` and its
//! operands. A row without an implementation in some register file does not compile.

/// Calls the macro `$apply` with the operations of the machine. `for_each_op!(each $apply $args)` calls it once per row, with
/// `$args`, the group, the operation, its meaning, and the rest of its row. `for_each_op!(each_instruction $apply self)` calls it
/// once per instruction of the group `machine`, with `self`, the comment and the signature of its method, and its form on a tape
/// with its operands. `for_each_op!($apply $args)` calls it with the whole table, for enumerations and matches.
///
/// The groups: `operator` and `binary` (a number from two, by a trait of `std::ops` or a method of `Vector`), `unary` (from
/// one), `compare` (a predicate from two numbers), `merge` (a number from a predicate and two numbers), `connective` and
/// `negation` (a predicate from two, from one), and `machine`.
///
/// An instruction of the group `machine` is an action of the tape (its enumeration and variant), followed by the method. Operands
/// are in the order of both and of the listing: first the array or the counter. The kind of an operand is one of `V` (numbers),
/// `P` (a predicate), `I` (an index vector), `At` (an index vector that selects elements of the array before it), `Numbers` and
/// `Entries` (an array of numbers or of index vectors, at the own element or at a shift), and `Counter`. Each kind has a type, by
/// default that of a method of `Machine`.
macro_rules! for_each_op {
    (@rows $apply:ident $args:tt
     $($group:ident { $(($op:ident, $symbol:literal, $class:ident, $doc:literal, $($rest:tt)*)),* $(,)? })*) => {
        $($($apply! { $args $group $op $doc $($rest)* })*)*
    };
    (@instructions $apply:ident $this:ident operator $o:tt binary $b:tt unary $u:tt compare $c:tt connective $a:tt
     negation $n:tt merge $m:tt
     machine { $(($v:ident, $s:literal, $class:ident, $d:literal, [$(
         $(#[$about:meta])* $file:ident $form:ident $f:ident $([$($generic:tt)*])?
         $(($($x:ident $(@ $shift:ident)?: {$kind:ident $type:ty}),+))? $(-> {$result:ident $value:ty})?;
     )*])),* $(,)? }) => {
        $($($apply! {
            $this
            [$(#[$about])*]
            [fn $f $(<$($generic)*>)? ($this $($(, $x: $type $(, $shift: isize)?)+)?) $(-> $value)?]
            $file $form $f $(($($x $($shift)?: $kind),+))?
        })*)*
    };
    (each $apply:ident $args:tt) => {
        for_each_op! { for_each_op @rows $apply $args }
    };
    (each_instruction $apply:ident $this:ident) => {
        for_each_op! { for_each_op @instructions $apply $this }
    };
    (@($V:tt $P:tt $I:tt $At:tt $Numbers:tt $Entries:tt $Counter:tt) $apply:ident $($args:tt)*) => {
        $apply! {
            $($args)*
            operator {
                (Add, "add", Add, "sum of two vectors", Add::add(a: V, b: V) -> V { a + b }),
                (Subtract, "sub", Add, "difference of two vectors", Sub::sub(a: V, b: V) -> V { a - b }),
                (Multiply, "mul", Multiply, "product of two vectors", Mul::mul(a: V, b: V) -> V { a * b }),
                (Divide, "div", Divide, "quotient of two vectors", Div::div(a: V, b: V) -> V { a / b }),
            }
            binary {
                (Minimum, "min", Compare, "the smaller of two; the second if they are unordered",
                    min(a: V, b: V) -> V { if a < b { a } else { b } }),
                (Maximum, "max", Compare, "the larger of two; the second if they are unordered",
                    max(a: V, b: V) -> V { if a > b { a } else { b } }),
            }
            unary {
                (SquareRoot, "sqrt", SquareRoot, "square root", sqrt(a: V) -> V { a.sqrt() }),
                (Absolute, "abs", Logical, "magnitude: the sign bit cleared", abs(a: V) -> V { a.abs() }),
                (Truncate, "int", Convert, "integer part, rounded towards zero", truncate(a: V) -> V { a.trunc() }),
            }
            compare {
                (LessThan, "lt", Compare, "predicate a < b", less_than(a: V, b: V) -> P { a < b }),
                (LessEqual, "le", Compare, "predicate a <= b", less_equal(a: V, b: V) -> P { a <= b }),
                (Equal, "eq", Compare, "predicate a = b", equal(a: V, b: V) -> P { a == b }),
            }
            connective {
                (And, "and", Logical, "conjunction of two predicates", and(a: P, b: P) -> P { a & b }),
            }
            negation {
                (Not, "not", Logical, "negation of a predicate", not(a: P) -> P { !a }),
            }
            merge {
                (Select, "sel", Logical, "merge: a where the predicate is true, else b",
                    select(predicate: P, holds: V, fails: V) -> V { if predicate { holds } else { fails } }),
            }
            machine {
                (Count, "cnt", Reduce, "population count of a predicate, added to a counter", [
                    /// Adds the number of true lanes to `counter`.
                    Effect Count count(counter: $Counter, predicate: $P);
                ]),
                (Numbers, "iota", Convert, "the element numbers 1, 2, 3, ...", [
                    /// The element numbers, from 1.
                    Number Numbers numbers -> $V;
                ]),
                (ToIndex, "toidx", Convert, "numbers to an index vector", [
                    /// Converts numbers to an index vector; numbers that are no element number (negative, NaN) become 0, which is
                    /// none.
                    Indices ToIndex to_index(numbers: $V) -> $I;
                ]),
                (FromIndex, "fromidx", Convert, "an index vector to numbers", [
                    /// Converts an index vector to numbers.
                    Number FromIndex index_numbers(index: $I) -> $V;
                ]),
                (Widen, "cvt", Convert, "change of precision at a load, gather or store", []),
                (Load, "ld", Load, "load of the own element, unit stride", [
                    /// Loads the own element.
                    Number Load load[T: Element](slot: $Numbers) -> $V;
                    /// Loads the own element of an index vector.
                    Indices Load load_index(slot: $Entries) -> $I;
                ]),
                (LoadShifted, "lds", Shift, "load at a shift: the shifted copy of a lattice vector", [
                    /// Loads the element at a distance of `shift` from the own one.
                    Number LoadShifted load_shifted[T: Element](slot @ shift: $Numbers) -> $V;
                ]),
                (Store, "st", Store, "store to the own element", [
                    /// Stores to the own element.
                    Effect Store store[T: Element](slot: $Numbers, value: $V);
                    /// Stores to the own element of an index vector.
                    Effect StoreIndex store_index(slot: $Entries, value: $I);
                ]),
                (Gather, "gth", Gather, "load through an index vector", [
                    /// Loads the elements that `index` numbers; `elsewhere` where the index is 0.
                    ///
                    /// # Panics
                    /// If a number is beyond the array.
                    Number Gather gather[T: Element](slot: $Numbers, index: $At, elsewhere: $V) -> $V;
                    /// Loads the entries of an index vector that `index` numbers; 0 where the index is 0.
                    ///
                    /// # Panics
                    /// If a number is beyond the array.
                    Indices Gather gather_index(slot: $Entries, index: $At) -> $I;
                ]),
                (Scatter, "sct", Scatter, "store through an index vector", [
                    /// Stores `value` to the elements that `index` numbers, in element order: of two values for one element the
                    /// later stays.
                    ///
                    /// # Panics
                    /// If a number is beyond the array.
                    Effect Scatter scatter[T: Element](slot: $Numbers, index: $At, value: $V);
                    /// Stores the index vector `value` to the elements that `index` numbers, in element order.
                    ///
                    /// # Panics
                    /// If a number is beyond the array.
                    Effect ScatterIndex scatter_index(slot: $Entries, index: $At, value: $I);
                ]),
            }
        }
    };
    ($($call:tt)*) => {
        for_each_op! {
            @({V Self::V} {P Self::P} {I Self::I} {At Self::I} {Numbers Slot<T>} {Entries Slot<u32>} {Counter LaneCounter})
            $($call)*
        }
    };
}
pub(crate) use for_each_op;
