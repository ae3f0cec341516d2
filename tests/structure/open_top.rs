//! Functions in a box with an open top: hand sums, and the ideal gas with fixed heights.

use super::{disc, rows, run, values};
use rand::RngExt;
use std::fs;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_physics::domain::Domain;
use stripmine_physics::particles::{ParticleKind, Particles};
use stripmine_physics::structure::{StructureSetting, observable, sampled_values};

/// Random points along a floor, whose density decreases with height: some are above the height of the box.
pub fn ideal_above_floor(
    random: &mut Stream,
    periodic: [bool; 2],
    radii: &[f64],
) -> (StructureSetting, Particles) {
    let (origin, sides, scale) = ([-3.0, 1.0], [20.0, 15.0], 6.0);
    let disc = |(id, &radius): (u32, &f64)| {
        let rim = if periodic[0] { 0.0 } else { radius };
        let x = random.random_range(origin[0] + rim..origin[0] + sides[0] - rim);
        let height = -scale * random.random_range(0.01_f64..1.0).ln();
        disc(id, ParticleKind::Grain, [x, origin[1] + radius + height], radius)
    };
    let discs = Particles::new((0..).zip(radii).map(disc).collect());
    let setting = StructureSetting::with_open_top(Domain::planar(origin, sides, periodic), &discs);
    let above = discs.all().iter().filter(|disc| disc.position[1] > origin[1] + sides[1]).count();
    assert!(above > 0);
    (setting, discs)
}

/// Four discs of diameter 1 and mass 1 on a floor of 10 with slices up to 20: two on the floor, 2.01 apart, and two at 25.5 and 26.71.
#[test]
fn open_top_functions_agree_with_hand_sums() {
    let places = [[1.05, 0.5], [3.06, 0.5], [1.05, 25.5], [1.05, 26.71]];
    let velocities = [[1.0, 0.0], [-1.0, 2.0], [0.0, -1.0], [3.0, 0.0]];
    let of = |(id, (place, [x, y])): (u32, ([f64; 2], [f64; 2]))| {
        let mut disc = disc(id, ParticleKind::Grain, place, 0.5);
        disc.velocity = [x, y, 0.0];
        disc
    };
    let discs = Particles::new((0..).zip(places.into_iter().zip(velocities)).map(of).collect());
    let domain = Domain::planar([0.0; 2], [10.0, 20.0], [true, false]);
    let setting = StructureSetting::with_open_top(domain, &discs);
    for (name, at, expected) in [
        // Two discs at random positions along the floor: one pair at the same height, one with a height difference of 1.21.
        ("g(r)", 60, 28.427734870543713),
        ("g(r)", 100, 110.99487026449597),
        ("g(r)", 150, 0.0),
        // Along x three discs are at one position, one is 2.01 from it: (10 + 6 cos 2.01k)/4 at k = 2π/10.
        ("S(k)", 0, 2.9545529044491614),
        ("coordination", 0, 0.5),
        ("coordination", 1, 0.5),
        // The mean number.
        ("coordination", 4, 0.5),
        ("psi6", 50, 0.6482999289396894),
        ("psi6", 51, 0.6709059613910289),
        // kT = 2: components 0 three times, ±1/√2, √2 and 3/√2.
        ("velocities", 50, 3.75),
        ("velocities", 57, 1.25),
        ("velocities", 42, 2.5),
        ("velocities", 71, 1.25),
        ("velocities", 100, 3.125),
        // Slices of 0.1, up to the highest centre.
        ("density(x)", 10, 3.0 / 2.671),
        ("density(x)", 30, 1.0 / 2.671),
        ("density(x)", 50, 0.0),
        ("flow(x)", 10, -1.0 / 3.0),
        ("flow(x)", 30, 2.0),
        ("temperature(x)", 10, 4.0 / 3.0),
        // Slices of 0.2 up to 20: the upper two discs are above.
        ("density(y)", 2, 1.0),
        ("density(y)", 99, 0.0),
        ("flow(y)", 2, 0.0),
        ("flow(y)", 99, 0.0),
        ("temperature(y)", 2, 2.0),
    ] {
        let found = values(name, &setting, &discs)[at];
        assert!(
            (found - expected).abs() <= 1e-9 * expected.abs().max(1.0),
            "{name} {at}: {found}, not {expected}"
        );
    }
    // Weights: zero for a slice without a disc, the area for slices along the floor.
    let weights = |name: &str| sampled_values(observable(name).unwrap(), setting, &discs)[1].clone();
    assert_eq!([weights("flow(y)")[2], weights("flow(y)")[99]], [2.0, 0.0]);
    assert!((weights("density(x)")[0] - 267.1).abs() < 1e-9);
}

