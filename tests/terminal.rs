//! Output of the commands as a terminal of 80 columns and a pipe show it: its width, a line for each quantity, and the numbers of its data.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Width of a page, which a pipe gets, and of a narrow terminal (characters).
const WIDTHS: [(Option<&str>, usize); 2] = [(None, 100), (Some("80"), 80)];

fn stripmine(folder: &Path, arguments: &[&str], columns: Option<&str>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.current_dir(folder).env_remove("COLUMNS").env("XDG_CACHE_HOME", folder.join("cache"));
    if let Some(columns) = columns {
        command.env("COLUMNS", columns);
    }
    command.args(arguments).stdin(Stdio::null()).output().unwrap()
}

/// Standard output of a command that succeeds, in a terminal of 80 columns.
fn shown(folder: &Path, arguments: &[&str]) -> String {
    let output = stripmine(folder, arguments, Some("80"));
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn read(path: &Path) -> Value {
    json(&fs::read_to_string(path).unwrap())
}

/// Free particles in a bath with kT = γ = 1, whose diffusion constant is kT/γ = 1.
const FREE: &str = "langevin-free --set output.structure=[\"msd\"] --set output.structure_share=1000.0 --set run.time=1000 \
                    --set run.thermo_every=50 --set particles.count=100 --quiet";

/// Commands with printed tables or texts, in an order in which each finds the runs that it reads.
const COMMANDS: &[&str] = &[
    "scene list",
    "scene keys",
    "scene keys hard-disks",
    "scene keys langevin",
    "scene keys nbody",
    "scene keys wall",
    "scene check pipe",
    "scene check two-discs --set integrator.dt=0.015",
    "scene check langevin-dense",
    "scene check hard-disks",
    "scene check plummer",
    "scene programs two-discs",
    "scene programs two-discs --listing",
    "listing forces",
    "table",
    "table --all",
    "table --ladder --machine cray-1",
    "table bench --host --set particles.count=50",
    "run two-discs --set run.thermo_every=20",
    "run langevin-dense --set particles.count=50 --set run.time=4 --set output.structure=[\"g(r)\",\"msd\"]",
    "run hard-disks --set particles.count=50 --set run.time=20",
    "run kepler --set run.thermo_every=20",
    "run hard-disks --set particles.count=50 --set run.time=20 --seeds 3",
    "average two-discs",
    "average langevin-dense",
    "average langevin-dense --structure g(r)",
    "average hard-disks",
    "average hard-disks.seeds",
    "plot two-discs",
    "plot langevin-dense",
    "plot hard-disks",
    "plot kepler",
    "scan hard-disks --over particles.packing_fraction=0.1,0.2 --set particles.count=50 --set run.time=20",
    "average hard-disks.scan",
    "compare two-discs --against integrator.dt=0.0005",
    "compare hard-disks --set particles.count=50 --set run.time=20 --against particles.seed=7",
    "bench hard-disks --particles 50 --collisions 500 --repeats 1",
    "bench lattice --particles 100 --steps 5 --repeats 1 --threads 1,2",
    "price kernel.json",
    "emit two-discs --isa rvv --out code",
    "explain kepler --seconds 1",
    "explain hard-disks --set particles.count=50 --set run.time=20 --seconds 1",
];

/// Kernel of a user: the length of a vector.
const KERNEL: &str = r#"{
    "inputs": ["x", "y"],
    "nodes": [
        {"input": [0, 0]}, {"input": [1, 0]},
        {"binary": ["multiply", 0, 0]}, {"binary": ["multiply", 1, 1]},
        {"binary": ["add", 2, 3]}, {"unary": ["square_root", 4]}
    ],
    "outputs": [["length", 5]]
}"#;

#[test]
fn no_command_prints_wider_than_its_page() {
    for (columns, most) in WIDTHS {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("kernel.json"), KERNEL).unwrap();
        for line in COMMANDS {
            let arguments: Vec<&str> = line.split(' ').collect();
            let output = stripmine(folder.path(), &arguments, columns);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success(), "{line}: {said}");
            let text = String::from_utf8(output.stdout).unwrap();
            assert!(!text.is_empty(), "{line}");
            for shown in text.lines() {
                assert!(shown.chars().count() <= most, "{line}, within {most}: {shown}");
                assert_eq!(shown.trim_end(), shown, "{line}");
            }
        }
    }
}

/// Lattice scenes have the most quantities. A table of them has four lines more: title, rules and headings.
#[test]
fn every_quantity_has_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let sets = ["--set", "run.steps=2000", "--set", "run.thermo_every=20", "--set", "run.snapshot_every=0"];
    shown(folder, &[&["run", "shaken-box", "--quiet"][..], &sets].concat());
    let averages = read(&folder.join("shaken-box.run/summary.json"))["averages"]["quantities"].clone();
    let names: Vec<&str> =
        averages.as_array().unwrap().iter().map(|it| it["quantity"].as_str().unwrap()).collect();
    let table = fs::read_to_string(folder.join("shaken-box.run/thermo.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let changes = |name: &&&str| {
        let column = rows[0].iter().position(|it| *it == **name).unwrap();
        rows[1..].iter().any(|row| row[column] != rows[1][column])
    };
    for (command, count) in [("average", names.len()), ("plot", names.iter().filter(changes).count())] {
        let text = shown(folder, &[command, "shaken-box"]);
        assert!(count > 10, "{command}: {count}");
        let end = text.lines().skip(2).position(|line| line.starts_with('─')).unwrap() + 2;
        assert_eq!(end, 4 + count, "{command}: {text}");
        for line in text.lines().skip(4).take(count) {
            assert!(names.iter().any(|name| line.split_whitespace().next() == Some(name)), "{line}");
        }
    }
}

