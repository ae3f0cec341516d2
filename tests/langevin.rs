//! Particles in a bath as a user sees them: exact results of diffusion, equal searches, losses, resumption, refusals.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use stripmine_physics::io::{extxyz, gsd};

fn stripmine(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn begin(scene: &str, out: &Path, sets: &[&str], more: &[&str]) -> Output {
    let mut arguments = vec!["run", scene, "--json", "--quiet", "--out", out.to_str().unwrap()];
    sets.iter().for_each(|set| arguments.extend(["--set", set]));
    arguments.extend(more);
    stripmine(&arguments)
}

fn run(scene: &str, out: &Path, sets: &[&str], more: &[&str]) -> Value {
    let output = begin(scene, out, sets, more);
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

/// Text of the last frame, with a line for each particle.
fn last_frame(folder: &Path) -> String {
    let text = fs::read_to_string(folder.join("trajectory.xyz")).unwrap();
    text[text.rfind("Lattice").unwrap()..].to_owned()
}

/// ⟨r²⟩ of free particles is 4 D (t − τ (1 − e^(−t/τ))) from a thermal start and 4 D (t − 2 τ (1 − e^(−t/τ)) + (τ/2)(1 − e^(−2t/τ)))
/// from rest, with D = kT/γ and τ = m/γ. For 20 000 particles it agrees to five standard errors at all times; so does the temperature.
#[test]
fn free_diffusion_agrees_with_the_exact_result() {
    let folder = tempfile::tempdir().unwrap();
    let (count, gamma, kt, mass) = (20_000.0, 0.8, 1.3, 0.5);
    let bath = ["law.drag=0.8", "law.bath_temperature=1.3", "particles.mass=0.5", "particles.count=20000"];
    let (diffusion, tau) = (kt / gamma, mass / gamma);
    for (name, start, scheme) in [
        ("thermal", "particles.temperature=1.3", "integrator.kind=baoab"),
        ("thermal-source", "particles.temperature=1.3", "integrator.kind=stochastic"),
        ("rest", "particles.temperature=0", "integrator.kind=baoab"),
    ] {
        let out = folder.path().join(name);
        let more = [start, scheme, "run.time=6", "run.thermo_every=50", "run.snapshot_every=0"];
        run("langevin-free", &out, &[&bath[..], &more].concat(), &[]);
        for (time, found) in column(&out, "time").into_iter().zip(column(&out, "msd")).skip(1) {
            let once = 1.0 - (-time / tau).exp();
            let twice = 1.0 - (-2.0 * time / tau).exp();
            let exact = match name {
                "rest" => 4.0 * diffusion * (time - 2.0 * tau * once + 0.5 * tau * twice),
                _ => 4.0 * diffusion * (time - tau * once),
            };
            // The standard deviation of the square of a planar Gaussian vector equals its mean; dt = 0.01 adds up to 1 % in the first steps.
            let bar = 5.0 * exact / f64::sqrt(count) + 0.01 * exact;
            assert!((found - exact).abs() < bar, "{name} at {time}: {found} {exact}");
        }
        let last = *column(&out, "temperature").last().unwrap();
        assert!((last / kt - 1.0).abs() < 5.0 / f64::sqrt(count) + 0.01, "{name}: {last}");
    }
}

/// The preset's fluid with a step that is long for it: both schemes have the temperature of the bath. For baoab it is that
/// of the velocities after the bath; those at the end of the step, in the trajectory, are colder by dt²⟨F²⟩/(4 m), which is 1.07 %
/// as measured over ten times as long.
#[test]
fn dense_fluid_has_the_bath_temperature() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, dt, expected) in [("baoab", 0.015, 0.0107), ("stochastic", 0.01, 0.0)] {
        let out = folder.path().join(kind);
        let (kind, step) = (format!("integrator.kind={kind}"), format!("integrator.dt={dt}"));
        let sets = [&kind, &step, "run.time=120", "run.thermo_every=20", "run.snapshot_every=100"];
        run("langevin-dense", &out, &sets, &[]);
        let rows = column(&out, "temperature");
        let mean = |rows: &[f64]| rows.iter().sum::<f64>() / rows.len() as f64;
        let late = mean(&rows[rows.len() / 6..]);
        assert!((late - 1.0).abs() < 0.006, "{kind}: {late}");
        // m⟨v²⟩/2 of the frames; every fifth row has a frame.
        let text = fs::read_to_string(out.join("trajectory.xyz")).unwrap();
        let squares: Vec<f64> = text
            .lines()
            .filter(|line| line.starts_with("Si "))
            .map(|line| {
                let velocity = line.split_whitespace().skip(5).take(2);
                velocity.map(|v| 0.5 * v.parse::<f64>().unwrap().powi(2)).sum()
            })
            .collect();
        let rows: Vec<f64> = rows.into_iter().step_by(5).collect();
        assert_eq!(squares.len(), 1120 * rows.len());
        let colder = mean(&rows) - mean(&squares);
        assert!((colder - expected).abs() < 0.001, "{kind}: frames are colder by {colder}");
    }
}

