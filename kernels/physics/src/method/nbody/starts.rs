//! Initial states of bodies. All are centred on the origin without momentum and, unless listed, have a total mass of 1. Velocities due to
//! gravity scale with √G.

use super::options::StartKind;
use super::scene::NbodyStart;
use rand::RngExt;
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use stripmine_kernels::noise::{RandomPurpose, Stream};

/// Mass, position (length) and velocity (length/time) of a body.
pub(crate) type InitialBody = (f64, [f64; 3], [f64; 3]);

/// Creates the bodies of a start, with softening ε (length) and gravitational constant G.
pub fn initial_bodies(start: &NbodyStart, softening: f64, constant: f64) -> Vec<InitialBody> {
    let root = constant.sqrt();
    match start.kind {
        StartKind::Kepler => scale_velocities(kepler(start.eccentricity, start.mass_ratio), root),
        StartKind::FigureEight => scale_velocities(figure_eight(), root),
        // Read by the check of the scene.
        StartKind::File => vec![],
        StartKind::List => {
            let body = |row: &Vec<f64>| (row[0], [row[1], row[2], row[3]], [row[4], row[5], row[6]]);
            start.bodies.iter().map(body).collect()
        }
        StartKind::Plummer => centred(scale_velocities(plummer(0..start.count, start.seed), root)),
        StartKind::Sphere | StartKind::Shell => {
            let mut bodies = centred(sphere(start));
            stir(&mut bodies, [start.virial, softening, constant], start.seed);
            bodies
        }
        StartKind::TwoClusters => two_clusters(start, root),
    }
}

/// Multiplies all velocities by a factor.
fn scale_velocities(mut bodies: Vec<InitialBody>, times: f64) -> Vec<InitialBody> {
    bodies.iter_mut().for_each(|(.., velocity)| *velocity = velocity.map(|v| times * v));
    bodies
}

/// Two bodies about their centre of mass, at the nearest point: semi-major axis, total mass and G are 1.
fn kepler(eccentricity: f64, mass_ratio: f64) -> Vec<InitialBody> {
    let share = mass_ratio / (1.0 + mass_ratio);
    let distance = 1.0 - eccentricity;
    let speed = ((1.0 + eccentricity) / distance).sqrt();
    vec![
        (1.0 - share, [-share * distance, 0.0, 0.0], [0.0, -share * speed, 0.0]),
        (share, [(1.0 - share) * distance, 0.0, 0.0], [0.0, (1.0 - share) * speed, 0.0]),
    ]
}

/// Three equal bodies on the figure of eight (Chenciner and Montgomery 2000), whose masses of 1 are thirds here.
fn figure_eight() -> Vec<InitialBody> {
    // If masses are multiplied by m, velocities are multiplied by √m.
    let slow = (1.0f64 / 3.0).sqrt();
    let [x, y] = [0.970_004_36, -0.243_087_53];
    let [u, v] = [0.932_407_37 * slow, 0.864_731_46 * slow];
    let m = 1.0 / 3.0;
    vec![
        (m, [x, y, 0.0], [0.5 * u, 0.5 * v, 0.0]),
        (m, [-x, -y, 0.0], [0.5 * u, 0.5 * v, 0.0]),
        (m, [0.0; 3], [-u, -v, 0.0]),
    ]
}

/// Draws an isotropic direction.
fn direction(random: &mut Stream) -> [f64; 3] {
    let z = random.random_range(-1.0..1.0);
    let angle = random.random_range(0.0..TAU);
    let across = f64::sqrt(1.0 - z * z);
    [across * libm::cos(angle), across * libm::sin(angle), z]
}

/// Plummer's sphere of scale 1 in equilibrium (Aarseth, Hénon and Wielen 1974), cut off where it contains 0.999 of its mass.
///
/// Each body draws from the random stream of its number.
fn plummer(numbers: Range<usize>, seed: u64) -> Vec<InitialBody> {
    let mass = 1.0 / numbers.len() as f64;
    let body = |number: usize| {
        let mut random = Stream::new(seed, RandomPurpose::Placement, number as u32 + 1);
        let inside = random.random_range(0.0..0.999);
        let radius = 1.0 / (libm::pow(inside, -2.0 / 3.0) - 1.0).sqrt();
        let place = direction(&mut random).map(|x| radius * x);
        // The ratio q to the escape velocity has the density q² (1 − q²)^{7/2}, which is below 0.1.
        let q = loop {
            let (q, height) = (random.random_range(0.0..1.0f64), random.random_range(0.0..0.1));
            if height < q * q * libm::pow(1.0 - q * q, 3.5) {
                break q;
            }
        };
        let speed = q * f64::sqrt(2.0) * libm::pow(1.0 + radius * radius, -0.25);
        (mass, place, direction(&mut random).map(|v| speed * v))
    };
    numbers.map(body).collect()
}

