//! Structure functions of a run: compared with theory (here), with naive sums (`oracles`) in boxes of every kind (`boxes`), below an open top
//! (`open_top`),
//! their error bars (`bars`), small scenes with known values (`cases`), discs across periodic sides (`followed`), forces (`forces`), and independence
//! of the
//! number of sessions.

mod bars;
mod boxes;
mod cases;
mod followed;
mod forces;
mod open_top;
mod oracles;
mod species;

use assert_cmd::cargo::CommandCargoExt;
use rand::RngExt;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_physics::domain::Domain;
use stripmine_physics::particles::{Particle, ParticleKind, Particles};
use stripmine_physics::structure::{
    NAMES, SamplingKind, StructureSetting, observable, pair_counts, pair_counts_of_all, sampled_values,
};

fn stripmine(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder).args(arguments).arg("--quiet").output().unwrap()
}

/// Functions available for hard discs of one species: all that need no forces.
fn names() -> Vec<&'static str> {
    let is_of_species = |name: &str| observable(name).unwrap().species() > 0;
    NAMES.into_iter().filter(|name| !name.starts_with("stress") && !is_of_species(name)).collect()
}

/// Runs a scene with all these functions, sampled at every row and snapshot.
fn run(folder: &Path, scene: &str, out: &str, sets: &[&str], more: &[&str]) {
    let all = format!("output.structure={:?}", names());
    let sets = [&[all.as_str(), "output.structure_share=1000.0"], sets].concat();
    let sets = sets.into_iter().flat_map(|set| ["--set", set]);
    let arguments: Vec<&str> = ["run", scene, "--out", out].into_iter().chain(sets).collect();
    let output = stripmine(folder, &[&arguments, more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Rows of a function's file: its arguments, mean and error bar.
fn rows<const COLUMNS: usize>(folder: &Path, out: &str, name: &str) -> Vec<[f64; COLUMNS]> {
    let text = fs::read_to_string(folder.join(out).join(observable(name).unwrap().file)).unwrap();
    let numbers = |line: &str| line.split(',').map(|number| number.parse().unwrap()).collect::<Vec<f64>>();
    text.lines().skip(1).map(|line| numbers(line).try_into().unwrap()).collect()
}

fn of_name(list: &Value, name: &str) -> Value {
    list.as_array().unwrap().iter().find(|it| it["name"] == name).unwrap_or(&Value::Null).clone()
}

/// Entry of an observable in the summary of a run.
fn summed(folder: &Path, out: &str, name: &str) -> Value {
    let text = fs::read_to_string(folder.join(out).join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    of_name(&summary["structure"], name)
}

/// Mean and error bar of a headline.
fn headline(folder: &Path, out: &str, name: &str, what: &str) -> [f64; 2] {
    let found = of_name(&summed(folder, out, name)["headlines"], what);
    ["mean", "bar"].map(|key| found[key].as_f64().unwrap())
}

/// An ideal gas in a box: random points, at least a radius away from closed sides.
fn ideal(
    random: &mut Stream,
    sides: [f64; 2],
    periodic: [bool; 2],
    count: u32,
) -> (StructureSetting, Particles) {
    ideal_of(random, sides, periodic, &vec![0.5; count as usize])
}

/// An ideal gas of discs with given radii.
fn ideal_of(
    random: &mut Stream,
    sides: [f64; 2],
    periodic: [bool; 2],
    radii: &[f64],
) -> (StructureSetting, Particles) {
    let origin = [-3.0, 1.0];
    let disc = |(id, &radius): (u32, &f64)| {
        let at = [0, 1].map(|axis| {
            let rim = if periodic[axis] { 0.0 } else { radius };
            random.random_range(origin[axis] + rim..origin[axis] + sides[axis] - rim)
        });
        disc(id, ParticleKind::Grain, at, radius)
    };
    let discs = Particles::new((0..).zip(radii).map(disc).collect());
    (StructureSetting::new(Domain::planar(origin, sides, periodic), &discs), discs)
}

fn disc(id: u32, kind: ParticleKind, [x, y]: [f64; 2], radius: f64) -> Particle {
    let velocity = [1.0, 0.0, 0.0];
    Particle {
        id,
        kind,
        species: 0,
        position: [x, y, 0.0],
        velocity,
        angle: 0.0,
        omega: 0.0,
        radius,
        mass: 1.0,
    }
}

/// An ideal gas in a channel between rows of wall discs; the space behind the walls is empty.
fn ideal_in_channel(random: &mut Stream) -> (StructureSetting, Particles) {
    let (sides, radius) = ([20.0, 12.0], 0.4);
    let walls = (0..20).flat_map(|column| [3.0, 9.0].map(|y| [f64::from(column) + 0.5, y]));
    let walls: Vec<[f64; 2]> = walls.collect();
    let domain = Domain::planar([0.0; 2], sides, [true, false]);
    let mut all = vec![];
    while all.len() < 150 {
        let at = [random.random_range(0.0..sides[0]), random.random_range(3.0..9.0)];
        if walls.iter().all(|wall| domain.distance(at, *wall) > 0.5 + radius) {
            all.push(disc(all.len() as u32, ParticleKind::Grain, at, radius));
        }
    }
    all.extend(walls.into_iter().zip(150..).map(|(at, id)| disc(id, ParticleKind::Wall, at, 0.5)));
    let particles = Particles::new(all);
    (StructureSetting::new(domain, &particles), particles)
}

fn values(name: &str, setting: &StructureSetting, discs: &Particles) -> Vec<f64> {
    let [values, _] = sampled_values(observable(name).unwrap(), *setting, discs);
    values
}

/// In periodic and in closed boxes, with one size and two, and between wall discs, an ideal gas has g(r) = 1 and S(k) = 1 at every
/// distance and wave vector: within four times the error of each, and with the expected sum of all errors. Pairs are those
/// of a search over all pairs.
#[test]
fn an_ideal_gas_has_no_structure() {
    let mut random = Stream::new(1, RandomPurpose::Test, 0);
    let mixed: Vec<f64> = [vec![0.3; 120], vec![2.4; 30]].concat();
    let mut of = |which: usize| -> (StructureSetting, Particles) {
        match which {
            0 => ideal(&mut random, [20.0, 13.0], [true, true], 150),
            1 => ideal(&mut random, [20.0, 9.0], [true, false], 150),
            2 => ideal(&mut random, [11.0, 12.0], [false, false], 150),
            3 => ideal_of(&mut random, [20.0, 16.0], [false, false], &mixed),
            _ => ideal_in_channel(&mut random),
        }
    };
    for which in 0..5 {
        const LOOKS: usize = 200;
        let made: Vec<(StructureSetting, Particles)> = (0..LOOKS).map(|_| of(which)).collect();
        let (setting, _) = &made[0];
        for name in ["g(r)", "S(k)"].into_iter().take(if setting.domain.is_periodic(0) { 2 } else { 1 }) {
            // The reference of the ideal gas is computed once for a run, but here for each sample.
            let looks = if which == 4 && name == "g(r)" { &made[..50] } else { &made[..] };
            let looks: Vec<Vec<f64>> = looks
                .iter()
                .map(|(setting, discs)| {
                    assert_eq!(
                        pair_counts(setting, discs.grains()),
                        pair_counts_of_all(setting, discs.grains())
                    );
                    values(name, setting, discs)
                })
                .collect();
            // With very few pairs, errors are not normal.
            let places = if name == "g(r)" { 20..looks[0].len() } else { 0..looks[0].len() };
            let scores: Vec<f64> = places
                .map(|place| {
                    let n = looks.len() as f64;
                    let mean = looks.iter().map(|look| look[place]).sum::<f64>() / n;
                    let square = looks.iter().map(|look| (look[place] - mean).powi(2)).sum::<f64>();
                    (mean - 1.0) / (square / (n * (n - 1.0))).sqrt()
                })
                .collect();
            let worst = scores.iter().fold(0.0_f64, |worst, score| worst.max(score.abs()));
            let square = scores.iter().map(|score| score * score).sum::<f64>() / scores.len() as f64;
            let mean = scores.iter().sum::<f64>() / scores.len() as f64;
            assert!(worst < 4.5 && (0.6..1.5).contains(&square), "{name} {which}: {worst} {square}");
            assert!(mean.abs() < 0.4, "{name} {which}: {mean}");
        }
    }
}

/// A hexagonal crystal has six neighbours, |Ψ6| = 1, and S(k) = N at its periods.
#[test]
fn a_crystal_is_in_order() {
    let (columns, rows) = (12_u32, 14_u32);
    let edge = 1.1;
    let domain = Domain::planar([0.0; 2], [12.0 * edge, 14.0 * edge * 0.75_f64.sqrt()], [true; 2]);
    let disc = |id: u32| {
        let (column, row) = (f64::from(id % columns), f64::from(id / columns));
        let at = [(column + 0.5 * (row % 2.0) + 0.1) * edge, (row + 0.1) * edge * 0.75_f64.sqrt()];
        disc(id, ParticleKind::Grain, at, 0.5)
    };
    let discs = Particles::new((0..columns * rows).map(disc).collect());
    let setting = StructureSetting::new(domain, &discs);
    let shares = values("coordination", &setting, &discs);
    assert!((shares[6] - 1.0).abs() < 1e-12, "{shares:?}");
    let order = values("psi6", &setting, &discs);
    let [global, mean] = [order[order.len() - 2], order[order.len() - 1]];
    assert!((global - 1.0).abs() < 1e-9 && (mean - 1.0).abs() < 1e-9, "{global} {mean}");
    let SamplingKind::Once { over, .. } = observable("S(k)").unwrap().seen else { unreachable!() };
    let factor = values("S(k)", &setting, &discs);
    let vectors = over.places(&setting);
    // All waves along x and y up to 25 of a diameter.
    let most = |axis: usize| (25.0 * domain.length(axis) / TAU) as usize;
    assert_eq!(vectors.len(), most(0) + most(1));
    for (vector, value) in vectors.iter().zip(factor) {
        let angle = |disc: &Particle| vector[0] * disc.position[0] + vector[1] * disc.position[1];
        let sum = |part: fn(f64) -> f64| discs.grains().iter().map(|disc| part(angle(disc))).sum::<f64>();
        let naive = (sum(f64::cos).powi(2) + sum(f64::sin).powi(2)) / f64::from(columns * rows);
        assert!((value - naive).abs() < 1e-6, "{vector:?}: {value} {naive}");
        // Two rows to a period along y, and two columns, since every other row is shifted by half a column.
        let peaks = [0, 1].map(|axis| {
            let periods = (vector[axis] * domain.length(axis) / TAU).round() as usize;
            periods.is_multiple_of([24, 14][axis])
        });
        let expected = if peaks == [true; 2] { f64::from(columns * rows) } else { 0.0 };
        assert!((value - expected).abs() < 1e-6, "{vector:?}: {value}");
    }
}

/// Hard discs: g at contact is (Z − 1)/(2ν) by the virial, and velocities are Maxwell's.
#[test]
fn contact_value_agrees_with_the_pressure() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(folder, "hard-disks", "a", &["run.snapshot_every=0.5", "run.events=1e6"], &[]);
    let text = fs::read_to_string(folder.join("a/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    let averages = summary["averages"]["quantities"].as_array().unwrap();
    let z = averages.iter().find(|it| it["quantity"] == "compressibility").unwrap()["mean"].as_f64().unwrap();
    let virial = (z - 1.0) / (2.0 * 0.5);
    let g: Vec<[f64; 3]> = rows(folder, "a", "g(r)");
    assert!(g.iter().filter(|[r, ..]| *r < 1.0).all(|[_, g, _]| *g == 0.0));
    // A straight line through the first bins after contact.
    let first: Vec<[f64; 3]> = g.iter().copied().filter(|[r, ..]| (1.0..1.1).contains(r)).collect();
    let n = first.len() as f64;
    let mean = |of: fn(&[f64; 3]) -> f64| first.iter().map(of).sum::<f64>() / n;
    let [r, value] = [mean(|row| row[0]), mean(|row| row[1])];
    let slope = first.iter().map(|row| (row[0] - r) * (row[1] - value)).sum::<f64>()
        / first.iter().map(|row| (row[0] - r).powi(2)).sum::<f64>();
    let contact = value + slope * (1.0 - r);
    assert!((contact / virial - 1.0).abs() < 0.02, "{contact} {virial}");
    let [kurtosis, bar] = headline(folder, "a", "velocities", "kurtosis");
    assert!((kurtosis - 3.0).abs() < 2.0 * bar + 6.0 / 1054.0 && bar < 0.03, "{kurtosis} ± {bar}");
    let density: Vec<[f64; 3]> = rows(folder, "a", "velocities");
    let far = density.iter().filter(|[v, density, error]| {
        let maxwell = (-0.5 * v * v).exp() / TAU.sqrt();
        (density - maxwell).abs() > 2.0 * error + 1e-3
    });
    assert!(far.count() < 3);
    // S(k → 0) is the compressibility of the fluid, far below 1; at large k it is 1.
    let waves: Vec<[f64; 4]> = rows(folder, "a", "S(k)");
    let last = waves[waves.len() - 50..].iter().map(|wave| wave[2]).sum::<f64>() / 50.0;
    assert!(waves[0][2] < 0.15 && (last - 1.0).abs() < 0.1, "{:?} {last}", waves[0]);
    let [global, _] = headline(folder, "a", "psi6", "global order |Ψ6|");
    assert!(global < 0.05, "{global}");
}

/// A run in two sessions writes the same files, whether or not all functions are requested from the start.
#[test]
fn structure_does_not_depend_on_sessions() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (scene, [half, whole]) in [
        ("hard-disks", ["run.events=77777", "run.events=300000"]),
        ("langevin-dense", ["run.steps=3333", "run.steps=10000"]),
        ("dense-gas", ["run.steps=777", "run.steps=2000"]),
    ] {
        let closer: &[&str] = match scene {
            "hard-disks" => &["run.snapshot_every=1.0", "run.thermo_every=0.5", "particles.count=200"],
            _ => &["run.snapshot_every=100", "run.thermo_every=30", "particles.count=100"],
        };
        let [one, two] = ["one", "two"].map(|name| format!("{scene}-{name}"));
        run(folder, scene, &one, &[closer, &[whole]].concat(), &[]);
        run(folder, scene, &two, &[closer, &[half]].concat(), &[]);
        run(folder, scene, &two, &[closer, &[whole]].concat(), &["--resume", "--threads", "1"]);
        for name in names() {
            let file = observable(name).unwrap().file;
            let [one, two] = [&one, &two].map(|out| fs::read_to_string(folder.join(out).join(file)).unwrap());
            assert!(one == two && one.lines().count() > 5, "{scene} {name}:\n{one}");
        }
        // Requested later: it starts then.
        let third = format!("{scene}-third");
        run(folder, scene, &third, &[closer, &[half, "output.structure=[]"]].concat(), &[]);
        run(folder, scene, &third, &[closer, &[whole]].concat(), &["--resume"]);
        let text = fs::read_to_string(folder.join(&third).join("summary.json")).unwrap();
        assert!(text.contains("g(r) is averaged from here on"), "{text}");
    }
}

/// Waves need a periodic side: a box without one has no S(k), with an open top or without.
#[test]
fn waves_need_a_periodic_side() {
    let folder = tempfile::tempdir().unwrap();
    for open in [true, false] {
        for (periodic, code) in [("[false, false]", 3), ("[true, false]", 0)] {
            let all = format!("output.structure={:?}", names());
            let top = format!("domain.open_top={open}");
            let sides = format!("domain.periodic={periodic}");
            let sets: Vec<&str> =
                [all.as_str(), &top, &sides].into_iter().flat_map(|set| ["--set", set]).collect();
            let output =
                stripmine(folder.path(), &[&["scene", "check", "vibrating-floor"], &sets[..]].concat());
            let said = String::from_utf8_lossy(&output.stderr);
            let is_refused = said.contains("\"S(k)\" of `output.structure` needs a periodic side");
            assert!(
                output.status.code() == Some(code) && is_refused == (code == 3),
                "{open} {periodic}: {said}"
            );
        }
    }
}
