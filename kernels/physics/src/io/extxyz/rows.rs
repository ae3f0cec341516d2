//! The rows of a frame: where `Properties` puts each column, and a disc from its fields.

use super::Room;
use super::error::{Mistake, Reason};
use crate::particles::{Kind, Particle};

/// A column that a frame may have.
struct Column {
    name: &'static str,
    shape: &'static str,
    width: usize,
    required: bool,
}

const fn column(name: &'static str, shape: &'static str, width: usize, required: bool) -> Column {
    Column { name, shape, width, required }
}

/// Without `species` every disc is a grain.
const COLUMNS: [Column; 7] = [
    column("species", "species:S:1", 1, false),
    column("pos", "pos:R:3", 3, true),
    column("id", "id:I:1", 1, true),
    column("velo", "velo:R:3", 3, true),
    column("radius", "radius:R:1", 1, true),
    column("mass", "mass:R:1", 1, true),
    column("omega", "omega:R:3", 3, true),
];

/// The first field of each of the columns, and how many fields a row has.
pub(super) struct Layout {
    first: [Option<usize>; COLUMNS.len()],
    fields: usize,
}

impl Layout {
    /// From `name:type:width:…`; columns that we do not know are passed over.
    pub(super) fn parse(text: &str) -> Result<Layout, Vec<Reason>> {
        let parts: Vec<&str> = text.trim().split(':').collect();
        let mut layout = Layout { first: [None; COLUMNS.len()], fields: 0 };
        let mut reasons = Vec::new();
        for part in parts.chunks(3) {
            let found = part.join(":");
            let known = COLUMNS.iter().position(|column| column.name == part[0]);
            let expected = known.map_or("name:S, I, R or L:width", |i| COLUMNS[i].shape);
            let width = match part {
                [name, "S" | "I" | "R" | "L", width] if !name.is_empty() => width.parse::<usize>().ok(),
                _ => None,
            };
            let end = width.filter(|&width| width > 0).and_then(|width| layout.fields.checked_add(width));
            let (Some(end), true) = (end, known.is_none_or(|i| COLUMNS[i].shape == found)) else {
                reasons.push(Reason::ColumnShape { found, expected });
                continue;
            };
            if let Some(i) = known {
                if layout.first[i].is_some() {
                    reasons.push(Reason::RepeatedColumn(part[0].to_owned()));
                }
                layout.first[i] = Some(layout.fields);
            }
            layout.fields = end;
        }
        for (column, first) in COLUMNS.iter().zip(&layout.first) {
            // A column of the wrong shape is there.
            let named = parts.chunks(3).any(|part| part[0] == column.name);
            if column.required && first.is_none() && !named {
                reasons.push(Reason::MissingColumn(column.shape));
            }
        }
        if reasons.is_empty() { Ok(layout) } else { Err(reasons) }
    }

    /// A disc from a row; `fields` is there to be used again.
    pub(super) fn disc<'a>(
        &self,
        text: &'a str,
        (line, room): (usize, Room),
        fields: &mut Vec<&'a str>,
    ) -> Result<Particle, Mistake> {
        fields.clear();
        fields.extend(text.split_ascii_whitespace());
        if fields.len() != self.fields {
            let reason = Reason::Fields { found: fields.len(), expected: self.fields };
            return Err(Mistake::in_line(line, reason));
        }
        let row = Row { layout: self, text, line, fields };
        let kind = match row.fields(SPECIES) {
            [] | ["Si"] => Kind::Grain,
            ["W"] => Kind::Wall,
            [other, ..] => return Err(row.wrong(other, Reason::Species((*other).to_owned()))),
        };
        let [x, y, z] = row.vector(POS)?;
        let id = row.id()?;
        let [u, v, w] = row.vector(VELO)?;
        if room == Room::Plane {
            row.zeros(POS, &[(2, z)])?;
            row.zeros(VELO, &[(2, w)])?;
        }
        let radius = row.positive(RADIUS)?;
        let mass = row.positive(MASS)?;
        let [about_x, about_y, omega] = row.vector(OMEGA)?;
        row.zeros(OMEGA, &[(0, about_x), (1, about_y)])?;
        Ok(Particle { id, kind, position: [x, y, z], velocity: [u, v, w], angle: 0.0, omega, radius, mass })
    }
}

/// Places in [`COLUMNS`].
const SPECIES: usize = 0;
const POS: usize = 1;
const ID: usize = 2;
const VELO: usize = 3;
const RADIUS: usize = 4;
const MASS: usize = 5;
const OMEGA: usize = 6;

/// A row cut into its fields, as many as the layout asks for.
struct Row<'a> {
    layout: &'a Layout,
    text: &'a str,
    line: usize,
    fields: &'a [&'a str],
}

impl Row<'_> {
    /// The fields of a column; none if the frame does not have it.
    fn fields(&self, column: usize) -> &[&str] {
        let Some(first) = self.layout.first[column] else { return &[] };
        self.fields.get(first..first + COLUMNS[column].width).unwrap_or(&[])
    }

    fn wrong(&self, field: &str, reason: Reason) -> Mistake {
        let byte = (field.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        Mistake::at(self.line, self.text, byte, reason)
    }

    fn vector<const WIDTH: usize>(&self, column: usize) -> Result<[f64; WIDTH], Mistake> {
        let name = COLUMNS[column].name;
        let mut numbers = [0.0; WIDTH];
        for (number, field) in numbers.iter_mut().zip(self.fields(column)) {
            let found = || (*field).to_owned();
            let parsed: f64 = field
                .parse()
                .map_err(|_| self.wrong(field, Reason::Number { column: name, found: found() }))?;
            if !parsed.is_finite() {
                return Err(self.wrong(field, Reason::NotFinite { column: name, found: found() }));
            }
            *number = parsed;
        }
        Ok(numbers)
    }

    fn positive(&self, column: usize) -> Result<f64, Mistake> {
        let [value] = self.vector(column)?;
        if value > 0.0 {
            return Ok(value);
        }
        let reason = Reason::NotPositive { column: COLUMNS[column].name, value };
        Err(self.wrong(self.fields(column)[0], reason))
    }

    /// Components that only a body in space has.
    fn zeros(&self, column: usize, components: &[(usize, f64)]) -> Result<(), Mistake> {
        match components.iter().find(|(_, value)| *value != 0.0) {
            None => Ok(()),
            Some(&(i, value)) => {
                let component = ['x', 'y', 'z'][i];
                let reason = Reason::OutOfPlane { column: COLUMNS[column].name, component, value };
                Err(self.wrong(self.fields(column)[i], reason))
            }
        }
    }

    fn id(&self) -> Result<u32, Mistake> {
        let field = self.fields(ID).first().copied().unwrap_or_default();
        match field.parse() {
            Ok(id) if id > 0 => Ok(id),
            _ => Err(self.wrong(field, Reason::Id(field.to_owned()))),
        }
    }
}
