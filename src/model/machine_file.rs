//! Machine files: TOML in which every number is a table of its value, its provenance and a note. The fields of [`MachineModel`]
//! define the entries; `machines/cray-1.toml` is an example of almost all.

use super::file::{FileEntry, FileKind};
use super::machine::{ClassCounts, DEFAULT, MachineModel, add_scaled};
use super::whole_registers::WholeRegisters;
use stripmine_kernels::isa::op::OpClass;
use stripmine_physics::input::InputErrors;
use toml::de::DeValue;

const KIND: FileKind<MachineModel> =
    FileKind { format: 1, remedy: None, wrong: machine_entry_error, completed: MachineModel::completed };
/// Largest number of operations in an expansion; clocks process them one by one.
const LONGEST_EXPANSION: u64 = 10_000;

impl MachineModel {
    /// Reads a machine file.
    ///
    /// # Errors
    /// [`InputErrors`]: the file cannot be read, or as for [`MachineModel::parse`].
    pub fn load(file: &str) -> Result<MachineModel, InputErrors> {
        KIND.load(file.as_ref())
    }

    /// Reads a machine from the `text` of a machine file; `file` is its name in errors.
    ///
    /// # Errors
    /// [`InputErrors`]: every invalid entry, or, once all entries are valid, a mistake of the machine as a whole.
    pub fn parse(file: &str, text: &str) -> Result<MachineModel, InputErrors> {
        KIND.read(file, text)
    }

    /// Completes the machine with its full expansions. Every class that it executes must have a start-up and, where units are named,
    /// a unit.
    fn completed(mut self) -> Result<MachineModel, (String, String)> {
        for class in OpClass::ALL.iter().filter(|class| self.expansions.contains_key(class.name())) {
            let executed = self.executed_for(*class)?;
            self.executed.insert(*class, executed);
        }
        if let Some(error) = self.whole_registers.as_ref().and_then(WholeRegisters::error) {
            return Err(error);
        }
        // The clock of whole registers needs no start-ups.
        let needs_start_ups = self.whole_registers.is_none() || self.has_start_ups();
        for class in OpClass::ALL.iter().filter(|_| needs_start_ups) {
            let name = class.name();
            if self.expansions.get(name).is_some_and(|own| !own.steps.contains_key(name)) {
                continue;
            }
            if ![DEFAULT, name].iter().any(|name| self.start_up.contains_key(*name)) {
                let what = format!("neither `start_up.{name}` nor `start_up.default` is given");
                return Err(("start_up".to_owned(), what));
            }
            if self.has_units() && !class.moves_data() && self.unit(*class).is_none() {
                let what = format!("no unit of `units` serves `{name}`, which the machine executes");
                return Err(("units".to_owned(), what));
            }
        }
        Ok(self)
    }

    /// Operations of executed classes that one operation of an expanded class consists of.
    fn executed_for(&self, class: OpClass) -> Result<ClassCounts, (String, String)> {
        let path = format!("expansions.{}", class.name());
        let what = match self.follow(class, &mut vec![]) {
            Err(circle) => format!("`{path}` is circular: {}", circle.join(" -> ")),
            Ok(executed) => {
                let count = executed.values().fold(0_u64, |sum, count| sum.saturating_add(*count));
                if count <= LONGEST_EXPANSION {
                    return Ok(executed);
                }
                let most = format!("above the maximum of {LONGEST_EXPANSION}");
                format!("`{path}` expands to {count} operations, {most}")
            }
        };
        Err((path, what))
    }

    /// Follows the expansion of `class` to its end; `open` holds the classes being expanded; an error contains the circle.
    fn follow(&self, class: OpClass, open: &mut Vec<OpClass>) -> Result<ClassCounts, Vec<&'static str>> {
        let own = ClassCounts::from([(class, 1)]);
        let Some(expansion) = self.expansions.get(class.name()) else { return Ok(own) };
        let is_circle = open.contains(&class);
        open.push(class);
        if is_circle {
            return Err(open.iter().map(|class| class.name()).collect());
        }
        let mut total = ClassCounts::new();
        for (name, &times) in &expansion.steps {
            let Some(step) = class_of(name) else { continue };
            let executed = if step == class { own.clone() } else { self.follow(step, open)? };
            add_scaled(&mut total, &executed, times);
        }
        open.pop();
        Ok(total)
    }
}

