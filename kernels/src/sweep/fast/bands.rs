//! A sweep in bands of rows, on any number of threads.

use super::SENTINELS;
use super::contacts::{Codes, Discs, Evaluate, Notes, SumColumns};
use super::detection::{Candidate, Cursor, Search};
use super::occupancy::Occupancy;
use super::sparse::SparseSearch;
use crate::InstructionSet;
use crate::backend::Precision;
use crate::isa::{Element, ProgramError};
use crate::law::{Law, Sum};
use crate::program::dispatch;
use crate::sweep::lattice::{Frame, LatticeShape};
use crate::threads::on_threads;
use std::ops::Range;

/// Rows of a band, at least; a function of nothing but the lattice may come into the order of summation.
const BAND_ROWS: usize = 32;

/// Candidates that are found before the law is asked about them: they and their discs stay in the nearest cache.
const AT_ONCE: usize = 512;

/// Rows that one thread sweeps, and what it keeps for that.
#[derive(Clone, Debug)]
struct Band {
    rows: Range<usize>,
    candidates: Vec<Candidate>,
    cells: Vec<u64>,
    notes: Notes,
    pairs: u64,
}

/// What a sweep met.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Met {
    /// Pairs the law was asked about, each once.
    pub pairs: u64,
    /// Pairs deeper than watched.
    pub deep: Vec<[u32; 2]>,
    /// Pairs whose force is no finite number. Two fixed discs that touch are such a pair.
    pub not_finite: Vec<[u32; 2]>,
}

/// A law over all contacts of a lattice, each met once.
///
/// First every band sweeps its rows but the last ones, whose partners are all its own; then every band sweeps its last
/// rows, whose partners may be the next band's first. So no two threads ever add to one disc, and the order of every
/// sum depends on the lattice alone.
#[derive(Clone, Debug)]
pub struct Sweep<P> {
    shape: LatticeShape,
    codes: Codes<P>,
    bands: Vec<Band>,
}

impl<P: Precision> Sweep<P> {
    /// For the lattice of an occupancy.
    pub fn new(occupancy: &Occupancy, frame: Frame) -> Self {
        let rows = occupancy.shape().rows();
        let count = (rows / BAND_ROWS).max(1);
        let bands = (0..count).map(|band| Band {
            rows: band * rows / count..(band + 1) * rows / count,
            candidates: Vec::new(),
            cells: Vec::new(),
            notes: Notes::default(),
            pairs: 0,
        });
        Sweep { shape: *occupancy.shape(), codes: Codes::new(occupancy, frame), bands: bands.collect() }
    }

    /// Adds what `law` gives to the sums (force along x, along y, torque), an entry a disc and sentinel.
    ///
    /// # Errors
    /// [`ProgramError::NoSuchInstructionSet`]; nothing was executed then.
    ///
    /// # Panics
    /// If the occupancy is of another lattice, a column that the law asks for has not an entry for every disc and
    /// sentinel, or one of the sums has none for a disc.
    pub fn run<S: Element, L: Law<2> + Sync>(
        &mut self,
        law: &L,
        occupancy: &Occupancy,
        discs: &Discs<'_, S>,
        sums: [&mut [P]; 3],
        watched: Option<f64>,
        set: InstructionSet,
    ) -> Result<Met, ProgramError> {
        assert!(self.shape == *occupancy.shape(), "a sweep is made for one lattice");
        let count = occupancy.discs();
        assert!(discs.suffice(law.fields(), count), "columns of {count} discs and {SENTINELS} sentinels");
        let mut columns = sums.map(|sum| (sum.len(), sum.as_mut_ptr()));
        assert!(law.sums().iter().all(|&sum| columns[sum as usize].0 >= count), "sums of {count} discs");
        // The law's sums are a prefix of the list of all.
        debug_assert!(law.sums().iter().zip(Sum::ALL).all(|(sum, there)| *sum == there));
        let sums = SumColumns(columns.each_mut().map(|column| column.1));
        let overlap = occupancy.half_width();
        let codes = &self.codes;
        let sweep = |band: &mut Band, rows: Range<usize>| -> Result<(), ProgramError> {
            let mut cursor = Cursor { row: rows.start, group: 0 };
            while cursor.row < rows.end {
                band.candidates.clear();
                let (rows, cursor, full) = (rows.clone(), &mut cursor, AT_ONCE);
                if occupancy.is_sparse() {
                    let (places, reach) = (discs.place, occupancy.reach());
                    let Band { candidates: found, cells, .. } = band;
                    let search =
                        SparseSearch { occupancy, codes, places, reach, rows, cursor, full, found, cells };
                    dispatch(set, search)?;
                } else {
                    dispatch(set, Search { occupancy, rows, cursor, full, found: &mut band.candidates })?;
                }
                band.pairs += band.candidates.len() as u64;
                let evaluate = Evaluate {
                    law,
                    index: occupancy.index(),
                    sentinel: count as u32,
                    codes,
                    discs,
                    candidates: &band.candidates,
                    sums,
                    watched,
                    notes: &mut band.notes,
                };
                dispatch(set, evaluate)?;
            }
            Ok(())
        };
        let inner = |rows: &Range<usize>| rows.start..rows.end.saturating_sub(overlap).max(rows.start);
        let each = |band: &mut Band, last: bool| {
            let inner = inner(&band.rows);
            let rows = if last { inner.end..band.rows.end } else { inner };
            sweep(band, rows)
        };
        for last in [false, true] {
            on_threads(&mut self.bands, |band| each(band, last)).into_iter().collect::<Result<(), _>>()?;
        }
        let mut met = Met::default();
        for band in &mut self.bands {
            met.pairs += std::mem::take(&mut band.pairs);
            met.deep.append(&mut band.notes.deep);
            met.not_finite.append(&mut band.notes.not_finite);
        }
        Ok(met)
    }
}
