//! Forces between discs and their stress, compared with naive sums, with the observed pressure, and with the weight of a heap.

use super::{ideal, stripmine};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use stripmine_kernels::noise::{RandomPurpose as Noise, Stream};
use stripmine_kernels::sweep::pair::Pair;
use stripmine_physics::method::observed::find;
use stripmine_physics::method::{METHODS, StartPurpose, Until, load};
use stripmine_physics::particles::{ParticleKind, Particles};
use stripmine_physics::structure::{
    PairForces, SamplingKind, StructureSample, StructureSetting, forces_on_each, net_forces, observable,
};

const NAMES: [&str; 3] = ["stress_xx(x,y)", "stress_xy(x,y)", "stress_yy(x,y)"];

/// Components of the stress, cell by cell.
fn stress(setting: StructureSetting, discs: &Particles, forces: &PairForces) -> [Vec<f64>; 3] {
    let observables = NAMES.map(|name| observable(name).unwrap());
    let mut look = StructureSample::new(setting, discs, observables.into_iter());
    assert!(look.take_sample(|states| states.store_grains(discs)));
    look.add_pair_forces(discs, forces);
    observables.map(|it| {
        let [values, _] = look.values(it);
        values
    })
}

/// An arbitrary force that depends on the velocities: it is neither along the line of the centres nor even.
fn made_up() -> PairForces {
    let of = |pair: &Pair| {
        let [one, two] = pair.bodies;
        let [x, y] = [0, 1].map(|axis| one.position[axis] - two.position[axis]);
        let square = x * x + y * y;
        let turn = 0.3 + one.radius * two.radius + 0.1 * (one.omega + two.omega);
        [x / square - turn * y, y / square + turn * x]
    };
    PairForces { reach: 2.5, of: Arc::new(of) }
}

/// Discs with different velocities, spins and masses, every seventh of which is a wall.
fn varied(periodic: [bool; 2], seed: u64) -> (StructureSetting, Particles) {
    let mut random = Stream::new(seed, Noise::Test, 0);
    let (setting, discs) = ideal(&mut random, [23.0, 17.0], periodic, 700);
    let mut discs = discs.all().to_vec();
    for (disc, number) in discs.iter_mut().zip(0..) {
        let part = f64::from(number) / 700.0;
        disc.velocity = [1.0 - part, part * part, 0.0];
        disc.omega = part - 0.5;
        disc.mass = 1.0 + part;
        disc.kind = if number % 7 == 0 { ParticleKind::Wall } else { ParticleKind::Grain };
    }
    (setting, Particles::new(discs))
}

