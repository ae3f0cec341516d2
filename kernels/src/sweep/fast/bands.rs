//! A sweep in bands of rows, on any number of threads.
//!
//! Pairs are found from the disc in the lower row, or from the left one in the same row. So a pair of a row adds to discs of that
//! row and of at most `ahead` rows further up. Rows are cut into bands at least twice as high as that. With `ahead` = 2:
//!
//! ```text
//!   row 11 ┐               stage 1   ─┐ adds to rows 10 to 13
//!   row 10 │               stage 1   ─┘
//!   row  9 │ band B        stage 0   ─┐
//!    ...   │                ...       │ adds to rows 6 to 11
//!   row  6 ┘               stage 0   ─┘
//!   row  5 ┐               stage 1   ─┐ adds to rows 4 to 7
//!   row  4 │               stage 1   ─┘
//!   row  3 │ band A        stage 0   ─┐
//!    ...   │                ...       │ adds to rows 0 to 5
//!   row  0 ┘               stage 0   ─┘
//! ```
//!
//! With fewer bands than threads, and most of the work in the search (coarse [`Sectors`](super::Sectors)), all threads find the
//! pairs of one band together. One thread then adds them up, in the same order.
//!
//! Within a stage no two bands add to the same row, so threads need no copies of the sums and no atomic additions. The bands
//! depend on the scene alone, so the order of every sum is the same on any number of threads. Partners of the last band beyond
//! the last row are, on a periodic side, those of the first rows, which band A does not touch in stage 1.

use super::contacts::{BandNotes, Evaluate, StatePointers, SumPointer};
use super::finder::{Finder, RankShare, RowLayout, SearchCursor};
use super::pairs::{PairBuffer, PairSequence};
use super::records::{ForceRecords, StateRecords};
use crate::InstructionSet;
use crate::backend::Precision;
use crate::backend::dispatch_native;
use crate::isa::{Element, ProgramError};
use crate::law::{self, Law, ObservationRequest};
use crate::threads::{in_stages, on_threads, pieces, threads};
use std::ops::Range;

/// Rows that one thread sweeps, with its buffers.
#[derive(Clone, Debug)]
struct RowBand<F> {
    /// Rows of the first stage, rows of the second, and rows whose extra pairs ([`Finder::find_extra_pairs`]) are found.
    rows: [Vec<Range<usize>>; 3],
    /// True if its notes belong to this rank.
    is_own: bool,
    found: F,
    notes: BandNotes,
    pairs: u64,
}

/// Result of a sweep: numbers of pairs and contacts, energies, and pairs that need attention.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepReport {
    /// Pairs the law was evaluated for, each once.
    pub pairs: u64,
    /// Pairs deeper than the watched depth.
    pub deep: Vec<[u32; 2]>,
    /// Pairs whose force is not finite. Two fixed discs that touch are such a pair.
    pub not_finite: Vec<[u32; 2]>,
    /// Power dissipated by the contacts (energy/time), if requested. The order of summation depends on the scene alone.
    pub dissipated: f64,
    /// Energy and virial of the pairs (energy), if requested. Summed in the same way.
    pub energy: [f64; 2],
    /// Contacts with at least one mobile disc, if energy is requested.
    pub contacts: u64,
    /// Deepest of these contacts (a fraction of the sum of the radii).
    pub deepest: f64,
    /// Contributions of the bands, whose sums are the totals above; lists of pairs are not split.
    pub of_bands: Vec<BandReport>,
}

/// Totals of one band.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BandReport {
    /// Pairs the law was evaluated for.
    pub pairs: u64,
    /// Power dissipated by the contacts (energy/time).
    pub dissipated: f64,
    /// Energy and virial of the pairs (energy).
    pub energy: [f64; 2],
    /// Contacts with at least one mobile disc.
    pub contacts: u64,
    /// Deepest of these contacts (a fraction of the sum of the radii).
    pub deepest: f64,
}

impl SweepReport {
    /// Adds up the bands in their order.
    #[inline]
    pub fn from_bands(of_bands: Vec<BandReport>) -> SweepReport {
        let mut met = SweepReport::default();
        for band in &of_bands {
            met.pairs += band.pairs;
            met.dissipated += band.dissipated;
            met.energy.iter_mut().zip(band.energy).for_each(|(sum, of_band)| *sum += of_band);
            met.contacts += band.contacts;
            met.deepest = met.deepest.max(band.deepest);
        }
        SweepReport { of_bands, ..met }
    }
}

/// Evaluates a law for all contacts, each once.
///
/// First every band sweeps all of its rows except the last ones; the partners are all in the band. Then every band sweeps its
/// last rows, whose partners may be in the first rows of the next band. Pairs outside the rows come last. So no two threads ever
/// add to one disc, and the order of every sum depends on the scene alone.
#[derive(Clone, Debug)]
pub struct Sweep<F> {
    rows: RowLayout,
    bands: Vec<RowBand<F>>,
    /// Pairs that threads find in one band, in its order.
    parts: Vec<F>,
}

/// Cost of evaluating a pair, in units of trying one; about one pair is found for each disc.
const EVALUATION: f64 = 16.0;
/// Parts of a band per searching thread; more than one because some take longer than others.
const PARTS: usize = 8;

/// True if it is cheaper that all threads find the pairs of one band after the other and one thread evaluates them, than that
/// each thread does all the work of a band. `tried` is the number of pairs tried per disc. No bit depends on the choice.
fn is_joint_search_cheaper(tried: f64, bands: usize, threads: usize) -> bool {
    tried / (threads as f64) + EVALUATION < (tried + EVALUATION) / bands.min(threads) as f64
}

