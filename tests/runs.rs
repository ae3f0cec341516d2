//! Runs as a user sees them: folders, resumption, interruption, failures.

use assert_cmd::cargo::CommandCargoExt;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use stripmine_physics::method::{Every, METHODS, load};

fn stripmine(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.args(arguments);
    command
}

fn output(arguments: &[&str]) -> Output {
    stripmine(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs a short pipe into a folder with further arguments.
fn pipe(folder: &Path, more: &[&str]) -> Output {
    let mut arguments = vec!["run", "pipe-small", "--out", folder.to_str().unwrap(), "--quiet"];
    arguments.extend(["--set", "run.thermo_every=50", "--set", "run.snapshot_every=100"]);
    arguments.extend(["--set", "run.checkpoint_every=200", "--set", "output.lammps_dump=true"]);
    arguments.extend(more);
    output(&arguments)
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn succeed(output: Output) {
    assert!(output.status.success(), "{}", said(&output));
}

/// Files that depend on the physics only.
const BITS: [&str; 3] = ["thermo.csv", "trajectory.xyz", "dump.lammpstrj"];

/// A run has the same bytes for any number of threads and every execution.
#[test]
fn runs_do_not_depend_on_threads_or_execution() {
    let folder = tempfile::tempdir().unwrap();
    let with = |name: &str, more: &[&str]| -> PathBuf {
        let path = folder.path().join(name);
        let programs =
            ["--set", "run.steps=200", "--set", "machine.engine=programs", "--set", "search.by=lattice"];
        succeed(pipe(&path, &[&programs[..], more].concat()));
        path
    };
    let one = with("one", &["--threads", "1"]);
    for (name, more) in [
        ("three", &["--threads", "3"][..]),
        ("eager", &["--set", "machine.execution=\"eager\""]),
        ("strip", &["--set", "machine.execution=\"strip:100\""]),
        ("scalar", &["--set", "machine.instruction_set=\"scalar\""]),
        ("list", &["--set", "search.by=\"neighbor-list\""]),
    ] {
        let other = with(name, more);
        for file in ["thermo.csv", "trajectory.xyz"] {
            assert!(read(&one, file) == read(&other, file), "{file} differs with {name}");
        }
    }
}

/// A run with the fast engine has the same bytes for any number of threads, any instruction set, and after a resumption.
#[test]
fn fast_runs_keep_their_bits_and_resume() {
    let folder = tempfile::tempdir().unwrap();
    let with = |name: &str, more: &[&str]| -> PathBuf {
        let path = folder.path().join(name);
        let fast = [
            "--set",
            "machine.engine=fast",
            "--set",
            "search.by=lattice",
            "--set",
            "integrator.kind=velocity-verlet",
        ];
        succeed(pipe(&path, &[&fast[..], &["--set", "run.steps=400"], more].concat()));
        path
    };
    let one = with("one", &["--threads", "1"]);
    for (name, more) in
        [("three", &["--threads", "3"][..]), ("scalar", &["--set", "machine.instruction_set=\"scalar\""])]
    {
        let other = with(name, more);
        for file in ["thermo.csv", "trajectory.xyz"] {
            assert!(read(&one, file) == read(&other, file), "{file} differs with {name}");
        }
    }
}

/// An interrupted or terminated run writes a checkpoint, exits with 130, and resumes with the same bits.
#[cfg(unix)]
#[test]
fn interrupted_run_resumes() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, stopped) = (folder.path().join("whole"), folder.path().join("stopped"));
    let steps = ["--set", "run.steps=6000"];
    succeed(pipe(&whole, &steps));
    for (signal, existing) in [("-INT", None), ("-TERM", Some("--resume"))] {
        let mut arguments = vec!["run", "pipe-small", "--out", stopped.to_str().unwrap(), "--quiet"];
        arguments.extend(["--set", "run.thermo_every=50", "--set", "run.snapshot_every=100"]);
        arguments.extend(["--set", "run.checkpoint_every=200", "--set", "output.lammps_dump=true"]);
        arguments.extend(steps);
        arguments.extend(existing);
        let mut child = stripmine(&arguments).stderr(std::process::Stdio::piped()).spawn().unwrap();
        // The signal comes at a random moment after the start; whether or not it stops the run, the bits agree.
        while !stopped.join("thermo.csv").exists() {
            std::thread::yield_now();
        }
        std::thread::sleep(std::time::Duration::from_millis(150));
        Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        let code = child.wait().unwrap().code();
        assert!(code == Some(130) || code == Some(0), "{signal}: {code:?}");
        assert!(stopped.join("run.checkpoint").exists());
    }
    succeed(pipe(&stopped, &[&steps[..], &["--resume"]].concat()));
    for name in BITS {
        assert!(read(&whole, name) == read(&stopped, name), "{name} differs");
    }
}

/// A folder with a run is not changed unless asked; another scene is not resumed.
#[test]
fn folders_with_a_run_are_not_changed() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let steps = ["--set", "run.steps=20"];
    succeed(pipe(&run, &steps));
    let before = read(&run, "thermo.csv");
    let again = pipe(&run, &steps);
    assert_eq!((again.status.code(), said(&again).contains("--resume")), (Some(2), true), "{}", said(&again));
    // Refused before anything is computed, such as the forecast.
    let loud = output(&[&["run", "pipe-small", "--out", run.to_str().unwrap()][..], &steps].concat());
    assert!(loud.status.code() == Some(2) && !said(&loud).contains("expected"), "{}", said(&loud));
    let other = pipe(&run, &[&steps[..], &["--resume", "--set", "law.friction=0.3"]].concat());
    assert_eq!((other.status.code(), said(&other).contains("friction")), (Some(2), true), "{}", said(&other));
    assert!(read(&run, "thermo.csv") == before);
    succeed(pipe(&run, &[&steps[..], &["--overwrite"]].concat()));
    assert!(read(&run, "thermo.csv") == before);
}

