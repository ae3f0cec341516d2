//! Discs in free flight, and when and how they collide. Nothing here knows how events are found.
//!
//! The arithmetic is canonical: a disc's position, velocity and local time change at its own events only, and the time of a
//! pair's event depends on nothing but the states of both. So every way to find events gives the same ones, to the bit.

use crate::domain::{Domain, Side};

/// A disc, as it was after its last event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Centre at its local time, inside the box along periodic sides (length).
    pub position: [f64; 2],
    /// Velocity (length/time).
    pub velocity: [f64; 2],
    /// Its local time: that of its last event.
    pub time: f64,
    /// Radius (length).
    pub radius: f64,
    /// Mass (mass).
    pub mass: f64,
    /// When it last met a disc; minus infinity if it never did.
    pub met: f64,
}

impl Disc {
    /// Where it is at a time, as if nothing happened until then; beyond periodic sides too.
    #[inline(always)]
    pub fn at(&self, time: f64) -> [f64; 2] {
        let flown = time - self.time;
        [self.position[0] + flown * self.velocity[0], self.position[1] + flown * self.velocity[1]]
    }

    /// Its speed (length/time).
    pub fn speed(&self) -> f64 {
        (self.velocity[0] * self.velocity[0] + self.velocity[1] * self.velocity[1]).sqrt()
    }

    /// Brings it to a time.
    fn advance(&mut self, time: f64, domain: &Domain) {
        self.position = domain.wrapped(self.at(time));
        self.time = time;
    }
}

/// What collisions do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// Restitution of two discs: relative normal speed after over that before.
    pub restitution: f64,
    /// Restitution at walls.
    pub wall_restitution: f64,
    /// A collision sooner than this after another one of either disc is elastic (time): the TC model of Luding and McNamara.
    pub contact_duration: f64,
}

/// What a collision was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Impulse times the distance of the centres (mass · length²/time): what it adds to the virial.
    pub virial: f64,
    /// Whether it was made elastic because another one was so short a time ago.
    pub was_made_elastic: bool,
}

/// When two discs meet that have not met up to `now` (time); infinite if they do not, or if it is clear at once that they do not
/// before the `horizon` (time). Of the images across periodic sides those meet that are the nearest now; the time follows from
/// the later of the local times on, and so does not depend on when it is asked for. `a` is the one with the smaller number.
#[inline(always)]
pub fn meeting(domain: &Domain, a: &Disc, b: &Disc, now: f64, horizon: f64) -> f64 {
    let from = a.time.max(b.time);
    let ([ax, ay], [bx, by]) = (a.at(from), b.at(from));
    let [u, v] = [b.velocity[0] - a.velocity[0], b.velocity[1] - a.velocity[1]];
    let dx = nearest(domain.sides[0], bx - ax, (now - from) * u);
    let dy = nearest(domain.sides[1], by - ay, (now - from) * v);
    let approach = dx * u + dy * v;
    // Most pairs move apart.
    if approach >= 0.0 {
        return f64::INFINITY;
    }
    let reach = a.radius + b.radius;
    // Discs that rounding has brought into each other meet at once.
    let apart = (dx * dx + dy * dy - reach * reach).max(0.0);
    // The root below is no larger than the approach.
    if apart > -2.0 * approach * (horizon - from) {
        return f64::INFINITY;
    }
    let speed = u * u + v * v;
    let discriminant = approach * approach - speed * apart;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    from + apart / (discriminant.sqrt() - approach)
}

/// The way to that image of a disc that is nearest after it has moved on by `moved` (length).
#[inline(always)]
fn nearest(side: Side, way: f64, moved: f64) -> f64 {
    match side {
        Side::Periodic(side) if (way + moved).abs() > 0.5 * side => {
            way - ((way + moved) / side).round() * side
        }
        _ => way,
    }
}

