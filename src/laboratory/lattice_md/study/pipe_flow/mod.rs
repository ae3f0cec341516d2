//! Grains falling through a pipe: BP93, section 4, figures 5 and 6.

mod pictures;

use super::StudyError;
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize, run_in_parallel};
use crate::statistics::MeanWithBar;
use stripmine_physics::method::lattice_md::keys::{
    EXECUTION, FRICTION, NORMAL_DAMPING, SEARCH, SHEAR_DAMPING,
};
use stripmine_physics::method::lattice_md::options::SearchKind;
use stripmine_physics::method::lattice_md::{GranularDocument, assemble, model};
use stripmine_physics::observe::waves::{Directions, directions, fano, histogram, strongest_mode};
use stripmine_physics::observe::{Observation, SceneProperties};
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::{DT, GRAVITY, Overrides, PACKING_FRACTION, SEED, STEPS};

/// Time between two samples (s), as in figure 6.
const STRIDE: f64 = 0.05;
/// Bin width for the Fano factor, in mean radii.
const FANO_BIN: f64 = 20.0;
/// Bin width of the density map, in mean radii.
pub(super) const MAP_BIN: f64 = 5.0;
/// Shortest wavelength of waves, in mean radii.
const SHORTEST_WAVE: f64 = 80.0;
/// Steps of the control: 2 s.
const CONTROL: u64 = 40_000;
/// Starts of the small pipe: a run of 68 grains scatters too much to decide.
const SMALL_SEEDS: [u64; 8] = [1, 2, 3, 4, 5, 6, 7, 8];
/// Number of rows of a map resolved by a picture; a line has twice as many points.
const ROWS: usize = 120;

/// Simulates two fifths of the pipe.
pub(crate) fn small_pipe(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    Ok(PipeRuns::of("pipe-small", &Overrides::new(), &SMALL_SEEDS, false, lab)?.made())
}

/// Simulates the whole pipe, with snapshots as in figure 6.
pub(crate) fn whole_pipe(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let runs = PipeRuns::of("pipe", &Overrides::new(), &[1, 2], true, lab)?;
    let (drawn, made) = (&runs.flows[0], runs.made());
    let made = made.with_picture("figure_5", pictures::piece(drawn));
    Ok(made.with_picture("figure_6", pictures::snapshots(drawn)).with_film(pictures::film(drawn)))
}

/// Simulates the whole pipe with fewer grains.
pub(crate) fn thin_pipe(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let thin = Overrides::new().set(&PACKING_FRACTION, 0.35);
    Ok(PipeRuns::of("pipe", &thin, &[1, 2], false, lab)?.made())
}

/// Overrides for a control without waves: an elastic gas without gravity. Its contacts need the shorter step (s).
pub(super) fn elastic_gas(pipe: &Overrides) -> Overrides {
    let gas = pipe.clone().set(&GRAVITY, [0.0; 2]).set(&NORMAL_DAMPING, 0.0).set(&SHEAR_DAMPING, 0.0);
    gas.set(&FRICTION, 0.0).set(&DT, 5e-5)
}

/// Time series and results of a run.
#[derive(Default)]
pub(super) struct Flow {
    seed: u64,
    grains: usize,
    /// Length of the pipe (m).
    length: f64,
    /// Times of the samples, beginning with the start (s).
    pub(super) times: Vec<f64>,
    /// Variance over mean of the grains in bins of [`FANO_BIN`] radii, at each sample.
    pub fano: Vec<f64>,
    /// Strongest Fourier amplitude at wavelengths of at least [`SHORTEST_WAVE`] radii, at each sample.
    pub(crate) strongest_mode: Vec<f64>,
    /// Mean velocity along the pipe at each sample (m/s).
    pub flow: Vec<f64>,
    /// Grains in bins of [`MAP_BIN`] radii, at each sample.
    pub(super) density: Vec<Vec<u32>>,
    /// Spectral power by direction in the last half of the run; forth is the direction of gravity.
    pub(super) directions: Directions,
    /// Largest penetration that exceeds the scene's `max_penetration` (fraction of the sum of the radii).
    deepest: f64,
    /// CRC-32 of the final state, by id.
    checksum: String,
    /// Grains at each sample, if they are drawn.
    frames: Vec<Particles>,
}

