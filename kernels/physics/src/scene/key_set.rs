//! The keys of a method's scenes.

use super::keys::{Key, Use};

/// The sections, in the order in which they are written, with what they hold.
pub const SECTIONS: [(&str, &str); 9] = [
    ("domain", "the box and the gravity in it"),
    ("particles", "the particles at the start, generated or read"),
    ("law", "what particles do to each other"),
    ("method", "the method"),
    ("search", "how pairs are found; no choice changes the physics"),
    ("integrator", "how motion follows from forces"),
    ("machine", "how the arithmetic is done; no choice but the precision changes the physics"),
    ("run", "how long, and how often something is written"),
    ("output", "which files are written"),
];

/// Keys of which at most one may be given.
#[derive(Debug)]
pub struct Rivals {
    /// The keys.
    pub keys: &'static [&'static Key],
    /// Where they are rivals.
    pub used: Use,
    /// Whether one must be given.
    pub needed: bool,
}

/// The keys of a method's scenes.
#[derive(Clone, Copy, Debug)]
pub struct KeySet {
    /// The value of `method.kind`.
    pub method: &'static str,
    /// Groups of keys; within a section they are written in this order.
    pub groups: &'static [&'static [&'static Key]],
    /// Keys that exclude each other.
    pub rivals: &'static [&'static [Rivals]],
    /// Keys that the method does not have though one may look for them, as `section.key`, each with what to do.
    pub advice: &'static [(&'static str, &'static str)],
}

impl KeySet {
    /// Every key.
    pub fn keys(&self) -> impl Iterator<Item = &'static Key> + use<> {
        self.groups.iter().flat_map(|group| group.iter().copied())
    }

    /// The keys of a section; the section without a name is the top of the file.
    pub fn section(&self, section: &str) -> impl Iterator<Item = &'static Key> {
        self.keys().filter(move |key| key.section == section)
    }

    /// The key of a section and a name.
    pub fn key(&self, section: &str, name: &str) -> Option<&'static Key> {
        self.keys().find(|key| key.section == section && key.name == name)
    }
}