/// The noise has its own seed: other seeds give other trajectories from one start, equal seeds the same bits, also for listed
/// particles, for those of a file, and through the scene that a run writes. Without it the noise follows the start's seed.
#[test]
fn noise_has_its_own_seed() {
    let folder = tempfile::tempdir().unwrap();
    let short = ["run.steps=30", "run.snapshot_every=0"];
    let began = |name: &str, scene: &str, sets: &[&str]| {
        let out = folder.path().join(name);
        let summary = run(scene, &out, &[&short[..], sets].concat(), &[]);
        let first = fs::read_to_string(out.join("trajectory.xyz")).unwrap();
        let first = first[..1 + first[1..].find("Lattice").unwrap()].to_owned();
        (last_frame(&out), first, summary["noise_seed"].as_u64().unwrap())
    };
    let start = folder.path().join("source/trajectory.xyz");
    let (plain, _, seed) = began("source", "langevin-free", &["particles.count=50"]);
    assert_eq!(seed, 1);
    assert_eq!(began("same", "langevin-free", &["particles.count=50", "law.noise_seed=1"]).0, plain);
    let (five, _, _) = began("five", "langevin-free", &["particles.count=50", "law.noise_seed=5"]);
    assert_ne!(five, plain);
    let (_, _, seed) = began("follows", "langevin-free", &["particles.count=50", "particles.seed=9"]);
    assert_eq!(seed, 9);
    // A resolved scene run with another seed of the start has other noise too.
    let resolved = folder.path().join("source/scene.toml").display().to_string();
    assert_eq!(began("again", &resolved, &["particles.seed=9"]).2, 9);
    let bath = "format = 2\nunits = \"reduced\"\n[method]\nkind = \"langevin\"\n[domain]\nsides = [50.0, 50.0]\n[law]\nkind = \"none\"\n\
                [integrator]\ndt = 0.01\n[run]\nsteps = 1\n[particles]\n";
    let listed = "generate = \"list\"\nradius = 0.1\nmass = 1.0\npositions = [[1.0, 2.0], [10.0, 5.0], [20.0, 20.0]]\n";
    for (kind, particles) in
        [("list", listed.to_owned()), ("file", format!("file = {:?}\n", start.display().to_string()))]
    {
        let path = folder.path().join(format!("{kind}.toml"));
        fs::write(&path, bath.to_owned() + &particles).unwrap();
        let scene = path.to_str().unwrap();
        let named = |number: u32| format!("{kind}-{number}");
        let (unset, first, seed) = began(&named(0), scene, &[]);
        assert_eq!(seed, 1);
        let of = |number: u32, seed: &str| began(&named(number), scene, &[&format!("law.noise_seed={seed}")]);
        let (three, again, other) = (of(1, "3"), of(2, "3"), of(3, "18446744073709551615"));
        assert_eq!(of(4, "1").0, unset, "{kind}");
        assert_eq!(three, again, "{kind}");
        assert!(three.1 == first && other.1 == first, "{kind}: one start");
        assert!(three.0 != unset && three.0 != other.0, "{kind}: one noise");
        let written = folder.path().join(named(1)).join("scene.toml");
        assert!(fs::read_to_string(&written).unwrap().contains("noise_seed = 3"), "{kind}");
        assert_eq!(began(&named(5), written.to_str().unwrap(), &[]), three, "{kind}");
    }
}

