//! Rows of `events.csv`, one per collision.

use super::engine::{EventPartner, ExecutedEvent};
use super::event::Arena;
use std::fmt::Write;
use stripmine_kernels::flight::FlyingDisc;

/// Columns. `partner` is an id or the name of a side. `x` and `y` are the point of contact. The impulse is that given to `disc`; a side
/// gives one only across itself. Free times are counted from the previous event of either disc, or from the start.
pub(super) const COLUMNS: &str =
    "event,time,disc,partner,x,y,impulse_x,impulse_y,free_time,partner_free_time";

/// Rows that have not been taken yet.
#[derive(Debug, Default)]
pub(super) struct Log(String);

impl Log {
    /// Adds an event with number `event`; `disc` returns discs in their state after it.
    pub(super) fn add<'d>(
        &mut self,
        event: u64,
        happened: &ExecutedEvent,
        arena: &Arena,
        disc: &dyn Fn(u32) -> &'d FlyingDisc,
        id: &dyn Fn(u32) -> u32,
    ) {
        let ExecutedEvent { time, disc: number, with, impact, thrust, free, .. } = *happened;
        let own = disc(number);
        let (partner, towards, impulse) = match with {
            EventPartner::Disc(other) => {
                let whole = arena.domain.displacement(own.position, disc(other).position);
                let share = own.radius / (own.radius + disc(other).radius);
                let impulse = impact.map_or([0.0; 2], |impact| impact.impulse);
                (id(other).to_string(), whole.map(|d| share * d), impulse)
            }
            EventPartner::Wall(axis) => {
                let axis = usize::from(axis);
                let middle = arena.domain.origin[axis] + 0.5 * arena.domain.length(axis);
                let is_high = own.position[axis] > middle;
                let mut impulse = [0.0; 2];
                impulse[axis] = if is_high { -thrust } else { thrust };
                let mut towards = [0.0; 2];
                towards[axis] = if is_high { own.radius } else { -own.radius };
                let side = [["left", "right"], ["bottom", "top"]][axis][usize::from(is_high)];
                (side.to_owned(), towards, impulse)
            }
        };
        let [x, y] = [0, 1].map(|axis| own.position[axis] + towards[axis]);
        let [across, along] = impulse;
        let free = match with {
            EventPartner::Disc(_) => format!("{:?},{:?}", free[0], free[1]),
            EventPartner::Wall(_) => format!("{:?},", free[0]),
        };
        let id = id(number);
        #[expect(clippy::let_underscore_must_use, reason = "a string takes whatever is written")]
        let _ = writeln!(self.0, "{event},{time:?},{id},{partner},{x:?},{y:?},{across:?},{along:?},{free}");
    }

    /// Returns the rows since the last call.
    pub(super) fn take(&mut self) -> String {
        std::mem::take(&mut self.0)
    }
}
