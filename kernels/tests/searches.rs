//! Sectors and Verlet lists compared with all pairs: every pair in reach is found once, with the displacement to the nearest
//! image.

use proptest::prelude::*;
use rand::RngExt;
use std::collections::BTreeMap;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::ObservationRequest;
use stripmine_kernels::law::lennard_jones::LennardJones;
use stripmine_kernels::law::potential::CutOff;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::sweep::fast::lattice::{Candidates, Codes, Lattice, Occupancy};
use stripmine_kernels::sweep::fast::{
    CellGrid, Finder, ForceRecords, PairBuffer, PairSequence, RecordEntry, RowLayout, SENTINELS,
    SearchCursor, Sectors, StateRecords, Sweep, VerletList,
};
use stripmine_kernels::sweep::lattice::{LatticeFrame, LatticeShape};

/// Discs in a box: positions, sectors, and positions relative to the sectors.
struct Scattered {
    positions: Vec<[f64; 2]>,
    sectors: Sectors,
    places: [Vec<f64>; 2],
}

const ORIGIN: [f64; 2] = [-3.0, 7.0];

fn scattered(
    sides: [f64; 2],
    periodic: [bool; 2],
    reach: f64,
    skin: f64,
    discs: usize,
    seed: u64,
) -> Scattered {
    let grid = CellGrid::new(ORIGIN, sides, periodic, reach + skin, f64::INFINITY, discs).unwrap();
    let mut sectors = Sectors::new(grid, discs, reach);
    let mut random = Stream::new(seed, RandomPurpose::Test, 0);
    let mut places = [vec![], vec![]];
    let mut positions = vec![];
    for disc in 0..discs {
        let along = sides.map(|side| side * random.random::<f64>());
        let cell = [0, 1].map(|axis| (along[axis] / grid.frame.edge[axis]) as usize);
        sectors.enter(disc, cell);
        for axis in 0..2 {
            places[axis].push(along[axis] - (cell[axis] as f64 + 0.5) * grid.frame.edge[axis]);
        }
        positions.push([0, 1].map(|axis| ORIGIN[axis] + along[axis]));
    }
    sectors.arrange(|disc| discs - disc);
    for (place, sentinels) in places.iter_mut().zip([[0.0, 1e3], [0.0; SENTINELS]]) {
        place.extend(sentinels);
    }
    Scattered { positions, sectors, places }
}

/// Records of discs and sentinels at these positions.
fn records(places: &[Vec<f64>; 2]) -> StateRecords<f64> {
    let mut records = StateRecords::zeros(0, places[0].len() - SENTINELS, [false; 2], 1.0);
    for (axis, column) in places.iter().enumerate() {
        records.fill(RecordEntry::of(axis, 0), |disc| column[disc]);
    }
    records
}

/// Pairs, the smaller number first, with the displacement from the first disc to the second.
type Found = BTreeMap<[u32; 2], [f64; 2]>;

/// Pairs that a finder finds, band by band.
fn found<F: Finder<f64, f64>>(finder: &F, places: &[Vec<f64>; 2]) -> Found {
    let (rows, mut all, discs) = (finder.rows().count, Found::new(), records(places));
    for band in [0..rows / 2, rows / 2..rows] {
        let (mut cursor, mut list) = (SearchCursor::at(band.start), F::Found::default());
        while cursor.row() < band.end {
            finder.find(&discs, band.clone(), &mut cursor, &mut list, InstructionSet::best()).unwrap();
            let pairs = finder.pairs(&list);
            for number in 0..pairs.count() {
                let ([a, b], cell_offset) = pairs.pair(number);
                let cell_offset = pairs.cell_offsets()[cell_offset as usize];
                let to = [0, 1]
                    .map(|axis| places[axis][b as usize] - places[axis][a as usize] + cell_offset[axis]);
                let (pair, to) = if a < b { ([a, b], to) } else { ([b, a], to.map(|along| -along)) };
                assert!(all.insert(pair, to).is_none(), "{pair:?} found twice");
            }
        }
    }
    all
}

