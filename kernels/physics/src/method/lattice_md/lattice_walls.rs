//! Plane walls on the lattice of the programs: their elements in runs that touch each cell once.

use super::GranularModel;
use super::wall_law::with_wall_law;
use crate::method::pairwise::{LawTask, PrescribedMotion, WallTouch};
use std::ops::Range;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::{AlignedColumn, Array, Memory, Slot};
use stripmine_kernels::law::Law;
use stripmine_kernels::sweep::fast::CellGrid;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::sweep::walls::{ELEMENT_NUMBERS, TouchingDisc, WALL_ARRAYS, elements, touch};

/// Largest distance by which a position is rounded out of its cell, relative to the cell.
const BESIDE: f64 = 1e-3;

/// Elements of the plane walls now.
#[derive(Clone, Debug, Default)]
pub(super) struct LatticeWalls<P> {
    /// Elements with the same place among those of their cell follow each other.
    runs: Vec<Range<usize>>,
    /// Position of each element's cell in lattice vectors, from 1.
    cells: AlignedColumn<u32>,
    walls: Vec<u32>,
    numbers: [AlignedColumn<P>; ELEMENT_NUMBERS],
}

impl<P: Precision> LatticeWalls<P> {
    /// Elements of a model's moved walls.
    pub(super) fn new(model: &GranularModel, motions: &[PrescribedMotion]) -> Self {
        let (walls, shape) = (&model.walls, model.shape);
        let (counts, periodic) = ([shape.columns(), shape.rows()], shape.periodic());
        let grid = CellGrid { frame: model.frame, counts, periodic };
        let [x, y] = model.frame.edge;
        let found = elements(&grid, &walls.pieces_at(motions), walls.reach(), BESIDE * x.min(y));
        let surfaces = walls.surfaces_at(motions);
        let mut place = 0;
        let mut before = None;
        let mut placed: Vec<(usize, u32, u32, [f64; ELEMENT_NUMBERS])> = found
            .iter()
            .map(|element| {
                place = if before == Some(element.cell) { place + 1 } else { 0 };
                before = Some(element.cell);
                let [column, row] = element.cell;
                let cell = shape.position(column as isize, row as isize) as u32 + 1;
                let centre = match model.coordinates {
                    Coordinates::CellRelative => [0.0; 2],
                    Coordinates::Absolute => model.position(cell, [0.0; 2]),
                };
                let numbers = element.shape.numbers(&surfaces[element.wall as usize], centre);
                (place, cell, element.wall, numbers)
            })
            .collect();
        placed.sort_by_key(|(place, ..)| *place);
        let runs = placed.chunk_by(|a, b| a.0 == b.0).scan(0, |end, run| {
            let start = std::mem::replace(end, *end + run.len());
            Some(start..*end)
        });
        let column = |number: usize| {
            let values = placed.iter().map(|(.., numbers)| P::from_f64(numbers[number]));
            AlignedColumn::new(WALL_ARRAYS[number] as usize, values)
        };
        LatticeWalls {
            runs: runs.collect(),
            cells: AlignedColumn::new(Array::WallCell as usize, placed.iter().map(|(_, cell, ..)| *cell)),
            walls: placed.iter().map(|(_, _, wall, _)| *wall).collect(),
            numbers: std::array::from_fn(column),
        }
    }

    /// Ranges of elements in different cells.
    pub(super) fn runs(&self) -> Vec<Range<usize>> {
        self.runs.clone()
    }

    /// Binds the arrays to their slots.
    pub(super) fn bind<'a>(&'a self, memory: &mut Memory<'a>) {
        memory.bind_read(Slot::new(Array::WallCell), &self.cells);
        for (array, column) in WALL_ARRAYS.into_iter().zip(&self.numbers) {
            memory.bind_read(Slot::new(array), column);
        }
    }

    /// Lists the contacts of the discs on the lattice; `in_cell` gives the grain at a position of a lattice vector, and its number. They are in the order of their numbers, then of the walls.
    pub(super) fn touches(
        &self,
        model: &GranularModel,
        in_cell: impl Fn(usize) -> Option<(usize, TouchingDisc<P>)>,
    ) -> Vec<WallTouch> {
        with_wall_law(model.wall_law(), TouchTask { walls: self, in_cell })
    }
}

/// Search for contacts under a law.
struct TouchTask<'a, P, F> {
    walls: &'a LatticeWalls<P>,
    in_cell: F,
}

impl<P: Precision, F: Fn(usize) -> Option<(usize, TouchingDisc<P>)>> LawTask for TouchTask<'_, P, F> {
    type Output = Vec<WallTouch>;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Vec<WallTouch> {
        let TouchTask { walls, in_cell } = self;
        let mut found = vec![];
        for (element, (&cell, &wall)) in walls.cells.iter().zip(&walls.walls).enumerate() {
            let Some((number, disc)) = in_cell(cell as usize - 1) else { continue };
            let numbers = walls.numbers.each_ref().map(|column| column[element]);
            if let Some(contact) = touch(&law, &disc, &numbers) {
                found.push(WallTouch::new(number, wall, disc.radius.to_f64(), &contact));
            }
        }
        found.sort_by_key(|touch| touch.disc);
        found
    }
}
