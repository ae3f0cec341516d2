//! Numbers of a figure as a table, for programs.

use super::{Chart, ChartAxis, Figure, HeatMap, Picture, Scale};
use crate::report::{FormattedTable, TableCell};

/// Returns the table of a chart or a map, named after the figure; `None` for a drawing, whose shapes are not data, and for a picture read
/// from a file.
///
/// A chart gives one row for each point: series, x, y, and the ends of its spread, preceded by the name of the panel if there are several.
/// A map gives one row for each of its rows from the bottom: the middle of the row, and its values under the middles of the columns.
pub(crate) fn data(figure: &Figure) -> Option<FormattedTable> {
    let (columns, rows) = match &figure.picture {
        Picture::Charts(panels) => {
            let (mut columns, rows) =
                (headings(&panels.first()?.1), panels.iter().map(|(_, chart)| chart_rows(chart)));
            if panels.iter().all(|(name, _)| name.is_empty()) {
                (columns, rows.flatten().collect())
            } else {
                columns.insert(0, "panel".to_owned());
                let named = |(row, (name, _)): (Vec<Vec<TableCell>>, &(String, Chart))| {
                    let name = TableCell::Text(name.clone());
                    row.into_iter().map(|cells| [vec![name.clone()], cells].concat()).collect::<Vec<_>>()
                };
                (columns, rows.zip(panels).flat_map(named).collect())
            }
        }
        Picture::Map(map) => map_table(map),
        Picture::Drawing(_) | Picture::Drawn { .. } => return None,
    };
    Some(FormattedTable {
        name: data_name(figure),
        title: figure.title.clone(),
        columns,
        rows,
        notes: vec![],
    })
}

fn data_name(figure: &Figure) -> String {
    format!("{}.data", figure.name)
}

/// Returns the name of the file with a figure's data, without its folder; `None` if it has no data.
pub(crate) fn data_file(figure: &Figure) -> Option<String> {
    let has_data = match &figure.picture {
        Picture::Drawing(_) => false,
        Picture::Drawn { has_data, .. } => *has_data,
        _ => true,
    };
    has_data.then(|| format!("{}.csv", data_name(figure)))
}

fn number(value: f64) -> TableCell {
    if value.is_finite() { TableCell::Number(value, 6) } else { TableCell::Nothing }
}

/// Returns the number, or the name that it represents on an axis of names.
fn axis_cell(axis: &ChartAxis, value: f64) -> TableCell {
    match &axis.scale {
        Scale::Names(names) => {
            names.get(value.round() as usize).cloned().map_or(TableCell::Nothing, TableCell::Text)
        }
        _ => number(value),
    }
}

fn headings(Chart { x, y, .. }: &Chart) -> Vec<String> {
    ["series".to_owned(), x.heading(), y.heading(), "lowest".to_owned(), "highest".to_owned()].to_vec()
}

fn chart_rows(Chart { x, y, series, .. }: &Chart) -> Vec<Vec<TableCell>> {
    let rows = series.iter().flat_map(|series| {
        series.points.iter().map(|point| {
            let [low, high] =
                point.spread.map_or([TableCell::Nothing, TableCell::Nothing], |ends| ends.map(number));
            vec![
                TableCell::Text(series.name.clone()),
                axis_cell(x, point.x),
                axis_cell(y, point.y),
                low,
                high,
            ]
        })
    });
    rows.collect()
}

fn map_table(HeatMap { x, y, value, rows }: &HeatMap) -> (Vec<String>, Vec<Vec<TableCell>>) {
    let middle = |axis: &ChartAxis, at: usize, count: usize| {
        let [low, high] = axis.limits.unwrap_or([0.0, count as f64]);
        let part = (at as f64 + 0.5) / count as f64;
        match axis.scale {
            Scale::Linear => low + (high - low) * (at as f64 + 0.5) / count as f64,
            Scale::Logarithmic => low * libm::pow(high / low, part),
            Scale::Names(_) => at as f64,
        }
    };
    let across = rows.first().map_or(0, Vec::len);
    let corner = format!("{} by {} down, {} across", value.heading(), y.heading(), x.heading());
    let columns = (0..across).map(|at| match &x.scale {
        Scale::Names(names) => names[at].clone(),
        _ => middle(x, at, across).to_string(),
    });
    let lines = rows.iter().enumerate().map(|(row, values)| {
        let middle = axis_cell(y, middle(y, row, rows.len()));
        std::iter::once(middle).chain(values.iter().copied().map(number)).collect()
    });
    (std::iter::once(corner).chain(columns).collect(), lines.collect())
}

#[cfg(test)]
mod tests {
    use super::super::tests::samples;
    use super::*;

    #[test]
    fn tables_have_every_point_and_cell() {
        for figure in samples::all() {
            let table = data(&figure);
            assert_eq!(table.is_some(), data_file(&figure).is_some());
            let Some(table) = table else { continue };
            assert_eq!(data_file(&figure), Some(format!("{}.csv", table.name)));
            assert!(table.rows.iter().all(|row| row.len() == table.columns.len()), "{}", figure.name);
            let points = |chart: &Chart| chart.series.iter().map(|series| series.points.len()).sum::<usize>();
            let rows = match &figure.picture {
                Picture::Charts(panels) => panels.iter().map(|(_, chart)| points(chart)).sum(),
                Picture::Map(map) => map.rows.len(),
                Picture::Drawing(_) | Picture::Drawn { .. } => unreachable!("drawings have no data"),
            };
            assert_eq!(table.rows.len(), rows, "{}", figure.name);
        }
    }

    #[test]
    fn a_map_names_the_middles_of_its_cells() {
        let axis = |label| ChartAxis::linear(label, Some("m")).between([0.0, 4.0]);
        let rows = vec![vec![1.0, 2.0], vec![3.0, f64::NAN]];
        let map = HeatMap { x: axis("x"), y: axis("y"), value: axis("depth"), rows };
        let (columns, rows) = map_table(&map);
        assert_eq!(columns, ["depth (m) by y (m) down, x (m) across", "1", "3"]);
        assert_eq!(rows[1], [TableCell::Number(3.0, 6), TableCell::Number(3.0, 6), TableCell::Nothing]);
        let (x, y) = (
            ChartAxis::names("search", ["lists", "lattice"]),
            ChartAxis::logarithmic("n", None).between([1.0, 1e4]),
        );
        let (columns, rows) = map_table(&HeatMap { x, y, ..map });
        assert_eq!(columns[1..], ["lists", "lattice"]);
        assert_eq!(rows[1][0], TableCell::Number(1000.0, 6));
    }

    #[test]
    fn panels_and_names_are_columns_of_words() {
        let words = |figure: &Figure, row: usize| data(figure).unwrap().rows[row][..3].to_vec();
        let row = words(&samples::panels(), 0);
        assert!(matches!(&row[0], TableCell::Text(panel) if panel == "5×5"), "{row:?}");
        let row = words(&samples::names(), 1);
        assert!(matches!(&row[1], TableCell::Text(name) if name == "dense-gas"), "{row:?}");
    }

    #[test]
    fn a_picture_from_a_file_is_unchanged() {
        let drawn = |has_data| Picture::Drawn { svg: "<svg/>".into(), has_data }.figure("old", "Old");
        assert_eq!(super::super::svg(&drawn(true)).unwrap(), "<svg/>");
        assert_eq!(data_file(&drawn(true)), Some("old.data.csv".into()));
        assert!(data_file(&drawn(false)).is_none() && data(&drawn(true)).is_none());
    }
}
