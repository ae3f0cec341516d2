//! Programs of a step, compiled for the parts that a model needs.

use super::options::ProgramText;
use super::{Discs, GearValues, Lengths, Model, Scheme};
use crate::method::pairwise::{CarriedBy, WithLaw, WithScheme};
use crate::scene;
use std::marker::PhantomData;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::DERIVATIVES;
use stripmine_kernels::integrator::gear::{Corrector, Gear, Predictor};
use stripmine_kernels::integrator::velocity_verlet::{Drift, Kick, VelocityVerlet};
use stripmine_kernels::isa::{Memory, Op, OpClass, ProgramError};
use stripmine_kernels::law::granular::{Disc, Granular};
use stripmine_kernels::law::{Field, Law};
use stripmine_kernels::ledger::{Ledger, Length};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::printed;
use stripmine_kernels::sweep::lattice::cells::{Check, Clear, Enter, Images};
use stripmine_kernels::sweep::lattice::forces::Forces;
use stripmine_kernels::sweep::lattice::vectors::Spread;
use stripmine_kernels::{Execution, InstructionSet, Program, Runnable};

macro_rules! define_parts {
    ($(($variant:ident, $name:literal, $doc:literal)),* $(,)?) => {
        /// Part of the step, as BP93 divides it (section 3); [`Part::Lattice`] is not counted there.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Part {
            $(#[doc = $doc] $variant,)*
        }

        impl Part {
            /// All parts, in the order of the step.
            pub const ALL: &'static [Part] = &[$(Part::$variant),*];

            /// Name in tables and on the command line.
            pub const fn name(self) -> &'static str {
                match self { $(Part::$variant => $name),* }
            }

            /// Description of the part.
            pub const fn meaning(self) -> &'static str {
                match self { $(Part::$variant => $doc),* }
            }
        }
    };
}

define_parts! {
    (Predictor, "predictor", "Gear's prediction of all derivatives"),
    (Box, "box", "positions wrapped into a periodic box: printed programs only, as the paper has no equation for it"),
    (Index, "index", "the cell of every disc, the scatter into the Index, the check that no disc was lost"),
    (Halo, "halo", "images in the halo, the check that no disc was lost: printed programs only, as the paper has no equation for it"),
    (Lattice, "lattice", "the discs' quantities as lattice vectors"),
    (Forces, "forces", "the contact law at every offset of the mask"),
    (Corrector, "corrector", "forces gathered back, and Gear's correction of all derivatives"),
}

impl Part {
    /// Parts between prediction and forces, once positions are in the box.
    pub(super) const CELLS: &'static [Part] = &[Part::Index, Part::Halo];
}

/// Program of the step.
pub struct StepProgram {
    /// Part that it belongs to.
    pub part: Part,
    /// Symbolic vector length.
    pub length: Length,
    /// The program.
    pub program: Box<dyn Runnable>,
}

/// Compiles the programs of a step of `model`, in order.
pub fn programs(model: &Model, precision: scene::Precision) -> Vec<StepProgram> {
    match precision {
        scene::Precision::F64 => programs_of::<f64, f64>(model),
        scene::Precision::F32 => programs_of::<f32, f32>(model),
        scene::Precision::Mixed => programs_of::<f64, f32>(model),
    }
}

/// Compiles the programs with state of precision `S` and forces of precision `P`.
pub(super) fn programs_of<S: Precision, P: Precision>(model: &Model) -> Vec<StepProgram> {
    match model.text {
        ProgramText::Ours => ours::<S, P>(model),
        ProgramText::Printed => printed_programs(model),
    }
}

fn step(part: Part, length: Length, program: Box<dyn Runnable>) -> StepProgram {
    StepProgram { part, length, program }
}

