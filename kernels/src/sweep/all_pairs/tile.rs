//! Evaluation of a band of rows in registers.

use super::{BodyColumns, is_split};
use crate::backend::{GROUP, Precision, RegisterTask, Registers};
use crate::isa::{Element, Vector};
use crate::law::{Env, Law, LawTable, ParticleField, ParticleSum, StatedEnv};
use crate::sweep::lookup::rows_in_registers;
use std::array::from_fn;
use std::cell::Cell;
use std::ops::Range;

/// Own bodies that share the same partners: as many as leave registers for everything else.
const OWN: usize = 4;

/// Groups of partners after which own sums leave the registers: the terms are then not much smaller than the sum, so that few
/// digits are lost.
const SPELL: usize = 64;

/// A band of rows.
pub(super) struct BandRows<'a, P, L, const SUMS: usize> {
    pub(super) law: &'a L,
    pub(super) bodies: &'a BodyColumns<'a, P>,
    /// Rows.
    pub(super) groups: Range<usize>,
    /// Sums of all bodies from the first row's on.
    pub(super) sums: [&'a mut [P]; SUMS],
    pub(super) observed: bool,
    /// Energy and virial.
    pub(super) energy: &'a mut [f64; 2],
    /// Called before each group; true stops the sweep.
    pub(super) interrupted: &'a (dyn Fn() -> bool + Sync),
    /// True if it was interrupted.
    pub(super) is_stopped: &'a mut bool,
}

/// Task that evaluates a band of rows. If `EXACT`, own sums are kept in 16 lanes.
pub(super) struct Tile<'a, P, L, const SUMS: usize, const EXACT: bool>(pub(super) BandRows<'a, P, L, SUMS>);

/// Sums of a body.
type BodySums<V, const SUMS: usize> = [Cell<V>; SUMS];

/// A register of partners.
#[derive(Clone, Copy)]
struct PartnerBodies<V> {
    position: [V; 3],
    /// Rounding residue of the position; zero in double precision.
    rest: [V; 3],
    /// Velocity if the law reads it, else zero.
    velocity: [V; 3],
    mass: V,
}

/// Environment of a law that evaluates one register of pairs. `BOTH` is true if the pair is visited once.
struct TileEnv<'a, R: Registers, const SUMS: usize, const BOTH: bool> {
    registers: R,
    own: PartnerBodies<R::V>,
    own_sums: &'a BodySums<R::V, SUMS>,
    partner_sums: &'a BodySums<R::V, SUMS>,
    observed: bool,
    energy: &'a [Cell<R::V>; 2],
}

impl<R: Registers, const SUMS: usize, const BOTH: bool> TileEnv<'_, R, SUMS, BOTH> {
    /// A quantity of a body. Quantities that bodies do not have are zero; the sweep rejects a law that states one.
    #[inline(always)]
    fn field(&self, of: &PartnerBodies<R::V>, field: ParticleField) -> R::V {
        match field {
            ParticleField::Mass => of.mass,
            ParticleField::Velocity(axis) => of.velocity[axis as usize],
            ParticleField::Omega
            | ParticleField::Radius
            | ParticleField::InverseMass
            | ParticleField::Occupied => self.registers.splat(R::Lane::default()),
        }
    }

    #[inline(always)]
    fn add(&self, to: &Cell<R::V>, value: R::V) {
        to.set(to.get() + value);
    }
}

