//! Mistakes in extended XYZ files, with their locations.

use super::format::ForeignFormat;
use crate::io::trajectory::TrajectoryError;
use crate::number::count_with_noun;
use crate::particles::MOST_PARTICLES;
use crate::quoted::{self, quoted};
use std::fmt;
use std::io;

/// All mistakes found in a file of frames, in the order of their lines.
#[derive(Debug, thiserror::Error)]
#[error("{}", listing(self))]
pub struct XyzReadError {
    /// Name of the file.
    pub file: String,
    /// First mistakes; at least one.
    pub mistakes: Vec<Mistake>,
    /// Number of further mistakes.
    pub more: usize,
}

/// Mistake with its location.
#[derive(Debug)]
pub struct Mistake {
    /// Line, from 1; none if the file cannot be read at all.
    pub line: Option<usize>,
    /// Column in characters, from 1; none if the whole line is meant.
    pub column: Option<usize>,
    /// Reason of the mistake.
    pub reason: XyzMistakeKind,
}

/// Reason of a mistake in an extended XYZ file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum XyzMistakeKind {
    /// The system refuses to read it.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// A line longer than any valid one.
    #[error("the line is longer than {most} bytes; expected a row of about twenty numbers")]
    LongLine {
        /// Limit (bytes).
        most: usize,
    },
    /// An empty file.
    #[error("the file is empty; expected the number of discs")]
    Empty,
    /// Bytes that are not text.
    #[error("not UTF-8 text")]
    NotText,
    /// A missing number at the start of a frame.
    #[error("expected the number of discs, which begins a frame, found `{}`{}", quoted(found), after(*.previous))]
    Count {
        /// Text found.
        found: String,
        /// Line of the previous frame's count, which may be too small.
        previous: Option<usize>,
    },
    /// More particles than can be numbered.
    #[error(
        "a frame of {found} discs; expected at most {MOST_PARTICLES}, as searches number them with 29 bits"
    )]
    TooMany {
        /// Number of discs that the frame announces.
        found: usize,
    },
    /// The file ends within a frame.
    #[error(
        "truncated: the file ends after {found} of the {promised} discs that line {line} announces{}",
        whole(*.frames)
    )]
    Truncated {
        /// Discs present of the last frame.
        found: usize,
        /// Discs that it should have.
        promised: usize,
        /// Line that states their number.
        line: usize,
        /// Complete frames before it.
        frames: usize,
    },
    /// A quote or bracket that is not closed.
    #[error("`{0}` is never closed")]
    Unclosed(char),
    /// A key missing in the comment line.
    #[error("the comment line has no `{key}`; expected {expected}")]
    MissingKey {
        /// Missing key.
        key: &'static str,
        /// Expected value.
        expected: &'static str,
    },
    /// A key given twice.
    #[error("`{}` is given twice", quoted(.0))]
    RepeatedKey(String),
    /// A value that the key cannot have.
    #[error("{key} is `{}`; expected {expected}", quoted(found))]
    Value {
        /// Key with this value.
        key: &'static str,
        /// Value found.
        found: String,
        /// Expected value.
        expected: &'static str,
    },
    /// A box that is not rectangular.
    #[error("number {at} of Lattice is {value}; boxes are rectangles, so expected 0")]
    Tilt {
        /// Number of the entry among the nine, from 1.
        at: usize,
        /// Value found.
        value: f64,
    },
    /// A file of another format.
    #[error(
        "this is {0}; expected extended XYZ, with columns for positions, velocities, radii and masses: convert it, for \
         example with OVITO (Export File, XYZ)"
    )]
    Format(ForeignFormat),
    /// A quantity without a column in `Properties`.
    #[error(
        "Properties has no column {0}; add it to the file, for example in OVITO (Compute property, Export File, XYZ) or in ASE \
         (atoms.set_array)"
    )]
    MissingColumn(&'static str),
    /// A column named twice.
    #[error("Properties names the column `{}` twice", quoted(.0))]
    RepeatedColumn(String),
    /// A column of another type or width.
    #[error("Properties has `{}`; expected `{expected}`", quoted(found))]
    ColumnShape {
        /// Shape found.
        found: String,
        /// Expected shape.
        expected: &'static str,
    },
    /// A row with too few or too many fields.
    #[error("the row has {found} fields; Properties asks for {expected}")]
    Fields {
        /// Fields of the row.
        found: usize,
        /// Fields that `Properties` adds up to.
        expected: usize,
    },
    /// A row of a frame without `Properties` that is not a name and three coordinates.
    #[error(
        "the row has {found} fields, and the comment line has no `Properties`; expected four fields, a name and three \
         coordinates, or `Properties` with the names of the columns, such as {}",
        super::PROPERTIES
    )]
    PlainFields {
        /// Fields of the row.
        found: usize,
    },
    /// A field that is not a number.
    #[error("{column} is `{}`; expected a number", quoted(found))]
    Number {
        /// Name of the column.
        column: &'static str,
        /// Text found.
        found: String,
    },
    /// An infinite number or NaN.
    #[error("{column} is `{}`; expected a finite number", quoted(found))]
    NotFinite {
        /// Name of the column.
        column: &'static str,
        /// Text found.
        found: String,
    },
    /// A radius or mass that is zero or negative.
    #[error("{column} is {value}; expected a number greater than 0")]
    NotPositive {
        /// Name of the column.
        column: &'static str,
        /// Value found.
        value: f64,
    },
    /// A component out of the plane.
    #[error("component {component} of {column} is {value}; discs lie in the plane, so expected 0")]
    OutOfPlane {
        /// Name of the column.
        column: &'static str,
        /// `x`, `y` or `z`.
        component: char,
        /// Value found.
        value: f64,
    },
    /// An id that is not a whole number of 32 bits.
    #[error("id is `{}`; expected a whole number from 0 to 4294967295", quoted(.0))]
    Id(String),
    /// Ids from 0 whose last one cannot be raised.
    #[error("id is 4294967295, and another is 0; ids that begin at 0 end at 4294967294")]
    LastId,
    /// An id that another disc has.
    #[error("id {id} is taken by the disc in line {line}")]
    RepeatedId {
        /// Repeated id.
        id: u32,
        /// Line of its first occurrence.
        line: usize,
    },
}

