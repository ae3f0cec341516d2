//! Resumption of runs: the same run to the bit, or a refusal with its reason.

use assert_cmd::cargo::CommandCargoExt;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use stripmine_physics::io::checkpoint::{Checkpoint, CheckpointCounter};

fn stripmine(scene: &str, folder: &Path, more: &[&str]) -> Command {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.args(["run", scene, "--out", folder.to_str().unwrap()]);
    command.args(["--set", "run.thermo_every=5", "--set", "run.snapshot_every=30"]);
    command.args(["--set", "run.checkpoint_every=40", "--set", "output.lammps_dump=true"]);
    command.args(["--set", "output.dcd=true", "--set", "output.gsd=true"]).args(more);
    command
}

fn run(folder: &Path, steps: u64, more: &[&str]) -> Output {
    let steps = format!("run.steps={steps}");
    stripmine("two-discs", folder, &[&["--set", &steps], more].concat()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn succeed(output: &Output) {
    assert!(output.status.success(), "{}", said(output));
}

fn refused(output: &Output, code: i32, words: &[&str]) {
    assert_eq!(output.status.code(), Some(code), "{}", said(output));
    words.iter().for_each(|word| assert!(said(output).contains(word), "{word} is not in: {}", said(output)));
}

fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("summary.json")).unwrap()).unwrap()
}

fn notes(folder: &Path) -> Vec<String> {
    let summary = summary(folder);
    summary["notes"].as_array().unwrap().iter().map(|note| note.as_str().unwrap().to_owned()).collect()
}

/// Files that depend on the physics only.
const BITS: [&str; 5] =
    ["thermo.csv", "trajectory.xyz", "trajectory.dcd", "trajectory.gsd", "dump.lammpstrj"];

fn bits(folder: &Path) -> [Vec<u8>; 5] {
    BITS.map(|name| fs::read(folder.join(name)).unwrap())
}

/// A folder, and the files of an uninterrupted run of 100 steps.
fn folder_and_bits() -> (tempfile::TempDir, PathBuf, [Vec<u8>; 5]) {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole");
    succeed(&run(&whole, 100, &[]));
    let (bits, path) = (bits(&whole), folder.path().join("run"));
    (folder, path, bits)
}

/// The final state is a frame even if none is due, only once if one is, and is removed when the run resumes.
#[test]
fn final_state_is_written_once() {
    let folder = tempfile::tempdir().unwrap();
    let steps = |path: &Path| -> Vec<u64> {
        let text = fs::read_to_string(path.join("trajectory.xyz")).unwrap();
        let of = |line: &str| {
            line.split("step=").nth(1).map(|rest| rest.split(' ').next().unwrap().parse().unwrap())
        };
        let frames: Vec<u64> = text.lines().filter_map(of).collect();
        let dump = fs::read_to_string(path.join("dump.lammpstrj")).unwrap();
        let heads = dump.lines().zip(dump.lines().skip(1)).filter(|(head, _)| *head == "ITEM: TIMESTEP");
        assert_eq!(heads.map(|(_, step)| step.parse::<u64>().unwrap()).collect::<Vec<_>>(), frames);
        frames
    };
    let every = |every: &'static str| ["--set", every];
    for (last, snapshots, expected) in [
        (70, every("run.snapshot_every=30"), &[0, 30, 60, 70][..]),
        (60, every("run.snapshot_every=30"), &[0, 30, 60]),
        (70, every("run.snapshot_every=0"), &[0, 70]),
    ] {
        let path = folder.path().join(format!("{last}{}", expected.len()));
        succeed(&run(&path, last, &snapshots));
        assert_eq!(steps(&path), expected);
        let before = bits(&path);
        // Complete: nothing changes. With more steps: the last frame is removed again if none is due.
        succeed(&run(&path, last, &[&snapshots[..], &["--resume"]].concat()));
        assert!(bits(&path) == before);
        succeed(&run(&path, 90, &[&snapshots[..], &["--resume"]].concat()));
        let whole = folder.path().join("whole");
        succeed(&run(&whole, 90, &[&snapshots[..], &["--overwrite"]].concat()));
        assert!(bits(&path) == bits(&whole));
    }
    // Frames at other steps from now on: none occurs twice.
    let path = folder.path().join("changed");
    succeed(&run(&path, 60, &[]));
    succeed(&run(&path, 60, &["--resume", "--set", "run.snapshot_every=0"]));
    assert_eq!(steps(&path), [0, 30, 60]);
}

