//! Runs of the bench scene, timed by phase as runs time themselves, with the amount of work per step.

use super::samples::Samples;
use crate::model::host::{Amounts, HostModel, OutOfRange};
use std::f64::consts::PI;
use std::time::Instant;
use stripmine_kernels::ledger::VectorLength;
use stripmine_kernels::sweep::fast::lattice::SPARSE;
use stripmine_physics::method::PhysicsFailure;
use stripmine_physics::method::lattice_md::keys::{CELL_EDGE, ENGINE, EXECUTION, SEARCH};
use stripmine_physics::method::lattice_md::{
    CheckedGranularScene, GranularDocument, Lengths, Phase, StepProgram, SteppedGrains, assemble, model,
    programs,
};
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, PRECISION};

/// Names of executions: lists of programs, the fast engine, and lists in the fast engine.
pub(super) const LISTS: &str = "lists";
pub(super) const FAST: &str = "fast";
pub(super) const FAST_LISTS: &str = "fast lists";
/// Precisions, by their names in scenes.
pub(super) const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Offsets of half a mask of 5×5 cells.
const HALF_MASK: f64 = 12.0;
/// Approximate nanoseconds of a sample.
const SHORT: f64 = 100_000.0;

/// Parameters of a run of the bench scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BenchRun {
    pub(super) particles: usize,
    /// ρ on cells as wide as the radius.
    pub(super) occupancy: f64,
    pub(super) precision: &'static str,
    /// Name of an execution of programs in scenes, [`LISTS`], [`FAST`] or [`FAST_LISTS`].
    pub(super) execution: &'static str,
}

impl BenchRun {
    /// Loads the scene with further overrides.
    pub(super) fn scene(self, further: &Overrides) -> Result<CheckedGranularScene, MeasurementError> {
        let scene = Overrides::new().set(&COUNT, self.particles).set(&PRECISION, self.precision);
        let scene = scene.set(&PACKING_FRACTION, PI * self.occupancy);
        let scene = match self.execution {
            FAST | FAST_LISTS => scene.set(&ENGINE, "fast"),
            LISTS => scene.set(&EXECUTION, "chained"),
            execution => scene.set(&EXECUTION, execution),
        };
        let scene = match self.has_lists() {
            true => scene.set(&SEARCH, "neighbor-list"),
            // As in BP93; the largest cells that the geometry allows would be fewer.
            false => scene.set(&SEARCH, "lattice").set(&CELL_EDGE, 0.5),
        };
        Ok(GranularDocument::load("bench", &scene.and(further).texts())?.check()?)
    }

    /// Name of the rates of a run whose work depends on the data; `None` for programs. A sparse lattice is searched by another algorithm.
    pub(super) fn rates(self) -> Option<&'static str> {
        match self.execution {
            FAST if self.occupancy < SPARSE => Some("fast, sparse"),
            FAST | FAST_LISTS | LISTS => Some(self.execution),
            _ => None,
        }
    }

    /// Predicted nanoseconds of every phase for work that depends on the data.
    ///
    /// # Errors
    /// [`OutOfRange`] outside the calibrated range of the model.
    pub(super) fn predicted(self, host: &HostModel, amounts: &Amounts) -> Result<Vec<f64>, OutOfRange> {
        let method = self.rates().unwrap_or_default();
        Phase::ALL.iter().map(|phase| host.rated((method, phase.name(), self.precision), amounts)).collect()
    }

    fn has_lists(self) -> bool {
        [LISTS, FAST_LISTS].contains(&self.execution)
    }
}

/// Programs of a step of a scene, and its vector lengths.
pub(super) fn step_of_scene(checked: &CheckedGranularScene) -> (Vec<StepProgram>, Lengths) {
    let (model, discs) = (model(checked), &checked.particles);
    let lengths = Lengths::new(&model, discs.grain_count(), discs.len());
    (programs(&model, checked.scene.machine.precision), lengths)
}

/// Run with its timing samples.
pub(super) struct PhaseTimedRun {
    pub(super) run: BenchRun,
    pub(super) checked: CheckedGranularScene,
    /// Number of steps, and number of list builds in them.
    steps: usize,
    made: usize,
    /// Number of timed steps, and the sums of their list entries and contacts.
    timed: usize,
    entries: usize,
    contacts: u64,
    /// Nanoseconds per step of every phase, without building lists.
    phases: [Samples; Phase::ALL.len()],
    /// Nanoseconds of each list build.
    makings: Samples,
}

