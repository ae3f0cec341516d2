//! Periods that discs have crossed: what is lost when a position is wrapped into the box.

use super::real_column;
use crate::domain::Domain;
use crate::io::checkpoint::Column;
use crate::method::restored::find_column;

/// How many periods each disc has moved along x and y since the start, by its number in the scene. Counts are whole; they
/// are kept as the numbers that a checkpoint holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Crossings {
    followed: [bool; 2],
    counts: Vec<[f64; 2]>,
}

/// The names of the counts in a checkpoint.
const CROSSINGS: [&str; 2] = ["crossings.x", "crossings.y"];

impl Crossings {
    /// None yet, of `discs` discs along the axes that are followed.
    pub fn new(followed: [bool; 2], discs: usize) -> Self {
        let counts = if followed.contains(&true) { vec![[0.0; 2]; discs] } else { vec![] };
        Crossings { followed, counts }
    }

    /// Whether there is anything to follow.
    pub(crate) fn is_followed(&self) -> bool {
        self.followed.contains(&true)
    }

    /// A disc was moved back by this many periods when it was wrapped.
    pub fn add(&mut self, number: usize, periods: [f64; 2]) {
        for axis in (0..2).filter(|&axis| self.followed[axis]) {
            self.counts[number][axis] += periods[axis];
        }
    }

    /// Whether every periodic side of a box is followed, and there is one.
    pub(crate) fn follows(&self, domain: &Domain) -> bool {
        let periodic = domain.periodic();
        periodic.contains(&true) && (0..2).all(|axis| self.followed[axis] || !periodic[axis])
    }

    /// How many periods a disc has moved along x and y, as of its image inside the box; `place` is as of the counts (length).
    pub(crate) fn image(&self, domain: &Domain, number: usize, place: [f64; 2]) -> [i32; 2] {
        let (crossed, beyond) = (self.counts[number], domain.periods(place));
        [0, 1].map(|axis| (crossed[axis] + beyond[axis]) as i32)
    }

    /// The counts, empty where nothing is followed.
    pub fn counts(&self) -> &[[f64; 2]] {
        &self.counts
    }

    /// The counts along each axis by name, for a checkpoint.
    pub fn columns(&self) -> impl Iterator<Item = (String, Column)> {
        let axes = (0..2).filter(|_| self.is_followed());
        axes.map(|axis| {
            (CROSSINGS[axis].to_owned(), real_column(self.counts.iter().map(move |count| count[axis])))
        })
    }

    /// The counts among the columns of a checkpoint.
    pub fn among(columns: &[(String, Column)]) -> impl Iterator<Item = &(String, Column)> {
        columns.iter().filter(|(name, _)| CROSSINGS.contains(&name.as_str()))
    }

    /// Adds counts of 0 to columns that have none: of a run in which nothing was followed.
    pub(crate) fn begin_in(columns: &mut Vec<(String, Column)>, discs: usize) {
        for name in CROSSINGS {
            if !columns.iter().any(|(there, _)| there == name) {
                columns.push((name.to_owned(), Column::F64(vec![0.0; discs])));
            }
        }
    }

    /// Takes up what [`columns`](Self::columns) gave.
    ///
    /// # Errors
    /// A sentence, if a column is missing, has not an entry for every disc, or one that is no count.
    pub fn take_up(&mut self, columns: &[(String, Column)]) -> Result<(), String> {
        let axes = if self.is_followed() { 0..2 } else { 0..0 };
        for axis in axes {
            let column = find_column::<f64>(columns, CROSSINGS[axis], self.counts.len())?;
            // Above this bound numbers are whole whether they count or not.
            let is_count = |count: &f64| count.fract() == 0.0 && count.abs() <= 2f64.powi(53);
            if let Some(count) = column.iter().find(|count| !is_count(count)) {
                return Err(format!("the column {} holds {count:?}, no count", CROSSINGS[axis]));
            }
            self.counts.iter_mut().zip(column).for_each(|(count, value)| count[axis] = value);
        }
        Ok(())
    }
}