impl<F: Clone + std::fmt::Debug + Default + Send> Sweep<F> {
    /// Sweep over these rows.
    #[inline]
    pub fn new(rows: RowLayout) -> Self {
        Sweep::for_share(rows, None)
    }

    /// Sweep over one rank's share of the rows. Sums are right for all discs within the margin of the share's rows, if the discs
    /// they depend on are present. Sums of other discs are not right.
    ///
    /// A rank repeats the pairs of a neighbouring band for discs it holds there, in the same order. Sums received from the other
    /// rank could not be added in the order of a single rank.
    #[inline]
    pub fn for_share(rows: RowLayout, share: Option<&RankShare>) -> Self {
        let ahead = rows.ahead;
        let bands = rows.bands().map(|band| {
            let inner = band.end.saturating_sub(ahead).max(band.start);
            let stages = [band.start..inner, inner..band.end, band.clone()];
            let own = share.is_none_or(|share| share.rows.contains(&band.start));
            let rows = match share {
                None => stages.map(|stage| vec![stage]),
                // Partners are ahead; those of the extra pairs may also be behind.
                Some(share) => {
                    let near = [share.margin + ahead, share.margin];
                    let [first, last, beside] = stages;
                    let of =
                        |stage: &Range<usize>, near: [usize; 2]| share.rows_near(stage, near, rows.count);
                    [of(&first, near), of(&last, near), of(&beside, [near[0], near[0]])]
                }
            };
            RowBand { rows, is_own: own, found: F::default(), notes: BandNotes::default(), pairs: 0 }
        });
        let bands = bands.filter(|band| band.is_own || band.rows.iter().any(|rows| !rows.is_empty()));
        Sweep { rows, bands: bands.collect(), parts: vec![] }
    }

    /// Adds the forces of `law` to the sums.
    ///
    /// # Errors
    /// [`ProgramError::NoSuchInstructionSet`], or [`ProgramError::Unstated`] for a law that reads a quantity it does not state;
    /// nothing was executed then.
    ///
    /// # Panics
    /// If the finder has other rows or discs, records have no entry for a quantity that the law reads, or there are fewer sums than
    /// discs.
    pub fn run<S: Element, P: Precision, L: Law<2> + Sync>(
        &mut self,
        law: &L,
        finder: &impl Finder<S, P, Found = F>,
        discs: &StateRecords<S>,
        sums: &mut ForceRecords<P>,
        asked: ObservationRequest,
        set: InstructionSet,
    ) -> Result<SweepReport, ProgramError> {
        assert!(self.rows == finder.rows(), "the finder's rows are not those the sweep was made for");
        law::check(law)?;
        let count = finder.discs();
        assert_eq!(discs.discs(), count, "the search and the records must have the same discs");
        assert!(discs.have(L::FIELDS), "the records have no entry for a quantity that the law reads");
        assert!(sums.discs() >= count, "fewer sums than the {count} discs");
        let sums = SumPointer(sums.numbers_mut());
        let state = StatePointers::new::<L>(discs);
        let sentinel = count as u32;
        let sweep = |band: &mut RowBand<F>, stage: usize| -> Result<(), ProgramError> {
            let RowBand { rows, found, notes, pairs: met, .. } = band;
            for rows in &rows[stage] {
                let mut cursor = SearchCursor::at(rows.start);
                while cursor.row < rows.end {
                    finder.find(discs, rows.clone(), &mut cursor, found, set)?;
                    let pairs = finder.pairs(found);
                    *met += pairs.count() as u64;
                    dispatch_native(
                        set,
                        Evaluate { law, pairs: &pairs, sentinel, state, sums, asked, notes },
                    )?;
                }
            }
            Ok(())
        };
        let threads = threads();
        if is_joint_search_cheaper(finder.pairs_tried(), self.bands.len(), threads) {
            self.parts.resize_with(PARTS * threads, F::default);
            for stage in 0..2 {
                for RowBand { rows, notes, pairs: met, .. } in &mut self.bands {
                    for rows in &rows[stage] {
                        let all = finder.search_items(rows.clone());
                        let length = all.len().div_ceil(PARTS * threads).max(1);
                        let cut = pieces(all, length).zip(&mut self.parts);
                        let searched = on_threads(cut, |(part, found)| {
                            finder.find_part(discs, part, found);
                            found
                        });
                        for found in searched {
                            let pairs = finder.pairs(found);
                            *met += pairs.count() as u64;
                            dispatch_native(
                                set,
                                Evaluate { law, pairs: &pairs, sentinel, state, sums, asked, notes },
                            )?;
                        }
                    }
                }
            }
        } else {
            in_stages(&mut self.bands, 2, sweep)?;
        }
        for RowBand { rows, notes, pairs: met, .. } in &mut self.bands {
            let mut beside = PairBuffer::default();
            rows[2].iter().for_each(|rows| finder.find_extra_pairs(rows.clone(), &mut beside));
            let pairs = &beside;
            if pairs.count() > 0 {
                *met += pairs.count() as u64;
                dispatch_native(set, Evaluate { law, pairs: &pairs, sentinel, state, sums, asked, notes })?;
            }
        }
        let (mut of_bands, mut deep, mut not_finite) = (vec![], vec![], vec![]);
        for band in &mut self.bands {
            let (notes, pairs) = (&mut band.notes, std::mem::take(&mut band.pairs));
            if band.is_own {
                of_bands.push(BandReport {
                    pairs,
                    dissipated: notes.dissipated,
                    energy: notes.energy,
                    contacts: notes.contacts,
                    deepest: notes.deepest,
                });
                deep.append(&mut notes.deep);
                not_finite.append(&mut notes.not_finite);
            }
            notes.clear();
        }
        Ok(SweepReport { deep, not_finite, ..SweepReport::from_bands(of_bands) })
    }
}