/// Uniform sphere of radius 1, or its surface, expanding.
fn sphere(start: &NbodyStart) -> Vec<InitialBody> {
    let mass = 1.0 / start.count as f64;
    let body = |number: usize| {
        let mut random = Stream::new(start.seed, RandomPurpose::Placement, number as u32 + 1);
        let radius = match start.kind {
            StartKind::Shell => 1.0,
            _ => libm::cbrt(random.random_range(0.0..1.0)),
        };
        let place = direction(&mut random).map(|x| radius * x);
        (mass, place, place.map(|x| start.expansion * x))
    };
    (0..start.count).map(body).collect()
}

/// Adds random velocities whose kinetic energy is the given fraction of the potential energy.
pub(super) fn stir(bodies: &mut [InitialBody], [virial, softening, constant]: [f64; 3], seed: u64) {
    if virial == 0.0 {
        return;
    }
    let potential = constant * potential(bodies, softening);
    let drawn: Vec<[f64; 3]> = (0..bodies.len())
        .map(|number| {
            let [a, b] = [1, 2].map(|step| {
                stripmine_kernels::noise::normals(
                    seed,
                    RandomPurpose::Placement,
                    number as u32 + 1,
                    1 << 32 | step,
                )
            });
            [a[0], a[1], b[0]]
        })
        .collect();
    let kinetic: f64 =
        bodies.iter().zip(&drawn).map(|((m, ..), v)| 0.5 * m * v.iter().map(|v| v * v).sum::<f64>()).sum();
    let scale = (virial * -potential / kinetic).sqrt();
    for ((.., velocity), drawn) in bodies.iter_mut().zip(drawn) {
        (0..3).for_each(|axis| velocity[axis] += scale * drawn[axis]);
    }
    without_drift(bodies);
}

/// Potential energy of all pairs.
fn potential(bodies: &[InitialBody], softening: f64) -> f64 {
    let of = |number: usize| -> f64 {
        let (m, r, _) = bodies[number];
        let pairs = bodies[..number].iter().map(|(other, there, _)| {
            let square: f64 = (0..3).map(|axis| (r[axis] - there[axis]).powi(2)).sum();
            -m * other / (square + softening * softening).sqrt()
        });
        pairs.sum()
    };
    (0..bodies.len()).map(of).sum()
}

/// Two approaching Plummer spheres, each with half of the bodies and of the mass; `root` is √G.
fn two_clusters(start: &NbodyStart, root: f64) -> Vec<InitialBody> {
    let first = start.count - start.count / 2;
    let mut bodies = vec![];
    for (side, numbers) in [(-0.5, 0..first), (0.5, first..start.count)] {
        let share = numbers.len() as f64 / start.count as f64;
        // In equilibrium at the same scale, half the mass moves √½ as fast.
        let slow = share.sqrt() * root;
        for (mass, place, velocity) in centred(plummer(numbers, start.seed)) {
            let place = [place[0] + side * start.separation, place[1], place[2]];
            let [u, v, w] = velocity.map(|v| slow * v);
            let velocity = [u - 2.0 * side * 0.5 * start.approach, v - side * 0.5 * start.approach, w];
            bodies.push((share * mass, place, velocity));
        }
    }
    centred(bodies)
}

/// Shifts bodies to their centre of mass and removes their momentum.
fn centred(mut bodies: Vec<InitialBody>) -> Vec<InitialBody> {
    let mass: f64 = bodies.iter().map(|(m, ..)| m).sum();
    for axis in 0..3 {
        let centre = bodies.iter().map(|(m, r, _)| m * r[axis]).sum::<f64>() / mass;
        bodies.iter_mut().for_each(|(_, r, _)| r[axis] -= centre);
    }
    without_drift(&mut bodies);
    bodies
}

fn without_drift(bodies: &mut [InitialBody]) {
    let mass: f64 = bodies.iter().map(|(m, ..)| m).sum();
    for axis in 0..3 {
        let drift = bodies.iter().map(|(m, _, v)| m * v[axis]).sum::<f64>() / mass;
        bodies.iter_mut().for_each(|(.., v)| v[axis] -= drift);
    }
}

/// Orbital period of the two bodies on an ellipse.
pub const ORBIT: f64 = 2.0 * PI;

#[cfg(test)]
mod tests {
    use super::*;

    fn start(kind: StartKind, count: usize) -> NbodyStart {
        NbodyStart { kind, count, ..super::super::scene::NbodyScene::default().start }
    }

