//! Ownership of folders: the program neither overwrites nor removes files that it did not write, and one process at a time writes to a folder.

use assert_cmd::cargo::CommandCargoExt;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

fn stripmine(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.args(arguments).arg("--quiet");
    command
}

/// Runs two discs for a few steps, LAMMPS files included, into a folder.
fn run(folder: &Path, more: &[&str]) -> Command {
    let mut command = stripmine(&["run", "two-discs", "--out", folder.to_str().unwrap()]);
    command.args(["--set", "run.steps=20", "--set", "output.lammps_dump=true"]);
    command.args(["--set", "output.lammps_data=true"]).args(more);
    command
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn succeed(mut command: Command) {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
}

/// Checks that the command is refused with this code and all of these words.
fn refused(mut command: Command, code: i32, words: &[&str]) {
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(code), "{}", said(&output));
    for word in words {
        assert!(said(&output).contains(word), "{word} is not in: {}", said(&output));
    }
}

/// Every file below a folder; links by their targets.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        let kind = entry.file_type().unwrap();
        if kind.is_dir() {
            for (below, bytes) in contents(&entry.path()) {
                all.insert(format!("{name}/{below}"), bytes);
            }
            all.insert(format!("{name}/"), vec![]);
        } else if kind.is_symlink() {
            all.insert(name, fs::read_link(entry.path()).unwrap().into_os_string().into_encoded_bytes());
        } else {
            all.insert(name, fs::read(entry.path()).unwrap());
        }
    }
    all
}

const ALL_OPTIONS: [&[&str]; 3] = [&[], &["--resume"], &["--overwrite"]];

/// A folder that no run wrote is refused with its contents, however a run begins, and stays as it was.
#[test]
fn foreign_folders_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let run_names =
        ["scene.toml", "trajectory.xyz", "thermo.csv", "dump.lammpstrj", "final.data", "summary.json"];
    for names in [&["thesis.tex"][..], &run_names, &["run.checkpoint"], &["run.lock"], &[".hidden"]] {
        let out = folder.path().join(names[0]);
        fs::create_dir(&out).unwrap();
        names.iter().for_each(|name| fs::write(out.join(name), "mine").unwrap());
        for options in ALL_OPTIONS {
            refused(run(&out, options), 2, &["run.files", names[0]]);
            assert_eq!(contents(&out).len(), names.len());
            assert!(contents(&out).values().all(|bytes| bytes == b"mine"));
        }
    }
}

/// Names of foreign files are printed without control characters of the terminal.
#[cfg(unix)]
#[test]
fn foreign_file_names_are_escaped() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a\u{1b}[2Jb\u{202e}c"), "mine").unwrap();
    for mut command in [run(folder.path(), &[]), reproduce(folder.path())] {
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        let words = said(&output);
        assert!(
            words.contains("a\\u{1b}[2Jb\\u{202e}c") && !words.contains(['\u{1b}', '\u{202e}']),
            "{words}"
        );
    }
}

/// `--out .` in the folder of a user's scene leaves the scene there.
#[test]
fn runs_do_not_overwrite_their_scene() {
    let folder = tempfile::tempdir().unwrap();
    let scene = stripmine(&["scene", "show", "two-discs"]).output().unwrap().stdout;
    fs::write(folder.path().join("scene.toml"), &scene).unwrap();
    for options in ALL_OPTIONS {
        let mut command = stripmine(&["run", "scene.toml", "--out", "."]);
        command.current_dir(folder.path()).args(options);
        refused(command, 2, &["scene.toml"]);
        assert_eq!(contents(folder.path()), BTreeMap::from([("scene.toml".to_owned(), scene.clone())]));
    }
}

/// A run's folder holds exactly the files of its list; `--overwrite` removes those and nothing else.
#[test]
fn overwrite_removes_only_files_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    succeed(run(&out, &["--set", "run.checkpoint_every=5"]));
    let list = fs::read_to_string(out.join("run.files")).unwrap();
    let there: Vec<String> = contents(&out).into_keys().collect();
    let mut listed: Vec<&str> = list.lines().skip(1).collect();
    listed.sort_unstable();
    assert_eq!(
        (list.lines().next(), &listed[..]),
        (Some("stripmine run files 1"), &there.iter().map(String::as_str).collect::<Vec<_>>()[..])
    );

    fs::write(out.join("notes.txt"), "mine").unwrap();
    fs::create_dir(out.join("pictures")).unwrap();
    fs::write(out.join("pictures/one.png"), "mine").unwrap();
    let before = contents(&out);
    refused(run(&out, &[]), 2, &["--resume", "--overwrite"]);
    assert_eq!(contents(&out), before);
    let plain = &["--overwrite", "--set", "output.lammps_dump=false", "--set", "output.lammps_data=false"];
    succeed(run(&out, plain));
    let after = contents(&out);
    assert_eq!((&after["notes.txt"][..], &after["pictures/one.png"][..]), (&b"mine"[..], &b"mine"[..]));
    assert!(!after.contains_key("dump.lammpstrj") && !after.contains_key("final.data"));
    assert!(!after.contains_key("run.checkpoint.previous"));
}

