//! Collapse of a cold sphere of bodies.

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::laboratory::running::RunningScene;
use crate::report::figure::{Drawing, DrawnShape, Guide, Picture, Tint};
use crate::report::section::{Film, FilmFrame};
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::{MeanWithBar, quantile};
use crate::study::StudyError;
use std::f64::consts::{PI, SQRT_2};
use stripmine_physics::method::nbody::keys::{COUNT, SEED};
use stripmine_physics::particles::{Particle, Particles};
use stripmine_physics::scene::Overrides;

/// Bodies of a sphere, and the numbers of them drawn and filmed.
const BODIES: usize = 2048;
const SHOWN: usize = 700;
const FILMED: usize = 300;
/// Seeds of the start.
const SEEDS: [u64; 4] = [1, 2, 3, 4];
/// Samples, and steps between them.
const SAMPLES: u64 = 320;
const BETWEEN: u64 = 8;
/// Time after which bound bodies are determined, after several oscillations.
const LATE: f64 = 6.0;
/// Free-fall time of a uniform sphere of radius and mass 1.
const FREE_FALL: f64 = PI / (2.0 * SQRT_2);
/// Drawings by name and time.
const DRAWN: [(&str, f64); 3] = [("bodies-0-0", 0.0), ("bodies-1-1", FREE_FALL), ("bodies-3-0", 3.0)];
/// Half the side of the film's window, and the time at which the film ends.
const WINDOW: f64 = 1.5;
const FILM_END: f64 = 4.0;
/// Share of the bodies inside a drawing.
const SEEN: f64 = 0.9;
/// Speed of the darkest shade.
const FASTEST: f64 = 3.0;
/// Radius of a body in the film.
const RADIUS: f64 = 0.015;

/// State of the sphere at a moment; of the first bodies, positions along x and y and speeds.
struct Moment {
    time: f64,
    /// Kinetic over potential energy.
    virial_ratio: f64,
    half_mass_radius: f64,
    energy_error: f64,
    momentum: f64,
    bodies: Vec<([f64; 2], f64)>,
}

/// Bound bodies at a moment.
struct BoundBodies {
    time: f64,
    share: f64,
    /// Kinetic over potential energy, relative to the mean motion of the bound bodies.
    virial_ratio: f64,
    /// Kinetic energy over Σ r·F, Clausius' virial, which equals the potential energy without softening.
    clausius_ratio: f64,
}

struct Sphere {
    seed: u64,
    bound: Vec<BoundBodies>,
    moments: Vec<Moment>,
}

impl Sphere {
    /// Time and radius at the minimum of the half-mass radius.
    fn closest(&self) -> [f64; 2] {
        let moments = self.moments.iter().map(|it| [it.time, it.half_mass_radius]);
        moments.min_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or([f64::NAN; 2])
    }

    /// Mean over the late moments.
    fn late(&self, of: fn(&BoundBodies) -> f64) -> f64 {
        self.bound.iter().map(of).sum::<f64>() / self.bound.len() as f64
    }
}

