//! Pictures of the particles of a run: its last state, and, where the box is long, the density along it over time.

use crate::io::extxyz::{Frame, Frames, ReadError};
use crate::io::regular_file;
use crate::particles::Kind;
use crate::report::figure::{Axis, Drawing, Figure, Guide, Map, Picture, Shape, Tint};
use std::path::Path;

/// Particles of a picture: more cannot be seen, and files would be large.
const SHOWN: usize = 20_000;
/// Rows of a map: more cannot be seen.
const ROWS: usize = 160;
/// A box that is so many times as long as wide has a density along it.
const LONG: f64 = 4.0;
/// Bins along it: a slice of each has about this many mean diameters, as in the pictures of BP93's pipe.
const BIN: f64 = 2.5;

/// The pictures of a trajectory. Gravity is that of the run's scene, if the scene can be read.
///
/// # Errors
/// [`ReadError`] if the trajectory cannot be read.
pub fn pictures(run: &Path) -> Result<Vec<Figure>, ReadError> {
    let (mut last, mut slices) = (None, vec![]);
    for frame in Frames::open(run.join("trajectory.xyz"))?.in_space() {
        let frame: Frame = frame?;
        slices.extend(slice(&frame).map(|counts| (frame.time, counts)));
        last = Some(frame);
    }
    let Some(last) = last else { return Ok(vec![]) };
    let density = density(&last, &slices);
    Ok(std::iter::once(state(&last, gravity(run))).chain(density).collect())
}

/// Which way gravity pulls in a run.
fn gravity(run: &Path) -> Option<[f64; 2]> {
    let scene: toml::Table =
        String::from_utf8(regular_file::read(&run.join("scene.toml"), 1 << 24).ok()?).ok()?.parse().ok()?;
    let pair = scene.get("domain")?.get("gravity")?.as_array()?;
    let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    let [x, y] = [pair.first().and_then(number)?, pair.get(1).and_then(number)?];
    ([x, y] != [0.0, 0.0]).then_some([x, y])
}

/// The lower left corner of what is shown of the plane, and its sides (length): the box, or where there is none all particles.
fn window(frame: &Frame) -> ([f64; 2], [f64; 2]) {
    if frame.cell.iter().all(|side| side.is_finite()) {
        return (frame.origin, frame.cell);
    }
    let all = frame.particles.all().iter();
    let ends = all.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], particle| {
        let (place, radius) = (particle.place(), particle.radius);
        let low = [0, 1].map(|axis| low[axis].min(place[axis] - radius));
        [low, [0, 1].map(|axis| high[axis].max(place[axis] + radius))]
    });
    (ends[0], [0, 1].map(|axis| ends[1][axis] - ends[0][axis]))
}

/// The particles of a frame, their speed as shade.
fn state(frame: &Frame, gravity: Option<[f64; 2]>) -> Figure {
    let speed = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let all = frame.particles.all();
    let mut speeds: Vec<f64> = all.iter().map(|particle| speed(particle.velocity)).collect();
    speeds.sort_by(f64::total_cmp);
    // Few are much faster than the others: they look like the fastest of a hundred.
    let fastest = crate::statistics::quantile(&speeds, 0.99).filter(|fastest| *fastest > 0.0).unwrap_or(1.0);
    let every = all.len().div_ceil(SHOWN);
    let ([x, y], [width, height]) = window(frame);
    // A tall box lies down, its upper end to the left.
    let lies = height > LONG * width;
    let place = |[a, b]: [f64; 2]| if lies { [y + height - b, a - x] } else { [a, b] };
    let shapes = all.iter().step_by(every).map(|particle| Shape::Disc {
        centre: place(particle.place()),
        radius: particle.radius,
        tint: match particle.kind {
            Kind::Wall => Tint::Still,
            Kind::Grain => Tint::Shade((speed(particle.velocity) / fastest).min(1.0)),
        },
    });
    let left_out = match every {
        1 => String::new(),
        every => format!(" One of {every} particles is shown."),
    };
    Figure {
        name: "last-state".into(),
        title: format!("The particles at time {:.6}", frame.time),
        caption: format!("Shade: speed.{left_out}"),
        picture: Picture::Drawing(Drawing {
            window: if lies { [[0.0, 0.0], [height, width]] } else { [[x, y], [x + width, y + height]] },
            width: if lies || width > LONG * height { 1800.0 } else { 720.0 },
            shapes: shapes.collect(),
            shades: Some((0.0, fastest, "speed (the scene's unit)".into())),
            guide: Some(Guide {
                unit: String::new(),
                gravity: gravity.map(|[a, b]| if lies { [-b, a] } else { [a, b] }),
            }),
        }),
    }
}

/// Grains in slices across a long box, from its lower or left end; none where no side is much the longest.
fn slice(frame: &Frame) -> Option<Vec<f64>> {
    let [width, height] = frame.cell;
    let side = if width > LONG * height { 0 } else { 1 };
    if frame.cell[side] <= LONG * frame.cell[1 - side] {
        return None;
    }
    let grains = frame.particles.grains();
    let (count, sum) = grains.iter().fold((0, 0.0), |(count, sum), disc| (count + 1, sum + disc.radius));
    let bins = (frame.cell[side] / (BIN * 2.0 * sum / f64::from(count.max(1)))).floor().clamp(1.0, 400.0);
    let mut counts = vec![0.0; bins as usize];
    for disc in grains {
        let part = (disc.place()[side] - frame.origin[side]) / frame.cell[side];
        counts[((part * bins) as usize).min(bins as usize - 1)] += 1.0;
    }
    Some(counts)
}

/// The density along a long box over time.
fn density(last: &Frame, slices: &[(f64, Vec<f64>)]) -> Option<Figure> {
    let ((begun, first), (ended, _)) = (slices.first()?, slices.last()?);
    let bins = first.len();
    let stride = slices.len().div_ceil(ROWS);
    let even = slices.iter().all(|(_, counts)| counts.len() == bins);
    let mean = last.particles.grain_count() as f64 / bins as f64;
    if slices.len() < 2 || !even || mean == 0.0 {
        return None;
    }
    let rows = slices.iter().step_by(stride).map(|(_, counts)| counts.iter().map(|it| it / mean).collect());
    let [width, height] = last.cell;
    let (side, way) = if width > height { (0, "x") } else { (1, "y") };
    let axis =
        |label: &str, limits| Axis { limits: Some(limits), ..Axis::linear(label, Some("the scene's unit")) };
    Some(Figure {
        name: "density-map".into(),
        title: "Density along the box over time".into(),
        caption: format!("Grains in {bins} slices across the box, over their mean."),
        picture: Picture::Map(Map {
            x: axis(way, [last.origin[side], last.origin[side] + last.cell[side]]),
            y: axis("time", [*begun, *ended]),
            value: Axis::linear("density, relative to the mean", None),
            rows: rows.collect(),
        }),
    })
}
