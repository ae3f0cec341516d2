//! Proof that no event will ever happen, for the cases in which it is possible.

use super::event::Arena;
use stripmine_kernels::flight::FlyingDisc;

/// Largest number of discs whose pairs are all checked. With more discs events are assumed possible.
const MOST: usize = 4096;
/// Relative margin of rounding between the distance of a miss and that of contact.
const ROUNDED_UP: f64 = 1.0 + 1e-9;

/// True if certainly no disc will ever meet another disc or a side. False if an event is possible or the proof fails.
pub(super) fn is_idle_forever(arena: &Arena, discs: &[FlyingDisc]) -> bool {
    if discs.iter().any(|disc| arena.wall(disc).0 < f64::INFINITY) {
        return false;
    }
    // No side is ahead, so nothing falls: discs fly straight along periodic sides or are at rest.
    if discs.windows(2).all(|pair| pair[0].velocity == pair[1].velocity) {
        return true;
    }
    let mut others = discs.iter().enumerate();
    discs.len() <= MOST
        && others.all(|(i, a)| discs[..i].iter().all(|b| is_collision_impossible(arena, a, b)))
}

/// True if two discs that fly straight along periodic sides miss each other and all images. Relative to one disc, the images of the
/// other fly on parallel lines. The distance of these lines is the greatest common measure of the sides' components across the motion.
fn is_collision_impossible(arena: &Arena, a: &FlyingDisc, b: &FlyingDisc) -> bool {
    let [u, v] = [0, 1].map(|axis| b.velocity[axis] - a.velocity[axis]);
    if [u, v] == [0.0; 2] {
        return true;
    }
    let time = a.time.max(b.time);
    let [dx, dy] = arena.domain.displacement(a.at(&arena.space, time), b.at(&arena.space, time));
    let period = |axis: usize| if arena.domain.is_periodic(axis) { arena.domain.length(axis) } else { 0.0 };
    let across = [(period(0) * v).abs(), (period(1) * u).abs()];
    if !across.iter().all(|length| length.is_finite()) {
        // Overflow: assume that they may meet.
        return false;
    }
    let lines = common_measure(across[0], across[1]);
    let off = (dx * v - dy * u).abs();
    let off = if lines > 0.0 { (off % lines).min(lines - off % lines) } else { off };
    off > (a.radius + b.radius) * u.hypot(v) * ROUNDED_UP
}

/// Greatest common measure of two numbers; 0 for two zeros. The remainder of two numbers is exact.
fn common_measure(mut a: f64, mut b: f64) -> f64 {
    while b > 0.0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::super::event::CollisionLaw;
    use super::*;
    use crate::domain::Domain;

    fn disc(position: [f64; 2], velocity: [f64; 2]) -> FlyingDisc {
        FlyingDisc { position, velocity, time: 0.0, radius: 0.5, mass: 1.0, events: 0 }
    }

    /// Calculated by hand: discs at rest, alone, side by side, passing on straight and slanted lines, and pairs that may meet.
    #[test]
    fn impossible_meetings_are_recognised() {
        let here = disc([2.0, 2.0], [0.0; 2]);
        let (open, closed) = ([true; 2], [true, false]);
        for (periodic, other, is_never) in [
            (open, disc([5.0, 5.0], [0.0; 2]), true),
            (open, disc([5.0, 3.5], [1.0, 0.0]), true),
            (open, disc([5.0, 2.9], [1.0, 0.0]), false),
            (open, disc([5.0, 3.0], [1.0, 0.0]), false),
            // Lines at 45 degrees are side/√2 apart after one period.
            (open, disc([7.0, 2.0], [1.0, 1.0]), true),
            (open, disc([3.2, 2.0], [1.0, 1.0]), false),
            // Five times as steep: the lines are denser, but not dense enough.
            (open, disc([3.0, 3.0], [1.0, 5.0]), false),
            // Almost incommensurable: the lines cover the whole box.
            (open, disc([7.0, 2.0], [1.0, 1.0 + 1e-9]), false),
            (closed, disc([5.0, 5.0], [1.0, 0.0]), true),
            (closed, disc([5.0, 5.0], [1.0, 1e-9]), false),
        ] {
            let domain = Domain::planar([0.0; 2], [10.0; 2], periodic);
            let arena = Arena::new(domain, [0.0; 2], CollisionLaw::ELASTIC);
            assert_eq!(is_idle_forever(&arena, &[here, other]), is_never, "{other:?}");
            assert!(is_idle_forever(&arena, &[disc([5.0; 2], [1.0, 0.0])]));
        }
        let falling =
            Arena::new(Domain::planar([0.0; 2], [10.0; 2], closed), [0.0, -1.0], CollisionLaw::ELASTIC);
        assert!(!is_idle_forever(&falling, &[here]));
    }
}
