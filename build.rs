//! Notes which source the program is built from, so that every report can say so.

use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
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

fn main() {
    // Outside a checkout (a source package) there is no commit to name.
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).unwrap_or_else(|| "unknown".to_owned());
    let sources = ["src", "kernels", "Cargo.toml", "Cargo.lock", "build.rs"];
    let changes = git(&[&["status", "--porcelain", "--"], &sources[..]].concat());
    let dirty = changes.is_some_and(|changes| !changes.is_empty());
    println!("cargo::rustc-env=STRIPMINE_COMMIT={commit}");
    println!("cargo::rustc-env=STRIPMINE_DIRTY={dirty}");
    println!("cargo::rustc-env=STRIPMINE_TARGET={}", std::env::var("TARGET").unwrap_or_default());
    println!("cargo::rustc-env=STRIPMINE_COMPILER={}", compiler());
    for path in ["src", "kernels", "build.rs", "Cargo.toml", "Cargo.lock", ".git/HEAD", ".git/index"] {
        println!("cargo::rerun-if-changed={path}");
    }
}
