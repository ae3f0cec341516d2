//! The memory that a run takes is what the check said it would take.
#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::{Command, Stdio};

/// The most memory that a process had at one time (bytes), once it has ended well.
#[expect(clippy::zombie_processes, reason = "it is waited for below, by what says how much it took")]
fn peak(arguments: &[String]) -> u64 {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    let child = command.args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let (mut status, mut usage) = (0, std::mem::MaybeUninit::<libc::rusage>::zeroed());
    // SAFETY: both are there to be written, and zeros are an `rusage`.
    let (ended, usage) = unsafe {
        let ended = libc::wait4(child.id() as libc::pid_t, &raw mut status, 0, usage.as_mut_ptr());
        (ended, usage.assume_init())
    };
    assert!(ended > 0 && status == 0, "{arguments:?} ends with {status}");
    usage.ru_maxrss as u64 * 1024
}

/// For the six ways of a hundred thousand discs: at most 5 % more than foreseen, and at most 10 % less.
/// Less is room for the thread that writes frames: whether it still holds one frame when the next is made
/// depends on the moment, and what is foreseen counts both. A frame of a hundred thousand particles is 10 MB, 7 % of the largest.
#[test]
fn a_run_takes_the_memory_that_was_foreseen() {
    let folder = tempfile::tempdir().unwrap();
    let mut said = Vec::new();
    for sets in [
        &["machine.engine=fast", "search.by=lattice", "particles.packing_fraction=0.7"][..],
        &["machine.engine=fast", "search.by=lattice", "particles.packing_fraction=0.05"],
        &["machine.execution=chained"],
        &["search.by=neighbor-list", "machine.engine=fast"],
        &["search.by=neighbor-list", "machine.execution=chained"],
        &["search.by=sectors", "machine.engine=fast"],
    ] {
        let sets: Vec<String> =
            sets.iter().chain(&["particles.count=100000", "run.steps=1"]).map(|&set| set.into()).collect();
        // Not asked in this process: what it holds counts in the memory of its children while they begin.
        let mut check = vec!["scene".to_owned(), "check".to_owned(), "bench".to_owned(), "--json".to_owned()];
        sets.iter().for_each(|set| check.extend(["--set".to_owned(), set.clone()]));
        let checked = Command::new(env!("CARGO_BIN_EXE_stripmine")).args(check).output().unwrap();
        let checked: serde_json::Value = serde_json::from_slice(&checked.stdout).unwrap();
        let needed = checked["memory"]["needed"].as_u64().unwrap();
        let mut arguments =
            ["run", "bench", "--overwrite", "--threads", "2", "--out"].map(str::to_owned).to_vec();
        arguments.push(folder.path().join("run").display().to_string());
        sets.iter().for_each(|set| arguments.extend(["--set".to_owned(), set.clone()]));
        let taken = peak(&arguments);
        said.push((
            needed as f64 / taken as f64 - 1.0,
            format!("{sets:?}: {needed} foreseen, {taken} taken"),
        ));
    }
    let off: Vec<&String> =
        said.iter().filter(|(off, _)| !(-0.05..=0.10).contains(off)).map(|(_, said)| said).collect();
    assert!(off.is_empty(), "{off:#?} of {said:#?}");
}

/// Particles in a bath by every search, at the start and gone on with: within the same bounds.
#[test]
fn particles_in_a_bath_take_the_memory_that_was_foreseen() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run").display().to_string();
    for by in ["neighbor-list", "sectors", "lattice"] {
        let by = format!("search.by={by}");
        let sets = ["particles.count=100000", "domain.sides=[160, 160]", &by];
        let sets = sets.map(|set| ["--set".to_owned(), set.to_owned()]).concat();
        let mut check = Command::new(env!("CARGO_BIN_EXE_stripmine"));
        check.args(["scene", "check", "langevin-report", "--json"]).args(&sets);
        let checked: serde_json::Value = serde_json::from_slice(&check.output().unwrap().stdout).unwrap();
        let needed = checked["memory"]["needed"].as_u64().unwrap();
        for (steps, how) in [(1, "--overwrite"), (2, "--resume")] {
            let fixed = ["run", "langevin-report", how, "--threads", "2", "--out", &out];
            let mut arguments = fixed.map(str::to_owned).to_vec();
            arguments.extend(sets.clone());
            arguments.extend(["--set".to_owned(), format!("run.steps={steps}")]);
            let taken = peak(&arguments);
            let off = needed as f64 / taken as f64 - 1.0;
            assert!((-0.05..=0.10).contains(&off), "{by} {how}: {needed} foreseen, {taken} taken");
        }
    }
}

