//! Physics of whole simulations: conservation, rebound and friction of collisions, independence of threads
//! and instructions, and failures found in their step.

mod support;

use stripmine_kernels::law::granular::{Contact, ContactArm};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::io::checkpoint::CheckpointColumn;
use stripmine_physics::method::SteppedState;
use stripmine_physics::method::lattice_md::SteppedGrains;
use stripmine_physics::method::lattice_md::{
    ContactSearch, ContactWatch, GearValues, GranularModel, GranularScheme, ProgramExecution,
};
use stripmine_physics::method::{FailureKind, PhysicsFailure};
use stripmine_physics::observe::{Observation, SceneProperties};
use stripmine_physics::particles::{Particle, Particles};
use stripmine_physics::scene::Precision;
use support::{CONTACT, advance, arena, fast, gas, grain, simulate};

fn lattice(start: &(GranularModel, Particles)) -> SteppedGrains {
    simulate(Precision::F64, start, ContactSearch::Lattice, fast())
}

fn observe(method: &SteppedGrains, model: &GranularModel) -> Observation {
    Observation::of(method.steps(), method.time(), &method.particles(), &SceneProperties::of(model))
}

// ---- a gas ----------------------------------------------------------------------------------------------

/// Rms and largest error of the energy over `time`, relative to the energy.
fn energy_error(values: GearValues, dt: f64, time: f64) -> [f64; 2] {
    let mut start = gas(400, 0.84, 11);
    start.0.contact = Contact { normal_damping: 0.0, shear_damping: 0.0, friction: 0.0, ..CONTACT };
    start.0.friction = false;
    (start.0.scheme, start.0.dt) = (GranularScheme::Gear(values), dt);
    let mut gas = lattice(&start);
    let energy = observe(&gas, &start.0).energy();
    let samples = 100;
    let steps = (time / dt / f64::from(samples)).round() as u64;
    let (mut square, mut most) = (0.0, 0.0_f64);
    for _ in 0..samples {
        advance(&mut gas, steps);
        let seen = observe(&gas, &start.0);
        assert!(seen.elastic < 0.9 * energy, "the gas must be moving");
        let error = seen.energy() / energy - 1.0;
        square += error * error / f64::from(samples);
        most = most.max(error.abs());
    }
    [square.sqrt(), most]
}

/// The pressure of soft discs is that of hard ones of their effective diameter, d = 1 − ∫ exp(−u/T) dξ (Barker and Henderson), to
/// first order in their softness. Henderson's equation of state is accurate to 0.3 % at this density.
#[test]
fn soft_discs_have_their_effective_hard_disc_pressure() {
    let mut start = gas(400, 0.40, 5);
    for disc in start.1.all_mut() {
        (disc.radius, disc.mass, disc.omega) = (0.5, 1.0, 0.0);
    }
    start.0.contact = Contact { normal_damping: 0.0, shear_damping: 0.0, friction: 0.0, ..CONTACT };
    start.0.friction = false;
    (start.0.scheme, start.0.dt) = (GranularScheme::Gear(GearValues::Five), 0.02);
    let mut gas = lattice(&start);
    advance(&mut gas, 2_000);
    let area = start.0.sides[0] * start.0.sides[1];
    let seen: Vec<Observation> = (0..800)
        .map(|_| {
            advance(&mut gas, 20);
            observe(&gas, &start.0)
        })
        .collect();
    let mean = |of: &dyn Fn(&Observation) -> f64| seen.iter().map(of).sum::<f64>() / seen.len() as f64;
    let (count, temperature) = (gas.particles().grains().len() as f64, mean(&|seen| seen.temperature));
    // The kinetic energy of count − 1 discs enters, since momentum is conserved.
    let compressibility = (mean(&|seen| seen.pressure) * area + temperature) / (count * temperature);
    let gamma = 0.887_263_817_503_075; // Γ(7/5)
    let diameter = 1.0 - gamma * (temperature / (0.4 * CONTACT.stiffness)).powf(0.4);
    let nu = count * std::f64::consts::FRAC_PI_4 * diameter * diameter / area;
    let henderson = (1.0 + nu * nu / 8.0) / ((1.0 - nu) * (1.0 - nu));
    println!("Z {compressibility:.4}, hard discs at {nu:.4} {henderson:.4}");
    assert!((compressibility / henderson - 1.0).abs() < 0.015, "{compressibility} {henderson}");
}

