//! Where a result comes from: what a reader needs to get it again.

use serde::Serialize;

/// The program that made a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// Version of the package.
    pub version: &'static str,
    /// Commit of the source it was built from.
    pub commit: &'static str,
    /// Whether the source had changes that are in no commit.
    pub dirty: bool,
    /// The platform it was built for.
    pub target: &'static str,
}

impl Origin {
    /// Of this program.
    pub fn here() -> Origin {
        Origin {
            version: env!("CARGO_PKG_VERSION"),
            commit: env!("STRIPMINE_COMMIT"),
            dirty: env!("STRIPMINE_DIRTY") == "true",
            target: env!("STRIPMINE_TARGET"),
        }
    }
}
