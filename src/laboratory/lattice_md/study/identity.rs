//! Does the lattice give what neighbour lists give? BP93 section 4: "no differences in the results".

use super::StudyError;
use super::executed;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use std::sync::atomic::{AtomicU64, Ordering};
use stripmine_physics::method::lattice_md::Document;
use stripmine_physics::method::lattice_md::assemble;

/// A scene that both methods ran.
#[derive(Clone, Debug, Serialize)]
pub struct Pair {
    /// What it is.
    pub name: &'static str,
    /// The scene.
    pub scene: &'static str,
    /// What differs from it.
    pub overrides: Vec<String>,
    /// Discs that move.
    pub grains: usize,
    /// The states that were compared.
    pub states: Vec<State>,
}

/// A state of both runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct State {
    /// The step.
    pub step: u64,
    /// CRC-32 of the lattice's state.
    pub lattice: String,
    /// CRC-32 of the lists' state.
    pub lists: String,
    /// Largest difference of a position (length).
    pub farthest: f64,
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Identity {
    /// Every scene.
    pub pairs: Vec<Pair>,
}

impl Identity {
    /// Whether every state that was compared is the same to the bit.
    pub fn holds(&self) -> bool {
        self.pairs.iter().flat_map(|pair| &pair.states).all(|state| state.lattice == state.lists)
    }
}

/// Steps between two comparisons.
const STRIDE: u64 = 1000;

/// Runs each scene with both methods. `progress` gets the share that is done.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn identity(progress: impl Fn(f64) + Sync) -> Result<Identity, StudyError> {
    let dense = ["particles.count=400", "particles.packing_fraction=0.84", "law.normal_damping=0.5"];
    let scenes: [(&str, &str, Vec<String>, u64); 3] = [
        ("dense gas with friction", "bench", dense.map(str::to_owned).to_vec(), 2000),
        ("density waves", "pipe-small", vec![], 4000),
        ("elastic gas", "dense-gas", vec!["particles.count=400".to_owned()], 2000),
    ];
    let (done, all) = (AtomicU64::new(0), scenes.iter().map(|scene| scene.3).sum::<u64>());
    let pairs = scenes.par_iter().map(|(name, scene, overrides, steps)| {
        let start = |kind: &str| {
            let mut overrides = overrides.clone();
            overrides.extend([format!("search.by={kind}"), executed("chained")]);
            Ok::<_, StudyError>(assemble(&Document::load(scene, &overrides)?.check()?)?)
        };
        let (mut lattice, mut lists) = (start("lattice")?, start("neighbor-list")?);
        let mut states = vec![];
        for step in 1..=*steps {
            lattice.step()?;
            lists.step()?;
            if step % STRIDE == 0 {
                let (a, b) = (lattice.particles(), lists.particles());
                let apart = a
                    .all()
                    .iter()
                    .zip(b.all())
                    .map(|(a, b)| (a.position[0] - b.position[0]).hypot(a.position[1] - b.position[1]));
                let farthest = apart.fold(0.0, f64::max);
                states.push(State { step, lattice: a.checksum(), lists: b.checksum(), farthest });
                progress((done.fetch_add(STRIDE, Ordering::Relaxed) + STRIDE) as f64 / all as f64);
            }
        }
        let grains = lattice.particles().grain_count();
        Ok(Pair { name, scene, overrides: overrides.clone(), grains, states })
    });
    Ok(Identity { pairs: pairs.collect::<Result<_, StudyError>>()? })
}
