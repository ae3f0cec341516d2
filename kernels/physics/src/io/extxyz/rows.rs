//! Rows of a frame: the layout given by `Properties`, and discs from their fields.

use super::FrameContents;
use super::error::{Mistake, XyzMistakeKind};
use crate::io::numbers::number;
use crate::particles::{Particle, ParticleKind};

/// Column that a frame may have.
struct XyzColumn {
    name: &'static str,
    /// Accepted shapes; the first one is written by this program.
    shapes: &'static [&'static str],
}

const fn column(name: &'static str, shapes: &'static [&'static str]) -> XyzColumn {
    XyzColumn { name, shapes }
}

/// Planar programs write vectors with two columns and the angular velocity with one. ASE stores velocities as momenta and masses.
const COLUMNS: [XyzColumn; 9] = [
    column("species", &["species:S:1"]),
    column("pos", &["pos:R:3", "pos:R:2"]),
    column("id", &["id:I:1"]),
    column("velo", &["velo:R:3", "velo:R:2"]),
    column("radius", &["radius:R:1"]),
    column("mass", &["mass:R:1"]),
    column("omega", &["omega:R:3", "omega:R:1"]),
    column("masses", &["masses:R:1"]),
    column("momenta", &["momenta:R:3", "momenta:R:2"]),
];

/// Indices in [`COLUMNS`].
const SPECIES: usize = 0;
const POS: usize = 1;
const ID: usize = 2;
const VELO: usize = 3;
const RADIUS: usize = 4;
const MASS: usize = 5;
const OMEGA: usize = 6;
const MASSES: usize = 7;
const MOMENTA: usize = 8;

/// Quantities that a start requires: alternative columns (at least one must be present), and their name in messages.
const REQUIRED: [(&[usize], &str); 4] = [
    (&[POS], "`pos:R:3` (or `pos:R:2`)"),
    (&[VELO, MOMENTA], "`velo:R:3` (or `velo:R:2`, or `momenta:R:3`, which is divided by the masses)"),
    (&[RADIUS], "`radius:R:1`"),
    (&[MASS, MASSES], "`mass:R:1` (or `masses:R:1`)"),
];

/// Quantities that the rows of a frame have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FrameColumns {
    pub(crate) velocity: bool,
    pub(crate) radius: bool,
    pub(crate) mass: bool,
    /// True if velocities are momenta, to be divided by masses that the frame lacks.
    pub(crate) has_momenta_only: bool,
}

/// First field and width of each column, and the number of fields of a row.
pub(super) struct XyzRowLayout {
    columns: [Option<(usize, usize)>; COLUMNS.len()],
    fields: usize,
    /// True if the comment line names no columns.
    is_plain: bool,
}

impl XyzRowLayout {
    /// Layout of plain XYZ: a name and three coordinates.
    pub(super) fn plain() -> XyzRowLayout {
        let mut columns = [None; COLUMNS.len()];
        (columns[SPECIES], columns[POS]) = (Some((0, 1)), Some((1, 3)));
        XyzRowLayout { columns, fields: 4, is_plain: true }
    }

