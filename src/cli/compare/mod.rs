//! `stripmine compare`: runs one scene in two configurations and compares the trajectories and the means.

mod means;

use crate::console::{CommandFailure, Common, print, print_json};
use crate::report::FrameBuilder;
use crate::report::terminal;
use clap::Args;
use means::{ComparedMean, compared_means, means_table};
use serde::Serialize;
use std::collections::HashMap;
use std::sync::atomic::AtomicBool;
use stripmine_physics::averages::{AveragedRows, RunAverages};
use stripmine_physics::domain::Domain;
use stripmine_physics::method::{
    Every, MethodEntry, Methods, PhysicsFailure, Prepared, Simulation, StartPurpose, Until, load,
};
use stripmine_physics::number::{count_with_noun, significant};
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::SceneErrors;

/// Compares two configurations of a scene bit by bit, and their means
///
/// Runs the scene in both; prints the first difference, its growth over time, and the means with the difference over its error.
#[derive(Args)]
pub(super) struct CompareVerb {
    /// Preset name or scene file
    scene: String,
    /// Overrides a value in both configurations; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Overrides a value in the second configuration only; can be repeated
    #[arg(long = "against", value_name = "SECTION.KEY=VALUE", required = true)]
    against: Vec<String>,
}

/// Exponent of the shortest interval: samples are taken at the start and after 2⁻¹⁶, 2⁻¹⁵, … 1 of the run.
const PARTS: u32 = 16;

/// Relative difference of times up to which two samples are at the same time.
const EVEN: f64 = 1e-9;

/// Differences of the two runs at one time.
#[derive(Serialize)]
struct TrajectoryDifference {
    /// Clock of the first run.
    steps: u64,
    events: u64,
    time: f64,
    /// Particles present in both runs.
    particles: usize,
    /// Particles present in one run only: lost in the other.
    unmatched: usize,
    /// True if all numbers have the same bits.
    same_bits: bool,
    /// Largest difference of positions (length) and of velocities (length/time), and the particle with the former.
    position: f64,
    velocity: f64,
    particle: Option<u32>,
}

#[derive(Serialize)]
struct Comparison {
    /// True if all samples have the same bits.
    same_bits: bool,
    /// Index of the first sample with a difference.
    first_difference: Option<usize>,
    looks: Vec<TrajectoryDifference>,
    means: Vec<ComparedMean>,
}

/// Configuration in progress, with rows of observables as a run has them.
struct ComparedRun {
    simulation: Box<dyn Simulation>,
    until: Until,
    rows: AveragedRows,
    every: Every,
    /// Moment of the next row.
    due: Option<Until>,
}

impl ComparedRun {
    fn start(prepared: &Prepared, entry: &MethodEntry) -> Result<ComparedRun, PhysicsFailure> {
        let (mut simulation, every) = (prepared.start(StartPurpose::Run)?, prepared.schedule.rows);
        let mut rows = AveragedRows::new(prepared.quantities(entry));
        rows.add(&simulation.row());
        let due = every.next(&simulation.clock());
        Ok(ComparedRun { simulation, until: prepared.schedule.until, rows, every, due })
    }

    /// Advances to a moment, and records the rows on the way.
    fn advance(&mut self, moment: Until) -> Result<(), PhysicsFailure> {
        while !moment.has_been_reached(&self.simulation.clock()) {
            let moments: Vec<Until> = self.due.into_iter().chain([moment]).collect();
            self.simulation.advance(&moments, &AtomicBool::new(false))?;
            let clock = self.simulation.clock();
            if self.due.is_some_and(|due| due.has_been_reached(&clock)) {
                self.rows.add(&self.simulation.row());
                self.due = self.every.next(&clock);
            }
        }
        Ok(())
    }
}

impl CompareVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let read = |more: &[String]| -> Result<(Prepared, &'static MethodEntry), CommandFailure> {
            let overrides: Vec<String> = self.overrides.iter().chain(more).cloned().collect();
            let read = load(&self.scene, &overrides, methods);
            Ok(read.map_err(|mistakes| mistakes_of_against(mistakes, more))?)
        };
        let ((prepared, entry), (against, entry_against)) = (read(&[])?, read(&self.against)?);
        prepared.memory.clone().with_concurrent(&against.memory).fits(&self.scene)?;
        let mut first = ComparedRun::start(&prepared, entry)?;
        let mut second = ComparedRun::start(&against, entry_against)?;
        let domain = prepared.domain;
        let mut looks = vec![trajectory_difference(&*first.simulation, &*second.simulation, &domain)];
        for part in (0..=PARTS).rev() {
            let moment = fraction_of_run(first.until, part);
            if moment.has_been_reached(&first.simulation.clock()) {
                continue;
            }
            first.advance(moment)?;
            second.advance(fraction_of_run(second.until, part))?;
            looks.push(trajectory_difference(&*first.simulation, &*second.simulation, &domain));
        }
        let ends = [&first, &second].map(|run| run.simulation.clock().time);
        let first_difference = looks.iter().position(|look| !look.same_bits);
        let means = compared_means([&first, &second].map(|run| RunAverages::of(&run.rows)));
        let comparison = Comparison { same_bits: first_difference.is_none(), first_difference, looks, means };
        if common.json {
            return print_json(&comparison);
        }
        print(&comparison_text(&self.scene, &comparison, ends))?;
        if comparison.same_bits {
            return Ok(());
        }
        print(&format!("\n{}", terminal::render(&means_table(&comparison.means))))
    }
}

