//! Figures of a page: charts and maps by expressions over the columns of frames, and pictures drawn by a study.

use super::{Shown, TemplateFilling, TemplateText};
use crate::frame::{ExpressionScope, ResultFrame};
use crate::report::figure::{
    Chart, ChartAxis, ChartBand, Figure, HeatMap, Picture, Series, SeriesPoint, Style,
};
use minijinja::value::{Value, ValueKind};
use serde::Deserialize;
use std::sync::Arc;
use stripmine_physics::input::InputErrors;
use toml::Spanned;

/// A figure of the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FigureSpec {
    name: TemplateText,
    /// List of elements, each of which gets such a figure; expressions call the element `it`.
    each: Option<TemplateText>,
    /// Condition of the figure; none for an unconditional one.
    when: Option<TemplateText>,
    /// List of elements, each of which gets a panel of the chart; expressions call the element `it`.
    panels: Option<TemplateText>,
    /// Name of a panel.
    panel: Option<TemplateText>,
    title: TemplateText,
    caption: Option<TemplateText>,
    /// Axes of a chart or a map; none for a picture drawn by the study.
    x: Option<AxisSpec>,
    y: Option<AxisSpec>,
    #[serde(default)]
    series: Vec<SeriesSpec>,
    #[serde(default)]
    band: Vec<BandSpec>,
    map: Option<MapSpec>,
}

impl FigureSpec {
    /// Name of its file, without the extension.
    pub(super) fn name(&self) -> &str {
        self.name.get_ref()
    }

    /// True if the study draws the picture.
    pub(super) fn is_drawn(&self) -> bool {
        self.x.is_none() || self.y.is_none()
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisSpec {
    label: TemplateText,
    unit: Option<TemplateText>,
    #[serde(default)]
    log: TruthSpec,
    limits: Option<[f64; 2]>,
}

/// A truth value, or an expression that gives one.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum TruthSpec {
    Fixed(bool),
    Expression(String),
}

impl Default for TruthSpec {
    fn default() -> TruthSpec {
        TruthSpec::Fixed(false)
    }
}

/// Points of a chart: expressions over the cells of a row give the coordinates, numbers or names. An axis with names lists them in the
/// order of the rows, from the left or from above.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SeriesSpec {
    from: TemplateText,
    x: TemplateText,
    y: TemplateText,
    /// Half-width of the interval of y.
    error: Option<TemplateText>,
    /// Ends of the interval of y, or of x where y is a name.
    spread: Option<[TemplateText; 2]>,
    /// Name in the legend of a single series.
    name: Option<TemplateText>,
    /// Name in the legend by row: one series for each name.
    by: Option<TemplateText>,
    /// Condition of the rows that are drawn.
    only: Option<TemplateText>,
    style: Style,
    /// Colour of the first series; by default the next free one.
    hue: Option<usize>,
    /// Sorts points by x.
    #[serde(default)]
    sorted: bool,
}

/// A highlighted part of the plane.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct BandSpec {
    /// List of elements, each of which gets such a part; expressions call the element `it`.
    each: Option<TemplateText>,
    label: TemplateText,
    /// Ends on the horizontal axis, numbers or expressions; equal ones give a line.
    x: Option<Spanned<[BandEnd; 2]>>,
    /// Ends on the vertical axis.
    y: Option<Spanned<[BandEnd; 2]>>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum BandEnd {
    Number(f64),
    Expression(String),
}

/// A map of a frame with a row for each cell.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MapSpec {
    from: TemplateText,
    x: TemplateText,
    y: TemplateText,
    value: TemplateText,
    /// Quantity shown by the colour.
    shade: AxisSpec,
}

/// Builds the figures of one specification: one, or one for each element of a list.
pub(super) fn figures(
    spec: &FigureSpec,
    fill: &TemplateFilling<'_>,
    shown: &Shown<'_>,
) -> Result<Vec<Figure>, InputErrors> {
    if let Some(when) = &spec.when {
        let value = fill.expressions.value(when.get_ref(), fill.scope);
        if !value.map_err(|cause| fill.refused(when.span().start, cause))?.is_true() {
            return Ok(vec![]);
        }
    }
    let Some(each) = &spec.each else { return Ok(vec![figure(spec, fill, shown)?]) };
    let one = |scope: ExpressionScope| figure(spec, &TemplateFilling { scope: &scope, ..*fill }, shown);
    elements(each, fill)?.into_iter().map(one).collect()
}

/// Names that expressions may use for each element of a list.
fn elements(list: &TemplateText, fill: &TemplateFilling<'_>) -> Result<Vec<ExpressionScope>, InputErrors> {
    let refused = |cause: String| fill.refused(list.span().start, cause);
    let all = fill.expressions.value(list.get_ref(), fill.scope).map_err(refused)?;
    let all = all.try_iter().map_err(|cause| refused(cause.to_string()))?;
    Ok(all.map(|it| fill.scope.with_it(&it)).collect())
}

