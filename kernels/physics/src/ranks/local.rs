//! Ranks as threads of this process.

use super::{Gone, Parcel, Ranks};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

/// How often it is looked for a message before the thread goes to sleep: to be woken takes longer than most messages do.
const LOOKS: u32 = 20_000;

/// A rank with a way from and to each other one.
pub struct Local {
    rank: usize,
    to: Vec<Sender<Parcel>>,
    from: Vec<Receiver<Parcel>>,
    looks: u32,
}

/// As many ranks, each to be given to a thread of its own, which has `threads` threads.
pub fn ranks(count: usize, threads: usize) -> Vec<Local> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    // Where others need the core it is better to sleep.
    let looks = if count * threads <= cores { LOOKS } else { 1 };
    let mut ranks: Vec<Local> =
        (0..count).map(|rank| Local { rank, to: vec![], from: vec![], looks }).collect();
    for from in 0..count {
        for to in 0..count {
            let (sender, receiver) = channel();
            ranks[from].to.push(sender);
            ranks[to].from.push(receiver);
        }
    }
    ranks
}

impl Local {
    fn send(&self, to: usize, parcel: Parcel) -> Result<(), Gone> {
        self.to[to].send(parcel).map_err(|_| Gone(to))
    }

    fn receive(&self, from: usize) -> Result<Parcel, Gone> {
        for _ in 0..self.looks {
            match self.from[from].try_recv() {
                Ok(parcel) => return Ok(parcel),
                Err(TryRecvError::Empty) => std::hint::spin_loop(),
                Err(TryRecvError::Disconnected) => return Err(Gone(from)),
            }
        }
        self.from[from].recv().map_err(|_| Gone(from))
    }
}

impl Ranks for Local {
    fn rank(&self) -> usize {
        self.rank
    }

    fn count(&self) -> usize {
        self.to.len()
    }

    fn halo(&self, [down, up]: [Parcel; 2], meanwhile: &mut dyn FnMut()) -> Result<[Parcel; 2], Gone> {
        let count = self.count();
        let [below, above] = [(self.rank + count - 1) % count, (self.rank + 1) % count];
        self.send(below, down)?;
        self.send(above, up)?;
        meanwhile();
        // Of two ranks both messages come from the same one, in the order in which it sent them: down first.
        let from_above = self.receive(above)?;
        let from_below = self.receive(below)?;
        Ok([from_below, from_above])
    }

    fn migrate(&self, to: Vec<Parcel>) -> Result<Vec<Parcel>, Gone> {
        to.into_iter().enumerate().try_for_each(|(rank, parcel)| self.send(rank, parcel))?;
        (0..self.count()).map(|rank| self.receive(rank)).collect()
    }

    fn gather(&self, own: Parcel) -> Result<Vec<Parcel>, Gone> {
        self.send(0, own)?;
        if self.rank > 0 { Ok(vec![]) } else { (0..self.count()).map(|rank| self.receive(rank)).collect() }
    }

    fn tell(&self, said: Option<Parcel>) -> Result<Parcel, Gone> {
        let Some(said) = said else { return self.receive(0) };
        (1..self.count()).try_for_each(|rank| self.send(rank, said.clone()))?;
        Ok(said)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parcel(words: &[usize]) -> Parcel {
        Parcel(words.iter().map(|&word| word as u64).collect())
    }

    /// What is sent arrives, at whom and from whom it should, for one rank and for many.
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
                        assert_eq!(ranks.tell(said).unwrap(), parcel(&[42]));
                    });
                }
            });
        }
    }

    /// Who waits for a rank that has ended is told, and does not wait for ever.
    #[test]
    fn a_rank_that_has_ended_is_named() {
        let mut all = ranks(3, 1);
        drop(all.remove(1));
        assert_eq!(all[0].migrate(vec![Parcel::new(); 3]), Err(Gone(1)));
    }
}