fn class_of(name: &str) -> Option<OpClass> {
    OpClass::ALL.iter().copied().find(|class| class.name() == name)
}

/// Describes an error of a single entry, if any.
fn machine_entry_error(entry: &FileEntry<'_>) -> Option<String> {
    let path = entry.path();
    match (&entry.names[..], entry.value) {
        ([.., "note"], DeValue::String(note)) if note.trim().is_empty() => {
            let of = path.trim_end_matches(".note");
            Some(format!("the note of `{of}` is empty; expected the origin of the number"))
        }
        (["start_up", name], _) if *name != DEFAULT => unknown_class_error(name, &path),
        (["whole_registers", "periods", name], DeValue::Table(_)) => unknown_class_error(name, &path),
        (["units", _, "serves"], DeValue::String(name)) => unknown_class_error(name, &path),
        (["expansions", name], _) => unknown_class_error(name, &path),
        (["expansions", _, "steps"], DeValue::Table(steps)) if steps.is_empty() => {
            Some(format!("`{path}` has no steps"))
        }
        (["expansions", _, "steps", name], _) => unknown_class_error(name, &path)
            .or_else(|| (entry.number()? == 0.0).then(|| format!("`{path}` is 0, but must be positive"))),
        ([of @ .., "value"], _) => number_error(entry.number()?, of),
        _ => None,
    }
}

fn unknown_class_error(name: &str, path: &str) -> Option<String> {
    let known = || OpClass::ALL.iter().map(|class| class.name()).collect::<Vec<_>>().join(", ");
    let is_known = class_of(name).is_some();
    (!is_known).then(|| format!("`{path}`: `{name}` is not a class of operations; known are {}", known()))
}

