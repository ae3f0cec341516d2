//! Frames of stability maps.

use super::alarms::alarms;
use super::boundary::StepBoundary;
use super::dataset::{Boundary, SchemeLimit, StabilityMap, over_seeds};
use super::outcome::{self, RunClass};
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::results::FinishedItem;
use crate::statistics::median;
use crate::study::alarm::{Alarm, WarningLevel};

type Maps = [(String, StabilityMap)];

/// Boundaries of different seeds disagree if they are more than this many tolerances apart.
const APART: f64 = 2.0;

/// Returns the frames of maps, each with a name for its rows.
pub(crate) fn made(maps: &Maps) -> FinishedItem {
    let seeds = maps.first().map_or(vec![], |(_, data)| data.seeds.clone());
    let frames = [
        of_maps(maps),
        schemes(maps),
        pairs(maps),
        said(maps),
        alarms(maps),
        cells(maps),
        boundaries(maps),
        edges(maps),
        lines(maps),
        unjudged(maps),
    ];
    FinishedItem::of(frames).with_seeds(seeds)
}

/// Ratio of the stability boundary to the step beyond which theory predicts growing errors: median, lowest and highest over the values.
fn of_theory(data: &StabilityMap) -> Option<[f64; 3]> {
    let at = data.values.iter().zip(&data.boundaries);
    let ratio = |(&value, boundary): (&f64, &Boundary)| {
        Some(over_seeds(&boundary.works)?[0] / data.unstable_beyond(value)?.0)
    };
    let mut ratios: Vec<f64> = at.filter_map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    Some([median(ratios.iter().copied()), *ratios.first()?, *ratios.last()?])
}

/// A row for each map: its axes, numbers of runs by kind, and boundaries compared with theory and over seeds.
fn of_maps(maps: &Maps) -> ResultFrame {
    let count = |of: fn(&StabilityMap) -> usize| move |(_, data): &&(String, StabilityMap)| of(data);
    let theory =
        |which: usize| move |(_, data): &&(String, StabilityMap)| of_theory(data).map(|ratios| ratios[which]);
    let spreads = |data: &StabilityMap| {
        let spreads = data.boundaries.iter().filter_map(|boundary| {
            let [_, low, high] = over_seeds(&boundary.works)?;
            Some(high / low - 1.0)
        });
        spreads.collect::<Vec<f64>>()
    };
    let own = |data: &StabilityMap| {
        data.schemes
            .iter()
            .find(|scheme| data.configuration.split(' ').any(|part| part == scheme.scheme))
            .cloned()
    };
    FrameBuilder::of(maps)
        .text("scene", |(name, _)| name)
        .text("method", |(_, data)| data.method)
        .text("configuration", |(_, data)| &data.configuration)
        .text("own integrator", |(_, data)| own(data).map_or(String::new(), |it| it.scheme))
        .number("own step", 6, |(_, data)| data.step)
        .text("unit of time", |(_, data)| data.time_unit.clone().unwrap_or_default())
        .number("time of a run", 3, |(_, data)| data.duration)
        .text("parameter", |(_, data)| data.parameter.name)
        .text("parameter in words", |(_, data)| data.parameter.label)
        .text("unit of the parameter", |(_, data)| data.parameter.unit.clone().unwrap_or_default())
        .count("logarithmic", |(_, data)| u64::from(data.parameter.is_logarithmic))
        .count("values", |(_, data)| data.values.len())
        .count("steps", |(_, data)| data.steps.len())
        .count("seeds", |(_, data)| data.seeds.len())
        .number("tolerance of an edge", 3, |(_, data)| data.tolerance)
        .count("places", count(|data| data.cells().count()))
        .count("right", count(|data| data.warning_counts(outcome::MapPoint::is_right).all))
        .count("right and refused", count(|data| data.warning_counts(outcome::MapPoint::is_right).refused))
        .count(
            "right and warned of",
            count(|data| {
                let said = data.warning_counts(outcome::MapPoint::is_right);
                said.all - said.unsaid - said.refused
            }),
        )
        .count(
            "undecided",
            count(|data| data.warning_counts(|cell| cell.class == RunClass::Works && !cell.is_decided).all),
        )
        .count("wrong", count(|data| data.warning_counts(|cell| cell.class.is_undetected_failure()).all))
        .count(
            "wrong and refused",
            count(|data| data.warning_counts(|cell| cell.class.is_undetected_failure()).refused),
        )
        .count(
            "wrong and warned of before",
            count(|data| data.warning_counts(|cell| cell.class.is_undetected_failure()).warned_before),
        )
        .count(
            "wrong and caught by the run",
            count(|data| data.warning_counts(|cell| cell.class.is_undetected_failure()).warned_by_run),
        )
        .count(
            "wrong and silent",
            count(|data| data.warning_counts(|cell| cell.class.is_undetected_failure()).unsaid),
        )
        .number("edge over theory", 3, theory(0))
        .number("edge over theory, lowest", 3, theory(1))
        .number("edge over theory, highest", 3, theory(2))
        .count("edges with seeds", |(_, data)| spreads(data).len())
        .count("edges that agree over seeds", |(_, data)| {
            spreads(data).iter().filter(|spread| **spread <= APART * data.tolerance).count()
        })
        .number("spread over seeds", 3, |(_, data)| median(spreads(data).into_iter()))
        .text("left out", |(_, data)| data.left_out.clone().unwrap_or_default())
        .frame("maps", "Maps: axes, runs by kind, and boundaries compared with theory")
}

