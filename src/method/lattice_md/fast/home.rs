//! Where discs are looked for: on the lattice, in sectors, or in Verlet lists.

use super::state::{Move, State};
use crate::grid::sectors_of;
use crate::method::lattice_md::Model;
use crate::particles::Particles;
use crate::words::define_words;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::{ProgramError, Storage};
use stripmine_kernels::law::{Asked, Law};
use stripmine_kernels::sweep::fast::lattice::{Candidates, Codes, Lattice, Occupancy, Taken};
use stripmine_kernels::sweep::fast::{
    Copies, Discs, DisplacementLimit, Finder, Grid, GridError, Met, Rows, Sectors, Sweep, Touches, VerletList,
};

/// How the fast execution finds contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// On the lattice with at most one disc a cell.
    Lattice(OnConflict),
    /// In sectors, which hold any number of discs.
    Sectors,
    /// In lists of near partners, made anew whenever a disc has moved half the skin.
    Lists {
        /// How much farther than contact a listed pair may be (length).
        skin: f64,
    },
}

define_words! {
    /// What becomes of a disc whose lattice cell is another's.
    pub enum OnConflict {
        /// The run stops.
        Stop = "stop",
        /// It is kept in a list beside the lattice, and every such disc and step counted.
        Resolve = "resolve",
    }
}

/// Cells and who is in them. A disc's place is seen from the centre of its cell.
pub(super) enum Home<S, P> {
    /// Cells of the lattice.
    Lattice { occupancy: Occupancy, on_conflict: OnConflict, codes: Codes<P>, sweep: Sweep<Candidates> },
    /// Sectors.
    Sectors { sectors: Sectors, sweep: Sweep<Touches<P>> },
    /// The sectors in which discs were when the lists were made.
    Lists { sectors: Sectors, sweep: Sweep<Touches<P>>, lists: Lists<S> },
}

/// Lists, and what they were made from.
pub(super) struct Lists<S> {
    list: Option<VerletList>,
    skin: f64,
    /// Places when the lists were made.
    made_at: [Vec<S>; 2],
    /// How often they were made.
    pub(super) made: u64,
}

impl<S: Precision, P: Precision> Home<S, P> {
    /// With nobody at home.
    ///
    /// # Errors
    /// [`GridError`] if the box is none for sectors.
    pub(super) fn new(search: Search, model: &Model, particles: &Particles) -> Result<Self, GridError> {
        let radii = particles.radii();
        let largest = radii.map_or(1.0, |[_, largest]| largest);
        let (discs, reach) = (particles.len(), 2.0 * largest);
        let single = S::NAME != f64::NAME || P::NAME != f64::NAME;
        let sectors = |skin: f64| {
            let grid = sectors_of(&model.domain(), reach + skin, single, discs)?;
            Ok((Sectors::new(grid, discs, reach), Sweep::new(rows::<S, P, _>(&Sectors::new(grid, 0, reach)))))
        };
        Ok(match search {
            Search::Lattice(on_conflict) => {
                let vary = radii.is_some_and(|[smallest, largest]| smallest != largest);
                let occupancy = Occupancy::new(model.shape, model.frame, discs, reach, vary);
                let codes = Codes::new(&occupancy, model.frame);
                let sweep = Sweep::new(rows::<S, P, _>(&Lattice { occupancy: &occupancy, codes: &codes }));
                Home::Lattice { occupancy, on_conflict, codes, sweep }
            }
            Search::Sectors => {
                let (sectors, sweep) = sectors(0.0)?;
                Home::Sectors { sectors, sweep }
            }
            Search::Lists { skin } => {
                let (sectors, sweep) = sectors(skin)?;
                let lists = Lists { list: None, skin, made_at: [vec![], vec![]], made: 0 };
                Home::Lists { sectors, sweep, lists }
            }
        })
    }

    /// The cells: where they lie, how many there are, and which sides are periodic.
    pub(super) fn grid(&self) -> Grid {
        match self {
            Home::Lattice { occupancy, .. } => occupancy.grid(),
            Home::Sectors { sectors, .. } | Home::Lists { sectors, .. } => *sectors.grid(),
        }
    }

    /// Column and row of a disc; none if it is in no cell.
    pub(super) fn cell(&self, disc: usize) -> Option<[usize; 2]> {
        match self {
            Home::Lattice { occupancy, .. } => occupancy.cell(disc),
            Home::Sectors { sectors, .. } | Home::Lists { sectors, .. } => sectors.cell(disc),
        }
    }

    /// Whether a cell must hold one disc only.
    pub(super) fn is_exclusive(&self) -> bool {
        matches!(self, Home::Lattice { on_conflict: OnConflict::Stop, .. })
    }

    /// How many discs are in cells that are another disc's.
    pub(super) fn guests(&self) -> usize {
        match self {
            Home::Lattice { occupancy, .. } => occupancy.guests().len(),
            Home::Sectors { .. } | Home::Lists { .. } => 0,
        }
    }

    /// The disc that must have a cell to itself.
    pub(super) fn owner(&self, [column, row]: [usize; 2]) -> Option<usize> {
        match self {
            Home::Lattice { occupancy, on_conflict: OnConflict::Stop, .. } => occupancy.disc(column, row),
            Home::Lattice { .. } | Home::Sectors { .. } | Home::Lists { .. } => None,
        }
    }

    /// Takes a disc out of its cell.
    pub(super) fn leave(&mut self, disc: usize) {
        match self {
            Home::Lattice { occupancy, .. } => occupancy.leave(disc),
            Home::Sectors { sectors, .. } | Home::Lists { sectors, .. } => sectors.leave(disc),
        }
    }

