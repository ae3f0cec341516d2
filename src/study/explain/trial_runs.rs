//! Trials of a scene in order, and the plan that follows from them.

use super::conservation::conserved_quantity_plan;
use super::findings::{Findings, HALVINGS, MeasuredConfiguration, SHARES, SceneTrials};
use super::mean::TrialMean;
use super::plan::plan;
use super::recommended::RunPlan;
use super::timing::{OF_LIMIT, OF_ONE_THREAD, bounded};
use super::unreachable::Unreached;
use super::{ExplainError, PlanTarget};
use crate::results::Journal;
use crate::study::StudyCase;
use crate::study::trial::TrialControl;
use serde::{Deserialize, Serialize};
use stripmine_physics::method::StepLimit;

/// Shares of the trial time where simpler models are the goal.
const FOR_SIMPLER_MODELS: [f64; 5] = [0.1, 0.25, 0.12, 0.48, 0.05];
/// Printed steps are rounded, and may exceed a limit by this part.
const ROUNDING: f64 = 1e-3;

/// Measures a scene.
///
/// # Errors
/// [`ExplainError`] if every trial fails, or the quantity does not become stationary.
fn findings(work: &mut SceneTrials<'_>, progress: &dyn Fn(f64)) -> Result<Findings, ExplainError> {
    let begun = work.trial.watch.now();
    let tell = |work: &SceneTrials<'_>| progress(((work.trial.watch.now() - begun) / work.seconds).min(1.0));
    let journal = work.journal;
    let timed = || work.unless_stopped(work.timed_configurations()?);
    let mut configurations: Vec<MeasuredConfiguration> = journal.recall("costs", |_| true, timed)?;
    restore_overrides(&mut configurations, work.case);
    tell(work);
    if work.target.is_kept() {
        return work.measure_deviations(configurations);
    }
    let known = journal.recall("means", |_| true, || work.compared(configurations, &tell))?;
    let MeasuredBiases { mut configurations, mut mean, whole } = known;
    restore_overrides(&mut configurations, work.case);
    work.whole = whole;
    tell(work);
    let best = &configurations[0];
    let one_thread = work.one_thread(best);
    let starts_differ = work.starts_differ(best, &mut mean);
    // Transients are mostly detected too late, by a part of the run.
    mean.known.transient = mean.transients.iter().copied().fold(f64::INFINITY, f64::min);
    let without = work.measure_simpler_models(best, &mean);
    work.unless_stopped(Findings {
        mean: mean.known,
        own_run: None,
        mean_configuration: mean.configuration,
        whole: work.whole,
        starts_differ,
        start: mean.start,
        row: mean.row,
        one_thread,
        threads: rayon::current_num_threads(),
        without,
        configurations,
    })
}

/// A mean, and the biases of configurations.
#[derive(Serialize, Deserialize)]
struct MeasuredBiases {
    configurations: Vec<MeasuredConfiguration>,
    mean: TrialMean,
    whole: Option<f64>,
}

impl SceneTrials<'_> {
    fn compared(
        &mut self,
        mut configurations: Vec<MeasuredConfiguration>,
        tell: &dyn Fn(&Self),
    ) -> Result<MeasuredBiases, ExplainError> {
        let mean = self.mean(&mut configurations)?;
        tell(self);
        // The trials of the bias may use all remaining time, except the shares of those that follow. Whole runs have no time to spare.
        let kept_back = match self.whole {
            Some(_) => 0.0,
            None => {
                let [.., of_twins, of_start] = self.shares.map(|share| share * self.seconds);
                // The biases have priority over simpler models: timing and the mean may have taken longer than their shares.
                let spare = self.left() - self.shares[2] * self.seconds;
                spare.clamp(0.0, of_twins) + of_start + 2.0 * OF_ONE_THREAD * self.seconds
            }
        };
        self.end -= kept_back;
        self.biases(&mut configurations, &mean);
        self.end += kept_back;
        self.unless_stopped(MeasuredBiases { configurations, mean, whole: self.whole })
    }
}

