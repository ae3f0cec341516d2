//! How much dissipation makes waves? The pipe over γ_N, and controls that must stay even.

use super::StudyError;
use super::pipe_flow::{PipeFlow, Question, elastic, pipe_flow};
use crate::results::{Meter, Progress};
use crate::statistics::Spread;
use serde::Serialize;
use stripmine_physics::method::lattice_md::keys::NORMAL_DAMPING;
use stripmine_physics::scene::Overrides;

/// One case over its seeds.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    /// What it is.
    pub name: String,
    /// γ_N (1/s).
    pub normal_damping: f64,
    /// What differs from `pipe-small`.
    pub overrides: Overrides,
    /// Fano factor at the start.
    pub fano_start: Spread,
    /// Fano factor over the last half of the run.
    pub fano: Spread,
    /// Strongest Fourier mode at the start.
    pub mode_start: Spread,
    /// Strongest Fourier mode over the last half of the run.
    pub mode: Spread,
    /// Mean velocity along the pipe over the last half of the run (m/s).
    pub flow: Spread,
    /// Deepest penetration (fraction of the sum of the radii); 0 where none passed `max_penetration`.
    pub deepest: Spread,
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Damping {
    /// Seeds of every case.
    pub seeds: Vec<u64>,
    /// The cases: γ_N by increasing value, then the controls.
    pub cases: Vec<Case>,
}

impl Damping {
    /// The cases in which γ_N alone differs from the scene.
    pub fn scan(&self) -> impl Iterator<Item = &Case> {
        self.cases.iter().filter(|case| case.overrides.len() <= 1)
    }
}

/// γ_N of the scan (1/s).
pub const SCAN: [f64; 5] = [100.0, 200.0, 400.0, 700.0, 1000.0];

/// Runs every case with every seed. `progress` gets the share that is done.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn damping(seeds: &[u64], progress: Progress<'_>) -> Result<Damping, StudyError> {
    let scan = SCAN.map(|damping| {
        (format!("γ_N = {damping:.0} 1/s"), damping, Overrides::new().set(&NORMAL_DAMPING, damping))
    });
    let elastic = ("elastic gas without gravity".to_owned(), 0.0, elastic(&Overrides::new()));
    let cases: Vec<_> = scan.into_iter().chain([elastic]).collect();
    let runs: Vec<(usize, u64)> =
        (0..cases.len()).flat_map(|case| seeds.iter().map(move |&seed| (case, seed))).collect();
    let flows = Meter::new(runs.len() as f64, progress).each(&runs, |&(case, seed)| {
        let overrides = cases[case].2.clone();
        pipe_flow(&Question { scene: "pipe-small", overrides, seed, keep_frames: false }, |_| {})
    })?;
    let cases =
        cases.into_iter().zip(flows.chunks(seeds.len())).map(|((name, normal_damping, overrides), flows)| {
            let over =
                |figure: &dyn Fn(&PipeFlow) -> f64| Spread::of(&flows.iter().map(figure).collect::<Vec<_>>());
            Case {
                name,
                normal_damping,
                overrides,
                fano_start: over(&|flow| flow.fano[0]),
                fano: over(&|flow| flow.late(&flow.fano).value),
                mode_start: over(&|flow| flow.strongest_mode[0]),
                mode: over(&|flow| flow.late(&flow.strongest_mode).value),
                flow: over(&|flow| flow.late(&flow.flow).value),
                deepest: over(&|flow| flow.deepest),
            }
        });
    Ok(Damping { seeds: seeds.to_vec(), cases: cases.collect() })
}
