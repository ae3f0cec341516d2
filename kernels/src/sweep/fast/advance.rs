//! Fused corrector and next predictor: one pass over the discs per step.
//!
//! ```text
//! a step as written:   predict | find forces | correct
//! as executed:                   find forces | correct, predict | find forces | correct, predict | ...
//! ```
//!
//! A pass leaves the predicted state. An observer needs the state at the end of the step and corrects a copy
//! ([`EquationOfMotion::corrected`]). So every column is read once and written once a step. The same pass, while everything is in
//! registers:
//!
//! - sets the sums of forces to zero for the next sweep;
//! - compares each disc's position with its limit, at which the search must be updated: the edge of its cell, or half the skin of
//!   a list. Few discs exceed it; their numbers are collected from the bits of one comparison per register;
//! - compares the length of the disc's next step with its limit, so that no disc jumps past another undetected;
//! - copies the position as a pair of 16-bit coordinates to the disc's cell, for a search on the lattice. Each disc writes to a cell of its
//!   own, so threads need no order. (Discs in a shared cell write to one spare element behind the lattice, atomically; it is
//!   never read.)
//!
//! Derivatives that a scheme does not carry from step to step are not stored ([`Scheme::CARRIED`]).

use super::motion::EquationOfMotion;
use super::records::{ENTRIES, ForceRecords, MOST_BLOCKS, RecordEntry, StateRecords};
use crate::InstructionSet;
use crate::backend::{Precision, QUAD, Registers, Scalar, block};
use crate::backend::{RegisterTask, dispatch_native};
use crate::integrator::{DERIVATIVES, Draws, Inertia, Scheme, acceleration};
use crate::isa::{Element, Predicate, ProgramError, Vector, is_same_storage};
use crate::threads::{on_threads, pieces};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// Discs whose random numbers are drawn in one batch, which fits in the first-level cache. A multiple of every register's lanes.
const AT_ONCE: usize = 256;

/// Discs that one thread moves in one piece.
const BAND: usize = 1024;

/// Limit of a disc's displacement beyond which the search must be updated.
#[derive(Clone, Copy, Debug)]
pub enum DisplacementLimit<'a, S> {
    /// The edge of its cell, of these sides (length).
    Cell([f64; 2]),
    /// A distance from a reference position.
    From {
        /// Reference positions, at least one entry per disc.
        positions: [&'a [S]; 2],
        /// Largest distance (length).
        distance: f64,
    },
}

/// Discs reported by a pass.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PassReport {
    /// Discs beyond the limit or without a finite position, in order.
    pub left: Vec<u32>,
    /// Discs whose next step is longer than allowed or whose speed is not a number, in order.
    pub far: Vec<u32>,
}

impl PassReport {
    /// Joins these discs with those of a pass over later discs.
    #[must_use]
    #[inline]
    pub fn joined_with(mut self, behind: PassReport) -> PassReport {
        self.left.extend(behind.left);
        self.far.extend(behind.far);
        self
    }
}

/// Copies of the positions for a search, pairs of 16-bit coordinates, written together with the state while it is in registers.
///
/// Only the lattice creates them. Every cell is an index into `positions` and belongs to one disc or to none.
#[derive(Debug)]
pub struct PositionCopies<'a> {
    /// Index of each disc's copy.
    pub(super) cells: &'a [u32],
    /// The copies.
    pub(super) positions: &'a mut [u32],
    /// Factor from lengths to the unit of the copies.
    pub(super) unit: f64,
}

/// Corrects the state with the forces of a sweep and predicts it one step ahead.
///
/// The order in which discs are moved changes no bit. Positions are relative to the cells. The pass sets the sums to zero.
pub struct Advance<'a, S, P, C> {
    /// Equation of motion and its integration.
    pub motion: &'a EquationOfMotion<C>,
    /// Number of degrees of freedom: 2, or 3 with rotation.
    pub freedoms: usize,
    /// Values and rates of change, and inverse masses; at least one record per moving disc.
    pub records: &'a mut StateRecords<S>,
    /// For each degree of freedom one column per carried derivative from the second on, with at least one entry per moving disc.
    pub higher: Vec<Vec<&'a mut [S]>>,
    /// Sums of the forces.
    pub sums: &'a mut ForceRecords<P>,
    /// Inverse moments of inertia, where discs vary and rotate.
    pub inverse_inertia: &'a [S],
    /// Discs to move.
    pub discs: Range<usize>,
    /// Number of the step to correct; the next one is predicted.
    pub step: u64,
    /// Ids of the discs, for a scheme that draws random numbers; at least one entry per moving disc.
    pub ids: &'a [u32],
    /// True in the first step: the state is the initial one, and forces only give its accelerations.
    pub corrected: bool,
    /// Longest step (length) at the predicted velocity; faster discs are listed.
    pub longest_step: f64,
}