/// A start file with other masses makes another run.
#[test]
fn start_file_contents_belong_to_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, start, out) =
        (folder.path().join("s.toml"), folder.path().join("two.xyz"), folder.path().join("run"));
    let discs = |mass: &str| {
        format!(
            "2\nLattice=\"10.0 0.0 0.0 0.0 8.0 0.0 0.0 0.0 1.0\" Origin=\"0.0 0.0 -0.5\" pbc=\"T T F\" \
             Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3 Time=0.0 step=0\n\
             Si 2.0 5.0 0.0 1 1.0 0.0 0.0 0.5 {mass} 0.0 0.0 0.0\nSi 5.0 5.0 0.0 2 0.0 0.0 0.0 0.5 1.0 0.0 0.0 0.25\n"
        )
    };
    fs::write(&start, discs("1.0")).unwrap();
    fs::write(
        &scene,
        "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"reduced\"\n[domain]\nsides = [10.0, 8.0]\n[particles]\nfile = \"two.xyz\"\n[law]\n\
         stiffness = 187.0\n[integrator]\ndt = 0.005\n[run]\nsteps = 50\n",
    )
    .unwrap();
    let go = |more: &[&str]| stripmine(scene.to_str().unwrap(), &out, more).output().unwrap();
    succeed(&go(&[]));
    let before = bits(&out);
    let longer = ["--resume", "--set", "run.steps=80"];
    fs::write(&start, discs("1.5")).unwrap();
    refused(&go(&longer), 2, &["two.xyz", "other discs"]);
    assert!(bits(&out) == before);
    fs::write(&start, discs("1.00")).unwrap();
    succeed(&go(&longer));
}

/// Changes a checkpoint's statement about its program.
fn forge(folder: &Path, change: impl FnOnce(&mut Checkpoint)) {
    let path = folder.join("run.checkpoint");
    let mut checkpoint = Checkpoint::read(&path).unwrap();
    change(&mut checkpoint);
    checkpoint.write_atomically(&path).unwrap();
}

/// A version that promises the same bits resumes with a note; any other is refused unless allowed.
#[test]
fn other_versions_are_noted_or_refused() {
    let (_folder, path, whole) = folder_and_bits();
    succeed(&run(&path, 60, &[]));
    forge(&path, |checkpoint| drop(checkpoint.origin.insert("commit".to_owned(), "0123456789ab".to_owned())));
    let output = run(&path, 80, &["--resume"]);
    succeed(&output);
    assert!(said(&output).contains("warning: resumed at step 60") && said(&output).contains("0123456789ab"));
    assert!(notes(&path).len() == 1 && notes(&path)[0].contains("0123456789ab"), "{:?}", notes(&path));
    forge(&path, |checkpoint| {
        checkpoint.counters.insert("bits".to_owned(), CheckpointCounter::Count(99));
    });
    let before = bits(&path);
    refused(&run(&path, 100, &["--resume"]), 2, &["--other-version", "bits"]);
    assert!(bits(&path) == before);
    succeed(&run(&path, 100, &["--resume", "--other-version"]));
    // Notes of an earlier session are kept.
    assert!(notes(&path).len() == 2 && notes(&path)[1].contains("does not promise"), "{:?}", notes(&path));
    assert!(bits(&path) == whole);
}

/// Fewer steps than are already done.
#[test]
fn resuming_to_fewer_steps_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    succeed(&run(&path, 60, &[]));
    let before = (bits(&path), summary(&path));
    refused(&run(&path, 50, &["--resume"]), 2, &["run.steps=60", "beyond the run.steps=50 asked for"]);
    assert!((bits(&path), summary(&path)) == before);
}

/// Rows and frames before the checkpoint that are missing or changed: exit code 6, and the files are not changed.
#[test]
fn damaged_files_are_refused() {
    let (_folder, path, whole) = folder_and_bits();
    succeed(&run(&path, 60, &[]));
    for name in BITS {
        let file = path.join(name);
        let kept = fs::read(&file).unwrap();
        let mut flipped = kept.clone();
        // A byte of the last frame or row: the middle of a short GSD file is unused index, which is cleared on resumption.
        flipped[kept.len() - 20] ^= 1;
        let first_line = kept.iter().position(|&byte| byte == b'\n').unwrap() + 1;
        for (damaged, words) in
            [(&flipped[..], "has changed"), (&kept[..first_line], "bytes, but"), (&[], "has 0 bytes, but")]
        {
            fs::write(&file, damaged).unwrap();
            refused(&run(&path, 100, &["--resume"]), 6, &[name, words]);
            assert_eq!(fs::read(&file).unwrap(), damaged);
        }
        fs::remove_file(&file).unwrap();
        refused(&run(&path, 100, &["--resume"]), 6, &[name, "is missing"]);
        fs::write(&file, kept).unwrap();
    }
    succeed(&run(&path, 100, &["--resume"]));
    assert!(bits(&path) == whole);
}

