//! A program as an assembly listing.

use super::instruction::{Action, Effect, Indices, Number, Operand, Reference, RegisterName, Truth};
use super::recorded::Tape;
use crate::isa::Element;
use std::fmt;

impl<L: Element> Tape<L> {
    /// The program as an assembly listing.
    pub fn listing(&self) -> Listing<'_, L> {
        Listing(self)
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
            if instruction.section != section {
                section = instruction.section;
                writeln!(f, "; {}", self.0.sections[section])?;
            }
            write!(f, "{:>5}  {:<8}", number + 1, instruction.op().mnemonic())?;
            if let Some(to) = instruction.to() {
                write!(f, "{to}")?;
                if !matches!(instruction.action, Action::Number(_, Number::Numbers)) {
                    write!(f, ", ")?;
                }
            }
            match &instruction.action {
                Action::Number(_, number) => match number {
                    Number::Unary(_, a) => write!(f, "{a}")?,
                    Number::Binary(_, a, b) => write!(f, "{a}, {b}")?,
                    Number::Select(predicate, a, b) => write!(f, "{predicate}, {a}, {b}")?,
                    Number::Numbers => {}
                    Number::FromIndex(a) => write!(f, "{a}")?,
                    Number::Load(from) | Number::LoadShifted(from) => write!(f, "{from}")?,
                    Number::Gather(from, index, elsewhere) => write!(f, "{from}({index}), {elsewhere}")?,
                },
                Action::Truth(_, truth) => match truth {
                    Truth::Compare(_, a, b) => write!(f, "{a}, {b}")?,
                    Truth::Connective(_, a, b) => write!(f, "{a}, {b}")?,
                    Truth::Negation(_, a) => write!(f, "{a}")?,
                },
                Action::Indices(_, indices) => match indices {
                    Indices::ToIndex(a) => write!(f, "{a}")?,
                    Indices::Load(from) => write!(f, "{from}")?,
                    Indices::Gather(from, index) => write!(f, "{from}({index})")?,
                },
                Action::Effect(effect) => match effect {
                    Effect::Count(predicate, counter) => write!(f, "C{counter}, {predicate}")?,
                    Effect::Store(to, value) => write!(f, "{to}, {value}")?,
                    Effect::StoreIndex(to, value) => write!(f, "{to}, {value}")?,
                    Effect::Scatter(to, index, value) => write!(f, "{to}({index}), {value}")?,
                },
            }
            writeln!(f)?;
        }
        Ok(())
    }
}
