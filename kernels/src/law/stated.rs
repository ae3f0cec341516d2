//! Enforcement of a law's statements: it can read no other field and add to no other sum.
//!
//! A sweep checks the columns that [`Law::FIELDS`] and [`Law::SUMS`] name, and then reads and adds unchecked. So a law reaches a
//! sweep only through [`StatedEnv`], which panics at anything else. Both lists are constants and so is every field a law names: the
//! compiled check is empty.

use super::environment::{Env, Law, WallCoefficient};
use super::quantity::{ParticleField, ParticleSum};
use super::table::LawTable;
use crate::isa::{ProgramError, Vector};
use std::cell::Cell;
use std::marker::PhantomData;

/// An environment in which the law `L` can use only the quantities it states.
pub struct StatedEnv<E, L> {
    env: E,
    law: PhantomData<fn() -> L>,
}

impl<E: Copy, L> Clone for StatedEnv<E, L> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<E: Copy, L> Copy for StatedEnv<E, L> {}

impl<E, L> StatedEnv<E, L> {
    /// An environment for one law.
    #[inline(always)]
    pub fn new<const DIM: usize>(env: E, _: &L) -> Self
    where
        E: Env<DIM>,
        L: Law<DIM>,
    {
        const { assert_in_dimensions::<DIM, L>() };
        StatedEnv { env, law: PhantomData }
    }

    #[inline(always)]
    fn field<const DIM: usize>(field: ParticleField)
    where
        L: Law<DIM>,
    {
        if const { bits_of_fields(L::FIELDS) } & bit_of_field(field) == 0 {
            panic_unstated(field.name());
        }
    }

    #[inline(always)]
    fn sum<const DIM: usize>(sum: ParticleSum)
    where
        L: Law<DIM>,
    {
        if const { bits_of_sums(L::SUMS) } & bit_of_sum(sum) == 0 {
            panic_unstated(sum.name());
        }
    }
}

/// Fails to compile for a law that states a quantity its dimensions lack.
const fn assert_in_dimensions<const DIM: usize, L: Law<DIM>>() {
    let mut i = 0;
    while i < L::FIELDS.len() {
        assert!(
            L::FIELDS[i].is_in(DIM),
            "the law states a field that does not exist in its number of dimensions"
        );
        i += 1;
    }
    i = 0;
    while i < L::SUMS.len() {
        assert!(
            L::SUMS[i].is_in(DIM),
            "the law states a sum that does not exist in its number of dimensions"
        );
        i += 1;
    }
}

#[inline(always)]
const fn bit_of_field(field: ParticleField) -> u32 {
    1 << match field {
        ParticleField::Velocity(axis) => axis as u32,
        ParticleField::Omega => 3,
        ParticleField::Radius => 4,
        ParticleField::InverseMass => 5,
        ParticleField::Mass => 6,
        ParticleField::Occupied => 7,
    }
}

#[inline(always)]
const fn bit_of_sum(sum: ParticleSum) -> u32 {
    1 << match sum {
        ParticleSum::Force(axis) => axis as u32,
        ParticleSum::Torque => 3,
        ParticleSum::ForceRate(axis) => 4 + axis as u32,
    }
}

const fn bits_of_fields(fields: &[ParticleField]) -> u32 {
    let (mut bits, mut i) = (0, 0);
    while i < fields.len() {
        bits |= bit_of_field(fields[i]);
        i += 1;
    }
    bits
}

const fn bits_of_sums(sums: &[ParticleSum]) -> u32 {
    let (mut bits, mut i) = (0, 0);
    while i < sums.len() {
        bits |= bit_of_sum(sums[i]);
        i += 1;
    }
    bits
}

#[cold]
#[inline(never)]
#[expect(clippy::panic, reason = "`check` rejects a law that uses unstated quantities before it runs")]
fn panic_unstated(what: &'static str) -> ! {
    panic!("{}", ProgramError::Unstated(what))
}

impl<const DIM: usize, E: Env<DIM>, L: Law<DIM>> Env<DIM> for StatedEnv<E, L> {
    type V = E::V;
    type Partner = E::Partner;
    const BOTH_PARTNERS: bool = E::BOTH_PARTNERS;

