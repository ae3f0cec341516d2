//! Foreign text in messages: control characters in files, names and arguments never reach the terminal.

use assert_cmd::Command;
use std::path::Path;

/// Sequences that would colour, delete, reverse or hide text.
const NASTY: [&str; 6] =
    ["\u{1b}[31m", "\u{7}\u{8}", "\u{9b}2J", "exe\u{202e}txt", "\u{2066}a\u{2069}", "a\u{200b}\u{feff}b"];

fn said(arguments: &[&str], folder: &Path) -> (Option<i32>, String) {
    let output =
        Command::cargo_bin("stripmine").unwrap().args(arguments).current_dir(folder).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

/// True if a text has only visible characters and line ends.
fn is_clean(text: &str) -> bool {
    let hidden = |c: char| {
        c.is_control() && c != '\n'
            || matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{ad}')
    };
    !text.chars().any(hidden)
}

#[test]
fn messages_have_no_control_characters() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let two = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/bad/two.xyz");
    let two = std::fs::read_to_string(two).unwrap();
    let machine =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/model/machines/cray-1.toml"));
    let machine = machine.unwrap();
    let host = stripmine::model::host::default_model().unwrap().to_toml().unwrap();
    let escaped = |text: &str| text.chars().map(|c| format!("\\U{:08X}", c as u32)).collect::<String>();
    for nasty in NASTY {
        let key = escaped(nasty);
        let scene = "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"SI\"\n[domain]\nsides = [10.0, 8.0]\n[particles]\nfile = \"FILE\"\n[law]\nstiffness = 1\n\
                     [integrator]\ndt = 1e-3\n[run]\nsteps = 1\n";
        let files = [
            ("syntax.toml", format!("format = 2\nx = {nasty}")),
            (
                "key.toml",
                format!("format = 2\n\"{key}\" = 1\n[\"{key}\"]\n[law]\n\"{key}\" = 2\nkind = \"{key}\"\n"),
            ),
            ("file.toml", scene.replace("FILE", &key)),
            ("species.toml", scene.replace("FILE", "species.xyz")),
            ("number.toml", scene.replace("FILE", "number.xyz")),
            ("count.toml", scene.replace("FILE", "count.xyz")),
            ("column.toml", scene.replace("FILE", "column.xyz")),
            ("value.toml", scene.replace("FILE", "value.xyz")),
            ("species.xyz", two.replacen("Si ", &format!("{nasty} "), 1)),
            ("number.xyz", two.replacen("0.5", nasty, 1)),
            ("count.xyz", format!("{nasty}\n{two}")),
            ("column.xyz", two.replacen("radius:R", &format!("{nasty}:R"), 1)),
            ("value.xyz", two.replacen("Time=0.0", &format!("Time={nasty}"), 1)),
            ("machine.toml", machine.replacen("title", &format!("\"{key}\" = 1\ntitle"), 1)),
            ("machine-syntax.toml", machine.replacen("title = ", &format!("title = {nasty}"), 1)),
            (
                "class.toml",
                machine.replacen("[start_up]", &format!("[start_up]\n\"{key}\" = {{ value = 1 }}"), 1),
            ),
            ("host.toml", host.replacen("title", &format!("\"{key}\" = 1\ntitle"), 1)),
            ("host-syntax.toml", host.replacen("title = ", &format!("title = {nasty}"), 1)),
        ];
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let path = at(&format!("no{nasty}such.toml"));
        let set = format!("{nasty}={nasty}");
        for (code, arguments) in [
            (3, &["scene", "check", "syntax.toml"][..]),
            (3, &["scene", "check", "key.toml"]),
            (3, &["scene", "check", "file.toml"]),
            (0, &["scene", "check", "species.toml"]),
            (3, &["scene", "check", "number.toml"]),
            (3, &["scene", "check", "count.toml"]),
            (3, &["scene", "check", "column.toml"]),
            (3, &["scene", "check", "value.toml"]),
            (3, &["scene", "check", &path]),
            (3, &["scene", "check", "two-discs", "--set", &set]),
            (3, &["scene", "check", "two-discs", "--set", nasty]),
            (3, &["table", "--machine", "machine.toml"]),
            (3, &["table", "--machine", "machine-syntax.toml"]),
            (3, &["table", "--machine", "class.toml"]),
            (5, &["table", "--machine", &path]),
            (2, &["table", "--machine", nasty]),
            (3, &["validate-model", "--host", "host.toml"]),
            (3, &["validate-model", "--host", "host-syntax.toml"]),
            (5, &["validate-model", "--host", &path]),
            (2, &["scene", "show", nasty]),
            (2, &["scene", nasty]),
            (2, &[nasty]),
            (2, &["run", "two-discs", "--threads", nasty]),
        ] {
            let (found, text) = said(arguments, folder.path());
            assert_eq!(found, Some(code), "{arguments:?}: {text}");
            assert!(!text.is_empty() && is_clean(&text), "{arguments:?}: {text:?}");
        }
    }
}