    /// Parses `name:type:width:…`; unknown columns are skipped.
    pub(super) fn parse(text: &str, room: FrameContents) -> Result<XyzRowLayout, Vec<XyzMistakeKind>> {
        let parts: Vec<&str> = text.trim().split(':').collect();
        let mut layout = XyzRowLayout { columns: [None; COLUMNS.len()], fields: 0, is_plain: false };
        let mut reasons = Vec::new();
        for part in parts.chunks(3) {
            let found = part.join(":");
            let known = COLUMNS.iter().position(|column| column.name == part[0]);
            let expected = known.map_or("name:S, I, R or L:width", |i| COLUMNS[i].shapes[0]);
            let width = match part {
                [name, "S" | "I" | "R" | "L", width] if !name.is_empty() => width.parse::<usize>().ok(),
                _ => None,
            };
            let end = width.filter(|&width| width > 0).and_then(|width| layout.fields.checked_add(width));
            let fits = known.is_none_or(|i| COLUMNS[i].shapes.contains(&found.as_str()));
            let (Some(end), true) = (end, fits) else {
                reasons.push(XyzMistakeKind::ColumnShape { found, expected });
                continue;
            };
            if let Some(i) = known {
                if layout.columns[i].is_some() {
                    reasons.push(XyzMistakeKind::RepeatedColumn(part[0].to_owned()));
                }
                layout.columns[i] = Some((layout.fields, end - layout.fields));
            }
            layout.fields = end;
        }
        let needed = if room.may_lack() { &REQUIRED[..1] } else { &REQUIRED[..] };
        for &(columns, expected) in needed {
            // A column of the wrong shape counts as present.
            let is_named = |&column: &usize| parts.chunks(3).any(|part| part[0] == COLUMNS[column].name);
            if !columns.iter().any(is_named) {
                reasons.push(XyzMistakeKind::MissingColumn(expected));
            }
        }
        if reasons.is_empty() { Ok(layout) } else { Err(reasons) }
    }

    /// Returns true if rows have ids; otherwise discs are numbered from 1.
    pub(super) fn has_ids(&self) -> bool {
        self.columns[ID].is_some()
    }

    /// Quantities of the rows.
    pub(super) fn quantities(&self) -> FrameColumns {
        let has = |column: usize| self.columns[column].is_some();
        let mass = has(MASS) || has(MASSES);
        FrameColumns {
            velocity: has(VELO) || has(MOMENTA),
            radius: has(RADIUS),
            mass,
            has_momenta_only: !has(VELO) && has(MOMENTA) && !mass,
        }
    }

    /// Column of a quantity that two columns may provide.
    fn either(&self, first: usize, second: usize) -> usize {
        if self.columns[first].is_some() { first } else { second }
    }

    /// Error for a row whose third coordinate is not 0.
    pub(super) fn out_of_plane(&self, text: &str, line: usize) -> Option<Mistake> {
        let fields: Vec<&str> = text.split_ascii_whitespace().collect();
        let row = XyzRow { layout: self, text, line, fields: &fields };
        let [_, _, z] = row.vector(POS).ok()?;
        row.zeros(POS, &[(2, z)]).err()
    }

    /// Parses a disc; its id is 0 if rows have none. `fields` is a buffer for reuse. Names of species are numbered as they occur, in `names`.
    pub(super) fn disc<'a>(
        &self,
        text: &'a str,
        (line, room): (usize, FrameContents),
        (fields, names): (&mut Vec<&'a str>, &mut Vec<String>),
    ) -> Result<Particle, Mistake> {
        fields.clear();
        fields.extend(text.split_ascii_whitespace());
        if fields.len() != self.fields {
            let found = fields.len();
            let reason = match self.is_plain {
                true => XyzMistakeKind::PlainFields { found },
                false => XyzMistakeKind::Fields { found, expected: self.fields },
            };
            return Err(Mistake::in_line(line, reason));
        }
        let row = XyzRow { layout: self, text, line, fields };
        let kind = if row.fields(SPECIES) == ["W"] { ParticleKind::Wall } else { ParticleKind::Grain };
        let species = match row.fields(SPECIES) {
            [name] if kind == ParticleKind::Grain => number_of(name, names),
            _ => 0,
        };
        let position = row.vector(POS)?;
        let id = row.id()?;
        let moving = self.either(VELO, MOMENTA);
        let mut velocity = row.vector(moving)?;
        if room.is_planar() {
            row.zeros(moving, &[(2, velocity[2])])?;
        }
        let radius = row.positive(RADIUS)?;
        let mass = row.positive(self.either(MASS, MASSES))?;
        if moving == MOMENTA && mass > 0.0 {
            velocity = row.velocity_from_momentum(velocity, mass)?;
        }
        let omega = row.spin()?;
        Ok(Particle { id, kind, species, position, velocity, angle: 0.0, omega, radius, mass })
    }
}

