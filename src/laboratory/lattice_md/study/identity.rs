//! Does the lattice give what neighbour lists give? BP93 section 4: "no differences in the results".

use super::StudyError;
use crate::results::{Meter, Progress};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use stripmine_physics::method::lattice_md::Document;
use stripmine_physics::method::lattice_md::assemble;
use stripmine_physics::method::lattice_md::keys::{EXECUTION, NORMAL_DAMPING, SEARCH};
use stripmine_physics::method::lattice_md::options::By;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// A scene that both methods ran.
#[derive(Clone, Debug, Serialize)]
pub struct Pair {
    /// What it is.
    pub name: &'static str,
    /// The scene.
    pub scene: &'static str,
    /// What differs from it.
    pub overrides: Overrides,
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
pub fn identity(progress: Progress<'_>) -> Result<Identity, StudyError> {
    let few = Overrides::new().set(&COUNT, 400_u64);
    let dense = few.clone().set(&PACKING_FRACTION, 0.84).set(&NORMAL_DAMPING, 0.5);
    let scenes: [(&str, &str, Overrides, u64); 3] = [
        ("dense gas with friction", "bench", dense, 2000),
        ("density waves", "pipe-small", Overrides::new(), 4000),
        ("elastic gas", "dense-gas", few, 2000),
    ];
    let meter = Meter::new(scenes.iter().map(|scene| scene.3 as f64).sum(), progress);
    let pairs = scenes.par_iter().map(|(name, scene, overrides, steps)| {
        let start = |search: By| {
            let overrides = overrides.clone().set(&SEARCH, search).set(&EXECUTION, "chained");
            Ok::<_, StudyError>(assemble(&Document::load(scene, &overrides)?.check()?)?)
        };
        let (mut lattice, mut lists) = (start(By::Lattice)?, start(By::NeighborList)?);
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
                meter.add(STRIDE as f64);
            }
        }
        let grains = lattice.particles().grain_count();
        Ok(Pair { name, scene, overrides: overrides.clone(), grains, states })
    });
    Ok(Identity { pairs: pairs.collect::<Result<_, StudyError>>()? })
}
