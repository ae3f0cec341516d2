//! The grammar of machine files, as a list: what may stand where. Reading stops at the first defect; this finds all.

use super::check::class;
use super::error::Defect;
use toml::de::{DeTable, DeValue};

/// What stands at a place.
#[derive(Clone, Copy)]
enum Shape {
    /// A version, or how many steps of an expansion there are: a whole number, not negative.
    Whole,
    /// Words.
    Words,
    /// `true` or `false`.
    Truth,
    /// A number above zero.
    Positive,
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// Names of classes of operations.
    Classes,
    /// A table with these keys, and whether each must be there.
    Table(&'static [(&'static str, bool, Shape)]),
    /// A table of things of one kind, by any name.
    Named(&'static Shape),
    /// The same by the name of a class of operations; `default` as well where it is allowed.
    ByClass(bool, &'static Shape),
}

const PROVENANCE: Shape = Shape::OneOf(&["sourced", "derived", "assumed"]);
const QUANTITY: Shape = Shape::Table(&[
    ("value", true, Shape::Positive),
    ("provenance", true, PROVENANCE),
    ("note", true, Shape::Words),
]);
const FACT: Shape = Shape::Table(&[
    ("value", true, Shape::Truth),
    ("provenance", true, PROVENANCE),
    ("note", true, Shape::Words),
]);
const REGISTERS: Shape = Shape::Table(&[("count", true, QUANTITY), ("length", true, QUANTITY)]);
const UNIT: Shape =
    Shape::Table(&[("serves", true, Shape::Classes), ("count", true, QUANTITY), ("rate", false, QUANTITY)]);
const MEMORY: Shape = Shape::Table(&[
    ("load_ports", true, QUANTITY),
    ("store_ports", false, QUANTITY),
    ("rate", false, QUANTITY),
    ("gather_rate", false, QUANTITY),
]);
const EXPANSION: Shape = Shape::Table(&[
    ("steps", true, Shape::ByClass(false, &Shape::Whole)),
    ("provenance", true, PROVENANCE),
    ("note", true, Shape::Words),
]);
const FILE: Shape = Shape::Table(&[
    ("format", true, Shape::Whole),
    ("title", true, Shape::Words),
    ("year", true, QUANTITY),
    ("clock_period_ns", true, QUANTITY),
    ("vector_registers", false, REGISTERS),
    ("chaining", false, FACT),
    ("loop_overhead", false, QUANTITY),
    ("start_up", true, Shape::ByClass(true, &QUANTITY)),
    ("units", false, Shape::Named(&UNIT)),
    ("memory", false, MEMORY),
    ("expansions", false, Shape::ByClass(false, &EXPANSION)),
]);

/// Every defect of a text's grammar; none where it is not even TOML, which is said elsewhere.
pub(super) fn defects(text: &str) -> Vec<Defect> {
    let Ok(document) = DeTable::parse(text) else { return vec![] };
    let mut found = vec![];
    table(document.get_ref(), FILE, "", &mut found);
    found
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

fn table(written: &DeTable<'_>, shape: Shape, path: &str, found: &mut Vec<Defect>) {
    if let Shape::Table(keys) = shape {
        for (key, required, _) in keys {
            if *required && !written.iter().any(|(name, _)| name.get_ref() == key) {
                found.push(Defect::MissingField { entry: join(path, key), name: (*key).to_owned() });
            }
        }
    }
    for (name, inner) in written {
        let name = name.get_ref().as_ref();
        let entry = join(path, name);
        let shape = match shape {
            Shape::Table(keys) => keys.iter().find(|(key, ..)| *key == name).map(|(.., shape)| *shape),
            Shape::Named(shape) => Some(*shape),
            Shape::ByClass(default, shape) => {
                if !(default && name == "default")
                    && let Err(defect) = class(name, &entry)
                {
                    found.push(defect);
                }
                Some(*shape)
            }
            _ => None,
        };
        match shape {
            Some(shape) => value(inner.get_ref(), shape, &entry, found),
            None => found.push(Defect::UnknownField { entry, name: name.to_owned() }),
        }
    }
}

fn value(written: &DeValue<'_>, shape: Shape, path: &str, found: &mut Vec<Defect>) {
    let mut expected = |what: &'static str| {
        found.push(Defect::WrongType { entry: path.to_owned(), expected: what.to_owned() });
    };
    match (shape, written) {
        (Shape::Table(_) | Shape::Named(_) | Shape::ByClass(..), DeValue::Table(inner)) => {
            table(inner, shape, path, found);
        }
        (Shape::Table(_) | Shape::Named(_) | Shape::ByClass(..), _) => expected("a table"),
        (Shape::Words, DeValue::String(_)) | (Shape::Truth, DeValue::Boolean(_)) => {}
        (Shape::Words, _) => expected("words in quotes"),
        (Shape::Truth, _) => expected("`true` or `false`"),
        (Shape::Whole, DeValue::Integer(number)) if !number.as_str().starts_with('-') => {}
        (Shape::Whole, _) => expected("a whole number, not negative"),
        (Shape::Positive, DeValue::Integer(number)) => positive(number.as_str(), path, found),
        (Shape::Positive, DeValue::Float(number)) => positive(number.as_str(), path, found),
        (Shape::Positive, _) => expected("a number"),
        (Shape::OneOf(words), DeValue::String(word)) if words.contains(&word.as_ref()) => {}
        (Shape::OneOf(words), _) => found.push(Defect::WrongType {
            entry: path.to_owned(),
            expected: words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" or "),
        }),
        (Shape::Classes, DeValue::Array(names)) => {
            for name in names.iter() {
                match name.get_ref() {
                    DeValue::String(name) => found.extend(class(name, path).err()),
                    _ => found.push(Defect::WrongType {
                        entry: path.to_owned(),
                        expected: "names of classes in quotes".to_owned(),
                    }),
                }
            }
        }
        (Shape::Classes, _) => expected("a list of names of classes"),
    }
}

fn positive(number: &str, path: &str, found: &mut Vec<Defect>) {
    // Digits may be set apart by underscores; a number in another base cannot be negative.
    if let Ok(value) = number.replace('_', "").parse::<f64>()
        && !(value.is_finite() && value > 0.0)
    {
        let entry = path.strip_suffix(".value").unwrap_or(path).to_owned();
        found.push(Defect::NotPositive { entry, value });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let said: Vec<String> = defects(text).iter().map(Defect::to_string).collect();
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
