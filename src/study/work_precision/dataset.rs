//! Errors and costs of a scene.

use super::collision::Collision;
use super::encounters::ParticleEvents;
use super::growth::{COMPARABLE, DisturbanceGrowth};
use super::measures::{Errors, Measure};
use super::orders::FittedOrder;
use super::plan::DiagramPlan;
use crate::statistics::median;
use crate::study::trial::RunFailure;
use serde::{Deserialize, Serialize};

/// Error against cost of a scene, for its configurations and steps.
#[derive(Clone, Debug)]
pub(crate) struct WorkPrecision {
    /// Number of moving particles.
    pub particles: usize,
    /// Unit of distances.
    pub unit: String,
    pub(crate) time_unit: Option<String>,
    /// Its own step (time).
    pub step: f64,
    /// Label of its own configuration.
    pub own: String,
    pub(crate) growth: DisturbanceGrowth,
    pub(crate) plan: DiagramPlan,
    pub duration: f64,
    /// Events per particle in that time.
    pub(crate) encounters: ParticleEvents,
    /// Reason why no configuration is recommended: too few events in the compared time; none where there are enough.
    pub(crate) undecided: Option<String>,
    pub(crate) reference: DiagramReference,
    pub(crate) configurations: Vec<DiagramConfiguration>,
    pub runs: Vec<DiagramRun>,
    pub orders: Vec<ConvergenceOrder>,
    /// Outcomes of the collision, for a scene of two discs.
    pub collision: Option<Collision>,
    /// Machine whose clock periods are computed.
    pub machine: Option<String>,
}

/// Diagrams, each with a name for its rows.
pub(crate) type NamedDiagrams = [(String, WorkPrecision)];

impl WorkPrecision {
    /// Integrator of a configuration.
    pub(crate) fn scheme(&self, label: &str) -> &str {
        self.configurations.iter().find(|it| it.label == label).map_or("", |it| &it.scheme)
    }

    pub(crate) fn of(&self, run: &DiagramRun) -> &DiagramConfiguration {
        &self.configurations[run.configuration]
    }
}

/// Reference that all runs are compared with.
#[derive(Clone, Debug)]
pub(crate) struct DiagramReference {
    /// Labels of its configuration, and of the second one.
    pub(crate) configurations: [String; 2],
    /// Its step (time).
    pub step: f64,
    /// Difference from a run at twice the step.
    pub(crate) halving: Errors,
    /// Difference from the second configuration.
    pub second: Errors,
    /// Error of the reference: the larger of the two differences, and its own error of the energy balance.
    pub(crate) floor: Errors,
}

/// A setting for each axis of the method.
#[derive(Clone, Debug)]
pub(crate) struct DiagramConfiguration {
    /// Label of all settings.
    pub label: String,
    /// Settings that decide the order.
    pub scheme: String,
    /// Settings that decide the precision.
    pub precision: String,
    /// Settings that decide the cost alone.
    pub(crate) cost: String,
    /// True if search and execution are the scene's own.
    pub(crate) is_primary: bool,
    /// True if integrator and precision are the scene's own.
    pub(crate) is_own_arithmetic: bool,
    /// Seconds of a step, from its first steps, or the reason why the scene cannot be run.
    pub(crate) each: Result<f64, RunFailure>,
}

#[derive(Clone, Debug)]
pub(crate) struct DiagramRun {
    /// Index of its configuration.
    pub(crate) configuration: usize,
    /// The step (time).
    pub step: f64,
    /// Power of two by which the step differs from the scene's own.
    pub(crate) power: i32,
    pub outcome: Result<DiagramResult, RunFailure>,
    /// Processor seconds per unit of time in each repeat.
    pub(crate) costs: Vec<f64>,
}

/// Results of a run that finished.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct DiagramResult {
    pub(crate) errors: Errors,
    /// Warnings: an exceeded theoretical limit, a check before the run, or one during it.
    pub(crate) objections: Vec<String>,
    /// Clock periods per unit of time; none where no operations are counted.
    pub clocks: Option<f64>,
}

impl DiagramRun {
    /// Processor seconds per unit of time: the median.
    pub(crate) fn cost(&self) -> Option<f64> {
        (!self.costs.is_empty()).then(|| median(self.costs.iter().copied()))
    }

    pub(crate) fn error(&self, measure: Measure) -> Option<f64> {
        self.outcome.as_ref().ok()?.errors.get(&measure).copied()
    }

    /// Warnings joined in words; empty where there are none.
    pub(crate) fn objections(&self) -> String {
        self.outcome.as_ref().map_or(String::new(), |finished| finished.objections.join("; "))
    }

    /// True if it finished without a warning.
    pub(crate) fn is_sound(&self) -> bool {
        self.outcome.as_ref().is_ok_and(|finished| finished.objections.is_empty())
    }

    /// True if its trajectories have diverged from the reference's.
    pub(crate) fn is_lost(&self) -> bool {
        self.error(Measure::Position).is_some_and(|error| error > COMPARABLE)
    }
}

/// Order of convergence of an error.
#[derive(Clone, Debug)]
pub(crate) struct ConvergenceOrder {
    /// Index of the configuration.
    pub(crate) configuration: usize,
    pub(crate) measure: Measure,
    /// Order of the measured errors; none for too few points.
    pub(crate) fitted: Option<FittedOrder>,
    /// Theoretical order, with the reason.
    pub theory: Option<(f64, &'static str)>,
}
