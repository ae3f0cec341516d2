//! Running scenes of studies: started from a preset with overrides, observed by the names of quantities.

use crate::statistics::kolmogorov_smirnov;
use crate::study::StudyError;
use std::sync::atomic::AtomicBool;
use stripmine_physics::domain::Domain;
use stripmine_physics::method::observed::{UnknownName, observed};
use stripmine_physics::method::{
    self, METHODS, MethodEntry, ObservedQuantity, Prepared, Simulation, StartPurpose, Until, load,
};
use stripmine_physics::scene::Overrides;

/// Prepares a preset with overrides.
pub(crate) fn prepare_preset(preset: &str, overrides: &Overrides) -> Result<Prepared, StudyError> {
    Ok(load(preset, &overrides.texts(), METHODS)?.0)
}

/// Runs `work` on a pool of `threads` threads.
pub(crate) fn on_threads<T: Send>(
    threads: usize,
    work: impl FnOnce() -> Result<T, StudyError> + Send,
) -> Result<T, StudyError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(StudyError::Threads)?.install(work)
}

/// Bisects a range whose lower end satisfies `holds` and whose upper end does not, by the `middle` of both ends, until it `is_narrow`.
pub(crate) fn bisect_range<T: Copy, E>(
    mut range: [T; 2],
    is_narrow: impl Fn([T; 2]) -> bool,
    middle: impl Fn(T, T) -> T,
    mut holds: impl FnMut(T) -> Result<bool, E>,
) -> Result<[T; 2], E> {
    while !is_narrow(range) {
        let middle = middle(range[0], range[1]);
        range[usize::from(!holds(middle)?)] = middle;
    }
    Ok(range)
}

/// Running scene.
pub(crate) struct RunningScene {
    /// Simulation in its present state.
    pub simulation: Box<dyn Simulation>,
    /// The box.
    pub domain: Domain,
    quantities: &'static [ObservedQuantity],
}

impl RunningScene {
    /// Starts a preset with overrides, with all observables.
    pub(super) fn begin(preset: &str, overrides: &Overrides) -> Result<RunningScene, StudyError> {
        let (prepared, method) = load(preset, &overrides.texts(), METHODS)?;
        RunningScene::of(method, prepared, StartPurpose::Run)
    }

    /// Starts a preset with overrides for timing: only quantities that the motion needs are tracked.
    pub(crate) fn begin_timed(preset: &str, overrides: &Overrides) -> Result<RunningScene, StudyError> {
        let (prepared, method) = load(preset, &overrides.texts(), METHODS)?;
        RunningScene::of(method, prepared, StartPurpose::Measurement)
    }

    /// Starts a prepared scene of a method, whose particles at the start may be released.
    pub(super) fn of(
        method: &'static MethodEntry,
        mut prepared: Prepared,
        purpose: StartPurpose,
    ) -> Result<RunningScene, StudyError> {
        prepared.memory.fits("scene")?;
        let (simulation, domain) = (prepared.start_last(purpose)?, prepared.domain);
        Ok(RunningScene { simulation, domain, quantities: method.quantities })
    }

    /// Advances by some steps.
    pub(super) fn advance_steps(&mut self, steps: u64) -> Result<(), method::PhysicsFailure> {
        self.advance_until(Until::Steps(steps).after(&self.simulation.clock()))
    }

    /// Advances by some events.
    pub(super) fn advance_events(&mut self, events: u64) -> Result<(), method::PhysicsFailure> {
        self.advance_until(Until::Events(events).after(&self.simulation.clock()))
    }

    /// Advances to a moment.
    pub(super) fn advance_until(&mut self, moment: Until) -> Result<(), method::PhysicsFailure> {
        self.simulation.advance(&[moment], &AtomicBool::new(false))
    }

    /// Probability of the Kolmogorov–Smirnov test that the velocity components have Maxwell's distribution at kT/m = `temperature`.
    pub(crate) fn maxwell_probability(&self, temperature: f64) -> f64 {
        let particles = self.simulation.particles();
        let components = particles.grains().iter().flat_map(|it| it.planar_velocity());
        let scaled = components.map(|v| v / temperature.sqrt()).collect();
        kolmogorov_smirnov(scaled, |x| 0.5 * libm::erfc(-x / 2f64.sqrt()))
    }

    /// Present values of some observables, by name.
    pub(super) fn observed_values<const N: usize>(&self, names: [&str; N]) -> Result<[f64; N], UnknownName> {
        observed(self.quantities, &self.simulation.observe(), names)
    }
}
