//! Small scenes whose values are known by hand or from theory.

use super::{headline, rows, run, stripmine, summed};
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

/// Writes a scene to a file and returns its name.
fn scene(folder: &Path, name: &str, text: &str) -> String {
    fs::write(folder.join(name), text).unwrap();
    name.to_owned()
}

/// A scene of listed hard discs.
fn listed(sides: [f64; 2], radii: &[f64], places: &[[f64; 2]]) -> String {
    format!(
        "format = 2\nunits = \"reduced\"\n[method]\nkind = \"hard-disks\"\n[domain]\nsides = {sides:?}\n[particles]\ngenerate = \
         \"list\"\nradius = 0.5\nmass = 1.0\npositions = {places:?}\nradii = {radii:?}\n[run]\ntime = 40.0\nthermo_every = 1.0\n\
         snapshot_every = 1.0\n"
    )
}

fn structure(names: &[&str]) -> String {
    format!("output.structure={names:?}")
}

/// Sixteen discs on a lattice of 3 × 6: S = 16 at multiples of the lattice's wave vector along each axis, and 0 at every other wave vector.
#[test]
fn rectangular_lattice_has_waves_at_its_periods() {
    let folder = tempfile::tempdir().unwrap();
    let places: Vec<[f64; 2]> = [3.0, 9.0]
        .into_iter()
        .flat_map(|y| (0..8).map(move |column| [1.0 + 3.0 * f64::from(column), y]))
        .collect();
    for (sides, copies) in [([24.0, 12.0], 1), ([48.0, 12.0], 2), ([24.0, 60.0], 5)] {
        let shift = |copy: u32| match sides[0] > 24.0 {
            true => [24.0 * f64::from(copy), 0.0],
            false => [0.0, 12.0 * f64::from(copy)],
        };
        let all = (0..copies)
            .flat_map(|copy| places.iter().map(move |at| [0, 1].map(|axis| at[axis] + shift(copy)[axis])));
        let all: Vec<[f64; 2]> = all.collect();
        let name = scene(folder.path(), "lattice.toml", &listed(sides, &vec![0.5; all.len()], &all));
        run(folder.path(), &name, "lattice", &[&structure(&["S(k)"])], &["--overwrite"]);
        let found: Vec<[f64; 4]> = rows(folder.path(), "lattice", "S(k)");
        let most = sides.map(|side| (25.0 * side / TAU) as usize);
        assert_eq!(found.len(), most[0] + most[1], "{sides:?}");
        for [kx, ky, value, bar] in found {
            // The period is 3 along x, and 6 along y.
            let (number, period) = if ky == 0.0 { (kx, TAU / 3.0) } else { (ky, TAU / 6.0) };
            let is_peak = (number / period - (number / period).round()).abs() < 1e-9;
            let expected = if is_peak { all.len() as f64 } else { 0.0 };
            assert!((value - expected).abs() < 1e-9 && bar < 1e-9, "{sides:?}: {kx} {ky}: {value}");
        }
    }
}

/// A disc of radius 6 with thirty of 0.5 around it: the small ones touch two of their kind and the large one, which has thirty neighbours. The
/// same by hand for 26 around one of radius 5.
#[test]
fn large_discs_have_many_neighbours() {
    let folder = tempfile::tempdir().unwrap();
    for (radius, around, distance) in [(6.0, 30, 7.0), (5.0, 26, 6.0)] {
        let middle = 2.0 * distance;
        let angle = |number: u32| TAU * f64::from(number) / f64::from(around);
        let ring = (0..around)
            .map(|number| [middle + distance * angle(number).cos(), middle + distance * angle(number).sin()]);
        let places: Vec<[f64; 2]> = std::iter::once([middle; 2]).chain(ring).collect();
        let radii: Vec<f64> = std::iter::once(radius).chain((0..around).map(|_| 0.5)).collect();
        let text = listed([2.0 * middle; 2], &radii, &places);
        let name = scene(folder.path(), "ring.toml", &text);
        run(folder.path(), &name, "ring", &[&structure(&["coordination", "psi6"])], &["--overwrite"]);
        let count = f64::from(around);
        let [mean, bar] = headline(folder.path(), "ring", "coordination", "mean number of neighbours");
        assert!((mean - 4.0 * count / (count + 1.0)).abs() < 1e-12 && bar < 1e-9, "{mean} ± {bar}");
        let shares: Vec<[f64; 3]> = rows(folder.path(), "ring", "coordination");
        for [number, share, _] in shares {
            let expected = if number == 3.0 {
                count / (count + 1.0)
            } else {
                f64::from(u8::from(number == count)) / (count + 1.0)
            };
            assert!((share - expected).abs() < 1e-12, "{number}: {share}");
        }
        assert!(summed(folder.path(), "ring", "coordination")["doubt"].is_null());
    }
    // A single disc at rest has no order and no velocities; this is reported instead of 0.
    let name = scene(folder.path(), "alone.toml", &listed([9.0; 2], &[0.5], &[[4.0, 4.0]]));
    run(folder.path(), &name, "alone", &[&structure(&["psi6", "g(r)", "density(x)", "velocities"])], &[]);
    for name in ["psi6", "g(r)", "velocities"] {
        let said = summed(folder.path(), "alone", name);
        assert!(said["headlines"].as_array().unwrap().is_empty(), "{said}");
        assert!(said["doubt"].as_str().unwrap().starts_with("there was no value in"), "{said}");
    }
    // One slice contains the disc; for the others, nothing shows how rarely a disc is there.
    let density: Vec<[f64; 3]> = rows(folder.path(), "alone", "density(x)");
    assert_eq!(density.iter().filter(|[_, density, bar]| *density > 0.0 && *bar == 0.0).count(), 1);
    assert_eq!(density.iter().filter(|[_, density, bar]| *density == 0.0 && bar.is_nan()).count(), 99);
}

