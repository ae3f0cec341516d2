//! Quantities of a particle that a law may read, and sums that it may add to.

/// An axis of space. A law in two dimensions has x and y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// First axis.
    X,
    /// Second axis.
    Y,
    /// Third axis.
    Z,
}

/// A quantity of a particle that a law may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParticleField {
    /// Velocity along an axis.
    Velocity(Axis),
    /// Angular velocity in the plane, counter-clockwise.
    Omega,
    /// Radius.
    Radius,
    /// Inverse mass; 0 for a fixed particle.
    InverseMass,
    /// Mass.
    Mass,
    /// 1 where there is a particle, 0 in an empty cell: BP93 (3).
    Occupied,
}

/// A sum over partners that a law adds to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParticleSum {
    /// Force along an axis.
    Force(Axis),
    /// Torque in the plane, counter-clockwise.
    Torque,
    /// Rate of change of the force along an axis, in space.
    ForceRate(Axis),
}

impl Axis {
    /// Every axis, in order.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];
}

impl ParticleField {
    /// Every field.
    pub const ALL: [ParticleField; 8] = [
        ParticleField::Velocity(Axis::X),
        ParticleField::Velocity(Axis::Y),
        ParticleField::Velocity(Axis::Z),
        ParticleField::Omega,
        ParticleField::Radius,
        ParticleField::InverseMass,
        ParticleField::Mass,
        ParticleField::Occupied,
    ];
    /// Every field in two dimensions.
    pub const PLANAR: [ParticleField; 7] = [
        ParticleField::Velocity(Axis::X),
        ParticleField::Velocity(Axis::Y),
        ParticleField::Omega,
        ParticleField::Radius,
        ParticleField::InverseMass,
        ParticleField::Mass,
        ParticleField::Occupied,
    ];

    /// True if particles have this field in a number of dimensions.
    #[inline(always)]
    pub const fn is_in(self, dimensions: usize) -> bool {
        match self {
            ParticleField::Velocity(axis) => (axis as usize) < dimensions,
            ParticleField::Omega | ParticleField::Occupied => dimensions == 2,
            ParticleField::Radius | ParticleField::InverseMass | ParticleField::Mass => true,
        }
    }

    /// Name in error messages.
    #[inline]
    pub const fn name(self) -> &'static str {
        match self {
            ParticleField::Velocity(Axis::X) => "the velocity along x",
            ParticleField::Velocity(Axis::Y) => "the velocity along y",
            ParticleField::Velocity(Axis::Z) => "the velocity along z",
            ParticleField::Omega => "the angular velocity",
            ParticleField::Radius => "the radius",
            ParticleField::InverseMass => "the inverse mass",
            ParticleField::Mass => "the mass",
            ParticleField::Occupied => "the occupation of its cell",
        }
    }
}

impl ParticleSum {
    /// Every sum.
    pub const ALL: [ParticleSum; 7] = [
        ParticleSum::Force(Axis::X),
        ParticleSum::Force(Axis::Y),
        ParticleSum::Force(Axis::Z),
        ParticleSum::Torque,
        ParticleSum::ForceRate(Axis::X),
        ParticleSum::ForceRate(Axis::Y),
        ParticleSum::ForceRate(Axis::Z),
    ];
    /// Every sum in two dimensions, in the order of their [columns](Self::column).
    pub const PLANAR: [ParticleSum; 3] =
        [ParticleSum::Force(Axis::X), ParticleSum::Force(Axis::Y), ParticleSum::Torque];

    /// True if particles have this sum in a number of dimensions.
    #[inline(always)]
    pub const fn is_in(self, dimensions: usize) -> bool {
        match self {
            ParticleSum::Force(axis) => (axis as usize) < dimensions,
            ParticleSum::Torque => dimensions == 2,
            ParticleSum::ForceRate(_) => dimensions == 3,
        }
    }

    /// Number of the column in `DIM` dimensions: the forces axis by axis, then the torque or, in space, the rates of the forces.
    #[inline(always)]
    pub const fn column<const DIM: usize>(self) -> usize {
        match self {
            ParticleSum::Force(axis) => axis as usize,
            ParticleSum::Torque => DIM,
            ParticleSum::ForceRate(axis) => DIM + axis as usize,
        }
    }

    /// Name in error messages.
    #[inline]
    pub const fn name(self) -> &'static str {
        match self {
            ParticleSum::Force(Axis::X) => "the force along x",
            ParticleSum::Force(Axis::Y) => "the force along y",
            ParticleSum::Force(Axis::Z) => "the force along z",
            ParticleSum::Torque => "the torque",
            ParticleSum::ForceRate(Axis::X) => "the rate of the force along x",
            ParticleSum::ForceRate(Axis::Y) => "the rate of the force along y",
            ParticleSum::ForceRate(Axis::Z) => "the rate of the force along z",
        }
    }
}
