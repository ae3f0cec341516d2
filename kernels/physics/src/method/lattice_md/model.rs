//! Model of a scene: only the parts that the scene needs.

use super::options::ProgramVersion;
use crate::domain::Domain;
use crate::method::pairwise::PlaneWalls;
use crate::observe::SceneProperties;
use crate::particles::longest_step;
use crate::words::define_words;
use std::sync::Arc;
use stripmine_kernels::integrator::Inertia;
use stripmine_kernels::integrator::gear::Acceleration;
use stripmine_kernels::isa::Storage;
use stripmine_kernels::law::ObservationRequest;
use stripmine_kernels::law::granular::{Contact, EqualDiscs};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame, LatticeShape};

/// Number of derivatives in Gear's scheme.
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

    /// Number of values.
    pub const fn count(self) -> usize {
        match self {
            GearValues::Four => 4,
            GearValues::Five => 5,
            GearValues::Six => 6,
        }
    }
}

/// Integration scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GranularScheme {
    /// Gear's predictor–corrector.
    Gear(GearValues),
    /// Velocity Verlet.
    VelocityVerlet,
}

impl GranularScheme {
    /// Name in reports: `gear4`, `gear5`, `gear6` or `velocity-verlet`.
    pub fn name(self) -> &'static str {
        match self {
            GranularScheme::Gear(GearValues::Four) => "gear4",
            GranularScheme::Gear(GearValues::Five) => "gear5",
            GranularScheme::Gear(GearValues::Six) => "gear6",
            GranularScheme::VelocityVerlet => "velocity-verlet",
        }
    }

    /// Number of scaled derivatives of a degree of freedom: position, velocity, acceleration and higher ones.
    pub const fn values(self) -> usize {
        match self {
            GranularScheme::Gear(values) => values.count(),
            GranularScheme::VelocityVerlet => 3,
        }
    }
}

/// Equal or different discs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DiscUniformity {
    /// All equal: radius, mass and inertia are numbers, not vectors.
    Equal {
        /// Radius and inverse mass.
        disc: EqualDiscs,
        /// Inverse moment of inertia.
        inverse_inertia: f64,
    },
    /// Individual radii and masses. Scenes with wall discs always vary, because walls are immobile.
    Varying,
}

/// Limits of contact depths and step lengths; penetrations are fractions of the sum of the radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactWatch {
    /// Deeper contacts are counted.
    pub max_penetration: f64,
    /// Deeper contacts stop the run.
    pub stop_penetration: f64,
    /// Smallest radius (length), including walls.
    pub(crate) smallest_radius: f64,
    /// Action for a disc that moves so far in a step that a contact may be missed.
    pub(crate) on_long_step: OnLongStep,
    /// True if energy is tracked: dissipation in contacts, work of moving walls, periods that discs cross along gravity.
    pub energy: bool,
    /// True if crossed periods are counted along every axis.
    pub motion: bool,
}

define_words! {
    /// Action for a disc that moves so far in a step that contacts may be missed.
    pub(crate) enum OnLongStep {
        /// The run stops.
        Stop = "stop",
        /// The disc is counted.
        Count = "count",
    }
}

impl ContactWatch {
    /// Detects contacts that are too deep (fractions of the sum of the radii) and stops at discs that are too fast, if no radius is below
    /// `smallest_radius` (length). Tracks neither energy nor motion.
    pub fn new(max_penetration: f64, stop_penetration: f64, smallest_radius: f64) -> ContactWatch {
        let on_long_step = OnLongStep::Stop;
        let [energy, motion] = [false; 2];
        ContactWatch { max_penetration, stop_penetration, smallest_radius, on_long_step, energy, motion }
    }

    /// Penetration (length) below which no pair exceeds the fraction `max_penetration`. Programs search with it, so that only what they find is
    /// compared with the pair's own radii.
    pub fn depth(&self) -> f64 {
        // Reduced by more than single precision rounds.
        2.0 * self.max_penetration * self.smallest_radius * (1.0 - 1e-6)
    }