/// Builds a figure of a page.
fn figure(spec: &FigureSpec, fill: &TemplateFilling<'_>, shown: &Shown<'_>) -> Result<Figure, InputErrors> {
    let title = fill.text(&spec.title)?;
    let caption = spec.caption.as_ref().map_or(Ok(String::new()), |caption| fill.text(caption))?;
    let name = fill.text(&spec.name)?;
    let picture = match (&spec.x, &spec.y) {
        (Some(x), Some(y)) => {
            let axes = [axis(x, fill)?, axis(y, fill)?];
            let panel = |scope: ExpressionScope| {
                let fill = TemplateFilling { scope: &scope, ..*fill };
                let name = spec.panel.as_ref().map_or(Ok(String::new()), |name| fill.text(name))?;
                Ok((name, chart(spec, axes.clone(), &fill)?))
            };
            match (&spec.map, &spec.panels) {
                (Some(map), _) => Picture::Map(mapped(map, axes, fill)?),
                (None, panels) => {
                    let all = panels
                        .as_ref()
                        .map_or_else(|| Ok(vec![fill.scope.clone()]), |all| elements(all, fill))?;
                    Picture::Charts(all.into_iter().map(panel).collect::<Result<_, InputErrors>>()?)
                }
            }
        }
        _ => {
            let drawn = shown.pictures.iter().find(|(known, _)| *known == name);
            let names =
                || shown.pictures.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
            let missing = || format!("the study drew no picture `{name}`; it drew {}", names());
            drawn.ok_or_else(|| fill.refused(spec.name.span().start, missing()))?.1.clone()
        }
    };
    Ok(picture.figure(name, title).caption(caption))
}

fn axis(spec: &AxisSpec, fill: &TemplateFilling<'_>) -> Result<ChartAxis, InputErrors> {
    let label = fill.text(&spec.label)?;
    let unit = spec.unit.as_ref().map(|unit| fill.text(unit)).transpose()?.filter(|unit| !unit.is_empty());
    let is_logarithmic = match &spec.log {
        TruthSpec::Fixed(truth) => *truth,
        TruthSpec::Expression(text) => {
            let value = fill.expressions.value(text, fill.scope);
            value.map_err(|cause| fill.refused(spec.label.span().start, cause))?.is_true()
        }
    };
    let unit = unit.as_deref();
    let axis =
        if is_logarithmic { ChartAxis::logarithmic(&label, unit) } else { ChartAxis::linear(&label, unit) };
    Ok(ChartAxis { limits: spec.limits, ..axis })
}

fn chart(
    spec: &FigureSpec,
    [x, y]: [ChartAxis; 2],
    fill: &TemplateFilling<'_>,
) -> Result<Chart, InputErrors> {
    let mut chart = Chart::of(x, y);
    let mut names = [vec![], vec![]];
    for spec in &spec.series {
        let next = chart.series.iter().map(|it| it.hue + 1).max().unwrap_or(0);
        chart = chart.with(series(spec, next, &mut names, fill)?);
    }
    let [across, mut down] = names;
    if !across.is_empty() {
        chart.x = ChartAxis::names(&chart.x.label, across);
    }
    if !down.is_empty() {
        let points = chart.series.iter_mut().flat_map(|series| &mut series.points);
        points.for_each(|point| point.y = (down.len() - 1) as f64 - point.y);
        down.reverse();
        chart.y = ChartAxis::names(&chart.y.label, down);
    }
    for spec in &spec.band {
        let scopes =
            spec.each.as_ref().map_or_else(|| Ok(vec![fill.scope.clone()]), |all| elements(all, fill))?;
        for scope in &scopes {
            chart = band(chart, spec, &TemplateFilling { scope, ..*fill })?;
        }
    }
    Ok(chart)
}

fn band(mut chart: Chart, spec: &BandSpec, fill: &TemplateFilling<'_>) -> Result<Chart, InputErrors> {
    let label = fill.text(&spec.label)?;
    let ends = |ends: &Spanned<[BandEnd; 2]>| {
        let end = |end: &BandEnd| match end {
            BandEnd::Number(number) => Ok(*number),
            BandEnd::Expression(text) => {
                let value = fill.expressions.value(text, fill.scope);
                let number = value.and_then(|value| number(&value).map(|it| it.unwrap_or(f64::NAN)));
                number.map_err(|cause| fill.refused(ends.span().start, cause))
            }
        };
        let [low, high] = ends.get_ref();
        Ok::<_, InputErrors>([end(low)?, end(high)?])
    };
    if let Some(x) = &spec.x {
        chart = chart.band(ChartBand::of_x(&label, ends(x)?));
    }
    if let Some(y) = &spec.y {
        chart = chart.band(ChartBand::of_y(&label, ends(y)?));
    }
    Ok(chart)
}

