//! Density waves in the pipe, over eight starts: wavelengths, distances of the maxima, correlation time, spectrum of one bin, and directions.

use super::pipe_flow::{Flow, MAP_BIN, run_pipe};
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::{MeanWithBar, slope};
use std::f64::consts::TAU;
use stripmine_physics::scene::{Overrides, PACKING_FRACTION, SIDES, WALL_SPACING};

/// Starts of the pipe, and of each other condition.
const SEEDS: [u64; 8] = [1, 2, 3, 4, 5, 6, 7, 8];
const OTHER_SEEDS: usize = 4;
/// Longest modes of the pipe that are compared, of wavelengths from 81 mean radii on.
const MODES: usize = 10;
/// Bins over which the density is averaged to find maxima: 20 mean radii.
const SMOOTHED: usize = 4;
/// Frequencies between which the spectrum of a bin is fitted (1/s).
const FITTED: [f64; 2] = [0.5, 5.0];
/// Power of the spectrum in experiments with sand in air (Moriyama et al. 1998).
const EXPERIMENT: f64 = -4.0 / 3.0;

/// Results of a run, over its last half.
struct WaveRun {
    /// Power of each mode, and the strongest mode, at each moment.
    powers: Vec<[f64; MODES]>,
    strongest: Vec<usize>,
    /// Mean distance of neighbouring maxima at each moment, and all distances (mean radii).
    distances: Vec<f64>,
    all_distances: Vec<f64>,
    /// Correlation of the density with itself, by samples of delay.
    correlation: Vec<f64>,
    /// Power of the frequencies of a bin, mean over the bins.
    spectrum: Vec<f64>,
    interval: f64,
}

impl WaveRun {
    /// Reads the last half of the grains in bins at moments that are an interval apart (s).
    fn of(density: &[Vec<u32>], interval: f64) -> WaveRun {
        let late = &density[density.len() / 2..];
        let rows: Vec<Vec<f64>> =
            late.iter().map(|row| row.iter().map(|&n| f64::from(n)).collect()).collect();
        let powers: Vec<[f64; MODES]> =
            rows.iter().map(|row| std::array::from_fn(|mode| power(row.iter().copied(), mode + 1))).collect();
        let strongest =
            |powers: &[f64; MODES]| (0..MODES).max_by(|&a, &b| powers[a].total_cmp(&powers[b])).unwrap_or(0);
        let maxima: Vec<Vec<f64>> = rows.iter().map(|row| distances_of_maxima(row)).collect();
        let bins = rows[0].len();
        let columns: Vec<Vec<f64>> = (0..bins)
            .map(|bin| {
                let mean = rows.iter().map(|row| row[bin]).sum::<f64>() / rows.len() as f64;
                rows.iter().map(|row| row[bin] - mean).collect()
            })
            .collect();
        let mean_of_bins =
            |of: &dyn Fn(&[f64]) -> f64| columns.iter().map(|it| of(it)).sum::<f64>() / bins as f64;
        let product = |delay: usize| {
            mean_of_bins(&|it| {
                it.iter().zip(&it[delay..]).map(|(a, b)| a * b).sum::<f64>() / (it.len() - delay) as f64
            })
        };
        let half = rows.len() / 2;
        WaveRun {
            strongest: powers.iter().map(strongest).collect(),
            powers,
            distances: maxima.iter().map(|it| it.iter().sum::<f64>() / it.len().max(1) as f64).collect(),
            all_distances: maxima.into_iter().flatten().collect(),
            correlation: (0..half).map(|delay| product(delay) / product(0)).collect(),
            spectrum: (1..half).map(|mode| mean_of_bins(&|it| power(it.iter().copied(), mode))).collect(),
            interval,
        }
    }

    /// Delay after which the correlation is below 1/e (s).
    fn correlation_time(&self) -> f64 {
        let delay = self.correlation.iter().position(|it| *it < (-1f64).exp());
        self.interval * delay.unwrap_or(self.correlation.len()) as f64
    }

    /// Frequency of an entry of the spectrum (1/s).
    fn frequency(&self, at: usize) -> f64 {
        (at + 1) as f64 / (self.powers.len() as f64 * self.interval)
    }

    /// Power by which the spectrum of a bin falls with the frequency.
    fn exponent(&self) -> f64 {
        let fitted = (0..self.spectrum.len())
            .filter(|&at| (FITTED[0]..=FITTED[1]).contains(&self.frequency(at)))
            .map(|at| (self.frequency(at).ln(), self.spectrum[at].ln()));
        let (x, y): (Vec<f64>, Vec<f64>) = fitted.unzip();
        slope(&x, &y)
    }

    /// Standard deviation of the distances of maxima over their mean.
    fn irregularity(&self) -> f64 {
        let mean = self.all_distances.iter().sum::<f64>() / self.all_distances.len() as f64;
        let squares: f64 = self.all_distances.iter().map(|it| (it / mean - 1.0).powi(2)).sum();
        (squares / self.all_distances.len() as f64).sqrt()
    }
}

