//! Whether a figure can be drawn.

use super::{Axis, Chart, Drawing, Fault, Figure, FigureError, Map, Picture, Scale, Shape, Tint};

/// Finds the first fault of a figure.
pub(super) fn check(figure: &Figure) -> Result<(), FigureError> {
    match &figure.picture {
        Picture::Chart(chart) => check_chart(chart),
        Picture::Map(map) => check_map(map),
        Picture::Drawing(drawing) => check_drawing(drawing),
        Picture::Drawn { .. } => Ok(()),
    }
    .map_err(|fault| fault.of(&figure.name))
}

fn check_chart(chart: &Chart) -> Result<(), Fault> {
    check_axis(&chart.x)?;
    check_axis(&chart.y)?;
    for series in &chart.series {
        let place = |i: usize, what: &str| format!("{what} of point {i} of `{}`", series.name);
        for (i, point) in series.points.iter().enumerate() {
            showable(&chart.x, point.x, || place(i, "x"))?;
            showable(&chart.y, point.y, || place(i, "y"))?;
            for end in point.spread.into_iter().flatten() {
                showable(&chart.y, end, || place(i, "the spread"))?;
            }
        }
    }
    for band in &chart.bands {
        if band.ends[0].partial_cmp(&band.ends[1]) != Some(std::cmp::Ordering::Less) {
            return Err(Fault::NotAnInterval {
                place: format!("the band `{}`", band.label),
                ends: band.ends,
            });
        }
    }
    if chart.series.iter().all(|series| series.points.is_empty()) {
        return Err(Fault::Empty);
    }
    Ok(())
}

fn check_map(map: &Map) -> Result<(), Fault> {
    for axis in [&map.x, &map.y] {
        if axis.limits.is_none() {
            return Err(Fault::NoLimits { axis: axis.label.clone() });
        }
    }
    for axis in [&map.x, &map.y, &map.value] {
        check_axis(axis)?;
    }
    let expected = map.rows.first().map_or(0, Vec::len);
    if expected == 0 {
        return Err(Fault::Empty);
    }
    for (j, row) in map.rows.iter().enumerate() {
        if row.len() != expected {
            return Err(Fault::UnevenRows { row: j, expected, found: row.len() });
        }
        for (i, &value) in row.iter().enumerate() {
            showable(&map.value, value, || format!("the value at row {j}, column {i}"))?;
        }
    }
    Ok(())
}

fn check_drawing(drawing: &Drawing) -> Result<(), Fault> {
    let [[left, low], [right, high]] = drawing.window;
    interval("the window's width", [left, right])?;
    interval("the window's height", [low, high])?;
    let height = drawing.width * (high - low) / (right - left);
    if !(drawing.width >= LEAST_WIDTH && drawing.width.max(height) <= LARGEST_SIDE) {
        return Err(Fault::Size { width: drawing.width, height });
    }
    if let Some((lowest, highest, what)) = &drawing.shades {
        interval(&format!("the shade `{what}`"), [*lowest, *highest])?;
    }
    if drawing.shapes.is_empty() {
        return Err(Fault::Empty);
    }
    let scale = drawing.width / (right - left);
    for (i, shape) in drawing.shapes.iter().enumerate() {
        let place = || format!("a number of shape {i}");
        if let Shape::Disc { tint: Tint::Shade(shade), .. }
        | Shape::Rectangle { tint: Tint::Shade(shade), .. } = shape
        {
            finite(*shade, place)?;
        }
        for value in lengths(shape) {
            finite(value, place)?;
            let pixels = scale * value.abs().min((value - left).abs()).min((value - low).abs());
            if pixels > FARTHEST || pixels.is_nan() {
                return Err(Fault::TooFar { place: place(), value, pixels });
            }
        }
    }
    Ok(())
}

/// The least width of a drawing (pixels): a word must find its place.
const LEAST_WIDTH: f64 = 100.0;
/// The farthest that a shape may lie from the corner of its window, and the longest that it may be (pixels): the
/// libraries that draw count in small whole numbers.
const FARTHEST: f64 = 1e6;
/// The largest side of a drawing (pixels).
const LARGEST_SIDE: f64 = 50_000.0;

/// Coordinates and sizes.
fn lengths(shape: &Shape) -> Vec<f64> {
    match shape {
        Shape::Disc { centre: [x, y], radius, .. } => vec![*x, *y, *radius],
        Shape::Rectangle { corners: [[a, b], [c, d]], .. } | Shape::Line { ends: [[a, b], [c, d]] } => {
            vec![*a, *b, *c, *d]
        }
        Shape::Text { centre: [x, y], height, .. } => vec![*x, *y, *height],
    }
}

fn check_axis(axis: &Axis) -> Result<(), Fault> {
    let Some(limits) = axis.limits else { return Ok(()) };
    let place = format!("the axis `{}`", axis.label);
    for end in limits {
        showable(axis, end, || format!("an end of {place}"))?;
    }
    interval(&place, limits)
}

fn interval(place: &str, ends: [f64; 2]) -> Result<(), Fault> {
    let length = ends[1] - ends[0];
    if length > 0.0 && length.is_finite() {
        return Ok(());
    }
    Err(Fault::NotAnInterval { place: place.to_owned(), ends })
}

fn showable(axis: &Axis, value: f64, place: impl Fn() -> String) -> Result<(), Fault> {
    finite(value, &place)?;
    if axis.scale == Scale::Logarithmic && value <= 0.0 {
        return Err(Fault::NotPositive { place: place(), value });
    }
    Ok(())
}

fn finite(value: f64, place: impl Fn() -> String) -> Result<(), Fault> {
    if value.is_finite() { Ok(()) } else { Err(Fault::NotFinite { place: place(), value }) }
}
