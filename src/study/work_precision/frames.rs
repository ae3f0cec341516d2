//! Frames of diagrams.

use super::conclusions::{cheapest_equivalent, cheapest_runs as wishes_of, own_run};
use super::dataset::{DiagramConfiguration, DiagramRun, NamedDiagrams, WorkPrecision};
use super::growth::EndedBy;
use super::measures::{Errors, Measure};
use super::orders::FittedOrder;
use super::points::{drawn, growth, outcomes};
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::results::FinishedItem;
use crate::statistics::median;
use crate::study::trial::RunFailure;

/// Returns the frames of diagrams, each with a name for its rows.
pub(crate) fn made(scenes: &NamedDiagrams) -> FinishedItem {
    FinishedItem::of([
        of_scenes(scenes),
        wishes(scenes),
        errors(scenes),
        orders(scenes),
        of_collisions(scenes),
        references(scenes),
        failed(scenes),
        runs(scenes),
        drawn(scenes),
        growth(scenes),
        outcomes(scenes),
    ])
}

/// A row for each scene: its own configuration, the cheapest that is as accurate, and the limits of the comparison.
fn of_scenes(scenes: &NamedDiagrams) -> ResultFrame {
    FrameBuilder::of(scenes)
        .text("scene", |(name, _)| name)
        .count("particles", |(_, data)| data.particles)
        .text("unit", |(_, data)| &data.unit)
        .text("unit of time", |(_, data)| data.time_unit.clone().unwrap_or_default())
        .text("own configuration", |(_, data)| &data.own)
        .short("own step", |(_, data)| data.step)
        .short("compared (time)", |(_, data)| data.duration)
        .short("comparable (time)", |(_, data)| data.growth.window)
        .short("growth of a disturbance (1/time)", |(_, data)| data.growth.rate)
        .short("error of the reference", |(_, data)| data.reference.floor.get(&Measure::Position).copied())
        .short("own error", |(_, data)| own_run(data)?.error(Measure::Position))
        .text("own failure", |(_, data)| own_run(data).map_or("", why))
        .text("own objections", |(_, data)| own_run(data).map_or(String::new(), DiagramRun::objections))
        .text("as accurate", |(_, data)| {
            cheapest_equivalent(data).map_or("", |found| &data.of(found.run).label)
        })
        .short("its step (own steps)", |(_, data)| {
            cheapest_equivalent(data).map(|found| in_own_steps(found.run))
        })
        .number("its cost over the own cost", 3, |(_, data)| cheapest_equivalent(data)?.of_own)
        .text("why nothing is decided", |(_, data)| data.undecided.clone().unwrap_or_default())
        .count("left out of the time", |(_, data)| {
            u64::from(data.duration < 0.9 * data.growth.window && !data.plan.left_out.is_empty())
        })
        .count("starts of the collision", |(_, data)| data.collision.as_ref().map_or(0, |it| it.phases))
        .text("machine", |(_, data)| data.machine.clone().unwrap_or_default())
        .number("difference of repeats (%)", 0, |(_, data)| 100.0 * spread(data))
        .frame("scenes", "Scenes: their own configurations, and the limits of the comparison")
}

/// Step in multiples of the scene's own.
fn in_own_steps(run: &DiagramRun) -> f64 {
    libm::exp2(f64::from(run.power))
}

/// Reason of the failure of a run; empty where it finished.
fn why(run: &DiagramRun) -> &str {
    run.outcome.as_ref().err().map_or("", |failure| &failure.why)
}

/// Relative difference of the repeats of a run: the median over the runs.
fn spread(data: &WorkPrecision) -> f64 {
    let of = |run: &DiagramRun| {
        let [least, most] = [f64::min, f64::max].map(|end| run.costs.iter().copied().reduce(end));
        Some(most? / least? - 1.0)
    };
    median(data.runs.iter().filter_map(of))
}

