//! Linked cells with crossing events (Rapaport): a cell holds a chain of discs, and a disc that leaves it is an event.
//!
//! A cell is at least as wide as the largest disc, so a disc meets only discs of its own cell and of the eight around it. At a crossing the
//! disc is compared with the discs of the three cells that it did not see before. Its motion does not change.

use super::grid::{CellMisfit, DiscCells};
use crate::domain::{BoxSide, Domain};
use crate::method::hard_disks::event::Arena;
use stripmine_kernels::flight::FlyingDisc;

/// Ends a chain.
const NONE: u32 = u32::MAX;
/// Fewest cells along a periodic side. With fewer, a disc in a neighbouring cell may be nearer across another side.
const FEWEST: usize = 4;
/// Factor by which cells are wider than the largest disc, so that rounding hides no partner.
const WIDER: f64 = 1.0 + 1e-9;

/// Numbers of cells along x and y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellCounts(pub(crate) [usize; 2]);

impl CellCounts {
    /// Cells of a closed or periodic box with about `discs_in_cell` of `count` discs each, whose largest radius is `largest` (length).
    /// Returns none if a periodic side is too short for such discs.
    pub(crate) fn new(domain: &Domain, count: usize, largest: f64, discs_in_cell: f64) -> Option<CellCounts> {
        let least = 2.0 * largest * WIDER;
        let edge = (discs_in_cell * domain.area() / count as f64).sqrt().max(least);
        let counts = [0, 1].map(|axis| {
            let side = domain.length(axis);
            let fewest = if domain.is_periodic(axis) { FEWEST } else { 1 };
            ((side / edge) as usize).max(fewest)
        });
        let fits = |axis: usize| !domain.is_periodic(axis) || domain.length(axis) / FEWEST as f64 >= least;
        (fits(0) && fits(1)).then_some(CellCounts(counts))
    }
}

/// Expected crossing of a disc.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Time of the crossing; infinite if the disc stays.
    time: f64,
    axis: u8,
    /// True if the disc enters the cell with the higher index.
    is_up: bool,
}

impl Crossing {
    /// The disc stays in its cell.
    const NEVER: Crossing = Crossing { time: f64::INFINITY, axis: 0, is_up: true };

    /// Step of the index.
    fn step(self) -> isize {
        if self.is_up { 1 } else { -1 }
    }
}

/// Linked cells with their discs.
#[derive(Clone, Debug)]
pub(crate) struct LinkedCells {
    domain: Domain,
    counts: [usize; 2],
    edge: [f64; 2],
    /// First disc of each cell, row by row.
    first: Vec<u32>,
    /// Next disc in the cell of each disc.
    next: Vec<u32>,
    /// Column and row of each disc.
    cell: Vec<[u32; 2]>,
    crossings: Vec<Crossing>,
}

impl LinkedCells {
    /// Creates the empty cells of a box without an open side.
    pub(super) fn new(domain: Domain, CellCounts(counts): CellCounts) -> LinkedCells {
        LinkedCells {
            domain,
            counts,
            edge: [0, 1].map(|axis| domain.length(axis) / counts[axis] as f64),
            first: vec![NONE; counts[0] * counts[1]],
            next: vec![],
            cell: vec![],
            crossings: vec![],
        }
    }

    /// Memory of the cells and their chains (bytes).
    pub(super) fn bytes(&self) -> usize {
        4 * (self.first.len() + self.next.len()) + 8 * self.cell.len()
    }

    /// Centre of a cell along an axis (length).
    #[inline(always)]
    fn centre_along(&self, axis: usize, index: u32) -> f64 {
        self.domain.origin[axis] + (f64::from(index) + 0.5) * self.edge[axis]
    }

    /// Boundary of a cell along an axis, of the image of the cell at a place that may be beyond periodic sides (length). It is the same number for
    /// the cells on both of its sides.
    #[inline(always)]
    fn boundary(&self, axis: usize, index: u32, place: f64, is_up: bool) -> f64 {
        let periods = match self.domain.sides[axis] {
            BoxSide::Periodic(side) => ((place - self.centre_along(axis, index)) / side).round(),
            _ => 0.0,
        };
        let unwrapped = f64::from(index) + periods * self.counts[axis] as f64 + f64::from(u8::from(is_up));
        self.domain.origin[axis] + unwrapped * self.edge[axis]
    }

    /// Index of the cell next to another along an axis; none beyond a closed side.
    #[inline(always)]
    fn neighbour(&self, axis: usize, index: u32, step: isize) -> Option<u32> {
        let (count, next) = (self.counts[axis] as isize, index as isize + step);
        if (0..count).contains(&next) {
            return Some(next as u32);
        }
        match self.domain.sides[axis] {
            BoxSide::Periodic(_) => Some(next.rem_euclid(count) as u32),
            _ => None,
        }
    }

