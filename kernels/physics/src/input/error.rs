//! Mistakes of an input file, with their places.

use crate::number::counted;
use crate::quoted;
use serde::Serialize;

/// A place in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Place {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// Kind of a mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Reason {
    /// The scene cannot be found or read.
    Unreadable,
    /// Not TOML.
    Syntax,
    /// The system does not let the file be read.
    System,
    /// A format version that this program does not read.
    Format,
    /// No such section or key.
    Unknown,
    /// A value of the wrong type, or a word that is not among the choices.
    Type,
    /// A number out of its range.
    Range,
    /// A key that must be given is not.
    Missing,
    /// A key that means nothing beside the other choices of the scene.
    Unused,
    /// Keys that cannot hold together.
    Contradiction,
    /// An override that is no `section.key=value`.
    Override,
    /// A file that the scene names cannot be read, or its content is wrong.
    StartFile,
    /// More discs than random placement finds room for.
    Placement,
    /// Discs that overlap at the start deeper than the scene allows.
    Overlap,
    /// A disc outside the domain.
    Outside,
    /// No lattice serves the discs.
    Geometry,
    /// A time step at which the integrator is unstable.
    Stability,
    /// A run that needs more memory than this machine has.
    Memory,
    /// Mistakes beyond those that are named.
    More,
}

/// A mistake of an input file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, thiserror::Error)]
#[error("{}", paragraph(self))]
pub struct InputError {
    /// The file, the preset, or the option of the command line.
    pub file: String,
    /// Where in the file; nothing where no single place is wrong.
    pub place: Option<Place>,
    /// Kind.
    pub reason: Reason,
    /// What is wrong, with the numbers.
    pub message: String,
    /// What should stand there.
    pub expected: Option<String>,
    /// What to do about it.
    pub suggestion: Option<String>,
}

fn paragraph(error: &InputError) -> String {
    let mut text = quoted::quoted(&error.file);
    if let Some(Place { line, column }) = error.place {
        text.push_str(&format!(":{line}:{column}"));
    }
    text.push_str(&format!(": {}", quoted::message(&error.message)));
    for (what, words) in [("expected", &error.expected), ("help", &error.suggestion)] {
        if let Some(words) = words {
            text.push_str(&format!("\n  {what}: {}", quoted::message(words)));
        }
    }
    text
}

impl InputError {
    /// The same, with what should stand there.
    #[must_use]
    pub(crate) fn expecting(self, expected: impl Into<String>) -> Self {
        InputError { expected: Some(expected.into()), ..self }
    }

    /// The same, with what to do about it.
    #[must_use]
    pub fn advising(self, suggestion: impl Into<String>) -> Self {
        InputError { suggestion: Some(suggestion.into()), ..self }
    }
}

/// Mistakes as they are found; names the first ones and counts the rest.
#[derive(Clone, Debug, Default)]
pub struct Mistakes {
    named: Vec<InputError>,
    more: usize,
}

impl Mistakes {
    /// At most as many mistakes are named: a file of another kind may hold millions.
    pub(crate) const NAMED: usize = 50;

    /// Whether a mistake would be named; where not, there is no need to find words for it.
    pub fn has_room(&self) -> bool {
        self.named.len() < Mistakes::NAMED
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

    /// One more, of which nothing is said.
    pub(crate) fn count(&mut self) {
        self.more += 1;
    }

    /// Nothing wrong, or the mistakes of the file.
    ///
    /// # Errors
    /// If there is any mistake.
    pub fn none_of(self, file: &str) -> Result<(), InputErrors> {
        let Err(InputErrors(mut errors)) = InputErrors::none_of(self.named) else { return Ok(()) };
        if self.more > 0 {
            let spot = Spot { file: file.to_owned(), place: None };
            errors.push(spot.error(
                Reason::More,
                format!("{}, not named", counted(self.more, "more mistake", "more mistakes")),
            ));
        }
        Err(InputErrors(errors))
    }
}

impl Extend<InputError> for Mistakes {
    fn extend<T: IntoIterator<Item = InputError>>(&mut self, errors: T) {
        errors.into_iter().for_each(|error| self.push(error));
    }
}

/// Every mistake found in an input file, in the order of their places; at least one. Of very many only the first are named.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, thiserror::Error)]
#[error("{}", paragraphs(.0))]
#[serde(transparent)]
pub struct InputErrors(pub Vec<InputError>);

impl InputErrors {
    /// Nothing wrong, or all mistakes in the order of their places.
    ///
    /// # Errors
    /// If there is any mistake.
    pub fn none_of(mut errors: Vec<InputError>) -> Result<(), InputErrors> {
        if errors.is_empty() {
            return Ok(());
        }
        errors.sort_by_key(|error| error.place.is_none());
        errors.sort_by_key(|error| error.place);
        // Those without a place last.
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
            let more = errors.iter().any(|error| error.reason == Reason::More);
            let count = if more { format!("more than {}", count - 1) } else { count.to_string() };
            let file = &errors[0].file;
            let is_one = errors.iter().all(|error| error.file == *file);
            let place = if is_one { format!(" in {}", quoted::quoted(file)) } else { String::new() };
            format!("{count} mistakes{place}\n\n{}\n", all.join("\n\n"))
        }
    }
}

/// Where a value comes from, to be said in an error.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spot {
    /// The file, the preset, or the option of the command line.
    pub file: String,
    /// Where in the file.
    pub place: Option<Place>,
}

impl Spot {
    /// A mistake at this place.
    pub fn error(&self, reason: Reason, message: impl Into<String>) -> InputError {
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
