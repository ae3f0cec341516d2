//! Sums over events: temperature, compressibility and energy compared with independently computed values.

use super::{column, listed, run, said, stripmine};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn average<'s>(summary: &'s Value, name: &str) -> &'s Value {
    let all = summary["averages"]["quantities"].as_array().unwrap();
    all.iter().find(|it| it["quantity"] == name).unwrap()
}

/// Closing words of a run.
fn words(scene: &str, out: &Path, more: &[&str]) -> String {
    let output = stripmine(&[&["run", scene, "--quiet", "--out", out.to_str().unwrap()], more].concat());
    assert!(output.status.success(), "{}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Z of a gas that cools to about a half within a row, compared with sums over rows eighty times as close, whose temperature is the mean of
/// both ends; between the times 1 and 5 it is 1.77 (theory: 1 + (1 + e)/2 (Z of elastic discs − 1) = 1.75).
#[test]
fn cooling_gas_rows_average_over_their_interval() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |every: &str| {
        let out = folder.path().join(every);
        let every = format!("run.thermo_every={every}");
        let summary = run("cooling-gas", &out, &["--set", "run.time=8", "--set", &every]);
        let names = ["time", "virial", "collisions", "temperature", "compressibility", "collision_rate"];
        (summary["discs"].as_f64().unwrap(), names.map(|name| column(&out, name)))
    };
    let (count, [time, virial, collisions, temperature, ..]) = rows("0.05");
    let integral = |from: usize, to: usize| -> f64 {
        (from..to).map(|at| 0.5 * (temperature[at] + temperature[at + 1]) * (time[at + 1] - time[at])).sum()
    };
    let of = |from: usize, to: usize| {
        let rate = 2.0 * (collisions[to] - collisions[from]) / (count * (time[to] - time[from]));
        [1.0 + (virial[to] - virial[from]) / (2.0 * count * integral(from, to)), rate]
    };
    let (_, [_, _, _, of_moment, z, rate]) = rows("4");
    assert_eq!((z.len(), z[0], rate[0]), (3, 1.0, 0.0));
    assert!(of_moment[1] < 0.6, "{of_moment:?}");
    for (row, from, to) in [(1, 0, 80), (2, 80, 160)] {
        let [expected, expected_rate] = of(from, to);
        assert!((z[row] - expected).abs() < 2e-3, "{} and {expected}", z[row]);
        assert!((rate[row] / expected_rate - 1.0).abs() < 1e-12, "{} and {expected_rate}", rate[row]);
    }
    let [early, _] = of(20, 100);
    assert!((early - 1.77).abs() < 0.05, "{early}");
    // The closing words cover the whole run.
    let said = words("cooling-gas", &folder.path().join("words"), &["--set", "run.time=8"]);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let z = said.split("since the start: compressibility ").nth(1).unwrap().split(',').next().unwrap();
    assert!((z.parse::<f64>().unwrap() - of(0, 160)[0]).abs() < 2e-3, "{said}");
}

/// Between walls no component of the momentum is conserved: the kinetic energy is N kT. Expected values are sums by hand over the velocities.
#[test]
fn between_walls_all_degrees_of_freedom_count() {
    let folder = tempfile::tempdir().unwrap();
    let (positions, velocities) = (
        "[[2.0, 2.0], [7.0, 3.0], [3.0, 7.5], [7.5, 7.0]]",
        "[[1.0, 0.3], [-0.7, 0.9], [0.2, -1.3], [-0.4, 0.6]]",
    );
    // Σ v² along x 1.69, along y 2.95; momentum 0.1 and 0.5.
    let [x, y] = [1.0 + 0.49 + 0.04 + 0.16, 0.09 + 0.81 + 1.69 + 0.36];
    for (periodic, expected) in [
        ("[false, false]", (x + y) / 8.0),
        ("[true, false]", (x - 0.01 / 4.0 + y) / 7.0),
        ("[true, true]", (x - 0.01 / 4.0 + y - 0.25 / 4.0) / 6.0),
    ] {
        let domain = format!("sides = [10.0, 10.0]\nperiodic = {periodic}");
        let scene = listed(folder.path(), &domain, positions, velocities, "[run]\ntime = 50.0");
        let out = folder.path().join(periodic);
        run(&scene, &out, &[]);
        let temperature = column(&out, "temperature");
        assert!(
            temperature.iter().all(|found| (found / expected - 1.0).abs() < 1e-12),
            "{temperature:?}, {expected}"
        );
        let ([virial, z], last) =
            (["virial", "compressibility"].map(|name| column(&out, name)), temperature.len() - 1);
        for row in 1..=last {
            let by_hand = 1.0 + (virial[row] - virial[row - 1]) / (2.0 * 4.0 * expected);
            assert!((z[row] - by_hand).abs() < 1e-9, "{} and {by_hand}", z[row]);
        }
    }
}

/// One disc over a wall of kT = 2 has that temperature along both axes, to four standard errors. In a periodic box it has none.
#[test]
fn single_disc_over_a_thermal_wall_has_temperature() {
    let folder = tempfile::tempdir().unwrap();
    let scene = listed(
        folder.path(),
        "sides = [10.0, 10.0]\nperiodic = [true, false]",
        "[[2.0, 2.0]]",
        "[[1.0, 0.3]]",
        "[law]\nthermal_side = \"bottom\"\nwall_temperature = 2.0\n[run]\ntime = 20000.0\nthermo_every = 10.0",
    );
    let summary = run(&scene, &folder.path().join("hot"), &[]);
    let found = average(&summary, "temperature");
    let [mean, bar] = ["mean", "bar"].map(|name| found[name].as_f64().unwrap_or(f64::NAN));
    assert!((mean - 2.0).abs() < 2.0 * bar && bar < 0.4, "{found}");
    // By hand at the start: (1 + 0.09)/2, although the box is periodic along x.
    assert_eq!(column(&folder.path().join("hot"), "temperature")[0], 0.545);
    assert!(column(&folder.path().join("hot"), "compressibility").iter().all(|&z| z == 1.0));
    let scene =
        listed(folder.path(), "sides = [10.0, 10.0]", "[[2.0, 2.0]]", "[[1.0, 0.3]]", "[run]\ntime = 20.0");
    let out = folder.path().join("alone");
    let words = words(&scene, &out, &[]);
    assert!(words.contains("temperature none (no degree of freedom)"), "{words}");
    assert!(column(&out, "temperature").iter().all(|found| found.is_nan()));
    assert!(column(&out, "compressibility").iter().all(|&z| z == 1.0));
}

/// Error of the energy is rounding if energy is conserved, lost in collisions, supplied by a hot or a moving floor, and under gravity.
#[test]
fn energy_error_is_rounding_in_every_scene() {
    let folder = tempfile::tempdir().unwrap();
    let falling = "sides = [10.0, 10.0]\nperiodic = [true, false]\ngravity = [0.0, -1.0]";
    let slanted =
        "sides = [10.0, 10.0]\nperiodic = [false, false]\ngravity = [0.3, -1.0]\norigin = [-3.0, 40.0]";
    let two = ("[[2.0, 3.5], [7.0, 6.3]]", "[[0.3, 0.0], [-0.2, 0.5]]");
    let lossy = "[law]\nrestitution = 0.9\nwall_restitution = 0.99\ncontact_duration = 1e-4\n";
    for (name, domain, (positions, velocities), law) in [
        ("elastic", falling, two, ""),
        ("at-rest", falling, (two.0, "[[0.0, 0.0], [0.0, 0.0]]"), ""),
        ("slanted", slanted, ("[[-1.0, 43.5], [4.0, 46.3]]", two.1), ""),
        ("lossy", falling, two, lossy),
        ("shaken", falling, two, "[law]\nrestitution = 0.9\nfloor_amplitude = 0.3\nfloor_frequency = 0.8\n"),
        (
            "hot",
            falling,
            two,
            "[law]\nrestitution = 0.9\nthermal_side = \"bottom\"\nwall_temperature = 2.0\n",
        ),
    ] {
        let scene =
            listed(folder.path(), domain, positions, velocities, &format!("{law}[run]\nevents = 2000"));
        let out = folder.path().join(name);
        let summary = run(&scene, &out, &[]);
        let error = column(&out, "energy_error");
        // Rounding of 2000 events; a hot floor gives energies tens of times those at the start.
        assert!(error.iter().all(|error| error.abs() < 1e-10), "{name}: {error:?}");
        let kept = average(&summary, "energy_error");
        assert!(kept["farthest"].as_f64().unwrap() < 1e-10, "{name}: {kept}");
        if name == "elastic" {
            // By hand: m g y of both discs, and half of v².
            assert!((column(&out, "gravitational")[0] - 9.8).abs() < 1e-14);
            assert!((column(&out, "kinetic")[0] - 0.19).abs() < 1e-14);
            assert!(column(&out, "work").iter().all(|&work| work == 0.0));
        }
    }
    for preset in ["hot-floor", "vibrating-floor", "cooling-gas"] {
        let out = folder.path().join(preset);
        run(preset, &out, &["--set", "run.events=20000", "--set", "run.thermo_every=1"]);
        let error = column(&out, "energy_error");
        assert!(error.iter().all(|error| error.abs() < 1e-10), "{preset}: {error:?}");
    }
}

/// Two discs of mass 1 collide head on at speed 1 with e = 1/2 and lose 1 − e² of the energy of 1.
#[test]
fn work_is_the_energy_lost_in_collisions() {
    let folder = tempfile::tempdir().unwrap();
    let scene = listed(
        folder.path(),
        "sides = [20.0, 20.0]",
        "[[5.0, 5.0], [9.0, 5.0]]",
        "[[1.0, 0.0], [-1.0, 0.0]]",
        "[law]\nrestitution = 0.5\n[run]\ntime = 3.0",
    );
    let out = folder.path().join("run");
    run(&scene, &out, &[]);
    assert_eq!(column(&out, "work"), [0.0, 0.0, -0.75, -0.75]);
    assert_eq!(column(&out, "kinetic"), [1.0, 1.0, 0.25, 0.25]);
    assert_eq!(column(&out, "energy_error"), [0.0; 4]);
    // kT is 1 up to the collision at 1.5 (one of two discs moves along x about the centre), then 1/4; the virial is 1.5 μ v d = 1.5.
    let z = column(&out, "compressibility");
    assert!((z[2] - (1.0 + 1.5 / (2.0 * 2.0 * (0.5 * 1.0 + 0.5 * 0.25)))).abs() < 1e-14, "{z:?}");
}

/// Discs of a crystal that overlap by the precision of their positions are shrunk by as much, with a note; deeper overlaps are refused with
/// their size.
#[test]
fn overlaps_of_rounding_size_are_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let begin_at = |by: f64, beyond: f64| {
        let positions = format!("[[2.0, 2.0], [{:?}, 2.0], [9.5, {:?}]]", 3.0 - by, 9.5 + beyond);
        let domain = "sides = [10.0, 10.0]\nperiodic = [true, false]";
        listed(
            folder.path(),
            domain,
            &positions,
            "[[1.0, 0.0], [0.0, 0.0], [0.0, 0.1]]",
            "[run]\nevents = 50",
        )
    };
    let begin = |by: f64| begin_at(by, 0.0);
    let check = |scene: &str| stripmine(&["scene", "check", scene]);
    // Beyond a closed side by 4e-9, for a radius of 1/2.
    let checked = check(&begin_at(0.0, 4e-9));
    let text = said(&checked) + &String::from_utf8_lossy(&checked.stdout);
    assert!(checked.status.success() && text.contains("in 1 places, by up to 8e-9 of their radii"), "{text}");
    let scene = begin(8e-9);
    let checked = check(&scene);
    let text = said(&checked) + &String::from_utf8_lossy(&checked.stdout);
    assert!(
        checked.status.success() && text.contains("8e-9") && text.contains("radii are made smaller"),
        "{text}"
    );
    let out = folder.path().join("run");
    run(&scene, &out, &[]);
    let frame = fs::read_to_string(out.join("trajectory.xyz")).unwrap();
    let first = frame.lines().nth(2).unwrap();
    assert!(first.contains(" 0.4999999959"), "{first}");
    for (by, number) in [(2e-5, "2e-5"), (0.1, "0.1")] {
        let refused = check(&begin(by));
        let text = said(&refused);
        assert!(
            !refused.status.success()
                && text.contains(&format!("by {number} of the sum of their radii, {number};")),
            "{text}"
        );
        assert!(text.contains("centres at least 1 apart"), "{text}");
    }
}