/// |Σ v exp(2πi k j/n)|²/Σ v², for the mode k of n values.
fn power(values: impl ExactSizeIterator<Item = f64> + Clone, mode: usize) -> f64 {
    let turn = TAU * mode as f64 / values.len() as f64;
    let squares: f64 = values.clone().map(|v| v * v).sum();
    let sums = values.zip(0..).fold([0.0; 2], |[cosines, sines], (v, at)| {
        let angle = turn * f64::from(at);
        [cosines + v * libm::cos(angle), sines + v * libm::sin(angle)]
    });
    (sums[0] * sums[0] + sums[1] * sums[1]) / squares.max(f64::MIN_POSITIVE)
}

/// Distances of neighbouring maxima of the smoothed density above its mean (mean radii), around the periodic pipe.
fn distances_of_maxima(row: &[f64]) -> Vec<f64> {
    let bins = row.len();
    let smooth: Vec<f64> =
        (0..bins).map(|bin| (0..SMOOTHED).map(|more| row[(bin + more) % bins]).sum()).collect();
    let mean = smooth.iter().sum::<f64>() / bins as f64;
    let is_maximum = |&bin: &usize| {
        let around = (1..=SMOOTHED).flat_map(|step| [(bin + step) % bins, (bin + bins - step) % bins]);
        // Of equal neighbours the first one counts.
        smooth[bin] > mean
            && around
                .clone()
                .all(|other| smooth[other] < smooth[bin] || smooth[other] == smooth[bin] && other > bin)
    };
    let maxima: Vec<usize> = (0..bins).filter(is_maximum).collect();
    let next = maxima.iter().skip(1).copied().chain(maxima.first().map(|first| first + bins));
    maxima.iter().zip(next).map(|(at, next)| MAP_BIN * (next - at) as f64).collect()
}

/// Runs the pipe with every seed, and other conditions with some.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let filled = |fraction: f64| Overrides::new().set(&PACKING_FRACTION, fraction);
    let conditions = [
        ("pipe of figure 6", Overrides::new()),
        ("filling 0.35", filled(0.35)),
        ("filling 0.30", filled(0.30)),
        ("wall discs 15 % farther apart", Overrides::new().set(&WALL_SPACING, 0.031)),
        ("wall discs 15 % closer", Overrides::new().set(&WALL_SPACING, 0.023)),
        ("twice as long", Overrides::new().set(&SIDES, [16.2, 0.088])),
    ];
    let runs: Vec<(&Overrides, u64)> = conditions
        .iter()
        .enumerate()
        .flat_map(|(at, (_, scene))| {
            SEEDS[..if at == 0 { SEEDS.len() } else { OTHER_SEEDS }].iter().map(move |&seed| (scene, seed))
        })
        .collect();
    let flows = ProgressMeter::new(runs.len() as f64, lab.progress)
        .run_cases(&runs, |&(scene, seed)| run_pipe("pipe", scene, seed, false, |_| {}))?;
    let (own, others) = flows.split_at(SEEDS.len());
    let directed = std::iter::once(own).chain(others.chunks(OTHER_SEEDS));
    let waves: Vec<WaveRun> =
        own.iter().map(|flow| WaveRun::of(&flow.density, flow.times[1] - flow.times[0])).collect();
    let mut made = frames(&waves).to_vec();
    let share =
        |flows: &[Flow], of: fn(&Flow) -> f64| MeanWithBar::of(&flows.iter().map(of).collect::<Vec<_>>());
    made.push(
        FrameBuilder::of(conditions.iter().map(|(name, _)| *name).zip(directed))
            .text("condition", |(name, _)| *name)
            .count("seeds", |(_, flows)| flows.len())
            .mean("against gravity", 2, |(_, flows)| share(flows, |it| it.directions.back))
            .mean("standing", 2, |(_, flows)| share(flows, |it| it.directions.standing))
            .mean("with gravity", 2, |(_, flows)| {
                share(flows, |it| 1.0 - it.directions.back - it.directions.standing)
            })
            .mean("with gravity over one wave", 2, |(_, flows)| {
                share(flows, |it| it.directions.forth / it.directions.of_one_wave[1])
            })
            .mean("power", 1, |(_, flows)| share(flows, |it| it.directions.power))
            .frame("directions", "Share of the spectral power by direction, late half"),
    );
    Ok(FinishedItem::of(made).with_seeds(SEEDS))
}

