//! Discs in free flight and the times of their collisions: one implementation for a pair and for a disc with all its candidates.
//!
//! The arithmetic is canonical. A disc's position, velocity and local time change only at its own events, and the time of a
//! pair's event depends only on the states of both. So every search for events gives the same ones, to the bit.

mod partners;

use crate::backend::{Registers, Scalar};
use crate::isa::{Predicate, Vector};
pub use partners::{EarliestCollision, MOST_PARTNERS, ROW_UNIT, earliest_collision};

/// State of a disc after its last event, in one cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct FlyingDisc {
    /// Centre at its local time, inside the box along periodic sides (length).
    pub position: [f64; 2],
    /// Velocity at its local time (length/time).
    pub velocity: [f64; 2],
    /// Local time: that of its last event.
    pub time: f64,
    /// Radius (length).
    pub radius: f64,
    /// Mass (mass).
    pub mass: f64,
    /// Number of events since the start.
    pub events: u64,
}

/// Space in which the discs fly: periodic sides, gravity, growth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    /// Lengths of the periodic sides along x and y (length); 0 for a non-periodic axis.
    sides: [f64; 2],
    /// Inverse lengths (1/length); 0 for a non-periodic axis.
    inverse_sides: [f64; 2],
    /// Acceleration of all discs (length/time²); `None` if they fly straight.
    gravity: Option<[f64; 2]>,
    /// Growth of the radii, if any.
    growth: Option<RadiusGrowth>,
}

/// Growth of the discs: radii are multiplied by a scale that is linear in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadiusGrowth {
    /// Scale at time 0.
    pub from: f64,
    /// Growth rate of the scale (1/time).
    pub rate: f64,
}

impl RadiusGrowth {
    /// Scale at a time.
    #[inline(always)]
    pub fn scale(&self, time: f64) -> f64 {
        self.from + self.rate * time
    }
}

impl Space {
    /// Space with the lengths of its periodic sides, `None` for a non-periodic axis (length), and an acceleration (length/time²).
    #[inline]
    pub fn new(periods: [Option<f64>; 2], gravity: [f64; 2]) -> Space {
        Space {
            sides: periods.map(|period| period.unwrap_or(0.0)),
            inverse_sides: periods.map(|period| period.map_or(0.0, |period| 1.0 / period)),
            gravity: (gravity != [0.0; 2]).then_some(gravity),
            growth: None,
        }
    }

    /// Copy of the space for growing discs.
    #[inline]
    pub fn growing(self, growth: RadiusGrowth) -> Space {
        Space { growth: Some(growth), ..self }
    }

    /// Growth of the radii, if any.
    #[inline(always)]
    pub fn growth(&self) -> Option<RadiusGrowth> {
        self.growth
    }

    /// Acceleration of all discs (length/time²).
    #[inline(always)]
    pub fn gravity(&self) -> Option<[f64; 2]> {
        self.gravity
    }
}

impl FlyingDisc {
    /// Position at a time without events until then (length); it may be beyond periodic sides.
    #[inline(always)]
    pub fn at(&self, space: &Space, time: f64) -> [f64; 2] {
        FlightState::of(self).at(Scalar::default(), space, time).0
    }

    /// Velocity at that time (length/time).
    #[inline(always)]
    pub fn velocity_at(&self, space: &Space, time: f64) -> [f64; 2] {
        FlightState::of(self).at(Scalar::default(), space, time).1
    }

    /// Speed at its local time (length/time).
    #[inline(always)]
    pub fn speed(&self) -> f64 {
        (self.velocity[0] * self.velocity[0] + self.velocity[1] * self.velocity[1]).sqrt()
    }
}

/// Quantities of a disc that determine its collisions.
#[derive(Clone, Copy)]
struct FlightState<V> {
    position: [V; 2],
    velocity: [V; 2],
    time: V,
    radius: V,
}

impl FlightState<f64> {
    #[inline(always)]
    fn of(disc: &FlyingDisc) -> Self {
        let FlyingDisc { position, velocity, time, radius, .. } = *disc;
        FlightState { position, velocity, time, radius }
    }
}

