//! The tables over all scenes.

use super::super::conclusions::{multiple, short, wishes as wishes_of};
use super::super::dataset::WorkPrecision;
use super::super::measures::Measure;
use crate::report::{Cell, Table};
use crate::study::growth::EndedBy;
use crate::study::orders::Fitted;
use crate::study::tables::{table, text};

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

fn number(value: Option<f64>, decimals: usize) -> Cell {
    value.map_or(Cell::Nothing, |value| Cell::Number(value, decimals))
}

fn wishes(scenes: &Scenes) -> Table {
    let rows = scenes.iter().flat_map(|(name, data)| {
        wishes_of(data).into_iter().map(move |answer| match answer {
            Ok(it) => vec![
                text(name),
                text(format!("{:.0e}", it.wish)),
                text(&data.ways[it.run.way].label),
                text(multiple(it.run.power)),
                text(it.run.error(Measure::Position).map_or(String::new(), short)),
                number(it.run.cost().map(|cost| 1e3 * cost), 3),
                number(it.of_own.map(|share| 100.0 * share), 0),
            ],
            Err(denied) => {
                let begin = [text(name), text(format!("{:.0e}", denied.wish)), text(denied.why)];
                begin.into_iter().chain([const { Cell::Nothing }; 4]).collect()
            }
        })
    });
    table(
        "wishes",
        "Which way and which step for which wish",
        &[
            "scene",
            "error wished for, at most (radii; sizes of a system of bodies)",
            "cheapest way",
            "step",
            "its error (the same)",
            "cost of a unit of time (ms)",
            "of the scene's own cost (%)",
        ],
        rows.collect(),
        &["Errors of positions at the end of the time that is compared. A way: integrator, precision, search, execution. No way is named where \
           too little happens in that time, nor one that theory, a check or a warning of its run speaks against."],
    )
}

fn fitted(fitted: Option<Fitted>) -> [Cell; 2] {
    let range = |it: Fitted| text(format!("{} to {}", short(it.range[0]), short(it.range[1])));
    [number(fitted.map(|it| it.order), 2), fitted.map_or(Cell::Nothing, range)]
}

fn orders(scenes: &Scenes) -> Table {
    let rows = scenes.iter().flat_map(|(name, data)| {
        data.orders.iter().map(move |order| {
            let [power, range] = fitted(order.fitted);
            vec![
                text(name),
                text(&data.ways[order.way].scheme),
                text(order.measure.name()),
                power,
                range,
                number(order.theory.map(|(order, _)| order), 1),
                order.theory.map_or(Cell::Nothing, |(_, why)| text(why)),
            ]
        })
    });
    table(
        "orders",
        "Orders of convergence, measured and by theory",
        &["scene", "integrator", "error", "order", "steps of the fit", "theory", "what decides it"],
        rows.collect(),
        &[
            "In the digits of the reference; fitted through the smallest steps whose error is at least three times the reference's own. No \
             number: fewer than three such steps.",
            "A single run scatters about its line: the error that the beginning and the end of a contact make depends on where in a step they \
             fall (see the collision). Theory is of the root of the mean square over these phases.",
        ],
    )
}

fn outcomes(scenes: &Scenes) -> Table {
    let rows = scenes.iter().flat_map(|(name, data)| {
        let orders = data.collision.iter().flat_map(|collision| &collision.orders);
        orders.map(move |order| {
            let scheme = data.ways.iter().find(|way| way.label == order.choice);
            let ([spread, range], [mean, _]) = (fitted(order.spread), fitted(order.mean));
            let scheme = scheme.map_or("", |way| &way.scheme);
            vec![text(name), text(scheme), text(&order.outcome), spread, mean, range]
        })
    });
    table(
        "collision",
        "One collision: how the error of what comes out falls",
        &["scene", "integrator", "outcome", "order of the RMS", "order of the mean", "steps of the fit"],
        rows.collect(),
        &[
            "Over starts shifted by parts of a step. Where a force sets in as ξ^s inside a step, the step errs by dt^(s+1) ζ(−s, phase), \
             Hurwitz's zeta function: order 2.5 for the kink of ξ^1.5, order 1 for the jump of a damping force. Its mean over all phases is \
             zero, so the mean falls faster than the root of the mean square, and a line through single runs lies somewhere between: velocity \
             Verlet on one elastic collision was seen at 2.6 to 2.8.",
            "Velocity Verlet's own error of second order does not show in the speed after an elastic collision: the energy that it keeps differs \
             from the energy itself only while discs touch.",
        ],
    )
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
    let rows = scenes.iter().flat_map(|(name, data)| {
        let all = data.observables.iter().flat_map(|all| &all.comparisons);
        all.filter(|it| is_shown(data, &it.choice)).map(move |it| {
            vec![
                text(name),
                text(&it.observable),
                text(&it.choice),
                text(short(it.step)),
                Cell::Number(100.0 * it.difference, 2),
                Cell::Number(100.0 * it.bar, 2),
                text(if it.reaches_zero() { "no: the bar reaches zero" } else { "yes" }),
            ]
        })
    });
    table(
        name,
        "Means over time of the scene's own way beside the reference's",
        &["scene", "mean of", "way", "step", "difference (%)", "bar, 95 % (%)", "significant"],
        rows.collect(),
        &["Paired by seed; one bar in twenty misses zero by chance. The density profile: root of the mean square over bins along both sides of \
           the box. All other ways: `all_means.csv`."],
    )
}

