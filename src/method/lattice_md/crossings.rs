//! Periods that discs have crossed: what is lost when a position is wrapped into the box.

/// How many periods each disc has moved along x and y since the start, by its number in the scene. Counts are whole; they
/// are kept as the numbers that a checkpoint holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Crossings {
    followed: [bool; 2],
    counts: Vec<[f64; 2]>,
}

/// The names of the counts in a checkpoint.
pub(super) const CROSSINGS: [&str; 2] = ["crossings.x", "crossings.y"];

impl Crossings {
    /// None yet, of `discs` discs along the axes that are followed.
    pub(super) fn new(followed: [bool; 2], discs: usize) -> Self {
        let counts = if followed.contains(&true) { vec![[0.0; 2]; discs] } else { vec![] };
        Crossings { followed, counts }
    }

    /// Whether there is anything to follow.
    pub(super) fn is_followed(&self) -> bool {
        self.followed.contains(&true)
    }

    /// A disc was moved back by this many periods when it was wrapped.
    pub(super) fn add(&mut self, number: usize, periods: [f64; 2]) {
        for axis in (0..2).filter(|&axis| self.followed[axis]) {
            self.counts[number][axis] += periods[axis];
        }
    }

    /// The counts, empty where nothing is followed.
    pub(super) fn counts(&self) -> &[[f64; 2]] {
        &self.counts
    }

    /// The counts along each axis by name, for a checkpoint.
    pub(super) fn columns(&self) -> Vec<(&'static str, Vec<f64>)> {
        let axes = (0..2).filter(|_| self.is_followed());
        axes.map(|axis| (CROSSINGS[axis], self.counts.iter().map(|count| count[axis]).collect())).collect()
    }

    /// Takes up what [`columns`](Self::columns) gave; `find` gives a column by its name.
    pub(super) fn take_up(
        &mut self,
        find: impl Fn(&'static str) -> Result<Vec<f64>, String>,
    ) -> Result<(), String> {
        let axes = if self.is_followed() { 0..2 } else { 0..0 };
        for axis in axes {
            let column = find(CROSSINGS[axis])?;
            if column.len() != self.counts.len() {
                let (name, found, discs) = (CROSSINGS[axis], column.len(), self.counts.len());
                return Err(format!("the column {name} has {found} entries, not {discs}"));
            }
            self.counts.iter_mut().zip(column).for_each(|(count, value)| count[axis] = value);
        }
        Ok(())
    }
}