/// Pairs 1.11 apart on a square lattice of 2.79: by hand a disc has one other at 1.11 and four at 2.79, so the second peak is higher, by
/// 4/2.79 to 1/1.11. The first one is reported.
#[test]
fn first_peak_need_not_be_the_highest() {
    let folder = tempfile::tempdir().unwrap();
    let places = (0..32).map(|disc| {
        let [column, row] = [disc / 2 % 4, disc / 8].map(|at| 1.0 + 2.79 * f64::from(at));
        [column + 1.11 * f64::from(disc % 2), row]
    });
    let text = listed([11.16; 2], &[0.5; 32], &places.collect::<Vec<_>>());
    let name = scene(folder.path(), "pairs.toml", &text);
    run(folder.path(), &name, "pairs", &[&structure(&["g(r)"])], &[]);
    let g: Vec<[f64; 3]> = rows(folder.path(), "pairs", "g(r)");
    let at = |r: f64| g.iter().find(|row| (row[0] - r).abs() < 1e-9).unwrap()[1];
    assert!((at(2.79) / at(1.11) - 4.0 * 1.11 / 2.79).abs() < 1e-9, "{} {}", at(2.79), at(1.11));
    let [place, _] = headline(folder.path(), "pairs", "g(r)", "place of the first peak");
    let [height, _] = headline(folder.path(), "pairs", "g(r)", "height of the first peak");
    assert!((place - 1.11).abs() < 1e-9 && (height / at(1.11) - 1.0).abs() < 1e-12, "{place} {height}");
}

/// A gas between walls of discs has g = 1, in channels of two widths and boxes of two heights.
#[test]
fn a_gas_in_a_channel_has_no_structure() {
    let folder = tempfile::tempdir().unwrap();
    for (height, width) in [(12.0, 5.0), (20.0, 5.0), (12.0, 8.0)] {
        let text = format!(
            "format = 2\nunits = \"reduced\"\n[method]\nkind = \"lattice-md\"\n[domain]\nsides = [100.0, {height:?}]\nperiodic = [true, \
             false]\n[particles]\ngenerate = \"pipe\"\ncount = 30\nradius = 0.5\nmass = 1.0\nspeed = 0.5\nclear_width = {width:?}\n\
             wall_radius = 0.45\nwall_spacing = 1.0\nseed = 2\n[law]\nstiffness = 1e4\n[integrator]\nkind = \"velocity-verlet\"\ndt = \
             2e-3\n[run]\nsteps = 400000\nthermo_every = 0\nsnapshot_every = 400\n[output]\ntrajectory = false\n"
        );
        let name = scene(folder.path(), "pipe.toml", &text);
        run(folder.path(), &name, "pipe", &[&structure(&["g(r)"])], &["--overwrite"]);
        let found: Vec<[f64; 3]> = rows(folder.path(), "pipe", "g(r)");
        // Bins of a quarter of a diameter together: beyond contact.
        for bins in found.chunks(12).filter(|bins| bins[0][0] > 1.2) {
            let count = bins.len() as f64;
            let [mean, bar] = [1, 2].map(|at| bins.iter().map(|row| row[at]).sum::<f64>() / count);
            let bar = bar / count.sqrt();
            assert!(
                (mean - 1.0).abs() < 0.05 + 2.0 * bar,
                "{height} {width}: {mean} ± {bar} at {}",
                bins[0][0]
            );
            assert!(bar < 0.15, "{bar}");
        }
    }
}

const FREE: &str = "format = 2\nunits = \"reduced\"\n[method]\nkind = \"langevin\"\n[domain]\nsides = [5.0, 5.0]\n[particles]\ngenerate = \
                    \"mesh\"\ncount = 100\nradius = 0.05\nmass = 1.0\ntemperature = 1.0\nseed = 7\n[law]\nkind = \"none\"\ndrag = 0.2\n\
                    bath_temperature = 1.0\n[integrator]\ndt = 0.02\n[run]\ntime = 4000.0\nthermo_every = 500\nsnapshot_every = 0\n";

