//! Particles that were thrown out of the box: who, when, where.

use crate::io::checkpoint::Column;
use crate::method::restored::find_counts;
use std::collections::BTreeSet;

/// The columns of `events.csv`.
pub(super) const COLUMNS: &str = "loss,time,particle,step,x,y";

const NAMES: [&str; 2] = ["lost.id", "lost.step"];

/// Particles lost so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Losses {
    /// Id and step of each, in the order in which they were lost.
    all: Vec<(u32, u64)>,
    /// Rows not yet taken, where they are asked for.
    rows: Option<String>,
}

impl Losses {
    /// None yet; `logs` whether a row is kept of each until it is taken.
    pub(super) fn new(logs: bool) -> Losses {
        Losses { all: vec![], rows: logs.then(String::new) }
    }

    /// How many.
    pub(super) fn count(&self) -> u64 {
        self.all.len() as u64
    }

    /// Whether a particle is lost.
    pub(super) fn ids(&self) -> impl Iterator<Item = u32> {
        self.all.iter().map(|&(id, _)| id)
    }

    /// One more, last seen at a place (length).
    pub(super) fn add(&mut self, id: u32, step: u64, time: f64, [x, y]: [f64; 2]) {
        self.all.push((id, step));
        if let Some(rows) = &mut self.rows {
            rows.push_str(&format!("{},{time:?},{id},{step},{x:?},{y:?}\n", self.all.len()));
        }
    }

    /// The rows since this was last asked.
    pub(super) fn take_rows(&mut self) -> String {
        self.rows.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// For a checkpoint.
    pub(super) fn columns(&self) -> [(String, Column); 2] {
        let ids = self.all.iter().map(|&(id, _)| id.into()).collect();
        let steps = self.all.iter().map(|&(_, step)| step).collect();
        [(NAMES[0].to_owned(), Column::U64(ids)), (NAMES[1].to_owned(), Column::U64(steps))]
    }

    /// Takes up what [`columns`](Self::columns) gave after so many steps of particles of these ids.
    ///
    /// # Errors
    /// A sentence, if it is not there, or of other particles or later steps.
    pub(super) fn take_up(
        &mut self,
        steps: u64,
        there: &BTreeSet<u32>,
        columns: &[(String, Column)],
    ) -> Result<(), String> {
        let count = columns.iter().find(|(name, _)| name == NAMES[0]).map_or(0, |(_, column)| column.len());
        let ids = find_counts(columns, NAMES[0], count, u32::MAX.into())?;
        let steps = find_counts(columns, NAMES[1], count, steps)?;
        let ids: Vec<u32> = ids.iter().map(|&id| id as u32).collect();
        let lost: BTreeSet<u32> = ids.iter().copied().collect();
        if lost.len() < count || !lost.is_subset(there) || count > 0 && lost.len() == there.len() {
            return Err(format!("the column {} holds what are no particles, or one twice, or all", NAMES[0]));
        }
        self.all = ids.into_iter().zip(steps.iter().copied()).collect();
        Ok(())
    }
}