/// A damaged checkpoint is refused with exit code 6; the older one is kept and can be used.
#[test]
fn corrupt_checkpoint_is_refused_and_older_kept() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let steps = ["--set", "run.steps=400"];
    succeed(pipe(&run, &steps));
    let newest = run.join("run.checkpoint");
    let whole = std::fs::read(&newest).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 4;
    for bytes in [&flipped[..], &whole[..whole.len() - 9], &[]] {
        std::fs::write(&newest, bytes).unwrap();
        let refused = pipe(&run, &[&steps[..], &["--resume"]].concat());
        assert_eq!(refused.status.code(), Some(6), "{}", said(&refused));
        assert!(said(&refused).contains("run.checkpoint"), "{}", said(&refused));
        assert!(run.join("run.checkpoint.previous").exists());
    }
    std::fs::rename(run.join("run.checkpoint.previous"), &newest).unwrap();
    succeed(pipe(&run, &[&steps[..], &["--resume"]].concat()));
}

/// The naive scale of the paper's numbers fails as the specification predicts, and the failure is named.
#[test]
fn pipe_as_printed_is_caught_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let failed = output(&["run", "pipe-as-printed", "--out", run.to_str().unwrap(), "--quiet"]);
    let words = said(&failed);
    assert_eq!(failed.status.code(), Some(4), "{words}");
    assert!(words.contains("step ") && words.contains("disc ") && words.contains("stiff"), "{words}");
    let summary: Value = serde_json::from_slice(&read(&run, "summary.json")).unwrap();
    let step = summary["steps"].as_u64().unwrap();
    assert!((650..2500).contains(&step), "{step}");
    let failure = &summary["failure"];
    assert!(failure["message"].as_str().unwrap().contains("overlap") && failure["kind"] == "too-deep");
    assert_eq!((&failure["when"]["steps"], &failure["count"]), (&summary["steps"], &Value::from(2)));
    assert!(summary["deep_disc_steps"].as_u64().unwrap() > 0);
    let frames = String::from_utf8(read(&run, "trajectory.xyz")).unwrap();
    assert!(frames.contains(&format!("step={step}")), "the state of the failing step is written");
}

