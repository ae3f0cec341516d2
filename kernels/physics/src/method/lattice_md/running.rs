//! Runs of granular discs: observations, energy balance, summary.

use super::assemble::model_following_energy;
use super::balance::{BalanceTerms, GravityPath, internal_energy};
use super::check::CheckedGranularScene;
use super::checks;
use super::quantities::{GranularObservation, OBSERVABLES};
use super::run_monitor::RunMonitor;
use super::{
    DiscUniformity, GranularModel, GranularTotals, Lengths, SteppedGrains, TotalEntry, assemble,
    assemble_following_energy, ledger, model, programs,
};
use crate::io::checkpoint::CheckpointCounter;
use crate::method::pairwise::{Crossings, PlaneMotion};
use crate::method::stepped::{Stepped, Stepwise};
use crate::method::{
    Change, Clock, MethodObservable, PhysicsFailure, RunWarning, Snapshot, StartPurpose, SteeredQuantity,
    Steering, SteeringError, has_no,
};
use crate::number::significant;
use crate::observe::{Observation, ObservationSums, SceneProperties};
use crate::scene::Precision;
use serde::Serialize;
use serde_json::{Value, json};
use std::cell::{Cell, OnceCell};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use stripmine_kernels::isa::OpCounts;

/// Name of the phase in which discs are observed.
const OBSERVING: &str = "observe";

/// Data of a run beside its discs.
pub(super) struct GranularRun {
    model: GranularModel,
    scenery: SceneProperties,
    /// Energy balance since the start.
    work: BalanceTerms,
    /// Observation of this moment, if already requested.
    seen: OnceCell<GranularObservation>,
    /// Seconds spent on observations: a phase outside the steps.
    observing: Cell<f64>,
    /// Columns and rows of the lattice, if the scene needs one, and discs for each cell.
    lattice: Option<([usize; 2], f64)>,
    discs: [usize; 2],
    /// Number of `[[walls]]`.
    stated_walls: usize,
    /// Periodic check, if this is a run.
    run_monitor: Option<RunMonitor>,
    /// True if a checkpoint may lack the counts of crossed periods.
    counts_for_motion_alone: bool,
}

/// Starts the discs of a checked scene.
///
/// # Errors
/// [`PhysicsFailure`] if the start violates a precondition, or the processor lacks the requested instruction set.
pub(super) fn begin(
    checked: &CheckedGranularScene,
    purpose: StartPurpose,
) -> Result<Stepped<GranularRun>, PhysicsFailure> {
    let grains = match purpose {
        StartPurpose::Run => assemble_following_energy(checked)?,
        StartPurpose::Measurement => assemble(checked)?,
    };
    let CheckedGranularScene { scene, particles, geometry, .. } = checked;
    let model = model(checked);
    let scenery = SceneProperties::of(&model);
    let path = GravityPath::begin(&scenery, grains.crossings(), || grains.unwrapped());
    let sums = grains.sums(&scenery, &path);
    let work = BalanceTerms::begin(path, &Observation::new(grains.steps(), grains.time(), &sums, &scenery));
    let run_monitor = (purpose == StartPurpose::Run).then(|| {
        let mut run_monitor = RunMonitor::of(checked);
        run_monitor.sample_speeds(&sums.grains);
        run_monitor
    });
    let count = particles.grain_count();
    let cells = [geometry.shape.columns(), geometry.shape.rows()];
    let granular = GranularRun {
        model,
        scenery,
        work,
        seen: OnceCell::new(),
        observing: Cell::default(),
        lattice: scene.needs_lattice().then_some((cells, geometry.occupancy)),
        discs: [count, particles.len() - count],
        stated_walls: scene.plane.list.len(),
        run_monitor,
        counts_for_motion_alone: model_following_energy(checked).counts_crossings_for_motion_alone(),
    };
    Ok(Stepped::new(grains, granular))
}

impl GranularRun {
    fn set_gravity(&mut self, gravity: [f64; 2]) {
        (self.model.gravity, self.scenery.gravity) = (gravity, gravity);
    }
}

