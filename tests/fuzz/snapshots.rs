//! Snapshots of every method with one column or counter replaced by another: refused, or resumed as a run that ends.
//!
//! A checkpoint with valid checksums may still contain anything, and a simulation takes its whole state from it.

use std::sync::atomic::AtomicBool;
use stripmine_physics::io::checkpoint::{CheckpointColumn, CheckpointCounter};
use stripmine_physics::method::{Clock, METHODS, Prepared, Simulation, Snapshot, StartPurpose, Until, load};

/// Small scenes of every method and every engine: preset and overrides.
const SCENES: &[(&str, &[&str])] = &[
    ("pipe-small", &["machine.engine=fast", "search.by=lattice", "particles.count=20"]),
    (
        "dense-gas",
        &["machine.engine=fast", "search.by=sectors", "particles.count=20", "machine.precision=f32"],
    ),
    ("dense-gas", &["machine.engine=fast", "search.by=neighbor-list", "particles.count=20"]),
    ("dense-gas", &["machine.execution=chained", "particles.count=20", "machine.precision=mixed"]),
    ("dense-gas", &["machine.execution=chained", "particles.count=20"]),
    ("dense-gas", &["search.by=neighbor-list", "search.rebuild=all-pairs", "particles.count=20"]),
    ("hard-disks", &["particles.count=24"]),
    ("hard-disks", &["particles.count=24", "machine.engine=reference"]),
    ("hard-disks", &["particles.count=200", "machine.engine=cell-crossing"]),
    ("langevin-dense", &["particles.count=24", "search.by=sectors"]),
    ("langevin-dense", &["particles.count=24", "search.by=neighbor-list"]),
    ("langevin-free", &["particles.count=24"]),
    ("kepler", &["integrator.kind=gear-6"]),
    ("kepler", &["integrator.kind=hermite-4"]),
    ("kepler", &["integrator.kind=ias15"]),
    ("kepler", &["integrator.kind=leapfrog"]),
    ("kepler", &["integrator.kind=damped-euler"]),
];

/// Steps before the snapshot, and after it.
const STEPS: u64 = 12;
/// Events before the snapshot, and after it.
const EVENTS: u64 = 300;

/// Advances by some steps or events, depending on the method.
fn advance(simulation: &mut dyn Simulation) -> bool {
    let clock = simulation.clock();
    let until = [Until::Steps(clock.steps + STEPS), Until::Events(clock.events + EVENTS)];
    // A method with steps has no events, and vice versa.
    simulation.advance(&until, &AtomicBool::new(false)).is_ok()
}

fn started(prepared: &Prepared) -> Box<dyn Simulation> {
    prepared.start(StartPurpose::Run).unwrap()
}

const REALS: [f64; 9] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 5e-324, 1e9, -1.0, 0.5];
const WHOLES: [u64; 5] = [u64::MAX, u64::MAX / 2, 1 << 53, u32::MAX as u64, 0];

/// Replacements of a column: one or all values changed, fewer values, more, none, or another type.
fn columns(column: &CheckpointColumn) -> Vec<CheckpointColumn> {
    fn of<T: Copy>(
        values: &[T],
        hostile: &[T],
        made: impl Fn(Vec<T>) -> CheckpointColumn,
    ) -> Vec<CheckpointColumn> {
        let mut all = vec![made(vec![]), made(values[..values.len() / 2].to_vec())];
        all.push(made(values.iter().chain(values).copied().collect()));
        for &value in hostile {
            all.push(made(vec![value; values.len()]));
            let mut one = values.to_vec();
            one.iter_mut().take(1).for_each(|it| *it = value);
            all.push(made(one));
        }
        all
    }
    let mut all = match column {
        CheckpointColumn::F64(values) => of(values, &REALS, CheckpointColumn::F64),
        CheckpointColumn::F32(values) => of(values, &REALS.map(|x| x as f32), CheckpointColumn::F32),
        CheckpointColumn::U32(values) => of(values, &WHOLES.map(|x| x as u32), CheckpointColumn::U32),
        CheckpointColumn::U64(values) => of(values, &WHOLES, CheckpointColumn::U64),
    };
    all.push(match column {
        CheckpointColumn::U64(values) => CheckpointColumn::U32(vec![7; values.len()]),
        other => CheckpointColumn::U64(vec![7; other.len()]),
    });
    all
}

fn counters() -> Vec<CheckpointCounter> {
    REALS.map(CheckpointCounter::Sum).into_iter().chain(WHOLES.map(CheckpointCounter::Count)).collect()
}

fn clocks(clock: Clock) -> Vec<Clock> {
    let times = REALS.map(|time| Clock { time, ..clock });
    let steps = WHOLES.map(|steps| Clock { steps, ..clock });
    let events = WHOLES.map(|events| Clock { events, ..clock });
    times.into_iter().chain(steps).chain(events).filter(|it| *it != clock).collect()
}

/// Restores a snapshot and continues; returns true if the snapshot was accepted.
fn taken_up(prepared: &Prepared, clock: Clock, snapshot: Snapshot) -> bool {
    let mut simulation = started(prepared);
    if let Err(why) = simulation.restore(clock, snapshot) {
        assert!(!why.is_empty());
        return false;
    }
    advance(simulation.as_mut());
    simulation.observe();
    true
}

#[test]
fn forged_snapshots_are_refused_or_resumed() {
    for &(preset, overrides) in SCENES {
        let sets: Vec<String> = overrides.iter().map(|set| (*set).to_owned()).collect();
        let what = format!("{preset} {}", overrides.join(" "));
        let (prepared, _) = load(preset, &sets, METHODS).unwrap_or_else(|why| panic!("{what}: {why}"));
        let prepared = &prepared;
        let mut simulation = started(prepared);
        assert!(advance(simulation.as_mut()), "{what}");
        let (clock, whole) = (simulation.clock(), || simulation.snapshot());
        assert!(taken_up(prepared, clock, whole()), "{what}");
        let mut refused = 0;
        let mut count = |taken: bool| refused += u32::from(!taken);
        for at in 0..whole().columns.len() {
            let name = whole().columns[at].0.clone();
            println!("{what}: {name}");
            for column in columns(&whole().columns[at].1) {
                let mut forged = whole();
                forged.columns[at].1 = column;
                count(taken_up(prepared, clock, forged));
            }
            let mut without = whole();
            without.columns.remove(at);
            assert!(!taken_up(prepared, clock, without), "{what}: accepted without {name}");
        }
        for name in whole().counters.into_keys() {
            println!("{what}: {name}");
            for counter in counters() {
                let mut forged = whole();
                forged.counters.insert(name.clone(), counter);
                count(taken_up(prepared, clock, forged));
            }
            let mut without = whole();
            without.counters.remove(&name);
            assert!(!taken_up(prepared, clock, without), "{what}: accepted without {name}");
        }
        for forged in clocks(clock) {
            println!("{what}: {forged:?}");
            count(taken_up(prepared, forged, whole()));
        }
        assert!(refused > 20, "{what}: {refused}");
    }
}
