//! What does each term of the host model add? One step on a host, term by term, then in other executions.

use super::efficiency_table::{Question, QuestionError, step};
use super::model_validation::Calibrated;
use super::predicted_step::Step;
use crate::model::host::{HostModel, OutOfRange};
use serde::Serialize;
use stripmine_kernels::Execution;
use stripmine_physics::method::lattice_md::Phase;

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct HostLadder {
    /// NP.
    pub particles: usize,
    /// LMAX.
    pub cells: usize,
    /// The host.
    pub host: String,
    /// Whose model it is.
    pub model: String,
    /// A row for each rung.
    pub rungs: Vec<Rung>,
}

/// A step by one form of the model.
#[derive(Clone, Debug, Serialize)]
pub struct Rung {
    /// Its name.
    pub name: &'static str,
    /// What it takes into account.
    pub meaning: &'static str,
    /// Nanoseconds of each phase.
    pub phases: Vec<f64>,
    /// Nanoseconds of the step.
    pub ns: f64,
}

/// Why there is no ladder.
#[derive(Debug, thiserror::Error)]
pub enum LadderError {
    /// No such lattice.
    #[error(transparent)]
    Question(#[from] QuestionError),
    /// Beyond what was calibrated.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}

/// Predicts the step of a question.
///
/// # Errors
/// [`LadderError`] if no such lattice exists or the model does not reach.
pub fn host_ladder(
    question: &Question,
    host: &HostModel,
    calibrated: Calibrated,
) -> Result<HostLadder, LadderError> {
    let (programs, lengths) = step(question)?;
    let step = Step::new(&programs, &lengths);
    let near = host.in_cache();
    let (eager, strips) = (Execution::Eager, Execution::Strip(256));
    let operations = "The trivial baseline: operations times elements, at the cost of a sum.";
    let forms = [
        ("operations", operations, host, eager, 1),
        ("passes", "Start-up and time of every pass, operands in the first-level cache.", &near, eager, 0),
        ("eager", "As passes, bytes from the level that their footprint lies in.", host, eager, 0),
        ("strips of 256", "The same, strip-mined.", host, strips, 0),
        ("chained", "The same, as compiled loops.", host, Execution::Chained, 0),
    ];
    let mut rungs = vec![];
    for (name, meaning, model, execution, which) in forms {
        let phases = Phase::ALL.iter().map(|&phase| Ok(step.phase(model, phase, execution)?[which]));
        let phases: Vec<f64> = phases.collect::<Result<_, OutOfRange>>()?;
        rungs.push(Rung { name, meaning, ns: phases.iter().sum(), phases });
    }
    Ok(HostLadder {
        particles: lengths.discs,
        cells: lengths.cells,
        host: host.title.clone(),
        model: calibrated.model_of(&host.title),
        rungs,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::host::default_model;

    #[test]
    fn every_term_costs_something_and_chaining_pays() {
        let ladder =
            host_ladder(&Question::default(), &default_model().unwrap(), Calibrated::Shipped).unwrap();
        let ns: Vec<f64> = ladder.rungs.iter().map(|rung| rung.ns).collect();
        assert!(ns[0] > 0.0 && ns[1] < ns[2], "{ns:?}");
        assert!(ns[4] < ns[3] && ns[4] < ns[2], "{ns:?}");
    }

    #[test]
    fn beyond_the_calibrated_range_there_is_no_prediction() {
        let question = Question { particles: 2_000_000, occupancy: 0.25, ..Question::default() };
        let error = host_ladder(&question, &default_model().unwrap(), Calibrated::Shipped).unwrap_err();
        assert!(matches!(error, LadderError::OutOfRange(OutOfRange::Length { .. })), "{error}");
    }
}
