//! Neighbour lists around registered positions. A list is renewed when its own disc has moved away from its registered position by the
//! displacement limit, and only then.
//!
//! A disc within `displacement_limit` of its registered position meets only discs registered within the sum of the radii and twice
//! the displacement limit. Those are in its list, and it is in theirs.

use crate::domain::{BoxSide, Domain};
use stripmine_kernels::flight::ROW_UNIT;
use stripmine_kernels::isa::AlignedColumn;

/// Marks the end of a cell's chain.
const NONE: u32 = u32::MAX;
/// Average fill fraction of a row.
const FILLED: f64 = 0.6;

#[derive(Clone, Debug)]
pub(crate) struct DiscNeighbourLists {
    domain: Domain,
    displacement_limit: f64,
    /// Registered position of each disc (length).
    positions: AlignedColumn<[f64; 2]>,
    /// One row per list. The row's own number fills the entries behind the listed discs; the last entry is the count. Every entry
    /// is therefore a valid number, as a list never holds all discs.
    rows: AlignedColumn<u32>,
    stride: usize,
    cells: RegistrationCells,
}

/// Linked cells of the registered positions. Rows and columns of cells wrap around the grid, so an infinite side needs no more cells.
/// Discs that share a cell by wrapping are far apart, and the distance check excludes them.
#[derive(Clone, Debug)]
struct RegistrationCells {
    counts: [usize; 2],
    edge: [f64; 2],
    /// First disc of each cell, row by row.
    first: AlignedColumn<u32>,
    /// Next disc of the same cell.
    next: AlignedColumn<u32>,
}

/// Maximum number of neighbours found around a disc, more than a list holds.
const FOUND: usize = 128;

/// Half-width of the searched block of cells.
const AROUND: isize = 2;

/// Largest allowed displacement from the registered position (length). Lists then hold about `most` discs, and no disc sees another
/// one across two sides. Returns none if the box is too small for lists.
pub(crate) fn displacement_limit(
    domain: &Domain,
    radii: impl Iterator<Item = f64> + Clone,
    most: f64,
) -> Option<f64> {
    let (count, largest, sum) = radii.fold((0.0, 0.0_f64, 0.0), |(count, largest, sum), radius| {
        (count + 1.0, radius.max(largest), sum + radius)
    });
    let bounded = (0..2).all(|axis| domain.length(axis).is_finite());
    // In an infinite box discs may be packed densely near the floor.
    let density = if bounded { count / domain.area() } else { 0.5 / (largest * largest) };
    let sight = ((most + 1.0) / (std::f64::consts::PI * density)).sqrt();
    let wanted = 0.5 * (sight - 2.0 * sum / count);
    let periodic = (0..2).filter(|&axis| domain.is_periodic(axis)).map(|axis| domain.length(axis));
    // Listed discs are registered within the sum of radii plus two limits and move by two more: together less than half a side.
    let bound = periodic.fold(f64::INFINITY, f64::min) / 8.0 - 0.5 * largest;
    let displacement_limit = wanted.max(0.1 * largest).min(0.9 * bound);
    (displacement_limit >= 0.05 * largest).then_some(displacement_limit)
}

impl DiscNeighbourLists {
    /// Creates lists without discs, with space for about `most` discs each; `largest` is the largest radius (length). Rows have at least
    /// `stride` entries, a multiple of [`ROW_UNIT`]; the count is among them.
    pub(super) fn new(
        domain: Domain,
        count: usize,
        displacement_limit: f64,
        largest: f64,
        most: f64,
        stride: usize,
    ) -> DiscNeighbourLists {
        let sight = 2.0 * (largest + displacement_limit) * (1.0 + 1e-9);
        let least = ((most / FILLED) as usize + 1).next_multiple_of(ROW_UNIT);
        DiscNeighbourLists {
            domain,
            displacement_limit,
            positions: AlignedColumn::filled(10, [0.0; 2], count),
            rows: empty_rows(count, stride.max(least)),
            stride: stride.max(least),
            cells: RegistrationCells::new(&domain, count, sight / AROUND as f64),
        }
    }

    /// Length of a row.
    pub(super) fn stride(&self) -> usize {
        self.stride
    }

    /// Largest allowed displacement from the registered position (length).
    #[inline(always)]
    pub(crate) fn displacement_limit(&self) -> f64 {
        self.displacement_limit
    }

    /// Registered position of a disc (length).
    #[inline(always)]
    pub(super) fn registered_position(&self, disc: u32) -> [f64; 2] {
        self.positions[disc as usize]
    }

    /// Discs that a disc may meet.
    #[inline(always)]
    pub(super) fn of(&self, disc: u32) -> &[u32] {
        let (row, count) = self.row(disc);
        &row[..count]
    }

