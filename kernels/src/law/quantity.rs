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
pub enum Field {
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
pub enum Sum {
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

impl Field {
    /// Every field.
    pub const ALL: [Field; 8] = [
        Field::Velocity(Axis::X),
        Field::Velocity(Axis::Y),
        Field::Velocity(Axis::Z),
        Field::Omega,
        Field::Radius,
        Field::InverseMass,
        Field::Mass,
        Field::Occupied,
    ];
    /// Every field in two dimensions.
    pub const PLANAR: [Field; 7] = [
        Field::Velocity(Axis::X),
        Field::Velocity(Axis::Y),
        Field::Omega,
        Field::Radius,
        Field::InverseMass,
        Field::Mass,
        Field::Occupied,
    ];

    /// True if particles have this field in a number of dimensions.
    #[inline(always)]
    pub const fn is_in(self, dimensions: usize) -> bool {
        match self {
            Field::Velocity(axis) => (axis as usize) < dimensions,
            Field::Omega | Field::Occupied => dimensions == 2,
            Field::Radius | Field::InverseMass | Field::Mass => true,
        }
    }

    /// Name in error messages.
    #[inline]
    pub const fn name(self) -> &'static str {
        match self {
            Field::Velocity(Axis::X) => "the velocity along x",
            Field::Velocity(Axis::Y) => "the velocity along y",
            Field::Velocity(Axis::Z) => "the velocity along z",
            Field::Omega => "the angular velocity",
            Field::Radius => "the radius",
            Field::InverseMass => "the inverse mass",
            Field::Mass => "the mass",
            Field::Occupied => "the occupation of its cell",
        }
    }
}

impl Sum {
    /// Every sum.
    pub const ALL: [Sum; 7] = [
        Sum::Force(Axis::X),
        Sum::Force(Axis::Y),
        Sum::Force(Axis::Z),
        Sum::Torque,
        Sum::ForceRate(Axis::X),
        Sum::ForceRate(Axis::Y),
        Sum::ForceRate(Axis::Z),
    ];
    /// Every sum in two dimensions, in the order of their [columns](Self::column).
    pub const PLANAR: [Sum; 3] = [Sum::Force(Axis::X), Sum::Force(Axis::Y), Sum::Torque];

    /// True if particles have this sum in a number of dimensions.
    #[inline(always)]
    pub const fn is_in(self, dimensions: usize) -> bool {
        match self {
            Sum::Force(axis) => (axis as usize) < dimensions,
            Sum::Torque => dimensions == 2,
            Sum::ForceRate(_) => dimensions == 3,
        }
    }

    /// Number of the column in `DIM` dimensions: the forces axis by axis, then the torque or, in space, the rates of the forces.
    #[inline(always)]
    pub const fn column<const DIM: usize>(self) -> usize {
        match self {
            Sum::Force(axis) => axis as usize,
            Sum::Torque => DIM,
            Sum::ForceRate(axis) => DIM + axis as usize,
        }
    }

    /// Name in error messages.
    #[inline]
    pub const fn name(self) -> &'static str {
        match self {
            Sum::Force(Axis::X) => "the force along x",
            Sum::Force(Axis::Y) => "the force along y",
            Sum::Force(Axis::Z) => "the force along z",
            Sum::Torque => "the torque",
            Sum::ForceRate(Axis::X) => "the rate of the force along x",
            Sum::ForceRate(Axis::Y) => "the rate of the force along y",
            Sum::ForceRate(Axis::Z) => "the rate of the force along z",
        }
    }
}
