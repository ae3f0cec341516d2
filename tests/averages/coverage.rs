//! Coverage of error bars: runs of all methods, alone, joined, and ended by `until`.

use super::{averages, ends_with, of, stripmine};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::sync::atomic::AtomicBool;
use stripmine_physics::averages::{AverageOutcome, AveragedRows, Estimate, RunAverages, joined};
use stripmine_physics::method::{METHODS, StartPurpose, load};

/// Reference value of a quantity.
#[derive(Clone, Copy)]
enum Truth {
    /// Known from theory.
    Known(f64),
    /// The mean of a run this many times as long, with its own seed.
    LongRun(f64),
    /// The mean over all runs: the start of each run affects its mean a little.
    AllRuns,
    /// The quantity has no mean.
    Never,
    /// The runs are too short for a mean.
    TooShort,
}

/// Runs of a scene with different seeds, and the reference values of its quantities.
struct System {
    preset: &'static str,
    overrides: &'static [&'static str],
    truths: &'static [(&'static str, Truth)],
}

/// Systems of all methods. Most start far from their stationary state: particles at another temperature, lattices that melt, discs of one speed,
/// grains at rest.
///
/// Grains have one size: drawn sizes make a different system of each seed, with its own mean.
const SYSTEMS: [System; 12] = [
    System {
        preset: "langevin-free",
        overrides: &[
            "particles.count=50",
            "particles.temperature=4.0",
            "run.time=100",
            "run.thermo_every=25",
        ],
        truths: &[("temperature", Truth::Known(1.0)), ("msd", Truth::Never)],
    },
    // The temperature of ten particles is soon known to 8 %.
    System {
        preset: "langevin-free",
        overrides: &["particles.count=10", "run.time=200", "run.thermo_every=10"],
        truths: &[("temperature", Truth::Known(1.0)), ("momentum_x", Truth::Known(0.0))],
    },
    System {
        preset: "hard-disks",
        overrides: &["particles.count=64", "run.events=20000", "run.thermo_every=0.1"],
        truths: &[("compressibility", Truth::LongRun(200.0))],
    },
    // With few discs, many rows have no collision.
    System {
        preset: "hard-disks",
        overrides: &["particles.count=6", "run.events=10000", "run.thermo_every=0.1"],
        truths: &[("compressibility", Truth::LongRun(200.0))],
    },
    System {
        preset: "cooling-gas",
        overrides: &["particles.count=100", "run.events=10000", "run.thermo_every=0.25"],
        truths: &[("temperature", Truth::Never), ("collisions", Truth::Never)],
    },
    // Two particles that collide now and then: u(r) over the canonical ensemble, by quadrature.
    System {
        preset: "langevin-free",
        overrides: &[
            "law.kind=wca",
            "particles.generate=random",
            "particles.count=2",
            "particles.radius=0.5",
            "domain.sides=[4.0, 4.0]",
            "run.time=1000",
            "run.thermo_every=40",
        ],
        truths: &[("potential", Truth::Known(0.018_104)), ("temperature", Truth::Known(1.0))],
    },
    // 64 Lennard-Jones particles.
    System {
        preset: "langevin-dense",
        overrides: &["particles.count=64", "domain.sides=[9.56, 9.56]", "run.time=60", "run.thermo_every=20"],
        truths: &[
            ("temperature", Truth::Known(1.0)),
            ("potential", Truth::LongRun(100.0)),
            ("pressure", Truth::LongRun(100.0)),
        ],
    },
    System {
        preset: "hot-floor",
        overrides: &[
            "particles.count=30",
            "domain.sides=[30.0, 20.0]",
            "run.time=2000",
            "run.thermo_every=2",
        ],
        truths: &[("kinetic", Truth::Known(30.0)), ("collisions", Truth::LongRun(50.0))],
    },
    System {
        preset: "plummer",
        overrides: &[
            "particles.count=64",
            "law.softening=0.1",
            "integrator.dt=0.015625",
            "run.time=200",
            "run.thermo_every=16",
        ],
        truths: &[("virial_ratio", Truth::AllRuns)],
    },
    System {
        preset: "shaken-box",
        overrides: &[
            "particles.count=20",
            "particles.radius_spread=0.0",
            "domain.sides=[0.1, 0.8]",
            "run.time=10",
        ],
        truths: &[("temperature", Truth::LongRun(50.0)), ("gravitational", Truth::LongRun(50.0))],
    },
    // A pipe of a fifth of pipe-small's length: the correlation time of its waves exceeds the run.
    System {
        preset: "pipe-small",
        overrides: &["domain.sides=[0.648, 0.088]", "particles.radius_spread=0.0", "run.time=4"],
        truths: &[("flow", Truth::TooShort), ("contacts", Truth::TooShort)],
    },
    // A tenth of its length, so that every start fits.
    System {
        preset: "pipe-small",
        overrides: &[
            "domain.sides=[0.324, 0.088]",
            "particles.count=20",
            "particles.radius_spread=0.0",
            "run.time=20",
        ],
        truths: &[
            ("flow", Truth::LongRun(50.0)),
            ("contacts", Truth::LongRun(50.0)),
            ("gravity_work", Truth::LongRun(50.0)),
        ],
    },
];