/// Names of files and folders, columns of tables and scenes appear on standard output, as words and as data, without control
/// characters; data reads back to the same.
#[test]
fn standard_output_has_no_control_characters() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Command::cargo_bin("stripmine")
        .unwrap()
        .args(["scene", "show", "two-discs"])
        .output()
        .unwrap()
        .stdout;
    for nasty in NASTY {
        let (file, run, plots) = (format!("a{nasty}b.toml"), format!("run{nasty}"), format!("plots{nasty}"));
        std::fs::write(folder.path().join(&file), &scene).unwrap();
        let short = ["--set", "run.steps=20", "--set", "run.thermo_every=5"];
        let with = |arguments: &[&str]| -> Vec<String> {
            arguments.iter().chain(&short).map(|it| (*it).to_owned()).collect()
        };
        let words = |arguments: &[&str]| arguments.iter().map(|it| (*it).to_owned()).collect::<Vec<_>>();
        for (arguments, names) in [
            (with(&["run", &file, "--out", &run]), true),
            (with(&["scene", "check", &file]), true),
            (with(&["scene", "check", &file, "--json"]), true),
            (with(&["compare", &file, "--against", "machine.engine=programs"]), true),
            (words(&["plot", &run, "--out", &plots]), true),
            (words(&["plot", &run, "--out", &plots, "--json"]), true),
            (with(&["run", &file, "--out", &run, "--overwrite", "--json"]), false),
        ] {
            let mut command = Command::cargo_bin("stripmine").unwrap();
            let output = command.args(&arguments).current_dir(folder.path()).output().unwrap();
            let text = String::from_utf8(output.stdout).unwrap();
            assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
            assert!(is_clean(&text), "{arguments:?}: {text:?}");
            let is_data = arguments.iter().any(|it| it == "--json");
            // Escaped, not left out.
            let spelled = if is_data { "\\u" } else { "\\u{" };
            assert!(!names || text.contains(spelled), "{arguments:?}: {text}");
            if is_data && names {
                assert!(
                    format!("{:?}", serde_json::from_str::<serde_json::Value>(&text).unwrap()).contains("b"),
                    "{text}"
                );
                let data: serde_json::Value = serde_json::from_str(&text).unwrap();
                assert!(data.to_string().contains(nasty.trim_matches(char::is_control)), "{text}");
            }
        }
        let table = folder.path().join(&run).join("thermo.csv");
        let text = std::fs::read_to_string(&table).unwrap();
        std::fs::write(&table, text.replacen("kinetic", nasty, 1)).unwrap();
        let mut command = Command::cargo_bin("stripmine").unwrap();
        command.args(["plot", &run, "--out", "other", "--overwrite"]).current_dir(folder.path());
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(is_clean(&String::from_utf8(output.stdout).unwrap()));
        let names = std::fs::read_dir(folder.path().join("other")).unwrap();
        assert!(
            names.into_iter().all(|name| name
                .unwrap()
                .file_name()
                .to_str()
                .is_some_and(|name| name.is_ascii()))
        );
    }
}

/// Checkpoints and folders with control characters in their names.
#[test]
fn checkpoint_messages_have_no_control_characters() {
    use stripmine_physics::io::checkpoint::{CheckpointError, CheckpointFault, OlderCheckpoint};
    for nasty in NASTY {
        let error = CheckpointError {
            file: nasty.into(),
            offset: None,
            fault: CheckpointFault::Repeated { what: "the column", name: nasty.to_owned() },
            kept: OlderCheckpoint::Whole { file: nasty.into(), step: 1 },
        };
        assert!(is_clean(&error.to_string()), "{error:?}");
    }
}

