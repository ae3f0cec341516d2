//! Neighbour lists around registered positions. A list is renewed when its own disc has moved away from its registered position by the
//! displacement limit, and only then.
//!
//! A disc within `displacement_limit` of its registered position meets only discs registered within the sum of the radii and twice
//! the displacement limit. Those are in its list, and it is in theirs.

use super::cells::FOUND;
use super::grids::{RegistrationGrids, SizeClass};
use crate::domain::Domain;
use stripmine_kernels::backend::Registers;
use stripmine_kernels::flight::{FlyingDisc, ROW_UNIT};
use stripmine_kernels::isa::AlignedColumn;

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
    cells: RegistrationGrids,
}

/// Radii of the discs.
#[derive(Clone, Copy)]
pub(super) struct Radii<'d> {
    /// Radius of all discs (length); none if they differ.
    pub(super) equal: Option<f64>,
    pub(super) discs: &'d [FlyingDisc],
}

impl Radii<'_> {
    #[inline(always)]
    fn of(&self, disc: u32) -> f64 {
        self.equal.unwrap_or_else(|| self.discs[disc as usize].radius)
    }
}

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
    // Listed discs are registered within the sum of radii plus two limits and move by two more: together less than half a side.
    let bound = domain.shortest_period() / 8.0 - 0.5 * largest;
    let displacement_limit = wanted.max(0.1 * largest).min(0.9 * bound);
    (displacement_limit >= 0.05 * largest).then_some(displacement_limit)
}

