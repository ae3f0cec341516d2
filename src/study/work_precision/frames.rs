//! Diagrams as frames.

use super::conclusions::{as_good, own_run, wishes as wishes_of};
use super::dataset::{Run, Scenes, Way, WorkPrecision};
use super::measures::{Errors, Measure};
use super::points::{drawn, drawn_means, growth, outcomes};
use crate::frame::{Cell, Frame, Rows};
use crate::results::Made;
use crate::statistics::median;
use crate::study::growth::EndedBy;
use crate::study::observables::CHANCE;
use crate::study::orders::Fitted;

/// Frames of diagrams, each with a name for its rows.
pub fn made(scenes: &Scenes) -> Made {
    let mut seeds: Vec<u64> = scenes.iter().flat_map(|(_, data)| data.seeds.clone()).collect();
    seeds.sort_unstable();
    seeds.dedup();
    let frames = [
        of_scenes(scenes),
        wishes(scenes),
        errors(scenes),
        orders(scenes),
        of_collisions(scenes),
        means("means", scenes, |data, choice| data.own == choice),
        means("all_means", scenes, |_, _| true),
        references(scenes),
        failed(scenes),
        runs(scenes),
        drawn(scenes),
        drawn_means(scenes),
        growth(scenes),
        outcomes(scenes),
    ];
    Made::of(frames).with_seeds(seeds)
}

/// A row for each scene: its own configuration beside the cheapest that is as accurate, and the limits of the comparison.
fn of_scenes(scenes: &Scenes) -> Frame {
    let own = |data: &WorkPrecision| own_run(data).cloned();
    let of_position = |run: Run| run.error(Measure::Position);
    let significant = |data: &WorkPrecision| {
        let all = data.observables.iter().flat_map(|all| all.comparisons.clone());
        all.filter(|it| !it.reaches_zero()).collect::<Vec<_>>()
    };
    let farthest = |data: &WorkPrecision| {
        significant(data).into_iter().max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs()))
    };
    let compared = |data: &WorkPrecision| data.observables.as_ref().map(|all| all.comparisons.len() as f64);
    Rows::of(scenes)
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
        .short("own error", |(_, data)| own(data).and_then(of_position))
        .text("own failure", |(_, data)| own(data).and_then(|run| run.outcome.err()).unwrap_or_default())
        .text("own objections", |(_, data)| own(data).map_or(String::new(), |run| run.objections.join("; ")))
        .text("as accurate", |(_, data)| as_good(data).map_or(String::new(), |found| found.way))
        .short("its step (own steps)", |(_, data)| {
            as_good(data).map(|found| libm::exp2(f64::from(found.power)))
        })
        .number("its cost over the own cost", 3, |(_, data)| as_good(data).map(|found| found.of_own))
        .text("why nothing is decided", |(_, data)| data.undecided.clone().unwrap_or_default())
        .count("left out of the time", |(_, data)| {
            u64::from(data.duration < 0.9 * data.growth.window && !data.plan.left_out.is_empty())
        })
        .number("means compared", 0, |(_, data)| compared(data))
        .number("of these significant", 0, |(_, data)| compared(data).map(|_| significant(data).len() as f64))
        .number("significant by chance", 1, |(_, data)| compared(data).map(|all| CHANCE * all))
        .text("mean farthest off", |(_, data)| farthest(data).map_or(String::new(), |it| it.observable))
        .text("its configuration", |(_, data)| farthest(data).map_or(String::new(), |it| it.choice))
        .short("step of that mean", |(_, data)| farthest(data).map(|it| it.step))
        .number("its difference (%)", 1, |(_, data)| farthest(data).map(|it| 100.0 * it.difference))
        .text("mean that is drawn", |(_, data)| {
            let all = data.observables.iter().flat_map(|all| &all.comparisons);
            all.map(|it| it.observable.as_str()).next().unwrap_or_default()
        })
        .short("time of the means", |(_, data)| data.observables.as_ref().map(|all| all.duration))
        .count("seeds", |(_, data)| data.seeds.len())
        .count("starts of the collision", |(_, data)| data.collision.as_ref().map_or(0, |it| it.phases))
        .text("machine", |(_, data)| data.machine.clone().unwrap_or_default())
        .number("difference of repeats (%)", 0, |(_, data)| 100.0 * spread(data))
        .frame("scenes", "Scenes: the own configuration, and the limits of the comparison")
}

/// Difference of the repeats of a run, in parts of the shortest: the median over the runs.
fn spread(data: &WorkPrecision) -> f64 {
    let of = |run: &Run| {
        let [least, most] = [f64::min, f64::max].map(|end| run.costs.iter().copied().reduce(end));
        Some(most? / least? - 1.0)
    };
    median(data.runs.iter().filter_map(of))
}