    /// Longest displacement of a disc in a step (length).
    pub(crate) fn longest_step(&self) -> f64 {
        longest_step(self.smallest_radius, self.max_penetration)
    }
}

/// Sides of the area that a lattice fills (length).
pub(crate) fn filled(shape: &LatticeShape, frame: &LatticeFrame) -> [f64; 2] {
    let counts = [shape.columns(), shape.rows()];
    [0, 1].map(|axis| counts[axis] as f64 * frame.edge[axis])
}

/// Sides of a box (length) in steps: along periodic sides exactly the area that the lattice fills.
pub(crate) fn sides_of(domain: &Domain, shape: &LatticeShape, frame: &LatticeFrame) -> [f64; 2] {
    let filled = filled(shape, frame);
    [0, 1].map(|axis| if domain.is_periodic(axis) { filled[axis] } else { domain.length(axis) })
}

/// Model and its lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct GranularModel {
    /// Version of the programs. Those of BP93 have friction, different discs and absolute positions, even where a scene needs none.
    pub text: ProgramVersion,
    /// The lattice.
    pub shape: LatticeShape,
    /// Origin and cell sides of the lattice.
    pub frame: LatticeFrame,
    /// Sides of the box (length). The lattice fills periodic sides exactly and may extend beyond closed ones.
    pub sides: [f64; 2],
    /// Neighbourhood, visited from both sides.
    pub mask: Mask,
    /// Origin of positions on the lattice.
    pub coordinates: Coordinates,
    /// The contact law's parameters.
    pub contact: Contact,
    /// Plane walls.
    pub walls: Arc<PlaneWalls>,
    /// Ends of the lines through which grains are counted (length).
    pub lines: Vec<[[f64; 2]; 2]>,
    /// True with friction, and with it rotation, torque and spin.
    pub friction: bool,
    /// Equal or different discs.
    pub discs: DiscUniformity,
    /// Moment of inertia of a disc of mass and radius 1: ½ for a disc, ⅖ for a sphere.
    pub inertia_factor: f64,
    /// The integrator.
    pub scheme: GranularScheme,
    /// Time step (time).
    pub dt: f64,
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
    /// Checks of a run; without them the programs are those of BP93.
    pub watch: Option<ContactWatch>,
}

impl GranularModel {
    /// Degrees of freedom of a disc.
    pub fn freedoms(&self) -> usize {
        if self.friction { 3 } else { 2 }
    }

    /// Radius of every disc (length), if all are equal.
    pub fn radius(&self) -> Option<f64> {
        match self.discs {
            DiscUniformity::Equal { disc, .. } => Some(disc.radius),
            DiscUniformity::Varying => None,
        }
    }

    /// Contact law at plane walls, whose coefficients may be others, and whether it has friction.
    pub(super) fn wall_law(&self) -> (Contact, bool) {
        (self.contact, self.friction)
    }

    /// Dependence of accelerations on velocities: with damping they depend on them.
    pub fn acceleration(&self) -> Acceleration {
        let Contact { normal_damping, shear_damping, .. } = self.contact;
        let of_walls = self.walls.all().iter().map(|wall| [wall.normal_damping, wall.shear_damping]);
        let mut dampings = of_walls.chain([[normal_damping, shear_damping]]);
        let damped = dampings.any(|[normal, shear]| normal != 0.0 || (self.friction && shear != 0.0));
        if damped { Acceleration::OfVelocities } else { Acceleration::OfPositions }
    }

    /// True if state positions of precision `S` are measured from the cells' centres: measured from the origin, single precision would lose motion in
    /// large boxes.
    pub(crate) fn is_anchored<S: Storage>(&self) -> bool {
        S::NAME == f32::NAME && self.coordinates == Coordinates::CellRelative
    }

