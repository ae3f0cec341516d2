//! Random placement without overlap.

use crate::domain::Domain;
use crate::near::NeighbourSearch;
use crate::particles::{Particle, ParticleKind, in_space};
use rand::distr::Distribution;
use rand::{Rng, RngExt};
use stripmine_kernels::noise::{RandomPurpose, Stream, normals};

/// Specification of a random placement.
#[derive(Clone, Debug)]
pub(crate) struct RandomPlacement<'a> {
    /// Box of the placement.
    pub domain: Domain,
    /// Lower and upper corner of the region for discs, surfaces included (length). Centres may be anywhere along a periodic side that the region
    /// spans.
    pub room: [[f64; 2]; 2],
    /// Discs already placed.
    pub(crate) obstacles: &'a [Particle],
    /// Segments that no disc may cut (length).
    pub(crate) barriers: &'a [[[f64; 2]; 2]],
    /// Number of discs.
    pub count: usize,
    /// Mean radius (length).
    pub radius: f64,
    /// Standard deviation of the Gaussian radii, relative to the mean.
    pub spread: f64,
    /// Largest deviation of a radius, relative to the mean.
    pub cut: f64,
    /// Discs of a second mean radius among them.
    pub second: Second,
    /// Mass of a disc of the mean radius; masses scale as (R/mean)².
    pub mass: f64,
    pub seed: u64,
}

/// Second kind of discs, spread evenly over the ids.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Second {
    /// Mean radius (length).
    pub radius: f64,
    /// Fraction of the number of discs, from 0 to 1.
    pub share: f64,
}

impl Second {
    /// True if the disc of an id, from 1 on, is of this kind: ⌊n · share⌋ of the first n discs are.
    pub(crate) fn has(&self, id: u32) -> bool {
        let up_to = |count: u32| (f64::from(count) * self.share).floor();
        up_to(id) > up_to(id - 1)
    }

    /// Mean of the squared mean radii of both kinds, the first of radius `first` (length²).
    pub(crate) fn mean_square(&self, first: f64) -> f64 {
        (1.0 - self.share) * first * first + self.share * self.radius * self.radius
    }

    /// Larger of the mean radii in use, the first being `first` (length).
    pub(crate) fn largest(&self, first: f64) -> f64 {
        if self.share > 0.0 { first.max(self.radius) } else { first }
    }
}

/// Failure of the random placement to find free space.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("random placement found room for {placed} of {asked} discs; the next found none in {tries} tries")]
pub(crate) struct PlacementJammed {
    /// Discs placed.
    pub placed: usize,
    /// Discs asked for.
    pub asked: usize,
    /// Tries for the disc that found no space.
    pub(crate) tries: usize,
}

/// Tries for one disc. Near saturation one in about ten thousand succeeds.
const TRIES: usize = 200_000;

/// Places discs with ids from 1 on, at rest, one after the other where they overlap nothing; those of the larger kind are first, as they find
/// no room among many small ones. The result depends on the filling alone.
///
/// # Errors
/// [`PlacementJammed`] if a disc finds no free space.
pub(crate) fn place_randomly(filling: &RandomPlacement<'_>) -> Result<Vec<Particle>, PlacementJammed> {
    let RandomPlacement {
        domain,
        room,
        obstacles,
        barriers,
        count,
        radius: mean,
        cut,
        second,
        mass,
        seed,
        ..
    } = *filling;
    let obstacle = obstacles.iter().map(|disc| disc.radius).fold(0.0, f64::max);
    let largest = second.largest(mean) * (1.0 + cut);
    let mut near = NeighbourSearch::new(domain, (2.0 * largest).max(largest + obstacle));
    let mut circles: Vec<f64> = Vec::with_capacity(obstacles.len() + count.min(1 << 20));
    for disc in obstacles {
        near.add(circles.len() as u32, domain.wrapped(disc.planar_position()));
        circles.push(disc.radius);
    }
    let mut discs = Vec::new();
    let ids = || 1..=count as u32;
    let kind = |id: u32| if second.has(id) { second.radius } else { mean };
    let is_large = |id: u32| kind(id) == second.largest(mean);
    for id in ids().filter(|&id| is_large(id)).chain(ids().filter(|&id| !is_large(id))) {
        let mut stream = Stream::new(seed, RandomPurpose::Placement, id);
        let radius = kind(id) * (1.0 + stream.sample(TruncatedNormal { deviation: filling.spread, cut }));
        let jammed = PlacementJammed { placed: discs.len(), asked: count, tries: TRIES };
        let ranges = [0, 1].map(|axis| {
            let [low, high] = room.map(|corner| corner[axis]);
            let open = domain.is_periodic(axis) && high - low >= domain.length(axis);
            if open { [low, high] } else { [low + radius, high - radius] }
        });
        if ranges.iter().any(|[low, high]| low > high) {
            return Err(PlacementJammed { tries: 0, ..jammed });
        }
        let mut draw = || {
            let position = ranges.map(|[low, high]| stream.random_range(low..=high));
            domain.wrapped(position)
        };
        let free = |position: &[f64; 2]| {
            near.candidates_near(*position)
                .all(|(other, there)| domain.distance(*position, there) > radius + circles[other as usize])
                && barriers.iter().all(|ends| domain.distance_to_segment(*position, ends) > radius)
        };
        let position = (0..TRIES).map(|_| draw()).find(free).ok_or(jammed)?;
        near.add(circles.len() as u32, position);
        circles.push(radius);
        let share = radius / mean;
        discs.push(Particle {
            id,
            kind: ParticleKind::Grain,
            species: u8::from(second.has(id)),
            position: in_space(position),
            velocity: [0.0; 3],
            angle: 0.0,
            omega: 0.0,
            radius,
            mass: mass * share * share,
        });
    }
    discs.sort_unstable_by_key(|disc| disc.id);
    Ok(discs)
}