/// Boundaries in multiples of the scene's own step: median, lowest and highest over the seeds.
fn multiples(data: &StabilityMap, edges: &[StepBoundary]) -> [TableCell; 3] {
    let numbers = over_seeds(edges).map(|steps| steps.map(|step| TableCell::Number(step / data.step, 2)));
    numbers.unwrap_or([const { TableCell::Nothing }; 3])
}

/// Position of a boundary that lies outside the map.
fn beyond(edges: &[StepBoundary]) -> Option<&'static str> {
    match edges {
        _ if over_seeds(edges).is_some() => None,
        [StepBoundary::Above, ..] if edges.iter().all(|edge| *edge == StepBoundary::Above) => {
            Some("above the map")
        }
        [StepBoundary::Below, ..] if edges.iter().all(|edge| *edge == StepBoundary::Below) => {
            Some("below the map")
        }
        _ => Some("not in every seed"),
    }
}

fn schemes(maps: &Maps) -> ResultFrame {
    let schemes =
        maps.iter().flat_map(|(name, data)| data.schemes.iter().map(move |scheme| (name, data, scheme)));
    FrameBuilder::of(schemes)
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
        .cell("what comes first beyond", |(.., scheme)| scheme.first.map(RunClass::name))
        .frame("integrators", "The largest step of each integrator, at the scene's own values")
}

fn said(maps: &Maps) -> ResultFrame {
    let classes = maps.iter().flat_map(|(name, data)| {
        RunClass::BEGUN.map(|class| (name, class, data.warning_counts(|cell| cell.class == class)))
    });
    FrameBuilder::of(classes.filter(|(.., said)| said.all > 0))
        .text("scene", |(name, ..)| *name)
        .text("what becomes of it", |(_, class, _)| class.name())
        .number("places", 0, |(.., said)| said.all as f64)
        .number("refused before", 0, |(.., said)| said.refused as f64)
        .number("warned of before", 0, |(.., said)| said.warned_before as f64)
        .number("warned of by the run", 0, |(.., said)| said.warned_by_run as f64)
        .number("nothing said", 0, |(_, class, said)| class.ends().then_some(said.unsaid as f64))
        .frame("said", "Warnings by outcome of a run")
}

/// All runs of all maps.
fn cells(maps: &Maps) -> ResultFrame {
    let cells = maps.iter().flat_map(|(name, data)| {
        let rows = data.values.iter().zip(&data.map);
        rows.flat_map(move |(value, cells)| {
            data.steps.iter().zip(cells).map(move |(step, cell)| (name, data, value, step, cell))
        })
    });
    let foreseen = |foreseen: WarningLevel| match foreseen {
        WarningLevel::Warned => "warned",
        WarningLevel::Refused => "refused",
        _ => "nothing",
    };
    FrameBuilder::of(cells)
        .text("scene", |(name, ..)| *name)
        .text("parameter", |(_, data, ..)| data.parameter.name)
        .number("value", 6, |(_, _, value, ..)| **value)
        .number("step", 6, |(.., step, _)| **step)
        .text("class", |(.., cell)| cell.class.name())
        .count("decided", |(.., cell)| u64::from(cell.is_decided))
        .text("foreseen", |(.., cell)| foreseen(cell.worst_before_run()))
        .text("warned_by_run", |(.., cell)| cell.warned_by_run().join(", "))
        .text("findings", |(.., cell)| cell.alarms.iter().map(Alarm::words).collect::<Vec<_>>().join(", "))
        .text("what", |(.., cell)| &cell.what)
        .frame("cells", "Every run")
}