/// Free particles in a bath: D = kT/γ, also if they cross the box between two rows; if lags are too short, the required time is reported instead of
/// D,
/// and a run of that time reports D. Hard discs so thin that they rarely collide: D by Enskog.
#[test]
fn diffusion_constant_is_reported_when_known() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let free = scene(folder, "free.toml", FREE);
    let asked = structure(&["msd", "vacf"]);
    // Rows ten apart, five relaxation times.
    run(folder, &free, "far", &[&asked], &[]);
    let [d, bar] = headline(folder, "far", "msd", "diffusion constant");
    assert!((d - 5.0).abs() < 1.5 * bar && bar < 0.8, "{d} ± {bar}");
    let said = summed(folder, "far", "vacf")["doubt"].as_str().unwrap().to_owned();
    assert!(said.contains("rows too far apart"), "{said}");
    // Too short, and as long as reported to be enough.
    for (name, sets, exact) in [
        ("bath", vec!["law.drag=1.0", "run.time=40.0", "run.thermo_every=1", "integrator.dt=0.05"], 1.0),
        ("slow", vec!["law.drag=0.1", "run.time=100.0", "run.thermo_every=10", "integrator.dt=0.05"], 10.0),
    ] {
        let sets = [&sets[..], &[asked.as_str()]].concat();
        run(folder, &free, name, &sets, &[]);
        let mut enough = 0.0_f64;
        for observable in ["msd", "vacf"] {
            let said = summed(folder, name, observable);
            assert!(said["headlines"].as_array().unwrap().is_empty(), "{said}");
            let doubt = said["doubt"].as_str().unwrap();
            let (_, time) = doubt.split_once("until about time ").unwrap_or_else(|| panic!("{doubt}"));
            enough = enough.max(time.split(' ').next().unwrap().parse().unwrap());
            // In units of τ = 1/γ.
            assert!((50.0..2000.0).contains(&(enough / exact)), "{doubt}");
        }
        let time = format!("run.time={:?}", (enough / 0.5).ceil() * 0.5);
        run(folder, &free, name, &[&sets[..], &[&time]].concat(), &["--overwrite"]);
        for observable in ["msd", "vacf"] {
            let [d, bar] = headline(folder, name, observable, "diffusion constant");
            assert!((d - exact).abs() < 2.0 * bar && bar < 0.5 * exact, "{name} {observable}: {d} ± {bar}");
        }
    }
    // Between closed sides displacements are bounded.
    let sets = [
        "domain.periodic=[true, false]",
        "particles.generate=\"random\"",
        "domain.sides=[12.0, 9.0]",
        "particles.radius=0.2",
        "particles.count=50",
        "run.time=200.0",
        asked.as_str(),
    ];
    run(folder, "hard-disks", "closed", &sets, &[]);
    for observable in ["msd", "vacf"] {
        let said = summed(folder, "closed", observable);
        assert!(said["doubt"].as_str().unwrap().contains("closed sides bound the displacements"), "{said}");
    }
}

/// Doubts are reported in every output that contains the number.
#[test]
fn doubts_are_reported_with_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let free = scene(folder, "free.toml", FREE);
    let sets = [
        "--set",
        "run.time=40.0",
        "--set",
        "run.thermo_every=1",
        "--set",
        "output.structure=[\"msd\"]",
        "--set",
        "output.structure_share=1000.0",
    ];
    let words = "msd: no diffusion constant: motion is not diffusive yet";
    let said = |arguments: &[&str]| {
        let output = stripmine(folder, arguments);
        assert!(output.status.success(), "{output:?}");
        [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap())
    };
    let [closing, _] = said(&[&["run", free.as_str(), "--out", "one"], &sets[..]].concat());
    assert!(closing.contains(words), "{closing}");
    for arguments in
        [&["average", "one"][..], &["average", "one", "--csv"], &["average", "one", "--structure", "msd"]]
    {
        let [out, doubt] = said(arguments);
        assert!(doubt.contains(words) && !out.contains("diffusion constant"), "{arguments:?}: {out} {doubt}");
    }
    let [csv, doubt] = said(&["average", "one", "--structure", "msd", "--csv"]);
    assert!(csv.starts_with("lag (time),") && doubt.contains(words), "{csv} {doubt}");
    let [json, _] = said(&["average", "one", "--json"]);
    assert!(json.contains("motion is not diffusive yet"), "{json}");
    said(&["plot", "one", "--out", "plots"]);
    let drawn = fs::read_dir(folder.join("plots")).unwrap().map(|it| fs::read(it.unwrap().path()).unwrap());
    let drawn = drawn.map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(drawn.collect::<String>().contains("motion is not diffusive yet"));
    let [closing, _] = said(&[&["run", free.as_str(), "--seeds", "2", "--out", "two"], &sets[..]].concat());
    assert!(closing.contains("msd: in 2 of 2 runs: no diffusion constant"), "{closing}");
    let seeds = fs::read_to_string(folder.join("two/seeds.json")).unwrap();
    assert!(seeds.contains("in 2 of 2 runs: no diffusion constant"), "{seeds}");
}
