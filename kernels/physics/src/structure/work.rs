//! Cost of sampling: the stride that keeps it within its share of a run's work, and its memory.

use super::heights;
use super::neighbours::candidates as neighbours_looked_at;
use super::waves::{bytes_of_waves, sums_of_a_disc};
use super::{MotionHistory, SampleData, SamplingKind, StructureObservable, StructureSetting};
use crate::particles::{GrainStates, Particle};
use std::f64::consts::PI;

/// Cost for each disc (ns): to copy it, for a pair within reach, for its neighbours and each candidate, in a density wave, for single-disc
/// functions, for forces; in a row, and to follow it across periodic sides. Then the cost of each value of a function. They were measured once.
/// Nothing is measured during a run, so that every machine samples the same moments.
const TAKEN_UP: f64 = 60.0;
const PAIR: f64 = 8.0;
const PAIR_OF_SPECIES: f64 = 16.0;
const NEIGHBOURS: f64 = 100.0;
const CANDIDATE: f64 = 16.0;
const WAVE: f64 = 0.5;
const ALONE: f64 = 15.0;
const FORCES: f64 = 250.0;
const ROW: f64 = 55.0;
const FOLLOWED: f64 = 20.0;
const VALUE: f64 = 8.0;

/// Cost of sampling a row and a snapshot for each disc (ns).
fn nanoseconds(observables: &[&StructureObservable], setting: &StructureSetting, discs: usize) -> [f64; 2] {
    let [mut row, mut snapshot]: [f64; 2] = [0.0; 2];
    let (mut found, [x, y]) = (vec![], setting.room());
    let density = discs as f64 / (x * y);
    for observable in observables {
        let (over, asks) = match observable.seen {
            SamplingKind::Once { over, asks, .. } => (over, asks),
            SamplingKind::Twice { follows, by_species, .. } => {
                let again = if by_species { ROW } else { 0.0 };
                row = row.max(ROW) + again + if follows { FOLLOWED } else { 0.0 };
                continue;
            }
        };
        // Functions of few discs cost more for their values than for the discs.
        let values = VALUE * over.places(setting).len() as f64 / discs as f64;
        snapshot = snapshot.max(TAKEN_UP) + values;
        if asks != SampleData::Discs && found.contains(&asks) {
            continue;
        }
        found.push(asks);
        snapshot += match asks {
            SampleData::Discs => ALONE,
            SampleData::Forces => FORCES,
            SampleData::DistancesOfSpecies => {
                PAIR_OF_SPECIES * 0.5 * PI * setting.reach * setting.reach * density
            }
            SampleData::Distances => {
                let ideal = if setting.has_open_top { heights::nanoseconds(setting, discs) } else { 0.0 };
                PAIR * 0.5 * PI * setting.reach * setting.reach * density + ideal
            }
            SampleData::Neighbours => NEIGHBOURS + CANDIDATE * neighbours_looked_at(setting, discs),
            SampleData::Waves | SampleData::WavesOfSpecies => WAVE * sums_of_a_disc(setting) as f64,
        };
    }
    [row, snapshot]
}

/// Strides of sampled rows and snapshots such that sampling takes at most a share of a run's work. `work` is the cost between two of each (ns for
/// each disc), 0 if unknown. If both are sampled, each has half the share.
pub fn strides(
    observables: &[&StructureObservable],
    setting: &StructureSetting,
    discs: usize,
    share: f64,
    work: [f64; 2],
) -> [u64; 2] {
    let takes = nanoseconds(observables, setting, discs);
    let asked = takes.iter().filter(|takes| **takes > 0.0).count().max(1) as f64;
    let stride = |at: usize| match work[at] > 0.0 {
        true => (takes[at] * asked / (share * work[at])).ceil().clamp(1.0, 1e9) as u64,
        false => 1,
    };
    [stride(0), stride(1)]
}

/// Memory for sampling in a run with at most `rows` samples of rows (bytes). Earlier samples are stored, twice while a checkpoint is written.
pub(crate) fn bytes(observables: &[&StructureObservable], discs: usize, rows: Option<u64>) -> u64 {
    let moves = observables.iter().any(|observable| matches!(observable.seen, SamplingKind::Twice { .. }));
    let stands = observables.iter().any(|observable| matches!(observable.seen, SamplingKind::Once { .. }));
    let state = size_of::<[f64; 4]>() as u64 * discs as u64;
    let mut bytes = 0;
    if moves {
        let follows = observables.iter().any(|observable| observable.follows_motion());
        let images = if follows { size_of::<[i32; 2]>() * discs } else { 0 };
        bytes += (GrainStates::bytes(discs) + images) as u64
            + 2 * state * MotionHistory::most_kept(rows.unwrap_or(u64::MAX));
    }
    if stands {
        // Six columns, three in the order of cells with images, three of cells; sizes and species.
        let of_a_disc = size_of::<[f64; 6]>() + 2 * size_of::<[f64; 3]>() + 3 * size_of::<u32>();
        let meets = |observable: &&StructureObservable| {
            matches!(observable.seen, SamplingKind::Once { asks: SampleData::Forces, .. })
        };
        if observables.iter().any(meets) {
            // A copy of the particles, their positions, and the sums of every 512 of them.
            bytes += ((size_of::<Particle>() + 6 * size_of::<f64>()) * discs) as u64;
        }
        let waves = |observable: &&StructureObservable| {
            matches!(
                observable.seen,
                SamplingKind::Once { asks: SampleData::Waves | SampleData::WavesOfSpecies, .. }
            )
        };
        if observables.iter().any(waves) {
            bytes += bytes_of_waves(discs);
        }
        let sizes = size_of::<([f64; 2], u8)>() + size_of::<u8>();
        bytes += (GrainStates::bytes(discs) + (of_a_disc + sizes) * discs) as u64;
    }
    bytes
}
