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

use super::file::{self, Entry, ModelFileError, Source, Table};
use super::machine::{ClassCounts, Expansion, MachineModel, VectorRegisters, add_scaled};
use super::quantity::{Fact, Provenance, Quantity};
use super::units::{MemoryPorts, Unit};
use std::collections::BTreeMap;
use stripmine_kernels::isa::op::OpClass;

/// The version of the file format that this program reads.
pub const FORMAT: u64 = 1;
const KIND: &str = "machine file";
/// The largest number of a kind, and whether it counts things. With larger ones a sum of all that a program does might not be finite.
type Bound = (f64, bool);
const REAL: Bound = (1e12, false);
const COUNTED: Bound = (1e6, true);
const YEAR: Bound = (9999.0, true);
/// Operations that one operation may come to; a clock writes them out one by one.
const LONGEST_EXPANSION: u64 = 10_000;

impl MachineModel {
    /// Reads a machine file.
    ///
    /// # Errors
    /// [`ModelFileError`]: the system does not let it be read, or it is bad.
    pub fn load(file: &str) -> Result<MachineModel, ModelFileError> {
        MachineModel::parse(file, &file::read(KIND, file.as_ref())?)
    }

    /// Reads a machine from the `text` of a machine file; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`ModelFileError`]: not TOML, or every entry found wrong; mistakes that only the whole machine shows are reported once every
    /// entry is right.
    pub fn parse(file: &str, text: &str) -> Result<MachineModel, ModelFileError> {
        Source { kind: KIND, file, text }.read(machine)
    }
}

fn machine(file: &Table<'_>) -> Option<MachineModel> {
    let format = file.need("format", |it| match it.whole()? {
        FORMAT => Some(()),
        found => it.wrong(format!("format = {found}, but this program reads format {FORMAT}")),
    });
    let title = file.need("title", Entry::words);
    let year = file.need("year", |it| quantity(it, YEAR));
    let clock_period_ns = file.need("clock_period_ns", |it| quantity(it, REAL));
    let chaining = file.may("chaining", |it| {
        let (value, provenance, note) = known(it, Entry::truth)?;
        Some(Fact { value, provenance, note })
    });
    let loop_overhead = file.may("loop_overhead", |it| quantity(it, REAL));
    let registers = |it: &Table<'_>| {
        let [count, length] = ["count", "length"].map(|name| it.need(name, |it| quantity(it, COUNTED)));
        Some(VectorRegisters { count: count?, length: length? })
    };
    let vector_registers = file.may("vector_registers", |it| it.table(registers));
    let start_ups = |it: &Table<'_>| {
        let default = it.may("default", |it| quantity(it, REAL));
        let classes = by_class(it, |it| quantity(it, REAL));
        Some((default?, classes?))
    };
    let start_ups = file.need("start_up", |it| it.table(start_ups));
    let units =
        file.may("units", |it| it.table(|it| it.others(|name, it| Some((name.to_owned(), unit(it)?)))));
    let memory = |it: &Table<'_>| {
        let load_ports = it.need("load_ports", |it| quantity(it, COUNTED));
        let store_ports = it.may("store_ports", |it| quantity(it, COUNTED));
        let [rate, gather_rate] = ["rate", "gather_rate"].map(|name| it.may(name, |it| quantity(it, REAL)));
        let (load_ports, store_ports) = (load_ports?, store_ports?);
        Some(MemoryPorts { load_ports, store_ports, rate: rate?, gather_rate: gather_rate? })
    };
    let memory = file.may("memory", |it| it.table(memory));
    let expansions = file.may("expansions", |it| it.table(|it| by_class(it, expansion)));
    format?;
    let (default_start_up, class_start_ups) = start_ups?;
    let machine = MachineModel {
        title: title?,
        year: year?,
        clock_period_ns: clock_period_ns?,
        vector_registers: vector_registers?,
        chaining: chaining?,
        loop_overhead: loop_overhead?,
        units: units?.unwrap_or_default(),
        memory: memory?,
        default_start_up,
        class_start_ups,
        expansions: expansions?.unwrap_or_default(),
        executed: BTreeMap::new(),
    };
    let executed = machine.expansions.keys().map(|&class| Some((class, executed(class, &machine, file)?)));
    let executed = executed.collect::<Option<_>>()?;
    is_complete(&machine, file)?;
    Some(MachineModel { executed, ..machine })
}

