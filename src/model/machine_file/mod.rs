//! Machine files: TOML in which every number is a table of its value, its provenance and a note.
//!
//! ```toml
//! format = 1
//! title = "A machine"
//! year = { value = 1976, provenance = "sourced", note = "where from" }
//! clock_period_ns = { value = 12.5, provenance = "sourced", note = "where from" }
//!
//! [vector_registers] # left out where vectors have any length
//! count = { value = 8, provenance = "sourced", note = "where from" }
//! length = { value = 64, provenance = "sourced", note = "where from" }
//!
//! [start_up] # clock periods; `default` is for all classes that are not named
//! default = { value = 6, provenance = "assumed", note = "why" }
//! divide = { value = 14, provenance = "sourced", note = "the reciprocal unit" }
//!
//! [expansions.divide] # the class itself stands for its unit and is not expanded again
//! steps = { divide = 1, multiply = 3 }
//! provenance = "sourced"
//! note = "where from"
//!
//! # All of the following may be left out; a clock that needs what is left out charges as the clock before it.
//! chaining = { value = true, provenance = "sourced", note = "where from" } # above the tables
//! loop_overhead = { value = 15, provenance = "assumed", note = "why" } # clock periods a strip; above the tables
//!
//! [units.add] # `count` instructions of these classes run at once, each at `rate` elements a clock period
//! serves = ["add", "convert"]
//! count = { value = 1, provenance = "sourced", note = "where from" }
//! rate = { value = 2, provenance = "sourced", note = "where from" } # 1 where it is left out
//!
//! [memory]
//! load_ports = { value = 2, provenance = "sourced", note = "where from" }
//! store_ports = { value = 1, provenance = "sourced", note = "where from" } # left out: stores take the ports of loads
//! rate = { value = 1, provenance = "sourced", note = "where from" } # elements a clock period of each port
//! gather_rate = { value = 0.5, provenance = "sourced", note = "where from" } # the same through an index vector
//! ```

mod check;
mod error;
mod grammar;
mod limits;
mod position;

pub use error::{Defect, MachineError, MachineFileError};
pub use limits::FORMAT;
pub(crate) use limits::{LONGEST, NAMED};
pub use position::Position;

use super::machine::{Expansion, MachineModel, VectorRegisters};
use super::quantity::{Fact, Provenance, Quantity};
use super::units::{MemoryPorts, Unit, Units};
use serde::Deserialize;
use std::collections::BTreeMap;
use stripmine_physics::io::regular_file;

