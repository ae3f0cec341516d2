//! Interactions per second, and force errors.

use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::rates::{CaseReading, RateCase, StudyWork, measure_rates, parse_parameters};
use crate::laboratory::running::{RunningScene, on_threads};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::study::StudyError;
use std::time::Instant;
use stripmine_kernels::InstructionSet;
use stripmine_physics::method;
use stripmine_physics::method::nbody::bodies::{PointMasses, zeros};
use stripmine_physics::method::nbody::field::{GravityField, never_stop, potential};
use stripmine_physics::method::nbody::keys::{ROOTS, SOFTENING};
use stripmine_physics::method::nbody::options::{ArithmeticKind, StartKind};
use stripmine_physics::method::nbody::scene::NbodyScene;
use stripmine_physics::method::nbody::schemes::AccelerationField;
use stripmine_physics::method::nbody::starts::initial_bodies;
use stripmine_physics::particles::{Particle, Particles};
use stripmine_physics::scene::{DT, Overrides, PRECISION, Precision};
use stripmine_physics::words::Words;

/// Combinations of force precision and root arithmetic.
const CONFIGURATIONS: [(Precision, ArithmeticKind); 5] = [
    (Precision::Mixed, ArithmeticKind::Raw),
    (Precision::Mixed, ArithmeticKind::Estimated),
    (Precision::Mixed, ArithmeticKind::Exact),
    (Precision::F64, ArithmeticKind::Estimated),
    (Precision::F64, ArithmeticKind::Exact),
];
/// Number of bodies whose forces are compared with direct summation.
const SAMPLED: usize = 512;
/// Softening for the comparison of forces, and for the energy error (length).
const SHARP: f64 = 0.01;
const SOFTENED: f64 = 0.05;
/// Compared numbers of threads.
const THREADS: [usize; 2] = [1, 2];

/// Measured work other than runs of scenes: evaluations of all forces.
pub(in crate::laboratory::nbody) static WORKS: [StudyWork; 1] =
    [StudyWork { name: "nbody-forces", measure: time_forces }];

/// Measures every combination.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (counts, seconds): (&[usize], f64) =
        if size == StudySize::Quick { (&[1024], 0.05) } else { (&[1024, 4096, 16_384], 0.1) };
    let all: Vec<(usize, usize)> = counts
        .iter()
        .flat_map(|&count| (0..CONFIGURATIONS.len()).map(move |configuration| (count, configuration)))
        .collect();
    let case = |&(count, configuration): &(usize, usize), threads: usize| {
        let (precision, arithmetic) = CONFIGURATIONS[configuration];
        let case =
            RateCase::own(&WORKS[0], serde_json::json!([count, configuration, seconds])).on_threads(threads);
        case.label("bodies", count as u64)
            .label("forces", precision.word())
            .label("arithmetic", arithmetic.word())
    };
    let cases: Vec<RateCase> = all.iter().flat_map(|it| THREADS.map(|threads| case(it, threads))).collect();
    let measured = measure_rates(lab, &cases)?;
    let errors = all
        .iter()
        .map(|&(count, configuration)| errors_of_forces(count, configuration))
        .collect::<Result<Vec<_>, _>>()?;
    let rows = all.iter().zip(measured.chunks(2)).zip(&errors).map(
        |((&(count, configuration), threads), (error, _))| {
            (count, CONFIGURATIONS[configuration], &threads[0], &threads[1], error)
        },
    );
    let same = errors.iter().all(|(_, same)| *same);
    let configurations = [CONFIGURATIONS[4], CONFIGURATIONS[2], CONFIGURATIONS[1], CONFIGURATIONS[0]];
    let conserving =
        configurations.into_iter().flat_map(|configuration| [128, 512].map(|steps| (configuration, steps)));
    let conserving = conserving
        .map(|(configuration, steps)| Ok((configuration, steps, energy_error(configuration, steps)?)));
    let conserving = conserving.collect::<Result<Vec<_>, StudyError>>()?;
    Ok(FinishedItem::of([
        FrameBuilder::of(rows)
            .count("bodies", |(count, ..)| *count)
            .text("forces", |(_, (precision, _), ..)| precision.word())
            .text("arithmetic", |(_, (_, arithmetic), ..)| arithmetic.word())
            .cell("1 thread (10⁹/s)", |(_, _, one, ..)| one.rate().cell(1e-9, 2))
            .cell("2 threads (10⁹/s)", |(_, _, _, two, _)| two.rate().cell(1e-9, 2))
            .cell("ratio", |(_, _, one, two, _)| two.rate_ratio(one).cell(1.0, 2))
            .short("force error", |(.., error)| error[0])
            .short("with rounded masses", |(.., error)| error[1])
            .frame(
                "rates",
                "Directed interactions a second, N² counted: median and range of three processes",
            ),
        FrameBuilder::of(conserving)
            .text("forces", |((precision, _), ..)| precision.word())
            .text("arithmetic", |((_, arithmetic), ..)| arithmetic.word())
            .count("steps of a unit of time", |(_, steps, _)| *steps)
            .short("|ΔE/E|", |(.., error)| *error)
            .frame(
                "conserving",
                "Energy error of a Plummer sphere of 1024 bodies after two units of time, leapfrog",
            ),
        FrameBuilder::of([()])
            .text("instruction set", |()| InstructionSet::best().name())
            .text("bits of two threads", |()| if same { "the same" } else { "other" })
            .frame("summary", "Instruction set, and bits of one thread and of two"),
    ])
    .with_seeds([1]))
}