/// Empty boxes have hardly more sectors than particles: the cost of a step depends on the particles, for every search and
/// precision, and the pairs are the same.
#[test]
fn cost_of_empty_boxes_depends_on_particles() {
    let folder = tempfile::tempdir().unwrap();
    for (name, side, spacing) in
        [("dense", "5.0", "0.13"), ("thin", "60.0", "0.2"), ("empty", "1000.0", "0.2")]
    {
        let [sides, spacing] =
            [format!("domain.sides=[{side}, {side}]"), format!("particles.spacing={spacing}")];
        let ran = |by: &str, precision: &str| -> Vec<f64> {
            let out = folder.path().join(format!("{name}-{by}-{precision}"));
            let [by, precision] = [format!("search.by={by}"), format!("machine.precision={precision}")];
            let sets = [&*sides, &spacing, &by, &precision, "particles.count=400", "run.steps=100"];
            let rows = ["run.thermo_every=100", "run.snapshot_every=0"];
            run("langevin-report", &out, &[&sets[..], &rows].concat(), &[]);
            ["potential", "temperature", "msd"].map(|name| *column(&out, name).last().unwrap()).to_vec()
        };
        let expected = ran("neighbor-list", "f64");
        for (by, precision, bound) in [
            ("sectors", "f64", 1e-9),
            ("sectors", "mixed", 1e-2),
            ("sectors", "f32", 1e-2),
            ("auto", "f32", 1e-2),
        ] {
            for (found, expected) in ran(by, precision).into_iter().zip(&expected) {
                let off = (found - expected).abs() / expected.abs().max(0.1);
                assert!(off < bound, "{name} by {by} in {precision}: {found}, {expected}");
            }
        }
    }
}

/// Friction by the velocity of the previous step heats to kT/(1 − γ dt/2m); by that after half a kick it does not.
#[test]
fn printed_scheme_heats_the_gas() {
    let folder = tempfile::tempdir().unwrap();
    let temperature = |kind: &str| {
        let out = folder.path().join(kind);
        let kind = format!("integrator.kind={kind}");
        let sets =
            [&kind, "integrator.dt=0.4", "run.time=400", "run.thermo_every=10", "run.snapshot_every=0"];
        run("langevin-free", &out, &[&sets[..], &["particles.count=2000"]].concat(), &[]);
        let late = column(&out, "temperature").split_off(20);
        late.iter().sum::<f64>() / late.len() as f64
    };
    // 80 samples of 2000 particles, separated by 4 times the time m/γ: 0.25 %.
    for (kind, expected) in [("baoab", 1.0), ("stochastic", 1.0), ("as-printed", 1.25)] {
        let found = temperature(kind);
        assert!((found / expected - 1.0).abs() < 0.0125, "{kind}: {found}");
    }
}

/// All searches find the same pairs: after 40 steps of a dense scene the positions agree to rounding.
#[test]
fn searches_threads_and_resumption_agree() {
    let folder = tempfile::tempdir().unwrap();
    let dense = ["law.kind=wca", "particles.count=900", "run.thermo_every=20", "run.snapshot_every=20"];
    let frame = |name: &str, sets: &[&str], parts: &[&str], more: &[&str]| {
        let out = folder.path().join(name);
        for (number, steps) in parts.iter().enumerate() {
            let steps = format!("run.steps={steps}");
            let all = [&dense[..], sets, &[&steps]].concat();
            let resumed: &[&str] = if number > 0 { &["--resume"] } else { &[] };
            run("langevin-dense", &out, &all, &[more, resumed].concat());
        }
        last_frame(&out)
    };
    let numbers = |frame: &str| -> Vec<f64> {
        let particles = frame.lines().skip(1).flat_map(|line| line.split_whitespace().skip(1).take(4));
        particles.map(|number| number.parse().unwrap()).collect()
    };
    let whole = frame("lists", &["search.by=neighbor-list"], &["40"], &[]);
    assert_eq!(whole.lines().count(), 901);
    for by in ["sectors", "lattice"] {
        let other = frame(by, &[&format!("search.by={by}")], &["40"], &[]);
        for (a, b) in numbers(&whole).into_iter().zip(numbers(&other)) {
            assert!((a - b).abs() < 1e-8 || (a - b).abs() > 39.9, "{by}: {a} {b}");
        }
        assert_eq!(
            frame(&format!("{by}-parts"), &[&format!("search.by={by}")], &["13", "27", "40"], &[]),
            other
        );
    }
    let lists = ["search.by=neighbor-list"];
    assert_eq!(frame("parts", &lists, &["7", "29", "40"], &[]), whole);
    // The summary of a run in parts is that of a run in one piece, also if lists were built in every part.
    let said = |name: &str, parts: &[&str]| {
        let out = folder.path().join(name);
        let mut summary = Value::Null;
        for (number, steps) in parts.iter().enumerate() {
            let steps = format!("run.steps={steps}");
            let resumed: &[&str] = if number > 0 { &["--resume"] } else { &[] };
            summary =
                run("langevin-dense", &out, &[&dense[..], &["search.skin=0.2"], &[&steps]].concat(), resumed);
        }
        ["lists_made", "listed_pairs", "particles", "lost", "potential", "noise_seed"]
            .map(|name| summary[name].clone())
    };
    let in_one_piece = said("counted", &["60"]);
    assert!(in_one_piece[0].as_u64().unwrap() > 3, "{in_one_piece:?}");
    assert_eq!(said("counted-parts", &["7", "29", "60"]), in_one_piece);
    assert_eq!(frame("one-thread", &lists, &["40"], &["--threads", "1"]), whole);
    assert_eq!(
        frame("scalar", &[&lists[..], &["machine.instruction_set=scalar"]].concat(), &["40"], &[]),
        whole
    );
    let source = [&lists[..], &["integrator.kind=stochastic"]].concat();
    let whole = frame("source", &source, &["40"], &[]);
    assert_eq!(frame("source-parts", &source, &["7", "29", "40"], &["--threads", "1"]), whole);
}

