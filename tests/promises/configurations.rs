//! Configurations for the scenes of a method: its engines, its searches, and the choices of further keys.

use stripmine_physics::method::MethodEntry;
use stripmine_physics::scene::KeyValueKind;

/// Overrides that set a key to each of its words; the first one is empty.
pub fn words(entry: &MethodEntry, section: &str, name: &str) -> Vec<Vec<String>> {
    let words = match entry.vocabulary.keys.key(section, name).map(|key| key.kind) {
        Some(KeyValueKind::Choice(words)) => words,
        _ => &[],
    };
    let given = words.iter().filter(|word| **word != "auto");
    std::iter::once(vec![]).chain(given.map(|word| vec![format!("{section}.{name}={word}")])).collect()
}

/// Every engine with every search, then each choice of the other keys alone.
pub fn configurations(entry: &MethodEntry, others: &[(&str, &str)]) -> Vec<Vec<String>> {
    let searches = words(entry, "search", "by");
    let engines = words(entry, "machine", "engine").into_iter();
    let engines =
        engines.flat_map(|engine| searches.iter().map(move |by| [engine.clone(), by.clone()].concat()));
    let alone = others.iter().flat_map(|(section, name)| words(entry, section, name).into_iter().skip(1));
    engines.chain(alone).collect()
}
