//! Every verb with requests that it cannot carry out: the documented exit code, a message on standard error, and, with `--json`, the failure as one
//! document on standard output.

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;
use std::process::Output;

fn stripmine(folder: &Path, arguments: &[&str]) -> Output {
    Command::cargo_bin("stripmine").unwrap().current_dir(folder).args(arguments).output().unwrap()
}

/// Fills the folder of the cases: files that are not valid text, and a file where a folder should be.
fn prepare(folder: &Path) {
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).unwrap();
    write("file", b"mine");
    write("latin.toml", b"format = 2\nmethod.kind = \"lattice-md\"\nunits = \"\xe9\"\n");
    let columns = "species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";
    let head = format!("1\nProperties={columns} Lattice=\"9 0 0 0 9 0 0 0 1\" pbc=\"F F F\"\nAr 1 ");
    write("frame.xyz", &[head.as_bytes(), b"\xff 0 1 0 0 0 0.5 1 0 0 0\n"].concat());
    let scene = String::from_utf8(stripmine(folder, &["scene", "show", "two-discs"]).stdout).unwrap();
    write("scene.toml", scene.replace("format = 2", "format = 99").as_bytes());
}

/// Arguments, exit code, kind of the failure as data, and words of the message.
const CASES: &[(&[&str], i32, &str, &[&str])] = &[
    (&["nonsense"], 2, "usage", &["nonsense"]),
    (&["table", "extra"], 2, "usage", &["--host"]),
    (&["table", "--threads", "0"], 2, "usage", &["--threads", "0"]),
    (&["table", "--particles", "0"], 2, "usage", &["at least one"]),
    (&["table", "--particles", "-3"], 2, "usage", &["-3"]),
    (&["table", "--occupancy", "2"], 2, "usage", &["occupancy", "2"]),
    (&["table", "--particles", "0", "--occupancy", "2"], 2, "usage", &["at least one"]),
    (&["table", "--gear-values", "3"], 2, "usage", &["4..=6"]),
    (&["table", "--mask", "6"], 2, "usage", &["5, 7"]),
    (&["table", "--machine", "cray-9"], 2, "usage", &["cray-9", "cray-1"]),
    (&["table", "--machine", "none.toml"], 5, "input-output", &["none.toml"]),
    (&["table", "--machine", "latin.toml"], 3, "input", &["latin.toml", "UTF-8"]),
    (&["table", "--ladder", "--machine", "scene.toml"], 3, "input", &["scene.toml"]),
    (&["validate-model", "--host", "."], 5, "input-output", &["folder"]),
    (&["validate-model", "--host", "scene.toml"], 3, "input", &["scene.toml"]),
    (&["listing"], 2, "usage", &["PART"]),
    (&["listing", "foces"], 2, "usage", &["forces"]),
    (&["listing", "forces", "--particles", "3"], 2, "usage", &["at least 5"]),
    (&["scene"], 2, "usage", &["check"]),
    (&["scene", "show", "three-discs"], 2, "usage", &["two-discs"]),
    (&["scene", "check"], 2, "usage", &["SCENE"]),
    (&["scene", "check", "none.toml"], 3, "input", &["none.toml"]),
    (&["scene", "check", "latin.toml"], 3, "input", &["latin.toml:3:", "UTF-8"]),
    (&["scene", "check", "scene.toml"], 3, "input", &["scene.toml:", "99"]),
    (&["scene", "check", "pipe", "--set", "law.friction=-1"], 3, "input", &["friction", "-1"]),
    (&["scene", "check", "pipe", "--set", "nothing"], 3, "input", &["nothing"]),
    (&["scene", "check", "two-discs", "--set", "particles.file=\"frame.xyz\""], 3, "input", &["frame.xyz:3"]),
    (&["run"], 2, "usage", &["SCENE"]),
    (&["run", "none.toml"], 3, "input", &["none.toml"]),
    (&["run", "two-discs", "--resume", "--overwrite"], 2, "usage", &["--overwrite"]),
    (&["run", "two-discs", "--out", "file"], 5, "input-output", &["file"]),
    (&["run", "two-discs", "--out", "file/below"], 5, "input-output", &["file/below"]),
    (&["run", "two-discs", "--set", "law.friction=-1"], 3, "input", &["friction"]),
    (
        &["run", "two-discs", "--out", "deep", "--set", "law.stiffness=1e-3"],
        4,
        "precondition",
        &["overlap", "deep/trajectory.xyz"],
    ),
    (&["scan"], 2, "usage", &["SCENE"]),
    (&["scan", "two-discs"], 2, "usage", &["--over"]),
    (
        &["scan", "two-discs", "--over", "law.stiffness=1:2"],
        2,
        "usage",
        &["--over law.stiffness=1:2", "no range"],
    ),
    (&["scan", "two-discs", "--over", "law.stiffnes=1,2"], 3, "input", &["stiffnes", "law.stiffness"]),
    (
        &["scan", "two-discs", "--over", "law.stiffness=1e4", "--seeds", "1e12"],
        2,
        "usage",
        &["1e12", "100000"],
    ),
    (&["scan", "two-discs", "--over", "law.stiffness=1e4", "--out", "file"], 5, "input-output", &["file"]),
    (&["bench"], 2, "usage", &["WHAT"]),
    (&["bench", "disks"], 2, "usage", &["lattice"]),
    (&["bench", "lattice", "--steps", "0"], 2, "usage", &["--steps", "0"]),
    (&["bench", "lattice", "--repeats", "0"], 2, "usage", &["--repeats", "0"]),
    (&["bench", "lattice", "--particles", "0"], 2, "usage", &["'0' for '--particles", "1e6"]),
    (&["bench", "lattice", "--packing-fraction", "2"], 2, "usage", &["--packing-fraction 2", "0.907"]),
    (&["bench", "lattice", "--packing-fraction", "NaN"], 2, "usage", &["--packing-fraction NaN"]),
    (&["bench", "lattice", "--packing-fraction", "-1"], 2, "usage", &["--packing-fraction -1"]),
    (&["bench", "lattice", "--cell-edge", "-1"], 2, "usage", &["--cell-edge -1"]),
    (&["bench", "lattice", "--cell-edge", "3"], 2, "usage", &["--cell-edge 3", "0.6363"]),
    (&["bench", "lattice", "--execution", "quick"], 2, "usage", &["--execution quick", "chained"]),
    (&["bench", "lattice", "--precision", "f16"], 2, "usage", &["f32"]),
    (&["bench", "lattice", "--integrator", "euler"], 2, "usage", &["gear5"]),
    (&["bench", "sectors", "--execution", "chained"], 2, "usage", &["--execution chained", "sectors"]),
    (&["calibrate", "--seconds", "0"], 2, "usage", &["--seconds", "0"]),
    (&["calibrate", "--out", "file"], 2, "usage", &["file", "--force"]),
    (&["calibrate", "--out", "none/host.toml"], 5, "input-output", &["none/host.toml"]),
    (&["validate-model", "--particles", "0"], 2, "usage", &["--particles", "0"]),
    (&["validate-model", "--particles", "100", "--occupancies", "7"], 2, "usage", &["--occupancies"]),
    (&["validate-model", "--seconds", "0"], 2, "usage", &["--seconds", "0"]),
    (&["validate-model", "--host", "none.toml"], 5, "input-output", &["none.toml"]),
    (&["validate-model", "--host", "latin.toml"], 3, "input", &["latin.toml:3:", "UTF-8"]),
    (&["validate-model", "--host", "scene.toml", "--calibrate"], 2, "usage", &["--calibrate"]),
    (&["validate-model", "--out", "file"], 5, "input-output", &["file"]),
    (&["chart"], 2, "usage", &["WHAT"]),
    (&["chart", "density-cost", "--machine", "cray-9"], 2, "usage", &["cray-9"]),
    (&["chart", "density-cost", "--machine", "none.toml"], 5, "input-output", &["none.toml"]),
    (&["chart", "density-cost", "--out", "file"], 5, "input-output", &["file"]),
    (&["reproduce", "--only", "figure-9"], 2, "usage", &["pipe-small"]),
    (&["reproduce", "--quick", "--all"], 2, "usage", &["--all"]),
    (&["bench", "lattice", "--steps", "18446744073709551615"], 2, "usage", &["--steps"]),
    (
        &["bench", "lattice", "--ranks", "1000", "--threads", "8"],
        2,
        "usage",
        &["1000 ranks with 8 threads each", "1024"],
    ),
    (
        &["run", "dense-gas", "--ranks", "1000", "--threads", "8"],
        2,
        "usage",
        &["1000 ranks with 8 threads each", "1024"],
    ),
    (&["run", "hard-disks", "--seeds", "1e12"], 2, "usage", &["1e12", "100000"]),
    (&["run", "hard-disks", "--seeds", "18446744073709551615"], 2, "usage", &["--seeds", "100000"]),
    (&["reproduce", "--only", "mask", "--out", "file"], 5, "input-output", &["file"]),
    (&["completions", "tcsh"], 2, "usage", &["bash"]),
    (&["man", "fly"], 2, "usage", &["reproduce"]),
];

