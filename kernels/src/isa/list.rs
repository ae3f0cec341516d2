//! The list of operations. From it come names, classes and counts, the methods of `Vector` and their
//! forwarding to registers, what a tape records, and what the interpreter executes.
//!
//! An operation is a row of a group, which says what it takes and gives. A row that is not served everywhere does not
//! compile: a computing operation is a method that every vector must have, and any other names the actions of a tape that
//! count as it, which listing, allocation and interpreter match one by one.

/// Calls the macro `$apply` with `$args` and every operation of the machine, a row each:
/// `(variant, mnemonic, class, what it does, ...)`.
///
/// The groups: `operator` and `binary` (a number from two, by a trait of `std::ops` or a method of `Vector`), `unary` (from
/// one), `compare` (a predicate from two numbers), `connective` and `negation` (from two predicates, from one), and
/// `machine`, whose rows end with the actions of a tape that count as the operation.
macro_rules! for_each_op {
    ($apply:ident $($args:tt)*) => {
        $apply! {
            $($args)*
            operator {
                (Add, "add", Add, "sum of two vectors", Add add),
                (Subtract, "sub", Add, "difference of two vectors", Sub sub),
                (Multiply, "mul", Multiply, "product of two vectors", Mul mul),
                (Divide, "div", Divide, "quotient of two vectors", Div div),
            }
            binary {
                (Minimum, "min", Compare, "the smaller of two; the second where they do not compare", min),
                (Maximum, "max", Compare, "the larger of two; the second where they do not compare", max),
            }
            unary {
                (SquareRoot, "sqrt", SquareRoot, "square root", sqrt),
                (Absolute, "abs", Logical, "magnitude: the sign bit cleared", abs),
                (Truncate, "int", Convert, "integer part, rounded towards zero", truncate),
            }
            compare {
                (LessThan, "lt", Compare, "predicate a < b", less_than),
                (LessEqual, "le", Compare, "predicate a <= b", less_equal),
                (Equal, "eq", Compare, "predicate a = b", equal),
            }
            connective {
                (And, "and", Logical, "conjunction of two predicates", and),
            }
            negation {
                (Not, "not", Logical, "negation of a predicate", not),
            }
            machine {
                (Select, "sel", Logical, "merge: a where the predicate holds, else b", [Number Select]),
                (Count, "cnt", Reduce, "population count of a predicate, added to a counter", [Effect Count]),
                (Numbers, "iota", Convert, "the element numbers 1, 2, 3, ...", [Number Numbers]),
                (ToIndex, "toidx", Convert, "numbers to an index vector", [Indices ToIndex]),
                (FromIndex, "fromidx", Convert, "an index vector to numbers", [Number FromIndex]),
                (Widen, "cvt", Convert, "change of precision at a load, gather or store", []),
                (Load, "ld", Load, "load at the own place, unit stride", [Number Load, Indices Load]),
                (LoadShifted, "lds", Shift, "load at a shift: the shifted copy of a lattice vector", [Number LoadShifted]),
                (Store, "st", Store, "store at the own place", [Effect Store, Effect StoreIndex]),
                (Gather, "gth", Gather, "load through an index vector", [Number Gather, Indices Gather]),
                (Scatter, "sct", Scatter, "store through an index vector", [Effect Scatter, Effect ScatterIndex]),
            }
        }
    };
}
pub(crate) use for_each_op;
