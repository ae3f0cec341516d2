//! Cells of the discs: which discs change them, and when lists are rebuilt.

use super::search::{PairSearch, SearchCells};
use super::state::CellMove;
use super::{NameableDiscs, PairEngine, conflict, outside};
use crate::method::{Culprit, PhysicsFailure};
use std::ops::Range;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::over_pieces;
use stripmine_kernels::sweep::fast::CellGrid;
use stripmine_kernels::sweep::fast::lattice::CellTaken;

/// Result of a search for cells: changes of cells, and discs that belong to no cell.
#[derive(Default)]
pub(super) struct CellSearchResult {
    moves: Vec<CellMove>,
    strays: Vec<CellMove>,
}

/// Change of cell of a disc owned by this rank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CellChange {
    /// Number of the disc in the scene.
    pub(super) number: u32,
    /// Old and new row.
    pub(super) rows: [usize; 2],
    /// Periods that it has crossed.
    pub(super) periods: [f64; 2],
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> PairEngine<S, P, Q> {
    /// Returns a position (length) from one relative to a cell's centre.
    fn absolute_from_relative(&self, cell: [usize; 2], place: [f64; 2]) -> [f64; 2] {
        let frame = self.search.cells().grid().frame;
        [0, 1].map(|axis| frame.origin[axis] + (cell[axis] as f64 + 0.5) * frame.edge[axis] + place[axis])
    }

    /// Returns the position (length) of a disc at `place` relative to its cell.
    pub(super) fn absolute_position(&self, disc: usize, place: [f64; 2]) -> [f64; 2] {
        self.absolute_from_relative(self.search.cells().cell(disc).unwrap_or_default(), place)
    }

    /// Returns the cell of a disc at a position (length), and the position relative to its centre.
    pub(super) fn locate(&self, disc: usize, position: [f64; 2]) -> Result<CellMove, PhysicsFailure> {
        let from = self.relative_to_first_cell(disc, position);
        self.in_containing_cell(from).ok_or_else(|| self.stray(from, 1))
    }

    /// Returns the row of a position (length); none outside all cells.
    pub(super) fn row_at(&self, position: [f64; 2]) -> Option<usize> {
        Some(self.in_containing_cell(self.relative_to_first_cell(0, position))?.cell[1])
    }

    /// Returns a disc at a position (length), relative to the first cell.
    fn relative_to_first_cell(&self, disc: usize, position: [f64; 2]) -> CellMove {
        let frame = self.search.cells().grid().frame;
        let place = [0, 1].map(|axis| position[axis] - (frame.origin[axis] + 0.5 * frame.edge[axis]));
        CellMove { disc, cell: [0, 0], place, periods: [0.0; 2] }
    }

    /// Returns a disc relative to the cell that contains it, from a position that may be outside the given cell; none if no cell contains it.
    fn in_containing_cell(&self, from: CellMove) -> Option<CellMove> {
        let CellMove { cell, place, .. } = from;
        let CellGrid { frame, counts, periodic } = self.search.cells().grid();
        let mut to = from;
        for axis in 0..2 {
            let (edge, count) = (frame.edge[axis], counts[axis] as f64);
            if place[axis].abs() < 0.5 * edge {
                continue;
            }
            let steps = (place[axis] / edge + 0.5).floor();
            let mut there = cell[axis] as f64 + steps;
            to.place[axis] = place[axis] - steps * edge;
            let is_near = (-count..2.0 * count).contains(&there);
            if periodic[axis] && (is_near || self.system.crosses_any && there.is_finite()) {
                let inside = there.rem_euclid(count);
                to.periods[axis] = (there - inside) / count;
                there = inside;
            } else if there == count && to.place[axis] <= -0.5 * edge {
                // On the far boundary, which belongs to the last cell.
                there -= 1.0;
                to.place[axis] += edge;
            }
            if !(0.0..count).contains(&there) {
                return None;
            }
            to.cell[axis] = there as usize;
        }
        Some(to)
    }

    /// Updates the cells after a pass: walls, discs beyond their limit, halo, lists.
    pub(super) fn update_cells_and_lists(&mut self, left: &[u32]) -> Result<(), PhysicsFailure> {
        if self.search.lists().is_some() {
            if self.is_stale(left)? {
                self.rebuild_lists()?;
            }
            return Ok(());
        }
        self.update_cells(left).map(drop)
    }

    /// Returns the current positions of moving walls.
    fn walls_now(&mut self) -> Result<Vec<CellMove>, PhysicsFailure> {
        let Some(prescribed) = self.prescribed() else { return Ok(vec![]) };
        self.update_wall_velocity();
        let now = |disc: usize| {
            let at = self.start.all()[self.state.number(disc)].position;
            let [dx, dy] = prescribed.displacement;
            self.locate(disc, [at[0] + dx, at[1] + dy])
        };
        (self.state.grains()..self.state.len()).map(now).collect()
    }

    /// Updates the cells where there are no lists.
    pub(super) fn update_cells(&mut self, left: &[u32]) -> Result<Vec<CellChange>, PhysicsFailure> {
        let walls = self.walls_now()?;
        let left = left.iter().map(|&disc| disc as usize);
        let left = left.chain(self.neighbours().filter(|&disc| !self.stays_in_cell(disc)));
        let mut moves = self.changes_of(vec![self.search_cells(left)])?;
        self.changes += moves.len();
        moves.extend(walls);
        let moved = self.change_cells(&moves)?;
        match self.reaches_beyond_box() {
            true => self.beyond_box().map_or(Ok(moved), Err),
            false => Ok(moved),
        }
    }

    /// Grains of neighbouring ranks.
    pub(super) fn neighbours(&self) -> Range<usize> {
        self.state.moving()..self.state.grains()
    }

    /// True if a pass would leave the disc in its cell. The comparison is that of `DisplacementLimit::Cell`, to the bit: a disc on the rim must be
    /// in one cell on all ranks.
    fn stays_in_cell(&self, disc: usize) -> bool {
        let (place, edge) = (self.state.place(disc), self.search.cells().grid().frame.edge);
        (0..2).all(|axis| place[axis].abs() <= S::from_f64(0.5 * edge[axis]).to_f64())
    }

    /// True if a disc may be outside the box and yet in a cell.
    fn reaches_beyond_box(&self) -> bool {
        let CellGrid { frame, counts, .. } = self.search.cells().grid();
        let filled = |axis: usize| counts[axis] as f64 * frame.edge[axis];
        (0..2).any(|axis| filled(axis) > self.system.domain.length(axis) * (1.0 + 1e-12))
    }

    /// Failure of a disc outside all cells.
    fn stray(&self, at: CellMove, count: u64) -> PhysicsFailure {
        outside(self.clock(), count, self.culprit_at(&at))
    }

    /// Disc at a prospective position.
    fn culprit_at(&self, at: &CellMove) -> Culprit {
        let disc = at.disc;
        Culprit::in_plane(
            "disc",
            self.id(disc),
            self.absolute_from_relative(at.cell, at.place),
            self.velocity(disc),
        )
    }

    /// Searches the cells that contain some discs.
    pub(super) fn search_cells(&self, discs: impl Iterator<Item = usize>) -> CellSearchResult {
        let mut looked = CellSearchResult::default();
        for disc in discs {
            let cell = self.search.cells().cell(disc).unwrap_or_default();
            let from = CellMove { disc, cell, place: self.state.place(disc), periods: [0.0; 2] };
            match self.in_containing_cell(from) {
                Some(to) if to == from => {}
                Some(to) => looked.moves.push(to),
                // Its own rank reports it.
                None if self.neighbours().contains(&disc) => {}
                None => looked.strays.push(from),
            }
        }
        looked
    }

    /// Returns the changes of cells, or a failure if a disc belongs to no cell.
    pub(super) fn changes_of(&self, looked: Vec<CellSearchResult>) -> Result<Vec<CellMove>, PhysicsFailure> {
        let strays = || looked.iter().flat_map(|looked| &looked.strays);
        match strays().min_by_key(|from| self.state.number(from.disc)) {
            Some(&first) => Err(self.stray(first, strays().count() as u64)),
            None => Ok(looked.into_iter().flat_map(|looked| looked.moves).collect()),
        }
    }

    /// Moves walls within the cells in which they are listed; returns true if a disc has gone so far that lists must be rebuilt.
    pub(super) fn is_stale(&mut self, left: &[u32]) -> Result<bool, PhysicsFailure> {
        let walls = self.walls_now()?;
        let edge = self.search.cells().grid().frame.edge;
        let domain = self.system.domain;
        let mut stale = !left.is_empty();
        for to in &walls {
            let (from, cell) = (self.search.cells().cell(to.disc).unwrap_or_default(), to.cell);
            let centre = |cell: [usize; 2]| [0, 1].map(|axis| cell[axis] as f64 * edge[axis]);
            let displacement = domain.displacement(centre(from), centre(cell));
            let place = [0, 1].map(|axis| to.place[axis] + displacement[axis]);
            self.state.put(to.disc, place);
            stale |= self.search.lists().is_some_and(|lists| lists.has_strayed(to.disc, place));
        }
        let outside = |&&disc: &&u32| self.is_outside(disc as usize);
        if let Some(&first) = self
            .boundary_candidates
            .iter()
            .filter(outside)
            .min_by_key(|&&disc| self.state.number(disc as usize))
        {
            let count = self.boundary_candidates.iter().filter(outside).count() as u64;
            let cell = self.search.cells().cell(first as usize).unwrap_or_default();
            let place = self.state.place(first as usize);
            return Err(self.stray(CellMove { disc: first as usize, cell, place, periods: [0.0; 2] }, count));
        }
        Ok(stale)
    }

    /// Rebuilds the lists.
    pub(super) fn rebuild_lists(&mut self) -> Result<Vec<CellChange>, PhysicsFailure> {
        let looked = over_pieces(0..self.state.len(), |discs| self.search_cells(discs));
        let moves = self.changes_of(looked)?;
        let moved = self.change_cells(&moves)?;
        self.changes += moves.len();
        // A disc that has changed its sector is still near its neighbours in memory: sorting takes a fifth of a rebuild.
        if self.changes > self.state.grains() / 8 {
            self.sort_by_cell();
        } else {
            self.make_lists();
        }
        Ok(moved)
    }

    /// Returns the discs that may leave through an open side before lists are rebuilt.
    pub(super) fn discs_near_open_sides(&self) -> Vec<u32> {
        let domain = &self.system.domain;
        let Some(lists) = self.search.lists().filter(|_| domain.periodic() != [true; 2]) else {
            return vec![];
        };
        // Slightly more than the range of the lists, so that rounding hides no disc.
        let reach = 0.5 * lists.skin() * (1.0 + 1e-6);
        let near = |disc: usize| {
            let position = self.position(disc);
            (0..2).filter(|&axis| !domain.is_periodic(axis)).any(|axis| {
                let along = position[axis] - domain.origin[axis];
                !(reach..=domain.length(axis) - reach).contains(&along)
            })
        };
        let others = self.neighbours();
        let near = |discs: Range<usize>| -> Vec<u32> {
            let own = discs.filter(|disc| !others.contains(disc));
            own.filter(|&disc| near(disc)).map(|disc| disc as u32).collect()
        };
        over_pieces(0..self.state.len(), near).concat()
    }

    /// True if a disc is beyond an open side.
    pub(super) fn is_outside(&self, disc: usize) -> bool {
        let cell = self.search.cells().cell(disc).unwrap_or_default();
        let from = CellMove { disc, cell, place: self.state.place(disc), periods: [0.0; 2] };
        self.in_containing_cell(from).is_none()
    }

    /// Moves discs into their new cells and returns the changes of this rank's discs. If two discs want an exclusive cell, none is moved.
    pub(super) fn change_cells(&mut self, moves: &[CellMove]) -> Result<Vec<CellChange>, PhysicsFailure> {
        if self.search.cells().is_exclusive() {
            self.reject_conflicts(moves)?;
        }
        let others = self.neighbours();
        let own = moves.iter().filter(|to| !others.contains(&to.disc));
        let moved = own.map(|to| {
            let from = self.search.cells().cell(to.disc).unwrap_or(to.cell);
            let number = self.state.number(to.disc) as u32;
            CellChange { number, rows: [from[1], to.cell[1]], periods: to.periods }
        });
        let moved = moved.collect();
        moves.iter().for_each(|to| self.search.cells_mut().leave(to.disc));
        for to in moves {
            if to.disc < self.state.moving() {
                self.elapsed.crossings.add(self.state.number(to.disc), to.periods);
            }
            self.state.put(to.disc, to.place);
            if let Err(CellTaken(owner)) = self.search.cells_mut().enter(to, &self.state) {
                // Conflicts are rejected above: a disc without a cell would silently interact with nothing.
                let culprits = [self.culprit(owner), self.culprit_at(to)];
                return Err(conflict(self.clock(), self.system.domain, culprits));
            }
        }
        self.search.cells_mut().arrange(&self.state);
        Ok(moved)
    }

    /// Fails if two discs want one cell.
    fn reject_conflicts(&self, moves: &[CellMove]) -> Result<(), PhysicsFailure> {
        let mut targets: Vec<([usize; 2], usize)> = moves.iter().map(|to| (to.cell, to.disc)).collect();
        targets.sort_unstable();
        let mut moving: Vec<usize> = moves.iter().map(|to| to.disc).collect();
        moving.sort_unstable();
        let twice = targets.windows(2).find(|pair| pair[0].0 == pair[1].0).map(|pair| (pair[0].1, pair[1].1));
        let taken = || {
            targets.iter().find_map(|&(cell, disc)| {
                let there = self.search.cells().owner(cell)?;
                moving.binary_search(&there).is_err().then_some((there, disc))
            })
        };
        if let Some((first, second)) = twice.or_else(taken) {
            let culprit = |disc: usize| {
                let to = moves.iter().find(|to| to.disc == disc);
                to.map_or_else(|| self.culprit(disc), |to| self.culprit_at(to))
            };
            return Err(conflict(self.clock(), self.system.domain, [culprit(first), culprit(second)]));
        }
        Ok(())
    }
}