fn wishes(scenes: &NamedDiagrams) -> ResultFrame {
    let answers = scenes.iter().flat_map(|(name, data)| {
        let answers = wishes_of(data).into_iter().map(|(wish, answer)| match answer {
            Ok(found) => (wish, data.of(found.run).label.clone(), Some(found)),
            Err(why) => (wish, why, None),
        });
        answers.map(move |(wish, said, found)| (name, wish, said, found))
    });
    FrameBuilder::of(answers)
        .text("scene", |(name, ..)| *name)
        .short("error wished for, at most (radii; sizes of a system of bodies)", |(_, wish, ..)| *wish)
        .text("cheapest configuration", |(_, _, said, _)| said.clone())
        .short("step", |(.., found)| found.map(|it| it.run.step))
        .short("of the scene's own step", |(.., found)| found.map(|it| in_own_steps(it.run)))
        .short("its error (the same)", |(.., found)| found.and_then(|it| it.run.error(Measure::Position)))
        .number("cost of a unit of time (ms)", 3, |(.., found)| {
            found.and_then(|it| Some(1e3 * it.run.cost()?))
        })
        .number("of the scene's own cost (%)", 0, |(.., found)| found.and_then(|it| Some(100.0 * it.of_own?)))
        .frame("wishes", "The cheapest configuration and step for an error")
}

/// Shortest and longest step of a fit.
fn steps_of(fitted: Option<FittedOrder>) -> [TableCell; 2] {
    fitted.map_or([TableCell::Nothing, TableCell::Nothing], |it| it.range.map(TableCell::Short))
}

/// Headings of these steps.
const STEPS_OF: [&str; 2] = ["shortest step of the fit", "longest step of the fit"];

fn orders(scenes: &NamedDiagrams) -> ResultFrame {
    let orders =
        scenes.iter().flat_map(|(name, data)| data.orders.iter().map(move |order| (name, data, order)));
    FrameBuilder::of(orders)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(_, data, order)| &data.configurations[order.configuration].scheme)
        .text("error", |(.., order)| order.measure.name())
        .number("order", 2, |(.., order)| order.fitted.map(|it| it.order))
        .cells(STEPS_OF, |(.., order)| steps_of(order.fitted))
        .number("theory", 1, |(.., order)| order.theory.map(|(order, _)| order))
        .cell("what decides it", |(.., order)| order.theory.map(|(_, why)| why))
        .frame("orders", "Orders of convergence, measured and theoretical")
}

fn of_collisions(scenes: &NamedDiagrams) -> ResultFrame {
    let orders = scenes.iter().flat_map(|(name, data)| {
        let orders = data.collision.iter().flat_map(|collision| &collision.orders);
        orders.map(move |order| (name, data, order))
    });
    FrameBuilder::of(orders)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(_, data, order)| data.scheme(&order.choice))
        .text("outcome", |(.., order)| order.outcome)
        .number("order of the RMS", 2, |(.., order)| order.spread.map(|it| it.order))
        .number("order of the mean", 2, |(.., order)| order.mean.map(|it| it.order))
        .cells(STEPS_OF, |(.., order)| steps_of(order.spread))
        .frame("collision", "Single collision: order of the error of its outcomes")
}

/// All errors at the scene's own step.
fn errors(scenes: &NamedDiagrams) -> ResultFrame {
    let own = scenes.iter().flat_map(|(name, data)| {
        let own = data.runs.iter().filter(|run| run.power == 0 && data.of(run).is_primary);
        own.map(move |run| (name, data.of(run), run))
    });
    let rows = FrameBuilder::of(own)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(_, it, _)| &it.scheme)
        .text("precision", |(_, it, _)| &it.precision);
    let with_errors = |rows: FrameBuilder<_>, measure: Measure| {
        rows.short(measure.name(), move |(.., run): &(_, _, &DiagramRun)| run.error(measure))
    };
    Measure::ALL
        .into_iter()
        .fold(rows, with_errors)
        .number("cost of a unit of time (ms)", 3, |(.., run)| run.cost().map(|cost| 1e3 * cost))
        .frame("errors", "All errors at the scene's own step")
}

fn references(scenes: &NamedDiagrams) -> ResultFrame {
    let ended_by = |ended_by: &EndedBy| match ended_by {
        EndedBy::Growth => "the error at four times the step reaches a tenth of a radius",
        EndedBy::Scene => "the scene ends",
        EndedBy::Budget => "more would take too long",
    };
    let of = |errors: &Errors| errors.get(&Measure::Position).copied();
    FrameBuilder::of(scenes)
        .text("scene", |(name, _)| name)
        .short("growth of a disturbance (1/time)", |(_, data)| data.growth.rate)
        .short("comparable up to (time)", |(_, data)| data.growth.window)
        .text("because", |(_, data)| ended_by(&data.growth.ended_by))
        .short("compared (time)", |(_, data)| data.duration)
        .short("in that time a particle has", |(_, data)| data.encounters.each)
        .text("of what", |(_, data)| data.encounters.name())
        .text("reference", |(_, data)| &data.reference.configurations[0])
        .short("its step", |(_, data)| data.reference.step)
        .short("off by twice the step", |(_, data)| of(&data.reference.halving))
        .short("off by another integrator", |(_, data)| of(&data.reference.second))
        .text("left out", |(_, data)| match data.plan.left_out.as_slice() {
            [] => "nothing".to_owned(),
            left_out => left_out.join("; "),
        })
        .frame("references", "Compared time, and error of the reference")
}

