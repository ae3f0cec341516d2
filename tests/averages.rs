//! Averages of runs, as a user meets them: at the end of a run, of its files, of several runs, and as the end of a run.

use assert_cmd::cargo::CommandCargoExt;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;
use stripmine_physics::averages::{Average, Estimate, Outcome, Rows};
use stripmine_physics::method::observed::find;
use stripmine_physics::method::{METHODS, Purpose, load};

/// A gas of hard discs, so short that its tests take no time.
const GAS: [&str; 4] = ["--set", "run.thermo_every=0.05", "--set", "particles.count=100"];

fn stripmine(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("stripmine").unwrap();
    command.current_dir(folder).args(arguments).arg("--quiet").output().unwrap()
}

fn run(folder: &Path, out: &str, more: &[&str]) -> Output {
    stripmine(folder, &[&["run", "hard-disks", "--out", out], &GAS[..], more].concat())
}

fn ends_with(output: &Output, code: i32, words: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{said}");
    words.iter().for_each(|word| assert!(said.contains(word), "{word} is not in: {said}"));
}

fn averages(folder: &Path, out: &str) -> Value {
    let text = fs::read_to_string(folder.join(out).join("summary.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["averages"].clone()
}

/// What is said of a quantity.
fn of<'a>(averages: &'a Value, name: &str) -> &'a Value {
    let all = averages["quantities"].as_array().unwrap();
    all.iter().find(|it| it["quantity"] == name).unwrap()
}

#[test]
fn a_run_ends_with_means_and_their_errors() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "a", &["--set", "run.events=20000"]);
    ends_with(&output, 0, &[]);
    let text = String::from_utf8_lossy(&output.stdout);
    for words in
        ["at the end: 100 discs", "means, ± 95 % (Student's t):", "compressibility", "constant: kinetic"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    let found = averages(folder.path(), "a");
    let z = of(&found, "compressibility");
    let [mean, bar, samples] = ["mean", "bar", "independent_samples"].map(|name| z[name].as_f64().unwrap());
    assert!(z["says"] == "mean" && z["of"] == "intervals" && samples > 100.0, "{z:#}");
    // Of scaled particle theory in two dimensions, Z = 1/(1 − ν)², good to 2 % at ν = 0.5.
    assert!((mean - 4.0).abs() < 0.2 && bar < 0.1, "{mean} {bar}");
    assert_eq!(of(&found, "kinetic")["says"], "constant");
    assert_eq!(of(&found, "energy_error")["says"], "kept");
    assert_eq!(of(&found, "collisions")["unit"], "1/time");
    // The same of the run's files.
    let again = stripmine(folder.path(), &["average", "a", "--json"]);
    assert_eq!(serde_json::from_slice::<Value>(&again.stdout).unwrap(), found);
    let table = stripmine(folder.path(), &["average", "a", "--csv"]);
    let table = String::from_utf8_lossy(&table.stdout);
    assert!(
        table.starts_with("quantity,mean,mean_error_95,unit,") && table.contains("\ncompressibility,"),
        "{table}"
    );
}

#[test]
fn averages_are_the_same_in_two_sessions() {
    let folder = tempfile::tempdir().unwrap();
    ends_with(&run(folder.path(), "whole", &["--set", "run.events=20000"]), 0, &[]);
    ends_with(&run(folder.path(), "parts", &["--set", "run.events=7777"]), 0, &[]);
    ends_with(&run(folder.path(), "parts", &["--set", "run.events=20000", "--resume"]), 0, &[]);
    assert_eq!(averages(folder.path(), "parts"), averages(folder.path(), "whole"));
}

