//! Calibration of a host model: programs of drill scenes of up to 4 million cells are timed in every execution, and the model is fitted to the
//! times.

mod fit;
mod programs;
mod scenes;

use super::StudyError;
use super::samples::Samples;
use crate::laboratory::running::on_threads;
use crate::model::host::{ExecutionPrices, FORMAT, HostModel, LaneCosts, MeasurementConditions};
use crate::statistics::median;
use fit::fit_robustly;
use programs::{DrillPrograms, FOOTPRINTS, LANES, LONGEST};
use scenes::DrillScenes;
use std::time::{Duration, Instant};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::tape::register_shape;
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::origin::{host, load_average};

/// Shortest vectors: with fewer elements the start of a pass dominates.
const SHORTEST: usize = 8;
/// Approximate seconds reserved for fitting.
const FITTING: f64 = 5.0;
/// Share of the time for drill scenes whose work depends on the data.
const SCENES: f64 = 0.4;

/// Measures this host on one thread for about `seconds`, whatever else the machine is doing, and fits its model. Everything required is
/// measured at least once, regardless of the time. `progress` receives the completed share.
///
/// # Errors
/// [`StudyError`] if the processor lacks the instruction set, or a drill scene breaks.
pub(crate) fn calibrate(seconds: f64, progress: impl Fn(f64) + Sync) -> Result<HostModel, StudyError> {
    on_threads(1, || Ok(measure_host(seconds, &progress)?))
}

fn measure_host(seconds: f64, progress: &dyn Fn(f64)) -> Result<HostModel, MeasurementError> {
    let (set, begun, load) = (InstructionSet::best(), Instant::now(), load_average());
    let shapes = [register_shape::<f64>(set)?, register_shape::<f32>(set)?];
    let (mut programs, mut scenes) = (DrillPrograms::new()?, DrillScenes::new()?);
    let (end, mut of_scenes) = ((seconds - FITTING).max(1.0), Duration::ZERO);
    // Programs and scenes alternate, so that both are measured under the same conditions.
    for number in 0.. {
        programs.sweep(set, number)?;
        if of_scenes < begun.elapsed().mul_f64(SCENES) {
            let start = Instant::now();
            scenes.sweep(begun + Duration::from_secs_f64(end))?;
            of_scenes += start.elapsed();
        }
        let share = begun.elapsed().as_secs_f64() / end;
        progress(share.min(1.0));
        if share >= 1.0 {
            break;
        }
    }
    let mut deviations = vec![];
    let mut prices = |lane, is_chained, shape| {
        let rows = programs.rows((lane, is_chained), shape);
        let prices = fit_robustly(&rows);
        deviations.extend(rows.iter().map(|row| row.deviation(&prices)));
        ExecutionPrices::of(&prices)
    };
    let of_lanes = LANES.into_iter().zip(shapes).map(|(lane, shape)| {
        let [interpreted, chained] = [false, true].map(|is_chained| prices(lane, is_chained, shape));
        let (register_bytes, lanes) = shape;
        (lane.to_owned(), LaneCosts { register_bytes, lanes, interpreted, chained })
    });
    let of_lanes = of_lanes.collect();
    let spread = majority_median(programs.samples().map(Samples::spread));
    let disagreement = majority_median(programs.samples().map(Samples::disagreement));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let measured = MeasurementConditions {
        state: MeasurementConditions::state_of([spread, disagreement], load, cores),
        load,
        seconds: begun.elapsed().as_secs_f64(),
        spread,
        disagreement,
        shortest: SHORTEST,
        longest: LONGEST,
        residual: median(deviations.into_iter()),
    };
    Ok(HostModel {
        format: FORMAT,
        title: host(),
        instruction_set: set.name().to_owned(),
        footprints: FOOTPRINTS.to_vec(),
        measured,
        programs: of_lanes,
        discs: scenes.discs(),
        rates: scenes.rates(),
    })
}

/// Median of the known values; `None` if most are unknown.
fn majority_median(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let all: Vec<Option<f64>> = values.collect();
    let known: Vec<f64> = all.iter().copied().flatten().filter(|value| value.is_finite()).collect();
    (2 * known.len() > all.len()).then(|| median(known.into_iter()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_needs_a_majority_of_known_values() {
        let of = |values: &[Option<f64>]| majority_median(values.iter().copied());
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[None, None, Some(0.1)]), None);
        assert_eq!(of(&[None, Some(0.3), Some(0.1), Some(0.2)]), Some(0.2));
        assert_eq!(of(&[Some(f64::NAN), Some(0.1)]), None);
    }
}
