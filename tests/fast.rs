//! Whole simulations in the fast engine: they agree with the programs except for rounding, have the same bits in every configuration, and
//! find every failure in the same step.

mod support;

use stripmine_kernels::law::granular::Contact;
use stripmine_kernels::sweep::lattice::LatticeShape;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::io::checkpoint::CheckpointColumn;
use stripmine_physics::method::SteppedState;
use stripmine_physics::method::lattice_md::GranularDocument;
use stripmine_physics::method::lattice_md::SteppedGrains;
use stripmine_physics::method::lattice_md::{
    ContactSearch, ContactWatch, FastSearch, GearValues, GranularModel, GranularScheme, OnConflict,
    ProgramExecution,
};
use stripmine_physics::method::{FailureKind, PhysicsFailure};
use stripmine_physics::observe::{Observation, SceneProperties};
use stripmine_physics::particles::{ParticleKind, Particles};
use stripmine_physics::scene::{Precision, WallMotion};
use support::{CONTACT, advance, arena, fast, gas, grain, simulate};

const LATTICE: FastSearch = FastSearch::Lattice(OnConflict::Stop);

/// All contact searches of the fast engine.
const SEARCHES: [FastSearch; 3] = [LATTICE, FastSearch::Sectors, FastSearch::Lists { skin: 0.15 }];

const SCHEMES: [GranularScheme; 4] = [
    GranularScheme::VelocityVerlet,
    GranularScheme::Gear(GearValues::Four),
    GranularScheme::Gear(GearValues::Five),
    GranularScheme::Gear(GearValues::Six),
];

fn bits(method: &SteppedGrains) -> Vec<(String, Vec<u64>)> {
    let bits = |column: CheckpointColumn| match column {
        CheckpointColumn::F64(values) => values.into_iter().map(f64::to_bits).collect(),
        CheckpointColumn::F32(values) => values.into_iter().map(|x| u64::from(x.to_bits())).collect(),
        CheckpointColumn::U32(values) => values.into_iter().map(u64::from).collect(),
        CheckpointColumn::U64(values) => values,
    };
    method.columns().into_iter().map(|(name, column)| (name, bits(column))).collect()
}

/// Largest differences of positions (length), with the nearest image, and of velocities.
fn differences(model: &GranularModel, a: &Particles, b: &Particles) -> [f64; 2] {
    let mut largest = [0.0_f64; 2];
    for (a, b) in a.all().iter().zip(b.all()) {
        assert_eq!(a.id, b.id);
        let [dx, dy] = model.domain().displacement(a.planar_position(), b.planar_position());
        let dv = [0, 1].map(|axis| a.velocity[axis] - b.velocity[axis]);
        let spin = (a.omega - b.omega).abs();
        largest = [largest[0].max(dx.hypot(dy)), largest[1].max(dv[0].hypot(dv[1])).max(spin)];
    }
    largest
}

#[test]
fn fast_engine_agrees_with_programs_except_for_rounding() {
    for scheme in SCHEMES {
        for (packing_fraction, friction) in [(0.84, true), (0.3, true), (0.1, false)] {
            let mut start = gas(400, packing_fraction, 7);
            (start.0.scheme, start.0.friction) = (scheme, friction);
            for (precision, bound) in
                [(Precision::F64, 1e-10), (Precision::Mixed, 1e-3), (Precision::F32, 1e-3)]
            {
                let mut faithful = simulate(precision, &start, ContactSearch::Lattice, fast());
                advance(&mut faithful, 300);
                let moved = differences(&start.0, &start.1, &faithful.particles());
                assert!(moved[0] > 0.1, "the discs must have moved: {moved:?}");
                for search in SEARCHES {
                    let mut other = simulate(precision, &start, ContactSearch::Fast(search), fast());
                    advance(&mut other, 300);
                    let off = differences(&start.0, &faithful.particles(), &other.particles());
                    let close = off[0] < bound && off[1] < 10.0 * bound;
                    assert!(close, "{search:?} {scheme:?} {precision:?}: {off:?}");
                }
            }
        }
    }
}

