//! One item of a reproduction, before it is known on which kind of page it will be read.

use super::Table;
use super::figure::Figure;
use crate::origin::Provenance;
use serde::{Deserialize, Serialize};

/// One item of the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Section {
    /// The item's name on the command line, and of its folder.
    pub name: String,
    /// What it is.
    pub title: String,
    /// What the source says.
    pub says: String,
    /// What came out.
    pub came_out: String,
    /// Whether the one is the other.
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
    /// Whether anything in it depends on the host (times), and is therefore not the same everywhere.
    pub depends_on_host: bool,
    /// How and where it was made; known once it is written.
    #[serde(skip)]
    pub provenance: Option<Provenance>,
}

impl Section {
    /// The folder of its files, relative to the page: what depends on the host lies apart.
    pub fn folder(&self) -> String {
        let [everywhere, here] = Section::folders(&self.name);
        if self.depends_on_host { here } else { everywhere }
    }

    /// The folder of an item that is the same everywhere, and of one that depends on the host.
    pub fn folders(name: &str) -> [String; 2] {
        [name.to_owned(), format!("host/{name}")]
    }
}

/// What to think of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// What the source says came out.
    Reproduced,
    /// It came out in part, or with differences that are named.
    Partly,
    /// It did not come out.
    Failed,
    /// The source says nothing to compare with.
    Shown,
}

impl Verdict {
    /// As one word.
    pub const fn word(self) -> &'static str {
        match self {
            Verdict::Reproduced => "reproduced",
            Verdict::Partly => "partly reproduced",
            Verdict::Failed => "not reproduced",
            Verdict::Shown => "shown",
        }
    }
}

/// Discs that move, frame by frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Film {
    /// What it shows.
    pub title: String,
    /// Lower left and upper right corner of what is shown (m).
    pub window: [[f64; 2]; 2],
    /// Radii of the discs that move (m), in the order of every frame's discs.
    pub radii: Vec<f64>,
    /// Centre and radius of the discs that do not move (m).
    pub fixed: Vec<([f64; 2], f64)>,
    /// The frames by increasing time.
    pub frames: Vec<Frame>,
    /// What the shade of a disc says, with its unit.
    pub shade: String,
    /// Lowest and highest shade.
    pub shades: [f64; 2],
}

/// A moment of a [`Film`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// When (s).
    pub time: f64,
    /// Centre and shade of every moving disc.
    pub discs: Vec<([f64; 2], f64)>,
}