/// Simulates a sphere for each seed.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let all = ProgressMeter::new(SEEDS.len() as f64, lab.progress)
        .run_cases(&SEEDS, |&seed| simulate_sphere(seed))?;
    let mean = |of: &dyn Fn(&Sphere) -> f64, decimals: usize| {
        let MeanWithBar { value, bar } = MeanWithBar::of(&all.iter().map(of).collect::<Vec<_>>());
        TableCell::with_error(value, Some(bar), decimals)
    };
    let largest = |of: fn(&Moment) -> f64| all.iter().flat_map(|it| &it.moments).map(of).fold(0.0, f64::max);
    let over_seeds = |at: usize, of: fn(&Moment) -> f64| {
        all.iter().map(|it| of(&it.moments[at])).sum::<f64>() / all.len() as f64
    };
    let bound = all.iter().flat_map(|sphere| sphere.bound.iter().map(|it| (sphere.seed, it)));
    let made = FinishedItem::of([
        FrameBuilder::of(&all)
            .count("seed", |it| it.seed)
            .number("end of the fall", 3, |it| it.closest()[0])
            .number("radius of half the mass there", 4, |it| it.closest()[1])
            .number("stays bound (%)", 1, |it| 100.0 * it.late(|it| it.share))
            .number("virial ratio, Σ r·F", 3, |it| it.late(|it| it.clausius_ratio))
            .number("with the potential energy", 3, |it| it.late(|it| it.virial_ratio))
            .frame(
                "spheres",
                format!("Spheres of {BODIES} bodies; late means are over times from {LATE} on"),
            ),
        FrameBuilder::of(0..all[0].moments.len())
            .number("time", 2, |at| all[0].moments[*at].time)
            .number("virial ratio", 3, |at| over_seeds(*at, |it| it.virial_ratio))
            .number("radius of half the mass", 3, |at| over_seeds(*at, |it| it.half_mass_radius))
            .frame(
                "moments",
                "All bodies: kinetic over potential energy, and radius of half the mass, means over seeds",
            ),
        FrameBuilder::of(bound)
            .count("seed", |(seed, _)| *seed)
            .number("time", 2, |(_, it)| it.time)
            .number("stays bound (%)", 1, |(_, it)| 100.0 * it.share)
            .number("virial ratio, Σ r·F", 3, |(_, it)| it.clausius_ratio)
            .number("with the potential energy", 3, |(_, it)| it.virial_ratio)
            .frame("bound", "Bodies that stay bound, at late moments"),
        FrameBuilder::of([()])
            .cell("end of the fall", |()| mean(&|it| it.closest()[0], 3))
            .number("free fall", 3, |()| FREE_FALL)
            .cell("radius of half the mass there", |()| mean(&|it| it.closest()[1], 4))
            .cell("stays bound (%)", |()| mean(&|it| 100.0 * it.late(|it| it.share), 1))
            .cell("virial ratio, Σ r·F", |()| mean(&|it| it.late(|it| it.clausius_ratio), 4))
            .cell("with the potential energy", |()| mean(&|it| it.late(|it| it.virial_ratio), 4))
            .short("largest energy error", |()| largest(|it| it.energy_error.abs()))
            .short("largest momentum", |()| largest(|it| it.momentum))
            .frame("summary", "Means over the seeds, and the largest errors"),
    ]);
    let made = DRAWN.iter().fold(made.with_film(film(&all[0])).with_seeds(SEEDS), |made, (name, time)| {
        made.with_picture(name, Picture::Drawing(drawing(&all[0].moments, *time)))
    });
    Ok(made)
}

/// Drawing of the bodies at the moment nearest to a time, in a window that contains most of them.
fn drawing(moments: &[Moment], time: f64) -> Drawing {
    let nearest = moments.iter().min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()));
    let bodies = nearest.map_or(&[][..], |it| &it.bodies);
    let mut far: Vec<f64> = bodies.iter().map(|([x, y], _)| x.abs().max(y.abs())).collect();
    far.sort_by(f64::total_cmp);
    let half = 1.05 * quantile(&far, SEEN).unwrap_or(WINDOW);
    let inside = bodies.iter().filter(|(centre, _)| centre.iter().all(|x| x.abs() < half));
    let shapes = inside.map(|&(centre, speed)| DrawnShape::Disc {
        centre,
        radius: RADIUS * half / WINDOW,
        tint: Tint::Shade((speed / FASTEST).min(1.0)),
    });
    Drawing {
        window: [[-half; 2], [half; 2]],
        width: 420.0,
        shapes: shapes.collect(),
        shades: Some((0.0, FASTEST, "speed (√(GM/R))".into())),
        guide: Some(Guide { unit: "R".into(), gravity: None }),
    }
}

