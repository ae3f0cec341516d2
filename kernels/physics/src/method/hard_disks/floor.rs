//! Vibrating floor, and the time at which a disc meets it.

use super::fall::fall;

/// Floor at the height A (1 − cos ω t) above its lowest position, ω = 2π f. At the start it is at rest in its lowest position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Floor {
    /// A (length).
    pub amplitude: f64,
    /// f (1/time).
    pub frequency: f64,
}

impl Floor {
    fn rate(&self) -> f64 {
        std::f64::consts::TAU * self.frequency
    }

    /// Height above the lowest position at a time (length).
    pub(crate) fn height(&self, time: f64) -> f64 {
        // Portable sine and cosine: the same bits on every platform.
        self.amplitude * (1.0 - libm::cos(self.rate() * time))
    }

    /// Upward velocity at a time (length/time).
    pub(crate) fn velocity(&self, time: f64) -> f64 {
        self.amplitude * self.rate() * libm::sin(self.rate() * time)
    }

    /// Returns the delay after `time` until a disc meets the floor; infinite if it never does. The lower end of the disc is `above` the
    /// floor's lowest position (length); its velocity and acceleration point upwards.
    ///
    /// The second derivative of the gap is nowhere below −m, m = A ω² − g. The gap therefore stays open for at least as long as
    /// gap + slope h − m h²/2 does. Steps of that length never pass the first meeting and converge to it as Newton steps do. A disc
    /// above the highest position of the floor first falls to that height.
    pub(crate) fn meeting(&self, above: f64, velocity: f64, acceleration: f64, time: f64) -> f64 {
        let highest = 2.0 * self.amplitude;
        let least = (self.amplitude * self.rate().powi(2) - acceleration).max(f64::MIN_POSITIVE);
        let mut passed = 0.0;
        let is_ahead = |passed: f64, step: f64| time + (passed + step) > time + passed;
        loop {
            let here = above + passed * (velocity + 0.5 * acceleration * passed);
            let speed = velocity + acceleration * passed;
            if here > highest {
                let falls = fall(here - highest, -speed, -acceleration);
                // A disc above the highest position only by rounding is treated as at that height.
                if is_ahead(passed, falls) {
                    passed += falls;
                    if passed == f64::INFINITY {
                        return passed;
                    }
                    continue;
                }
            }
            let gap = (here - self.height(time + passed)).max(0.0);
            let slope = speed - self.velocity(time + passed);
            let root = (slope * slope + 2.0 * least * gap).sqrt();
            let opens = if slope > 0.0 { (slope + root) / least } else { 2.0 * gap / (root - slope) };
            // NaN if the gap is zero and neither opens nor closes.
            if !is_ahead(passed, opens) {
                return passed;
            }
            passed += opens;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: Floor = Floor { amplitude: 0.5, frequency: 0.5 };

    /// First time at which the gap is closed, found with small steps.
    fn searched(floor: &Floor, above: f64, velocity: f64, acceleration: f64, time: f64) -> f64 {
        let gap = |s: f64| above + s * (velocity + 0.5 * acceleration * s) - floor.height(time + s);
        let step = 1e-5;
        // Start where the gap is open.
        let begin = (1..1_000_000).find(|&i| gap(f64::from(i) * step) > 1e-9).unwrap();
        f64::from((begin..3_000_000).find(|&i| gap(f64::from(i) * step) <= 0.0).unwrap()) * step
    }

    #[test]
    fn the_first_meeting_is_found() {
        for (above, velocity, acceleration, time) in [
            (2.0, 0.0, -1.0, 0.0),
            (0.9, 0.0, -1.0, 0.7),
            (0.9, 0.05, -0.1, 1.7),
            (0.3, -4.0, -1.0, 0.1),
            (5.0, -0.2, 0.0, 2.0),
            (0.95, 3.0, -9.81, 5.0),
        ] {
            let found = FLOOR.meeting(above, velocity, acceleration, time);
            let near = searched(&FLOOR, above, velocity, acceleration, time);
            assert!((found - near).abs() < 2e-5, "{above} {velocity}: {found} and {near}");
        }
    }

    /// A disc thrown off the floor meets it again later, not at once.
    #[test]
    fn a_disc_that_leaves_the_floor_comes_back() {
        for start in [0.2, 0.5, 0.9, 1.4, 2.0] {
            let (above, thrown) = (FLOOR.height(start), FLOOR.velocity(start) + 0.4);
            let found = FLOOR.meeting(above, thrown, -1.0, start);
            let near = searched(&FLOOR, above, thrown, -1.0, start);
            assert!((found - near).abs() < 2e-5 && found > 0.05, "{start}: {found} and {near}");
        }
    }

    #[test]
    fn escaping_discs_miss_and_resting_discs_touch() {
        assert_eq!(FLOOR.meeting(3.0, 1.0, 0.0, 0.0), f64::INFINITY);
        assert_eq!(FLOOR.meeting(0.0, -1.0, -1.0, 0.0), 0.0);
    }
}
