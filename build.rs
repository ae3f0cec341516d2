//! Notes which source the program is built from, so that every report can say so.

#![expect(
    clippy::disallowed_methods,
    reason = "a build without git, or with a compiler that does not say its version, is one of no known commit"
)]

use std::path::{Path, PathBuf};
use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    // Git would write what it has looked at to its index, which is looked at for changes: the next build would do everything again.
    let output = Command::new("git").arg("--no-optional-locks").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// The compiler, and the flags that it is given beside those of the profile.
fn compiler() -> String {
    let of = |name: &str| std::env::var(name).unwrap_or_default();
    let said = Command::new(of("RUSTC")).arg("--version").output().ok();
    let version =
        said.map_or_else(String::new, |said| String::from_utf8_lossy(&said.stdout).trim().to_owned());
    // `rustc 1.90.0 (1159e78c4 2025-09-14)`: the number says it all.
    let version = version.split(" (").next().unwrap_or_default().to_owned();
    let flags = of("CARGO_ENCODED_RUSTFLAGS").replace('\x1f', " ");
    let flags = if flags.is_empty() { String::new() } else { format!(" {flags}") };
    format!("{version}, profile {}{flags}", of("PROFILE"))
}

/// Rooms of the physics that no result of a study depends on: files, records, processes.
const OUTSIDE: [&str; 3] = ["io", "ranks", "run"];

/// A fingerprint of a crate's code: every file, without blank lines, comments on lines of their own, and unit tests.
fn fingerprint(folder: &Path) -> String {
    let mut files = vec![];
    sources(folder, &mut files);
    files.sort();
    // FNV-1a, 64 bits.
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
        let lines = code.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
        for byte in lines.flat_map(|line| line.bytes().chain([b'\n'])) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    format!("{hash:016x}")
}

fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        let name = name.to_string_lossy();
        if path.is_dir() && name != "tests" && !OUTSIDE.contains(&&*name) {
            sources(&path, files);
        } else if name.ends_with(".rs") && name != "tests.rs" {
            files.push(path);
        }
    }
}

fn main() {
    // Outside a checkout (a source package) there is no commit to name.
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).unwrap_or_else(|| "unknown".to_owned());
    let sources = ["src", "kernels", "claims", "pages", "Cargo.toml", "Cargo.lock", "build.rs"];
    let changes = git(&[&["status", "--porcelain", "--"], &sources[..]].concat());
    let dirty = changes.is_some_and(|changes| !changes.is_empty());
    println!("cargo::rustc-env=STRIPMINE_COMMIT={commit}");
    println!("cargo::rustc-env=STRIPMINE_DIRTY={dirty}");
    println!("cargo::rustc-env=STRIPMINE_TARGET={}", std::env::var("TARGET").unwrap_or_default());
    println!("cargo::rustc-env=STRIPMINE_COMPILER={}", compiler());
    for (name, folder) in [("KERNELS", "kernels/src"), ("PHYSICS", "kernels/physics/src")] {
        println!("cargo::rustc-env=STRIPMINE_{name}={}", fingerprint(Path::new(folder)));
    }
    // A release has pages and claims in it; a development build reads their files when it runs.
    if std::env::var("PROFILE").is_ok_and(|profile| profile == "release") {
        ["claims", "pages"].iter().for_each(|path| println!("cargo::rerun-if-changed={path}"));
    }
    for path in ["src", "kernels", "build.rs", "Cargo.toml", "Cargo.lock", ".git/HEAD", ".git/index"] {
        println!("cargo::rerun-if-changed={path}");
    }
}
