//! The tables over all maps.

use super::super::boundary::Edge;
use super::super::dataset::{Stability, over_seeds};
use super::super::outcome::{Class, Foreseen};
use crate::report::{Cell, Table};
use crate::study::tables::{table, text};

type Maps = [(String, Stability)];

/// Every table of the page.
pub fn of(maps: &Maps) -> Vec<Table> {
    [schemes(maps), said(maps)].into_iter().filter(|table| !table.rows.is_empty()).collect()
}

/// Edges as multiples of the scene's own step: the middle, the lowest and the highest over the seeds.
fn multiples(data: &Stability, edges: &[Edge]) -> [Cell; 2] {
    let Some([middle, low, high]) = over_seeds(edges) else {
        let word = match edges {
            [Edge::Above, ..] if edges.iter().all(|edge| *edge == Edge::Above) => "above the map",
            [Edge::Below, ..] if edges.iter().all(|edge| *edge == Edge::Below) => "below the map",
            _ => "not in every seed",
        };
        return [text(word), Cell::Nothing];
    };
    let range = format!("{:.2} to {:.2}", low / data.step, high / data.step);
    [Cell::Number(middle / data.step, 2), text(range)]
}

fn schemes(maps: &Maps) -> Table {
    let rows = maps.iter().flat_map(|(name, data)| {
        data.schemes.iter().map(move |scheme| {
            let [works, range] = multiples(data, &scheme.edges.works);
            let [ends, _] = multiples(data, &scheme.edges.ends);
            let theory = scheme.theory;
            vec![
                text(name),
                text(&scheme.scheme),
                works,
                range,
                ends,
                theory.map_or(Cell::Nothing, |(step, _)| Cell::Number(step / data.step, 2)),
                theory.map_or(Cell::Nothing, |(_, what)| text(what)),
                scheme.first.map_or(Cell::Nothing, |class| text(class.name())),
            ]
        })
    });
    table(
        "integrators",
        "The largest step of each integrator, at the scene's own values",
        &[
            "scene",
            "integrator",
            "works up to (own steps)",
            "over the seeds",
            "ends up to (own steps)",
            "theory: errors grow beyond (own steps)",
            "by",
            "what comes first beyond",
        ],
        rows.collect(),
        &["Works: the run comes to an end, its energy is off by at most 10 % of what passed through, and its means are those of runs with the \
           smallest step: by at most 5 %, or by what chance alone exceeds once in a thousand runs. What is off by more is confirmed by another \
           seed."],
    )
}

fn said(maps: &Maps) -> Table {
    let mut rows = vec![];
    for (name, data) in maps {
        for class in Class::ALL {
            let said = data.said(|it| it == class);
            if said.all == 0 || class == Class::Refused {
                continue;
            }
            let count = |count: usize| Cell::Number(count as f64, 0);
            rows.push(vec![
                text(name),
                text(class.name()),
                count(said.all),
                count(said.refused),
                count(said.warned_before),
                count(said.warned_by_run),
                if class.ends() { count(said.unsaid()) } else { Cell::Nothing },
            ]);
        }
    }
    table(
        "said",
        "What the program says of it",
        &[
            "scene",
            "what becomes of it",
            "places",
            "refused before",
            "warned of before",
            "warned of by the run",
            "nothing said",
        ],
        rows,
        &["Maps try what the check of a scene refuses, to see what would have become of it. A run that is stopped says so itself."],
    )
}

/// Every place of every map, for a file.
pub fn cells(maps: &Maps) -> Table {
    let mut rows = vec![];
    for (name, data) in maps {
        for (value, cells) in data.values.iter().zip(&data.map) {
            for (step, cell) in data.steps.iter().zip(cells) {
                let foreseen = match cell.foreseen {
                    Foreseen::Nothing => "nothing",
                    Foreseen::Warned => "warned",
                    Foreseen::Refused => "refused",
                };
                rows.push(vec![
                    text(name),
                    text(data.parameter.name),
                    text(format!("{value:e}")),
                    text(format!("{step:e}")),
                    text(cell.class.name()),
                    text(foreseen),
                    text(cell.warned.join(" ")),
                    text(&cell.what),
                ]);
            }
        }
    }
    let columns = ["scene", "parameter", "value", "step", "class", "foreseen", "warned_by_run", "what"];
    table("cells", "Every place", &columns, rows, &[])
}

/// Every edge of every seed, for a file.
pub fn boundaries(maps: &Maps) -> Table {
    let mut rows = vec![];
    for (name, data) in maps {
        for (value, boundary) in data.values.iter().zip(&data.boundaries) {
            for (what, edges) in [("works", &boundary.works), ("ends", &boundary.ends)] {
                for (seed, edge) in data.seeds.iter().zip(edges) {
                    let ends = match edge {
                        Edge::Below => ["".to_owned(), format!("{:e}", data.steps[0])],
                        Edge::Between(ends) => ends.map(|end| format!("{end:e}")),
                        Edge::Above => [format!("{:e}", data.steps[data.steps.len() - 1]), String::new()],
                    };
                    let [low, high] = ends.map(text);
                    rows.push(vec![
                        text(name),
                        text(data.parameter.name),
                        text(format!("{value:e}")),
                        text(what),
                        Cell::Number(*seed as f64, 0),
                        low,
                        high,
                    ]);
                }
            }
        }
    }
    let columns = [
        "scene",
        "parameter",
        "value",
        "edge",
        "seed",
        "largest_step_that_does",
        "smallest_step_that_does_not",
    ];
    table("edges", "Every edge", &columns, rows, &[])
}
