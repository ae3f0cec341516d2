//! Interfaces of a law and of the environment that evaluates it.

use super::quantity::{ParticleField, ParticleSum};
use super::table::LawTable;
use crate::isa::Vector;

/// Observations made beside the sums, while the contacts are in registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ObservationRequest {
    /// List contacts deeper than this (length).
    pub watched: Option<f64>,
    /// Sum up the power that contacts dissipate.
    pub dissipation: bool,
    /// Observe pairs: sum up their energy and virial, count their contacts.
    pub energy: bool,
}

/// Coefficient of a contact that a wall may have of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WallCoefficient {
    /// Normal damping.
    NormalDamping,
    /// Tangential damping.
    ShearDamping,
    /// Friction coefficient.
    Friction,
}

/// Environment of a law: everything it may read and write.
///
/// *Own* is the particle the law is evaluated for, *partner* the other one. A law never subtracts positions itself: the
/// sweep handles images and cell-relative coordinates.
pub trait Env<const DIM: usize>: Copy {
    /// Vector of numbers.
    type V: Vector;
    /// Handle of a partner: a mask neighbour, a listed disc, a cyclic shift or loaded values; `()` if the environment knows it.
    type Partner: Copy;
    /// True if a pair is visited once, so that the law gives the partner's share with [`Env::partner_sub`].
    const BOTH_PARTNERS: bool;

    /// Own position, the argument of [`Env::displacement`].
    fn own_position(self) -> [Self::V; DIM];
    /// A quantity of the own particle.
    fn own(self, field: ParticleField) -> Self::V;
    /// `r_own − r_partner`.
    fn displacement(self, own: [Self::V; DIM], partner: Self::Partner) -> [Self::V; DIM];
    /// A quantity of the partner.
    fn partner(self, field: ParticleField, partner: Self::Partner) -> Self::V;
    /// Broadcasts a number to all pairs.
    fn uniform(self, value: f64) -> Self::V;
    /// Loads for each pair numbers of a row of a table, one of each of some columns. Rows are numbered from 1; NaN where the number is
    /// not positive. A program panics at a number beyond the last row.
    fn lookup<const N: usize>(self, table: &LawTable, columns: [usize; N], number: Self::V) -> [Self::V; N];
    /// A coefficient of the contact: that of the law, unless the partner is a wall with another.
    #[inline(always)]
    fn coefficient(self, _which: WallCoefficient, of_law: f64) -> Self::V {
        self.uniform(of_law)
    }
    /// True if the predicate is false for all pairs and this execution takes early exits.
    fn none(self, predicate: <Self::V as Vector>::Predicate) -> bool;
    /// Adds to a sum of the own particle.
    fn own_add(self, sum: ParticleSum, value: Self::V);
    /// Subtracts from a sum of the partner. Called only where [`Env::BOTH_PARTNERS`].
    fn partner_sub(self, sum: ParticleSum, partner: Self::Partner, value: Self::V);
    /// Adds `a · b` to a sum of the own particle. If the pair is visited once, subtracts it from the partner's sum.
    #[inline(always)]
    fn add_product(self, sum: ParticleSum, partner: Self::Partner, a: Self::V, b: Self::V) {
        let product = a * b;
        self.own_add(sum, product);
        if Self::BOTH_PARTNERS {
            self.partner_sub(sum, partner, product);
        }
    }
    /// True if penetrations are watched.
    fn watches(self) -> bool;
    /// Reports the penetration (length) of every pair, negative without contact. Called only where [`Env::watches`].
    fn watch(self, penetration: Self::V);
    /// True if dissipation is counted.
    fn counts_dissipation(self) -> bool;
    /// Reports the power (energy/time) that every pair turns into heat, 0 without contact. If a pair is visited from both sides,
    /// this is the own particle's share. Called only where [`Env::counts_dissipation`].
    fn dissipate(self, power: Self::V);
    /// True if energy and virial are observed.
    fn observes_energy(self) -> bool;
    /// Reports the energy that every pair stores, 0 without contact. If a pair is visited from both sides, this is the own
    /// particle's share; a fixed particle has none. Called only where [`Env::observes_energy`].
    fn energy(self, energy: Self::V);
    /// Reports the virial of every pair without a fixed particle, (r_own − r_partner)·F_own (energy), or the own particle's share
    /// as in [`Env::energy`]. Called only where [`Env::observes_energy`].
    fn virial(self, virial: Self::V);
    /// Reports the depth of every contact as a fraction of the sum of the radii: 0 without contact and for two fixed particles.
    /// Called only where [`Env::observes_energy`], by laws that have contacts.
    #[inline(always)]
    fn contact(self, _penetration: Self::V) {}
    /// Names the following operations, for the ledger and the listing.
    fn section(self, name: &'static str);
}

/// A pair law in `DIM` dimensions.
///
/// It states the quantities it reads and the sums it adds to. A sweep provides these and no more. A law that omits a field or a
/// sum is rejected ([`check`](super::check)) and cannot reach what it does not state ([`StatedEnv`](super::StatedEnv)). A law that
/// states a quantity its dimensions lack does not compile where it is used:
///
/// ```compile_fail
/// use stripmine_kernels::law::{Axis, Env, ParticleField, Law, ParticleSum, check};
///
/// #[derive(Clone)]
/// struct Lifting;
///
/// impl Law<2> for Lifting {
///     type Own<V: Copy> = ();
///     const FIELDS: &'static [ParticleField] = &[];
///     const SUMS: &'static [ParticleSum] = &[ParticleSum::Force(Axis::Z)];
///     fn own<E: Env<2>>(&self, _: E) {}
///     fn pair<E: Env<2>>(&self, _: E, _: E::Partner, _: &()) {}
/// }
///
/// check(&Lifting)?; // A disc of the plane has no force along z.
/// # Ok::<(), stripmine_kernels::isa::ProgramError>(())
/// ```
pub trait Law<const DIM: usize>: Clone {
    /// Quantities of the own particle, loaded once for all its partners.
    type Own<V: Copy>: Copy;

    /// Quantities that the law reads, besides positions.
    const FIELDS: &'static [ParticleField];
    /// Sums that the law adds to.
    const SUMS: &'static [ParticleSum];

    /// Loads the own particle.
    fn own<E: Env<DIM>>(&self, env: E) -> Self::Own<E::V>;
    /// Evaluates the interaction of the own particle and its partner, given by its handle.
    fn pair<E: Env<DIM>>(&self, env: E, partner: E::Partner, own: &Self::Own<E::V>);
}