/// A step that is too long makes particles leave the box: the run stops, reports their number and suggests a step. With losses allowed the
/// run continues, counts and lists them, also across a resumption, and the rest stays finite.
#[test]
fn losses_are_counted_and_listed() {
    let folder = tempfile::tempdir().unwrap();
    let thin = [
        "particles.count=4000",
        "domain.sides=[31.6, 31.6]",
        "integrator.dt=0.005",
        "run.checkpoint_every=0",
        "run.snapshot_every=50",
        "output.dcd=true",
        "output.gsd=true",
    ];
    let stopped = begin("langevin-report", &folder.path().join("stopped"), &thin, &[]);
    assert_eq!(stopped.status.code(), Some(4), "{}", said(&stopped));
    for word in ["lost", "run.most_lost", "integrator.dt below"] {
        assert!(said(&stopped).contains(word), "{word} is not in {}", said(&stopped));
    }
    let allowed = [&thin[..], &["run.most_lost=4000"]].concat();
    let events = |name: &str, parts: &[&str]| {
        let out = folder.path().join(name);
        let (mut lost, mut counted) = (0, vec![]);
        for (number, steps) in parts.iter().enumerate() {
            let steps = format!("run.steps={steps}");
            let resumed: &[&str] = if number > 0 { &["--resume"] } else { &[] };
            let summary = run("langevin-report", &out, &[&allowed[..], &[&steps]].concat(), resumed);
            lost = summary["lost"].as_u64().unwrap();
            assert_eq!(summary["particles"].as_u64().unwrap() + lost, 4000);
            let listed = summary["losses"].as_array().unwrap();
            assert_eq!(listed.len() as u64, lost.min(100));
            let rows = fs::read_to_string(out.join("events.csv")).unwrap();
            for (loss, row) in listed.iter().zip(rows.lines().skip(1)) {
                let row: Vec<f64> = row.split(',').map(|number| number.parse().unwrap()).collect();
                let named = ["particle", "step", "x", "y"].map(|name| loss[name].as_f64().unwrap());
                assert_eq!(named[..2], row[2..4]);
                // Numbers of JSON are read to the last digit or two.
                (2..4).for_each(|along| {
                    assert!((named[along] - row[2 + along]).abs() <= 1e-15 * row[2 + along].abs(), "{loss}");
                });
            }
            let first =
                format!("first particle {} in step {} at (", listed[0]["particle"], listed[0]["step"]);
            for said in [&summary["warnings"], &summary["checks"]] {
                assert!(
                    said.to_string().contains(&first) && said.to_string().contains("events.csv"),
                    "{said}"
                );
            }
            counted = ["losses", "lists_made", "listed_pairs", "particles", "lost", "potential"]
                .map(|name| summary[name].clone())
                .to_vec();
        }
        assert!(lost > 100, "{lost}");
        let rows = fs::read_to_string(out.join("events.csv")).unwrap();
        assert_eq!(rows.lines().count() as u64, lost + 1);
        assert_eq!(last_frame(&out).lines().count() as u64, 4001 - lost);
        assert_eq!(column(&out, "lost").last().copied(), Some(lost as f64));
        // Every DCD frame has all particles of the start; positions of lost ones are NaN.
        let dcd = fs::read(out.join("trajectory.dcd")).unwrap();
        let (heading, frame) = (196, 56 + 3 * (8 + 4 * 4000));
        assert_eq!((dcd.len() - heading) % frame, 0);
        let last = &dcd[dcd.len() - 3 * (8 + 4 * 4000) + 4..][..4 * 4000];
        let absent = last.chunks(4).filter(|x| f32::from_le_bytes((*x).try_into().unwrap()).is_nan());
        assert_eq!(absent.count() as u64, lost);
        // A GSD frame has the remaining particles, as the text does, but no seed.
        let text: Vec<_> = extxyz::XyzFrames::open(out.join("trajectory.xyz"))
            .unwrap()
            .map(|frame| extxyz::ParticleFrame { seed: None, ..frame.unwrap() })
            .collect();
        let indexed: Vec<_> =
            gsd::GsdFrames::open(out.join("trajectory.gsd")).unwrap().map(Result::unwrap).collect();
        assert!(text == indexed && text[text.len() - 1].particles.len() as u64 == 4000 - lost);
        (rows, last_frame(&out), dcd, fs::read(out.join("trajectory.gsd")).unwrap(), counted)
    };
    assert_eq!(events("parts", &["33", "71", "100"]), events("whole", &["100"]));
    // Without rows only the summary lists them, and the message refers to it.
    let silent = [&allowed[..], &["output.losses=false", "run.steps=71"]].concat();
    let summary = run("langevin-report", &folder.path().join("silent"), &silent, &[]);
    let said = summary["warnings"].to_string();
    assert!(said.contains("summary.json lists them") && !said.contains("events.csv"), "{said}");
    assert!(!summary["losses"].as_array().unwrap().is_empty());
}

