//! How long is each phase of a step, and how much was there to do? Runs of the bench scene, timed phase by phase.

use super::samples::Samples;
use crate::model::host::{Amounts, HostModel, OutOfRange};
use std::f64::consts::PI;
use std::time::Instant;
use stripmine_kernels::ledger::Length;
use stripmine_physics::method::Failure;
use stripmine_physics::method::lattice_md::Lengths;
use stripmine_physics::method::lattice_md::keys::{CELL_EDGE, ENGINE, EXECUTION, SEARCH};
use stripmine_physics::method::lattice_md::{Checked, Document};
use stripmine_physics::method::lattice_md::{Engine, Phase};
use stripmine_physics::method::lattice_md::{assemble, model};
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, PRECISION};

/// A run of the bench scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// NP.
    pub particles: usize,
    /// ρ on cells as wide as the radius.
    pub occupancy: f64,
    /// Precision of state and forces, as a scene names it.
    pub precision: &'static str,
    /// What executes the step: an execution of programs as a scene names it, [`FAST`] for the fast engine, [`LISTS`] for the
    /// rival, [`FAST_LISTS`] for lists in the fast engine.
    pub execution: &'static str,
}

/// The name of the neighbour lists among the executions.
pub const LISTS: &str = "lists";
/// The name of the fast engine among them.
pub const FAST: &str = "fast";
/// The name of lists in the fast engine among them.
pub const FAST_LISTS: &str = "fast lists";

/// Places of half a mask of 5×5 cells.
pub(super) const HALF_MASK: f64 = 12.0;

impl Run {
    /// The scene, with further overrides.
    ///
    /// # Errors
    /// [`MeasurementError::Scene`] if there is no such scene.
    pub fn scene(&self, further: impl FnOnce(Overrides) -> Overrides) -> Result<Checked, MeasurementError> {
        let overrides = Overrides::new()
            .set(&COUNT, self.particles)
            .set(&PACKING_FRACTION, PI * self.occupancy)
            .set(&PRECISION, self.precision);
        let overrides = match self.execution {
            FAST | FAST_LISTS => overrides.set(&ENGINE, "fast"),
            LISTS => overrides.set(&EXECUTION, "chained"),
            execution => overrides.set(&EXECUTION, execution),
        };
        let overrides = match self.has_lists() {
            true => overrides.set(&SEARCH, "neighbor-list"),
            // As the source has it; the largest cell that the geometry allows would need fewer.
            false => overrides.set(&SEARCH, "lattice").set(&CELL_EDGE, 0.5),
        };
        Ok(Document::load("bench", &further(overrides))?.check()?)
    }

    /// The name that a host model gives the rates of this run's method, if its work depends on the data: a lattice with few discs
    /// is searched by another algorithm.
    pub fn rates(&self) -> Option<&'static str> {
        match self.execution {
            LISTS => Some("lists"),
            FAST_LISTS => Some("fast lists"),
            FAST if self.occupancy < stripmine_kernels::sweep::fast::lattice::SPARSE => Some("fast, sparse"),
            FAST => Some("fast"),
            _ => None,
        }
    }

    /// Nanoseconds of every phase by the model of a host, where the work depends on the data.
    ///
    /// # Errors
    /// [`OutOfRange`] where the model does not reach.
    pub fn predicted(&self, host: &HostModel, amounts: &Amounts) -> Result<Vec<f64>, OutOfRange> {
        let method = self.rates().unwrap_or_default();
        Phase::ALL.iter().map(|phase| host.rated((method, phase.name(), self.precision), amounts)).collect()
    }

    /// Whether it has neighbour lists.
    pub fn has_lists(&self) -> bool {
        [LISTS, FAST_LISTS].contains(&self.execution)
    }

    /// All that distinguishes it from the others.
    pub fn name(&self) -> String {
        let Run { particles, occupancy, precision, execution } = self;
        format!("{execution}, {precision}, NP = {particles}, ρ = {occupancy}")
    }
}

