//! RISC-V vector instructions of every operation: the expansion table.

use crate::isa::Op;

/// Instructions that execute an operation with operands of given kinds. The last one counts as the operation; the others are its
/// expansion.
///
/// Kinds: `v` numbers in a register, `f` a broadcast number, `p` a predicate, `i` an index vector, `m` an array of numbers and `n`
/// one of index vectors, at the own element or through an index vector.
///
/// Placeholders: `{d}` is the result. `{a}` and `{b}` are the numbers in their order, `{p}` and `{q}` predicates, `{i}` and `{j}`
/// index vectors, `{x}` the address of an array, `{t}` and `{u}` temporary registers, `{k}` the constant of the row, `{c}` a scalar
/// register. A result in capitals, `{D}`, shares no register with an operand of its line. `{h}` is half of the register group,
/// `{m}` the whole.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The operation.
    pub op: Op,
    /// Kinds of its operands, in the order of the listing.
    pub operands: &'static str,
    /// Constant that the instructions need.
    pub constant: Option<f64>,
    /// The instructions.
    pub code: &'static [&'static str],
}

const fn form(op: Op, operands: &'static str, code: &'static [&'static str]) -> Form {
    Form { op, operands, constant: None, code }
}

/// Magnitude from which a number is an integer beyond 64 bits.
const BEYOND: f64 = 9_223_372_036_854_775_808.0;

const HALF: &str = "vsetvli zero, zero, e32, {h}, ta, mu";
const WHOLE: &str = "vsetvli zero, zero, e64, {m}, ta, mu";

/// The expansion table. An operand of kind `f` without a row is first copied to every element of a register.
pub const FORMS: &[Form] = &[
    form(Op::Add, "vv", &["vfadd.vv {d}, {a}, {b}"]),
    form(Op::Add, "vf", &["vfadd.vf {d}, {a}, {b}"]),
    form(Op::Add, "fv", &["vfadd.vf {d}, {b}, {a}"]),
    form(Op::Subtract, "vv", &["vfsub.vv {d}, {a}, {b}"]),
    form(Op::Subtract, "vf", &["vfsub.vf {d}, {a}, {b}"]),
    form(Op::Subtract, "fv", &["vfrsub.vf {d}, {b}, {a}"]),
    form(Op::Multiply, "vv", &["vfmul.vv {d}, {a}, {b}"]),
    form(Op::Multiply, "vf", &["vfmul.vf {d}, {a}, {b}"]),
    form(Op::Multiply, "fv", &["vfmul.vf {d}, {b}, {a}"]),
    form(Op::Divide, "vv", &["vfdiv.vv {d}, {a}, {b}"]),
    form(Op::Divide, "vf", &["vfdiv.vf {d}, {a}, {b}"]),
    form(Op::Divide, "fv", &["vfrdiv.vf {d}, {b}, {a}"]),
    // RISC-V's vfmin and vfmax return the number beside a NaN, and −0 below +0; ours return the second operand.
    form(Op::Minimum, "vv", &["vmflt.vv v0, {a}, {b}", "vmerge.vvm {d}, {b}, {a}, v0"]),
    form(
        Op::Minimum,
        "vf",
        &["vmflt.vf v0, {a}, {b}", "vmnand.mm v0, v0, v0", "vfmerge.vfm {d}, {a}, {b}, v0"],
    ),
    form(Op::Minimum, "fv", &["vmfgt.vf v0, {b}, {a}", "vfmerge.vfm {d}, {b}, {a}, v0"]),
    form(Op::Maximum, "vv", &["vmflt.vv v0, {b}, {a}", "vmerge.vvm {d}, {b}, {a}, v0"]),
    form(
        Op::Maximum,
        "vf",
        &["vmfgt.vf v0, {a}, {b}", "vmnand.mm v0, v0, v0", "vfmerge.vfm {d}, {a}, {b}, v0"],
    ),
    form(Op::Maximum, "fv", &["vmflt.vf v0, {b}, {a}", "vfmerge.vfm {d}, {b}, {a}, v0"]),
    form(Op::SquareRoot, "v", &["vfsqrt.v {d}, {a}"]),
    form(Op::Absolute, "v", &["vfsgnjx.vv {d}, {a}, {a}"]),
    // Numbers beyond 64 bits are integers already; the sign of a zero comes from the operand.
    Form {
        op: Op::Truncate,
        operands: "v",
        constant: Some(BEYOND),
        code: &[
            "vfsgnjx.vv {t}, {a}, {a}",
            "vmflt.vf v0, {t}, {k}",
            "vfcvt.rtz.x.f.v {t}, {a}",
            "vfcvt.f.x.v {t}, {t}",
            "vfsgnj.vv {t}, {t}, {a}",
            "vmerge.vvm {d}, {a}, {t}, v0",
        ],
    },
    form(Op::LessThan, "vv", &["vmflt.vv {d}, {a}, {b}"]),
    form(Op::LessThan, "vf", &["vmflt.vf {d}, {a}, {b}"]),
    form(Op::LessThan, "fv", &["vmfgt.vf {d}, {b}, {a}"]),
    form(Op::LessEqual, "vv", &["vmfle.vv {d}, {a}, {b}"]),
    form(Op::LessEqual, "vf", &["vmfle.vf {d}, {a}, {b}"]),
    form(Op::LessEqual, "fv", &["vmfge.vf {d}, {b}, {a}"]),
    form(Op::Equal, "vv", &["vmfeq.vv {d}, {a}, {b}"]),
    form(Op::Equal, "vf", &["vmfeq.vf {d}, {a}, {b}"]),
    form(Op::Equal, "fv", &["vmfeq.vf {d}, {b}, {a}"]),
    form(Op::And, "pp", &["vmand.mm {d}, {p}, {q}"]),
    form(Op::Not, "p", &["vmnand.mm {d}, {p}, {p}"]),
    form(Op::Select, "pvv", &["vmv1r.v v0, {p}", "vmerge.vvm {d}, {b}, {a}, v0"]),
    form(Op::Select, "pfv", &["vmv1r.v v0, {p}", "vfmerge.vfm {d}, {b}, {a}, v0"]),
    form(Op::Select, "pvf", &["vmnand.mm v0, {p}, {p}", "vfmerge.vfm {d}, {a}, {b}, v0"]),
    form(Op::Count, "p", &["vcpop.m {c}, {p}"]),
    form(Op::Numbers, "", &["vid.v {d}", "vadd.vx {d}, {d}, {c}", "vfcvt.f.xu.v {d}, {d}"]),
    // A negative number becomes 0 and one beyond 32 bits the largest entry, as in Rust; a NaN must become 0.
    form(
        Op::ToIndex,
        "v",
        &[
            "vfcvt.rtz.xu.f.v {t}, {a}",
            "vmfne.vv v0, {a}, {a}",
            "vmerge.vim {t}, {t}, 0, v0",
            "vminu.vx {d}, {t}, {c}",
        ],
    ),
    form(Op::FromIndex, "i", &["vfcvt.f.xu.v {d}, {i}"]),
    form(Op::Load, "m", &["vle64.v {d}, ({x})"]),
    form(Op::Load, "n", &["vle32.v {t}, ({x})", "vzext.vf2 {D}, {t}"]),
    form(Op::LoadShifted, "m", &["vle64.v {d}, ({x})"]),
    form(Op::Store, "mv", &["vse64.v {a}, ({x})"]),
    form(Op::Store, "ni", &[HALF, "vnsrl.wi {t}, {i}, 0", "vse32.v {t}, ({x})", WHOLE]),
    form(
        Op::Gather,
        "miv",
        &[
            "vmsne.vi v0, {i}, 0",
            "vadd.vi {t}, {i}, -1",
            "vsll.vi {t}, {t}, 3",
            "vmv.v.v {d}, {a}",
            "vluxei64.v {d}, ({x}), {t}, v0.t",
        ],
    ),
    form(
        Op::Gather,
        "mif",
        &[
            "vmsne.vi v0, {i}, 0",
            "vadd.vi {t}, {i}, -1",
            "vsll.vi {t}, {t}, 3",
            "vfmv.v.f {d}, {a}",
            "vluxei64.v {d}, ({x}), {t}, v0.t",
        ],
    ),
    form(
        Op::Gather,
        "ni",
        &[
            "vmsne.vi v0, {i}, 0",
            "vadd.vi {t}, {i}, -1",
            "vsll.vi {t}, {t}, 2",
            HALF,
            "vmv.v.i {u}, 0",
            "vluxei64.v {u}, ({x}), {t}, v0.t",
            WHOLE,
            "vzext.vf2 {D}, {u}",
        ],
    ),
    form(
        Op::Scatter,
        "miv",
        &[
            "vmsne.vi v0, {i}, 0",
            "vadd.vi {t}, {i}, -1",
            "vsll.vi {t}, {t}, 3",
            "vsoxei64.v {a}, ({x}), {t}, v0.t",
        ],
    ),
    form(
        Op::Scatter,
        "nii",
        &[
            "vmsne.vi v0, {i}, 0",
            "vadd.vi {t}, {i}, -1",
            "vsll.vi {t}, {t}, 2",
            HALF,
            "vnsrl.wi {u}, {j}, 0",
            "vsoxei64.v {u}, ({x}), {t}, v0.t",
            WHOLE,
        ],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operation_of_doubles_has_a_form() {
        for &op in Op::ALL {
            let is_there = FORMS.iter().any(|form| form.op == op);
            assert_eq!(is_there, op != Op::Widen, "{op:?}");
        }
    }
}
