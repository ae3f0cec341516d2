//! Configuration of the search for events: the engine with its cells.

use super::engine::EventEngine;
use super::event::Arena;
use super::fast::Fast;
use super::reference;
use super::reference::linked_cells::CellCounts;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::flight::FlyingDisc;
use stripmine_kernels::mask::Mask;

/// Configuration of the search for events.
#[derive(Clone, Debug)]
pub(super) enum EngineConfiguration {
    Fast(InstructionSet),
    Reference(Mask),
    CellCrossing(CellCounts),
}

impl EngineConfiguration {
    /// Creates the engine of discs at a time.
    pub(super) fn engine(&self, arena: Arena, discs: Vec<FlyingDisc>, time: f64) -> Box<dyn EventEngine> {
        match self {
            EngineConfiguration::Fast(set) => Box::new(Fast::new(arena, discs, *set, time)),
            EngineConfiguration::Reference(mask) => reference::engine(arena, discs, mask, time),
            EngineConfiguration::CellCrossing(counts) => {
                reference::cell_crossing_engine(arena, discs, *counts, time)
            }
        }
    }
}
