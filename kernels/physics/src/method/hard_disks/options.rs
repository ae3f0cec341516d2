//! Words of this method's keys.

use crate::words::define_words;

define_words! {
    /// Engine that finds the events.
    pub enum EngineChoice {
        /// The fastest engine that fits the scene.
        Auto = "auto",
        /// A neighbour list for each disc.
        Fast = "fast",
        /// Masks over the exclusive grid, as in ISO99.
        Reference = "reference",
        /// Linked cells with crossing events, the rival of ISO99.
        CellCrossing = "cell-crossing",
    }
}