    /// Puts a disc into a cell.
    ///
    /// # Errors
    /// [`Taken`] if the cell is another disc's.
    pub(super) fn enter(&mut self, to: &Move, model: &Model, state: &State<S>) -> Result<(), Taken> {
        let Move { disc, cell, place, .. } = *to;
        match self {
            Home::Lattice { occupancy, on_conflict, .. } => {
                let radius = |disc: usize| state.radius(model, disc);
                let entered = occupancy.enter(disc, cell, place, radius(disc));
                let Err(Taken(owner)) = entered else { return Ok(()) };
                if *on_conflict == OnConflict::Stop {
                    return entered;
                }
                // The cell is that one's with the smallest number: a state knows no history.
                let mut guest = disc;
                if state.number(disc) < state.number(owner) {
                    occupancy.leave(owner);
                    occupancy.enter(disc, cell, place, radius(disc))?;
                    guest = owner;
                }
                occupancy.enter_as_guest(guest, cell, |disc| state.number(disc));
                Ok(())
            }
            Home::Sectors { sectors, .. } | Home::Lists { sectors, .. } => {
                sectors.enter(disc, cell);
                Ok(())
            }
        }
    }

    /// What is to be done when discs have changed their cells.
    pub(super) fn settle(&mut self, model: &Model, state: &State<S>) {
        match self {
            Home::Lattice { occupancy, .. } => {
                // Guests whose host has gone have the cell to themselves.
                for (guest, cell) in occupancy.guests().to_vec() {
                    let guest = guest as usize;
                    if occupancy.disc(cell[0], cell[1]).is_none() {
                        occupancy.leave(guest);
                        let radius = state.radius(model, guest);
                        let entered = occupancy.enter(guest, cell, state.place(guest), radius);
                        debug_assert!(entered.is_ok(), "the cell is empty");
                    }
                }
                occupancy.repeat_images();
            }
            Home::Sectors { sectors, .. } | Home::Lists { sectors, .. } => {
                sectors.arrange(|disc| state.number(disc));
            }
        }
    }

    /// The discs in order of their cells.
    pub(super) fn order(&self) -> Vec<u32> {
        match self {
            Home::Lattice { occupancy, .. } => occupancy.order(),
            Home::Sectors { sectors, .. } | Home::Lists { sectors, .. } => sectors.order(),
        }
    }

    /// Disc `n` is from now on what disc `order[n]` was. Lists are to be made anew.
    pub(super) fn renumber(&mut self, order: &[u32]) {
        match self {
            Home::Lattice { occupancy, .. } => occupancy.renumber(order),
            Home::Sectors { sectors, .. } => sectors.renumber(order),
            Home::Lists { sectors, lists, .. } => {
                sectors.renumber(order);
                lists.list = None;
            }
        }
    }

    /// Makes lists, where there are such, from the state as it stands.
    pub(super) fn make_lists(&mut self, state: &State<S>) {
        if let Home::Lists { sectors, lists, .. } = self {
            let places = state.places();
            lists.made_at = places.map(<[S]>::to_vec);
            lists.list = Some(VerletList::new(sectors, places, lists.skin));
            lists.made += 1;
        }
    }

    /// The lists, where there are such.
    pub(super) fn lists(&self) -> Option<&Lists<S>> {
        match self {
            Home::Lists { lists, .. } => Some(lists),
            Home::Lattice { .. } | Home::Sectors { .. } => None,
        }
    }

    /// How far discs may go, and what else is written when they do.
    pub(super) fn displacement_limit(&mut self) -> (DisplacementLimit<'_, S>, Option<Copies<'_>>) {
        match self {
            Home::Lattice { occupancy, .. } => {
                (DisplacementLimit::Cell(occupancy.grid().frame.edge), occupancy.copies())
            }
            Home::Sectors { sectors, .. } => (DisplacementLimit::Cell(sectors.grid().frame.edge), None),
            Home::Lists { lists, .. } => {
                let [x, y] = &lists.made_at;
                (DisplacementLimit::From { places: [x, y], distance: 0.5 * lists.skin }, None)
            }
        }
    }

    /// All contacts with a law.
    pub(super) fn sweep<L: Law<2> + Sync>(
        &mut self,
        law: &L,
        discs: &Discs<'_, S>,
        sums: [&mut [P]; 3],
        asked: Asked,
        set: InstructionSet,
    ) -> Result<Met, ProgramError> {
        match self {
            Home::Lattice { occupancy, codes, sweep, .. } => {
                sweep.run(law, &Lattice { occupancy, codes }, discs, sums, asked, set)
            }
            Home::Sectors { sectors, sweep } => sweep.run(law, sectors, discs, sums, asked, set),
            Home::Lists { sweep, lists, .. } => match &lists.list {
                Some(list) => sweep.run(law, list, discs, sums, asked, set),
                None => Ok(Met::default()),
            },
        }
    }
}

impl<S: Precision> Lists<S> {
    /// Pairs listed.
    pub(super) fn entries(&self) -> usize {
        self.list.as_ref().map_or(0, VerletList::entries)
    }

    /// How much farther than contact a listed pair may be (length).
    pub(super) fn skin(&self) -> f64 {
        self.skin
    }

    /// Where a disc was when the lists were made.
    pub(super) fn made_at(&self, axis: usize) -> &[S] {
        &self.made_at[axis]
    }

    /// Whether a disc at a place is as far from there as it may be.
    pub(super) fn has_strayed(&self, disc: usize, place: [f64; 2]) -> bool {
        let [dx, dy] = [0, 1].map(|axis| place[axis] - self.made_at[axis][disc].to_f64());
        dx * dx + dy * dy > 0.25 * self.skin * self.skin
    }
}

fn rows<S: Precision, P: Precision, F: Finder<S, P>>(finder: &F) -> Rows {
    finder.rows()
}
