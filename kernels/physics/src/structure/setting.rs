//! What an observable is measured by: the box and the size of the discs at the start.

use crate::domain::Domain;
use crate::particles::Particles;

/// Mean diameters up to which pairs are looked at.
const REACH: f64 = 4.0;

/// The box, and lengths that bins go by.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The box.
    pub domain: Domain,
    /// The mean diameter of the discs at the start (length).
    pub diameter: f64,
    /// The largest radius at the start (length).
    pub(crate) largest_radius: f64,
    /// The smallest radius at the start (length).
    pub(crate) smallest_radius: f64,
    /// How many discs there are at the start.
    pub discs: usize,
    /// How far pairs are looked at (length).
    pub reach: f64,
    /// Whether discs may be above the upper end of the second side.
    pub has_open_top: bool,
}

impl Setting {
    /// Of a box and the discs in it at the start.
    pub fn new(domain: Domain, particles: &Particles) -> Setting {
        Setting::of(domain, particles, false)
    }

    /// The same of a box without a ceiling. The second side is the height that the scene gives, up to which profiles go.
    pub fn with_open_top(domain: Domain, particles: &Particles) -> Setting {
        Setting::of(domain, particles, true)
    }

    fn of(domain: Domain, particles: &Particles, has_open_top: bool) -> Setting {
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
        Setting { domain, diameter, largest_radius, smallest_radius, discs: discs.len(), reach, has_open_top }
    }

    /// The sides of the rectangle that centres of discs of the mean size may be in, were there no wall discs (length).
    pub fn room(&self) -> [f64; 2] {
        [0, 1].map(|axis| match self.domain.is_periodic(axis) {
            true => self.domain.length(axis),
            false => self.domain.length(axis) - self.diameter,
        })
    }
}