/// The stress is the sum over all pairs, half of it in the cell of each disc.
#[test]
fn stress_is_the_sum_over_all_pairs() {
    for (periodic, seed) in [([true, true], 1), ([true, false], 2), ([false, false], 3)] {
        let (setting, discs) = varied(periodic, seed);
        let forces = made_up();
        let SamplingKind::Once { over, .. } = observable(NAMES[0]).unwrap().seen else { unreachable!() };
        let middles = over.places(&setting);
        let columns = middles.iter().take_while(|middle| middle[1] == middles[0][1]).count();
        let rows = middles.len() / columns;
        let domain = setting.domain;
        let cell = |place: [f64; 2]| {
            let part = [0, 1].map(|axis| (place[axis] - domain.origin[axis]) / domain.length(axis));
            let cell = (part[1] * rows as f64) as usize * columns + (part[0] * columns as f64) as usize;
            let away = [0, 1].map(|axis| (middles[cell][axis] - place[axis]).abs());
            assert!(away[0] <= 0.51 * domain.length(0) / columns as f64, "{place:?}");
            assert!(away[1] <= 0.51 * domain.length(1) / rows as f64, "{place:?}");
            cell
        };
        let [mut naive, area] = [vec![0.0; 3 * middles.len()], vec![domain.area() / middles.len() as f64]];
        let mut on_each = vec![0.0; discs.len()];
        let mut net = vec![[0.0; 2]; discs.len()];
        let all = discs.all();
        for (at, one) in all.iter().enumerate() {
            if one.kind == ParticleKind::Grain {
                let [x, y] = one.planar_velocity();
                for (sum, part) in [x * x, x * y, y * y].into_iter().enumerate() {
                    naive[3 * cell(one.planar_position()) + sum] += one.mass * part / area[0];
                }
            }
            for (other, two) in all.iter().enumerate().skip(at + 1) {
                let displacement = domain.displacement(one.planar_position(), two.planar_position());
                let are_walls = one.kind == ParticleKind::Wall && two.kind == ParticleKind::Wall;
                if displacement[0].hypot(displacement[1]) >= forces.reach || are_walls {
                    continue;
                }
                let turn = 0.3 + one.radius * two.radius + 0.1 * (one.omega + two.omega);
                let [x, y] = displacement;
                let square = x * x + y * y;
                let force = [x / square - turn * y, y / square + turn * x];
                [at, other].into_iter().for_each(|disc| on_each[disc] += force[0].hypot(force[1]));
                // The vector leads to the other disc, and the force is odd in it.
                for axis in [0, 1] {
                    net[other][axis] += force[axis];
                    net[at][axis] -= force[axis];
                }
                let parts = [x * force[0], 0.5 * (x * force[1] + y * force[0]), y * force[1]];
                for place in [one.planar_position(), two.planar_position()] {
                    for (sum, part) in parts.into_iter().enumerate() {
                        naive[3 * cell(place) + sum] += 0.5 * part / area[0];
                    }
                }
            }
        }
        let found = stress(setting, &discs, &forces);
        for (component, found) in found.iter().enumerate() {
            for (cell, found) in found.iter().enumerate() {
                let naive = naive[3 * cell + component];
                assert!(
                    (found - naive).abs() < 1e-9 * naive.abs().max(1.0),
                    "{component} {cell}: {found} {naive}"
                );
            }
        }
        let found = forces_on_each(&setting, all, &forces);
        for (at, (found, naive)) in found.iter().zip(&on_each).enumerate() {
            assert!((found - naive).abs() < 1e-9 * naive, "{at}: {found} {naive}");
        }
        let found = net_forces(&setting, all, &forces);
        for (at, ((found, naive), scale)) in found.iter().zip(&net).zip(&on_each).enumerate() {
            let apart = [0, 1].map(|axis| found[axis] - naive[axis]);
            assert!(apart[0].hypot(apart[1]) <= 1e-9 * scale, "{at}: {found:?} {naive:?}");
        }
    }
}

/// The stress has the same bits on any number of threads.
#[test]
fn stress_does_not_depend_on_threads() {
    let (setting, discs) = varied([true, false], 4);
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| stress(setting, &discs, &made_up()));
        found.concat().iter().map(|it| it.to_bits()).collect::<Vec<_>>()
    };
    assert!(of(1) == of(3));
}

/// In a box without walls, half the trace of the stress is the pressure that the method observes, computed differently. The kinetic part is excluded,
/// which a bath observes at another moment of the step.
#[test]
fn the_mean_stress_is_the_pressure() {
    for scene in ["langevin-dense", "dense-gas", "wide-sizes"] {
        let (prepared, method) = load(scene, &[], METHODS).unwrap();
        let mut simulation = prepared.start(StartPurpose::Run).unwrap();
        simulation.advance(&[Until::Steps(300)], &AtomicBool::new(false)).unwrap();
        let observed = |name: &str| simulation.observe()[find(method.quantities, name).unwrap()];
        let area = prepared.domain.area();
        let of_pairs = observed("pressure") * area - observed("kinetic");
        let setting = StructureSetting::new(prepared.domain, prepared.particles());
        let forces = prepared.model.pair_forces().unwrap();
        let discs = simulation.particles();
        let [xx, _, yy] = stress(setting, &discs, &forces);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let square = |[x, y]: [f64; 2]| x * x + y * y;
        let motion =
            discs.grains().iter().map(|disc| 0.5 * disc.mass * square(disc.planar_velocity())).sum::<f64>();
        let found = 0.5 * (mean(&xx) + mean(&yy)) * area - motion;
        assert!((found - of_pairs).abs() < 1e-9 * motion, "{scene}: {found} {of_pairs}");
        assert!(of_pairs.abs() > 0.01 * motion, "{scene}: {of_pairs} {motion}");
    }
}

