//! Reasons why a study has no result.

use crate::results::JournalError;
use stripmine_physics::method::PhysicsFailure;
use stripmine_physics::method::observed::UnknownName;
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::number::significant;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::scene::SceneErrors;

/// Reason why a study has no result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StudyError {
    /// The method has no time step to vary.
    #[error(
        "scenes of the method {0} take no time steps, but this study varies the step\n  help: choose a scene of another method"
    )]
    NothingToVary(&'static str),
    /// The budget is below the smallest study.
    #[error(
        "the smallest map of the scene takes about {} processor seconds, above --budget {budget}\n  help: raise --budget, or choose \
         a smaller scene",
        significant(*needed, 2)
    )]
    TooLittleTime { needed: f64, budget: f64 },
    /// Trajectories of the scene cannot be compared.
    #[error(
        "positions of {scene} cannot be compared: {why}\n  help: chart the error of a mean: stripmine chart accuracy {scene} --of {quantity}"
    )]
    NoTrajectories { scene: String, why: String, quantity: &'static str },
    /// The user interrupted the study. Finished runs are kept.
    #[error("interrupted; the same command resumes after the finished runs")]
    Interrupted,
    /// The scene has no vector programs.
    #[error(
        "a step of {0} has no vector programs: discs move from event to event, particles do not interact, or they fit no \
         lattice in the box\n  help: choose a scene of lattice-md, langevin with pairs, or nbody"
    )]
    NoPrograms(String),
    /// The trials of the method name a quantity that it does not observe.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// A run of the scene failed.
    #[error(transparent)]
    Physics(#[from] PhysicsFailure),
    /// A timing of the scene failed.
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
    /// Threads could not be started.
    #[error("the threads cannot be started: {0}; ask for fewer with --threads")]
    Threads(rayon::ThreadPoolBuildError),
    /// A temporary file could not be written.
    #[error(
        "a temporary file cannot be written: {0}\n  help: free space there, or set TMPDIR to another folder"
    )]
    Files(std::io::Error),
    /// Error of a study of a single method.
    #[error("{0}")]
    Own(Box<dyn Reported>),
    /// The scene ends before its first output.
    #[error(
        "the scene ends after {steps} steps, before its first output (after {first}); nothing was run\n  help: \
         raise run.steps or run.time, or lower run.thermo_every"
    )]
    OverBeforeOutput {
        steps: u64,
        /// Steps up to the first row.
        first: u64,
    },
    /// The method has no parameter of that name to vary.
    #[error("`{name}` is not a parameter that can be varied besides the step\n  help: use one of {}", known.join(", "))]
    NoSuchParameter { name: String, known: Vec<&'static str> },
    /// The scene sets none of the parameters that its method can vary, so no range can be derived.
    #[error(
        "the scene sets none of the parameters that can be varied besides the step\n  help: choose a parameter and its range: --over \
         NAME --range LOW HIGH, with one of {}",
        known.join(", ")
    )]
    NothingOfItsOwn { known: Vec<&'static str> },
    /// The scene does not set the parameter to be varied, so no range can be derived.
    #[error(
        "the scene does not set {0}, so its range is unknown\n  help: choose a range: --range LOW HIGH; or another parameter: --over NAME"
    )]
    NothingOfTheKind(&'static str),
    /// The range is invalid.
    #[error(
        "--range {} {} is invalid for {name}: expected two rising values from {} to {}",
        range[0], range[1], significant(bounds[0], 3), significant(bounds[1], 3)
    )]
    OutOfRange { name: &'static str, range: [f64; 2], bounds: [f64; 2] },
    #[error(
        "no run of the scene gave a usable result; tried:{}\n  help: lower integrator.dt, or fix what the failures name",
        tried.iter().map(|(what, why)| format!("\n  {what}: {why}")).collect::<String>()
    )]
    EveryRunFails {
        /// Runs that were tried, and why they failed.
        tried: Vec<(String, String)>,
    },
    /// The measuring process received parameters that it cannot read.
    #[error(
        "the measuring process cannot read its parameters: {0}\n  help: use one version of the program for both processes"
    )]
    Parameters(serde_json::Error),
    /// The journal cannot be read, or belongs to another scene.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

impl Reported for StudyError {
    fn class(&self) -> ErrorClass {
        match self {
            StudyError::OverBeforeOutput { .. }
            | StudyError::EveryRunFails { .. }
            | StudyError::Interrupted => ErrorClass::Precondition,
            StudyError::Threads(_) | StudyError::Files(_) | StudyError::Parameters(_) => {
                ErrorClass::InputOutput
            }
            _ => self.inner_error().map_or(ErrorClass::Usage, Reported::class),
        }
    }

    fn inner_error(&self) -> Option<&dyn Reported> {
        Some(match self {
            StudyError::Unknown(error) => error,
            StudyError::Scene(errors) => errors,
            StudyError::Physics(failure) => failure,
            StudyError::Measurement(error) => error,
            StudyError::Own(error) => error.as_ref(),
            StudyError::Journal(error) => error,
            _ => return None,
        })
    }

    fn remedy(&self) -> Option<String> {
        match self {
            StudyError::Threads(_) => Some("ask for fewer with --threads".to_owned()),
            _ => self.inner_error()?.remedy(),
        }
    }
}
