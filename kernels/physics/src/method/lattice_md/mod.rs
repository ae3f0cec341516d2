//! Lattice molecular dynamics of granular discs, BP93: every step is a sequence of vector programs over the discs and over a lattice with at most one
//! disc a cell. The alternative that BP93 compares with, scalar neighbour lists, uses the same state and the same law.
//!
//! Step discs one by one:
//!
//! ```
//! use stripmine_physics::method::lattice_md::{GranularDocument, assemble};
//!
//! let checked = GranularDocument::load("two-discs", &["machine.engine=programs".to_owned()])?.check()?;
//! let mut grains = assemble(&checked)?;
//! grains.step()?;
//! assert_eq!(grains.particles().len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arrays;
mod assemble;
mod balance;
mod benches;
mod check;
mod checks;
mod choice;
mod contacts;
mod document;
mod encounter;
mod entry;
mod facts;
mod fast;
mod flux;
mod grains;
mod hard;
pub mod keys;
mod lattice_walls;
pub mod memory;
mod model;
mod neighbor_list;
pub mod options;
mod prepared;
mod presets;
mod programs;
mod quantities;
mod run_monitor;
mod running;
pub mod scene;
mod simulation;
mod step_checks;
mod theory;
mod totals;
mod trials;
mod wall_checks;
pub mod wall_keys;
mod wall_law;
mod wall_sums;
mod walls;

pub use crate::method::pairwise::search::OnConflict;
pub use crate::method::pairwise::{HaloTraffic, Phase, PlaneMotion, PlaneWall, PlaneWalls, Timings};
pub use arrays::{Lengths, ProgramArrays};
pub use assemble::{assemble, assemble_following_energy, model};
pub use balance::EnergyBalance;
pub use check::{CheckedGranularScene, Geometry, MotionEstimates};
pub use contacts::{ContactSearch, ProgramExecution};
pub use document::GranularDocument;
pub use entry::ENTRY;
pub use fast::FastSearch;
pub use grains::SteppedGrains;
pub(crate) use model::OnLongStep;
pub use model::{ContactWatch, DiscUniformity, GearValues, GranularModel, GranularScheme};
pub use neighbor_list::{ListOptions, Rebuild};
pub use options::ProgramVersion;
pub use programs::{Part, StepProgram, execute, ledger, neighbour_list_ledger, programs};
pub use scene::{GranularScene, Inertia};
pub use totals::{GranularTotals, TotalEntry};