#[test]
fn impossible_settings_are_refused_with_alternatives() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str], &[&str]); 14] = [
        (
            "langevin-report",
            &["search.by=sectors", "search.sectors=900"],
            &["narrower than the cut-off", "3 to 890"],
        ),
        ("langevin-report", &["particles.count=800000"], &["890 × 890 = 792100 sites", "particles.spacing"]),
        ("langevin-dense", &["search.by=lattice"], &["no lattice serves", "sectors"]),
        ("langevin-dense", &["domain.periodic=[true, false]"], &["no walls"]),
        ("langevin-dense", &["domain.gravity=[0.0, -1.0]"], &["gravity"]),
        ("langevin-dense", &["particles.spacing=0.5", "particles.count=5000"], &["overlap", "thrown apart"]),
        ("langevin-dense", &["integrator.dt=-1"], &["integrator.dt"]),
        ("langevin-dense", &["search.skin=20"], &["no room", "search.skin"]),
        ("langevin-dense", &["law.strenght=2"], &["strength"]),
        (
            "langevin-dense",
            &["law.kind=wca", "law.screening=3"],
            &["has no effect with law.kind = \"wca\"", "yukawa"],
        ),
        ("langevin-dense", &["law.kind=yukawa", "law.screening=60"], &["above 0 and at most 50"]),
        (
            "langevin-dense",
            &["law.kind=yukawa", "search.by=lattice"],
            &["no lattice serves", "the cut-off is 2.5"],
        ),
        ("langevin-dense", &["law.noise_seed=-1"], &["law.noise_seed"]),
        (
            "langevin-free",
            &[
                "law.kind=wca",
                "domain.sides=[9e4, 9e4]",
                "particles.spacing=90",
                "search.by=sectors",
                "search.sectors=70000",
            ],
            &["more than the 2^32"],
        ),
    ];
    for (scene, sets, words) in cases {
        let output = begin(scene, &folder.path().join("refused"), sets, &[]);
        assert_eq!(output.status.code(), Some(3), "{sets:?}: {}", said(&output));
        words.iter().for_each(|word| assert!(said(&output).contains(word), "{word}: {}", said(&output)));
    }
    let warned = stripmine(&["scene", "check", "langevin-report", "--set", "integrator.dt=0.04"]);
    let text = String::from_utf8_lossy(&warned.stdout).into_owned() + &said(&warned);
    assert!(warned.status.success() && text.contains("beyond √(2 m r_c/F) = 0.030584"), "{text}");
}