impl Stepped<GranularRun> {
    /// Observation of this moment, computed once.
    fn seen(&self) -> &GranularObservation {
        self.method.seen.get_or_init(|| {
            let (grains, sums) = (&self.state, self.sums());
            let now = Observation::new(grains.steps(), grains.time(), &sums, &self.method.scenery);
            let totals = grains.totals();
            GranularObservation {
                now,
                balance: self.method.work.balance(&now, &sums, &totals, self.steering.work),
                totals,
            }
        })
    }

    /// Sums over the discs and their contacts now; the time is recorded.
    fn sums(&self) -> ObservationSums {
        let start = Instant::now();
        let GranularRun { scenery, work, observing, .. } = &self.method;
        let sums = self.state.sums(scenery, work.gravity_path());
        observing.set(observing.get() + start.elapsed().as_secs_f64());
        sums
    }

    /// Refuses velocities (length/time) of driven walls, and of walls that could pass discs between two steps.
    fn check_wall_velocities(&self, velocities: &[[f64; 2]]) -> Result<(), SteeringError> {
        let GranularRun { model, .. } = &self.method;
        let limit = model.watch.map_or(f64::INFINITY, |watch| watch.longest_step() / model.dt);
        for (number, (velocity, motion)) in velocities.iter().zip(self.state.wall_motions()).enumerate() {
            let speed = PlaneMotion { velocity: *velocity, ..motion }.fastest();
            let (reason, remedy) = if motion.drive.is_some() && *velocity != [0.0; 2] {
                ("which a force drives".to_owned(), "leave its row [0, 0]".to_owned())
            } else if speed > limit {
                let (speed, limit) = (significant(speed, 5), significant(limit, 5));
                (
                    format!("at up to {speed}: it could pass discs between two steps"),
                    format!("keep it below {limit}"),
                )
            } else {
                continue;
            };
            let reason = format!("wall_velocities[{number}] moves wall {}, {reason}", number + 1);
            return Err(SteeringError::refused(reason, remedy));
        }
        Ok(())
    }

    /// Work of the programs relative to the fullest model on the same lattice; none where a step is not a fixed program.
    fn relative_work(&self) -> Option<f64> {
        if self.state.ledger().parts().is_empty() {
            return None;
        }
        let GranularRun { model, discs: [grains, walls], .. } = &self.method;
        let lengths = Lengths::new(model, *grains, grains + walls);
        let work = |model: &GranularModel| -> u64 {
            let parts = ledger(&programs(model, Precision::F64)).parts();
            let cost = parts.iter();
            cost.map(|(_, length, counts)| counts.total() * lengths.range(*length).len() as u64).sum()
        };
        let everything = GranularModel { friction: true, discs: DiscUniformity::Varying, ..model.clone() };
        Some(work(model) as f64 / work(&everything) as f64)
    }
}

/// Row of the summary's ledger: a part of a step.
#[derive(Serialize)]
struct LedgerRow {
    part: &'static str,
    /// Vector length, as a symbol.
    length: &'static str,
    /// Vector length in the last step.
    n: u64,
    /// Operations on each element.
    operations: u64,
}

fn ledger_rows(grains: &SteppedGrains) -> Vec<LedgerRow> {
    let parts = grains.ledger().parts();
    let rows = parts.iter().map(|(part, length, counts)| LedgerRow {
        part,
        length: length.symbol(),
        n: grains.length(*length),
        operations: counts.total(),
    });
    rows.collect()
}

impl Stepwise for GranularRun {
    type State = SteppedGrains;
    type Seen = GranularObservation;
    const OBSERVABLES: &'static [MethodObservable<GranularObservation>] = &OBSERVABLES;