/// The file as it is written, names of classes still unchecked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MachineFile {
    format: u32,
    title: String,
    year: Quantity,
    clock_period_ns: Quantity,
    vector_registers: Option<VectorRegisters>,
    chaining: Option<Fact>,
    loop_overhead: Option<Quantity>,
    start_up: BTreeMap<String, Quantity>,
    #[serde(default)]
    units: BTreeMap<String, WrittenUnit>,
    memory: Option<MemoryPorts>,
    #[serde(default)]
    expansions: BTreeMap<String, WrittenExpansion>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenUnit {
    serves: Vec<String>,
    count: Quantity,
    rate: Option<Quantity>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenExpansion {
    steps: BTreeMap<String, u64>,
    provenance: Provenance,
    note: String,
}

impl MachineModel {
    /// Reads a machine file.
    ///
    /// # Errors
    /// [`MachineError`]: the system does not let it be read, or it is bad.
    pub fn load(file: &str) -> Result<MachineModel, MachineError> {
        let bytes = regular_file::read(file.as_ref(), LONGEST)
            .map_err(|cause| MachineError::Read { file: file.to_owned(), cause })?;
        match String::from_utf8(bytes) {
            Ok(text) => Ok(MachineModel::parse(file, &text)?),
            Err(cause) => {
                let line = regular_file::line_that_is_not_text(cause.as_bytes()).unwrap_or(1);
                Err(MachineFileError::NotText { file: file.to_owned(), line }.into())
            }
        }
    }

    /// Reads a machine from the `text` of a machine file; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`MachineFileError`]: not TOML, or every entry found wrong; what only the whole machine can show is looked for once
    /// every entry is right.
    pub fn parse(file: &str, text: &str) -> Result<MachineModel, MachineFileError> {
        let content = |mut defects: Vec<Defect>| {
            let more = defects.len().saturating_sub(NAMED);
            defects.truncate(NAMED);
            let placed = |defect: Defect| (Position::of(text, &defect.entry()), defect);
            let defects = defects.into_iter().map(placed).collect();
            MachineFileError::Content { file: file.to_owned(), defects, more }
        };
        let defects = grammar::defects(text);
        if !defects.is_empty() {
            return Err(content(defects));
        }
        let written: MachineFile = toml::from_str(text)
            .map_err(|error| MachineFileError::Syntax { file: file.to_owned(), cause: Box::new(error) })?;
        written.machine().map_err(|defect| content(vec![defect]))
    }
}

impl MachineFile {
    /// The machine, once everything beyond the grammar is in order.
    fn machine(mut self) -> Result<MachineModel, Defect> {
        if self.format != FORMAT {
            return Err(Defect::UnsupportedFormat { found: self.format });
        }
        let default_start_up = self.start_up.remove("default");
        let class_start_ups = check::named_by_class("start_up", self.start_up)?;
        let mut expansions = BTreeMap::new();
        for (class, WrittenExpansion { steps, provenance, note }) in
            check::named_by_class("expansions", self.expansions)?
        {
            let entry = format!("expansions.{}.steps", class.name());
            let steps = check::named_by_class(&entry, steps)?;
            check::steps(&entry, &steps)?;
            expansions.insert(class, Expansion { steps, provenance, note });
        }
        let mut executed = BTreeMap::new();
        for &class in expansions.keys() {
            executed.insert(class, check::expand_fully(class, &expansions)?);
        }
        let mut units = Units::new();
        for (name, WrittenUnit { serves, count, rate }) in self.units {
            let entry = format!("units.{name}.serves");
            let serves = serves.iter().map(|class| check::class(class, &entry)).collect::<Result<_, _>>()?;
            units.insert(name, Unit { serves, count, rate });
        }
        let machine = MachineModel {
            title: self.title,
            year: self.year,
            clock_period_ns: self.clock_period_ns,
            vector_registers: self.vector_registers,
            chaining: self.chaining,
            loop_overhead: self.loop_overhead,
            units,
            memory: self.memory,
            default_start_up,
            class_start_ups,
            expansions,
            executed,
        };
        check::machine(&machine)?;
        Ok(machine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::isa::op::OpClass;

    const GOOD: &str = r#"
        format = 1
        title = "A machine"
        year = { value = 1976, provenance = "sourced", note = "here" }
        clock_period_ns = { value = 12.5, provenance = "derived", note = "from there" }
        [vector_registers]
        count = { value = 8, provenance = "sourced", note = "here" }
        length = { value = 64, provenance = "sourced", note = "here" }
        [start_up]
        default = { value = 6, provenance = "assumed", note = "why not" }
        divide = { value = 14, provenance = "sourced", note = "there" }
        [expansions.divide]
        steps = { divide = 1, multiply = 3 }
        provenance = "sourced"
        note = "here"
    "#;

    /// What is said about the good file once `old` in it is replaced by `new`.
    fn complaint(old: &str, new: &str) -> String {
        assert!(GOOD.contains(old), "{old}");
        MachineModel::parse("bad.toml", &GOOD.replace(old, new)).unwrap_err().to_string()
    }

    #[test]
    fn a_good_file_becomes_a_machine() {
        let machine = MachineModel::parse("good.toml", GOOD).unwrap();
        assert_eq!(machine.title(), "A machine");
        assert_eq!(machine.clock_period_ns().value, 12.5);
        assert_eq!(machine.vector_registers().unwrap().length.value, 64.0);
        assert_eq!(machine.start_up(OpClass::Divide), 14.0);
        assert_eq!(machine.start_up(OpClass::Gather), 6.0);
        assert_eq!(machine.assumed(), ["start_up.default"]);
    }

    #[test]
    fn every_defect_is_named_with_file_and_entry() {
        let divide = "steps = { divide = 1, multiply = 3 }";
        let default = r#"default = { value = 6, provenance = "assumed", note = "why not" }"#;
        for (old, new, expected) in [
            ("format = 1", "format = 2", "format = 2, but this program reads format 1"),
            ("value = 12.5", "value = 0", "`clock_period_ns` is 0, but must be positive"),
            ("value = 12.5", "value = nan", "`clock_period_ns` is NaN, but must be positive"),
            ("value = 14", "value = -14", "`start_up.divide` is -14, but must be positive"),
            ("value = 6,", "value = inf,", "`start_up.default` is inf, but must be positive"),
            ("value = 64", "value = 64.5", "`vector_registers.length` is 64.5, but must be a whole number"),
            ("value = 1976", "value = -1", "`year` is -1, but must be positive"),
            ("why not", " ", "the note of `start_up.default` is empty"),
            ("\"here\"\n    ", "\"\"\n    ", "the note of `expansions.divide` is empty"),
            ("divide = { value", "division = { value", "`division` names no class of operations"),
            ("[expansions.divide]", "[expansions.root]", "`root` names no class of operations"),
            ("multiply = 3", "times = 3", "`times` names no class of operations"),
            ("multiply = 3", "multiply = 0", "`expansions.divide.steps.multiply` is 0"),
            (divide, "steps = {}", "`expansions.divide.steps` has no steps"),
            (default, "", "neither `start_up.add` nor `start_up.default` is given"),
        ] {
            let complaint = complaint(old, new);
            assert!(complaint.starts_with("machine file `bad.toml`, line "), "{complaint}");
            assert!(complaint.contains(expected), "{complaint}");
        }
    }

    #[test]
    fn defects_of_the_grammar_are_shown_with_their_line() {
        for (old, new, expected) in [
            ("title = ", "name = ", "unknown field `name`"),
            ("title = \"A machine\"", "", "missing field `title`"),
            ("provenance = \"derived\"", "provenance = \"guessed\"", "must be \"sourced\" or"),
            ("value = 12.5, ", "", "missing field `value`"),
            ("value = 12.5", "value = \"fast\"", "`clock_period_ns.value` must be a number"),
            ("multiply = 3", "multiply = -3", "must be a whole number, not negative"),
            ("title = \"A machine\"", "title = ", "TOML parse error at"),
        ] {
            let complaint = complaint(old, new);
            assert!(complaint.contains(expected) && complaint.contains("line "), "{complaint}");
        }
    }

    #[test]
    fn expansions_that_run_in_a_circle_are_refused() {
        let circle = r#"
            [expansions.multiply]
            steps = { add = 1, divide = 2 }
            provenance = "assumed"
            note = "a circle"
        "#;
        let error = MachineModel::parse("bad.toml", &format!("{GOOD}{circle}")).unwrap_err();
        let MachineFileError::Content { file, defects, .. } = &error else { panic!("{error}") };
        let [(_, Defect::EndlessExpansion { entry, cycle })] = defects.as_slice() else { panic!("{error}") };
        assert_eq!((file.as_str(), entry.as_str()), ("bad.toml", "expansions.multiply"));
        assert_eq!(*cycle, ["multiply", "divide", "multiply"]);
    }

    #[test]
    fn a_class_that_is_expanded_away_needs_no_start_up() {
        let own_start_ups: String = OpClass::ALL
            .iter()
            .filter(|&&class| !matches!(class, OpClass::Divide | OpClass::SquareRoot))
            .map(|class| {
                format!("{} = {{ value = 2, provenance = \"assumed\", note = \"n\" }}\n", class.name())
            })
            .collect();
        let default = r#"default = { value = 6, provenance = "assumed", note = "why not" }"#;
        let square_root =
            "[expansions.square_root]\nsteps = { divide = 3 }\nprovenance = \"assumed\"\nnote = \"n\"";
        let without = GOOD.replace(default, &own_start_ups);
        assert!(MachineModel::parse("bad.toml", &without).is_err());
        let machine = MachineModel::parse("good.toml", &format!("{without}\n{square_root}")).unwrap();
        assert_eq!(machine.start_up(OpClass::SquareRoot), 0.0);
    }
}
