//! Random sites of a mesh.

use rand::RngExt;
use std::collections::HashMap;
use stripmine_kernels::noise::{RandomPurpose, Stream};

/// Draws `count` different sites of a mesh of some columns and rows, every choice and order equally likely (Fisher and Yates). Memory grows with
/// the sites drawn, not with the mesh: only exchanged entries of the shuffled list are stored.
///
/// # Panics
/// If there are fewer sites.
pub(crate) fn random_mesh_sites([columns, rows]: [usize; 2], count: usize, seed: u64) -> Vec<[usize; 2]> {
    let places = columns * rows;
    assert!(count <= places, "{count} of {places} sites");
    let mut random = Stream::new(seed, RandomPurpose::Placement, 0);
    let mut exchanged = HashMap::new();
    let mut draw = |drawn: usize| {
        let first = exchanged.remove(&drawn).unwrap_or(drawn);
        match random.random_range(drawn..places) {
            at if at == drawn => first,
            at => exchanged.insert(at, first).unwrap_or(at),
        }
    };
    (0..count).map(&mut draw).map(|place| [place % columns, place / columns]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sites equal those of a shuffled list of all, for meshes of one site to many, with a few or all of them drawn.
    #[test]
    fn sites_match_a_shuffled_list() {
        for (columns, rows, count) in [(1, 1, 1), (7, 5, 35), (7, 5, 1), (30, 40, 600), (500, 300, 90)] {
            for seed in 0..20 {
                let mut random = Stream::new(seed, RandomPurpose::Placement, 0);
                let mut list: Vec<usize> = (0..columns * rows).collect();
                for drawn in 0..count {
                    list.swap(drawn, random.random_range(drawn..columns * rows));
                }
                let expected: Vec<[usize; 2]> =
                    list[..count].iter().map(|place| [place % columns, place / columns]).collect();
                assert_eq!(random_mesh_sites([columns, rows], count, seed), expected);
            }
        }
    }

    /// Sites are drawn at most once, and all of them if all are asked for. Each is equally likely in each turn: χ² of 9999 draws of 3 of 6.
    #[test]
    fn sites_are_distinct_and_equally_likely() {
        let mut all = random_mesh_sites([7, 5], 35, 4);
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 35);
        let (mut counts, draws) = ([[0.0; 6]; 3], 9999);
        for seed in 0..draws {
            let places = random_mesh_sites([3, 2], 3, seed);
            for (turn, [column, row]) in places.into_iter().enumerate() {
                counts[turn][column + 3 * row] += 1.0;
            }
        }
        let expected = draws as f64 / 6.0;
        for turn in counts {
            // Five degrees of freedom: χ² exceeds 20.5 with probability 0.001.
            let square: f64 = turn.iter().map(|count: &f64| (count - expected).powi(2) / expected).sum();
            assert!(square < 20.5, "{square}");
        }
    }
}
