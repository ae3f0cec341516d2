//! Observables of granular discs: the same sums with every engine, in every order of work, in one piece or resumed.

use rand::RngExt;
use serde_json::{Map, Value};
use std::sync::atomic::AtomicBool;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::law::granular::{Contact, ContactArm};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::noise::{RandomPurpose as Draw, Stream};
use stripmine_physics::domain::Domain;
use stripmine_physics::method::lattice_md::{GranularDocument, model};
use stripmine_physics::method::{METHODS, Simulation, StartPurpose, Until, load};
use stripmine_physics::observe::{Observation, SceneProperties};
use stripmine_physics::particles::{Particle, ParticleKind, Particles, in_space};

/// Overrides of a scene.
type Sets<'a> = &'a [&'a str];

fn owned(sets: &[Sets<'_>]) -> Vec<String> {
    sets.iter().flat_map(|sets| sets.iter()).map(|&set| set.to_owned()).collect()
}

fn begin(scene: &str, sets: &[Sets<'_>]) -> Box<dyn Simulation> {
    let prepared = GranularDocument::load(scene, &owned(sets)).unwrap().prepare().unwrap();
    prepared.start(StartPurpose::Run).unwrap()
}

fn advance(simulation: &mut dyn Simulation, steps: u64) {
    simulation.advance(&[Until::Steps(steps)], &AtomicBool::new(false)).unwrap();
}

fn scenery(scene: &str, sets: &[Sets<'_>]) -> SceneProperties {
    SceneProperties::of(&model(&GranularDocument::load(scene, &owned(sets)).unwrap().check().unwrap()))
}

/// Index of a quantity in a row.
fn column(name: &str) -> usize {
    let quantities = stripmine_physics::method::lattice_md::ENTRY.quantities;
    quantities.iter().position(|quantity| quantity.name == name).unwrap()
}

/// All configurations that advance granular discs.
const CONFIGURATIONS: [Sets<'static>; 8] = [
    &["machine.engine=fast", "search.by=lattice"],
    &["machine.engine=fast", "search.by=sectors"],
    &["machine.engine=fast", "search.by=neighbor-list"],
    &["machine.engine=fast", "search.by=neighbor-list", "machine.precision=f32"],
    &["machine.engine=fast", "search.by=lattice", "machine.precision=mixed"],
    &["machine.engine=programs", "search.by=lattice"],
    &["machine.engine=programs", "search.by=lattice", "machine.precision=f32"],
    &["machine.engine=programs", "search.by=neighbor-list"],
];

/// Scenes with damping, friction, spins, fixed and moving walls, gravity along a periodic side, and with none of these; and
/// dense ones, on whose lattice registers of cells are compared.
const SCENES: [(&str, Sets<'static>); 5] = [
    ("pipe-small", &[]),
    ("shaken-box", &["law.contact_arm=lammps"]),
    ("bench", &["particles.count=1500", "particles.packing_fraction=0.84", "law.contact_arm=overlap"]),
    ("dense-gas", &["particles.packing_fraction=0.70"]),
    ("bench", &["particles.count=800", "integrator.kind=velocity-verlet", "law.cohesionless=false"]),
];

/// A row compared with naive sums over the current particles.
#[test]
fn rows_agree_with_naive_sums() {
    for (scene, of_scene) in SCENES {
        for configuration in CONFIGURATIONS {
            let sets = [of_scene, configuration];
            let scenery = scenery(scene, &sets);
            let mut simulation = begin(scene, &sets);
            for steps in [0, 30, 120] {
                advance(simulation.as_mut(), steps);
                let row = simulation.observe();
                let particles = simulation.particles();
                let naive = Observation::of(steps, simulation.clock().time, &particles, &scenery);
                assert_eq!(
                    row[column("contacts")],
                    naive.contacts as f64,
                    "{scene} {configuration:?} {steps}"
                );
                // The error of a sum that nearly cancels is the rounding of its terms.
                let count = particles.grain_count() as f64;
                let energy = naive.kinetic + naive.elastic + naive.rotational;
                let mass: f64 = particles.grains().iter().map(|grain| grain.mass).sum();
                let momentum = (2.0 * mass * naive.kinetic).sqrt();
                let area = scenery.domain.area();
                let speed = (2.0 * naive.kinetic / mass).sqrt();
                for (name, expected, scale) in [
                    ("time", naive.time, 0.0),
                    ("kinetic", naive.kinetic, energy),
                    ("rotational", naive.rotational, energy),
                    ("elastic", naive.elastic, energy),
                    ("gravitational", naive.gravitational, naive.gravitational.abs()),
                    ("momentum_x", naive.momentum_x, momentum),
                    ("momentum_y", naive.momentum_y, momentum),
                    ("temperature", naive.temperature, energy / count),
                    ("pressure", naive.pressure, naive.pressure.abs().max(energy / area)),
                    ("flow", naive.flow, speed),
                    ("deepest_penetration", naive.deepest_penetration, 0.1),
                ] {
                    let off = (row[column(name)] - expected).abs();
                    assert!(
                        off <= 2e-11 * scale,
                        "{scene} {configuration:?} {steps}: {name} differs by {off}, scale {scale}"
                    );
                }
            }
        }
    }
}

fn bits(row: &[f64]) -> Vec<u64> {
    row.iter().map(|value| value.to_bits()).collect()
}

/// Threads and instructions do not change a bit, with more discs than a single thread handles.
#[test]
fn rows_do_not_depend_on_threads_or_instructions() {
    for configuration in &CONFIGURATIONS[..5] {
        let row = |threads: usize, set: InstructionSet| {
            let instructions = format!("machine.instruction_set={}", set.name());
            let sets: [Sets<'_>; 3] = [
                &["particles.count=6000", "particles.packing_fraction=0.80"],
                configuration,
                &[&instructions],
            ];
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut simulation = begin("bench", &sets);
                advance(simulation.as_mut(), 30);
                bits(&simulation.observe())
            })
        };
        let first = row(1, InstructionSet::best());
        assert_eq!(row(3, InstructionSet::best()), first, "{configuration:?}");
        for set in InstructionSet::available() {
            assert_eq!(row(2, set), first, "{configuration:?} by {set:?}");
        }
    }
}

/// The summary without entries that belong to the session only.
fn of_the_run(simulation: &dyn Simulation) -> (Map<String, Value>, String) {
    (simulation.summary(), simulation.in_words())
}

/// A resumed run, at once and after more steps, reports the same as a run in one piece: grains that have crossed periodic
/// sides are not counted again, and counters do not restart.
#[test]
fn resumed_runs_report_as_uninterrupted_ones() {
    let more: [Sets<'_>; 3] = [
        &["machine.engine=programs", "machine.execution=eager", "search.by=lattice"],
        &["machine.engine=programs", "machine.coordinates=absolute", "search.by=lattice"],
        &["machine.engine=programs", "machine.precision=f32", "search.by=neighbor-list"],
    ];
    for (scene, of_scene, [cut, end]) in
        [("pipe-small", &[][..], [500, 600]), ("shaken-box", &["particles.count=40"], [150, 200])]
    {
        for configuration in CONFIGURATIONS.into_iter().chain(more) {
            let sets = [of_scene, configuration];
            let mut whole = begin(scene, &sets);
            advance(whole.as_mut(), cut);
            let (clock, snapshot) = (whole.clock(), whole.snapshot());
            let mut resumed = begin(scene, &sets);
            resumed.restore(clock, snapshot).unwrap();
            for steps in [cut, cut + 1, end] {
                advance(whole.as_mut(), steps);
                advance(resumed.as_mut(), steps);
                let what = format!("{scene} {configuration:?} after {steps} of {cut}");
                assert_eq!(bits(&resumed.observe()), bits(&whole.observe()), "{what}");
                assert_eq!(of_the_run(resumed.as_ref()), of_the_run(whole.as_ref()), "{what}");
                assert_eq!(resumed.warnings(), whole.warnings(), "{what}");
            }
            assert!(
                scene != "pipe-small" || whole.warnings().is_empty(),
                "{configuration:?}: {:?}",
                whole.warnings()
            );
        }
    }
}

/// Counters of lists continue in the engine shared by all methods.
#[test]
fn list_counters_continue_in_other_methods() {
    let sets = owned(&[&["search.by=neighbor-list", "run.steps=200"]]);
    let begin = || {
        let (prepared, _) = load("langevin-dense", &sets, METHODS).unwrap();
        prepared.start(StartPurpose::Run).unwrap()
    };
    let mut whole = begin();
    advance(whole.as_mut(), 100);
    let (clock, snapshot) = (whole.clock(), whole.snapshot());
    let mut resumed = begin();
    resumed.restore(clock, snapshot).unwrap();
    for steps in [100, 200] {
        advance(whole.as_mut(), steps);
        advance(resumed.as_mut(), steps);
        assert_eq!(resumed.summary(), whole.summary());
    }
    assert!(whole.summary()["lists_made"].as_u64() > Some(2));
}

/// A disc on the lower rim of a periodic side has not crossed it, wherever rounding places it.
#[test]
fn disc_on_the_rim_has_not_crossed() {
    for origin in ["0.0", "0.1", "-0.7", "1e3", "-3.3", "0.3"] {
        for configuration in CONFIGURATIONS {
            let origin_of_box = format!("domain.origin=[{origin}, {origin}]");
            let position = format!("particles.positions=[[{origin}, {origin}]]");
            let sets: [Sets<'_>; 2] = [
                &[
                    "domain.sides=[7.3, 7.3]",
                    "domain.periodic=[true, true]",
                    "domain.gravity=[0.0, -1.0]",
                    &origin_of_box,
                    &position,
                    "particles.velocities=[[0.0, 0.0]]",
                    "particles.omegas=[0.0]",
                ],
                configuration,
            ];
            let mut simulation = begin("two-discs", &sets);
            let work = |simulation: &dyn Simulation| simulation.observe()[column("gravity_work")];
            assert_eq!(work(simulation.as_ref()), 0.0, "{origin} {configuration:?}");
            advance(simulation.as_mut(), 100);
            // m g (g t²/2), with rounding of positions in single precision.
            let expected = 0.5 * 0.1 * 0.1;
            assert!(
                (work(simulation.as_ref()) - expected).abs() < 1e-2 * expected,
                "{origin} {configuration:?}"
            );
        }
    }
}

/// Observation has its own phase, and is carried out once for any number of callers.
#[test]
fn observation_is_computed_once() {
    let mut simulation = begin("dense-gas", &[]);
    advance(simulation.as_mut(), 10);
    simulation.reset_phases();
    assert!(!simulation.phases().contains_key("observe"));
    simulation.observe();
    let once = simulation.phases()["observe"];
    assert!(once > 0.0);
    simulation.observe();
    simulation.summary();
    simulation.warnings();
    simulation.in_words();
    assert_eq!(simulation.phases()["observe"], once);
}

/// Pressure of random discs and walls, by the explicit formula: (K + ½ Σ F_N |r_i − r_j|)/A over the contacts between grains, with
/// their kinetic energy K about the mean motion along x, which is periodic, F_N = max(k_N ξ^{3/2} − γ_N M_eff (v_i − v_j)·n, 0).
#[test]
fn pressure_agrees_with_the_formula() {
    let domain = Domain::planar([-1.0, 2.0], [7.0, 9.0], [true, false]);
    let mut by_damping = 0.0;
    for seed in 0..20 {
        let mut random = Stream::new(seed, Draw::Test, 0);
        let mut spread = |width: f64| random.random_range(-0.5 * width..=0.5 * width);
        let contact = Contact {
            spring: Spring::Hertz,
            stiffness: 18.7,
            normal_damping: 4.0 + spread(4.0),
            shear_damping: 3.0,
            friction: 0.5,
            cohesionless: seed % 2 == 0,
            arm: [ContactArm::Radius, ContactArm::Overlap, ContactArm::Lammps][seed as usize % 3],
        };
        let discs = (0..60).map(|id| Particle {
            id,
            kind: if id % 7 == 0 { ParticleKind::Wall } else { ParticleKind::Grain },
            species: 0,
            position: in_space([2.5 + spread(7.0), 6.5 + spread(9.0)]),
            velocity: in_space([spread(4.0), spread(4.0)]),
            angle: 0.0,
            omega: spread(8.0),
            radius: 0.5 + spread(0.1),
            mass: 1.0 + spread(1.0),
        });
        let particles = Particles::new(discs.collect());
        let scenery = SceneProperties { domain, contact, gravity: [0.0; 2], inertia_factor: 0.5 };
        let seen = Observation::of(0, 0.0, &particles, &scenery);
        let grains = particles.grains();
        let (mut virial, mut undamped) = (0.0, 0.0);
        for (i, a) in grains.iter().enumerate() {
            for b in &grains[..i] {
                let mut x = a.position[0] - b.position[0];
                x -= (x / 7.0).round() * 7.0;
                let y = a.position[1] - b.position[1];
                let distance = (x * x + y * y).sqrt();
                let depth = a.radius + b.radius - distance;
                if depth > 0.0 {
                    let effective = a.mass * b.mass / (a.mass + b.mass);
                    let [u, v] = [0, 1].map(|axis| a.velocity[axis] - b.velocity[axis]);
                    let parting = (u * x + v * y) / distance;
                    let spring = contact.stiffness * depth.powf(1.5);
                    let force = spring - contact.normal_damping * effective * parting;
                    virial += distance * if contact.cohesionless { force.max(0.0) } else { force };
                    undamped += distance * spring;
                }
            }
        }
        let sum = |of: fn(&Particle) -> f64| grains.iter().map(of).sum::<f64>();
        let along = sum(|it| it.mass * it.velocity[0]).powi(2) / sum(|it| it.mass);
        let kinetic =
            sum(|it| 0.5 * it.mass * (it.velocity[0].powi(2) + it.velocity[1].powi(2))) - 0.5 * along;
        let expected = (kinetic + 0.5 * virial) / 63.0;
        assert!((seen.pressure / expected - 1.0).abs() < 1e-12, "{} instead of {expected}", seen.pressure);
        by_damping += (virial / undamped - 1.0).abs();
    }
    assert!(by_damping > 0.1, "damping must contribute");
}

/// Temperatures by hand: masses 1 and 3 with velocities (1, 2) and (−1, 0) have Σ m v² = (4, 4) and Σ m v = (−2, 2), a mean motion of
/// 1 along each axis. Along periodic axes it is no heat, and one of two degrees of freedom is left; along closed axes all count.
#[test]
fn temperatures_count_the_degrees_of_freedom() {
    let disc = |id, position, velocity, mass| Particle {
        id,
        kind: ParticleKind::Grain,
        species: 0,
        position: in_space(position),
        velocity: in_space(velocity),
        angle: 0.0,
        omega: 0.0,
        radius: 0.5,
        mass,
    };
    let two = [disc(1, [2.0, 2.0], [1.0, 2.0], 1.0), disc(2, [7.0, 3.0], [-1.0, 0.0], 3.0)];
    let contact = Contact {
        spring: Spring::Hertz,
        stiffness: 18.7,
        normal_damping: 0.0,
        shear_damping: 0.0,
        friction: 0.0,
        cohesionless: true,
        arm: ContactArm::Radius,
    };
    let seen = |discs: &[Particle], periodic| {
        let domain = Domain::planar([0.0; 2], [10.0, 9.0], periodic);
        let scenery = SceneProperties { domain, contact, gravity: [0.0; 2], inertia_factor: 0.5 };
        let seen = Observation::of(0, 0.0, &Particles::new(discs.to_vec()), &scenery);
        [seen.temperature, seen.pressure * 90.0]
    };
    // The temperature, and the kinetic energy that enters the pressure.
    for (periodic, temperature, kinetic) in [
        ([true, true], (3.0 + 3.0) / 2.0, 3.0),
        ([true, false], (3.0 + 4.0) / 3.0, 3.5),
        ([false, true], (4.0 + 3.0) / 3.0, 3.5),
        ([false, false], (4.0 + 4.0) / 4.0, 4.0),
    ] {
        let [found, pressing] = seen(&two, periodic);
        assert!(
            (found - temperature).abs() < 1e-15 && (pressing - kinetic).abs() < 1e-13,
            "{periodic:?}: {found} {pressing}"
        );
    }
    // A single disc has m v²/2 for each axis in a closed box, and no temperature in a periodic one.
    let one = &two[..1];
    assert_eq!(seen(one, [false, false])[0], 2.5);
    assert_eq!(seen(one, [true, false])[0], 4.0);
    assert!(seen(one, [true, true])[0].is_nan());
}
