//! Density waves along the periodic axes of the box.

use super::discs::SampledDiscs;
use super::setting::StructureSetting;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
use rayon::slice::ParallelSlice;
use std::f64::consts::TAU;
use stripmine_kernels::backend::{RegisterTask, Registers, dispatch_best};

/// Waves along an axis: the number of the longest ones, then the number of others up to the largest wave number, and that number times the
/// diameter.
const WAVES: [u32; 2] = [128, 128];
const LARGEST: f64 = 25.0;
/// Discs in the sums of one task.
const AT_A_TIME: usize = 512;
/// Discs processed together, each with its own sums.
const LANES: usize = 8;

/// Complex number of each of some discs.
type Phasors = [[f64; LANES]; 2];

/// Periods along a side of each of its waves: all up to the largest wave number if these are not too many, else the longest and, evenly between
/// these and the shortest, as many others.
fn periods(setting: &StructureSetting, axis: usize) -> Vec<u32> {
    let [longest, others] = WAVES;
    let most = (LARGEST / setting.diameter * setting.domain.length(axis) / TAU) as u32;
    if most <= longest + others {
        return (1..=most.max(1)).collect();
    }
    let between =
        |other: u32| longest + (u64::from(most - longest) * u64::from(other) / u64::from(others)) as u32;
    (1..=longest).chain((1..=others).map(between)).collect()
}

/// Periodic axes of the box.
fn axes(setting: &StructureSetting) -> impl Iterator<Item = usize> {
    let domain = setting.domain;
    (0..2).filter(move |&axis| domain.is_periodic(axis))
}

/// Number of sums that a disc contributes to.
pub(super) fn sums_of_a_disc(setting: &StructureSetting) -> usize {
    axes(setting).map(|axis| periods(setting, axis).len()).sum()
}

/// Largest memory of the sums of waves along an axis (bytes).
pub(super) fn bytes_of_waves(discs: usize) -> u64 {
    let waves = WAVES.iter().sum::<u32>() as usize;
    (discs.div_ceil(AT_A_TIME) * waves * size_of::<Phasors>()) as u64
}

/// Wave vector of each wave (1/length): those along x, then those along y.
pub(super) fn vectors(setting: &StructureSetting) -> Vec<[f64; 2]> {
    let along = |axis: usize| {
        let of = move |periods: u32| {
            let mut vector = [0.0; 2];
            vector[axis] = TAU * f64::from(periods) / setting.domain.length(axis);
            vector
        };
        periods(setting, axis).into_iter().map(of)
    };
    axes(setting).flat_map(along).collect()
}

/// Structure factor S(k) = |Σ exp(ikr)|²/N of each wave.
pub(super) fn factor(waves: &Waves, values: &mut [f64]) {
    values.copy_from_slice(&waves.factor);
}

/// Partial structure factors of each pair of species and wave.
pub(super) fn partial_factors(waves: &Waves, values: &mut [f64]) {
    values.copy_from_slice(&waves.partial);
}

/// Species and wave vectors of the partial structure factors.
pub(super) fn vectors_of_species(setting: &StructureSetting) -> Vec<Vec<f64>> {
    let over: Vec<Vec<f64>> = vectors(setting).iter().map(|vector| vector.to_vec()).collect();
    setting.by_pairs_of_species(&over)
}

/// Waves of a box, and their sums.
#[derive(Clone, Debug)]
pub(super) struct Waves {
    along: Vec<AxisWaves>,
    factor: Vec<f64>,
    /// S_ab of each pair of species, wave by wave.
    partial: Vec<f64>,
    parts: Vec<Vec<Phasors>>,
}

/// Waves along an axis, each a step of periods from the one before.
#[derive(Clone, Debug)]
struct AxisWaves {
    axis: usize,
    /// Different steps that occur.
    different: Vec<u32>,
    /// Index of each wave's step among them.
    steps: Vec<usize>,
}

impl Waves {
    /// Waves of a box.
    pub(super) fn new(setting: &StructureSetting) -> Waves {
        let of = |axis: usize| {
            let ends = periods(setting, axis).into_iter();
            let steps: Vec<u32> =
                ends.scan(0, |last, now| Some(now - std::mem::replace(last, now))).collect();
            let mut different = steps.clone();
            different.sort_unstable();
            different.dedup();
            let steps = steps.iter().map(|step| different.partition_point(|it| it < step)).collect();
            AxisWaves { axis, different, steps }
        };
        Waves {
            along: axes(setting).map(of).collect(),
            factor: vec![0.0; sums_of_a_disc(setting)],
            partial: vec![],
            parts: vec![],
        }
    }

