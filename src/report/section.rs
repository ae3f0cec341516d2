//! One item of a reproduction, before it is known on which kind of page it will be read.

use super::Table;
use super::figure::Figure;
use crate::claims::{self, Judged};
use crate::provenance::Provenance;
use crate::statistics::Claim;
use serde::{Deserialize, Serialize};

/// One item of the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Section {
    /// The item's name on the command line, and of its folder.
    pub name: String,
    /// What it is.
    pub title: String,
    /// Which chapter of the report it belongs to.
    pub chapter: Chapter,
    /// What is asked.
    pub question: String,
    /// What is expected, and who says so: a source, theory, or our own aim.
    pub expected: String,
    /// What came out, in one sentence with its number.
    pub answer: String,
    /// What else a reader must know, a paragraph each.
    pub details: Vec<String>,
    /// What to think of the answer beside what was expected.
    pub verdict: Verdict,
    /// The command that makes it again.
    pub again: String,
    /// Pictures.
    pub figures: Vec<Figure>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Some lines of a program's text, with a line that says what they are.
    pub excerpt: Option<(String, String)>,
    /// Moving pictures.
    pub film: Option<Film>,
    /// Seeds of the random numbers.
    pub seeds: Vec<u64>,
    /// Place among the results of the page's first screen; none if it is not among them.
    #[serde(default)]
    pub front: Option<u8>,
    /// Whether anything in it depends on the host (times), and is therefore not the same everywhere.
    pub depends_on_host: bool,
    /// Claims of sources and aims of ours that it answers.
    #[serde(default)]
    pub claims: Vec<JudgedClaim>,
    /// How and where it was made; known once it is written. No author of a section says it.
    #[serde(skip)]
    pub provenance: Option<Provenance>,
}

/// How a section is put together: its name, then what is asked, expected and answered, then its blocks. Pages order the blocks by
/// their kind.
impl Section {
    /// A section that has only its name so far. `stripmine reproduce` makes it again, unless it says otherwise.
    pub fn new(name: &str, title: impl Into<String>) -> Section {
        Section {
            name: name.to_owned(),
            title: title.into(),
            chapter: Chapter::Beyond,
            question: String::new(),
            expected: String::new(),
            answer: String::new(),
            details: vec![],
            verdict: Verdict::Measured,
            again: format!("stripmine reproduce --only {name}"),
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

    /// What is asked.
    pub fn asks(self, question: impl Into<String>) -> Section {
        Section { question: question.into(), ..self }
    }

    /// What is expected, and who says so.
    pub fn expects(self, expected: impl Into<String>) -> Section {
        Section { expected: expected.into(), ..self }
    }

    /// What came out.
    pub fn answers(self, answer: impl Into<String>) -> Section {
        Section { answer: answer.into(), ..self }
    }

    /// What to think of the answer. Without one it is measured.
    pub fn verdict(self, verdict: Verdict) -> Section {
        Section { verdict, ..self }
    }

    /// The command that makes it again, where this is not `reproduce`.
    pub fn again(self, command: impl Into<String>) -> Section {
        Section { again: command.into(), ..self }
    }

    /// Seeds of its random numbers.
    pub fn seeds(self, seeds: impl IntoIterator<Item = u64>) -> Section {
        Section { seeds: seeds.into_iter().collect(), ..self }
    }

    /// It has times, which are of the host alone.
    pub fn depends_on_host(self) -> Section {
        Section { depends_on_host: true, ..self }
    }

    /// With further paragraphs.
    pub fn details(mut self, paragraphs: impl IntoIterator<Item = impl Into<String>>) -> Section {
        self.details.extend(paragraphs.into_iter().map(Into::into));
        self
    }

    /// With further pictures.
    pub fn figures(mut self, figures: impl IntoIterator<Item = Figure>) -> Section {
        self.figures.extend(figures);
        self
    }

    /// With further tables.
    pub fn tables(mut self, tables: impl IntoIterator<Item = Table>) -> Section {
        self.tables.extend(tables);
        self
    }

    /// With lines of a program's text, after a line that says what they are.
    pub fn excerpt(self, excerpt: Option<(String, String)>) -> Section {
        Section { excerpt, ..self }
    }

    /// With a film.
    pub fn film(self, film: impl Into<Option<Film>>) -> Section {
        Section { film: film.into(), ..self }
    }
}

impl Section {
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
    pub fn is_stale(&self) -> bool {
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
    pub fn folders(name: &str) -> [String; 2] {
        [name.to_owned(), format!("host/{name}")]
    }
}

/// A chapter of the report. Items stand in the order of the chapters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Chapter {
    /// Tables, figures and claims of the sources.
    Sources,
    /// What the sources do not ask.
    Beyond,
    /// Times on the host of the report that no source has.
    Host,
}

impl Chapter {
    /// All, in the order of the report.
    pub const ALL: [Chapter; 3] = [Chapter::Sources, Chapter::Beyond, Chapter::Host];

    /// Its heading.
    pub const fn title(self) -> &'static str {
        match self {
            Chapter::Sources => "What the sources contain",
            Chapter::Beyond => "Beyond the sources",
            Chapter::Host => "This host",
        }
    }
}

/// What to think of an item: the first three where a source or theory is the measure, the next two where an aim of our own is,
/// the last two where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// What the source or theory says came out.
    Reproduced,
    /// It came out in part, or with differences that are named.
    Partly,
    /// It did not come out.
    NotReproduced,
    /// Error bars are too wide to tell.
    Undecided,
    /// Our own aim is met.
    AimMet,
    /// It is missed.
    AimMissed,
    /// There is nothing to compare with: a measurement.
    Measured,
    /// There is nothing to compare with: a count, or what a model says.
    Computed,
}

