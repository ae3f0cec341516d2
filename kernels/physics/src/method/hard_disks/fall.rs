//! Fall time under a constant acceleration.

/// Returns the time to cover a `distance` (length, at least 0), with a speed and an acceleration towards its end; infinite if the
/// end is never reached.
pub(super) fn fall(distance: f64, speed: f64, acceleration: f64) -> f64 {
    if acceleration == 0.0 {
        return if speed > 0.0 { distance / speed } else { f64::INFINITY };
    }
    let square = speed * speed + 2.0 * acceleration * distance;
    if acceleration > 0.0 {
        let root = square.sqrt();
        // Form of the root that adds numbers of one sign.
        return match speed {
            _ if speed > 0.0 => 2.0 * distance / (speed + root),
            _ => (root - speed) / acceleration,
        };
    }
    if speed > 0.0 && square >= 0.0 { 2.0 * distance / (speed + square.sqrt()) } else { f64::INFINITY }
}
