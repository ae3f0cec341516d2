//! Evaluation of a law for the pairs found, one register of pairs at a time.
//!
//! ```text
//! pairs      (3,7) (3,9) (5,8) (6,8)            as many as a register has lanes
//! gather     own     x: x[3] x[3] x[5] x[6]     one load per lane; the law names the columns
//!            partner x: x[7] x[9] x[8] x[8]
//! law        one evaluation for all lanes       -> forces on own and on partner
//! add        F[3] += lane 0, F[7] -= lane 0,    lane after lane, own before partner
//!            F[3] += lane 1, F[9] -= lane 1, ...
//! ```
//!
//! Reasons:
//!
//! - *Gathers are one load per lane*, because no portable SIMD has an instruction for them.
//! - *Sums are added lane after lane*: two lanes may add to one disc, such as 3 and 8 above, and the order of summation must not
//!   depend on the number of lanes.
//! - *The last register is padded with a pair of sentinels*, two discs behind the others that never touch. So the law needs no
//!   second version for partial registers.
//! - *Reads are not bounds-checked.* Columns are checked once a sweep, pairs are of discs by the [`Finder`](super::Finder)'s
//!   contract, and a law can read only the columns it states ([`StatedEnv`]).

use super::pairs::{DiscPair, PairSequence, SENTINELS};
use crate::backend::{GROUP, RegisterTask};
use crate::backend::{Precision, Registers};
use crate::isa::{Element, Vector};
use crate::law::{Env, Law, ObservationRequest, ParticleField, ParticleSum, StatedEnv};
use std::cell::Cell;
use std::mem::MaybeUninit;

/// Quantities of the discs as a fast sweep reads them: one entry per disc and [`SENTINELS`] more. Columns that the law does not
/// read may be empty.
#[derive(Clone, Copy, Debug)]
pub struct DiscColumns<'a, S> {
    /// Positions relative to the centres of the cells (length).
    pub position: [&'a [S]; 2],
    /// Velocities, in any unit of time.
    pub velocity: [&'a [S]; 2],
    /// Angular velocities, in the same unit.
    pub omega: &'a [S],
    /// One over that unit.
    pub per_time: f64,
    /// Radii.
    pub radius: &'a [S],
    /// Inverse masses.
    pub inverse_mass: &'a [S],
}

impl<'a, S: Element> DiscColumns<'a, S> {
    #[inline(always)]
    fn column(&self, field: ParticleField) -> &'a [S] {
        match field {
            ParticleField::Velocity(axis) => self.velocity[axis as usize],
            ParticleField::Omega => self.omega,
            ParticleField::Radius => self.radius,
            ParticleField::InverseMass => self.inverse_mass,
            ParticleField::Mass | ParticleField::Occupied => &[],
        }
    }

    /// True if every column that a law reads has an entry for every disc and sentinel.
    #[inline]
    pub(super) fn has_all_entries(&self, fields: &[ParticleField], discs: usize) -> bool {
        let columns = fields.iter().map(|&field| self.column(field)).chain(self.position);
        columns.into_iter().all(|column| column.len() == discs + SENTINELS)
    }
}

/// Columns of the sums; no other thread touches the elements that this thread does.
#[derive(Clone, Copy, Debug)]
pub(super) struct SumColumns<P>(pub(super) [*mut P; 3]);

// SAFETY: a sweep gives each thread bands of rows, and in each stage no disc belongs to the rows or partners of two bands: what
// one thread adds to, no other touches.
unsafe impl<P: Send> Send for SumColumns<P> {}
// SAFETY: a shared reference only copies the pointers; the argument above covers their use.
unsafe impl<P: Send> Sync for SumColumns<P> {}

/// Observations of a band beside the sums.
#[derive(Clone, Debug, Default)]
pub(super) struct BandNotes {
    /// Pairs deeper than the watched depth.
    pub(super) deep: Vec<DiscPair>,
    /// Pairs whose force is not finite.
    pub(super) not_finite: Vec<DiscPair>,
    /// Power dissipated by the contacts (energy/time).
    pub(super) dissipated: f64,
    /// Energy and virial of the pairs (energy).
    pub(super) energy: [f64; 2],
    /// Contacts, and the deepest of them (a fraction of the sum of the radii).
    pub(super) contacts: u64,
    pub(super) deepest: f64,
}

