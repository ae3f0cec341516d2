//! Folding of loads into operands: executed code needs no copy of an array that is stored in memory as loaded.

use super::instruction::{ArrayReference, Instruction, Number, Operand, RegisterName, TapeAction};
use crate::isa::Element;
use std::collections::HashMap;

/// Converts straight-line code, in which each register is written once, into the passes that execute it. A load becomes an
/// operand of its readers if its array keeps its contents until the last reader.
///
/// The CRAY had to bring a vector into a register first, so the load stays in the counts and the listing.
pub(super) fn fold_loads<L: Element>(instructions: &[Instruction<L>]) -> Vec<Instruction<L>> {
    let mut passes = instructions.to_vec();
    let mut last_use = HashMap::new();
    for (at, pass) in passes.iter_mut().enumerate() {
        pass.registers(|name| {
            last_use.insert(*name, at);
        });
    }
    let mut folded: HashMap<RegisterName, ArrayReference> = HashMap::new();
    for (at, instruction) in instructions.iter().enumerate() {
        if let TapeAction::Number(to, Number::Load(reference) | Number::LoadShifted(reference)) =
            instruction.action
        {
            let overwritten =
                instructions[at..=last_use[&to]].iter().any(|later| later.overwrites(reference));
            if reference.element == L::NAME && !overwritten {
                folded.insert(to, reference);
            }
        }
    }
    passes.retain(|pass| !pass.to().is_some_and(|to| folded.contains_key(&to)));
    for pass in &mut passes {
        pass.operands(|operand| {
            if let Operand::Register(name) = operand
                && let Some(&reference) = folded.get(name)
            {
                *operand = Operand::Memory(reference);
            }
        });
    }
    passes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::tape::{Effect, RegisterKind};
    use crate::isa::Array;
    use crate::isa::op::{BinaryOp, UnaryOp};

    fn register(number: u32) -> RegisterName {
        RegisterName { file: RegisterKind::Number, number }
    }

    fn number(to: u32, number: Number<f64>) -> Instruction<f64> {
        Instruction { section: 0, action: TapeAction::Number(register(to), number) }
    }

    fn store(to: ArrayReference, value: Operand<f64>) -> Instruction<f64> {
        Instruction { section: 0, action: TapeAction::Effect(Effect::Store(to, value)) }
    }

    fn x(element: &'static str) -> ArrayReference {
        ArrayReference { array: Array::ALL[0], element, shift: 3 }
    }

    #[test]
    fn a_load_becomes_an_operand_of_its_readers() {
        let [a, b] = [0, 1].map(|number| Operand::Register(register(number)));
        let to = ArrayReference { array: Array::ALL[1], ..x("f64") };
        let passes = fold_loads(&[
            number(0, Number::LoadShifted(x("f64"))),
            number(1, Number::Binary(BinaryOp::Multiply, a, a)),
            store(to, b),
        ]);
        let from = Operand::Memory(x("f64"));
        assert_eq!(passes.len(), 2);
        assert_eq!(passes[0], number(1, Number::Binary(BinaryOp::Multiply, from, from)));
    }

    #[test]
    fn overwritten_or_converting_loads_are_not_folded() {
        let a = Operand::Register(register(0));
        for element in ["f64", "f32"] {
            let code = [
                number(0, Number::LoadShifted(x(element))),
                store(x(element), Operand::Uniform(1.0)),
                number(1, Number::Unary(UnaryOp::SquareRoot, a)),
            ];
            assert_eq!(fold_loads(&code), code);
        }
    }
}