/// All pairs nearer than `reach`, with the nearest image on periodic sides.
fn naive(positions: &[[f64; 2]], sides: [f64; 2], periodic: [bool; 2], reach: f64) -> Found {
    let mut pairs = Found::new();
    for (a, from) in positions.iter().enumerate() {
        for (b, to) in positions.iter().enumerate().skip(a + 1) {
            let configuration = [0, 1].map(|axis| {
                let along = to[axis] - from[axis];
                if periodic[axis] { along - sides[axis] * (along / sides[axis]).round() } else { along }
            });
            if configuration[0].hypot(configuration[1]) < reach {
                pairs.insert([a as u32, b as u32], configuration);
            }
        }
    }
    pairs
}

fn assert_same(found: &Found, expected: &Found, reach: f64) {
    for (pair, configuration) in expected {
        let there = found.get(pair).unwrap_or_else(|| panic!("{pair:?} not found"));
        assert!(
            (0..2).all(|axis| (there[axis] - configuration[axis]).abs() < 1e-9),
            "{pair:?}: {there:?} for {configuration:?}"
        );
    }
    for (pair, [x, y]) in found {
        assert!(x.hypot(*y) < 1.001 * reach, "{pair:?} is far: {x}, {y}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_pair_in_reach_is_found_once(
        sides in [3.4..30.0, 3.4..30.0],
        periodic: [bool; 2],
        reach in 0.3..1.0,
        skin in 0.01..0.13,
        discs in 0usize..400,
        seed: u64,
    ) {
        let Scattered { positions, sectors, places } = scattered(sides, periodic, reach, skin, discs, seed);
        let expected = naive(&positions, sides, periodic, reach);
        assert_same(&found(&sectors, &places), &expected, reach);
        let mut list = VerletList::new(&sectors, &records(&places), skin);
        assert_same(&found(&list, &places), &expected, reach);
        prop_assert!(list.entries() >= expected.len());
        // Every disc moves as far as the skin allows: the list is still valid.
        let (mut places, mut positions) = (places, positions);
        let mut random = Stream::new(seed, RandomPurpose::Test, 1);
        for (disc, position) in positions.iter_mut().enumerate() {
            let angle = std::f64::consts::TAU * random.random::<f64>();
            for (axis, along) in [angle.cos(), angle.sin()].into_iter().enumerate() {
                places[axis][disc] += 0.499 * skin * along;
                position[axis] += 0.499 * skin * along;
            }
        }
        assert_same(&found(&list, &places), &naive(&positions, sides, periodic, reach), reach);
        // Renumbered and rebuilt, lists have the same pairs with their new numbers.
        let Scattered { mut sectors, places, .. } = scattered(sides, periodic, reach, skin, discs, seed);
        let order = sectors.order();
        sectors.renumber(&order);
        let sorted = places.each_ref().map(|place| {
            let there = order.iter().map(|&disc| place[disc as usize]);
            there.chain(place[discs..].iter().copied()).collect::<Vec<f64>>()
        });
        list = VerletList::new(&sectors, &records(&sorted), skin);
        let back = |found: Found| -> Vec<[u32; 2]> {
            let mut pairs: Vec<_> = found.into_keys().map(|pair| pair.map(|disc| order[disc as usize])).collect();
            pairs.iter_mut().for_each(|pair| pair.sort_unstable());
            pairs.sort_unstable();
            pairs
        };
        let expected: Vec<[u32; 2]> = expected.into_keys().collect();
        for found in [back(found(&sectors, &sorted)), back(found(&list, &sorted))] {
            prop_assert!(expected.iter().all(|pair| found.binary_search(pair).is_ok()));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Half of the cells of a lattice have a disc. Every pair that may touch is found once, in cells as narrow as the mask allows and
    /// in wider ones, for equal and unequal discs, and beyond contact if asked. Few others are.
    #[test]
    fn every_pair_on_a_lattice_is_found_once(
        counts in [8usize..40, 8usize..40],
        periodic: [bool; 2],
        (half_width, stretch) in (2u32..=3, [1.0..3.0, 1.0..3.0]),
        (vary, slack, reach) in (any::<bool>(), prop_oneof![Just(0.0), 0.0..0.1], 0.01..100.0),
        seed: u64,
    ) {
        let narrowest = reach * (1.0 + slack) / f64::from(half_width);
        let edge = stretch.map(|stretch| narrowest * stretch);
        let frame = LatticeFrame { origin: ORIGIN, edge };
        let shape = LatticeShape::new(counts[0], counts[1], &Mask::square(half_width), periodic).unwrap();
        let mut random = Stream::new(seed, RandomPurpose::Test, 0);
        let mut discs = vec![];
        for cell in (0..counts[1]).flat_map(|row| (0..counts[0]).map(move |column| [column, row])) {
            if random.random::<bool>() {
                let place = edge.map(|edge| edge * (random.random::<f64>() - 0.5));
                let radius = 0.5 * reach * if vary { 1.0 - 0.6 * random.random::<f64>() } else { 1.0 };
                discs.push((cell, place, radius));
            }
        }
        let mut occupancy = Occupancy::new(shape, frame, discs.len(), reach, vary);
        for (disc, &(cell, place, radius)) in discs.iter().enumerate() {
            occupancy.enter(disc, cell, place, radius).unwrap();
        }
        occupancy.repeat_images();
        let places = [0, 1].map(|axis| {
            let sentinels = [0.0, 1e3 * reach];
            discs.iter().map(|disc| disc.1[axis]).chain(sentinels).collect::<Vec<f64>>()
        });
        let codes = Codes::new(&occupancy, frame);
        let found = found(&Lattice { occupancy: &occupancy, codes: &codes, slack }, &places);
        let positions: Vec<[f64; 2]> = discs
            .iter()
            .map(|(cell, place, _)| [0, 1].map(|axis| (cell[axis] as f64 + 0.5) * edge[axis] + place[axis]))
            .collect();
        let sides = [0, 1].map(|axis| counts[axis] as f64 * edge[axis]);
        let within = |&[a, b]: &[u32; 2]| (discs[a as usize].2 + discs[b as usize].2) * (1.0 + slack);
        for (pair, to) in naive(&positions, sides, periodic, reach * (1.0 + slack)) {
            if to[0].hypot(to[1]) < within(&pair) {
                let there = found.get(&pair);
                prop_assert!(there.is_some(), "{pair:?} not found, {to:?} apart");
                prop_assert!((0..2).all(|axis| (there.unwrap()[axis] - to[axis]).abs() < 1e-9 * reach));
            }
        }
        for (pair, [x, y]) in &found {
            prop_assert!((pair[1] as usize) < discs.len(), "an empty cell is near disc {}", pair[0]);
            // The slack of unequal discs is that of the largest. Coordinates are coarser in wide cells.
            let touching = discs[pair[0] as usize].2 + discs[pair[1] as usize].2;
            prop_assert!(x.hypot(*y) < touching + (slack + 0.004) * reach, "{pair:?} is far: {x}, {y}");
        }
    }
}

/// An empty lattice for discs that touch at a distance of 1, with its frame.
fn lattice(columns: usize) -> (Occupancy, LatticeFrame) {
    let shape = LatticeShape::new(columns, 20, &Mask::square(2), [false; 2]).unwrap();
    let frame = LatticeFrame { origin: [0.0; 2], edge: [0.6, 0.6] };
    (Occupancy::new(shape, frame, 1, 1.0, false), frame)
}

fn search(lattice: &Lattice<'_, f64>, discs: usize) -> Candidates {
    let (mut cursor, mut found) = (SearchCursor::at(0), Candidates::default());
    let records = StateRecords::<f64>::zeros(0, discs, [false; 2], 1.0);
    lattice.find(&records, 0..20, &mut cursor, &mut found, InstructionSet::best()).unwrap();
    found
}

/// Tables of another lattice and records of too few discs are rejected before they are read unchecked.
#[test]
fn lattices_reject_foreign_codes_and_records() {
    let [(narrow, frame), (wide, _)] = [lattice(20), lattice(40)];
    let [of_narrow, of_wide] = [&narrow, &wide].map(|occupancy| Codes::<f64>::new(occupancy, frame));
    let refused = |codes, discs| {
        let lattice = Lattice { occupancy: &narrow, codes, slack: 0.0 };
        catch_unwind(AssertUnwindSafe(|| search(&lattice, discs))).is_err()
    };
    assert!(!refused(&of_narrow, 1));
    assert!(refused(&of_narrow, 0));
    assert!(refused(&of_wide, 1));
}

/// One disc in twenty is ten times as large. Listed pairs are within the sum of their own radii and the skin; found ones touch.
#[test]
fn wide_sizes_are_listed_by_their_own_radii() {
    let (sides, skin) = ([40.0, 31.0], 0.2);
    let radius = |disc: usize| if disc.is_multiple_of(20) { 1.0 } else { 0.1 };
    let of = scattered(sides, [true, false], 2.0, skin, 2000, 13);
    let mut discs = StateRecords::<f64>::zeros(0, 2000, [true; 2], 1.0);
    for (axis, column) in of.places.iter().enumerate() {
        discs.fill(RecordEntry::of(axis, 0), |disc| column[disc]);
    }
    discs.fill(RecordEntry::Radius, |disc| if disc < 2000 { radius(disc) } else { 0.0 });
    let list = VerletList::new(&of.sectors, &discs, skin);
    let all = naive(&of.positions, sides, [true, false], 2.0 + skin);
    let within = |margin: f64| {
        let near = |[a, b]: [u32; 2], [x, y]: [f64; 2]| {
            x.hypot(y) < radius(a as usize) + radius(b as usize) + margin
        };
        all.iter().filter(|(pair, to)| near(**pair, **to)).map(|(pair, _)| *pair).collect::<Vec<_>>()
    };
    assert_eq!(list.entries(), within(skin).len());
    assert!(all.len() > 5 * list.entries());
    let (mut cursor, mut found) = (SearchCursor::at(0), PairBuffer::<f64>::default());
    let (rows, mut pairs) = (Finder::<f64, f64>::rows(&list).count, vec![]);
    while cursor.row() < rows {
        list.find(&discs, 0..rows, &mut cursor, &mut found, InstructionSet::best()).unwrap();
        let all = Finder::<f64, f64>::pairs(&list, &found);
        pairs.extend((0..all.count()).map(|number| all.pair(number).0).map(|[a, b]| [a.min(b), a.max(b)]));
    }
    pairs.sort_unstable();
    assert_eq!(pairs, within(0.0));
    assert!(pairs.len() > 100, "{}", pairs.len());
}

/// Threads share the construction of lists; the result does not depend on their number.
#[test]
fn verlet_lists_do_not_depend_on_threads() {
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut of = scattered([300.0, 130.0], [true, false], 1.0, 0.3, 50_000, 11);
            let before = VerletList::new(&of.sectors, &records(&of.places), 0.3);
            let order = of.sectors.order();
            of.sectors.renumber(&order);
            let places =
                of.places.map(|place| order.iter().map(|&disc| place[disc as usize]).collect::<Vec<_>>());
            let places = places.map(|place| [place.as_slice(), &[0.0; SENTINELS]].concat());
            let after = VerletList::new(&of.sectors, &records(&places), 0.3);
            assert!(before.entries() > 100_000 && after.entries() == before.entries());
            (order, before, after)
        })
    };
    let alone = made(1);
    assert!([2, 3].map(made).iter().all(|made| *made == alone));
}

