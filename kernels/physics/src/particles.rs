//! Particles as a scene knows them, before a method lays them out for itself.

/// What moves a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Kind {
    /// Forces and gravity.
    #[default]
    Grain,
    /// Nothing, or the motion that the scene prescribes for its walls; of infinite mass in every contact.
    Wall,
}

/// One particle: a disc in the plane, or a body in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// A number of its own, which stays with it.
    pub id: u32,
    /// What moves it.
    pub kind: Kind,
    /// Centre (length); in the plane the third coordinate is 0.
    pub position: [f64; 3],
    /// Velocity (length/time); likewise.
    pub velocity: [f64; 3],
    /// Angle, counter-clockwise (radian).
    pub angle: f64,
    /// Angular velocity, counter-clockwise (1/time). What moves in space does not turn.
    pub omega: f64,
    /// Radius (length).
    pub radius: f64,
    /// Mass (mass); finite also for a wall disc, where it only describes the material.
    pub mass: f64,
}

/// A vector of the plane as one of space.
pub const fn in_space([x, y]: [f64; 2]) -> [f64; 3] {
    [x, y, 0.0]
}

/// The first two coordinates, all that there is in the plane.
pub(crate) const fn in_plane([x, y, _]: [f64; 3]) -> [f64; 2] {
    [x, y]
}

impl Particle {
    /// Where it is in the plane (length).
    pub const fn place(&self) -> [f64; 2] {
        in_plane(self.position)
    }

    /// How fast it moves in the plane (length/time).
    pub const fn planar_velocity(&self) -> [f64; 2] {
        in_plane(self.velocity)
    }
}

/// Particles: all grains first, then all wall discs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles(Vec<Particle>);

impl Particles {
    /// Puts grains before wall discs, otherwise in the order given.
    pub fn new(mut discs: Vec<Particle>) -> Self {
        discs.sort_by_key(|disc| disc.kind == Kind::Wall);
        Particles(discs)
    }

    /// All discs.
    pub fn all(&self) -> &[Particle] {
        &self.0
    }

    /// All discs, to be changed in all but their kind.
    pub fn all_mut(&mut self) -> &mut [Particle] {
        &mut self.0
    }

    /// The discs that forces move.
    pub fn grains(&self) -> &[Particle] {
        &self.0[..self.grain_count()]
    }

    /// How many discs forces move.
    pub fn grain_count(&self) -> usize {
        self.0.partition_point(|disc| disc.kind == Kind::Grain)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Positions in single precision (length).
    pub fn positions(&self) -> Vec<[f32; 3]> {
        self.0.iter().map(|particle| particle.position.map(|x| x as f32)).collect()
    }

    /// CRC-32 of the bits of positions, velocities and spins, by id: equal states have equal checksums.
    pub fn checksum(&self) -> String {
        let mut discs: Vec<_> = self.0.iter().collect();
        discs.sort_by_key(|disc| disc.id);
        let mut hasher = crc32fast::Hasher::new();
        for disc in discs {
            // What has no depth has the checksum of its plane.
            let depth = [disc.position[2], disc.velocity[2]];
            let depth = depth.into_iter().filter(|_| depth != [0.0; 2]);
            let planar = disc.place().into_iter().chain(disc.planar_velocity()).chain([disc.omega]);
            planar.chain(depth).for_each(|number| hasher.update(&number.to_bits().to_le_bytes()));
        }
        format!("{:08x}", hasher.finalize())
    }

    /// The smallest and the largest radius, wall discs included; none without discs.
    pub fn radii(&self) -> Option<[f64; 2]> {
        let radii = || self.0.iter().map(|disc| disc.radius);
        Some([radii().reduce(f64::min)?, radii().reduce(f64::max)?])
    }
}

/// Places and velocities in the plane of the grains of a scene, in their order at the start: what is looked at often.
#[derive(Clone, Debug)]
pub struct States {
    ids: Vec<u32>,
    /// The number of each id, where ids are not far more than grains.
    numbers: Vec<u32>,
    rows: Vec<[f64; 4]>,
}

impl States {
    /// Room for these grains, none of which is there yet.
    pub fn of(grains: &[Particle]) -> States {
        let ids: Vec<u32> = grains.iter().map(|grain| grain.id).collect();
        let largest = ids.iter().max().map_or(0, |&id| id as usize);
        let mut numbers = vec![];
        if largest < 8 * ids.len() {
            numbers = vec![u32::MAX; largest + 1];
            ids.iter().zip(0..).for_each(|(&id, number)| numbers[id as usize] = number);
        }
        States { rows: vec![[f64::NAN; 4]; ids.len()], ids, numbers }
    }

