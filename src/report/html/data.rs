//! What the scripts get of a figure.

use super::look;
use super::quantised::{Quantised, ends};
use crate::report::figure::{self, Along, Axis, Chart, Map, Point, Scale, style};
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

/// Data in the page, where no script or style can be made of them: in JSON, `<` stands in strings only.
pub fn embedded(id: &str, data: &Value) -> Markup {
    let text = data.to_string().replace('<', "\\u003c");
    html! { script type="application/json" id=[Some(id).filter(|id| !id.is_empty())] { (PreEscaped(text)) } }
}

/// A chart; points that its axes cannot show are left out.
pub fn chart(chart: &Chart) -> Value {
    let Chart { x, y, series, bands } = chart;
    let all = || series.iter().flat_map(|series| shown(&series.points, chart));
    let ends = |along| bands.iter().filter(move |band| band.along == along).flat_map(|band| band.ends);
    let spreads = all().filter_map(|point| point.spread).flatten();
    let across = all().map(|point| point.x).chain(ends(Along::X));
    let up = all().map(|point| point.y).chain(spreads).chain(ends(Along::Y));
    let series: Vec<Value> = series
        .iter()
        .zip(look::looks(chart))
        .map(|(series, look)| {
            let points: Vec<&Point> = shown(&series.points, chart).collect();
            json!({
                "name": series.name,
                "look": look,
                "x": points.iter().map(|point| short(point.x)).collect::<Vec<_>>(),
                "y": points.iter().map(|point| short(point.y)).collect::<Vec<_>>(),
                "spreads": spreads_of(&points),
            })
        })
        .collect();
    let bands: Vec<Value> = bands
        .iter()
        .map(|band| json!({ "label": band.label, "ends": band.ends, "along": band.along }))
        .collect();
    json!({ "x": axis(x, across), "y": axis(y, up), "series": series, "bands": bands })
}

/// The spreads of points; none at all where no point has one.
fn spreads_of(points: &[&Point]) -> Vec<Option<[f64; 2]>> {
    match points.iter().any(|point| point.spread.is_some()) {
        true => points.iter().map(|point| point.spread.map(|ends| ends.map(short))).collect(),
        false => vec![],
    }
}

/// A number with six digits: more than a chart has dots, or a reader is shown.
fn short(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

/// A map: its values row by row from the bottom, on the scale of their axis.
pub fn map(map: &Map) -> Value {
    let on_scale = |&value: &f64| match map.value.scale {
        Scale::Linear => value,
        Scale::Logarithmic => libm::log10(value),
    };
    let values = map.rows.iter().flatten().copied().filter(|&value| lies_on(&map.value, value));
    let edges = |axis_of: &Axis| axis(axis_of, std::iter::empty());
    json!({
        "x": edges(&map.x),
        "y": edges(&map.y),
        "value": {
            "label": map.value.label,
            "unit": map.value.unit,
            "log": map.value.scale == Scale::Logarithmic,
            // Without limits, the darkest and the brightest shade are exactly those of the data.
            "ends": map.value.limits.or(ends(values)).unwrap_or([0.1, 1.0]),
        },
        "columns": map.rows.first().map_or(0, Vec::len),
        "rows": map.rows.len(),
        "values": Quantised::of(&map.rows.iter().flatten().map(on_scale).collect::<Vec<_>>()),
    })
}

fn shown<'a>(points: &'a [Point], chart: &'a Chart) -> impl Iterator<Item = &'a Point> {
    points.iter().filter(|point| lies_on(&chart.x, point.x) && lies_on(&chart.y, point.y))
}

/// Whether an axis can show a value.
fn lies_on(axis: &Axis, value: f64) -> bool {
    value.is_finite() && (axis.scale == Scale::Linear || value > 0.0)
}

/// An axis and its ends.
fn axis(axis: &Axis, data: impl Iterator<Item = f64>) -> Value {
    json!({
        "label": axis.label,
        "unit": axis.unit,
        "log": axis.scale == Scale::Logarithmic,
        "ends": figure::ends(axis, data.filter(|&value| lies_on(axis, value))).unwrap_or([0.1, 1.0]),
    })
}

/// The colours of magnitudes, and those of signed quantities, from the lowest to the highest.
pub fn shades() -> Value {
    let colours =
        |signed| style::levels(signed).map(|level| style::shade(level).to_string()).collect::<Vec<_>>();
    json!([colours(false), colours(true)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::{Series, Style};

    #[test]
    fn data_cannot_end_their_element() {
        let text = embedded("x", &json!({ "name": "</script><script>alert(1)</script>", "less": "a<b" }))
            .into_string();
        assert_eq!(text.matches("</script").count(), 1, "{text}");
        assert!(text.contains("\\u003c/script>"));
    }

    #[test]
    fn points_off_the_axes_are_left_out() {
        let points = [(1.0, 2.0), (0.0, 1.0), (3.0, -1.0), (4.0, f64::NAN), (10.0, 5.0)];
        let series = Series {
            name: "a".to_owned(),
            style: Style::Points,
            hue: 0,
            points: points.map(|(x, y)| Point::at(x, y)).to_vec(),
        };
        let log = |label| Axis::logarithmic(label, None);
        let data = chart(&Chart { x: log("x"), y: log("y"), series: vec![series], bands: vec![] });
        assert_eq!(data["series"][0]["x"], json!([1.0, 10.0]));
        assert_eq!(data["series"][0]["y"], json!([2.0, 5.0]));
    }

    #[test]
    fn a_map_keeps_its_values_on_its_scale() {
        let axis = |label| Axis { limits: Some([0.0, 1.0]), ..Axis::linear(label, None) };
        let rows = vec![vec![1.0, 10.0], vec![100.0, 0.0]];
        let data = map(&Map { x: axis("x"), y: axis("y"), value: Axis::logarithmic("density", None), rows });
        assert_eq!(data["value"]["ends"], json!([1.0, 100.0]));
        let values = crate::report::html::quantised::tests::read(
            &serde_json::from_value(data["values"].clone()).unwrap(),
        );
        assert!((values[1] - 1.0).abs() < 1e-4 && values[2] == 2.0 && values[3].is_nan(), "{values:?}");
    }
}