/// Free particles that cross the box several times in a step: they run, and their displacements are those in a wide box that none crosses, for
/// every search and on three ranks. ⟨r²⟩ is 4 D (t − τ) to five standard errors.
#[test]
fn free_particles_cross_the_box_in_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let hot = [
        "particles.count=400",
        "particles.temperature=5e5",
        "law.bath_temperature=5e5",
        "particles.seed=7",
        "integrator.dt=0.05",
        "particles.mass=1",
        "law.drag=1",
        "run.time=20",
        "run.thermo_every=100",
        "run.snapshot_every=200",
        "particles.radius=0.05",
    ];
    let msd = |name: &str, sets: &[&str], more: &[&str]| {
        let out = folder.path().join(name);
        let summary = run("langevin-free", &out, &[&hot[..], sets].concat(), more);
        assert_eq!(summary["lost"], 0, "{name}");
        *column(&out, "msd").last().unwrap()
    };
    let wide = msd("wide", &["domain.sides=[1e6, 1e6]", "particles.spacing=100"], &[]);
    let exact = 4.0 * 5e5 * (20.0 - 1.0);
    assert!((wide / exact - 1.0).abs() < 5.0 / 20.0, "{wide} {exact}");
    for (name, sets, more) in [
        ("lists", &["search.by=neighbor-list"][..], &[][..]),
        ("sectors", &["search.by=sectors"], &[]),
        ("few", &["search.by=sectors", "search.sectors=3"], &[]),
        ("ranks", &["search.by=sectors", "search.sectors=60"], &["--ranks", "3"]),
    ] {
        let found = msd(name, &[&["domain.sides=[50, 40]"], sets].concat(), more);
        assert!((found / wide - 1.0).abs() < 1e-9, "{name}: {found} {wide}");
    }
}

/// Losses caused by pairs are reported with a suggested step; if the step is within all limits, with the displacement and the side of the box.
#[test]
fn losses_are_reported_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let said = |name: &str, sets: &[&str]| {
        let output = begin(
            "langevin-free",
            &folder.path().join(name),
            &[&["particles.count=100", "law.kind=wca"], sets].concat(),
            &[],
        );
        assert!(!output.status.success(), "{name}");
        said(&output)
    };
    let far = [
        "particles.temperature=1e12",
        "law.drag=0",
        "particles.radius=0.05",
        "integrator.dt=1e-3",
        "domain.sides=[50, 50]",
    ];
    let message = said("far", &far);
    assert!(message.contains("lost") && message.contains("farther than the side 50 of the box"), "{message}");
    // By hand: the side over the reported velocity, along x.
    let number = |before: &str| -> f64 {
        let rest = message.split(before).nth(1).unwrap_or_else(|| panic!("{message}"));
        rest.split([',', ' ']).next().unwrap().parse().unwrap()
    };
    let [velocity, step] = ["with velocity (", "take integrator.dt below "].map(number);
    assert!((step * velocity.abs() / 50.0 - 1.0).abs() < 5e-3, "{message}");
}