/// A foreign file in a run's folder is not overwritten, even if it has a name that the run writes.
#[test]
fn foreign_files_in_a_run_folder_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    succeed(run(&out, &["--set", "output.lammps_data=false"]));
    fs::write(out.join("final.data"), "mine").unwrap();
    for options in ["--resume", "--overwrite"] {
        refused(run(&out, &[options]), 2, &["final.data"]);
        assert_eq!(fs::read(out.join("final.data")).unwrap(), b"mine");
    }
}

/// Links in a run's folder are replaced or refused, never followed.
#[cfg(unix)]
#[test]
fn links_are_not_followed() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let (out, thesis) = (folder.path().join("run"), folder.path().join("thesis.tex"));
    fs::write(&thesis, "mine").unwrap();
    succeed(run(&out, &["--set", "run.checkpoint_every=5"]));
    let names: Vec<String> = contents(&out).into_keys().collect();
    for name in names {
        fs::remove_file(out.join(&name)).unwrap();
        symlink(&thesis, out.join(&name)).unwrap();
        for options in ["--resume", "--overwrite"] {
            let code = run(&out, &[options]).output().unwrap().status.code();
            assert!([Some(0), Some(2), Some(6)].contains(&code), "{name} {options}: {code:?}");
            assert_eq!(fs::read(&thesis).unwrap(), b"mine", "{name} {options}");
        }
        let _ = fs::remove_dir_all(&out);
        succeed(run(&out, &["--set", "run.checkpoint_every=5"]));
    }
    symlink(&thesis, out.join("run.lock")).unwrap();
    refused(run(&out, &["--overwrite"]), 2, &["run.lock"]);
    assert_eq!(fs::read(&thesis).unwrap(), b"mine");
}

/// A list with impossible names is refused, and nothing is removed.
#[test]
fn lists_with_foreign_names_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    fs::create_dir(&out).unwrap();
    fs::write(folder.path().join("thesis.tex"), "mine").unwrap();
    fs::write(out.join("notes.txt"), "mine").unwrap();
    for (list, words) in [
        ("", "run.files:1"),
        ("stripmine run files 2\nthermo.csv\n", "run.files:1"),
        ("stripmine run files 1\n../thesis.tex\n", "run.files:2"),
        ("stripmine run files 1\nthermo.csv\nnotes.txt\n", "run.files:3"),
        ("stripmine run files 1\n\u{1b}[2J\n", "run.files:2"),
    ] {
        fs::write(out.join("run.files"), list).unwrap();
        for options in ALL_OPTIONS {
            refused(run(&out, options), 6, &[words]);
        }
        assert!(folder.path().join("thesis.tex").exists() && out.join("notes.txt").exists());
    }
}

/// With periodic sides no disc leaves the box.
const PERIODIC: &str = "domain.periodic=[true, true]";

/// Starts a run that lasts until it is killed.
fn endless(folder: &Path) -> Child {
    let mut command = run(
        folder,
        &["--set", "run.steps=1000000000", "--set", "run.checkpoint_every=100", "--set", PERIODIC],
    );
    let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while !folder.join("run.checkpoint").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child
}

/// A second process is told which process writes to the folder; after that one is killed, the folder is free.
#[test]
fn only_one_process_writes_to_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let mut child = endless(&out);
    for options in ALL_OPTIONS {
        refused(run(&out, options), 2, &[&format!("process {}", child.id()), "since", "--out"]);
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let longer = &["--resume", "--set", "run.steps=1000000000", "--set", PERIODIC];
    let mut child = run(&out, longer).stdout(Stdio::null()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "the lock of the killed process is still there");
    child.kill().unwrap();
    child.wait().unwrap();
    succeed(run(&out, &["--overwrite"]));
    assert!(!out.join("run.lock").exists());
}

fn reproduce(folder: &Path) -> Command {
    stripmine(&["reproduce", "--only", "mask", "--out", folder.to_str().unwrap()])
}

