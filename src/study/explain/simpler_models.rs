//! Simpler models of a scene: their effect on the mean, and the time they save.

use super::PlanTarget;
use super::findings::{MeasuredConfiguration, NO_TIME, SceneTrials, SimplerModelResult};
use super::mean::TrialMean;
use super::whole_runs::MeasuredMean;
use crate::study::trial::MeanEstimate;
use crate::study::{StudyCase, first_line};
use stripmine_physics::method::{Prepared, SimplifiedModel, TranslatedScene};
use stripmine_physics::scene::{Overrides, SceneErrors};

/// Lists the simpler models of a scene for a quantity, by the part they omit.
fn simpler(case: &StudyCase, quantity: &str) -> Vec<(&'static str, SimplerScene)> {
    let of = |becomes: &SimplifiedModel| {
        Some(match becomes {
            SimplifiedModel::Overridden(overrides) => SimplerScene::Overridden(overrides(&case.values)?),
            SimplifiedModel::Rewritten(scene) => {
                SimplerScene::Rewritten(scene(&case.values, &case.prepared, quantity)?)
            }
        })
    };
    case.entry.twins.iter().filter_map(|twin| Some((twin.name, of(&twin.becomes)?))).collect()
}

/// True if a scene has simpler models to compare.
pub(super) fn has_simpler(case: &StudyCase, quantity: &str) -> bool {
    !simpler(case, quantity).is_empty()
}

impl SceneTrials<'_> {
    /// Measures every simpler model of the scene.
    pub(super) fn measure_simpler_models(
        &self,
        configuration: &MeasuredConfiguration,
        mean: &TrialMean,
    ) -> Vec<SimplerModelResult> {
        let reference = &mean.known;
        let twins = simpler(self.case, self.target.quantity.name);
        let seconds = self.shares[3] * self.seconds / twins.len().max(1) as f64;
        let measured = |(name, simpler): (&str, SimplerScene)| {
            let of = |failed: Option<String>| SimplerModelResult {
                name: name.to_owned(),
                difference: None,
                cost: None,
                failed,
            };
            let measured = match simpler {
                SimplerScene::Overridden(overrides) => self.overridden(configuration, &overrides, seconds),
                SimplerScene::Rewritten(scene) => self.rewritten(scene, seconds),
            };
            match measured {
                Ok(MeasuredMean { known, cost, .. }) => SimplerModelResult {
                    difference: known
                        .as_ref()
                        .ok()
                        .map(|known| [known.mean - reference.mean, known.bar.hypot(reference.bar)]),
                    cost: Some(cost / mean.cost),
                    ..of(known.err())
                },
                Err(why) => of(Some(why)),
            }
        };
        twins.into_iter().map(measured).collect()
    }

    /// Measures a model with the same method.
    fn overridden(
        &self,
        configuration: &MeasuredConfiguration,
        overrides: &Overrides,
        seconds: f64,
    ) -> Result<MeasuredMean, String> {
        let shortest =
            |prepared: &Prepared| prepared.step_limits.iter().map(|limit| limit.step).reduce(f64::min);
        let of_scene = self.prepared(&configuration.overrides, None).ok().as_ref().and_then(shortest);
        let more = configuration.overrides.clone().and(overrides);
        // The step is as far below its own limit as in the scene.
        let longer = shortest(&self.prepared(&more, None)?)
            .zip(of_scene)
            .map_or(1.0, |(own, of_scene)| own / of_scene);
        let twin = MeasuredConfiguration { overrides: more, ..configuration.clone() };
        self.measure_mean(&twin, configuration.step.map(|step| step * longer), seconds)
    }

    /// Measures a model with another method, in its own cheapest configuration.
    fn rewritten(&self, scene: TranslatedScene, seconds: f64) -> Result<MeasuredMean, String> {
        let errors =
            |errors: SceneErrors| errors.0.first().map_or(String::new(), |error| first_line(&error.message));
        let case = self.case.with_text_of(&scene.text).map_err(errors)?;
        let target = PlanTarget::of(&case, Some(scene.quantity), None).map_err(|error| error.to_string())?;
        if self.left() == 0.0 {
            return Err(NO_TIME.to_owned());
        }
        let mut work = SceneTrials { case: &case, target: &target, seconds, ..*self };
        let configurations = work.timed_configurations().map_err(|error| error.to_string())?;
        work.seconds = self.seconds;
        let measured = work.measure_mean(&configurations[0], configurations[0].step, seconds)?;
        let in_unit = |known: MeanEstimate| MeanEstimate {
            mean: scene.unit * known.mean,
            bar: scene.unit * known.bar,
            square: scene.unit * scene.unit * known.square,
            single: scene.unit * scene.unit * known.single,
            ..known
        };
        Ok(MeasuredMean { known: measured.known.map(in_unit), ..measured })
    }
}

/// A simpler model of a scene.
enum SimplerScene {
    Overridden(Overrides),
    Rewritten(TranslatedScene),
}
