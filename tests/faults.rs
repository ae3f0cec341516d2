//! Kills and faults at random moments, in the long suite: a run that is resumed afterwards gives the bits of an undisturbed run,
//! or is refused with a documented exit code.
//!
//! `STRIPMINE_KILLS` and `STRIPMINE_FAULTS` set their numbers (1000 each), `STRIPMINE_SEED` their seed (1).
#![cfg(unix)]

use assert_cmd::cargo::CommandCargoExt;
use rand::RngExt;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;
use stripmine_kernels::noise::{RandomPurpose, Stream};

/// Small scenes of every method with its own kind of state.
const SCENES: [&[&str]; 4] = [
    &["two-discs", "--set", "machine.execution=chained"],
    &["two-discs", "--set", "search.by=neighbor-list", "--set", "machine.execution=chained"],
    &["pipe-small", "--set", "machine.engine=fast", "--set", "search.by=lattice"],
    &["pipe-small", "--set", "search.by=neighbor-list", "--set", "machine.engine=fast"],
];

/// Files that depend on the physics only.
const BITS: [&str; 3] = ["thermo.csv", "trajectory.xyz", "dump.lammpstrj"];

/// Documented exit codes.
const CONTRACT: [i32; 7] = [0, 2, 3, 4, 5, 6, 130];