    /// Returns the cell of a position (length), numbered from 1 in the padded lattice, and the position relative to its centre. A position beyond a
    /// closed side belongs to the cell at that side.
    pub fn anchored(&self, position: [f64; 2]) -> (u32, [f64; 2]) {
        let position = self.domain().wrapped(position);
        let counts = [self.shape.columns(), self.shape.rows()];
        let mut cell = [0; 2];
        let mut place = position;
        for axis in 0..2 {
            let edge = self.frame.edge[axis];
            let from_low = position[axis] - self.frame.origin[axis];
            let nearest = (from_low / edge).floor().clamp(0.0, (counts[axis] - 1) as f64);
            cell[axis] = nearest as isize;
            place[axis] = from_low - (nearest + 0.5) * edge;
        }
        (self.shape.position(cell[0], cell[1]) as u32 + 1, place)
    }

    /// Returns the position (length) of a point given relative to the centre of a cell numbered from 1.
    pub fn position(&self, cell: u32, place: [f64; 2]) -> [f64; 2] {
        let at = self.shape.column_and_row((cell as usize).saturating_sub(1));
        [0, 1].map(|axis| {
            self.frame.origin[axis] + (at[axis] as f64 + 0.5) * self.frame.edge[axis] + place[axis]
        })
    }

    /// The box.
    pub fn domain(&self) -> Domain {
        Domain::planar(self.frame.origin, self.sides, self.shape.periodic())
    }

    /// True if a disc may be outside the box and yet on the lattice.
    pub(crate) fn reaches_beyond_box(&self) -> bool {
        let [x, y] = filled(&self.shape, &self.frame);
        x > self.sides[0] * (1.0 + 1e-12) || y > self.sides[1] * (1.0 + 1e-12)
    }

    /// True if contacts dissipate energy and energy is tracked.
    pub(crate) fn counts_dissipation(&self) -> bool {
        self.follows_energy() && self.acceleration() == Acceleration::OfVelocities
    }

    /// Quantities to evaluate with the contacts.
    pub fn asked(&self) -> ObservationRequest {
        ObservationRequest {
            watched: self.watch.map(|watch| watch.depth()),
            dissipation: self.counts_dissipation(),
            energy: false,
        }
    }

    /// True for the axes along which crossed periods are counted: where gravity does work, or displacements are requested.
    pub(crate) fn counts_crossings(&self) -> [bool; 2] {
        let periodic = self.shape.periodic();
        let motion = self.watch.is_some_and(|watch| watch.motion);
        [0, 1].map(|axis| periodic[axis] && (motion || self.does_gravity_work_along(axis)))
    }

    /// True if crossings are counted for displacements alone: a run started without displacements has no counts.
    pub(crate) fn counts_crossings_for_motion_alone(&self) -> bool {
        let periodic = self.shape.periodic();
        (0..2).all(|axis| !(periodic[axis] && self.does_gravity_work_along(axis)))
    }

    fn does_gravity_work_along(&self, axis: usize) -> bool {
        self.follows_energy() && self.gravity[axis] != 0.0
    }

    /// True if energy is tracked.
    pub(crate) fn follows_energy(&self) -> bool {
        self.watch.is_some_and(|watch| watch.energy)
    }

    /// Mass and inertia that forces and torques are divided by.
    pub fn inertia(&self) -> Inertia {
        match self.discs {
            DiscUniformity::Equal { disc, inverse_inertia } => {
                Inertia::Equal { inverse_mass: disc.inverse_mass, inverse_inertia }
            }
            DiscUniformity::Varying => Inertia::Varying,
        }
    }
}

impl SceneProperties {
    /// Scenery of a model.
    pub fn of(model: &GranularModel) -> SceneProperties {
        SceneProperties {
            domain: model.domain(),
            contact: model.contact,
            gravity: model.gravity,
            inertia_factor: if model.friction { model.inertia_factor } else { 0.0 },
        }
    }
}
