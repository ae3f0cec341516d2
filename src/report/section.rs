//! One item of a reproduction, before it is known on which kind of page it will be read.

use super::Table;
use super::figure::Figure;
use crate::claims::{self, Judged};
use crate::provenance::Provenance;
use serde::{Deserialize, Serialize};

/// One item of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The item's name on the command line, and of its folder.
    pub name: String,
    /// What it is.
    pub title: String,
    /// Which chapter of the report it belongs to.
    pub(crate) chapter: Chapter,
    /// What is asked.
    pub question: String,
    /// What is expected, and who says so: a source, theory, or our own aim.
    pub expected: String,
    /// What came out, in one sentence with its number.
    pub answer: String,
    /// What else a reader must know, a paragraph each.
    pub(crate) details: Vec<String>,
    /// Pictures.
    pub figures: Vec<Figure>,
    pub(crate) tables: Vec<Table>,
    /// Some lines of a program's text, with a line that says what they are.
    pub(crate) excerpt: Option<(String, String)>,
    /// Moving pictures.
    pub(crate) film: Option<Film>,
    /// Seeds of the random numbers.
    pub seeds: Vec<u64>,
    /// Place among the results of the page's first screen; none if it is not among them.
    pub(crate) front: Option<u8>,
    /// Whether anything in it depends on the host (times), and is therefore not the same everywhere.
    pub(crate) depends_on_host: bool,
    /// Claims of sources and aims of ours that it answers.
    pub claims: Vec<JudgedClaim>,
    /// How and where it was made; known once it is written. No author of a section says it.
    pub provenance: Option<Provenance>,
}

impl Section {
    /// A section that has only its name and title so far.
    pub fn new(name: &str, title: impl Into<String>) -> Section {
        Section {
            name: name.to_owned(),
            title: title.into(),
            chapter: Chapter::Beyond,
            question: String::new(),
            expected: String::new(),
            answer: String::new(),
            details: vec![],
            figures: vec![],
            tables: vec![],
            excerpt: None,
            film: None,
            seeds: vec![],
            front: None,
            depends_on_host: false,
            claims: vec![],
            provenance: None,
        }
    }

    /// The command that makes it again: of an item of the report that alone, of a study the whole command.
    pub(crate) fn again(&self) -> String {
        match &self.provenance {
            Some(made) if !made.is_of_the_report() => made.command.clone(),
            made => {
                let is_all =
                    made.as_ref().is_some_and(|it| it.command.split(' ').any(|word| word == "--all"));
                format!("stripmine reproduce{} --only {}", if is_all { " --all" } else { "" }, self.name)
            }
        }
    }

    /// The folder of its files, relative to the page: what depends on the host lies apart.
    pub fn folder(&self) -> String {
        let [everywhere, here] = Section::folders(&self.name);
        if self.depends_on_host { here } else { everywhere }
    }

    /// Counts its claims by verdict, in words.
    pub fn outcome(&self) -> String {
        let counts = self.counts().map(|(verdict, count)| format!("{count} {}", verdict.words()));
        let counts: Vec<String> = counts.collect();
        let counts = if counts.is_empty() { "no claim".to_owned() } else { counts.join(", ") };
        if self.is_stale() { format!("{counts}; stale") } else { counts }
    }

    /// Returns whether kernels or physics have changed since its results were made.
    pub(crate) fn is_stale(&self) -> bool {
        self.provenance.as_ref().is_some_and(Provenance::is_stale)
    }

    /// The verdicts of its claims, with how many have each.
    pub fn counts(&self) -> impl Iterator<Item = (claims::Verdict, usize)> {
        let count = |verdict: claims::Verdict| {
            self.claims.iter().filter(|claim| claim.verdict == verdict.words()).count()
        };
        let counts = claims::Verdict::ALL.into_iter().map(move |verdict| (verdict, count(verdict)));
        counts.filter(|(_, count)| *count > 0)
    }

    /// The answer and what else there is to know, a paragraph each.
    pub fn paragraphs(&self) -> impl Iterator<Item = &str> {
        std::iter::once(&self.answer).chain(&self.details).map(String::as_str)
    }

    /// The folder of an item that is the same everywhere, and of one that depends on the host.
    pub(crate) fn folders(name: &str) -> [String; 2] {
        [name.to_owned(), format!("host/{name}")]
    }
}

/// A chapter of the report. Items stand in the order of the chapters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Chapter {
    /// Tables, figures and claims of the sources.
    Sources,
    /// What the sources do not ask.
    Beyond,
    /// Times on the host of the report that no source has.
    Host,
}

impl Chapter {
    /// All, in the order of the report.
    pub(crate) const ALL: [Chapter; 3] = [Chapter::Sources, Chapter::Beyond, Chapter::Host];

    /// Its heading.
    pub(crate) const fn title(self) -> &'static str {
        match self {
            Chapter::Sources => "What the sources contain",
            Chapter::Beyond => "Beyond the sources",
            Chapter::Host => "This host",
        }
    }
}

/// A claim with its verdict, for a reader.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedClaim {
    /// Name.
    pub id: String,
    /// Source and place in it.
    pub place: [String; 2],
    /// Statement.
    pub text: String,
    /// Expectation.
    pub expected: String,
    /// Value of the result.
    pub value: String,
    pub verdict: String,
    /// Reference and note.
    pub(crate) notes: Vec<String>,
}

impl From<&Judged<'_>> for JudgedClaim {
    fn from(judged: &Judged<'_>) -> JudgedClaim {
        let Judged { claim, verdict, value, is_too_new } = judged;
        let late =
            is_too_new.then(|| format!("The limit of {} is newer than the result.", claim.limit.since));
        JudgedClaim {
            id: claim.id.clone(),
            place: [claim.source.name().to_owned(), claim.place.clone()],
            text: claim.text.clone(),
            expected: judged.expected(),
            value: value.clone(),
            verdict: verdict.words().to_owned(),
            notes: [claim.reference.clone(), claim.note.clone(), late].into_iter().flatten().collect(),
        }
    }
}

/// Discs that move, frame by frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Film {
    /// What it shows.
    pub title: String,
    /// The units of lengths and of times.
    pub units: [String; 2],
    /// Lower left and upper right corner of what is shown (length).
    pub window: [[f64; 2]; 2],
    /// The sides of the box that are seen.
    pub sides: Vec<Side>,
    /// Whether gravity pulls along a long window, the way in which it is read.
    pub(crate) falls: bool,
    /// Radii of the discs that move (length), in the order of every frame's discs.
    pub radii: Vec<f64>,
    /// Centre and radius of the discs that do not move (length).
    pub(crate) fixed: Vec<([f64; 2], f64)>,
    /// The frames by increasing time.
    pub frames: Vec<Frame>,
    /// What the shade of a disc says, with its unit.
    pub(crate) shade: String,
    /// Lowest and highest shade.
    pub(crate) shades: [f64; 2],
}

/// A side of a box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Side {
    /// Its ends (length).
    pub ends: [[f64; 2]; 2],
    /// Whether what leaves here comes in at the other side.
    pub(crate) is_periodic: bool,
}

/// A moment of a [`Film`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Frame {
    /// When (time).
    pub time: f64,
    /// Centre and shade of every moving disc; the shade is no number where it says nothing, the centre where there is no disc.
    pub discs: Vec<([f64; 2], f64)>,
}
