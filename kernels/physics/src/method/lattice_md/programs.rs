//! Programs of a step, compiled for the parts that a model needs.

use super::options::ProgramVersion;
use super::wall_law::with_wall_law;
use super::{DiscUniformity, GearValues, GranularModel, GranularScheme, Lengths};
use crate::method::pairwise::{CarriedQuery, LawTask, SchemeTask};
use crate::scene;
use std::marker::PhantomData;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::DERIVATIVES;
use stripmine_kernels::integrator::gear::{Gear, GearCorrector, GearPredictor};
use stripmine_kernels::integrator::velocity_verlet::{VelocityVerlet, VerletDrift, VerletKick};
use stripmine_kernels::isa::{Memory, Op, OpClass, ProgramError};
use stripmine_kernels::law::granular::{EqualDiscs, Granular};
use stripmine_kernels::law::{Law, ParticleField};
use stripmine_kernels::ledger::{Ledger, VectorLength};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::printed;
use stripmine_kernels::sweep::lattice::cells::{CheckIndex, ClearIndex, EnterDiscs, IndexImages};
use stripmine_kernels::sweep::lattice::forces::Forces;
use stripmine_kernels::sweep::lattice::vectors::SpreadToLattice;
use stripmine_kernels::sweep::walls::WallForces;
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
    (Walls, "walls", "the contact law at the plane walls: scenes with such walls only"),
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
    pub length: VectorLength,
    /// The program.
    pub program: Box<dyn Runnable>,
}

/// Compiles the programs of a step of `model`, in order.
pub fn programs(model: &GranularModel, precision: scene::Precision) -> Vec<StepProgram> {
    match precision {
        scene::Precision::F64 => programs_of::<f64, f64>(model),
        scene::Precision::F32 => programs_of::<f32, f32>(model),
        scene::Precision::Mixed => programs_of::<f64, f32>(model),
    }
}

/// Compiles the programs with state of precision `S` and forces of precision `P`.
pub(super) fn programs_of<S: Precision, P: Precision>(model: &GranularModel) -> Vec<StepProgram> {
    match model.text {
        ProgramVersion::Ours => our_programs::<S, P>(model),
        ProgramVersion::Printed => printed_programs(model),
    }
}

fn step(part: Part, length: VectorLength, program: Box<dyn Runnable>) -> StepProgram {
    StepProgram { part, length, program }
}

/// Programs printed in BP93, which have one precision.
fn printed_programs(model: &GranularModel) -> Vec<StepProgram> {
    let GranularModel { shape, frame, ref mask, contact, coordinates, .. } = *model;
    let law = printed::Printed { contact };
    let forces = Forces::<f64, _>::new(law, mask, shape, frame, coordinates).asked(model.asked());
    let into_box = printed::additions::IntoBox::<f64>::new(shape, frame);
    let mut programs = vec![
        step(Part::Predictor, VectorLength::Grains, printed_predictor(model)),
        step(Part::Box, VectorLength::Discs, Box::new(Program::new(into_box))),
        step(
            Part::Index,
            VectorLength::PaddedCells,
            Box::new(Program::new(printed::PrintedClear::<f64>::default())),
        ),
        step(
            Part::Index,
            VectorLength::Discs,
            Box::new(Program::new(printed::PrintedEnter::<f64, f64>::new(shape, frame))),
        ),
        step(Part::Halo, VectorLength::Discs, Box::new(Program::new(CheckIndex))),
    ];
    if shape.periodic().contains(&true) {
        let images = printed::additions::PrintedImages::<f64>::default();
        programs.push(step(Part::Halo, VectorLength::HaloCells, Box::new(Program::new(images))));
    }
    programs.extend([
        step(
            Part::Lattice,
            VectorLength::PaddedCells,
            Box::new(Program::new(printed::PrintedMap::<f64, f64>::new(shape))),
        ),
        step(Part::Forces, VectorLength::SweptCells, Box::new(Program::new(forces))),
        step(Part::Corrector, VectorLength::Grains, printed_corrector(model)),
    ]);
    programs
}

fn printed_predictor(model: &GranularModel) -> Box<dyn Runnable> {
    match model.scheme {
        GranularScheme::Gear(GearValues::Five) => {
            Box::new(Program::new(printed::PrintedPredictor::<f64, 5, 3>::new(model.dt)))
        }
        GranularScheme::Gear(GearValues::Six) => {
            Box::new(Program::new(printed::PrintedPredictor::<f64, 6, 3>::new(model.dt)))
        }
        // BP93 has no other scheme: scenes with one are rejected.
        _ => Box::new(Program::new(printed::PrintedPredictor::<f64, 4, 3>::new(model.dt))),
    }
}