/// Energy of undamped Hertz collisions converges at about dt^2.2 with any scheme: the force has half a derivative too few.
#[test]
fn energy_error_converges_with_the_step() {
    for values in GearValues::ALL {
        let dts = [0.02, 0.01, 0.005, 0.0025];
        let errors = dts.map(|dt| energy_error(values, dt, 10.0));
        let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0][0] / pair[1][0]).log2()).collect();
        println!(
            "{values:?}: dt {dts:?}, rms and largest error of the energy {errors:?}, orders {orders:.2?}"
        );
        assert!(orders.iter().all(|order| *order > 1.0), "{values:?}: {orders:?}");
        let mean = orders.iter().sum::<f64>() / 3.0;
        assert!((1.8..4.5).contains(&mean), "{values:?}: order {mean}");
        assert!(errors[2][1] < 1e-3, "{values:?}: {errors:?}");
    }
}

#[test]
fn periodic_gas_conserves_momentum_to_rounding() {
    let start = gas(400, 0.84, 5);
    let mut gas = lattice(&start);
    let first = observe(&gas, &start.0);
    let magnitude: f64 = gas
        .particles()
        .grains()
        .iter()
        .map(|disc| disc.mass * disc.velocity[0].hypot(disc.velocity[1]))
        .sum();
    let mut worst = 0.0_f64;
    for _ in 0..20 {
        advance(&mut gas, 100);
        let seen = observe(&gas, &start.0);
        let lost = (seen.momentum_x - first.momentum_x).hypot(seen.momentum_y - first.momentum_y);
        worst = worst.max(lost / magnitude);
    }
    println!("momentum lost in 2000 steps: {worst:.2e} of the sum of its magnitudes");
    assert!(worst < 1e-13, "{worst:e}");
    assert!(observe(&gas, &start.0).kinetic < 0.99 * first.kinetic, "the gas must have collided and cooled");
}

// ---- one collision --------------------------------------------------------------------------------------

const RADII: [f64; 2] = [0.5, 0.46];
const MASSES: [f64; 2] = [1.0, 0.7];
const EFFECTIVE: f64 = MASSES[0] * MASSES[1] / (MASSES[0] + MASSES[1]);

/// Two discs that touch after a number of steps, approaching at `normal` and sliding past each other at `shear`.
fn pair(contact: Contact, dt: f64, steps: f64, [normal, shear]: [f64; 2]) -> (GranularModel, Particles) {
    let x = 4.0 + RADII[0] + RADII[1] + steps * normal * dt;
    // In the frame of the centre of mass.
    let share = [MASSES[1], -MASSES[0]].map(|m| m / (MASSES[0] + MASSES[1]));
    let discs = [
        grain(1, [4.0, 4.1], [share[0] * normal, share[0] * shear], RADII[0], MASSES[0]),
        grain(2, [x, 4.1], [share[1] * normal, share[1] * shear], RADII[1], MASSES[1]),
    ];
    let (mut model, particles) = arena([16, 16], true, &discs);
    model.friction = contact.friction > 0.0;
    (model.contact, model.dt, model.scheme) = (contact, dt, GranularScheme::Gear(GearValues::Four));
    (model, particles)
}

/// Overlap, normal from the second to the first, relative velocity along normal and tangent.
fn apart(discs: &[Particle]) -> (f64, [f64; 2], [f64; 2]) {
    let displacement = [0, 1].map(|axis| discs[0].position[axis] - discs[1].position[axis]);
    let distance = displacement[0].hypot(displacement[1]);
    let n = displacement.map(|w| w / distance);
    let v = [0, 1].map(|axis| discs[0].velocity[axis] - discs[1].velocity[axis]);
    (RADII[0] + RADII[1] - distance, n, [v[0] * n[0] + v[1] * n[1], v[1] * n[0] - v[0] * n[1]])
}

/// Overlap and speed of separation at the end of a collision, and the duration of contact if the discs separated.
#[derive(Debug, Clone, Copy)]
struct End {
    overlap: f64,
    speed: f64,
    duration: Option<f64>,
}

