//! Assignment of bands to ranks, and the neighbourhood that each rank needs.

use std::ops::Range;
use stripmine_kernels::sweep::fast::{RankShare, RowLayout};

/// Number of rows that a disc may move before discs are redistributed. No bit depends on it. Pairs found beside rows reach as far as partners are
/// searched ahead.
pub(super) fn margin(rows: RowLayout) -> usize {
    rows.ahead.max(2)
}

/// Distance in rows within which discs matter to a rank: its own discs may have moved by the margin, others too, and partners are found ahead.
pub(super) fn reach(rows: RowLayout) -> usize {
    2 * margin(rows) + rows.ahead
}

/// Side of a rank on which a row lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RankSide {
    Below,
    Above,
}

/// Bands of each rank: consecutive whole bands, so that sums equal those on one rank.
#[derive(Clone, Debug)]
pub(super) struct BandLayout {
    rows: RowLayout,
    is_periodic: bool,
    bands: Vec<Range<usize>>,
    /// First band of each rank, and the end.
    first: Vec<usize>,
}

impl BandLayout {
    /// Distributes the bands so that each of `ranks` has about the same weight. A function of the weights alone.
    pub(super) fn new(rows: RowLayout, is_periodic: bool, weights: &[u64], ranks: usize) -> BandLayout {
        let bands: Vec<Range<usize>> = rows.bands().collect();
        let all: u64 = weights.iter().sum();
        let (mut first, mut before, mut band) = (vec![0], 0, 0);
        for rank in 1..ranks {
            let goal = all * rank as u64 / ranks as u64;
            // Each rank has at least one band and leaves one for each rank after it.
            let most = bands.len() - (ranks - rank);
            before += weights[band];
            band += 1;
            while band < most && before + weights[band] / 2 < goal {
                before += weights[band];
                band += 1;
            }
            first.push(band);
        }
        first.push(bands.len());
        BandLayout { rows, is_periodic, bands, first }
    }

    pub(super) fn band(&self, row: usize) -> usize {
        self.bands.partition_point(|band| band.end <= row).min(self.bands.len() - 1)
    }

    /// Rank that owns a row.
    pub(super) fn owner(&self, row: usize) -> usize {
        self.first.partition_point(|&first| first <= self.band(row)) - 1
    }

    /// Rows of a rank.
    pub(super) fn share(&self, rank: usize) -> RankShare {
        let [first, end] = [self.first[rank], self.first[rank + 1]];
        RankShare { rows: self.bands[first].start..self.bands[end - 1].end, margin: margin(self.rows) }
    }

    /// Side of a rank's rows on which a row lies; none if its discs do not matter there.
    pub(super) fn side(&self, rank: usize, row: usize) -> Option<RankSide> {
        let (rows, reach) = (self.share(rank).rows, reach(self.rows));
        if rows.contains(&row) {
            return None;
        }
        // Number of rows upwards from one to another.
        let up = |from: usize, to: usize| {
            let straight = to.checked_sub(from);
            straight.or(self.is_periodic.then(|| (to + self.rows.count).saturating_sub(from)))
        };
        let is_near = |rows: Option<usize>| rows.is_some_and(|rows| rows <= reach);
        if is_near(up(row, rows.start)) {
            Some(RankSide::Below)
        } else if is_near(up(rows.end - 1, row)) {
            Some(RankSide::Above)
        } else {
            None
        }
    }

    /// True if a disc is farther from its former row than the margin.
    pub(super) fn has_strayed(&self, from: usize, to: usize) -> bool {
        let away = from.abs_diff(to);
        let away = if self.is_periodic { away.min(self.rows.count - away) } else { away };
        away > margin(self.rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every band has one rank, every rank a band, and no rank has much more than its share.
    #[test]
    fn bands_are_distributed_by_weight() {
        let rows = RowLayout { count: 640, ahead: 2, band: 16 };
        let bands = rows.bands().len() as u64;
        for ranks in [1, 2, 3, 7, 8, 40] {
            for heap in [false, true] {
                let weights: Vec<u64> =
                    (0..bands).map(|band| if heap && band > 9 { 0 } else { 100 + band }).collect();
                let layout = BandLayout::new(rows, true, &weights, ranks);
                let shares: Vec<RankShare> = (0..ranks).map(|rank| layout.share(rank)).collect();
                assert_eq!((shares[0].rows.start, shares[ranks - 1].rows.end), (0, 640));
                assert!(shares.windows(2).all(|pair| pair[0].rows.end == pair[1].rows.start));
                assert!((0..640).all(|row| shares[layout.owner(row)].rows.contains(&row)));
                let most = shares.iter().map(|share| {
                    let there =
                        (0..bands as usize).filter(|&band| share.rows.contains(&layout.bands[band].start));
                    there.map(|band| weights[band]).sum::<u64>()
                });
                let all: u64 = weights.iter().sum();
                assert!(most.max().unwrap() <= all / ranks as u64 + 150, "{ranks} ranks, heap {heap}");
            }
        }
    }

    /// Sides form a ring if rows are periodic, and a stack if they are not.
    #[test]
    fn nearby_rows_have_one_side() {
        let rows = RowLayout { count: 64, ahead: 2, band: 16 };
        for is_periodic in [true, false] {
            let layout = BandLayout::new(rows, is_periodic, &[1; 4], 4);
            let side = |row| layout.side(0, row);
            assert_eq!((side(0), side(15)), (None, None));
            assert_eq!((side(16), side(21), side(22)), (Some(RankSide::Above), Some(RankSide::Above), None));
            let below = is_periodic.then_some(RankSide::Below);
            assert_eq!((side(63), side(58), side(57)), (below, below, None));
        }
    }
}