impl PhaseTimedRun {
    /// Makes a run without samples.
    pub(super) fn new(run: BenchRun, further: &Overrides) -> Result<PhaseTimedRun, MeasurementError> {
        Ok(PhaseTimedRun {
            run,
            checked: run.scene(further)?,
            steps: 0,
            made: 0,
            timed: 0,
            entries: 0,
            contacts: 0,
            phases: Default::default(),
            makings: Samples::default(),
        })
    }

    /// Runs the scene from its start and times its phases, on the calling thread.
    pub(super) fn measure(&mut self) -> Result<(), MeasurementError> {
        let mut engine = assemble(&self.checked)?;
        // Programs only need warm caches. Fewer steps with many discs, but enough for lists to be rebuilt.
        let (warm_up, least) = match (self.run.rates(), self.run.has_lists()) {
            (None, _) => (3, 2),
            (_, false) => ((100_000 / self.run.particles).clamp(3, 60), 2),
            (_, true) => ((250_000 / self.run.particles).clamp(3, 60), 6),
        };
        let steps = (10_000 / self.run.particles).clamp(least, 2000);
        let shortest = self.advance(&mut engine, warm_up, false)?;
        let group = ((SHORT / shortest) as usize).clamp(1, steps);
        for done in (0..steps).step_by(group) {
            self.advance(&mut engine, group.min(steps - done), true)?;
        }
        Ok(())
    }

    /// Runs some steps, as a sample if they are timed. List builds are always counted, because they are rare. Returns the nanoseconds of the
    /// shortest step.
    fn advance(
        &mut self,
        engine: &mut SteppedGrains,
        count: usize,
        is_timed: bool,
    ) -> Result<f64, PhysicsFailure> {
        let made = |engine: &SteppedGrains| engine.lists().map_or(0, |(_, made)| made);
        let (mut shortest, mut making, mut upkeeps) = (f64::INFINITY, 0.0, count);
        engine.reset_timings();
        for _ in 0..count {
            let (before, earlier) = (engine.timings().seconds(Phase::Index), made(engine));
            let start = Instant::now();
            engine.step()?;
            shortest = start.elapsed().as_secs_f64().min(shortest);
            if made(engine) > earlier {
                let seconds = engine.timings().seconds(Phase::Index) - before;
                self.makings.push(1e9 * seconds);
                making += seconds;
                upkeeps -= 1;
            }
            if is_timed {
                self.timed += 1;
                self.entries += engine.lists().map_or(0, |(entries, _)| entries);
                self.contacts += engine.length(VectorLength::Pairs);
            }
        }
        self.steps += count;
        self.made += count - upkeeps;
        for &phase in Phase::ALL.iter().filter(|_| is_timed) {
            let seconds = engine.timings().seconds(phase);
            let (seconds, of) =
                if phase == Phase::Index { (seconds - making, upkeeps) } else { (seconds, count) };
            if of > 0 {
                self.phases[phase as usize].push(1e9 * seconds / of as f64);
            }
        }
        Ok(1e9 * shortest)
    }

    fn list_builds_per_step(&self) -> f64 {
        self.made as f64 / self.steps.max(1) as f64
    }

    /// Mean amount of work per step.
    pub(super) fn amounts_per_step(&self) -> Amounts {
        let (lists, timed) = (self.run.has_lists(), self.timed.max(1) as f64);
        let discs = self.checked.particles.grain_count();
        let cells = Lengths::new(&model(&self.checked), discs, self.checked.particles.len()).cells as f64;
        let (discs, made) = (discs as f64, self.list_builds_per_step());
        let near = HALF_MASK * discs * discs / cells.max(1.0);
        let candidates = if lists { self.entries as f64 / timed } else { near };
        let of_lists = |amount: f64| if lists { amount } else { 0.0 };
        Amounts {
            steps: 1.0,
            discs,
            cells: cells - of_lists(cells),
            candidates,
            contacts: self.contacts as f64 / timed,
            makings: of_lists(made),
            remade: made * discs,
            relisted: of_lists(made * candidates),
        }
    }

    /// Nanoseconds of a phase per step, including list builds.
    pub(super) fn ns(&self, phase: Phase) -> f64 {
        let making = self.list_builds_per_step() * self.list_build_time().unwrap_or(0.0);
        self.phase_time_without_builds(phase) + if phase == Phase::Index { making } else { 0.0 }
    }

    /// Nanoseconds of a phase per step, without list builds.
    pub(super) fn phase_time_without_builds(&self, phase: Phase) -> f64 {
        self.phases[phase as usize].median().unwrap_or(0.0)
    }

    /// Nanoseconds of a list build; `None` if there was none.
    pub(super) fn list_build_time(&self) -> Option<f64> {
        self.makings.median()
    }
}
