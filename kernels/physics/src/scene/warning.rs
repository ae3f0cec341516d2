//! Warnings about scenes that run.

use serde::Serialize;

/// Property of a scene that is allowed but rarely intended.
#[derive(Clone, Debug, PartialEq, Serialize, thiserror::Error)]
#[error("{key}: {message}\n  help: {suggestion}")]
pub struct Warning {
    /// Check that found it.
    pub check: &'static str,
    /// Value found over the largest one allowed; infinite if none is allowed.
    pub share: f64,
    /// True if it is a reason to reject the scene, which was nevertheless prepared: this one is independent of the step.
    pub is_refusal: bool,
    /// Key responsible.
    pub key: String,
    /// Finding, with its numbers.
    pub message: String,
    /// Remedy.
    pub suggestion: String,
}
