//! Frame of a start file that several runs share.

use crate::io::start_files::{StartFrame, StartRequest};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// Path, request and frame of a start file, shared by all runs of a scene and filled by the first.
pub(super) type SharedFrame = Arc<OnceLock<(PathBuf, StartRequest, StartFrame)>>;
