//! Discs under gravity above a hot floor, without a ceiling: density against height, compared with the barometric law.

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::{MeanWithBar, slope, slope_error};
use crate::study::StudyError;
use stripmine_physics::method::Until;
use stripmine_physics::method::hard_disks::keys::{ENGINE, RESTITUTION, TIME};
use stripmine_physics::method::hard_disks::options::EngineChoice;
use stripmine_physics::method::observed::summary_number;
use stripmine_physics::number::count_with_noun;
use stripmine_physics::scene::{COUNT, GRAVITY, Overrides, SIDES};

/// Gases: number of layers that the discs would fill, and restitution.
const GASES: [(f64, f64); 4] = [(0.02, 1.0), (0.2, 1.0), (1.0, 1.0), (1.0, 0.95)];
/// Scenes for ISO99's look-up of occupied cells.
const SCENES: [&str; 2] = ["hot-floor", "vibrating-floor"];
/// Discs of the atmospheres in which the look-up is counted; each has 0.2 layers and kT/(m g) of [`SCALE`].
const SIZES: [usize; 4] = [200, 800, 3200, 12_800];
/// kT/(m g), in diameters.
const SCALE: f64 = 20.0;
/// Discs in a gas.
const DISCS: usize = 200;
/// Samples of a gas, a time √(kT/m)/g apart.
const LOOKS: usize = 600;
/// Width of the bins of the profile in units of kT/(m g), and their number.
const BINS: (f64, usize) = (0.25, 32);

/// Height profile of a gas.
struct Profile {
    name: String,
    /// Number density by height, over the barometric density at the floor.
    densities: Vec<MeanWithBar>,
    /// Mean height of the centres over kT/(m g): 1 in the barometric law.
    mean_height: MeanWithBar,
    /// Temperature over that of the floor.
    temperature: MeanWithBar,
    /// Largest height of a disc over kT/(m g).
    highest: f64,
}

/// Simulates the gases, and counts the entries of ISO99's look-up.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let runs = GASES.len() + SCENES.len() + SIZES.len();
    let meter = ProgressMeter::new(runs as f64, lab.progress);
    let profiles = meter.run_cases(&GASES, measure_profile)?;
    let look_ups = meter.run_cases(&SCENES, |&scene| compare_look_up(scene))?;
    let growth = meter.run_cases_from_last(&SIZES, |&discs| count_look_up(discs))?;
    let logarithms = |of: fn(&[f64; 2]) -> f64| growth.iter().map(|it| of(it).ln()).collect::<Vec<_>>();
    let (discs, entries) = (logarithms(|it| it[0]), logarithms(|it| it[1]));
    let bins = profiles.iter().flat_map(|it| it.densities.iter().enumerate().map(move |bin| (it, bin)));
    let height = |bin: usize| (bin as f64 + 0.5) * BINS.0;
    Ok(FinishedItem::of([
        FrameBuilder::of(&profiles)
            .text("discs", |it| it.name.clone())
            .count("how many", |_| DISCS)
            .mean("mean height over kT/(m g)", 3, |it| it.mean_height)
            .mean("temperature over the floor's", 3, |it| it.temperature)
            .number("highest seen", 1, |it| it.highest)
            .frame("atmosphere", "Discs above a hot floor"),
        FrameBuilder::of(&look_ups)
            .text("scene", |(scene, ..)| *scene)
            .count("discs (entries of A, BX, BY)", |(_, [source, _], _)| source.simulation.particles().len())
            .number("entries of C and D", 0, |(.., entries)| *entries)
            .count("events", |(_, [source, _], _)| source.simulation.clock().events)
            .text("same bits by the fast engine", |(_, runs, _)| {
                let [source, fast] = runs.each_ref().map(|run| run.simulation.particles());
                if source.all() == fast.all() { "yes" } else { "no" }
            })
            .frame("look-up", "The source's look-up of occupied cells, as printed"),
        FrameBuilder::of(&growth)
            .number("discs", 0, |it| it[0])
            .number("entries of C and D", 0, |it| it[1])
            .number("entries of a disc", 2, |it| it[1] / it[0])
            .frame("growth", "The look-up in atmospheres of 0.2 layers"),
        FrameBuilder::of([()])
            .number("power", 2, |()| slope(&discs, &entries))
            .number("± (95 %)", 2, |()| slope_error(&discs, &entries))
            .frame("powers", "Power of the number of discs by which the entries of C and D grow"),
        FrameBuilder::of(bins)
            .text("discs", |(it, _)| it.name.clone())
            .number("height over kT/(m g)", 3, |(_, (bin, _))| height(*bin))
            .cell("density over the barometric one at the floor", |(_, (_, mean))| {
                TableCell::with_error(mean.value, Some(mean.bar), 4)
            })
            .number("barometric law", 4, |(_, (bin, _))| (-height(*bin)).exp())
            .frame("heights", "Density over the height"),
    ])
    .with_seeds([1]))
}