/// Data after the checkpoint may be torn anywhere, also within the first words of a dump's frame.
#[test]
fn torn_data_after_the_checkpoint_are_repaired() {
    let (_folder, path, whole) = folder_and_bits();
    succeed(&run(&path, 80, &[]));
    let kept = bits(&path);
    let words = b"ITEM: TIMESTEP\n80\nITEM: NUMBER";
    for torn in 0..words.len() {
        for (name, bytes) in BITS.iter().zip(&kept) {
            fs::write(path.join(name), [&bytes[..], &words[..torn]].concat()).unwrap();
        }
        succeed(&run(&path, 80, &["--resume"]));
        assert!(bits(&path) == kept);
    }
    succeed(&run(&path, 100, &["--resume"]));
    assert!(bits(&path) == whole);
}

/// The older checkpoint is used if the newest is missing; this is reported at once and at the end.
#[test]
fn fallback_to_the_older_checkpoint_is_reported() {
    let (_folder, path, whole) = folder_and_bits();
    succeed(&run(&path, 60, &[]));
    fs::remove_file(path.join("run.checkpoint")).unwrap();
    let output = run(&path, 100, &["--resume"]);
    succeed(&output);
    assert!(said(&output).contains("warning: ") && said(&output).contains("older checkpoint, of step 40"));
    assert!(notes(&path).len() == 1 && notes(&path)[0].contains("older checkpoint"), "{:?}", notes(&path));
    assert!(bits(&path) == whole);
}

/// `--resume` starts a run in an empty folder, and starts again if there is no checkpoint yet; another scene is still refused.
#[test]
fn resuming_without_a_checkpoint_starts_the_run() {
    let (_folder, path, whole) = folder_and_bits();
    succeed(&run(&path, 100, &["--resume"]));
    assert!(bits(&path) == whole && notes(&path).is_empty());
    for name in ["run.checkpoint", "run.checkpoint.previous", "summary.json"] {
        fs::remove_file(path.join(name)).unwrap();
    }
    refused(&run(&path, 100, &["--resume", "--set", "law.friction=0.3"]), 2, &["friction"]);
    assert!(bits(&path) == whole);
    let output = run(&path, 100, &["--resume"]);
    succeed(&output);
    assert!(said(&output).contains("started again") && bits(&path) == whole);
    fs::remove_dir_all(&path).unwrap();
    fs::create_dir(&path).unwrap();
    succeed(&run(&path, 100, &["--resume"]));
    assert!(bits(&path) == whole);
}

/// Files removed by others during a run are noticed at the next checkpoint, not only at the end.
#[cfg(unix)]
#[test]
fn files_removed_during_a_run_are_noticed() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["thermo.csv", "trajectory.xyz", "dump.lammpstrj", "scene.toml", "run.files", "run.lock"] {
        let path = folder.path().join(name);
        let mut command = stripmine("two-discs", &path, &["--set", "run.steps=1000000000", "--quiet"]);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        while !path.join("run.checkpoint").exists() {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        fs::remove_file(path.join(name)).unwrap();
        refused(&child.wait_with_output().unwrap(), 5, &[name, "removed"]);
    }
}

/// Choices made at the start of a run are kept, even if another choice would be made now.
#[test]
fn choices_are_kept_on_resumption() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    succeed(&run(&path, 20, &["--set", "search.by=sectors", "--set", "machine.engine=fast"]));
    succeed(&run(&path, 40, &["--resume", "--set", "search.by=auto", "--set", "machine.engine=auto"]));
    let scene = std::fs::read_to_string(path.join("scene.toml")).unwrap();
    assert!(scene.contains("by = \"sectors\"") && scene.contains("engine = \"fast\""), "{scene}");
}

