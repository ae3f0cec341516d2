//! The tables over all maps.

use super::super::boundary::Edge;
use super::super::dataset::{Stability, over_seeds};
use super::super::outcome::{Class, Foreseen};
use crate::report::{Cell, Rows, Table};

type Maps = [(String, Stability)];

/// Every table of the page.
pub fn of(maps: &Maps) -> Vec<Table> {
    [schemes(maps), said(maps)].into_iter().filter(|table| !table.rows.is_empty()).collect()
}

/// Edges as multiples of the scene's own step: the middle, the lowest and the highest over the seeds.
fn multiples(data: &Stability, edges: &[Edge]) -> [Cell; 3] {
    let numbers = over_seeds(edges).map(|steps| steps.map(|step| Cell::Number(step / data.step, 2)));
    numbers.unwrap_or([const { Cell::Nothing }; 3])
}

/// Where there is no such edge.
fn beyond(edges: &[Edge]) -> Option<&'static str> {
    match edges {
        _ if over_seeds(edges).is_some() => None,
        [Edge::Above, ..] if edges.iter().all(|edge| *edge == Edge::Above) => Some("above the map"),
        [Edge::Below, ..] if edges.iter().all(|edge| *edge == Edge::Below) => Some("below the map"),
        _ => Some("not in every seed"),
    }
}

fn schemes(maps: &Maps) -> Table {
    let schemes =
        maps.iter().flat_map(|(name, data)| data.schemes.iter().map(move |scheme| (name, data, scheme)));
    Rows::of(schemes)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(.., scheme)| &scheme.scheme)
        .cells(["works up to (own steps)", "lowest seed", "highest seed"], |(_, data, scheme)| {
            multiples(data, &scheme.edges.works)
        })
        .cell("edge of works", |(.., scheme)| beyond(&scheme.edges.works))
        .cell("ends up to (own steps)", |(_, data, scheme)| multiples(data, &scheme.edges.ends)[0].clone())
        .cell("edge of ends", |(.., scheme)| beyond(&scheme.edges.ends))
        .number("theory: errors grow beyond (own steps)", 2, |(_, data, scheme)| {
            scheme.theory.map(|(step, _)| step / data.step)
        })
        .cell("by", |(.., scheme)| scheme.theory.map(|(_, what)| what))
        .cell("what comes first beyond", |(.., scheme)| scheme.first.map(Class::name))
        .table("integrators", "The largest step of each integrator, at the scene's own values")
        .note("Works: the run comes to an end, its energy is off by at most 10 % of what passed through, and its means are those of runs with \
               the smallest step: by at most 5 %, or by what chance alone exceeds once in a thousand runs. What is off by more is confirmed by \
               another seed.")
}

fn said(maps: &Maps) -> Table {
    let classes = maps
        .iter()
        .flat_map(|(name, data)| Class::ALL.map(|class| (name, class, data.said(|it| it == class))));
    let counted = classes.filter(|(_, class, said)| said.all > 0 && *class != Class::Refused);
    Rows::of(counted)
        .text("scene", |(name, ..)| *name)
        .text("what becomes of it", |(_, class, _)| class.name())
        .number("places", 0, |(.., said)| said.all as f64)
        .number("refused before", 0, |(.., said)| said.refused as f64)
        .number("warned of before", 0, |(.., said)| said.warned_before as f64)
        .number("warned of by the run", 0, |(.., said)| said.warned_by_run as f64)
        .number("nothing said", 0, |(_, class, said)| class.ends().then(|| said.unsaid() as f64))
        .table("said", "What the program says of it")
        .note("Maps try what the check of a scene refuses, to see what would have become of it. A run that is stopped says so itself.")
}

/// Every place of every map, for a file.
pub fn cells(maps: &Maps) -> Table {
    let cells = maps.iter().flat_map(|(name, data)| {
        let rows = data.values.iter().zip(&data.map);
        rows.flat_map(move |(value, cells)| {
            data.steps.iter().zip(cells).map(move |(step, cell)| (name, data, value, step, cell))
        })
    });
    let foreseen = |foreseen: Foreseen| match foreseen {
        Foreseen::Nothing => "nothing",
        Foreseen::Warned => "warned",
        Foreseen::Refused => "refused",
    };
    Rows::of(cells)
        .text("scene", |(name, ..)| *name)
        .text("parameter", |(_, data, ..)| data.parameter.name)
        .number("value", 6, |(_, _, value, ..)| **value)
        .number("step", 6, |(.., step, _)| **step)
        .text("class", |(.., cell)| cell.class.name())
        .text("foreseen", |(.., cell)| foreseen(cell.foreseen))
        .text("warned_by_run", |(.., cell)| cell.warned.join(" "))
        .text("what", |(.., cell)| &cell.what)
        .table("cells", "Every place")
}

/// Every edge of every seed, for a file.
pub fn boundaries(maps: &Maps) -> Table {
    let edges = maps.iter().flat_map(|(name, data)| {
        let boundaries = data.values.iter().zip(&data.boundaries);
        boundaries.flat_map(move |(value, boundary)| {
            let kinds = [("works", &boundary.works), ("ends", &boundary.ends)];
            kinds.into_iter().flat_map(move |(kind, edges)| {
                data.seeds.iter().zip(edges).map(move |(seed, edge)| (name, data, value, kind, seed, edge))
            })
        })
    });
    let does = |data: &Stability, edge: &Edge| match edge {
        Edge::Below => None,
        Edge::Between([low, _]) => Some(*low),
        Edge::Above => Some(data.steps[data.steps.len() - 1]),
    };
    let does_not = |data: &Stability, edge: &Edge| match edge {
        Edge::Below => Some(data.steps[0]),
        Edge::Between([_, high]) => Some(*high),
        Edge::Above => None,
    };
    Rows::of(edges)
        .text("scene", |(name, ..)| *name)
        .text("parameter", |(_, data, ..)| data.parameter.name)
        .number("value", 6, |(_, _, value, ..)| **value)
        .text("edge", |(.., kind, _, _)| *kind)
        .number("seed", 0, |(.., seed, _)| **seed as f64)
        .number("largest_step_that_does", 6, |(_, data, .., edge)| does(data, edge))
        .number("smallest_step_that_does_not", 6, |(_, data, .., edge)| does_not(data, edge))
        .table("edges", "Every edge")
}