    fn step(run: &mut Stepped<Self>, _interrupted: &AtomicBool) -> Result<bool, PhysicsFailure> {
        run.method.seen.take();
        run.state.step()?;
        if run.method.run_monitor.is_some() && RunMonitor::is_due(run.state.steps()) {
            let sums = run.sums();
            run.method.run_monitor.iter_mut().for_each(|run_monitor| run_monitor.sample_speeds(&sums.grains));
        }
        Ok(true)
    }

    fn with_observation<R>(run: &Stepped<Self>, work: impl FnOnce(&GranularObservation) -> R) -> R {
        work(run.seen())
    }

    fn wall_velocities(run: &Stepped<Self>) -> Vec<[f64; 2]> {
        let stated = run.state.wall_motions().take(run.method.stated_walls);
        stated.map(|motion| motion.velocity).collect()
    }

    fn own_values(run: &Stepped<Self>) -> Vec<f64> {
        run.state.own_values()
    }

    fn save_into(run: &Stepped<Self>, kept: &mut Snapshot) {
        for (name, total) in run.state.totals().entries() {
            match total {
                TotalEntry::Count(count) => kept.add_count(name, count),
                TotalEntry::Sum(sum) => kept.add_sum(name, sum),
            }
        }
        run.state.own_entries().iter().for_each(|(name, sum)| kept.add_sum(name, *sum));
        kept.counters.extend(run.method.run_monitor.iter().flat_map(RunMonitor::counters));
        if run.steering.gravity.is_some() {
            run.method.work.keep_path(kept);
        }
    }

    fn change(run: &mut Stepped<Self>, change: &Change) -> Result<f64, SteeringError> {
        let refused =
            |why: &str, remedy: &str| Err(has_no("this scene of lattice-md", change.quantity, why, remedy));
        match change.quantity {
            SteeredQuantity::BathTemperature => {
                return refused("its discs are in no bath", "change velocities instead");
            }
            SteeredQuantity::AngularVelocities if !run.method.model.friction => {
                return refused("without friction discs do not rotate", "start it with law.friction above 0");
            }
            _ => {}
        }
        let GranularObservation { now, balance, .. } = run.seen();
        let (before, gravity_work) = (internal_energy(now), balance.gravity_work);
        if let Some(velocities) = change.wall_velocities() {
            run.check_wall_velocities(&velocities)?;
            run.state.set_wall_velocities(&velocities);
        }
        let motion = change.motion_of(&run.state.particles());
        run.state.restart(&motion, change.gravity())?;
        run.method.seen.take();
        if let Some(gravity) = change.gravity() {
            run.method.set_gravity(gravity);
            let grains = &run.state;
            let path = GravityPath::begin(&run.method.scenery, grains.crossings(), || grains.unwrapped());
            run.method.work.change_gravity(path, gravity_work);
        }
        let (sums, grains) = (run.sums(), &run.state);
        let after = Observation::new(grains.steps(), grains.time(), &sums, &run.method.scenery);
        Ok(internal_energy(&after) - before)
    }

    fn take_up(run: &mut Stepped<Self>, steering: &Steering, begun: u64) -> Result<(), String> {
        if let Some(gravity) = steering.gravity {
            if !run.state.set_gravity(gravity) {
                return Err("gravity was changed during the run: resume it on one rank".to_owned());
            }
            run.method.set_gravity(gravity);
        }
        run.state.begun_after(begun);
        Ok(())
    }

    fn restore(run: &mut Stepped<Self>, clock: Clock, mut snapshot: Snapshot) -> Result<(), String> {
        let totals = GranularTotals::from_entries(|name| match snapshot.counters.get(name)? {
            CheckpointCounter::Count(count) => Some(TotalEntry::Count(*count)),
            CheckpointCounter::Sum(sum) => Some(TotalEntry::Sum(*sum)),
        });
        let discs = run.method.discs[0] + run.method.discs[1];
        let totals = totals.map_err(|name| format!("the total {name} is missing"))?;
        totals.check_plausible(clock.steps, discs as u64)?;
        if let Some(run_monitor) = &mut run.method.run_monitor {
            run_monitor.restore(&snapshot.counters)?;
        }
        run.method.seen.take();
        if run.steering.gravity.is_some() {
            let grains = run.method.discs[0];
            run.method.work.restore_path(&run.method.scenery, grains, &snapshot)?;
        }
        let mut columns = std::mem::take(&mut snapshot.columns);
        if run.method.counts_for_motion_alone {
            Crossings::begin_in(&mut columns, discs);
        }
        run.state.restore(clock.steps, totals, &columns)?;
        run.state.restore_own(|name| snapshot.sum(name))
    }