    /// Returns the whole row of a disc, as [`earliest_collision`](stripmine_kernels::flight::earliest_collision) takes it, and the number of listed discs.
    #[inline(always)]
    pub(super) fn row(&self, disc: u32) -> (&[u32], usize) {
        let row = &self.rows[disc as usize * self.stride..][..self.stride];
        (row, row[self.stride - 1] as usize)
    }

    /// Prefetches the cache lines of a disc's list and registered position.
    #[inline(always)]
    pub(crate) fn prefetch(&self, disc: usize) {
        self.rows.prefetch(disc * self.stride);
        self.positions.prefetch(disc);
    }

    /// Registers unregistered discs at `positions` inside the box (length). Each disc lists those registered before it, and they list
    /// it.
    ///
    /// # Errors
    /// The disc whose list is full.
    pub(super) fn begin(&mut self, positions: &[[f64; 2]], radius: impl Fn(u32) -> f64) -> Result<(), u32> {
        for (disc, &position) in positions.iter().enumerate() {
            self.enter(disc as u32, position, &radius)?;
        }
        Ok(())
    }

    /// Registers a disc at a new position inside the box (length).
    ///
    /// # Errors
    /// The disc whose list is full.
    pub(crate) fn renew(
        &mut self,
        disc: u32,
        position: [f64; 2],
        radius: impl Fn(u32) -> f64,
    ) -> Result<(), u32> {
        self.cells.remove(disc, self.cells.of(&self.domain, self.positions[disc as usize]));
        let begin = disc as usize * self.stride;
        for entry in 0..self.rows[begin + self.stride - 1] as usize {
            let other = self.rows[begin + entry];
            self.remove_partner(other, disc);
        }
        clear(&mut self.rows[begin..begin + self.stride], disc);
        self.enter(disc, position, &radius)
    }

    fn enter(&mut self, disc: u32, position: [f64; 2], radius: &impl Fn(u32) -> f64) -> Result<(), u32> {
        self.positions[disc as usize] = position;
        let at = self.cells.coordinates(&self.domain, position);
        let reach = radius(disc) + 2.0 * self.displacement_limit;
        let [columns, rows] = [0, 1].map(|axis| self.cells.around(axis, at[axis]));
        // Candidates overwrite each other until one is near enough: a branch per candidate would be unpredictable.
        let (mut found, mut count) = ([0; FOUND], 0);
        for row in rows {
            for column in columns {
                let mut other = self.cells.first[row * self.cells.counts[0] + column];
                while other != NONE {
                    let [dx, dy] = self.domain.displacement(position, self.positions[other as usize]);
                    let near = (reach + radius(other)) * (1.0 + 1e-9);
                    found[count] = other;
                    count += usize::from(dx * dx + dy * dy < near * near);
                    if count == FOUND {
                        return Err(disc);
                    }
                    other = self.cells.next[other as usize];
                }
            }
        }
        for &other in &found[..count] {
            self.add(disc, other)?;
            self.add(other, disc)?;
        }
        self.cells.add(disc, self.cells.round(at));
        Ok(())
    }

    fn add(&mut self, to: u32, disc: u32) -> Result<(), u32> {
        let row = &mut self.rows[to as usize * self.stride..][..self.stride];
        let (count, entries) = row.split_last_mut().ok_or(to)?;
        *entries.get_mut(*count as usize).ok_or(to)? = disc;
        *count += 1;
        Ok(())
    }

    fn remove_partner(&mut self, from: u32, disc: u32) {
        let row = &mut self.rows[from as usize * self.stride..][..self.stride];
        let last = row.len() - 1;
        // No branch per entry: the index is unpredictable.
        let at: u32 =
            row[..last].iter().zip(0..).map(|(&other, entry)| if other == disc { entry } else { 0 }).sum();
        row[last] -= 1;
        let filled = row[last] as usize;
        row[at as usize] = row[filled];
        row[filled] = from;
    }
}

/// Creates rows without entries.
fn empty_rows(count: usize, stride: usize) -> AlignedColumn<u32> {
    let mut rows = AlignedColumn::filled(11, 0, count * stride);
    rows.chunks_exact_mut(stride).zip(0..).for_each(|(row, disc)| clear(row, disc));
    rows
}

/// Empties the row of a disc.
#[inline(always)]
fn clear(row: &mut [u32], disc: u32) {
    row.fill(disc);
    row[row.len() - 1] = 0;
}

