//! Loads as operands: what is executed needs no copy of an array that lies in memory as it was loaded.

use super::instruction::{Action, Instruction, Operand, Reference, RegisterName};
use crate::isa::Element;
use std::collections::HashMap;

/// The passes that execute straight-line code (each register written once): every load whose array keeps its contents
/// until the last reader is past becomes an operand of its readers.
///
/// The CRAY had to bring a vector into a register first, so the load stays in what is counted and listed.
pub(super) fn fold_loads<L: Element>(instructions: &[Instruction<L>]) -> Vec<Instruction<L>> {
    let mut passes = instructions.to_vec();
    let mut last_use = HashMap::new();
    for (at, pass) in passes.iter_mut().enumerate() {
        pass.registers(|name| {
            last_use.insert(*name, at);
        });
    }
    let mut folded: HashMap<RegisterName, Reference> = HashMap::new();
    for (at, instruction) in instructions.iter().enumerate() {
        if let (Action::Load(reference), Some(to)) = (instruction.action, instruction.to) {
            let overwritten =
                instructions[at..=last_use[&to]].iter().any(|later| later.overwrites(reference));
            if reference.element == L::NAME && !overwritten {
                folded.insert(to, reference);
            }
        }
    }
    passes.retain(|pass| !pass.to.is_some_and(|to| folded.contains_key(&to)));
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
    use crate::backend::tape::File;
    use crate::isa::{Array, Op};

    fn register(number: u32) -> RegisterName {
        RegisterName { file: File::Number, number }
    }

    fn instruction(op: Op, to: Option<u32>, action: Action<f64>) -> Instruction<f64> {
        Instruction { op, section: 0, to: to.map(register), action }
    }

    fn x(element: &'static str) -> Reference {
        Reference { array: Array::ALL[0], element, shift: 3 }
    }

    #[test]
    fn a_load_becomes_an_operand_of_its_readers() {
        let [a, b] = [0, 1].map(|number| Operand::Register(register(number)));
        let store = Reference { array: Array::ALL[1], ..x("f64") };
        let passes = fold_loads(&[
            instruction(Op::LoadShifted, Some(0), Action::Load(x("f64"))),
            instruction(Op::Multiply, Some(1), Action::Binary(a, a)),
            instruction(Op::Store, None, Action::Store(store, b)),
        ]);
        let from = Operand::Memory(x("f64"));
        assert_eq!(passes.len(), 2);
        assert_eq!(passes[0].action, Action::Binary(from, from));
    }

    #[test]
    fn a_load_stays_where_its_array_is_written_while_it_is_needed_or_holds_another_precision() {
        let a = Operand::Register(register(0));
        for element in ["f64", "f32"] {
            let stored = Action::Store(x(element), Operand::Uniform(1.0));
            let code = [
                instruction(Op::LoadShifted, Some(0), Action::Load(x(element))),
                instruction(Op::Store, None, stored),
                instruction(Op::SquareRoot, Some(1), Action::Unary(a)),
            ];
            assert_eq!(fold_loads(&code), code);
        }
    }
}
