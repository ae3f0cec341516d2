//! The words of this method's keys.

use crate::words::define_words;

define_words! {
    /// How events are found.
    pub enum EngineChoice {
        /// As is fastest.
        Auto = "auto",
        /// By lists of each disc's own.
        Fast = "fast",
        /// The source's way: masks over the exclusive grid.
        Reference = "reference",
    }
}
