//! A rectangle of the plane, periodic or not.

/// A box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Lower left corner (length).
    pub origin: [f64; 2],
    /// Sides (length).
    pub sides: [f64; 2],
    /// Which sides are periodic.
    pub periodic: [bool; 2],
}

impl Area {
    /// The image of a position that lies inside along the periodic sides.
    pub fn wrapped(&self, position: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let (origin, side) = (self.origin[axis], self.sides[axis]);
            let along = position[axis] - origin;
            if !self.periodic[axis] || (0.0..side).contains(&along) {
                return position[axis];
            }
            // What rounds to a whole side is the origin.
            let rest = along.rem_euclid(side);
            let inside = origin + if rest < side { rest } else { 0.0 };
            if inside < origin + side { inside } else { origin }
        })
    }

    /// Whether a position lies inside; the upper sides are outside.
    pub fn contains(&self, position: [f64; 2]) -> bool {
        (0..2).all(|axis| {
            let end = self.origin[axis] + self.sides[axis];
            self.origin[axis] <= position[axis] && position[axis] < end
        })
    }

    /// The shortest way from one position to another, across periodic sides.
    pub fn way(&self, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let (way, side) = (to[axis] - from[axis], self.sides[axis]);
            if self.periodic[axis] { way - (way / side).round() * side } else { way }
        })
    }

    /// The distance of two positions, across periodic sides (length).
    pub fn distance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let [x, y] = self.way(a, b);
        x.hypot(y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_lie_inside_and_keep_their_distances() {
        let area = Area { origin: [-1.0, 2.0], sides: [0.3, 5.0], periodic: [true, false] };
        for x in [-1.0, -0.7, -0.7 - 1e-17, 12.0, -9.123, f64::from_bits((-1f64).to_bits() + 1)] {
            let wrapped = area.wrapped([x, 3.0]);
            assert!(area.contains(wrapped), "{x} becomes {wrapped:?}");
            assert!(area.distance([x, 3.0], wrapped) < 1e-12);
        }
        assert_eq!(area.wrapped([-1.0, 99.0]), [-1.0, 99.0]);
        assert!(!area.contains([-1.0, 99.0]));
        assert!((area.distance([-0.99, 3.0], [-0.71, 3.0]) - 0.02).abs() < 1e-12);
    }
}
