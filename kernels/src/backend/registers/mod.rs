//! Machine over registers: one implementation of every instruction for any register file.

pub(super) mod coordinates;
pub(super) mod records;

use crate::isa::list::for_each_op;
use crate::isa::{
    ArrayColumn, Element, LaneCounter, Machine, Memory, Slot, Storage, Vector, is_same_storage,
};
use records::{QUAD, RecordPlaces, block};
use std::hint::select_unpredictable;
use std::mem::MaybeUninit;

/// Largest number of lanes of any register file; bounds the buffers of lane-by-lane instructions.
pub(crate) const MAX_LANES: usize = 16;

/// Index vector, one entry per lane.
pub trait IndexLanes: Copy {
    /// Index vector whose entries are all 0, which is none.
    fn none() -> Self;
    /// Entry of `lane`.
    fn lane(&self, lane: usize) -> u32;
    /// Sets the entry of `lane`.
    fn set_lane(&mut self, lane: usize, number: u32);
}

impl<const N: usize> IndexLanes for [u32; N] {
    #[inline(always)]
    fn none() -> Self {
        [0; N]
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> u32 {
        self[lane]
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: u32) {
        self[lane] = number;
    }
}

/// A register file: loads, stores and broadcasts of vectors of one width.
pub trait Registers: Copy + 'static {
    /// Number type of a lane.
    type Lane: Element;
    /// A register.
    type V: Vector;
    /// An index vector as wide as `V`.
    type Index: IndexLanes;
    /// Registers of the same width with single-precision lanes.
    type Single: Registers<Lane = f32>;
    /// Lanes of `V`, at most 16.
    const LANES: usize;

    /// Single-precision registers of the same instruction set.
    fn single(self) -> Self::Single;

    /// Broadcasts a number to every lane.
    fn splat(self, value: Self::Lane) -> Self::V;
    /// Loads `LANES` consecutive numbers.
    ///
    /// # Safety
    /// `from` points to that many initialised numbers of one allocation and is aligned for one of them; nothing writes them
    /// during the call.
    unsafe fn load(self, from: *const Self::Lane) -> Self::V;
    /// Stores `LANES` consecutive numbers.
    ///
    /// # Safety
    /// `to` points to space for that many numbers in one allocation and is aligned for one of them; nothing else reads or writes
    /// there during the call.
    unsafe fn store(self, to: *mut Self::Lane, value: Self::V);
    /// True if the predicate is false in every lane.
    fn none(self, predicate: <Self::V as Vector>::Predicate) -> bool;
    /// Truth values as bits, lane 0 lowest.
    fn bits(self, predicate: <Self::V as Vector>::Predicate) -> u64;