impl DiscNeighbourLists {
    /// Creates lists without discs, with space for about `most` discs each, for discs of some classes of sizes. Rows have at least
    /// `stride` entries, a multiple of [`ROW_UNIT`]; the count is among them.
    pub(super) fn new(
        domain: Domain,
        count: usize,
        displacement_limit: f64,
        classes: &[SizeClass],
        most: f64,
        stride: usize,
    ) -> DiscNeighbourLists {
        let least = ((most / FILLED) as usize + 1).next_multiple_of(ROW_UNIT);
        DiscNeighbourLists {
            domain,
            displacement_limit,
            positions: AlignedColumn::filled(10, [0.0; 2], count),
            rows: empty_rows(count, stride.max(least)),
            stride: stride.max(least),
            cells: RegistrationGrids::new(&domain, classes, displacement_limit),
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

    /// Prefetches the cache lines that the renewal of a list at a position reads.
    #[inline(always)]
    pub(super) fn prefetch_cells(&self, position: [f64; 2], radius: f64) {
        self.cells.prefetch(&self.domain, position, radius);
    }

    /// Registers unregistered discs, in their order, at `positions` inside the box (length). Each disc lists those registered before it,
    /// and they list it.
    ///
    /// # Errors
    /// The disc whose list is full.
    pub(super) fn begin<R: Registers<Lane = f32>>(
        &mut self,
        registers: R,
        positions: impl Iterator<Item = [f64; 2]>,
        radii: Radii<'_>,
    ) -> Result<(), u32> {
        (0..).zip(positions).try_for_each(|(disc, position)| self.enter(registers, disc, position, radii))
    }

    /// Registers a disc at a new position inside the box (length).
    ///
    /// # Errors
    /// The disc whose list is full.
    #[inline(always)]
    pub(crate) fn renew<R: Registers<Lane = f32>>(
        &mut self,
        registers: R,
        disc: u32,
        position: [f64; 2],
        radii: Radii<'_>,
    ) -> Result<(), u32> {
        self.cells.remove(&self.domain, disc, (self.positions[disc as usize], radii.of(disc)));
        let begin = disc as usize * self.stride;
        for entry in 0..self.rows[begin + self.stride - 1] as usize {
            let other = self.rows[begin + entry];
            self.remove_partner(other, disc);
        }
        clear(&mut self.rows[begin..begin + self.stride], disc);
        self.enter(registers, disc, position, radii)
    }

    #[inline(always)]
    fn enter<R: Registers<Lane = f32>>(
        &mut self,
        registers: R,
        disc: u32,
        position: [f64; 2],
        radii: Radii<'_>,
    ) -> Result<(), u32> {
        self.positions[disc as usize] = position;
        let mut found = [0; FOUND];
        let own = (position, radii.of(disc));
        let count = if self.cells.is_approximate() || radii.equal.is_none() {
            let reach = own.1 + 2.0 * self.displacement_limit;
            let is_near = |other: u32| {
                let [dx, dy] = self.domain.displacement(position, self.positions[other as usize]);
                let reach = (reach + radii.of(other)) * (1.0 + 1e-9);
                dx * dx + dy * dy < reach * reach
            };
            self.cells.find(registers, &self.domain, own, is_near, &mut found)
        } else {
            self.cells.find(registers, &self.domain, own, |_| true, &mut found)
        };
        let count = count.ok_or(disc)?;
        for &other in &found[..count] {
            self.add(disc, other)?;
            self.add(other, disc)?;
        }
        self.cells.add(&self.domain, disc, own);
        Ok(())
    }

    #[inline(always)]
    fn add(&mut self, to: u32, disc: u32) -> Result<(), u32> {
        let row = &mut self.rows[to as usize * self.stride..][..self.stride];
        let (count, entries) = row.split_last_mut().ok_or(to)?;
        *entries.get_mut(*count as usize).ok_or(to)? = disc;
        *count += 1;
        Ok(())
    }

    #[inline(always)]
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::BoxSide;
    use rand::RngExt;
    use stripmine_kernels::backend::Scalar;
    use stripmine_kernels::noise::{RandomPurpose, Stream};

    fn disc(radius: f64) -> FlyingDisc {
        FlyingDisc { position: [0.0; 2], velocity: [0.0; 2], time: 0.0, radius, mass: 1.0, events: 0 }
    }

    /// Compared with all pairs as discs move, in boxes of every kind of side.
    #[test]
    fn lists_match_a_search_over_pairs() {
        let mut stream = Stream::new(11, RandomPurpose::Test, 0);
        let open = Domain {
            origin: [-3.0, 2.0, 0.0],
            sides: [BoxSide::Periodic(30.0), BoxSide::Open, BoxSide::Flat],
        };
        let planar = |periodic| Domain::planar([-3.0, 2.0], [30.0, 25.0], periodic);
        let registers = Scalar::<f32>::default();
        let mut pairs = 0;
        let domains = [open, planar([true, true]), planar([true, false])];
        // One class of sizes, and four.
        let cases = domains.into_iter().flat_map(|domain| [(domain, 0.3), (domain, 0.04)]);
        for (domain, smallest) in cases {
            let count = 150;
            let radii: Vec<f64> = (0..count).map(|_| stream.random_range(smallest..0.5)).collect();
            let classes = SizeClass::of(radii.iter().copied());
            let discs: Vec<FlyingDisc> = radii.iter().map(|&radius| disc(radius)).collect();
            let radii_of_discs = Radii { equal: None, discs: &discs };
            let displacement_limit = displacement_limit(&domain, radii.iter().copied(), 6.0).unwrap();
            let mut draw = || {
                let along = |axis: usize| domain.length(axis).min(90.0);
                [0, 1].map(|axis| domain.origin[axis] + stream.random_range(0.0..along(axis)))
            };
            let mut positions: Vec<[f64; 2]> = (0..count).map(|_| draw()).collect();
            // More than a cell has slots for.
            for position in &mut positions[..20] {
                *position = [0, 1].map(|axis| domain.origin[axis] + 0.3 + 0.01 * position[axis]);
            }
            let mut lists = DiscNeighbourLists::new(domain, count, displacement_limit, &classes, 6.0, 64);
            lists.begin(registers, positions.iter().copied(), radii_of_discs).unwrap();
            for moved in 0..400 {
                let disc = moved % count;
                positions[disc] = draw();
                lists.renew(registers, disc as u32, positions[disc], radii_of_discs).unwrap();
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