/// A run from the last frame of another one has new noise, from a file and from a list: after the same number of
/// steps the velocities of both are uncorrelated. Runs from one start are the same, and another noise_seed gives other noise.
#[test]
fn runs_from_frames_have_new_noise() {
    let folder = tempfile::tempdir().unwrap();
    let free = [
        "domain.sides=[50, 50]",
        "run.time=10",
        "run.thermo_every=100",
        "run.snapshot_every=1000",
        "integrator.dt=0.01",
        "law.drag=1",
    ];
    let first = folder.path().join("first");
    run("langevin-free", &first, &[&free[..], &["particles.count=200"]].concat(), &[]);
    let start = folder.path().join("start.xyz");
    let text = fs::read_to_string(first.join("trajectory.xyz")).unwrap();
    let frames: Vec<&str> = text.lines().collect();
    fs::write(&start, frames[frames.len() - 202..].join("\n") + "\n").unwrap();
    let file = format!("particles.file={}", start.display());
    let numbers = |line: &str, from: usize| -> String {
        let all: Vec<&str> = line.split_whitespace().collect();
        format!("[{}, {}]", all[from], all[from + 1])
    };
    let list = |from: usize| {
        let rows: Vec<String> = frames[frames.len() - 200..].iter().map(|line| numbers(line, from)).collect();
        format!("[{}]", rows.join(", "))
    };
    let positions = format!("particles.positions={}", list(2));
    let velocities = format!("particles.velocities={}", list(5));
    let listed = ["particles.generate=list", &positions, &velocities];
    let velocities = |folder: &Path| -> Vec<f64> {
        let frame = last_frame(folder);
        let lines = frame.lines().filter(|line| line.starts_with("Si "));
        lines
            .flat_map(|line| {
                line.split_whitespace().skip(5).take(2).map(|v| v.parse().unwrap()).collect::<Vec<f64>>()
            })
            .collect()
    };
    let mut all = vec![velocities(&first)];
    for (name, sets) in
        [("file", &[file.as_str()][..]), ("file-of-2", &[&file, "law.noise_seed=2"]), ("list", &listed)]
    {
        let outs = [name.to_owned(), format!("{name}-again")].map(|name| folder.path().join(name));
        outs.iter().for_each(|out| _ = run("langevin-free", out, &[&free[..], sets].concat(), &[]));
        assert_eq!(last_frame(&outs[0]), last_frame(&outs[1]), "{name}");
        all.push(velocities(&outs[0]));
    }
    // File and list are the same state except for the precision of the file; their noise is either the same or uncorrelated.
    for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2)] {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let correlation = dot(&all[a], &all[b]) / (dot(&all[a], &all[a]) * dot(&all[b], &all[b])).sqrt();
        assert!(correlation.abs() < 4.5 / f64::sqrt(400.0), "{a} {b}: {correlation}");
    }
}

/// Without friction there is no bath: momentum is conserved, and a single free particle has no temperature; with it, kT is half of m v².
#[test]
fn bath_temperature_counts_degrees_of_freedom() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |name: &str, sets: &[&str]| {
        let out = folder.path().join(name);
        let list = [
            "particles.generate=list",
            "particles.mass=2",
            "law.kind=none",
            "run.steps=2",
            "run.thermo_every=1",
        ];
        run("langevin-free", &out, &[&list[..], sets].concat(), &[]);
        column(&out, "temperature")[0]
    };
    let one = ["particles.positions=[[2.0, 3.0]]", "particles.velocities=[[1.0, 2.0]]"];
    assert_eq!(rows("one", &one), 5.0);
    assert!(rows("one-free", &[&one[..], &["law.drag=0"]].concat()).is_nan());
    // Σ m v² = 2 (1 + 4 + 1) = 12; without the mean motion, 2 · 2 (0² + 1²) = 4, it is 8.
    let two =
        ["particles.positions=[[2.0, 3.0], [5.0, 5.0]]", "particles.velocities=[[1.0, 2.0], [-1.0, 0.0]]"];
    assert_eq!(rows("two", &two), 12.0 / 4.0);
    assert_eq!(rows("two-free", &[&two[..], &["law.drag=0"]].concat()), 8.0 / 2.0);
}

/// U of Yukawa particles with ε = 1, σ = 1 and κσ = 5, cut off at 2.5 and shifted.
fn yukawa(distance: f64) -> f64 {
    let uncut = |r: f64| (-5.0 * (r - 1.0)).exp() / r;
    if distance < 2.5 { uncut(distance) - uncut(2.5) } else { 0.0 }
}

