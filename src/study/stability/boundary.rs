//! Where a method ceases to work: by bisection between steps of a ladder.

/// The edge of what works along the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Edge {
    /// Not even the smallest step works.
    Below,
    /// The largest step that was found to work and the smallest that was not (time), as far apart as the tolerance lets them.
    Between([f64; 2]),
    Above,
}

impl Edge {
    /// The middle of the two steps (time).
    pub(crate) fn step(self) -> Option<f64> {
        match self {
            Edge::Between([works, fails]) => Some((works * fails).sqrt()),
            Edge::Below | Edge::Above => None,
        }
    }
}

/// Finds the edge between rising steps, beginning at the place `guess` of the first that fails, until it lies within a part
/// `tolerance` of the step.
pub(crate) fn edge<E>(
    steps: &[f64],
    guess: usize,
    tolerance: f64,
    mut works: impl FnMut(f64) -> Result<bool, E>,
) -> Result<Edge, E> {
    let mut first = guess.min(steps.len());
    while first < steps.len() && works(steps[first])? {
        first += 1;
    }
    while first > 0 && !works(steps[first - 1])? {
        first -= 1;
    }
    if first == 0 {
        return Ok(Edge::Below);
    }
    if first == steps.len() {
        return Ok(Edge::Above);
    }
    let [mut low, mut high] = [steps[first - 1], steps[first]];
    while high > low * (1.0 + tolerance) {
        let middle = (low * high).sqrt();
        if works(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(Edge::Between([low, high]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn an_edge_is_found_from_every_guess() {
        let steps = [1.0, 2.0, 4.0, 8.0];
        for guess in 0..6 {
            let found =
                |limit: f64| edge(&steps, guess, 0.01, |step| Ok::<_, Infallible>(step <= limit)).unwrap();
            assert_eq!((found(0.5), found(8.0)), (Edge::Below, Edge::Above));
            for limit in [1.0, 3.3, 7.9] {
                let Edge::Between([low, high]) = found(limit) else { panic!("{guess} {limit}") };
                assert!(low <= limit && limit < high && high <= 1.01 * low, "{low} {limit} {high}");
            }
        }
    }
}
