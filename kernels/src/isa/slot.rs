//! Names of the arrays of a kernel.

use super::element::Storage;
use std::marker::PhantomData;

/// Name of an array of `T` in a kernel's memory.
///
/// A slot is a number and a label; the memory of a run binds it to a slice.
pub struct Slot<T> {
    array: Array,
    element: PhantomData<fn() -> T>,
}

impl<T> Clone for Slot<T> {
    #[inline]
    fn clone(&self) -> Self {
        *self
    }
}
impl<T> Copy for Slot<T> {}

impl<T: Storage> Slot<T> {
    /// The slot of `array` with elements of type `T`.
    #[inline(always)]
    pub const fn new(array: Array) -> Self {
        Slot { array, element: PhantomData }
    }

    /// Array that the slot names.
    #[inline(always)]
    pub const fn array(self) -> Array {
        self.array
    }
}

macro_rules! define_arrays {
    ($(($variant:ident, $label:literal, $doc:literal)),* $(,)?) => {
        /// Every array that a kernel may name.
        ///
        /// Lengths: *discs* (NP) or *cells* (the swept lattice with its halo before and behind).
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Array {
            $(#[doc = $doc] $variant,)*
        }

        impl Array {
            /// Every array, in the order of the list.
            pub const ALL: &'static [Array] = &[$(Array::$variant),*];

            /// Label in listings and errors.
            #[inline]
            pub const fn label(self) -> &'static str {
                match self { $(Array::$variant => $label),* }
            }
        }
    };
}