/// Endless devices, pipes without a writer and folders are refused before they are opened.
#[cfg(unix)]
#[test]
fn only_ordinary_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.toml");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("zero.toml")).unwrap();
    std::fs::create_dir(folder.path().join("folder.toml")).unwrap();
    let scene = "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"SI\"\n[domain]\nsides = [10.0, 8.0]\n[particles]\nfile = \"FILE\"\n[law]\nstiffness = 1\n\
                 [integrator]\ndt = 1e-3\n[run]\nsteps = 1\n";
    for (name, words) in
        [("pipe.toml", "it is a pipe"), ("zero.toml", "it is a device"), ("folder.toml", "it is a folder")]
    {
        std::fs::write(folder.path().join("scene.toml"), scene.replace("FILE", name)).unwrap();
        let run = format!("{name}.run");
        std::fs::create_dir(folder.path().join(&run)).unwrap();
        for (code, arguments) in [
            (3, &["scene", "check", name][..]),
            (3, &["scene", "check", "scene.toml"]),
            (5, &["table", "--machine", name]),
            (5, &["validate-model", "--host", name]),
        ] {
            let (found, text) = said(arguments, folder.path());
            assert_eq!(found, Some(code), "{arguments:?}: {text}");
            assert!(text.contains(words) && text.contains("an ordinary file"), "{arguments:?}: {text}");
        }
        let checkpoint =
            stripmine_physics::io::checkpoint::Checkpoint::read(folder.path().join(name)).unwrap_err();
        assert!(checkpoint.to_string().contains(words), "{checkpoint}");
    }
}

/// No verb blocks on a pipe at the name of one of its files: it refuses, or continues without the file.
#[cfg(unix)]
#[test]
fn no_verb_blocks_on_a_pipe() {
    const LONGEST: std::time::Duration = std::time::Duration::from_secs(120);
    let folder = tempfile::tempdir().unwrap();
    let ended = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("stripmine").unwrap();
        let output = command.args(arguments).current_dir(folder.path()).timeout(LONGEST).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let begin = |name: &str| {
        let (code, text) = ended(&[
            "run",
            "two-discs",
            "--out",
            name,
            "--quiet",
            "--set",
            "run.steps=20",
            "--set",
            "run.thermo_every=5",
        ]);
        assert_eq!(code, Some(0), "{text}");
    };
    let pipe = |path: &str| {
        let path = folder.path().join(path);
        let _ = std::fs::remove_file(&path);
        assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
    };
    for (name, code) in [("thermo.csv", 5), ("scene.toml", 0), ("trajectory.xyz", 0)] {
        let run = format!("plot-{name}");
        begin(&run);
        pipe(&format!("{run}/{name}"));
        let (found, text) = ended(&["plot", &run, "--out", &format!("{run}.plots")]);
        assert_eq!(found, Some(code), "{name}: {text}");
    }
    for (name, code) in
        [("run.files", 2), ("run.checkpoint", 5), ("scene.toml", 0), ("thermo.csv", 6), ("trajectory.xyz", 6)]
    {
        let run = format!("resumed-{name}");
        begin(&run);
        pipe(&format!("{run}/{name}"));
        let (found, text) = ended(&[
            "run",
            "two-discs",
            "--out",
            &run,
            "--resume",
            "--set",
            "run.steps=40",
            "--set",
            "run.thermo_every=5",
        ]);
        assert_eq!(found, Some(code), "{name}: {text}");
    }
    let chart = |out: &str| ended(&["chart", "stability", "two-discs", "--out", out]);
    for name in ["journal.jsonl", ".stripmine.lock"] {
        let out = format!("chart-{name}");
        assert_eq!(ended(&["reproduce", "--only", "mask", "--out", &out]).0, Some(0));
        pipe(&format!("{out}/{name}"));
        let (found, text) = chart(&out);
        assert!(found == Some(5) && text.contains("pipe") || found == Some(2), "{name}: {found:?} {text}");
    }
    for name in ["section.json", "provenance.json"] {
        let out = format!("reproduced-{name}");
        assert_eq!(ended(&["reproduce", "--only", "mask", "--out", &out]).0, Some(0));
        pipe(&format!("{out}/mask/{name}"));
        let (found, text) = ended(&["reproduce", "--only", "listing", "--out", &out]);
        assert!(found == Some(5) || found == Some(0), "{name}: {found:?} {text}");
    }
}

