//! Time for which ISO99's grid holds, with its dynamic cut-off, in equilibrium and out of it.

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::study::StudyError;
use stripmine_physics::method::hard_disks::keys::{ENGINE, MASK, RESTITUTION};
use stripmine_physics::method::hard_disks::options::EngineChoice;
use stripmine_physics::method::observed::summary_number;
use stripmine_physics::scene::{COUNT, Overrides};

/// Scenes: name in the tables, preset, and collisions of a disc in a window.
const SCENES: [(&str, &str, u64); 3] =
    [("fluid", "hard-disks", 2), ("cooling gas", "cooling-gas", 1), ("hot floor", "hot-floor", 1)];
/// Windows of a scene.
const WINDOWS: usize = 24;
/// Discs of the fluid and of the cooling gas, and restitution of the latter.
const DISCS: u64 = 2500;
const DISSIPATIVE: f64 = 0.9;

/// A part of a run.
struct LifetimeWindow {
    /// Time at the end, and collisions of a disc until then.
    time: f64,
    passed: f64,
    duration: f64,
    collisions: f64,
    /// Fills of the grid.
    fills: f64,
}

impl LifetimeWindow {
    fn lifetime(&self) -> f64 {
        self.duration / self.fills
    }
}

/// Runs every scene.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let meter = ProgressMeter::new(SCENES.len() as f64, lab.progress);
    let all = meter.run_cases(&SCENES, windows)?;
    Ok(FinishedItem::of(frames(&all)).with_seeds([1]))
}

fn frames(all: &[Vec<LifetimeWindow>]) -> [ResultFrame; 2] {
    let named = || SCENES.iter().map(|(name, ..)| *name).zip(all);
    let windows = named().flat_map(|(name, windows)| windows.iter().map(move |it| (name, windows, it)));
    let sum =
        |windows: &[LifetimeWindow], of: fn(&LifetimeWindow) -> f64| windows.iter().map(of).sum::<f64>();
    // A fixed time is that of the first window.
    let fixed = |windows: &[LifetimeWindow]| sum(windows, |it| it.duration) / windows[0].lifetime();
    let shortest = |windows: &[LifetimeWindow]| {
        windows.iter().map(LifetimeWindow::lifetime).fold(f64::INFINITY, f64::min)
    };
    let spread = |windows: &[LifetimeWindow]| {
        let mean = sum(windows, LifetimeWindow::lifetime) / windows.len() as f64;
        let square: f64 = windows.iter().map(|it| (it.lifetime() / mean - 1.0).powi(2)).sum();
        (square / (windows.len() as f64 - 1.0)).sqrt()
    };
    [
        FrameBuilder::of(windows)
            .text("scene", |(name, ..)| *name)
            .number("time", 3, |(.., it)| it.time)
            .number("collisions of a disc", 0, |(.., it)| it.passed)
            .number("collisions", 0, |(.., it)| it.collisions)
            .number("fills", 0, |(.., it)| it.fills)
            .number("lifetime of a fill over the first", 3, |(_, all, it)| it.lifetime() / all[0].lifetime())
            .frame("windows", "Lifetime of a filled grid over the time of the run"),
        FrameBuilder::of(named())
            .text("scene", |(name, _)| *name)
            .number("standard deviation over the mean lifetime", 3, |(_, all)| spread(all))
            .number("shortest lifetime over the first", 3, |(_, all)| shortest(all) / all[0].lifetime())
            .number("fills in a thousand collisions", 2, |(_, all)| {
                1e3 * sum(all, |it| it.fills) / sum(all, |it| it.collisions)
            })
            .number("with the first lifetime throughout", 2, |(_, all)| {
                1e3 * fixed(all) / sum(all, |it| it.collisions)
            })
            .frame("scenes", "Fills of the grid with the dynamic cut-off and with a fixed lifetime"),
    ]
}

fn windows(&(name, preset, collisions): &(&str, &str, u64)) -> Result<Vec<LifetimeWindow>, StudyError> {
    let scene = Overrides::new().set(&ENGINE, EngineChoice::Reference).set(&MASK, "min");
    let scene = match name {
        "hot floor" => scene,
        "cooling gas" => scene.set(&COUNT, DISCS).set(&RESTITUTION, DISSIPATIVE),
        _ => scene.set(&COUNT, DISCS),
    };
    let mut running = RunningScene::begin(preset, &scene)?;
    let discs = running.simulation.particles().grain_count() as u64;
    if name == "fluid" {
        running.advance_events(10 * discs)?;
    }
    let state = |running: &RunningScene| -> Result<[f64; 2], StudyError> {
        Ok([running.simulation.clock().time, summary_number(&running.simulation.summary(), "remaps")?])
    };
    let mut before = state(&running)?;
    let mut found = vec![];
    for window in 1..=WINDOWS {
        running.advance_events(collisions * discs)?;
        let after = state(&running)?;
        found.push(LifetimeWindow {
            time: after[0],
            passed: (2 * collisions) as f64 * window as f64,
            duration: after[0] - before[0],
            collisions: (collisions * discs) as f64,
            fills: (after[1] - before[1]).max(1.0),
        });
        before = after;
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameValue;

    /// By hand: a gas whose grid holds for 1, 2 and 4 units of time, two fills each, needs 6 fills in 14 units, and 14 with the first lifetime
    /// throughout.
    #[test]
    fn slowing_gas_needs_fewer_fills() {
        let window = |lifetime: f64, fills: f64| LifetimeWindow {
            time: 0.0,
            passed: 0.0,
            duration: lifetime * fills,
            collisions: 100.0,
            fills,
        };
        let all =
            [1.0, 1.0, 2.0].map(|it| vec![window(1.0, 2.0), window(it, 2.0), window(3.0 * it - 2.0, 2.0)]);
        let [_, scenes] = frames(&all);
        let equals = |name: &str, expected: [f64; 3]| {
            let at = scenes.position(name).unwrap();
            for (row, expected) in scenes.rows.iter().zip(expected) {
                assert!(
                    matches!(row[at], FrameValue::Number(it) if (it - expected).abs() < 0.01),
                    "{name}: {row:?}"
                );
            }
        };
        equals("fills_in_a_thousand_collisions", [20.0; 3]);
        equals("with_the_first_lifetime_throughout", [20.0, 20.0, 14_000.0 / 300.0]);
        equals("shortest_lifetime_over_the_first", [1.0; 3]);
    }
}