fn printed_corrector(model: &GranularModel) -> Box<dyn Runnable> {
    fn corrector<const VALUES: usize>(model: &GranularModel) -> Box<dyn Runnable> {
        let GranularModel { dt, gravity, .. } = *model;
        let corrector =
            printed::PrintedCorrector::<f64, f64, VALUES, 3>::new(dt, model.acceleration(), gravity);
        Box::new(Program::new(if model.watch.is_some() { corrector.checked() } else { corrector }))
    }
    match model.scheme {
        GranularScheme::Gear(GearValues::Five) => corrector::<5>(model),
        GranularScheme::Gear(GearValues::Six) => corrector::<6>(model),
        _ => corrector::<4>(model),
    }
}

fn our_programs<S: Precision, P: Precision>(model: &GranularModel) -> Vec<StepProgram> {
    let (forces, fields) = with_law(model, LatticeSweep::<P>(model, PhantomData));
    let mut programs = vec![
        step(Part::Predictor, VectorLength::Grains, predictor::<S, P>(model)),
        step(Part::Index, VectorLength::PaddedCells, Box::new(Program::new(ClearIndex))),
        step(Part::Index, VectorLength::Discs, Box::new(Program::new(enter::<S, P>(model)))),
        step(Part::Index, VectorLength::Discs, Box::new(Program::new(CheckIndex))),
    ];
    if model.shape.periodic().contains(&true) {
        programs.push(step(Part::Index, VectorLength::HaloCells, Box::new(Program::new(IndexImages))));
    }
    let spread = SpreadToLattice::<P>::new(model.shape, model.coordinates, fields);
    programs.extend([
        step(Part::Lattice, VectorLength::PaddedCells, Box::new(Program::new(spread))),
        step(Part::Forces, VectorLength::SweptCells, forces),
    ]);
    if !model.walls.is_empty() {
        programs.push(step(
            Part::Walls,
            VectorLength::WallElements,
            with_wall_law(model.wall_law(), WallSweep::<P>(model, PhantomData)),
        ));
    }
    programs.push(step(Part::Corrector, VectorLength::Grains, corrector::<S, P>(model)));
    programs
}