impl<R: Registers, const SUMS: usize, const BOTH: bool> Env<3> for &TileEnv<'_, R, SUMS, BOTH> {
    type V = R::V;
    type Partner = PartnerBodies<R::V>;
    const BOTH_PARTNERS: bool = BOTH;

    #[inline(always)]
    fn own_position(self) -> [R::V; 3] {
        self.own.position
    }
    #[inline(always)]
    fn own(self, field: ParticleField) -> R::V {
        self.field(&self.own, field)
    }
    #[inline(always)]
    fn displacement(self, own: [R::V; 3], there: PartnerBodies<R::V>) -> [R::V; 3] {
        from_fn(|axis| {
            let far = own[axis] - there.position[axis];
            if const { is_split::<R::Lane>() } { far + (self.own.rest[axis] - there.rest[axis]) } else { far }
        })
    }
    #[inline(always)]
    fn partner(self, field: ParticleField, there: PartnerBodies<R::V>) -> R::V {
        self.field(&there, field)
    }
    #[inline(always)]
    fn uniform(self, value: f64) -> R::V {
        self.registers.splat(R::Lane::from_f64(value))
    }
    #[inline(always)]
    fn lookup<const N: usize>(self, table: &LawTable, columns: [usize; N], number: R::V) -> [R::V; N] {
        rows_in_registers(self.registers, table, columns, number)
    }
    #[inline(always)]
    fn none(self, predicate: <R::V as Vector>::Predicate) -> bool {
        self.registers.none(predicate)
    }
    #[inline(always)]
    fn own_add(self, sum: ParticleSum, value: R::V) {
        self.add(&self.own_sums[sum.column::<3>()], value);
    }
    #[inline(always)]
    fn partner_sub(self, sum: ParticleSum, _: PartnerBodies<R::V>, value: R::V) {
        let to = &self.partner_sums[sum.column::<3>()];
        to.set(to.get() - value);
    }
    #[inline(always)]
    fn add_product(self, sum: ParticleSum, _: PartnerBodies<R::V>, a: R::V, b: R::V) {
        let to = &self.own_sums[sum.column::<3>()];
        to.set(a.times_plus(b, to.get()));
        if BOTH {
            let to = &self.partner_sums[sum.column::<3>()];
            to.set(a.times_from(b, to.get()));
        }
    }
    #[inline(always)]
    fn watches(self) -> bool {
        false
    }
    #[inline(always)]
    fn watch(self, _: R::V) {}
    #[inline(always)]
    fn counts_dissipation(self) -> bool {
        false
    }
    #[inline(always)]
    fn dissipate(self, _: R::V) {}
    #[inline(always)]
    fn observes_energy(self) -> bool {
        self.observed
    }
    #[inline(always)]
    fn energy(self, energy: R::V) {
        self.add(&self.energy[0], energy);
    }
    #[inline(always)]
    fn virial(self, virial: R::V) {
        self.add(&self.energy[1], virial);
    }
    #[inline(always)]
    fn section(self, _: &'static str) {}
}

impl<P: Precision, L: Law<3>, const SUMS: usize, const EXACT: bool> RegisterTask<P>
    for Tile<'_, P, L, SUMS, EXACT>
{
    #[inline(always)]
    fn on<R: Registers<Lane = P>>(mut self, registers: R) {
        for group in self.0.groups.clone() {
            if (self.0.interrupted)() {
                *self.0.is_stopped = true;
                return;
            }
            for first in (0..GROUP).step_by(OWN) {
                self.row(registers, group, first);
            }
        }
    }
}