fn failed(scenes: &NamedDiagrams) -> ResultFrame {
    let failed = scenes.iter().flat_map(|(name, data)| {
        let refused = refused(data).into_iter().map(|(what, why)| (what, None, why));
        let failed = broken(data).into_iter().map(|(what, step, why)| (what, Some(step), why));
        refused.chain(failed).map(move |(what, step, failure)| (name, what, step, failure))
    });
    FrameBuilder::of(failed)
        .text("scene", |(name, ..)| *name)
        .text("configuration", |(_, what, ..)| what.clone())
        .cell("step", |(_, _, step, _)| step.map_or(TableCell::from("any"), TableCell::Short))
        .text("failure", |(.., failure)| failure.cause.name())
        .text("why", |(.., failure)| &failure.why)
        .frame("failed", "Failures and their reasons")
}

/// Configurations in which the scene is refused, with the reason; those refused in every scheme and precision are merged.
fn refused(data: &WorkPrecision) -> Vec<(String, &RunFailure)> {
    let mut all: Vec<(String, &RunFailure)> = vec![];
    for it in &data.configurations {
        let Err(failure) = &it.each else { continue };
        let alike = |other: &&DiagramConfiguration| other.cost == it.cost;
        let is_all = data.configurations.iter().filter(alike).all(|other| other.each == it.each);
        let what =
            if is_all { format!("any integrator and precision, {}", it.cost) } else { it.label.clone() };
        if !all.iter().any(|(known, _)| *known == what) {
            all.push((what, failure));
        }
    }
    all
}

/// Runs that failed, with step and reason; runs of one scheme with the same failure are merged.
fn broken(data: &WorkPrecision) -> Vec<(String, f64, &RunFailure)> {
    let mut all: Vec<(String, f64, &RunFailure)> = vec![];
    for run in &data.runs {
        let Err(failure) = &run.outcome else { continue };
        let scheme = &data.of(run).scheme;
        let mut alike = data.runs.iter().filter(|it| it.step == run.step && data.of(it).scheme == *scheme);
        let what = match alike.all(|other| other.outcome.as_ref().err() == Some(failure)) {
            true => format!("{scheme}, in every configuration tried"),
            false => data.of(run).label.clone(),
        };
        if !all.iter().any(|(known, step, _)| *known == what && *step == run.step) {
            all.push((what, run.step, failure));
        }
    }
    all
}

/// Every run of every scene, for programs.
fn runs(scenes: &NamedDiagrams) -> ResultFrame {
    let runs = scenes
        .iter()
        .flat_map(|(name, data)| data.runs.iter().map(move |run| (name, &data.of(run).label, run)));
    let end = |run: &DiagramRun, pick: fn(f64, f64) -> f64| run.costs.iter().copied().reduce(pick);
    let rows = FrameBuilder::of(runs)
        .text("scene", |(name, ..)| *name)
        .text("configuration", |(_, label, _)| *label)
        .short("step", |(.., run)| run.step);
    let with_errors = |rows: FrameBuilder<_>, measure: Measure| {
        rows.number(measure.name(), 0, move |(.., run): &(_, _, &DiagramRun)| run.error(measure))
    };
    Measure::ALL
        .into_iter()
        .fold(rows, with_errors)
        .number("cost (s)", 0, |(.., run)| run.cost())
        .number("least cost (s)", 0, |(.., run)| end(run, f64::min))
        .number("largest cost (s)", 0, |(.., run)| end(run, f64::max))
        .number("clock periods", 0, |(.., run)| run.outcome.as_ref().ok()?.clocks)
        .cell("failed", |(.., run)| run.outcome.as_ref().err().map(|failure| failure.why.as_str()))
        .cell("what speaks against it", |(.., run)| Some(run.objections()).filter(|it| !it.is_empty()))
        .frame("runs", "Every run")
}