/// Mean over the samples of the last half.
pub(super) fn late_mean(course: &[f64]) -> MeanWithBar {
    MeanWithBar::of_time_series(&course[course.len() - course.len() / 2..])
}

/// Runs a pipe. `progress` receives the completed share.
///
/// The run uses neighbour lists: they give bits identical to the lattice's (item `identity`) in a third of the time for such a small scene.
pub(super) fn run_pipe(
    scene: &str,
    overrides: &Overrides,
    seed: u64,
    keeps_frames: bool,
    mut progress: impl FnMut(f64),
) -> Result<Flow, StudyError> {
    let overrides = overrides.clone().set(&SEED, seed);
    let overrides = overrides.set(&SEARCH, SearchKind::NeighborList).set(&EXECUTION, "chained");
    let checked = GranularDocument::load(scene, &overrides.texts())?.check()?;
    let mut method = assemble(&checked)?;
    let scenery = SceneProperties::of(&model(&checked));
    let (length, origin) = (checked.domain.length(0), checked.domain.origin[0]);
    let scene = &checked.scene;
    let every = (STRIDE / scene.integrator.dt).round() as u64;
    let radii = checked.particles.grains().iter().map(|grain| grain.radius);
    let grains = checked.particles.grain_count();
    let radius = radii.sum::<f64>() / grains as f64;
    let bins = |width: f64| (length / (width * radius)).round() as usize;
    let mut flow = Flow { seed, grains, length, ..Flow::default() };
    loop {
        if method.steps().is_multiple_of(every) {
            let now = method.particles();
            let along: Vec<f64> = now.grains().iter().map(|grain| grain.position[0] - origin).collect();
            flow.times.push(method.time());
            flow.fano.push(fano(&histogram(along.iter().copied(), length, bins(FANO_BIN))));
            flow.strongest_mode.push(strongest_mode(&along, length, SHORTEST_WAVE * radius));
            flow.density.push(histogram(along, length, bins(MAP_BIN)));
            flow.flow.push(Observation::of(method.steps(), method.time(), &now, &scenery).flow);
            if keeps_frames {
                flow.frames.push(now);
            }
            progress(method.steps() as f64 / scene.run.steps as f64);
        }
        if method.steps() >= scene.run.steps {
            break;
        }
        method.step()?;
    }
    let late = &flow.density[flow.density.len() / 2..];
    flow.directions = directions(late, length, SHORTEST_WAVE * radius);
    flow.deepest = method.totals().deepest;
    flow.checksum = method.particles().checksum();
    Ok(flow)
}

/// Runs with different seeds, and the control.
struct PipeRuns {
    title: String,
    flows: Vec<Flow>,
    control: Flow,
}

impl PipeRuns {
    fn of(
        scene: &str,
        overrides: &Overrides,
        seeds: &[u64],
        draws: bool,
        lab: &StudyEnvironment<'_>,
    ) -> Result<PipeRuns, StudyError> {
        let control = elastic_gas(overrides).set(&STEPS, CONTROL);
        let mut cases: Vec<_> =
            seeds.iter().map(|&seed| (overrides, seed, draws && seed == seeds[0])).collect();
        cases.push((&control, seeds[0], false));
        let meter = ProgressMeter::new(cases.len() as f64, lab.progress);
        let mut flows = run_in_parallel(&cases, |&(overrides, seed, keeps_frames)| {
            let mut before = 0.0;
            let progress = |share| meter.add(share - std::mem::replace(&mut before, share));
            run_pipe(scene, overrides, seed, keeps_frames, progress)
        })?;
        let control = flows.remove(seeds.len());
        let title = overrides.texts().iter().map(|text| format!(", {text}")).collect::<String>();
        Ok(PipeRuns { title: format!("Runs of {scene}{title}"), flows, control })
    }