fn enter<S: Precision, P: Precision>(model: &GranularModel) -> EnterDiscs<S, P> {
    let GranularModel { shape, frame, coordinates, .. } = *model;
    match model.is_anchored::<S>() {
        true => EnterDiscs::anchored(shape, frame),
        false => EnterDiscs::new(shape, frame, coordinates),
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
pub fn neighbour_list_ledger(model: &GranularModel) -> Ledger {
    neighbour_list_ledger_of::<f64, f64>(model)
}

/// Returns these operations with state of precision `S` and forces of precision `P`.
pub(super) fn neighbour_list_ledger_of<S: Precision, P: Precision>(model: &GranularModel) -> Ledger {
    let one_place = GranularModel { mask: Mask::single_offset(), ..model.clone() };
    let (law, _) = with_program_law(&one_place, LatticeSweep::<P>(&one_place, PhantomData));
    let part = Part::Forces.name();
    let mut ledger = Ledger::default();
    for step in programs_of::<S, P>(model) {
        match step.part {
            Part::Lattice => {}
            Part::Forces => {
                for (section, counts) in law.tally() {
                    let once = |op: Op| op.class() == OpClass::Store || op.class() == OpClass::Load;
                    let length = match section {
                        "distance" | "contact" => VectorLength::Candidates,
                        _ => VectorLength::Pairs,
                    };
                    let (of_disc, of_pair) = (counts.filtered(once), counts.filtered(|op| !once(op)));
                    for (length, counts) in [(VectorLength::Grains, of_disc), (length, of_pair)] {
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
pub(super) fn with_program_law<W: LawTask>(model: &GranularModel, task: W) -> W::Output {
    match model.text {
        ProgramVersion::Ours => with_law(model, task),
        ProgramVersion::Printed => task.with(printed::Printed { contact: model.contact }),
    }
}

/// Applies a task to the compiled variant of the law.
pub(super) fn with_law<W: LawTask>(model: &GranularModel, task: W) -> W::Output {
    let contact = model.contact;
    // Not read if discs vary.
    let any = EqualDiscs { radius: f64::NAN, inverse_mass: f64::NAN };
    match (model.friction, model.discs) {
        (true, DiscUniformity::Varying) => task.with(Granular::<true, false> { contact, disc: any }),
        (true, DiscUniformity::Equal { disc, .. }) => task.with(Granular::<true, true> { contact, disc }),
        (false, DiscUniformity::Varying) => task.with(Granular::<false, false> { contact, disc: any }),
        (false, DiscUniformity::Equal { disc, .. }) => task.with(Granular::<false, true> { contact, disc }),
    }
}

/// Applies a task to the integrator.
pub(super) fn with_scheme<W: SchemeTask>(model: &GranularModel, work: W) -> W::Output {
    let acceleration = model.acceleration();
    match model.scheme {
        GranularScheme::Gear(GearValues::Four) => work.with(Gear::<4>::new(acceleration)),
        GranularScheme::Gear(GearValues::Five) => work.with(Gear::<5>::new(acceleration)),
        GranularScheme::Gear(GearValues::Six) => work.with(Gear::<6>::new(acceleration)),
        GranularScheme::VelocityVerlet => work.with(VelocityVerlet),
    }
}

/// Scale factors of the derivatives in the state of the programs.
pub(super) fn scales(model: &GranularModel) -> [f64; DERIVATIVES] {
    if model.text == ProgramVersion::Printed {
        return [1.0; DERIVATIVES];
    }
    with_scheme(model, CarriedQuery { dt: model.dt }).scales
}

/// Lattice sweep of a law, and the quantities it needs.
struct LatticeSweep<'m, P>(&'m GranularModel, PhantomData<P>);

impl<P: Precision> LawTask for LatticeSweep<'_, P> {
    type Output = (Box<dyn Runnable>, &'static [ParticleField]);

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output {
        let GranularModel { mask, shape, frame, coordinates, .. } = self.0;
        let forces = Forces::<P, L>::new(law, mask, *shape, *frame, *coordinates).asked(self.0.asked());
        (Box::new(Program::new(forces)), L::FIELDS)
    }
}

/// Program of the plane walls for a law.
struct WallSweep<'m, P>(&'m GranularModel, PhantomData<P>);

impl<P: Precision> LawTask for WallSweep<'_, P> {
    type Output = Box<dyn Runnable>;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output {
        let equal = match self.0.discs {
            DiscUniformity::Equal { disc, .. } => Some(disc),
            DiscUniformity::Varying => None,
        };
        Box::new(Program::new(WallForces::<P, L>::new(law, equal)))
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

fn predictor<S: Precision, P: Precision>(model: &GranularModel) -> Box<dyn Runnable> {
    fn scheme<S: Precision, P: Precision, const VALUES: usize, const FREEDOMS: usize>(
        model: &GranularModel,
    ) -> Box<dyn Runnable> {
        Box::new(Program::new(GearPredictor::<S, P, VALUES, FREEDOMS>::new(model.dt)))
    }
    match (model.scheme, model.friction) {
        (GranularScheme::Gear(values), _) => for_scheme!(model, values, scheme),
        (GranularScheme::VelocityVerlet, true) => {
            Box::new(Program::new(VerletDrift::<S, P, 3>::new(model.dt)))
        }
        (GranularScheme::VelocityVerlet, false) => {
            Box::new(Program::new(VerletDrift::<S, P, 2>::new(model.dt)))
        }
    }
}

fn corrector<S: Precision, P: Precision>(model: &GranularModel) -> Box<dyn Runnable> {
    fn scheme<S: Precision, P: Precision, const VALUES: usize, const FREEDOMS: usize>(
        model: &GranularModel,
    ) -> Box<dyn Runnable> {
        let GranularModel { dt, gravity, .. } = *model;
        let corrector =
            GearCorrector::<S, P, VALUES, FREEDOMS>::new(dt, model.acceleration(), model.inertia(), gravity);
        Box::new(Program::new(if model.watch.is_some() { corrector.checked() } else { corrector }))
    }
    fn kick<S: Precision, P: Precision, const FREEDOMS: usize>(model: &GranularModel) -> Box<dyn Runnable> {
        let kick = VerletKick::<S, P, FREEDOMS>::new(model.dt, model.inertia(), model.gravity);
        Box::new(Program::new(if model.watch.is_some() { kick.checked() } else { kick }))
    }
    match (model.scheme, model.friction) {
        (GranularScheme::Gear(values), _) => for_scheme!(model, values, scheme),
        (GranularScheme::VelocityVerlet, true) => kick::<S, P, 3>(model),
        (GranularScheme::VelocityVerlet, false) => kick::<S, P, 2>(model),
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
        for range in lengths.ranges(step.length) {
            step.program.run(memory, range, execution, set)?;
        }
    }
    Ok(())
}
