//! Items of a report, independent of the format of the page.

use super::FormattedTable;
use super::figure::Figure;
use crate::claims::{self, ClaimJudgement};
use crate::provenance::Provenance;
use serde::{Deserialize, Serialize};

/// Item of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Name of the item on the command line, and of its folder.
    pub name: String,
    /// Heading of the item.
    pub title: String,
    /// Chapter of the report.
    pub(crate) chapter: Chapter,
    /// Question that the item answers.
    pub question: String,
    /// Expectation and its origin: a paper, theory, or our own aim.
    pub expected: String,
    /// Result, in one sentence with its number.
    pub answer: String,
    /// Further paragraphs.
    pub(crate) details: Vec<String>,
    /// Figures of the item.
    pub figures: Vec<Figure>,
    pub(crate) tables: Vec<FormattedTable>,
    /// Caption and lines of a program listing.
    pub(crate) excerpt: Option<(String, String)>,
    /// Film of the item.
    pub(crate) film: Option<Film>,
    /// Seeds of the random numbers.
    pub seeds: Vec<u64>,
    /// Rank among the results of the page's first screen; `None` if not shown there.
    pub(crate) front: Option<u8>,
    /// True if anything in it, such as times, depends on the host.
    pub(crate) depends_on_host: bool,
    /// Judged claims of the papers and of our own aims.
    pub claims: Vec<JudgedClaim>,
    /// Command, host and time of the measurement; known once the item is written.
    pub provenance: Option<Provenance>,
}

impl Section {
    /// Makes a section with a name and a title only.
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

    /// Command that reproduces the item: `reproduce` for an item of the report, the original command for a study.
    pub(crate) fn reproduce_command(&self) -> String {
        match &self.provenance {
            Some(made) if !made.is_from_reproduce() => made.command.clone(),
            made => {
                let is_all =
                    made.as_ref().is_some_and(|it| it.command.split(' ').any(|word| word == "--all"));
                format!("stripmine reproduce{} --only {}", if is_all { " --all" } else { "" }, self.name)
            }
        }
    }

    /// Folder of the files, relative to the page. Results that depend on the host have a separate folder.
    pub fn folder(&self) -> String {
        let [everywhere, here] = Section::folders(&self.name);
        if self.depends_on_host { here } else { everywhere }
    }

    /// Number of claims by verdict, as text.
    pub fn claim_summary(&self) -> String {
        let counts = self.counts().map(|(verdict, count)| format!("{count} {}", verdict.words()));
        let counts: Vec<String> = counts.collect();
        let counts = if counts.is_empty() { "no claim".to_owned() } else { counts.join(", ") };
        if self.is_stale() { format!("{counts}; stale") } else { counts }
    }

    /// Returns true if kernels or physics have changed since the results were made.
    pub(crate) fn is_stale(&self) -> bool {
        self.provenance.as_ref().is_some_and(Provenance::is_stale)
    }

    /// Number of claims for each verdict that occurs.
    pub fn counts(&self) -> impl Iterator<Item = (claims::ClaimVerdict, usize)> {
        let count = |verdict: claims::ClaimVerdict| {
            self.claims.iter().filter(|claim| claim.verdict == verdict.words()).count()
        };
        let counts = claims::ClaimVerdict::ALL.into_iter().map(move |verdict| (verdict, count(verdict)));
        counts.filter(|(_, count)| *count > 0)
    }

    /// All paragraphs, beginning with the answer.
    pub fn paragraphs(&self) -> impl Iterator<Item = &str> {
        std::iter::once(&self.answer).chain(&self.details).map(String::as_str)
    }

    /// Folders of an item: if it is the same on every host, and if it depends on the host.
    pub(crate) fn folders(name: &str) -> [String; 2] {
        [name.to_owned(), format!("host/{name}")]
    }
}

/// Chapter of the report. Items are listed in the order of the chapters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Chapter {
    /// Tables, figures and claims of the papers.
    Sources,
    /// Questions beyond the papers.
    Beyond,
    /// Times on the host of the report, without a counterpart in the papers.
    Host,
}

impl Chapter {
    /// All chapters in the order of the report.
    pub(crate) const ALL: [Chapter; 3] = [Chapter::Sources, Chapter::Beyond, Chapter::Host];

    /// Heading of the chapter.
    pub(crate) const fn title(self) -> &'static str {
        match self {
            Chapter::Sources => "Reproduction of the papers",
            Chapter::Beyond => "Beyond the papers",
            Chapter::Host => "Measurements on this host",
        }
    }
}

/// Claim with its verdict, as text.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedClaim {
    /// Identifier of the claim.
    pub id: String,
    /// Paper and location in it.
    pub place: [String; 2],
    /// Statement of the claim.
    pub text: String,
    /// Expected value or limit.
    pub expected: String,
    /// Measured value.
    pub value: String,
    pub verdict: String,
    /// Reference and note.
    pub(crate) notes: Vec<String>,
}

impl From<&ClaimJudgement<'_>> for JudgedClaim {
    fn from(judged: &ClaimJudgement<'_>) -> JudgedClaim {
        let ClaimJudgement { claim, verdict, value, is_too_new } = judged;
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

/// Film of moving discs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Film {
    /// Title of the film.
    pub title: String,
    /// Units of length and of time.
    pub units: [String; 2],
    /// Lower left and upper right corner of the visible part (length).
    pub window: [[f64; 2]; 2],
    /// Visible sides of the box.
    pub sides: Vec<FilmSide>,
    /// True if gravity points along a long window, in reading direction.
    pub(crate) falls: bool,
    /// Radii of the moving discs (length), in the order of the discs of every frame.
    pub radii: Vec<f64>,
    /// Centre and radius of the fixed discs (length).
    pub(crate) fixed: Vec<([f64; 2], f64)>,
    /// Frames by increasing time.
    pub frames: Vec<FilmFrame>,
    /// Quantity shown by the shade of a disc, with its unit.
    pub(crate) shade: String,
    /// Lowest and highest shade.
    pub(crate) shades: [f64; 2],
}

/// Side of a box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FilmSide {
    /// End points (length).
    pub ends: [[f64; 2]; 2],
    /// True if discs that leave here re-enter at the opposite side.
    pub(crate) is_periodic: bool,
}

/// Frame of a [`Film`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FilmFrame {
    /// Time of the frame.
    pub time: f64,
    /// Ends of the plane walls that move (length).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) walls: Vec<[[f64; 2]; 2]>,
    /// Centre and shade of every moving disc. A NaN shade has no meaning; a NaN centre means that the disc is absent.
    pub discs: Vec<([f64; 2], f64)>,
}