/// Every class that the machine executes has a start-up and, where units are named, a unit.
fn is_complete(machine: &MachineModel, file: &Table<'_>) -> Option<()> {
    let is_executed =
        |class: &OpClass| machine.expansions.get(class).is_none_or(|own| own.steps.contains_key(class));
    for class in OpClass::ALL.iter().filter(|class| is_executed(class)) {
        let name = class.name();
        if machine.default_start_up.is_none() && !machine.class_start_ups.contains_key(class) {
            let what = format!("neither `start_up.{name}` nor `start_up.default` is given");
            return file.wrong_at("start_up", what);
        }
        if machine.has_units() && !class.moves_data() && machine.unit(*class).is_none() {
            let what = format!("no unit of `units` serves `{name}`, which the machine executes");
            return file.wrong_at("units", what);
        }
    }
    Some(())
}

fn quantity(entry: &Entry<'_>, (most, is_counted): Bound) -> Option<Quantity> {
    let number = |it: &Entry<'_>| {
        let value = it.number()?;
        let expected = match value {
            _ if !(value.is_finite() && value > 0.0) => "positive and finite".to_owned(),
            _ if value > most => format!("at most {most:e}"),
            _ if is_counted && value.fract() != 0.0 => "a whole number".to_owned(),
            _ => return Some(value),
        };
        it.wrong(format!("`{}` is {value}, but must be {expected}", entry.path))
    };
    let (value, provenance, note) = known(entry, number)?;
    Some(Quantity { value, provenance, note })
}

/// A value, where it comes from, and the note that says so.
fn known<'t, T>(
    entry: &Entry<'t>,
    read: impl FnOnce(&Entry<'t>) -> Option<T>,
) -> Option<(T, Provenance, String)> {
    entry.table(|table| {
        let value = table.need("value", read);
        let (provenance, note) = origin(table)?;
        Some((value?, provenance, note))
    })
}

fn origin(table: &Table<'_>) -> Option<(Provenance, String)> {
    let provenance = table.need("provenance", |it| {
        let all = [Provenance::Sourced, Provenance::Derived, Provenance::Assumed];
        let found = it.words().map(|word| all.into_iter().find(|known| known.name() == word))?;
        let known = || all.map(|known| format!("\"{}\"", known.name())).join(" or ");
        found.or_else(|| it.wrong(format!("`{}` must be {}", it.path, known())))
    });
    let note = table.need("note", |it| {
        let (note, of) = (it.words()?, it.path.trim_end_matches(".note"));
        let is_empty = note.trim().is_empty();
        if !is_empty {
            Some(note)
        } else {
            it.wrong(format!("the note of `{of}` is empty; say where the number comes from"))
        }
    });
    Some((provenance?, note?))
}

/// The class of a name that an entry has, or that is its value.
fn class(name: &str, entry: &Entry<'_>) -> Option<OpClass> {
    OpClass::ALL.iter().copied().find(|class| class.name() == name).or_else(|| {
        let known = OpClass::ALL.iter().map(|class| class.name()).collect::<Vec<_>>().join(", ");
        entry.wrong(format!("`{}`: `{name}` names no class of operations; known are {known}", entry.path))
    })
}

fn by_class<T>(table: &Table<'_>, read: impl Fn(&Entry<'_>) -> Option<T>) -> Option<BTreeMap<OpClass, T>> {
    table.others(|name, entry| {
        let (class, value) = (class(name, entry), read(entry));
        Some((class?, value?))
    })
}

