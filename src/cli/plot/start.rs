//! Picture of the start of a scene.

use super::colouring::{ColouringError, RunColouring};
use super::particles::{short_name, state_figures};
use super::segments::WallSegments;
use crate::cli::scene::presets;
use crate::report::figure::Figure;
use std::path::{Path, PathBuf};
use stripmine_physics::io::extxyz::ParticleFrame;
use stripmine_physics::method::{Methods, Prepared};
use stripmine_physics::quoted;
use stripmine_physics::reported::{ErrorClass, Reported};

/// Option of `plot` that does not fit to what is drawn.
#[derive(Debug, thiserror::Error)]
pub(super) enum MisplacedOption {
    /// Option of runs, given with a scene.
    #[error("{option} needs a run, and {} is a scene\n  help: run the scene, and plot the folder of the run", quoted::path(scene.as_ref()))]
    OfRuns {
        /// The option.
        option: &'static str,
        /// Name of the scene.
        scene: String,
    },
    /// Overrides of a run.
    #[error(
        "--set needs a scene, and {} is a run\n  help: plot the scene, or leave --set out",
        quoted::path(run)
    )]
    OfScenes {
        /// Folder of the run.
        run: PathBuf,
    },
}

impl Reported for MisplacedOption {
    fn class(&self) -> ErrorClass {
        ErrorClass::Usage
    }
}

/// Name of the scene that is to be drawn: a file, or a preset unless a run has its name.
pub(super) fn scene_name(what: &Path, run: &Path, methods: Methods) -> Option<String> {
    let name = what.to_str()?;
    let is_preset = || !run.exists() && presets(methods).any(|preset| preset.name == name);
    (what.is_file() || is_preset()).then(|| name.to_owned())
}

/// Pictures of the particles, sides and plane walls of a scene at its start, of bodies in space from two sides.
///
/// # Errors
/// If the particles cannot be coloured this way.
pub(super) fn figures(
    name: &str,
    prepared: &Prepared,
    color: Option<&str>,
) -> Result<Vec<Figure>, ColouringError> {
    let domain = prepared.domain;
    let frame = ParticleFrame {
        particles: prepared.particles().clone(),
        cell: domain.lengths(),
        origin: domain.corner(),
        periodic: Some(domain.periodic()),
        time: 0.0,
        step: 0,
        seed: prepared.seed,
        has_raised_ids: false,
    };
    let colours = RunColouring::new(color, || prepared.model.pair_forces());
    let scene: Option<toml::Table> = prepared.scene.parse().ok();
    let walls = scene.as_ref().map(WallSegments::of).unwrap_or_default();
    state_figures(("start", &short_name(Path::new(name))), &frame, (scene.as_ref(), &walls), &[], &colours)
}
