//! Conversion between tables of cells and frames: cells of one heading become several typed columns.

use super::{Cell, Column, Digits, Frame, Role, Table, Value, names};

/// Converts a table of cells to a frame: each column of cells becomes as many typed columns as its cells need.
impl From<&Table> for Frame {
    fn from(table: &Table) -> Frame {
        let mut columns: Vec<Column> = vec![];
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
                columns.push(Column { name, doc: heading.clone(), unit, role, digits: digits(cells) });
                sources.push(source);
            }
        }
        let rows = table.rows.iter().map(|cells| {
            let places = columns.iter().zip(&sources);
            places
                .map(|(column, at)| cells.get(*at).map_or(Value::Nothing, |it| part(it, column.role)))
                .collect()
        });
        let rows = rows.collect();
        Frame { name: table.name.clone(), title: table.title.clone(), columns, rows }
    }
}

/// Converts a frame for reading: columns of one heading become one.
impl From<&Frame> for Table {
    fn from(frame: &Frame) -> Table {
        let mut groups: Vec<Vec<usize>> = vec![];
        for (at, column) in frame.columns.iter().enumerate() {
            let continues = |before: &Column| before.doc == column.doc && before.role < column.role;
            match groups.last_mut() {
                Some(group) if continues(&frame.columns[at - 1]) => group.push(at),
                _ => groups.push(vec![at]),
            }
        }
        let cell = |row: &[Value], group: &[usize]| {
            let of = |role: Role| {
                let place = group.iter().find(|at| frame.columns[**at].role == role)?;
                Some(row[*place].clone()).filter(|value| *value != Value::Nothing)
            };
            let digits = frame.columns[group[0]].digits;
            Cell::of(Role::ALL.map(of), digits)
        };
        let rows = frame.rows.iter().map(|row| groups.iter().map(|group| cell(row, group)).collect());
        Table {
            name: frame.name.clone(),
            title: frame.title.clone(),
            columns: groups.iter().map(|group| frame.columns[group[0]].doc.clone()).collect(),
            rows: rows.collect(),
            notes: vec![],
        }
    }
}

/// Roles of the columns that cells of one heading need.
fn roles<'c, I: Iterator<Item = &'c Cell>>(cells: impl Fn() -> I) -> Vec<Role> {
    let has = |is_so: fn(&Cell) -> bool| cells().any(is_so);
    let ranges = has(|cell| matches!(cell, Cell::Range(..) | Cell::Spread { .. }));
    let errors = has(|cell| matches!(cell, Cell::WithError { .. }));
    let numbers = has(|cell| matches!(cell, Cell::Number(..) | Cell::Short(_) | Cell::Spread { .. }));
    let counts = has(|cell| matches!(cell, Cell::Count(_)));
    let words = has(|cell| matches!(cell, Cell::Text(words) if !words.is_empty()));
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
fn digits<'c, I: Iterator<Item = &'c Cell>>(cells: impl Fn() -> I) -> Option<Digits> {
    let decimals = cells().filter_map(|cell| match cell {
        Cell::Number(_, decimals)
        | Cell::WithError { decimals, .. }
        | Cell::Range(_, decimals)
        | Cell::Spread { decimals, .. } => Some(*decimals),
        _ => None,
    });
    let short = || cells().any(|cell| matches!(cell, Cell::Short(_))).then_some(Digits::Short);
    decimals.max().map(Digits::Decimals).or_else(short)
}

fn part(cell: &Cell, role: Role) -> Value {
    match (cell, role) {
        (Cell::Text(words), Role::Words) => Value::Words(words.clone()),
        (Cell::Count(count), Role::Count) => Value::Count(*count),
        (Cell::Count(count), Role::Number) => Value::Number(*count as f64),
        (Cell::Number(value, _) | Cell::Short(value), Role::Number) => Value::number(*value),
        (Cell::WithError { value, .. } | Cell::Spread { value, .. }, Role::Number) => Value::number(*value),
        (Cell::WithError { error, .. }, Role::Error) => Value::number(*error),
        (Cell::Range([it, _], _) | Cell::Spread { range: [it, _], .. }, Role::Lowest) => Value::number(*it),
        (Cell::Range([_, it], _) | Cell::Spread { range: [_, it], .. }, Role::Highest) => Value::number(*it),
        _ => Value::Nothing,
    }
}