impl BandNotes {
    /// Resets everything and keeps the allocated memory.
    pub(super) fn clear(&mut self) {
        let (mut deep, mut not_finite) =
            (std::mem::take(&mut self.deep), std::mem::take(&mut self.not_finite));
        deep.clear();
        not_finite.clear();
        *self = BandNotes { deep, not_finite, ..BandNotes::default() };
    }
}

/// Task that evaluates the law for pairs.
pub(super) struct Evaluate<'a, S, P, L, Q> {
    pub(super) law: &'a L,
    pub(super) pairs: &'a Q,
    pub(super) sentinel: u32,
    pub(super) discs: &'a DiscColumns<'a, S>,
    pub(super) sums: SumColumns<P>,
    pub(super) asked: ObservationRequest,
    pub(super) notes: &'a mut BandNotes,
}

/// As many entries as the widest register has lanes.
type LaneArray<T> = [T; GROUP];

/// Environment of a law that evaluates one register of pairs.
struct GatherEnv<'a, R: Registers, S> {
    registers: R,
    discs: &'a DiscColumns<'a, S>,
    own: &'a LaneArray<u32>,
    partner: &'a LaneArray<u32>,
    cell_offset: [R::V; 2],
    asked: ObservationRequest,
    penetration: Cell<R::V>,
    power: Cell<R::V>,
    /// Energy and virial.
    energy: [Cell<R::V>; 2],
    contact: Cell<R::V>,
    own_sums: [Cell<R::V>; 3],
    partner_sums: [Cell<R::V>; 3],
}

impl<R: Registers, S: Element> GatherEnv<'_, R, S> {
    #[inline(always)]
    fn gather(&self, column: &[S], discs: &LaneArray<u32>) -> R::V {
        assemble(self.registers, |lane| {
            // SAFETY: the positions and the columns of the fields that the law states have an entry for every disc and for the
            // sentinels (checked by Sweep); `StatedEnv` rejects reads of other columns. Pairs are of discs (Finder's contract), and
            // lanes without a pair have the sentinels.
            R::Lane::from_f64(unsafe { column.get_unchecked(discs[lane] as usize) }.to_f64())
        })
    }

    #[inline(always)]
    fn field(&self, field: ParticleField, discs: &LaneArray<u32>) -> R::V {
        let value = self.gather(self.discs.column(field), discs);
        match field {
            ParticleField::Velocity(_) | ParticleField::Omega => value * self.uniform(self.discs.per_time),
            ParticleField::Radius
            | ParticleField::InverseMass
            | ParticleField::Mass
            | ParticleField::Occupied => value,
        }
    }
}

#[inline(always)]
fn assemble<R: Registers>(registers: R, number: impl Fn(usize) -> R::Lane) -> R::V {
    let mut lanes = MaybeUninit::<LaneArray<R::Lane>>::uninit();
    let first = lanes.as_mut_ptr().cast::<R::Lane>();
    for lane in 0..R::LANES {
        // SAFETY: lane < LANES <= GROUP, the capacity of `lanes`.
        unsafe { first.add(lane).write(number(lane)) };
    }
    // SAFETY: the loop has written the first LANES entries.
    unsafe { registers.load(first) }
}

#[inline(always)]
fn spill<R: Registers>(registers: R, value: R::V) -> LaneArray<R::Lane> {
    let mut lanes = [R::Lane::default(); GROUP];
    // SAFETY: `lanes` has GROUP entries, and LANES <= GROUP.
    unsafe { registers.store(lanes.as_mut_ptr(), value) };
    lanes
}