    fn made(&self) -> FinishedItem {
        let PipeRuns { title, flows, control } = self;
        let runs = flows.iter().map(|flow| ("pipe", flow)).chain([("elastic gas, no gravity", control)]);
        let runs = FrameBuilder::of(runs)
            .text("run", |(name, _)| *name)
            .count("seed", |(_, flow)| flow.seed)
            .number("Fano at the start", 2, |(_, flow)| flow.fano[0])
            .number("Fano late", 2, |(_, flow)| late_mean(&flow.fano).value)
            .number("± (95 %)", 2, |(_, flow)| late_mean(&flow.fano).bar)
            .number("mode at the start", 3, |(_, flow)| flow.strongest_mode[0])
            .number("mode late", 3, |(_, flow)| late_mean(&flow.strongest_mode).value)
            .number("mean velocity late (m/s)", 3, |(_, flow)| late_mean(&flow.flow).value)
            .number("± (95 %)", 3, |(_, flow)| late_mean(&flow.flow).bar)
            .number("spectral power (independent grains: 1)", 2, |(_, flow)| flow.directions.power)
            .number("power against gravity (%)", 0, |(_, flow)| 100.0 * flow.directions.back)
            .number("standing (%)", 0, |(_, flow)| 100.0 * flow.directions.standing)
            .number("with gravity (%)", 0, |(_, flow)| 100.0 * flow.directions.forth)
            .number("deepest penetration, where beyond the warned", 3, |(_, flow)| {
                (flow.deepest > 0.0).then_some(flow.deepest)
            })
            .text("final state, CRC-32", |(_, flow)| format!("0x{}", flow.checksum))
            .frame("runs", title);
        let mut frames = vec![runs, self.fano_series(), self.summary()];
        if flows.len() > 2 {
            frames.push(self.starts());
        }
        let made = FinishedItem::of(frames);
        made.with_picture("density_map", pictures::map(&flows[0])).with_seeds(flows.iter().map(|it| it.seed))
    }

    /// Fano factors over time.
    fn fano_series(&self) -> ResultFrame {
        let samples = self.flows.iter().flat_map(|flow| {
            let samples = flow.times.iter().zip(&flow.fano).step_by(flow.times.len().div_ceil(2 * ROWS));
            samples.map(|sample| (flow.seed, sample))
        });
        FrameBuilder::of(samples)
            .count("seed", |(seed, _)| *seed)
            .number("time (s)", 2, |(_, (time, _))| **time)
            .number("Fano factor", 2, |(_, (_, fano))| **fano)
            .frame("course", "Variance over mean of the grains in a bin, over time")
    }

    /// Means over the starts, with their errors.
    fn starts(&self) -> ResultFrame {
        let PipeRuns { flows, control, .. } = self;
        let mean = |of: &dyn Fn(&Flow) -> f64| MeanWithBar::of(&flows.iter().map(of).collect::<Vec<_>>());
        let beyond_gas =
            |power: fn(&Directions) -> f64| mean(&|it| power(&it.directions) / power(&control.directions));
        FrameBuilder::of([()])
            .count("starts", |()| flows.len())
            .mean("Fano late", 2, |()| mean(&|it| late_mean(&it.fano).value))
            .mean("against gravity over the gas", 1, |()| beyond_gas(|it| it.power * it.back))
            .mean("with gravity over the gas", 1, |()| beyond_gas(|it| it.power * it.forth))
            .mean("with gravity over one wave", 2, |()| {
                mean(&|it| it.directions.forth / it.directions.of_one_wave[1])
            })
            .frame(
                "starts",
                "Waves of all starts, beside a gas without waves and waves against gravity alone",
            )
    }

    fn summary(&self) -> ResultFrame {
        let PipeRuns { flows, control, .. } = self;
        let least = |of: &dyn Fn(&Directions) -> f64| {
            flows.iter().map(|flow| of(&flow.directions)).fold(f64::INFINITY, f64::min)
        };
        let beyond_gas = |power: fn(&Directions) -> f64| least(&power) / power(&control.directions);
        // Waves of equal amplitude that move only against gravity also have some power with gravity, because they grow and decay.
        let one_wave = least(&|it| it.forth / it.of_one_wave[1]);
        FrameBuilder::of([()])
            .count("grains", |()| flows[0].grains)
            .number("lasting (s)", 2, |()| flows[0].times.last().copied())
            .number("against gravity over the gas", 2, |()| beyond_gas(|it| it.power * it.back))
            .number("with gravity over the gas", 2, |()| beyond_gas(|it| it.power * it.forth))
            .number("with gravity over one wave", 2, |()| one_wave)
            .frame("summary", "Least power of waves over the runs, beside a gas without waves and waves against gravity alone")
    }
}