/// The mean and its error bar after a name in a text, as printed.
fn printed<'t>(text: &'t str, name: &str) -> Vec<&'t str> {
    let line = text.lines().map(str::trim).find(|line| line.starts_with(name));
    let line = line.unwrap_or_else(|| panic!("{name} is not in: {text}"));
    line[name.len()..].split_whitespace().filter(|word| *word != "±").take(2).collect()
}

/// Checks that a printed number is a number of the data, rounded to its digits.
fn agrees(printed: &str, value: &Value) {
    let value = value.as_f64().unwrap();
    let decimals = printed.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    assert_eq!(format!("{value:.decimals$}"), printed);
}

#[test]
fn run_ends_with_the_numbers_of_its_summary() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let free: Vec<&str> = FREE.split(' ').filter(|word| !word.is_empty()).collect();
    let text = shown(folder, &[&["run"][..], &free, &["--out", "one"]].concat());
    let summary = read(&folder.join("one/summary.json"));
    let means = summary["averages"]["quantities"].as_array().unwrap();
    let known: Vec<&Value> = means.iter().filter(|it| it["says"] == "mean").collect();
    assert!(!known.is_empty());
    for it in known {
        let [mean, bar] =
            printed(&text, &format!("{} ", it["quantity"].as_str().unwrap())).try_into().unwrap();
        agrees(mean, &it["mean"]);
        agrees(bar, &it["bar"]);
    }
    let number = &summary["structure"][0]["headlines"][0];
    assert_eq!(number["name"], "diffusion constant");
    let [value, bar] = printed(&text, "msd: diffusion constant ").try_into().unwrap();
    agrees(value, &number["mean"]);
    agrees(bar, &number["bar"]);
    let [value, bar] = [value, bar].map(|it| it.parse::<f64>().unwrap());
    assert!((value - 1.0).abs() < 2.0 * bar && bar < 0.2, "{value} ± {bar}");
}

/// Means of both configurations are those of two runs; their difference over √(s₁² + s₂²), summed here, is what the table shows.
#[test]
fn compared_means_are_those_of_two_runs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = ["--set", "particles.count=60", "--set", "run.time=100", "--set", "run.thermo_every=0.1"];
    let other = "particles.packing_fraction=0.35";
    shown(folder, &[&["run", "hard-disks", "--quiet", "--out", "first"][..], &scene].concat());
    shown(
        folder,
        &[&["run", "hard-disks", "--quiet", "--out", "second", "--set", other][..], &scene].concat(),
    );
    let [first, second] = ["first", "second"]
        .map(|run| read(&folder.join(run).join("summary.json"))["averages"]["quantities"].clone());
    let of = |run: &Value, name: &str, key: &str| {
        let all = run.as_array().unwrap();
        all.iter().find(|it| it["quantity"] == name).unwrap()[key].as_f64().unwrap()
    };
    let name = "compressibility";
    let [one, two] = [&first, &second].map(|run| ["mean", "standard_error"].map(|key| of(run, name, key)));
    let sigmas = (two[0] - one[0]) / (one[1] * one[1] + two[1] * two[1]).sqrt();
    assert!(sigmas.abs() > 10.0, "{sigmas}");
    let compare = [&["compare", "hard-disks", "--quiet", "--against", other][..], &scene].concat();
    let found = json(&shown(folder, &[&compare[..], &["--json"]].concat()));
    let means = found["means"].as_array().unwrap();
    let mean = means.iter().find(|it| it["first"]["quantity"] == name).unwrap();
    assert_eq!([&mean["first"]["mean"], &mean["second"]["mean"]], [one[0], two[0]]);
    assert!((mean["sigmas"].as_f64().unwrap() / sigmas - 1.0).abs() < 1e-12, "{mean} {sigmas}");
    let text = shown(folder, &compare);
    let row = text.lines().find(|line| line.trim_start().starts_with(name)).unwrap();
    assert!(row.ends_with(&format!(" {sigmas:.1}")), "{row}");
}

/// Positions are compared at the same times, not after as many steps.
#[test]
fn configurations_with_other_steps_end_together() {
    let folder = tempfile::tempdir().unwrap();
    let compare = ["compare", "kepler", "--set", "run.time=2", "--set", "integrator.dt=0.01"];
    let text = shown(folder.path(), &[&compare[..], &["--against", "integrator.dt=0.005"]].concat());
    assert!(!text.contains("ends at time"), "{text}");
    let steps = ["compare", "kepler", "--set", "run.steps=100", "--set", "integrator.dt=0.01"];
    let text = shown(folder.path(), &[&steps[..], &["--against", "integrator.dt=0.005"]].concat());
    assert!(text.contains("The second configuration ends at time 0.5, not 1"), "{text}");
}
