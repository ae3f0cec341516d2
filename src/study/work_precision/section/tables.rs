//! The tables over all scenes.

use super::super::Errors;
use super::super::conclusions::wishes as wishes_of;
use super::super::dataset::{Run, WorkPrecision};
use super::super::measures::Measure;
use crate::report::{Cell, Rows, Table};
use crate::study::growth::EndedBy;
use crate::study::orders::Fitted;

type Scenes = [(String, WorkPrecision)];

/// Every table.
pub fn of(scenes: &Scenes) -> Vec<Table> {
    let all = [
        wishes(scenes),
        errors(scenes),
        orders(scenes),
        outcomes(scenes),
        means(scenes),
        references(scenes),
        failed(scenes),
    ];
    all.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

fn wishes(scenes: &Scenes) -> Table {
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
        .short("its error (the same)", |(.., found)| found.as_ref().and_then(|it| it.run.error(Measure::Position)))
        .number("cost of a unit of time (ms)", 3, |(.., found)| {
            found.as_ref().and_then(|it| Some(1e3 * it.run.cost()?))
        })
        .number("of the scene's own cost (%)", 0, |(.., found)| {
            found.as_ref().and_then(|it| Some(100.0 * it.of_own?))
        })
        .table("wishes", "Which way and which step for which wish")
        .note("Errors of positions at the end of the time that is compared. A way: integrator, precision, search, execution. No way is named \
               where too little happens in that time, nor one that theory, a check or a warning of its run speaks against.")
}

/// The steps that an order was fitted through: the shortest and the longest.
fn steps_of(fitted: Option<Fitted>) -> [Cell; 2] {
    fitted.map_or([Cell::Nothing, Cell::Nothing], |it| it.range.map(Cell::Short))
}

/// Their headings.
const STEPS_OF: [&str; 2] = ["shortest step of the fit", "longest step of the fit"];

fn orders(scenes: &Scenes) -> Table {
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
        .table("orders", "Orders of convergence, measured and by theory")
        .note("In the digits of the reference; fitted through the smallest steps whose error is at least three times the reference's own. No \
               number: fewer than three such steps.")
        .note("A single run scatters about its line: the error that the beginning and the end of a contact make depends on where in a step they \
               fall (see the collision). Theory is of the root of the mean square over these phases.")
}

fn outcomes(scenes: &Scenes) -> Table {
    let orders = scenes.iter().flat_map(|(name, data)| {
        let orders = data.collision.iter().flat_map(|collision| &collision.orders);
        orders.map(move |order| (name, data, order))
    });
    Rows::of(orders)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(_, data, order)| {
            let way = data.ways.iter().find(|way| way.label == order.choice);
            way.map_or("", |way| &way.scheme)
        })
        .text("outcome", |(.., order)| &order.outcome)
        .number("order of the RMS", 2, |(.., order)| order.spread.map(|it| it.order))
        .number("order of the mean", 2, |(.., order)| order.mean.map(|it| it.order))
        .cells(STEPS_OF, |(.., order)| steps_of(order.spread))
        .table("collision", "One collision: how the error of what comes out falls")
        .note("Over starts shifted by parts of a step. Where a force sets in as ξ^s inside a step, the step errs by dt^(s+1) ζ(−s, phase), \
               Hurwitz's zeta function: order 2.5 for the kink of ξ^1.5, order 1 for the jump of a damping force. Its mean over all phases is \
               zero, so the mean falls faster than the root of the mean square, and a line through single runs lies somewhere between: velocity \
               Verlet on one elastic collision was seen at 2.6 to 2.8.")
        .note("Velocity Verlet's own error of second order does not show in the speed after an elastic collision: the energy that it keeps \
               differs from the energy itself only while discs touch.")
}

/// Means over time of the scene's own ways.
fn means(scenes: &Scenes) -> Table {
    compared("means", scenes, |data, choice| data.own == choice)
}

/// Means over time of every way, for programs.
pub fn all_means(scenes: &Scenes) -> Table {
    compared("all_means", scenes, |_, _| true)
}

fn compared(name: &str, scenes: &Scenes, is_shown: fn(&WorkPrecision, &str) -> bool) -> Table {
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
        .table(name, "Means over time of the scene's own way beside the reference's")
        .note("Paired by seed; one bar in twenty misses zero by chance. The density profile: root of the mean square over bins along both sides \
               of the box. All other ways: `all_means.csv`.")
}

/// Every error with the scene's own step.
fn errors(scenes: &Scenes) -> Table {
    let own = scenes.iter().flat_map(|(name, data)| {
        let own = data.runs.iter().filter(|run| run.power == 0 && data.ways[run.way].is_primary);
        own.map(move |run| (name, &data.ways[run.way], run))
    });
    let mut rows = Rows::of(own)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(_, way, _)| &way.scheme)
        .text("precision", |(_, way, _)| &way.digits);
    for measure in Measure::ALL {
        rows = rows.short(measure.name(), |(.., run)| run.error(measure));
    }
    rows.number("cost of a unit of time (ms)", 3, |(.., run)| run.cost().map(|cost| 1e3 * cost))
        .table("errors", "Every error with the scene's own step")
        .note("Angular momentum has no meaning in a box with periodic sides. Every run: `runs.csv`.")
}

fn references(scenes: &Scenes) -> Table {
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
        .table("references", "What is compared, and how sure the reference is")
}

fn failed(scenes: &Scenes) -> Table {
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
        .table("failed", "What failed, and why")
        .note("Larger steps than one that failed were not tried.")
}

/// Ways that the scene is refused in, and why; those that are refused in every scheme and precision as one.
fn refused(data: &WorkPrecision) -> Vec<(String, &str)> {
    let mut all: Vec<(String, &str)> = vec![];
    for way in &data.ways {
        let Some(why) = &way.refused else { continue };
        let alike = |other: &&super::super::Way| other.cost == way.cost;
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
pub fn runs(scenes: &Scenes) -> Table {
    let runs = scenes
        .iter()
        .flat_map(|(name, data)| data.runs.iter().map(move |run| (name, &data.ways[run.way], run)));
    let end = |run: &Run, pick: fn(f64, f64) -> f64| run.costs.iter().copied().reduce(pick);
    let mut rows = Rows::of(runs)
        .text("scene", |(name, ..)| *name)
        .text("way", |(_, way, _)| &way.label)
        .short("step", |(.., run)| run.step);
    for measure in Measure::ALL {
        rows = rows.number(measure.name(), 0, |(.., run)| run.error(measure));
    }
    rows.number("cost (s)", 0, |(.., run)| run.cost())
        .number("least cost (s)", 0, |(.., run)| end(run, f64::min))
        .number("largest cost (s)", 0, |(.., run)| end(run, f64::max))
        .number("clock periods", 0, |(.., run)| run.clocks)
        .cell("failed", |(.., run)| run.outcome.as_ref().err().map(String::as_str))
        .cell("what speaks against it", |(.., run)| (!run.is_sound()).then(|| run.objections.join("; ")))
        .table("runs", "Every run")
}
