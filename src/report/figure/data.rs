//! The numbers of a figure as a table, for programs.

use super::{Chart, Figure, Map, Picture};
use crate::report::{Cell, Table};

/// What a chart or a map shows, in a table called as the figure's data; none of a drawing, whose shapes are not data.
///
/// A chart gives a row for each point: its series, x, y, and the ends of its spread. A map gives a row for each of its rows from
/// the bottom: where the middle of the row lies, and its values under the middles of the columns.
pub fn data(figure: &Figure) -> Option<Table> {
    let (columns, rows) = match &figure.picture {
        Picture::Chart(chart) => points(chart),
        Picture::Map(map) => cells(map),
        Picture::Drawing(_) | Picture::Drawn { .. } => return None,
    };
    Some(Table { name: data_name(figure), title: figure.title.clone(), columns, rows, notes: vec![] })
}

/// What the table of a figure's data is called.
fn data_name(figure: &Figure) -> String {
    format!("{}.data", figure.name)
}

/// The file with a figure's data, without its folder; none where there are no data.
pub fn data_file(figure: &Figure) -> Option<String> {
    let has_data = match figure.picture {
        Picture::Drawing(_) => false,
        Picture::Drawn { has_data, .. } => has_data,
        Picture::Chart(_) | Picture::Map(_) => true,
    };
    has_data.then(|| format!("{}.csv", data_name(figure)))
}

fn number(value: f64) -> Cell {
    if value.is_finite() { Cell::Number(value, 6) } else { Cell::Nothing }
}

fn points(Chart { x, y, series, .. }: &Chart) -> (Vec<String>, Vec<Vec<Cell>>) {
    let columns = ["series".to_owned(), x.heading(), y.heading(), "lowest".to_owned(), "highest".to_owned()];
    let rows = series.iter().flat_map(|series| {
        series.points.iter().map(|point| {
            let [low, high] = point.spread.map_or([Cell::Nothing, Cell::Nothing], |ends| ends.map(number));
            vec![Cell::Text(series.name.clone()), number(point.x), number(point.y), low, high]
        })
    });
    (columns.to_vec(), rows.collect())
}

fn cells(Map { x, y, value, rows }: &Map) -> (Vec<String>, Vec<Vec<Cell>>) {
    let middle = |limits: Option<[f64; 2]>, at: usize, count: usize| {
        let [low, high] = limits.unwrap_or([0.0, count as f64]);
        low + (high - low) * (at as f64 + 0.5) / count as f64
    };
    let across = rows.first().map_or(0, Vec::len);
    let corner = format!("{} by {} down, {} across", value.heading(), y.heading(), x.heading());
    let columns = (0..across).map(|column| middle(x.limits, column, across).to_string());
    let lines = rows.iter().enumerate().map(|(row, values)| {
        let middle = number(middle(y.limits, row, rows.len()));
        std::iter::once(middle).chain(values.iter().copied().map(number)).collect()
    });
    (std::iter::once(corner).chain(columns).collect(), lines.collect())
}

#[cfg(test)]
mod tests {
    use super::super::samples;
    use super::*;

    #[test]
    fn every_point_and_every_cell_is_in_the_table() {
        for figure in samples::all() {
            let table = data(&figure);
            assert_eq!(table.is_some(), data_file(&figure).is_some());
            let Some(table) = table else { continue };
            assert_eq!(data_file(&figure), Some(format!("{}.csv", table.name)));
            assert!(table.rows.iter().all(|row| row.len() == table.columns.len()), "{}", figure.name);
            let rows = match &figure.picture {
                Picture::Chart(chart) => chart.series.iter().map(|series| series.points.len()).sum(),
                Picture::Map(map) => map.rows.len(),
                Picture::Drawing(_) | Picture::Drawn { .. } => unreachable!("a drawing has no data"),
            };
            assert_eq!(table.rows.len(), rows, "{}", figure.name);
        }
    }

    #[test]
    fn a_map_names_the_middles_of_its_cells() {
        let axis = |label| super::super::Axis {
            limits: Some([0.0, 4.0]),
            ..super::super::Axis::linear(label, Some("m"))
        };
        let map = Map {
            x: axis("x"),
            y: axis("y"),
            value: axis("depth"),
            rows: vec![vec![1.0, 2.0], vec![3.0, f64::NAN]],
        };
        let (columns, rows) = cells(&map);
        assert_eq!(columns, ["depth (m) by y (m) down, x (m) across", "1", "3"]);
        assert_eq!(rows[1], [Cell::Number(3.0, 6), Cell::Number(3.0, 6), Cell::Nothing]);
    }
}
