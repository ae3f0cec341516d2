//! How the arithmetic is done, as far as methods share it.

use super::binding::Binding;
use super::keys::Fallback::Is;
use super::keys::Key;
use super::keys::Kind::Choice;
use super::keys::define_keys;
use crate::words::{Words, define_words};
use stripmine_kernels::{Execution, InstructionSet};

define_words! {
    /// Precision of a run.
    pub enum Precision {
        /// State and forces in f64.
        F64 = "f64",
        /// State and forces in f32.
        F32 = "f32",
        /// State in f64, forces in f32.
        Mixed = "mixed",
    }
}

define_keys! {
    /// Precision.
    pub(crate) static ARITHMETIC;
    PRECISION = "machine" "precision", Choice(Precision::WORDS), "", Is("\"f64\""), None,
        "Precision; mixed keeps the state in f64 and computes forces in f32.";
}

define_keys! {
    /// Instructions.
    pub(crate) static INSTRUCTIONS;
    INSTRUCTION_SET = "machine" "instruction_set", Choice(&["auto", "scalar", "wide", "neon", "avx2", "avx512"]), "",
        Is("\"auto\""), None,
        "The SIMD instructions; auto takes the widest that the processor has.";
}

/// Meets the keys of precision and instructions; no instruction set is the widest there is.
pub(crate) fn bind_arithmetic(
    binding: &mut dyn Binding,
    precision: &mut Precision,
    instruction_set: &mut Option<InstructionSet>,
) {
    binding.choice(&PRECISION, precision);
    bind_instructions(binding, instruction_set);
}

/// Meets a method's key of how its programs are executed.
pub(crate) fn bind_execution(binding: &mut dyn Binding, key: &'static Key, execution: &mut Execution) {
    let mut name = execution_name(*execution);
    binding.word(key, &mut name);
    *execution = match name.strip_prefix("strip:").map(str::parse) {
        Some(Ok(length)) => Execution::Strip(length),
        _ if name == "eager" => Execution::Eager,
        _ => Execution::Chained,
    };
}

/// The name of a way to execute programs, in scenes and on the command line.
pub(crate) fn execution_name(execution: Execution) -> String {
    match execution {
        Execution::Chained => "chained".to_owned(),
        Execution::Eager => "eager".to_owned(),
        Execution::Strip(length) => format!("strip:{length}"),
    }
}

/// Meets the key of the instructions; none is the widest set there is.
pub(crate) fn bind_instructions(binding: &mut dyn Binding, instruction_set: &mut Option<InstructionSet>) {
    let mut name = instruction_set.map_or("auto", InstructionSet::name).to_owned();
    binding.word(&INSTRUCTION_SET, &mut name);
    *instruction_set = InstructionSet::ALL.iter().copied().find(|set| set.name() == name);
}
