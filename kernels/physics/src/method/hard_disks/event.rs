//! Box, flight and collision rules of hard discs, independent of how events are found.

use super::fall::fall;
use super::floor::Floor;
use crate::domain::{BoxSide, Domain};
use crate::observe::conserved_axes;
use stripmine_kernels::flight::{FlyingDisc, RadiusGrowth, Space};
use stripmine_kernels::noise::{RandomPurpose, normals};

/// Collision law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CollisionLaw {
    /// Restitution of two discs: ratio of the relative normal speeds after and before the collision.
    pub restitution: f64,
    /// Restitution at walls.
    pub(crate) wall_restitution: f64,
    /// Collisions sooner than this after another event of either disc are elastic (time): TC model of Luding and McNamara.
    pub contact_duration: f64,
    /// Thermal side, if any.
    pub(crate) thermal: Option<ThermalWall>,
    /// Motion of the floor, the lower end of the second side; none if it is at rest.
    pub floor: Option<Floor>,
}

impl CollisionLaw {
    /// Elastic collisions and reflecting sides.
    pub(crate) const ELASTIC: CollisionLaw = CollisionLaw {
        restitution: 1.0,
        wall_restitution: 1.0,
        contact_duration: 0.0,
        thermal: None,
        floor: None,
    };
}

/// Thermal wall, which re-emits discs with velocities of its own temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ThermalWall {
    /// Axis of the side; true for the upper one.
    pub side: (usize, bool),
    /// Temperature kT (energy).
    pub temperature: f64,
    /// Seed of its velocities.
    pub seed: u64,
}

/// Result of a collision of two discs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DiscCollision {
    /// Impulse given to the disc with the smaller number (mass · length/time).
    pub impulse: [f64; 2],
    /// Contribution to the virial: impulse times the distance of the centres (mass · length²/time).
    pub virial: f64,
    /// Kinetic energy lost (energy): (1 − e²) of the energy of the approach.
    pub loss: f64,
    /// True if the contact duration made it elastic.
    pub(crate) was_made_elastic: bool,
}

/// Effect of a side on a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WallBounce {
    /// Magnitude of the momentum given (mass · length/time).
    pub(crate) thrust: f64,
    /// Energy given; negative if taken.
    pub work: f64,
}

/// Box of the discs with gravity and the collision law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arena {
    /// The box.
    pub domain: Domain,
    /// Periods, gravity and growth of free flight.
    pub(crate) space: Space,
    /// Collision law.
    pub law: CollisionLaw,
    /// True if the kinetic energy is constant: no gravity, and no collision and no side changes the energy.
    pub(crate) keeps_kinetic: bool,
}

impl Arena {
    /// Creates the arena of a box, with an acceleration of all discs (length/time²).
    pub(crate) fn new(domain: Domain, gravity: [f64; 2], law: CollisionLaw) -> Arena {
        let period = |axis: usize| match domain.sides[axis] {
            BoxSide::Periodic(period) => Some(period),
            _ => None,
        };
        let keeps_kinetic = gravity == [0.0; 2]
            && law.restitution == 1.0
            && law.wall_restitution == 1.0
            && law.thermal.is_none()
            && law.floor.is_none();
        Arena { domain, space: Space::new([0, 1].map(period), gravity), law, keeps_kinetic }
    }

    /// Returns the arena with another gravity (length/time²); the discs do not grow.
    pub(crate) fn with_gravity(self, gravity: [f64; 2]) -> Arena {
        Arena::new(self.domain, gravity, self.law)
    }

    /// Returns the arena with growing discs.
    pub(crate) fn growing(self, growth: RadiusGrowth) -> Arena {
        Arena { space: self.space.growing(growth), ..self }
    }

    /// Radius of a disc at a time (length), and its rate of growth (length/time).
    #[inline]
    fn radius(&self, disc: &FlyingDisc, time: f64) -> [f64; 2] {
        match self.space.growth() {
            None => [disc.radius, 0.0],
            Some(growth) => [disc.radius * growth.scale(time), disc.radius * growth.rate],
        }
    }