/// Results are written to an empty folder, or over results; foreign folders and pages are left alone.
#[test]
fn results_replace_results_only() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("reports");
    succeed(reproduce(&out));
    let first = contents(&out);
    assert!(first.keys().all(|name| !name.starts_with('.')), "{:?}", first.keys());
    fs::write(out.join("index.png"), "mine").unwrap();
    succeed(reproduce(&out));
    assert_eq!(fs::read(out.join("index.png")).unwrap(), b"mine");
    assert_eq!(contents(&out).len(), first.len() + 1);

    let mine = |name: &str, words: &str| {
        let path = out.join(name);
        let before = fs::read(&path).ok();
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, "mine").unwrap();
        let there = contents(&out);
        refused(reproduce(&out), 2, &[words]);
        assert_eq!(contents(&out), there);
        match before {
            Some(bytes) => fs::write(&path, bytes).unwrap(),
            None => fs::remove_file(&path).unwrap(),
        }
    };
    mine("mask/thesis.tex", "thesis.tex");
    mine("README.md", "README.md");
    mine("index.html", "index.html");
    mine("mask/provenance.json", "mask");
    fs::create_dir(out.join("mask/figures")).unwrap();
    refused(reproduce(&out), 2, &["figures"]);
    fs::remove_dir(out.join("mask/figures")).unwrap();
    succeed(reproduce(&out));

    for names in [&["mask/thesis.tex"][..], &["README.md"], &["thesis.tex"], &["host/thesis.tex"]] {
        let other = folder.path().join("other");
        for name in names {
            fs::create_dir_all(other.join(name).parent().unwrap()).unwrap();
            fs::write(other.join(name), "mine").unwrap();
        }
        let before = contents(&other);
        let path = other.to_str().unwrap();
        for arguments in [
            &["reproduce", "--only", "mask", "--out", path][..],
            &["chart", "density-cost", "--out", path],
            &["validate-model", "--out", path],
        ] {
            refused(stripmine(arguments), 2, &["other"]);
            assert_eq!(contents(&other), before, "{arguments:?}");
        }
        fs::remove_dir_all(other).unwrap();
    }
}

/// Temporary folders left by killed sessions are removed by the next session; a foreign folder with such a name stays.
#[test]
fn leftover_temporary_folders_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("reports");
    succeed(reproduce(&out));
    let first: Vec<String> = contents(&out).into_keys().collect();
    let [part, empty, other] = ["a", "b", "c"].map(|name| out.join(format!(".stripmine-{name}.part")));
    fs::create_dir(&part).unwrap();
    fs::copy(out.join("mask/provenance.json"), part.join("provenance.json")).unwrap();
    fs::create_dir_all(empty.join("item")).unwrap();
    fs::create_dir(&other).unwrap();
    fs::write(other.join("thesis.tex"), "mine").unwrap();
    succeed(reproduce(&out));
    assert_eq!(fs::read(other.join("thesis.tex")).unwrap(), b"mine");
    fs::remove_dir_all(other).unwrap();
    assert_eq!(contents(&out).into_keys().collect::<Vec<_>>(), first);
}

/// Links in a folder of results are not followed.
#[cfg(unix)]
#[test]
fn links_among_results_are_not_followed() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let (out, thesis) = (folder.path().join("reports"), folder.path().join("thesis"));
    fs::create_dir(&thesis).unwrap();
    fs::write(thesis.join("README.md"), "mine").unwrap();
    succeed(reproduce(&out));
    for name in ["mask", "README.md", "index.html", ".stripmine.lock"] {
        let (path, kept) = (out.join(name), folder.path().join("kept"));
        let there = fs::rename(&path, &kept).is_ok();
        symlink(if name == "mask" { thesis.clone() } else { thesis.join("README.md") }, &path).unwrap();
        refused(reproduce(&out), 2, &[name]);
        assert_eq!(contents(&thesis), BTreeMap::from([("README.md".to_owned(), b"mine".to_vec())]));
        fs::remove_file(&path).unwrap();
        if there {
            fs::rename(&kept, &path).unwrap();
        }
    }
}

/// The program recognises the committed results as its own.
#[test]
fn committed_results_are_recognised() {
    let folder = tempfile::tempdir().unwrap();
    let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
    for name in ["README.md", "index.html"] {
        fs::copy(reports.join(name), folder.path().join(name)).unwrap();
    }
    for entry in fs::read_dir(reports.join("mask")).unwrap() {
        let entry = entry.unwrap();
        fs::create_dir_all(folder.path().join("mask")).unwrap();
        fs::copy(entry.path(), folder.path().join("mask").join(entry.file_name())).unwrap();
    }
    succeed(reproduce(folder.path()));
    for entry in fs::read_dir(&reports).unwrap().chain(fs::read_dir(reports.join("host")).unwrap()) {
        let item = entry.unwrap().path();
        let Ok(list) = fs::read(item.join("provenance.json")) else { continue };
        let list: serde_json::Value = serde_json::from_slice(&list).unwrap();
        let listed: Vec<&str> =
            list["files"].as_array().unwrap().iter().filter_map(|name| name.as_str()).collect();
        assert!(contents(&item).keys().all(|name| listed.contains(&name.as_str())), "{}", item.display());
    }
}