/// What was measured.
#[derive(Clone, Debug)]
pub struct PhaseTimes {
    /// What there was to do in a step, on average.
    pub amounts: Amounts,
    /// Nanoseconds a step of every phase; without the making of lists.
    samples: [Samples; Phase::ALL.len()],
    /// Nanoseconds of each making of lists.
    makings: Samples,
    /// Makings a step.
    made: f64,
}

impl PhaseTimes {
    /// Nothing measured yet, of `discs` discs.
    pub fn none(discs: usize) -> PhaseTimes {
        PhaseTimes {
            amounts: Amounts { steps: 1.0, discs: discs as f64, ..Amounts::default() },
            samples: Default::default(),
            makings: Samples::default(),
            made: 0.0,
        }
    }

    /// What there is of a run, if there is something already, and the same run measured once more.
    #[must_use]
    pub fn with(before: Option<PhaseTimes>, more: PhaseTimes) -> PhaseTimes {
        match before {
            Some(before) => before.joined(more),
            None => more,
        }
    }

    /// The same run measured once more, at another time.
    #[must_use]
    pub fn joined(mut self, more: PhaseTimes) -> PhaseTimes {
        let [a, b] = [&self, &more].map(|times| times.samples[Phase::Forces as usize].count() as f64);
        let mean = |x: f64, y: f64| (a * x + b * y) / (a + b);
        self.amounts = self.amounts.with(&more.amounts, mean);
        self.made = mean(self.made, more.made);
        self.makings.join(&more.makings);
        for (samples, more) in self.samples.iter_mut().zip(&more.samples) {
            samples.join(more);
        }
        self
    }

    /// Nanoseconds of a phase a step: the middle of the samples, with lists rebuilt as often as they were.
    pub fn of(&self, phase: Phase) -> f64 {
        self.rebuilding(phase) + self.upkeep(phase)
    }

    fn rebuilding(&self, phase: Phase) -> f64 {
        if phase == Phase::Index { self.made * self.making().unwrap_or(0.0) } else { 0.0 }
    }

    /// Nanoseconds of a phase without the rebuilding of lists: the middle of the samples.
    pub fn upkeep(&self, phase: Phase) -> f64 {
        let samples = &self.samples[phase as usize];
        if samples.count() > 0 { samples.middle() } else { 0.0 }
    }

    /// Nanoseconds of a making of lists; none if there was none.
    pub fn making(&self) -> Option<f64> {
        (self.makings.count() > 0).then(|| self.makings.middle())
    }
}

/// Nanoseconds of a sample, about.
const SHORT: f64 = 100_000.0;

/// How much of a run is timed.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    /// Steps before the clock starts.
    pub equilibration: usize,
    /// Repeats, all of them taken in short samples.
    pub repeats: usize,
    /// Particle-steps of a repeat, about.
    pub particle_steps: usize,
    /// Steps of a repeat, at least.
    pub least_steps: usize,
}

/// Runs a scene and times its phases, as runs do.
///
/// # Errors
/// [`MeasurementError`] if it breaks.
pub fn phase_times(checked: &Checked, sampling: &Sampling) -> Result<PhaseTimes, MeasurementError> {
    let discs = checked.particles.grain_count();
    let steps = sampling.repeats * (sampling.particle_steps / discs).clamp(sampling.least_steps, 2000);
    let mut timing = Timing {
        method: assemble(checked)?,
        times: PhaseTimes::none(discs),
        found: Found::default(),
        steps: 0,
        made: 0,
    };
    let step = timing.unnoticed(sampling.equilibration.max(1))?;
    let group = ((SHORT / step).floor() as usize).clamp(1, steps);
    for done in (0..steps).step_by(group) {
        timing.group(group.min(steps - done))?;
    }
    let cells = Lengths::new(&model(checked), discs, checked.particles.len()).cells;
    Ok(timing.done(cells))
}

/// A run that is being timed.
struct Timing {
    method: Box<dyn Engine>,
    times: PhaseTimes,
    found: Found,
    /// Steps so far, and how often lists were made in them.
    steps: usize,
    made: usize,
}