impl<S: Precision, P: Element, C: Scheme> Advance<'_, S, P, C> {
    /// Advances the discs and returns those that need attention.
    ///
    /// # Errors
    /// [`ProgramError::NoSuchInstructionSet`]; nothing was executed then.
    ///
    /// # Panics
    /// If a column is shorter than documented.
    pub fn run(
        mut self,
        limit: DisplacementLimit<'_, S>,
        copies: Option<PositionCopies<'_>>,
        set: InstructionSet,
    ) -> Result<PassReport, ProgramError> {
        let Advance { motion, freedoms, discs, corrected, longest_step, inverse_inertia, step, ids, .. } =
            self;
        let end = discs.end;
        assert!(C::DRAWS == Draws::Never || ids.len() >= end, "ids has no entry for some moving disc");
        assert!((2..=3).contains(&freedoms) && self.higher.len() == freedoms, "2 or 3 degrees of freedom");
        let vary = motion.inertia == Inertia::Varying;
        assert!(self.records.discs() >= end && self.sums.discs() >= end, "a moving disc without a record");
        assert!(
            freedoms == 2 || self.records.has(RecordEntry::Omega),
            "records without the angular velocity"
        );
        assert!(!vary || self.records.has(RecordEntry::InverseMass), "records without the inverse mass");
        assert!(!vary || freedoms == 2 || inverse_inertia.len() >= end);
        if let DisplacementLimit::From { positions, .. } = limit {
            assert!(
                positions.iter().all(|position| position.len() >= end),
                "a column of reference positions has no entry for some moving disc"
            );
        }
        let mut columns = [[std::ptr::null_mut(); DERIVATIVES - 2]; 3];
        for (to, from) in columns.iter_mut().zip(&mut self.higher) {
            assert!(from.len() == C::CARRIED - 2 && from.iter().all(|column| column.len() >= end));
            to.iter_mut().zip(from).for_each(|(to, from)| *to = from.as_mut_ptr());
        }
        let copies_positions = copies.is_some();
        let PositionCopies { cells, positions, unit } =
            copies.unwrap_or(PositionCopies { cells: &[], positions: &mut [], unit: 1.0 });
        assert!(!copies_positions || cells.len() >= end, "cells has no entry for some moving disc");
        let arrays = PassPointers {
            records: self.records.blocks_mut(),
            columns,
            sums: self.sums.numbers_mut(),
            step,
            ids,
            inverse_inertia: inverse_inertia.as_ptr(),
            limit,
            cells: cells.as_ptr(),
            copies_positions,
            positions: positions.as_mut_ptr(),
        };
        // Velocity in the units of the state at which a step has the greatest length allowed.
        let fastest = longest_step * (C::scales(motion.dt)[1] / motion.dt);
        let square = fastest * fastest;
        let pass = |range: Range<usize>| -> Result<PassReport, ProgramError> {
            let mut passed = PassReport::default();
            let (arrays, found) = (&arrays, &mut passed);
            match freedoms {
                2 => dispatch_native(
                    set,
                    Pass::<_, _, _, 2> { motion, arrays, range, corrected, square, unit, passed: found },
                ),
                _ => dispatch_native(
                    set,
                    Pass::<_, _, _, 3> { motion, arrays, range, corrected, square, unit, passed: found },
                ),
            }?;
            Ok(passed)
        };
        let mut all = PassReport::default();
        for passed in on_threads(pieces(discs, BAND), pass) {
            all = all.joined_with(passed?);
        }
        Ok(all)
    }
}

/// Pointers to the arrays of a pass.
struct PassPointers<'a, S, P> {
    /// Blocks of the records.
    records: [*mut S; MOST_BLOCKS],
    columns: [[*mut S; DERIVATIVES - 2]; 3],
    sums: *mut P,
    step: u64,
    ids: &'a [u32],
    inverse_inertia: *const S,
    limit: DisplacementLimit<'a, S>,
    cells: *const u32,
    /// True if positions are copied to the lattice.
    copies_positions: bool,
    positions: *mut u32,
}

// SAFETY: passes over disjoint ranges touch different discs, and these have different cells. Discs in shared cells have a common
// spare cell, which is stored to atomically and never read.
unsafe impl<S: Send + Sync, P: Send> Sync for PassPointers<'_, S, P> {}

/// The pass over one range of discs.
struct Pass<'a, S, P, C, const FREEDOMS: usize> {
    motion: &'a EquationOfMotion<C>,
    arrays: &'a PassPointers<'a, S, P>,
    range: Range<usize>,
    corrected: bool,
    /// Square of the greatest velocity allowed, in the units of the state.
    square: f64,
    unit: f64,
    passed: &'a mut PassReport,
}

