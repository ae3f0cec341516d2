//! Stability boundary of a method along the step, by bisection between steps of a ladder.

/// Stability boundary along the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StepBoundary {
    /// Even the smallest step fails.
    Below,
    /// Largest working step and smallest failing step found (time), within the tolerance of each other.
    Between([f64; 2]),
    Above,
}

impl StepBoundary {
    /// Geometric mean of the two steps (time).
    pub(crate) fn step(self) -> Option<f64> {
        match self {
            StepBoundary::Between([works, fails]) => Some((works * fails).sqrt()),
            StepBoundary::Below | StepBoundary::Above => None,
        }
    }
}

/// Finds the boundary between rising steps to within a part `tolerance` of the step. The search begins at index `guess`, the expected first
/// failing step.
pub(crate) fn find_boundary<E>(
    steps: &[f64],
    guess: usize,
    tolerance: f64,
    mut works: impl FnMut(f64) -> Result<bool, E>,
) -> Result<StepBoundary, E> {
    let mut first = guess.min(steps.len());
    while first < steps.len() && works(steps[first])? {
        first += 1;
    }
    while first > 0 && !works(steps[first - 1])? {
        first -= 1;
    }
    if first == 0 {
        return Ok(StepBoundary::Below);
    }
    if first == steps.len() {
        return Ok(StepBoundary::Above);
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
    Ok(StepBoundary::Between([low, high]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn boundary_is_found_from_every_guess() {
        let steps = [1.0, 2.0, 4.0, 8.0];
        for guess in 0..6 {
            let found = |limit: f64| {
                find_boundary(&steps, guess, 0.01, |step| Ok::<_, Infallible>(step <= limit)).unwrap()
            };
            assert_eq!((found(0.5), found(8.0)), (StepBoundary::Below, StepBoundary::Above));
            for limit in [1.0, 3.3, 7.9] {
                let StepBoundary::Between([low, high]) = found(limit) else { panic!("{guess} {limit}") };
                assert!(low <= limit && limit < high && high <= 1.01 * low, "{low} {limit} {high}");
            }
        }
    }
}