/// When a disc meets a closed side, and along which axis; infinite where there is none ahead.
pub fn wall(domain: &Domain, disc: &Disc) -> (f64, usize) {
    let along = |axis: usize| {
        let Side::Closed(side) = domain.sides[axis] else { return f64::INFINITY };
        let (low, v) = (domain.origin[axis], disc.velocity[axis]);
        let way = match v {
            v if v > 0.0 => low + side - disc.radius - disc.position[axis],
            v if v < 0.0 => low + disc.radius - disc.position[axis],
            _ => return f64::INFINITY,
        };
        disc.time + (way / v).max(0.0)
    };
    let [x, y] = [along(0), along(1)];
    if y < x { (y, 1) } else { (x, 0) }
}

/// Two discs collide; `a` is the one with the smaller number.
pub fn collide(domain: &Domain, law: &Law, a: &mut Disc, b: &mut Disc, time: f64) -> Impact {
    a.advance(time, domain);
    b.advance(time, domain);
    let [dx, dy] = domain.displacement(a.position, b.position);
    let distance = (dx * dx + dy * dy).sqrt();
    let [nx, ny] = [dx / distance, dy / distance];
    let separation = (b.velocity[0] - a.velocity[0]) * nx + (b.velocity[1] - a.velocity[1]) * ny;
    let was_made_elastic = law.restitution < 1.0 && time - a.met.max(b.met) < law.contact_duration;
    let restitution = if was_made_elastic { 1.0 } else { law.restitution };
    let effective = a.mass * b.mass / (a.mass + b.mass);
    let impulse = ((-1.0 - restitution) * effective * separation).max(0.0);
    let [of_a, of_b] = [impulse / a.mass, impulse / b.mass];
    a.velocity = [a.velocity[0] - of_a * nx, a.velocity[1] - of_a * ny];
    b.velocity = [b.velocity[0] + of_b * nx, b.velocity[1] + of_b * ny];
    (a.met, b.met) = (time, time);
    Impact { virial: impulse * distance, was_made_elastic }
}