impl Timing {
    /// Steps of which only the makings of lists count, for these are rare. Nanoseconds of the shortest.
    fn unnoticed(&mut self, count: usize) -> Result<f64, Failure> {
        let ran = Ran::some(self.method.as_mut(), count, &mut Found::default())?;
        self.times.take_makings(&ran);
        self.count(count, ran.makings.len());
        Ok(1e9 * ran.shortest)
    }

    fn count(&mut self, steps: usize, made: usize) {
        self.steps += steps;
        self.made += made;
    }

    /// A sample of some steps.
    fn group(&mut self, count: usize) -> Result<(), Failure> {
        let ran = Ran::some(self.method.as_mut(), count, &mut self.found)?;
        self.times.take_group(self.method.as_ref(), count, &ran);
        self.count(count, ran.makings.len());
        Ok(())
    }

    /// The times and amounts, on a lattice of `cells` cells if there is one.
    fn done(self, cells: usize) -> PhaseTimes {
        let Timing { method, mut times, found, steps, made, .. } = self;
        let lists = method.lists().is_some();
        let discs = times.amounts.discs;
        times.made = made as f64 / steps.max(1) as f64;
        let near = HALF_MASK * discs * discs / cells.max(1) as f64;
        let candidates = if lists { found.mean(found.candidates) } else { near };
        times.amounts = Amounts {
            steps: 1.0,
            discs,
            cells: if lists { 0.0 } else { cells as f64 },
            candidates,
            contacts: found.mean(found.contacts),
            makings: if lists { times.made } else { 0.0 },
            remade: times.made * discs,
            relisted: if lists { times.made * candidates } else { 0.0 },
        };
        times
    }
}

/// Steps that were run.
struct Ran {
    /// Seconds of the shortest step.
    shortest: f64,
    /// Seconds of each making of lists, with the upkeep of its step.
    makings: Vec<f64>,
}

impl Ran {
    /// Runs `count` steps and counts what each of them had to do.
    fn some(method: &mut dyn Engine, count: usize, found: &mut Found) -> Result<Ran, Failure> {
        let made = |method: &dyn Engine| method.lists().map_or(0, |(_, made)| made);
        let (mut makings, mut shortest) = (vec![], f64::INFINITY);
        method.reset_timings();
        for _ in 0..count {
            let (seconds, earlier) = (method.timings().seconds(Phase::Index), made(method));
            let start = Instant::now();
            method.step()?;
            shortest = start.elapsed().as_secs_f64().min(shortest);
            found.look(method);
            if made(method) > earlier {
                makings.push(method.timings().seconds(Phase::Index) - seconds);
            }
        }
        Ok(Ran { shortest, makings })
    }
}

impl PhaseTimes {
    /// The times of a group of steps.
    fn take_group(&mut self, method: &dyn Engine, count: usize, ran: &Ran) {
        self.take_makings(ran);
        for &phase in Phase::ALL {
            let seconds = method.timings().seconds(phase);
            let (seconds, of) = match phase {
                Phase::Index => (seconds - ran.makings.iter().sum::<f64>(), count - ran.makings.len()),
                _ => (seconds, count),
            };
            if of > 0 {
                self.samples[phase as usize].push(1e9 * seconds / of as f64);
            }
        }
    }

    fn take_makings(&mut self, ran: &Ran) {
        ran.makings.iter().for_each(|seconds| self.makings.push(1e9 * seconds));
    }
}

/// Candidates and contacts of the steps that were counted.
#[derive(Default)]
struct Found {
    steps: u64,
    candidates: u64,
    contacts: u64,
}

impl Found {
    fn look(&mut self, method: &dyn Engine) {
        self.steps += 1;
        self.candidates += method.lists().map_or(0, |(entries, _)| entries as u64);
        self.contacts += method.length(Length::Pairs);
    }

    fn mean(&self, sum: u64) -> f64 {
        sum as f64 / self.steps.max(1) as f64
    }
}