impl<P: Precision, L: Law<3>, const SUMS: usize, const EXACT: bool> Tile<'_, P, L, SUMS, EXACT> {
    /// Pairs `OWN` bodies of a group, from its `first` on, with those of the group and all behind it.
    #[inline(always)]
    fn row<R: Registers<Lane = P>>(&mut self, registers: R, group: usize, first: usize) {
        let BandRows { law, bodies, groups, sums, observed, energy: total, .. } = &mut self.0;
        let (law, bodies, observed) = (*law, *bodies, *observed);
        let (start, behind) = (group * GROUP, bodies.mass.len());
        // Sums of lane l of part p are those of logical lane p · LANES + l. Parts share their sums where bits may depend on the
        // registers.
        let kept = const { if EXACT { GROUP / R::LANES } else { 1 } };
        let zero = registers.splat(P::default());
        let own_sums: [[BodySums<R::V, SUMS>; GROUP]; OWN] =
            from_fn(|_| from_fn(|_| from_fn(|_| Cell::new(zero))));
        let energies: [[BodySums<R::V, 2>; GROUP]; 1] = [from_fn(|_| from_fn(|_| Cell::new(zero)))];
        let nothing: BodySums<R::V, SUMS> = from_fn(|_| Cell::new(zero));
        let own: [PartnerBodies<R::V>; OWN] = from_fn(|n| Self::own(registers, bodies, start + first + n));
        for part in 0..GROUP / R::LANES {
            let at = start + part * R::LANES;
            // SAFETY: the group's entries exist, and a part is one register of them.
            let partner = unsafe { Self::partner(registers, bodies, at) };
            for (n, own) in own.into_iter().enumerate() {
                let (own, partner) =
                    without_self_force(registers, own, partner, (start + first + n).wrapping_sub(at));
                let own_sums = &own_sums[n][part % kept];
                let meeting = TileEnv::<R, SUMS, false> {
                    registers,
                    own,
                    own_sums,
                    partner_sums: &nothing,
                    observed,
                    energy: &energies[0][part % kept],
                };
                evaluate_pair(law, &meeting, partner);
            }
        }
        let base = groups.start * GROUP;
        let mut at = start + GROUP;
        let (mut spelled, mut spelled_energies) = ([[0.0; SUMS]; OWN], [[0.0; 2]]);
        let mut left = SPELL;
        while at < behind {
            if left == 0 {
                flush_sums(registers, &own_sums, kept, &mut spelled);
                if observed {
                    flush_sums(registers, &energies, kept, &mut spelled_energies);
                }
                left = SPELL;
            }
            left -= 1;
            for part in 0..GROUP / R::LANES {
                let at = at + part * R::LANES;
                // SAFETY: whole groups exist (checked by AllPairs::sweep), and a part is one register of one.
                let partner = unsafe { Self::partner(registers, bodies, at) };
                // SAFETY: sums have an entry for every body from `base` on.
                let to: [*mut P; SUMS] = from_fn(|sum| unsafe { sums[sum].as_mut_ptr().add(at - base) });
                let partner_sums: BodySums<R::V, SUMS> = from_fn(|_| Cell::new(zero));
                for (n, own) in own.into_iter().enumerate() {
                    let own_sums = &own_sums[n][part % kept];
                    let partner_sums = &partner_sums;
                    let meeting = TileEnv::<R, SUMS, true> {
                        registers,
                        own,
                        own_sums,
                        partner_sums,
                        observed,
                        energy: &energies[0][part % kept],
                    };
                    evaluate_pair(law, &meeting, partner);
                }
                for sum in 0..SUMS {
                    // SAFETY: `to` points at sums of whole groups, of which a part is one register.
                    unsafe { registers.store(to[sum], registers.load(to[sum]) + partner_sums[sum].get()) };
                }
            }
            at += GROUP;
        }
        flush_sums(registers, &own_sums, kept, &mut spelled);
        for (n, spelled) in spelled.iter().enumerate() {
            for (sums, spelled) in sums.iter_mut().zip(spelled) {
                let to = &mut sums[start + first + n - base];
                *to = P::from_f64(to.to_f64() + spelled);
            }
        }
        if observed {
            flush_sums(registers, &energies, kept, &mut spelled_energies);
            total.iter_mut().zip(spelled_energies[0]).for_each(|(to, spelled)| *to += spelled);
        }
    }

    /// Broadcasts a body to every lane.
    #[inline(always)]
    fn own<R: Registers<Lane = P>>(
        registers: R,
        bodies: &BodyColumns<'_, P>,
        body: usize,
    ) -> PartnerBodies<R::V> {
        Self::body(registers, bodies, |column| registers.splat(column[body]))
    }

    /// Loads a register of bodies from `at` on.
    ///
    /// # Safety
    /// The bodies exist.
    #[inline(always)]
    unsafe fn partner<R: Registers<Lane = P>>(
        registers: R,
        bodies: &BodyColumns<'_, P>,
        at: usize,
    ) -> PartnerBodies<R::V> {
        // SAFETY: the caller promises the bodies, and all columns that the law reads have as many entries (checked by
        // AllPairs::sweep).
        Self::body(registers, bodies, |column| unsafe { registers.load(column.as_ptr().add(at)) })
    }

    /// Reads the quantities that the law uses, with `of` applied to each column.
    #[inline(always)]
    fn body<R: Registers<Lane = P>>(
        registers: R,
        bodies: &BodyColumns<'_, P>,
        of: impl Fn(&[P]) -> R::V,
    ) -> PartnerBodies<R::V> {
        let velocity = match const { reads_velocity(L::FIELDS) } {
            true => bodies.velocity.map(&of),
            false => [registers.splat(P::default()); 3],
        };
        let rest = match const { is_split::<P>() } {
            true => bodies.rest.map(&of),
            false => [registers.splat(P::default()); 3],
        };
        PartnerBodies { position: bodies.position.map(&of), rest, velocity, mass: of(bodies.mass) }
    }
}