const SEEDS: u64 = 200;
/// First seed; none of these seeds was used to choose a parameter.
const FIRST_SEED: u64 = 1000;
/// Smallest share of the runs that must report a mean.
const LEAST: f64 = 0.4;
/// Largest share of runs that may report a mean where none exists, and where runs are too short for it.
const NEVER: f64 = 0.01;
const SELDOM: f64 = 0.1;
/// Numbers of runs in a join.
const JOINED: [usize; 4] = [2, 3, 4, 8];

/// True if a share is 92 to 98 %, within two standard errors for `count` independent runs.
fn is_as_claimed(share: f64, count: f64) -> bool {
    let beyond = |limit: f64| 2.0 * (limit * (1.0 - limit) / count).sqrt();
    (0.92 - beyond(0.92)..=0.98 + beyond(0.98)).contains(&share)
}

/// Consecutive seeds from [`FIRST_SEED`].
fn seeds(count: u64) -> impl ParallelIterator<Item = u64> {
    (FIRST_SEED..FIRST_SEED + count).into_par_iter()
}

impl System {
    /// Averages of a run `times` as long as the preset's.
    fn averages(&self, seed: u64, times: f64) -> RunAverages {
        let longer = |text: &&str| match text.split_once('=') {
            Some((key @ ("run.time" | "run.events"), length)) => {
                format!("{key}={}", times * length.parse::<f64>().unwrap())
            }
            _ => (*text).to_owned(),
        };
        let overrides = self.overrides.iter().map(longer);
        let overrides: Vec<String> = overrides.chain([format!("particles.seed={seed}")]).collect();
        let (prepared, method) = load(self.preset, &overrides, METHODS).unwrap();
        let mut simulation = prepared.start(StartPurpose::Run).unwrap();
        let mut rows = AveragedRows::new(method.quantities);
        rows.add(&simulation.row());
        let schedule = prepared.schedule;
        while !schedule.until.has_been_reached(&simulation.clock()) {
            let next = schedule.rows.next(&simulation.clock()).unwrap();
            simulation.advance(&[schedule.until, next], &AtomicBool::new(false)).unwrap();
            if next.has_been_reached(&simulation.clock()) {
                rows.add(&simulation.row());
            }
        }
        RunAverages::of(&rows)
    }
}

/// Outcome of one quantity.
fn outcome(averages: &RunAverages, quantity: &str) -> AverageOutcome {
    averages.quantities.iter().find(|it| it.quantity == quantity).unwrap().outcome
}

/// Means among some outcomes, and the share of them whose error bar covers the truth.
fn held(outcomes: impl Iterator<Item = AverageOutcome>, truth: f64) -> (Vec<Estimate>, f64) {
    let mean = |outcome| if let AverageOutcome::Mean(estimate) = outcome { Some(estimate) } else { None };
    let found: Vec<Estimate> = outcomes.filter_map(mean).collect();
    let held = found.iter().filter(|it| (it.mean - truth).abs() <= it.bar).count();
    let share = held as f64 / found.len().max(1) as f64;
    (found, share)
}

/// Number of systems in the first of the two tests; both take about as long.
const FLUIDS: usize = 8;

#[test]
#[ignore = "long: cargo test --release --test averages -- --ignored"]
fn error_bars_cover_the_truth_of_fluids() {
    hold_the_truth(&SYSTEMS[..FLUIDS]);
}

