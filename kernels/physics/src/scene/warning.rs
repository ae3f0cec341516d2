//! Warnings about a scene that runs.

use serde::Serialize;

/// Something that a scene may do but that seldom ends well.
#[derive(Clone, Debug, PartialEq, Serialize, thiserror::Error)]
#[error("{key}: {message}\n  help: {suggestion}")]
pub struct Warning {
    /// The check that found it.
    pub check: &'static str,
    /// The value found over the largest one that is allowed; infinite where nothing of the kind is.
    pub share: f64,
    /// True for a reason to refuse the scene, which was prepared nevertheless: at any step.
    pub is_refusal: bool,
    /// The key that decides it.
    pub key: String,
    /// What was found, with the numbers.
    pub message: String,
    /// What to do about it.
    pub suggestion: String,
}
