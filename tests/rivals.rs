//! The scripts that measure rivals, as far as they run without them.

use std::path::Path;
use std::process::{Command, Output};

fn run(program: &str, folder: &Path, arguments: &[&str]) -> Output {
    Command::new(program).current_dir(folder).args(arguments).output().unwrap()
}

#[test]
fn changed_checkout_cannot_overwrite_committed_results() {
    let checkout = tempfile::tempdir().unwrap();
    let at = |name: &str| checkout.path().join(name);
    for folder in ["src", "tests/rivals", "src/study/rivals/measured"] {
        std::fs::create_dir_all(at(folder)).unwrap();
    }
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/rivals");
    for script in std::fs::read_dir(scripts).unwrap().map(Result::unwrap) {
        if script.file_type().unwrap().is_file() {
            std::fs::copy(script.path(), at("tests/rivals").join(script.file_name())).unwrap();
        }
    }
    std::fs::write(at("src/lib.rs"), "").unwrap();
    std::fs::write(at("src/study/rivals/measured/contests.json"), "").unwrap();
    let git = |arguments: &[&str]| {
        let who = ["-c", "user.name=n", "-c", "user.email=e", "-c", "commit.gpgsign=false"];
        let done = run("git", checkout.path(), &[&who, arguments].concat());
        assert!(done.status.success(), "{done:?}");
    };
    git(&["init", "--quiet"]);
    git(&["add", "src", "tests"]);
    git(&["commit", "--quiet", "--message", "all"]);
    // No program is measured: a call that is not refused ends without a result and without an error.
    let asked = |out: &str| {
        let call = ["-B", "tests/rivals/lammps.py", "--stripmine", "none", "--out", out];
        run("python3", checkout.path(), &call)
    };
    let code = |done: &Output| done.status.code();
    assert_eq!(code(&asked("src/study/rivals/measured")), Some(0));
    // Results are not sources: writing them does not count as a change.
    std::fs::write(at("src/study/rivals/measured/contests.json"), "1").unwrap();
    assert_eq!(code(&asked("src/study/rivals/measured")), Some(0));
    std::fs::write(at("src/lib.rs"), "// changed").unwrap();
    let refused = asked("src/study/rivals/measured");
    assert_eq!(code(&refused), Some(2), "{refused:?}");
    assert!(String::from_utf8_lossy(&refused.stderr).contains("choose another --out"), "{refused:?}");
    assert_eq!(code(&asked("elsewhere")), Some(0));
}