#[test]
#[ignore = "long: cargo test --release --test averages -- --ignored"]
fn error_bars_cover_the_truth_of_grains_bodies() {
    hold_the_truth(&SYSTEMS[FLUIDS..]);
}

/// Error bars cover the truth in 92 to 98 of 100 runs for every method, and so do those of 2, 3, 4 and 8 joined runs. A mean is hardly ever reported
/// for a
/// system that never becomes stationary or whose waves outlive the run.
fn hold_the_truth(systems: &[System]) {
    let mut wrong = vec![];
    let mut joins = [[0.0; 2]; JOINED.len()];
    let check = |wrong: &mut Vec<(String, f64, f64)>,
                 name: String,
                 found: &[Estimate],
                 share: f64,
                 truth: f64| {
        let count = found.len() as f64;
        let over = |of: &dyn Fn(&Estimate) -> f64| found.iter().map(of).sum::<f64>() / count;
        println!(
            "{name}: {} of {SEEDS} have a mean, {share:.3} cover {truth:.6}; mean {:.6}, bar {:.2} of the scatter, {:.0} samples",
            found.len(),
            over(&|it| it.mean),
            over(&|it| it.bar) / (1.96 * over(&|it| (it.mean - truth).powi(2)).sqrt()),
            over(&|it| it.independent_samples)
        );
        if !is_as_claimed(share, count) || count < LEAST * SEEDS as f64 {
            wrong.push((name, share, count));
        }
    };
    for system in systems {
        let needs_long = system.truths.iter().find_map(|(_, truth)| match truth {
            Truth::LongRun(times) => Some(*times),
            _ => None,
        });
        let (runs, long) = rayon::join(
            || -> Vec<RunAverages> { seeds(SEEDS).map(|seed| system.averages(seed, 1.0)).collect() },
            || needs_long.map(|times| system.averages(FIRST_SEED + SEEDS, times)),
        );
        for &(quantity, truth) in system.truths {
            let name = format!("{} {quantity}", system.preset);
            let truth = match truth {
                Truth::Known(value) => value,
                Truth::LongRun(_) => {
                    let AverageOutcome::Mean(found) = outcome(long.as_ref().unwrap(), quantity) else {
                        panic!("{name}")
                    };
                    found.mean
                }
                Truth::AllRuns => {
                    let (found, _) = held(runs.iter().map(|run| outcome(run, quantity)), 0.0);
                    found.iter().map(|it| it.mean).sum::<f64>() / found.len() as f64
                }
                Truth::Never | Truth::TooShort => {
                    let most = if matches!(truth, Truth::Never) { NEVER } else { SELDOM };
                    let (found, _) = held(runs.iter().map(|run| outcome(run, quantity)), 0.0);
                    println!("{name}: {} of {SEEDS} have a mean, although none exists", found.len());
                    if found.len() as f64 > most * SEEDS as f64 {
                        wrong.push((name, f64::NAN, found.len() as f64));
                    }
                    continue;
                }
            };
            let (found, share) = held(runs.iter().map(|run| outcome(run, quantity)), truth);
            check(&mut wrong, name, &found, share, truth);
            for (at, count) in JOINED.into_iter().enumerate() {
                // Each run is part of as many joins as a join has runs.
                let join = |first: usize| {
                    let members = (0..count).map(|number| runs[(first + 37 * number) % runs.len()].clone());
                    outcome(&joined(&members.collect::<Vec<_>>()), quantity)
                };
                let (found, share) = held((0..runs.len()).map(join), truth);
                println!("  {count} joined: {share:.3} of {} cover it", found.len());
                joins[at][0] += share * found.len() as f64;
                joins[at][1] += found.len() as f64;
            }
        }
    }
    for (count, [held, all]) in JOINED.into_iter().zip(joins) {
        println!("{count} joined, all systems: {:.3} of {all} cover the truth", held / all);
        if !is_as_claimed(held / all, all / count as f64) {
            wrong.push((format!("{count} joined"), held / all, all));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Collision rates of runs with different energies: a run's error bar is for its own energy, a join's for all energies.
#[test]
#[ignore = "long: cargo test --release --test averages -- --ignored"]
fn joined_bars_cover_the_mean_over_energies() {
    let system = System {
        preset: "hard-disks",
        overrides: &["particles.count=48", "run.events=5000", "run.thermo_every=0.1"],
        truths: &[],
    };
    let runs: Vec<RunAverages> = seeds(4 * SEEDS).map(|seed| system.averages(seed, 1.0)).collect();
    let (found, _) = held(runs.iter().map(|run| outcome(run, "collision_rate")), 0.0);
    let truth = found.iter().map(|it| it.mean).sum::<f64>() / found.len() as f64;
    for count in JOINED {
        let joins = (0..SEEDS as usize).map(|first| {
            let members: Vec<RunAverages> =
                (0..count).map(|number| runs[(first * 4 + 101 * number) % runs.len()].clone()).collect();
            outcome(&joined(&members), "collision_rate")
        });
        let (found, share) = held(joins, truth);
        println!("{count} joined: {share:.3} of {} cover {truth:.4}", found.len());
        assert!(is_as_claimed(share, found.len() as f64), "{count}: {share}");
    }
}

/// Number of runs whose scatter gives the time a target takes, to 11 % (one standard error).
const RUNS: u32 = 160;

/// Runs that end by `until` end within 30 % of the time the target takes, as computed from the scatter over their seeds.
#[test]
#[ignore = "long: cargo test --release --test averages -- --ignored"]
fn until_ends_when_the_target_is_reached() {
    let folder = tempfile::tempdir().unwrap();
    let discs = ["hard-disks", "--set", "particles.count=100", "--set", "run.thermo_every=0.1"];
    let discs = [&discs[..], &["--set", "run.events=100000000"]].concat();
    let fluid = ["langevin-dense", "--set", "particles.count=64", "--set", "domain.sides=[9.56, 9.56]"];
    let fluid = [&fluid[..], &["--set", "run.thermo_every=20", "--set", "run.time=100000"]].concat();
    for (scene, quantity, percent) in [(discs, "compressibility", 1.0), (fluid, "potential", -0.5)] {
        let target = format!("run.until={{ quantity = \"{quantity}\", error = \"{}%\" }}", f64::abs(percent));
        let runs: Vec<[f64; 2]> = (1..=RUNS)
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
        // The variance of a mean over a time t is D/t.
        let scatter = runs.iter().map(|run| (run[0] - mean).powi(2) * run[1]).sum::<f64>() / (count - 1.0);
        let needed = scatter * (1.96 / (0.01 * percent * mean)).powi(2);
        let near = runs.iter().filter(|run| (run[1] / needed - 1.0).abs() < 0.3).count();
        println!(
            "{quantity} to {percent} %: {mean:.4}, ends at {middle:.0}, {needed:.0} needed; {near} of {count} within 30 %"
        );
        assert!((middle / needed - 1.0).abs() < 0.3, "{middle} {needed}");
    }
}

/// Runs that end by `until` cover the truth as often as others, although each ends when its error bar happens to be short.
#[test]
#[ignore = "long: cargo test --release --test averages -- --ignored"]
fn until_covers_the_truth_at_the_nominal_rate() {
    let folder = tempfile::tempdir().unwrap();
    for error in ["8%", "4%"] {
        let target = format!("run.until={{ quantity = \"temperature\", error = \"{error}\" }}");
        let free = ["run", "langevin-free", "--set", "particles.count=10", "--set", "run.thermo_every=10"];
        let free =
            [&free[..], &["--set", "run.time=100000", "--set", "run.snapshot_every=0", "--set", &target]]
                .concat();
        let held = seeds(SEEDS).filter(|seed| {
            let (out, seed) = (format!("{seed}"), format!("particles.seed={seed}"));
            let own = ["--set", &seed, "--overwrite", "--out", &out];
            ends_with(&stripmine(folder.path(), &[&free[..], &own].concat()), 0, &[]);
            let found = averages(folder.path(), &out);
            let [mean, bar] = ["mean", "bar"].map(|name| of(&found, "temperature")[name].as_f64().unwrap());
            (mean - 1.0).abs() <= bar
        });
        let share = held.count() as f64 / SEEDS as f64;
        println!("until {error}: {share:.3} cover the truth");
        assert!(is_as_claimed(share, SEEDS as f64), "{error}: {share}");
    }
}
