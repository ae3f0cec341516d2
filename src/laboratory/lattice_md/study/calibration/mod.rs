//! How long do this host's operations take? The programs of drill scenes, of up to 4 million cells, are timed in every execution, and
//! a host model is fitted to the times.

mod fit;
mod programs;
mod scenes;

use super::samples::Samples;
use crate::model::host::{Costs, FORMAT, HostModel, LaneCosts, Measured};
use crate::statistics::median;
use fit::suited;
use programs::{FOOTPRINTS, LANES, LONGEST, Programs};
use scenes::Scenes;
use std::time::{Duration, Instant};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::tape::register_shape;
use stripmine_kernels::isa::ProgramError;
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::origin::load_average;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Seconds that it takes about; what has to be measured at all is measured once, whatever that takes.
    pub seconds: f64,
}

impl Default for Effort {
    fn default() -> Self {
        Effort { seconds: 75.0 }
    }
}

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// The processor lacks the instruction set.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// A drill scene broke.
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
}

/// Shortest vectors: of fewer elements nothing but the start of a pass counts.
const SHORTEST: usize = 8;
/// Seconds that fitting takes about, which are kept back.
const FITTING: f64 = 5.0;
/// The share of the time that the drill scenes of work that depends on the data take.
const SCENES: f64 = 0.4;

/// Measures this host, called `title`, on one thread, and fits its model: whatever else the machine is doing. `progress` gets the share
/// that is done.
///
/// # Errors
/// [`CalibrationError`] if the processor lacks the instruction set, or a drill scene breaks.
pub fn calibrate(
    title: String,
    set: InstructionSet,
    effort: Effort,
    progress: impl Fn(f64) + Sync,
) -> Result<HostModel, CalibrationError> {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
    alone.install(|| {
        let mut calibration = Calibration::new(title, set)?;
        calibration.measure(effort.seconds, &progress)?;
        Ok(calibration.model())
    })
}

/// A calibration under way.
struct Calibration {
    title: String,
    set: InstructionSet,
    begun: Instant,
    /// Load average before that.
    load: Option<f64>,
    /// Sweeps done.
    sweeps: usize,
    /// Bytes of an element in a register of each file and the lanes of a hardware register, of the lanes' types.
    shapes: [([f64; 3], usize); LANES.len()],
    programs: Programs,
    scenes: Scenes,
}

impl Calibration {
    /// Of this host, called `title`: nothing measured yet.
    fn new(title: String, set: InstructionSet) -> Result<Self, CalibrationError> {
        Ok(Calibration {
            title,
            set,
            begun: Instant::now(),
            load: load_average(),
            sweeps: 0,
            shapes: [register_shape::<f64>(set)?, register_shape::<f32>(set)?],
            programs: Programs::new()?,
            scenes: Scenes::new()?,
        })
    }

    /// Measures for some seconds, on the thread that calls: drills and scenes in turns, so that all see the same machine.
    fn measure(&mut self, seconds: f64, progress: &(dyn Fn(f64) + Sync)) -> Result<(), CalibrationError> {
        let time = Duration::from_secs_f64((seconds - FITTING).max(1.0));
        let (begun, mut of_scenes) = (self.begun, Duration::ZERO);
        let done = || (begun.elapsed().as_secs_f64() / time.as_secs_f64()).min(1.0);
        loop {
            self.programs.sweep(self.set, self.sweeps)?;
            self.sweeps += 1;
            progress(done());
            if of_scenes < begun.elapsed().mul_f64(SCENES) {
                let start = Instant::now();
                self.scenes.sweep(begun + time)?;
                of_scenes += start.elapsed();
                progress(done());
            }
            if begun.elapsed() >= time {
                return Ok(());
            }
        }
    }

    /// The model fitted to what was measured.
    fn model(self) -> HostModel {
        let Calibration { title, set, begun, load, shapes, programs, scenes, .. } = self;
        let mut deviations = vec![];
        let mut prices = |lane, is_chained, shape| {
            let rows = programs.rows((lane, is_chained), shape);
            let prices = suited(&rows);
            deviations.extend(rows.iter().map(|row| row.deviation(&prices)));
            Costs::of(&prices)
        };
        let lanes = LANES.into_iter().zip(shapes).map(|(lane, shape)| {
            let [interpreted, chained] = [false, true].map(|is_chained| prices(lane, is_chained, shape));
            let (register_bytes, lanes) = shape;
            (lane.to_owned(), LaneCosts { register_bytes, lanes, interpreted, chained })
        });
        let of_lanes = lanes.collect();
        let spread = middle_of_most(programs.samples().map(Samples::spread));
        let disagreement = middle_of_most(programs.samples().map(Samples::disagreement));
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let measured = Measured {
            state: Measured::state_of([spread, disagreement], load, cores),
            load,
            seconds: begun.elapsed().as_secs_f64(),
            spread,
            disagreement,
            shortest: SHORTEST,
            longest: LONGEST,
            residual: median(deviations.into_iter()),
        };
        HostModel {
            format: FORMAT,
            title,
            instruction_set: set.name().to_owned(),
            footprints: FOOTPRINTS.to_vec(),
            measured,
            programs: of_lanes,
            discs: scenes.discs(),
            rates: scenes.rates(),
        }
    }
}

/// The middle one of those that are known; none where most are not.
fn middle_of_most(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let all: Vec<Option<f64>> = values.collect();
    let known: Vec<f64> = all.iter().copied().flatten().filter(|value| value.is_finite()).collect();
    (2 * known.len() > all.len()).then(|| median(known.into_iter()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_most_points_do_not_know_is_unknown() {
        let of = |values: &[Option<f64>]| middle_of_most(values.iter().copied());
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[None, None, Some(0.1)]), None);
        assert_eq!(of(&[None, Some(0.3), Some(0.1), Some(0.2)]), Some(0.2));
        assert_eq!(of(&[Some(f64::NAN), Some(0.1)]), None);
    }
}