impl<S: Precision, P: Element, C: Scheme, const FREEDOMS: usize> RegisterTask<S>
    for Pass<'_, S, P, C, FREEDOMS>
{
    #[inline(always)]
    fn on<R: Registers<Lane = S>>(mut self, registers: R) {
        let Range { start: mut first, end } = self.range.clone();
        let mut noise = [[S::default(); AT_ONCE]; 2];
        while first < end {
            let some = first..(first + AT_ONCE).min(end);
            if C::DRAWS != Draws::Never {
                let [x, y] = &mut noise;
                self.motion.draw(self.arrays.step, &self.arrays.ids[some.clone()], [x, y]);
            }
            while first + R::LANES <= some.end {
                let from = first - some.start;
                self.advance_register(registers, first, [&noise[0][from..], &noise[1][from..]]);
                first += R::LANES;
            }
            let from = first - some.start;
            self.advance_singly(first..some.end, [&noise[0][from..], &noise[1][from..]]);
            first = some.end;
        }
    }
}

impl<S: Precision, P: Element, C: Scheme, const FREEDOMS: usize> Pass<'_, S, P, C, FREEDOMS> {
    /// Advances the discs that do not fill a register one by one. The bits are the same, so one copy serves all register files.
    #[inline(never)]
    fn advance_singly(&mut self, discs: Range<usize>, [x, y]: [&[S]; 2]) {
        for (number, disc) in discs.enumerate() {
            self.advance_register(Scalar::<S>::default(), disc, [&x[number..], &y[number..]]);
        }
    }

    /// Advances one register of discs from `first` on, with their random numbers along x and y.
    #[allow(clippy::needless_range_loop, reason = "several arrays share one index")]
    #[inline(always)]
    fn advance_register<R: Registers<Lane = S>>(&mut self, registers: R, first: usize, noise: [&[S]; 2]) {
        let Pass { motion, arrays, corrected, .. } = *self;
        let uniform = |value: f64| registers.splat(S::from_f64(value));
        let nothing = uniform(f64::NAN);
        let normals = match C::DRAWS {
            Draws::Never => [nothing; 2],
            _ => {
                assert!(noise[0].len() >= R::LANES && noise[1].len() >= R::LANES);
                // SAFETY: both slices have at least LANES entries, as asserted.
                unsafe { [registers.load(noise[0].as_ptr()), registers.load(noise[1].as_ptr())] }
            }
        };
        let read = match motion.inertia {
            Inertia::Varying => ENTRIES,
            Inertia::Equal { .. } => 2 * FREEDOMS,
        };
        let numbers = block::<S>();
        let mut record = [nothing; ENTRIES];
        for number in 0..MOST_BLOCKS {
            if number * numbers >= read {
                break;
            }
            // SAFETY: Advance has checked that every moving disc has a record with these entries, those of a register included; this
            // thread alone works on them.
            let loaded = unsafe { registers.load_block_run(arrays.records[number].add(first * numbers)) };
            for k in 0..numbers {
                record[number * numbers + k] = loaded[k];
            }
        }
        // SAFETY: every moving disc has sums, and this thread alone works on them.
        let forces = unsafe { take_sums(registers, arrays.sums.add(first * QUAD)) };
        for freedom in 0..FREEDOMS {
            let force = forces[freedom];
            let inverse = motion.inertia.inverse(freedom, uniform, || match freedom {
                0 | 1 => record[RecordEntry::InverseMass as usize],
                // SAFETY: where discs vary and rotate, Advance has checked that there is an entry for every moving disc.
                _ => unsafe { registers.load(arrays.inverse_inertia.add(first)) },
            });
            let context = |point: Draws| {
                let normal = if C::DRAWS == point { normals[freedom.min(1)] } else { nothing };
                motion.context(registers, inverse, normal)
            };
            let acceleration = acceleration(uniform, motion.gravity, freedom, force, inverse);
            let mut row = [uniform(0.0); DERIVATIVES];
            let [value, rate] = [RecordEntry::of(freedom, 0) as usize, RecordEntry::of(freedom, 1) as usize];
            (row[0], row[1]) = (record[value], record[rate]);
            for k in 2..C::CARRIED {
                // SAFETY: Advance has checked that every carried derivative has an entry for every moving disc.
                row[k] = unsafe { registers.load(arrays.columns[freedom][k - 2].add(first)) };
            }
            if corrected {
                motion.scheme.begin(&context(Draws::InCorrector), &mut row, acceleration);
            } else {
                motion.scheme.correct(&context(Draws::InCorrector), &mut row, acceleration);
            }
            motion.scheme.predict(&context(Draws::InPredictor), &mut row);
            for k in 2..C::CARRIED {
                // SAFETY: the row was loaded from there, and this thread alone works on these discs.
                unsafe { registers.store(arrays.columns[freedom][k - 2].add(first), row[k]) };
            }
            (record[value], record[rate]) = (row[0], row[1]);
        }
        for number in 0..MOST_BLOCKS {
            if number * numbers >= 2 * FREEDOMS {
                break;
            }
            let mut stored = [nothing; QUAD];
            for k in 0..numbers {
                stored[k] = record[number * numbers + k];
            }
            // SAFETY: the block was loaded from there, and this thread alone works on these discs.
            unsafe { registers.store_block_run(stored, arrays.records[number].add(first * numbers)) };
        }
        let [x, y, vx, vy, ..] = record;
        let (position, velocity) = ([x, y], [vx, vy]);
        let stays = match arrays.limit {
            DisplacementLimit::Cell([x, y]) => {
                let (x, y) = (uniform(0.5 * x), uniform(0.5 * y));
                position[0].abs().less_equal(x).and(position[1].abs().less_equal(y))
            }
            DisplacementLimit::From { positions: [x, y], distance } => {
                // SAFETY: Advance has checked that every moving disc has a reference position.
                let (x, y) =
                    unsafe { (registers.load(x.as_ptr().add(first)), registers.load(y.as_ptr().add(first))) };
                let (dx, dy) = (position[0] - x, position[1] - y);
                (dx * dx + dy * dy).less_equal(uniform(distance * distance))
            }
        };
        let creeps = (velocity[0] * velocity[0] + velocity[1] * velocity[1]).less_equal(uniform(self.square));
        let moved = registers.bits(stays.and(creeps).not());
        if moved != 0 {
            list_discs(registers.bits(stays.not()), first, R::LANES, &mut self.passed.left);
            list_discs(registers.bits(creeps.not()), first, R::LANES, &mut self.passed.far);
        }
        if !arrays.copies_positions {
            return;
        }
        // Copied before the atomic stores, which might otherwise change them.
        let (cells, copies) = (arrays.cells, arrays.positions);
        let mut along = [[S::default(); 16]; 2];
        for axis in 0..2 {
            let rounded = position[axis] * uniform(self.unit) + uniform(const { rounding::<S>() });
            // SAFETY: `along` has 16 entries, and no register has more lanes.
            unsafe { registers.store(along[axis].as_mut_ptr(), rounded) };
        }
        // All lanes first, so that the compiler vectorises the conversion.
        let mut pairs = [0; 16];
        for lane in 0..16 {
            pairs[lane] = along[0][lane].bits() as u32 & 0xffff | (along[1][lane].bits() as u32) << 16;
        }
        for lane in 0..R::LANES {
            // SAFETY: the cells are cells of the lattice, each of one disc only. The exception is the spare cell behind it, which
            // discs in shared cells have in common: only these stores touch it. They are atomic and compile to plain ones.
            unsafe {
                let position = copies.add(*cells.add(first + lane) as usize);
                AtomicU32::from_ptr(position).store(pairs[lane], Ordering::Relaxed);
            }
        }
    }
}

