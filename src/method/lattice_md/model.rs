//! What is modelled: no more than a scene needs.

use crate::domain::Domain;
use stripmine_kernels::integrator::gear::{Acceleration, Inertia};
use stripmine_kernels::law::granular::{Contact, Disc};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::{Coordinates, Frame, LatticeShape};

/// How many derivatives Gear's scheme carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GearValues {
    /// Third order; the most stable with damping.
    Four,
    /// Fourth order.
    Five,
    /// Fifth order.
    Six,
}

impl GearValues {
    /// All schemes.
    pub const ALL: [GearValues; 3] = [GearValues::Four, GearValues::Five, GearValues::Six];

    /// The number of values.
    pub const fn count(self) -> usize {
        match self {
            GearValues::Four => 4,
            GearValues::Five => 5,
            GearValues::Six => 6,
        }
    }
}

/// How motion follows from forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Gear's predictor–corrector.
    Gear(GearValues),
    /// Velocity Verlet.
    VelocityVerlet,
}

impl Scheme {
    /// Scaled derivatives of a degree of freedom: position, velocity, acceleration and what is carried beyond.
    pub const fn values(self) -> usize {
        match self {
            Scheme::Gear(values) => values.count(),
            Scheme::VelocityVerlet => 3,
        }
    }
}

/// Whether discs differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Discs {
    /// All alike: radius, mass and inertia are numbers, not vectors.
    Equal {
        /// Radius and inverse mass.
        disc: Disc,
        /// Inverse moment of inertia.
        inverse_inertia: f64,
    },
    /// Each its own. Wall discs are always others than grains: nothing moves them.
    Varying,
}

/// Which contacts are too deep; penetrations are fractions of the sum of the radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch {
    /// Deeper ones are counted.
    pub max_penetration: f64,
    /// Deeper ones stop the run.
    pub stop_penetration: f64,
    /// The smallest radius (length), of walls too.
    pub smallest_radius: f64,
}

impl Watch {
    /// Penetration (length) that no pair passes whose fraction is at most `max_penetration`: what programs look for, so
    /// that only what they find need be held against the pair's own radii.
    pub fn depth(&self) -> f64 {
        // Less by more than single precision rounds.
        2.0 * self.max_penetration * self.smallest_radius * (1.0 - 1e-6)
    }
}

/// What is modelled, on which lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The lattice.
    pub shape: LatticeShape,
    /// Where it lies.
    pub frame: Frame,
    /// The neighbourhood, met from both sides.
    pub mask: Mask,
    /// What positions on the lattice are measured from.
    pub coordinates: Coordinates,
    /// The contact law's parameters.
    pub contact: Contact,
    /// Whether there is friction, and with it rotation, torque and spin.
    pub friction: bool,
    /// Whether discs differ.
    pub discs: Discs,
    /// Moment of inertia of a disc of mass and radius 1: ½ for a disc, ⅖ for a sphere.
    pub inertia_factor: f64,
    /// The integrator.
    pub scheme: Scheme,
    /// Time step (time).
    pub dt: f64,
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
    /// The checks of a run; without, the programs are those of the source.
    pub watch: Option<Watch>,
}

impl Model {
    /// Degrees of freedom of a disc.
    pub fn freedoms(&self) -> usize {
        if self.friction { 3 } else { 2 }
    }

    /// Whether a damping makes the accelerations depend on velocities.
    pub fn acceleration(&self) -> Acceleration {
        let Contact { normal_damping, shear_damping, .. } = self.contact;
        let damped = normal_damping != 0.0 || (self.friction && shear_damping != 0.0);
        if damped { Acceleration::OfVelocities } else { Acceleration::OfPositions }
    }

    /// The box that the lattice fills.
    pub fn domain(&self) -> Domain {
        let counts = [self.shape.columns(), self.shape.rows()];
        Domain {
            origin: self.frame.origin,
            sides: [0, 1].map(|axis| counts[axis] as f64 * self.frame.edge[axis]),
            periodic: self.shape.periodic(),
        }
    }

    /// What forces and torques are divided by.
    pub fn inertia(&self) -> Inertia {
        match self.discs {
            Discs::Equal { disc, inverse_inertia } => {
                Inertia::Equal { inverse_mass: disc.inverse_mass, inverse_inertia }
            }
            Discs::Varying => Inertia::Varying,
        }
    }
}