/// Builds the series of a chart. New names are added to their axes.
fn series(
    spec: &SeriesSpec,
    next: usize,
    [across, down]: &mut [Vec<String>; 2],
    fill: &TemplateFilling<'_>,
) -> Result<Vec<Series>, InputErrors> {
    let frame = fill.frame(&spec.from)?;
    let rows = FigureRows { frame, fill };
    let fixed = spec.name.as_ref().map_or(Ok(String::new()), |name| fill.text(name))?;
    let mut all: Vec<Series> = vec![];
    for row in 0..frame.rows.len() {
        if let Some(only) = &spec.only
            && !rows.value(only, row)?.is_true()
        {
            continue;
        }
        let place = (rows.axis_coordinate(&spec.x, row, across)?, rows.axis_coordinate(&spec.y, row, down)?);
        let (Some(x), Some(y)) = place else { continue };
        let mut point = SeriesPoint::at(x, y);
        if let Some(error) = &spec.error
            && let Some(error) = rows.number(error, row)?
        {
            point.spread = Some([y - error, y + error]);
        }
        if let Some([low, high]) = &spec.spread {
            point.spread = rows.number(low, row)?.zip(rows.number(high, row)?).map(|(low, high)| [low, high]);
        }
        let name =
            spec.by.as_ref().map_or(Ok(fixed.clone()), |by| rows.value(by, row).map(|it| it.to_string()))?;
        let hue = spec.hue.unwrap_or(next) + all.len();
        match all.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => all.push(Series::new(name, spec.style, hue, [point])),
        }
    }
    if spec.sorted {
        all.iter_mut().for_each(|series| series.points.sort_by(|a, b| a.x.total_cmp(&b.x)));
    }
    Ok(all)
}

/// Cells in the order of their coordinates: numbers rise, words keep their order. A point without a row is empty.
fn mapped(
    spec: &MapSpec,
    [x, y]: [ChartAxis; 2],
    fill: &TemplateFilling<'_>,
) -> Result<HeatMap, InputErrors> {
    let frame = fill.frame(&spec.from)?;
    let rows = FigureRows { frame, fill };
    let mut cells = vec![];
    for row in 0..frame.rows.len() {
        let place = [rows.value(&spec.x, row)?, rows.value(&spec.y, row)?];
        if place.iter().all(|it| !it.is_none()) {
            cells.push((place, rows.number(&spec.value, row)?.unwrap_or(f64::NAN)));
        }
    }
    let along = |axis: usize, drawn: ChartAxis, text: &TemplateText| -> Result<_, InputErrors> {
        let mut all: Vec<Value> = vec![];
        for (place, _) in &cells {
            if !all.contains(&place[axis]) {
                all.push(place[axis].clone());
            }
        }
        if all.iter().any(|it| it.kind() == ValueKind::String) {
            return Ok((ChartAxis::names(&drawn.label, all.iter().map(Value::to_string)), all));
        }
        let numbers = all.iter().map(number).collect::<Result<Vec<_>, String>>();
        numbers.map_err(|cause| fill.refused(text.span().start, cause))?;
        all.sort();
        Ok((drawn, all))
    };
    let (x, across) = along(0, x, &spec.x)?;
    let (y, up) = along(1, y, &spec.y)?;
    let at = |x: &Value, y: &Value| {
        cells.iter().find(|(place, _)| place[0] == *x && place[1] == *y).map_or(f64::NAN, |it| it.1)
    };
    let rows = up.iter().map(|y| across.iter().map(|x| at(x, y)).collect()).collect();
    Ok(HeatMap { x, y, value: axis(&spec.shade, fill)?, rows })
}

/// Rows of a frame, whose cells are named in expressions.
struct FigureRows<'r> {
    frame: &'r Arc<ResultFrame>,
    fill: &'r TemplateFilling<'r>,
}

impl FigureRows<'_> {
    fn value(&self, text: &TemplateText, row: usize) -> Result<Value, InputErrors> {
        let value = self.fill.expressions.of_row(text.get_ref(), self.fill.scope, self.frame, row);
        value.map_err(|cause| self.fill.refused(text.span().start, cause))
    }

    /// Coordinate on an axis: a number, or the index of a name.
    fn axis_coordinate(
        &self,
        text: &TemplateText,
        row: usize,
        names: &mut Vec<String>,
    ) -> Result<Option<f64>, InputErrors> {
        let value = self.value(text, row)?;
        let Some(name) = value.as_str() else { return self.number(text, row) };
        let at = names.iter().position(|known| known == name).unwrap_or_else(|| {
            names.push(name.to_owned());
            names.len() - 1
        });
        Ok(Some(at as f64))
    }

    fn number(&self, text: &TemplateText, row: usize) -> Result<Option<f64>, InputErrors> {
        let value = self.value(text, row)?;
        number(&value).map_err(|cause| self.fill.refused(text.span().start, cause))
    }
}

/// A number; none for an empty cell.
fn number(value: &Value) -> Result<Option<f64>, String> {
    match value.kind() {
        ValueKind::None => Ok(None),
        _ => f64::try_from(value.clone()).map(Some).map_err(|_| format!("`{value}` is not a number")),
    }
}
