//! Rounds over everything that is measured: as many as are asked for, or as there is time for.

use std::time::{Duration, Instant};

/// How many rounds.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    /// The largest number of rounds; one is made in any case.
    pub most: usize,
    /// None is begun that would end later, as long as those before it took; unbounded without.
    pub within: Option<Duration>,
}

impl Bound {
    /// A fixed number of rounds, without a limit of time.
    pub fn of(most: usize) -> Bound {
        Bound { most, within: None }
    }

    /// The clock starts.
    pub fn begin(self) -> Rounds {
        Rounds { bound: self, begun: 0, start: Instant::now() }
    }
}

/// Rounds under way.
pub struct Rounds {
    bound: Bound,
    begun: usize,
    start: Instant,
}

impl Rounds {
    /// The share that is done once such a share of the round is: by their number or by the time, of which the sooner ends them.
    pub fn share(&self, of_round: f64) -> f64 {
        let by_number = (self.begun.saturating_sub(1) as f64 + of_round) / self.bound.most.max(1) as f64;
        let by_time = self.bound.within.map_or(0.0, |within| {
            self.start.elapsed().as_secs_f64() / within.as_secs_f64().max(f64::MIN_POSITIVE)
        });
        by_number.max(by_time).min(1.0)
    }

    fn is_time(&self) -> bool {
        let each = self.start.elapsed() / self.begun.max(1) as u32;
        self.begun == 0 || self.bound.within.is_none_or(|within| self.start.elapsed() + each <= within)
    }
}

impl Iterator for Rounds {
    type Item = usize;

    /// The number of the next round.
    fn next(&mut self) -> Option<usize> {
        let more = self.begun < self.bound.most.max(1) && self.is_time();
        more.then(|| {
            self.begun += 1;
            self.begun - 1
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_end_with_their_number_or_with_the_time() {
        assert_eq!(Bound::of(3).begin().collect::<Vec<_>>(), [0, 1, 2]);
        // One is made in any case.
        assert_eq!(Bound::of(0).begin().count(), 1);
        let late = Bound { most: 1000, within: Some(Duration::ZERO) };
        assert_eq!(late.begin().count(), 1);
        let soon = Bound { most: 1000, within: Some(Duration::from_millis(60)) };
        let each = |_| std::thread::sleep(Duration::from_millis(20));
        assert!((1..=3).contains(&soon.begin().map(each).count()));
    }

    #[test]
    fn the_share_that_is_done_follows_whichever_ends_them() {
        let mut rounds = Bound::of(4).begin();
        assert_eq!(rounds.share(0.0), 0.0);
        assert_eq!((rounds.next(), rounds.next()), (Some(0), Some(1)));
        assert_eq!(rounds.share(0.5), 0.375);
        let mut late = Bound { most: 4, within: Some(Duration::from_nanos(1)) }.begin();
        late.next();
        assert_eq!(late.share(0.0), 1.0);
    }
}