/// Film of every other moment; bodies beyond the window are drawn at its rim.
fn film(sphere: &Sphere) -> Film {
    let frames = sphere.moments.iter().filter(|it| it.time <= FILM_END).step_by(2).map(|it| FilmFrame {
        time: it.time,
        walls: vec![],
        discs: it
            .bodies
            .iter()
            .take(FILMED)
            .map(|&(centre, speed)| (centre.map(|x| x.clamp(-WINDOW, WINDOW)), speed.min(FASTEST)))
            .collect(),
    });
    Film {
        title: String::new(),
        units: ["R", "√(R³/GM)"].map(str::to_owned),
        window: [[-WINDOW; 2], [WINDOW; 2]],
        sides: vec![],
        falls: false,
        radii: vec![RADIUS; FILMED],
        fixed: vec![],
        frames: frames.collect(),
        shade: "speed (√(GM/R))".into(),
        shades: [0.0, FASTEST],
    }
}

fn simulate_sphere(seed: u64) -> Result<Sphere, StudyError> {
    let mut running =
        RunningScene::begin_timed("cold-collapse", &Overrides::new().set(&COUNT, BODIES).set(&SEED, seed))?;
    let (mut moments, mut late) = (vec![], vec![]);
    for sample in 0..=SAMPLES {
        if sample > 0 {
            running.advance_steps(BETWEEN)?;
        }
        let names = ["time", "virial_ratio", "half_mass_radius", "energy_error", "momentum"];
        let [time, virial_ratio, half_mass_radius, energy_error, momentum] =
            running.observed_values(names)?;
        let particles = running.simulation.particles();
        let bodies = particles.all().iter().take(SHOWN).map(|body| {
            let [x, y, _] = body.position;
            ([x, y], body.velocity.iter().map(|v| v * v).sum::<f64>().sqrt())
        });
        let bodies = bodies.collect();
        if time > LATE && sample.is_multiple_of(8) {
            late.push(bound_bodies(time, &particles));
        }
        moments.push(Moment { time, virial_ratio, half_mass_radius, energy_error, momentum, bodies });
    }
    Ok(Sphere { seed, bound: late, moments })
}

/// Bound bodies: those with positive energy are removed repeatedly until none is left.
fn bound_bodies(time: f64, particles: &Particles) -> BoundBodies {
    // Value of the preset.
    const SOFTENING: f64 = 0.03;
    let mut inside: Vec<&Particle> = particles.all().iter().collect();
    loop {
        let mass: f64 = inside.iter().map(|body| body.mass).sum();
        let drift: [f64; 3] = [0, 1, 2]
            .map(|axis| inside.iter().map(|body| body.mass * body.velocity[axis]).sum::<f64>() / mass);
        let energies = inside.iter().map(|body| {
            let speed: f64 = (0..3).map(|axis| (body.velocity[axis] - drift[axis]).powi(2)).sum();
            let others = inside.iter().filter(|other| other.id != body.id).map(|other| {
                let square: f64 =
                    (0..3).map(|axis| (body.position[axis] - other.position[axis]).powi(2)).sum();
                let softened = square + SOFTENING * SOFTENING;
                let potential = -other.mass / softened.sqrt();
                [potential, potential * square / softened]
            });
            let [potential, virial] = others.fold([0.0; 2], |sum, more| [sum[0] + more[0], sum[1] + more[1]]);
            [0.5 * speed, potential, virial]
        });
        let energies: Vec<[f64; 3]> = energies.collect();
        let before = inside.len();
        if energies.iter().all(|[kinetic, potential, _]| kinetic + potential < 0.0) {
            let sum = |which: usize| {
                inside.iter().zip(&energies).map(|(body, energies)| body.mass * energies[which]).sum::<f64>()
            };
            let [virial_ratio, clausius_ratio] = [1, 2].map(|which| sum(0) / (0.5 * sum(which)).abs());
            let share = before as f64 / particles.len() as f64;
            return BoundBodies { time, share, virial_ratio, clausius_ratio };
        }
        let stays = energies.iter().map(|[kinetic, potential, _]| kinetic + potential < 0.0);
        inside = inside.into_iter().zip(stays).filter(|(_, stays)| *stays).map(|(body, _)| body).collect();
    }
}
