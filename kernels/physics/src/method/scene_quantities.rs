//! Quantities that only some scenes have: those of each plane wall and of each line through which discs are counted.

use super::entry::{MethodEntry, ObservedQuantity, QuantityKind};
use super::list::Methods;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Unit, kind and meaning of a quantity of a thing, by the thing and the end of the name.
const KINDS: [(&str, &str, &str, QuantityKind, &str); 11] = [
    (
        "wall",
        "impulse_x",
        "mass·length/time",
        QuantityKind::Counter,
        "Impulse of the grains on a plane wall along x since the start; its rate is the mean force.",
    ),
    (
        "wall",
        "impulse_y",
        "mass·length/time",
        QuantityKind::Counter,
        "Impulse of the grains on a plane wall along y since the start; its rate is the mean force.",
    ),
    ("wall", "force_x", "force", QuantityKind::Instant, "Force of the grains on a plane wall along x."),
    ("wall", "force_y", "force", QuantityKind::Instant, "Force of the grains on a plane wall along y."),
    (
        "flux",
        "count",
        "",
        QuantityKind::Counter,
        "Grains that have crossed a line to its right since the start, less those to its left.",
    ),
    (
        "flux",
        "mass",
        "mass",
        QuantityKind::Counter,
        "Mass of the grains that have crossed a line to its right since the start, less that to its left.",
    ),
    (
        "wall",
        "torque",
        "force·length",
        QuantityKind::Instant,
        "Torque of the grains on a plane wall about its middle.",
    ),
    ("wall", "x", "length", QuantityKind::Instant, "Middle of a plane wall that moves, along x."),
    ("wall", "y", "length", QuantityKind::Instant, "Middle of a plane wall that moves, along y."),
    (
        "wall",
        "velocity_x",
        "length/time",
        QuantityKind::Instant,
        "Velocity of a plane wall that moves, along x.",
    ),
    (
        "wall",
        "velocity_y",
        "length/time",
        QuantityKind::Instant,
        "Velocity of a plane wall that moves, along y.",
    ),
];

/// Labels of things without a number.
const SIDES: [&str; 4] = ["left", "right", "bottom", "top"];

/// Quantities of walls that move.
const OF_MOTION: [&str; 4] = ["x", "y", "velocity_x", "velocity_y"];

/// Names of all quantities of a thing, by its kind and its label: a number from 1, or a side of the box. Only a wall that moves has a position and
/// a velocity.
pub(crate) fn names_of(thing: &'static str, label: &str, moves: bool) -> Vec<String> {
    let of_thing = KINDS.iter().filter(|(of, what, ..)| *of == thing && (moves || !OF_MOTION.contains(what)));
    of_thing.map(|(_, what, ..)| format!("{thing}_{label}_{what}")).collect()
}

/// Unit, kind and meaning of a name like `wall_3_force_x`.
fn parsed(name: &str) -> Option<(&'static str, QuantityKind, &'static str)> {
    let (thing, rest) = name.split_once('_')?;
    let (label, what) = rest.split_once('_')?;
    let is_known = SIDES.contains(&label) || label.parse::<usize>().is_ok_and(|number| number > 0);
    let found = KINDS.iter().find(|(of, end, ..)| *of == thing && *end == what)?;
    is_known.then_some((found.2, found.3, found.4))
}

/// Lists of quantities by the method and the names of the scene's own.
type QuantityLists = BTreeMap<(&'static str, Vec<String>), &'static [ObservedQuantity]>;

/// Quantities of a method followed by those of a scene; none if a name is unknown. Each list is made once and kept.
fn listed(entry: &MethodEntry, names: &[String]) -> Option<&'static [ObservedQuantity]> {
    static LISTS: Mutex<QuantityLists> = Mutex::new(BTreeMap::new());
    if names.is_empty() {
        return Some(entry.quantities);
    }
    let mut lists = LISTS.lock().unwrap_or_else(PoisonError::into_inner);
    let key = (entry.vocabulary.keys.method, names.to_vec());
    if let Some(list) = lists.get(&key) {
        return Some(list);
    }
    let own: Option<Vec<ObservedQuantity>> = names
        .iter()
        .map(|name| {
            let (unit, kind, doc) = parsed(name)?;
            Some(ObservedQuantity { name: String::leak(name.clone()), unit, kind, doc })
        })
        .collect();
    let list: &[ObservedQuantity] = Vec::leak([entry.quantities, &own?].concat());
    lists.insert(key, list);
    Some(list)
}

impl MethodEntry {
    /// Quantities of a scene of this method that has some of its own.
    pub(super) fn quantities_with(&self, own: &[String]) -> &'static [ObservedQuantity] {
        listed(self, own).unwrap_or(self.quantities)
    }
}

/// Quantities whose names are the columns of a table after the step; none if no method observes them.
pub fn observed_quantities(methods: Methods, columns: &[String]) -> Option<&'static [ObservedQuantity]> {
    let columns = columns.get(1..)?;
    methods.iter().find_map(|method| {
        let (shared, own) = columns.split_at_checked(method.quantities.len())?;
        let is_its = method.quantities.iter().map(|it| it.name).eq(shared.iter().map(String::as_str));
        is_its.then(|| listed(method, own)).flatten()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::METHODS;

    /// Names of walls follow those of the method; other names belong to no method.
    #[test]
    fn columns_of_walls_are_known_by_name() {
        let method = METHODS.iter().find(|method| method.vocabulary.keys.method == "lattice-md").unwrap();
        let own = names_of("wall", "12", true);
        assert!(
            own.contains(&"wall_12_torque".to_owned())
                && names_of("wall", "top", false)[2] == "wall_top_force_x"
        );
        let columns = |own: &[String]| -> Vec<String> {
            let all = method.quantities.iter().map(|it| it.name.to_owned());
            std::iter::once("step".to_owned()).chain(all).chain(own.iter().cloned()).collect()
        };
        let found = observed_quantities(METHODS, &columns(&own)).unwrap();
        assert_eq!(found.len(), method.quantities.len() + 9);
        assert!(found.last().unwrap().unit == "length/time");
        assert!(std::ptr::eq(found, method.quantities_with(&own)));
        for wrong in ["wall_0_torque", "wall_1_weight", "wall_torque", "gate_1_torque"] {
            assert_eq!(observed_quantities(METHODS, &columns(&[wrong.to_owned()])), None, "{wrong}");
        }
        assert_eq!(observed_quantities(METHODS, &columns(&[])), Some(method.quantities));
    }
}