    /// Bits of the lanes in which two pairs of 16-bit coordinates (x in the low half of a word, y in the high half) are nearer than the
    /// root of `limit`, after the offset is subtracted from the first.
    ///
    /// # Safety
    /// `own` and `other` point to `LANES` initialised pairs; nothing writes them during the call.
    #[inline(always)]
    unsafe fn near_pairs(self, own: *const u32, offset: u32, other: *const u32, limit: i32) -> u64 {
        // SAFETY: the caller makes the same promise.
        unsafe { coordinates::near_pairs::<Self>(own, offset, other, limit) }
    }
    /// As [`near_pairs`](Self::near_pairs), nearer than the sum of the reaches of both and one more. Each side has pairs and reaches;
    /// reaches are pairs with a second coordinate of 0.
    ///
    /// # Safety
    /// All point to `LANES` initialised pairs; nothing writes them during the call.
    #[inline(always)]
    unsafe fn touching_pairs(
        self,
        own: [*const u32; 2],
        offset: u32,
        other: [*const u32; 2],
        beyond: u32,
    ) -> u64 {
        // SAFETY: the caller makes the same promise.
        unsafe { coordinates::touching_pairs::<Self>(own, offset, other, beyond) }
    }
    /// Loads a block of 16 bytes for each lane: register k holds the number k of every lane, or zero if a block has fewer.
    ///
    /// # Safety
    /// Every lane's record begins with an initialised block; nothing writes it during the call.
    #[inline(always)]
    unsafe fn load_blocks(self, places: RecordPlaces<'_, Self::Lane>) -> [Self::V; QUAD] {
        // SAFETY: the caller makes the same promise.
        unsafe { records::load_by_number(self, block::<Self::Lane>(), places) }
    }
    /// As [`load_blocks`](Self::load_blocks), for blocks one behind the other.
    ///
    /// # Safety
    /// `first` points to `LANES` initialised blocks; nothing writes them during the call.
    #[inline(always)]
    unsafe fn load_block_run(self, first: *const Self::Lane) -> [Self::V; QUAD] {
        let numbers = block::<Self::Lane>();
        // SAFETY: the caller makes the same promise.
        unsafe { records::load_by_number(self, numbers, RecordPlaces::run(first.cast_mut(), numbers)) }
    }
    /// Stores blocks one behind the other, of register k the number k.
    ///
    /// # Safety
    /// `first` points to space for `LANES` blocks; nothing else reads or writes there during the call.
    #[inline(always)]
    unsafe fn store_block_run(self, values: [Self::V; QUAD], first: *mut Self::Lane) {
        let numbers = block::<Self::Lane>();
        // SAFETY: the caller makes the same promise.
        unsafe { records::store_by_number(self, numbers, values, RecordPlaces::run(first, numbers)) }
    }
    /// Loads quads one behind the other: register k holds the number k of every lane.
    ///
    /// # Safety
    /// `first` points to `LANES` initialised quads; nothing writes them during the call.
    #[inline(always)]
    unsafe fn load_quad_run(self, first: *const Self::Lane) -> [Self::V; QUAD] {
        // SAFETY: the caller makes the same promise.
        unsafe { records::load_by_number(self, QUAD, RecordPlaces::run(first.cast_mut(), QUAD)) }
    }
    /// For the first `count` lanes, one after the other: adds four numbers to the lane's quad in the first place, then subtracts
    /// four from that in the second.
    ///
    /// # Safety
    /// Both quads of every such lane have four initialised numbers; nothing else reads or writes there during the call.
    #[inline(always)]
    unsafe fn add_quads(
        self,
        count: usize,
        added_and_subtracted: [[Self::V; QUAD]; 2],
        quads: [RecordPlaces<'_, Self::Lane>; 2],
    ) {
        // SAFETY: the caller makes the same promise.
        unsafe { records::add_by_number(self, count, added_and_subtracted, quads) }
    }
}

/// A strip of `R::LANES` elements of a memory, from element `base` on.
///
/// The memory was admitted for the kernel's footprint over every strip that is run, which makes the raw loads sound.
#[derive(Clone, Copy)]
pub(crate) struct Strip<'m, R> {
    registers: R,
    memory: &'m Memory<'m>,
    base: usize,
}

/// Lanes spilled to memory, for instructions that no portable SIMD offers. The spill is cache-line-aligned; otherwise the stack
/// position would decide whether a wide register straddles two lines.
#[repr(align(64))]
struct Spill<T>(MaybeUninit<[T; MAX_LANES]>);

impl<T: Copy> Spill<T> {
    #[inline(always)]
    fn new() -> Self {
        Spill(MaybeUninit::uninit())
    }
    #[inline(always)]
    fn start(&mut self) -> *mut T {
        self.0.as_mut_ptr().cast()
    }
}

/// Implementations of the machine's instructions, each named as its method of [`Machine`].
///
/// Instructions that touch memory take the column by value. With a lookup per lane or per register behind stores to the stack, a
/// pass took a tenth longer or twice as long at some stack depths: a load waits for an earlier store with the same last 12 bits
/// of its address.
impl<'m, R: Registers> Strip<'m, R> {
    #[inline(always)]
    pub(crate) fn new(registers: R, memory: &'m Memory<'m>, base: usize) -> Self {
        const { assert!(R::LANES <= MAX_LANES) }
        Strip { registers, memory, base }
    }

    #[inline(always)]
    fn place<T: Storage>(self, column: ArrayColumn<T>, shift: isize) -> *mut T {
        // SAFETY: the memory was admitted for the footprint, so base + shift and the lanes behind it exist.
        unsafe { column.at(self.base.wrapping_add_signed(shift)) }
    }