    #[inline(always)]
    fn place(&self, [column, row]: [u32; 2]) -> usize {
        row as usize * self.counts[0] + column as usize
    }

    /// Adds a disc to a cell.
    fn link(&mut self, disc: u32, cell: [u32; 2]) {
        let place = self.place(cell);
        self.next[disc as usize] = self.first[place];
        self.first[place] = disc;
        self.cell[disc as usize] = cell;
    }

    /// Removes a disc from its cell.
    fn unlink(&mut self, disc: u32) {
        let place = self.place(self.cell[disc as usize]);
        let after = self.next[disc as usize];
        if self.first[place] == disc {
            self.first[place] = after;
            return;
        }
        let mut before = self.first[place];
        while self.next[before as usize] != disc {
            before = self.next[before as usize];
        }
        self.next[before as usize] = after;
    }

    /// Visits the discs of a cell.
    #[inline(always)]
    fn for_each_in(&self, cell: [u32; 2], mut visit: impl FnMut(u32)) {
        let mut disc = self.first[self.place(cell)];
        while disc != NONE {
            visit(disc);
            disc = self.next[disc as usize];
        }
    }
}

impl DiscCells for LinkedCells {
    const HAS_CROSSINGS: bool = true;

    fn fill(&mut self, places: impl Iterator<Item = [f64; 2]>) -> Result<(), CellMisfit> {
        self.first.fill(NONE);
        self.next.clear();
        self.cell.clear();
        for (disc, at) in (0..).zip(places) {
            self.next.push(NONE);
            self.cell.push([0; 2]);
            let cell = [0, 1].map(|axis| {
                let index = ((at[axis] - self.domain.origin[axis]) / self.edge[axis]) as usize;
                index.min(self.counts[axis] - 1) as u32
            });
            self.link(disc, cell);
        }
        self.crossings.resize(self.cell.len(), Crossing::NEVER);
        Ok(())
    }

    fn centre(&self, disc: u32) -> [f64; 2] {
        let cell = self.cell[disc as usize];
        [0, 1].map(|axis| self.centre_along(axis, cell[axis]))
    }

    #[inline(always)]
    fn for_each_around(&self, disc: u32, mut visit: impl FnMut(u32)) {
        let [column, row] = self.cell[disc as usize];
        for row in [-1, 0, 1].into_iter().filter_map(|step| self.neighbour(1, row, step)) {
            for column in [-1, 0, 1].into_iter().filter_map(|step| self.neighbour(0, column, step)) {
                self.for_each_in([column, row], |other| {
                    if other != disc {
                        visit(other);
                    }
                });
            }
        }
    }

    /// Mean number of discs in a cell: N_c.
    fn figure(&self) -> (&'static str, f64) {
        ("discs_in_cell", self.cell.len() as f64 / self.first.len() as f64)
    }

    fn predict_crossing(&mut self, arena: &Arena, number: u32, disc: &FlyingDisc, now: f64) {
        let cell = self.cell[number as usize];
        let (place, velocity) = (disc.at(&arena.space, now), disc.velocity_at(&arena.space, now));
        let gravity = arena.space.gravity().unwrap_or([0.0; 2]);
        let mut next = Crossing::NEVER;
        for axis in 0..2 {
            for is_up in [false, true] {
                let crossing = Crossing { time: f64::INFINITY, axis: axis as u8, is_up };
                let step = crossing.step();
                if self.neighbour(axis, cell[axis], step).is_none() {
                    continue;
                }
                let sign = step as f64;
                // A disc that is slowed leaves only while it still moves this way.
                if sign * gravity[axis] < 0.0 && sign * velocity[axis] <= 0.0 {
                    continue;
                }
                let ahead =
                    sign * (self.boundary(axis, cell[axis], place[axis], is_up) - disc.position[axis]);
                let time = disc.time + exit_time(ahead, sign * disc.velocity[axis], sign * gravity[axis]);
                if time < next.time {
                    next = Crossing { time: time.max(now), ..crossing };
                }
            }
        }
        self.crossings[number as usize] = next;
    }

    #[inline(always)]
    fn crossing_time(&self, disc: u32) -> f64 {
        self.crossings[disc as usize].time
    }

    fn cross(&mut self, disc: u32) {
        let crossing = self.crossings[disc as usize];
        let (axis, mut cell) = (crossing.axis as usize, self.cell[disc as usize]);
        if let Some(entered) = self.neighbour(axis, cell[axis], crossing.step()) {
            self.unlink(disc);
            cell[axis] = entered;
            self.link(disc, cell);
        }
    }