    /// Position of a disc at a time, inside the box along periodic sides (length).
    #[inline(always)]
    pub(crate) fn position_at(&self, disc: &FlyingDisc, time: f64) -> [f64; 2] {
        self.domain.wrapped(disc.at(&self.space, time))
    }

    /// Action of a disc's flight from its last event to a time: ∫ m v² dt (energy · time), twice the time integral of its kinetic energy.
    #[inline]
    pub(crate) fn action(&self, disc: &FlyingDisc, time: f64) -> f64 {
        let flown = time - disc.time;
        let [u, v] = disc.velocity;
        let mean_square = match self.space.gravity() {
            None => u * u + v * v,
            Some([gx, gy]) => u * u + v * v + flown * (u * gx + v * gy + flown * (gx * gx + gy * gy) / 3.0),
        };
        disc.mass * mean_square * flown
    }

    /// Potential energy of a disc at a time (energy), zero at the lower corner of the box.
    pub(crate) fn potential(&self, disc: &FlyingDisc, time: f64) -> f64 {
        let Some(gravity) = self.space.gravity() else { return 0.0 };
        let place = self.position_at(disc, time);
        let [along_x, along_y] = [0, 1].map(|axis| gravity[axis] * (place[axis] - self.domain.origin[axis]));
        -disc.mass * (along_x + along_y)
    }

    /// Axes along which the momentum is conserved: the periodic ones, unless a thermal side draws new velocities.
    pub(crate) fn conserved_axes(&self) -> [bool; 2] {
        match self.law.thermal {
            None => conserved_axes(&self.domain),
            Some(_) => [false; 2],
        }
    }

    /// Advances a disc to the time of its event.
    #[inline(always)]
    fn advance(&self, disc: &mut FlyingDisc, time: f64) {
        let (position, velocity) = (self.position_at(disc, time), disc.velocity_at(&self.space, time));
        (disc.position, disc.velocity, disc.time) = (position, velocity, time);
        disc.events += 1;
    }

    /// True if an event of a disc follows its last one so soon that it is elastic.
    #[inline(always)]
    fn is_too_soon(&self, disc: &FlyingDisc, time: f64) -> bool {
        disc.events > 0 && time - disc.time < self.law.contact_duration
    }

    /// Time at which a disc meets a closed side, and the axis; infinite if no side is ahead.
    #[inline(always)]
    pub(crate) fn wall(&self, disc: &FlyingDisc) -> (f64, usize) {
        let along = |axis: usize| match self.domain.sides[axis] {
            BoxSide::Closed(side) => self.wall_along(disc, axis, Some(side)),
            // An open side is closed below.
            BoxSide::Open => self.wall_along(disc, axis, None),
            BoxSide::Periodic(_) | BoxSide::Flat => f64::INFINITY,
        };
        let [x, y] = [along(0), along(1)];
        if y < x { (y, 1) } else { (x, 0) }
    }

    /// Time at which a disc meets an end of a side: the low end, or the high end if the side has a length.
    fn wall_along(&self, disc: &FlyingDisc, axis: usize, side: Option<f64>) -> f64 {
        let (low, v) = (self.domain.origin[axis], disc.velocity[axis]);
        let g = self.space.gravity().map_or(0.0, |gravity| gravity[axis]);
        let [radius, swelling] = self.radius(disc, disc.time);
        let above = (disc.position[axis] - radius - low).max(0.0);
        let below = side.map(|side| (low + side - radius - disc.position[axis]).max(0.0));
        let to_low = match self.floor(axis) {
            Some(floor) => floor.meeting(above, v, g, disc.time),
            None => fall(above, swelling - v, -g),
        };
        let to_high = below.map_or(f64::INFINITY, |below| fall(below, swelling + v, g));
        disc.time + to_low.min(to_high)
    }

    /// Motion of the lower end of a side.
    fn floor(&self, axis: usize) -> Option<Floor> {
        self.law.floor.filter(|_| axis == 1)
    }

