//! Event-driven hard discs as a user sees them: physics compared with published values, resumption, and refusals.

#[path = "hard_disks/sums.rs"]
mod sums;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn stripmine(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn run(scene: &str, out: &Path, more: &[&str]) -> Value {
    let begin = ["run", scene, "--json", "--quiet", "--out", out.to_str().unwrap()];
    let output = stripmine(&[&begin[..], more].concat());
    assert!(output.status.success(), "{}", said(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Column of thermo.csv by name.
fn column(folder: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(folder.join("thermo.csv")).unwrap();
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(',').position(|column| column == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

/// Z and the collision rate of a fluid at ν = 0.50 and 0.30 agree to 2 % with two independent codes (values of the specification
/// of ISO99: Z = 4.1094 and 2.0632, ω = 7.017 and 2.3995), from the second half of a run of 2·10⁵ collisions.
#[test]
fn fluid_pressure_agrees_with_other_programs() {
    let folder = tempfile::tempdir().unwrap();
    for (packing, pressure, rate) in [("0.50", 4.1094, 7.017), ("0.30", 2.0632, 2.3995)] {
        let out = folder.path().join(packing);
        let set = [format!("particles.packing_fraction={packing}"), "run.events=200000".to_owned()];
        let summary =
            run("hard-disks", &out, &["--set", &set[0], "--set", &set[1], "--set", "run.thermo_every=2"]);
        let [time, virial, collisions, temperature, energy] =
            ["time", "virial", "collisions", "temperature", "energy_error"].map(|name| column(&out, name));
        let count = summary["discs"].as_f64().unwrap();
        let (first, last) = (time.len() / 2, time.len() - 1);
        let [flown, virial, collisions] = [&time, &virial, &collisions].map(|it| it[last] - it[first]);
        let z = 1.0 + virial / (2.0 * count * temperature[last] * flown);
        let thermal = temperature[last].sqrt();
        let omega = 2.0 * collisions / (count * flown) / thermal;
        assert!((z / pressure - 1.0).abs() < 0.02, "Z = {z}");
        assert!((omega / rate - 1.0).abs() < 0.02, "ω = {omega}");
        assert!(energy.iter().all(|error| error.abs() < 1e-12), "{energy:?}");
        assert_eq!(summary["checks"], serde_json::json!([]));
    }
}

/// A mixture of two kinds is compressed to a packing fraction that random placement cannot reach, and ISO99's engine gives the same run.
#[test]
fn mixtures_are_compressed() {
    let folder = tempfile::tempdir().unwrap();
    let set = [
        "domain.sides=[24.0, 24.0]",
        "particles.generate=compressed",
        "particles.count=386",
        "particles.second_radius=0.7",
        "particles.second_share=0.5",
        "run.time=2",
    ];
    let more: Vec<&str> = set.into_iter().flat_map(|text| ["--set", text]).collect();
    let ended = |engine: &str| {
        let engine = format!("machine.engine={engine}");
        let out = folder.path().join(&engine);
        run("hot-floor", &out, &[&more[..], &["--set", &engine]].concat());
        (column(&out, "kinetic"), column(&out, "events"))
    };
    let [source, fast] = ["reference", "fast"].map(ended);
    assert_eq!(source, fast);
    assert!(fast.1[fast.1.len() - 1] > 3000.0, "{:?}", fast.1);
    // 386 discs, half of them of each kind.
    let area = 193.0 * std::f64::consts::PI * (0.25 + 0.49);
    assert!((area / (24.0 * 24.0) - 0.78).abs() < 0.002);
}

/// Haff's law, T = T₀ exp(−(1 − e²) collisions/N), holds to 3 % over four collisions a disc, while the gas is homogeneous.
#[test]
fn a_cooling_gas_follows_haffs_law() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let summary = run("cooling-gas", &out, &["--set", "run.events=5000", "--set", "run.thermo_every=0.05"]);
    let count = summary["discs"].as_f64().unwrap();
    let (collisions, temperature) = (column(&out, "collisions"), column(&out, "temperature"));
    // The lattice of the start is not yet a gas: from one collision a disc on.
    let begun = collisions.iter().position(|collisions| *collisions > count).unwrap();
    assert!(temperature.len() > begun + 5);
    for (now, found) in collisions.iter().zip(&temperature).skip(begun) {
        let law = temperature[begun] * (-(1.0 - 0.81) * (now - collisions[begun]) / count).exp();
        assert!((found / law - 1.0).abs() < 0.03, "{now}: {found}, {law}");
    }
}

/// Engine, mask and instruction set do not change a bit, up to the end of the run.
#[test]
fn engines_and_masks_do_not_change_bits() {
    let folder = tempfile::tempdir().unwrap();
    let frames = |setting: &str| {
        let out = folder.path().join(setting);
        let more = ["--set", "run.time=10", "--set", setting, "--set", "particles.count=200"];
        run("hard-disks", &out, &[&more[..], &["--set", "run.snapshot_every=4"]].concat());
        fs::read_to_string(out.join("trajectory.xyz")).unwrap()
    };
    let source = frames("machine.engine=reference");
    let times: Vec<&str> =
        source.lines().filter_map(|line| line.split("Time=").nth(1)?.split(' ').next()).collect();
    assert_eq!(times, ["0.0", "4.0", "8.0", "10.0"]);
    for setting in
        ["search.mask=min", "search.mask=r4", "machine.engine=fast", "machine.instruction_set=scalar"]
    {
        assert!(frames(setting) == source, "{setting}");
    }
}

/// A scene of listed discs of radius 1/2.
fn listed(folder: &Path, domain: &str, positions: &str, velocities: &str, more: &str) -> String {
    let scene = folder.join("list.toml");
    let text = format!(
        "format = 2\nunits = \"reduced\"\n[method]\nkind = \"hard-disks\"\n[domain]\n{domain}\n[particles]\n\
         generate = \"list\"\npositions = {positions}\nvelocities = {velocities}\nradius = 0.5\nmass = 1.0\n{more}\n"
    );
    fs::write(&scene, text).unwrap();
    scene.to_str().unwrap().to_owned()
}

/// Events that happen very late are found by both engines, however many rows are written before them.
#[test]
fn late_events_are_found() {
    let folder = tempfile::tempdir().unwrap();
    // A disc winds round the box and approaches the other by a small amount each time.
    for (engine, rise) in [("fast", 2e-6), ("reference", 1e-4)] {
        let (when, lateral) = (9.0 / rise, format!("[[0.0, 0.0], [1.0, {rise:?}]]"));
        let set = |every: f64| {
            format!("[machine]\nengine = \"{engine}\"\n[run]\nevents = 1\nthermo_every = {every:?}")
        };
        for every in [0.0, when / 50.0] {
            let scene = listed(
                folder.path(),
                "sides = [40.0, 40.0]",
                "[[5.0, 15.0], [5.0, 5.0]]",
                &lateral,
                &set(every),
            );
            let out = folder.path().join(format!("{engine}{every}"));
            let summary = run(&scene, &out, &[]);
            let time = summary["time"].as_f64().unwrap();
            assert!(summary["events"] == 1 && (time / when - 1.0).abs() < 0.01, "{engine}: {time}, {when}");
        }
    }
}

/// Time passes with both engines if no event can happen; a number of events is refused when the scene is checked, or when
/// no further event can happen.
#[test]
fn time_passes_without_events() {
    let folder = tempfile::tempdir().unwrap();
    for (name, positions, velocities) in [
        ("rest", "[[5.0, 5.0], [8.0, 5.0]]", "[[0.0, 0.0], [0.0, 0.0]]"),
        ("alone", "[[5.0, 5.0]]", "[[1.0, 0.5]]"),
        ("beside", "[[5.0, 5.0], [8.0, 5.0]]", "[[0.0, 1.0], [0.0, 1.0]]"),
        ("past", "[[5.0, 5.0], [5.0, 8.0]]", "[[1.0, 0.0], [0.0, 0.0]]"),
        ("slanted", "[[5.0, 5.0], [15.0, 5.0]]", "[[1.0, 1.0], [0.0, 0.0]]"),
    ] {
        for engine in ["fast", "reference"] {
            let more =
                format!("[machine]\nengine = \"{engine}\"\n[run]\ntime = 5000.0\nthermo_every = 500.0");
            let scene = listed(folder.path(), "sides = [20.0, 20.0]", positions, velocities, &more);
            let out = folder.path().join(format!("{name}{engine}"));
            let summary = run(&scene, &out, &[]);
            assert_eq!((&summary["events"], &summary["time"]), (&Value::from(0), &Value::from(5000.0)));
            assert_eq!(column(&out, "time").len(), 11, "{name}");
            let refused = stripmine(&["scene", "check", &scene, "--set", "run.events=3"]);
            assert!(
                refused.status.code() == Some(3) && said(&refused).contains("nothing will ever happen"),
                "{name}"
            );
        }
    }
    // Discs at rest above a floor fall.
    let domain = "sides = [20.0, 20.0]\nperiodic = [true, false]\ngravity = [0.0, -1.0]";
    let scene = listed(folder.path(), domain, "[[5.0, 5.0]]", "[[0.0, 0.0]]", "[run]\nevents = 3");
    run(&scene, &folder.path().join("fall"), &[]);
}

/// A disc that slides on a floor bounces for ever once its bounces are elastic. If the contact duration makes them elastic so late that
/// the run cannot end, both engines report the same event; with a longer duration the run continues.
#[test]
fn discs_at_rest_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let said = ["fast", "reference"].map(|engine| {
        let more = format!(
            "[law]\nwall_restitution = 0.5\ncontact_duration = 1e-9\n[machine]\nengine = \"{engine}\"\n[run]\ntime = 66.0"
        );
        let domain = "sides = [20.0, 20.0]\nperiodic = [true, false]\ngravity = [0.0, -1.0]";
        let scene = listed(folder.path(), domain, "[[5.0, 3.0], [12.0, 9.0]]", "[[1.0, 0.0], [1.0, 0.0]]", &more);
        let out = folder.path().join(engine);
        let arguments = ["run", &scene, "--quiet", "--out", out.to_str().unwrap()];
        let failed = stripmine(&arguments);
        assert_eq!(failed.status.code(), Some(4), "{}", said(&failed));
        let summary: Value = serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
        assert_eq!(summary["failure"]["kind"], "resting");
        // The frame that the message refers to exists.
        let frames = fs::read_to_string(out.join("trajectory.xyz")).unwrap();
        let last = frames.lines().rfind(|line| line.starts_with("Lattice")).unwrap();
        let time = summary["failure"]["when"]["time"].as_f64().unwrap();
        assert!(time > 1.0 && last.contains(&format!("Time={time:?} ")), "{last}, {time}");
        let words = said(&failed);
        let named = ["event ", "disc 1 at (", "has come to rest", "law.contact_duration", "last frame"];
        assert!(named.iter().all(|word| words.contains(word)), "{words}");
        run(&scene, &folder.path().join(format!("{engine}-longer")), &["--set", "law.contact_duration=1e-3"]);
        words.replace(engine, "")
    });
    assert_eq!(said[0], said[1]);
}

/// The log has a row for each event, with the exchanged momentum; it is cut and continued on resumption.
#[test]
fn every_collision_is_logged() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |name: &str, parts: &[&str]| {
        let out = folder.path().join(name);
        for (number, events) in parts.iter().enumerate() {
            let set = format!("run.events={events}");
            let mut more = vec![
                "--set",
                &set,
                "--set",
                "output.collisions=true",
                "--set",
                "domain.periodic=[true, false]",
            ];
            more.extend(["--set", "particles.count=100", "--set", "particles.generate=random"]);
            more.extend(["--set", "domain.sides=[16.0, 16.0]"]);
            if number > 0 {
                more.push("--resume");
            }
            run("hard-disks", &out, &more);
        }
        fs::read_to_string(out.join("events.csv")).unwrap()
    };
    let whole = rows("whole", &["3000"]);
    assert_eq!(rows("parts", &["1000", "3000"]), whole);
    assert_eq!(whole.lines().count(), 3001);
    let places: Vec<&str> = whole.lines().next().unwrap().split(',').collect();
    let of = |row: &str, name: &str| {
        row.split(',').nth(places.iter().position(|place| *place == name).unwrap()).unwrap().to_owned()
    };
    let mut last = std::collections::HashMap::new();
    let (mut seen, mut sides) = (0, 0);
    for row in whole.lines().skip(1) {
        let number = |name: &str| of(row, name).parse::<f64>().unwrap();
        let (time, disc, partner) = (number("time"), of(row, "disc"), of(row, "partner"));
        // Unit masses and diameters: a disc of speed below 6 transfers at most twice its momentum.
        assert!(number("impulse_x").hypot(number("impulse_y")) < 12.0);
        let before = last.insert(disc, time).unwrap_or(0.0);
        assert!((number("free_time") - (time - before)).abs() < 1e-9);
        match partner.as_str() {
            "bottom" => assert!(number("impulse_y") > 0.0 && number("y").abs() < 1e-9),
            "top" => assert!(number("impulse_y") < 0.0),
            _ => {
                let before = last.insert(partner.clone(), time).unwrap_or(0.0);
                assert!((number("partner_free_time") - (time - before)).abs() < 1e-9);
                seen += 1;
            }
        }
        sides += usize::from(partner == "top" || partner == "bottom");
    }
    assert!(seen > 1000 && sides > 50, "{seen} {sides}");
}

/// Discs are compressed to a packing fraction of 0.85, isotropically; jamming is reported.
#[test]
fn dense_starts_are_compressed() {
    let folder = tempfile::tempdir().unwrap();
    let grown = ["--set", "particles.generate=compressed", "--set", "domain.sides=[20.0, 20.0]"];
    let with = |out: &str, more: &[&'static str]| {
        let out = folder.path().join(out).display().to_string();
        let mut arguments = vec!["run".to_owned(), "hard-disks".to_owned(), "--out".to_owned(), out];
        arguments.extend(grown.iter().chain(more).map(|&text| text.to_owned()));
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        stripmine(&arguments)
    };
    let dense = with(
        "dense",
        &["--set", "particles.packing_fraction=0.85", "--set", "run.events=20000", "--json", "--quiet"],
    );
    assert!(dense.status.success(), "{}", said(&dense));
    let summary: Value = serde_json::from_slice(&dense.stdout).unwrap();
    assert!(summary["discs"].as_f64().unwrap() > 430.0, "{summary}");
    let jammed =
        with("jammed", &["--set", "particles.packing_fraction=0.88", "--set", "particles.radius_spread=0.1"]);
    assert_eq!(jammed.status.code(), Some(3));
    assert!(said(&jammed).contains("jam at a packing fraction"), "{}", said(&jammed));
}

/// Three very dissipative discs in a line collide without end; this is reported with the pair.
#[test]
fn inelastic_collapse_is_detected_and_avoided() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("collapse.toml");
    // One dimension, three particles: collapse for e < 7 − 4 √3 = 0.0718 (McNamara and Young).
    let text = "format = 2\nunits = \"reduced\"\n[method]\nkind = \"hard-disks\"\n[domain]\nsides = [40.0, 10.0]\n[particles]\n\
                generate = \"list\"\npositions = [[10.0, 5.0], [13.5, 5.0], [18.0, 5.0]]\nvelocities = [[1.0, 0.0], [0.0, 0.0], \
                [-1.0, 0.0]]\nradius = 0.5\nmass = 1.0\n[law]\nrestitution = 0.01\n[run]\nevents = 100000\nthermo_every = 0\nsnapshot_every = 0\ncheckpoint_every = 0\n";
    fs::write(&scene, text).unwrap();
    let path = scene.to_str().unwrap();
    let out = folder.path().join("run");
    let refused = stripmine(&["run", path, "--out", out.to_str().unwrap()]);
    let message = said(&refused);
    assert_eq!(refused.status.code(), Some(4), "{message}");
    assert!(message.contains("inelastic collapse") && message.contains("contact_duration"), "{message}");
    let cured = ["--set", "law.contact_duration=1e-3", "--set", "run.events=20"];
    let summary = run(path, &folder.path().join("cured"), &cured);
    assert_eq!(summary["checks"][0]["check"], "made-elastic");
}

#[test]
fn impossible_hard_disc_scenes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let refused = |scene: &str, set: &[&str], code: i32, words: &[&str]| {
        let mut arguments = vec!["run", scene, "--out", out.to_str().unwrap()];
        set.iter().for_each(|text| arguments.extend(["--set", text]));
        let output = stripmine(&arguments);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{set:?}: {said}");
        assert!(words.iter().all(|word| said.contains(word)), "{set:?}: {said}");
    };
    refused("hard-disks", &["law.restitution=1.5"], 3, &["law.restitution", "1"]);
    refused("hard-disks", &["law.restitution=0"], 3, &["above 0 and at most 1"]);
    refused(
        "hard-disks",
        &["domain.gravity=[0.0, -1.0]"],
        3,
        &["nothing stops the fall", "periodic = [true, false]"],
    );
    refused("hard-disks", &["domain.open_top=true"], 3, &["needs a floor"]);
    refused("hard-disks", &["law.thermal_side=top"], 3, &["that side is periodic"]);
    refused("hard-disks", &["law.wall_temperature=2"], 3, &["law.wall_temperature"]);
    refused("hot-floor", &["law.floor_amplitude=0.1"], 3, &["thermal", "floor_amplitude"]);
    refused("hard-disks", &["law.floor_amplitude=0.1"], 3, &["needs a floor", "periodic"]);
    refused(
        "hard-disks",
        &["particles.count=4", "particles.packing_fraction=0.7", "machine.engine=fast"],
        3,
        &["too small for lists"],
    );
    refused("hard-disks", &["particles.count=20", "search.mask=r10"], 3, &["r10 does not serve", "one of"]);
    // Cells of 40/57: R = 5 covers radii up to 1 : 2.98, R = 6 up to 1 : 3.78, R = 10 up to 1 : 6.47.
    let unequal = |radius: &str, mask: &str, words: &[&str]| {
        let [radius, mask] = [("particles.second_radius", radius), ("search.mask", mask)]
            .map(|(key, value)| format!("{key}={value}"));
        let mixture = ["domain.sides=[40.0, 40.0]", "particles.generate=random", "particles.count=20"];
        let set = [&mixture[..], &["particles.second_share=0.5", &radius, &mask, "machine.engine=reference"]];
        refused("hard-disks", &set.concat(), 3, words);
    };
    unequal("1.75", "min", &["mask min does not serve", "one of r6, r7, r8, r9, r10"]);
    unequal("3.5", "auto", &["no mask serves", "radii that differ less"]);
    refused(
        "hot-floor",
        &["machine.engine=cell-crossing"],
        3,
        &["cells for the whole box", "open_top", "or \"auto\""],
    );
    refused(
        "hard-disks",
        &["particles.count=4", "particles.packing_fraction=0.7", "machine.engine=cell-crossing"],
        3,
        &["too small for linked cells", "a larger box"],
    );
    refused("hard-disks", &["search.discs_in_cell=2"], 3, &["search.discs_in_cell", "machine.engine"]);
    refused("hard-disks", &["particles.temperature=0"], 3, &["nothing will ever happen"]);
    let list = |positions: &str| {
        let scene = folder.path().join("list.toml");
        let text = format!(
            "format = 2\nunits = \"reduced\"\n[method]\nkind = \"hard-disks\"\n[domain]\nsides = [20.0, 20.0]\nperiodic = [false, true]\n\
             [particles]\ngenerate = \"list\"\npositions = {positions}\nvelocities = [[0.0, 1.0], [0.0, 1.0]]\nradius = 0.5\nmass = 1.0\n\
             [run]\nevents = 10\nthermo_every = 0\nsnapshot_every = 0\ncheckpoint_every = 0\n"
        );
        fs::write(&scene, text).unwrap();
        scene.to_str().unwrap().to_owned()
    };
    refused(
        &list("[[5.0, 5.0], [5.9, 5.0]]"),
        &[],
        3,
        &["overlap at the start", "hard discs do not overlap"],
    );
    refused(&list("[[0.3, 5.0], [5.9, 5.0]]"), &[], 3, &["reaches beyond a side"]);
}

/// A thermal wall has its own seed if the start has none: runs with different seeds differ, the same seed gives the same run, and a run
/// that starts from a state draws other numbers than the run before.
#[test]
fn thermal_walls_have_a_seed() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let text = "format = 2\nunits = \"reduced\"\n[method]\nkind = \"hard-disks\"\n[domain]\nsides = [10.0, 10.0]\nperiodic = [true, false]\n\
                [particles]\ngenerate = \"list\"\nradius = 0.5\nmass = 1.0\npositions = [[2.0, 2.0], [5.0, 5.0]]\n\
                velocities = [[1.0, 0.3], [0.0, -0.4]]\n[law]\nthermal_side = \"bottom\"\nwall_temperature = 2.0\n\
                [run]\ntime = 100.0\nthermo_every = 1.0\nsnapshot_every = 100.0\n";
    fs::write(&scene, text).unwrap();
    let scene = scene.to_str().unwrap();
    let out = folder.path().join("seeds");
    let output = stripmine(&["run", scene, "--seeds", "3", "--quiet", "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", said(&output));
    let rows = |folder: &Path| fs::read_to_string(folder.join("thermo.csv")).unwrap();
    let seeds: Vec<String> = (1..=3).map(|seed| rows(&out.join(format!("seed-{seed}")))).collect();
    assert!(seeds[0] != seeds[1] && seeds[1] != seeds[2] && seeds[0] != seeds[2]);
    let one = |name: &str, sets: &[&str]| {
        let out = folder.path().join(name);
        run(scene, &out, sets);
        rows(&out)
    };
    assert_eq!(one("default", &[]), seeds[0]);
    // Joins identify runs by this seed.
    assert!(
        fs::read_to_string(folder.path().join("default/scene.toml")).unwrap().contains("\nnoise_seed = 1\n")
    );
    assert_eq!(one("two", &["--set", "law.noise_seed=2"]), seeds[1]);
    // The written scene contains the seed, and gives the same run.
    let written = out.join("seed-3").join("scene.toml");
    let again = folder.path().join("again");
    run(written.to_str().unwrap(), &again, &[]);
    assert_eq!(rows(&again), seeds[2]);
    // Another state draws other numbers: the first kinetic energies after the wall differ.
    let moved = one("moved", &["--set", "particles.velocities=[[1.0, 0.3], [0.0, -0.40000001]]"]);
    assert!(moved != seeds[0]);
    let kinetic = |text: &str| -> Vec<f64> {
        let place = text.lines().next().unwrap().split(',').position(|name| name == "kinetic").unwrap();
        text.lines().skip(1).map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
    };
    let near = kinetic(&moved)
        .into_iter()
        .zip(kinetic(&seeds[0]))
        .filter(|(a, b)| (a / b - 1.0).abs() < 1e-6)
        .count();
    assert!(near < 60, "{near} of 101 rows are those of before");
    // A generated start passes its own seed to the wall, unless the scene sets another.
    let error = stripmine(&[
        "run",
        scene,
        "--set",
        "law.thermal_side=none",
        "--set",
        "law.noise_seed=1",
        "--out",
        "no",
    ]);
    assert!(said(&error).contains("law.noise_seed"), "{}", said(&error));
}