#[test]
fn runs_with_seeds_of_their_own_are_joined_and_others_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (out, seed) in [("a", "particles.seed=1"), ("b", "particles.seed=2"), ("c", "particles.seed=1")] {
        ends_with(&run(folder, out, &["--set", "run.events=10000", "--set", seed]), 0, &[]);
    }
    let output = stripmine(folder, &["average", "a", "b", "--json"]);
    let joined: Value = serde_json::from_slice(&output.stdout).unwrap();
    let z = |averages: &Value| of(averages, "compressibility")["independent_samples"].as_f64().unwrap();
    let [a, b] = ["a", "b"].map(|out| z(&averages(folder, out)));
    assert!(joined["runs"] == 2 && (z(&joined) - a - b).abs() < 1e-9, "{joined:#}");
    ends_with(&stripmine(folder, &["average", "a", "c"]), 2, &["one run made twice", "a seed of its own"]);
    ends_with(&run(folder, "d", &["--set", "run.events=2000", "--set", "law.restitution=0.99"]), 0, &[]);
    ends_with(&stripmine(folder, &["average", "a", "d"]), 2, &["restitution = 1.0", "restitution = 0.99"]);
    ends_with(&stripmine(folder, &["average", "none"]), 5, &["none/thermo.csv"]);
    fs::create_dir(folder.join("odd")).unwrap();
    fs::write(folder.join("odd/thermo.csv"), "step,time,colour\n0,0.0,1.0\n").unwrap();
    ends_with(&stripmine(folder, &["average", "odd"]), 3, &["odd/thermo.csv", "not those of any method"]);
}

#[test]
fn a_run_ends_when_a_mean_is_known_well_enough() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let target = r#"run.until={ quantity = "compressibility", error = "2%" }"#;
    let wanted = ["--set", "run.events=10000000", "--set", target];
    ends_with(&run(folder, "whole", &wanted), 0, &[]);
    let found = averages(folder, "whole");
    let z = of(&found, "compressibility");
    let [mean, bar] = ["mean", "bar"].map(|name| z[name].as_f64().unwrap());
    assert!(bar <= 0.02 * mean && bar > 0.01 * mean, "{mean} {bar}");
    // In two sessions, the first of which ends before: the same rows, and the same end.
    ends_with(&run(folder, "parts", &["--set", "run.events=3000"]), 0, &[]);
    ends_with(&run(folder, "parts", &[&wanted[..], &["--resume"]].concat()), 0, &[]);
    let bytes = |out: &str, file: &str| fs::read(folder.join(out).join(file)).unwrap();
    assert_eq!(bytes("parts", "thermo.csv"), bytes("whole", "thermo.csv"));
    // Nothing is left to do.
    ends_with(&run(folder, "whole", &[&wanted[..], &["--resume"]].concat()), 0, &[]);
    assert_eq!(bytes("parts", "thermo.csv"), bytes("whole", "thermo.csv"));
    // A bound that comes first.
    let short =
        ["--set", "run.events=20000", "--set", r#"run.until={ quantity = "compressibility", error = 1e-4 }"#];
    let output = run(folder, "short", &short);
    ends_with(
        &output,
        4,
        &["run.events=20000 is over", "known to ± 0.", "not to ± 1e-4 (95 %)", "about time"],
    );
    assert_eq!(of(&averages(folder, "short"), "compressibility")["says"], "mean");
}

#[test]
fn seeds_make_an_ensemble() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let wanted = ["--set", "run.events=5000", "--seeds", "3", "--json"];
    let output = run(folder, "all", &wanted);
    ends_with(&output, 0, &[]);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let members = ["all/seed-1", "all/seed-2", "all/seed-3"];
    let folders: Vec<&str> =
        found["runs"].as_array().unwrap().iter().map(|run| run["folder"].as_str().unwrap()).collect();
    assert_eq!(folders, members);
    // What the verb says of the same folders; and one of them alone is the run of its seed.
    let joined = stripmine(folder, &[&["average"], &members[..], &["--json"]].concat());
    assert_eq!(serde_json::from_slice::<Value>(&joined.stdout).unwrap(), found["averages"]);
    ends_with(&run(folder, "two", &["--set", "run.events=5000", "--set", "particles.seed=2"]), 0, &[]);
    let bytes = |out: &str| fs::read(folder.join(out).join("thermo.csv")).unwrap();
    assert_eq!(bytes("two"), bytes("all/seed-2"));
    assert!(folder.join("all/seeds.json").is_file());
    ends_with(&run(folder, "all", &wanted), 2, &["all/seed-1 holds a run already"]);
    ends_with(&run(folder, "all", &[&wanted[..], &["--resume"]].concat()), 0, &[]);
    let output = stripmine(folder, &["run", "two-discs", "--seeds", "2"]);
    ends_with(&output, 2, &["nothing of this scene is drawn at random"]);
}

