//! Scene files: TOML descriptions of a simulation.
//!
//! A method states the keys of its scenes ([`Vocabulary`]). Each key has a name, type, range, unit, default and documentation ([`Key`]). Reading a
//! text reports all mistakes at once, each with its location ([`SceneValues`], [`SceneErrors`]). One function for each section binds its fields to its
//! keys, both for reading and for writing ([`Binding`]). This module names no method: it contains the keys that several of them share.

mod arrays;
mod binding;
mod disc_keys;
mod discs;
mod domain;
mod format_1;
mod general;
mod key_set;
pub(crate) mod keys;
mod machine;
mod overrides;
mod reading;
mod rules;
mod shared_frame;
mod speed;
mod start_file;
mod target;
mod text;
mod unknown;
mod values;
mod warning;

pub use crate::input::{
    InputError as SceneError, InputErrors as SceneErrors, MistakeKind, Spot, TextLocation,
};
pub use arrays::NumberArray;
pub use binding::{Binding, ReadBinding, Write};
pub(crate) use disc_keys::{
    CLEAR_WIDTH, FILE, FILL_HEIGHT, MASS, RADII, RADIUS, RADIUS_CUT, RADIUS_SPREAD, SPEED, WALL_AMPLITUDE,
    WALL_POSITIONS, WALL_RADIUS,
};
pub use disc_keys::{
    COUNT, DISCS, GENERATE, PACKING_FRACTION, POSITIONS, SECOND_RADIUS, SECOND_SHARE, SEED, SPACING,
    TEMPERATURE, VELOCITIES, WALL_SPACING,
};
pub use discs::{Amount, DiscStart, GeneratedDiscs, List, WallLining, WallMotion};
pub use domain::{GRAVITY, PLANAR_DOMAIN, SIDES, SceneDomain};
pub(crate) use domain::{ORIGIN, PERIODIC};
pub use general::{
    DT, DURATION, HEADING, METHOD, OUTPUT, Output, RunKeys, STEP, STEPPED_RUN, STEPS, TARGETED, THERMO_EVERY,
    TIME, UNITS, bind_heading, too_many_steps,
};
pub(crate) use general::{STRUCTURE, STRUCTURE_RANGE, SUMMED, TARGET};
pub use key_set::{ExclusiveKeys, KeySet, SECTIONS};
pub(crate) use keys::Use;
pub use keys::{Fallback, Key, KeyValue, KeyValueKind, NumberRange, TableRow};
pub(crate) use machine::{
    ARITHMETIC, INSTRUCTION_SET, INSTRUCTIONS, bind_arithmetic, bind_execution, bind_instructions,
    execution_name,
};
pub use machine::{PRECISION, Precision};
pub use overrides::Overrides;
pub use rules::{DISC_RIVALS, start_inconsistencies};
pub use speed::Speed;
pub(crate) use start_file::path_beside;
pub use start_file::{StartFile, SuppliedValues};
pub use target::{MeanTarget, Width};
pub use values::{Preset, RenamedKey, SceneValues, Vocabulary};
pub use warning::Warning;

#[cfg(test)]
mod tests;
