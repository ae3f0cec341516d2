//! Text dump of LAMMPS: frames of `ITEM:` sections, with columns by name.

use super::text::{TextFile, TextLine, TextMistake, TextReadError};
use super::{
    QuantitySource, StartBox, StartFileError, StartFormat, StartFrame, StartRequest, lines, particle_of_type,
};
use crate::io::lammps::DUMP_COLUMNS;
use crate::particles::{Particle, ParticleKind, Particles};
use std::path::Path;

pub(super) static FORMAT: StartFormat = StartFormat {
    name: "LAMMPS dump",
    recognises: |head| lines(head).next().is_some_and(|line| line.starts_with(b"ITEM:")),
    read,
    columns: ["vx vy vz", "radius (or diameter)", "mass"],
};

const COUNT: &str = "ITEM: NUMBER OF ATOMS";
const BOUNDS: &str = "ITEM: BOX BOUNDS";
const ATOMS: &str = "ITEM: ATOMS";

fn read(path: &Path, request: StartRequest) -> Result<StartFrame, StartFileError> {
    let mut file = TextFile::open(path)?;
    let (mut wanted, mut count) = (None, 0);
    while let Some(frame) = RawDump::next(&mut file)? {
        if request.frame.is_none_or(|number| number == count) {
            wanted = Some(frame);
        }
        count += 1;
    }
    match wanted {
        Some(frame) => Ok(frame.parse(&file, request)?),
        None => Err(StartFileError::beyond(path, request, count)),
    }
}

/// Frame whose rows are not parsed yet.
struct RawDump {
    bounds: [TextLine; 3],
    flags: TextLine,
    header: TextLine,
    rows: Vec<TextLine>,
}

impl RawDump {
    /// Reads the next frame; none at the end of the file.
    fn next(file: &mut TextFile) -> Result<Option<RawDump>, TextReadError> {
        let (mut count, mut bounds) = (None, None);
        loop {
            let Some(line) = file.next_line()? else {
                return match count.is_some() || bounds.is_some() {
                    true => file.required_line(ATOMS).map(|_| None),
                    false => Ok(None),
                };
            };
            let text = line.text.trim();
            if text.is_empty() {
                continue;
            }
            if text.starts_with(COUNT) {
                let line = file.required_line("the number of atoms")?;
                count = Some((file.count(&line, line.text.trim())?, line.number));
            } else if text.starts_with(BOUNDS) {
                let mut next = || file.required_line("the bounds of the box along x, y and z");
                bounds = Some((line, [next()?, next()?, next()?]));
            } else if text.starts_with(ATOMS) {
                let missing = |expected| {
                    let found = line.to_string();
                    file.wrong(line.number, TextMistake::Expected { found, expected })
                };
                let (count, promised) = count.ok_or_else(|| missing(COUNT))?;
                let (flags, bounds) = bounds.ok_or_else(|| missing(BOUNDS))?;
                let mut rows = vec![];
                for found in 0..count {
                    let number = line.number + found;
                    let Some(row) = file.next_line()?.filter(|row| !row.text.starts_with("ITEM:")) else {
                        let reason = TextMistake::Rows { found, promised: count, line: promised };
                        return Err(file.wrong(number, reason));
                    };
                    rows.push(row);
                }
                return Ok(Some(RawDump { bounds, flags, header: line, rows }));
            } else if text.starts_with("ITEM:") {
                // TIMESTEP, TIME and UNITS have one line each.
                file.required_line("the value of this item")?;
            } else {
                let (found, expected) = (line.to_string(), "a line that begins with `ITEM:`");
                return Err(file.wrong(line.number, TextMistake::Expected { found, expected }));
            }
        }
    }

