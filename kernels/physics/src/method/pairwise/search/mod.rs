//! How the fast engine finds pairs: on a lattice, in sectors, or in Verlet lists.

mod lattice;
mod lists;
mod sectors;

pub(crate) use lattice::LatticeSearch;
pub use lattice::OnConflict;
pub(crate) use lists::{ListSearch, Listed};
pub(crate) use sectors::SectorSearch;

use super::state::{Move, State};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::{Asked, Law};
use stripmine_kernels::sweep::fast::lattice::Taken;
use stripmine_kernels::sweep::fast::{
    Copies, Discs, DisplacementLimit, Finder, Grid, Met, Rows, Share, Sweep,
};

/// Cells, and which discs are in them. A disc's place is seen from the centre of its cell.
pub(crate) trait Cells<S: Precision>: Send + Sync {
    /// Where the cells lie, how many there are, and which sides are periodic.
    fn grid(&self) -> Grid;

    /// Column and row of a disc; none if it is in no cell.
    fn cell(&self, disc: usize) -> Option<[usize; 2]>;

    /// Takes a disc out of its cell.
    fn leave(&mut self, disc: usize);

    /// Puts a disc into a cell.
    ///
    /// # Errors
    /// [`Taken`] if the cell is another disc's.
    fn enter(&mut self, to: &Move, state: &State<S>) -> Result<(), Taken>;

    /// A disc that stays in its cell is at another place there.
    fn settle(&mut self, _disc: usize, _place: [f64; 2]) {}

    /// What is to be done when discs have changed their cells.
    fn arrange(&mut self, state: &State<S>);

    /// The discs in order of their cells.
    fn order(&self) -> Vec<u32>;

    /// Disc `n` is from now on what disc `order[n]` was.
    fn renumber(&mut self, order: &[u32]);

    /// Whether a cell must hold one disc only.
    fn is_exclusive(&self) -> bool {
        false
    }

    /// The disc that a cell holds, where it must hold one only.
    fn owner(&self, _cell: [usize; 2]) -> Option<usize> {
        None
    }

    /// How many of some discs are in cells that are another disc's, where one disc has a cell.
    fn shared_cells(&self, _counts: &dyn Fn(usize) -> bool) -> usize {
        0
    }
}

/// Pairs, found with the help of cells.
///
/// The engine is compiled for each search: what a search does not need costs nothing.
pub(crate) trait Search<S: Precision, P: Precision>: Send + Sync {
    /// The kind of cells.
    type Cells: Cells<S>;

    /// The same for as many discs in the scene, with room for `discs` of them, none in it, and those rows that a rank sees to.
    fn emptied(&self, discs: usize, share: Share) -> Self;

    /// The rows of cells that a sweep is made for.
    fn rows(&self) -> Rows;

    fn cells(&self) -> &Self::Cells;

    /// The same, to be changed.
    fn cells_mut(&mut self) -> &mut Self::Cells;

    /// How far discs may go, and what else is written when they do.
    fn displacement_limit(&mut self) -> (DisplacementLimit<'_, S>, Option<Copies<'_>>);

    /// All pairs with a law.
    ///
    /// # Errors
    /// [`ProgramError`] if the processor lacks the instructions, or the law asks for what it does not state.
    fn sweep<L: Law<2> + Sync>(
        &mut self,
        law: &L,
        discs: &Discs<'_, S>,
        sums: [&mut [P]; 3],
        asked: Asked,
        set: InstructionSet,
    ) -> Result<Met, ProgramError>;

    /// Energy, virial, number and depth of the contacts of discs in the cells or lists as they stand, at places up to `moved`
    /// (length) from those of the last [`sweep`](Self::sweep). Nothing is changed.
    ///
    /// # Errors
    /// As [`sweep`](Self::sweep).
    fn observe<L: Law<2> + Sync>(
        &self,
        law: &L,
        discs: &Discs<'_, f64>,
        moved: f64,
        set: InstructionSet,
    ) -> Result<Met, ProgramError>;

    /// Makes lists, where there are such, from the state as it stands. Due whenever discs were renumbered.
    fn make_lists(&mut self, _state: &State<S>) {}

    /// From now on lists count as made so often.
    fn set_lists_made(&mut self, _made: u64) {}

    /// The lists, where there are such.
    fn lists(&self) -> Option<&Listed<S>> {
        None
    }
}

/// What a sweep in double precision sees of the pairs of a finder: the sweep of the forces in that precision, so that nothing
/// more is compiled; its forces are thrown away.
fn observed<F: Finder<f64, f64>, L: Law<2> + Sync>(
    law: &L,
    finder: &F,
    share: Option<&Share>,
    discs: &Discs<'_, f64>,
    set: InstructionSet,
) -> Result<Met, ProgramError> {
    let mut sums = [0, 1, 2].map(|_| vec![0.0; discs.place[0].len()]);
    let asked = Asked { energy: true, ..Asked::default() };
    Sweep::of_share(finder.rows(), share).run(
        law,
        finder,
        discs,
        sums.each_mut().map(Vec::as_mut_slice),
        asked,
        set,
    )
}

/// The rows that a sweep for a finder is made for.
fn rows<S: Precision, P: Precision, F: Finder<S, P>>(finder: &F) -> Rows {
    finder.rows()
}