/// What a quantity must be.
#[derive(Clone, Copy)]
enum Truth {
    /// By theory or other programs.
    Known(f64),
    /// The same at kT = 1; it goes with the root of the run's own temperature.
    KnownRate(f64),
    /// By a run so many times as long, with a seed of its own.
    LongRun(f64),
}

/// Runs of a scene with seeds of their own, and what is known of one quantity.
struct System {
    preset: &'static str,
    overrides: &'static [&'static str],
    quantity: &'static str,
    truth: Truth,
}

/// 64 Lennard-Jones particles, a lattice that melts.
const FLUID: &[&str] =
    &["particles.count=64", "domain.sides=[9.56, 9.56]", "run.time=50", "run.thermo_every=20"];
/// Hard discs at ν = 0.3, so many that the box changes Z by less than a tenth of a bar.
const DISCS: &[&str] =
    &["particles.count=1600", "particles.packing_fraction=0.3", "run.events=80000", "run.thermo_every=0.5"];

/// Systems that are far from what they come to: free particles at another temperature, lattices that melt, discs of one speed.
const SYSTEMS: [System; 6] = [
    System {
        preset: "langevin-free",
        overrides: &[
            "particles.count=50",
            "particles.temperature=4.0",
            "run.time=100",
            "run.thermo_every=25",
        ],
        quantity: "temperature",
        truth: Truth::Known(1.0),
    },
    System {
        preset: "langevin-dense",
        overrides: FLUID,
        quantity: "potential",
        truth: Truth::LongRun(200.0),
    },
    System { preset: "langevin-dense", overrides: FLUID, quantity: "pressure", truth: Truth::LongRun(200.0) },
    System {
        preset: "hard-disks",
        overrides: &["particles.count=64", "run.events=20000", "run.thermo_every=0.1"],
        quantity: "compressibility",
        truth: Truth::LongRun(200.0),
    },
    // Two programs with 250 000 discs (the specification of ISO99), which agree with ten virial coefficients.
    System {
        preset: "hard-disks",
        overrides: DISCS,
        quantity: "compressibility",
        truth: Truth::Known(2.0632),
    },
    // The free time of a disc is the reciprocal of the rate, √π/(4 (Z − 1)).
    System {
        preset: "hard-disks",
        overrides: DISCS,
        quantity: "collision_rate",
        truth: Truth::KnownRate(2.3995),
    },
];

const SEEDS: u64 = 200;

impl System {
    /// What a run so many times as long says, with its temperature at the end; none where it has no mean.
    fn mean(&self, seed: u64, times: f64) -> Option<(Estimate, f64)> {
        let longer = |text: &&str| match text.split_once('=') {
            Some((key @ ("run.time" | "run.events"), length)) => {
                format!("{key}={}", times * length.parse::<f64>().unwrap())
            }
            _ => (*text).to_owned(),
        };
        let overrides = self.overrides.iter().map(longer);
        let overrides: Vec<String> = overrides.chain([format!("particles.seed={seed}")]).collect();
        let (prepared, method) = load(self.preset, &overrides, METHODS).unwrap();
        let mut simulation = prepared.start(Purpose::Run).unwrap();
        let mut rows = Rows::new(method.quantities);
        rows.add(&simulation.observe());
        let schedule = prepared.schedule;
        while !schedule.until.has_come(&simulation.clock()) {
            let next = schedule.rows.next(&simulation.clock()).unwrap();
            simulation.advance(&[schedule.until, next], &AtomicBool::new(false)).unwrap();
            if next.has_come(&simulation.clock()) {
                rows.add(&simulation.observe());
            }
        }
        let temperature = simulation.observe()[find(method.quantities, "temperature").unwrap()];
        match Average::of(&rows, find(method.quantities, self.quantity).unwrap()).outcome {
            Outcome::Mean(estimate) => Some((estimate, temperature)),
            _ => None,
        }
    }
}

