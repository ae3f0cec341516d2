//! A sweep in bands of rows, on any number of threads.
//!
//! Pairs are found from the disc in the lower row (or to the left in the same one), so that a pair of a row adds to discs of
//! that row and of at most `ahead` rows further up. Rows are cut into bands at least twice as high as that. With `ahead` = 2:
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
//! Where there are fewer bands than threads and most of the work is finding pairs (coarse [`Sectors`](super::Sectors)), all threads
//! find the pairs of a band together, and one adds them up, in the same order.
//!
//! Within a stage no two bands add to the same row. So threads need no copies of the sums and no atomic additions, and as the
//! bands are a function of the scene, the order of every sum is the same on any number of threads. The last band's partners
//! beyond the last row are, on a periodic side, those of the first rows, which band A leaves alone in stage 1.

use super::contacts::{Discs, Evaluate, Notes, SumColumns};
use super::finder::{Cursor, Finder, Rows, Share};
use super::pairs::{Pairs, SENTINELS, Touches};
use crate::InstructionSet;
use crate::backend::Precision;
use crate::backend::dispatch_native;
use crate::isa::{Element, ProgramError};
use crate::law::{self, Asked, Law};
use crate::threads::{in_stages, on_threads, pieces, threads};
use std::ops::Range;

/// Rows that one thread sweeps, and what it keeps for that.
#[derive(Clone, Debug)]
struct Band<F> {
    /// The rows to be swept in each of the two stages, and those beside whose search pairs are found.
    rows: [Vec<Range<usize>>; 3],
    /// Whether its notes are this rank's.
    is_own: bool,
    found: F,
    notes: Notes,
    pairs: u64,
}

/// What a sweep met.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Met {
    /// Pairs the law was asked about, each once.
    pub pairs: u64,
    /// Pairs deeper than watched.
    pub deep: Vec<[u32; 2]>,
    /// Pairs whose force is no finite number. Two fixed discs that touch are such a pair.
    pub not_finite: Vec<[u32; 2]>,
    /// What the contacts dissipate (energy/time), where that is asked for. Summed in an order that depends on the scene
    /// alone.
    pub dissipated: f64,
    /// Energy and virial of the pairs (energy), where they are asked for. Summed likewise.
    pub energy: [f64; 2],
    /// Contacts of which at least one disc may move, where energy is asked for.
    pub contacts: u64,
    /// The deepest of them (a fraction of the sum of the radii).
    pub deepest: f64,
    /// What all of that but the pairs listed is the sum of, band by band.
    pub of_bands: Vec<OfBand>,
}

/// What a band has met.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct OfBand {
    /// As of all.
    pub pairs: u64,
    /// As of all.
    pub dissipated: f64,
    /// As of all.
    pub energy: [f64; 2],
    /// As of all.
    pub contacts: u64,
    /// As of all.
    pub deepest: f64,
}

impl Met {
    /// Of bands, added up in their order.
    #[inline]
    pub fn of(of_bands: Vec<OfBand>) -> Met {
        let mut met = Met::default();
        for band in &of_bands {
            met.pairs += band.pairs;
            met.dissipated += band.dissipated;
            met.energy.iter_mut().zip(band.energy).for_each(|(sum, of_band)| *sum += of_band);
            met.contacts += band.contacts;
            met.deepest = met.deepest.max(band.deepest);
        }
        Met { of_bands, ..met }
    }
}

/// A law over all contacts, each met once.
///
/// First every band sweeps its rows but the last ones, whose partners are all its own; then every band sweeps its last
/// rows, whose partners may be the next band's first; last come the pairs that are in no row. So no two threads ever add to one disc, and the order of every
/// sum depends on the scene alone.
#[derive(Clone, Debug)]
pub struct Sweep<F> {
    rows: Rows,
    bands: Vec<Band<F>>,
    /// What threads find of one band, in its order.
    parts: Vec<F>,
}

/// What a pair that is found takes, over one that is tried; about one is found for each disc.
const EVALUATION: f64 = 16.0;
/// Parts of a band for each thread that searches them: some take longer than others.
const PARTS: usize = 8;

/// Whether it is cheaper that all threads find the pairs of one band after the other and one evaluates them, than that each
/// thread does all for a band; with `tried` pairs for each disc. No bit depends on it.
fn is_cheaper_apart(tried: f64, bands: usize, threads: usize) -> bool {
    tried / (threads as f64) + EVALUATION < (tried + EVALUATION) / bands.min(threads) as f64
}

impl<F: Clone + std::fmt::Debug + Default + Send> Sweep<F> {
    /// For rows of discs.
    #[inline]
    pub fn new(rows: Rows) -> Self {
        Sweep::of_share(rows, None)
    }