    /// Bytes for a number of grains.
    pub const fn bytes(grains: usize) -> usize {
        grains * (size_of::<[f64; 4]>() + 2 * size_of::<u32>())
    }

    /// For each grain its place (length) and velocity (length/time); not a number where it is lost.
    pub fn rows(&self) -> &[[f64; 4]] {
        &self.rows
    }

    /// None of them is there.
    pub fn forget(&mut self) {
        self.rows.fill([f64::NAN; 4]);
    }

    /// Where the grain of a number in the scene's order is, and how fast; others than grains do not count.
    #[inline]
    pub(crate) fn put(&mut self, number: usize, [x, y]: [f64; 2], [vx, vy]: [f64; 2]) {
        if let Some(row) = self.rows.get_mut(number) {
            *row = [x, y, vx, vy];
        }
    }

    /// The grains among some particles, by their ids; those that are not there are lost.
    pub fn take_up(&mut self, particles: &Particles) {
        self.forget();
        for (at, grain) in particles.grains().iter().enumerate() {
            // Grains are mostly in the order of the scene.
            let number = match self.ids.get(at) == Some(&grain.id) {
                true => Some(at),
                false => self.number(grain.id),
            };
            if let Some(number) = number {
                self.put(number, grain.place(), grain.planar_velocity());
            }
        }
    }

    /// Moves each grain by whole sides (length) to where it would be without: by the periods that particles have crossed, which are in
    /// the scene's order, or in that of `left` where some are lost.
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

/// Data of each particle as it stands. A new output of this kind is one function here, with what it is where nothing better is known,
/// and one where it is known.
pub trait PerParticle {
    /// The particles, positions inside the box.
    fn particles(&self) -> Particles;

    /// False once a part of them cannot be reached any more, for a rank is lost: nothing that was asked for since is to be used.
    fn is_whole(&self) -> bool {
        true
    }

    /// Places and velocities of the grains in the plane, places inside the box.
    fn states(&self, states: &mut States) {
        states.take_up(&self.particles());
    }

    /// Positions alone, in single precision, one for each particle of the start in its order; no numbers where one is lost.
    fn positions(&self) -> Vec<[f32; 3]> {
        self.particles().positions()
    }

    /// How many periods each particle has moved along x and y since the start, in the order of [`particles`](Self::particles); empty
    /// where that is not followed along every periodic side.
    fn images(&self) -> Vec<[i32; 2]> {
        vec![]
    }
}

/// How far discs may move in a step (length) for no contact deeper than a fraction `max_penetration` of the sum of the radii
/// to pass unseen between two steps, if no radius is below `smallest_radius` (length).
///
/// Two discs that pass each other on parallel lines at the distance (1 − p) s, s the sum of their radii, overlap along the
/// way 2 s √(1 − (1 − p)²); together they may move as far, each half of it.
pub(crate) fn longest_step(smallest_radius: f64, max_penetration: f64) -> f64 {
    let closest = 1.0 - max_penetration;
    2.0 * smallest_radius * (1.0 - closest * closest).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two discs that pass each other just deep enough, each by the longest step: apart before it and after it, no more.
    #[test]
    fn what_moves_the_longest_step_passes_by_just_unseen() {
        let (radius, depth) = (0.5, 0.1);
        let step = longest_step(radius, depth);
        let apart = (1.0 - depth) * 2.0 * radius;
        // Together they move twice the step along lines that far apart, half of it before they are nearest.
        assert!((step.hypot(apart) - 2.0 * radius).abs() < 1e-12, "{step}");
    }
}
