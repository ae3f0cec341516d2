//! Particles of a scene, independent of the storage of a method.

/// Most particles of a scene: searches number them with 29 bits.
pub(crate) const MOST_PARTICLES: usize = (1 << 29) - 1;

/// Motion of a particle: free or prescribed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ParticleKind {
    /// Moves under forces and gravity.
    #[default]
    Grain,
    /// Stands still or follows the motion that the scene prescribes for its walls; has infinite mass in every contact.
    Wall,
}

/// A particle: a disc in the plane, or a body in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// Unique number, constant during a run.
    pub id: u32,
    /// Kind of motion.
    pub kind: ParticleKind,
    /// Species of a grain at the start, for functions by species; forces do not depend on it.
    pub species: u8,
    /// Centre (length); the third coordinate is 0 in the plane.
    pub position: [f64; 3],
    /// Velocity (length/time); the third component is 0 in the plane.
    pub velocity: [f64; 3],
    /// Angle, counter-clockwise (radian).
    pub angle: f64,
    /// Angular velocity, counter-clockwise (1/time). Bodies in space do not rotate.
    pub omega: f64,
    /// Radius (length).
    pub radius: f64,
    /// Mass (mass); finite for a wall disc too, where it only describes the material.
    pub mass: f64,
}

/// Vector of the plane as a vector of space.
pub const fn in_space([x, y]: [f64; 2]) -> [f64; 3] {
    [x, y, 0.0]
}

/// First two components of a vector.
pub(crate) const fn in_plane([x, y, _]: [f64; 3]) -> [f64; 2] {
    [x, y]
}

impl Particle {
    /// Particle at rest whose radius and mass are still 0.
    pub(crate) const fn at_rest(id: u32, kind: ParticleKind, position: [f64; 3]) -> Particle {
        let (velocity, angle, omega, radius, mass) = ([0.0; 3], 0.0, 0.0, 0.0, 0.0);
        Particle { id, kind, species: 0, position, velocity, angle, omega, radius, mass }
    }

    /// Position in the plane (length).
    pub const fn planar_position(&self) -> [f64; 2] {
        in_plane(self.position)
    }

    /// Velocity in the plane (length/time).
    pub const fn planar_velocity(&self) -> [f64; 2] {
        in_plane(self.velocity)
    }
}

/// Particles: all grains first, then all wall discs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles(Vec<Particle>);

impl Particles {
    /// Sorts grains before wall discs and keeps the order otherwise.
    pub fn new(mut discs: Vec<Particle>) -> Self {
        discs.sort_by_key(|disc| disc.kind == ParticleKind::Wall);
        Particles(discs)
    }

    /// Particles without wall discs.
    pub(crate) fn of_grains(grains: Vec<Particle>) -> Self {
        debug_assert!(grains.iter().all(|disc| disc.kind == ParticleKind::Grain));
        Particles(grains)
    }

    /// All particles.
    pub fn all(&self) -> &[Particle] {
        &self.0
    }

    /// All particles, mutable. The kind of a particle must not change.
    pub fn all_mut(&mut self) -> &mut [Particle] {
        &mut self.0
    }

    /// Visits all particles, the last one first, and releases the memory of those visited piece by piece.
    pub(crate) fn release_each(self, mut visit: impl FnMut(Particle)) {
        const PIECES: usize = 16;
        let Particles(mut left) = self;
        let piece = left.len().div_ceil(PIECES).max(1);
        while !left.is_empty() {
            left.drain(left.len().saturating_sub(piece)..).rev().for_each(&mut visit);
            left.shrink_to_fit();
        }
    }

    /// Particles that forces move.
    pub fn grains(&self) -> &[Particle] {
        &self.0[..self.grain_count()]
    }

    /// Number of particles that forces move.
    pub fn grain_count(&self) -> usize {
        self.0.partition_point(|disc| disc.kind == ParticleKind::Grain)
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// True if there are no particles.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Positions in single precision (length).
    pub fn positions(&self) -> Vec<[f32; 3]> {
        self.0.iter().map(|particle| particle.position.map(|x| x as f32)).collect()
    }

    /// CRC-32 of the bits of positions, velocities and spins, sorted by id: equal states have equal checksums.
    pub fn checksum(&self) -> String {
        let mut discs: Vec<_> = self.0.iter().collect();
        discs.sort_by_key(|disc| disc.id);
        Particles::checksum_in_order(discs.into_iter().copied())
    }

    /// Checksum of particles that come in the order of their ids.
    pub(crate) fn checksum_in_order(discs: impl Iterator<Item = Particle>) -> String {
        let mut hasher = crc32fast::Hasher::new();
        for disc in discs {
            // Depth counts only where it is not 0, so a planar state keeps the checksum of its plane.
            let depth = [disc.position[2], disc.velocity[2]];
            let depth = depth.into_iter().filter(|_| depth != [0.0; 2]);
            let planar = disc.planar_position().into_iter().chain(disc.planar_velocity()).chain([disc.omega]);
            planar.chain(depth).for_each(|number| hasher.update(&number.to_bits().to_le_bytes()));
        }
        format!("{:08x}", hasher.finalize())
    }

    /// Smallest and largest radius, wall discs included; none without particles.
    pub fn radii(&self) -> Option<[f64; 2]> {
        let radii = || self.0.iter().map(|disc| disc.radius);
        Some([radii().reduce(f64::min)?, radii().reduce(f64::max)?])
    }
}

/// Planar positions and velocities of a scene's grains, in their order at the start. Made for frequent sampling.
#[derive(Clone, Debug)]
pub struct GrainStates {
    ids: Vec<u32>,
    /// Index of each id; empty if ids are far larger than the number of grains.
    numbers: Vec<u32>,
    rows: Vec<[f64; 4]>,
}

impl GrainStates {
    /// Reserves memory for these grains; all are lost until stored.
    pub fn of(grains: &[Particle]) -> GrainStates {
        let ids: Vec<u32> = grains.iter().map(|grain| grain.id).collect();
        let largest = ids.iter().max().map_or(0, |&id| id as usize);
        let mut numbers = vec![];
        if largest < 8 * ids.len() {
            numbers = vec![u32::MAX; largest + 1];
            ids.iter().zip(0..).for_each(|(&id, number)| numbers[id as usize] = number);
        }
        GrainStates { rows: vec![[f64::NAN; 4]; ids.len()], ids, numbers }
    }

