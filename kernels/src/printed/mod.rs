//! BP93's own program: Index, Test and contact_i as lattice vectors, products by 0 and 1 instead of branches, Gear's scheme with
//! unscaled derivatives. There is one file per part of the step, and each line is next to its equation. Sections of a listing
//! ([`EQUATIONS`]) and arrays ([`ARRAYS`]) are named by equations of the paper.
//!
//! Two of its lines, equations (4) to (6):
//!
//! ```text
//! let [dx, dy] = env.displacement(own.position, partner); // (5), (6)
//! let distance = (dx * dx + dy * dy).sqrt();            // (4)
//! ```
//!
//! # As printed
//! Only the parts of the paper that cannot work as printed are corrected; each correction is documented where it is made:
//!
//! - (10), (11) use another tangent than (13), (14) adds a vector to a number and feeds energy in, (15) bounds one side of a
//!   signed number, (16) gives the spins opposite signs, appendix A multiplies the coefficients by the acceleration and not by
//!   its difference from the predicted one. These are the misprints of [`granular`](crate::law::granular), corrected as there.
//! - (14) raises R_i + R_j − |r_i − r_j| to the power 3/2, which has no value where discs do not touch: the power is taken of
//!   contact_i times that ([`Printed`]).
//! - (2) gives an empty cell the particle number 0. The paper does not define x(0): see below.
//!
//! Steps without an equation in the paper are in [`additions`]: wrapping of positions in a periodic box, images in a halo, the check
//! that no disc was lost. They are counted separately.
//!
//! # Contents of an empty cell
//! Index is 0 there, so x, y, R, M, … of an empty cell are those of a "particle 0". Read literally, all empty cells have one
//! position: two of them have dist = 0, (10) to (12) divide by it, and 1/0 · 0 is NaN. Possible readings:
//!
//! | position of an empty cell | two empty cells | here (IEEE) | on a CRAY |
//! |---|---|---|---|
//! | that of particle 0, for all | 0/0 in their own sums, which no disc reads | the discs' forces are right | has no infinity and no NaN: the quotient is out of range, which interrupts the program unless it has disabled that |
//! | that of particle 0, and a disc is there too | 1/0 · 0 in the disc's own sums | that disc's forces are NaN | as above, and the disc's forces are wrong |
//! | that of its last disc (nothing clears x) | as particle 0 until discs have come and gone | right by luck | as above at the start |
//! | its own, x(0) + (1 − Test)·far | finite | right | right: nothing is out of range |
//!
//! [`PrintedMap`] implements the last: three more operations on the lattice, exact, and the only reading that runs unchanged on a CRAY.
//! `kernels/tests/printed.rs` demonstrates the others.

pub mod additions;
mod corrector;
mod forces;
mod index;
mod lattice;
mod predictor;

pub use corrector::PrintedCorrector;
pub use forces::Printed;
pub use index::{PrintedClear, PrintedEnter};
pub use lattice::PrintedMap;
pub use predictor::PrintedPredictor;

use crate::isa::Array;

/// Sections of the kernels, each with its equation.
pub const EQUATIONS: &[(&str, &str)] = &[
    ("(1)", "r'' = F/m"),
    ("gravity", "gravity's part of F in (1)"),
    ("(2)", "Index: the number of the disc in each cell"),
    ("i of (2)", "cells are numbered from 1, behind a halo: i ∈ [1, LMAX]"),
    ("way back", "the cell of each disc, kept for step 5"),
    ("(3)", "Test: 1 where there is a disc"),
    ("step 3", "Index maps the discs' observables to lattice vectors"),
    ("step 5", "Index maps the sums back to the discs"),
    ("(4)", "dist_i"),
    ("(5), (6)", "Δx_i, Δy_i, by shifted vectors"),
    ("(7)", "contact_i"),
    ("(8)", "Test · Test{i} · contact_i · F_n"),
    ("(9)", "Test · Test{i} · contact_i · F_s"),
    ("(10)", "F_x"),
    ("(11)", "F_y"),
    ("(12)", "the torque"),
    ("sums", "the left sides of (10) to (12), stored"),
    ("(14)", "F_n between two discs"),
    ("(15)", "F_s between two discs"),
    ("(16)", "v_rel"),
    ("(17)", "M_eff"),
    ("A 1", "Taylor expansion over a step"),
    ("A 3", "correction of every derivative"),
];

/// Arrays of the kernels, each with its name in the paper.
pub const ARRAYS: &[(Array, &str)] = &[
    (Array::X0, "x of the discs (A 1)"),
    (Array::X1, "x' (A 1)"),
    (Array::X2, "x'' (A 1)"),
    (Array::X3, "x''' (A 1)"),
    (Array::X4, "fourth derivative of x (A 1)"),
    (Array::X5, "fifth derivative of x (A 1)"),
    (Array::Y0, "y of the discs (A 1)"),
    (Array::Y1, "y' (A 1)"),
    (Array::Y2, "y'' (A 1)"),
    (Array::Y3, "y''' (A 1)"),
    (Array::Y4, "fourth derivative of y (A 1)"),
    (Array::Y5, "fifth derivative of y (A 1)"),
    (Array::Phi0, "Ω, the angle (16)"),
    (Array::Phi1, "Ω' (16)"),
    (Array::Phi2, "Ω'' (A 1)"),
    (Array::Phi3, "Ω''' (A 1)"),
    (Array::Phi4, "fourth derivative of Ω (A 1)"),
    (Array::Phi5, "fifth derivative of Ω (A 1)"),
    (Array::DiscRadius, "R of the discs (13)"),
    (Array::DiscMass, "M of the discs (17)"),
    (Array::DiscInverseMass, "1/m of the discs (1)"),
    (Array::DiscInverseInertia, "(1) for the rotation: 1/I of the discs"),
    (Array::DiscCell, "the inverse of Index: the cell of each disc (2)"),
    (Array::Index, "Index (2)"),
    (Array::Test, "Test (3)"),
    (Array::FarX, "x of an empty cell: corrected, see Contents of an empty cell"),
    (Array::ImageX, "the periodically continued region (section 2)"),
    (Array::ImageY, "the periodically continued region (section 2)"),
    (Array::X, "x (5)"),
    (Array::Y, "y (6)"),
    (Array::Vx, "x' (14)"),
    (Array::Vy, "y' (14)"),
    (Array::Omega, "Ω' (16)"),
    (Array::Radius, "R (13)"),
    (Array::Mass, "M (17)"),
    (Array::Fx, "F_x (10)"),
    (Array::Fy, "F_y (11)"),
    (Array::Torque, "M, the torque (12)"),
];

/// Mass of a fixed disc (mass) among grains of at most `largest`: a power of two so large that M_i M/(M_i + M) of (17) is M_i to
/// the last bit.
pub fn mass_of_fixed_disc(largest: f64) -> f64 {
    (largest.log2().ceil() + 60.0).exp2()
}