fn unit(entry: &Entry<'_>) -> Option<Unit> {
    entry.table(|table| {
        let serves = table.need("serves", |it| {
            let classes = it.list("names of classes")?.into_iter().map(|it| class(&it.words()?, &it));
            classes.collect::<Vec<_>>().into_iter().collect::<Option<_>>()
        });
        let count = table.need("count", |it| quantity(it, COUNTED));
        let rate = table.may("rate", |it| quantity(it, REAL));
        Some(Unit { serves: serves?, count: count?, rate: rate? })
    })
}

fn expansion(entry: &Entry<'_>) -> Option<Expansion> {
    let times = |it: &Entry<'_>| match it.whole()? {
        0 => it.wrong(format!("`{}` is 0, but must be positive", it.path)),
        times => Some(times),
    };
    entry.table(|table| {
        let steps = table.need("steps", |it| {
            let steps = it.table(|it| by_class(it, times))?;
            if !steps.is_empty() { Some(steps) } else { it.wrong(format!("`{}` has no steps", it.path)) }
        });
        let (provenance, note) = origin(table)?;
        Some(Expansion { steps: steps?, provenance, note })
    })
}

/// What one operation of a class that is expanded comes to in classes that the machine executes.
fn executed(class: OpClass, machine: &MachineModel, file: &Table<'_>) -> Option<ClassCounts> {
    let path = format!("expansions.{}", class.name());
    let executed = match follow(class, &machine.expansions, &mut vec![]) {
        Ok(executed) => executed,
        Err(circle) => return file.wrong_at(&path, format!("`{path}` never ends: {}", circle.join(" -> "))),
    };
    let count = executed.values().fold(0_u64, |sum, count| sum.saturating_add(*count));
    if count <= LONGEST_EXPANSION {
        return Some(executed);
    }
    let most = format!("but at most {LONGEST_EXPANSION} are counted out");
    file.wrong_at(&path, format!("`{path}` comes to {count} operations, {most}"))
}

/// Follows the expansion of `class` to its end; `open` holds the classes being expanded, an error the circle.
fn follow(
    class: OpClass,
    expansions: &BTreeMap<OpClass, Expansion>,
    open: &mut Vec<OpClass>,
) -> Result<ClassCounts, Vec<&'static str>> {
    let Some(expansion) = expansions.get(&class) else { return Ok(ClassCounts::from([(class, 1)])) };
    let is_circle = open.contains(&class);
    open.push(class);
    if is_circle {
        return Err(open.iter().map(|class| class.name()).collect());
    }
    let mut total = ClassCounts::new();
    for (&step, &times) in &expansion.steps {
        let executed =
            if step == class { ClassCounts::from([(class, 1)]) } else { follow(step, expansions, open)? };
        add_scaled(&mut total, &executed, times);
    }
    open.pop();
    Ok(total)
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
        let said = "`expansions.multiply` never ends: multiply -> divide -> multiply";
        assert!(error.to_string().contains(said), "{error}");
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

    #[test]
    fn every_defect_of_a_file_is_found_at_once() {
        let text = r#"
            format = 1
            titel = "A machine"
            year = { value = 1976, provenance = "sourced", note = "here" }
            clock_period_ns = { value = -12.5, provenance = "guessed" }
            [start_up]
            default = { value = "six", provenance = "assumed", note = "why not" }
            division = { value = 0, provenance = "assumed", note = "why not" }
        "#;
        let said = MachineModel::parse("bad.toml", text).unwrap_err().to_string();
        let said: Vec<&str> = said.lines().collect();
        for expected in [
            "missing field `title`",
            "unknown field `titel`",
            "`clock_period_ns` is -12.5",
            "`clock_period_ns.provenance` must be",
            "missing field `note`",
            "`start_up.default.value` must be a number",
            "`division` names no class",
            "`start_up.division` is 0",
        ] {
            assert_eq!(
                said.iter().filter(|said| said.contains(expected)).count(),
                1,
                "{expected}: {said:#?}"
            );
        }
        assert_eq!(said.len(), 8, "{said:#?}");
    }
}
