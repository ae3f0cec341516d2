//! Notes which source the program is built from, so that every report can say so.

use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
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
    for path in ["src", "kernels", "build.rs", "Cargo.toml", "Cargo.lock", ".git/HEAD", ".git/index"] {
        println!("cargo::rerun-if-changed={path}");
    }
}
