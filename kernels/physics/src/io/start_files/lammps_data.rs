//! Data file of LAMMPS: counts, box and sections, of which `Masses`, `Atoms` and `Velocities` are read.

use super::text::{TextFile, TextLine, TextMistake, TextReadError};
use super::{
    QuantitySource, StartBox, StartFileError, StartFormat, StartFrame, StartRequest, is_count, lines,
    particle_of_type,
};
use crate::io::lammps::{DATA_HEADING, mass_of_sphere};
use crate::particles::{Particle, Particles};
use std::collections::HashMap;
use std::path::Path;

pub(super) static FORMAT: StartFormat = StartFormat {
    name: "LAMMPS data",
    recognises: |head| lines(head).skip(1).take(40).any(announces_atoms),
    read,
    columns: [
        "section Velocities",
        "diameters (Atoms # sphere)",
        "densities (Atoms # sphere), or section Masses",
    ],
};

/// True for a line such as `16 atoms`.
fn announces_atoms(line: &[u8]) -> bool {
    let text = line.split(|&byte| byte == b'#').next().unwrap_or_default().trim_ascii();
    text.strip_suffix(b"atoms").is_some_and(|count| is_count(count.trim_ascii()))
}

/// Velocity and angular velocity of an atom.
type AtomMotion = ([f64; 3], f64);

/// Columns of a row of `Atoms`.
#[derive(Clone, Copy)]
struct AtomStyle {
    name: &'static str,
    /// Fields before the position.
    position: usize,
    /// Fields of diameter and density.
    sphere: Option<[usize; 2]>,
}

const fn style(name: &'static str, position: usize) -> AtomStyle {
    AtomStyle { name, position, sphere: None }
}

/// Styles that have all of a disc; the type is the second field, or the third after a molecule.
const STYLES: [AtomStyle; 7] = [
    AtomStyle { name: "sphere", position: 4, sphere: Some([2, 3]) },
    style("atomic", 2),
    style("charge", 3),
    style("bond", 3),
    style("angle", 3),
    style("molecular", 3),
    style("full", 4),
];
const NAMES: &str =
    "a style in the heading, one of `Atoms # sphere`, atomic, charge, bond, angle, molecular, full";

/// Rows of the sections that are read, and the box.
#[derive(Default)]
struct DataSections {
    count: Option<(usize, usize)>,
    low_and_high: [Option<[f64; 2]>; 3],
    masses: Vec<TextLine>,
    atoms: Vec<TextLine>,
    velocities: Vec<TextLine>,
    /// Heading of `Atoms`.
    heading: Option<TextLine>,
}

fn read(path: &Path, request: StartRequest) -> Result<StartFrame, StartFileError> {
    if request.frame.is_some_and(|number| number > 0) {
        return Err(StartFileError::beyond(path, request, 1));
    }
    let mut file = TextFile::open(path)?;
    let first = file.required_line("a heading")?;
    let is_own = first.text.starts_with(DATA_HEADING);
    let sections = DataSections::read(&mut file)?;
    Ok(sections.frame(&file, is_own, request)?)
}