fn frames(waves: &[WaveRun]) -> [ResultFrame; 5] {
    let over = |of: &dyn Fn(&WaveRun) -> f64| MeanWithBar::of(&waves.iter().map(of).collect::<Vec<_>>());
    let moments: usize = waves.iter().map(|it| it.strongest.len()).sum();
    let counts: [usize; MODES] = std::array::from_fn(|mode| {
        waves.iter().flat_map(|it| &it.strongest).filter(|it| **it == mode).count()
    });
    let distances: Vec<MeanWithBar> =
        waves.iter().map(|it| MeanWithBar::of_time_series(&it.distances)).collect();
    let spread = over(&|it| it.distances.iter().sum::<f64>() / it.distances.len() as f64);
    // Variance of the seeds' means over that expected from the moments; a 95 % half-width is two standard errors.
    let between: f64 =
        distances.iter().map(|it| (it.value - spread.value).powi(2)).sum::<f64>() / (waves.len() - 1) as f64;
    let within = distances.iter().map(|it| (0.5 * it.bar).powi(2)).sum::<f64>() / waves.len() as f64;
    [
        FrameBuilder::of(waves.iter().zip(&distances).zip(SEEDS))
            .count("seed", |(_, seed)| *seed)
            .mean("distance of maxima (mean radii)", 1, |((_, distance), _)| **distance)
            .number("its standard deviation over the mean", 2, |((it, _), _)| it.irregularity())
            .number("correlation time (s)", 2, |((it, _), _)| it.correlation_time())
            .number("power of the spectrum of a bin", 2, |((it, _), _)| it.exponent())
            .frame("runs", "Waves of each start, late half"),
        FrameBuilder::of(0..MODES)
            .number("wavelength (mean radii)", 0, |mode| 810.0 / (mode + 1) as f64)
            .mean("power", 2, |&mode| {
                over(&|it| it.powers.iter().map(|it| it[mode]).sum::<f64>() / it.powers.len() as f64)
            })
            .number("share of the moments in which it is the strongest", 3, |mode| {
                counts[*mode] as f64 / moments as f64
            })
            .frame("modes", "Power of the wavelengths, mean over moments and starts"),
        FrameBuilder::of(0..waves[0].correlation.len())
            .number("delay", 2, |at| waves[0].interval * *at as f64)
            .mean("correlation", 3, |&at| over(&|it| it.correlation[at]))
            .frame("correlation", "Correlation of the density with itself"),
        FrameBuilder::of(0..waves[0].spectrum.len())
            .number("frequency", 3, |at| waves[0].frequency(*at))
            .mean("power", 4, |&at| over(&|it| it.spectrum[at]))
            .number("power of experiments", 4, |&at| {
                over(&|it| it.spectrum[0] * (it.frequency(at) / it.frequency(0)).powf(EXPERIMENT)).value
            })
            .frame("spectrum", "Power spectrum of the grains in a bin of five mean radii"),
        FrameBuilder::of([()])
            .number("largest share of a wavelength", 3, |()| {
                counts.iter().max().copied().unwrap_or(0) as f64 / moments as f64
            })
            .mean("irregularity of the distances", 2, |()| over(&WaveRun::irregularity))
            .mean("correlation time (s)", 2, |()| over(&WaveRun::correlation_time))
            .number("variance of the seeds over that of moments", 2, |()| between / within)
            .mean("power of the spectrum", 2, |()| over(&WaveRun::exponent))
            .number("power in experiments", 2, |()| EXPERIMENT)
            .frame("summary", "Waves over all starts"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::noise::{RandomPurpose, normals};

    /// By hand: two crests 16 and 24 bins apart in 40 bins; a pure wave has all power in its mode.
    #[test]
    fn maxima_and_modes_of_known_rows() {
        let mut row = vec![1.0; 40];
        (row[5], row[21]) = (9.0, 7.0);
        assert_eq!(distances_of_maxima(&row), [80.0, 120.0]);
        let wave = (0..40).map(|at| libm::cos(TAU * 3.0 * f64::from(at) / 40.0));
        assert!((power(wave.clone(), 3) - 20.0).abs() < 1e-9 && power(wave, 4) < 1e-9);
    }

    /// A density that falls as exp(−t/τ) at random bins has the correlation time τ, and a spectrum as f^(−2) above 1/(2πτ).
    #[test]
    fn correlation_times_of_known_noise() {
        let (interval, time, bins, moments) = (0.05, 0.5_f64, 60, 400);
        let decay = (-interval / time).exp();
        let mut values = vec![0.0_f64; bins];
        let density: Vec<Vec<u32>> = (0..2 * moments)
            .map(|moment| {
                values.iter_mut().zip(0..).for_each(|(value, bin)| {
                    let [kick, _] = normals(1, RandomPurpose::Test, bin, moment as u64);
                    *value = decay * *value + (1.0 - decay * decay).sqrt() * kick;
                });
                values.iter().map(|value| (1e4 + 1e3 * value) as u32).collect()
            })
            .collect();
        let run = WaveRun::of(&density, interval);
        assert!((run.correlation_time() - time).abs() < 0.15, "{}", run.correlation_time());
        assert!((run.exponent() + 1.6).abs() < 0.4, "{}", run.exponent());
    }
}
