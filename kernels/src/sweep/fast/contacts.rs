//! Evaluation of a law for the pairs found, one register of pairs at a time.
//!
//! ```text
//! pairs      (3,7) (3,9) (5,8) (6,8)            as many as a register has lanes
//! gather     own     x: x[3] x[3] x[5] x[6]     records of the discs, transposed
//!            partner x: x[7] x[9] x[8] x[8]
//! law        one evaluation for all lanes       -> forces on own and on partner
//! add        F[3] += lane 0, F[7] -= lane 0,    lane after lane, own before partner
//!            F[3] += lane 1, F[9] -= lane 1, ...
//! ```
//!
//! Reasons:
//!
//! - *Blocks of records are loaded and transposed* (`records.rs`): a load for two numbers, or four in single precision. A processor's
//!   gather instruction is slower than that.
//! - *Sums are added lane after lane*: two lanes may add to one disc, such as 3 and 8 above, and the order of summation must not
//!   depend on the number of lanes.
//! - *The last register is padded with a pair of sentinels*, two discs behind the others that never touch. So the law needs no
//!   second version for partial registers.
//! - *Reads are not bounds-checked.* Records are checked once a sweep, pairs are of discs by the [`Finder`](super::Finder)'s
//!   contract, and a law can read only the entries it states ([`StatedEnv`]).

use super::pairs::{DiscPair, PairSequence};
use super::records::{ENTRIES, MOST_BLOCKS, RecordEntry, StateRecords};
use crate::backend::{GROUP, QUAD, RecordPlaces, RegisterTask, block, registers_of};
use crate::backend::{Precision, Registers};
use crate::isa::{Element, Vector, is_same_storage};
use crate::law::{Env, Law, LawTable, ObservationRequest, ParticleField, ParticleSum, StatedEnv};
use crate::sweep::lookup::rows_in_registers;
use std::cell::Cell;
use std::marker::PhantomData;

/// Sums of all discs; no other thread touches those that this thread does.
#[derive(Clone, Copy, Debug)]
pub(super) struct SumPointer<P>(pub(super) *mut P);

// SAFETY: a sweep gives each thread bands of rows, and in each stage no disc belongs to the rows or partners of two bands: what
// one thread adds to, no other touches.
unsafe impl<P: Send> Send for SumPointer<P> {}
// SAFETY: a shared reference only copies the pointer; the argument above covers its use.
unsafe impl<P: Send> Sync for SumPointer<P> {}

/// Columns of the blocks that a law reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct StatePointers<'a, S> {
    blocks: [*const S; MOST_BLOCKS],
    per_time: f64,
    records: PhantomData<&'a StateRecords<S>>,
}

impl<'a, S: Element> StatePointers<'a, S> {
    /// # Panics
    /// If the records do not have these entries.
    #[inline]
    pub(super) fn new<L: Law<2>>(records: &'a StateRecords<S>) -> Self {
        let blocks = records.blocks(const { entries_read(L::FIELDS) });
        StatePointers { blocks, per_time: records.per_time(), records: PhantomData }
    }
}

// SAFETY: the pointers are to numbers that are borrowed as shared for as long.
unsafe impl<S: Sync> Send for StatePointers<'_, S> {}
// SAFETY: as above.
unsafe impl<S: Sync> Sync for StatePointers<'_, S> {}

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

/// Task that evaluates the law for pairs. There is a record for every disc and sentinel, with the entries that the law states.
pub(super) struct Evaluate<'a, S, P, L, Q> {
    pub(super) law: &'a L,
    pub(super) pairs: &'a Q,
    pub(super) sentinel: u32,
    pub(super) state: StatePointers<'a, S>,
    pub(super) sums: SumPointer<P>,
    pub(super) asked: ObservationRequest,
    pub(super) notes: &'a mut BandNotes,
}

/// As many entries as the widest register has lanes.
type LaneArray<T> = [T; GROUP];

/// Entries of the records of one register of discs; those of blocks that the law does not read are zero.
type RecordRegisters<R> = [<R as Registers>::V; ENTRIES];