/// Number that rounds a small number to an integer when it is added: the low 16 bits of the sum are those of the integer.
const fn rounding<S: Element>() -> f64 {
    if S::BYTES == 8 { 1.5 * (1_u64 << 52) as f64 } else { 1.5 * (1_u64 << 23) as f64 }
}

/// Lists the discs of a register from `first` on whose bits are set.
#[inline(never)]
fn list_discs(bits: u64, first: usize, lanes: usize, to: &mut Vec<u32>) {
    to.extend((0..lanes).filter(|lane| bits >> lane & 1 == 1).map(|lane| (first + lane) as u32));
}

/// Loads the sums of a register of discs and sets them to zero.
///
/// # Safety
/// There are as many sums as a register has lanes, and no other thread touches them.
#[inline(always)]
unsafe fn take_sums<R: Registers, P: Element>(registers: R, sums: *mut P) -> [R::V; QUAD] {
    if is_same_storage::<P, R::Lane>() {
        let sums = sums.cast::<R::Lane>();
        // SAFETY: P is Lane, and the caller promises the sums of LANES discs, which belong to this thread.
        return unsafe {
            let values = registers.load_quad_run(sums);
            for quad in 0..QUAD {
                registers.store(sums.add(quad * R::LANES), registers.splat(R::Lane::default()));
            }
            values
        };
    }
    let mut converted = [[R::Lane::default(); QUAD]; 16];
    // SAFETY: the caller promises the sums of LANES discs, which belong to this thread.
    let sums = unsafe { std::slice::from_raw_parts_mut(sums.cast::<[P; QUAD]>(), R::LANES) };
    for (to, from) in converted.iter_mut().zip(sums) {
        for (to, from) in to.iter_mut().zip(from) {
            *to = R::Lane::from_f64(std::mem::take(from).to_f64());
        }
    }
    // SAFETY: `converted` has 16 quads, and no register has more lanes.
    unsafe { registers.load_quad_run(converted.as_ptr().cast()) }
}
