//! The classes of the errors of studies, for a user.

use super::StudyError;
use super::calibration::CalibrationError;
use super::efficiency_table::QuestionError;
use super::model_validation::ValidationError;
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::reported::{Class, Reported};

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

impl Reported for CalibrationError {
    fn class(&self) -> Class {
        match self {
            CalibrationError::Program(_) => Class::InputOutput,
            CalibrationError::Measurement(error) => error.class(),
        }
    }

    fn passed_on(&self) -> Option<&dyn Reported> {
        match self {
            CalibrationError::Measurement(error) => Some(error),
            CalibrationError::Program(_) => None,
        }
    }
}

impl Reported for ValidationError {
    fn class(&self) -> Class {
        match self {
            ValidationError::OutOfRange { .. } => Class::Precondition,
            // Its scenes are made of options.
            ValidationError::Measurement(MeasurementError::Scene(_)) => Class::Usage,
            ValidationError::Measurement(error) => error.class(),
            ValidationError::Calibration(error) => error.class(),
        }
    }

    fn passed_on(&self) -> Option<&dyn Reported> {
        match self {
            ValidationError::Measurement(error) => Some(error),
            ValidationError::Calibration(error) => Some(error),
            ValidationError::OutOfRange { .. } => None,
        }
    }
}
