//! In which form an integrator carries the state: asked for here, and nowhere assumed.

use super::WithScheme;
use stripmine_kernels::integrator::{DERIVATIVES, Scheme};

/// In which form an integrator carries the state from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Carried {
    /// How many derivatives of a degree of freedom, the position among them.
    pub derivatives: usize,
    /// What each is multiplied by, as [`Scheme::scales`] has it.
    pub(crate) scales: [f64; DERIVATIVES],
}

/// Asks an integrator for its [`Carried`], for steps of `dt` (time).
pub(crate) struct CarriedBy {
    /// The step (time).
    pub dt: f64,
}

impl WithScheme for CarriedBy {
    type Output = Carried;

    fn with<C: Scheme>(self, _: C) -> Carried {
        Carried { derivatives: C::CARRIED, scales: C::scales(self.dt) }
    }
}