impl RegistrationCells {
    fn new(domain: &Domain, count: usize, least_edge: f64) -> RegistrationCells {
        let most = (count as f64).sqrt().max(8.0);
        let counts = [0, 1].map(|axis| match domain.sides[axis] {
            BoxSide::Open | BoxSide::Flat => most as usize,
            BoxSide::Periodic(side) | BoxSide::Closed(side) => ((side / least_edge) as usize).max(1),
        });
        let edge = [0, 1].map(|axis| match domain.sides[axis] {
            BoxSide::Open | BoxSide::Flat => least_edge,
            BoxSide::Periodic(side) | BoxSide::Closed(side) => side / counts[axis] as f64,
        });
        // With fewer cells along a side than a search covers, some would be visited twice.
        let counts = counts.map(|along| along.max(2 * AROUND as usize + 1));
        RegistrationCells {
            counts,
            edge,
            first: AlignedColumn::filled(12, NONE, counts[0] * counts[1]),
            next: AlignedColumn::filled(13, NONE, count),
        }
    }

    #[inline(always)]
    fn coordinates(&self, domain: &Domain, position: [f64; 2]) -> [isize; 2] {
        // No position is below the origin of the box.
        [0, 1].map(|axis| ((position[axis] - domain.origin[axis]) / self.edge[axis]) as isize)
    }

    /// Columns or rows searched around one of them.
    #[inline(always)]
    fn around(&self, axis: usize, at: isize) -> [usize; 2 * AROUND as usize + 1] {
        let count = self.counts[axis] as isize;
        let at = if at < count { at } else { at % count };
        std::array::from_fn(|step| {
            let along = at + step as isize - AROUND;
            (if along < 0 {
                along + count
            } else if along >= count {
                along - count
            } else {
                along
            }) as usize
        })
    }

    #[inline(always)]
    fn round(&self, at: [isize; 2]) -> usize {
        let [column, row] = [0, 1].map(|axis| {
            let count = self.counts[axis] as isize;
            let along = at[axis];
            // Usually inside.
            if (0..count).contains(&along) { along as usize } else { along.rem_euclid(count) as usize }
        });
        row * self.counts[0] + column
    }

    fn of(&self, domain: &Domain, position: [f64; 2]) -> usize {
        self.round(self.coordinates(domain, position))
    }

    fn add(&mut self, disc: u32, cell: usize) {
        self.next[disc as usize] = self.first[cell];
        self.first[cell] = disc;
    }

    fn remove(&mut self, disc: u32, cell: usize) {
        let after = self.next[disc as usize];
        let mut other = self.first[cell];
        if other == disc {
            self.first[cell] = after;
            return;
        }
        while other != NONE {
            let next = self.next[other as usize];
            if next == disc {
                self.next[other as usize] = after;
                return;
            }
            other = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use stripmine_kernels::noise::{RandomPurpose, Stream};

    /// Compared with all pairs as discs move, in boxes of every kind of side.
    #[test]
    fn lists_match_a_search_over_pairs() {
        let mut stream = Stream::new(11, RandomPurpose::Test, 0);
        let open = Domain {
            origin: [-3.0, 2.0, 0.0],
            sides: [BoxSide::Periodic(30.0), BoxSide::Open, BoxSide::Flat],
        };
        let planar = |periodic| Domain::planar([-3.0, 2.0], [30.0, 25.0], periodic);
        let mut pairs = 0;
        for domain in [open, planar([true, true]), planar([true, false])] {
            let count = 150;
            let radii: Vec<f64> = (0..count).map(|_| stream.random_range(0.3..0.5)).collect();
            let displacement_limit = displacement_limit(&domain, radii.iter().copied(), 6.0).unwrap();
            let mut draw = || {
                let along = |axis: usize| domain.length(axis).min(90.0);
                [0, 1].map(|axis| domain.origin[axis] + stream.random_range(0.0..along(axis)))
            };
            let mut positions: Vec<[f64; 2]> = (0..count).map(|_| draw()).collect();
            let radius = |disc: u32| radii[disc as usize];
            let mut lists = DiscNeighbourLists::new(domain, count, displacement_limit, 0.5, 6.0, 64);
            lists.begin(&positions, radius).unwrap();
            for moved in 0..400 {
                let disc = moved % count;
                positions[disc] = draw();
                lists.renew(disc as u32, positions[disc], radius).unwrap();
                for a in [disc, (disc + 7) % count] {
                    let mut listed = lists.of(a as u32).to_vec();
                    listed.sort_unstable();
                    let near = |&b: &u32| {
                        let reach = radii[a] + radii[b as usize] + 2.0 * displacement_limit;
                        b as usize != a && domain.distance(positions[a], positions[b as usize]) < reach
                    };
                    let expected: Vec<u32> = (0..count as u32).filter(near).collect();
                    assert_eq!(listed, expected);
                    pairs += expected.len();
                }
            }
        }
        assert!(pairs > 5_000, "{pairs}");
    }
}