fn from_environment(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

struct Random(Stream);

impl Random {
    fn new(of: u32) -> Random {
        Random(Stream::new(from_environment("STRIPMINE_SEED", 1), RandomPurpose::Test, of))
    }

    fn below(&mut self, limit: usize) -> usize {
        self.0.random_range(0..limit)
    }
}

/// Arguments of a run that starts or resumes.
fn arguments(scene: usize, folder: &Path) -> Vec<String> {
    let steps = if SCENES[scene][0] == "two-discs" { "run.steps=1500" } else { "run.steps=150" };
    let common = ["--set", steps, "--set", "run.thermo_every=10", "--set", "run.snapshot_every=40"];
    let more =
        ["--set", "run.checkpoint_every=25", "--set", "output.lammps_dump=true", "--quiet", "--resume"];
    let all =
        ["run"].iter().chain(SCENES[scene]).chain(&common).chain(&more).chain(&["--threads", "1", "--out"]);
    all.map(|text| (*text).to_owned()).chain([folder.to_str().unwrap().to_owned()]).collect()
}

fn stripmine(scene: usize, folder: &Path) -> Command {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.args(arguments(scene, folder)).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn bits(folder: &Path) -> [Vec<u8>; 3] {
    BITS.map(|name| fs::read(folder.join(name)).unwrap())
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Files of undisturbed runs.
fn whole(folder: &Path) -> Vec<[Vec<u8>; 3]> {
    let one = |scene| {
        let path = folder.join(format!("whole{scene}"));
        let output = stripmine(scene, &path).output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
        bits(&path)
    };
    (0..SCENES.len()).map(one).collect()
}

/// A run that is killed at random moments and resumed until it is complete leaves the bits of an undisturbed one.
#[test]
#[ignore = "long: cargo test --release --test faults -- --ignored"]
fn kills_change_no_bit() {
    let kills = from_environment("STRIPMINE_KILLS", 1000);
    let folder = tempfile::tempdir().unwrap();
    let whole = whole(folder.path());
    let mut random = Random::new(1);
    let (mut killed, mut runs, mut sessions) = (0, 0, 0);
    while killed < kills {
        let scene = runs as usize % SCENES.len();
        let path = folder.path().join("run");
        loop {
            sessions += 1;
            let mut child = stripmine(scene, &path).spawn().unwrap();
            std::thread::sleep(Duration::from_micros(random.below(250_000) as u64));
            let _ = child.kill();
            let output = child.wait_with_output().unwrap();
            match output.status.code() {
                None => killed += 1,
                Some(0) => break,
                Some(code) => panic!("{scene}: exit {code} after {killed} kills: {}", said(&output)),
            }
            if killed >= kills {
                let output = stripmine(scene, &path).output().unwrap();
                assert!(output.status.success(), "{}", said(&output));
                break;
            }
        }
        runs += 1;
        assert!(bits(&path) == whole[scene], "{scene}: other bits after {killed} kills");
        fs::remove_dir_all(path).unwrap();
    }
    println!("{killed} kills in {sessions} sessions of {runs} runs");
}

/// Builds the library that makes calls fail.
fn shim(folder: &Path) -> PathBuf {
    let library = folder.join("shim.so");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults/shim.c");
    let built = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-o"])
        .args([&library, &source])
        .arg("-ldl")
        .status();
    assert!(built.unwrap().success());
    library
}

/// Runs a session with one random fault; returns the fault's name and the session's output.
fn spoilt(scene: usize, path: &Path, shim: &Path, random: &mut Random) -> (String, Output) {
    const ERRORS: [&str; 5] = ["0", "5", "13", "28", "122"];
    match random.below(4) {
        0 => {
            let blocks = random.below(60);
            let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
            let program = Command::cargo_bin("stripmine").unwrap().get_program().to_owned();
            let output =
                Command::new("sh").args(["-c", &limited]).arg(program).args(arguments(scene, path)).output();
            (format!("ulimit -f {blocks}"), output.unwrap())
        }
        1 if path.join("run.files").exists() => {
            let list = fs::read_to_string(path.join("run.files")).unwrap();
            let names: Vec<&str> = list.lines().skip(1).filter(|name| path.join(name).exists()).collect();
            let file = path.join(names[random.below(names.len())]);
            let mut bytes = fs::read(&file).unwrap();
            let name = match random.below(3) {
                0 => {
                    fs::remove_file(&file).unwrap();
                    "removed"
                }
                1 => {
                    bytes.truncate(random.below(bytes.len() + 1));
                    fs::write(&file, bytes).unwrap();
                    "cut"
                }
                _ => {
                    if !bytes.is_empty() {
                        let place = random.below(bytes.len());
                        bytes[place] ^= 1 << random.below(8);
                    }
                    fs::write(&file, bytes).unwrap();
                    "a bit flipped"
                }
            };
            (format!("{}: {name}", file.display()), stripmine(scene, path).output().unwrap())
        }
        _ => {
            let (at, error) = (1 + random.below(400), ERRORS[random.below(ERRORS.len())]);
            let mut command = stripmine(scene, path);
            command.env("LD_PRELOAD", shim).env("FAULT_AT", at.to_string()).env("FAULT_ERROR", error);
            let sticks = random.below(2) == 0;
            if sticks {
                command.env("FAULT_STICKS", "1");
            }
            (format!("call {at} fails with error {error}, sticks: {sticks}"), command.output().unwrap())
        }
    }
}

/// Faults of any kind end with a documented exit code. A run that can be resumed gives the same bits; only files damaged from outside
/// prevent this.
#[test]
#[ignore = "long: cargo test --release --test faults -- --ignored"]
fn faults_lose_nothing() {
    let faults = from_environment("STRIPMINE_FAULTS", 1000);
    let folder = tempfile::tempdir().unwrap();
    let (whole, shim) = (whole(folder.path()), shim(folder.path()));
    let mut random = Random::new(2);
    let mut exits = std::collections::BTreeMap::new();
    let path = folder.path().join("run");
    let mut scene = 0;
    for fault in 0..faults {
        let (name, output) = spoilt(scene, &path, &shim, &mut random);
        let about = format!("fault {fault}, scene {scene}, {name}");
        let code =
            output.status.code().unwrap_or_else(|| panic!("{about}: {}: {}", output.status, said(&output)));
        assert!(CONTRACT.contains(&code), "{about}: exit {code}: {}", said(&output));
        assert!(code == 0 || said(&output).starts_with("error: "), "{about}: {}", said(&output));
        *exits.entry(code).or_insert(0) += 1;
        if code == 0 {
            assert!(bits(&path) == whole[scene], "{about}: exit 0 with other bits");
        }
        let damaged = name.starts_with(path.to_str().unwrap());
        // Some faults follow each other before an undisturbed session.
        if !damaged && random.below(2) == 0 && code != 0 {
            continue;
        }
        let output = stripmine(scene, &path).output().unwrap();
        let refused = damaged && [Some(2), Some(6)].contains(&output.status.code());
        assert!(output.status.success() || refused, "{about}, then: {}", said(&output));
        assert!(refused || bits(&path) == whole[scene], "{about}: other bits");
        let _ = fs::remove_dir_all(&path);
        scene = (scene + 1) % SCENES.len();
    }
    println!("{faults} faults, exits: {exits:?}");
}
