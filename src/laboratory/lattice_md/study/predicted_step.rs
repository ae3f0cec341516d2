//! A step of the lattice method as the host model sees it: its programs, and the arrays that they go over.

use crate::model::host::{Around, HostModel, OutOfRange};
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_physics::method::lattice_md::{Lengths, Part, Phase, StepProgram};

/// The programs of a step as the model sees them.
pub struct Step {
    programs: Vec<(Part, Outlines, usize)>,
    around: Around,
}

impl Step {
    /// Of programs over vectors of these lengths.
    pub fn new(step: &[StepProgram], lengths: &Lengths) -> Step {
        let programs: Vec<(Part, Outlines, usize)> = step
            .iter()
            .map(|step| (step.part, step.program.outlines(), lengths.range(step.length).len()))
            .collect();
        let cycle: Vec<(&Outlines, usize)> = programs.iter().map(|(_, outlines, n)| (outlines, *n)).collect();
        let around = Around::of_step(&cycle);
        Step { programs, around }
    }

    /// Nanoseconds of a phase.
    ///
    /// # Errors
    /// [`OutOfRange`] where the model does not reach.
    pub fn phase(&self, host: &HostModel, phase: Phase, execution: Execution) -> Result<f64, OutOfRange> {
        let parts: &[Part] = match phase {
            Phase::Predict => &[Part::Predictor],
            Phase::Index => &[Part::Index, Part::Lattice],
            Phase::Forces => &[Part::Forces],
            Phase::Correct => &[Part::Corrector],
            // Only the fast engine has it, which has no programs.
            Phase::CorrectPredict | Phase::Halo => &[],
        };
        let programs = self.programs.iter().filter(|(part, ..)| parts.contains(part));
        programs.map(|(_, outlines, n)| host.program(outlines, *n, execution, &self.around)).sum()
    }
}
