//! Density waves along the periodic axes of the box.

use super::setting::Setting;
use crate::particles::Particle;
use rayon::iter::ParallelIterator;
use rayon::slice::ParallelSlice;
use std::f64::consts::TAU;

/// Waves along an axis at most, and the largest wave number times the diameter.
const WAVES: (usize, f64) = (100, 25.0);
/// Discs whose waves are summed up together.
const AT_A_TIME: usize = 512;

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
fn axes(setting: &Setting) -> Vec<usize> {
    (0..2).filter(|&axis| setting.domain.is_periodic(axis)).collect()
}

/// The wave number of each wave (1/length): the mean along both axes.
pub(super) fn numbers(setting: &Setting) -> Vec<f64> {
    let axes = axes(setting);
    let along =
        |periods: &[u32; 2], axis: usize| TAU * f64::from(periods[axis]) / setting.domain.length(axis);
    let of = |wave: [u32; 2]| axes.iter().map(|&axis| along(&wave, axis)).sum::<f64>() / axes.len() as f64;
    periods(setting).into_iter().map(of).collect()
}

/// S(k) = |Σ exp(ikr)|²/N, the mean along both axes.
pub(super) fn factor(setting: &Setting, discs: &[Particle]) -> Vec<f64> {
    let (periods, axes) = (periods(setting), axes(setting));
    let mut values = vec![0.0; periods.len()];
    for &axis in &axes {
        let along: Vec<u32> = periods.iter().map(|wave| wave[axis]).collect();
        let of = |discs: &[Particle]| sums(setting, discs, axis, &along);
        // Added in the order of the discs, however many threads.
        let parts: Vec<Vec<[f64; 2]>> = discs.par_chunks(AT_A_TIME).map(of).collect();
        for (wave, value) in values.iter_mut().enumerate() {
            let [x, y] = parts.iter().fold([0.0; 2], |[x, y], part| [x + part[wave][0], y + part[wave][1]]);
            *value += (x * x + y * y) / (discs.len() * axes.len()) as f64;
        }
    }
    values
}

/// Σ exp(ikr) of discs for each number of periods along an axis: each from the one before by a step, of which there are few.
fn sums(setting: &Setting, discs: &[Particle], axis: usize, periods: &[u32]) -> Vec<[f64; 2]> {
    let steps: Vec<u32> =
        periods.iter().scan(0, |last, &now| Some(now - std::mem::replace(last, now))).collect();
    let mut different = steps.clone();
    different.sort_unstable();
    different.dedup();
    let places: Vec<usize> = steps.iter().map(|step| different.partition_point(|it| it < step)).collect();
    let mut sums = vec![[0.0; 2]; periods.len()];
    for disc in discs {
        let angle = TAU * (disc.position[axis] - setting.domain.origin[axis]) / setting.domain.length(axis);
        let turns: Vec<[f64; 2]> = different
            .iter()
            .map(|&step| libm::sincos(angle * f64::from(step)))
            .map(|(sine, cosine)| [cosine, sine])
            .collect();
        let [mut x, mut y] = [1.0, 0.0];
        for (sum, &place) in sums.iter_mut().zip(&places) {
            let [cosine, sine] = turns[place];
            [x, y] = [x * cosine - y * sine, x * sine + y * cosine];
            *sum = [sum[0] + x, sum[1] + y];
        }
    }
    sums
}