/// Runs a scene with ISO99's engine and with the fast engine; returns the entries of the former's look-up of occupied cells.
fn compare_look_up(scene: &'static str) -> Result<(&'static str, [RunningScene; 2], f64), StudyError> {
    let run = |engine: EngineChoice| {
        let mut gas = RunningScene::begin(scene, &Overrides::new().set(&ENGINE, engine))?;
        gas.advance_until(Until::Time(100.0))?;
        Ok::<_, StudyError>(gas)
    };
    let source = run(EngineChoice::Reference)?;
    let entries = summary_number(&source.simulation.summary(), "blocks")?;
    Ok((scene, [source, run(EngineChoice::Fast)?], entries))
}

/// A gas with diameter, mass and kT of 1, and kT/(m g) of [`SCALE`].
fn atmosphere(discs: usize, layers: f64) -> Overrides {
    let place = Overrides::new().set(&SIDES, [discs as f64 / layers, 120.0]);
    place.set(&GRAVITY, [0.0, -1.0 / SCALE]).set(&COUNT, discs).set(&TIME, 1e9)
}

/// Number of discs, and the entries of ISO99's look-up: the mean of ten samples in equilibrium.
fn count_look_up(discs: usize) -> Result<[f64; 2], StudyError> {
    let overrides = atmosphere(discs, 0.2).set(&ENGINE, EngineChoice::Reference);
    let mut gas = RunningScene::begin("hot-floor", &overrides)?;
    let mut entries = 0.0;
    for sample in 1..=10 {
        gas.advance_until(Until::Time(10.0 * SCALE + f64::from(sample) * SCALE))?;
        entries += summary_number(&gas.simulation.summary(), "blocks")? / 10.0;
    }
    Ok([discs as f64, entries])
}

/// Measures the profile of a gas.
fn measure_profile(&(layers, restitution): &(f64, f64)) -> Result<Profile, StudyError> {
    let height = SCALE;
    let overrides = atmosphere(DISCS, layers).set(&RESTITUTION, restitution);
    let mut gas = RunningScene::begin("hot-floor", &overrides)?;
    // A disc falls through the height in a time of about √2 √(kT/m)/g.
    let between = height;
    let mut now = 40.0 * between;
    gas.advance_until(Until::Time(now))?;
    let mut densities = vec![vec![]; BINS.1];
    let (mut heights, mut temperatures, mut highest) = (vec![], vec![], 0.0_f64);
    for _ in 0..LOOKS {
        now += between;
        gas.advance_until(Until::Time(now))?;
        let mut counts = vec![0.0; BINS.1];
        let mut height_now = 0.0;
        for disc in gas.simulation.particles().grains() {
            let above = (disc.position[1] - disc.radius) / height;
            height_now += above / DISCS as f64;
            highest = highest.max(above);
            if let Some(count) = counts.get_mut((above / BINS.0) as usize) {
                *count += 1.0;
            }
        }
        heights.push(height_now);
        temperatures.push(gas.observed_values(["kinetic"])?[0] / DISCS as f64);
        // The barometric law has N/h discs per unit of height at the floor.
        let now = counts.into_iter().map(|count| count / (DISCS as f64 * BINS.0));
        densities.iter_mut().zip(now).for_each(|(course, now)| course.push(now));
    }
    let layers = count_with_noun(layers, "layer", "layers");
    let name = if restitution < 1.0 { format!("{layers}, e = {restitution}") } else { layers };
    Ok(Profile {
        name,
        densities: densities.iter().map(|course| MeanWithBar::of_time_series(course)).collect(),
        mean_height: MeanWithBar::of_time_series(&heights),
        temperature: MeanWithBar::of_time_series(&temperatures),
        highest,
    })
}
