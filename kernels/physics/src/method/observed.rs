//! Look-up of observed quantities by name.

use super::entry::{MethodObservable, ObservedQuantity};
use crate::reported::{ErrorClass, Reported};
use serde_json::{Map, Value};

/// Unknown name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} `{name}`\n  help: use one of {}", known.join(", "))]
pub struct UnknownName {
    /// Kind of thing that was looked up.
    pub what: &'static str,
    /// Its name.
    pub name: String,
    /// Known names.
    pub known: Vec<String>,
}

impl UnknownName {
    /// Error of a name of a kind of thing, with the known names.
    pub fn new<'n>(what: &'static str, name: &str, known: impl IntoIterator<Item = &'n str>) -> Self {
        UnknownName { what, name: name.to_owned(), known: known.into_iter().map(str::to_owned).collect() }
    }
}

impl Reported for UnknownName {
    fn class(&self) -> ErrorClass {
        ErrorClass::Precondition
    }
}

/// Builds a list of observables; each row has name, unit, kind, function that evaluates it, and description.
macro_rules! observables {
    ($($name:literal, $unit:literal, $kind:expr, $of:expr, $doc:literal;)*) => {
        [$($crate::method::MethodObservable {
            quantity: $crate::method::ObservedQuantity { name: $name, unit: $unit, kind: $kind, doc: $doc },
            of: $of,
        }),*]
    };
}
pub(super) use observables;

/// Values of observables in order.
pub(super) fn values<S>(observables: &[MethodObservable<S>], seen: &S) -> Vec<f64> {
    observables.iter().map(|observable| (observable.of)(seen)).collect()
}

/// Returns the index of a quantity at compile time: a misspelt name does not compile.
///
/// # Panics
/// If no quantity has this name.
#[expect(clippy::panic, reason = "a constant: a name that is misspelt does not compile")]
pub(crate) const fn quantity_index(quantities: &[ObservedQuantity], name: &str) -> usize {
    let mut at = 0;
    while at < quantities.len() {
        if is_same(quantities[at].name, name) {
            return at;
        }
        at += 1;
    }
    panic!("no quantity of that name is observed")
}

const fn is_same(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    let mut at = 0;
    while at < one.len() && at < other.len() && one[at] == other[at] {
        at += 1;
    }
    at == one.len() && at == other.len()
}

/// Returns the index of an observed quantity.
///
/// # Errors
/// [`UnknownName`] if no quantity has this name.
pub fn find(quantities: &[ObservedQuantity], name: &str) -> Result<usize, UnknownName> {
    let unknown = || UnknownName::new("quantity", name, quantities.iter().map(|quantity| quantity.name));
    quantities.iter().position(|quantity| quantity.name == name).ok_or_else(unknown)
}

/// Returns values of quantities by name from `values`, which has one for each quantity.
///
/// # Errors
/// [`UnknownName`] if a name is not observed.
pub fn observed<const N: usize>(
    quantities: &[ObservedQuantity],
    values: &[f64],
    names: [&str; N],
) -> Result<[f64; N], UnknownName> {
    let mut found = [0.0; N];
    for (found, name) in found.iter_mut().zip(names) {
        *found = values[find(quantities, name)?];
    }
    Ok(found)
}

/// Returns a number of a summary.
///
/// # Errors
/// [`UnknownName`] if the summary has no number of this name.
pub fn summary_number(summary: &Map<String, Value>, name: &str) -> Result<f64, UnknownName> {
    let numbers = summary.iter().filter(|(_, value)| value.is_number()).map(|(name, _)| name.as_str());
    let unknown = || UnknownName::new("number of the summary", name, numbers);
    summary.get(name).and_then(Value::as_f64).ok_or_else(unknown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, QuantityKind};

    const QUANTITIES: &[ObservedQuantity] = &[
        ObservedQuantity { name: "time", unit: "time", kind: QuantityKind::Time, doc: "" },
        ObservedQuantity { name: "flow", unit: "", kind: QuantityKind::Instant, doc: "" },
    ];

    #[test]
    fn unknown_quantity_error_lists_known_names() {
        assert_eq!(observed(QUANTITIES, &[1.0, 2.0], ["flow", "time"]), Ok([2.0, 1.0]));
        let said = observed(QUANTITIES, &[1.0, 2.0], ["flwo"]).unwrap_err().to_string();
        assert_eq!(said, "unknown quantity `flwo`\n  help: use one of time, flow");
        assert_eq!(quantity_index(QUANTITIES, "flow"), 1);
        assert!(std::panic::catch_unwind(|| quantity_index(QUANTITIES, "flo")).is_err());
        let summary: Map<String, Value> = serde_json::from_str(r#"{"remaps": 3, "mask": "min"}"#).unwrap();
        assert_eq!(summary_number(&summary, "remaps"), Ok(3.0));
        let said = summary_number(&summary, "remap").unwrap_err().to_string();
        assert!(said.contains("`remap`") && said.ends_with("one of remaps"), "{said}");
    }

    #[test]
    fn every_method_observes_the_time() {
        for method in METHODS {
            let times = method.quantities.iter().filter(|quantity| quantity.kind == QuantityKind::Time);
            assert_eq!(times.map(|it| it.name).collect::<Vec<_>>(), ["time"]);
        }
    }

    /// Benchmarks name observed quantities only.
    #[test]
    fn names_of_benches_are_observed() {
        for method in METHODS {
            for bench in method.benches {
                for name in bench.compared.iter().chain(bench.at_end) {
                    assert!(find(bench.quantities, name).is_ok(), "{}: {name}", bench.name);
                }
            }
        }
    }
}