/// Gaussian numbers of the given standard deviation, at most `cut` in magnitude.
///
/// The distributions of the crate `rand_distr` use the platform's logarithms and exponentials. These use the portable `libm`, so that radii have
/// the same bits everywhere.
struct TruncatedNormal {
    deviation: f64,
    cut: f64,
}

impl Distribution<f64> for TruncatedNormal {
    fn sample<R: Rng + ?Sized>(&self, random: &mut R) -> f64 {
        let TruncatedNormal { deviation, cut } = *self;
        if deviation == 0.0 || cut == 0.0 {
            return 0.0;
        }
        loop {
            // Narrow cuts use a flat proposal, wide ones the Gaussian itself: either is accepted about three times in five.
            let number = if cut < deviation {
                let flat = random.random_range(-cut..=cut);
                let z = flat / deviation;
                if random.random::<f64>() > libm::exp(-0.5 * z * z) {
                    continue;
                }
                flat
            } else {
                // The interval (0, 1], where the logarithm is finite.
                let radius = (-2.0 * libm::log(1.0 - random.random::<f64>())).sqrt();
                deviation * radius * libm::cos(random.random_range(0.0..std::f64::consts::TAU))
            };
            if number.abs() <= cut {
                return number;
            }
        }
    }
}

/// Gives discs Gaussian velocities of standard deviation `deviation(disc)` (length/time) for each component. They depend on seed and id alone, and
/// have no net momentum if `balanced`.
pub(crate) fn set_gaussian_velocities(
    discs: &mut [Particle],
    seed: u64,
    balanced: bool,
    deviation: impl Fn(&Particle) -> f64,
) {
    for disc in discs.iter_mut() {
        disc.velocity =
            in_space(normals(seed, RandomPurpose::Placement, disc.id, 1).map(|v| v * deviation(disc)));
    }
    if balanced {
        let mass: f64 = discs.iter().map(|disc| disc.mass).sum();
        for axis in 0..2 {
            let mean = discs.iter().map(|disc| disc.mass * disc.velocity[axis]).sum::<f64>() / mass;
            discs.iter_mut().for_each(|disc| disc.velocity[axis] -= mean);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filling() -> RandomPlacement<'static> {
        RandomPlacement {
            domain: Domain::planar([-2.0, 1.0], [30.0, 20.0], [true, false]),
            room: [[-2.0, 1.0], [28.0, 21.0]],
            obstacles: &[],
            barriers: &[],
            count: 300,
            radius: 0.5,
            spread: 0.05,
            cut: 0.1,
            second: Second::default(),
            mass: 2.0,
            seed: 9,
        }
    }

    /// A quarter of 40 discs has the second radius, evenly spread over the ids, and masses are proportional to areas.
    #[test]
    fn two_kinds_are_mixed_evenly() {
        let second = Second { radius: 0.7, share: 0.25 };
        let discs = place_randomly(&RandomPlacement { count: 40, spread: 0.0, second, ..filling() }).unwrap();
        let larger: Vec<u32> = discs.iter().filter(|disc| disc.radius == 0.7).map(|disc| disc.id).collect();
        assert_eq!(larger, [4, 8, 12, 16, 20, 24, 28, 32, 36, 40]);
        assert!(discs.iter().all(|disc| (disc.mass / disc.radius.powi(2) - 8.0).abs() < 1e-12));
        assert!((second.mean_square(0.5) - (0.75 * 0.25 + 0.25 * 0.49)).abs() < 1e-15);
        assert_eq!([second.largest(0.5), Second::default().largest(0.5)], [0.7, 0.5]);
        let overlap = |a: &Particle, b: &Particle| {
            filling().domain.distance(a.planar_position(), b.planar_position()) < a.radius + b.radius
        };
        assert!(discs.iter().enumerate().all(|(i, a)| discs[..i].iter().all(|b| !overlap(a, b))));
    }

    /// 990 discs of radius 0.5 and 9 of radius 5 cover a half; among the small ones a large one would find no room.
    #[test]
    fn large_discs_are_placed_before_small_ones() {
        let domain = Domain::planar([0.0; 2], [54.6; 2], [true; 2]);
        let kinds =
            [(0.5, Second { radius: 5.0, share: 0.0099 }), (5.0, Second { radius: 0.5, share: 0.99 })];
        for (radius, second) in kinds {
            let mixture = RandomPlacement { domain, count: 999, radius, second, spread: 0.0, ..filling() };
            let discs = place_randomly(&RandomPlacement { room: [[0.0; 2], [54.6; 2]], ..mixture }).unwrap();
            assert!((9..=11).contains(&discs.iter().filter(|disc| disc.radius == 5.0).count()));
            assert!(discs.iter().zip(1..).all(|(disc, id)| disc.id == id));
        }
    }

    #[test]
    fn random_discs_stay_inside_without_overlap() {
        let filling = filling();
        let discs = place_randomly(&filling).unwrap();
        assert_eq!(discs.len(), 300);
        for (i, a) in discs.iter().enumerate() {
            assert_eq!(a.id as usize, i + 1);
            assert!(filling.domain.contains(a.position));
            assert!(a.position[1] - a.radius >= 1.0 && a.position[1] + a.radius <= 21.0);
            assert!((a.radius / 0.5 - 1.0).abs() <= 0.1);
            assert!((a.mass - 2.0 * (a.radius / 0.5).powi(2)).abs() < 1e-12);
            for b in &discs[..i] {
                assert!(
                    filling.domain.distance(a.planar_position(), b.planar_position()) > a.radius + b.radius
                );
            }
        }
        assert_eq!(discs, place_randomly(&filling).unwrap());
        assert_ne!(discs, place_randomly(&RandomPlacement { seed: 10, ..filling }).unwrap());
    }

    /// A change of these bits changes every scene with a random start; a new version of `rand` must not cause it unnoticed.
    #[test]
    fn bits_of_a_random_start_are_fixed() {
        let mut discs = place_randomly(&RandomPlacement { count: 40, ..filling() }).unwrap();
        set_gaussian_velocities(&mut discs, 9, true, |_| 0.5);
        assert_eq!(crate::particles::Particles::new(discs).checksum(), "5ba7c8a9");
    }

    #[test]
    fn too_many_discs_are_refused() {
        let jammed = place_randomly(&RandomPlacement { count: 700, ..filling() }).unwrap_err();
        assert!(jammed.asked == 700 && (350..450).contains(&jammed.placed), "{jammed}");
        let narrow = RandomPlacement { room: [[-2.0, 1.0], [28.0, 1.3]], ..filling() };
        assert_eq!(place_randomly(&narrow).unwrap_err().placed, 0);
    }

    /// Variance of a Gaussian cut at ± c standard deviations: 1 − 2 c φ(c)/(2Φ(c) − 1).
    #[test]
    fn radii_are_gaussian_within_the_cut() {
        let mut stream = Stream::new(3, RandomPurpose::Test, 1);
        for (cut, variance) in [(0.5, 0.080_5), (2.0, 0.773_7), (9.0, 1.0)] {
            let n = 40_000;
            let numbers: Vec<f64> =
                (0..n).map(|_| stream.sample(TruncatedNormal { deviation: 1.0, cut })).collect();
            assert!(numbers.iter().all(|z| z.abs() <= cut));
            let (mean, square) =
                numbers.iter().fold((0.0, 0.0), |(m, s), z| (m + z / f64::from(n), s + z * z / f64::from(n)));
            assert!(mean.abs() < 0.03 && (square / variance - 1.0).abs() < 0.04, "{cut}: {mean} {square}");
        }
    }
}
