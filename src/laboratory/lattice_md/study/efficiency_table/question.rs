//! Scenes of efficiency tables: number of particles, occupancy, and modelled features.

use crate::study::StudyError;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use stripmine_kernels::law::granular::{Contact, ContactArm, EqualDiscs};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame, LatticeShape, ShapeError};
use stripmine_physics::method::lattice_md::{
    DiscUniformity, GearValues, GranularModel, GranularScheme, Lengths, ProgramVersion, StepProgram, programs,
};
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::scene::Precision;
use stripmine_physics::words::Words;

/// Scene whose operations are counted, as options of verbs.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct TableScene {
    /// Number of particles NP
    #[arg(long, default_value_t = 1000)]
    pub(crate) particles: usize,
    /// Occupancy of the lattice: particles per cell, above 0 and at most 1
    #[arg(long, default_value_t = 0.25)]
    pub(crate) occupancy: f64,
    #[command(flatten)]
    pub(crate) choice: TableFeatures,
}

/// Features of the method that a scene needs. BP93's program has friction, different discs and absolute positions.
#[derive(Args, Clone, Copy, Debug, PartialEq)]
pub(crate) struct TableFeatures {
    /// Program: ours, or BP93's as printed
    #[arg(long, default_value = "ours", value_parser = text_parser())]
    pub(crate) text: ProgramVersion,
    /// Omit friction and rotation
    #[arg(long, conflicts_with = "text")]
    pub(crate) frictionless: bool,
    /// Equal discs: radius and mass are scalars, not vectors
    #[arg(long, conflicts_with = "text")]
    pub(crate) equal_discs: bool,
    /// Values of Gear's scheme
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u8).range(4..=6))]
    pub(crate) gear_values: u8,
    /// Width of the mask: 5 (24 offsets) or 7 (48 offsets)
    #[arg(long, default_value = "5", value_parser = PossibleValuesParser::new(["5", "7"]).map(|it| if it == "7" { 7_u32 } else { 5 }))]
    pub(crate) mask: u32,
    /// Positions relative to the cell instead of the origin
    #[arg(long, conflicts_with = "text")]
    pub(crate) cell_relative: bool,
}

fn text_parser() -> impl TypedValueParser<Value = ProgramVersion> {
    // The parser admits words of the list only.
    PossibleValuesParser::new(ProgramVersion::WORDS.to_vec())
        .map(|word| ProgramVersion::parse(&word).unwrap_or(ProgramVersion::Ours))
}

/// 1000 discs on 4000 cells.
impl Default for TableScene {
    fn default() -> Self {
        TableScene { particles: 1000, occupancy: 0.25, choice: TableFeatures::default() }
    }
}

/// All features of BP93, with our program.
impl Default for TableFeatures {
    fn default() -> Self {
        let (text, [frictionless, equal_discs, cell_relative]) = (ProgramVersion::Ours, [false; 3]);
        TableFeatures { text, frictionless, equal_discs, gear_values: 5, mask: 5, cell_relative }
    }
}

impl TableFeatures {
    /// This choice with BP93's program.
    pub(crate) fn printed(self) -> TableFeatures {
        let TableFeatures { gear_values, mask, .. } = self;
        TableFeatures { text: ProgramVersion::Printed, gear_values, mask, ..TableFeatures::default() }
    }
}

impl TableScene {
    /// This scene with BP93's program.
    pub(crate) fn printed(self) -> TableScene {
        TableScene { choice: self.choice.printed(), ..self }
    }
}

/// Scene without an efficiency table.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TableSceneError {
    #[error("the occupancy is {0}; it must be above 0 and at most 1 (one disc per cell)")]
    Occupancy(f64),
    #[error("a step needs at least one particle")]
    NoParticles,
    #[error("no lattice exists for {particles} particles at occupancy {occupancy}: {cause}")]
    Shape { particles: usize, occupancy: f64, cause: ShapeError },
}

impl Reported for TableSceneError {
    fn class(&self) -> ErrorClass {
        ErrorClass::Usage
    }
}

impl From<TableSceneError> for StudyError {
    fn from(error: TableSceneError) -> Self {
        StudyError::Own(Box::new(error))
    }
}

/// Model with `choice` on a nearly square, periodic lattice of about `cells` cells.
///
/// Parameters that do not affect operation counts are arbitrary.
pub(crate) fn counting_model(cells: usize, choice: TableFeatures) -> Result<GranularModel, ShapeError> {
    let columns = ((cells as f64).sqrt().round() as usize).max(1);
    let rows = cells.div_ceil(columns);
    let mask = Mask::square(choice.mask / 2);
    let coordinates = if choice.cell_relative { Coordinates::CellRelative } else { Coordinates::Absolute };
    let disc = EqualDiscs { radius: 0.5, inverse_mass: 1.0 };
    Ok(GranularModel {
        text: choice.text,
        shape: LatticeShape::new(columns, rows, &mask, [true, true])?,
        frame: LatticeFrame { origin: [0.0, 0.0], edge: [0.5, 0.5] },
        sides: [columns, rows].map(|count| 0.5 * count as f64),
        mask,
        coordinates,
        walls: std::sync::Arc::default(),
        lines: vec![],
        contact: Contact {
            spring: Spring::Hertz,
            stiffness: 100.0,
            normal_damping: 1000.0,
            shear_damping: 300.0,
            friction: 0.5,
            cohesionless: choice.text == ProgramVersion::Ours,
            arm: ContactArm::Radius,
        },
        friction: !choice.frictionless,
        discs: if choice.equal_discs {
            DiscUniformity::Equal { disc, inverse_inertia: 8.0 }
        } else {
            DiscUniformity::Varying
        },
        scheme: GranularScheme::Gear(match choice.gear_values {
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

pub(crate) fn scene_model(question: &TableScene) -> Result<GranularModel, TableSceneError> {
    let &TableScene { particles, occupancy, choice } = question;
    if particles == 0 {
        return Err(TableSceneError::NoParticles);
    }
    if !(occupancy > 0.0 && occupancy <= 1.0) {
        return Err(TableSceneError::Occupancy(occupancy));
    }
    let cells = (particles as f64 / occupancy).ceil() as usize;
    counting_model(cells, choice).map_err(|cause| TableSceneError::Shape { particles, occupancy, cause })
}

/// Programs of a step and their vector lengths.
pub(crate) fn programs_of_step(
    question: &TableScene,
) -> Result<(Vec<StepProgram>, Lengths), TableSceneError> {
    programs_in_precision(question, Precision::F64)
}

/// As [`programs_of_step`], in another precision.
pub(crate) fn programs_in_precision(
    question: &TableScene,
    precision: Precision,
) -> Result<(Vec<StepProgram>, Lengths), TableSceneError> {
    let model = scene_model(question)?;
    let lengths = Lengths::new(&model, question.particles, question.particles);
    Ok((programs(&model, precision), lengths))
}
