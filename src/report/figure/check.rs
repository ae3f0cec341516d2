//! Checks of figures before they are drawn.

use super::{Chart, ChartAxis, Drawing, DrawnShape, HeatMap, Picture, Scale, Tint};
use stripmine_physics::number::significant;
use stripmine_physics::reported::{ErrorClass, Reported};

/// Figure that cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("figure `{figure}`: {problem}")]
pub struct FigureError {
    /// Name of the figure.
    pub figure: String,
    /// Location, value and reason.
    pub(crate) problem: String,
}

impl Reported for FigureError {
    // A figure that cannot be drawn is a bug of the program.
    fn class(&self) -> ErrorClass {
        ErrorClass::InputOutput
    }
}

/// Minimum width and maximum side of a drawing (pixels).
const SIDES: [f64; 2] = [100.0, 50_000.0];
/// Maximum size of a shape and its maximum distance from the corner of the window (pixels), since renderers use small integers.
const FARTHEST: f64 = 1e6;

/// Returns the first fault of a picture as an error.
pub(crate) fn check(picture: &Picture) -> Result<(), String> {
    match picture {
        Picture::Charts(panels) => {
            let first = &panels.first().ok_or("it has no data to draw")?.1;
            match panels.iter().find(|(_, chart)| chart.x != first.x || chart.y != first.y) {
                Some((name, _)) => {
                    Err(format!("the axes of panel `{name}` differ from those of the first panel"))
                }
                None => panels.iter().try_for_each(|(_, chart)| check_chart(chart)),
            }
        }
        Picture::Map(map) => check_map(map),
        Picture::Drawing(drawing) => check_drawing(drawing),
        Picture::Drawn { .. } => Ok(()),
    }
}

fn check_chart(chart: &Chart) -> Result<(), String> {
    let (Chart { x, y, series, bands }, (spreads, _)) = (chart, chart.spreads_along());
    [x, y].into_iter().try_for_each(check_axis)?;
    for series in series {
        let place = |i: usize, what: &str| format!("{what} of point {i} of `{}`", series.name);
        for (i, point) in series.points.iter().enumerate() {
            check_value(x, point.x, || place(i, "x"))?;
            check_value(y, point.y, || place(i, "y"))?;
            point
                .spread
                .iter()
                .flatten()
                .try_for_each(|end| check_value(spreads, *end, || place(i, "the spread")))?;
        }
    }
    if let Some(band) = bands.iter().find(|band| !matches!(band.ends, [low, high] if low <= high)) {
        return Err(interval_error(&format!("the band `{}`", band.label), band.ends));
    }
    require_data(series.iter().any(|series| !series.points.is_empty()))
}

fn check_map(map: &HeatMap) -> Result<(), String> {
    let columns = map.rows.first().map_or(0, Vec::len);
    require_data(columns > 0)?;
    for (axis, cells) in [(&map.x, columns), (&map.y, map.rows.len())] {
        let ChartAxis { label, scale, limits, .. } = axis;
        match scale {
            Scale::Names(names) if names.len() != cells => {
                return Err(format!(
                    "the axis `{label}` has {} names; expected one for each of {cells} cells",
                    names.len()
                ));
            }
            Scale::Linear | Scale::Logarithmic if limits.is_none() => {
                return Err(format!("the axis `{label}` of a map has no limits; expected two"));
            }
            _ => check_axis(axis)?,
        }
    }
    check_axis(&map.value)?;
    for (j, row) in map.rows.iter().enumerate() {
        if row.len() != columns {
            return Err(format!(
                "row {j} has {} values; expected {columns} as in the previous rows",
                row.len()
            ));
        }
        for (i, &value) in row.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
            check_value(&map.value, value, || format!("the value at row {j}, column {i}"))?;
        }
    }
    Ok(())
}

fn check_drawing(Drawing { window, width, shapes, shades, .. }: &Drawing) -> Result<(), String> {
    let [[left, low], [right, high]] = *window;
    check_interval("the window's width", [left, right])?;
    check_interval("the window's height", [low, high])?;
    let height = width * (high - low) / (right - left);
    if !(*width >= SIDES[0] && width.max(height) <= SIDES[1]) {
        let [width, height] = [*width, height].map(|side| significant(side, 6));
        return Err(format!(
            "a picture of {width} by {height} pixels cannot be drawn; expected a width of {} or more and sides of at most {}",
            SIDES[0], SIDES[1]
        ));
    }
    if let Some((lowest, highest, what)) = shades {
        check_interval(&format!("the shade `{what}`"), [*lowest, *highest])?;
    }
    for (i, shape) in shapes.iter().enumerate() {
        let place = || format!("a number of shape {i}");
        if let DrawnShape::Disc { tint: Tint::Shade(shade), .. } = shape {
            check_finite(*shade, place)?;
        }
        for (value, low) in shape.extent().into_iter().flat_map(|corner| corner.into_iter().zip([left, low]))
        {
            check_finite(value, place)?;
            let pixels = width / (right - left) * (value - low).abs();
            if pixels > FARTHEST || pixels.is_nan() {
                let [value, pixels] = [significant(value, 6), significant(pixels, 2)];
                return Err(format!(
                    "{} is {value}, which is {pixels} pixels on the picture; expected at most {FARTHEST}",
                    place()
                ));
            }
        }
    }
    require_data(!shapes.is_empty())
}

fn check_axis(axis: &ChartAxis) -> Result<(), String> {
    let Some(limits) = axis.limits else { return Ok(()) };
    let place = format!("the axis `{}`", axis.label);
    limits.into_iter().try_for_each(|end| check_value(axis, end, || format!("an end of {place}")))?;
    check_interval(&place, limits)
}

fn require_data(something: bool) -> Result<(), String> {
    if something { Ok(()) } else { Err("it has no data to draw".to_owned()) }
}

fn check_interval(place: &str, ends: [f64; 2]) -> Result<(), String> {
    let length = ends[1] - ends[0];
    if length > 0.0 && length.is_finite() { Ok(()) } else { Err(interval_error(place, ends)) }
}

/// Describes ends that are not an interval.
pub(crate) fn interval_error(place: &str, ends: [f64; 2]) -> String {
    let [low, high] = ends.map(|end| significant(end, 6));
    format!("{place} goes from {low} to {high}; expected increasing ends at a finite distance")
}

fn check_value(axis: &ChartAxis, value: f64, place: impl Fn() -> String) -> Result<(), String> {
    check_finite(value, &place)?;
    let problem = match &axis.scale {
        Scale::Logarithmic if value <= 0.0 => "a logarithmic axis needs positive numbers".to_owned(),
        Scale::Names(all) if value < -0.5 || value > all.len() as f64 - 0.5 => {
            format!("its axis has {} names", all.len())
        }
        _ => return Ok(()),
    };
    Err(format!("{} is {}, but {problem}", place(), significant(value, 6)))
}

fn check_finite(value: f64, place: impl Fn() -> String) -> Result<(), String> {
    if value.is_finite() { Ok(()) } else { Err(format!("{} is {value}; expected a finite number", place())) }
}
