//! How far discs fly: between collisions, and out of the surroundings that their lists were made for.

use crate::method::hard_disks::event::Arena;
use stripmine_kernels::flight::Disc;

/// The mean free path (length) of `count` discs of a radius (length) in an area (length²), by Enskog's theory with Henderson's contact
/// value; what one disc has in its square where the area is without end.
pub(super) fn free_path(count: f64, radius: f64, area: f64) -> f64 {
    let density = if area.is_finite() { count / area } else { 0.25 / (radius * radius) };
    let packing = (std::f64::consts::PI * radius * radius * density).min(0.9);
    let contact_value = (1.0 - 7.0 * packing / 16.0) / (1.0 - packing).powi(2);
    1.0 / (8.0_f64.sqrt() * density * 2.0 * radius * contact_value)
}

/// When a disc that is where it should be at `now` may be farther than `displacement_limit` from where it was registered (time); not
/// told apart, and infinite, where that is not before its `next` event.
#[inline]
pub(super) fn leaving(
    arena: &Arena,
    disc: &Disc,
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
        // Near enough at both ends of a straight way is near enough all along, and mostly so: no root is needed.
        None if x * x + y * y < displacement_limit * displacement_limit => f64::INFINITY,
        None => {
            let outwards = dx * u + dy * v;
            let root = (outwards * outwards + square * left.max(0.0)).sqrt();
            now + if outwards > 0.0 { left.max(0.0) / (outwards + root) } else { (root - outwards) / square }
        }
        // No farther than as if it flew and fell straight away from there.
        Some([gx, gy]) => {
            let way = (displacement_limit - (dx * dx + dy * dy).sqrt()).max(0.0);
            let root = (square + 2.0 * (gx * gx + gy * gy).sqrt() * way).sqrt();
            now + 2.0 * way / (square.sqrt() + root)
        }
    }
}
