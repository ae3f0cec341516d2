//! Keys of the arithmetic shared by methods.

use super::binding::Binding;
use super::keys::Fallback::Is;
use super::keys::Key;
use super::keys::KeyValueKind::Choice;
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
    /// Precision of the arithmetic.
    pub(crate) static ARITHMETIC;
    PRECISION = "machine" "precision", Choice(Precision::WORDS), "", Is("\"f64\""), None,
        "Precision; mixed keeps the state in f64 and computes forces in f32.";
}

define_keys! {
    /// SIMD instructions of the arithmetic.
    pub(crate) static INSTRUCTIONS;
    INSTRUCTION_SET = "machine" "instruction_set", Choice(&["auto", "scalar", "wide", "neon", "avx2", "avx512"]), "",
        Is("\"auto\""), None,
        "SIMD instructions; auto selects the widest set of the processor.";
}

/// Binds the keys of precision and instruction set; no instruction set means the widest available.
pub(crate) fn bind_arithmetic(
    binding: &mut dyn Binding,
    precision: &mut Precision,
    instruction_set: &mut Option<InstructionSet>,
) {
    binding.choice(&PRECISION, precision);
    bind_instructions(binding, instruction_set);
}

/// Binds a method's key for the execution of its programs.
pub(crate) fn bind_execution(binding: &mut dyn Binding, key: &'static Key, execution: &mut Execution) {
    let mut name = execution_name(*execution);
    binding.word(key, &mut name);
    *execution = match name.strip_prefix("strip:").map(str::parse) {
        Some(Ok(length)) => Execution::Strip(length),
        _ if name == "eager" => Execution::Eager,
        _ => Execution::Chained,
    };
}

/// Name of an execution of programs, in scenes and on the command line.
pub(crate) fn execution_name(execution: Execution) -> String {
    match execution {
        Execution::Chained => "chained".to_owned(),
        Execution::Eager => "eager".to_owned(),
        Execution::Strip(length) => format!("strip:{length}"),
    }
}

/// Binds the key of the instruction set; none means the widest available.
pub(crate) fn bind_instructions(binding: &mut dyn Binding, instruction_set: &mut Option<InstructionSet>) {
    let mut name = instruction_set.map_or("auto", InstructionSet::name).to_owned();
    binding.word(&INSTRUCTION_SET, &mut name);
    *instruction_set = InstructionSet::ALL.iter().copied().find(|set| set.name() == name);
}