/// For every verb with `--out`: a user's file with the name of an output is refused by name and stays.
#[test]
fn no_verb_overwrites_foreign_files() {
    let folder = tempfile::tempdir().unwrap();
    let there = folder.path().join("there");
    succeed(run(&there, &["--set", "run.thermo_every=5"]));
    let there = there.to_str().unwrap();
    let verbs: [(&[&str], &str); 13] = [
        (&["run", "two-discs"], "thermo.csv"),
        (&["scan", "two-discs", "--over", "run.steps=20"], "scan.csv"),
        (&["scan", "two-discs", "--over", "run.steps=20"], "steps=20"),
        (&["plot", there], "last-state.png"),
        (&["plot", there], "plot.files"),
        (&["reproduce", "--only", "mask"], "README.md"),
        (&["chart", "stability", "two-discs"], "journal.jsonl"),
        (&["chart", "work-precision", "two-discs"], "README.md"),
        (&["chart", "accuracy", "hard-disks"], "README.md"),
        (&["chart", "density-cost"], "index.html"),
        (&["chart", "soft-hard"], "thesis.tex"),
        (&["validate-model"], "validation"),
        (&["emit", "bench", "--isa", "rvv"], "kernels.S"),
    ];
    for (number, (arguments, name)) in verbs.into_iter().enumerate() {
        let out = folder.path().join(number.to_string());
        fs::create_dir(&out).unwrap();
        fs::write(out.join(name), "mine").unwrap();
        let mut command = stripmine(arguments);
        command.args(["--out", out.to_str().unwrap()]);
        refused(command, 2, &[name]);
        assert_eq!(contents(&out), BTreeMap::from([(name.to_owned(), b"mine".to_vec())]), "{arguments:?}");
    }
    let file = folder.path().join("host.toml");
    fs::write(&file, "mine").unwrap();
    let mut command = stripmine(&["calibrate"]);
    command.args(["--out", file.to_str().unwrap()]);
    refused(command, 2, &["host.toml", "--force"]);
    // The list is complete: a verb with an --out that is not tried here fails this.
    let tried = ["run", "plot", "reproduce", "chart stability", "chart work-precision", "chart density-cost"];
    let more = ["scan", "chart soft-hard", "chart accuracy", "validate-model", "calibrate", "emit"];
    let tried = [&tried[..], &more].concat();
    let help = |verb: &[&str]| {
        String::from_utf8(stripmine(&[verb, &["--help"]].concat()).output().unwrap().stdout).unwrap()
    };
    let below = |text: &str, heading: &str| -> Vec<String> {
        let names =
            text.lines().skip_while(|line| *line != heading).skip(1).take_while(|line| !line.is_empty());
        let first = |line: &str| line.strip_prefix("  ")?.split(' ').next().map(str::to_owned);
        names.filter_map(first).filter(|name| !name.is_empty() && name != "help").collect()
    };
    let verbs = below(&help(&[]), "Commands:");
    let charts = below(&help(&["chart"]), "Studies:");
    assert!(verbs.len() > 8 && charts.len() == 5, "{verbs:?} {charts:?}");
    for verb in
        verbs.iter().map(|verb| vec![verb.as_str()]).chain(charts.iter().map(|name| vec!["chart", name]))
    {
        let writes = help(&verb).contains("--out <");
        assert_eq!(writes, tried.contains(&verb.join(" ").as_str()), "{verb:?}");
    }
}

/// Pictures replace earlier pictures of ours; foreign files are replaced only on request.
#[test]
fn only_our_own_pictures_are_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let [there, out] = ["there", "pictures"].map(|name| folder.path().join(name));
    succeed(run(&there, &["--set", "run.thermo_every=5"]));
    let plot = |more: &[&str]| {
        let mut command = stripmine(&["plot", there.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        command.args(more);
        command
    };
    fs::create_dir(&out).unwrap();
    fs::write(out.join("thesis.tex"), "mine").unwrap();
    succeed(plot(&[]));
    let drawn = contents(&out);
    succeed(plot(&[]));
    assert_eq!(contents(&out), drawn);
    fs::remove_file(out.join("plot.files")).unwrap();
    refused(plot(&[]), 2, &["--overwrite", "was not written by this command"]);
    succeed(plot(&["--overwrite"]));
    assert_eq!(contents(&out), drawn);
    assert_eq!(drawn["thesis.tex"], b"mine");
}
