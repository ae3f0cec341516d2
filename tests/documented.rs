//! Commands of the documents are run, and their shown output is compared.
//!
//! A block ```` ```console ```` has lines `$ COMMAND`, each followed by its output, or by nothing where the output is not shown. `[..]` stands for any
//! characters of a line, a line `…` for any number of lines, and a line `? 3` says that the command ends with exit code 3. Blocks of one document share a
//! folder. Blocks marked `console,slow` are run by the long suite. With `STRIPMINE_BLESS=1` outputs that differ are replaced.

#![cfg(unix)]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use assert_cmd::Command as Timed;

/// A command with the output that a document shows.
#[derive(Debug, PartialEq)]
struct Shown {
    /// Line of the command, from 1.
    line: usize,
    command: String,
    code: i32,
    output: Vec<String>,
    is_slow: bool,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// README and documents.
fn documents() -> Vec<PathBuf> {
    let mut found = vec![root().join("README.md"), root().join("python/README.md")];
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|it| it == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Commands of a document, in order.
fn shown(text: &str) -> Vec<Shown> {
    let mut found: Vec<Shown> = vec![];
    let mut block = None;
    for (at, line) in text.lines().enumerate() {
        match (block, line.strip_prefix("```")) {
            (None, Some(kind)) => block = Some(kind),
            (Some(_), Some("")) => block = None,
            (Some(kind @ ("console" | "console,slow")), None) => {
                if let Some(command) = line.strip_prefix("$ ") {
                    let command = command.to_owned();
                    found.push(Shown {
                        line: at + 1,
                        command,
                        code: 0,
                        output: vec![],
                        is_slow: kind != "console",
                    });
                } else if let Some(code) = line.strip_prefix("? ") {
                    found.last_mut().expect("a command before its exit code").code = code.parse().unwrap();
                } else {
                    found.last_mut().expect("a command before its output").output.push(line.to_owned());
                }
            }
            _ => {}
        }
    }
    found
}

/// True if a line is as the pattern says, in which `[..]` stands for any characters.
fn fits(pattern: &str, line: &str) -> bool {
    let mut parts = pattern.split("[..]");
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = line.strip_prefix(first) else { return false };
    let mut parts = parts.peekable();
    if parts.peek().is_none() {
        return rest.is_empty();
    }
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return rest.ends_with(part);
        }
        match rest.find(part) {
            Some(at) => rest = &rest[at + part.len()..],
            None => return false,
        }
    }
    true
}

/// True if an output is as the patterns say, of which `…` stands for any number of lines.
fn agrees(patterns: &[String], lines: &[&str]) -> bool {
    match (patterns.split_first(), lines.split_first()) {
        (None, None) => true,
        (Some((pattern, others)), _) if pattern == "…" => {
            (0..=lines.len()).any(|skipped| agrees(others, &lines[skipped..]))
        }
        (Some((pattern, others)), Some((line, rest))) => fits(pattern, line) && agrees(others, rest),
        _ => false,
    }
}