    /// Collides two discs; `a` has the smaller number.
    #[inline(always)]
    pub(crate) fn collide(&self, a: &mut FlyingDisc, b: &mut FlyingDisc, time: f64) -> DiscCollision {
        let CollisionLaw { restitution, .. } = self.law;
        let was_made_elastic = restitution < 1.0 && (self.is_too_soon(a, time) || self.is_too_soon(b, time));
        let restitution = if was_made_elastic { 1.0 } else { restitution };
        self.advance(a, time);
        self.advance(b, time);
        let [dx, dy] = self.domain.displacement(a.position, b.position);
        // The unnormalised line of centres needs no root, and no rounded direction heats or cools the discs.
        let square = dx * dx + dy * dy;
        let closing = (b.velocity[0] - a.velocity[0]) * dx + (b.velocity[1] - a.velocity[1]) * dy;
        let closing = match self.space.growth() {
            None => closing,
            // Closing speed of the growing surfaces.
            Some(growth) => closing - (a.radius + b.radius) * growth.rate * square.sqrt(),
        };
        // Equal masses cancel, so that no division waits for another.
        let is_equal = a.mass == b.mass;
        let effective = if is_equal { 0.5 } else { a.mass * b.mass / (a.mass + b.mass) };
        let virial = ((-1.0 - restitution) * effective * closing).max(0.0);
        let impulse = virial / square;
        let (of_a, of_b, unit) = match is_equal {
            true => (impulse, impulse, a.mass),
            false => (impulse / a.mass, impulse / b.mass, 1.0),
        };
        let (virial, impulse) = (unit * virial, unit * impulse);
        a.velocity = [a.velocity[0] - of_a * dx, a.velocity[1] - of_a * dy];
        b.velocity = [b.velocity[0] + of_b * dx, b.velocity[1] + of_b * dy];
        let loss = -0.5 * (1.0 - restitution) * closing * impulse;
        DiscCollision { impulse: [-impulse * dx, -impulse * dy], virial, loss, was_made_elastic }
    }

    /// Reflects a disc from a closed side across an axis, or re-emits it from a thermal side; `number` is the disc's.
    pub(crate) fn rebound(&self, disc: &mut FlyingDisc, number: u32, axis: usize, time: f64) -> WallBounce {
        let too_soon = self.is_too_soon(disc, time);
        self.advance(disc, time);
        let before = disc.velocity;
        let v = before[axis];
        // A disc flies outwards at both ends of a side; one at rest under gravity lies on the side it is drawn to. A growing disc,
        // or one hit by the floor, may fly inwards, but is near one of the ends.
        let [_, swelling] = self.radius(disc, time);
        let g = self.space.gravity().map_or(0.0, |gravity| gravity[axis]);
        let middle = self.domain.origin[axis] + 0.5 * self.domain.length(axis);
        let floor = self.floor(axis);
        let is_high = if swelling > 0.0 || floor.is_some() {
            disc.position[axis] > middle
        } else {
            v > 0.0 || v == 0.0 && g > 0.0
        };
        match self.law.thermal {
            Some(thermal) if thermal.side == (axis, is_high) => {
                let [across, along] = thermal.velocity(disc, number);
                disc.velocity[axis] = if is_high { -across } else { across };
                disc.velocity[1 - axis] = along;
            }
            _ => {
                let restitution = if too_soon { 1.0 } else { self.law.wall_restitution };
                let inwards = match floor {
                    Some(floor) if !is_high => floor.velocity(time),
                    _ if is_high => -swelling,
                    _ => swelling,
                };
                disc.velocity[axis] = inwards - restitution * (v - inwards);
            }
        }
        // Twice the gain of kinetic energy over the mass, as a product: exactly zero if a velocity is only reversed.
        let gain = |axis: usize| (disc.velocity[axis] - before[axis]) * (disc.velocity[axis] + before[axis]);
        WallBounce {
            thrust: disc.mass * (disc.velocity[axis] - v).abs(),
            work: 0.5 * disc.mass * (gain(0) + gain(1)),
        }
    }
}

