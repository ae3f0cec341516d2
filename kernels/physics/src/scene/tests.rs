//! Tests of the keys of every method.

use super::keys::KeyValueKind::{Number, Numbers, Pair, Pairs};
use super::{Fallback, SECTIONS};
use crate::method::METHODS;

#[test]
fn keys_have_docs_and_valid_defaults() {
    for method in METHODS {
        let keys = &method.vocabulary.keys;
        for key in keys.keys() {
            assert!(key.doc.ends_with(['.', '…']) && key.doc.len() > 8, "{}", key.path());
            assert!(key.section.is_empty() || SECTIONS.iter().any(|(name, _)| *name == key.section));
            assert_eq!(keys.keys().filter(|other| other.path() == key.path()).count(), 1, "{}", key.path());
            if let Fallback::Is(text) = key.fallback {
                let value = toml::de::DeValue::parse(text).unwrap();
                let Ok(value) = key.kind.read(&value) else { panic!("default of {}", key.path()) };
                assert_eq!(value.to_toml(), text, "{}", key.path());
            }
        }
    }
}

/// Every dimensional key has a unit.
#[test]
fn dimensional_keys_have_units() {
    let pure = [
        "count",
        "packing_fraction",
        "radius_spread",
        "radius_cut",
        "second_share",
        "friction",
        "max_penetration",
        "stop_penetration",
        "restitution",
        "wall_restitution",
        "virial",
        "eccentricity",
        "mass_ratio",
        "damping",
        "structure_share",
        "screening",
        "discs_in_cell",
        "tolerance",
    ];
    for key in METHODS.iter().flat_map(|method| method.vocabulary.keys.keys()) {
        let measures = matches!(key.kind, Number(_) | Pair(_) | Pairs | Numbers(_));
        assert_eq!(measures && !pure.contains(&key.name), measures && !key.unit.is_empty(), "{}", key.path());
    }
}