/// Runs the commands of a document in a folder of its own. Returns what differs, and the text with the outputs that came out.
fn run(document: &Path, is_wanted: impl Fn(&Shown) -> bool) -> (Vec<String>, String) {
    let text = fs::read_to_string(document).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let folder = tempfile::tempdir().unwrap();
    for linked in ["docs", "reports", "python"] {
        std::os::unix::fs::symlink(root().join(linked), folder.path().join(linked)).unwrap();
    }
    let program = Path::new(env!("CARGO_BIN_EXE_stripmine")).parent().unwrap();
    let path = std::env::join_paths(
        [program.to_owned()].into_iter().chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
    );
    let path = path.unwrap();
    let mut faults = vec![];
    // From the last to the first when lines are replaced, for their numbers.
    let mut replaced = vec![];
    for it in shown(&text).into_iter().filter(is_wanted) {
        let mut command = Command::new("sh");
        command.args(["-c", &format!("{{ {}\n}} 2>&1", it.command)]).current_dir(folder.path());
        command.env("PATH", &path).env("COLUMNS", "80").env("NO_COLOR", "1");
        command.env("XDG_CACHE_HOME", folder.path().join("cache"));
        let output = Timed::from_std(command).timeout(Duration::from_secs(300)).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let said: Vec<&str> = said.lines().map(str::trim_end).collect();
        let mut fault = String::new();
        if output.status.code() != Some(it.code) {
            write!(fault, "ends with {:?}, not {}", output.status.code(), it.code).unwrap();
        } else if !it.output.is_empty() && !agrees(&it.output, &said) {
            fault.push_str("has another output");
        }
        if !fault.is_empty() {
            let name = document.strip_prefix(root()).unwrap().display();
            faults.push(format!("{name}:{}: `{}` {fault}:\n{}", it.line, it.command, said.join("\n")));
            let first = it.line + usize::from(it.code != 0);
            let new = said.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>();
            replaced.push((first..first + it.output.len(), new));
        }
    }
    for (range, new) in replaced.into_iter().rev() {
        lines.splice(range, new);
    }
    (faults, lines.join("\n") + "\n")
}

fn check(is_wanted: impl Fn(&Shown) -> bool + Copy) {
    let mut faults = vec![];
    for document in documents() {
        let (found, text) = run(&document, is_wanted);
        if !found.is_empty() && std::env::var_os("STRIPMINE_BLESS").is_some() {
            fs::write(&document, text).unwrap();
        }
        faults.extend(found);
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n\n"));
}

#[test]
fn commands_of_documents_give_the_shown_output() {
    check(|it| !it.is_slow);
}

#[test]
#[ignore = "takes minutes"]
fn slow_commands_of_documents_give_the_shown_output() {
    check(|it| it.is_slow);
}

/// A command in a block that nothing runs may be wrong without anyone noticing.
#[test]
fn commands_are_in_blocks_that_are_run() {
    let mut faults = vec![];
    // `tests/gallery.rs` runs the commands of the gallery.
    for document in documents().into_iter().filter(|it| !it.ends_with("docs/gallery.md")) {
        let text = fs::read_to_string(&document).unwrap();
        let run: Vec<usize> = shown(&text).iter().map(|it| it.line).collect();
        for (at, line) in text.lines().enumerate() {
            let command = line.trim_start_matches("$ ");
            if command.starts_with("stripmine ") && is_unchecked(&text, at) && !run.contains(&(at + 1)) {
                faults.push(format!(
                    "{}:{}: {line}",
                    document.strip_prefix(root()).unwrap().display(),
                    at + 1
                ));
            }
        }
    }
    assert!(faults.is_empty(), "{} commands that are not run:\n{}", faults.len(), faults.join("\n"));
}

/// True if a line is in a block whose commands nothing runs. Blocks of kind `text,printed` show what one
/// machine printed.
fn is_unchecked(text: &str, at: usize) -> bool {
    let mut block = None;
    for line in text.lines().take(at) {
        if let Some(kind) = line.strip_prefix("```") {
            block = if block.is_none() { Some(kind) } else { None };
        }
    }
    block.is_some_and(|kind| !kind.starts_with("console") && kind != "text,printed")
}

#[test]
fn patterns_stand_for_what_they_leave_out() {
    assert!(fits("took [..] s of [..]", "took 1.5 s of 3"));
    assert!(!fits("took [..] s", "took 1.5 min"));
    let patterns = ["a", "…", "c[..]"].map(str::to_owned);
    assert!(
        agrees(&patterns, &["a", "b", "b", "cd"])
            && agrees(&patterns, &["a", "c"])
            && !agrees(&patterns, &["a", "b"])
    );
    let text = "```console\n$ false\n? 1\n$ stripmine x  # y\none\n```\n```console,slow\n$ z\n```\n";
    let found = shown(text);
    assert_eq!(found.len(), 3);
    assert_eq!((found[0].code, found[1].output.len(), found[2].is_slow), (1, 1, true));
}
