//! Particles in a bath, as a user meets them: exact results of diffusion, equal searches, losses, resumption, what is refused.

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

/// The columns of thermo.csv by name.
fn column(folder: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(folder.join("thermo.csv")).unwrap();
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(',').position(|column| column == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

/// The last frame: a line for each particle, and its numbers.
fn last_frame(folder: &Path) -> String {
    let text = fs::read_to_string(folder.join("trajectory.xyz")).unwrap();
    text[text.rfind("Lattice").unwrap()..].to_owned()
}

/// ⟨r²⟩ of free particles is 4 D (t − τ (1 − e^(−t/τ))) from a thermal start and 4 D (t − 2 τ (1 − e^(−t/τ)) + (τ/2)(1 − e^(−2t/τ)))
/// from rest, with D = kT/γ and τ = m/γ: of 20 000 particles to five standard errors, at all times; the temperature likewise.
#[test]
fn free_particles_diffuse_as_the_exact_result_has_it() {
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
            // The square of a Gaussian vector of the plane scatters as itself; dt = 0.01 adds up to 1 % in the first steps.
            let bar = 5.0 * exact / f64::sqrt(count) + 0.01 * exact;
            assert!((found - exact).abs() < bar, "{name} at {time}: {found} {exact}");
        }
        let last = *column(&out, "temperature").last().unwrap();
        assert!((last / kt - 1.0).abs() < 5.0 / f64::sqrt(count) + 0.01, "{name}: {last}");
    }
}

/// Friction by the velocity of the step before heats to kT/(1 − γ dt/2m), by that after half a kick not.
#[test]
fn the_scheme_as_printed_heats() {
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
    // 80 looks at 2000 particles, 4 times the time m/γ apart: 0.25 %.
    for (kind, expected) in [("baoab", 1.0), ("stochastic", 1.0), ("as-printed", 1.25)] {
        let found = temperature(kind);
        assert!((found / expected - 1.0).abs() < 0.0125, "{kind}: {found}");
    }
}

/// The searches find the same pairs: particles of a dense scene lie on each other after 40 steps, to rounding.
#[test]
fn searches_agree_and_threads_sets_and_resumption_change_no_bit() {
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
    assert_eq!(frame("one-thread", &lists, &["40"], &["--threads", "1"]), whole);
    assert_eq!(
        frame("scalar", &[&lists[..], &["machine.instruction_set=scalar"]].concat(), &["40"], &[]),
        whole
    );
    let source = [&lists[..], &["integrator.kind=stochastic"]].concat();
    let whole = frame("source", &source, &["40"], &[]);
    assert_eq!(frame("source-parts", &source, &["7", "29", "40"], &["--threads", "1"]), whole);
}

/// A step that is too long throws particles out: the run stops with the number and a step that would do; where losses are allowed it
/// goes on, counts and lists them, also across a resumption, and the rest stays finite.
#[test]
fn losses_are_counted_listed_and_survived() {
    let folder = tempfile::tempdir().unwrap();
    let thin = [
        "particles.count=4000",
        "domain.sides=[31.6, 31.6]",
        "integrator.dt=0.005",
        "run.checkpoint_every=0",
        "output.dcd=true",
    ];
    let stopped = begin("langevin-report", &folder.path().join("stopped"), &thin, &[]);
    assert_eq!(stopped.status.code(), Some(4), "{}", said(&stopped));
    for word in ["lost", "run.most_lost", "integrator.dt below"] {
        assert!(said(&stopped).contains(word), "{word} is not in {}", said(&stopped));
    }
    let allowed = [&thin[..], &["run.most_lost=4000"]].concat();
    let events = |name: &str, parts: &[&str]| {
        let out = folder.path().join(name);
        let mut lost = 0;
        for (number, steps) in parts.iter().enumerate() {
            let steps = format!("run.steps={steps}");
            let resumed: &[&str] = if number > 0 { &["--resume"] } else { &[] };
            let summary = run("langevin-report", &out, &[&allowed[..], &[&steps]].concat(), resumed);
            lost = summary["lost"].as_u64().unwrap();
            assert_eq!(summary["particles"].as_u64().unwrap() + lost, 4000);
            assert!(summary["warnings"].to_string().contains("lost"));
        }
        assert!(lost > 100, "{lost}");
        let rows = fs::read_to_string(out.join("events.csv")).unwrap();
        assert_eq!(rows.lines().count() as u64, lost + 1);
        assert_eq!(last_frame(&out).lines().count() as u64, 4001 - lost);
        assert_eq!(column(&out, "lost").last().copied(), Some(lost as f64));
        // Every frame of positions has all particles of the start; what is lost is no number.
        let dcd = fs::read(out.join("trajectory.dcd")).unwrap();
        let (heading, frame) = (196, 56 + 3 * (8 + 4 * 4000));
        assert_eq!((dcd.len() - heading) % frame, 0);
        let last = &dcd[dcd.len() - 3 * (8 + 4 * 4000) + 4..][..4 * 4000];
        let absent = last.chunks(4).filter(|x| f32::from_le_bytes((*x).try_into().unwrap()).is_nan());
        assert_eq!(absent.count() as u64, lost);
        (rows, last_frame(&out), dcd)
    };
    assert_eq!(events("parts", &["33", "71", "100"]), events("whole", &["100"]));
}

#[test]
fn what_cannot_be_is_refused_with_what_may_be() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str], &[&str]); 9] = [
        (
            "langevin-report",
            &["search.by=sectors", "search.sectors=900"],
            &["narrower than the cut-off", "3 to 890"],
        ),
        ("langevin-report", &["particles.count=800000"], &["890 × 890 = 792100 places", "particles.spacing"]),
        ("langevin-dense", &["search.by=lattice"], &["no lattice serves", "sectors"]),
        ("langevin-dense", &["domain.periodic=[true, false]"], &["no walls"]),
        ("langevin-dense", &["domain.gravity=[0.0, -1.0]"], &["gravity"]),
        ("langevin-dense", &["particles.spacing=0.5", "particles.count=5000"], &["overlap", "thrown apart"]),
        ("langevin-dense", &["integrator.dt=-1"], &["integrator.dt"]),
        ("langevin-dense", &["search.skin=20"], &["no room", "search.skin"]),
        ("langevin-dense", &["law.strenght=2"], &["strength"]),
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