    #[inline(always)]
    fn own_position(self) -> [E::V; DIM] {
        self.env.own_position()
    }
    #[inline(always)]
    fn own(self, field: ParticleField) -> E::V {
        Self::field::<DIM>(field);
        self.env.own(field)
    }
    #[inline(always)]
    fn displacement(self, own: [E::V; DIM], partner: E::Partner) -> [E::V; DIM] {
        self.env.displacement(own, partner)
    }
    #[inline(always)]
    fn partner(self, field: ParticleField, partner: E::Partner) -> E::V {
        Self::field::<DIM>(field);
        self.env.partner(field, partner)
    }
    #[inline(always)]
    fn uniform(self, value: f64) -> E::V {
        self.env.uniform(value)
    }
    #[inline(always)]
    fn lookup<const N: usize>(self, table: &LawTable, columns: [usize; N], number: E::V) -> [E::V; N] {
        self.env.lookup(table, columns, number)
    }
    #[inline(always)]
    fn coefficient(self, which: WallCoefficient, of_law: f64) -> E::V {
        self.env.coefficient(which, of_law)
    }
    #[inline(always)]
    fn none(self, predicate: <E::V as Vector>::Predicate) -> bool {
        self.env.none(predicate)
    }
    #[inline(always)]
    fn own_add(self, sum: ParticleSum, value: E::V) {
        Self::sum::<DIM>(sum);
        self.env.own_add(sum, value);
    }
    #[inline(always)]
    fn partner_sub(self, sum: ParticleSum, partner: E::Partner, value: E::V) {
        Self::sum::<DIM>(sum);
        self.env.partner_sub(sum, partner, value);
    }
    #[inline(always)]
    fn add_product(self, sum: ParticleSum, partner: E::Partner, a: E::V, b: E::V) {
        Self::sum::<DIM>(sum);
        self.env.add_product(sum, partner, a, b);
    }
    #[inline(always)]
    fn watches(self) -> bool {
        self.env.watches()
    }
    #[inline(always)]
    fn watch(self, penetration: E::V) {
        self.env.watch(penetration);
    }
    #[inline(always)]
    fn counts_dissipation(self) -> bool {
        self.env.counts_dissipation()
    }
    #[inline(always)]
    fn dissipate(self, power: E::V) {
        self.env.dissipate(power);
    }
    #[inline(always)]
    fn observes_energy(self) -> bool {
        self.env.observes_energy()
    }
    #[inline(always)]
    fn energy(self, energy: E::V) {
        self.env.energy(energy);
    }
    #[inline(always)]
    fn virial(self, virial: E::V) {
        self.env.virial(virial);
    }
    #[inline(always)]
    fn contact(self, penetration: E::V) {
        self.env.contact(penetration);
    }
    #[inline(always)]
    fn section(self, name: &'static str) {
        self.env.section(name);
    }
}

/// Checks on one pair that a law uses only the quantities it states.
///
/// # Errors
/// [`ProgramError::Unstated`] names the first field or sum that it does not state.
pub fn check<const DIM: usize, L: Law<DIM>>(law: &L) -> Result<(), ProgramError> {
    const { assert_in_dimensions::<DIM, L>() };
    let probe = LawProbe::default();
    let own = law.own(&probe);
    law.pair(&probe, (), &own);
    let fields = probe.fields.get() & !bits_of_fields(L::FIELDS);
    let sums = probe.sums.get() & !bits_of_sums(L::SUMS);
    let field = ParticleField::ALL.into_iter().find(|&field| fields & bit_of_field(field) != 0);
    let sum = ParticleSum::ALL.into_iter().find(|&sum| sums & bit_of_sum(sum) != 0);
    match field.map(ParticleField::name).or(sum.map(ParticleSum::name)) {
        Some(what) => Err(ProgramError::Unstated(what)),
        None => Ok(()),
    }
}

/// A pair of particles, all of whose quantities are 1, that records the law's requests.
#[derive(Default)]
struct LawProbe {
    fields: Cell<u32>,
    sums: Cell<u32>,
}

impl LawProbe {
    fn ask(&self, field: ParticleField) -> f64 {
        self.fields.set(self.fields.get() | bit_of_field(field));
        1.0
    }
    fn add(&self, sum: ParticleSum) {
        self.sums.set(self.sums.get() | bit_of_sum(sum));
    }
}

impl<const DIM: usize> Env<DIM> for &LawProbe {
    type V = f64;
    type Partner = ();
    const BOTH_PARTNERS: bool = true;

    fn own_position(self) -> [f64; DIM] {
        [0.0; DIM]
    }
    fn own(self, field: ParticleField) -> f64 {
        self.ask(field)
    }
    fn displacement(self, _: [f64; DIM], (): ()) -> [f64; DIM] {
        [1.0; DIM]
    }
    fn partner(self, field: ParticleField, (): ()) -> f64 {
        self.ask(field)
    }
    fn uniform(self, value: f64) -> f64 {
        value
    }
    fn lookup<const N: usize>(self, table: &LawTable, columns: [usize; N], number: f64) -> [f64; N] {
        table.numbers(columns, number)
    }
    fn none(self, _: bool) -> bool {
        false // No early exit: the whole law is checked.
    }
    fn own_add(self, sum: ParticleSum, _: f64) {
        self.add(sum);
    }
    fn partner_sub(self, sum: ParticleSum, (): (), _: f64) {
        self.add(sum);
    }
    fn watches(self) -> bool {
        true
    }
    fn watch(self, _: f64) {}
    fn counts_dissipation(self) -> bool {
        true
    }
    fn dissipate(self, _: f64) {}
    fn observes_energy(self) -> bool {
        true
    }
    fn energy(self, _: f64) {}
    fn virial(self, _: f64) {}
    fn section(self, _: &'static str) {}
}