/// Pairs of the ideal gas by sums over all pairs of heights, with the distribution of two uniform positions along the floor from a sum over
/// positions.
#[test]
fn ideal_gas_below_an_open_top_keeps_heights() {
    let mut random = Stream::new(9, RandomPurpose::Test, 0);
    let mixture: Vec<f64> = [vec![0.25; 50], vec![1.0; 20]].concat();
    for (periodic, radii) in
        [([true, false], vec![0.5; 90]), ([false; 2], vec![0.5; 90]), ([false; 2], mixture)]
    {
        let (setting, discs) = ideal_above_floor(&mut random, periodic, &radii);
        let [g, pairs] = sampled_values(observable("g(r)").unwrap(), setting, &discs);
        let (width, length) = (setting.diameter / 50.0, setting.domain.length(0));
        // Even positions along the floor, one more for one disc than for the other, so that their differences are even too.
        let place = |at: usize, of: usize, radius: f64| match periodic[0] {
            true => (at as f64 + 0.5) / of as f64 * length,
            false => radius + (at as f64 + 0.5) / of as f64 * (length - 2.0 * radius),
        };
        let mut nearer = std::collections::HashMap::new();
        let mut distances = |one: f64, other: f64| {
            nearer
                .entry([one.to_bits(), other.to_bits()])
                .or_insert_with(|| {
                    let both = (0..400).flat_map(|a| (0..401).map(move |b| (a, b)));
                    let distance = |(a, b): (usize, usize)| {
                        let distance = (place(a, 400, one) - place(b, 401, other)).abs();
                        if periodic[0] { distance.min(length - distance) } else { distance }
                    };
                    let mut all: Vec<f64> = both.map(distance).collect();
                    all.sort_by(f64::total_cmp);
                    all
                })
                .clone()
        };
        let all = discs.all();
        // Bins joined by ten, since the number of positions is finite.
        let bins = pairs.len() / 10;
        let mut naive = vec![0.0; bins];
        for (number, one) in all.iter().enumerate() {
            for other in &all[number + 1..] {
                let height = one.position[1] - other.position[1];
                let distances = distances(one.radius, other.radius);
                let within = |r: f64| {
                    let along = (r * r - height * height).max(0.0).sqrt();
                    distances.partition_point(|distance| *distance < along) as f64 / distances.len() as f64
                };
                for (bin, naive) in naive.iter_mut().enumerate() {
                    let [inner, outer] = [bin, bin + 1].map(|edge| within(10.0 * edge as f64 * width));
                    *naive += outer - inner;
                }
            }
        }
        for (bin, naive) in naive.iter().enumerate() {
            let found: f64 = pairs[10 * bin..10 * (bin + 1)].iter().sum();
            assert!((found / naive - 1.0).abs() < 0.01, "{periodic:?} {bin}: {found} and {naive}");
        }
        let whole = [pairs.iter().sum::<f64>(), naive.iter().sum()];
        assert!(pairs.len() % 10 == 0 && (whole[0] / whole[1] - 1.0).abs() < 2e-3, "{whole:?}");
        // The sample is such a gas: its own g(r) is 1 within the noise of its pairs.
        let own = g.iter().zip(&pairs).map(|(g, pairs)| g * pairs).sum::<f64>();
        assert!((own - whole[0]).abs() < 4.0 * whole[0].sqrt(), "{own} {whole:?}");
    }
}

/// Two discs far above a floor, one twice as fast: displacements continue across the sides, and velocities are constant.
#[test]
fn discs_below_an_open_top_move_freely() {
    let folder = tempfile::tempdir().unwrap();
    let text = "format = 2\nunits = \"reduced\"\n[method]\nkind = \"hard-disks\"\n[domain]\nsides = [10.0, 4.0]\nperiodic = [true, false]\n\
         gravity = [0.0, -1e-12]\nopen_top = true\n[particles]\ngenerate = \"list\"\nradius = 0.5\nmass = 1.0\n\
         positions = [[2.0, 1.0], [5.0, 3.0]]\nvelocities = [[1.0, 0.0], [-2.0, 0.5]]\n[run]\ntime = 60.0\nthermo_every = 1.0\nsnapshot_every = 1.0\n";
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    run(folder.path(), "scene.toml", "run", &[], &[]);
    let msd: Vec<[f64; 3]> = rows(folder.path(), "run", "msd");
    let vacf: Vec<[f64; 3]> = rows(folder.path(), "run", "vacf");
    assert!(msd.len() > 1 && vacf.len() > 1);
    for ([lag, square, _], [_, product, _]) in msd.into_iter().zip(vacf) {
        // (1 + 4 + 0.25)/2.
        assert!(
            (square - 2.625 * lag * lag).abs() < 1e-6 && (product - 2.625).abs() < 1e-6,
            "{lag}: {square} {product}"
        );
    }
    // The second disc rises by 0.5 in a unit of time, above the height of 4 soon after the start.
    let summary = fs::read_to_string(folder.path().join("run/summary.json")).unwrap();
    assert!(summary.contains("50 % of the discs are above the highest slice of the open box"), "{summary}");
    for name in ["coordination", "psi6", "velocities", "density(x)", "density(y)", "flow(x)", "flow(y)"] {
        let file =
            fs::read_to_string(folder.path().join("run").join(observable(name).unwrap().file)).unwrap();
        assert!(file.lines().count() > 1, "{name}");
    }
}