/// A start takes memory for its particles, not for the box: of two milliard places of a mesh a thousand are drawn.
#[test]
fn an_empty_box_takes_no_memory() {
    let check = ["scene", "check", "langevin-free", "--set", "domain.sides=[4600, 4600]"].map(str::to_owned);
    let taken = peak(&check);
    assert!(taken < 64_000_000, "{taken} bytes");
}

/// Under a limit of the address space or of the data a run is refused, with the limit in words, or comes to its end: it is not
/// aborted in its midst, whatever the limit.
#[test]
fn limits_of_the_process_are_asked() {
    let folder = tempfile::tempdir().unwrap();
    let under = |limit: &str, scene: &str, sets: &[&str]| {
        let mut command = Command::new("sh");
        let out = folder.path().join("run");
        let script = format!("ulimit {limit} && exec \"$0\" \"$@\"");
        command.args([
            "-c",
            &script,
            env!("CARGO_BIN_EXE_stripmine"),
            "run",
            scene,
            "--overwrite",
            "--threads",
            "2",
        ]);
        command.args(["--out", out.to_str().unwrap(), "--set", "run.snapshot_every=0"]);
        sets.iter().for_each(|set| _ = command.args(["--set", set]));
        let output = command.stdin(Stdio::null()).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let langevin = ["particles.count=300000", "domain.sides=[300, 300]", "run.steps=1"];
    let scenes: [(&str, &[&str]); 3] = [
        ("langevin-report", &langevin),
        ("bench", &["particles.count=200000", "run.steps=1"]),
        ("hard-disks", &["particles.count=200000", "run.events=10", "run.snapshot_every=0"]),
    ];
    for (scene, sets) in scenes {
        for (limit, name) in [("-v", "the address space (ulimit -v)"), ("-d", "of a process (ulimit -d)")] {
            let mut codes = vec![];
            for mebibytes in [300, 4000] {
                let (code, said) = under(&format!("{limit} {}", mebibytes * 1024), scene, sets);
                assert!(matches!(code, Some(0 | 3)), "{scene} {limit} {mebibytes}: {code:?} {said}");
                assert!(code == Some(0) || said.contains(name), "{scene} {limit} {mebibytes}: {said}");
                codes.push(code);
            }
            assert_eq!(codes.last(), Some(&Some(0)), "{scene} {limit}");
        }
        let (code, said) = under("-v 204800", scene, sets);
        assert!(code == Some(3) && said.contains(" left"), "{scene}: {code:?} {said}");
    }
}

/// Bytes of the process while it refuses: a tenth of a gigabyte is far below what it was asked for.
#[test]
fn what_does_not_fit_is_refused_before_it_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let gas = "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"reduced\"\n[domain]\nsides = [SIDE, SIDE]\n[particles]\ngenerate = \"random\"\ncount = COUNT\n\
               radius = 0.5\nmass = 1.0\n[law]\nstiffness = 187.0\n[integrator]\ndt = 0.005\n[run]\nsteps = 1\n[machine]\nengine = \"programs\"\n";
    for (side, count, words) in [
        // Two billion discs; and two discs in two billion cells.
        ("1e5", "2e9", "to place 2e9 discs takes"),
        ("3e4", "2", "a run of 2 discs in"),
    ] {
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, gas.replace("SIDE", side).replace("COUNT", count)).unwrap();
        let said = refused(&["scene", "check"], &path);
        assert!(said.contains(words) && said.contains(" left"), "{said}");
        let said = refused(&["run"], &path);
        assert!(said.contains(words), "{said}");
    }
}

fn refused(verb: &[&str], scene: &Path) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    let output = command.args(verb).arg(scene).current_dir(scene.parent().unwrap()).output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}