impl DataSections {
    fn read(file: &mut TextFile) -> Result<DataSections, TextReadError> {
        /// Tilt by rounding.
        const ROUNDING: f64 = 1e-12;
        let mut sections = DataSections::default();
        let mut section: Option<String> = None;
        while let Some(line) = file.next_line()? {
            let text = line.text.split('#').next().unwrap_or_default().trim();
            let words: Vec<&str> = text.split_ascii_whitespace().collect();
            let begins_upper = text.starts_with(|c: char| c.is_ascii_uppercase());
            match (&words[..], section.as_deref()) {
                ([], _) => {}
                (_, _) if begins_upper => {
                    if text == "Atoms" {
                        sections.heading = Some(line.clone());
                    }
                    section = Some(text.to_owned());
                }
                (_, Some("Masses")) => sections.masses.push(line.without_comment()),
                (_, Some("Atoms")) => sections.atoms.push(line.without_comment()),
                (_, Some("Velocities")) => sections.velocities.push(line.without_comment()),
                (_, Some(_)) => {}
                ([count, "atoms"], None) => sections.count = Some((file.count(&line, count)?, line.number)),
                ([low, high, from, _], None) if from.ends_with("lo") => {
                    let axis = ["xlo", "ylo", "zlo"].iter().position(|name| name == from);
                    let [low, high] = [
                        file.number(&line, "the lower bound", low)?,
                        file.number(&line, "the upper bound", high)?,
                    ];
                    if let Some(axis) = axis {
                        sections.low_and_high[axis] = Some([low, high]);
                    }
                    if high <= low {
                        let (found, expected) = (words[1].to_owned(), "a number above the lower bound");
                        return Err(file.wrong(
                            line.number,
                            TextMistake::Number { what: "the upper bound", found, expected },
                        ));
                    }
                }
                ([.., "xy", "xz", "yz"], None) => {
                    for word in &words[..words.len() - 3] {
                        let tilt = file.number(&line, "the tilt", word)?;
                        let side = sections.low_and_high[0].map_or(1.0, |[low, high]| high - low);
                        if tilt.abs() > ROUNDING * side {
                            return Err(file.wrong(line.number, TextMistake::Tilt(tilt)));
                        }
                    }
                }
                (_, None) => {}
            }
        }
        Ok(sections)
    }

    /// Layout of the rows of `Atoms`.
    fn style(&self, file: &TextFile) -> Result<AtomStyle, TextReadError> {
        let (Some(heading), Some(first)) = (&self.heading, self.atoms.first()) else {
            return Err(file.wrong(1, TextMistake::Ends(NAMES)));
        };
        let stated = heading.text.split_once('#').map(|(_, style)| style.trim());
        if let Some(stated) = stated {
            let known = STYLES.into_iter().find(|style| style.name == stated);
            return known.ok_or_else(|| {
                let found = stated.chars().take(60).collect();
                file.wrong(heading.number, TextMistake::Expected { found, expected: NAMES })
            });
        }
        // Three image flags may follow.
        match first.words().len() {
            5 | 8 => Ok(STYLES[1]),
            6 | 9 => Ok(STYLES[2]),
            found => {
                let expected = format!("{NAMES}, as this number may be of several styles");
                Err(file.wrong(first.number, TextMistake::Fields { found, expected }))
            }
        }
    }

    fn frame(
        &self,
        file: &TextFile,
        is_own: bool,
        request: StartRequest,
    ) -> Result<StartFrame, TextReadError> {
        let (count, announced) = self.count.unwrap_or_default();
        if self.atoms.len() != count {
            let line = self.atoms.last().map_or(announced, |row| row.number);
            return Err(file.wrong(
                line,
                TextMistake::Rows { found: self.atoms.len(), promised: count, line: announced },
            ));
        }
        let ([Some([left, right]), Some([bottom, top]), _], false) =
            (self.low_and_high, self.atoms.is_empty())
        else {
            return Err(file.wrong(
                announced,
                TextMistake::Ends("the box (`xlo xhi`, `ylo yhi`) and the section Atoms"),
            ));
        };
        let style = self.style(file)?;
        let masses = self.masses_of_types(file)?;
        let velocities = self.velocities_of_ids(file)?;
        let mut particles = Vec::with_capacity(count);
        let mut line_of = Vec::with_capacity(count);
        for row in &self.atoms {
            particles.push(atom(file, row, style, is_own, &masses)?);
            line_of.push(row.number);
        }
        if let Some(velocities) = &velocities {
            for (particle, &line) in particles.iter_mut().zip(&line_of) {
                let Some((velocity, omega)) = velocities.get(&particle.id) else {
                    let expected = format!("a row `{} vx vy vz` in Velocities", particle.id);
                    return Err(
                        file.wrong(line, TextMistake::Lacks { id: particle.id, what: "velocity", expected })
                    );
                };
                (particle.velocity, particle.omega) = (*velocity, *omega);
            }
        }
        let has_raised_ids = file.check(&mut particles, &line_of, request)?;
        let source = |is_there| if is_there { QuantitySource::Stated } else { QuantitySource::Missing };
        let sides = [right - left, top - bottom];
        Ok(StartFrame {
            particles: Particles::new(particles),
            cell: Some(StartBox {
                corner: [left, bottom],
                sides,
                is_movable: false,
                precision: StartBox::DOUBLE,
            }),
            periodic: None,
            sources: [
                velocities.is_some(),
                style.sphere.is_some(),
                style.sphere.is_some() || !masses.is_empty(),
            ]
            .map(source),
            has_momenta: false,
            line: self.heading.as_ref().map(|heading| heading.number),
            columns: FORMAT.columns,
            has_raised_ids,
        })
    }