/// Describes an error of a number, if any. The upper bounds keep the sum over a program finite.
fn number_error(value: f64, of: &[&str]) -> Option<String> {
    let (most, is_counted) = match of.last() {
        Some(&"year") => (9999.0, true),
        Some(&"count" | &"length" | &"load_ports" | &"store_ports" | &"vlen" | &"group" | &"lanes_32") => {
            (1e6, true)
        }
        _ => (1e12, false),
    };
    let expected = match value {
        _ if !(value.is_finite() && value > 0.0) => "positive and finite".to_owned(),
        _ if value > most => format!("at most {most:e}"),
        _ if is_counted && value.fract() != 0.0 => "a whole number".to_owned(),
        _ => return None,
    };
    Some(format!("`{}` is {value}, but must be {expected}", of.join(".")))
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

    /// Error message for the good file with `old` replaced by `new`.
    fn complaint(old: &str, new: &str) -> String {
        assert!(GOOD.contains(old), "{old}");
        MachineModel::parse("bad.toml", &GOOD.replace(old, new)).unwrap_err().to_string()
    }

    #[test]
    fn a_good_file_becomes_a_machine() {
        let machine = MachineModel::parse("good.toml", GOOD).unwrap();
        assert_eq!(machine.title(), "A machine");
        assert_eq!(machine.clock_period_ns(), 12.5);
        assert_eq!(machine.vector_registers.as_ref().unwrap().length.value, 64.0);
        assert_eq!(machine.start_up(OpClass::Divide), 14.0);
        assert_eq!(machine.start_up(OpClass::Gather), 6.0);
        assert_eq!(machine.assumed(), ["start_up.default"]);
    }

    #[test]
    fn invalid_entries_are_reported_with_file() {
        let divide = "steps = { divide = 1, multiply = 3 }";
        let default = r#"default = { value = 6, provenance = "assumed", note = "why not" }"#;
        for (old, new, expected) in [
            ("format = 1", "format = 2", "`format` is 2\n  expected: 1"),
            ("value = 12.5", "value = 0", "`clock_period_ns` is 0\n  expected: positive"),
            ("value = 12.5", "value = nan", "`clock_period_ns` is NaN\n  expected: positive"),
            ("value = 14", "value = -14", "`start_up.divide` is -14\n  expected: positive"),
            ("value = 6,", "value = inf,", "`start_up.default` is inf\n  expected: positive"),
            ("value = 64", "value = 64.5", "`vector_registers.length` is 64.5\n  expected: a whole number"),
            ("value = 1976", "value = -1", "`year` is -1\n  expected: positive"),
            ("why not", " ", "the note of `start_up.default` is empty"),
            ("\"here\"\n    ", "\"\"\n    ", "the note of `expansions.divide` is empty"),
            ("divide = { value", "division = { value", "`division` is not a class of operations"),
            ("[expansions.divide]", "[expansions.root]", "`root` is not a class of operations"),
            ("multiply = 3", "times = 3", "`times` is not a class of operations"),
            ("multiply = 3", "multiply = 0", "`expansions.divide.steps.multiply` is 0"),
            (divide, "steps = {}", "`expansions.divide.steps` has no steps"),
            (default, "", "neither `start_up.add` nor `start_up.default` is given"),
        ] {
            let complaint = complaint(old, new);
            assert!(complaint.starts_with("bad.toml:"), "{complaint}");
            assert!(complaint.contains(expected), "{complaint}");
        }
    }

    #[test]
    fn syntax_errors_are_reported_with_line() {
        for (old, new, expected) in [
            ("title = ", "name = ", "unknown field `name`"),
            ("title = \"A machine\"", "", "missing field `title`"),
            (
                "provenance = \"derived\"",
                "provenance = \"guessed\"",
                "unknown variant `guessed`\n  expected: one of `sourced`",
            ),
            ("value = 12.5, ", "", "missing field `value`"),
            ("value = 12.5", "value = \"fast\"", "`clock_period_ns.value`: invalid type"),
            ("multiply = 3", "multiply = -3", "`expansions.divide.steps.multiply`: invalid value"),
            ("title = \"A machine\"", "title = ", "not TOML: "),
        ] {
            let complaint = complaint(old, new);
            assert!(complaint.contains(expected) && complaint.contains("bad.toml:"), "{complaint}");
        }
    }

    #[test]
    fn circular_expansions_are_refused() {
        let circle = r#"
            [expansions.multiply]
            steps = { add = 1, divide = 2 }
            provenance = "assumed"
            note = "a circle"
        "#;
        let error = MachineModel::parse("bad.toml", &format!("{GOOD}{circle}")).unwrap_err();
        let said = "`expansions.multiply` is circular: multiply -> divide -> multiply";
        assert!(error.to_string().contains(said), "{error}");
    }

    #[test]
    fn fully_expanded_classes_need_no_start_up() {
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

    #[test]
    fn all_mistakes_are_found_at_once() {
        let text = r#"
            format = "1"
            titel = "A machine"
            year = { value = 0, provenance = "sourced", note = "here" }
            clock_period_ns = { value = -12.5, provenance = "sourced", note = "" }
            chaining = { value = "no", provenance = "sourced", note = "here" }
            loop_overhead = { value = 15, provenance = "sourced" }
            [start_up]
            default = { value = 6, provenance = "assumed", note = "why not" }
            division = { value = 0, provenance = "assumed", note = "why not" }
            [memory]
        "#;
        let InputErrors(said) = MachineModel::parse("bad.toml", text).unwrap_err();
        for (line, expected) in [
            (2, "`format`: invalid type: string \"1\", expected u32"),
            (3, "unknown field `titel`, expected one of"),
            (4, "`year` is 0, but must be positive"),
            (5, "`clock_period_ns` is -12.5, but must be positive"),
            (5, "the note of `clock_period_ns` is empty"),
            (6, "`chaining.value`: invalid type: string \"no\", expected a boolean"),
            (7, "`loop_overhead`: missing field `note`"),
            (10, "`division` is not a class"),
            (10, "`start_up.division` is 0"),
            (11, "`memory`: missing field `load_ports`"),
        ] {
            let found = said.iter().filter(|it| it.message.contains(expected));
            let lines: Vec<u32> = found.map(|it| it.place.unwrap().line).collect();
            assert_eq!(lines, [line], "{expected}: {said:#?}");
        }
        assert_eq!(said.len(), 10, "{said:#?}");
        assert_eq!(said[1].suggestion.as_deref(), Some("did you mean `title`?"));
    }
}