/// Names `--against` as the location of mistakes in overrides of the second configuration.
fn mistakes_of_against(SceneErrors(mut mistakes): SceneErrors, against: &[String]) -> SceneErrors {
    for mistake in &mut mistakes {
        if let Some(text) =
            mistake.file.strip_prefix("--set ").filter(|text| against.iter().any(|it| it == text))
        {
            mistake.file = format!("--against {text}");
        }
    }
    SceneErrors(mistakes)
}

/// End of the run divided by 2^part.
fn fraction_of_run(until: Until, part: u32) -> Until {
    match until {
        Until::Steps(steps) => Until::Steps((steps >> part).max(1)),
        Until::Events(events) => Until::Events((events >> part).max(1)),
        Until::Time(time) => Until::Time(time / f64::from(1u32 << part)),
    }
}

fn trajectory_difference(
    first: &dyn Simulation,
    second: &dyn Simulation,
    domain: &Domain,
) -> TrajectoryDifference {
    let (one, other): (Particles, Particles) = (first.particles(), second.particles());
    let by_id: HashMap<u32, _> = other.all().iter().map(|particle| (particle.id, particle)).collect();
    let clock = first.clock();
    let mut seen = TrajectoryDifference {
        steps: clock.steps,
        events: clock.events,
        time: clock.time,
        particles: 0,
        unmatched: 0,
        same_bits: true,
        position: 0.0,
        velocity: 0.0,
        particle: None,
    };
    for particle in one.all() {
        let Some(twin) = by_id.get(&particle.id) else { continue };
        seen.particles += 1;
        let length = |vector: [f64; 3]| vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        let apart = length(domain.displacement(particle.position, twin.position));
        let faster = length([0, 1, 2].map(|axis| twin.velocity[axis] - particle.velocity[axis]));
        if apart > seen.position {
            (seen.position, seen.particle) = (apart, Some(particle.id));
        }
        seen.velocity = seen.velocity.max(faster);
        let bits = |of: &stripmine_physics::particles::Particle| {
            (of.position.map(f64::to_bits), of.velocity.map(f64::to_bits), of.omega.to_bits())
        };
        seen.same_bits &= bits(particle) == bits(twin);
    }
    seen.unmatched = one.len() + other.len() - 2 * seen.particles;
    seen.same_bits &= seen.unmatched == 0;
    seen
}

/// Describes the difference of the first sample with other bits.
fn first_difference(seen: &TrajectoryDifference) -> String {
    let by = |what: &str, most: f64| format!("{what} differ by up to {}", significant(most, 2));
    match seen {
        _ if seen.position > 0.0 => by("positions", seen.position),
        _ if seen.velocity > 0.0 => by("velocities", seen.velocity),
        _ if seen.unmatched > 0 => {
            count_with_noun(seen.unmatched, "particle is in one run only", "particles are in one run only")
        }
        _ => "angular velocities or signs of zeros differ".to_owned(),
    }
}

fn comparison_text(scene: &str, comparison: &Comparison, ends: [f64; 2]) -> String {
    let looks = &comparison.looks;
    let answer = match comparison.first_difference {
        None => format!("{scene}: same bits in all {} samples", looks.len()),
        Some(0) => format!("{scene}: the two configurations differ at the start"),
        Some(at) => {
            let (before, seen) = (&looks[at - 1], &looks[at]);
            format!(
                "{scene}: same bits up to time {}; {} at time {}",
                significant(before.time, 6),
                first_difference(seen),
                significant(seen.time, 6)
            )
        }
    };
    let has_events = looks.iter().any(|look| look.events > 0);
    let unit = if has_events { "events" } else { "steps" };
    let is_later = (ends[1] - ends[0]).abs() > EVEN * ends[0].abs();
    let later = is_later.then(|| {
        let [first, second] = ends.map(|time| significant(time, 6));
        format!(
            "The second configuration ends at time {second}, not {first}: set the length of the run by time."
        )
    });
    terminal::render(
        &FrameBuilder::of(looks)
            .count(unit, |look| if has_events { look.events } else { look.steps })
            .text("time", |look| significant(look.time, 6))
            .text("same bits", |look| if look.same_bits { "yes" } else { "no" })
            .text("position", |look| significant(look.position, 2))
            .text("velocity", |look| significant(look.velocity, 2))
            .text("particle", |look| look.particle.map_or(String::new(), |id| id.to_string()))
            .count("in one only", |look| look.unmatched)
            .table("comparison", answer)
            .note(
                "Largest differences over all particles; `particle` has the largest difference of positions.",
            )
            .notes(later),
    )
}