/// Sectors that count the parts in which they are searched.
struct Counted<'a>(&'a Sectors, AtomicUsize);

// SAFETY: all pairs are those of the sectors.
unsafe impl Finder<f64, f64> for Counted<'_> {
    type Found = PairBuffer<f64>;

    fn discs(&self) -> usize {
        Finder::<f64, f64>::discs(self.0)
    }

    fn rows(&self) -> RowLayout {
        Finder::<f64, f64>::rows(self.0)
    }

    fn find(
        &self,
        discs: &StateRecords<f64>,
        rows: Range<usize>,
        cursor: &mut SearchCursor,
        found: &mut PairBuffer<f64>,
        set: InstructionSet,
    ) -> Result<(), ProgramError> {
        self.0.find(discs, rows, cursor, found, set)
    }

    fn pairs_tried(&self) -> f64 {
        Finder::<f64, f64>::pairs_tried(self.0)
    }

    fn search_items(&self, rows: Range<usize>) -> Range<usize> {
        Finder::<f64, f64>::search_items(self.0, rows)
    }

    fn find_part(&self, discs: &StateRecords<f64>, part: Range<usize>, found: &mut PairBuffer<f64>) {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.find_part(discs, part, found);
    }

    fn pairs<'a>(&'a self, found: &'a PairBuffer<f64>) -> impl PairSequence<f64> + 'a {
        Finder::<f64, f64>::pairs(self.0, found)
    }
}

