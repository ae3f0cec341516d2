//! Mistakes of an input file, with their locations.

use crate::number::count_with_noun;
use crate::quoted;
use serde::Serialize;

/// Location in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct TextLocation {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// Kind of a mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum MistakeKind {
    /// The scene cannot be found or read.
    Unreadable,
    /// Not TOML.
    Syntax,
    /// The system refuses to read the file.
    System,
    /// A format version that this program cannot read.
    Format,
    /// An unknown section or key.
    Unknown,
    /// A value of the wrong type, or a word that is not among the choices.
    Type,
    /// A number out of its range.
    Range,
    /// A required key is missing.
    Missing,
    /// A key that has no effect with the other choices of the scene.
    Unused,
    /// Keys that contradict each other.
    Contradiction,
    /// An override that is not `section.key=value`.
    Override,
    /// A file that the scene names cannot be read, or its content is wrong.
    StartFile,
    /// More discs than random placement finds room for.
    Placement,
    /// Discs that overlap at the start deeper than the scene allows.
    Overlap,
    /// A disc outside the domain.
    Outside,
    /// Discs or a box that no lattice fits.
    Geometry,
    /// A time step at which the integrator is unstable.
    Stability,
    /// A run that needs more memory than this machine has.
    Memory,
    /// Mistakes beyond those listed.
    More,
}

/// Mistake of an input file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, thiserror::Error)]
#[error("{}", paragraph(self))]
pub struct InputError {
    /// File, preset, or option of the command line.
    pub file: String,
    /// Location in the file, if there is one.
    pub place: Option<TextLocation>,
    /// Kind.
    pub reason: MistakeKind,
    /// Mistake in words, with the numbers.
    pub message: String,
    /// Expected value.
    pub expected: Option<String>,
    /// Advice.
    pub suggestion: Option<String>,
}

fn paragraph(error: &InputError) -> String {
    let mut text = quoted::quoted(&error.file);
    if let Some(TextLocation { line, column }) = error.place {
        text.push_str(&format!(":{line}:{column}"));
    }
    let [default_expected, default_advice] = error.reason.defaults();
    // Messages of parsers have the expectation behind the mistake.
    let marks = [", expected ", "; expected ", ", but must be ", ", but this program reads "];
    let in_message = || marks.iter().find_map(|mark| error.message.split_once(mark));
    let (message, expected) = match (&error.expected, in_message()) {
        (Some(expected), _) => (error.message.as_str(), expected.as_str()),
        (None, Some((message, "nothing"))) => (message, default_expected),
        (None, Some(parts)) => parts,
        (None, None) => (error.message.as_str(), default_expected),
    };
    let advice = error.suggestion.as_deref().unwrap_or(default_advice);
    text.push_str(&format!(": {}", quoted::message(message)));
    for (what, words) in [("expected", expected), ("help", advice)] {
        if !words.is_empty() {
            text.push_str(&format!("\n  {what}: {}", quoted::message(words)));
        }
    }
    text
}

impl MistakeKind {
    /// Expected value and advice of a mistake that states none of its own.
    fn defaults(self) -> [&'static str; 2] {
        match self {
            MistakeKind::Unreadable => [
                "a readable file or the name of a preset",
                "check the path; `stripmine scene list` lists the presets",
            ],
            MistakeKind::Syntax => ["a TOML file in UTF-8", "correct the text at this location"],
            MistakeKind::System => ["a readable file", "check the path and its permissions"],
            MistakeKind::Format => {
                ["a format that this program reads", "convert the file, or use the version that wrote it"]
            }
            MistakeKind::Unknown => ["a known name", "correct the name, or remove the line"],
            MistakeKind::Type => ["a value of the right type", "change the value"],
            MistakeKind::Range => ["a value in the allowed range", "change the value"],
            MistakeKind::Missing => ["a value", "add the line"],
            MistakeKind::Unused => ["a key that has an effect", "remove the line"],
            MistakeKind::Contradiction => ["values that agree with each other", "change one of them"],
            MistakeKind::Override => ["section.key=value", "correct the option"],
            MistakeKind::StartFile => {
                ["a start file that can be read whole", "correct the start file, or name another one"]
            }
            MistakeKind::Placement => {
                ["discs that find room", "place fewer or smaller discs, or enlarge the box"]
            }
            MistakeKind::Overlap => ["discs that do not overlap", "move one of the discs"],
            MistakeKind::Outside => ["discs inside the box", "move the disc, or enlarge the box"],
            MistakeKind::Geometry => {
                ["a box and discs that a lattice fits", "change the box, the discs or [search]"]
            }
            MistakeKind::Stability => ["a stable time step", "lower integrator.dt"],
            MistakeKind::Memory => ["a run that fits into memory", "reduce the particles or the outputs"],
            MistakeKind::More => ["", ""],
        }
    }
}