impl<V: Vector> FlightState<V> {
    /// Position and velocity at a time.
    #[inline(always)]
    fn at<R: Registers<Lane = f64, V = V>>(&self, registers: R, space: &Space, time: V) -> ([V; 2], [V; 2]) {
        let flown = time - self.time;
        let [[x, y], [u, v]] = [self.position, self.velocity];
        let Some(gravity) = space.gravity else {
            return ([x + flown * u, y + flown * v], [u, v]);
        };
        let [gx, gy] = gravity.map(|g| registers.splat(g));
        let half = registers.splat(0.5) * flown;
        let (gained_x, gained_y) = (gx * flown, gy * flown);
        let position = [x + (flown * u + half * gained_x), y + (flown * v + half * gained_y)];
        (position, [u + gained_x, v + gained_y])
    }
}

/// Time of the collision of two discs that have not collided up to `now` (time). It is infinite if they do not collide, or if
/// they clearly do not before the `horizon` (time). Across periodic sides, the images that are nearest at `now` collide. The time
/// is computed from the later of the two local times, so it depends neither on the time of the query nor on the order of the two.
#[inline(always)]
pub fn collision_time(space: &Space, a: &FlyingDisc, b: &FlyingDisc, now: f64, horizon: f64) -> f64 {
    collision_times(Scalar::default(), space, &FlightState::of(a), &FlightState::of(b), now, horizon)
}

