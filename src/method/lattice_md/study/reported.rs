//! The classes of the errors of studies, for a user.

use super::StudyError;
use super::break_even::AtlasError;
use super::calibration::CalibrationError;
use super::efficiency_table::QuestionError;
use super::host_ladder::LadderError;
use super::model_validation::ValidationError;
use crate::method::throughput::MeasurementError;
use crate::reported::{Class, Reported};
use crate::scene::SceneErrors;

impl Reported for QuestionError {
    fn class(&self) -> Class {
        Class::Usage
    }
}

impl Reported for StudyError {
    fn class(&self) -> Class {
        match self {
            StudyError::Scene(errors) => errors.class(),
            StudyError::Physics(failure) => failure.class(),
            StudyError::Question(error) => error.class(),
        }
    }

    fn mistakes(&self) -> Option<&SceneErrors> {
        match self {
            StudyError::Scene(errors) => Some(errors),
            StudyError::Physics(_) | StudyError::Question(_) => None,
        }
    }
}

impl Reported for LadderError {
    fn class(&self) -> Class {
        match self {
            LadderError::Question(error) => error.class(),
            LadderError::OutOfRange(_) => Class::Precondition,
        }
    }
}

impl Reported for CalibrationError {
    fn class(&self) -> Class {
        match self {
            CalibrationError::Program(_) => Class::InputOutput,
            CalibrationError::Measurement(error) => error.class(),
        }
    }

    fn mistakes(&self) -> Option<&SceneErrors> {
        match self {
            CalibrationError::Measurement(error) => error.mistakes(),
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

    fn mistakes(&self) -> Option<&SceneErrors> {
        match self {
            ValidationError::Measurement(error) => error.mistakes(),
            ValidationError::Calibration(error) => error.mistakes(),
            ValidationError::OutOfRange { .. } => None,
        }
    }
}

impl Reported for AtlasError {
    fn class(&self) -> Class {
        match self {
            AtlasError::OutOfRange(_) => Class::Precondition,
            AtlasError::Study(error) => error.class(),
            AtlasError::Measurement(error) => error.class(),
        }
    }

    fn mistakes(&self) -> Option<&SceneErrors> {
        match self {
            AtlasError::Study(error) => error.mistakes(),
            AtlasError::Measurement(error) => error.mistakes(),
            AtlasError::OutOfRange(_) => None,
        }
    }
}