    #[inline(always)]
    fn for_each_entered(&self, disc: u32, mut visit: impl FnMut(u32)) {
        let crossing = self.crossings[disc as usize];
        let (axis, mut cell) = (crossing.axis as usize, self.cell[disc as usize]);
        let Some(ahead) = self.neighbour(axis, cell[axis], crossing.step()) else { return };
        cell[axis] = ahead;
        let other_axis = 1 - axis;
        let beside = cell[other_axis];
        for index in [-1, 0, 1].into_iter().filter_map(|step| self.neighbour(other_axis, beside, step)) {
            cell[other_axis] = index;
            self.for_each_in(cell, &mut visit);
        }
    }
}

/// Time after the last event at which a disc leaves through a boundary `ahead` of its position then (length), with its speed then and its
/// acceleration this way; infinite if it turns before. It depends on the disc and the boundary alone, not on the time of the query: a resumed run has the
/// same crossings.
#[inline(always)]
fn exit_time(ahead: f64, speed: f64, acceleration: f64) -> f64 {
    let square = speed * speed + 2.0 * acceleration * ahead;
    match (speed > 0.0, acceleration > 0.0) {
        (false, false) => f64::INFINITY,
        (true, false) if square < 0.0 => f64::INFINITY,
        // Forms of the root that add numbers of one sign. Rounding may put the disc just beyond the boundary.
        (true, _) => (2.0 * ahead / (speed + square.max(0.0).sqrt())).max(0.0),
        (false, true) => (square.max(0.0).sqrt() - speed) / acceleration,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::hard_disks::event::CollisionLaw;

    fn disc(position: [f64; 2], velocity: [f64; 2]) -> FlyingDisc {
        FlyingDisc { position, velocity, time: 0.0, radius: 0.5, mass: 1.0, events: 0 }
    }

    /// By hand, in a box of 6 × 4 cells of 2 × 1.5: a disc crosses a periodic side, turns in its fall, and stays below a closed side.
    #[test]
    fn discs_cross_their_cells_in_time() {
        let domain = Domain::planar([-1.0, 2.0], [12.0, 6.0], [true, false]);
        let counts = CellCounts::new(&domain, 30, 0.5, 30.0 / 24.0).unwrap();
        assert_eq!(counts, CellCounts([6, 3]));
        let mut cells = LinkedCells::new(domain, CellCounts([6, 4]));
        let discs = [
            disc([10.5, 3.0], [0.25, 0.0]),
            disc([2.0, 3.0], [0.0, 1.0]),
            disc([2.0, 7.0], [0.0, 1.0]),
            disc([0.0, 2.1], [-0.5, 0.0]),
            disc([8.0, 4.0], [0.0, 2.0]),
        ];
        cells.fill(discs.iter().map(|disc| disc.position)).unwrap();
        let cross = |cells: &mut LinkedCells, gravity: [f64; 2], number: usize, now: f64| {
            let arena = Arena::new(domain, gravity, CollisionLaw::ELASTIC);
            cells.predict_crossing(&arena, number as u32, &discs[number], now);
            cells.crossing_time(number as u32)
        };
        assert_eq!(cross(&mut cells, [0.0; 2], 0, 0.0), 2.0);
        cells.cross(0);
        let mut entered = vec![];
        cells.for_each_entered(0, |other| entered.push(other));
        assert_eq!((cells.cell[0], entered), ([0, 0], vec![1]));
        // The next crossing is a cell later.
        assert_eq!(cross(&mut cells, [0.0; 2], 0, 2.0), 10.0);
        assert_eq!(cross(&mut cells, [0.0; 2], 1, 0.0), 0.5);
        // It rises by a quarter, v²/2g, and the floor is below.
        assert_eq!(cross(&mut cells, [0.0, -2.0], 1, 0.0), f64::INFINITY);
        assert_eq!(cross(&mut cells, [0.0; 2], 2, 0.0), f64::INFINITY);
        assert_eq!(cross(&mut cells, [0.0; 2], 3, 0.0), 2.0);
        // Thrown up, it meets the upper cell a length above after 2 − √2, and comes back after 2 + √2, whenever that is predicted.
        let [up, down] = [-1.0, 1.0].map(|sign| 2.0 + sign * 2.0_f64.sqrt());
        assert!((cross(&mut cells, [0.0, -1.0], 4, 0.0) - up).abs() < 1e-15);
        cells.cross(4);
        let back = cross(&mut cells, [0.0, -1.0], 4, up);
        assert!((back - down).abs() < 1e-15 && cross(&mut cells, [0.0, -1.0], 4, 3.0) == back);
        cells.cross(4);
        // Below it falls on, to the next boundary half a length below its start.
        assert!((cross(&mut cells, [0.0, -1.0], 4, back) - (2.0 + 5.0_f64.sqrt())).abs() < 1e-15);
        let mut around = vec![];
        cells.for_each_around(3, |other| around.push(other));
        around.sort_unstable();
        assert_eq!(around, [0, 1]);
    }
}