/// Environment of a law that evaluates one register of pairs. `PLAIN` where neither energy nor dissipation is asked for: their code and
/// registers are gone.
struct GatherEnv<R: Registers, const PLAIN: bool> {
    registers: R,
    own: RecordRegisters<R>,
    partner: RecordRegisters<R>,
    per_time: f64,
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

impl<R: Registers, const PLAIN: bool> GatherEnv<R, PLAIN> {
    #[inline(always)]
    fn field(&self, field: ParticleField, records: &RecordRegisters<R>) -> R::V {
        let Some(entry) = RecordEntry::of_field(field) else {
            // A sweep rejects laws that state such a field.
            return self.uniform(f64::NAN);
        };
        let value = records[entry as usize];
        match entry {
            RecordEntry::Vx | RecordEntry::Vy | RecordEntry::Omega => value * self.uniform(self.per_time),
            _ => value,
        }
    }
}

/// Number of entries up to the last that a law reads.
const fn entries_read(fields: &[ParticleField]) -> usize {
    let (mut i, mut count) = (0, 2);
    while i < fields.len() {
        if let Some(entry) = RecordEntry::of_field(fields[i])
            && entry as usize >= count
        {
            count = entry as usize + 1;
        }
        i += 1;
    }
    count
}

/// Loads the first `entries` entries of the records of some discs.
///
/// # Safety
/// There is a record with these entries for every disc.
#[inline(always)]
unsafe fn load_records<R: Registers, S: Element>(
    registers: R,
    entries: usize,
    blocks: [*const S; MOST_BLOCKS],
    discs: &LaneArray<u32>,
) -> RecordRegisters<R> {
    let mut record = [registers.splat(R::Lane::default()); ENTRIES];
    let numbers = block::<S>();
    for number in 0..MOST_BLOCKS {
        if number * numbers >= entries {
            break;
        }
        let places = RecordPlaces { first: blocks[number].cast_mut(), stride: numbers, records: discs };
        // SAFETY: the caller promises a block for every disc.
        let loaded = unsafe { load_converted(registers, places) };
        for k in 0..numbers {
            record[number * numbers + k] = loaded[k];
        }
    }
    record
}

/// Loads blocks of another precision.
///
/// # Safety
/// As for [`Registers::load_blocks`].
#[inline(always)]
unsafe fn load_converted<R: Registers, S: Element>(
    registers: R,
    places: RecordPlaces<'_, S>,
) -> [R::V; QUAD] {
    let RecordPlaces { first, stride, records } = places;
    if is_same_storage::<S, R::Lane>() {
        // SAFETY: S is Lane, and the caller makes the same promise.
        return unsafe { registers.load_blocks(RecordPlaces { first: first.cast(), stride, records }) };
    }
    let mut columns = [[R::Lane::default(); GROUP]; QUAD];
    for lane in 0..R::LANES {
        for (k, column) in columns.iter_mut().enumerate().take(block::<S>()) {
            // SAFETY: the caller promises a block there.
            let number = unsafe { *first.add(records[lane] as usize * stride + k) };
            column[lane] = R::Lane::from_f64(number.to_f64());
        }
    }
    registers_of(registers, &columns)
}

#[inline(always)]
fn spill<R: Registers>(registers: R, value: R::V) -> LaneArray<R::Lane> {
    let mut lanes = [R::Lane::default(); GROUP];
    // SAFETY: `lanes` has GROUP entries, and LANES <= GROUP.
    unsafe { registers.store(lanes.as_mut_ptr(), value) };
    lanes
}

impl<R: Registers, const PLAIN: bool> Env<2> for &GatherEnv<R, PLAIN> {
    type V = R::V;
    type Partner = ();
    const BOTH_PARTNERS: bool = true;

