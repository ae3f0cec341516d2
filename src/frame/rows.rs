//! Builder of frames and tables, column by column.

use super::{FormattedTable, ResultFrame, TableCell};
use crate::statistics::MeanWithBar;

/// A table under construction. Each column is a heading and a function from items to cells; each item is a row.
#[derive(Debug)]
pub struct FrameBuilder<T> {
    columns: Vec<String>,
    rows: Vec<(T, Vec<TableCell>)>,
}

impl<T> FrameBuilder<T> {
    /// Starts a table with a row for each item and no columns.
    pub fn of(items: impl IntoIterator<Item = T>) -> FrameBuilder<T> {
        FrameBuilder { columns: vec![], rows: items.into_iter().map(|item| (item, vec![])).collect() }
    }

    /// Adds a column of words.
    pub fn text<W: Into<String>>(self, heading: impl Into<String>, of: impl Fn(&T) -> W) -> FrameBuilder<T> {
        self.column(heading.into(), &|item| TableCell::Text(of(item).into()))
    }

    /// Adds a column of counts.
    pub fn count<C: TryInto<u64>>(self, heading: impl Into<String>, of: impl Fn(&T) -> C) -> FrameBuilder<T> {
        self.column(heading.into(), &|item| of(item).try_into().map_or(TableCell::Nothing, TableCell::Count))
    }

    /// Adds a column of numbers with a number of decimals; an item may have none.
    pub fn number<N: Into<Option<f64>>>(
        self,
        heading: impl Into<String>,
        decimals: usize,
        of: impl Fn(&T) -> N,
    ) -> FrameBuilder<T> {
        self.column(heading.into(), &|item| {
            of(item).into().map_or(TableCell::Nothing, |it| TableCell::Number(it, decimals))
        })
    }

    /// Adds two columns: a mean with a number of decimals, and its 95 % half-width; an item may have none.
    pub fn mean<M: Into<Option<MeanWithBar>>>(
        self,
        heading: impl Into<String>,
        decimals: usize,
        of: impl Fn(&T) -> M,
    ) -> FrameBuilder<T> {
        let number = |it: Option<f64>| it.map_or(TableCell::Nothing, |it| TableCell::Number(it, decimals));
        self.cells([heading.into(), "± (95 %)".to_owned()], |item| {
            let mean: Option<MeanWithBar> = of(item).into();
            [mean.map(|it| it.value), mean.map(|it| it.bar)].map(number)
        })
    }

    /// Adds a column of numbers of any size, shown with two digits; an item may have none.
    pub fn short<N: Into<Option<f64>>>(
        self,
        heading: impl Into<String>,
        of: impl Fn(&T) -> N,
    ) -> FrameBuilder<T> {
        self.column(heading.into(), &|item| of(item).into().map_or(TableCell::Nothing, TableCell::Short))
    }

    /// Adds a column of any cells.
    pub fn cell<C: Into<TableCell>>(
        self,
        heading: impl Into<String>,
        of: impl Fn(&T) -> C,
    ) -> FrameBuilder<T> {
        self.column(heading.into(), &|item| of(item).into())
    }

    /// Adds a column; compiled once for all columns of such items.
    fn column(mut self, heading: String, of: &dyn Fn(&T) -> TableCell) -> FrameBuilder<T> {
        self.columns.push(heading);
        self.rows.iter_mut().for_each(|(item, cells)| cells.push(of(item)));
        self
    }

    /// Adds several columns, as many as there are headings.
    pub fn cells<C: Into<TableCell>, R: IntoIterator<Item = C>>(
        mut self,
        headings: impl IntoIterator<Item = impl Into<String>>,
        of: impl Fn(&T) -> R,
    ) -> FrameBuilder<T> {
        self.columns.extend(headings.into_iter().map(Into::into));
        for (item, cells) in &mut self.rows {
            cells.extend(of(item).into_iter().map(Into::into));
        }
        self
    }

    /// Builds the frame, with columns for programs, typed by their cells.
    pub fn frame(self, name: impl Into<String>, title: impl Into<String>) -> ResultFrame {
        ResultFrame::from(&self.table(name, title))
    }

    pub(crate) fn table(self, name: impl Into<String>, title: impl Into<String>) -> FormattedTable {
        let rows = self.rows.into_iter().map(|(_, cells)| cells).collect();
        FormattedTable { name: name.into(), title: title.into(), columns: self.columns, rows, notes: vec![] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_its_heading_and_its_cells() {
        let items = [("a", 1usize, Some(0.5)), ("b", 2, None)];
        let table = FrameBuilder::of(&items)
            .text("name", |(name, ..)| *name)
            .count("times", |(_, times, _)| *times)
            .number("share", 2, |(.., share)| *share)
            .cells([1, 2].map(|power| format!("to {power}")), |(_, times, _)| {
                [1, 2].map(|power| times.pow(power) as u64)
            })
            .table("items", "Items")
            .note("none");
        assert_eq!(table.columns, ["name", "times", "share", "to 1", "to 2"]);
        let first = [
            TableCell::from("a"),
            TableCell::Count(1),
            TableCell::Number(0.5, 2),
            TableCell::Count(1),
            TableCell::Count(1),
        ];
        assert_eq!(table.rows[0], first);
        assert_eq!(table.rows[1][2..], [TableCell::Nothing, TableCell::Count(2), TableCell::Count(4)]);
        assert_eq!(table.notes, ["none"]);
        // Without rows the headings remain.
        assert_eq!(FrameBuilder::of([0u64; 0]).count("n", |n| *n).table("", "").columns, ["n"]);
    }
}
