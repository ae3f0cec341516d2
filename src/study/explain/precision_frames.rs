//! Error of a mean over the wall time of its run, as frames.

use super::precision::{Curve, Precision};
use crate::frame::{Frame, Rows};
use crate::results::Made;
use crate::study::work_precision::front;
use stripmine_physics::number::significant;

/// Name of the item.
pub const NAME: &str = "work-precision-of-means";

/// Errors that are asked for, in parts of the mean, where it is none of about zero.
const WISHES: [f64; 5] = [0.1, 0.03, 0.01, 0.003, 0.001];

/// The frames of a scene.
pub fn made(scene: &str, data: &Precision) -> Made {
    Made::of([summary(scene, data), points(data), means(data), wishes(data)])
}

fn label(curve: &Curve) -> String {
    curve.step.map_or(curve.way.clone(), |step| format!("{}, dt {}", curve.way, significant(step, 3)))
}

/// A point: wall seconds, error, and its curve.
type Drawn<'d> = (f64, f64, &'d Curve);

/// Every point of every curve.
fn all(data: &Precision) -> Vec<Drawn<'_>> {
    let curves = data.curves.iter();
    curves.flat_map(|curve| curve.points.iter().map(move |it| (it[0], it[1], curve))).collect()
}

/// Smallest error that the reference can show.
fn known(data: &Precision) -> f64 {
    0.5 * data.reference[1]
}

/// Points that no point beats in both, by rising cost. Errors below that of the reference say nothing.
fn best(data: &Precision) -> Vec<Drawn<'_>> {
    let all: Vec<_> = all(data).into_iter().filter(|(_, error, _)| *error > known(data)).collect();
    let points: Vec<(f64, f64)> = all.iter().map(|(seconds, error, _)| (*seconds, *error)).collect();
    front(&points).into_iter().map(|at| all[at]).collect()
}

fn summary(scene: &str, data: &Precision) -> Frame {
    let [mean, bar] = data.reference;
    let best = best(data);
    let least = best.last();
    let left_out = data.left_out.iter().map(|(what, why)| format!("{what}: {why}"));
    Rows::of([()])
        .text("scene", |()| scene)
        .text("quantity", |()| data.quantity.to_string())
        .text("unit", |()| data.unit)
        .number("mean of the reference", 6, |()| mean)
        .number("bar of the reference", 6, |()| bar)
        .text("reference", |()| &data.reference_way)
        .number("step of the reference", 6, |()| data.reference_step)
        .short("transient", |()| data.transient)
        .short("error that the reference can show", |()| Some(known(data)).filter(|error| *error > 0.0))
        .short("least error", |()| least.map(|it| it.1))
        .number("least relative error (%)", 2, |()| {
            least.filter(|_| mean.abs() > bar).map(|it| 100.0 * it.1 / mean.abs())
        })
        .short("wall time of the least error (s)", |()| least.map(|it| it.0))
        .text("configuration of the least error", |()| least.map_or(String::new(), |it| label(it.2)))
        .text("not measured", |()| left_out.clone().collect::<Vec<_>>().join("; "))
        .frame("summary", "Reference, and the least error")
}

fn points(data: &Precision) -> Frame {
    Rows::of(all(data))
        .text("curve", |(.., curve)| label(curve))
        .number("wall time (s)", 6, |(seconds, ..)| *seconds)
        .number("error", 6, |(_, error, _)| *error)
        .frame("points", "Error of the mean over the wall time of a run after the transient, RMS")
}

fn means(data: &Precision) -> Frame {
    let [mean, _] = data.reference;
    Rows::of(&data.curves)
        .text("way", |it| it.way.clone())
        .short("dt", |it| it.step)
        .short("wall time of a unit of time (s)", |it| it.cost)
        .short("mean less the reference", |it| it.mean.map(|[own, _]| own - mean))
        .short("± (95 %)", |it| it.mean.map(|[_, bar]| bar))
        .short("error of the longest run, RMS", |it| it.points.last().map(|it| it[1]))
        .short("its wall time (s)", |it| it.points.last().map(|it| it[0]))
        .frame("means", "Means by configuration and step")
}

/// The cheapest for each wish.
fn wishes(data: &Precision) -> Frame {
    let best = best(data);
    let mean = data.reference[0].abs();
    let found = WISHES.map(|wish| (wish, best.iter().find(|(_, error, _)| *error <= wish * mean)));
    Rows::of(found)
        .short("error, RMS (%)", |(wish, _)| 100.0 * wish)
        .text("cheapest that was drawn", |(_, found)| {
            found.map_or("none: longer than the trials, or below the reference's error".to_owned(), |it| {
                label(it.2)
            })
        })
        .short("wall time (s)", |(_, found)| found.map(|it| it.0))
        .frame("wishes", "The cheapest configuration and step for an error")
}