    #[inline(always)]
    fn own_position(self) -> [R::V; 2] {
        [self.own[RecordEntry::X as usize], self.own[RecordEntry::Y as usize]]
    }
    #[inline(always)]
    fn own(self, field: ParticleField) -> R::V {
        self.field(field, &self.own)
    }
    #[inline(always)]
    fn displacement(self, own: [R::V; 2], (): ()) -> [R::V; 2] {
        let x = (own[0] - self.partner[RecordEntry::X as usize]) - self.cell_offset[0];
        let y = (own[1] - self.partner[RecordEntry::Y as usize]) - self.cell_offset[1];
        [x, y]
    }
    #[inline(always)]
    fn partner(self, field: ParticleField, (): ()) -> R::V {
        self.field(field, &self.partner)
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
        !PLAIN && self.asked.dissipation
    }
    #[inline(always)]
    fn dissipate(self, power: R::V) {
        self.power.set(power);
    }
    #[inline(always)]
    fn observes_energy(self) -> bool {
        !PLAIN && self.asked.energy
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
        // Not behind a reference: parameters of the law then stay in registers, since no store to a sum can change them.
        let law = self.law.clone();
        let mut notes = std::mem::take(self.notes);
        let mut first = 0;
        if !self.asked.dissipation && !self.asked.energy {
            while first < self.pairs.count() {
                self.evaluate_register::<R, true>(registers, &law, first, &mut notes);
                first += R::LANES;
            }
        }
        while first < self.pairs.count() {
            self.evaluate_register::<R, false>(registers, &law, first, &mut notes);
            first += R::LANES;
        }
        *self.notes = notes;
    }
}

impl<S: Element, P: Precision, L: Law<2>, Q: PairSequence<P>> Evaluate<'_, S, P, L, Q> {
    #[inline(always)]
    fn evaluate_register<R: Registers<Lane = P>, const PLAIN: bool>(
        &self,
        registers: R,
        law: &L,
        first: usize,
        notes: &mut BandNotes,
    ) {
        let count = (self.pairs.count() - first).min(R::LANES);
        let mut own = [self.sentinel; GROUP];
        let mut partner = [self.sentinel + 1; GROUP];
        let mut cell_offset = [0; GROUP];
        // Nearly all registers are full: the compiler unrolls a loop over all lanes.
        for lane in 0..R::LANES {
            if lane == count {
                break;
            }
            ([own[lane], partner[lane]], cell_offset[lane]) = self.pairs.pair(first + lane);
        }
        let cell_offsets = self.pairs.cell_offsets().as_ptr().cast::<P>().cast_mut();
        let cell_offsets = RecordPlaces { first: cell_offsets, stride: QUAD, records: &cell_offset };
        // SAFETY: the numbers of a finder's pairs are those of cell offsets, and a pair's finder has the first.
        let cell_offset = unsafe { registers.load_blocks(cell_offsets) };
        let entries = const { entries_read(L::FIELDS) };
        // SAFETY: Sweep has checked that there is a record for every disc and sentinel, with all entries that the law states.
        // Pairs are of discs (Finder's contract), and lanes without a pair have the sentinels.
        let (own_record, partner_record) = unsafe {
            (
                load_records(registers, entries, self.state.blocks, &own),
                load_records(registers, entries, self.state.blocks, &partner),
            )
        };
        let zero = || Cell::new(registers.splat(P::default()));
        let gathered = GatherEnv::<R, PLAIN> {
            registers,
            own: own_record,
            partner: partner_record,
            per_time: self.state.per_time,
            cell_offset: [cell_offset[0], cell_offset[1]],
            asked: self.asked,
            penetration: zero(),
            power: zero(),
            energy: [zero(), zero()],
            contact: zero(),
            own_sums: [zero(), zero(), zero()],
            partner_sums: [zero(), zero(), zero()],
        };
        // Only through `StatedEnv`: a law has the entries that it states, and no others.
        let env = StatedEnv::new(&gathered, law);
        let disc = law.own(env);
        law.pair(env, (), &disc);

        let [x, y, torque] = &gathered.own_sums;
        let (x, y, torque) = (x.get(), y.get(), torque.get());
        let magnitude = (x.abs() + y.abs()) + torque.abs();
        let nothing = registers.splat(P::default());
        let added = [x, y, torque, nothing];
        let [x, y, torque] = &gathered.partner_sums;
        let subtracted = [x.get(), y.get(), torque.get(), nothing];
        let sums = |records| RecordPlaces { first: self.sums.0, stride: QUAD, records };
        let places = [sums(&own), sums(&partner)];
        // One contact after the other, own before partner: the order of summation does not depend on the register width.
        // SAFETY: Sweep has checked that there are sums for every disc, and a finder's pairs are of discs. Own discs are in the rows
        // that this thread sweeps, partners in these or those ahead of them: no other thread adds to either at this stage.
        unsafe { registers.add_quads(count, [added, subtracted], places) };
        // Pair by pair. Two touching fixed discs have no effective mass; any other pair without a finite force is listed below.
        if !PLAIN && self.asked.dissipation {
            add(&spill(registers, gathered.power.get()), count, &mut notes.dissipated);
        }
        if !PLAIN && self.asked.energy {
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
