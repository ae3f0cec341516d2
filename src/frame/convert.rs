//! Conversion between tables of cells and frames: cells of one heading become several typed columns.

use super::{Digits, FormattedTable, FrameColumn, FrameValue, ResultFrame, Role, TableCell, names};

/// Converts a table of cells to a frame: each column of cells becomes as many typed columns as its cells need.
impl From<&FormattedTable> for ResultFrame {
    fn from(table: &FormattedTable) -> ResultFrame {
        let mut columns: Vec<FrameColumn> = vec![];
        let mut sources: Vec<usize> = vec![];
        let mut before = String::new();
        for (source, heading) in table.columns.iter().enumerate() {
            let mut base = names::of(heading);
            // A heading that only qualifies the column before, or is repeated, is named after both.
            let is_known = |name: &str| columns.iter().any(|column| column.name == name);
            if heading.starts_with('±') || is_known(&base) {
                base = format!("{before}_{base}");
            }
            before.clone_from(&base);
            let numbered = (2..).map(|number| format!("{base}_{number}"));
            let base =
                std::iter::once(base.clone()).chain(numbered).find(|name| !is_known(name)).unwrap_or(base);
            let cells = || table.rows.iter().filter_map(|row| row.get(source));
            let roles = roles(cells);
            for &role in &roles {
                let name = match role {
                    Role::Words if roles.len() > 1 => format!("{base}_words"),
                    Role::Words | Role::Count | Role::Number => base.clone(),
                    Role::Error => format!("{base}_error"),
                    Role::Lowest => format!("{base}_lowest"),
                    Role::Highest => format!("{base}_highest"),
                };
                let unit = names::unit(heading).filter(|_| role != Role::Words).map(str::to_owned);
                columns.push(FrameColumn { name, doc: heading.clone(), unit, role, digits: digits(cells) });
                sources.push(source);
            }
        }
        let rows = table.rows.iter().map(|cells| {
            let places = columns.iter().zip(&sources);
            places
                .map(|(column, at)| cells.get(*at).map_or(FrameValue::Nothing, |it| part(it, column.role)))
                .collect()
        });
        let rows = rows.collect();
        ResultFrame { name: table.name.clone(), title: table.title.clone(), columns, rows }
    }
}

/// Converts a frame for reading: columns of one heading become one.
impl From<&ResultFrame> for FormattedTable {
    fn from(frame: &ResultFrame) -> FormattedTable {
        let mut groups: Vec<Vec<usize>> = vec![];
        for (at, column) in frame.columns.iter().enumerate() {
            let continues = |before: &FrameColumn| before.doc == column.doc && before.role < column.role;
            match groups.last_mut() {
                Some(group) if continues(&frame.columns[at - 1]) => group.push(at),
                _ => groups.push(vec![at]),
            }
        }
        let cell = |row: &[FrameValue], group: &[usize]| {
            let of = |role: Role| {
                let place = group.iter().find(|at| frame.columns[**at].role == role)?;
                Some(row[*place].clone()).filter(|value| *value != FrameValue::Nothing)
            };
            let digits = frame.columns[group[0]].digits;
            TableCell::of(Role::ALL.map(of), digits)
        };
        let rows = frame.rows.iter().map(|row| groups.iter().map(|group| cell(row, group)).collect());
        FormattedTable {
            name: frame.name.clone(),
            title: frame.title.clone(),
            columns: groups.iter().map(|group| frame.columns[group[0]].doc.clone()).collect(),
            rows: rows.collect(),
            notes: vec![],
        }
    }
}

/// Roles of the columns that cells of one heading need.
fn roles<'c, I: Iterator<Item = &'c TableCell>>(cells: impl Fn() -> I) -> Vec<Role> {
    let has = |is_so: fn(&TableCell) -> bool| cells().any(is_so);
    let ranges = has(|cell| matches!(cell, TableCell::Range(..) | TableCell::Spread { .. }));
    let errors = has(|cell| matches!(cell, TableCell::WithError { .. }));
    let numbers =
        has(|cell| matches!(cell, TableCell::Number(..) | TableCell::Short(_) | TableCell::Spread { .. }));
    let counts = has(|cell| matches!(cell, TableCell::Count(_)));
    let words = has(|cell| matches!(cell, TableCell::Text(words) if !words.is_empty()));
    let all = [
        (numbers || errors, Role::Number),
        (counts && !(numbers || errors), Role::Count),
        (errors, Role::Error),
        (ranges, Role::Lowest),
        (ranges, Role::Highest),
        (words || !(numbers || errors || counts || ranges), Role::Words),
    ];
    all.into_iter().filter(|(is_there, _)| *is_there).map(|(_, role)| role).collect()
}

/// Digits shown of some cells; the most where they differ.
fn digits<'c, I: Iterator<Item = &'c TableCell>>(cells: impl Fn() -> I) -> Option<Digits> {
    let decimals = cells().filter_map(|cell| match cell {
        TableCell::Number(_, decimals)
        | TableCell::WithError { decimals, .. }
        | TableCell::Range(_, decimals)
        | TableCell::Spread { decimals, .. } => Some(*decimals),
        _ => None,
    });
    let short = || cells().any(|cell| matches!(cell, TableCell::Short(_))).then_some(Digits::Short);
    decimals.max().map(Digits::Decimals).or_else(short)
}

fn part(cell: &TableCell, role: Role) -> FrameValue {
    match (cell, role) {
        (TableCell::Text(words), Role::Words) => FrameValue::Words(words.clone()),
        (TableCell::Count(count), Role::Count) => FrameValue::Count(*count),
        (TableCell::Count(count), Role::Number) => FrameValue::Number(*count as f64),
        (TableCell::Number(value, _) | TableCell::Short(value), Role::Number) => FrameValue::number(*value),
        (TableCell::WithError { value, .. } | TableCell::Spread { value, .. }, Role::Number) => {
            FrameValue::number(*value)
        }
        (TableCell::WithError { error, .. }, Role::Error) => FrameValue::number(*error),
        (TableCell::Range([it, _], _) | TableCell::Spread { range: [it, _], .. }, Role::Lowest) => {
            FrameValue::number(*it)
        }
        (TableCell::Range([_, it], _) | TableCell::Spread { range: [_, it], .. }, Role::Highest) => {
            FrameValue::number(*it)
        }
        _ => FrameValue::Nothing,
    }
}
