//! Flight distances: the mean free path, and the time at which a disc leaves the range of its list.

use crate::method::hard_disks::event::Arena;
use stripmine_kernels::flight::FlyingDisc;

/// Mean free path (length) of `count` discs of a radius (length) in an area (length²), by Enskog's theory with Henderson's contact
/// value. In an infinite area each disc is assumed to have one square of its diameter.
pub(super) fn free_path(count: f64, radius: f64, area: f64) -> f64 {
    let density = if area.is_finite() { count / area } else { 0.25 / (radius * radius) };
    let packing = (std::f64::consts::PI * radius * radius * density).min(0.9);
    let contact_value = (1.0 - 7.0 * packing / 16.0) / (1.0 - packing).powi(2);
    1.0 / (8.0_f64.sqrt() * density * 2.0 * radius * contact_value)
}

/// Earliest time at which a disc, at its position at `now`, may be farther than `displacement_limit` from its registered position.
/// Returns infinity if that is not before its `next` event.
#[inline(always)]
pub(super) fn leaving_time(
    arena: &Arena,
    disc: &FlyingDisc,
    registered: [f64; 2],
    displacement_limit: f64,
    (now, next): (f64, f64),
) -> f64 {
    let [dx, dy] = arena.domain.displacement(registered, disc.at(&arena.space, now));
    let [u, v] = disc.velocity_at(&arena.space, now);
    let square = u * u + v * v;
    let left = displacement_limit * displacement_limit - (dx * dx + dy * dy);
    let ahead = next - now;
    let [x, y] = [dx + ahead * u, dy + ahead * v];
    match arena.space.gravity() {
        None if square == 0.0 => f64::INFINITY,
        // Within the limit at both ends of a straight path means within it throughout. This common case needs no root.
        None if x * x + y * y < displacement_limit * displacement_limit => f64::INFINITY,
        None => {
            let outwards = dx * u + dy * v;
            let root = (outwards * outwards + square * left.max(0.0)).sqrt();
            now + if outwards > 0.0 { left.max(0.0) / (outwards + root) } else { (root - outwards) / square }
        }
        // Upper bound: the disc flies and falls straight away from the registered position.
        Some([gx, gy]) => {
            let distance = (displacement_limit - (dx * dx + dy * dy).sqrt()).max(0.0);
            let root = (square + 2.0 * (gx * gx + gy * gy).sqrt() * distance).sqrt();
            now + 2.0 * distance / (square.sqrt() + root)
        }
    }
}