/// Boundaries of all seeds.
fn boundaries(maps: &Maps) -> ResultFrame {
    let edges = maps.iter().flat_map(|(name, data)| {
        let boundaries = data.values.iter().zip(&data.boundaries);
        boundaries.flat_map(move |(value, boundary)| {
            let kinds = [("works", &boundary.works), ("ends", &boundary.ends)];
            kinds.into_iter().flat_map(move |(kind, edges)| {
                data.seeds.iter().zip(edges).map(move |(seed, edge)| (name, data, value, kind, seed, edge))
            })
        })
    });
    let does = |data: &StabilityMap, edge: &StepBoundary| match edge {
        StepBoundary::Below => None,
        StepBoundary::Between([low, _]) => Some(*low),
        StepBoundary::Above => Some(data.steps[data.steps.len() - 1]),
    };
    let does_not = |data: &StabilityMap, edge: &StepBoundary| match edge {
        StepBoundary::Below => Some(data.steps[0]),
        StepBoundary::Between([_, high]) => Some(*high),
        StepBoundary::Above => None,
    };
    FrameBuilder::of(edges)
        .text("scene", |(name, ..)| *name)
        .text("parameter", |(_, data, ..)| data.parameter.name)
        .number("value", 6, |(_, _, value, ..)| **value)
        .text("edge", |(.., kind, _, _)| *kind)
        .number("seed", 0, |(.., seed, _)| **seed as f64)
        .number("largest_step_that_does", 6, |(_, data, .., edge)| does(data, edge))
        .number("smallest_step_that_does_not", 6, |(_, data, .., edge)| does_not(data, edge))
        .frame("edges", "Every boundary")
}

/// Ratio of each integrator's longest working step to the step beyond which theory predicts growing errors, at the scene's own
/// values.
fn pairs(maps: &Maps) -> ResultFrame {
    let pairs = maps.iter().flat_map(|(name, data)| {
        let of = |scheme: &SchemeLimit| Some(over_seeds(&scheme.edges.works)?[0] / scheme.theory?.0);
        data.schemes.iter().filter_map(move |scheme| Some((name, &scheme.scheme, of(scheme)?)))
    });
    FrameBuilder::of(pairs)
        .text("scene", |(name, ..)| *name)
        .text("integrator", |(_, scheme, _)| *scheme)
        .number("edge over theory", 3, |(.., ratio)| *ratio)
        .frame("pairs", "Longest working step over the step beyond which theory predicts growing errors")
}

/// Stability boundary over the seeds, and the theoretical step, at every value.
fn edges(maps: &Maps) -> ResultFrame {
    let at = maps.iter().flat_map(|(name, data)| {
        data.values.iter().zip(&data.boundaries).map(move |(value, boundary)| {
            let [low, high] = [data.steps[0], data.steps[data.steps.len() - 1]];
            let theory = data.unstable_beyond(*value).filter(|(step, _)| (low..=high).contains(step));
            (name, *value, over_seeds(&boundary.works), theory)
        })
    });
    FrameBuilder::of(at)
        .text("scene", |(name, ..)| *name)
        .number("value", 6, |(_, value, ..)| *value)
        .number("works up to", 6, |(.., edge, _)| edge.map(|edge| edge[0]))
        .number("lowest seed", 6, |(.., edge, _)| edge.map(|edge| edge[1]))
        .number("highest seed", 6, |(.., edge, _)| edge.map(|edge| edge[2]))
        .number("theory", 6, |(.., theory)| theory.map(|(step, _)| step))
        .text("by", |(.., theory)| theory.map_or("", |(_, name)| name))
        .frame("edges-over-seeds", "Stability boundary over the seeds, and theoretical step")
}

/// Straight lines of the maps, by their ends: the scene's own step, and parameter values with a theoretical meaning.
fn lines(maps: &Maps) -> ResultFrame {
    let ends = |(name, data): &(String, StabilityMap)| {
        let [low, high] = [data.steps[0], data.steps[data.steps.len() - 1]];
        let [first, last] = [data.values[0], data.values[data.values.len() - 1]];
        let own =
            [first, last].map(|value| (name.clone(), "the scene's own step".to_owned(), value, data.step));
        let marks = data
            .marks
            .iter()
            .flat_map(|(at, what)| [low, high].map(|step| (name.clone(), what.clone(), *at, step)));
        own.into_iter().chain(marks).collect::<Vec<_>>()
    };
    FrameBuilder::of(maps.iter().flat_map(ends))
        .text("scene", |(name, ..)| name.clone())
        .text("line", |(_, line, ..)| line.clone())
        .number("value", 6, |(.., value, _)| *value)
        .number("step", 6, |(.., step)| *step)
        .frame("lines", "The scene's own step, and values with a theoretical meaning")
}

/// Values without a reference.
fn unjudged(maps: &Maps) -> ResultFrame {
    let all = maps.iter().flat_map(|(name, data)| data.unjudged.iter().map(move |it| (name, it)));
    FrameBuilder::of(all)
        .text("scene", |(name, _)| *name)
        .number("value", 6, |(_, (value, _))| *value)
        .text("reason", |(_, (_, why))| why)
        .frame("unjudged", "Values without a reference: runs at the smallest step fail, too")
}
