//! Complete binary tree over the discs, in which the smaller key wins: the root holds the smallest key.

/// Tournament tree. Leaves are discs, by number.
#[derive(Clone, Debug)]
pub(crate) struct TournamentTree {
    /// Winner of each node; the root is 1, the children of k are 2k and 2k + 1. Leaves, from the number of discs on, are not stored.
    winners: Vec<u32>,
    /// Number of leaves.
    leaves: usize,
}

/// Marks a leaf without a disc.
const NONE: u32 = u32::MAX;

impl TournamentTree {
    /// Builds the tree of `count` discs with the keys `time`; ties go to the smaller number.
    pub(super) fn new(count: usize, time: impl Fn(u32) -> f64) -> TournamentTree {
        let leaves = count.max(2);
        let mut tree = TournamentTree { winners: vec![NONE; leaves], leaves };
        for node in (1..leaves).rev() {
            tree.winners[node] = tree.play(node, count, &time);
        }
        tree
    }

    /// Returns the disc with the smallest key.
    #[inline]
    pub(super) fn first(&self) -> u32 {
        self.winners[1]
    }

    /// Replays all nodes after all keys have changed.
    pub(crate) fn renew(&mut self, count: usize, time: impl Fn(u32) -> f64) {
        for node in (1..self.leaves).rev() {
            self.winners[node] = self.play(node, count, &time);
        }
    }

    /// Updates the tree after the key of a disc has changed.
    #[inline]
    pub(super) fn update(&mut self, disc: u32, count: usize, time: impl Fn(u32) -> f64) {
        let mut node = (self.leaves + disc as usize) / 2;
        while node > 0 {
            let winner = self.play(node, count, &time);
            // The nodes above are unaffected if the disc neither won before nor wins now.
            if winner == self.winners[node] && winner != disc {
                return;
            }
            self.winners[node] = winner;
            node /= 2;
        }
    }

    #[inline(always)]
    fn play(&self, node: usize, count: usize, time: &impl Fn(u32) -> f64) -> u32 {
        let entrant = |child: usize| {
            if child >= self.leaves {
                let disc = child - self.leaves;
                if disc < count { disc as u32 } else { NONE }
            } else {
                self.winners[child]
            }
        };
        let [left, right] = [entrant(2 * node), entrant(2 * node + 1)];
        match (left, right) {
            (left, NONE) => left,
            (NONE, right) => right,
            (left, right) => {
                let [ours, theirs] = [time(left), time(right)];
                if theirs < ours || theirs == ours && right < left { right } else { left }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use stripmine_kernels::noise::{RandomPurpose, Stream};

    #[test]
    fn tournament_root_holds_the_smallest_key() {
        let mut stream = Stream::new(7, RandomPurpose::Test, 0);
        for count in [1usize, 2, 3, 17, 64, 100] {
            let mut keys: Vec<f64> = (0..count).map(|_| stream.random_range(0..8) as f64).collect();
            let mut tree = TournamentTree::new(count, |disc| keys[disc as usize]);
            for _ in 0..500 {
                let smallest = (0..count).min_by(|&a, &b| keys[a].total_cmp(&keys[b])).unwrap();
                assert_eq!(tree.first() as usize, smallest, "{keys:?}");
                let changed = stream.random_range(0..count);
                keys[changed] = stream.random_range(0..8) as f64;
                tree.update(changed as u32, count, |disc| keys[disc as usize]);
            }
        }
    }
}
