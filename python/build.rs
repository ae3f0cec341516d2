//! Records the source commit of the package, which is stored with each run.

use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    // Without this option git refreshes its index. Cargo watches the index, and would rebuild everything next time.
    let output =
        Command::new("git").arg("--no-optional-locks").args(arguments).current_dir("..").output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn main() {
    // A source package outside a checkout has no commit.
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).unwrap_or_else(|| "unknown".to_owned());
    let sources =
        ["kernels", "Cargo.toml", "python/src", "python/Cargo.toml", "python/Cargo.lock", "python/build.rs"];
    let changes = git(&[&["status", "--porcelain", "--"], &sources[..]].concat());
    let is_dirty = changes.is_some_and(|changes| !changes.is_empty());
    println!("cargo::rustc-env=STRIPMINE_COMMIT={commit}");
    println!("cargo::rustc-env=STRIPMINE_DIRTY={is_dirty}");
    println!("cargo::rustc-env=STRIPMINE_TARGET={}", std::env::var("TARGET").unwrap_or_default());
    for path in ["../kernels", "../.git/HEAD", "../.git/index", "src", "build.rs", "Cargo.toml", "Cargo.lock"]
    {
        println!("cargo::rerun-if-changed={path}");
    }
}
