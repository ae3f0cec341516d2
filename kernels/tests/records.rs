//! Blocks and quads: loaded, stored and added in every register file as number by number, to the bit. Pairs of 16-bit coordinates:
//! compared as integers of 64 bits.

use rand::RngExt;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::{Precision, RecordPlaces, RegisterTask, Registers, dispatch_native};
use stripmine_kernels::noise::{RandomPurpose, Stream};

/// Largest number of lanes.
const LANES: usize = 16;
const QUAD: usize = 4;

/// Quads of the discs 0 to 19, and the discs of the lanes; some discs are in two lanes.
struct Quads<P> {
    memory: Vec<P>,
    discs: [u32; LANES],
    partners: [u32; LANES],
}

impl<P: Precision> Quads<P> {
    fn new() -> Self {
        let memory = (0..20 * QUAD).map(|number| P::from_f64(0.1 + number as f64 / 7.0)).collect();
        let discs = std::array::from_fn(|lane| (7 * lane as u32 + 3) % 20);
        let partners = std::array::from_fn(|lane| (3 * lane as u32) % 5);
        Quads { memory, discs, partners }
    }

    /// Number `k` of the quad of a lane.
    fn number(&self, lane: usize, k: usize) -> P {
        self.memory[self.discs[lane] as usize * QUAD + k]
    }
}

/// The numbers of some registers, by register and lane.
fn spilled<R: Registers>(registers: R, values: [R::V; QUAD]) -> [[R::Lane; LANES]; QUAD] {
    values.map(|value| {
        let mut column = [R::Lane::default(); LANES];
        // SAFETY: there is space for the lanes of any register.
        unsafe { registers.store(column.as_mut_ptr(), value) };
        column
    })
}

impl<P: Precision> RegisterTask<P> for &Quads<P> {
    fn on<R: Registers<Lane = P>>(self, registers: R) {
        let Quads { memory, discs, partners } = self;
        let (block, lanes) = (16 / P::BYTES, R::LANES);
        let first = memory.as_ptr();
        let places = RecordPlaces { first: first.cast_mut(), stride: QUAD, records: discs };
        // SAFETY: every disc has four numbers, so there are as many blocks and quads as lanes.
        let (blocks, run, quads) = unsafe {
            (registers.load_blocks(places), registers.load_block_run(first), registers.load_quad_run(first))
        };
        let [blocks, of_run, of_quads] = [blocks, run, quads].map(|values| spilled(registers, values));
        for (k, lane) in (0..QUAD).flat_map(|k| (0..lanes).map(move |lane| (k, lane))) {
            assert_eq!(of_quads[k][lane], memory[lane * QUAD + k], "{k} of quad {lane}");
            if k < block {
                assert_eq!(blocks[k][lane], self.number(lane, k), "{k} of lane {lane}");
                assert_eq!(of_run[k][lane], memory[lane * block + k], "{k} of block {lane}");
            }
        }
        let mut stored = vec![P::default(); lanes * block];
        // SAFETY: there is space for a block of every lane.
        unsafe { registers.store_block_run(run, stored.as_mut_ptr()) };
        assert!(stored == memory[..lanes * block]);
        for count in [0, 1, lanes - 1, lanes] {
            let (mut sums, mut expected) = (memory.clone(), memory.clone());
            let subtracted = [quads[3], quads[0], quads[2], quads[1]];
            let first = sums.as_mut_ptr();
            let places = [discs, partners].map(|records| RecordPlaces { first, stride: QUAD, records });
            // SAFETY: every disc has four numbers.
            unsafe { registers.add_quads(count, [quads, subtracted], places) };
            for lane in 0..count {
                let [own, partner] = [discs, partners].map(|of| of[lane] as usize * QUAD);
                for k in 0..QUAD {
                    expected[own + k] = expected[own + k] + of_quads[k][lane];
                }
                for (k, other) in [3, 0, 2, 1].into_iter().enumerate() {
                    expected[partner + k] = expected[partner + k] - of_quads[other][lane];
                }
            }
            assert!(sums == expected, "{count} of {lanes} lanes");
        }
    }
}

#[test]
fn records_equal_single_numbers() {
    for set in InstructionSet::available() {
        dispatch_native(set, &Quads::<f64>::new()).unwrap();
        dispatch_native(set, &Quads::<f32>::new()).unwrap();
    }
}

/// Coordinates of a pair.
fn coordinates(pair: u32) -> [i64; 2] {
    [(pair as u16).cast_signed().into(), ((pair >> 16) as u16).cast_signed().into()]
}

/// Pairs of coordinates, and reaches of the same cells.
struct Cells {
    pairs: [u32; 2 * LANES],
    reaches: [u32; 2 * LANES],
    offset: u32,
    limit: i32,
    beyond: u32,
}

impl RegisterTask<f32> for &Cells {
    fn on<R: Registers<Lane = f32>>(self, registers: R) {
        let Cells { pairs, reaches, offset, limit, beyond } = self;
        for first in 0..=LANES {
            let (own, other) = (pairs.as_ptr(), pairs[first..].as_ptr());
            let of_reaches = [reaches.as_ptr(), reaches[first..].as_ptr()];
            // SAFETY: LANES or more pairs and reaches follow in all of these places.
            let [near, touching] = unsafe {
                [
                    registers.near_pairs(own, *offset, other, *limit),
                    registers.touching_pairs([own, of_reaches[0]], *offset, [other, of_reaches[1]], *beyond),
                ]
            };
            for lane in 0..R::LANES {
                let [[x, y], [a, b], [dx, dy]] = [pairs[lane], pairs[first + lane], *offset].map(coordinates);
                let square = (x - dx - a).pow(2) + (y - dy - b).pow(2);
                let reach = i64::from(reaches[lane] + reaches[first + lane] + beyond);
                assert_eq!(near >> lane & 1 == 1, square < i64::from(*limit), "{first} {lane}");
                assert_eq!(touching >> lane & 1 == 1, square < reach * reach, "{first} {lane}");
            }
            assert!((near | touching) >> R::LANES == 0);
        }
    }
}

#[test]
fn coordinates_are_compared_as_integers() {
    let mut random = Stream::new(5, RandomPurpose::Test, 0);
    for _ in 0..200 {
        let mut pair = |most: i16| {
            let [x, y] = [0, 1].map(|_| random.random_range(-most..=most));
            u32::from(x.cast_unsigned()) | u32::from(y.cast_unsigned()) << 16
        };
        let pairs = std::array::from_fn(|_| pair(5000));
        let offset = pair(6000);
        let reaches = std::array::from_fn(|_| random.random_range(0..5000));
        let cells = Cells { pairs, reaches, offset, limit: 8195 * 8195, beyond: random.random_range(0..900) };
        for set in InstructionSet::available() {
            dispatch_native(set, &cells).unwrap();
        }
    }
}
