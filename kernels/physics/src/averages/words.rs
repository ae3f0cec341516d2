//! Averages as text of a few lines.

use super::{Average, AverageOutcome, Estimate, RunAverages};
use crate::number::{count_with_noun, significant, with_error_bar};
use std::collections::BTreeMap;
use std::fmt;

/// Formats a line for each mean, then the reasons why others have none. Zero rates and conserved quantities are omitted.
impl fmt::Display for RunAverages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of_runs = if self.runs > 1 { format!(" over {} runs", self.runs) } else { String::new() };
        let mut is_first = true;
        let mut constants = vec![];
        let mut changing = vec![];
        let mut undefined = vec![];
        let mut short: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        for average in &self.quantities {
            let name = average.quantity;
            match &average.outcome {
                AverageOutcome::Mean(estimate) => {
                    if std::mem::take(&mut is_first) {
                        writeln!(f, "means{of_runs}, ± 95 % (Student's t):")?;
                    }
                    writeln!(f, "  {}", line(average, estimate))?;
                }
                AverageOutcome::Constant { mean } if *mean != 0.0 => {
                    constants.push(format!("{name} {}", significant(*mean, 6)));
                }
                AverageOutcome::Changing { .. } => changing.push(name),
                AverageOutcome::Undefined => undefined.push(name),
                AverageOutcome::TooShort { enough_at, .. } => {
                    short.entry(significant(*enough_at, 2)).or_default().push(name);
                }
                AverageOutcome::Constant { .. } | AverageOutcome::Kept { .. } => {}
            }
        }
        if !constants.is_empty() {
            writeln!(f, "constant: {}", constants.join(", "))?;
        }
        if !changing.is_empty() {
            writeln!(f, "still changing, without a mean: {}", changing.join(", "))?;
        }
        if !undefined.is_empty() {
            writeln!(f, "not defined in some rows, without a mean: {}", undefined.join(", "))?;
        }
        for (enough_at, names) in short {
            writeln!(f, "too short for a mean, until about time {enough_at}: {}", names.join(", "))?;
        }
        Ok(())
    }
}

fn line(average: &Average, estimate: &Estimate) -> String {
    let samples =
        count_with_noun(estimate.independent_samples as u64, "independent sample", "independent samples");
    let name = match average.of {
        "rate" => format!("rate of {}", average.quantity),
        _ => average.quantity.to_owned(),
    };
    let unit = if average.unit.is_empty() { String::new() } else { format!(" {}", average.unit) };
    let value = with_error_bar(estimate.mean, estimate.bar);
    format!("{name} {value}{unit}, {samples} after time {}", significant(estimate.equilibrated_at, 3))
}
