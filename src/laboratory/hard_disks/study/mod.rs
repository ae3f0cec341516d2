//! Studies of hard discs.

pub(crate) mod atmosphere;
pub(crate) mod cells;
pub(crate) mod collapse;
pub(crate) mod complexity;
pub(crate) mod cooling;
pub(crate) mod crossing;
pub(crate) mod errors;
pub(crate) mod fluid;
pub(crate) mod lifetimes;
pub(crate) mod masks;
pub(crate) mod precision;
pub(crate) mod pressures;
pub(crate) mod rates;
pub(crate) mod soft_hard;
pub(crate) mod structure;
pub(crate) mod unequal;

use crate::laboratory::running::RunningScene;
use stripmine_physics::method::hard_disks::INELASTIC_COLLAPSE;
use stripmine_physics::method::{PhysicsFailure, Until};

/// Advances a gas to a moment or to its inelastic collapse; returns the collapse.
fn advance_or_collapse(gas: &mut RunningScene, end: Until) -> Result<Option<PhysicsFailure>, PhysicsFailure> {
    match gas.advance_until(end) {
        Ok(()) => Ok(None),
        Err(failure) if failure.kind == INELASTIC_COLLAPSE => Ok(Some(failure)),
        Err(failure) => Err(failure),
    }
}
