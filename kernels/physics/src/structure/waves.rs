//! Density waves along the periodic axes of the box.

use super::discs::Discs;
use super::setting::Setting;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
use rayon::slice::ParallelSlice;
use std::f64::consts::TAU;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::{Registers, Task, dispatch_native};

/// Waves along an axis at most, and the largest wave number times the diameter.
const WAVES: (usize, f64) = (100, 25.0);
/// Discs whose waves are summed up together.
const AT_A_TIME: usize = 512;
/// Discs at once, each with sums of its own.
const LANES: usize = 8;

/// A complex number of each of some discs.
type Turns = [[f64; LANES]; 2];

/// For each wave its periods along both sides, the nearest to the same wave number; along all sides that are periodic.
fn periods(setting: &Setting) -> Vec<[u32; 2]> {
    let (count, largest) = WAVES;
    let of = |wave: usize| {
        let number = largest / setting.diameter * wave as f64 / count as f64;
        [0, 1].map(|axis| match setting.domain.is_periodic(axis) {
            true => ((number * setting.domain.length(axis) / TAU).round() as u32).max(1),
            false => 0,
        })
    };
    let mut periods: Vec<[u32; 2]> = (1..=count).map(of).collect();
    periods.dedup();
    periods
}

/// The periodic axes.
fn axes(setting: &Setting) -> impl Iterator<Item = usize> {
    let domain = setting.domain;
    (0..2).filter(move |&axis| domain.is_periodic(axis))
}

/// How many sums a disc is part of.
pub(super) fn sums_of_a_disc(setting: &Setting) -> usize {
    periods(setting).len() * axes(setting).count()
}

/// The wave number of each wave (1/length): the mean along both axes.
pub(super) fn numbers(setting: &Setting) -> Vec<f64> {
    let count = axes(setting).count() as f64;
    let along =
        |periods: &[u32; 2], axis: usize| TAU * f64::from(periods[axis]) / setting.domain.length(axis);
    let of = |wave: [u32; 2]| axes(setting).map(|axis| along(&wave, axis)).sum::<f64>() / count;
    periods(setting).into_iter().map(of).collect()
}

/// S(k) = |Σ exp(ikr)|²/N, the mean along both axes.
pub(super) fn factor(waves: &Waves, values: &mut [f64]) {
    values.copy_from_slice(&waves.factor);
}

/// The waves of a box, and their sums.
#[derive(Clone, Debug)]
pub(super) struct Waves {
    along: Vec<Along>,
    factor: Vec<f64>,
    parts: Vec<Vec<Turns>>,
}

/// The waves along an axis: each by a step of periods from the one before.
#[derive(Clone, Debug)]
struct Along {
    axis: usize,
    /// The steps that there are.
    different: Vec<u32>,
    /// The place of each wave's among them.
    steps: Vec<usize>,
}

impl Waves {
    /// Those of a box.
    pub(super) fn new(setting: &Setting) -> Waves {
        let periods = periods(setting);
        let of = |axis: usize| {
            let ends = periods.iter().map(|wave| wave[axis]);
            let steps: Vec<u32> =
                ends.scan(0, |last, now| Some(now - std::mem::replace(last, now))).collect();
            let mut different = steps.clone();
            different.sort_unstable();
            different.dedup();
            let steps = steps.iter().map(|step| different.partition_point(|it| it < step)).collect();
            Along { axis, different, steps }
        };
        Waves { along: axes(setting).map(of).collect(), factor: vec![0.0; periods.len()], parts: vec![] }
    }

    /// Sums up the discs.
    pub(super) fn sum(&mut self, setting: &Setting, discs: &Discs) {
        let Waves { along, factor, parts } = self;
        factor.fill(0.0);
        let count = discs.x.len();
        parts.resize(count.div_ceil(AT_A_TIME), vec![]);
        for Along { axis, different, steps } in &*along {
            let by_length = TAU / setting.domain.length(*axis);
            let origin = setting.domain.origin[*axis];
            let places = if *axis == 0 { &discs.x } else { &discs.y };
            parts.par_iter_mut().zip(places.par_chunks(AT_A_TIME)).for_each(|(sums, places)| {
                sums.clear();
                sums.resize(steps.len(), [[0.0; LANES]; 2]);
                let summing = Summing { places, origin, by_length, different, steps, sums };
                dispatch_native(InstructionSet::best(), summing).unwrap_or_default();
            });
            for (wave, value) in factor.iter_mut().enumerate() {
                let part = |sums: &Vec<Turns>| sums[wave].map(|lanes| lanes.iter().sum::<f64>());
                // Added in the order of the discs, however many threads.
                let [x, y] = parts.iter().map(part).fold([0.0; 2], |[x, y], [a, b]| [x + a, y + b]);
                *value += (x * x + y * y) / (count * along.len()) as f64;
            }
        }
    }
}

/// Sums up exp(ikr) of some discs for each wave along an axis.
struct Summing<'w> {
    places: &'w [f64],
    origin: f64,
    by_length: f64,
    different: &'w [u32],
    steps: &'w [usize],
    sums: &'w mut [Turns],
}

impl Task<f64> for Summing<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, _: R) {
        let Summing { places, origin, by_length, different, steps, sums } = self;
        let mut turns = vec![[[0.0; LANES]; 2]; different.len()];
        for places in places.chunks(LANES) {
            // What is not there adds nothing.
            let [mut one, mut now] = [[[0.0; LANES]; 2]; 2];
            for (at, place) in places.iter().enumerate() {
                let (sine, cosine) = libm::sincos((place - origin) * by_length);
                (one[0][at], one[1][at], now[0][at]) = (cosine, sine, 1.0);
            }
            turns.iter_mut().zip(different).for_each(|(turn, &step)| *turn = power(&one, step));
            for (sum, &step) in sums.iter_mut().zip(steps) {
                now = product(&now, &turns[step]);
                for at in 0..LANES {
                    sum[0][at] += now[0][at];
                    sum[1][at] += now[1][at];
                }
            }
        }
    }
}

#[inline(always)]
fn product(a: &Turns, b: &Turns) -> Turns {
    let mut product = [[0.0; LANES]; 2];
    for at in 0..LANES {
        product[0][at] = a[0][at] * b[0][at] - a[1][at] * b[1][at];
        product[1][at] = a[0][at] * b[1][at] + a[1][at] * b[0][at];
    }
    product
}

/// A power by squares.
#[inline(always)]
fn power(one: &Turns, exponent: u32) -> Turns {
    let (mut square, mut rest) = (*one, exponent);
    let mut power = [[1.0; LANES], [0.0; LANES]];
    while rest > 0 {
        if rest & 1 == 1 {
            power = product(&power, &square);
        }
        square = product(&square, &square);
        rest >>= 1;
    }
    power
}