#[test]
fn verbs_fail_with_exit_code_message_and_data() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    prepare(folder);
    let mut wrong = vec![];
    for &(arguments, code, kind, words) in CASES {
        let output = stripmine(folder, &[arguments, &["--json"]].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        let data: Value = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
        let error = &data["error"];
        let has_message = error["message"].as_str().is_some_and(|message| !message.is_empty())
            && ["place", "remedy"].iter().all(|key| error.get(key).is_some());
        let holds = output.status.code() == Some(code)
            && error["kind"] == kind
            && has_message
            && words.iter().all(|word| said.contains(word))
            && !said.contains("panicked");
        if !holds {
            wrong.push(format!("{arguments:?}: {:?}, {kind}, {words:?}\n{said}{data:#}", output.status));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n\n{}", wrong.len(), CASES.len(), wrong.join("\n\n"));
    assert_eq!(std::fs::read(folder.join("file")).unwrap(), b"mine");
}

/// `RAYON_NUM_THREADS` has the same bounds as `--threads`, which takes precedence.
#[test]
fn rayon_threads_are_bounded_like_the_option() {
    let folder = tempfile::tempdir().unwrap();
    let run = |threads: &str, more: &[&str]| {
        let mut command = Command::cargo_bin("stripmine").unwrap();
        command.current_dir(folder.path()).env("RAYON_NUM_THREADS", threads);
        command.args(["scene", "check", "two-discs"]).args(more).output().unwrap()
    };
    for (threads, more, code) in [
        ("1000000000", &[][..], 2),
        ("1025", &[], 2),
        ("18446744073709551616", &[], 2),
        ("-1", &[], 2),
        ("two", &[], 2),
        ("2", &[], 0),
        ("1000000000", &["--threads", "2"], 0),
    ] {
        let output = run(threads, more);
        let said = String::from_utf8_lossy(&output.stderr);
        let names =
            said.contains(&format!("RAYON_NUM_THREADS is {threads}")) && said.contains("from 1 to 1024");
        assert!(output.status.code() == Some(code) && names == (code == 2), "{threads} {more:?}: {said}");
    }
}

/// A broken simulation is reported as data, with kind, moment, particles and values, whichever verb ran it.
#[test]
fn physics_failures_are_reported_as_data() {
    let folder = tempfile::tempdir().unwrap();
    let run = ["run", "two-discs", "--set", "law.stiffness=1e-3", "--json"];
    let data: Value = serde_json::from_slice(&stripmine(folder.path(), &run).stdout).unwrap();
    let (error, details) = (&data["error"], &data["error"]["details"]);
    assert!(error["message"].as_str().unwrap().contains("overlap"), "{error:#}");
    assert!(error["remedy"].as_str().unwrap().contains("law.stiffness"), "{error:#}");
    assert!(details["kind"] == "too-deep" && details["count"] == 2, "{details:#}");
    assert!(details["when"]["steps"].as_u64() > Some(0) && details["when"]["time"].as_f64() > Some(0.0));
    let who = details["who"].as_array().unwrap();
    assert!(who.len() == 2 && who.iter().all(|disc| disc["id"].is_u64() && disc["position"][1].is_f64()));
    assert!(details["values"]["penetration"].as_f64() > details["values"]["limit"].as_f64());
}

/// All mistakes of a scene are reported, each with its location; the first of them is the error.
#[test]
fn scene_mistakes_have_locations_as_data() {
    let folder = tempfile::tempdir().unwrap();
    let bad = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/bad/many-mistakes-at-once.toml");
    for verb in [&["scene", "check"][..], &["run"]] {
        let output = stripmine(folder.path(), &[verb, &[bad.to_str().unwrap(), "--json"]].concat());
        assert_eq!(output.status.code(), Some(3));
        let data: Value = serde_json::from_slice(&output.stdout).unwrap();
        let errors = data["errors"].as_array().unwrap();
        assert!(errors.len() > 1 && errors[0]["place"]["line"].is_u64());
        assert_eq!(data["error"]["place"]["line"], errors[0]["place"]["line"]);
        assert_eq!(data["error"]["message"], errors[0]["message"]);
    }
}

/// Data that standard output rejects is an input/output failure, also for help and version; a reader that closes the pipe is not; and a full or
/// closed
/// standard error changes no exit code.
#[cfg(target_os = "linux")]
#[test]
fn full_and_closed_outputs_end_in_exit_codes() {
    let folder = tempfile::tempdir().unwrap();
    let program = assert_cmd::cargo::cargo_bin("stripmine");
    let mut wrong = vec![];
    for (line, code) in [
        ("\"$0\" table >/dev/full", 5),
        ("\"$0\" table --json >/dev/full", 5),
        ("\"$0\" --help >/dev/full", 5),
        ("\"$0\" --version >/dev/full", 5),
        ("\"$0\" man >/dev/full", 5),
        ("\"$0\" completions bash >/dev/full", 5),
        ("\"$0\" listing forces >/dev/full", 5),
        ("\"$0\" scene keys >/dev/full", 5),
        ("\"$0\" run two-discs --overwrite --out full >/dev/full", 5),
        ("\"$0\" nonsense --json >/dev/full", 2),
        ("\"$0\" scene check none --json >/dev/full", 3),
        ("{ \"$0\" listing forces; echo $? >code; } | true; exit $(cat code)", 0),
        ("{ \"$0\" scene keys --json; echo $? >code; } | true; exit $(cat code)", 0),
        ("\"$0\" table 2>/dev/full", 0),
        ("\"$0\" scene check pipe-as-printed 2>/dev/full", 0),
        ("\"$0\" reproduce --only mask --out pages 2>/dev/full", 0),
        ("\"$0\" run two-discs --overwrite --out full 2>/dev/full", 0),
        ("\"$0\" table --particles 0 2>/dev/full", 2),
        ("\"$0\" nonsense 2>/dev/full", 2),
        ("\"$0\" 2>/dev/full", 2),
        ("\"$0\" scene check none 2>/dev/full", 3),
        ("\"$0\" table 2>&-", 0),
        ("\"$0\" nonsense 2>&-", 2),
        ("\"$0\" table --particles 0 >&- 2>&-", 2),
        ("\"$0\" table <&- >&- 2>&-", 0),
    ] {
        let mut shell = std::process::Command::new("sh");
        let ended = shell.current_dir(folder.path()).args(["-c", line]).arg(&program).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        if ended.status.code() != Some(code) || said.contains("panicked") {
            wrong.push(format!("{line}: {:?} instead of {code}\n{said}", ended.status));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A file that reaches the size limit is an input/output failure, not a death by a signal.
#[cfg(unix)]
#[test]
fn file_size_limit_ends_in_an_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let program = assert_cmd::cargo::cargo_bin("stripmine");
    for arguments in
        ["run pipe-small --out run", "reproduce --only mask --out pages", "table --ladder >table.txt"]
    {
        let line = format!("ulimit -f 1; \"$0\" {arguments}");
        let mut shell = std::process::Command::new("sh");
        let ended = shell.current_dir(folder.path()).args(["-c", &line]).arg(&program).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(5), "{arguments}: {said}");
        assert!(said.contains("too large"), "{arguments}: {said}");
    }
}

/// A checkpoint that is intact but has impossible contents ends with exit code 6 and names the file, for every method.
#[test]
fn forged_checkpoints_end_with_6() {
    use stripmine_physics::io::checkpoint::{Checkpoint, CheckpointColumn};
    let folder = tempfile::tempdir().unwrap();
    for (preset, short, column) in [
        ("two-discs", "run.steps=20", "x1"),
        ("hard-disks", "run.events=200", "local_time"),
        ("langevin-free", "run.steps=10", "x1"),
        ("kepler", "run.steps=16", "carried.0.1"),
    ] {
        let set = ["--set", short];
        let begun = stripmine(folder.path(), &[&["run", preset, "--quiet"][..], &set].concat());
        assert!(begun.status.success(), "{}", String::from_utf8_lossy(&begun.stderr));
        let file = folder.path().join(format!("{preset}.run/run.checkpoint"));
        let whole = Checkpoint::read(&file).unwrap();
        let names: Vec<&str> = whole.columns.iter().map(|(name, _)| name.as_str()).collect();
        let at =
            names.iter().position(|name| *name == column).unwrap_or_else(|| panic!("{preset}: {names:?}"));
        let count = whole.columns[at].1.len();
        for forged in [
            CheckpointColumn::F64(vec![f64::NAN; count]),
            CheckpointColumn::F64(vec![0.0; count / 2]),
            CheckpointColumn::U64(vec![0; count]),
        ] {
            let mut checkpoint = whole.clone();
            checkpoint.columns[at].1 = forged;
            checkpoint.write_atomically(&file).unwrap();
            let resumed =
                stripmine(folder.path(), &[&["run", preset, "--resume", "--quiet"][..], &set].concat());
            let said = String::from_utf8_lossy(&resumed.stderr).into_owned();
            assert_eq!(resumed.status.code(), Some(6), "{preset}: {said}");
            assert!(said.contains("run.checkpoint") && said.contains(column), "{preset}: {said}");
        }
    }
}

/// Variables of launchers do not affect verbs that start no simulation; a run among several processes is refused if the processes could not
/// communicate.
#[test]
fn launcher_variables_affect_simulations_only() {
    const LAUNCHERS: [[(&str, &str); 2]; 3] = [
        [("PMI_SIZE", "8"), ("PMI_RANK", "0")],
        [("OMPI_COMM_WORLD_SIZE", "8"), ("OMPI_COMM_WORLD_RANK", "0")],
        // srun with PMIx.
        [("SLURM_NTASKS", "8"), ("PMIX_RANK", "0")],
    ];
    let folder = tempfile::tempdir().unwrap();
    let run = ["run", "two-discs", "--quiet", "--set", "run.steps=20"];
    assert!(stripmine(folder.path(), &run).status.success());
    for variables in LAUNCHERS {
        let launched = |arguments: &[&str]| {
            let mut command = Command::cargo_bin("stripmine").unwrap();
            command.current_dir(folder.path()).args(arguments).envs(variables).output().unwrap()
        };
        for verb in [
            &["scene", "list"][..],
            &["scene", "check", "two-discs"],
            &["average", "two-discs.run"],
            &["plot", "two-discs.run"],
            &["completions", "bash"],
            &["--version"],
        ] {
            let output = launched(verb);
            assert!(
                output.status.success() && !output.stdout.is_empty(),
                "{verb:?} {variables:?}: {output:?}"
            );
        }
        if !cfg!(feature = "mpi") {
            let output = launched(&run);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(4), "{said}");
            for words in ["this is one of 8 processes", "built without MPI", "unset", variables[1].0] {
                assert!(said.contains(words), "{words}: {said}");
            }
        }
    }
    // A batch script of Slurm, without srun.
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder.path()).args(run).args(["--out", "alone"]).env("SLURM_NTASKS", "8");
    assert!(command.env("SLURM_PROCID", "0").output().unwrap().status.success());
}

/// An impossible number of threads in the environment is refused and the variable is named; an empty value, or `--threads` on the command line,
/// makes it irrelevant.
#[test]
fn bad_rayon_threads_are_refused_unless_overridden() {
    let folder = tempfile::tempdir().unwrap();
    for (given, more, code) in [
        ("", &[][..], 0),
        ("0", &[], 0),
        ("2", &[], 0),
        ("1025", &[], 2),
        ("18446744073709551615", &[], 2),
        ("-1", &[], 2),
        ("many", &[], 2),
        ("many", &["--threads", "1"], 0),
    ] {
        let mut command = Command::cargo_bin("stripmine").unwrap();
        command.current_dir(folder.path()).args(["table"]).args(more).env("RAYON_NUM_THREADS", given);
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{given} {more:?}: {said}");
        assert!(
            code == 0 || said.contains("RAYON_NUM_THREADS is") && said.contains("from 1 to 1024"),
            "{said}"
        );
    }
}

/// Runs with several seeds that fail leave no summary of the runs they overwrite.
#[test]
fn overwritten_seed_runs_leave_no_summary() {
    let folder = tempfile::tempdir().unwrap();
    let begin = ["run", "dense-gas", "--seeds", "2", "--out", "all", "--quiet", "--set", "run.steps=400"];
    let summary = folder.path().join("all/seeds.json");
    let whole = stripmine(folder.path(), &begin);
    assert!(whole.status.success() && summary.is_file(), "{}", String::from_utf8_lossy(&whole.stderr));
    // Discs so soft that they pass through each other.
    let broken = ["--overwrite", "--set", "law.stiffness=1e-3"];
    let output = stripmine(folder.path(), &[&begin[..], &broken].concat());
    assert_eq!(output.status.code(), Some(4), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(folder.path().join("all/seed-1").is_dir() && !summary.exists());
}
