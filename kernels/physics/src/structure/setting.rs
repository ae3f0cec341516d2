//! Reference lengths of observables: the box and the sizes of the initial discs.

use crate::domain::Domain;
use crate::particles::{Particle, Particles};

/// Largest distance of pairs, in mean diameters.
const REACH: f64 = 4.0;
/// Bins of distances in a mean diameter; an integer, so that one of them starts at contact.
const BINS: f64 = 50.0;
/// Largest number of species told apart.
pub(crate) const MOST_SPECIES: usize = 4;

/// Box, and lengths that define bins.
#[derive(Clone, Copy, Debug)]
pub struct StructureSetting {
    /// Box.
    pub domain: Domain,
    /// Mean initial diameter (length).
    pub diameter: f64,
    /// Largest initial radius (length).
    pub(crate) largest_radius: f64,
    /// Smallest initial radius (length).
    pub(crate) smallest_radius: f64,
    /// Initial number of discs.
    pub discs: usize,
    /// Largest distance of pairs (length), and the largest that the box allows.
    pub reach: f64,
    pub(crate) longest_reach: f64,
    /// Bins of distances in a mean diameter.
    pub(super) bins: f64,
    /// Number of species of the initial discs.
    pub(crate) species: usize,
    /// True if discs may be above the upper end of the second side.
    pub has_open_top: bool,
}

impl StructureSetting {
    /// Setting of a box and its initial discs.
    pub fn new(domain: Domain, particles: &Particles) -> StructureSetting {
        StructureSetting::of(domain, particles, false)
    }

    /// Setting of a box without a ceiling. The second side is the height stated by the scene, up to which profiles extend.
    pub fn with_open_top(domain: Domain, particles: &Particles) -> StructureSetting {
        StructureSetting::of(domain, particles, true)
    }

    fn of(domain: Domain, particles: &Particles, has_open_top: bool) -> StructureSetting {
        let discs = particles.grains();
        let diameter = 2.0 * discs.iter().map(|disc| disc.radius).sum::<f64>() / discs.len() as f64;
        let reaches = [0, 1].map(|axis| match domain.is_periodic(axis) {
            true => 0.5 * domain.length(axis),
            false if axis == 1 && has_open_top => f64::INFINITY,
            false => domain.length(axis) - diameter,
        });
        let longest_reach = reaches.into_iter().fold(f64::INFINITY, f64::min).max(0.0);
        let reach = (REACH * diameter).min(longest_reach);
        let largest_radius = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
        let smallest_radius = discs.iter().map(|disc| disc.radius).fold(f64::INFINITY, f64::min);
        StructureSetting {
            domain,
            diameter,
            largest_radius,
            smallest_radius,
            discs: discs.len(),
            reach,
            longest_reach,
            bins: BINS,
            species: species_numbers(discs).1,
            has_open_top,
        }
    }

    /// Setting with another largest distance of pairs (length), up to that of the box, and another number of bins up to there.
    #[must_use]
    pub fn with_bins(self, reach: Option<f64>, bins: Option<u64>) -> StructureSetting {
        let reach = reach.unwrap_or(self.reach).min(self.longest_reach);
        let bins = bins.map_or(self.bins, |bins| bins as f64 * self.diameter / reach);
        StructureSetting { reach, bins, ..self }
    }

    /// Numbers that define the bins of distances.
    pub(crate) fn binning(&self) -> [f64; 2] {
        [self.reach, self.bins]
    }

    /// Pairs of species, each once, by their numbers from 0.
    pub(super) fn pairs_of_species(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let species = self.species;
        (0..species).flat_map(move |a| (a..species).map(move |b| [a, b]))
    }

    /// Coordinates of a function of pairs of species: the numbers of both from 1, then those of `over`.
    pub(super) fn by_pairs_of_species(&self, over: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let pairs = self.pairs_of_species().map(|pair| pair.map(|species| species as f64 + 1.0));
        pairs.flat_map(|pair| over.iter().map(move |over| [&pair[..], over].concat())).collect()
    }

    /// Sides of the rectangle that centres of discs of the mean size can reach without wall discs (length).
    pub fn room(&self) -> [f64; 2] {
        [0, 1].map(|axis| match self.domain.is_periodic(axis) {
            true => self.domain.length(axis),
            false => self.domain.length(axis) - self.diameter,
        })
    }
}

/// Number of each grain's species, from 0 in the order of the numbers at the start; and their count.
pub(crate) fn species_numbers(grains: &[Particle]) -> (Vec<u8>, usize) {
    let (mut numbers, mut count) = ([u8::MAX; 256], 0);
    grains.iter().for_each(|grain| numbers[usize::from(grain.species)] = 0);
    for number in numbers.iter_mut().filter(|number| **number == 0) {
        *number = count as u8;
        count += 1;
    }
    (grains.iter().map(|grain| numbers[usize::from(grain.species)]).collect(), count)
}