impl<R: Registers, S: Element> Env<2> for &GatherEnv<'_, R, S> {
    type V = R::V;
    type Partner = ();
    const BOTH_PARTNERS: bool = true;

    #[inline(always)]
    fn own_position(self) -> [R::V; 2] {
        [self.gather(self.discs.position[0], self.own), self.gather(self.discs.position[1], self.own)]
    }
    #[inline(always)]
    fn own(self, field: ParticleField) -> R::V {
        self.field(field, self.own)
    }
    #[inline(always)]
    fn displacement(self, own: [R::V; 2], (): ()) -> [R::V; 2] {
        let x = (own[0] - self.gather(self.discs.position[0], self.partner)) - self.cell_offset[0];
        let y = (own[1] - self.gather(self.discs.position[1], self.partner)) - self.cell_offset[1];
        [x, y]
    }
    #[inline(always)]
    fn partner(self, field: ParticleField, (): ()) -> R::V {
        self.field(field, self.partner)
    }
    #[inline(always)]
    fn uniform(self, value: f64) -> R::V {
        self.registers.splat(R::Lane::from_f64(value))
    }
    #[inline(always)]
    fn none(self, _: <R::V as Vector>::Predicate) -> bool {
        false // A branch does not pay: nearly all candidates are contacts.
    }
    #[inline(always)]
    fn own_add(self, sum: ParticleSum, value: R::V) {
        self.own_sums[sum.column::<2>()].set(value);
    }
    #[inline(always)]
    fn partner_sub(self, sum: ParticleSum, (): (), value: R::V) {
        self.partner_sums[sum.column::<2>()].set(value);
    }
    #[inline(always)]
    fn watches(self) -> bool {
        self.asked.watched.is_some()
    }
    #[inline(always)]
    fn watch(self, penetration: R::V) {
        self.penetration.set(penetration);
    }
    #[inline(always)]
    fn counts_dissipation(self) -> bool {
        self.asked.dissipation
    }
    #[inline(always)]
    fn dissipate(self, power: R::V) {
        self.power.set(power);
    }
    #[inline(always)]
    fn observes_energy(self) -> bool {
        self.asked.energy
    }
    #[inline(always)]
    fn energy(self, energy: R::V) {
        self.energy[0].set(energy);
    }
    #[inline(always)]
    fn virial(self, virial: R::V) {
        self.energy[1].set(virial);
    }
    #[inline(always)]
    fn contact(self, penetration: R::V) {
        self.contact.set(penetration);
    }
    #[inline(always)]
    fn section(self, _: &'static str) {}
}

impl<S: Element, P: Precision, L: Law<2>, Q: PairSequence<P>> RegisterTask<P> for Evaluate<'_, S, P, L, Q> {
    #[inline(always)]
    fn on<R: Registers<Lane = P>>(self, registers: R) {
        const { assert!(R::LANES <= GROUP) }
        let mut notes = std::mem::take(self.notes);
        let mut first = 0;
        while first < self.pairs.count() {
            self.evaluate_register::<R>(registers, first, &mut notes);
            first += R::LANES;
        }
        *self.notes = notes;
    }
}