fn simulated(contact: Contact, dt: f64, speed: f64, time: f64) -> End {
    let mut collision = lattice(&pair(contact, dt, 1.37, [speed, 0.0]));
    let (mut before, _, _) = apart(collision.particles().all());
    let (mut touched, mut parted) = (None, None);
    loop {
        advance(&mut collision, 1);
        let (overlap, _, [away, _]) = apart(collision.particles().all());
        let crossing = collision.time() - dt * overlap / (overlap - before);
        match (before > 0.0, overlap > 0.0) {
            (false, true) => touched = Some(crossing),
            (true, false) => parted = Some(crossing),
            _ => {}
        }
        before = overlap;
        if touched.is_some_and(|touched| collision.time() >= touched + time) {
            let duration = parted.zip(touched).map(|(parted, touched)| parted - touched);
            return End { overlap, speed: away, duration };
        }
    }
}

/// Solves M x'' = k x^1.5 − γ M v of the pair by fourth-order Runge–Kutta in tiny steps, independently of the program.
fn integrated(contact: Contact, speed: f64, time: f64) -> End {
    let Contact { stiffness: k, normal_damping: gamma, cohesionless, .. } = contact;
    // x is the overlap, u its rate.
    let rate = |[x, u]: [f64; 2]| {
        let push = if x > 0.0 { k * x * x.sqrt() + gamma * EFFECTIVE * u } else { 0.0 };
        [u, -(if cohesionless { push.max(0.0) } else { push }) / EFFECTIVE]
    };
    let h = time / 100_000.0;
    let go = |s: [f64; 2], d: [f64; 2], h: f64| [s[0] + h * d[0], s[1] + h * d[1]];
    let mut s = [0.0, speed];
    let mut duration = None;
    for step in 0..100_000 {
        let a = rate(if step == 0 { [1e-300, speed] } else { s });
        let b = rate(go(s, a, 0.5 * h));
        let c = rate(go(s, b, 0.5 * h));
        let d = rate(go(s, c, h));
        let next = [0, 1].map(|i| s[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        if duration.is_none() && next[0] <= 0.0 {
            duration = Some(h * (f64::from(step) + s[0] / (s[0] - next[0])));
        }
        s = next;
    }
    End { overlap: s[0], speed: -s[1], duration }
}

fn hertz_time(stiffness: f64, speed: f64) -> f64 {
    3.218 * (EFFECTIVE * EFFECTIVE / (stiffness * stiffness * speed)).powf(0.2)
}

/// Damped collisions converge at first order only: the damping jumps at first contact, which falls inside a step.
#[test]
fn collisions_agree_with_an_independent_integration() {
    println!("speed gamma clamped |  restitution, integrated |  duration, integrated");
    for cohesionless in [true, false] {
        for speed in [0.05, 0.2, 0.8] {
            for normal_damping in [0.3, 1.0, 4.0, 40.0] {
                let contact = Contact { normal_damping, cohesionless, friction: 0.0, ..CONTACT };
                let dt = 0.001;
                let strong = normal_damping > 4.0;
                let time = if strong { 12.0 } else { 3.0 } * hertz_time(contact.stiffness, speed);
                let ours = simulated(contact, dt, speed, time);
                let theirs = integrated(contact, speed, time);
                let [e, reference] = [ours.speed / speed, theirs.speed / speed];
                println!(
                    "{speed:5} {normal_damping:5} {cohesionless:7} | {e:.5} {reference:.5} | {:.5?} {:.5?}",
                    ours.duration, theirs.duration
                );
                let what =
                    format!("speed {speed}, damping {normal_damping}: {ours:?}, integrated {theirs:?}");
                assert!((e - reference).abs() < 6e-4 * normal_damping.min(4.0), "{what}");
                match (ours.duration, theirs.duration) {
                    (Some(ours), Some(theirs)) => {
                        assert!(
                            (ours - theirs).abs() < if strong { 0.02 * theirs } else { 2.0 * dt },
                            "{what}"
                        );
                    }
                    // Unclamped, strongly damped pairs creep.
                    (None, None) => assert!((ours.overlap / theirs.overlap - 1.0).abs() < 0.01, "{what}"),
                    _ => panic!("{what}"),
                }
                assert_eq!(ours.duration.is_some(), cohesionless || !strong, "{what}");
            }
        }
    }
}

#[test]
fn undamped_collisions_last_the_hertz_time() {
    for speed in [0.05, 0.2, 0.8] {
        let contact = Contact { normal_damping: 0.0, friction: 0.0, ..CONTACT };
        let hertz = hertz_time(contact.stiffness, speed);
        let end = simulated(contact, 0.001, speed, 1.5 * hertz);
        let duration = end.duration.unwrap();
        println!(
            "speed {speed}: duration {duration:.6}, Hertz {hertz:.6}; restitution {:.7}",
            end.speed / speed
        );
        assert!((duration / hertz - 1.0).abs() < 5e-4, "{duration} {hertz}");
        assert!((end.speed / speed - 1.0).abs() < 1e-4, "{end:?}");
    }
}

/// Convergence of the rebound speed of an undamped collision with the time step: rms over the phase of the step at which it
/// begins.
#[test]
fn undamped_collisions_converge_above_second_order() {
    let contact = Contact { normal_damping: 0.0, friction: 0.0, ..CONTACT };
    let (speed, phases, dts) = (0.2, 16, [0.016, 0.008, 0.004, 0.002]);
    for values in GearValues::ALL {
        let errors = dts.map(|dt| {
            let square = |phase: i32| {
                let mut start = pair(contact, dt, 1.0 + f64::from(phase) / f64::from(phases), [speed, 0.0]);
                start.0.scheme = GranularScheme::Gear(values);
                let mut collision = lattice(&start);
                advance(&mut collision, (1.3 * hertz_time(contact.stiffness, speed) / dt) as u64 + 3);
                let (overlap, _, [away, _]) = apart(collision.particles().all());
                assert!(overlap < 0.0 && away > 0.0);
                (away / speed - 1.0).powi(2)
            };
            ((0..phases).map(square).sum::<f64>() / f64::from(phases)).sqrt()
        });
        let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        println!("{values:?}: dt {dts:?}, rms error of the speed given back {errors:?}, orders {orders:.2?}");
        assert!(orders.iter().sum::<f64>() / 3.0 > 1.8, "{values:?}: {orders:?}");
    }
}

/// Momentum that the first disc receives along the mean normal and tangent, and the slip of the surfaces before and
/// after; the Coulomb bound is asserted in every step.
fn oblique(contact: Contact, normal: f64, shear: f64) -> ([f64; 2], [f64; 2], Particles) {
    let mut collision = lattice(&pair(contact, 0.0005, 1.37, [normal, shear]));
    let before = collision.particles();
    let slip = |discs: &[Particle]| {
        let (_, _, [_, along]) = apart(discs);
        along - RADII[0] * discs[0].omega - RADII[1] * discs[1].omega
    };
    let (mut first, mut last) = (None, [0.0; 2]);
    for _ in 0..1000 {
        advance(&mut collision, 1);
        let now = collision.particles();
        let (overlap, n, _) = apart(now.all());
        if overlap > 0.0 {
            first.get_or_insert(n);
            last = n;
        } else if first.is_some() {
            break;
        }
        let [fx, fy, torque] = collision.forces()[0];
        // The torque is −R F_S for any normal of the predicted positions.
        let shear = -torque / RADII[0];
        let push = (fx * fx + fy * fy - shear * shear).max(0.0).sqrt();
        assert!(shear.abs() <= contact.friction * push * (1.0 + 1e-6) + 1e-9, "{shear} against {push}");
    }
    let after = collision.particles();
    let n = [0, 1].map(|axis| 0.5 * (first.unwrap()[axis] + last[axis]));
    let length = n[0].hypot(n[1]);
    let n = n.map(|n| n / length);
    let [px, py] =
        [0, 1].map(|axis| MASSES[0] * (after.all()[0].velocity[axis] - before.all()[0].velocity[axis]));
    ([px * n[0] + py * n[1], py * n[0] - px * n[1]], [slip(before.all()), slip(after.all())], after)
}

/// Oblique collisions with a linear spring agree with LAMMPS's `gran/hooke` in positions, velocities and spins, with steps 25 times as
/// long.
#[test]
fn linear_contacts_agree_with_lammps() {
    let table = include_str!("rivals/linear_contacts.csv").lines().filter(|line| !line.starts_with('#'));
    let contact = Contact {
        spring: Spring::Linear,
        stiffness: 187.0,
        normal_damping: 0.7,
        shear_damping: 20.0,
        friction: 0.3,
        cohesionless: false,
        arm: ContactArm::Radius,
    };
    let (mut rows, mut turned) = (0, 0.0_f64);
    for row in table.skip(1) {
        let row: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let discs = [1, 2].map(|id| {
            let &[radius, mass, x, y, vx, vy, omega] = &row[12 * (id - 1)..][..7] else { panic!("{row:?}") };
            Particle { omega, ..grain(id as u32, [x, y], [vx, vy], radius, mass) }
        });
        let (mut model, particles) = arena([16, 16], true, &discs);
        (model.contact, model.friction, model.dt) = (contact, true, 0.0005);
        let side = model.sides[0];
        let mut collision = lattice(&(model, particles));
        advance(&mut collision, 5000);
        for (disc, before) in collision.particles().all().iter().zip(&discs) {
            let after = &row[12 * (disc.id as usize - 1) + 7..][..5];
            let ours = [disc.position, disc.velocity].map(|[x, y, _]| [x, y]).concat();
            for (ours, theirs) in ours.iter().chain([&disc.omega]).zip(after) {
                // LAMMPS's box is a whole multiple of ours.
                let off = ours - theirs;
                let off = off - side * (off / side).round();
                assert!(off.abs() < 2e-4, "{ours} {theirs} of {after:?}");
            }
            turned = turned.max((disc.omega - before.omega).abs());
        }
        rows += 1;
    }
    assert!(rows == 16 && turned > 0.1, "{rows} {turned}");
}

#[test]
fn friction_is_coulombs_for_sliding_surfaces() {
    let stiff = Contact { stiffness: 18_700.0, normal_damping: 0.0, friction: 0.3, ..CONTACT };
    for shear in [-1.0, 1.0] {
        let sliding = Contact { shear_damping: 1e5, ..stiff };
        let ([push, drag], [before, after], _) = oblique(sliding, 0.2, shear);
        println!("sliding at {shear}: drag/push {:.5}, slip {before:.4} to {after:.4}", drag / push);
        assert!((drag / push + before.signum() * 0.3).abs() < 0.003, "{drag} {push}");
        assert!(after / before > 0.3, "it must slide to the end: {before} to {after}");
        // The inertia of 1 + 1/0.5 = 3 surfaces against the exchanged momentum.
        assert!((after - before - 3.0 * drag / EFFECTIVE).abs() < 0.02, "{before} {after} {drag}");

        // Between the two cases: below the Coulomb bound.
        let weak = Contact { shear_damping: 1.0, ..stiff };
        let ([push, drag], [before, _], _) = oblique(weak, 0.2, shear);
        println!("viscous at {shear}: drag/push {:.5}", drag / push);
        assert!(drag.abs() < 0.29 * push && drag * before < 0.0);

        let rolling = Contact { shear_damping: 200.0, friction: 5.0, ..stiff };
        let shear = 0.05 * shear;
        let ([push, drag], [before, after], discs) = oblique(rolling, 0.2, shear);
        println!("rolling from {shear}: drag/push {:.5}, slip {before:.5} to {after:.2e}", drag / push);
        assert!((before.abs() / shear.abs() - 1.0).abs() < 1e-3, "{before}");
        assert!(after.abs() < 1e-3 * shear.abs(), "{after}");
        assert!(drag.abs() < 5.0 * push);
        let spins = RADII[0] * discs.all()[0].omega + RADII[1] * discs.all()[1].omega;
        // Two thirds of the slip become spin.
        assert!((spins / before - 2.0 / 3.0).abs() < 0.02, "{spins} {before}");
    }
}

// ---- the same bits --------------------------------------------------------------------------------------

fn bits(method: &SteppedGrains) -> Vec<(String, Vec<u64>)> {
    let bits = |column: CheckpointColumn| match column {
        CheckpointColumn::F64(values) => values.into_iter().map(f64::to_bits).collect(),
        CheckpointColumn::F32(values) => values.into_iter().map(|x| u64::from(x.to_bits())).collect(),
        CheckpointColumn::U32(values) => values.into_iter().map(u64::from).collect(),
        CheckpointColumn::U64(values) => values,
    };
    method.columns().into_iter().map(|(name, column)| (name, bits(column))).collect()
}

#[test]
fn bits_do_not_depend_on_threads_or_instructions() {
    let start = gas(8200, 0.84, 3);
    let run = |threads: usize, set: InstructionSet| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            assert_eq!(rayon::current_num_threads(), threads);
            let machine = ProgramExecution { execution: Execution::Chained, set };
            let mut gas = simulate(Precision::F64, &start, ContactSearch::Lattice, machine);
            advance(&mut gas, 50);
            let touching = gas.forces().iter().filter(|force| force[0] != 0.0).count();
            assert!(touching > 500, "the gas must collide: {touching}");
            bits(&gas)
        })
    };
    let scalar = run(1, InstructionSet::Scalar);
    for set in InstructionSet::available() {
        for threads in [1, 2, 3] {
            assert!(run(threads, set) == scalar, "{} on {threads} threads", set.name());
        }
    }
}

