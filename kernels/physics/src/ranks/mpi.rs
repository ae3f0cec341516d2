//! Ranks as processes started by `mpiexec`.
//!
//! Messages go from process to process, with a tag for each kind and direction: of two ranks in a ring each is below and above the other. Sums use
//! no reduction of MPI, because its order depends on the number of ranks.

use super::{Parcel, RankError, Ranks};
use mpi::environment::Universe;
use mpi::point_to_point::MatchedReceiveVec;
use mpi::request::{WaitGuard, scope};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Destination, Source};
use std::thread;
use std::time::Duration;

/// Tags of messages, by kind and direction.
const DOWN: i32 = 1;
const UP: i32 = 2;
const MIGRATING: i32 = 3;
const GATHERED: i32 = 4;
const BROADCASTING: i32 = 5;
/// Size of a piece of a message (bytes): MPI counts with 31 bits.
const PIECE: usize = 1 << 30;
/// Number of polls for a message before the process yields its core, and before it sleeps.
const POLLS_BUSY: u32 = 2000;
const POLLS_YIELDING: u32 = 200_000;
const MOMENT: Duration = Duration::from_millis(1);

/// Handle of MPI's environment; no message is sent after it is dropped.
pub struct MpiSession(Universe);

impl MpiSession {
    /// Joins the processes started by `mpiexec`; none if that was done already.
    pub fn begin() -> Option<MpiSession> {
        mpi::initialize().map(MpiSession)
    }

    /// Number of processes.
    pub fn count(&self) -> usize {
        self.0.world().size() as usize
    }
}

/// Ends all processes at once, with an exit code.
pub fn abort(code: u8) -> ! {
    MpiRank::all().abort(code.into())
}

/// Rank of this process among all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MpiRank;

/// Rank of this process, as a [`RankBackend`](super::RankBackend) needs it.
pub fn world() -> Box<dyn Ranks> {
    Box::new(MpiRank)
}

impl MpiRank {
    fn all() -> SimpleCommunicator {
        SimpleCommunicator::world()
    }

    /// Sends a message, and returns once the parcel may be dropped.
    fn send(to: usize, parcel: &Parcel, tag: i32) {
        let all = MpiRank::all();
        pieces(parcel).for_each(|piece| all.process_at_rank(to as i32).send_with_tag(piece, tag));
    }

    fn receive(from: usize, tag: i32) -> Parcel {
        let mut bytes = MpiRank::receive_piece(from, tag);
        let mut last = bytes.len();
        while last == PIECE {
            let piece = MpiRank::receive_piece(from, tag);
            last = piece.len();
            bytes.extend(piece);
        }
        Parcel(bytes)
    }

    fn receive_piece(from: usize, tag: i32) -> Vec<u8> {
        let (all, mut looks) = (MpiRank::all(), 0_u32);
        let from = all.process_at_rank(from as i32);
        loop {
            if let Some(there) = from.immediate_matched_probe_with_tag(tag) {
                return there.matched_receive_vec().0;
            }
            looks = looks.saturating_add(1);
            // Other ranks need this core if there are more ranks than cores; MPI's own waiting would keep it.
            if looks > POLLS_YIELDING {
                thread::sleep(MOMENT);
            } else if looks > POLLS_BUSY {
                thread::yield_now();
            }
        }
    }
}

/// Pieces of a message; only the last one is shorter than the others.
fn pieces(Parcel(bytes): &Parcel) -> impl Iterator<Item = &[u8]> {
    (0..=bytes.len() / PIECE).map(|piece| &bytes[piece * PIECE..bytes.len().min((piece + 1) * PIECE)])
}

impl Ranks for MpiRank {
    fn rank(&self) -> usize {
        MpiRank::all().rank() as usize
    }

    fn count(&self) -> usize {
        MpiRank::all().size() as usize
    }

    fn halo(&self, [down, up]: [Parcel; 2], meanwhile: &mut dyn FnMut()) -> Result<[Parcel; 2], RankError> {
        let (all, [below, above]) = (MpiRank::all(), self.neighbours());
        let [to_below, to_above] = [below, above].map(|rank| all.process_at_rank(rank as i32));
        Ok(scope(|scope| {
            let down = pieces(&down).map(|piece| (to_below, piece, DOWN));
            let up = pieces(&up).map(|piece| (to_above, piece, UP));
            let sent = down
                .chain(up)
                .map(|(to, piece, tag)| WaitGuard::from(to.immediate_send_with_tag(scope, piece, tag)));
            let _sent: Vec<_> = sent.collect();
            meanwhile();
            [MpiRank::receive(below, UP), MpiRank::receive(above, DOWN)]
        }))
    }

    fn migrate(&self, mut to: Vec<Parcel>) -> Result<Vec<Parcel>, RankError> {
        let (all, rank) = (MpiRank::all(), self.rank());
        let own = std::mem::take(&mut to[rank]);
        Ok(scope(|scope| {
            let others = to.iter().enumerate().filter(|(other, _)| *other != rank);
            let sent = others.flat_map(|(other, parcel)| pieces(parcel).map(move |piece| (other, piece)));
            let sent = sent.map(|(other, piece)| {
                let other = all.process_at_rank(other as i32);
                WaitGuard::from(other.immediate_send_with_tag(scope, piece, MIGRATING))
            });
            let _sent: Vec<_> = sent.collect();
            let from = (0..to.len())
                .map(|other| if other == rank { own.clone() } else { MpiRank::receive(other, MIGRATING) });
            from.collect()
        }))
    }

    fn gather(&self, own: Parcel) -> Result<Vec<Parcel>, RankError> {
        // Gathers along a binary tree: each rank appends the parcels of the next ranks to its own, and sends all of them on in the order of ranks.
        let (rank, count) = (self.rank(), self.count());
        let mut parcels = vec![own];
        let mut apart = 1;
        while apart < count {
            if rank % (2 * apart) == apart {
                MpiRank::send(rank - apart, &Parcel::of(&parcels), GATHERED);
                return Ok(vec![]);
            }
            let next = rank + apart;
            if next < count {
                let packed = MpiRank::receive(next, GATHERED).open::<Vec<Parcel>>(next);
                // Every loss is reported to the first rank.
                let lost = |lost| vec![Parcel::lost(lost); apart.min(count - next)];
                parcels.extend(packed.unwrap_or_else(lost));
            }
            apart *= 2;
        }
        Ok(parcels)
    }

    fn broadcast(&self, said: Option<Parcel>) -> Result<Parcel, RankError> {
        // Broadcasts along a binary tree: each rank that has the message sends it half-way to the next rank that has it.
        let (rank, count) = (self.rank(), self.count());
        let mut apart = count.next_power_of_two();
        let mut known = said;
        while apart > 1 {
            let half = apart / 2;
            match &known {
                Some(parcel) if rank % apart == 0 && rank + half < count => {
                    MpiRank::send(rank + half, parcel, BROADCASTING);
                }
                None if rank % apart == half => known = Some(MpiRank::receive(rank - half, BROADCASTING)),
                _ => {}
            }
            apart = half;
        }
        known.ok_or(RankError::Ended(0))
    }
}