#[test]
fn walls_gravity_and_floor_agree_with_programs() {
    let mut discs = Vec::new();
    for column in 0..8u32 {
        let x = 0.5 + f64::from(column);
        let mut wall = grain(100 + column, [x, 1.0], [0.0; 2], 0.5, 1.0);
        wall.kind = ParticleKind::Wall;
        discs.push(wall);
        discs.push(grain(column, [x, 2.2 + 0.01 * f64::from(column)], [0.1, -0.2], 0.47, 0.9));
    }
    let (mut model, particles) = arena([16, 16], true, &discs);
    (model.contact, model.friction, model.gravity) = (CONTACT, true, [0.3, -1.0]);
    let walls = WallMotion::Oscillating { amplitude: [0.05, 0.2], frequency: 0.7 };
    for scheme in SCHEMES {
        model.scheme = scheme;
        let run = |contacts| {
            let (model, particles) = (model.clone(), particles.clone());
            let start = SteppedGrains::start;
            let mut method = start(Precision::F64, model, contacts, fast(), walls, particles).unwrap();
            advance(&mut method, 400);
            (method.particles(), method.totals())
        };
        let (faithful, deep) = run(ContactSearch::Lattice);
        for search in SEARCHES {
            let (other, also_deep) = run(ContactSearch::Fast(search));
            let off = differences(&model, &faithful, &other);
            assert!(off[0] < 1e-10 && off[1] < 1e-9, "{search:?} {scheme:?}: {off:?}");
            assert_eq!(deep.deep_disc_steps, also_deep.deep_disc_steps);
            assert!((deep.deepest - also_deep.deepest).abs() < 1e-9);
        }
    }
}

/// Enough discs that building lists and sorting are split among threads.
#[test]
fn lists_and_order_do_not_depend_on_threads() {
    let mut start = gas(40_000, 0.3, 5);
    (start.0.scheme, start.0.dt) = (GranularScheme::VelocityVerlet, 0.02);
    for (search, precision) in [
        (FastSearch::Sectors, Precision::F64),
        (FastSearch::Lists { skin: 0.02 }, Precision::F64),
        (FastSearch::Lists { skin: 0.02 }, Precision::Mixed),
    ] {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut gas = simulate(precision, &start, ContactSearch::Fast(search), fast());
                advance(&mut gas, 5);
                assert!(gas.lists().is_none_or(|(_, made)| made > 1), "lists must be rebuilt");
                (bits(&gas), gas.lists())
            })
        };
        let alone = run(1);
        for threads in [2, 3] {
            assert!(run(threads) == alone, "{search:?} on {threads} threads");
        }
    }
}

#[test]
fn threads_instructions_and_resumption_give_the_same_bits() {
    // Long enough for lists to be rebuilt.
    const STEPS: u64 = 60;
    let (lattice, [_, sectors, lists]) = (LATTICE, SEARCHES);
    for (search, packing_fraction, precision) in [
        (lattice, 0.84, Precision::F64),
        (lattice, 0.1, Precision::F64),
        (lattice, 0.84, Precision::Mixed),
        (sectors, 0.3, Precision::F64),
        (lists, 0.84, Precision::F32),
        (lists, 0.1, Precision::F64),
    ] {
        let mut start = gas(8200, packing_fraction, 3);
        start.0.scheme = GranularScheme::VelocityVerlet;
        let run = |threads: usize, set: InstructionSet| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let machine = ProgramExecution { execution: Execution::Chained, set };
                let mut gas = simulate(precision, &start, ContactSearch::Fast(search), machine);
                advance(&mut gas, STEPS);
                bits(&gas)
            })
        };
        let scalar = run(1, InstructionSet::Scalar);
        for set in InstructionSet::available() {
            for threads in [1, 2, 3] {
                assert!(run(threads, set) == scalar, "{search:?} {} on {threads} threads", set.name());
            }
        }
        let mut first = simulate(precision, &start, ContactSearch::Fast(search), fast());
        advance(&mut first, 37);
        let mut second = simulate(precision, &start, ContactSearch::Fast(search), fast());
        second.restore(37, first.totals(), &first.columns()).unwrap();
        assert!(second.particles() == first.particles());
        advance(&mut second, STEPS - 37);
        assert!(bits(&second) == scalar, "{search:?}: a resumed run differs");
    }
}

