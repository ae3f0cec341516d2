//! Record of the particles lost from the box, with time and position.

use crate::io::checkpoint::CheckpointColumn;
use crate::method::restored::{find_column, find_counts};
use crate::number::significant;
use serde::Serialize;
use std::collections::BTreeSet;

/// Columns of `events.csv`.
pub(super) const COLUMNS: &str = "loss,time,particle,step,x,y";
/// Maximum number of losses listed in `summary.json`, the first ones.
const LISTED: usize = 100;

const NAMES: [&str; 2] = ["lost.id", "lost.step"];
const PLACE: [&str; 2] = ["lost.x", "lost.y"];

/// Lost particle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Loss {
    /// Id of the particle.
    particle: u32,
    /// Step in which it was lost.
    step: u64,
    /// Last known position (length).
    x: f64,
    y: f64,
}

/// All losses so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Losses {
    /// Losses in order of time.
    all: Vec<Loss>,
    /// Rows that have not been taken yet, if logged.
    rows: Option<String>,
}

impl Losses {
    /// Creates an empty record. With `logs`, a row of each loss is kept until it is taken.
    pub(super) fn new(logs: bool) -> Losses {
        Losses { all: vec![], rows: logs.then(String::new) }
    }

    /// Number of losses.
    pub(super) fn count(&self) -> u64 {
        self.all.len() as u64
    }

    /// Ids of the lost particles.
    pub(super) fn ids(&self) -> impl Iterator<Item = u32> {
        self.all.iter().map(|loss| loss.particle)
    }

    /// First losses, for `summary.json`.
    pub(super) fn listed(&self) -> serde_json::Value {
        serde_json::json!(self.all[..self.all.len().min(LISTED)])
    }

    /// Description of the first loss.
    pub(super) fn first_in_words(&self) -> Option<String> {
        let Loss { particle, step, x, y } = self.all.first()?;
        let [x, y] = [x, y].map(|along| significant(*along, 5));
        Some(format!("first particle {particle} in step {step} at ({x}, {y})"))
    }

    /// Adds a loss with the last known position (length).
    pub(super) fn add(&mut self, particle: u32, step: u64, time: f64, [x, y]: [f64; 2]) {
        self.all.push(Loss { particle, step, x, y });
        if let Some(rows) = &mut self.rows {
            rows.push_str(&format!("{},{time:?},{particle},{step},{x:?},{y:?}\n", self.all.len()));
        }
    }

    /// Returns the rows since the last call.
    pub(super) fn take_rows(&mut self) -> String {
        self.rows.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Columns for a checkpoint.
    pub(super) fn columns(&self) -> [(String, CheckpointColumn); 4] {
        let whole = |of: fn(&Loss) -> u64| CheckpointColumn::U64(self.all.iter().map(of).collect());
        let real = |of: fn(&Loss) -> f64| CheckpointColumn::F64(self.all.iter().map(of).collect());
        [
            (NAMES[0].to_owned(), whole(|loss| loss.particle.into())),
            (NAMES[1].to_owned(), whole(|loss| loss.step)),
            (PLACE[0].to_owned(), real(|loss| loss.x)),
            (PLACE[1].to_owned(), real(|loss| loss.y)),
        ]
    }

    /// Restores the columns written by [`columns`](Self::columns) after a number of steps; `there` are the ids of the start.
    ///
    /// # Errors
    /// A message if they are missing, or belong to other particles or later steps.
    pub(super) fn take_up(
        &mut self,
        steps: u64,
        there: &BTreeSet<u32>,
        columns: &[(String, CheckpointColumn)],
    ) -> Result<(), String> {
        let count = columns.iter().find(|(name, _)| name == NAMES[0]).map_or(0, |(_, column)| column.len());
        let ids = find_counts(columns, NAMES[0], count, u32::MAX.into())?;
        let steps = find_counts(columns, NAMES[1], count, steps)?;
        let ids: Vec<u32> = ids.iter().map(|&id| id as u32).collect();
        let lost: BTreeSet<u32> = ids.iter().copied().collect();
        if lost.len() < count || !lost.is_subset(there) || count > 0 && lost.len() == there.len() {
            return Err(format!(
                "the column {} holds unknown or repeated ids, or those of all particles",
                NAMES[0]
            ));
        }
        let along = |name: &str| find_column::<f64>(columns, name, ids.len());
        let places = along(PLACE[0])?.into_iter().zip(along(PLACE[1])?);
        let losses = ids.into_iter().zip(steps).zip(places);
        self.all = losses.map(|((particle, &step), (x, y))| Loss { particle, step, x, y }).collect();
        Ok(())
    }
}