fn wishes(scenes: &Scenes) -> Frame {
    let answers = scenes.iter().flat_map(|(name, data)| {
        let answers = wishes_of(data).into_iter().map(|answer| match answer {
            Ok(it) => (it.wish, data.ways[it.run.way].label.clone(), Some(it)),
            Err(denied) => (denied.wish, denied.why, None),
        });
        answers.map(move |(wish, said, found)| (name, wish, said, found))
    });
    Rows::of(answers)
        .text("scene", |(name, ..)| *name)
        .short("error wished for, at most (radii; sizes of a system of bodies)", |(_, wish, ..)| *wish)
        .text("cheapest way", |(_, _, said, _)| said.clone())
        .short("step", |(.., found)| found.as_ref().map(|it| it.run.step))
        .short("of the scene's own step", |(.., found)| {
            found.as_ref().map(|it| libm::exp2(f64::from(it.run.power)))
        })
        .short("its error (the same)", |(.., found)| {
            found.as_ref().and_then(|it| it.run.error(Measure::Position))
        })
        .number("cost of a unit of time (ms)", 3, |(.., found)| {
            found.as_ref().and_then(|it| Some(1e3 * it.run.cost()?))
        })
        .number("of the scene's own cost (%)", 0, |(.., found)| {
            found.as_ref().and_then(|it| Some(100.0 * it.of_own?))
        })
        .frame("wishes", "The cheapest configuration and step for an error")
}

/// The steps that an order was fitted through: the shortest and the longest.
fn steps_of(fitted: Option<Fitted>) -> [Cell; 2] {
    fitted.map_or([Cell::Nothing, Cell::Nothing], |it| it.range.map(Cell::Short))
}

/// Their headings.
const STEPS_OF: [&str; 2] = ["shortest step of the fit", "longest step of the fit"];

fn orders(scenes: &Scenes) -> Frame {
    let orders =
        scenes.iter().flat_map(|(name, data)| data.orders.iter().map(move |order| (name, data, order)));
    Rows::of(orders)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(_, data, order)| &data.ways[order.way].scheme)
        .text("error", |(.., order)| order.measure.name())
        .number("order", 2, |(.., order)| order.fitted.map(|it| it.order))
        .cells(STEPS_OF, |(.., order)| steps_of(order.fitted))
        .number("theory", 1, |(.., order)| order.theory.map(|(order, _)| order))
        .cell("what decides it", |(.., order)| order.theory.map(|(_, why)| why))
        .frame("orders", "Orders of convergence, measured and by theory")
}

fn of_collisions(scenes: &Scenes) -> Frame {
    let orders = scenes.iter().flat_map(|(name, data)| {
        let orders = data.collision.iter().flat_map(|collision| &collision.orders);
        orders.map(move |order| (name, data, order))
    });
    Rows::of(orders)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(_, data, order)| data.scheme(&order.choice))
        .text("outcome", |(.., order)| &order.outcome)
        .number("order of the RMS", 2, |(.., order)| order.spread.map(|it| it.order))
        .number("order of the mean", 2, |(.., order)| order.mean.map(|it| it.order))
        .cells(STEPS_OF, |(.., order)| steps_of(order.spread))
        .frame("collision", "One collision: how the error of what comes out falls")
}

fn means(name: &str, scenes: &Scenes, is_shown: fn(&WorkPrecision, &str) -> bool) -> Frame {
    let shown = scenes.iter().flat_map(|(name, data)| {
        let all = data.observables.iter().flat_map(|all| &all.comparisons);
        all.filter(|it| is_shown(data, &it.choice)).map(move |it| (name, it))
    });
    Rows::of(shown)
        .text("scene", |(name, _)| *name)
        .text("mean of", |(_, it)| &it.observable)
        .text("way", |(_, it)| &it.choice)
        .short("step", |(_, it)| it.step)
        .number("difference (%)", 2, |(_, it)| 100.0 * it.difference)
        .number("bar, 95 % (%)", 2, |(_, it)| 100.0 * it.bar)
        .text("significant", |(_, it)| if it.reaches_zero() { "no" } else { "yes" })
        .frame(name, "Means over time beside the reference's")
}

/// Every error with the scene's own step.
fn errors(scenes: &Scenes) -> Frame {
    let own = scenes.iter().flat_map(|(name, data)| {
        let own = data.runs.iter().filter(|run| run.power == 0 && data.ways[run.way].is_primary);
        own.map(move |run| (name, &data.ways[run.way], run))
    });
    let rows = Rows::of(own)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(_, way, _)| &way.scheme)
        .text("precision", |(_, way, _)| &way.digits);
    let with_errors = |rows: Rows<_>, measure: Measure| {
        rows.short(measure.name(), move |(.., run): &(_, _, &Run)| run.error(measure))
    };
    Measure::ALL
        .into_iter()
        .fold(rows, with_errors)
        .number("cost of a unit of time (ms)", 3, |(.., run)| run.cost().map(|cost| 1e3 * cost))
        .frame("errors", "Every error with the scene's own step")
}

