//! The time of a fall: motion with a constant acceleration.

/// The time in which something passes a `way` (length, at least 0) at a speed towards its end and with an acceleration towards it;
/// infinite if it does not.
pub(super) fn fall(way: f64, speed: f64, acceleration: f64) -> f64 {
    if acceleration == 0.0 {
        return if speed > 0.0 { way / speed } else { f64::INFINITY };
    }
    let square = speed * speed + 2.0 * acceleration * way;
    if acceleration > 0.0 {
        let root = square.sqrt();
        // Of the two forms of the root that which adds numbers of one sign.
        return match speed {
            _ if speed > 0.0 => 2.0 * way / (speed + root),
            _ => (root - speed) / acceleration,
        };
    }
    if speed > 0.0 && square >= 0.0 { 2.0 * way / (speed + square.sqrt()) } else { f64::INFINITY }
}