/// Writes a start file of nine particles on a grid, and a scene of a bath that uses it.
fn write_start(folder: &Path) {
    let row =
        |id: usize| format!("Si {} {} 0 {id} 0.5 0.25 0 0.5 1 0 0 0\n", 3 * (id % 3) + 1, 3 * (id / 3) + 1);
    let rows: String = (0..9).map(row).collect();
    let columns = "species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";
    let start = format!("9\nLattice=\"9 0 0 0 9 0 0 0 1\" pbc=\"T T F\" Properties={columns}\n{rows}");
    let scene = "format = 2\nunits = \"reduced\"\n[method]\nkind = \"langevin\"\n[domain]\nsides = [9.0, 9.0]\n\
                 [particles]\nfile = \"start.xyz\"\n[law]\nkind = \"none\"\ndrag = 1.0\nbath_temperature = 1.0\n\
                 [integrator]\ndt = 0.01\n[run]\nsteps = 40\nthermo_every = 5\n";
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join("start.xyz"), start).unwrap();
    fs::write(folder.join("scene.toml"), scene).unwrap();
}

/// A folder moved together with its start file resumes: the file is identified by its contents.
#[test]
fn runs_can_be_moved_with_their_start_file() {
    let folder = tempfile::tempdir().unwrap();
    let [scratch, home, copy] = ["scratch", "home", "copy"].map(|name| folder.path().join(name));
    let stripmine = |at: &Path, arguments: &[&str]| {
        Command::cargo_bin("stripmine")
            .unwrap()
            .current_dir(at)
            .args(arguments)
            .arg("--quiet")
            .output()
            .unwrap()
    };
    let goes_on = ["run", "scene.toml", "--resume", "--set", "run.steps=80"];
    let seeded = ["--set", "law.noise_seed=2"];
    for at in [&scratch, &copy] {
        write_start(at);
    }
    succeed(&stripmine(&scratch, &["run", "scene.toml"]));
    // The reference is a run that was never moved.
    succeed(&stripmine(&scratch, &["run", "scene.toml", "--set", "run.steps=80", "--out", "whole.run"]));
    fs::rename(&scratch, &home).unwrap();
    succeed(&stripmine(&home, &goes_on));
    let table = |folder: &Path| fs::read(folder.join("thermo.csv")).unwrap();
    assert!(table(&home.join("scene.run")) == table(&home.join("whole.run")));
    let written = fs::read_to_string(home.join("scene.run/scene.toml")).unwrap();
    assert!(written.contains("file = \"../start.xyz\"\n# discs of this file: SHA-256 "), "{written}");
    // The scene written by the run can be started from, too.
    fs::remove_dir_all(home.join("whole.run")).unwrap();
    succeed(&stripmine(&home, &["run", "scene.run/scene.toml", "--out", "again.run"]));
    assert!(table(&home.join("again.run")) == table(&home.join("scene.run")));
    succeed(&stripmine(
        &home,
        &["run", "scene.run/scene.toml", "--out", "again.run", "--resume", "--set", "run.steps=90"],
    ));
    // Runs from copies of one file can be joined; runs from another file cannot.
    succeed(&stripmine(&copy, &["run", "scene.toml", "--set", "law.noise_seed=2", "--set", "run.steps=80"]));
    succeed(&stripmine(folder.path(), &["average", "home/scene.run", "copy/scene.run"]));
    let start = fs::read_to_string(copy.join("start.xyz")).unwrap().replace("0.25", "0.125");
    fs::write(copy.join("start.xyz"), &start).unwrap();
    refused(
        &stripmine(&copy, &[&goes_on[..], &seeded].concat()),
        2,
        &["other discs", "copy/start.xyz", "restore the start"],
    );
    succeed(&stripmine(&copy, &["run", "scene.toml", "--set", "law.noise_seed=2", "--overwrite"]));
    refused(
        &stripmine(folder.path(), &["average", "home/scene.run", "copy/scene.run"]),
        2,
        &["have different scenes", "# discs of this file"],
    );
    // The path of a start file far from its run is absolute.
    let far = folder.path().join("far/away/from/it");
    fs::create_dir_all(&far).unwrap();
    let out = far.join("scene.run");
    succeed(&stripmine(&home, &["run", "scene.toml", "--out", out.to_str().unwrap()]));
    let written = fs::read_to_string(out.join("scene.toml")).unwrap();
    assert!(written.contains("/home/start.xyz\"\n# discs"), "{written}");
    // A start without a checkpoint is also checked against the contents.
    fs::remove_file(copy.join("scene.run/run.checkpoint")).unwrap();
    drop(fs::remove_file(copy.join("scene.run/run.checkpoint.previous")));
    fs::write(copy.join("start.xyz"), start.replace("0.125", "0.25")).unwrap();
    refused(&stripmine(&copy, &[&goes_on[..], &seeded].concat()), 2, &["# discs of this file"]);
}
