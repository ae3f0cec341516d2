//! Failures of hard discs, in words.

use super::engine::EngineError;
use crate::method::{Clock, Culprit, Failure, FailureKind};
use crate::particles::Particles;
use stripmine_kernels::flight::Disc;
use stripmine_kernels::isa::ProgramError;

/// A disc, as a failure names it.
pub(super) fn culprit(number: u32, disc: &Disc, particles: &Particles, places: &[usize]) -> Culprit {
    let Disc { position, velocity, .. } = *disc;
    Culprit::in_plane("disc", particles.all()[places[number as usize]].id, position, velocity)
}

/// What an engine says, for the reader: with names of discs, and what to do.
pub(super) fn failure(
    why: EngineError,
    disc: &dyn Fn(u32) -> Disc,
    particles: &Particles,
    places: &[usize],
    clock: Clock,
) -> Failure {
    let named = |number: u32| culprit(number, &disc(number), particles, places);
    match why {
        EngineError::SharedCell(pair) => {
            let [a, b] = pair.map(named);
            let message =
                format!("{a} and {b} have their centres in one cell of the exclusive grid: they overlap");
            let remedy = "this must not happen between hard discs: report it with the scene";
            Failure::new(FailureKind::CONFLICT, message, remedy).at(clock).of(2, [a, b])
        }
        EngineError::Crowded(disc, most) => {
            let who = named(disc);
            let message = format!("{who} has more than {most} others around it, and a list holds no more");
            let remedy = "set machine.engine = \"reference\", or take radii that differ less";
            Failure::new(FailureKind::CONFLICT, message, remedy).at(clock).of(1, [who])
        }
        EngineError::TooHigh(disc, entries) => {
            let who = named(disc);
            let message = format!(
                "{who} is so high that the source's look-up of cells takes {entries} entries: they grow with the height"
            );
            let remedy = "set machine.engine = \"fast\", whose memory grows with the discs only";
            Failure::new(FailureKind::CONFLICT, message, remedy).at(clock).of(1, [who])
        }
        EngineError::NoInstructions(set) => ProgramError::NoSuchInstructionSet(set.name()).into(),
        EngineError::BackInTime(disc, time, now) => {
            let who = named(disc);
            let message = format!("the next event of {who} is at {time:?}, before the last one at {now:?}");
            let remedy = "this must not happen: a mask missed a partner; report it with the scene";
            let failure = Failure::new(super::BACK_IN_TIME, message, remedy).at(clock).of(1, [who]);
            failure.with([("time", time), ("now", now)])
        }
    }
}
