//! Failures of runs, by cause.

use crate::study::first_line;
use serde::{Deserialize, Serialize};
use stripmine_physics::method::{Failure, FailureKind};
use stripmine_physics::scene::SceneErrors;

/// Cause of a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Cause {
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

impl Cause {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Cause::Penetration => "penetration",
            Cause::MaskOutrun => "mask outrun",
            Cause::SharedCell => "two in a cell",
            Cause::ParticleLost => "particle lost",
            Cause::NonFinite => "non-finite",
            Cause::Other => "stopped otherwise",
            Cause::Refused => "no such scene",
            Cause::Interrupted => "interrupted",
        }
    }
}

/// Failure of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunFailure {
    pub(crate) cause: Cause,
    /// One line, without advice.
    pub(crate) why: String,
}

impl RunFailure {
    pub(super) fn interrupted() -> RunFailure {
        RunFailure { cause: Cause::Interrupted, why: String::new() }
    }

    /// True if the user interrupted the run.
    pub(crate) fn is_interruption(&self) -> bool {
        self.cause == Cause::Interrupted
    }
}

impl From<Failure> for RunFailure {
    fn from(failure: Failure) -> RunFailure {
        let cause = match failure.kind {
            FailureKind::NOT_FINITE | FailureKind::OVERFLOW => Cause::NonFinite,
            FailureKind::OUT_OF_BOX => Cause::ParticleLost,
            FailureKind::CONFLICT => Cause::SharedCell,
            FailureKind::TOO_DEEP => Cause::Penetration,
            FailureKind::LONG_STEP => Cause::MaskOutrun,
            _ => Cause::Other,
        };
        RunFailure { cause, why: first_line(&failure.what()) }
    }
}

impl From<SceneErrors> for RunFailure {
    fn from(errors: SceneErrors) -> RunFailure {
        let messages: Vec<String> = errors.0.iter().map(|error| first_line(&error.message)).collect();
        RunFailure { cause: Cause::Refused, why: messages.join("; ") }
    }
}
