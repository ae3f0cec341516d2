//! Lines of text files, with the location of every mistake.

use super::{StartRequest, lines};
use crate::io::numbers::number;
use crate::io::plane::move_into_plane;
use crate::io::regular_file;
use crate::particles::{MOST_PARTICLES, Particle};
use crate::quoted::{self, quoted};
use std::collections::HashMap;
use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Mistake in a text, with its location.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {reason}", quoted::path(file), place(*.line, *.column))]
pub struct TextReadError {
    /// Path of the file.
    pub file: PathBuf,
    /// Line, from 1; none if the file cannot be read.
    pub line: Option<usize>,
    /// Column in characters, from 1; none if the whole line is meant.
    pub column: Option<usize>,
    /// Reason.
    pub reason: TextMistake,
}

fn place(line: Option<usize>, column: Option<usize>) -> String {
    [line, column].into_iter().flatten().map(|number| format!(":{number}")).collect()
}

/// Reason of a mistake in a text.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TextMistake {
    /// The system refuses to read it.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Bytes that are not text, or a line too long.
    #[error("the line is not UTF-8 text of at most {LONGEST_LINE} bytes; expected a row of numbers")]
    Line,
    /// Something else than the format asks for here.
    #[error("found `{}`; expected {expected}", quoted(found))]
    Expected {
        /// Text found.
        found: String,
        /// Expected text.
        expected: &'static str,
    },
    /// The end of the file where more is expected.
    #[error("truncated: the file ends here; expected {0}")]
    Ends(&'static str),
    /// Fewer rows than announced.
    #[error(
        "truncated: {found} of the {promised} particles that line {line} announces; expected as many rows"
    )]
    Rows {
        /// Rows found.
        found: usize,
        /// Rows announced.
        promised: usize,
        /// Line that announces them.
        line: usize,
    },
    /// More particles than can be numbered.
    #[error("{found} particles; expected at most {MOST_PARTICLES}, as searches number them with 29 bits")]
    TooMany {
        /// Number announced.
        found: usize,
    },
    /// A row with another number of fields.
    #[error("the row has {found} fields; expected {expected}")]
    Fields {
        /// Fields found.
        found: usize,
        /// Expected fields.
        expected: String,
    },
    /// A quantity that needs a column.
    #[error("there is no column for {what}; expected {expected}")]
    Column {
        /// Quantity.
        what: &'static str,
        /// Names of possible columns.
        expected: &'static str,
    },
    /// A number out of its range.
    #[error("{what} is `{}`; expected {expected}", quoted(found))]
    Number {
        /// Quantity.
        what: &'static str,
        /// Text found.
        found: String,
        /// Range.
        expected: &'static str,
    },
    /// A box that is not a rectangle.
    #[error("the box has the tilt {0}; expected 0, as boxes are rectangles")]
    Tilt(f64),
    /// Particles at different heights.
    #[error("z is {z}, but {first} for the first particle; expected one z for all, as discs lie in a plane")]
    Space {
        /// Third coordinate found.
        z: f64,
        /// Third coordinate of the first particle.
        first: f64,
    },
    /// An id that another particle has.
    #[error("id {id} is taken by the particle in line {line}; expected an id of its own")]
    RepeatedId {
        /// Repeated id.
        id: u32,
        /// Line of its first occurrence.
        line: usize,
    },
    /// A particle that another section needs.
    #[error("particle {id} has no {what}; expected {expected}")]
    Lacks {
        /// Id of the particle.
        id: u32,
        /// Missing quantity.
        what: &'static str,
        /// Expected line.
        expected: String,
    },
}

/// Longest line (bytes).
const LONGEST_LINE: usize = 1 << 20;

impl TextReadError {
    /// Error of the system.
    pub(super) fn of_system(file: &Path, cause: io::Error) -> TextReadError {
        TextReadError { file: file.to_owned(), line: None, column: None, reason: cause.into() }
    }
}

/// Open text.
pub(super) struct TextFile {
    path: PathBuf,
    reader: BufReader<File>,
    /// Number of lines read.
    line: usize,
}

/// Line of a text.
#[derive(Clone, Debug)]
pub(super) struct TextLine {
    pub(super) number: usize,
    pub(super) text: String,
}

impl TextFile {
    pub(super) fn open(path: &Path) -> Result<TextFile, TextReadError> {
        let file = regular_file::open(path).map_err(|cause| TextReadError::of_system(path, cause))?;
        Ok(TextFile { path: path.to_owned(), reader: BufReader::new(file), line: 0 })
    }

    /// Reads the next line without its end; none at the end of the file.
    pub(super) fn next_line(&mut self) -> Result<Option<TextLine>, TextReadError> {
        let mut bytes = vec![];
        let mut line = self.reader.by_ref().take(LONGEST_LINE as u64 + 1);
        line.read_until(b'\n', &mut bytes).map_err(|cause| TextReadError::of_system(&self.path, cause))?;
        if bytes.is_empty() {
            return Ok(None);
        }
        self.line += 1;
        let is_short = bytes.len() <= LONGEST_LINE;
        let bytes = if self.line == 1 { lines(&bytes).next().unwrap_or_default().to_vec() } else { bytes };
        match String::from_utf8(bytes) {
            Ok(text) if is_short => Ok(Some(TextLine { number: self.line, text })),
            _ => Err(self.wrong(self.line, TextMistake::Line)),
        }
    }