/// True if a law that states these fields reads velocities.
pub(super) const fn reads_velocity(fields: &[ParticleField]) -> bool {
    let mut i = 0;
    while i < fields.len() {
        if matches!(fields[i], ParticleField::Velocity(_)) {
            return true;
        }
        i += 1;
    }
    false
}

/// Evaluates the law for a register of pairs.
#[inline(always)]
fn evaluate_pair<R: Registers, L: Law<3>, const SUMS: usize, const BOTH: bool>(
    law: &L,
    meeting: &TileEnv<'_, R, SUMS, BOTH>,
    partner: PartnerBodies<R::V>,
) {
    let env = StatedEnv::new(meeting, law);
    let own = law.own(env);
    law.pair(env, partner, &own);
}

/// Removes a body's interaction with itself. In the body's own lane the partner gets no mass and distance 1, so the force is
/// zero, with or without softening, at any position.
#[inline(always)]
fn without_self_force<R: Registers>(
    registers: R,
    own: PartnerBodies<R::V>,
    partner: PartnerBodies<R::V>,
    lane: usize,
) -> (PartnerBodies<R::V>, PartnerBodies<R::V>) {
    if lane >= R::LANES {
        return (own, partner);
    }
    let mut numbers = [R::Lane::default(); GROUP];
    numbers[lane] = R::Lane::from_f64(1.0);
    // SAFETY: GROUP entries, and LANES <= GROUP.
    let one_at_own = unsafe { registers.load(numbers.as_ptr()) };
    let zero = registers.splat(R::Lane::default());
    let is_own = zero.less_than(one_at_own);
    // Both x coordinates are replaced: adding 1 to the body's own would be lost where floating-point numbers are coarser than 1.
    let along_x = |instead: R::V, of: PartnerBodies<R::V>| {
        let [x, y, z] = of.position;
        PartnerBodies { position: [R::V::select(is_own, instead, x), y, z], ..of }
    };
    let mass = R::V::select(is_own, zero, partner.mass);
    (along_x(zero, own), PartnerBodies { mass, ..along_x(one_at_own, partner) })
}

/// Adds the sums in the registers to `into` and sets them to zero.
#[inline(always)]
fn flush_sums<R: Registers, const SUMS: usize, const BODIES: usize>(
    registers: R,
    own_sums: &[[BodySums<R::V, SUMS>; GROUP]; BODIES],
    kept: usize,
    into: &mut [[f64; SUMS]; BODIES],
) {
    let zero = registers.splat(R::Lane::default());
    for (sums, into) in own_sums.iter().zip(into) {
        for (sum, into) in into.iter_mut().enumerate() {
            let mut lanes = [R::Lane::default(); GROUP];
            for (part, sums) in sums.iter().take(kept).enumerate() {
                // SAFETY: part · LANES + LANES <= GROUP.
                unsafe { registers.store(lanes.as_mut_ptr().add(part * R::LANES), sums[sum].replace(zero)) };
            }
            *into += sum_of_lanes(lanes).to_f64();
        }
    }
}

/// Sum of all lanes, by repeated halving.
#[inline(always)]
fn sum_of_lanes<P: Element>(mut lanes: [P; GROUP]) -> P {
    let mut half = GROUP / 2;
    while half > 0 {
        for lane in 0..half {
            lanes[lane] = lanes[lane] + lanes[lane + half];
        }
        half /= 2;
    }
    lanes[0]
}