    /// Memory for a number of grains (bytes).
    pub const fn bytes(grains: usize) -> usize {
        grains * (size_of::<[f64; 4]>() + 2 * size_of::<u32>())
    }

    /// Position (length) and velocity (length/time) of each grain; NaN where the grain is lost.
    pub fn rows(&self) -> &[[f64; 4]] {
        &self.rows
    }

    /// Marks all grains as lost.
    pub fn mark_all_lost(&mut self) {
        self.rows.fill([f64::NAN; 4]);
    }

    /// Stores position and velocity of a grain by its index in the scene's order; indices beyond the grains are ignored.
    #[inline]
    pub(crate) fn store_state(&mut self, number: usize, [x, y]: [f64; 2], [vx, vy]: [f64; 2]) {
        if let Some(row) = self.rows.get_mut(number) {
            *row = [x, y, vx, vy];
        }
    }

    /// Stores the grains among some particles, by id; missing grains are lost.
    pub fn store_grains(&mut self, particles: &Particles) {
        self.mark_all_lost();
        for (at, grain) in particles.grains().iter().enumerate() {
            // Grains are mostly in the order of the scene.
            let number = match self.ids.get(at) == Some(&grain.id) {
                true => Some(at),
                false => self.number(grain.id),
            };
            if let Some(number) = number {
                self.store_state(number, grain.planar_position(), grain.planar_velocity());
            }
        }
    }

    /// Adds the periods that each particle has crossed to its position: whole sides (length). `images` is in the scene's order, or in the order of
    /// `left` where particles are lost.
    pub(crate) fn unfold(&mut self, sides: [f64; 2], images: &[[i32; 2]], left: Option<&Particles>) {
        for (at, image) in images.iter().enumerate() {
            let number = match left {
                None => Some(at),
                Some(left) => left.all().get(at).and_then(|particle| self.number(particle.id)),
            };
            if let Some(row) = number.and_then(|number| self.rows.get_mut(number)) {
                (0..2).for_each(|axis| row[axis] += f64::from(image[axis]) * sides[axis]);
            }
        }
    }

    fn number(&self, id: u32) -> Option<usize> {
        let number = match self.numbers.is_empty() {
            true => self.ids.iter().position(|&it| it == id),
            false => self.numbers.get(id as usize).map(|&number| number as usize),
        };
        number.filter(|&number| number < self.ids.len())
    }
}

/// Data of each particle in its present state. A new output of this kind is one function here, with a default for methods that provide nothing
/// better.
pub trait PerParticle {
    /// Particles, with positions inside the box.
    fn particles(&self) -> Particles;

    /// True as long as all particles can be reached. False after a rank is lost: results requested since then must not be used.
    fn is_whole(&self) -> bool {
        true
    }

    /// Checksum of [`particles`](Self::particles).
    fn checksum(&self) -> String {
        self.particles().checksum()
    }

    /// Stores planar positions and velocities of the grains, with positions inside the box.
    fn states(&self, states: &mut GrainStates) {
        states.store_grains(&self.particles());
    }

    /// Positions in single precision, one for each particle of the start in its order; NaN where a particle is lost.
    fn positions(&self) -> Vec<[f32; 3]> {
        self.particles().positions()
    }

    /// Periods that each particle has crossed along x and y since the start, in the order of [`particles`](Self::particles). Empty if they are not
    /// counted along every periodic side.
    fn images(&self) -> Vec<[i32; 2]> {
        vec![]
    }
}

/// Longest displacement of a disc in a step (length) such that no contact deeper than a fraction `max_penetration` of the sum of the radii is
/// missed between two steps. No radius is below `smallest_radius` (length).
///
/// Two discs that pass each other on parallel lines at the distance (1 − p) s, with s the sum of their radii, overlap along the path 2 s √(1 − (1 −
/// p)²). Each of them may move half of it.
pub(crate) fn longest_step(smallest_radius: f64, max_penetration: f64) -> f64 {
    let closest = 1.0 - max_penetration;
    2.0 * smallest_radius * (1.0 - closest * closest).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two discs that pass each other just deep enough, each by the longest step, touch before and after it.
    #[test]
    fn longest_displacement_just_misses_the_contact() {
        let (radius, depth) = (0.5, 0.1);
        let step = longest_step(radius, depth);
        let apart = (1.0 - depth) * 2.0 * radius;
        // Their relative displacement is twice the step along lines that far apart, half of it before they are closest.
        assert!((step.hypot(apart) - 2.0 * radius).abs() < 1e-12, "{step}");
    }
}
