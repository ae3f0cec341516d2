//! Messages of failures of hard discs.

use super::engine::{EngineError, FlyingDiscs};
use super::identities::DiscIdentities;
use crate::method::{Clock, Culprit, FailureKind, PhysicsFailure};
use stripmine_kernels::flight::FlyingDisc;
use stripmine_kernels::isa::ProgramError;

/// Description of a disc in a failure.
pub(super) fn culprit(number: u32, discs: &dyn FlyingDiscs, identities: &DiscIdentities) -> Culprit {
    let FlyingDisc { position, velocity, .. } = *discs.disc(number);
    Culprit::in_plane("disc", identities.id(number), position, velocity)
}

/// Converts an engine error to a failure that names the discs and the remedy.
pub(super) fn failure(
    why: EngineError,
    discs: &dyn FlyingDiscs,
    identities: &DiscIdentities,
    clock: Clock,
) -> PhysicsFailure {
    let named = |number: u32| culprit(number, discs, identities);
    match why {
        EngineError::SharedCell(pair) => {
            let [a, b] = pair.map(named);
            let message =
                format!("{a} and {b} have their centres in one cell of the exclusive grid: they overlap");
            let remedy = "this is a bug: please report it with the scene";
            PhysicsFailure::new(FailureKind::CONFLICT, message, remedy).at(clock).of(2, [a, b])
        }
        EngineError::Crowded(disc, most) => {
            let who = named(disc);
            let message = format!("{who} has more than {most} neighbours, the most that a list can hold");
            let remedy = "set machine.engine = \"reference\", or use radii that differ less";
            PhysicsFailure::new(FailureKind::CONFLICT, message, remedy).at(clock).of(1, [who])
        }
        EngineError::TooHigh(disc, entries) => {
            let who = named(disc);
            let message = format!(
                "{who} is so high above the floor that the cell look-up of the reference engine needs {entries} entries, which grow with the height"
            );
            let remedy = "set machine.engine = \"fast\", whose memory depends only on the number of discs";
            PhysicsFailure::new(FailureKind::CONFLICT, message, remedy).at(clock).of(1, [who])
        }
        EngineError::NoInstructions(set) => ProgramError::NoSuchInstructionSet(set.name()).into(),
        EngineError::BackInTime(disc, time, now) => {
            let who = named(disc);
            let message = format!("the next event of {who} is at {time:?}, before the last one at {now:?}");
            let remedy = "this is a bug, a mask missed a partner: please report it with the scene";
            let failure = PhysicsFailure::new(super::BACK_IN_TIME, message, remedy).at(clock).of(1, [who]);
            failure.with([("time", time), ("now", now)])
        }
    }
}