    #[inline(always)]
    pub(crate) fn load<T: Element>(self, column: ArrayColumn<T>) -> R::V {
        self.load_shifted(column, 0)
    }

    #[inline(always)]
    pub(crate) fn load_shifted<T: Element>(self, column: ArrayColumn<T>, shift: isize) -> R::V {
        let from = self.place(column, shift);
        if is_same_storage::<T, R::Lane>() {
            // SAFETY: T is Lane, and the admitted footprint covers the LANES elements from base + shift on.
            unsafe { self.registers.load(from.cast()) }
        } else {
            // SAFETY: lane < LANES, and the admitted footprint covers the LANES elements from base + shift on.
            self.assemble(|lane| R::Lane::from_f64(unsafe { *from.add(lane) }.to_f64()))
        }
    }

    #[inline(always)]
    pub(crate) fn store<T: Element>(self, column: ArrayColumn<T>, value: R::V) {
        let to = self.place(column, 0);
        if is_same_storage::<T, R::Lane>() {
            // SAFETY: T is Lane, and the admitted footprint marks the LANES elements from base on as written.
            unsafe { self.registers.store(to.cast(), value) };
        } else {
            // SAFETY: lane < LANES, and the admitted footprint marks the LANES elements from base on as written.
            self.disperse(value, |lane, number| unsafe { *to.add(lane) = T::from_f64(number.to_f64()) });
        }
    }

    #[inline(always)]
    pub(crate) fn gather<T: Element>(self, column: ArrayColumn<T>, index: R::Index, elsewhere: R::V) -> R::V {
        let mut spill = Spill::new();
        // SAFETY: the spill has space for MAX_LANES >= LANES elements.
        unsafe { self.registers.store(spill.start(), elsewhere) };
        // Read and discarded where the index is 0, because a branch would be mispredicted at every other cell. It is no element
        // of the column: that would always be the same one, which pending stores to the spill may seem to overlap.
        let nothing = T::default();
        for lane in 0..R::LANES {
            let number = index.lane(lane);
            let is_none = number == 0;
            let from = select_unpredictable(is_none, &raw const nothing, column.entry(number));
            // SAFETY: `entry` has checked that the number is an element's; where it is 0 the pointer is to `nothing`.
            let element = R::Lane::from_f64(unsafe { *from }.to_f64());
            // SAFETY: lane < LANES, and the store of `elsewhere` has written LANES elements of the spill.
            let to = unsafe { &mut *spill.start().add(lane) };
            *to = select_unpredictable(is_none, *to, element);
        }
        // SAFETY: the store of `elsewhere` has written LANES elements of the spill.
        unsafe { self.registers.load(spill.start()) }
    }

    #[inline(always)]
    pub(crate) fn load_index(self, column: ArrayColumn<u32>) -> R::Index {
        let from = self.place(column, 0);
        let mut index = R::Index::none();
        for lane in 0..R::LANES {
            // SAFETY: lane < LANES, and the admitted footprint covers the LANES elements from base on.
            index.set_lane(lane, unsafe { *from.add(lane) });
        }
        index
    }

    #[inline(always)]
    pub(crate) fn store_index(self, column: ArrayColumn<u32>, value: R::Index) {
        let to = self.place(column, 0);
        for lane in 0..R::LANES {
            // SAFETY: lane < LANES, and the admitted footprint marks the LANES elements from base on as written.
            unsafe { *to.add(lane) = value.lane(lane) };
        }
    }

    #[inline(always)]
    pub(crate) fn gather_index(self, column: ArrayColumn<u32>, index: R::Index) -> R::Index {
        let mut gathered = R::Index::none();
        for lane in 0..R::LANES {
            let number = index.lane(lane);
            if number != 0 {
                gathered.set_lane(lane, column.read(number as usize - 1));
            }
        }
        gathered
    }

    #[inline(always)]
    pub(crate) fn scatter_index(self, column: ArrayColumn<u32>, index: R::Index, value: R::Index) {
        for lane in 0..R::LANES {
            let number = index.lane(lane);
            if number != 0 {
                column.write(number as usize - 1, value.lane(lane));
            }
        }
    }