/// Two Yukawa particles at rest, 1.2 apart, have the energy and pressure of the formula, with r F = U (κ r + 1); without friction the error
/// of the energy in a collision is proportional to dt².
#[test]
fn yukawa_pair_agrees_with_the_formula() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |name: &str, sets: &[&str], columns: &[&str]| -> Vec<Vec<f64>> {
        let two = [
            "law.kind=yukawa",
            "law.drag=0",
            "integrator.kind=stochastic",
            "particles.generate=list",
            "particles.radius=0.5",
            "run.thermo_every=1",
        ];
        let out = folder.path().join(name);
        run("langevin-free", &out, &[&two[..], sets].concat(), &[]);
        columns.iter().map(|name| column(&out, name)).collect()
    };
    let rest = [
        "particles.positions=[[20.0, 20.0], [21.2, 20.0]]",
        "particles.velocities=[[0.0, 0.0], [0.0, 0.0]]",
        "run.steps=1",
    ];
    let found = rows("rest", &rest, &["potential", "pressure"]);
    let virial = (-1f64).exp() / 1.2 * (5.0 * 1.2 + 1.0);
    assert!((found[0][0] - yukawa(1.2)).abs() < 1e-14, "{found:?}");
    assert!((found[1][0] - 0.5 * virial / 2500.0).abs() < 1e-14, "{found:?}");
    let worst = [0.04, 0.02, 0.01].map(|dt| {
        let (name, dt) = (format!("dt-{dt}"), format!("integrator.dt={dt}"));
        let collision = [
            "particles.positions=[[20.0, 20.0], [23.0, 20.3]]",
            "particles.velocities=[[1.0, 0.0], [-1.0, 0.0]]",
            "run.time=3",
            &dt,
        ];
        let found = rows(&name, &collision, &["kinetic", "potential"]);
        let energies = found[0].iter().zip(&found[1]).map(|(kinetic, potential)| kinetic + potential);
        energies.map(|energy| (energy - 1.0).abs()).fold(0.0, f64::max)
    });
    assert!(worst[0] < 5e-3 && worst.windows(2).all(|it| (3.6..4.4).contains(&(it[0] / it[1]))), "{worst:?}");
}

/// Pressure of a thin Yukawa fluid, P = ρ kT (1 + B₂ ρ + B₃ ρ²) with virial coefficients by quadrature: the contribution of pairs agrees within
/// 2.5 %, of which B₄ is half a percent and the statistical error as much. A table of the potential has the same pressure.
#[test]
fn thin_yukawa_fluid_agrees_with_virial_expansion() {
    const PARTS: usize = 60;
    let part = 2.5 / PARTS as f64;
    let mayer = |distance: f64| (-yukawa(distance)).exp() - 1.0;
    let middles = || (0..PARTS).map(|it| (it as f64 + 0.5) * part);
    let second = -std::f64::consts::PI * middles().map(|r| mayer(r) * r * part).sum::<f64>();
    let third = |r: f64, s: f64| {
        let angles = (0..PARTS).map(|it| (it as f64 + 0.5) * std::f64::consts::PI / PARTS as f64);
        let across = |angle: f64| mayer((r * r + s * s - 2.0 * r * s * angle.cos()).sqrt());
        mayer(r) * r * part * mayer(s) * s * part * angles.map(across).sum::<f64>() / PARTS as f64
    };
    let third = -4.0 / 3.0
        * std::f64::consts::PI.powi(2)
        * middles().map(|r| middles().map(|s| third(r, s)).sum::<f64>()).sum::<f64>();
    let folder = tempfile::tempdir().unwrap();
    let rows = (1..=100).map(|row| 0.025 * f64::from(row)).map(|r| format!("{r},{}\n", yukawa(r)));
    let table = folder.path().join("yukawa.csv");
    std::fs::write(&table, rows.collect::<String>()).unwrap();
    let table = format!("law.file={}", table.display());
    let thin = [
        "particles.count=2000",
        "domain.sides=[200.0, 200.0]",
        "integrator.dt=0.01",
        "run.time=200",
        "run.thermo_every=20",
        "run.snapshot_every=0",
    ];
    let density = 0.05;
    for (kind, law) in [("yukawa", vec!["law.kind=yukawa"]), ("table", vec!["law.kind=table", &table])] {
        let out = folder.path().join(kind);
        run("langevin-dense", &out, &[&law[..], &thin].concat(), &[]);
        let [pressures, temperatures] = ["pressure", "temperature"].map(|name| column(&out, name));
        let of_pairs = pressures.iter().zip(&temperatures).map(|(pressure, kt)| pressure - density * kt);
        let of_pairs: Vec<f64> = of_pairs.skip(pressures.len() / 10).collect();
        let found = of_pairs.iter().sum::<f64>() / of_pairs.len() as f64;
        let expected = density * (second * density + third * density * density);
        assert!(
            (found / expected - 1.0).abs() < 0.025,
            "{kind}: {found} {expected}: B₂ = {second}, B₃ = {third}"
        );
    }
}
