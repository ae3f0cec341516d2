//! Shortened presets, and their final states.

use std::sync::atomic::AtomicBool;
use stripmine_physics::method::{Clock, Every, MethodEntry, Methods, Prepared, StartPurpose, Until, load};
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::KeyValueKind;

/// Runs with more particles than `MANY` are reduced to `FEWER`.
const MANY: usize = 500;
const FEWER: usize = 200;
/// Overrides that shorten a preset: fewer particles, a part of its length, all files, and rows and frames due at several moments; no
/// frame is due at the end.
pub fn shortened(methods: Methods, entry: &'static MethodEntry, preset: &str) -> Vec<String> {
    let prepared = |overrides: &[String]| load(preset, overrides, methods).map(|(prepared, _)| prepared);
    let whole = prepared(&[]).expect("a preset is a scene");
    let mut overrides: Vec<String> = entry
        .vocabulary
        .keys
        .section("output")
        .filter(|key| key.kind == KeyValueKind::Switch)
        .map(|key| format!("output.{}=true", key.name))
        // Some scenes do not have every file.
        .filter(|asked| prepared(std::slice::from_ref(asked)).is_ok())
        .collect();
    let fewer = [overrides.clone(), vec![format!("particles.count={FEWER}")]].concat();
    if whole.particles().len() > MANY && prepared(&fewer).is_ok() {
        overrides = fewer;
    }
    overrides.push(match whole.schedule.until {
        Until::Steps(steps) => format!("run.steps={}", steps.min(60)),
        Until::Events(events) => format!("run.events={}", events / 100),
        Until::Time(time) => format!("run.time={:?}", time / 8.0),
    });
    let short = prepared(&overrides).expect("a shortened scene");
    let (clock, ..) = end_of(&short);
    let every = |parts: f64| match short.schedule.rows {
        Every::Time(_) => format!("{:?}", clock.time / parts),
        _ => format!("{}", (clock.steps as f64 / parts) as u64),
    };
    overrides.extend([
        format!("run.thermo_every={}", every(11.0)),
        format!("run.snapshot_every={}", every(7.3)),
        format!("run.checkpoint_every={}", every(4.1)),
    ]);
    overrides
}

/// Final state of a scene run without files: clock, particles, and their positions.
pub fn end_of(prepared: &Prepared) -> (Clock, Particles, Vec<[f32; 3]>) {
    let mut simulation = prepared.start(StartPurpose::Run).expect("it starts");
    simulation.advance(&[prepared.schedule.until], &AtomicBool::new(false)).expect("it does not fail");
    (simulation.clock(), simulation.particles(), simulation.per_particle().positions())
}

/// Moments at which something is due, from the start to the end.
pub fn moments(every: Every, end: &Clock) -> Vec<f64> {
    let (every, end) = match every {
        Every::Time(every) => (every, end.time),
        Every::Steps(every) => (every as f64, end.steps as f64),
        Every::Never | Every::Seconds(_) => return vec![0.0],
    };
    (0..).map(|times| f64::from(times) * every).take_while(|moment| *moment <= end).collect()
}
