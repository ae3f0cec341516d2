//! A run to be measured, and what is predicted of it.

use super::errors::Case;
use super::runs::{EXECUTIONS, Effort, ValidationError};
use crate::method::lattice_md::Checked;
use crate::method::lattice_md::Lengths;
use crate::method::lattice_md::Phase;
use crate::method::lattice_md::model;
use crate::method::lattice_md::study::noise_monitor::NoiseMonitor;
use crate::method::lattice_md::study::phase_times::{PhaseTimes, Run, Sampling, phase_times};
use crate::method::lattice_md::study::predicted_step::{Step, of_precision};
use crate::method::throughput::MeasurementError;
use crate::model::host::{HostModel, OutOfRange};
use stripmine_kernels::Execution;

/// Steps after which the caches hold what the next one finds.
const WARMED: usize = 3;

/// A run, ready. `step` is known where the work does not depend on the data; else the amount of work comes from the run.
pub(super) struct Scene {
    run: Run,
    checked: Checked,
    step: Option<(Step, Execution)>,
}

impl Scene {
    /// Of a run.
    pub(super) fn new(run: Run) -> Result<Scene, MeasurementError> {
        let checked = run.scene(&[])?;
        let named = EXECUTIONS.iter().find(|(name, _)| *name == run.execution);
        let step = named.and_then(|(_, execution)| *execution).map(|execution| {
            let model = model(&checked);
            let lengths = Lengths::new(&model, checked.particles.grain_count(), checked.particles.len());
            (Step::new(&of_precision(&model, checked.scene.machine.precision), &lengths), execution)
        });
        Ok(Scene { run, checked, step })
    }

    /// Nanoseconds of every phase, and the baseline's; none if they depend on the data.
    pub(super) fn predicted(&self, host: &HostModel) -> Result<Option<Vec<[f64; 2]>>, ValidationError> {
        let Some((step, execution)) = &self.step else { return Ok(None) };
        let phases = Phase::ALL.iter().map(|&phase| step.phase(host, phase, *execution));
        phases.collect::<Result<_, _>>().map(Some).map_err(|cause| self.out(cause))
    }

    fn out(&self, cause: OutOfRange) -> ValidationError {
        ValidationError::OutOfRange { case: self.run.name(), cause }
    }

    /// Runs it once more, and joins what comes out to what there is.
    pub(super) fn measure(
        &self,
        effort: &Effort,
        monitor: &mut NoiseMonitor,
        times: &mut Option<PhaseTimes>,
    ) -> Result<(), MeasurementError> {
        let sampling = Sampling {
            // What programs take does not depend on the data: only the caches must be in their steady state.
            equilibration: if self.step.is_some() {
                WARMED
            } else {
                (effort.particle_steps / self.run.particles).clamp(5, 50)
            },
            repeats: effort.repeats,
            particle_steps: effort.particle_steps,
            // Lists are rebuilt every few steps only.
            least_steps: if self.run.has_lists() { 6 } else { 2 },
        };
        let more = phase_times(&self.checked, &sampling, monitor)?;
        *times = Some(PhaseTimes::with(times.take(), more));
        Ok(())
    }

    /// Every phase that it has, predicted by a model, and as it was measured in the rounds of even and of odd number;
    /// `reference` is what the reference loop takes undisturbed (ns).
    pub(super) fn cases(
        &self,
        host: &HostModel,
        halves: &[Option<PhaseTimes>; 2],
        reference: f64,
    ) -> Result<Vec<Case>, ValidationError> {
        let Some(times) = halves.iter().flatten().cloned().reduce(PhaseTimes::joined) else {
            return Ok(vec![]);
        };
        let of_halves = |phase: Phase| match halves {
            [Some(even), Some(odd)] => Some([even, odd].map(|half| half.typical(phase, reference).0)),
            _ => None,
        };
        let predicted: Vec<(f64, Option<f64>)> = match self.predicted(host)? {
            Some(all) => all.into_iter().map(|[ns, baseline]| (ns, Some(baseline))).collect(),
            None => {
                let phases = rated(host, &self.run, &times).map_err(|cause| self.out(cause))?;
                phases.into_iter().map(|ns| (ns, None)).collect()
            }
        };
        let Run { particles, occupancy, precision, execution } = self.run;
        let cases = Phase::ALL.iter().zip(predicted).map(|(&phase, (predicted, baseline))| {
            let (measured, quartiles) = times.typical(phase, reference);
            Case {
                particles,
                occupancy,
                precision,
                execution,
                phase: phase.name(),
                predicted,
                measured,
                quartiles,
                halves: of_halves(phase),
                quiet: times.quiet(phase, reference),
                baseline,
            }
        });
        // Not every execution has every phase.
        Ok(cases.filter(|case| case.measured > 0.0).collect())
    }
}

/// Nanoseconds of every phase of a run whose cost depends on the data.
pub(super) fn rated(host: &HostModel, run: &Run, times: &PhaseTimes) -> Result<Vec<f64>, OutOfRange> {
    let method = run.rates().unwrap_or_default();
    let rates = host.rates.get(method).ok_or_else(|| OutOfRange::NotMeasured(format!("method {method}")))?;
    Phase::ALL.iter().map(|phase| rates.phase(run.precision, phase.name(), &times.amounts)).collect()
}