    /// Sums over the discs.
    pub(super) fn sum(&mut self, setting: &StructureSetting, discs: &SampledDiscs) {
        let (count, amplitudes) = (discs.x.len(), self.amplitudes(setting, discs));
        for (value, [x, y]) in self.factor.iter_mut().zip(amplitudes) {
            *value = (x * x + y * y) / count as f64;
        }
    }

    /// Computes Re ρ_a ρ_b*/√(N_a N_b) of each pair of species, ρ being the sum over the discs of one; NaN if one has none.
    pub(super) fn sum_species(&mut self, setting: &StructureSetting, discs: &SampledDiscs) {
        let of = |species: usize| {
            let is_own = |own: &u8| usize::from(*own) == species;
            let column = |of: &[f64]| {
                of.iter().zip(&discs.species).filter(|(_, own)| is_own(own)).map(|(at, _)| *at).collect()
            };
            SampledDiscs { x: column(&discs.x), y: column(&discs.y), ..SampledDiscs::default() }
        };
        let members: Vec<SampledDiscs> = (0..setting.species).map(of).collect();
        let sums: Vec<Vec<[f64; 2]>> = members.iter().map(|it| self.amplitudes(setting, it)).collect();
        self.partial.clear();
        for [a, b] in setting.pairs_of_species() {
            let norm = ((members[a].x.len() * members[b].x.len()) as f64).sqrt();
            let factors = sums[a].iter().zip(&sums[b]).map(|([x, y], [u, v])| match norm > 0.0 {
                true => (x * u + y * v) / norm,
                false => f64::NAN,
            });
            self.partial.extend(factors);
        }
    }

    /// Σ exp(ikr) of each wave, real and imaginary part.
    fn amplitudes(&mut self, setting: &StructureSetting, discs: &SampledDiscs) -> Vec<[f64; 2]> {
        let Waves { along, factor, parts, .. } = self;
        let count = discs.x.len();
        let mut amplitudes = Vec::with_capacity(factor.len());
        parts.resize(count.div_ceil(AT_A_TIME), vec![]);
        for AxisWaves { axis, different, steps } in &*along {
            let by_length = TAU / setting.domain.length(*axis);
            let origin = setting.domain.origin[*axis];
            let places = if *axis == 0 { &discs.x } else { &discs.y };
            parts.par_iter_mut().zip(places.par_chunks(AT_A_TIME)).for_each(|(sums, places)| {
                sums.clear();
                sums.resize(steps.len(), [[0.0; LANES]; 2]);
                let summing = WaveTask { places, origin, by_length, different, steps, sums };
                dispatch_best(summing);
            });
            for wave in 0..steps.len() {
                let part = |sums: &Vec<Phasors>| sums[wave].map(|lanes| lanes.iter().sum::<f64>());
                // The sum is in the order of the discs for any number of threads.
                amplitudes.push(parts.iter().map(part).fold([0.0; 2], |[x, y], [a, b]| [x + a, y + b]));
            }
        }
        amplitudes
    }
}

/// Sum of exp(ikr) over some discs for each wave along an axis.
struct WaveTask<'w> {
    places: &'w [f64],
    origin: f64,
    by_length: f64,
    different: &'w [u32],
    steps: &'w [usize],
    sums: &'w mut [Phasors],
}

impl RegisterTask<f64> for WaveTask<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, _: R) {
        let WaveTask { places, origin, by_length, different, steps, sums } = self;
        let mut turns = vec![[[0.0; LANES]; 2]; different.len()];
        for places in places.chunks(LANES) {
            // Missing discs add nothing.
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
fn product(a: &Phasors, b: &Phasors) -> Phasors {
    let mut product = [[0.0; LANES]; 2];
    for at in 0..LANES {
        product[0][at] = a[0][at] * b[0][at] - a[1][at] * b[1][at];
        product[1][at] = a[0][at] * b[1][at] + a[1][at] * b[0][at];
    }
    product
}

/// Power by repeated squaring.
#[inline(always)]
fn power(one: &Phasors, exponent: u32) -> Phasors {
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
