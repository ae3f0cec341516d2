//! The pictures of maps: one over all of them, and one of each.

use super::super::conclusions::of_theory;
use super::super::dataset::{Stability, over_seeds};
use super::super::outcome::{Cell, Class};
use crate::report::figure::{Axis, Chart, Figure, Point, Series, Style};
use crate::study::work_precision::conclusions::short;

/// The hue of what was measured.
const INK: usize = 6;

/// The edge of what works over the step beyond which theory says that errors grow, for each map that has both.
pub fn summary(maps: &[(String, Stability)]) -> Option<Figure> {
    let known: Vec<_> =
        maps.iter().filter_map(|(name, data)| Some((name, of_theory(data)?))).enumerate().collect();
    let points =
        known.iter().map(|(row, (_, [middle, low, high]))| (*row as f64 + 1.0, *middle, [*low, *high]));
    let names: Vec<String> = known.iter().map(|(row, (name, _))| format!("{} {name}", row + 1)).collect();
    let ends = [0.5, known.len() as f64 + 0.5];
    (known.len() > 1).then(|| {
        Chart::of(
            Axis::linear("map, numbered as below", None).between(ends),
            Axis::logarithmic("edge of what works over the step of theory", None),
        )
        .series("measured", Style::Points, 0, points)
        .series("theory: errors grow beyond", Style::Dashed, INK, ends.map(|end| (end, 1.0)))
        .figure("edge_over_theory", "Where methods stop to work, beside the step beyond which theory says that errors grow")
        .caption(format!(
            "{}. A point is the middle over the values of a map, its bar goes from the lowest to the highest.",
            names.join(", ")
        ))
    })
}

/// What becomes of a place, for a reader of a map: what stops a run is one kind, and what is wrong is told apart by whether the program says
/// so.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    Works,
    WrongAndSaid,
    WrongAndSilent,
    Stopped,
}

impl Fate {
    const ALL: [Fate; 4] = [Fate::Works, Fate::WrongAndSaid, Fate::WrongAndSilent, Fate::Stopped];

    fn of(cell: &Cell) -> Option<Fate> {
        match cell.class {
            Class::Works => Some(Fate::Works),
            Class::Refused => None,
            class if class.is_unseen() && cell.is_said() => Some(Fate::WrongAndSaid),
            class if class.is_unseen() => Some(Fate::WrongAndSilent),
            _ => Some(Fate::Stopped),
        }
    }

    /// Its name in a legend, and its hue.
    const fn look(self) -> (&'static str, usize) {
        match self {
            Fate::Works => ("works", 5),
            Fate::WrongAndSaid => ("wrong, and the program says so", 4),
            Fate::WrongAndSilent => ("wrong, and nothing is said", 1),
            Fate::Stopped => ("stopped by the program", 0),
        }
    }
}

/// The map: a marker for what became of each place, the edge of what works with bars over the seeds, and theory.
pub fn map(name: &str, data: &Stability) -> Figure {
    let fates = Fate::ALL.into_iter().map(|fate| {
        let (name, hue) = fate.look();
        Series::new(name, Style::Points, hue, places(data, fate))
    });
    let edge = Series::new("edge of what works", Style::Line, INK, edge(data));
    let [low, high] = [data.steps[0], data.steps[data.steps.len() - 1]];
    let grows = data.values.iter().filter_map(|&value| Some((value, data.unstable_beyond(value)?.0)));
    let grows = grows.filter(|(_, step)| (low..=high).contains(step));
    let theory = Series::new("theory: errors grow beyond", Style::Dashed, 2, grows);
    let ends = [data.values[0], data.values[data.values.len() - 1]];
    let own = Series::new("the scene's own step", Style::Dashed, 3, ends.map(|value| (value, data.step)));
    let marks = data
        .marks
        .iter()
        .map(|(at, _)| Series::new("", Style::Dashed, INK, [low, high].map(|step| (*at, step))));
    let all = fates.chain([edge, theory, own]).chain(marks);
    let unit = data.parameter.unit.as_deref();
    let x = match data.parameter.is_logarithmic {
        true => Axis::logarithmic(data.parameter.label, unit),
        false => Axis::linear(data.parameter.label, unit),
    };
    let marked: String = data.marks.iter().map(|(_, what)| format!(" The upright line: {what}.")).collect();
    let title = format!("{name}: where it works, over the step and the {}", data.parameter.label);
    Chart::of(x, Axis::logarithmic("step", data.time_unit.as_deref()))
        .with(all.filter(|series| !series.points.is_empty()))
        .figure(format!("{}_stability", name.replace('-', "_")), title)
        .caption(format!(
            "{} × {} runs of a time of {}, {}; bisected edges from {} seeds, bars from the lowest to the highest. What stops each run and every \
             limit of theory are in the tables.{marked}",
            data.values.len(),
            data.steps.len(),
            short(data.duration),
            data.way,
            data.seeds.len(),
        ))
}

fn places(data: &Stability, fate: Fate) -> impl Iterator<Item = (f64, f64)> {
    data.values.iter().zip(&data.map).flat_map(move |(value, cells)| {
        let own = data.steps.iter().zip(cells).filter(move |(_, cell)| Fate::of(cell) == Some(fate));
        own.map(|(step, _)| (*value, *step))
    })
}

/// The edge of what works.
fn edge(data: &Stability) -> Vec<Point> {
    let at = data.values.iter().zip(&data.boundaries).filter_map(|(&value, boundary)| {
        let [middle, low, high] = over_seeds(&boundary.works)?;
        Some(Point { x: value, y: middle, spread: Some([low, high]) })
    });
    at.collect()
}