/// Restores overrides, which are not cached, from settings and skins.
pub(super) fn restore_overrides(configurations: &mut [MeasuredConfiguration], case: &StudyCase) {
    for configuration in configurations {
        configuration.overrides = configuration.configuration_overrides(case);
    }
}

/// Measures a scene in trials of some seconds. Trials in the journal are not repeated.
///
/// # Errors
/// [`ExplainError`] if every trial fails, or the quantity has no mean.
pub(crate) fn measure_findings(
    case: &StudyCase,
    target: &PlanTarget,
    seconds: f64,
    trial: TrialControl<'_>,
    (progress, journal): (&dyn Fn(f64), &Journal),
) -> Result<Findings, ExplainError> {
    measure_with_shares(SHARES, case, target, seconds, trial, (progress, journal))
}

/// Measures a scene as [`measure_findings`] does, with most of the time for its simpler models.
///
/// # Errors
/// As [`measure_findings`].
pub(super) fn measure_with_simpler_models(
    case: &StudyCase,
    target: &PlanTarget,
    seconds: f64,
    trial: TrialControl<'_>,
) -> Result<Findings, ExplainError> {
    measure_with_shares(FOR_SIMPLER_MODELS, case, target, seconds, trial, (&|_| {}, &Journal::none()))
}

fn measure_with_shares(
    shares: [f64; 5],
    case: &StudyCase,
    target: &PlanTarget,
    seconds: f64,
    trial: TrialControl<'_>,
    (progress, journal): (&dyn Fn(f64), &Journal),
) -> Result<Findings, ExplainError> {
    let end = trial.watch.now() + seconds;
    let (as_it_stands, whole) = (None, None);
    let work = &mut SceneTrials { case, target, seconds, shares, end, trial, journal, as_it_stands, whole };
    findings(work, progress)
}

/// Makes a plan from measurements, or returns the scene as it stands where that is as good and no plan is faster.
///
/// # Errors
/// [`Unreached`], where no configuration reaches the target.
pub(crate) fn plan_or_scene(
    case: &StudyCase,
    target: &PlanTarget,
    findings: &Findings,
    origin: &str,
) -> Result<RunPlan, Unreached> {
    if target.is_kept() {
        return Ok(conserved_quantity_plan(case, target, findings, origin)?.or_as_it_stands(case, findings));
    }
    let mut findings = findings.clone();
    let mut made = plan(case, target, &findings, origin)?;
    // A run longer than the scene's own has harder collisions, which shorten the step, and with a shorter step it takes longer still.
    for _ in 0..HALVINGS {
        let Some(limit) = limit_of(case, &made) else { break };
        findings.limit_steps(&limit);
        made = plan(case, target, &findings, origin)?;
    }
    Ok(made.or_as_it_stands(case, &findings))
}

/// Returns the theoretical limit on the step of a plan's run, if the plan exceeds it.
fn limit_of(case: &StudyCase, plan: &RunPlan) -> Option<StepLimit> {
    let limits = case.prepared_with(&plan.overrides).ok()?.step_limits;
    let limit = limits.into_iter().min_by(|a, b| a.step.total_cmp(&b.step))?;
    (plan.step? > OF_LIMIT * limit.step * (1.0 + ROUNDING)).then_some(limit)
}

impl Findings {
    /// Shortens the longest steps to a theoretical limit.
    fn limit_steps(&mut self, limit: &StepLimit) {
        let longest = OF_LIMIT * limit.step;
        for configuration in &mut self.configurations {
            let Some(step) = configuration.step.filter(|step| *step > longest) else { continue };
            (configuration.step, configuration.cost) =
                (Some(longest), configuration.cost.map(|cost| cost * step / longest));
            configuration.phases.iter_mut().for_each(|(_, cost)| *cost *= step / longest);
            configuration.bound = Some(bounded(limit));
        }
    }
}
