//! Search for the nearest pair of bodies.

use super::bodies::StateColumns;

/// Nearest pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NearestPair {
    /// Numbers of the bodies, the smaller first.
    pub(super) bodies: [usize; 2],
    /// Distance of the bodies (length).
    pub(super) distance: f64,
    /// Position of the first body (length).
    pub(super) place: [f64; 3],
}

/// Search for the nearest pair. Bodies are sorted along the axis of their widest extent, and each is compared with the bodies behind it
/// that are closer along this axis than the nearest pair so far.
#[derive(Clone, Debug, Default)]
pub(super) struct NearestPairSearch {
    /// Last order, which is almost the next one.
    order: Vec<u32>,
}

impl NearestPairSearch {
    /// Returns the nearest pair of the first `count` bodies; none if no pair has a finite distance.
    pub(super) fn nearest(&mut self, position: &StateColumns, count: usize) -> Option<NearestPair> {
        let spread = |column: &Vec<f64>| {
            let ends = column[..count]
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)]);
            ends[1] - ends[0]
        };
        let widest = (0..3).max_by(|&a, &b| spread(&position[a]).total_cmp(&spread(&position[b])))?;
        let along = &position[widest];
        if self.order.len() != count {
            self.order = (0..count as u32).collect();
        }
        self.order.sort_unstable_by(|&a, &b| along[a as usize].total_cmp(&along[b as usize]).then(a.cmp(&b)));
        let mut nearest: Option<([u32; 2], f64)> = None;
        for (number, &body) in self.order.iter().enumerate() {
            for &other in &self.order[number + 1..] {
                let [a, b] = [body as usize, other as usize];
                if nearest.is_some_and(|(_, distance)| along[b] - along[a] >= distance) {
                    break;
                }
                let square: f64 = position.iter().map(|column| (column[a] - column[b]).powi(2)).sum();
                let distance = square.sqrt();
                if distance.is_finite() && nearest.is_none_or(|(_, least)| distance < least) {
                    nearest = Some(([body.min(other), body.max(other)], distance));
                }
            }
        }
        let (bodies, distance) = nearest?;
        let bodies = bodies.map(|body| body as usize);
        Some(NearestPair { bodies, distance, place: position.each_ref().map(|column| column[bodies[0]]) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use stripmine_kernels::noise::{RandomPurpose, Stream};

    /// Compared with all pairs, repeatedly after small moves; also for bodies on lines and planes.
    #[test]
    fn nearest_pair_matches_all_pairs() {
        let mut random = Stream::new(3, RandomPurpose::Test, 0);
        for count in [0, 1, 2, 3, 17, 200] {
            for flat in 0..4 {
                let mut encounters = NearestPairSearch::default();
                let mut position: StateColumns = std::array::from_fn(|axis| {
                    (0..count)
                        .map(|_| if axis < flat { 1.0 } else { random.random_range(-1.0..1.0) })
                        .collect()
                });
                for _ in 0..3 {
                    let found = encounters.nearest(&position, count);
                    let apart = |a: usize, b: usize| -> f64 {
                        position.iter().map(|column| (column[a] - column[b]).powi(2)).sum::<f64>().sqrt()
                    };
                    let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
                    let least = all.map(|(a, b)| apart(a, b)).min_by(f64::total_cmp);
                    assert_eq!(found.map(|found| found.distance), least);
                    if let Some(NearestPair { bodies: [a, b], distance, .. }) = found {
                        assert!(a < b && apart(a, b) == distance);
                    }
                    for x in position[2].iter_mut() {
                        *x += random.random_range(-0.1..0.1);
                    }
                }
            }
        }
    }

    #[test]
    fn nan_positions_are_ignored() {
        let position = [vec![0.0, f64::NAN, 3.0, 4.0], vec![0.0; 4], vec![0.0; 4]];
        let found = NearestPairSearch::default().nearest(&position, 4).unwrap();
        assert_eq!((found.bodies, found.distance), ([2, 3], 1.0));
    }
}
