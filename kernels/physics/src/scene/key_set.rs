//! Keys of a method's scenes.

use super::keys::{Key, KeyValueKind, Use};

/// Sections in the order in which they are written, with their contents.
pub const SECTIONS: [(&str, &str); 9] = [
    ("domain", "the box and the gravity in it"),
    ("particles", "the particles at the start, generated or read"),
    ("law", "forces between particles"),
    ("method", "the method"),
    ("search", "neighbour search; no choice changes the physics"),
    ("integrator", "time integration"),
    ("machine", "execution of the arithmetic; only the precision changes the physics"),
    ("run", "duration and intervals of output"),
    ("output", "output files"),
];

/// Keys that exclude each other: at most one may be given.
#[derive(Debug)]
pub struct ExclusiveKeys {
    /// Exclusive keys.
    pub keys: &'static [&'static Key],
    /// Condition under which they exclude each other.
    pub used: Use,
    /// True if one must be given.
    pub needed: bool,
    /// Key without which they do not exclude each other: together they determine its value.
    pub with: Option<&'static Key>,
}

/// Keys of a method's scenes.
#[derive(Clone, Copy, Debug)]
pub struct KeySet {
    /// Value of `method.kind`.
    pub method: &'static str,
    /// Groups of keys; within a section they are written in this order.
    pub groups: &'static [&'static [&'static Key]],
    /// Keys that exclude each other.
    pub rivals: &'static [&'static [ExclusiveKeys]],
    /// Keys that the method lacks though a user may expect them, as `section.key`, each with advice.
    pub advice: &'static [(&'static str, &'static str)],
}

impl KeySet {
    /// All keys.
    pub fn keys(&self) -> impl Iterator<Item = &'static Key> + use<> {
        self.groups.iter().flat_map(|group| group.iter().copied())
    }

    /// All keys, those of the tables of a list after all others.
    pub fn keys_and_fields(&self) -> impl Iterator<Item = &'static Key> + use<> {
        let fields = self.keys().flat_map(|key| match key.kind {
            KeyValueKind::Tables(fields) => fields.iter().copied(),
            _ => [].iter().copied(),
        });
        self.keys().chain(fields)
    }

    /// Keys of a section; the section without a name is the head of the file.
    pub fn section(&self, section: &str) -> impl Iterator<Item = &'static Key> {
        self.keys().filter(move |key| key.section == section)
    }

    /// Key with a section and a name.
    pub fn key(&self, section: &str, name: &str) -> Option<&'static Key> {
        self.keys().find(|key| key.section == section && key.name == name)
    }
}