/// Grains at rest on a floor: over the whole box the stress along y is their weight times their height above the centres of the floor
/// (the virial theorem).
#[test]
fn stress_of_a_heap_balances_its_weight() {
    let sets = ["particles.wall_motion=\"fixed\"", "law.normal_damping=2000.0", "run.time=3.0"];
    let sets = sets.map(str::to_owned);
    let (prepared, _) = load("shaken-box", &sets, METHODS).unwrap();
    let mut simulation = prepared.start(StartPurpose::Run).unwrap();
    simulation.advance(&[prepared.schedule.until], &AtomicBool::new(false)).unwrap();
    let discs = simulation.particles();
    let setting = StructureSetting::new(prepared.domain, prepared.particles());
    let [_, _, yy] = stress(setting, &discs, &prepared.model.pair_forces().unwrap());
    let floor = discs.all().iter().find(|disc| disc.kind == ParticleKind::Wall).unwrap().position[1];
    let found = yy.iter().sum::<f64>() / yy.len() as f64 * prepared.domain.area();
    let weights = discs.grains().iter().map(|disc| 9.81 * disc.mass * (disc.position[1] - floor));
    let held = weights.sum::<f64>();
    assert!((found / held - 1.0).abs() < 0.01, "{found} {held}");
}

/// A run writes three files with positions and error bars, a map of each, and particles coloured by force; hard discs have no forces.
#[test]
fn stress_is_written_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let asked = format!("output.structure={NAMES:?}");
    let run = |scene: &str, sets: &[&str]| {
        let sets = sets.iter().flat_map(|set| ["--set", set]);
        stripmine(folder, &["run", scene, "--out", "a"].into_iter().chain(sets).collect::<Vec<_>>())
    };
    let output = run(
        "langevin-dense",
        &["run.steps=1000", "run.snapshot_every=20", "output.structure_share=100.0", &asked],
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for name in NAMES {
        let text = fs::read_to_string(folder.join("a").join(observable(name).unwrap().file)).unwrap();
        let (head, rows) = text.split_once('\n').unwrap();
        assert!(
            head.starts_with("x (length),y (length),stress ") && head.ends_with(" (force/length),error"),
            "{head}"
        );
        assert_eq!(rows.lines().count(), 400);
    }
    let said = stripmine(folder, &["average", "a", "--structure", NAMES[0], "--csv"]).stdout;
    assert_eq!(String::from_utf8(said).unwrap(), fs::read_to_string(folder.join("a/stress-xx.csv")).unwrap());
    let plot =
        |run: &str, more: &[&str]| stripmine(folder, &[&["plot", run, "--color", "force"], more].concat());
    let output = plot("a", &["--film"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for name in ["stress-xx.svg", "stress-xy.svg", "stress-yy.svg", "last-state.svg", "film.html"] {
        assert!(Path::new(&folder.join("a.plots").join(name)).exists(), "{name}");
    }
    let refused = stripmine(folder, &["run", "hard-disks", "--out", "b", "--set", &asked]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(3) && said.contains("needs pair forces"), "{said}");
    stripmine(folder, &["run", "hard-disks", "--out", "b", "--set", "run.time=1.0"]);
    let refused = plot("b", &[]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("no continuous pair forces"), "{said}");
}
