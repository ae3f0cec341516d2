//! Elements of plane walls, found by the cell of a disc.

use super::{PlaneWalls, WallTracks};
use crate::method::pairwise::PrescribedMotion;
use std::sync::Arc;
use stripmine_kernels::isa::Element;
use stripmine_kernels::sweep::fast::CellGrid;
use stripmine_kernels::sweep::walls::{ELEMENT_NUMBERS, elements};

/// Element of a wall that a disc in a cell may touch, its position relative to the cell's centre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GridElement<P> {
    /// Number of the cell.
    cell: u32,
    /// Number of the wall.
    pub(crate) wall: u32,
    /// Numbers of the element.
    pub(crate) numbers: [P; ELEMENT_NUMBERS],
}

/// Elements of all walls in a grid of cells.
pub(crate) struct WallGrid<P> {
    walls: Arc<PlaneWalls>,
    grid: CellGrid,
    /// Largest distance of a disc from its cell (length).
    margin: f64,
    /// Number of the first element of each cell, from 1; 0 without elements.
    first: Vec<u32>,
    elements: Vec<GridElement<P>>,
    /// Motions of the walls of the elements.
    motions: Vec<PrescribedMotion>,
}

impl<P: Element> WallGrid<P> {
    /// Elements at the start, for discs that may be `margin` outside their cells (length).
    pub(crate) fn new(walls: Arc<PlaneWalls>, grid: CellGrid, margin: f64) -> WallGrid<P> {
        let first = vec![0; grid.counts[0] * grid.counts[1]];
        let motions = WallTracks::new(&walls).now().to_vec();
        let mut made = WallGrid { walls, grid, margin, first, elements: vec![], motions };
        made.place();
        made
    }

    /// Replaces the walls by the same walls, joined otherwise and moved.
    pub(crate) fn move_walls(&mut self, walls: &Arc<PlaneWalls>, motions: &[PrescribedMotion]) {
        if motions != self.motions || !Arc::ptr_eq(walls, &self.walls) {
            self.walls = walls.clone();
            self.motions.copy_from_slice(motions);
            self.place();
        }
    }

    fn place(&mut self) {
        self.elements.iter().for_each(|element| self.first[element.cell as usize] = 0);
        let surfaces = self.walls.surfaces_at(&self.motions);
        let found =
            elements(&self.grid, &self.walls.pieces_at(&self.motions), self.walls.reach(), self.margin);
        self.elements = found
            .into_iter()
            .map(|found| {
                let numbers = found.shape.numbers(&surfaces[found.wall as usize], [0.0; 2]);
                let cell = self.number(found.cell) as u32;
                GridElement { cell, wall: found.wall, numbers: numbers.map(P::from_f64) }
            })
            .collect();
        // The first of each cell is entered last.
        for (at, element) in self.elements.iter().enumerate().rev() {
            self.first[element.cell as usize] = at as u32 + 1;
        }
    }

    fn number(&self, [column, row]: [usize; 2]) -> usize {
        row * self.grid.counts[0] + column
    }

    /// Elements that a disc in a cell may touch, in the order of the walls.
    pub(crate) fn in_cell(&self, cell: [usize; 2]) -> &[GridElement<P>] {
        let number = self.number(cell);
        let Some(first) = self.first[number].checked_sub(1) else { return &[] };
        let from = &self.elements[first as usize..];
        let count = from.iter().take_while(|element| element.cell as usize == number).count();
        &from[..count]
    }
}