/// If there are fewer bands than threads, sectors are searched in parts by all threads; forces, energy and pairs equal those of
/// one thread to the bit. If there are enough bands, each thread takes whole bands.
#[test]
fn joint_searches_are_bit_equal_to_serial_ones() {
    let law = CutOff::new(LennardJones::new(1.0, 0.9), 1.0);
    for (sides, periodic, discs, is_coarse) in [
        ([9.0, 9.0], [true, true], 6000, true),
        ([40.0, 3.0], [true, true], 5000, true),
        ([30.0, 50.0], [false, true], 8000, true),
        ([3.0, 3.0], [false, false], 300, true),
        ([200.0, 200.0], [true, true], 3000, false),
    ] {
        // Some hundred discs per sector, except in the last case.
        let wide = if is_coarse { sides.map(|side| (side / 3.0_f64).max(1.0)) } else { [1.0; 2] };
        let reach = wide[0].min(wide[1]);
        let grid = CellGrid::new(ORIGIN, sides, periodic, reach, f64::INFINITY, discs).unwrap();
        let Scattered { positions, .. } = scattered(sides, periodic, 1.0, 0.0, discs, 5);
        let mut sectors = Sectors::new(grid, discs, 1.0);
        let mut places = [vec![], vec![]];
        for (disc, position) in positions.iter().enumerate() {
            let along = [0, 1].map(|axis| position[axis] - ORIGIN[axis]);
            let cell = [0, 1].map(|axis| (along[axis] / grid.frame.edge[axis]) as usize);
            sectors.enter(disc, cell);
            for axis in 0..2 {
                places[axis].push(along[axis] - (cell[axis] as f64 + 0.5) * grid.frame.edge[axis]);
            }
        }
        sectors.arrange(|disc| disc);
        for (place, sentinels) in places.iter_mut().zip([[0.0, 1e3], [0.0; SENTINELS]]) {
            place.extend(sentinels);
        }
        let swept = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let counted = Counted(&sectors, AtomicUsize::new(0));
                let mut sweep = Sweep::new(counted.rows());
                let mut sums = ForceRecords::zeros(0, discs);
                let asked = ObservationRequest { energy: true, ..ObservationRequest::default() };
                let (records, set) = (records(&places), InstructionSet::best());
                let met = sweep.run(&law, &counted, &records, &mut sums, asked, set).unwrap();
                let bits: Vec<_> = (0..discs).map(|disc| sums.of(disc).map(f64::to_bits)).collect();
                (bits, met.pairs, met.energy.map(f64::to_bits), counted.1.into_inner())
            })
        };
        let alone = swept(1);
        assert!(alone.1 > 100 && alone.3 == 0, "{} pairs, {} parts", alone.1, alone.3);
        for threads in [2, 3, 8] {
            let shared = swept(threads);
            assert_eq!(shared.3 > threads, is_coarse, "{sides:?}: {} parts on {threads} threads", shared.3);
            assert!(
                (shared.0, shared.1, shared.2) == (alone.0.clone(), alone.1, alone.2),
                "{sides:?} {threads}"
            );
        }
    }
}