    #[inline(always)]
    pub(crate) fn scatter<T: Element>(self, column: ArrayColumn<T>, index: R::Index, value: R::V) {
        self.disperse(value, |lane, number| {
            let place = index.lane(lane);
            if place != 0 {
                column.write(place as usize - 1, T::from_f64(number.to_f64()));
            }
        });
    }

    #[inline(always)]
    pub(crate) fn numbers(self) -> R::V {
        self.assemble(|lane| R::Lane::from_f64((self.base + lane + 1) as f64))
    }

    #[inline(always)]
    pub(crate) fn to_index(self, numbers: R::V) -> R::Index {
        let mut index = R::Index::none();
        // A cast saturates: negative numbers and NaN become 0, which is none.
        self.disperse(numbers, |lane, number| index.set_lane(lane, number.to_f64() as u32));
        index
    }

    #[inline(always)]
    pub(crate) fn index_numbers(self, index: R::Index) -> R::V {
        self.assemble(|lane| R::Lane::from_f64(index.lane(lane).into()))
    }

    #[inline(always)]
    pub(crate) fn count(self, counter: LaneCounter, predicate: <R::V as Vector>::Predicate) {
        if self.none(predicate) {
            return; // Counted events are rare.
        }
        let zero = self.uniform(0.0);
        let mut holding = 0;
        self.disperse(R::V::select(predicate, self.uniform(1.0), zero), |_, number| {
            holding += u64::from(number.to_f64() != 0.0);
        });
        self.memory.count(counter, holding);
    }

    /// Builds a vector lane by lane.
    #[inline(always)]
    fn assemble(self, mut number: impl FnMut(usize) -> R::Lane) -> R::V {
        let mut spill = Spill::<R::Lane>::new();
        for lane in 0..R::LANES {
            // SAFETY: lane < LANES <= MAX_LANES, the capacity of the spill.
            unsafe { spill.start().add(lane).write(number(lane)) };
        }
        // SAFETY: the loop has written the spill's first LANES elements.
        unsafe { self.registers.load(spill.start()) }
    }

    /// Splits a vector into lanes.
    #[inline(always)]
    fn disperse(self, value: R::V, mut take: impl FnMut(usize, R::Lane)) {
        let mut spill = Spill::new();
        // SAFETY: the spill has space for MAX_LANES >= LANES elements, and the store writes the LANES that are read.
        unsafe { self.registers.store(spill.start(), value) };
        for lane in 0..R::LANES {
            // SAFETY: lane < LANES, and the store of `value` has written LANES elements of the spill.
            take(lane, unsafe { spill.start().add(lane).read() });
        }
    }
}

/// Implements the method of an instruction: looks up its arrays and calls its implementation.
macro_rules! implement {
    ($strip:ident $about:tt [$($signature:tt)*]
     $file:ident $form:ident $f:ident $(($($x:ident $($shift:ident)?: $kind:ident),+))?) => {
        #[inline(always)]
        $($signature)* {
            Strip::$f($strip $($(, looked_up!($strip $kind $x) $(, $shift)?)+)?)
        }
    };
}
#[rustfmt::skip]
macro_rules! looked_up {
    ($strip:ident Numbers $slot:ident) => { $strip.memory.column($slot) };
    ($strip:ident Entries $slot:ident) => { $strip.memory.column($slot) };
    ($strip:ident $kind:ident $value:ident) => { $value };
}

impl<R: Registers> Machine for Strip<'_, R> {
    type Lane = R::Lane;
    type V = R::V;
    type P = <R::V as Vector>::Predicate;
    type I = R::Index;

    #[inline(always)]
    fn uniform(self, value: f64) -> R::V {
        self.registers.splat(R::Lane::from_f64(value))
    }

    for_each_op!(each_instruction implement self);

    #[inline(always)]
    fn none(self, predicate: Self::P) -> bool {
        self.registers.none(predicate)
    }

    #[inline(always)]
    fn section(self, _: &'static str) {}
}
