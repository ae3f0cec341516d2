//! Bias of the steps of each integrator, from runs that start from the same states.

use super::bias::{Bias, StepDifference};
use super::findings::{HALVINGS, MeasuredConfiguration, SceneTrials, sort_by_cost};
use super::mean::{FEWEST, TrialMean};
use crate::study::trial::{PairedConfigurations, PairedMeans, TOGETHER, run_pairs, shown_part};
use crate::study::{SettingChoice, first_line};
use stripmine_physics::method::{ChoiceEffect, Prepared, StartPurpose};
use stripmine_physics::scene::Overrides;

/// Most integrators whose means are compared.
const COMPARED: usize = 3;
/// Step of the reference, in parts of the shortest step compared, and steps of each integrator, in parts of its longest.
const REFERENCE: f64 = 0.25;
const STEPS: [f64; 2] = [1.0, 0.5];
/// Share of the time of the first runs, which show whether steps raise warnings.
const SCOUT: f64 = 0.1;
/// Spacing of rows in longest steps, rows in the first half of the first window, and rows per period where forces depend on time.
const APART: f64 = 8.0;
const FIRST: u64 = 2;
const A_PERIOD: u64 = 16;
/// Part of the steady-state bias in the mean over a run that remembers all of it: 1 − (1 − 1/e).
const OF_WHOLE_RUN: f64 = 0.367_879_441_171_442_3;
/// Shortest window used, in parts of the longest in which runs stay together: shorter ones contain hardly any contacts.
const SHORTER: f64 = 0.125;
/// Range of the power of the step that errors of means follow: contacts have kinks.
const POWERS: [f64; 2] = [1.0, 2.0];

/// Configurations to compare, the reference first, each with its step.
struct PairedCases {
    /// Index of the cheapest configuration of each integrator.
    firsts: Vec<usize>,
    prepared: Vec<(Prepared, f64)>,
    /// Steps between two rows.
    steps: Vec<u64>,
    reference: SettingChoice,
}

/// Reasons why there are no paired runs.
enum PairingFailure {
    /// Too few states to start from.
    FewStates,
    /// Two windows of all cases exceed the available time.
    TooExpensive,
    /// Index of the case that failed, and the reason.
    Broken(usize, String),
}