    fn phases(run: &Stepped<Self>) -> BTreeMap<&'static str, f64> {
        let observing = Some((OBSERVING, run.method.observing.get())).filter(|(_, seconds)| *seconds > 0.0);
        run.state.timings().named().into_iter().chain(observing).collect()
    }

    fn reset_phases(run: &mut Stepped<Self>) {
        run.state.reset_timings();
        run.method.observing.take();
    }

    fn work(run: &Stepped<Self>) -> f64 {
        run.method.discs[0] as f64 * run.state.steps() as f64
    }

    fn operations(run: &Stepped<Self>) -> Vec<(OpCounts, u64)> {
        let parts = run.state.ledger().parts();
        parts.into_iter().map(|(_, length, counts)| (counts, run.state.length(length))).collect()
    }

    fn summary(run: &Stepped<Self>) -> Vec<(&'static str, Value)> {
        let (GranularObservation { now, balance, totals, .. }, GranularRun { discs, lattice, .. }) =
            (run.seen(), &run.method);
        let lists = run.state.lists();
        vec![
            ("discs", json!({ "grains": discs[0], "walls": discs[1] })),
            (
                "lattice",
                json!(lattice.map(|([columns, rows], _)| json!({ "columns": columns, "rows": rows }))),
            ),
            ("occupancy", json!(lattice.map(|(_, occupancy)| occupancy))),
            ("energy", json!(balance)),
            ("long_steps", json!(totals.long_steps)),
            ("deep_disc_steps", json!(totals.deep_disc_steps)),
            ("resolved_conflicts", json!(totals.shared_cells)),
            ("deepest_watched", json!(totals.deepest)),
            ("listed_pairs", json!(lists.map(|(entries, _)| entries))),
            ("lists_made", json!(lists.map(|(_, made)| made))),
            ("ledger", json!(ledger_rows(&run.state))),
            ("work_relative_to_everything", json!(run.relative_work())),
            ("last", json!(now)),
        ]
    }

    fn warnings(run: &Stepped<Self>) -> Vec<RunWarning> {
        let (GranularObservation { balance, totals, .. }, run_monitor) =
            (run.seen(), &run.method.run_monitor);
        let passed = run.method.work.energy_scale(balance);
        let energy = run_monitor.as_ref().and_then(|_| checks::energy(balance, passed));
        let looked = run_monitor.iter().flat_map(RunMonitor::warnings);
        checks::counted(totals).into_iter().chain(looked).chain(energy).collect()
    }

    fn in_words(run: &Stepped<Self>) -> String {
        let ([grains, walls], GranularObservation { now, .. }) = (run.method.discs, run.seen());
        let mut text = format!("{grains} grains and {walls} wall discs");
        if let Some(([columns, rows], occupancy)) = run.method.lattice {
            let occupancy = significant(occupancy, 4);
            text.push_str(&format!(" on {columns}×{rows} cells, occupancy {occupancy}"));
        }
        text.push_str(&format!(
            "; temperature {}, flow {}, contacts {}, deepest penetration {}",
            significant(now.temperature, 5),
            significant(now.flow, 5),
            now.contacts,
            significant(now.deepest_penetration, 4)
        ));
        if let Some(share) = run.relative_work().filter(|&share| share < 1.0) {
            let saved = 100.0 * (1.0 - share);
            text.push_str(&format!(
                "\nsaved: {saved:.1} % of a step's operations with friction and different discs"
            ));
        }
        text
    }
}
