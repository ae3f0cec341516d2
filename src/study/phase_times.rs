//! How long is each phase of a step, and how much was there to do? Runs of the bench scene, timed phase by phase.

use super::pace::{COUNTS, Timed, at_pace, quantile, reading, was_at_pace};
use super::throughput::MeasurementError;
use crate::method::lattice_md::Lengths;
use crate::method::{Failure, Method, Phase};
use crate::model::host::Amounts;
use crate::run::{assemble, model};
use crate::scene::{Checked, Document};
use std::f64::consts::PI;
use std::time::Instant;
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
    /// The execution, as a scene names it; [`LISTS`] for the rival, [`FAST_LISTS`] for its fast execution.
    pub execution: &'static str,
}

/// The name of the neighbour lists among the executions.
pub const LISTS: &str = "lists";
/// The name of the fast execution.
pub const FAST: &str = "fast";
/// The name of the lists in the fast execution.
pub const FAST_LISTS: &str = "fast lists";

/// Places of half a mask of 5×5 cells.
pub(super) const HALF_MASK: f64 = 12.0;

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
        if self.has_lists() {
            overrides.push("method.kind=\"neighbor-list\"".to_owned());
        }
        if self.execution == FAST_LISTS {
            overrides.push("method.execution=\"fast\"".to_owned());
        } else if self.execution != LISTS {
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
            FAST_LISTS => Some("fast lists"),
            FAST if self.occupancy < stripmine_kernels::sweep::fast::lattice::SPARSE => Some("fast, sparse"),
            FAST => Some("fast"),
            _ => None,
        }
    }

    /// Whether it has neighbour lists.
    pub fn has_lists(&self) -> bool {
        [LISTS, FAST_LISTS].contains(&self.execution)
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
    /// Nanoseconds a step of every phase, sample by sample; without the making of lists.
    samples: [Vec<Timed>; Phase::ALL.len()],
    /// Nanoseconds of each making of lists.
    makings: Vec<Timed>,
    /// Makings a step.
    made: f64,
}

impl PhaseTimes {
    /// Of so many discs, nothing measured yet.
    pub fn none(discs: usize) -> PhaseTimes {
        PhaseTimes {
            amounts: Amounts { discs: discs as f64, ..Amounts::default() },
            samples: Default::default(),
            makings: vec![],
            made: 0.0,
        }
    }

    /// The same run measured once more, at another time.
    #[must_use]
    pub fn joined(mut self, more: PhaseTimes) -> PhaseTimes {
        let [a, b] = [&self, &more].map(|times| times.samples[Phase::Forces as usize].len() as f64);
        let mean = |x: f64, y: f64| (a * x + b * y) / (a + b);
        self.amounts = self.amounts.with(&more.amounts, mean);
        self.made = mean(self.made, more.made);
        self.makings.extend(more.makings);
        for (samples, more) in self.samples.iter_mut().zip(more.samples) {
            samples.extend(more);
        }
        self
    }

    /// Nanoseconds of a phase a step at the pace of a reference, and the quartiles of the samples: makings of lists are as
    /// often as they were.
    pub fn typical(&self, phase: Phase, reference: f64) -> (f64, [f64; 2]) {
        let paced = at_pace(&self.samples[phase as usize], reference);
        let making =
            if phase == Phase::Index { self.made * self.making(reference).unwrap_or(0.0) } else { 0.0 };
        let of = |share: f64| making + quantile(&paced, share).unwrap_or(0.0);
        (of(COUNTS), [of(0.25), of(0.75)])
    }

    /// Whether enough samples of a phase were at the pace of a reference.
    pub fn was_at_pace(&self, phase: Phase, reference: f64) -> bool {
        was_at_pace(&self.samples[phase as usize], reference)
    }

    /// Nanoseconds of a phase without the making of lists.
    pub fn quiet(&self, phase: Phase, reference: f64) -> f64 {
        quantile(&at_pace(&self.samples[phase as usize], reference), COUNTS).unwrap_or(0.0)
    }