/// A disc is thrown back by a closed side across an axis.
pub fn rebound(domain: &Domain, law: &Law, disc: &mut Disc, axis: usize, time: f64) {
    disc.advance(time, domain);
    disc.velocity[axis] *= -law.wall_restitution;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(position: [f64; 2], velocity: [f64; 2]) -> Disc {
        Disc { position, velocity, time: 0.0, radius: 0.5, mass: 1.0, met: f64::NEG_INFINITY }
    }

    fn when(domain: &Domain, a: &Disc, b: &Disc) -> f64 {
        meeting(domain, a, b, 0.0, f64::INFINITY)
    }

    const LAW: Law = Law { restitution: 1.0, wall_restitution: 1.0, contact_duration: 0.0 };

    /// By hand: head on, at half a radius off the line of centres, and past each other.
    #[test]
    fn pairs_meet_where_they_touch() {
        let domain = Domain::planar([0.0; 2], [20.0; 2], [true; 2]);
        let still = disc([5.0, 5.0], [0.0; 2]);
        assert_eq!(when(&domain, &still, &disc([8.0, 5.0], [-2.0, 0.0])), 1.0);
        let off = when(&domain, &still, &disc([8.0, 5.5], [-1.0, 0.0]));
        assert!((off - (3.0 - 0.75f64.sqrt())).abs() < 1e-15, "{off}");
        assert_eq!(when(&domain, &still, &disc([8.0, 6.1], [-1.0, 0.0])), f64::INFINITY);
        assert_eq!(when(&domain, &still, &disc([8.0, 5.0], [1.0, 0.0])), f64::INFINITY);
        // Two are left out where the horizon is clearly nearer.
        let before = |horizon: f64| meeting(&domain, &still, &disc([8.0, 5.0], [-2.0, 0.0]), 0.0, horizon);
        assert_eq!([before(1.0), before(0.3)], [1.0, f64::INFINITY]);
        // Across a periodic side.
        assert_eq!(when(&domain, &disc([1.0, 5.0], [0.0; 2]), &disc([18.0, 5.0], [1.0, 0.0])), 2.0);
    }

    /// Two discs that part meet again on the other side of the box.
    #[test]
    fn the_nearest_image_is_that_of_now() {
        let domain = Domain::planar([0.0; 2], [20.0; 2], [true; 2]);
        let (a, b) = (disc([9.0, 5.0], [-1.0, 0.0]), disc([11.0, 5.0], [1.0, 0.0]));
        let at = |now: f64| meeting(&domain, &a, &b, now, f64::INFINITY);
        assert_eq!([at(0.0), at(5.0), at(8.0)], [f64::INFINITY, 8.5, 8.5]);
    }

    /// Energy and momentum stay; what e < 1 takes is (1 − e²) of the energy of the approach.
    #[test]
    fn a_collision_keeps_what_it_must() {
        let domain = Domain::planar([0.0; 2], [20.0; 2], [true; 2]);
        let start =
            [disc([5.0, 5.0], [1.0, 0.2]), Disc { mass: 3.0, radius: 0.7, ..disc([8.0, 5.5], [-1.0, 0.1]) }];
        let energy = |discs: &[Disc; 2]| -> f64 {
            discs.iter().map(|it| 0.5 * it.mass * it.velocity.iter().map(|v| v * v).sum::<f64>()).sum()
        };
        let momentum = |discs: &[Disc; 2], axis: usize| -> f64 {
            discs.iter().map(|it| it.mass * it.velocity[axis]).sum()
        };
        for restitution in [1.0, 0.5] {
            let mut after = start;
            let time = when(&domain, &start[0], &start[1]);
            let [a, b] = &mut after;
            let impact = collide(&domain, &Law { restitution, ..LAW }, a, b, time);
            assert!((0..2).all(|axis| (momentum(&after, axis) - momentum(&start, axis)).abs() < 1e-15));
            // Along the line of centres.
            let [dx, dy] = domain.displacement(start[0].at(time), start[1].at(time));
            let distance = dx.hypot(dy);
            assert!((distance - 1.2).abs() < 1e-14, "{distance}");
            let approach = ((start[1].velocity[0] - start[0].velocity[0]) * dx
                + (start[1].velocity[1] - start[0].velocity[1]) * dy)
                / distance;
            let taken = 0.5 * 0.75 * approach * approach * (1.0 - restitution * restitution);
            assert!((energy(&start) - energy(&after) - taken).abs() < 1e-14);
            assert!((impact.virial - (1.0 + restitution) * 0.75 * -approach * 1.2).abs() < 1e-14);
            assert_eq!(when(&domain, &after[0], &after[1]), f64::INFINITY);
        }
    }

    #[test]
    fn collisions_too_soon_after_others_are_elastic_where_asked() {
        let domain = Domain::planar([0.0; 2], [20.0; 2], [true; 2]);
        let law = Law { restitution: 0.5, contact_duration: 0.1, ..LAW };
        let made = |met: f64| {
            let mut a = Disc { met, ..disc([5.0, 5.0], [1.0, 0.0]) };
            let mut b = disc([6.0, 5.0], [-1.0, 0.0]);
            collide(&domain, &law, &mut a, &mut b, 0.0).was_made_elastic
        };
        assert!(made(-0.05) && !made(-0.2) && !made(f64::NEG_INFINITY));
    }

    #[test]
    fn walls_throw_back() {
        let domain = Domain::planar([1.0, 0.0], [10.0, 10.0], [false, true]);
        let law = Law { wall_restitution: 0.5, ..LAW };
        let mut flying = disc([3.0, 5.0], [-0.5, 7.0]);
        assert_eq!(wall(&domain, &flying), (3.0, 0));
        rebound(&domain, &law, &mut flying, 0, 3.0);
        assert_eq!((flying.velocity, flying.position, flying.time), ([0.25, 7.0], [1.5, 6.0], 3.0));
        assert_eq!(wall(&domain, &flying), (3.0 + 9.0 / 0.25, 0));
        assert_eq!(wall(&domain, &disc([3.0, 5.0], [0.0, 1.0])).0, f64::INFINITY);
    }
}
