//! Studies: one file per question, each a function from parameters to a dataset.

pub mod break_even;
pub mod calibration;
pub mod crossover;
pub mod damping;
pub mod density_cost;
pub mod efficiency_table;
pub mod host_ladder;
pub mod identity;
pub mod ladder;
pub mod measured_cost;
pub mod misprints;
pub mod model_validation;
pub mod noise_monitor;
pub mod phase_times;
pub mod pipe_flow;
pub mod precision;
pub mod predicted_step;
pub mod rounds;
pub mod segment_times;
pub mod statistics;
pub mod threads;
pub mod throughput;
pub mod useful_work;

use crate::particles::Particles;

/// Why a study has no result.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The scene.
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneErrors),
    /// The physics.
    #[error(transparent)]
    Physics(#[from] crate::method::Failure),
    /// A question that has no answer.
    #[error(transparent)]
    Question(#[from] efficiency_table::QuestionError),
}

/// CRC-32 of the bits of positions, velocities and spins, by id: equal states have equal checksums.
pub fn checksum(particles: &Particles) -> String {
    let mut discs: Vec<_> = particles.all().iter().collect();
    discs.sort_by_key(|disc| disc.id);
    let mut hasher = crc32fast::Hasher::new();
    for disc in discs {
        let numbers = [disc.position[0], disc.position[1], disc.velocity[0], disc.velocity[1], disc.omega];
        numbers.iter().for_each(|number| hasher.update(&number.to_bits().to_le_bytes()));
    }
    format!("{:08x}", hasher.finalize())
}