    /// For those rows of discs that one of several ranks sees to: sums are right for all discs that are no farther from its rows than its margin, if
    /// the discs are there on which they depend. All others' are not.
    ///
    /// Who has a disc beside a band of another rank does that band's pairs again, in the same order, rather than be told sums of them: those could
    /// not be added in the order of one rank alone.
    #[inline]
    pub fn of_share(rows: Rows, share: Option<&Share>) -> Self {
        let ahead = rows.ahead;
        let bands = rows.bands().map(|band| {
            let inner = band.end.saturating_sub(ahead).max(band.start);
            let stages = [band.start..inner, inner..band.end, band.clone()];
            let own = share.is_none_or(|share| share.rows.contains(&band.start));
            let rows = match share {
                None => stages.map(|stage| vec![stage]),
                // Partners lie ahead, but those of pairs beside rows also behind.
                Some(share) => {
                    let near = [share.margin + ahead, share.margin];
                    let [first, last, beside] = stages;
                    let of = |stage: &Range<usize>, near: [usize; 2]| share.near(stage, near, rows.count);
                    [of(&first, near), of(&last, near), of(&beside, [near[0], near[0]])]
                }
            };
            Band { rows, is_own: own, found: F::default(), notes: Notes::default(), pairs: 0 }
        });
        let bands = bands.filter(|band| band.is_own || band.rows.iter().any(|rows| !rows.is_empty()));
        Sweep { rows, bands: bands.collect(), parts: vec![] }
    }

    /// Adds what `law` gives to the sums (force along x, along y, torque), an entry a disc and sentinel.
    ///
    /// # Errors
    /// [`ProgramError::NoSuchInstructionSet`], or [`ProgramError::Unstated`] for a law that asks for what it does not state;
    /// nothing was executed then.
    ///
    /// # Panics
    /// If the rows are others, a column that the law asks for has not an entry for every disc and sentinel, or one of
    /// the sums has none for a disc.
    pub fn run<S: Element, P: Precision, L: Law<2> + Sync>(
        &mut self,
        law: &L,
        finder: &impl Finder<S, P, Found = F>,
        discs: &Discs<'_, S>,
        sums: [&mut [P]; 3],
        asked: Asked,
        set: InstructionSet,
    ) -> Result<Met, ProgramError> {
        assert!(self.rows == finder.rows(), "a sweep is made for its rows");
        law::check(law)?;
        let count = finder.discs();
        assert!(discs.suffice(L::FIELDS, count), "columns of {count} discs and {SENTINELS} sentinels");
        let mut columns = sums.map(|sum| (sum.len(), sum.as_mut_ptr()));
        assert!(L::SUMS.iter().all(|sum| columns[sum.column::<2>()].0 >= count), "sums of {count} discs");
        let sums = SumColumns(columns.each_mut().map(|column| column.1));
        let sentinel = count as u32;
        let sweep = |band: &mut Band<F>, stage: usize| -> Result<(), ProgramError> {
            let Band { rows, found, notes, pairs: met, .. } = band;
            for rows in &rows[stage] {
                let mut cursor = Cursor::at(rows.start);
                while cursor.row < rows.end {
                    finder.find(discs.place, rows.clone(), &mut cursor, found, set)?;
                    let pairs = finder.pairs(found);
                    *met += pairs.count() as u64;
                    dispatch_native(
                        set,
                        Evaluate { law, pairs: &pairs, sentinel, discs, sums, asked, notes },
                    )?;
                }
            }
            Ok(())
        };
        let threads = threads();
        if is_cheaper_apart(finder.tried(), self.bands.len(), threads) {
            self.parts.resize_with(PARTS * threads, F::default);
            for stage in 0..2 {
                for Band { rows, notes, pairs: met, .. } in &mut self.bands {
                    for rows in &rows[stage] {
                        let all = finder.searched(rows.clone());
                        let length = all.len().div_ceil(PARTS * threads).max(1);
                        let cut = pieces(all, length).zip(&mut self.parts);
                        let searched = on_threads(cut, |(part, found)| {
                            finder.find_part(discs.place, part, found);
                            found
                        });
                        for found in searched {
                            let pairs = finder.pairs(found);
                            *met += pairs.count() as u64;
                            dispatch_native(
                                set,
                                Evaluate { law, pairs: &pairs, sentinel, discs, sums, asked, notes },
                            )?;
                        }
                    }
                }
            }
        } else {
            in_stages(&mut self.bands, 2, sweep)?;
        }
        for Band { rows, notes, pairs: met, .. } in &mut self.bands {
            let mut beside = Touches::default();
            rows[2].iter().for_each(|rows| finder.find_beside(rows.clone(), &mut beside));
            let pairs = &beside;
            if pairs.count() > 0 {
                *met += pairs.count() as u64;
                dispatch_native(set, Evaluate { law, pairs: &pairs, sentinel, discs, sums, asked, notes })?;
            }
        }
        let (mut of_bands, mut deep, mut not_finite) = (vec![], vec![], vec![]);
        for band in &mut self.bands {
            let (notes, pairs) = (&mut band.notes, std::mem::take(&mut band.pairs));
            if band.is_own {
                of_bands.push(OfBand {
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
        Ok(Met { deep, not_finite, ..Met::of(of_bands) })
    }
}
