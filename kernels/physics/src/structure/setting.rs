//! Reference lengths of observables: the box and the sizes of the initial discs.

use crate::domain::Domain;
use crate::particles::Particles;

/// Largest distance of pairs, in mean diameters.
const REACH: f64 = 4.0;

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
    /// Largest distance of pairs (length).
    pub reach: f64,
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
        let reach = reaches.into_iter().fold(REACH * diameter, f64::min).max(0.0);
        let largest_radius = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
        let smallest_radius = discs.iter().map(|disc| disc.radius).fold(f64::INFINITY, f64::min);
        StructureSetting {
            domain,
            diameter,
            largest_radius,
            smallest_radius,
            discs: discs.len(),
            reach,
            has_open_top,
        }
    }

    /// Sides of the rectangle that centres of discs of the mean size can reach without wall discs (length).
    pub fn room(&self) -> [f64; 2] {
        [0, 1].map(|axis| match self.domain.is_periodic(axis) {
            true => self.domain.length(axis),
            false => self.domain.length(axis) - self.diameter,
        })
    }
}