/// Programs printed in BP93, which have one precision.
fn printed_programs(model: &Model) -> Vec<StepProgram> {
    let Model { shape, frame, ref mask, contact, coordinates, .. } = *model;
    let law = printed::Printed { contact };
    let forces = Forces::<f64, _>::new(law, mask, shape, frame, coordinates).asked(model.asked());
    let into_box = printed::beside::IntoBox::<f64>::new(shape, frame);
    let mut programs = vec![
        step(Part::Predictor, Length::Grains, printed_predictor(model)),
        step(Part::Box, Length::Discs, Box::new(Program::new(into_box))),
        step(Part::Index, Length::PaddedCells, Box::new(Program::new(printed::Clear::<f64>::default()))),
        step(
            Part::Index,
            Length::Discs,
            Box::new(Program::new(printed::Enter::<f64, f64>::new(shape, frame))),
        ),
        step(Part::Halo, Length::Discs, Box::new(Program::new(Check))),
    ];
    if shape.periodic().contains(&true) {
        let images = printed::beside::Images::<f64>::default();
        programs.push(step(Part::Halo, Length::HaloCells, Box::new(Program::new(images))));
    }
    programs.extend([
        step(
            Part::Lattice,
            Length::PaddedCells,
            Box::new(Program::new(printed::Map::<f64, f64>::new(shape))),
        ),
        step(Part::Forces, Length::SweptCells, Box::new(Program::new(forces))),
        step(Part::Corrector, Length::Grains, printed_corrector(model)),
    ]);
    programs
}

fn printed_predictor(model: &Model) -> Box<dyn Runnable> {
    match model.scheme {
        Scheme::Gear(GearValues::Five) => {
            Box::new(Program::new(printed::Predictor::<f64, 5, 3>::new(model.dt)))
        }
        Scheme::Gear(GearValues::Six) => {
            Box::new(Program::new(printed::Predictor::<f64, 6, 3>::new(model.dt)))
        }
        // BP93 has no other scheme: scenes with one are rejected.
        _ => Box::new(Program::new(printed::Predictor::<f64, 4, 3>::new(model.dt))),
    }
}

fn printed_corrector(model: &Model) -> Box<dyn Runnable> {
    fn corrector<const VALUES: usize>(model: &Model) -> Box<dyn Runnable> {
        let Model { dt, gravity, .. } = *model;
        let corrector = printed::Corrector::<f64, f64, VALUES, 3>::new(dt, model.acceleration(), gravity);
        Box::new(Program::new(if model.watch.is_some() { corrector.checked() } else { corrector }))
    }
    match model.scheme {
        Scheme::Gear(GearValues::Five) => corrector::<5>(model),
        Scheme::Gear(GearValues::Six) => corrector::<6>(model),
        _ => corrector::<4>(model),
    }
}

fn ours<S: Precision, P: Precision>(model: &Model) -> Vec<StepProgram> {
    let (forces, fields) = with_law(model, LatticeSweep::<P>(model, PhantomData));
    let mut programs = vec![
        step(Part::Predictor, Length::Grains, predictor::<S, P>(model)),
        step(Part::Index, Length::PaddedCells, Box::new(Program::new(Clear))),
        step(Part::Index, Length::Discs, Box::new(Program::new(enter::<S, P>(model)))),
        step(Part::Index, Length::Discs, Box::new(Program::new(Check))),
    ];
    if model.shape.periodic().contains(&true) {
        programs.push(step(Part::Index, Length::HaloCells, Box::new(Program::new(Images))));
    }
    let spread = Spread::<P>::new(model.shape, model.coordinates, fields);
    programs.extend([
        step(Part::Lattice, Length::PaddedCells, Box::new(Program::new(spread))),
        step(Part::Forces, Length::SweptCells, forces),
        step(Part::Corrector, Length::Grains, corrector::<S, P>(model)),
    ]);
    programs
}

fn enter<S: Precision, P: Precision>(model: &Model) -> Enter<S, P> {
    let Model { shape, frame, coordinates, .. } = *model;
    match model.is_anchored::<S>() {
        true => Enter::anchored(shape, frame),
        false => Enter::new(shape, frame, coordinates),
    }
}

