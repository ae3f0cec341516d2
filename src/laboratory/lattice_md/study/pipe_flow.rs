//! Do grains that fall through a pipe gather into density waves? BP93 section 4, figures 5 and 6.

use super::StudyError;
use crate::statistics::Mean;
use serde::Serialize;
use stripmine_physics::method::lattice_md::Document;
use stripmine_physics::method::lattice_md::keys::{
    EXECUTION, FRICTION, NORMAL_DAMPING, SEARCH, SHEAR_DAMPING,
};
use stripmine_physics::method::lattice_md::options::By;
use stripmine_physics::method::lattice_md::{assemble, model};
use stripmine_physics::observe::waves::{Directions, directions, fano, histogram, strongest_mode};
use stripmine_physics::observe::{Observation, Scenery};
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::{DT, GRAVITY, Overrides, SEED};

/// What to run: a pipe scene with overrides, and for how long.
#[derive(Clone, Debug)]
pub struct Question {
    /// A preset's name, or a scene file.
    pub scene: &'static str,
    /// What differs from the scene.
    pub overrides: Overrides,
    /// Seed of the start.
    pub seed: u64,
    /// Whether positions are kept for drawing.
    pub keep_frames: bool,
}

/// Time between two looks (s), as in figure 6.
pub const LOOK: f64 = 0.05;
/// Bins of the Fano factor, in mean radii.
pub const FANO_BIN: f64 = 20.0;
/// Bins of the map of density, in mean radii.
pub const MAP_BIN: f64 = 5.0;
/// The shortest wavelength looked for, in mean radii.
pub const SHORTEST_WAVE: f64 = 80.0;

/// What makes of a pipe a control without waves: an elastic gas without gravity, whose contacts need the shorter step (s).
pub fn elastic(pipe: &Overrides) -> Overrides {
    let gas = pipe.clone().set(&GRAVITY, [0.0; 2]).set(&NORMAL_DAMPING, 0.0).set(&SHEAR_DAMPING, 0.0);
    gas.set(&FRICTION, 0.0).set(&DT, 5e-5)
}

/// What came of one run.
#[derive(Clone, Debug, Serialize)]
pub struct PipeFlow {
    /// The scene.
    pub scene: &'static str,
    /// What differed from it.
    pub overrides: Overrides,
    /// Seed of the start.
    pub seed: u64,
    /// Grains.
    pub grains: usize,
    /// Length of the pipe (m).
    pub length: f64,
    /// Mean radius of the grains (m).
    pub radius: f64,
    /// Times of the looks, the start first (s).
    pub times: Vec<f64>,
    /// Variance over mean of the grains in bins of [`FANO_BIN`] radii, at each look.
    pub fano: Vec<f64>,
    /// Strongest Fourier amplitude at wavelengths from [`SHORTEST_WAVE`] radii on, at each look.
    pub strongest_mode: Vec<f64>,
    /// Mean velocity along the pipe at each look (m/s).
    pub flow: Vec<f64>,
    /// Grains in bins of [`MAP_BIN`] radii, at each look.
    pub density: Vec<Vec<u32>>,
    /// Which way the waves ran in the last half of the run: forth is the way grains fall.
    pub directions: Directions,
    /// Deepest penetration of all steps, and only what is deeper than the scene's `max_penetration` is followed
    /// (fraction of the sum of the radii).
    pub deepest: f64,
    /// CRC-32 of the final state, by id.
    pub checksum: String,
    /// The grains at each look, where asked for; drawn, not written.
    #[serde(skip)]
    pub frames: Vec<Particles>,
}

impl PipeFlow {
    /// Mean of a figure over the looks of the last half.
    pub fn late(&self, figure: &[f64]) -> Mean {
        Mean::of_course(&figure[figure.len() - figure.len() / 2..])
    }
}

/// Runs a pipe. `progress` gets the share that is done.
///
/// The run uses neighbour lists: they give the lattice's trajectory to the bit (the study `identity` holds them against
/// each other), in a third of the time for a scene as small as this.
///
/// # Errors
/// [`StudyError`] if the scene is bad or breaks while running.
pub fn pipe_flow(question: &Question, mut progress: impl FnMut(f64)) -> Result<PipeFlow, StudyError> {
    let overrides = question.overrides.clone().set(&SEED, question.seed);
    let overrides = overrides.set(&SEARCH, By::NeighborList).set(&EXECUTION, "chained");
    let checked = Document::load(question.scene, &overrides)?.check()?;
    let mut method = assemble(&checked)?;
    let scenery = Scenery::of(&model(&checked));
    let (length, origin) = (checked.domain.length(0), checked.domain.origin[0]);
    let scene = &checked.scene;
    let look_every = (LOOK / scene.integrator.dt).round() as u64;
    let radii = checked.particles.grains().iter().map(|grain| grain.radius);
    let grains = checked.particles.grain_count();
    let radius = radii.sum::<f64>() / grains as f64;
    let bins = |width: f64| (length / (width * radius)).round() as usize;
    let mut flow = PipeFlow {
        scene: question.scene,
        overrides: question.overrides.clone(),
        seed: question.seed,
        grains,
        length,
        radius,
        times: vec![],
        fano: vec![],
        strongest_mode: vec![],
        flow: vec![],
        density: vec![],
        directions: Directions::default(),
        deepest: 0.0,
        checksum: String::new(),
        frames: vec![],
    };
    loop {
        if method.steps().is_multiple_of(look_every) {
            let now = method.particles();
            let along: Vec<f64> = now.grains().iter().map(|grain| grain.position[0] - origin).collect();
            flow.times.push(method.time());
            flow.fano.push(fano(&histogram(along.iter().copied(), length, bins(FANO_BIN))));
            flow.strongest_mode.push(strongest_mode(&along, length, SHORTEST_WAVE * radius));
            flow.density.push(histogram(along, length, bins(MAP_BIN)));
            flow.flow.push(Observation::of(method.steps(), method.time(), &now, &scenery).flow);
            if question.keep_frames {
                flow.frames.push(now);
            }
            progress(method.steps() as f64 / scene.run.steps as f64);
        }
        if method.steps() >= scene.run.steps {
            break;
        }
        method.step()?;
    }
    let late = &flow.density[flow.density.len() / 2..];
    flow.directions = directions(late, length, SHORTEST_WAVE * radius);
    flow.deepest = method.totals().deepest;
    flow.checksum = method.particles().checksum();
    Ok(flow)
}
