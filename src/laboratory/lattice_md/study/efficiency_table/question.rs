//! Questions that an efficiency table answers: a number of particles, an occupancy, and what is modelled.

use crate::study::StudyError;
use stripmine_kernels::law::granular::{Contact, ContactArm, Disc};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::{Coordinates, Frame, LatticeShape, ShapeError};
use stripmine_physics::method::lattice_md::{
    Discs, GearValues, Lengths, Model, ProgramText, Scheme, StepProgram, programs,
};
use stripmine_physics::reported::{Class, Reported};
use stripmine_physics::scene::Precision;

/// A scene whose operations are counted.
#[derive(Clone, Debug)]
pub struct Question {
    /// NP.
    pub particles: usize,
    /// ρ = NP/LMAX.
    pub occupancy: f64,
    /// What is modelled.
    pub choice: Choice,
}

impl Default for Question {
    /// 1000 discs on 4000 cells, everything modelled that the source models.
    fn default() -> Self {
        Question { particles: 1000, occupancy: 0.25, choice: Choice::default() }
    }
}

/// Parts of the method that a scene needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Programs of BP93, which have friction, different discs and absolute positions whatever is chosen here, or ours.
    pub text: ProgramText,
    /// Friction, and with it rotation, torque and spin.
    pub friction: bool,
    /// Whether radii and masses differ.
    pub varying_discs: bool,
    /// Values of Gear's scheme.
    pub gear_values: usize,
    /// Half-width of the mask: 2 for 5×5, 3 for 7×7.
    pub mask_half_width: u32,
    /// Whether positions are relative to the cell.
    pub cell_relative: bool,
}

impl Choice {
    /// The same by the source's own programs.
    #[must_use]
    pub fn printed(self) -> Choice {
        Choice {
            text: ProgramText::Printed,
            friction: true,
            varying_discs: true,
            cell_relative: false,
            ..self
        }
    }
}

impl Default for Choice {
    /// The source's own scene: rough discs of different sizes, absolute positions, 24 places.
    fn default() -> Self {
        Choice {
            text: ProgramText::Ours,
            friction: true,
            varying_discs: true,
            gear_values: 5,
            mask_half_width: 2,
            cell_relative: false,
        }
    }
}

/// A scene that has no table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuestionError {
    /// An occupancy that no lattice has.
    #[error("an occupancy lies above 0 and at most at 1 (one disc a cell), not at {0}")]
    Occupancy(f64),
    /// No particles.
    #[error("a step needs at least one particle")]
    NoParticles,
    /// No lattice of that many cells.
    #[error("{particles} particles at occupancy {occupancy} make no lattice: {cause}")]
    Shape {
        /// NP.
        particles: usize,
        /// ρ.
        occupancy: f64,
        /// Cause.
        cause: ShapeError,
    },
}

impl Reported for QuestionError {
    fn class(&self) -> Class {
        Class::Usage
    }
}

impl From<QuestionError> for StudyError {
    fn from(error: QuestionError) -> Self {
        StudyError::Own(Box::new(error))
    }
}

/// A model with `choice` on a nearly square, periodic lattice of about `cells` cells.
///
/// Parameters that change no operation count are arbitrary.
///
/// # Errors
/// [`ShapeError`] if no such lattice exists.
pub fn counting_model(cells: usize, choice: Choice) -> Result<Model, ShapeError> {
    let columns = ((cells as f64).sqrt().round() as usize).max(1);
    let rows = cells.div_ceil(columns);
    let mask = Mask::square(choice.mask_half_width);
    let coordinates = if choice.cell_relative { Coordinates::CellRelative } else { Coordinates::Absolute };
    let disc = Disc { radius: 0.5, inverse_mass: 1.0 };
    Ok(Model {
        text: choice.text,
        shape: LatticeShape::new(columns, rows, &mask, [true, true])?,
        frame: Frame { origin: [0.0, 0.0], edge: [0.5, 0.5] },
        sides: [columns, rows].map(|count| 0.5 * count as f64),
        mask,
        coordinates,
        contact: Contact {
            spring: Spring::Hertz,
            stiffness: 100.0,
            normal_damping: 1000.0,
            shear_damping: 300.0,
            friction: 0.5,
            cohesionless: choice.text == ProgramText::Ours,
            arm: ContactArm::Radius,
        },
        friction: choice.friction,
        discs: if choice.varying_discs {
            Discs::Varying
        } else {
            Discs::Equal { disc, inverse_inertia: 8.0 }
        },
        scheme: Scheme::Gear(match choice.gear_values {
            4 => GearValues::Four,
            5 => GearValues::Five,
            _ => GearValues::Six,
        }),
        inertia_factor: 0.5,
        watch: None,
        dt: 1e-4,
        gravity: [9.81, 0.0],
    })
}

/// The model of a question.
///
/// # Errors
/// [`QuestionError`] if no such lattice exists.
pub(crate) fn model_of(question: &Question) -> Result<Model, QuestionError> {
    let &Question { particles, occupancy, choice } = question;
    if particles == 0 {
        return Err(QuestionError::NoParticles);
    }
    if !(occupancy > 0.0 && occupancy <= 1.0) {
        return Err(QuestionError::Occupancy(occupancy));
    }
    let cells = (particles as f64 / occupancy).ceil() as usize;
    counting_model(cells, choice).map_err(|cause| QuestionError::Shape { particles, occupancy, cause })
}

/// The programs of a step, and how long their vectors are, for a question.
///
/// # Errors
/// [`QuestionError`] if no such lattice exists.
pub fn step(question: &Question) -> Result<(Vec<StepProgram>, Lengths), QuestionError> {
    let model = model_of(question)?;
    let lengths = Lengths::new(&model, question.particles, question.particles);
    Ok((programs(&model, Precision::F64), lengths))
}