/// Implementation of [`collision_time`] for a register of pairs.
#[inline(always)]
fn collision_times<R: Registers<Lane = f64>>(
    registers: R,
    space: &Space,
    a: &FlightState<R::V>,
    b: &FlightState<R::V>,
    now: f64,
    horizon: f64,
) -> R::V {
    let uniform = |value: f64| registers.splat(value);
    let (zero, never) = (uniform(0.0), uniform(f64::INFINITY));
    let from = a.time.max(b.time);
    let ([ax, ay], [au, av]) = a.at(registers, space, from);
    let ([bx, by], [bu, bv]) = b.at(registers, space, from);
    let [u, v] = [bu - au, bv - av];
    let ahead = uniform(now) - from;
    let (mut dx, mut dy) = (bx - ax, by - ay);
    let x = (dx + ahead * u) * uniform(space.inverse_sides[0]);
    let y = (dy + ahead * v) * uniform(space.inverse_sides[1]);
    let half = uniform(0.5);
    // Few pairs are nearer across a side. Behind a branch, the others need not wait for their correction, which is zero.
    if !registers.none(x.abs().less_than(half).and(y.abs().less_than(half)).not()) {
        let nearest = |side: f64, difference: R::V, periods: R::V| {
            // Rounds to the nearest whole number.
            let whole = (periods + periods).truncate() - periods.truncate();
            difference - whole * uniform(side)
        };
        dx = nearest(space.sides[0], dx, x);
        dy = nearest(space.sides[1], dy, y);
    }
    let (mut reach, mut approach, mut speed_squared) = (a.radius + b.radius, dx * u + dy * v, u * u + v * v);
    let mut approaches = approach.less_than(zero);
    if let Some(growth) = space.growth {
        // The contact distance grows.
        let swelling = reach * uniform(growth.rate);
        reach = reach * (uniform(growth.from) + uniform(growth.rate) * from);
        approach = approach - reach * swelling;
        speed_squared = speed_squared - swelling * swelling;
        approaches = approach.less_than(zero).not().and(zero.less_equal(speed_squared)).not();
    }
    // Most pairs move apart.
    if registers.none(approaches) {
        return never;
    }
    // Discs that overlap because of rounding collide at once.
    let apart = (dx * dx + dy * dy - reach * reach).max(zero);
    // The root below is at most the approach speed_squared; for growing discs there is no such bound.
    let soon = match space.growth {
        None => apart.less_equal(uniform(-2.0) * approach * (uniform(horizon) - from)),
        Some(_) => approaches,
    };
    let discriminant = approach * approach - speed_squared * apart;
    let meets = approaches.and(soon).and(zero.less_equal(discriminant));
    if registers.none(meets) {
        return never;
    }
    let after = apart / (discriminant.max(zero).sqrt() - approach);
    R::V::select(meets, from + after, never)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(position: [f64; 2], velocity: [f64; 2]) -> FlyingDisc {
        FlyingDisc { position, velocity, time: 0.0, radius: 0.5, mass: 1.0, events: 0 }
    }

    const PERIODIC: [Option<f64>; 2] = [Some(20.0); 2];

    fn collision_time_from_start(space: &Space, a: &FlyingDisc, b: &FlyingDisc) -> f64 {
        collision_time(space, a, b, 0.0, f64::INFINITY)
    }

    /// By hand: head on, half a radius off the line of centres, and a miss.
    #[test]
    fn pairs_collide_at_contact() {
        let space = Space::new(PERIODIC, [0.0; 2]);
        let still = disc([5.0, 5.0], [0.0; 2]);
        assert_eq!(collision_time_from_start(&space, &still, &disc([8.0, 5.0], [-2.0, 0.0])), 1.0);
        let off = collision_time_from_start(&space, &still, &disc([8.0, 5.5], [-1.0, 0.0]));
        assert!((off - (3.0 - 0.75f64.sqrt())).abs() < 1e-15, "{off}");
        assert_eq!(collision_time_from_start(&space, &still, &disc([8.0, 6.1], [-1.0, 0.0])), f64::INFINITY);
        assert_eq!(collision_time_from_start(&space, &still, &disc([8.0, 5.0], [1.0, 0.0])), f64::INFINITY);
        // The pair is omitted if the horizon is clearly nearer.
        let before =
            |horizon: f64| collision_time(&space, &still, &disc([8.0, 5.0], [-2.0, 0.0]), 0.0, horizon);
        assert_eq!([before(1.0), before(0.3)], [1.0, f64::INFINITY]);
        // Across a periodic side.
        assert_eq!(
            collision_time_from_start(&space, &disc([1.0, 5.0], [0.0; 2]), &disc([18.0, 5.0], [1.0, 0.0])),
            2.0
        );
    }

    /// Two discs that move apart collide on the other side of the box.
    #[test]
    fn the_currently_nearest_image_collides() {
        let space = Space::new(PERIODIC, [0.0; 2]);
        let (a, b) = (disc([9.0, 5.0], [-1.0, 0.0]), disc([11.0, 5.0], [1.0, 0.0]));
        let at = |now: f64| collision_time(&space, &a, &b, now, f64::INFINITY);
        assert_eq!([at(0.0), at(5.0), at(8.0)], [f64::INFINITY, 8.5, 8.5]);
    }

    /// Discs at rest collide by growing, as do discs that separate more slowly than they grow; others do not.
    #[test]
    fn growing_discs_collide_sooner() {
        let growing = |rate: f64| Space::new([None; 2], [0.0; 2]).growing(RadiusGrowth { from: 0.5, rate });
        let (a, b) = (disc([0.0; 2], [0.0; 2]), disc([1.0, 0.0], [0.0; 2]));
        assert_eq!(collision_time_from_start(&growing(0.25), &a, &b), 2.0);
        let leaving = disc([1.0, 0.0], [0.2, 0.0]);
        assert!((collision_time_from_start(&growing(0.25), &a, &leaving) - 10.0).abs() < 1e-12);
        assert_eq!(collision_time_from_start(&growing(0.15), &a, &leaving), f64::INFINITY);
        let coming = disc([1.0, 0.0], [-0.25, 0.0]);
        assert_eq!(collision_time_from_start(&growing(0.25), &a, &coming), 1.0);
    }

    /// Discs that fall together collide as without gravity, for any local times.
    #[test]
    fn gravity_changes_no_collision_time() {
        let falling = Space::new([None; 2], [0.0, -2.0]);
        let (a, b) = (disc([0.0, 9.0], [0.0, 0.0]), disc([3.0, 9.0], [-1.0, 0.0]));
        assert_eq!(collision_time_from_start(&falling, &a, &b), 2.0);
        // The same flight, from a later moment of one of the discs.
        let (position, velocity) = (b.at(&falling, 0.5), b.velocity_at(&falling, 0.5));
        let later = FlyingDisc { position, velocity, time: 0.5, ..b };
        assert!((collision_time_from_start(&falling, &a, &later) - 2.0).abs() < 1e-15);
        assert_eq!(a.at(&falling, 2.0), [0.0, 5.0]);
    }
}
