//! Pair potentials of a user's table in Langevin scenes: an oscillation with a known period, the fluid of the built-in law, equal bits, rows that
//! are refused, pairs below the first row, resumption.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::law::lennard_jones::LennardJones;
use stripmine_kernels::law::potential::PairPotential;

fn begin(scene: &str, out: &Path, sets: &[&str], more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(["run", scene, "--json", "--quiet", "--out", out.to_str().unwrap()]).args(more);
    sets.iter().for_each(|set| {
        command.args(["--set", set]);
    });
    command.stdin(Stdio::null()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout)
}

fn run(scene: &str, out: &Path, sets: &[&str]) -> Value {
    let output = begin(scene, out, sets, &[]);
    assert!(output.status.success(), "{}", said(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Columns of thermo.csv by name.
fn columns<const N: usize>(folder: &Path, names: [&str; N]) -> [Vec<f64>; N] {
    let text = fs::read_to_string(folder.join("thermo.csv")).unwrap();
    let heading: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    names.map(|name| {
        let place = heading.iter().position(|column| *column == name).unwrap();
        text.lines().skip(1).map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
    })
}

/// Text of the last frame.
fn last_frame(folder: &Path) -> String {
    let text = fs::read_to_string(folder.join("trajectory.xyz")).unwrap();
    text[text.rfind("Lattice").unwrap()..].to_owned()
}

/// Table of a potential at distances from `first` to `last`.
fn table(path: &Path, [first, last]: [f64; 2], rows: u32, of: impl Fn(f64) -> f64) -> String {
    let r = |row: u32| first + (last - first) * f64::from(row) / f64::from(rows);
    let rows: String = (0..=rows).map(r).map(|r| format!("{r},{}\n", of(r))).collect();
    fs::write(path, format!("r,U\n{rows}")).unwrap();
    format!("law.file={}", path.display())
}

/// Two particles in a harmonic table oscillate with ω = √(k/μ) = √(100/0.5): their potential energy is k a² cos²(ωt)/2 beyond that of the minimum.
/// Without friction energy and momentum are conserved.
#[test]
fn harmonic_table_oscillates_as_calculated() {
    let folder = tempfile::tempdir().unwrap();
    let file = table(&folder.path().join("spring.csv"), [1.0, 2.0], 40, |r| 50.0 * (r - 1.5).powi(2));
    let sets = [
        "law.kind=table",
        &file,
        "law.drag=0",
        "integrator.kind=stochastic",
        "particles.generate=list",
        "particles.radius=0.5",
        "particles.positions=[[20.0, 20.0], [21.6, 20.0]]",
        "particles.velocities=[[0.3, 0.2], [0.3, 0.2]]",
        "integrator.dt=0.001",
        "run.time=3",
        "run.thermo_every=1",
    ];
    run("langevin-free", folder.path().join("two").as_path(), &sets);
    let [time, kinetic, potential, along, across] =
        columns(&folder.path().join("two"), ["time", "kinetic", "potential", "momentum_x", "momentum_y"]);
    let omega = 200f64.sqrt();
    let mut largest = [0.0_f64; 3];
    for (at, time) in time.iter().enumerate() {
        let exact = 0.5 * (omega * time).cos().powi(2) - 12.5;
        largest[0] = largest[0].max((potential[at] - exact).abs());
        let moved = (along[at] - 0.6).abs().max((across[at] - 0.4).abs());
        largest[1] = largest[1].max(moved);
        largest[2] = largest[2].max((kinetic[at] + potential[at] - kinetic[0] - potential[0]).abs());
    }
    assert!(
        time.len() == 3001 && largest[0] < 5e-4 && largest[1] < 1e-12 && largest[2] < 1e-4,
        "{largest:?}"
    );
}

/// A fluid by the rows of Lennard-Jones has the potential energy of the built-in law at the start, and after a while with the same noise still its
/// particles; with rows twice as dense it is at least twice as near.
#[test]
fn fluid_by_table_approaches_the_builtin_law() {
    let folder = tempfile::tempdir().unwrap();
    let exact = LennardJones::new(1.0, 1.0);
    let fluid = [
        "particles.count=300",
        "domain.sides=[24.0, 24.0]",
        "integrator.dt=0.001",
        "run.time=0.2",
        "run.thermo_every=200",
    ];
    let out = |name: &str| folder.path().join(name);
    run("langevin-dense", &out("exact"), &[&fluid[..], &["law.kind=lennard-jones"]].concat());
    let [reference] = columns(&out("exact"), ["potential"]);
    let off = [400, 800].map(|rows| {
        let file = table(&out(&format!("{rows}.csv")), [0.7, 2.5], rows, |r| exact.energy(r));
        let name = rows.to_string();
        run("langevin-dense", &out(&name), &[&fluid[..], &["law.kind=table", &file]].concat());
        let [found] = columns(&out(&name), ["potential"]);
        [0, 1].map(|at| (found[at] - reference[at]).abs())
    });
    assert!(off[0][0] < 1e-4 && off[0][1] < 1e-2, "{off:?}");
    assert!([0, 1].iter().all(|&at| off[0][at] > 2.0 * off[1][at]), "{off:?}");
}

/// Every instruction set, search and precision: the same bits on all instruction sets and threads; a factor of the strength is one of the energy.
#[test]
fn tables_give_equal_bits_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let exact = LennardJones::new(1.0, 1.0);
    let file = table(&folder.path().join("wca.csv"), [0.7, 1.12], 100, |r| exact.energy(r));
    let fluid = ["law.kind=table", &file, "particles.count=300", "domain.sides=[24.0, 24.0]", "run.time=0.2"];
    for precision in ["f64", "f32", "mixed"] {
        for search in ["lattice", "sectors", "neighbor-list"] {
            let mut frames = vec![];
            for set in InstructionSet::available() {
                let out = folder.path().join(format!("{precision}-{search}-{}", set.name()));
                let own = [
                    &format!("search.by={search}"),
                    &format!("machine.precision={precision}"),
                    &format!("machine.instruction_set={}", set.name()),
                ];
                let sets = [&fluid[..], &own.map(String::as_str)].concat();
                let threads = if frames.is_empty() { "1" } else { "3" };
                let output = begin("langevin-dense", &out, &sets, &["--threads", threads]);
                assert!(output.status.success(), "{}", said(&output));
                frames.push(last_frame(&out));
            }
            assert!(frames.iter().all(|frame| *frame == frames[0]), "{precision} {search}");
        }
    }
    let potential = |name: &str, strength: &str| {
        let out = folder.path().join(name);
        let two = [
            "particles.generate=list",
            "particles.radius=0.5",
            "particles.positions=[[20.0, 20.0], [21.05, 20.0]]",
        ];
        run("langevin-free", &out, &[&["law.kind=table", &file, "run.time=0", strength][..], &two].concat());
        columns(&out, ["potential"])[0][0]
    };
    let [once, thrice] = [potential("once", "law.strength=1"), potential("thrice", "law.strength=3")];
    assert!(once > 0.0 && (thrice / once - 3.0).abs() < 1e-12, "{once} {thrice}");
}

/// Mistakes of a table are refused with its file and line.
#[test]
fn wrong_tables_are_refused_with_their_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pair.csv");
    let file = format!("law.file={}", path.display());
    let good: Vec<String> = (0..=30)
        .map(|row| 0.9 + 0.02 * f64::from(row))
        .map(|r| format!("{r},{},{}", 1.0 / r, 1.0 / (r * r)))
        .collect();
    let refused = |text: &str| {
        fs::write(&path, text).unwrap();
        let out = folder.path().join("refused");
        let output = begin("langevin-dense", &out, &["law.kind=table", &file], &[]);
        assert_eq!(output.status.code(), Some(3), "{}", said(&output));
        said(&output)
    };
    let with = |row: usize, text: &str| {
        let mut rows = good.clone();
        rows[row] = text.to_owned();
        format!("# distance, energy, force\nr,U,F\n\n{}\n", rows.join("\n"))
    };
    for (text, words) in [
        (with(3, "0.96,1e999,1.0"), &["pair.csv:7", "finite"][..]),
        (with(3, "0.96,NaN,1.0"), &["pair.csv:7", "finite"]),
        (with(3, "0.94,1.06,1.13"), &["pair.csv:7", "r = 0.94 after 0.94", "rise"]),
        (with(3, "0.96,1.04"), &["pair.csv:7", "2 fields"]),
        (with(3, "0.96,1.04,1.08,0"), &["pair.csv:7", "4 fields"]),
        (with(3, "0.96,much,1.08"), &["pair.csv:7", "`much`"]),
        (with(3, "0.96,1.0416666,-1.08"), &["pair.csv:7", "F = -1.08", "-dU/dr of the rows is 1.08"]),
        (with(3, "0.96,1.2,1.08"), &["pair.csv:4", "-dU/dr"]),
        ("1,2\n2,1\n".to_owned(), &["pair.csv", "2 rows", "at least 5"]),
        ("1.2,5\n1.3,4\n1.4,3\n1.5,2\n1.6,1\n".to_owned(), &["begins at r = 1.2", "radius >= 0.6"]),
    ] {
        let said = refused(&text);
        words.iter().for_each(|word| assert!(said.contains(word), "{word}: {said}"));
    }
    fs::remove_file(&path).unwrap();
    let output = begin("langevin-dense", &folder.path().join("none"), &["law.kind=table", &file], &[]);
    assert!(output.status.code() == Some(3) && said(&output).contains("cannot be read"), "{}", said(&output));
    let without = begin("langevin-dense", &folder.path().join("none"), &["law.kind=table"], &[]);
    assert!(said(&without).contains("law.file"), "{}", said(&without));
    let unused = begin("langevin-dense", &folder.path().join("none"), &[&file], &[]);
    assert!(said(&unused).contains("has no effect"), "{}", said(&unused));
    fs::write(&path, with(0, &good[0])).unwrap();
    let fine =
        begin("langevin-dense", &folder.path().join("fine"), &["law.kind=table", &file, "run.steps=1"], &[]);
    assert!(fine.status.success(), "{}", said(&fine));
}

/// Two particles that run into each other below the first row are named with their distance; run.most_lost counts them.
#[test]
fn pairs_below_the_first_row_are_lost() {
    let folder = tempfile::tempdir().unwrap();
    let file = table(&folder.path().join("soft.csv"), [0.9, 1.5], 60, |r| (1.5 - r).powi(2));
    let two = [
        "law.kind=table",
        &file,
        "law.drag=0",
        "particles.generate=list",
        "particles.radius=0.5",
        "particles.positions=[[20.0, 20.0], [22.0, 20.0], [30.0, 30.0]]",
        "particles.velocities=[[2.0, 0.0], [-2.0, 0.0], [0.0, 0.0]]",
        "integrator.dt=0.01",
        "run.time=1",
    ];
    let output = begin("langevin-free", &folder.path().join("ended"), &two, &[]);
    assert_eq!(output.status.code(), Some(4), "{}", said(&output));
    for word in ["2 particles were lost", "from particle", "nearer than 0.9", "soft.csv", "add rows"] {
        assert!(said(&output).contains(word), "{word}: {}", said(&output));
    }
    let summary =
        run("langevin-free", &folder.path().join("counted"), &[&two[..], &["run.most_lost=2"]].concat());
    assert!(summary.to_string().contains("\"lost\":2"), "{summary}");
    let checked = Command::new(env!("CARGO_BIN_EXE_stripmine"))
        .args(["scene", "check", "langevin-free"])
        .args(
            [&two[..], &["particles.velocities=[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]"]]
                .concat()
                .iter()
                .flat_map(|set| ["--set", set]),
        )
        .output()
        .unwrap();
    assert!(said(&checked).contains("the hardest collision has about"), "{}", said(&checked));
}

/// A folder that is moved with its table resumes to the bits of one run; with other rows it is refused.
#[test]
fn moved_run_resumes_with_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let exact = LennardJones::new(1.0, 1.0);
    let [here, there] = ["here", "there"].map(|name| folder.path().join(name));
    fs::create_dir_all(&here).unwrap();
    let file = table(&here.join("wca.csv"), [0.7, 1.12], 100, |r| exact.energy(r));
    let fluid = ["law.kind=table", &file, "particles.count=100", "domain.sides=[14.0, 14.0]"];
    run("langevin-dense", &folder.path().join("whole"), &[&fluid[..], &["run.steps=100"]].concat());
    run("langevin-dense", &here.join("run"), &[&fluid[..], &["run.steps=40"]].concat());
    fs::rename(&here, &there).unwrap();
    let file = format!("law.file={}", there.join("wca.csv").display());
    let fluid =
        ["law.kind=table", &file, "particles.count=100", "domain.sides=[14.0, 14.0]", "run.steps=100"];
    let resumed = || begin("langevin-dense", &there.join("run"), &fluid, &["--resume"]);
    let before = fs::read_to_string(there.join("wca.csv")).unwrap();
    fs::write(there.join("wca.csv"), before.replacen("0.7,", "0.701,", 1)).unwrap();
    let other = resumed();
    assert!(!other.status.success() && said(&other).contains("rows of this file"), "{}", said(&other));
    fs::write(there.join("wca.csv"), before).unwrap();
    let output = resumed();
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(last_frame(&there.join("run")), last_frame(&folder.path().join("whole")));
    let text = fs::read_to_string(there.join("run/scene.toml")).unwrap();
    assert!(text.contains("file = \"../wca.csv\"\n# rows of this file: SHA-256 "), "{text}");
}

/// The scene of the benchmark has no table, and no option gives it one: the message names the option and what to do.
#[test]
fn benchmarks_refuse_a_law_without_its_table() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    let output = command.args(["bench", "langevin", "--law", "table", "--quiet"]).output().unwrap();
    let said = said(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    for words in ["--law table: `law.file` is missing", "no option for this key", "stripmine run SCENE"] {
        assert!(said.contains(words), "{words} is not in: {said}");
    }
    assert!(!said.contains("langevin-report"), "{said}");
}