/// Keys of `bench --json` that outside programs read.
#[test]
fn bench_prints_the_documented_keys() {
    let programs = &["predict", "index", "forces", "correct"][..];
    for (what, execution, integrator, phases) in [
        ("lattice", "fast", "velocity-verlet", &["correct_predict", "index", "forces"][..]),
        ("lattice", "fast", "gear5", &["correct_predict", "index", "forces"]),
        ("lattice", "chained", "velocity-verlet", programs),
        ("neighbor-list", "chained", "gear5", programs),
        ("neighbor-list", "fast", "gear5", &["correct_predict", "index", "forces"]),
        ("sectors", "fast", "gear6", &["correct_predict", "index", "forces"]),
    ] {
        let measured = output(&[
            "bench",
            what,
            if execution == "fast" { "--engine" } else { "--execution" },
            execution,
            "--integrator",
            integrator,
            "--particles",
            "300",
            "--packing-fraction",
            "0.6",
            "--steps",
            "20",
            "--repeats",
            "2",
            "--json",
        ]);
        assert!(measured.status.success(), "{}", said(&measured));
        let result: Value = serde_json::from_slice(&measured.stdout).unwrap();
        for key in [
            "what",
            "particles",
            "packing_fraction",
            "precision",
            "integrator",
            "execution",
            "friction",
            "cell_edge",
            "threads",
            "instruction_set",
            "repeats",
            "seconds",
            "cpu_seconds",
            "peak_memory_bytes",
            "temperature",
            "checksum",
            "particle_steps_per_second",
            "particle_steps_per_second_median",
            "phases",
        ] {
            let on_lattice = what == "lattice" || execution == "chained";
            let may_be_null = key == "peak_memory_bytes" || (key == "cell_edge" && !on_lattice);
            assert!(!result[key].is_null() || may_be_null, "{what}: {key}");
        }
        assert_eq!(result["phases"].as_object().unwrap().len(), phases.len());
        for phase in phases {
            assert!(result["phases"][phase].as_f64().unwrap() > 0.0, "{what}: {phase}");
        }
        let [start, end] = [0, 1].map(|i| result["temperature"][i].as_f64().unwrap());
        assert!(start > 0.005 && end > 0.005, "the gas must be warm: {start} {end}");
    }
}

/// No method writes checkpoints more often than the default wall-clock interval, unless its scene asks for it.
#[test]
fn default_checkpoints_follow_the_wall_clock() {
    for preset in METHODS.iter().flat_map(|method| method.vocabulary.presets) {
        let checkpoints = |more: &[String]| load(preset.name, more, METHODS).unwrap().0.schedule.checkpoints;
        let by_default = checkpoints(&[]);
        assert!(
            matches!(by_default, Every::Seconds(_)) || preset.name == "bench",
            "{}: {by_default:?}",
            preset.name
        );
        let given = checkpoints(&["run.checkpoint_every=7".to_owned()]);
        assert!(matches!(given, Every::Steps(7) | Every::Time(7.0)), "{}: {given:?}", preset.name);
    }
}

/// All seeds of a run use one scene, read once with its start file: both files may be removed while they run.
#[test]
fn seeds_use_the_scene_as_first_read() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let inside = |arguments: &[&str]| {
        let mut command = stripmine(arguments);
        command.current_dir(folder).args(["--quiet", "--threads", "1"]);
        command
    };
    let short = ["--set", "particles.count=20", "--set", "run.time=0.1", "--out", "first"];
    succeed(inside(&[&["run", "langevin-free"], &short[..]].concat()).output().unwrap());
    let preset = String::from_utf8(output(&["scene", "show", "langevin-free"]).stdout).unwrap();
    let mut text: toml::Table = preset.parse().unwrap();
    text.insert(
        "particles".to_owned(),
        toml::Table::from_iter([("file".to_owned(), "start.xyz".into())]).into(),
    );
    let write = || {
        std::fs::copy(folder.join("first/trajectory.xyz"), folder.join("start.xyz")).unwrap();
        std::fs::write(folder.join("scene.toml"), text.to_string()).unwrap();
    };
    let seeds = ["run", "scene.toml", "--set", "run.time=1000", "--seeds", "4", "--out"];
    write();
    succeed(inside(&[&seeds[..], &["whole"]].concat()).output().unwrap());
    let mut running = inside(&[&seeds[..], &["changed"]].concat()).spawn().unwrap();
    // One seed follows the other: the first has started.
    while !folder.join("changed/seed-1").exists() {
        assert!(running.try_wait().unwrap().is_none());
        std::thread::yield_now();
    }
    ["scene.toml", "start.xyz"].iter().for_each(|name| std::fs::remove_file(folder.join(name)).unwrap());
    succeed(running.wait_with_output().unwrap());
    for seed in 1..=4 {
        let name = format!("seed-{seed}/thermo.csv");
        assert_eq!(read(&folder.join("changed"), &name), read(&folder.join("whole"), &name), "{name}");
    }
}