    /// Nanoseconds of a making of lists; none if there was none.
    pub fn making(&self, reference: f64) -> Option<f64> {
        quantile(&at_pace(&self.makings, reference), COUNTS)
    }

    /// How much slower than where the reference was taken the host was in each sample.
    pub fn paces(&self, reference: f64) -> impl Iterator<Item = f64> {
        let samples = self.samples[Phase::Forces as usize].iter();
        samples.map(move |sample| sample.pace(reference))
    }
}

/// Least nanoseconds of a sample: a shared host changes its pace within milliseconds, and a sample that lasts longer than the
/// pace says nothing of it.
const SHORTEST: f64 = 200_000.0;
/// Samples that a repeat is taken in, at most.
const FINEST: usize = 8;

/// How much of a run is timed.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    /// Steps before the clock starts.
    pub equilibration: usize,
    /// Repeats, each taken in several samples.
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
    let lists = method.lists().is_some();
    let cells = if lists { 0 } else { Lengths::new(&model, discs, checked.particles.len()).cells };
    let steps = (sampling.particle_steps / discs).clamp(sampling.least_steps, 2000);
    let mut times = PhaseTimes::none(discs);
    let mut before = reading();
    let made = |method: &dyn Method| method.lists().map_or(0, |(_, made)| made);
    let (mut all, mut made_in_all, mut found) = (0, 0, Found::default());
    // The first sample is to warm up: only what it takes to make lists counts, for that is rare. It says how many steps one
    // of the others has.
    let (mut count, mut left, mut warm) = (sampling.equilibration, steps * sampling.repeats, false);
    let mut group = 1;
    loop {
        method.reset_timings();
        let mut makings = vec![];
        let start = Instant::now();
        for _ in 0..count {
            let (seconds, earlier) = (method.timings().seconds(Phase::Index), made(method.as_ref()));
            method.step().map_err(|failure: Failure| failure)?;
            if made(method.as_ref()) > earlier {
                makings.push(method.timings().seconds(Phase::Index) - seconds);
            }
            if warm {
                found.look(method.as_ref());
            }
        }
        let step = start.elapsed().as_nanos() as f64 / count.max(1) as f64;
        let after = reading();
        let around = [before, after];
        before = after;
        all += count;
        made_in_all += makings.len();
        let making: f64 = makings.iter().sum();
        times.makings.extend(makings.iter().map(|seconds| Timed { ns: 1e9 * seconds, around }));
        for &phase in Phase::ALL {
            let seconds = method.timings().seconds(phase);
            let (seconds, of) = match phase {
                Phase::Index => (seconds - making, count - makings.len()),
                _ => (seconds, count),
            };
            if warm && of > 0 {
                times.samples[phase as usize].push(Timed { ns: 1e9 * seconds / of as f64, around });
            }
        }
        if warm {
            left -= count;
        } else {
            warm = true;
            group = ((SHORTEST / step).ceil() as usize).max(steps.div_ceil(FINEST));
        }
        if left == 0 {
            break;
        }
        count = group.min(left);
    }
    times.made = made_in_all as f64 / all.max(1) as f64;
    let discs = discs as f64;
    let near = HALF_MASK * discs * discs / cells.max(1) as f64;
    let candidates = if lists { found.mean(found.candidates) } else { near };
    times.amounts = Amounts {
        discs,
        cells: cells as f64,
        candidates,
        contacts: found.mean(found.contacts),
        remade: times.made * discs,
        relisted: if lists { times.made * candidates } else { 0.0 },
    };
    Ok(times)
}

/// What some steps met.
#[derive(Default)]
struct Found {
    steps: u64,
    candidates: u64,
    contacts: u64,
}

impl Found {
    fn look(&mut self, method: &dyn Method) {
        self.steps += 1;
        self.candidates += method.lists().map_or(0, |(entries, _)| entries as u64);
        self.contacts += method.length(Length::Pairs);
    }

    fn mean(&self, sum: u64) -> f64 {
        sum as f64 / self.steps.max(1) as f64
    }
}