impl Verdict {
    /// All of them.
    pub const ALL: [Verdict; 8] = [
        Verdict::Reproduced,
        Verdict::Partly,
        Verdict::NotReproduced,
        Verdict::Undecided,
        Verdict::AimMet,
        Verdict::AimMissed,
        Verdict::Measured,
        Verdict::Computed,
    ];

    /// Of a source's or theory's statement that holds, or does not hold in all.
    pub fn reproduced(holds: impl Into<Claim>) -> Verdict {
        match holds.into() {
            Claim::Holds => Verdict::Reproduced,
            Claim::Fails => Verdict::Partly,
            Claim::Open => Verdict::Undecided,
        }
    }

    /// Of several statements of a source or theory, each of which came out or did not, or is open.
    pub fn of_claims<T: Into<Claim> + Copy>(claims: &[T]) -> Verdict {
        let count = |which: Claim| claims.iter().filter(|claim| (**claim).into() == which).count();
        match [count(Claim::Holds), count(Claim::Fails)] {
            [all, _] if all == claims.len() => Verdict::Reproduced,
            [_, all] if all == claims.len() => Verdict::NotReproduced,
            [_, 0] => Verdict::Undecided,
            _ => Verdict::Partly,
        }
    }

    /// Of an aim.
    pub const fn aim(is_met: bool) -> Verdict {
        if is_met { Verdict::AimMet } else { Verdict::AimMissed }
    }

    /// As a word or two.
    pub const fn word(self) -> &'static str {
        match self {
            Verdict::Reproduced => "reproduced",
            Verdict::Partly => "partly reproduced",
            Verdict::NotReproduced => "not reproduced",
            Verdict::Undecided => "undecided",
            Verdict::AimMet => "aim met",
            Verdict::AimMissed => "aim missed",
            Verdict::Measured => "measured",
            Verdict::Computed => "computed",
        }
    }

    /// What it means.
    pub const fn meaning(self) -> &'static str {
        match self {
            Verdict::Reproduced => "what the source or theory says came out, as closely as the item states",
            Verdict::Partly => "it came out in part, or with differences that the item names",
            Verdict::NotReproduced => "it did not come out",
            Verdict::Undecided => "error bars are too wide to tell",
            Verdict::AimMet => "no source says; our own aim, which the item states, is met",
            Verdict::AimMissed => "our own aim, which the item states, is missed",
            Verdict::Measured => "no source and no aim: a measurement",
            Verdict::Computed => "no source and no aim: a count, or what a model says",
        }
    }
}

/// A claim with its verdict, for a reader.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// Verdict.
    pub verdict: String,
    /// Reference and note.
    pub notes: Vec<String>,
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
pub struct Film {
    /// What it shows.
    pub title: String,
    /// The units of lengths and of times.
    pub units: [String; 2],
    /// Lower left and upper right corner of what is shown (length).
    pub window: [[f64; 2]; 2],
    /// The sides of the box that are seen.
    pub sides: Vec<Side>,
    /// Whether gravity pulls along a long window, the way in which it is read.
    pub falls: bool,
    /// Radii of the discs that move (length), in the order of every frame's discs.
    pub radii: Vec<f64>,
    /// Centre and radius of the discs that do not move (length).
    pub fixed: Vec<([f64; 2], f64)>,
    /// The frames by increasing time.
    pub frames: Vec<Frame>,
    /// What the shade of a disc says, with its unit.
    pub shade: String,
    /// Lowest and highest shade.
    pub shades: [f64; 2],
}

/// A side of a box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Side {
    /// Its ends (length).
    pub ends: [[f64; 2]; 2],
    /// Whether what leaves here comes in at the other side.
    pub is_periodic: bool,
}

/// A moment of a [`Film`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// When (time).
    pub time: f64,
    /// Centre and shade of every moving disc; the shade is no number where it says nothing, the centre where there is no disc.
    pub discs: Vec<([f64; 2], f64)>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_is_that_of_its_claims() {
        use Claim::{Fails, Holds, Open};
        assert_eq!(Verdict::of_claims(&[Holds, Holds]), Verdict::Reproduced);
        assert_eq!(Verdict::of_claims(&[Fails, Fails]), Verdict::NotReproduced);
        assert_eq!(Verdict::of_claims(&[Holds, Open]), Verdict::Undecided);
        assert_eq!(Verdict::of_claims(&[Fails, Open]), Verdict::Partly);
        assert_eq!(Verdict::of_claims(&[true, false]), Verdict::Partly);
        assert_eq!(Verdict::reproduced(Open), Verdict::Undecided);
    }
}