/// Cells so wide that many hold two discs and some three: the discs that the lattice has no cell for feel the same forces.
#[test]
fn discs_sharing_a_cell_feel_the_same_forces() {
    for (scheme, edge) in
        [(GranularScheme::VelocityVerlet, 1.0), (GranularScheme::Gear(GearValues::Five), 1.2)]
    {
        let mut start = gas(400, 0.8, 9);
        let sides = start.0.domain().lengths();
        let counts = sides.map(|side| (side / edge) as usize);
        start.0.shape = LatticeShape::new(counts[0], counts[1], &start.0.mask, [true; 2]).unwrap();
        start.0.frame.edge = [0, 1].map(|axis| sides[axis] / counts[axis] as f64);
        start.0.scheme = scheme;
        let run = |search: FastSearch, set: InstructionSet| {
            let machine = ProgramExecution { execution: Execution::Chained, set };
            let mut gas = simulate(Precision::F64, &start, ContactSearch::Fast(search), machine);
            advance(&mut gas, 300);
            gas
        };
        let resolve = FastSearch::Lattice(OnConflict::Resolve);
        let (rival, resolved) = (run(FastSearch::Sectors, fast().set), run(resolve, fast().set));
        let off = differences(&start.0, &rival.particles(), &resolved.particles());
        assert!(off[0] < 1e-10 && off[1] < 1e-9, "{off:?}");
        let conflicts = resolved.totals().shared_cells;
        assert!(conflicts > 300, "{conflicts} in 300 steps");
        assert_eq!(rival.totals().shared_cells, 0);
        let scalar = run(resolve, InstructionSet::Scalar);
        assert!(bits(&scalar) == bits(&resolved));
        assert_eq!(scalar.totals(), resolved.totals());
        // The choice of the disc that keeps a shared cell depends on the state only, not on its history.
        let mut first = simulate(Precision::F64, &start, ContactSearch::Fast(resolve), fast());
        advance(&mut first, 111);
        let mut second = simulate(Precision::F64, &start, ContactSearch::Fast(resolve), fast());
        second.restore(111, first.totals(), &first.columns()).unwrap();
        advance(&mut second, 189);
        assert!(bits(&second) == bits(&resolved), "a resumed run differs");
        assert_eq!(second.totals(), resolved.totals());
        let begin = SteppedGrains::start;
        let (model, particles) = start.clone();
        let stopped =
            begin(Precision::F64, model, ContactSearch::Fast(LATTICE), fast(), WallMotion::Fixed, particles);
        let stopped = stopped.err().expect("two discs in one cell");
        assert_eq!((stopped.kind, stopped.at.map(|clock| clock.steps)), (FailureKind::CONFLICT, Some(0)));
    }
}

/// Forces of all pairs of elastic discs, from the textbook formula.
fn naive_forces(model: &GranularModel, discs: &Particles) -> Vec<[f64; 2]> {
    let mut forces = vec![[0.0; 2]; discs.len()];
    for (i, a) in discs.all().iter().enumerate() {
        for (j, b) in discs.all().iter().enumerate().skip(i + 1) {
            let displacement = model.domain().displacement(a.planar_position(), b.planar_position());
            let distance = displacement[0].hypot(displacement[1]);
            let depth = (a.radius + b.radius - distance).max(0.0);
            for axis in 0..2 {
                let force = model.contact.stiffness * depth.powf(1.5) * displacement[axis] / distance;
                forces[i][axis] -= force;
                forces[j][axis] += force;
            }
        }
    }
    forces
}