fn references(scenes: &Scenes) -> Frame {
    let ended_by = |ended_by: &EndedBy| match ended_by {
        EndedBy::Growth => "the error of four times the step comes to a tenth of a radius",
        EndedBy::Scene => "the scene ends",
        EndedBy::Budget => "more would take too long",
    };
    let of = |errors: &Errors| errors.get(&Measure::Position).copied();
    Rows::of(scenes)
        .text("scene", |(name, _)| name)
        .short("growth of a disturbance (1/time)", |(_, data)| data.growth.rate)
        .short("comparable up to (time)", |(_, data)| data.growth.window)
        .text("because", |(_, data)| ended_by(&data.growth.ended_by))
        .short("compared (time)", |(_, data)| data.duration)
        .short("in that time a particle has", |(_, data)| data.encounters.each)
        .text("of what", |(_, data)| data.encounters.name())
        .text("reference", |(_, data)| &data.reference.ways[0])
        .short("its step", |(_, data)| data.reference.step)
        .short("off by twice the step", |(_, data)| of(&data.reference.halving))
        .short("off by another integrator", |(_, data)| of(&data.reference.second))
        .text("left out", |(_, data)| match data.plan.left_out.as_slice() {
            [] => "nothing".to_owned(),
            left_out => left_out.join("; "),
        })
        .frame("references", "The time that is compared, and the error of the reference")
}

fn failed(scenes: &Scenes) -> Frame {
    let failed = scenes.iter().flat_map(|(name, data)| {
        let refused = refused(data).into_iter().map(|(what, why)| (what, None, why));
        let failed = broken(data).into_iter().map(|(what, step, why)| (what, Some(step), why));
        refused.chain(failed).map(move |(what, step, why)| (name, what, step, why))
    });
    Rows::of(failed)
        .text("scene", |(name, ..)| *name)
        .text("way", |(_, what, ..)| what.clone())
        .cell("step", |(_, _, step, _)| step.map_or(Cell::from("any"), Cell::Short))
        .text("why", |(.., why)| *why)
        .frame("failed", "Failures and their reasons")
}

/// Configurations that the scene is refused in, and why; those that are refused in every scheme and precision as one.
fn refused(data: &WorkPrecision) -> Vec<(String, &str)> {
    let mut all: Vec<(String, &str)> = vec![];
    for way in &data.ways {
        let Some(why) = &way.refused else { continue };
        let alike = |other: &&Way| other.cost == way.cost;
        let is_all = data.ways.iter().filter(alike).all(|other| other.refused.as_ref() == Some(why));
        let what =
            if is_all { format!("any integrator and precision, {}", way.cost) } else { way.label.clone() };
        if !all.iter().any(|(known, _)| *known == what) {
            all.push((what, why));
        }
    }
    all
}

/// Runs that broke, their step, and why; those of one scheme that broke alike as one.
fn broken(data: &WorkPrecision) -> Vec<(String, f64, &str)> {
    let mut all: Vec<(String, f64, &str)> = vec![];
    for run in &data.runs {
        let Err(why) = &run.outcome else { continue };
        let scheme = &data.ways[run.way].scheme;
        let mut alike =
            data.runs.iter().filter(|it| it.step == run.step && data.ways[it.way].scheme == *scheme);
        let what = match alike.all(|other| other.outcome.as_ref().err() == Some(why)) {
            true => format!("{scheme}, in every way that was run"),
            false => data.ways[run.way].label.clone(),
        };
        if !all.iter().any(|(known, step, _)| *known == what && *step == run.step) {
            all.push((what, run.step, why));
        }
    }
    all
}

/// Every run of every scene, for programs.
fn runs(scenes: &Scenes) -> Frame {
    let runs = scenes
        .iter()
        .flat_map(|(name, data)| data.runs.iter().map(move |run| (name, &data.ways[run.way], run)));
    let end = |run: &Run, pick: fn(f64, f64) -> f64| run.costs.iter().copied().reduce(pick);
    let rows = Rows::of(runs)
        .text("scene", |(name, ..)| *name)
        .text("way", |(_, way, _)| &way.label)
        .short("step", |(.., run)| run.step);
    let with_errors = |rows: Rows<_>, measure: Measure| {
        rows.number(measure.name(), 0, move |(.., run): &(_, _, &Run)| run.error(measure))
    };
    Measure::ALL
        .into_iter()
        .fold(rows, with_errors)
        .number("cost (s)", 0, |(.., run)| run.cost())
        .number("least cost (s)", 0, |(.., run)| end(run, f64::min))
        .number("largest cost (s)", 0, |(.., run)| end(run, f64::max))
        .number("clock periods", 0, |(.., run)| run.clocks)
        .cell("failed", |(.., run)| run.outcome.as_ref().err().map(String::as_str))
        .cell("what speaks against it", |(.., run)| (!run.is_sound()).then(|| run.objections.join("; ")))
        .frame("runs", "Every run")
}