/// Returns the operations of a step of the programs.
pub fn ledger(programs: &[StepProgram]) -> Ledger {
    let mut ledger = Ledger::default();
    for step in programs {
        ledger.enter(step.part.name(), step.length, step.program.as_ref());
    }
    ledger
}

/// Returns the operations of a step of BP93's neighbour lists, element by element and in double precision. They are the programs shared with the
/// lattice, and the law: its distance section for every candidate, the rest for every pair.
pub fn rival_ledger(model: &Model) -> Ledger {
    rival_ledger_of::<f64, f64>(model)
}

/// Returns these operations with state of precision `S` and forces of precision `P`.
pub(super) fn rival_ledger_of<S: Precision, P: Precision>(model: &Model) -> Ledger {
    let one_place = Model { mask: Mask::one_place(), ..model.clone() };
    let (law, _) = with_law_of_text(&one_place, LatticeSweep::<P>(&one_place, PhantomData));
    let part = Part::Forces.name();
    let mut ledger = Ledger::default();
    for step in programs_of::<S, P>(model) {
        match step.part {
            Part::Lattice => {}
            Part::Forces => {
                for (section, counts) in law.tally() {
                    let once = |op: Op| op.class() == OpClass::Store || op.class() == OpClass::Load;
                    let length = match section {
                        "distance" | "contact" => Length::Candidates,
                        _ => Length::Pairs,
                    };
                    let (of_disc, of_pair) = (counts.filtered(once), counts.filtered(|op| !once(op)));
                    for (length, counts) in [(Length::Grains, of_disc), (length, of_pair)] {
                        if counts.total() > 0 {
                            ledger.enter_counts(part, section, length, counts);
                        }
                    }
                }
            }
            _ => ledger.enter(step.part.name(), step.length, step.program.as_ref()),
        }
    }
    ledger
}

/// Applies a task to the law of the programs' version.
pub(super) fn with_law_of_text<W: WithLaw>(model: &Model, task: W) -> W::Output {
    match model.text {
        ProgramText::Ours => with_law(model, task),
        ProgramText::Printed => task.with(printed::Printed { contact: model.contact }),
    }
}

/// Applies a task to the compiled variant of the law.
pub(super) fn with_law<W: WithLaw>(model: &Model, task: W) -> W::Output {
    let contact = model.contact;
    // Not read if discs vary.
    let any = Disc { radius: f64::NAN, inverse_mass: f64::NAN };
    match (model.friction, model.discs) {
        (true, Discs::Varying) => task.with(Granular::<true, false> { contact, disc: any }),
        (true, Discs::Equal { disc, .. }) => task.with(Granular::<true, true> { contact, disc }),
        (false, Discs::Varying) => task.with(Granular::<false, false> { contact, disc: any }),
        (false, Discs::Equal { disc, .. }) => task.with(Granular::<false, true> { contact, disc }),
    }
}

/// Applies a task to the integrator.
pub(super) fn with_scheme<W: WithScheme>(model: &Model, work: W) -> W::Output {
    let acceleration = model.acceleration();
    match model.scheme {
        Scheme::Gear(GearValues::Four) => work.with(Gear::<4>::new(acceleration)),
        Scheme::Gear(GearValues::Five) => work.with(Gear::<5>::new(acceleration)),
        Scheme::Gear(GearValues::Six) => work.with(Gear::<6>::new(acceleration)),
        Scheme::VelocityVerlet => work.with(VelocityVerlet),
    }
}

/// Scale factors of the derivatives in the state of the programs.
pub(super) fn scales(model: &Model) -> [f64; DERIVATIVES] {
    if model.text == ProgramText::Printed {
        return [1.0; DERIVATIVES];
    }
    with_scheme(model, CarriedBy { dt: model.dt }).scales
}