    fn parse(&self, file: &TextFile, request: StartRequest) -> Result<StartFrame, TextReadError> {
        let (low, high) = self.low_and_high(file)?;
        let names: Vec<&str> = self.header.words().into_iter().skip(2).collect();
        let column = |name: &str| names.iter().position(|it| *it == name);
        let is_own = names == DUMP_COLUMNS.split(' ').collect::<Vec<_>>();
        let places = self.places(file, &column)?;
        let velocity: Vec<usize> = ["vx", "vy", "vz"].iter().filter_map(|name| column(name)).collect();
        let [id, mass, omega] = ["id", "mass", "omegaz"].map(column);
        let radius = column("radius").map(|at| (at, 1.0)).or(column("diameter").map(|at| (at, 0.5)));
        let kind = column("type");
        let mut particles = Vec::with_capacity(self.rows.len());
        for (number, row) in self.rows.iter().enumerate() {
            let words = row.words();
            if words.len() != names.len() {
                let (found, expected) =
                    (words.len(), format!("{}, as line {} names", names.len(), self.header.number));
                return Err(file.wrong(row.number, TextMistake::Fields { found, expected }));
            }
            let id = id.map_or(Ok(number as u32 + 1), |at| file.id(row, words[at]))?;
            let (kind, species) =
                kind.map_or((ParticleKind::Grain, 0), |at| particle_of_type(words[at], is_own));
            let mut particle = Particle { species, ..Particle::at_rest(id, kind, [0.0; 3]) };
            for (axis, place) in places.iter().enumerate() {
                let Some((at, is_scaled)) = *place else { continue };
                let value = file.number(row, "the position", words[at])?;
                let scaled = low[axis] + value * (high[axis] - low[axis]);
                particle.position[axis] = if is_scaled { scaled } else { value };
            }
            for (axis, &at) in velocity.iter().enumerate() {
                particle.velocity[axis] = file.number(row, "the velocity", words[at])?;
            }
            if let Some((at, factor)) = radius {
                particle.radius = factor * file.positive(row, "the radius", words[at])?;
            }
            if let Some(at) = mass {
                particle.mass = file.positive(row, "mass", words[at])?;
            }
            if let Some(at) = omega {
                particle.omega = file.number(row, "omegaz", words[at])?;
            }
            particles.push(particle);
        }
        let line_of: Vec<usize> = self.rows.iter().map(|row| row.number).collect();
        let has_raised_ids = file.check(&mut particles, &line_of, request)?;
        let source = |is_there| if is_there { QuantitySource::Stated } else { QuantitySource::Missing };
        let sides = [high[0] - low[0], high[1] - low[1]];
        Ok(StartFrame {
            particles: Particles::new(particles),
            cell: Some(StartBox {
                corner: [low[0], low[1]],
                sides,
                is_movable: false,
                precision: StartBox::DOUBLE,
            }),
            periodic: self.periodic(),
            sources: [velocity.len() >= 2, radius.is_some(), mass.is_some()].map(source),
            has_momenta: false,
            line: Some(self.header.number),
            columns: FORMAT.columns,
            has_raised_ids,
        })
    }

    /// Columns of the position along x, y and z, and true if they are fractions of the box. z may be missing.
    fn places(
        &self,
        file: &TextFile,
        column: &impl Fn(&str) -> Option<usize>,
    ) -> Result<[Option<(usize, bool)>; 3], TextReadError> {
        let place = |axis: &str| {
            let kinds = [("", false), ("u", false), ("s", true), ("su", true)];
            kinds.iter().find_map(|(kind, is_scaled)| Some((column(&format!("{axis}{kind}"))?, *is_scaled)))
        };
        let places = ["x", "y", "z"].map(place);
        if places[0].is_none() || places[1].is_none() {
            let reason = TextMistake::Column {
                what: "the position",
                expected: "x y z, xs ys zs, xu yu zu or xsu ysu zsu",
            };
            return Err(file.wrong(self.header.number, reason));
        }
        Ok(places)
    }

    /// Lowest and highest coordinate of the box along each axis.
    fn low_and_high(&self, file: &TextFile) -> Result<([f64; 3], [f64; 3]), TextReadError> {
        /// Tilt by rounding, relative to a side.
        const ROUNDING: f64 = 1e-12;
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        let mut tilts = vec![];
        for (axis, line) in self.bounds.iter().enumerate() {
            let words = line.words();
            let [first, second, ref rest @ ..] = words[..] else {
                let (found, expected) = (words.len(), "two, the bounds of the box".to_owned());
                return Err(file.wrong(line.number, TextMistake::Fields { found, expected }));
            };
            low[axis] = file.number(line, "the lower bound", first)?;
            high[axis] = file.number(line, "the upper bound", second)?;
            if high[axis] <= low[axis] {
                let (found, expected) = (second.to_owned(), "a number above the lower bound");
                return Err(file.wrong_word(
                    line,
                    second,
                    TextMistake::Number { what: "the upper bound", found, expected },
                ));
            }
            for word in rest {
                tilts.push((line, *word, file.number(line, "the tilt", word)?));
            }
        }
        match tilts.iter().find(|(_, _, tilt)| tilt.abs() > ROUNDING * (high[0] - low[0])) {
            Some((line, word, tilt)) => Err(file.wrong_word(line, word, TextMistake::Tilt(*tilt))),
            None => Ok((low, high)),
        }
    }

    /// Periodicity along x and y, from flags such as `pp ff ff`.
    fn periodic(&self) -> Option<[bool; 2]> {
        let words = self.flags.words();
        let flags: Vec<&&str> = words
            .iter()
            .skip(3)
            .filter(|word| word.len() == 2 && **word != "xy" && **word != "xz" && **word != "yz")
            .collect();
        let [x, y, ..] = flags[..] else { return None };
        Some([x, y].map(|flag| *flag == "pp"))
    }
}