/// Scene of a combination, and its Plummer sphere.
fn plummer_scene(count: usize, configuration: usize) -> (NbodyScene, PointMasses) {
    let (precision, arithmetic) = CONFIGURATIONS[configuration];
    let mut scene = NbodyScene { softening: SHARP, precision, arithmetic, ..NbodyScene::default() };
    (scene.start.kind, scene.start.count) = (StartKind::Plummer, count);
    let all =
        PointMasses::new(initial_bodies(&scene.start, SHARP, 1.0).into_iter().map(|(m, r, v)| (r, v, m)));
    (scene, all)
}

/// Times evaluations of the forces. Parameters: number of bodies, index into [`CONFIGURATIONS`], minimum seconds.
fn time_forces(parameters: &serde_json::Value) -> Result<CaseReading, StudyError> {
    let (count, configuration, least): (usize, usize, f64) = parse_parameters(parameters)?;
    let (scene, all) = plummer_scene(count, configuration);
    let mut field = GravityField::new(&scene, &all)?;
    let mut into = zeros(all.entries());
    let mut sweep = || {
        field
            .for_step(false, &never_stop)
            .acceleration(&all.position, &mut into)
            .map_err(method::PhysicsFailure::from)
    };
    sweep()?;
    let (begun, mut sweeps) = (Instant::now(), 0);
    while begun.elapsed().as_secs_f64() < least {
        sweep()?;
        sweeps += 1;
    }
    let seconds = begun.elapsed().as_secs_f64();
    Ok(CaseReading { work: f64::from(sweeps) * (count as f64).powi(2), seconds, ..CaseReading::default() })
}

/// Largest error of an acceleration over the largest acceleration: first for masses in the kernel's precision, then including the rounding of
/// masses to single precision. Also true if two threads give the bits of one.
fn errors_of_forces(count: usize, configuration: usize) -> Result<([f64; 2], bool), StudyError> {
    let (scene, all) = plummer_scene(count, configuration);
    let on = |threads: usize| {
        on_threads(threads, || {
            let mut into = zeros(all.entries());
            let mut field = GravityField::new(&scene, &all)?;
            field
                .for_step(false, &never_stop)
                .acceleration(&all.position, &mut into)
                .map_err(method::PhysicsFailure::from)?;
            Ok(into)
        })
    };
    let [one, two] = [on(1)?, on(2)?];
    let error = |is_rounded: bool| {
        let (mut largest, mut worst) = (0.0_f64, 0.0_f64);
        // Evenly spaced sample of the bodies.
        for body in (0..count).step_by((count / SAMPLED).max(1)) {
            let expected = direct_acceleration(&all, body, scene.softening, is_rounded);
            for (axis, expected) in expected.into_iter().enumerate() {
                largest = largest.max(expected.abs());
                worst = worst.max((one[axis][body] - expected).abs());
            }
        }
        worst / largest
    };
    Ok(([error(scene.precision != Precision::F64), error(false)], one == two))
}

/// Acceleration of a body by direct summation with Neumaier's compensation. If `is_rounded`, masses are first rounded to single precision as
/// in the kernel.
fn direct_acceleration(all: &PointMasses, body: usize, softening: f64, is_rounded: bool) -> [f64; 3] {
    let seen = |value: f64| if is_rounded { f64::from(value as f32) } else { value };
    let mut sums = [[0.0_f64; 2]; 3];
    for other in (0..all.len()).filter(|&other| other != body) {
        let displacement = [0, 1, 2].map(|axis| all.position[axis][other] - all.position[axis][body]);
        let square = displacement.iter().map(|part| part * part).sum::<f64>() + seen(softening).powi(2);
        let pull = seen(all.mass[other]) / (square * square.sqrt());
        for (sum, part) in sums.iter_mut().zip(displacement) {
            let [before, lost] = *sum;
            let term = pull * part;
            let after = before + term;
            let rest =
                if before.abs() >= term.abs() { (before - after) + term } else { (term - after) + before };
            *sum = [after, lost + rest];
        }
    }
    sums.map(|[sum, lost]| sum + lost)
}

/// Kinetic plus pair energy in double precision.
fn energy(particles: &Particles, softening: f64) -> Result<f64, StudyError> {
    let all = particles.all();
    let mass: Vec<f64> = all.iter().map(|body| body.mass).collect();
    let position = [0, 1, 2].map(|axis| all.iter().map(|body| body.position[axis]).collect());
    let square = |body: &Particle| body.velocity.iter().map(|v| v * v).sum::<f64>();
    let kinetic: f64 = all.iter().map(|body| 0.5 * body.mass * square(body)).sum();
    let potential =
        potential(&mass, &position, softening, &never_stop).map_err(method::PhysicsFailure::from)?;
    Ok(kinetic + potential)
}

/// |ΔE/E| of a Plummer sphere with leapfrog after two units of time of `steps` steps each.
fn energy_error((precision, arithmetic): (Precision, ArithmeticKind), steps: u64) -> Result<f64, StudyError> {
    let machine = Overrides::new().set(&PRECISION, precision).set(&ROOTS, arithmetic);
    let overrides = machine.set(&DT, 1.0 / steps as f64).set(&SOFTENING, SOFTENED);
    let mut running = RunningScene::begin_timed("plummer", &overrides)?;
    let begin = energy(&running.simulation.particles(), SOFTENED)?;
    running.advance_steps(2 * steps)?;
    Ok((energy(&running.simulation.particles(), SOFTENED)? / begin - 1.0).abs())
}