/// Files of other types and broken ones may hold any number of mistakes: the first are named, the rest counted.
#[test]
fn many_mistakes_are_counted() {
    use stripmine_physics::method::lattice_md::GranularScene;
    use stripmine_physics::scene::MistakeKind;
    let keys: String = (0..100_000).map(|i| format!("key{i} = 1\n")).collect();
    let positions = format!("[particles]\npositions = [{}]", "[1.0, 2.0, 3.0], ".repeat(40_000));
    for (text, more) in [
        (format!("format = 2\n[law]\n{keys}"), Some("more mistakes, not listed")),
        (format!("format = 2\n{keys}"), Some("more mistakes, not listed")),
        (format!("format = 2\n{}", "x\n".repeat(100_000)), Some("more mistakes, not listed")),
        (format!("format = 2\n{positions}"), None),
        (format!("format = 2\n[law]\n{} = 1", "k".repeat(1_000_000)), None),
    ] {
        let errors = GranularScene::parse("scene.toml", &text).unwrap_err();
        assert!(errors.0.len() <= 60, "{}", errors.0.len());
        let said = errors
            .0
            .iter()
            .find(|error| error.reason == MistakeKind::More)
            .map(|error| error.message.clone());
        assert_eq!(said.is_some(), more.is_some(), "{said:?}");
        assert!(said.is_none_or(|said| said.ends_with(more.unwrap())));
        assert!(errors.to_string().len() < 200_000);
    }
}

/// The column of an item is found without counting from the start of its line.
#[test]
fn long_lines_are_read_in_linear_time() {
    use stripmine_physics::method::lattice_md::GranularDocument;
    let text = GranularDocument::load("two-discs", &[]).unwrap().scene.to_toml();
    let list =
        |count: usize| (0..count).map(|i| format!("[{}.0, 1.0]", i % 9)).collect::<Vec<_>>().join(", ");
    let at = text.find("positions = ").unwrap();
    let end = at + text[at..].find('\n').unwrap();
    let velocities = text.find("velocities = ").map(|at| (at, at + text[at..].find('\n').unwrap()));
    let long = format!("{}positions = [{}, [\"é\", 0.0]]{}", &text[..at], list(40_000), &text[end..]);
    assert!(velocities.is_some());
    let errors = GranularDocument::parse("scene.toml", &long, &[]).unwrap_err();
    let place = errors.0[0].place.unwrap();
    let column = long.lines().nth(place.line as usize - 1).unwrap().find('"').unwrap() + 1;
    assert_eq!(place.column as usize, column, "{errors}");
}

#[test]
fn number_of_threads_is_bounded() {
    let folder = tempfile::tempdir().unwrap();
    for threads in ["0", "1025", "65535", "99999999999", "-1"] {
        let (code, text) = said(&["scene", "list", "--threads", threads], folder.path());
        assert_eq!(code, Some(2), "{text}");
    }
    let (_, text) = said(&["scene", "list", "--threads", "65535"], folder.path());
    assert!(text.contains("1..=1024"), "{text}");
}

/// Overlaps of discs in one heap are counted up to a bound, and the deepest is named.
#[test]
fn overlaps_of_a_heap_are_counted_partially() {
    let folder = tempfile::tempdir().unwrap();
    let header = "Lattice=\"10.0 0 0 0 8.0 0 0 0 1\" Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";
    let rows: String = (1..=8000).map(|id| format!("Si 5 5 0 {id} 0 0 0 0.5 1 0 0 0\n")).collect();
    std::fs::write(folder.path().join("heap.xyz"), format!("8000\n{header}\n{rows}")).unwrap();
    let scene = "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"SI\"\n[domain]\nsides = [10.0, 8.0]\n[particles]\nfile = \"heap.xyz\"\n[law]\nstiffness = 1\n\
                 [integrator]\ndt = 1e-3\n[run]\nsteps = 1\n";
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let (code, text) = said(&["scene", "check", "scene.toml"], folder.path());
    assert_eq!(code, Some(3));
    assert!(text.contains("at least 999995 more pairs overlap; the search ended there"), "{text}");
}
