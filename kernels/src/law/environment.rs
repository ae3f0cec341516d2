//! What a law is, and how it sees the particles that meet.

use super::quantity::{Field, Sum};
use crate::isa::Vector;

/// What is looked at beside the sums, while contacts are at hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Asked {
    /// Contacts deeper than this (length) are listed.
    pub watched: Option<f64>,
    /// Whether the power that contacts dissipate is summed up.
    pub dissipation: bool,
    /// Whether pairs are observed: their energy and virial are summed up, their contacts counted.
    pub energy: bool,
}

/// What a law may ask of the way particles meet.
///
/// *Own* is the particle the law is evaluated for, *partner* the one that stands at a place. A law never subtracts
/// positions itself: images and cell-relative coordinates are the sweep's business.
pub trait Env<const DIM: usize>: Copy {
    /// A vector of numbers.
    type V: Vector;
    /// Where a partner stands: a lattice offset, a gather index, a cyclic shift.
    type Place: Copy;
    /// Whether a pair is met once, so that the partner's share must be given with [`Env::partner_sub`].
    const BOTH_PARTNERS: bool;

    /// The own position, to be handed to [`Env::displacement`].
    fn own_position(self) -> [Self::V; DIM];
    /// A quantity of the own particle.
    fn own(self, field: Field) -> Self::V;
    /// `r_own − r_partner`.
    fn displacement(self, own: [Self::V; DIM], place: Self::Place) -> [Self::V; DIM];
    /// A quantity of the partner.
    fn partner(self, field: Field, place: Self::Place) -> Self::V;
    /// The same number for every pair.
    fn uniform(self, value: f64) -> Self::V;
    /// Whether no pair holds, where this execution takes early ways out.
    fn none(self, predicate: <Self::V as Vector>::Predicate) -> bool;
    /// Adds to a sum of the own particle.
    fn own_add(self, sum: Sum, value: Self::V);
    /// Subtracts from a sum of the partner. Called only where [`Env::BOTH_PARTNERS`].
    fn partner_sub(self, sum: Sum, place: Self::Place, value: Self::V);
    /// Adds `a · b` to a sum of the own particle and, where the pair is met once, subtracts it from the partner's.
    #[inline(always)]
    fn add_product(self, sum: Sum, place: Self::Place, a: Self::V, b: Self::V) {
        let product = a * b;
        self.own_add(sum, product);
        if Self::BOTH_PARTNERS {
            self.partner_sub(sum, place, product);
        }
    }
    /// Whether penetrations are watched.
    fn watches(self) -> bool;
    /// Reports the penetration (length) of every pair, negative without contact. Called only where [`Env::watches`].
    fn watch(self, penetration: Self::V);
    /// Whether dissipation is counted.
    fn counts_dissipation(self) -> bool;
    /// Reports the power (energy/time) that every pair turns into heat, 0 without contact; where a pair is met from both
    /// sides, the own particle's share. Called only where [`Env::counts_dissipation`].
    fn dissipate(self, power: Self::V);
    /// Whether energy and virial are observed.
    fn observes_energy(self) -> bool;
    /// Reports the energy that every pair stores, 0 without contact; where a pair is met from both sides, the own particle's
    /// share, of which a fixed one has none. Called only where [`Env::observes_energy`].
    fn energy(self, energy: Self::V);
    /// Reports the virial of every pair of which neither is fixed, (r_own − r_partner)·F_own (energy), or the own particle's
    /// share of it, as [`Env::energy`]. Called only where [`Env::observes_energy`].
    fn virial(self, virial: Self::V);
    /// Reports how deep every pair is in contact, as a fraction of the sum of the radii: 0 without contact, and of two fixed
    /// particles. Called only where [`Env::observes_energy`], by laws that know contacts.
    #[inline(always)]
    fn contact(self, _penetration: Self::V) {}
    /// Names what follows, for the ledger and the listing.
    fn section(self, name: &'static str);
}

/// A pair law in `DIM` dimensions.
///
/// It states what it asks for and what it gives. A sweep provides that and no more: a law that forgets a field or a sum is
/// refused ([`check`](super::check)), and could not reach what it did not state ([`Stated`](super::Stated)). One that states what its dimensions lack does
/// not compile where it is used:
///
/// ```compile_fail
/// use stripmine_kernels::law::{Axis, Env, Field, Law, Sum, check};
///
/// #[derive(Clone)]
/// struct Lifting;
///
/// impl Law<2> for Lifting {
///     type Own<V: Copy> = ();
///     const FIELDS: &'static [Field] = &[];
///     const SUMS: &'static [Sum] = &[Sum::Force(Axis::Z)];
///     fn own<E: Env<2>>(&self, _: E) {}
///     fn pair<E: Env<2>>(&self, _: E, _: E::Place, _: &()) {}
/// }
///
/// check(&Lifting)?; // A disc of the plane has no force along z.
/// # Ok::<(), stripmine_kernels::isa::ProgramError>(())
/// ```
pub trait Law<const DIM: usize>: Clone {
    /// The own particle's quantities, loaded once for all its partners.
    type Own<V: Copy>: Copy;

    /// The quantities, beside positions, that the law asks for.
    const FIELDS: &'static [Field];
    /// The sums the law contributes to.
    const SUMS: &'static [Sum];

    /// Loads the own particle.
    fn own<E: Env<DIM>>(&self, env: E) -> Self::Own<E::V>;
    /// What the own particle and its partner at `place` do to each other.
    fn pair<E: Env<DIM>>(&self, env: E, place: E::Place, own: &Self::Own<E::V>);
}
