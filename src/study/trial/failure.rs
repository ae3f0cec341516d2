//! Failures of runs, by cause.

use crate::study::first_line;
use serde::{Deserialize, Serialize};
use stripmine_physics::method::{FailureKind, PhysicsFailure};
use stripmine_physics::scene::SceneErrors;

/// Cause of a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FailureCause {
    Penetration,
    /// A particle moves so far in a step that contacts are missed.
    MaskOutrun,
    /// Two particles share a cell for one.
    SharedCell,
    ParticleLost,
    NonFinite,
    Other,
    /// The scene is refused at any step.
    Refused,
    /// The user interrupted the run: it has no result, and is never recorded.
    #[serde(skip)]
    Interrupted,
}

impl FailureCause {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            FailureCause::Penetration => "penetration",
            FailureCause::MaskOutrun => "mask outrun",
            FailureCause::SharedCell => "two in a cell",
            FailureCause::ParticleLost => "particle lost",
            FailureCause::NonFinite => "non-finite",
            FailureCause::Other => "stopped otherwise",
            FailureCause::Refused => "no such scene",
            FailureCause::Interrupted => "interrupted",
        }
    }
}

/// Failure of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunFailure {
    pub(crate) cause: FailureCause,
    /// One line, without advice.
    pub(crate) why: String,
}

impl RunFailure {
    pub(super) fn interrupted() -> RunFailure {
        RunFailure { cause: FailureCause::Interrupted, why: String::new() }
    }

    /// True if the user interrupted the run.
    pub(crate) fn is_interruption(&self) -> bool {
        self.cause == FailureCause::Interrupted
    }
}

impl From<PhysicsFailure> for RunFailure {
    fn from(failure: PhysicsFailure) -> RunFailure {
        let cause = match failure.kind {
            FailureKind::NOT_FINITE | FailureKind::OVERFLOW => FailureCause::NonFinite,
            FailureKind::OUT_OF_BOX => FailureCause::ParticleLost,
            FailureKind::CONFLICT => FailureCause::SharedCell,
            FailureKind::TOO_DEEP => FailureCause::Penetration,
            FailureKind::LONG_STEP => FailureCause::MaskOutrun,
            _ => FailureCause::Other,
        };
        RunFailure { cause, why: first_line(&failure.what_and_when()) }
    }
}

impl From<SceneErrors> for RunFailure {
    fn from(errors: SceneErrors) -> RunFailure {
        let messages: Vec<String> = errors.0.iter().map(|error| first_line(&error.message)).collect();
        RunFailure { cause: FailureCause::Refused, why: messages.join("; ") }
    }
}
