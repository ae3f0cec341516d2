//! Every numeric key of every method with values at the ends of the number format: the scene is refused, or its run ends.

use std::sync::atomic::AtomicBool;
use stripmine_physics::method::{Clock, Every, METHODS, Prepared, Simulation, StartPurpose, Until, load};
use stripmine_physics::scene::{Key, KeyValueKind};

/// Small scenes of every method.
const SCENES: &[(&str, &[&str])] = &[
    ("hard-disks", &["particles.count=20", "run.events=200"]),
    ("cooling-gas", &["particles.count=20", "run.events=200"]),
    ("vibrating-floor", &["particles.count=10", "run.time=2"]),
    ("hot-floor", &["particles.count=10", "run.time=2", "machine.engine=reference"]),
    ("dense-gas", &["particles.count=30", "run.steps=20"]),
    ("pipe-small", &["particles.count=30", "run.steps=20"]),
    ("shaken-box", &["particles.count=30", "run.steps=20"]),
    ("langevin-dense", &["particles.count=30", "run.steps=20"]),
    ("plummer", &["particles.count=20", "run.steps=20"]),
];

const NUMBERS: [&str; 6] = ["0", "-1", "1e-300", "1e300", "nan", "inf"];

/// Largest number of collisions, rows, snapshots or checkpoints of a run that ends, with a margin for estimates from the start.
const MOST: f64 = 1e18;
/// Memory (bytes) up to which a case is run.
const MEMORY: u64 = 1 << 30;

fn texts(key: &Key) -> Vec<String> {
    match key.kind {
        KeyValueKind::Number(_) | KeyValueKind::Whole(..) | KeyValueKind::OneOf(_) => {
            NUMBERS.map(str::to_owned).to_vec()
        }
        KeyValueKind::Pair(_) => NUMBERS.iter().map(|number| format!("[{number}, {number}]")).collect(),
        _ => vec![],
    }
}

/// Runs a scene for two rows; returns true if it completed both.
fn two_rows(prepared: &Prepared, what: &str) -> bool {
    let Ok(mut simulation) = prepared.start(StartPurpose::Run) else { return false };
    let takes = |simulation: &mut dyn Simulation| {
        let clock = simulation.clock();
        let until =
            [prepared.schedule.until, Until::Steps(clock.steps + 2), Until::Events(clock.events + 50)];
        simulation.advance(&until, &AtomicBool::new(false)).is_ok() && !simulation.row().is_empty()
    };
    let all = takes(simulation.as_mut()) && takes(simulation.as_mut());
    check_run_can_finish(prepared, simulation.clock(), what);
    all
}

/// Checks that any machine can finish the rest of a run, as far as its first rows show.
fn check_run_can_finish(prepared: &Prepared, now: Clock, what: &str) {
    let schedule = prepared.schedule;
    let time = match schedule.until {
        Until::Time(time) => {
            let events = time / now.time * now.events as f64;
            assert!(now.events == 0 || events <= MOST, "{what}: about {events:e} events");
            time
        }
        Until::Events(events) => now.time * events as f64 / now.events.max(1) as f64,
        Until::Steps(_) => return,
    };
    for every in [schedule.rows, schedule.snapshots, schedule.checkpoints] {
        if let Every::Time(every) = every {
            assert!(time / every <= MOST, "{what}: about {:e} times", time / every);
        }
    }
    for count in [schedule.row_count(), schedule.snapshot_count()].into_iter().flatten() {
        assert!(count as f64 <= MOST, "{what}: {count} times");
    }
}

#[test]
fn extreme_key_values_are_refused_or_finish() {
    let [mut refused, mut ran] = [0; 2];
    for &(preset, overrides) in SCENES {
        let (_, entry) = load(preset, &[], METHODS).unwrap();
        for key in entry.vocabulary.keys.keys().filter(|key| key.name != "format") {
            for text in texts(key) {
                let path = key.path();
                let others = overrides.iter().filter(|set| !set.starts_with(&format!("{path}=")));
                let mut sets: Vec<String> = others.map(|set| (*set).to_owned()).collect();
                sets.push(format!("{path}={text}"));
                let what = format!("{preset} {}", sets.join(" "));
                match load(preset, &sets, METHODS) {
                    Err(why) => {
                        assert!(why.0.iter().all(|error| !error.message.is_empty()), "{what}");
                        refused += 1;
                    }
                    Ok((prepared, _)) if prepared.memory.needed > MEMORY => refused += 1,
                    Ok((prepared, _)) => ran += u32::from(two_rows(&prepared, &what)),
                }
            }
        }
    }
    println!("{refused} refused, {ran} ran");
    assert!(refused > 500 && ran > 200, "{refused} refused, {ran} ran");
}

/// The message names the key, its value and the bound.
#[test]
fn endless_runs_are_refused_with_the_bound() {
    for (preset, sets, words) in [
        (
            "hot-floor",
            &["particles.count=100", "particles.speed=1e300", "run.time=1"][..],
            ["`run.time` = 1 takes about", "a time of at most", "for 1e15 collisions"],
        ),
        (
            "hard-disks",
            &["particles.mass=9e180", "run.events=100000"],
            [
                "`run.thermo_every` = 1 makes about",
                "rows in the duration of `run.events` = 100000",
                "or at least",
            ],
        ),
        (
            "vibrating-floor",
            &["run.thermo_every=1e-300"],
            [
                "`run.thermo_every` = 1e-300 makes about 2e302 rows in `run.time` = 200",
                "0 for none, or at least 2e-10",
                "",
            ],
        ),
        (
            "vibrating-floor",
            &["run.checkpoint_every=1e-300"],
            [
                "`run.checkpoint_every` = 1e-300 makes about 2e302 checkpoints",
                "0 for none, or at least 2e-10",
                "",
            ],
        ),
    ] {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let said = match load(preset, &sets, METHODS) {
            Err(why) => why.to_string(),
            Ok(_) => panic!("{preset} {sets:?} has no end"),
        };
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
    }
}