impl ThermalWall {
    /// Draws a velocity, normal and tangential to the wall, from the flux of a gas at its temperature. It is a function of the seed,
    /// the number of the disc and its event count.
    fn velocity(&self, disc: &FlyingDisc, number: u32) -> [f64; 2] {
        let draw = |which: u64| normals(self.seed, RandomPurpose::Wall, number, 2 * disc.events + which);
        let ([a, b], [along, _]) = (draw(0), draw(1));
        let thermal = (self.temperature / disc.mass).sqrt();
        [thermal * (a * a + b * b).sqrt(), thermal * along]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::flight::collision_time;

    fn disc(position: [f64; 2], velocity: [f64; 2]) -> FlyingDisc {
        FlyingDisc { position, velocity, time: 0.0, radius: 0.5, mass: 1.0, events: 0 }
    }

    fn periodic(law: CollisionLaw) -> Arena {
        Arena::new(Domain::planar([0.0; 2], [20.0; 2], [true; 2]), [0.0; 2], law)
    }

    /// Energy and momentum are conserved; e < 1 takes (1 − e²) of the energy of the approach.
    #[test]
    fn collisions_conserve_momentum_and_balance_energy() {
        let start = [
            disc([5.0, 5.0], [1.0, 0.2]),
            FlyingDisc { mass: 3.0, radius: 0.7, ..disc([8.0, 5.5], [-1.0, 0.1]) },
        ];
        let energy = |discs: &[FlyingDisc; 2]| -> f64 {
            discs.iter().map(|it| 0.5 * it.mass * it.velocity.iter().map(|v| v * v).sum::<f64>()).sum()
        };
        let momentum = |discs: &[FlyingDisc; 2], axis: usize| -> f64 {
            discs.iter().map(|it| it.mass * it.velocity[axis]).sum()
        };
        for restitution in [1.0, 0.5] {
            let arena = periodic(CollisionLaw { restitution, ..CollisionLaw::ELASTIC });
            let when = |[a, b]: &[FlyingDisc; 2]| collision_time(&arena.space, a, b, 0.0, f64::INFINITY);
            let mut after = start;
            let time = when(&start);
            let [a, b] = &mut after;
            let impact = arena.collide(a, b, time);
            assert!((0..2).all(|axis| (momentum(&after, axis) - momentum(&start, axis)).abs() < 1e-15));
            // Along the line of centres.
            let [p, q] = [0, 1].map(|which: usize| start[which].at(&arena.space, time));
            let [dx, dy] = arena.domain.displacement(p, q);
            let distance = dx.hypot(dy);
            assert!((distance - 1.2).abs() < 1e-14, "{distance}");
            let approach = ((start[1].velocity[0] - start[0].velocity[0]) * dx
                + (start[1].velocity[1] - start[0].velocity[1]) * dy)
                / distance;
            let taken = 0.5 * 0.75 * approach * approach * (1.0 - restitution * restitution);
            assert!((energy(&start) - energy(&after) - taken).abs() < 1e-14);
            assert!((impact.loss - taken).abs() < 1e-14);
            assert!((impact.virial - (1.0 + restitution) * 0.75 * -approach * 1.2).abs() < 1e-14);
            assert_eq!(when(&after), f64::INFINITY);
        }
    }

    /// Calculated by hand: mass 2, thrown with (1, 2) under g = 1, after 3: 2 ∫ 1 + (2 − s)² ds = 2 (3 + (8 + 1)/3); the height is 5 + 6 − 4.5.
    #[test]
    fn flights_have_known_action_and_potential() {
        let domain = Domain::planar([0.0, 1.0], [20.0; 2], [true, false]);
        let arena = Arena::new(domain, [0.0, -1.0], CollisionLaw::ELASTIC);
        let thrown = FlyingDisc { mass: 2.0, ..disc([5.0, 5.0], [1.0, 2.0]) };
        assert!((arena.action(&thrown, 3.0) - 12.0).abs() < 1e-14);
        assert_eq!(arena.potential(&thrown, 3.0), 2.0 * (6.5 - 1.0));
        let straight = periodic(CollisionLaw { restitution: 0.5, ..CollisionLaw::ELASTIC });
        assert_eq!(straight.action(&thrown, 3.0), 2.0 * 5.0 * 3.0);
        assert!(
            !arena.keeps_kinetic && !straight.keeps_kinetic && periodic(CollisionLaw::ELASTIC).keeps_kinetic
        );
    }

    #[test]
    fn contact_duration_makes_frequent_collisions_elastic() {
        let arena =
            periodic(CollisionLaw { restitution: 0.5, contact_duration: 0.1, ..CollisionLaw::ELASTIC });
        let made = |before: f64, events: u64| {
            let mut a = FlyingDisc { time: -before, events, ..disc([5.0 - before, 5.0], [1.0, 0.0]) };
            let mut b = disc([6.0, 5.0], [-1.0, 0.0]);
            arena.collide(&mut a, &mut b, 0.0).was_made_elastic
        };
        assert!(made(0.05, 3) && !made(0.2, 3) && !made(0.05, 0));
    }

    #[test]
    fn walls_reflect_discs() {
        let domain = Domain::planar([1.0, 0.0], [10.0, 10.0], [false, true]);
        let arena =
            Arena::new(domain, [0.0; 2], CollisionLaw { wall_restitution: 0.5, ..CollisionLaw::ELASTIC });
        let mut flying = disc([3.0, 5.0], [-0.5, 7.0]);
        assert_eq!(arena.wall(&flying), (3.0, 0));
        arena.rebound(&mut flying, 0, 0, 3.0);
        assert_eq!((flying.velocity, flying.position, flying.time), ([0.25, 7.0], [1.5, 6.0], 3.0));
        assert_eq!(arena.wall(&flying), (3.0 + 9.0 / 0.25, 0));
        assert_eq!(arena.wall(&disc([3.0, 5.0], [0.0, 1.0])).0, f64::INFINITY);
    }

    /// A disc thrown up returns to the floor with its initial speed; one that is fast enough meets the ceiling.
    #[test]
    fn discs_fall_on_the_floor() {
        let domain = Domain::planar([0.0; 2], [10.0, 10.0], [true, false]);
        let arena = Arena::new(domain, [0.0, -2.0], CollisionLaw::ELASTIC);
        let mut thrown = disc([5.0, 0.5], [0.0, 3.0]);
        assert_eq!(arena.wall(&thrown), (3.0, 1));
        arena.rebound(&mut thrown, 0, 1, 3.0);
        assert_eq!((thrown.position[1], thrown.velocity[1], arena.wall(&thrown).0), (0.5, 3.0, 6.0));
        // A speed of 6 just reaches a height of 9, after 3.
        assert_eq!(arena.wall(&disc([5.0, 0.5], [0.0, 6.0])), (3.0, 1));
        assert!((arena.wall(&disc([5.0, 2.5], [0.0, -1.0])).0 - 1.0).abs() < 1e-15);
        // A disc at rest on the floor meets it at once, again and again, as in a collapse.
        assert_eq!(arena.wall(&disc([5.0, 0.5], [1.0, 0.0])).0, 0.0);
    }

    /// The normal velocity off a thermal wall has a mean square of 2 kT/m, the tangential one of kT/m.
    #[test]
    fn thermal_walls_emit_at_their_temperature() {
        let thermal = ThermalWall { side: (1, false), temperature: 3.0, seed: 5 };
        let domain = Domain::planar([0.0; 2], [10.0, 10.0], [true, false]);
        let arena =
            Arena::new(domain, [0.0; 2], CollisionLaw { thermal: Some(thermal), ..CollisionLaw::ELASTIC });
        let samples = 20_000;
        let mut squares = [0.0; 2];
        for number in 0..samples {
            let mut falling = FlyingDisc { mass: 2.0, ..disc([5.0, 0.5], [0.0, -1.0]) };
            arena.rebound(&mut falling, number, 1, 0.0);
            assert!(falling.velocity[1] > 0.0);
            (0..2).for_each(|axis| squares[axis] += falling.velocity[axis].powi(2) / f64::from(samples));
            let mut rising = disc([5.0, 9.5], [0.0, 1.0]);
            arena.rebound(&mut rising, number, 1, 0.0);
            assert_eq!(rising.velocity, [0.0, -1.0]);
        }
        assert!(
            (squares[0] / 1.5 - 1.0).abs() < 0.05 && (squares[1] / 3.0 - 1.0).abs() < 0.05,
            "{squares:?}"
        );
    }
}
