//! Assembly listing of a kernel.

use super::instruction::{ArrayReference, Instruction, Operand, OperandRef, RegisterName};
use super::recorded::Tape;
use crate::isa::Element;
use serde::Serialize;
use std::fmt;

impl<L: Element> Tape<L> {
    /// Assembly listing of the kernel.
    pub fn listing(&self) -> TapeListing<'_, L> {
        TapeListing(self)
    }

    /// Instructions in words.
    pub fn lines(&self) -> Vec<ListingLine> {
        self.instructions.iter().map(|instruction| self.line(instruction)).collect()
    }

    fn line(&self, instruction: &Instruction<L>) -> ListingLine {
        let mut words = Vec::from_iter(instruction.to().map(|name| name.to_string()));
        let mut action = instruction.action;
        action.parts(|part| match part {
            OperandRef::V(operand) => words.push(operand.to_string()),
            OperandRef::P(name) | OperandRef::I(name) => words.push(name.to_string()),
            OperandRef::Numbers(array) | OperandRef::Entries(array) => words.push(self.array_text(array)),
            OperandRef::At(name) => {
                let array = words.pop().unwrap_or_default();
                words.push(format!("{array}({name})"));
            }
            OperandRef::Counter(number) => words.push(format!("C{number}")),
        });
        // The first word is the destination, also of an instruction that writes no register.
        let destination = words.remove(0);
        let section = self.sections[instruction.section];
        ListingLine { section, operation: instruction.op().mnemonic(), destination, sources: words }
    }

    /// An array with its name, and the shift.
    fn array_text(&self, reference: &ArrayReference) -> String {
        let own = reference.array.own_number().and_then(|number| self.names.get(number));
        let name = own.map_or(reference.array.label(), String::as_str);
        match reference.shift {
            0 => format!("[{name}]"),
            shift => format!("[{name}{shift:+}]"),
        }
    }
}

/// An instruction in words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ListingLine {
    /// Purpose of its section of the kernel.
    pub section: &'static str,
    /// Mnemonic of the operation.
    pub operation: &'static str,
    /// Destination of the result: a register, an array, or a counter.
    pub destination: String,
    /// Operands in their order: registers, arrays, `#` before a scalar.
    pub sources: Vec<String>,
}

/// Prints a tape, one vector instruction per line.
pub struct TapeListing<'t, L>(&'t Tape<L>);

impl fmt::Display for RegisterName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.file.letter(), self.number)
    }
}

impl<L: Element> fmt::Display for Operand<L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Operand::Register(name) => name.fmt(f),
            Operand::Uniform(value) => write!(f, "#{}", value.to_f64()),
            // A folded load is in no listing.
            Operand::Memory(from) => write!(f, "[{}]", from.array.label()),
        }
    }
}

impl<L: Element> fmt::Display for TapeListing<'_, L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut section = usize::MAX;
        for (number, instruction) in self.0.instructions.iter().enumerate() {
            let ListingLine { section: name, operation, destination, sources } = self.0.line(instruction);
            if instruction.section != section {
                section = instruction.section;
                writeln!(f, "; {name}")?;
            }
            let operands = std::iter::once(destination).chain(sources).collect::<Vec<_>>().join(", ");
            writeln!(f, "{:>5}  {operation:<8}{operands}", number + 1)?;
        }
        Ok(())
    }
}
