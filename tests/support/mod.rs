//! Small systems for the tests of the lattice method.
#![allow(dead_code, reason = "each test file uses its part")]

use rand::RngExt;
use stripmine_kernels::law::granular::{Contact, ContactArm};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame, LatticeShape};
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::SteppedGrains;
use stripmine_physics::method::lattice_md::{
    ContactSearch, ContactWatch, DiscUniformity, GearValues, GranularModel, GranularScheme, ProgramExecution,
    ProgramVersion,
};
use stripmine_physics::particles::{Particle, ParticleKind, Particles, in_space};
use stripmine_physics::placement::hexagonal;
use stripmine_physics::scene::{Precision, WallMotion};

pub const CONTACT: Contact = Contact {
    spring: Spring::Hertz,
    stiffness: 187.0,
    normal_damping: 0.05,
    shear_damping: 0.02,
    friction: 0.5,
    cohesionless: true,
    arm: ContactArm::Radius,
};

pub fn fast() -> ProgramExecution {
    ProgramExecution { execution: Execution::Chained, set: InstructionSet::best() }
}

/// A dense periodic gas of discs with radii that vary by 5 %, and spins.
pub fn gas(least: usize, packing_fraction: f64, seed: u64) -> (GranularModel, Particles) {
    let packing = hexagonal(least, packing_fraction, 0.01, seed);
    let mut particles = packing.particles;
    let mut random = Stream::new(seed, RandomPurpose::Test, 0);
    for disc in particles.all_mut() {
        disc.radius = random.random_range(0.45..0.5);
        disc.mass = 4.0 * disc.radius * disc.radius;
        disc.omega = random.random_range(-0.1..0.1);
    }
    let mask = Mask::square(2);
    let counts = packing.sides.map(|side| (side / 0.5) as usize);
    let edge = [packing.sides[0] / counts[0] as f64, packing.sides[1] / counts[1] as f64];
    let model = GranularModel {
        text: ProgramVersion::Ours,
        shape: LatticeShape::new(counts[0], counts[1], &mask, [true; 2]).unwrap(),
        frame: LatticeFrame { origin: [0.0; 2], edge },
        sides: [0, 1].map(|axis| counts[axis] as f64 * edge[axis]),
        mask,
        coordinates: Coordinates::CellRelative,
        walls: std::sync::Arc::default(),
        lines: vec![],
        contact: CONTACT,
        friction: true,
        discs: DiscUniformity::Varying,
        inertia_factor: 0.5,
        scheme: GranularScheme::Gear(GearValues::Five),
        dt: 0.005,
        gravity: [0.0; 2],
        watch: Some(ContactWatch::new(0.1, 0.3, 0.45)),
    };
    (model, particles)
}

/// The gas of [`gas`] for BP93's own program, which has no clamp and measures positions from the origin.
pub fn printed_gas(least: usize, packing_fraction: f64, seed: u64) -> (GranularModel, Particles) {
    let (model, particles) = gas(least, packing_fraction, seed);
    let contact = Contact { cohesionless: false, ..model.contact };
    let coordinates = Coordinates::Absolute;
    (GranularModel { text: ProgramVersion::Printed, contact, coordinates, ..model }, particles)
}

/// Starts a simulation. Compiled in the library, so that test files build fast.
pub fn simulate(
    precision: Precision,
    (model, particles): &(GranularModel, Particles),
    contacts: ContactSearch,
    machine: ProgramExecution,
) -> SteppedGrains {
    SteppedGrains::start(precision, model.clone(), contacts, machine, WallMotion::Fixed, particles.clone())
        .unwrap()
}

pub fn advance(method: &mut SteppedGrains, steps: u64) {
    for _ in 0..steps {
        method.step().unwrap();
    }
}

/// A model in a box of `cells` cells of side 0.5 whose corner is the origin: no damping, no friction.
pub fn arena(cells: [usize; 2], periodic: bool, discs: &[Particle]) -> (GranularModel, Particles) {
    let (mut model, _) = gas(12, 0.5, 1);
    model.shape = LatticeShape::new(cells[0], cells[1], &model.mask, [periodic; 2]).unwrap();
    model.frame = LatticeFrame { origin: [0.0; 2], edge: [0.5; 2] };
    model.sides = cells.map(|count| 0.5 * count as f64);
    model.contact = Contact { normal_damping: 0.0, shear_damping: 0.0, friction: 0.0, ..CONTACT };
    model.friction = false;
    (model, Particles::new(discs.to_vec()))
}

/// A grain without spin.
pub fn grain(id: u32, position: [f64; 2], velocity: [f64; 2], radius: f64, mass: f64) -> Particle {
    let (position, velocity) = (in_space(position), in_space(velocity));
    Particle {
        id,
        kind: ParticleKind::Grain,
        species: 0,
        position,
        velocity,
        angle: 0.0,
        omega: 0.0,
        radius,
        mass,
    }
}
