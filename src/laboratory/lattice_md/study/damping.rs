//! How much dissipation makes waves? The pipe over γ_N, and controls that must stay even.

use super::StudyError;
use super::pipe_flow::{PipeFlow, Question, pipe_flow};
use crate::statistics::Spread;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// One case over its seeds.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    /// What it is.
    pub name: String,
    /// γ_N (1/s).
    pub normal_damping: f64,
    /// What differs from `pipe-small`.
    pub overrides: Vec<String>,
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
pub fn damping(seeds: &[u64], progress: impl Fn(f64) + Sync) -> Result<Damping, StudyError> {
    let scan = SCAN.map(|damping| {
        (format!("γ_N = {damping:.0} 1/s"), damping, vec![format!("law.normal_damping={damping:.0}")])
    });
    let elastic = [
        "domain.gravity=[0.0, 0.0]",
        "law.normal_damping=0",
        "law.shear_damping=0",
        "law.friction=0",
        "integrator.dt=5e-5",
    ];
    let elastic = ("elastic gas without gravity".to_owned(), 0.0, elastic.map(str::to_owned).to_vec());
    let cases: Vec<_> = scan.into_iter().chain([elastic]).collect();
    let runs: Vec<(usize, u64)> =
        (0..cases.len()).flat_map(|case| seeds.iter().map(move |&seed| (case, seed))).collect();
    let done = AtomicUsize::new(0);
    let flows = runs.par_iter().map(|&(case, seed)| {
        let overrides = cases[case].2.clone();
        let question = Question { scene: "pipe-small", overrides, seed, keep_frames: false };
        let flow = pipe_flow(&question, |_| {});
        progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / runs.len() as f64);
        flow
    });
    let flows: Vec<PipeFlow> = flows.collect::<Result<_, _>>()?;
    let cases =
        cases.into_iter().zip(flows.chunks(seeds.len())).map(|((name, normal_damping, overrides), flows)| {
            let over =
                |figure: &dyn Fn(&PipeFlow) -> f64| Spread::of(&flows.iter().map(figure).collect::<Vec<_>>());
            Case {
                name,
                normal_damping,
                overrides,
                fano_start: over(&|flow| flow.fano[0]),
                fano: over(&|flow| flow.late(&flow.fano)),
                mode_start: over(&|flow| flow.strongest_mode[0]),
                mode: over(&|flow| flow.late(&flow.strongest_mode)),
                flow: over(&|flow| flow.late(&flow.flow)),
                deepest: over(&|flow| flow.deepest),
            }
        });
    Ok(Damping { seeds: seeds.to_vec(), cases: cases.collect() })
}
