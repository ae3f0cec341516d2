//! Reasons why a study has no result.

use crate::results::JournalError;
use stripmine_physics::method::Failure;
use stripmine_physics::method::observed::UnknownName;
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::number::significant;
use stripmine_physics::reported::{Class, Reported};
use stripmine_physics::scene::SceneErrors;

/// Reason why a study has no result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StudyError {
    /// The method states no trials.
    #[error(
        "scenes of the method {0} take no time steps, and this study varies the step\n  help: choose a scene of another method"
    )]
    NothingToVary(&'static str),
    /// Less time than the smallest study takes.
    #[error(
        "the smallest map of the scene takes about {} processor seconds, more than --budget {budget}\n  help: raise --budget, or choose \
         a smaller scene",
        significant(*needed, 2)
    )]
    TooLittleTime {
        /// Processor seconds of the smallest map.
        needed: f64,
        budget: f64,
    },
    /// Errors of positions say nothing of the scene.
    #[error(
        "positions of {scene} cannot be compared: {why}\n  help: chart the error of a mean: stripmine chart accuracy {scene} --of {quantity}"
    )]
    NoTrajectories {
        scene: String,
        why: String,
        /// A quantity that has a mean.
        quantity: &'static str,
    },
    /// The user asked for the end. Finished runs are kept.
    #[error("interrupted; the same command resumes with the runs that were finished")]
    Interrupted,
    /// The scene is run without vector programs.
    #[error(
        "a step of {0} has no vector programs: discs fly from event to event, nothing acts between particles, or they fit no \
         lattice in the box\n  help: choose a scene of lattice-md, langevin with pairs, or nbody"
    )]
    NoPrograms(String),
    /// The method names something in its trials that it does not observe.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// The scene as it stands.
    #[error(transparent)]
    Physics(#[from] Failure),
    /// A scene that is timed.
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
    /// Threads that the system does not give.
    #[error("the threads cannot be had: {0}; ask for fewer with --threads")]
    Threads(rayon::ThreadPoolBuildError),
    /// Error of the studies of one method.
    #[error("{0}")]
    Own(Box<dyn Reported>),
    /// The scene ends before anything is seen of it.
    #[error(
        "the scene is over after {steps} steps, before its first output (after {first}): no run of it was tried\n  help: \
         raise run.steps or run.time, or lower run.thermo_every"
    )]
    OverBeforeOutput {
        steps: u64,
        /// Steps up to the first row.
        first: u64,
    },
    /// The method lets nothing of that name vary.
    #[error("`{name}` is nothing that may be varied beside the step\n  help: one of {}", known.join(", "))]
    NoSuchParameter { name: String, known: Vec<&'static str> },
    /// The scene has no value of anything that its method varies, so that nothing suggests itself.
    #[error(
        "the scene has no value of its own of what may be varied beside the step\n  help: choose what and from where to where: --over \
         NAME --range LOW HIGH, with one of {}",
        known.join(", ")
    )]
    NothingOfItsOwn { known: Vec<&'static str> },
    /// The scene has nothing of what is to be varied, so that no range suggests itself.
    #[error(
        "the scene has no {0} of its own to vary\n  help: choose a range: --range LOW HIGH; or something else: --over NAME"
    )]
    NothingOfTheKind(&'static str),
    /// A range that cannot be.
    #[error(
        "--range {} {} is none for {name}: it rises, from {} at the least to {} at the most",
        range[0], range[1], significant(bounds[0], 3), significant(bounds[1], 3)
    )]
    OutOfRange { name: &'static str, range: [f64; 2], bounds: [f64; 2] },
    #[error(
        "no run of the scene came to its end as it should; tried were:{}\n  help: lower integrator.dt, or mend what the failures name",
        tried.iter().map(|(what, why)| format!("\n  {what}: {why}")).collect::<String>()
    )]
    EveryRunFails {
        /// Runs that were tried, and why they failed.
        tried: Vec<(String, String)>,
    },
    /// A measuring process was asked for something else than it measures.
    #[error(
        "the measuring process cannot read its parameters: {0}\n  help: let both processes be of one version"
    )]
    Parameters(serde_json::Error),
    /// The journal cannot be read, or is another scene's.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

impl Reported for StudyError {
    fn class(&self) -> Class {
        match self {
            StudyError::OverBeforeOutput { .. }
            | StudyError::EveryRunFails { .. }
            | StudyError::Interrupted => Class::Precondition,
            StudyError::Threads(_) | StudyError::Parameters(_) => Class::InputOutput,
            _ => self.passed_on().map_or(Class::Usage, Reported::class),
        }
    }

    fn passed_on(&self) -> Option<&dyn Reported> {
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
            _ => self.passed_on()?.remedy(),
        }
    }
}