/// Lattice sweep of a law, and the quantities it needs.
struct LatticeSweep<'m, P>(&'m Model, PhantomData<P>);

impl<P: Precision> WithLaw for LatticeSweep<'_, P> {
    type Output = (Box<dyn Runnable>, &'static [Field]);

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output {
        let Model { mask, shape, frame, coordinates, .. } = self.0;
        let forces = Forces::<P, L>::new(law, mask, *shape, *frame, *coordinates).asked(self.0.asked());
        (Box::new(Program::new(forces)), L::FIELDS)
    }
}

/// Calls the instance of `$function::<S, P, VALUES, FREEDOMS>` that a model needs.
macro_rules! for_scheme {
    ($model:expr, $values:expr, $function:ident) => {
        match ($values, $model.friction) {
            (GearValues::Four, true) => $function::<S, P, 4, 3>($model),
            (GearValues::Four, false) => $function::<S, P, 4, 2>($model),
            (GearValues::Five, true) => $function::<S, P, 5, 3>($model),
            (GearValues::Five, false) => $function::<S, P, 5, 2>($model),
            (GearValues::Six, true) => $function::<S, P, 6, 3>($model),
            (GearValues::Six, false) => $function::<S, P, 6, 2>($model),
        }
    };
}

fn predictor<S: Precision, P: Precision>(model: &Model) -> Box<dyn Runnable> {
    fn scheme<S: Precision, P: Precision, const VALUES: usize, const FREEDOMS: usize>(
        model: &Model,
    ) -> Box<dyn Runnable> {
        Box::new(Program::new(Predictor::<S, P, VALUES, FREEDOMS>::new(model.dt)))
    }
    match (model.scheme, model.friction) {
        (Scheme::Gear(values), _) => for_scheme!(model, values, scheme),
        (Scheme::VelocityVerlet, true) => Box::new(Program::new(Drift::<S, P, 3>::new(model.dt))),
        (Scheme::VelocityVerlet, false) => Box::new(Program::new(Drift::<S, P, 2>::new(model.dt))),
    }
}

fn corrector<S: Precision, P: Precision>(model: &Model) -> Box<dyn Runnable> {
    fn scheme<S: Precision, P: Precision, const VALUES: usize, const FREEDOMS: usize>(
        model: &Model,
    ) -> Box<dyn Runnable> {
        let Model { dt, gravity, .. } = *model;
        let corrector =
            Corrector::<S, P, VALUES, FREEDOMS>::new(dt, model.acceleration(), model.inertia(), gravity);
        Box::new(Program::new(if model.watch.is_some() { corrector.checked() } else { corrector }))
    }
    fn kick<S: Precision, P: Precision, const FREEDOMS: usize>(model: &Model) -> Box<dyn Runnable> {
        let kick = Kick::<S, P, FREEDOMS>::new(model.dt, model.inertia(), model.gravity);
        Box::new(Program::new(if model.watch.is_some() { kick.checked() } else { kick }))
    }
    match (model.scheme, model.friction) {
        (Scheme::Gear(values), _) => for_scheme!(model, values, scheme),
        (Scheme::VelocityVerlet, true) => kick::<S, P, 3>(model),
        (Scheme::VelocityVerlet, false) => kick::<S, P, 2>(model),
    }
}

/// Runs the programs of some parts, in order, on bound arrays.
///
/// # Errors
/// [`ProgramError`] if the memory does not suit a program; nothing of that program has been executed.
pub fn execute(
    programs: &[StepProgram],
    parts: &[Part],
    memory: &Memory<'_>,
    lengths: &Lengths,
    execution: Execution,
    set: InstructionSet,
) -> Result<(), ProgramError> {
    for step in programs.iter().filter(|step| parts.contains(&step.part)) {
        step.program.run(memory, lengths.range(step.length), execution, set)?;
    }
    Ok(())
}