/// In 92 to 98 of 100 runs, whatever the method; in more where successive values make up for each other, as collisions of many discs in short times do
/// (a time with many is followed by one with few): no inefficiency is taken to be below 1, as with pymbar, and bars are 1.4 to 1.8 times too wide there.
#[test]
#[ignore = "long: cargo test --release --test averages -- --ignored"]
fn bars_of_95_percent_hold_the_truth_of_real_systems() {
    let mut wrong = vec![];
    for system in &SYSTEMS {
        let truth = match system.truth {
            Truth::Known(value) | Truth::KnownRate(value) => value,
            Truth::LongRun(times) => system.mean(SEEDS, times).unwrap().0.mean,
        };
        let at_one = |(found, temperature): (Estimate, f64)| match system.truth {
            Truth::KnownRate(_) => {
                let rate = temperature.sqrt();
                Estimate { mean: found.mean / rate, bar: found.bar / rate, ..found }
            }
            Truth::Known(_) | Truth::LongRun(_) => found,
        };
        let found: Vec<Option<(Estimate, f64)>> =
            (0..SEEDS).into_par_iter().map(|seed| system.mean(seed, 1.0)).collect();
        let found: Vec<Estimate> = found.into_iter().flatten().map(at_one).collect();
        let count = found.len() as f64;
        let over = |of: &dyn Fn(&Estimate) -> f64| found.iter().map(of).sum::<f64>() / count;
        let held = over(&|it| f64::from((it.mean - truth).abs() <= it.bar));
        println!(
            "{} {}: {held:.3} of {count} hold {truth:.5}, mean {:.5}, bar {:.5}, scatter {:.5}, {:.0} samples",
            system.preset,
            system.quantity,
            over(&|it| it.mean),
            over(&|it| it.bar),
            1.96 * over(&|it| (it.mean - over(&|it| it.mean)).powi(2)).sqrt(),
            over(&|it| it.independent_samples)
        );
        let most = if system.overrides == DISCS { 1.0 } else { 0.98 };
        if !(0.92..=most).contains(&held) || count < 0.9 * SEEDS as f64 {
            wrong.push((system.preset, system.quantity, held, count));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Runs that end by `until` end within 30 % of the time that the target takes, which the scatter over their seeds tells.
#[test]
#[ignore = "long: cargo test --release --test averages -- --ignored"]
fn until_ends_where_the_target_is_reached() {
    let folder = tempfile::tempdir().unwrap();
    let discs = ["hard-disks", "--set", "particles.count=100", "--set", "run.thermo_every=0.1"];
    let discs = [&discs[..], &["--set", "run.events=100000000"]].concat();
    let fluid = ["langevin-dense", "--set", "particles.count=64", "--set", "domain.sides=[9.56, 9.56]"];
    let fluid = [&fluid[..], &["--set", "run.thermo_every=20", "--set", "run.time=100000"]].concat();
    for (scene, quantity, percent) in [(discs, "compressibility", 1.0), (fluid, "potential", -0.5)] {
        let target = format!("run.until={{ quantity = \"{quantity}\", error = \"{}%\" }}", f64::abs(percent));
        let runs: Vec<[f64; 2]> = (1..=40)
            .into_par_iter()
            .map(|seed: u32| {
                let (out, seed) = (format!("{quantity}-{seed}"), format!("particles.seed={seed}"));
                let own = ["--set", &target, "--set", &seed, "--out", &out];
                ends_with(&stripmine(folder.path(), &[&["run"], &scene[..], &own].concat()), 0, &[]);
                let found = averages(folder.path(), &out);
                let found = of(&found, quantity);
                ["mean", "span"].map(|name| found[name].as_f64().unwrap())
            })
            .collect();
        let (count, length) = (runs.len() as f64, |run: &[f64; 2]| run[1]);
        let mean = runs.iter().map(|run| run[0]).sum::<f64>() / count;
        let middle = runs.iter().map(length).sum::<f64>() / count;
        // A mean over a time t has the variance D/t.
        let scatter = runs.iter().map(|run| (run[0] - mean).powi(2) * run[1]).sum::<f64>() / (count - 1.0);
        let needed = scatter * (1.96 / (0.01 * percent * mean)).powi(2);
        let near = runs.iter().filter(|run| (run[1] / needed - 1.0).abs() < 0.3).count();
        println!(
            "{quantity} to {percent} %: {mean:.4}, ends at {middle:.0}, {needed:.0} needed; {near} of {count} within 30 %"
        );
        assert!((middle / needed - 1.0).abs() < 0.3, "{middle} {needed}");
    }
}