/// Over a hot wall the temperature fluctuates. Mean compressibilities over rows of 1/2, 5 or 30 equal all impulses over the integral of the
/// temperature, here from rows a tenth apart. The mean of 3000 independent times is known to 0.3 %; the four agree far better.
#[test]
fn mean_compressibility_does_not_depend_on_rows() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("hot.toml");
    fs::write(
        &scene,
        "format = 2\nunits = \"reduced\"\n[method]\nkind = \"hard-disks\"\n[domain]\nsides = [10.0, 10.0]\nperiodic = [true, false]\n\
         [particles]\ngenerate = \"random\"\ncount = 24\nradius = 0.5\nmass = 1.0\ntemperature = 1.0\nseed = 1\n[law]\n\
         thermal_side = \"bottom\"\nwall_temperature = 1.0\n[run]\ntime = 3000.0\nsnapshot_every = 0\n",
    )
    .unwrap();
    let rows = |every: &str| {
        let out = folder.path().join(every);
        run(scene.to_str().unwrap(), &out, &["--set", &format!("run.thermo_every={every}")]);
        ["virial", "temperature", "compressibility"].map(|name| column(&out, name))
    };
    let [virial, temperature, _] = rows("0.1");
    let integral: f64 = temperature.windows(2).map(|pair| 0.05 * (pair[0] + pair[1])).sum();
    let expected = 1.0 + virial[virial.len() - 1] / (2.0 * 24.0 * integral);
    let varies =
        temperature.iter().map(|kt| (kt / (integral / 3000.0) - 1.0).powi(2)).sum::<f64>() / 30_001.0;
    // kT of 48 degrees of freedom of a gas at one temperature has a variance of 2/48.
    assert!((0.03..0.06).contains(&varies), "{varies}");
    for every in ["0.5", "5", "30"] {
        let z = &rows(every)[2][1..];
        let mean = z.iter().sum::<f64>() / z.len() as f64;
        assert!((mean / expected - 1.0).abs() < 1.5e-3, "{every}: {mean} and {expected}");
    }
}
