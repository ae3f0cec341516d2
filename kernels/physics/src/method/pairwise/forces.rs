//! Pair forces of a law in double precision, for structure analysis.

use super::LawTask;
use crate::structure::PairForces;
use std::sync::Arc;
use stripmine_kernels::law::Law;
use stripmine_kernels::sweep::pair::Pair;

/// Builds pair forces of a law up to a distance (length).
pub(crate) struct PairForcesTask(pub f64);

impl LawTask for PairForcesTask {
    type Output = PairForces;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> PairForces {
        let of = move |pair: &Pair| {
            let [[x, y, _], _] = pair.sums(&law);
            [x, y]
        };
        PairForces { reach: self.0, of: Arc::new(of) }
    }
}