    /// Reads the next line, which must exist.
    pub(super) fn required_line(&mut self, expected: &'static str) -> Result<TextLine, TextReadError> {
        match self.next_line()? {
            Some(line) => Ok(line),
            None => Err(self.wrong(self.line, TextMistake::Ends(expected))),
        }
    }

    /// Mistake of a whole line.
    pub(super) fn wrong(&self, line: usize, reason: TextMistake) -> TextReadError {
        TextReadError { file: self.path.clone(), line: Some(line), column: None, reason }
    }

    /// Mistake of a word of a line.
    pub(super) fn wrong_word(&self, line: &TextLine, word: &str, reason: TextMistake) -> TextReadError {
        let byte = (word.as_ptr() as usize).saturating_sub(line.text.as_ptr() as usize);
        let column = line.text.get(..byte).map(|before| before.chars().count() + 1);
        TextReadError { column, ..self.wrong(line.number, reason) }
    }

    /// Parses a finite number.
    pub(super) fn number(
        &self,
        line: &TextLine,
        what: &'static str,
        word: &str,
    ) -> Result<f64, TextReadError> {
        number(word).filter(|number| number.is_finite()).ok_or_else(|| {
            let (found, expected) = (word.to_owned(), "a finite number");
            self.wrong_word(line, word, TextMistake::Number { what, found, expected })
        })
    }

    /// Parses a number above 0.
    pub(super) fn positive(
        &self,
        line: &TextLine,
        what: &'static str,
        word: &str,
    ) -> Result<f64, TextReadError> {
        let value = self.number(line, what, word)?;
        if value > 0.0 {
            return Ok(value);
        }
        let (found, expected) = (word.to_owned(), "a number greater than 0");
        Err(self.wrong_word(line, word, TextMistake::Number { what, found, expected }))
    }

    /// Parses an id.
    pub(super) fn id(&self, line: &TextLine, word: &str) -> Result<u32, TextReadError> {
        word.parse().map_err(|_| {
            let (found, expected) = (word.to_owned(), "a whole number from 0 to 4294967295");
            self.wrong_word(line, word, TextMistake::Number { what: "id", found, expected })
        })
    }

    /// Parses the number of particles.
    pub(super) fn count(&self, line: &TextLine, word: &str) -> Result<usize, TextReadError> {
        match word.parse() {
            Ok(found) if found > MOST_PARTICLES => {
                Err(self.wrong_word(line, word, TextMistake::TooMany { found }))
            }
            Ok(count) => Ok(count),
            Err(_) => {
                let (found, expected) = (word.chars().take(60).collect(), "the number of particles");
                Err(self.wrong_word(line, word, TextMistake::Expected { found, expected }))
            }
        }
    }

    /// Checks ids and planes of particles, each with its line, and raises ids that begin at 0. Returns true if it raised them.
    pub(super) fn check(
        &self,
        particles: &mut [Particle],
        line_of: &[usize],
        request: StartRequest,
    ) -> Result<bool, TextReadError> {
        let mut lines: HashMap<u32, usize> = HashMap::with_capacity(particles.len());
        for (particle, &line) in particles.iter().zip(line_of) {
            if let Some(first) = lines.insert(particle.id, line) {
                let reason = TextMistake::RepeatedId { id: particle.id, line: first };
                return Err(self.wrong(line, reason));
            }
        }
        if request.is_planar {
            let first = particles.first().map_or(0.0, |first| first.position[2]);
            if !move_into_plane(particles) {
                let other = particles.iter().zip(line_of).find(|(it, _)| it.position[2] != first);
                let (z, line) = other.map_or((first, 1), |(it, line)| (it.position[2], *line));
                return Err(self.wrong(line, TextMistake::Space { z, first }));
            }
            if let Some((it, &line)) = particles.iter().zip(line_of).find(|(it, _)| it.velocity[2] != 0.0) {
                let found = it.velocity[2].to_string();
                let expected = "0, as discs move in a plane";
                return Err(
                    self.wrong(line, TextMistake::Number { what: "the velocity along z", found, expected })
                );
            }
        }
        let is_from_0 = lines.contains_key(&0);
        if is_from_0 {
            if let Some(&line) = lines.get(&u32::MAX) {
                let (found, expected) = (u32::MAX.to_string(), "ids up to 4294967294 where they begin at 0");
                return Err(self.wrong(line, TextMistake::Number { what: "id", found, expected }));
            }
            particles.iter_mut().for_each(|particle| particle.id += 1);
        }
        Ok(is_from_0)
    }
}

impl TextLine {
    /// Line up to a `#`.
    pub(super) fn without_comment(mut self) -> TextLine {
        self.text.truncate(self.text.find('#').unwrap_or(self.text.len()));
        self
    }

    /// Words of the line.
    pub(super) fn words(&self) -> Vec<&str> {
        self.text.split_ascii_whitespace().collect()
    }
}

impl fmt::Display for TextLine {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.text.trim().chars().take(60).collect::<String>())
    }
}
