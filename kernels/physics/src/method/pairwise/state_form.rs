//! Form in which an integrator carries the state: queried here, assumed nowhere.

use super::SchemeTask;
use stripmine_kernels::integrator::{DERIVATIVES, Scheme};

/// Form in which an integrator carries the state from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CarriedState {
    /// Number of derivatives of a degree of freedom, including the position.
    pub derivatives: usize,
    /// Scale factor of each derivative, as in [`Scheme::scales`].
    pub(crate) scales: [f64; DERIVATIVES],
}

/// Queries an integrator for its [`CarriedState`] form, for steps of `dt` (time).
pub(crate) struct CarriedQuery {
    /// The step (time).
    pub dt: f64,
}

impl SchemeTask for CarriedQuery {
    type Output = CarriedState;

    fn with<C: Scheme>(self, _: C) -> CarriedState {
        CarriedState { derivatives: C::CARRIED, scales: C::scales(self.dt) }
    }
}