define_arrays! {
    (X0, "x0", "discs: position along x"),
    (X1, "x1", "discs: first derivative of x, as the scheme scales it"),
    (X2, "x2", "discs: second derivative of x, as the scheme scales it"),
    (X3, "x3", "discs: third derivative of x, as the scheme scales it"),
    (X4, "x4", "discs: fourth derivative of x, as the scheme scales it"),
    (X5, "x5", "discs: fifth derivative of x, as the scheme scales it"),
    (Y0, "y0", "discs: position along y"),
    (Y1, "y1", "discs: first derivative of y, as the scheme scales it"),
    (Y2, "y2", "discs: second derivative of y, as the scheme scales it"),
    (Y3, "y3", "discs: third derivative of y, as the scheme scales it"),
    (Y4, "y4", "discs: fourth derivative of y, as the scheme scales it"),
    (Y5, "y5", "discs: fifth derivative of y, as the scheme scales it"),
    (Phi0, "phi0", "discs: angle"),
    (Phi1, "phi1", "discs: first derivative of the angle, as the scheme scales it"),
    (Phi2, "phi2", "discs: second derivative of the angle, as the scheme scales it"),
    (Phi3, "phi3", "discs: third derivative of the angle, as the scheme scales it"),
    (Phi4, "phi4", "discs: fourth derivative of the angle, as the scheme scales it"),
    (Phi5, "phi5", "discs: fifth derivative of the angle, as the scheme scales it"),
    (DiscX, "disc.x", "discs: x in the lattice's coordinates, absolute or relative to the cell"),
    (DiscY, "disc.y", "discs: y in the lattice's coordinates, absolute or relative to the cell"),
    (DiscVx, "disc.vx", "discs: velocity along x"),
    (DiscVy, "disc.vy", "discs: velocity along y"),
    (DiscOmega, "disc.omega", "discs: angular velocity"),
    (DiscRadius, "disc.radius", "discs: radius"),
    (DiscMass, "disc.M", "discs: mass; for a fixed disc so large that the effective mass of a pair is the other disc's"),
    (DiscInverseMass, "disc.1/m", "discs: inverse mass, 0 for a fixed disc"),
    (DiscInverseInertia, "disc.1/I", "discs: inverse moment of inertia, 0 for a fixed disc"),
    (DiscCell, "disc.cell", "discs: number of the cell, from 1; 0 is none"),
    (Index, "Index", "cells: number of the disc, from 1; 0 is none (BP93 (2))"),
    (Test, "Test", "cells: 1 if there is a disc, 0 otherwise (BP93 (3))"),
    (HaloCell, "halo.cell", "halo: number of a halo cell"),
    (HaloSource, "halo.source", "halo: number of the cell whose image it is"),
    (FarX, "far.x", "cells: the x of an empty cell, far from everything"),
    (ImageX, "image.x", "cells: displacement of an image along x"),
    (ImageY, "image.y", "cells: displacement of an image along y"),
    (Interior, "interior", "cells: 1 where discs may be, 0 in the halo"),
    (X, "x", "cells: position along x"),
    (Y, "y", "cells: position along y"),
    (Vx, "vx", "cells: velocity along x"),
    (Vy, "vy", "cells: velocity along y"),
    (Omega, "omega", "cells: angular velocity"),
    (Radius, "radius", "cells: radius"),
    (Mass, "M", "cells: mass"),
    (InverseMass, "1/m", "cells: inverse mass"),
    (Fx, "Fx", "cells: force along x"),
    (Fy, "Fy", "cells: force along y"),
    (Torque, "torque", "cells: torque"),
    (Deepest, "deepest", "cells: penetration (length) of the deepest contact"),
    (Power, "power", "cells: the disc's share of the power its contacts dissipate (energy/time)"),
    (Energy, "energy", "cells: the disc's share of the energy its contacts store (energy)"),
    (Virial, "virial", "cells: the disc's share of its contacts' virial (energy)"),
    (Table0, "law.0", "law: first column of its table, a row for each number from 1"),
    (Table1, "law.1", "law: second column of its table"),
    (Table2, "law.2", "law: third column of its table"),
    (Table3, "law.3", "law: fourth column of its table"),
    (WallCell, "wall.cell", "walls: number of the cell of an element"),
    (WallX, "wall.x", "walls: x of a point of the element, in the lattice's coordinates"),
    (WallY, "wall.y", "walls: y of a point of the element, in the lattice's coordinates"),
    (WallAlongX, "wall.along.x", "walls: x of the unit vector along the segment, 0 for a corner"),
    (WallAlongY, "wall.along.y", "walls: y of the unit vector along the segment, 0 for a corner"),
    (WallGateX, "wall.gate.x", "walls: x of the vector of the first gate"),
    (WallGateY, "wall.gate.y", "walls: y of the vector of the first gate"),
    (WallOtherGateX, "wall.other.x", "walls: x of the vector of the second gate"),
    (WallOtherGateY, "wall.other.y", "walls: y of the vector of the second gate"),
    (WallLimit, "wall.limit", "walls: limit of the first gate, below which the element counts (length)"),
    (WallOtherLimit, "wall.other.limit", "walls: limit of the second gate (length)"),
    (WallVx, "wall.vx", "walls: velocity along x"),
    (WallVy, "wall.vy", "walls: velocity along y"),
    (WallNormalDamping, "wall.gamma.n", "walls: normal damping"),
    (WallShearDamping, "wall.gamma.s", "walls: tangential damping"),
    (WallFriction, "wall.mu", "walls: friction coefficient"),
    (BodyX, "body.x", "bodies, twice over: position along x"),
    (BodyY, "body.y", "bodies, twice over: position along y"),
    (BodyZ, "body.z", "bodies, twice over: position along z"),
    (BodyRestX, "body.x rest", "bodies, twice over: rounding residue of the position along x in single precision"),
    (BodyRestY, "body.y rest", "bodies, twice over: rounding residue of the position along y in single precision"),
    (BodyRestZ, "body.z rest", "bodies, twice over: rounding residue of the position along z in single precision"),
    (BodyVx, "body.vx", "bodies, twice over: velocity along x"),
    (BodyVy, "body.vy", "bodies, twice over: velocity along y"),
    (BodyVz, "body.vz", "bodies, twice over: velocity along z"),
    (BodyMass, "body.m", "bodies, twice over: mass"),
    (BodyFx, "body.Fx", "bodies: force along x"),
    (BodyFy, "body.Fy", "bodies: force along y"),
    (BodyFz, "body.Fz", "bodies: force along z"),
    (BodyRateX, "body.dFx", "bodies: rate of the force along x"),
    (BodyRateY, "body.dFy", "bodies: rate of the force along y"),
    (BodyRateZ, "body.dFz", "bodies: rate of the force along z"),
    (Own0, "own.0", "array 0 of a kernel with names of its own"),
    (Own1, "own.1", "array 1 of a kernel with names of its own"),
    (Own2, "own.2", "array 2 of a kernel with names of its own"),
    (Own3, "own.3", "array 3 of a kernel with names of its own"),
    (Own4, "own.4", "array 4 of a kernel with names of its own"),
    (Own5, "own.5", "array 5 of a kernel with names of its own"),
    (Own6, "own.6", "array 6 of a kernel with names of its own"),
    (Own7, "own.7", "array 7 of a kernel with names of its own"),
    (Own8, "own.8", "array 8 of a kernel with names of its own"),
    (Own9, "own.9", "array 9 of a kernel with names of its own"),
    (Own10, "own.10", "array 10 of a kernel with names of its own"),
    (Own11, "own.11", "array 11 of a kernel with names of its own"),
    (Own12, "own.12", "array 12 of a kernel with names of its own"),
    (Own13, "own.13", "array 13 of a kernel with names of its own"),
    (Own14, "own.14", "array 14 of a kernel with names of its own"),
    (Own15, "own.15", "array 15 of a kernel with names of its own"),
}

impl Array {
    /// Number of arrays with names of a kernel's own; they are the last of the list.
    pub const OWN: usize = 16;

    /// Array with a name of a kernel's own, by its number from 0; none beyond [`Array::OWN`].
    pub(crate) fn own(number: usize) -> Option<Array> {
        let first = Array::Own0 as usize;
        Array::ALL[first..].get(number).copied()
    }

    /// Number of an array with a name of a kernel's own.
    pub(crate) fn own_number(self) -> Option<usize> {
        (self as usize).checked_sub(Array::Own0 as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_arrays_are_the_last_of_the_list() {
        for number in 0..Array::OWN {
            let array = Array::own(number).unwrap();
            assert_eq!(array.own_number(), Some(number));
            assert_eq!(array.label(), format!("own.{number}"));
        }
        assert_eq!(Array::own(Array::OWN), None);
        assert_eq!(Array::BodyRateZ.own_number(), None);
    }
}
