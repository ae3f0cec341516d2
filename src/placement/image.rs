//! Images across periodic sides.

use crate::domain::Domain;

/// The image of a position that lies inside along the periodic sides.
pub fn wrapped(domain: &Domain, position: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let (origin, side) = (domain.origin[axis], domain.sides[axis]);
        let along = position[axis] - origin;
        if !domain.periodic[axis] || (0.0..side).contains(&along) {
            return position[axis];
        }
        // What rounds to a whole side is the origin.
        let rest = along.rem_euclid(side);
        let inside = origin + if rest < side { rest } else { 0.0 };
        if inside - origin < side { inside } else { origin }
    })
}

/// The distance of two positions, across periodic sides where that is shorter (length).
pub fn distance(domain: &Domain, a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = domain.displacement(a, b);
    x.hypot(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_lie_inside_and_keep_their_distances() {
        let domain = Domain { origin: [-1.0, 2.0], sides: [0.3, 5.0], periodic: [true, false] };
        for x in [-1.0, -0.7, -0.7 - 1e-17, 12.0, -9.123, f64::from_bits((-1f64).to_bits() + 1)] {
            let image = wrapped(&domain, [x, 3.0]);
            assert!(image[0] - domain.origin[0] < 0.3 && domain.contains(image), "{x} becomes {image:?}");
            assert!(distance(&domain, [x, 3.0], image) < 1e-12);
        }
        assert_eq!(wrapped(&domain, [-1.0, 99.0]), [-1.0, 99.0]);
        assert!((distance(&domain, [-0.99, 3.0], [-0.71, 3.0]) - 0.02).abs() < 1e-12);
    }
}
