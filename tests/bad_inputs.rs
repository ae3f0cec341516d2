//! Bad inputs of every kind, one a line, in `tests/bad/*.cases`: a valid input, one change to it, and the words its error must contain.
//!
//! A line is `BASE: OLD => NEW :: words :: words`. `NEW` replaces the first line of the base that begins with `OLD`; with `~>`
//! instead of the arrow, it replaces the first `OLD` in the text. The mark `‸` in `NEW` is where the error must point, and is
//! removed; `\n` is a line end. Bases are files in the same folder, called `BASE.base`. Lines that begin with `#` are headings.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

struct Case {
    line: usize,
    text: String,
    /// Line and column where the error must point.
    place: Option<(usize, usize)>,
    words: Vec<String>,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad")
}

fn cases(kind: &str) -> Vec<Case> {
    let table = std::fs::read_to_string(folder().join(format!("{kind}.cases"))).unwrap();
    let lines =
        table.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    lines.map(|(number, line)| case(number + 1, line)).collect()
}

fn case(line: usize, text: &str) -> Case {
    let mut parts = text.split(" :: ");
    let change = parts.next().unwrap();
    let words: Vec<String> = parts.map(str::to_owned).collect();
    assert!(!words.is_empty(), "line {line} has no expected words");
    let (base, change) = change.split_once(": ").unwrap();
    let whole = change.contains(" => ");
    let (old, new) = change.split_once(if whole { " => " } else { " ~> " }).unwrap();
    let base = std::fs::read_to_string(folder().join(format!("{base}.base"))).unwrap();
    let begins = if whole {
        base.starts_with(old).then_some(0).or_else(|| base.find(&format!("\n{old}")).map(|at| at + 1))
    } else {
        base.find(old)
    };
    let begins = begins.unwrap_or_else(|| panic!("line {line}: the base has no {old:?}"));
    let ends = if whole {
        base[begins..].find('\n').map_or(base.len(), |end| begins + end)
    } else {
        begins + old.len()
    };
    let marked = format!("{}{}{}", &base[..begins], new.replace("\\n", "\n"), &base[ends..]);
    let place = marked.find('‸').map(|mark| {
        let before = &marked[..mark];
        (before.matches('\n').count() + 1, before.rsplit('\n').next().unwrap().chars().count() + 1)
    });
    Case { line, text: marked.replace('‸', ""), place, words }
}

/// Checks that every case of a table ends with exit code 3 and the expected words; `ask` runs the command, `place` formats a location.
fn all_are_refused(
    kind: &str,
    least: usize,
    ask: impl Fn(&Path, &str) -> Output,
    place: impl Fn(usize, usize) -> String,
) {
    let cases = cases(kind);
    assert!(cases.len() >= least, "{} cases", cases.len());
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for case in &cases {
        let output = ask(folder.path(), &case.text);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let place = case.place.map(|(line, column)| place(line, column));
        let missing: Vec<&String> =
            case.words.iter().chain(&place).filter(|words| !said.contains(words.as_str())).collect();
        if output.status.code() != Some(3) || !output.stdout.is_empty() || !missing.is_empty() {
            wrong.push(format!(
                "line {}: ends with {:?}, lacks {missing:?}\n{said}",
                case.line,
                output.status.code()
            ));
        }
    }
    assert!(wrong.is_empty(), "{} of {} of {kind}.cases:\n\n{}", wrong.len(), cases.len(), wrong.join("\n"));
}

fn stripmine(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stripmine")).args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn bad_scenes_are_refused() {
    let ask = |folder: &Path, text: &str| {
        std::fs::write(folder.join("scene.toml"), text).unwrap();
        stripmine(folder, &["scene", "check", "scene.toml"])
    };
    all_are_refused("scene", 130, ask, |line, column| format!("scene.toml:{line}:{column}: "));
}

#[test]
fn bad_start_files_are_refused() {
    let scene = std::fs::read_to_string(folder().join("start.base")).unwrap();
    let ask = |folder: &Path, text: &str| {
        std::fs::write(folder.join("start.xyz"), text).unwrap();
        std::fs::write(folder.join("scene.toml"), &scene).unwrap();
        stripmine(folder, &["scene", "check", "scene.toml"])
    };
    all_are_refused("start-file", 40, ask, |line, column| format!("start.xyz:{line}:{column}: "));
}

#[test]
fn bad_machine_files_are_refused() {
    let ask = |folder: &Path, text: &str| {
        std::fs::write(folder.join("machine.toml"), text).unwrap();
        stripmine(folder, &["table", "--machine", "machine.toml"])
    };
    all_are_refused("machine", 30, ask, |line, column| format!("machine.toml:{line}:{column}: "));
}

#[test]
fn bad_host_files_are_refused() {
    let host = stripmine::model::host::default_model().unwrap().to_toml().unwrap();
    let ask = |folder: &Path, change: &str| {
        // The base is long and is not kept twice: the text of a case is the change, old and new.
        let (old, new) = change.trim_end().split_once('\n').unwrap();
        assert!(host.contains(old), "{old}");
        std::fs::write(folder.join("host.toml"), host.replacen(old, new, 1)).unwrap();
        stripmine(folder, &["validate-model", "--host", "host.toml"])
    };
    all_are_refused("host", 15, ask, |line, column| format!("host.toml:{line}:{column}: "));
}

/// Sixty messages, spread over all tables: each paragraph has the mistake, then the expectation, then the advice.
#[test]
fn messages_have_three_parts() {
    let folder = tempfile::tempdir().unwrap();
    let scene = std::fs::read_to_string(self::folder().join("start.base")).unwrap();
    let (mut checked, mut faults) = (0, vec![]);
    for (kind, every, file, arguments) in [
        ("scene", 8, "scene.toml", ["scene", "check", "scene.toml"]),
        ("start-file", 3, "start.xyz", ["scene", "check", "scene.toml"]),
        ("machine", 3, "machine.toml", ["table", "--machine", "machine.toml"]),
    ] {
        for case in cases(kind).iter().step_by(every) {
            std::fs::write(folder.path().join("scene.toml"), &scene).unwrap();
            std::fs::write(folder.path().join(file), &case.text).unwrap();
            let said = stripmine(folder.path(), &arguments).stderr;
            let said = String::from_utf8_lossy(&said).into_owned();
            // With several mistakes, their number comes first.
            for paragraph in said.split("\n\n").filter(|it| it.contains(".toml:") && it.contains("\n  ")) {
                let parts = ["\n  expected: ", "\n  help: "].map(|part| paragraph.find(part));
                if !matches!(parts, [Some(expected), Some(help)] if expected < help) {
                    faults.push(format!("{kind}.cases:{}: {paragraph}", case.line));
                }
                checked += 1;
            }
            let lone = said.split("\n\n").filter(|it| it.contains(".toml:") && !it.trim_end().contains('\n'));
            faults.extend(lone.map(|it| format!("{kind}.cases:{}: {it}", case.line)));
        }
    }
    assert!(checked >= 60, "{checked} messages");
    assert!(faults.is_empty(), "{} of {checked}:\n{}", faults.len(), faults.join("\n\n"));
}