/// Size ratios that no lattice can hold, compared with a textbook velocity Verlet.
#[test]
fn wide_size_ratios_work_with_sectors_and_lists() {
    const STEPS: u64 = 1000;
    let load = |overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        GranularDocument::load("wide-sizes", &overrides).and_then(GranularDocument::check)
    };
    let few = ["domain.sides=[20, 18]", "particles.packing_fraction=0.3"];
    let checked = load(&few).unwrap_or_else(|errors| panic!("{errors}"));
    let (model, dt) = (stripmine_physics::method::lattice_md::model(&checked), 0.002);
    let mut expected = checked.particles.clone();
    let radii = expected.radii().unwrap();
    assert!(radii[1] / radii[0] > 5.0, "{radii:?}");
    let mut forces = naive_forces(&model, &expected);
    for _ in 0..STEPS {
        let kick = |discs: &mut Particles, forces: &[[f64; 2]]| {
            for (disc, force) in discs.all_mut().iter_mut().zip(forces) {
                (0..2).for_each(|axis| disc.velocity[axis] += 0.5 * dt * force[axis] / disc.mass);
            }
        };
        kick(&mut expected, &forces);
        for disc in expected.all_mut() {
            (0..2).for_each(|axis| disc.position[axis] += dt * disc.velocity[axis]);
        }
        forces = naive_forces(&model, &expected);
        kick(&mut expected, &forces);
    }
    let moved = differences(&model, &checked.particles, &expected);
    assert!(moved[0] > 0.5 && moved[1] > 0.1, "the discs must have moved and collided: {moved:?}");
    for kind in ["sectors", "neighbor-list"] {
        let checked = load(&[&few[..], &[&format!("search.by={kind}")]].concat()).unwrap();
        let mut method = stripmine_physics::method::lattice_md::assemble(&checked).unwrap();
        advance(&mut method, STEPS);
        let off = differences(&model, &expected, &method.particles());
        assert!(off[0] < 1e-9 && off[1] < 1e-8, "{kind}: {off:?}");
    }
    let refused = load(&["search.by=lattice"]).unwrap_err().to_string();
    assert!(refused.contains("or set search.by = \"sectors\""), "{refused}");
}

#[test]
fn momentum_is_conserved_to_rounding() {
    let mut start = gas(400, 0.84, 5);
    start.0.scheme = GranularScheme::VelocityVerlet;
    let mut gas = simulate(Precision::F64, &start, ContactSearch::Fast(LATTICE), fast());
    let observe = |gas: &SteppedGrains| {
        Observation::of(gas.steps(), 0.0, &gas.particles(), &SceneProperties::of(&start.0))
    };
    let first = observe(&gas);
    advance(&mut gas, 2000);
    let seen = observe(&gas);
    let lost = (seen.momentum_x - first.momentum_x).hypot(seen.momentum_y - first.momentum_y);
    assert!(lost < 1e-12, "{lost:e}");
    assert!(seen.kinetic < 0.99 * first.kinetic, "the gas must have collided and cooled");
}