/// Every error with the scene's own step.
fn errors(scenes: &Scenes) -> Table {
    let rows = scenes.iter().flat_map(|(name, data)| {
        let own = data.runs.iter().filter(|run| run.power == 0 && data.ways[run.way].is_primary);
        own.map(move |run| {
            let way = &data.ways[run.way];
            let mut row = vec![text(name), text(&way.scheme), text(&way.digits)];
            row.extend(
                Measure::ALL.map(|measure| run.error(measure).map_or(Cell::Nothing, |it| text(short(it)))),
            );
            row.push(number(run.cost().map(|cost| 1e3 * cost), 3));
            row
        })
    });
    let columns: Vec<&str> = ["scene", "integrator", "precision"]
        .into_iter()
        .chain(Measure::ALL.map(Measure::name))
        .chain(["cost of a unit of time (ms)"])
        .collect();
    table(
        "errors",
        "Every error with the scene's own step",
        &columns,
        rows.collect(),
        &["Angular momentum has no meaning in a box with periodic sides. Every run: `runs.csv`."],
    )
}

fn references(scenes: &Scenes) -> Table {
    let rows = scenes.iter().map(|(name, data)| {
        let ended_by = match data.growth.ended_by {
            EndedBy::Growth => "the error of four times the step comes to a tenth of a radius",
            EndedBy::Scene => "the scene ends",
            EndedBy::Budget => "more would take too long",
        };
        let of = |errors: &super::super::Errors| {
            text(errors.get(&Measure::Position).map_or("–".to_owned(), |error| short(*error)))
        };
        vec![
            text(name),
            data.growth.rate.map_or(Cell::Nothing, |rate| text(short(rate))),
            text(short(data.growth.window)),
            text(ended_by),
            text(short(data.duration)),
            text(format!("{} {}", short(data.encounters.each), data.encounters.name())),
            text(&data.reference.ways[0]),
            text(short(data.reference.step)),
            of(&data.reference.halving),
            of(&data.reference.second),
            text(match data.plan.left_out.as_slice() {
                [] => "nothing".to_owned(),
                left_out => left_out.join("; "),
            }),
        ]
    });
    table(
        "references",
        "What is compared, and how sure the reference is",
        &[
            "scene",
            "growth of a disturbance (1/time)",
            "comparable up to (time)",
            "because",
            "compared (time)",
            "in that time, for a particle",
            "reference",
            "its step",
            "off by twice the step ",
            "off by another integrator ",
            "left out",
        ],
        rows.collect(),
        &[],
    )
}

fn failed(scenes: &Scenes) -> Table {
    let rows = scenes.iter().flat_map(|(name, data)| {
        let refused = refused(data).into_iter();
        let refused = refused.map(move |(what, why)| vec![text(name), text(what), text("any"), text(why)]);
        let failed = broken(data).into_iter();
        let failed =
            failed.map(move |(what, step, why)| vec![text(name), text(what), text(short(step)), text(why)]);
        refused.chain(failed)
    });
    table(
        "failed",
        "What failed, and why",
        &["scene", "way", "step", "why"],
        rows.collect(),
        &["Larger steps than one that failed were not tried."],
    )
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
    let measures = Measure::ALL.map(Measure::name);
    let rows = scenes.iter().flat_map(|(name, data)| {
        data.runs.iter().map(move |run| {
            let mut row = vec![text(name), text(&data.ways[run.way].label), Cell::Number(run.step, 0)];
            row.extend(Measure::ALL.map(|measure| number(run.error(measure), 0)));
            let ends = [f64::min, f64::max].map(|end| run.costs.iter().copied().reduce(end));
            row.extend([run.cost(), ends[0], ends[1], run.clocks].map(|value| number(value, 0)));
            row.push(run.outcome.as_ref().err().map_or(Cell::Nothing, text));
            row.push(if run.is_sound() { Cell::Nothing } else { text(run.objections.join("; ")) });
            row
        })
    });
    let columns: Vec<&str> = ["scene", "way", "step"]
        .into_iter()
        .chain(measures)
        .chain([
            "cost (s)",
            "least cost (s)",
            "largest cost (s)",
            "clock periods",
            "failed",
            "what speaks against it",
        ])
        .collect();
    table("runs", "Every run", &columns, rows.collect(), &[])
}
