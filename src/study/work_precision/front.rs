//! Pareto front: runs for which no other is both cheaper and more accurate.

/// Indices of the points (cost, error) on the front, by rising cost.
pub(crate) fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let ((x, error), (y, other)) = (points[a], points[b]);
        x.total_cmp(&y).then(error.total_cmp(&other))
    });
    let mut least = f64::INFINITY;
    order.retain(|&place| {
        let error = points[place].1;
        let is_on = error < least;
        least = least.min(error);
        is_on
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn front_points_are_not_dominated() {
        let points = [(1.0, 1.0), (2.0, 0.1), (3.0, 0.2), (2.0, 0.05), (4.0, 0.01), (0.5, f64::NAN)];
        assert_eq!(front(&points), [0, 3, 4]);
        assert!(front(&[]).is_empty());
    }
}
