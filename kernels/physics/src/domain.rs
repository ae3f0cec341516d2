//! Box of the particles.

/// Boundary of a box along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoxSide {
    /// Periodic, with its length.
    Periodic(f64),
    /// Closed: nothing may leave; with its length.
    Closed(f64),
    /// Unbounded.
    Open,
    /// Without extent: a planar scene has no depth.
    Flat,
}

impl BoxSide {
    /// Length of the side: infinite if open, 0 if flat.
    pub const fn length(self) -> f64 {
        match self {
            BoxSide::Periodic(length) | BoxSide::Closed(length) => length,
            BoxSide::Open => f64::INFINITY,
            BoxSide::Flat => 0.0,
        }
    }
}

/// Box of a scene. Planar methods read its first two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Corner with the smallest coordinates (length); coordinates of an open side are relative to it too.
    pub origin: [f64; 3],
    /// Boundary along each axis.
    pub sides: [BoxSide; 3],
}

impl Domain {
    /// Rectangle with its lower left corner and sides (length), each pair of sides periodic or closed.
    pub fn planar([x, y]: [f64; 2], sides: [f64; 2], periodic: [bool; 2]) -> Domain {
        let side = |axis: usize| match periodic[axis] {
            true => BoxSide::Periodic(sides[axis]),
            false => BoxSide::Closed(sides[axis]),
        };
        Domain { origin: [x, y, 0.0], sides: [side(0), side(1), BoxSide::Flat] }
    }

    /// Length of a side.
    pub fn length(&self, axis: usize) -> f64 {
        self.sides[axis].length()
    }

    /// True if a side is periodic.
    pub fn is_periodic(&self, axis: usize) -> bool {
        matches!(self.sides[axis], BoxSide::Periodic(_))
    }

    /// Shortest periodic side in the plane (length); infinite without periodic sides.
    pub(crate) fn shortest_period(&self) -> f64 {
        let periodic = (0..2).filter(|&axis| self.is_periodic(axis)).map(|axis| self.length(axis));
        periodic.fold(f64::INFINITY, f64::min)
    }

    /// Lower left corner of a planar box (length).
    pub fn corner(&self) -> [f64; 2] {
        [self.origin[0], self.origin[1]]
    }

    /// Sides of a planar box (length).
    pub fn lengths(&self) -> [f64; 2] {
        [self.length(0), self.length(1)]
    }

    /// Area of a planar box (length²).
    pub fn area(&self) -> f64 {
        self.length(0) * self.length(1)
    }

    /// Periodicity of the sides of a planar box.
    pub fn periodic(&self) -> [bool; 2] {
        [self.is_periodic(0), self.is_periodic(1)]
    }

    /// Vector from `from` to `to`, the shortest across periodic sides (length).
    #[inline(always)]
    pub fn displacement<const D: usize>(&self, from: [f64; D], to: [f64; D]) -> [f64; D] {
        std::array::from_fn(|axis| {
            let difference = to[axis] - from[axis];
            match self.sides[axis] {
                BoxSide::Periodic(side) if difference.abs() > 0.5 * side => {
                    difference - (difference / side).round() * side
                }
                _ => difference,
            }
        })
    }

    /// Distance of two positions, the shortest across periodic sides (length).
    pub fn distance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let [x, y] = self.displacement(a, b);
        x.hypot(y)
    }

    /// Distance of a position from a segment, the shortest across periodic sides; both are at most a period outside the box (length).
    pub(crate) fn distance_to_segment(&self, position: [f64; 2], [a, b]: &[[f64; 2]; 2]) -> f64 {
        let shifts = [0, 1].map(|axis| match self.sides[axis] {
            BoxSide::Periodic(side) => vec![-2.0 * side, -side, 0.0, side, 2.0 * side],
            _ => vec![0.0],
        });
        let mut nearest = f64::INFINITY;
        for &x in &shifts[0] {
            for &y in &shifts[1] {
                let from = [position[0] + x - a[0], position[1] + y - a[1]];
                let along = [b[0] - a[0], b[1] - a[1]];
                let square = along[0] * along[0] + along[1] * along[1];
                let share = ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0);
                nearest = nearest.min((from[0] - share * along[0]).hypot(from[1] - share * along[1]));
            }
        }
        nearest
    }

    /// Image of a position inside the box along the periodic sides.
    #[inline(always)]
    pub fn wrapped<const D: usize>(&self, position: [f64; D]) -> [f64; D] {
        std::array::from_fn(|axis| {
            let origin = self.origin[axis];
            let along = position[axis] - origin;
            let BoxSide::Periodic(side) = self.sides[axis] else { return position[axis] };
            if (0.0..side).contains(&along) {
                return position[axis];
            }
            // A remainder that rounds to a whole side becomes the origin.
            let rest = along.rem_euclid(side);
            let inside = origin + if rest < side { rest } else { 0.0 };
            if inside - origin < side { inside } else { origin }
        })
    }

    /// Number of periods between a position and its image inside the box, along each periodic side.
    pub fn periods<const D: usize>(&self, position: [f64; D]) -> [f64; D] {
        let inside = self.wrapped(position);
        std::array::from_fn(|axis| match self.sides[axis] {
            BoxSide::Periodic(side) => ((position[axis] - inside[axis]) / side).round(),
            _ => 0.0,
        })
    }

    /// True if a position is inside the box or on its boundary.
    pub fn contains<const D: usize>(&self, position: [f64; D]) -> bool {
        (0..D).all(|axis| {
            let from_low = position[axis] - self.origin[axis];
            match self.sides[axis] {
                BoxSide::Periodic(side) | BoxSide::Closed(side) => from_low >= 0.0 && from_low <= side,
                BoxSide::Open => true,
                BoxSide::Flat => from_low == 0.0,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_lie_inside_and_keep_their_distances() {
        let domain = Domain::planar([-1.0, 2.0], [0.3, 5.0], [true, false]);
        for x in [-1.0, -0.7, -0.7 - 1e-17, 12.0, -9.123, f64::from_bits((-1f64).to_bits() + 1)] {
            let image = domain.wrapped([x, 3.0]);
            assert!(image[0] - domain.origin[0] < 0.3 && domain.contains(image), "{x} becomes {image:?}");
            let [periods, none] = domain.periods([x, 3.0]);
            assert!((image[0] + 0.3 * periods - x).abs() < 1e-12 && none == 0.0, "{x}: {periods}");
            assert!(domain.distance([x, 3.0], image) < 1e-12);
        }
        assert_eq!(domain.wrapped([-1.0, 99.0]), [-1.0, 99.0]);
        assert!((domain.distance([-0.99, 3.0], [-0.71, 3.0]) - 0.02).abs() < 1e-12);
    }

    #[test]
    fn open_space_contains_everything_and_planes_are_flat() {
        let space =
            Domain { origin: [0.0; 3], sides: [BoxSide::Open, BoxSide::Periodic(2.0), BoxSide::Open] };
        assert!(space.contains([-1e300, 1.0, 7.0]) && !space.contains([0.0, 3.0, 0.0]));
        assert_eq!(space.wrapped([-5.0, 3.0, 9.0]), [-5.0, 1.0, 9.0]);
        assert_eq!(
            space
                .displacement([0.0, 0.1, 0.0], [8.0, 1.9, -3.0])
                .map(|difference| (difference * 10.0).round()),
            [80.0, -2.0, -30.0]
        );
        let plane = Domain::planar([0.0; 2], [1.0; 2], [false; 2]);
        assert!(
            plane.contains([0.5, 0.5, 0.0]) && !plane.contains([0.5, 0.5, 0.1]) && plane.length(2) == 0.0
        );
    }
}
