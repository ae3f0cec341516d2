//! Ranks as threads of this process.

use super::{Parcel, RankError, Ranks};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

/// Number of polls for a message before the thread sleeps; waking it takes longer than most messages.
const LOOKS: u32 = 20_000;

/// A rank with a channel from and to each other rank.
pub struct ThreadRank {
    rank: usize,
    to: Vec<Sender<Parcel>>,
    from: Vec<Receiver<Parcel>>,
    looks: u32,
}

/// Creates ranks, each for a thread of its own that has `threads` threads.
pub fn ranks(count: usize, threads: usize) -> Vec<ThreadRank> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    // Sleeping is better where other threads need the core.
    let looks = if count * threads <= cores { LOOKS } else { 1 };
    let mut ranks: Vec<ThreadRank> =
        (0..count).map(|rank| ThreadRank { rank, to: vec![], from: vec![], looks }).collect();
    for from in 0..count {
        for to in 0..count {
            let (sender, receiver) = channel();
            ranks[from].to.push(sender);
            ranks[to].from.push(receiver);
        }
    }
    ranks
}

impl ThreadRank {
    /// Sends to a rank. A rank that has ended is detected when it is received from: its last message may name another lost rank.
    fn send(&self, to: usize, parcel: Parcel) {
        #[expect(clippy::let_underscore_must_use, reason = "the receiver detects that it has ended")]
        let _ = self.to[to].send(parcel);
    }

    fn receive(&self, from: usize) -> Result<Parcel, RankError> {
        for _ in 0..self.looks {
            match self.from[from].try_recv() {
                Ok(parcel) => return Ok(parcel),
                Err(TryRecvError::Empty) => std::hint::spin_loop(),
                Err(TryRecvError::Disconnected) => return Err(RankError::Ended(from)),
            }
        }
        self.from[from].recv().map_err(|_| RankError::Ended(from))
    }
}

impl Ranks for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn count(&self) -> usize {
        self.to.len()
    }

    fn halo(&self, [down, up]: [Parcel; 2], meanwhile: &mut dyn FnMut()) -> Result<[Parcel; 2], RankError> {
        let [below, above] = self.neighbours();
        self.send(below, down);
        self.send(above, up);
        meanwhile();
        // Of two ranks both messages come from the same one, in the order of sending: down first.
        let from_above = self.receive(above)?;
        let from_below = self.receive(below)?;
        Ok([from_below, from_above])
    }

    fn migrate(&self, to: Vec<Parcel>) -> Result<Vec<Parcel>, RankError> {
        to.into_iter().enumerate().for_each(|(rank, parcel)| self.send(rank, parcel));
        (0..self.count()).map(|rank| self.receive(rank)).collect()
    }

    fn gather(&self, own: Parcel) -> Result<Vec<Parcel>, RankError> {
        self.send(0, own);
        if self.rank > 0 { Ok(vec![]) } else { (0..self.count()).map(|rank| self.receive(rank)).collect() }
    }

    fn broadcast(&self, said: Option<Parcel>) -> Result<Parcel, RankError> {
        let Some(said) = said else { return self.receive(0) };
        (1..self.count()).for_each(|rank| self.send(rank, said.clone()));
        Ok(said)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parcel(words: &[usize]) -> Parcel {
        Parcel::of(words)
    }

    /// Messages arrive from and at the right ranks, for one rank and for many.
    #[test]
    fn messages_go_where_they_should() {
        for count in [1, 2, 3, 8] {
            thread::scope(|scope| {
                for ranks in ranks(count, 1) {
                    scope.spawn(move || {
                        let own = ranks.rank();
                        let halo = ranks.halo([parcel(&[own, 0]), parcel(&[own, 1])], &mut || {}).unwrap();
                        let [below, above] = [(own + count - 1) % count, (own + 1) % count];
                        assert_eq!(halo, [parcel(&[below, 1]), parcel(&[above, 0])]);
                        let to = (0..count).map(|to| parcel(&[own, to])).collect();
                        let from: Vec<Parcel> = (0..count).map(|from| parcel(&[from, own])).collect();
                        assert_eq!(ranks.migrate(to).unwrap(), from);
                        let gathered = ranks.gather(parcel(&[own])).unwrap();
                        let all: Vec<Parcel> = (0..count).map(|rank| parcel(&[rank])).collect();
                        assert_eq!(gathered, if own == 0 { all } else { vec![] });
                        let said = (own == 0).then(|| parcel(&[42]));
                        assert_eq!(ranks.broadcast(said).unwrap(), parcel(&[42]));
                    });
                }
            });
        }
    }

    /// Messages of each kind come from the right ranks unchanged.
    #[test]
    fn messages_are_opened_by_their_ranks() {
        thread::scope(|scope| {
            for ranks in ranks(3, 1) {
                scope.spawn(move || {
                    let ranks: &dyn Ranks = &ranks;
                    let own = ranks.rank();
                    let all = ranks.gather_messages(own).unwrap();
                    assert_eq!(all, if own == 0 { vec![0, 1, 2] } else { vec![] });
                    assert_eq!(
                        ranks.broadcast_message((own == 0).then(|| "go on".to_owned())).unwrap(),
                        "go on"
                    );
                    // The second rank sends a message that is not a number.
                    let sent = if own == 1 { Parcel(vec![7]) } else { Parcel::of(&own) };
                    let all = ranks.gather(sent).unwrap();
                    let opened: Vec<_> =
                        all.iter().enumerate().map(|(rank, it)| it.open::<usize>(rank)).collect();
                    let expected = [Ok(0), Err(RankError::Unreadable(1)), Ok(2)];
                    assert_eq!(opened, if own == 0 { expected.to_vec() } else { vec![] });
                });
            }
        });
    }

    /// Receiving from a rank that has ended is an error that names it; the others receive their messages.
    #[test]
    fn ended_ranks_are_named() {
        let mut all = ranks(3, 1);
        drop(all.remove(1));
        let ended = Err(RankError::Ended(1));
        assert_eq!(all[0].migrate(vec![Parcel::default(); 3]), ended);
        assert_eq!(all[1].receive(0), Ok(Parcel::default()));
        assert_eq!(all[0].broadcast(Some(parcel(&[42]))), Ok(parcel(&[42])));
        assert_eq!(all[1].broadcast(None), Ok(parcel(&[42])));
        all[1].gather(parcel(&[7])).unwrap();
        assert_eq!(all[0].gather(parcel(&[])), ended);
    }

    /// Messages of a rank arrive after its end: its last one may name another lost rank.
    #[test]
    fn last_messages_of_a_rank_arrive() {
        let mut all = ranks(2, 1);
        let last = all.remove(1);
        [7, 8].into_iter().for_each(|word| last.send(0, parcel(&[word])));
        drop(last);
        let halo = || all[0].halo([parcel(&[]), parcel(&[])], &mut || {});
        assert_eq!(halo(), Ok([parcel(&[8]), parcel(&[7])]));
        assert_eq!(halo(), Err(RankError::Ended(1)));
    }
}