/// Without damping, velocity Verlet in the fast engine conserves energy as well as Gear's scheme in the programs.
#[test]
fn energy_is_conserved_over_ten_thousand_steps() {
    let drift = |scheme: GranularScheme, contacts: ContactSearch| {
        let mut start = gas(400, 0.84, 11);
        start.0.contact = Contact { normal_damping: 0.0, shear_damping: 0.0, friction: 0.0, ..CONTACT };
        (start.0.friction, start.0.scheme) = (false, scheme);
        let mut gas = simulate(Precision::F64, &start, contacts, fast());
        let energy = |gas: &SteppedGrains| {
            Observation::of(gas.steps(), 0.0, &gas.particles(), &SceneProperties::of(&start.0)).energy()
        };
        let first = energy(&gas);
        (0..10)
            .map(|_| {
                advance(&mut gas, 1000);
                (energy(&gas) / first - 1.0).abs()
            })
            .fold(0.0, f64::max)
    };
    let verlet = drift(GranularScheme::VelocityVerlet, ContactSearch::Fast(LATTICE));
    let gear = drift(GranularScheme::Gear(GearValues::Five), ContactSearch::Lattice);
    println!("largest error of the energy: velocity Verlet {verlet:.1e}, Gear {gear:.1e}");
    assert!(verlet < 1e-4, "{verlet:e}");
    assert!(gear < 1e-3, "{gear:e}");
}

/// A simulation fails in the same step and with the same discs as with the programs.
#[test]
fn failures_are_found_in_their_step() {
    let lost = [
        grain(7, [2.0, 2.0], [0.0; 2], 0.5, 1.0),
        grain(31, [7.6975, 5.25], [1.0, 0.1], 0.5, 1.0),
        grain(8, [2.0, 5.0], [0.1, 0.0], 0.5, 1.0),
    ];
    let closing = [
        grain(1, [3.0, 3.2], [4.0, 0.0], 0.5, 1.0),
        grain(2, [4.3, 3.2], [-4.0, 0.0], 0.5, 1.0),
        grain(3, [6.6, 6.2], [0.0, 0.0], 0.5, 1.0),
    ];
    let mut nan = gas(400, 0.84, 2);
    nan.1.all_mut()[123].velocity[1] = f64::NAN;
    let with = |stop: f64| {
        let mut start = arena([16, 16], false, &closing);
        start.0.contact.stiffness = 1e-6;
        start.0.watch = Some(ContactWatch::new(0.1, stop, 0.5));
        start
    };
    let cases = [arena([16, 16], false, &lost), with(0.4), nan, with(0.99)];
    // Two discs in one cell are an error for the lattice only.
    let runs = SEARCHES.into_iter().flat_map(|search| {
        let apply = if search == LATTICE { 4 } else { 3 };
        cases.iter().take(apply).cloned().map(move |start| (search, start))
    });
    for (search, mut start) in runs {
        start.0.scheme = GranularScheme::Gear(GearValues::Five);
        let failure = |contacts| -> PhysicsFailure {
            let start = start.clone();
            let (model, particles) = start;
            let begin = SteppedGrains::start;
            let mut method =
                match begin(Precision::F64, model, contacts, fast(), WallMotion::Fixed, particles) {
                    Ok(method) => method,
                    Err(failure) => return failure,
                };
            (0..200).find_map(|_| method.step().err()).expect("something breaks")
        };
        let (faithful, other) = (failure(ContactSearch::Lattice), failure(ContactSearch::Fast(search)));
        assert_eq!(faithful.kind, other.kind, "{faithful}\nbut {other}");
        let value = |name: &str| [&faithful, &other].map(|failure| failure.value(name).unwrap());
        match faithful.kind {
            FailureKind::NOT_FINITE => assert_eq!(faithful.culprits[0].id, other.culprits[0].id),
            _ => assert_eq!(faithful.at, other.at, "{search:?}"),
        }
        match faithful.kind {
            FailureKind::OUT_OF_BOX => {
                let (first, disc) = (faithful.culprits[0], other.culprits[0]);
                assert_eq!(first.id, disc.id);
                assert!((first.position[0] - disc.position[0]).abs() < 1e-9);
            }
            FailureKind::TOO_DEEP => {
                let [penetration, also] = value("penetration");
                assert!((penetration - also).abs() < 1e-9);
            }
            FailureKind::CONFLICT => {
                let [distance, also] = value("distance");
                assert!((distance - also).abs() < 1e-9, "{distance} {also}");
            }
            _ => {}
        }
    }
}