fn after(previous: Option<usize>) -> String {
    previous.map_or_else(String::new, |line| format!("; does line {line} announce too few?"))
}

fn whole(frames: usize) -> String {
    match frames {
        0 => String::new(),
        1 => "; the frame before is complete".to_owned(),
        _ => format!("; the {frames} frames before are complete"),
    }
}

impl Mistake {
    pub(super) fn in_line(line: usize, reason: XyzMistakeKind) -> Mistake {
        Mistake { line: Some(line), column: None, reason }
    }

    /// Mistake at a byte of a line's text.
    pub(super) fn at(line: usize, text: &str, byte: usize, reason: XyzMistakeKind) -> Mistake {
        let column = text.get(..byte).map(|before| before.chars().count() + 1);
        Mistake { line: Some(line), column, reason }
    }

    pub(super) fn reading(cause: io::Error) -> Mistake {
        Mistake { line: None, column: None, reason: cause.into() }
    }
}

impl From<Mistake> for XyzMistakeList {
    fn from(mistake: Mistake) -> Self {
        XyzMistakeList { first: vec![mistake], more: 0 }
    }
}

/// Collection of mistakes; keeps the first ones and counts the rest.
#[derive(Debug, Default)]
pub(super) struct XyzMistakeList {
    first: Vec<Mistake>,
    more: usize,
}

impl XyzMistakeList {
    const KEPT: usize = 20;

    /// True if a further mistake would be kept; otherwise its location need not be found.
    pub(super) fn has_room(&self) -> bool {
        self.first.len() < XyzMistakeList::KEPT
    }

    pub(super) fn extend(&mut self, mistakes: impl IntoIterator<Item = Mistake>) {
        mistakes.into_iter().for_each(|mistake| self.add(mistake));
    }

    /// Counts a mistake without keeping it.
    pub(super) fn count(&mut self) {
        self.more += 1;
    }

    pub(super) fn add(&mut self, mistake: Mistake) {
        if self.has_room() {
            self.first.push(mistake);
        } else {
            self.more += 1;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    pub(super) fn of_file(self, file: &str) -> XyzReadError {
        XyzReadError { file: file.to_owned(), mistakes: self.first, more: self.more }
    }
}

impl XyzReadError {
    /// Error of the system, if the file could not be read at all.
    pub fn system(&self) -> Option<&io::Error> {
        self.mistakes.iter().find_map(|mistake| match &mistake.reason {
            XyzMistakeKind::Io(cause) => Some(cause),
            _ => None,
        })
    }
}

impl From<XyzReadError> for TrajectoryError {
    fn from(error: XyzReadError) -> TrajectoryError {
        TrajectoryError {
            line: error.mistakes.first().and_then(|mistake| mistake.line),
            is_of_system: error.system().is_some(),
            words: error.to_string(),
            file: error.file.into(),
        }
    }
}

/// Formats `line:column: ` as far as known.
impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for number in [self.line, self.column].into_iter().flatten() {
            write!(f, "{number}:")?;
        }
        write!(f, " {}", self.reason)
    }
}

fn listing(error: &XyzReadError) -> String {
    let file = quoted::path(error.file.as_ref());
    let mut lines: Vec<String> = error.mistakes.iter().map(|mistake| format!("{file}:{mistake}")).collect();
    if error.more > 0 {
        lines.push(format!("{file}: {}", count_with_noun(error.more, "more mistake", "more mistakes")));
    }
    lines.join("\n")
}