    fn kinetic(bodies: &[InitialBody]) -> f64 {
        bodies.iter().map(|(m, _, v)| 0.5 * m * v.iter().map(|v| v * v).sum::<f64>()).sum()
    }

    /// Plummer's sphere has the potential energy −3π/32, virial equilibrium, and half of its mass within 1.305.
    #[test]
    fn a_plummer_sphere_is_in_equilibrium() {
        let bodies = initial_bodies(&start(StartKind::Plummer, 4000), 0.0, 1.0);
        let (kinetic, potential) = (kinetic(&bodies), potential(&bodies, 0.0));
        assert!((potential / (-3.0 * PI / 32.0) - 1.0).abs() < 0.04, "{potential}");
        assert!((kinetic / -potential - 0.5).abs() < 0.02, "{kinetic} {potential}");
        let inside =
            bodies.iter().filter(|(_, r, _)| r.iter().map(|x| x * x).sum::<f64>() < 1.305 * 1.305).count();
        assert!((inside as f64 / 4000.0 - 0.5).abs() < 0.03, "{inside}");
    }

    /// An ellipse of semi-major axis 1 has the energy −½ m₁ m₂, a uniform sphere −3/5; the virial ratio is as requested.
    #[test]
    fn start_energies_match_the_literature() {
        for (eccentricity, ratio) in [(0.0, 1.0), (0.5, 1.0), (0.9, 0.1)] {
            let bodies = kepler(eccentricity, ratio);
            let energy = kinetic(&bodies) + potential(&bodies, 0.0);
            assert!((energy / (-0.5 * bodies[0].0 * bodies[1].0) - 1.0).abs() < 1e-13);
        }
        let sphere = initial_bodies(&NbodyStart { virial: 0.5, ..start(StartKind::Sphere, 3000) }, 0.0, 1.0);
        let potential = potential(&sphere, 0.0);
        assert!((potential / -0.6 - 1.0).abs() < 0.03, "{potential}");
        assert!((kinetic(&sphere) / -potential - 0.5).abs() < 1e-3);
        for kind in [StartKind::Plummer, StartKind::Shell, StartKind::TwoClusters, StartKind::FigureEight] {
            let bodies = initial_bodies(&start(kind, 500), 0.0, 1.0);
            let momentum = [0, 1, 2].map(|axis| bodies.iter().map(|(m, _, v)| m * v[axis]).sum::<f64>());
            assert!(momentum.iter().all(|p| p.abs() < 1e-15), "{kind:?} {momentum:?}");
            assert!((bodies.iter().map(|(m, ..)| m).sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    /// Clusters of one seed, and of consecutive seeds, are unrelated: relative to their centres, no two bodies coincide.
    #[test]
    fn clusters_and_seeds_share_no_body() {
        let mut seen: Vec<[f64; 6]> = vec![];
        for seed in [0, 1, 2, 3, u64::MAX] {
            let all = initial_bodies(&NbodyStart { seed, ..start(StartKind::TwoClusters, 64) }, 0.0, 1.0);
            for cluster in all.chunks(32) {
                let state: Vec<[f64; 6]> =
                    cluster.iter().map(|(_, [x, y, z], [u, v, w])| [*x, *y, *z, *u, *v, *w]).collect();
                let mean: [f64; 6] =
                    std::array::from_fn(|k| state.iter().map(|body| body[k]).sum::<f64>() / 32.0);
                seen.extend(state.iter().map(|body| std::array::from_fn(|k| body[k] - mean[k])));
            }
        }
        for (number, body) in seen.iter().enumerate() {
            for other in &seen[..number] {
                let near = |range: Range<usize>| range.into_iter().all(|k| (body[k] - other[k]).abs() < 1e-6);
                assert!(!near(0..3) && !near(3..6), "body {number}: {body:?}");
            }
        }
    }

    /// The virial ratio of every start due to gravity is independent of the constant; given speeds stay.
    #[test]
    fn velocities_scale_with_root_g() {
        for kind in [StartKind::Kepler, StartKind::FigureEight, StartKind::Plummer, StartKind::Sphere] {
            let start = NbodyStart { virial: 0.5, ..start(kind, 100) };
            let [one, other] = [1.0, 6.6743e-11].map(|constant| {
                let bodies = initial_bodies(&start, 0.0, constant);
                kinetic(&bodies) / (constant * potential(&bodies, 0.0))
            });
            assert!((other / one - 1.0).abs() < 1e-12, "{kind:?}: {one} {other}");
        }
        let expanding = NbodyStart { expansion: 2.0, ..start(StartKind::Shell, 10) };
        assert_eq!(initial_bodies(&expanding, 0.0, 1.0), initial_bodies(&expanding, 0.0, 6.6743e-11));
    }
}