// ---- failures -------------------------------------------------------------------------------------------

/// Steps until the failure, which must occur in step `at`.
fn breaks(start: &(GranularModel, Particles), most: u64, kind: FailureKind, at: u64) -> PhysicsFailure {
    let mut method = lattice(start);
    for _ in 0..most {
        if let Err(failure) = method.step() {
            assert_eq!((failure.kind, method.steps()), (kind, at), "{failure}");
            assert_eq!(failure.at.map(|clock| clock.steps), Some(at));
            return failure;
        }
    }
    panic!("no failure in {most} steps");
}

/// Sorted ids of the discs that a failure names.
fn ids(failure: &PhysicsFailure) -> Vec<u32> {
    let mut ids: Vec<u32> = failure.culprits.iter().map(|culprit| culprit.id).collect();
    ids.sort_unstable();
    ids
}

#[test]
fn velocity_nan_stops_the_first_step() {
    let mut start = gas(400, 0.84, 2);
    start.1.all_mut()[123].velocity[1] = f64::NAN;
    let id = start.1.all()[123].id;
    let failure = breaks(&start, 1, FailureKind::NOT_FINITE, 1);
    assert_eq!((failure.count, failure.culprits[0].id), (1, id));
}

#[test]
fn disc_leaving_a_closed_box_is_named() {
    // A distance of 0.3025 remains, at 0.005 a step.
    let discs = [
        grain(7, [2.0, 2.0], [0.0; 2], 0.5, 1.0),
        grain(31, [7.6975, 5.25], [1.0, 0.1], 0.5, 1.0),
        grain(8, [2.0, 5.0], [0.1, 0.0], 0.5, 1.0),
    ];
    let failure = breaks(&arena([16, 16], false, &discs), 100, FailureKind::OUT_OF_BOX, 61);
    let first = failure.culprits[0];
    assert_eq!((failure.count, first.id), (1, 31));
    assert!((first.position[0] - 8.0025).abs() < 1e-9, "{first}");
}

