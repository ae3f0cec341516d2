//! Scene of the benches: a dense packing of discs with all contacts active.

use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::Storage;
use stripmine_kernels::law::granular::{Contact, ContactArm};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame, LatticeShape};
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::{
    DiscUniformity, GearValues, GranularModel, GranularScheme, Part, ProgramArrays, ProgramVersion,
    StepProgram, execute, programs,
};
use stripmine_physics::particles::Particles;
use stripmine_physics::placement::hexagonal;
use stripmine_physics::scene;

pub const CONTACT: Contact = Contact {
    spring: Spring::Hertz,
    stiffness: 187.0,
    normal_damping: 1e-6,
    shear_damping: 3e-7,
    friction: 0.5,
    cohesionless: true,
    arm: ContactArm::Radius,
};

/// A dense packing (0.84) on a lattice of about `cells` cells as wide as the radius.
pub fn dense<P: Precision>(
    cells: usize,
    friction: bool,
) -> (GranularModel, Particles, ProgramArrays<f64, P>) {
    let packing = hexagonal((cells as f64 * 0.84 / std::f64::consts::PI) as usize, 0.84, 0.01, 1);
    let radius = 0.5;
    let counts = packing.sides.map(|side| (side / radius) as usize);
    let edge = [packing.sides[0] / counts[0] as f64, packing.sides[1] / counts[1] as f64];
    let mask = Mask::square(2);
    let model = GranularModel {
        text: ProgramVersion::Ours,
        shape: LatticeShape::new(counts[0], counts[1], &mask, [true; 2]).expect("large enough"),
        frame: LatticeFrame { origin: [0.0; 2], edge },
        sides: [0, 1].map(|axis| counts[axis] as f64 * edge[axis]),
        mask,
        coordinates: Coordinates::CellRelative,
        walls: std::sync::Arc::default(),
        lines: vec![],
        contact: CONTACT,
        friction,
        discs: DiscUniformity::Varying,
        scheme: GranularScheme::Gear(GearValues::Four),
        inertia_factor: 0.5,
        watch: None,
        dt: 0.005,
        gravity: [0.0; 2],
    };
    let mut arrays = ProgramArrays::new(&model, &packing.particles);
    warm_up::<P>(&programs_of::<P>(&model), &mut arrays);
    (model, packing.particles, arrays)
}

/// Programs of a step with forces of the given precision.
pub fn programs_of<P: Precision>(model: &GranularModel) -> Vec<StepProgram> {
    let is_double = P::NAME == f64::NAME;
    programs(model, if is_double { scene::Precision::F64 } else { scene::Precision::Mixed })
}

/// Runs the parts of a step before the forces.
pub fn warm_up<P: Precision>(steps: &[StepProgram], arrays: &mut ProgramArrays<f64, P>) {
    let before = [Part::Predictor, Part::Index, Part::Lattice];
    let (memory, lengths) = arrays.memory();
    execute(steps, &before, &memory, lengths, Execution::Chained, InstructionSet::best()).expect("bound");
}