    fn masses_of_types(&self, file: &TextFile) -> Result<HashMap<String, f64>, TextReadError> {
        let mut masses = HashMap::new();
        for line in &self.masses {
            let [kind, mass, ..] = line.words()[..] else {
                let expected = "two, a type and its mass".to_owned();
                return Err(
                    file.wrong(line.number, TextMistake::Fields { found: line.words().len(), expected })
                );
            };
            masses.insert(kind.to_owned(), file.positive(line, "mass", mass)?);
        }
        Ok(masses)
    }

    /// Velocity and angular velocity by id; none without the section.
    fn velocities_of_ids(&self, file: &TextFile) -> Result<Option<HashMap<u32, AtomMotion>>, TextReadError> {
        let mut velocities = HashMap::with_capacity(self.velocities.len());
        for line in &self.velocities {
            let words = line.words();
            let [id, ref numbers @ ..] = words[..] else { continue };
            if ![3, 6].contains(&numbers.len()) {
                let expected = "id vx vy vz, and wx wy wz of spheres".to_owned();
                return Err(file.wrong(line.number, TextMistake::Fields { found: words.len(), expected }));
            }
            let mut motion = [0.0; 6];
            for (value, word) in motion.iter_mut().zip(numbers) {
                *value = file.number(line, "the velocity", word)?;
            }
            let [u, v, w, _, _, omega] = motion;
            velocities.insert(file.id(line, id)?, ([u, v, w], omega));
        }
        Ok((!self.velocities.is_empty()).then_some(velocities))
    }
}

/// Particle of a row of `Atoms`.
fn atom(
    file: &TextFile,
    row: &TextLine,
    style: AtomStyle,
    is_own: bool,
    masses: &HashMap<String, f64>,
) -> Result<Particle, TextReadError> {
    let words = row.words();
    let fields = style.position + 3;
    if ![fields, fields + 3].contains(&words.len()) {
        let expected = format!("{fields} of style {}, or {} with image flags", style.name, fields + 3);
        return Err(file.wrong(row.number, TextMistake::Fields { found: words.len(), expected }));
    }
    let kind = match ["bond", "angle", "molecular", "full"].contains(&style.name) {
        true => words[2],
        false => words[1],
    };
    let mut position = [0.0; 3];
    for (coordinate, word) in position.iter_mut().zip(&words[style.position..]) {
        *coordinate = file.number(row, "the position", word)?;
    }
    let id = file.id(row, words[0])?;
    let (disc, species) = particle_of_type(kind, is_own);
    let mut particle = Particle { species, ..Particle::at_rest(id, disc, position) };
    if let Some([diameter, density]) = style.sphere {
        particle.radius = 0.5 * file.positive(row, "the diameter", words[diameter])?;
        particle.mass = mass_of_sphere(file.positive(row, "the density", words[density])?, particle.radius);
    } else if !masses.is_empty() {
        particle.mass = *masses.get(kind).ok_or_else(|| {
            let expected = format!("a row `{kind} mass` in Masses");
            file.wrong(row.number, TextMistake::Lacks { id, what: "mass", expected })
        })?;
    }
    Ok(particle)
}