impl SceneTrials<'_> {
    /// Measures the bias of the cheapest configuration of each integrator. All that differ in precision or search alone share it: rounding is far
    /// below the resolution of a mean.
    pub(super) fn biases(&self, configurations: &mut [MeasuredConfiguration], mean: &TrialMean) {
        if self.case.entry.trials.is_none() {
            return;
        }
        let creeps = self.bias_growths(configurations, mean);
        let all = self.shares[2] * self.seconds;
        // A few short pairs come first, and are repeated for as long as steps are shortened. None is shorter than a period.
        let mut seconds = if self.case.prepared.model.period().is_some() { all } else { SCOUT * all };
        let mut most = COMPARED;
        for _ in 0..=HALVINGS * COMPARED as u32 {
            let Some(cases) = self.cases(configurations, most) else { break };
            match self.paired(&cases, mean, seconds) {
                Err(PairingFailure::FewStates) => break,
                // The first short runs have little time.
                Err(PairingFailure::TooExpensive) if seconds < all => seconds = all,
                // The best configuration and the scene's own are the fewest that can be compared.
                Err(PairingFailure::TooExpensive) if most > 1 => most -= 1,
                Err(PairingFailure::TooExpensive) => break,
                Err(PairingFailure::Broken(at, why)) => {
                    // The reference has the shortest step of all: its configuration is unusable.
                    let Some(first) = at.checked_sub(1).map(|at| cases.firsts[at / STEPS.len()]) else {
                        break;
                    };
                    self.halve_steps(configurations, &configurations[first].clone(), &why);
                }
                Ok(paired) => {
                    let warned = |first: usize| {
                        let all = &paired.warnings[1 + first * STEPS.len()];
                        all.first().map(|warning| format!("warning: {}", warning.message))
                    };
                    let (at, why) = match (0..cases.firsts.len()).find_map(|at| Some((at, warned(at)?))) {
                        Some(found) if self.left() > 0.0 => found,
                        _ if seconds < all => {
                            seconds = all;
                            continue;
                        }
                        _ => {
                            self.assign_biases(configurations, &cases, &paired, mean);
                            break;
                        }
                    };
                    self.halve_steps(configurations, &configurations[cases.firsts[at]].clone(), &why);
                }
            }
        }
        let is_any_known = configurations
            .iter()
            .any(|configuration| configuration.dropped.is_none() && configuration.bias.is_some());
        for configuration in configurations
            .iter_mut()
            .filter(|configuration| configuration.bias.is_none() && configuration.dropped.is_none())
        {
            match configuration.step {
                None => {}
                Some(_) if is_any_known => {
                    configuration.dropped = Some("its bias was not measured".to_owned())
                }
                // Limits and warnings alone then bound the step.
                Some(step) => {
                    configuration.bias = Some(Bias::unknown(step, self.power(&self.choice(configuration))))
                }
            }
        }
        self.add_unpaired_biases(configurations, mean);
        for (choice, step, creep) in creeps {
            for configuration in configurations
                .iter_mut()
                .filter(|configuration| self.choice(configuration).agrees_on(&choice, ChoiceEffect::Order))
            {
                configuration.bias = configuration.bias.map(|bias| bias.with_creep(step, creep));
            }
        }
        sort_by_cost(configurations);
    }

    /// Adds the biases from the shadow energy and from single collisions to those from paired runs.
    fn add_unpaired_biases(&self, configurations: &mut [MeasuredConfiguration], mean: &TrialMean) {
        let of_mean = configurations.iter().find_map(|configuration| {
            Some((self.choice(configuration), mean.step?, self.shadow_bias(configuration, mean)?))
        });
        let mut seen: Vec<(SettingChoice, Option<f64>)> = vec![];
        for configuration in configurations.iter_mut().filter(|configuration| configuration.dropped.is_none())
        {
            let Some(bias) = configuration.bias else { continue };
            let choice = self.choice(configuration);
            let alike = |other: &SettingChoice| other.agrees_on(&choice, ChoiceEffect::Order);
            let bias = match &of_mean {
                Some((of_mean, step, shadow)) if alike(of_mean) => bias.with_shadow(*step, *shadow),
                _ => bias,
            };
            let known = seen.iter().find(|(other, _)| alike(other)).map(|(_, part)| *part);
            let of_collisions = known.unwrap_or_else(|| {
                let part = (self.left() > 0.0)
                    .then(|| self.error_of_collisions(configuration, bias.step, mean))
                    .flatten();
                seen.push((choice, part));
                part
            });
            configuration.bias =
                Some(bias.with_collisions(of_collisions.map(|part| part * mean.known.mean.abs())));
        }
    }

    /// Returns the configurations to compare; none where one cannot be prepared.
    fn cases(&self, configurations: &[MeasuredConfiguration], most: usize) -> Option<PairedCases> {
        let mut firsts: Vec<usize> = vec![];
        for (at, configuration) in
            configurations.iter().enumerate().filter(|(_, configuration)| configuration.dropped.is_none())
        {
            let own = self.choice(configuration);
            let is_another = firsts
                .iter()
                .all(|&it| !self.choice(&configurations[it]).agrees_on(&own, ChoiceEffect::Order));
            // The scene's own is always included: a plan states the error of the scene's own values.
            let is_own = own.agrees_on(&self.case.own, ChoiceEffect::Order);
            if is_another && (firsts.len() < most || is_own) {
                firsts.push(at);
            }
        }
        let trials = self.case.entry.trials?;
        let steps = |at: &usize| configurations[*at].step;
        let longest = firsts.iter().filter_map(steps).reduce(f64::max)?;
        let shortest = firsts.iter().filter_map(steps).reduce(f64::min)?;
        let reference = self.choice(&configurations[*firsts.first()?]).with(trials.references[0]);
        let period = self.case.prepared.model.period();
        let spacing = period.map_or(APART * longest, |period| period / A_PERIOD as f64);
        let of_firsts = firsts.iter().flat_map(|&at| {
            STEPS.map(|part| {
                (configurations[at].overrides.clone(), part * configurations[at].step.unwrap_or(longest))
            })
        });
        let of_reference = (reference.overrides(), REFERENCE * shortest);
        let (overrides, steps): (Vec<Overrides>, Vec<f64>) =
            std::iter::once(of_reference).chain(of_firsts).unzip();
        // Noise of a long step is composed of that of whole short ones.
        let is_noisy = self.case.prepared.model.with_noise(0, 1).is_some();
        let whole = |steps: u64| if is_noisy { steps.next_power_of_two() } else { steps };
        let steps: Vec<u64> = steps.iter().map(|step| whole((spacing / step).ceil() as u64)).collect();
        let prepared = overrides.iter().zip(&steps).map(|(overrides, &steps)| {
            let even = spacing / steps as f64;
            Some((self.prepared(overrides, Some(even)).ok()?, even))
        });
        let prepared = prepared.collect::<Option<Vec<_>>>()?;
        Some(PairedCases { firsts, prepared, steps, reference })
    }

    /// Runs all cases from the same states.
    fn paired(
        &self,
        cases: &PairedCases,
        mean: &TrialMean,
        seconds: f64,
    ) -> Result<PairedMeans, PairingFailure> {
        let steps = &cases.steps;
        if mean.states.len() < FEWEST {
            return Err(PairingFailure::FewStates);
        }
        let first = self.case.prepared.model.period().map_or(FIRST, |_| A_PERIOD);
        // As many states as leave time for two windows.
        let two_windows = 4 * first * steps.iter().sum::<u64>();
        let seconds = seconds.min(self.left());
        let fitting = seconds * rayon::current_num_threads() as f64 / (mean.step_cost * two_windows as f64);
        if fitting < 0.5 * FEWEST as f64 {
            return Err(PairingFailure::TooExpensive);
        }
        let starts = (fitting as usize).clamp(FEWEST, mean.states.len());
        let begin = |case: usize, start: usize| {
            let state = mean.states[start * mean.states.len() / starts].clone();
            let prepared = cases.prepared[case].0.model.started_from(state);
            // All runs from one state see the same noise; each state has its own.
            let parts = (steps[0] / steps[case]) as u32;
            let prepared = prepared.model.with_noise(start as u64, parts).unwrap_or(prepared);
            prepared.start(StartPurpose::Run).map_err(|failure| first_line(&failure.what_and_when()))
        };
        let compared = PairedConfigurations { steps, first, starts, begin: &begin };
        let observed = (self.case.quantities(), self.target.place);
        run_pairs(&self.trial, &compared, observed, seconds)
            .map_err(|broken| PairingFailure::Broken(broken.at, broken.why))
    }

    /// Assigns the biases measured by paired runs.
    fn assign_biases(
        &self,
        configurations: &mut [MeasuredConfiguration],
        cases: &PairedCases,
        paired: &PairedMeans,
        mean: &TrialMean,
    ) {
        // A run that never becomes stationary remembers all of itself. Values within a period compensate each other, which is no short memory.
        let period = self.case.prepared.model.period().unwrap_or(0.0);
        let memory = self.whole.unwrap_or((0.5 * mean.known.apart).max(period));
        let of_run = self.whole.map_or(1.0, |_| OF_WHOLE_RUN);
        for (number, &first) in cases.firsts.iter().enumerate() {
            let choice = self.choice(&configurations[first]);
            let power = self.power(&choice);
            let is_of_reference = choice.agrees_on(&cases.reference, ChoiceEffect::Order);
            let longest = paired.windows.iter().rev().find(|it| it.scatter <= TOGETHER);
            let shortest = SHORTER * longest.or(paired.windows.first()).map_or(0.0, |window| window.time);
            let bias = paired.windows.windows(2).filter(|both| both[1].time >= shortest).map(|both| {
                let seen: Vec<StepDifference> = (0..STEPS.len())
                    .map(|at| {
                        let place = number * STEPS.len() + at;
                        let reference = if is_of_reference { cases.prepared[0].1 } else { 0.0 };
                        let steps = (cases.prepared[1 + place].1, reference);
                        StepDifference::of([&both[0], &both[1]], place, (memory, of_run), steps)
                    })
                    .collect();
                Bias::of(&seen, power, both[1].time, shown_part(both[1].time, memory), paired.starts)
            });
            // Longer windows show more of the bias but scatter more: the one with the smallest error bar is used.
            let best = bias.filter(|it| it.below().is_finite()).min_by(|a, b| a.bar.total_cmp(&b.bar));
            for configuration in configurations
                .iter_mut()
                .filter(|configuration| self.choice(configuration).agrees_on(&choice, ChoiceEffect::Order))
            {
                configuration.bias = best;
            }
        }
    }

    /// Power of the step that errors of means follow: the theoretical order for positions, within [`POWERS`].
    fn power(&self, choice: &SettingChoice) -> f64 {
        self.theory(choice).map_or(POWERS[1], |order| order.clamp(POWERS[0], POWERS[1]))
    }

    /// Theoretical order of position errors in the step.
    pub(super) fn theory(&self, choice: &SettingChoice) -> Option<f64> {
        let (trials, scheme) = self.case.entry.trials.zip(choice.scheme())?;
        Some((trials.theory)(&self.case.values, &self.case.prepared, scheme)?.order)
    }
}
