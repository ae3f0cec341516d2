//! Mixtures of discs of two sizes: scenes, the largest ratio of the radii that a mask admits, and the pairs that searches compare.

use super::running::bisect_range;
use stripmine_physics::domain::Domain;
use stripmine_physics::near::NeighbourSearch;
use stripmine_physics::particles::Particle;
use stripmine_physics::scene::{COUNT, GENERATE, Overrides, SECOND_RADIUS, SECOND_SHARE, SIDES};

/// Radius of the small discs, that of the presets (length).
pub(super) const SMALL: f64 = 0.5;

/// Two sizes that cover equal areas, in a square box at a packing fraction. `ratio` is the larger radius over the smaller one.
pub(super) fn mixture(ratio: f64, discs: u64, packing_fraction: f64) -> Overrides {
    let share = 1.0 / (1.0 + ratio * ratio);
    let mean_square = SMALL * SMALL * (1.0 - share + share * ratio * ratio);
    let side = (discs as f64 * std::f64::consts::PI * mean_square / packing_fraction).sqrt();
    let scene = Overrides::new().set(&GENERATE, "compressed").set(&COUNT, discs).set(&SIDES, [side; 2]);
    scene.set(&SECOND_RADIUS, ratio * SMALL).set(&SECOND_SHARE, share)
}

/// Finds the largest ratio of the radii of two discs that scenes admit, in a box that cells of a side `cell` (length) fill. `admits` checks the scene.
pub(super) fn largest_ratio(cell: f64, admits: impl Fn(&Overrides) -> bool) -> f64 {
    let scene = |ratio: f64| {
        let scene =
            Overrides::new().set(&GENERATE, "random").set(&COUNT, 2_u64).set(&SIDES, [1000.0 * cell; 2]);
        scene.set(&SECOND_RADIUS, ratio * SMALL).set(&SECOND_SHARE, 0.5)
    };
    let is_admitted = |ratio| Ok::<_, std::convert::Infallible>(admits(&scene(ratio)));
    let found = bisect_range([1.0, 20.0], |[a, b]| b - a < 1e-6 * a, |a, b| 0.5 * (a + b), is_admitted);
    found.map_or(f64::NAN, |[admitted, _]| admitted)
}

/// Pairs for each disc that a search compares or lists, each pair once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ComparedPairs {
    /// In the squares of one grid, as wide as the largest discs reach.
    pub(super) one_grid: f64,
    /// With a grid for each size, in the squares of the larger disc's grid.
    pub(super) grid_of_each_size: f64,
    /// Nearer than the largest discs reach.
    pub(super) within_largest: f64,
    /// Nearer than the sum of their own radii and the margin.
    pub(super) within_own: f64,
}

impl ComparedPairs {
    /// Counts the pairs of some discs, with a margin beyond contact (length).
    pub(super) fn of(domain: &Domain, discs: &[Particle], margin: f64) -> ComparedPairs {
        let place = |disc: &Particle| domain.wrapped(disc.planar_position());
        let mut sizes: Vec<f64> = discs.iter().map(|disc| disc.radius).collect();
        sizes.sort_by(f64::total_cmp);
        sizes.dedup();
        let largest = sizes.last().copied().unwrap_or(0.0);
        let search = |members: &[Particle], reach: f64| {
            NeighbourSearch::over_positions(*domain, members.iter().map(place), reach)
        };
        let mut pairs = ComparedPairs::default();
        let all = search(discs, 2.0 * largest + margin);
        for (disc, number) in discs.iter().zip(0..) {
            // Both discs of a pair compare it here.
            for (other, there) in all.candidates_near(place(disc)).filter(|(other, _)| *other != number) {
                let distance = domain.distance(place(disc), there);
                let own = disc.radius + discs[other as usize].radius + margin;
                pairs.one_grid += 0.5;
                pairs.within_largest += if distance < 2.0 * largest + margin { 0.5 } else { 0.0 };
                pairs.within_own += if distance < own { 0.5 } else { 0.0 };
            }
        }
        for size in sizes {
            let members: Vec<Particle> = discs.iter().filter(|disc| disc.radius == size).cloned().collect();
            let grid = search(&members, 2.0 * size + margin);
            for disc in discs.iter().filter(|disc| disc.radius <= size) {
                let compared = grid.candidates_near(place(disc)).count() as f64;
                pairs.grid_of_each_size += if disc.radius < size { compared } else { 0.5 * (compared - 1.0) };
            }
        }
        let count = discs.len() as f64;
        let ComparedPairs { one_grid, grid_of_each_size, within_largest, within_own } = pairs;
        let [one_grid, grid_of_each_size, within_largest, within_own] =
            [one_grid, grid_of_each_size, within_largest, within_own].map(|pairs| pairs / count);
        ComparedPairs { one_grid, grid_of_each_size, within_largest, within_own }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::particles::ParticleKind;

    fn disc(x: f64, y: f64, radius: f64) -> Particle {
        Particle {
            id: 1,
            kind: ParticleKind::Grain,
            species: 0,
            position: [x, y, 0.0],
            velocity: [0.0; 3],
            angle: 0.0,
            omega: 0.0,
            radius,
            mass: 1.0,
        }
    }

    /// 144 small discs on a square lattice of spacing 1, and four large ones of three times the radius, counted by hand.
    #[test]
    fn pairs_on_a_lattice_match_counts_by_hand() {
        let domain = Domain::planar([0.0; 2], [12.0; 2], [true; 2]);
        let along = || (0..12).map(|at| f64::from(at) + 0.5);
        let small = along().flat_map(|x| along().map(move |y| disc(x, y, 0.5)));
        let large = [(3.0, 3.0), (3.0, 9.0), (9.0, 3.0), (9.0, 9.0)].map(|(x, y)| disc(x, y, 1.5));
        let discs: Vec<Particle> = small.chain(large).collect();
        let pairs = ComparedPairs::of(&domain, &discs, 0.0);
        // Squares of 3 hold nine small discs; a disc sees those of nine squares, and large ones do not see each other.
        assert_eq!(pairs.one_grid, (144.0 * 80.0 / 2.0 + 4.0 * 81.0) / 148.0);
        // Squares of 1 hold one small disc; each large one is seen from nine squares of 3.
        assert_eq!(pairs.grid_of_each_size, (144.0 * 8.0 / 2.0 + 4.0 * 81.0) / 148.0);
        // 24 lattice vectors are shorter than 3; 32 small discs are nearer than 3 to a large one, twelve nearer than 2.
        assert_eq!(pairs.within_largest, (144.0 * 24.0 / 2.0 + 4.0 * 32.0) / 148.0);
        assert_eq!(pairs.within_own, 4.0 * 12.0 / 148.0);
    }

    /// 400 small discs and 100 of twice the radius cover 0.4 of the box, half of it each.
    #[test]
    fn both_sizes_cover_equal_areas() {
        let texts = mixture(2.0, 500, 0.4).texts();
        let value = |key: &str| {
            let text = texts.iter().find_map(|text| text.strip_prefix(key)).unwrap();
            text.trim_matches(['=', '[', ']', ' ']).split(',').next().unwrap().parse::<f64>().unwrap()
        };
        assert_eq!(value("particles.second_share"), 0.2);
        let areas = [400.0 * 0.25, 100.0 * 1.0].map(|squares| std::f64::consts::PI * squares);
        assert_eq!(areas[0], areas[1]);
        assert!(((areas[0] + areas[1]) / value("domain.sides").powi(2) - 0.4).abs() < 1e-12);
    }
}