/// Two discs that hardly repel each other, approaching by 0.04 a step.
fn ghosts(stop_penetration: f64) -> (GranularModel, Particles) {
    let discs = [
        grain(5, [2.02, 3.25], [4.0, 0.0], 0.5, 1.0),
        grain(9, [4.0, 1.0], [0.0; 2], 0.5, 1.0),
        grain(12, [3.97, 3.25], [-4.0, 0.0], 0.5, 1.0),
    ];
    let (mut model, particles) = arena([16, 16], false, &discs);
    model.contact.stiffness = 1e-9;
    model.watch = Some(ContactWatch::new(0.1, stop_penetration, 0.5));
    (model, particles)
}

#[test]
fn too_deep_contact_names_both_discs() {
    // 1.95 − 0.04 n < 0.7: n = 32, at 0.67.
    let failure = breaks(&ghosts(0.3), 100, FailureKind::TOO_DEEP, 32);
    assert_eq!(ids(&failure), [5, 12]);
    assert!((failure.value("penetration").unwrap() - 0.33).abs() < 1e-6, "{failure}");
    assert_eq!(failure.value("limit"), Some(0.3));
}

#[test]
fn discs_in_one_cell_are_named() {
    // Step 49 takes the second disc from 3.01 to 2.99, into the cell of the first at 2.985.
    let mut start = ghosts(0.999);
    start.1.all_mut()[0].position[0] = 2.005;
    let failure = breaks(&start, 100, FailureKind::CONFLICT, 49);
    assert_eq!(ids(&failure), [5, 12]);
    assert!((failure.value("distance").unwrap() - 0.005).abs() < 1e-6, "{failure}");
}
