//! Studies of hard discs, each a file.

pub mod atmosphere;
pub mod collapse;
pub mod complexity;
pub mod cooling;
pub mod fluid;
pub mod masks;
pub mod precision;
pub mod rates;
pub mod soft_hard;
pub mod structure;

use crate::laboratory::running::Running;
use stripmine_physics::method::hard_disks::INELASTIC_COLLAPSE;
use stripmine_physics::method::{Failure, Until};

/// Follows a gas to a moment, or to its inelastic collapse.
fn followed(gas: &mut Running, end: Until) -> Result<Option<Failure>, Failure> {
    match gas.until(end) {
        Ok(()) => Ok(None),
        Err(failure) if failure.kind == INELASTIC_COLLAPSE => Ok(Some(failure)),
        Err(failure) => Err(failure),
    }
}
