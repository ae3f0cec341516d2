//! How long is each phase of a step, and how much was there to do? Runs of the bench scene, timed phase by phase.

use super::throughput::MeasurementError;
use crate::method::lattice_md::Lengths;
use crate::method::{Failure, Method, Phase};
use crate::model::host::Amounts;
use crate::run::{assemble, model};
use crate::scene::{Checked, Document};
use std::f64::consts::PI;
use stripmine_kernels::ledger::Length;

/// A run of the bench scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// NP.
    pub particles: usize,
    /// ρ on cells as wide as the radius.
    pub occupancy: f64,
    /// Precision of state and forces, as a scene names it.
    pub precision: &'static str,
    /// The execution, as a scene names it; [`LISTS`] for the rival.
    pub execution: &'static str,
}

/// The name of the neighbour lists among the executions.
pub const LISTS: &str = "lists";
/// The name of the fast execution.
pub const FAST: &str = "fast";

impl Run {
    /// The scene, with further overrides.
    ///
    /// # Errors
    /// [`MeasurementError::Scene`] if there is no such scene.
    pub fn scene(&self, further: &[&str]) -> Result<Checked, MeasurementError> {
        let mut overrides = vec![
            format!("particles.count={}", self.particles),
            format!("particles.packing_fraction={}", PI * self.occupancy),
            format!("method.precision=\"{}\"", self.precision),
        ];
        if self.execution == LISTS {
            overrides.push("method.kind=\"neighbor-list\"".to_owned());
        } else {
            // As the source has it; the largest cell that the geometry allows would need fewer.
            overrides.push("method.cell_edge=0.5".to_owned());
            overrides.push(format!("method.execution=\"{}\"", self.execution));
        }
        overrides.extend(further.iter().map(|&text| text.to_owned()));
        Ok(Document::load("bench", &overrides)?.check()?)
    }

    /// The name that a host model gives the rates of this run's method, if they hang on the data: a lattice with few discs
    /// is searched in another way.
    pub fn rates(&self) -> Option<&'static str> {
        match self.execution {
            LISTS => Some("lists"),
            FAST if self.occupancy < stripmine_kernels::sweep::fast::lattice::SPARSE => Some("fast, sparse"),
            FAST => Some("fast"),
            _ => None,
        }
    }

    /// All that tells it from the others.
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
    /// Nanoseconds a step of every phase, repeat by repeat.
    pub repeats: Vec<[f64; Phase::ALL.len()]>,
    /// Whether lists were made anew now and then, so that repeats differ in what they had to do.
    pub by_bursts: bool,
}

impl PhaseTimes {
    /// Of so many discs, nothing measured yet.
    pub fn none(discs: usize) -> PhaseTimes {
        let amounts = Amounts { discs: discs as f64, ..Amounts::default() };
        PhaseTimes { amounts, repeats: vec![], by_bursts: false }
    }

    /// The same run measured once more, at another time.
    #[must_use]
    pub fn joined(mut self, more: PhaseTimes) -> PhaseTimes {
        let (a, b) = (self.repeats.len() as f64, more.repeats.len() as f64);
        let means = self.amounts.values().into_iter().zip(more.amounts.values());
        let mut mean = means.map(|(x, y)| (a * x + b * y) / (a + b));
        let mut next = || mean.next().unwrap_or(0.0);
        self.amounts =
            Amounts { discs: next(), cells: next(), candidates: next(), contacts: next(), relisted: next() };
        self.repeats.extend(more.repeats);
        self
    }

    /// Nanoseconds of a phase: the best repeat, or, where repeats differ in what they had to do, their mean.
    pub fn best(&self, phase: Phase) -> f64 {
        let samples = self.repeats.iter().map(|repeat| repeat[phase as usize]);
        if self.by_bursts && phase == Phase::Index {
            return samples.sum::<f64>() / self.repeats.len().max(1) as f64;
        }
        samples.fold(f64::INFINITY, f64::min)
    }

    /// Nanoseconds of the median repeat.
    pub fn median(&self, phase: Phase) -> f64 {
        let mut samples: Vec<f64> = self.repeats.iter().map(|repeat| repeat[phase as usize]).collect();
        samples.sort_by(f64::total_cmp);
        samples.get(samples.len() / 2).copied().unwrap_or(f64::NAN)
    }
}

/// How much of a run is timed.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    /// Steps before the clock starts.
    pub equilibration: usize,
    /// Repeats.
    pub repeats: usize,
    /// Particle-steps of a repeat, about.
    pub particle_steps: usize,
    /// Steps of a repeat, at least.
    pub least_steps: usize,
}

/// Runs a scene and times its phases.
///
/// # Errors
/// [`MeasurementError`] if it breaks.
pub fn phase_times(checked: &Checked, sampling: &Sampling) -> Result<PhaseTimes, MeasurementError> {
    let mut method = assemble(checked)?;
    let model = model(checked);
    let discs = checked.particles.grain_count();
    let cells = Lengths::new(&model, discs, checked.particles.len()).cells;
    let steps = (sampling.particle_steps / discs).clamp(sampling.least_steps, 2000);
    let mut repeats = vec![];
    (0..sampling.equilibration).try_for_each(|_| method.step())?;
    let rebuilds = |method: &dyn Method| method.lists().map_or(0, |(_, rebuilds)| rebuilds);
    let before = rebuilds(method.as_ref());
    let [mut candidates, mut contacts] = [0, 0];
    for _ in 0..sampling.repeats {
        method.reset_timings();
        for _ in 0..steps {
            method.step().map_err(|failure: Failure| failure)?;
            candidates += method.length(Length::Candidates);
            contacts += method.length(Length::Pairs);
        }
        let mut each = [0.0; Phase::ALL.len()];
        for &phase in Phase::ALL {
            each[phase as usize] = 1e9 * method.timings().seconds(phase) / steps as f64;
        }
        repeats.push(each);
    }
    let all = (sampling.repeats * steps) as f64;
    let lists = method.lists().is_some();
    let candidates = candidates as f64 / all;
    let made = (rebuilds(method.as_ref()) - before) as f64 / all;
    Ok(PhaseTimes {
        amounts: Amounts {
            discs: discs as f64,
            cells: if lists { 0.0 } else { cells as f64 },
            candidates,
            contacts: contacts as f64 / all,
            relisted: made * candidates,
        },
        repeats,
        by_bursts: lists,
    })
}
