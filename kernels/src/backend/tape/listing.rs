//! A program as an assembly listing.

use super::instruction::{
    Action, Effect, Indices, Instruction, Number, Operand, Reference, RegisterName, Truth,
};
use super::recorded::Tape;
use crate::isa::Element;
use serde::Serialize;
use std::fmt;

impl<L: Element> Tape<L> {
    /// The program as an assembly listing.
    pub fn listing(&self) -> Listing<'_, L> {
        Listing(self)
    }

    /// The instructions as words.
    pub fn lines(&self) -> Vec<Line> {
        self.instructions
            .iter()
            .map(|instruction| line(self.sections[instruction.section], instruction))
            .collect()
    }
}

/// An instruction as words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Line {
    /// What the section of the program does.
    pub section: &'static str,
    /// The operation's mnemonic.
    pub operation: &'static str,
    /// Where the result goes: a register, an array, or a counter.
    pub destination: String,
    /// Operands in their order: registers, arrays, `#` before a scalar.
    pub sources: Vec<String>,
}

fn line<L: Element>(section: &'static str, instruction: &Instruction<L>) -> Line {
    let to = instruction.to().map(|name| name.to_string());
    let word = |operand: &dyn fmt::Display| operand.to_string();
    let (destination, sources) = match &instruction.action {
        Action::Number(_, number) => (
            to,
            match number {
                Number::Unary(_, a) => vec![word(a)],
                Number::Binary(_, a, b) => vec![word(a), word(b)],
                Number::Select(predicate, a, b) => vec![word(predicate), word(a), word(b)],
                Number::Numbers => vec![],
                Number::FromIndex(a) => vec![word(a)],
                Number::Load(from) | Number::LoadShifted(from) => vec![word(from)],
                Number::Gather(from, index, elsewhere) => vec![format!("{from}({index})"), word(elsewhere)],
            },
        ),
        Action::Truth(_, truth) => (
            to,
            match truth {
                Truth::Compare(_, a, b) => vec![word(a), word(b)],
                Truth::Connective(_, a, b) => vec![word(a), word(b)],
                Truth::Negation(_, a) => vec![word(a)],
            },
        ),
        Action::Indices(_, indices) => (
            to,
            match indices {
                Indices::ToIndex(a) => vec![word(a)],
                Indices::Load(from) => vec![word(from)],
                Indices::Gather(from, index) => vec![format!("{from}({index})")],
            },
        ),
        Action::Effect(effect) => match effect {
            Effect::Count(predicate, counter) => (Some(format!("C{counter}")), vec![word(predicate)]),
            Effect::Store(to, value) => (Some(word(to)), vec![word(value)]),
            Effect::StoreIndex(to, value) => (Some(word(to)), vec![word(value)]),
            Effect::Scatter(to, index, value) => (Some(format!("{to}({index})")), vec![word(value)]),
            Effect::ScatterIndex(to, index, value) => (Some(format!("{to}({index})")), vec![word(value)]),
        },
    };
    Line {
        section,
        operation: instruction.op().mnemonic(),
        destination: destination.unwrap_or_default(),
        sources,
    }
}

/// Prints a tape, one vector instruction a line.
pub struct Listing<'t, L>(&'t Tape<L>);

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
            Operand::Memory(from) => from.fmt(f),
        }
    }
}

impl fmt::Display for Reference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.shift {
            0 => write!(f, "[{}]", self.array.label()),
            shift => write!(f, "[{}{shift:+}]", self.array.label()),
        }
    }
}

impl<L: Element> fmt::Display for Listing<'_, L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut section = usize::MAX;
        for (number, instruction) in self.0.instructions.iter().enumerate() {
            let Line { section: name, operation, destination, sources } =
                line(self.0.sections[instruction.section], instruction);
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
