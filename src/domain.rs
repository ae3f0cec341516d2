//! The box that particles live in.

/// A rectangle, each pair of sides periodic or closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Lower left corner (length).
    pub origin: [f64; 2],
    /// Sides (length).
    pub sides: [f64; 2],
    /// Which sides are periodic.
    pub periodic: [bool; 2],
}

impl Domain {
    /// From `from` to `to`, across periodic sides where that is shorter (length).
    pub fn displacement(&self, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let way = to[axis] - from[axis];
            let side = self.sides[axis];
            if self.periodic[axis] && way.abs() > 0.5 * side {
                way - (way / side).round() * side
            } else {
                way
            }
        })
    }

    /// A position moved by periods into the box.
    pub fn inside(&self, position: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let from_low = position[axis] - self.origin[axis];
            if self.periodic[axis] && !(0.0..self.sides[axis]).contains(&from_low) {
                self.origin[axis] + from_low.rem_euclid(self.sides[axis])
            } else {
                position[axis]
            }
        })
    }

    /// Whether a position lies inside, or on the rim.
    pub fn contains(&self, position: [f64; 2]) -> bool {
        (0..2).all(|axis| {
            let from_low = position[axis] - self.origin[axis];
            from_low >= 0.0 && from_low <= self.sides[axis]
        })
    }
}