/// Number of a name among those known, to which it is added; the largest for all beyond it.
fn number_of(name: &str, names: &mut Vec<String>) -> u8 {
    let number = names.iter().position(|known| known == name).unwrap_or_else(|| {
        if names.len() < usize::from(u8::MAX) {
            names.push(name.to_owned());
            names.len() - 1
        } else {
            names.len()
        }
    });
    u8::try_from(number).unwrap_or(u8::MAX)
}

/// Row split into its fields, as many as the layout requires.
struct XyzRow<'a> {
    layout: &'a XyzRowLayout,
    text: &'a str,
    line: usize,
    fields: &'a [&'a str],
}

impl XyzRow<'_> {
    /// Fields of a column; none if the frame lacks it.
    fn fields(&self, column: usize) -> &[&str] {
        let Some((first, width)) = self.layout.columns[column] else { return &[] };
        self.fields.get(first..first + width).unwrap_or(&[])
    }

    fn wrong(&self, field: &str, reason: XyzMistakeKind) -> Mistake {
        let byte = (field.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        Mistake::at(self.line, self.text, byte, reason)
    }

    /// Numbers of a column, with 0 for missing ones.
    fn vector<const WIDTH: usize>(&self, column: usize) -> Result<[f64; WIDTH], Mistake> {
        let name = COLUMNS[column].name;
        let mut numbers = [0.0; WIDTH];
        for (value, field) in numbers.iter_mut().zip(self.fields(column)) {
            let found = || (*field).to_owned();
            let parsed = number(field)
                .ok_or_else(|| self.wrong(field, XyzMistakeKind::Number { column: name, found: found() }))?;
            if !parsed.is_finite() {
                return Err(self.wrong(field, XyzMistakeKind::NotFinite { column: name, found: found() }));
            }
            *value = parsed;
        }
        Ok(numbers)
    }

    /// Number above 0; 0 if the frame lacks the column.
    fn positive(&self, column: usize) -> Result<f64, Mistake> {
        let [value] = self.vector(column)?;
        if value > 0.0 || self.fields(column).is_empty() {
            return Ok(value);
        }
        let reason = XyzMistakeKind::NotPositive { column: COLUMNS[column].name, value };
        Err(self.wrong(self.fields(column)[0], reason))
    }

    /// Velocity from a momentum.
    fn velocity_from_momentum(&self, momentum: [f64; 3], mass: f64) -> Result<[f64; 3], Mistake> {
        let velocity = momentum.map(|p| p / mass);
        match velocity.iter().zip(self.fields(MOMENTA)).find(|(speed, _)| !speed.is_finite()) {
            None => Ok(velocity),
            Some((_, field)) => {
                let found = format!("{field} over the mass {mass:?}");
                Err(self.wrong(field, XyzMistakeKind::NotFinite { column: COLUMNS[MOMENTA].name, found }))
            }
        }
    }

    /// Angular velocity; 0 if the frame has none.
    fn spin(&self) -> Result<f64, Mistake> {
        if let [_] = self.fields(OMEGA) {
            let [omega] = self.vector(OMEGA)?;
            return Ok(omega);
        }
        let [about_x, about_y, omega] = self.vector(OMEGA)?;
        self.zeros(OMEGA, &[(0, about_x), (1, about_y)])?;
        Ok(omega)
    }

    /// Checks that components of a body in space are 0.
    fn zeros(&self, column: usize, components: &[(usize, f64)]) -> Result<(), Mistake> {
        match components.iter().find(|(_, value)| *value != 0.0) {
            None => Ok(()),
            Some(&(i, value)) => {
                let component = ['x', 'y', 'z'][i];
                let reason = XyzMistakeKind::OutOfPlane { column: COLUMNS[column].name, component, value };
                Err(self.wrong(self.fields(column)[i], reason))
            }
        }
    }

    fn id(&self) -> Result<u32, Mistake> {
        let Some(field) = self.fields(ID).first() else { return Ok(0) };
        field.parse().map_err(|_| self.wrong(field, XyzMistakeKind::Id((*field).to_owned())))
    }
}