impl<S: Element, P: Precision, L: Law<2>, Q: PairSequence<P>> Evaluate<'_, S, P, L, Q> {
    #[allow(clippy::needless_range_loop, reason = "several columns share one index")]
    #[inline(always)]
    fn evaluate_register<R: Registers<Lane = P>>(&self, registers: R, first: usize, notes: &mut BandNotes) {
        let count = (self.pairs.count() - first).min(R::LANES);
        let mut own = [self.sentinel; GROUP];
        let mut partner = [self.sentinel + 1; GROUP];
        let mut cell_offsets = [[P::default(); GROUP]; 2];
        // Nearly all registers are full: the compiler unrolls a loop over all lanes.
        for lane in 0..R::LANES {
            if lane == count {
                break;
            }
            ([own[lane], partner[lane]], [cell_offsets[0][lane], cell_offsets[1][lane]]) =
                self.pairs.pair(first + lane);
        }
        let zero = || Cell::new(registers.splat(P::default()));
        // SAFETY: each array has GROUP entries, and LANES <= GROUP.
        let cell_offset =
            unsafe { [registers.load(cell_offsets[0].as_ptr()), registers.load(cell_offsets[1].as_ptr())] };
        let gathered = GatherEnv {
            registers,
            discs: self.discs,
            own: &own,
            partner: &partner,
            cell_offset,
            asked: self.asked,
            penetration: zero(),
            power: zero(),
            energy: [zero(), zero()],
            contact: zero(),
            own_sums: [zero(), zero(), zero()],
            partner_sums: [zero(), zero(), zero()],
        };
        // Only through `StatedEnv`, which makes the unchecked reads of columns sound for any law.
        let env = StatedEnv::new(&gathered, self.law);
        let disc = self.law.own(env);
        self.law.pair(env, (), &disc);

        let (mut own_sums, mut partner_sums) = ([[P::default(); GROUP]; 3], [[P::default(); GROUP]; 3]);
        let mut magnitude = registers.splat(P::default());
        for sum in L::SUMS {
            let sum = sum.column::<2>();
            let value = gathered.own_sums[sum].get();
            magnitude = magnitude + value.abs();
            own_sums[sum] = spill(registers, value);
            partner_sums[sum] = spill(registers, gathered.partner_sums[sum].get());
        }
        // One contact after the other, own before partner: the order of summation does not depend on the register width.
        for lane in 0..R::LANES {
            if lane == count {
                break;
            }
            for sum in L::SUMS {
                let sum = sum.column::<2>();
                // SAFETY: Sweep has checked that the column of every sum that L states has an entry for every disc, and a
                // finder's pairs are of discs; no other thread adds to discs of the rows that this one sweeps.
                unsafe {
                    let to = &mut *self.sums.0[sum].add(own[lane] as usize);
                    *to = *to + own_sums[sum][lane];
                }
            }
            for sum in L::SUMS {
                let sum = sum.column::<2>();
                // SAFETY: the partner is a disc too, in these rows or those ahead of them, to which no other thread adds at this
                // stage; the reference to the own disc's sum has ended.
                unsafe {
                    let to = &mut *self.sums.0[sum].add(partner[lane] as usize);
                    *to = *to - partner_sums[sum][lane];
                }
            }
        }
        // Pair by pair. Two touching fixed discs have no effective mass; any other pair without a finite force is listed below.
        if self.asked.dissipation {
            add(&spill(registers, gathered.power.get()), count, &mut notes.dissipated);
        }
        if self.asked.energy {
            let [energy, virial] = &mut notes.energy;
            add(&spill(registers, gathered.energy[0].get()), count, energy);
            add(&spill(registers, gathered.energy[1].get()), count, virial);
            let contact = gathered.contact.get();
            // Sentinels never touch, so padding adds no contact.
            let there = registers.bits(registers.splat(P::default()).less_than(contact));
            if there != 0 {
                notes.contacts += u64::from(there.count_ones());
                notes.deepest = deepest(&spill(registers, contact), count, notes.deepest);
            }
        }
        if let Some(depth) = self.asked.watched {
            let depth = registers.splat(P::from_f64(depth));
            let bits = registers.bits(depth.less_than(gathered.penetration.get()));
            if bits != 0 {
                list_pairs(bits, count, [&own, &partner], &mut notes.deep);
            }
        }
        let finite = registers.bits(magnitude.less_than(registers.splat(P::from_f64(f64::INFINITY))));
        if finite.trailing_ones() < R::LANES as u32 {
            list_pairs(!finite, count, [&own, &partner], &mut notes.not_finite);
        }
    }
}

/// Adds the finite values one after the other.
fn add<P: Element>(values: &LaneArray<P>, count: usize, to: &mut f64) {
    let values = values.iter().take(count).map(|value| value.to_f64());
    values.filter(|value| value.is_finite()).for_each(|value| *to += value);
}

/// Maximum of the values and of the one before.
fn deepest<P: Element>(values: &LaneArray<P>, count: usize, before: f64) -> f64 {
    values.iter().take(count).map(|depth| depth.to_f64()).fold(before, f64::max)
}

/// Lists the pairs whose bits are set.
fn list_pairs(bits: u64, count: usize, [own, partner]: [&LaneArray<u32>; 2], to: &mut Vec<DiscPair>) {
    to.extend((0..count).filter(|lane| bits >> lane & 1 == 1).map(|lane| [own[lane], partner[lane]]));
}
