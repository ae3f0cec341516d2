//! Periods that discs have crossed: the information lost when positions are wrapped into the box.

use super::real_column;
use crate::domain::Domain;
use crate::io::checkpoint::CheckpointColumn;
use crate::method::restored::find_column;

/// Number of periods each disc has crossed along x and y since the start, by its number in the scene. Counts are whole numbers, stored as doubles as
/// in checkpoints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Crossings {
    followed: [bool; 2],
    counts: Vec<[f64; 2]>,
}

/// Column names of the counts in a checkpoint.
const CROSSINGS: [&str; 2] = ["crossings.x", "crossings.y"];

impl Crossings {
    /// Zero counts of `discs` discs along the counted axes.
    pub fn new(followed: [bool; 2], discs: usize) -> Self {
        let counts = if followed.contains(&true) { vec![[0.0; 2]; discs] } else { vec![] };
        Crossings { followed, counts }
    }

    /// Counts these axes from now on, too.
    pub(crate) fn follow(&mut self, followed: [bool; 2], discs: usize) {
        self.followed = [0, 1].map(|axis| self.followed[axis] || followed[axis]);
        if self.is_followed() {
            self.counts.resize(discs, [0.0; 2]);
        }
    }

    /// True if any axis is counted.
    pub(crate) fn is_followed(&self) -> bool {
        self.followed.contains(&true)
    }

    /// Adds the periods by which a disc was moved back when it was wrapped.
    pub fn add(&mut self, number: usize, periods: [f64; 2]) {
        for axis in (0..2).filter(|&axis| self.followed[axis]) {
            self.counts[number][axis] += periods[axis];
        }
    }

    /// True if a box has a periodic side and all of them are counted.
    pub(crate) fn follows(&self, domain: &Domain) -> bool {
        let periodic = domain.periodic();
        periodic.contains(&true) && (0..2).all(|axis| self.followed[axis] || !periodic[axis])
    }

    /// Returns the periods that a disc has crossed along x and y relative to its image inside the box; `place` is consistent with the counts
    /// (length).
    pub(crate) fn image(&self, domain: &Domain, number: usize, place: [f64; 2]) -> [i32; 2] {
        let (crossed, beyond) = (self.counts[number], domain.periods(place));
        [0, 1].map(|axis| (crossed[axis] + beyond[axis]) as i32)
    }

    /// Returns the counts; empty if none are kept.
    pub fn counts(&self) -> &[[f64; 2]] {
        &self.counts
    }

    /// Returns the counts along each axis by name, for a checkpoint.
    pub fn columns(&self) -> impl Iterator<Item = (String, CheckpointColumn)> {
        let axes = (0..2).filter(|_| self.is_followed());
        axes.map(|axis| {
            (CROSSINGS[axis].to_owned(), real_column(self.counts.iter().map(move |count| count[axis])))
        })
    }

    /// Returns the counts among the columns of a checkpoint.
    pub fn among(
        columns: &[(String, CheckpointColumn)],
    ) -> impl Iterator<Item = &(String, CheckpointColumn)> {
        columns.iter().filter(|(name, _)| CROSSINGS.contains(&name.as_str()))
    }

    /// Adds counts of 0 to the columns of a run without counts.
    pub(crate) fn begin_in(columns: &mut Vec<(String, CheckpointColumn)>, discs: usize) {
        for name in CROSSINGS {
            if !columns.iter().any(|(there, _)| there == name) {
                columns.push((name.to_owned(), CheckpointColumn::F64(vec![0.0; discs])));
            }
        }
    }

    /// Restores what [`columns`](Self::columns) returned.
    ///
    /// # Errors
    /// Says which column is missing, has the wrong length, or holds a value that is not a count.
    pub fn restore_counts(&mut self, columns: &[(String, CheckpointColumn)]) -> Result<(), String> {
        let axes = if self.is_followed() { 0..2 } else { 0..0 };
        for axis in axes {
            let column = find_column::<f64>(columns, CROSSINGS[axis], self.counts.len())?;
            // Above this bound every double is a whole number.
            let is_count = |count: &f64| count.fract() == 0.0 && count.abs() <= 2f64.powi(53);
            if let Some(count) = column.iter().find(|count| !is_count(count)) {
                return Err(format!("the column {} holds {count:?}, not a count", CROSSINGS[axis]));
            }
            self.counts.iter_mut().zip(column).for_each(|(count, value)| count[axis] = value);
        }
        Ok(())
    }
}