impl InputError {
    /// Adds the expected value.
    #[must_use]
    pub(crate) fn expecting(self, expected: impl Into<String>) -> Self {
        InputError { expected: Some(expected.into()), ..self }
    }

    /// Adds advice.
    #[must_use]
    pub fn advising(self, suggestion: impl Into<String>) -> Self {
        InputError { suggestion: Some(suggestion.into()), ..self }
    }
}

/// Collection of mistakes; lists the first ones and counts the rest.
#[derive(Clone, Debug, Default)]
pub struct MistakeList {
    named: Vec<InputError>,
    more: usize,
}

impl MistakeList {
    /// Largest number of mistakes listed: a file of another kind may have millions.
    pub(crate) const NAMED: usize = 50;

    /// True if a further mistake would be listed; otherwise its message need not be formatted.
    pub fn has_room(&self) -> bool {
        self.named.len() < MistakeList::NAMED
    }

    pub(crate) fn named(&self) -> &[InputError] {
        &self.named
    }

    /// Adds a mistake.
    pub fn push(&mut self, error: InputError) {
        match self.has_room() {
            true => self.named.push(error),
            false => self.more += 1,
        }
    }

    /// Counts a mistake without listing it.
    pub(crate) fn count(&mut self) {
        self.more += 1;
    }

    /// Returns the mistakes of the file as an error, if there are any.
    ///
    /// # Errors
    /// If there is any mistake.
    pub fn ok_without_mistakes(self, file: &str) -> Result<(), InputErrors> {
        let Err(InputErrors(mut errors)) = InputErrors::ok_if_empty(self.named) else { return Ok(()) };
        if self.more > 0 {
            let spot = Spot { file: file.to_owned(), place: None };
            errors.push(spot.error(
                MistakeKind::More,
                format!("{}, not listed", count_with_noun(self.more, "more mistake", "more mistakes")),
            ));
        }
        Err(InputErrors(errors))
    }
}

impl Extend<InputError> for MistakeList {
    fn extend<T: IntoIterator<Item = InputError>>(&mut self, errors: T) {
        errors.into_iter().for_each(|error| self.push(error));
    }
}

/// All mistakes of an input file sorted by location, at least one. Only the first of very many are listed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, thiserror::Error)]
#[error("{}", paragraphs(.0))]
#[serde(transparent)]
pub struct InputErrors(pub Vec<InputError>);

impl InputErrors {
    /// Returns all mistakes sorted by location as an error, if there are any.
    ///
    /// # Errors
    /// If there is any mistake.
    pub fn ok_if_empty(mut errors: Vec<InputError>) -> Result<(), InputErrors> {
        if errors.is_empty() {
            return Ok(());
        }
        errors.sort_by_key(|error| error.place.is_none());
        errors.sort_by_key(|error| error.place);
        // Mistakes without a location come last.
        let placeless = errors.partition_point(|error| error.place.is_none());
        errors.rotate_left(placeless);
        Err(InputErrors(errors))
    }
}

impl From<InputError> for InputErrors {
    fn from(error: InputError) -> Self {
        InputErrors(vec![error])
    }
}

fn paragraphs(errors: &[InputError]) -> String {
    let all: Vec<String> = errors.iter().map(ToString::to_string).collect();
    match all.len() {
        1 => all.concat(),
        count => {
            let more = errors.iter().any(|error| error.reason == MistakeKind::More);
            let count = if more { format!("more than {}", count - 1) } else { count.to_string() };
            let file = &errors[0].file;
            let is_one = errors.iter().all(|error| error.file == *file);
            let place = if is_one { format!(" in {}", quoted::quoted(file)) } else { String::new() };
            format!("{count} mistakes{place}\n\n{}\n", all.join("\n\n"))
        }
    }
}

/// Source of a value, for errors.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spot {
    /// File, preset, or option of the command line.
    pub file: String,
    /// Location in the file.
    pub place: Option<TextLocation>,
}

impl Spot {
    /// Mistake at this location.
    pub fn error(&self, reason: MistakeKind, message: impl Into<String>) -> InputError {
        InputError {
            file: self.file.clone(),
            place: self.place,
            reason,
            message: message.into(),
            expected: None,
            suggestion: None,
        }
    }
}
