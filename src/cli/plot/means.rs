//! Means on the charts of observables: a ribbon after the transient, and a band over the transient.

use crate::cli::display::{mean_or_reason, reasons};
use crate::report::figure::{ChartBand, Series, Style};
use stripmine_physics::averages::{Average, AverageOutcome, AveragedRows, Estimate, RunAverages};
use stripmine_physics::method::{Methods, QuantityKind, observed_quantities};
use stripmine_physics::number::{significant, with_error_bar};

/// Legend of the ribbons.
pub(super) const RIBBON: &str = "mean ± 95 %, after the transient";
/// Legend of the time before all ribbons.
pub(super) const BEFORE: &str = "transient, excluded from the mean";

/// Means of a run, as in `average` and `summary.json`.
pub(super) struct ColumnMeans {
    averages: Vec<Average>,
    /// Times of the first and the last row.
    ends: [f64; 2],
}

impl ColumnMeans {
    /// Means of the rows of a table whose first column is the step; none if no method has these columns.
    pub(super) fn of(columns: &[String], rows: &[Vec<f64>], methods: Methods) -> Option<ColumnMeans> {
        let quantities = observed_quantities(methods, columns)?;
        let mut all = AveragedRows::new(quantities);
        rows.iter().for_each(|row| all.add(&row[1..]));
        let time = 1 + quantities.iter().position(|it| it.kind == QuantityKind::Time)?;
        let ends = [rows.first()?[time], rows.last()?[time]];
        Some(ColumnMeans { averages: RunAverages::of(&all).quantities, ends })
    }

    fn of_column(&self, name: &str) -> Option<&Average> {
        self.averages.iter().find(|average| average.quantity == name)
    }

    /// Mean of a column's values; none without a mean, or if it is a rate.
    fn mean_estimate(&self, name: &str) -> Option<&Estimate> {
        match self.of_column(name)? {
            Average { of: "rate", .. } => None,
            Average { outcome: AverageOutcome::Mean(estimate), .. } => Some(estimate),
            _ => None,
        }
    }

    /// Ribbons of some columns, each with the hue of its curve.
    pub(super) fn ribbons(&self, names: &[&str]) -> Vec<Series> {
        let estimates =
            names.iter().enumerate().filter_map(|(hue, name)| Some((hue, self.mean_estimate(name)?)));
        let ribbon = |(place, (hue, it)): (usize, (usize, &Estimate))| {
            let spread = [it.mean - it.bar, it.mean + it.bar];
            let points = [it.equilibrated_at, self.ends[1]].map(|time| (time, it.mean, spread));
            // All ribbons share one entry of the legend.
            Series::new(if place == 0 { RIBBON } else { "" }, Style::Ribbon, hue, points)
        };
        estimates.enumerate().map(ribbon).collect()
    }

    /// Band over the time before every mean of some columns; none if a mean begins at the start.
    pub(super) fn transient_band(&self, names: &[&str]) -> Option<ChartBand> {
        let cuts = names.iter().filter_map(|name| Some(self.mean_estimate(name)?.equilibrated_at));
        let first = cuts.reduce(f64::min)?;
        (first > self.ends[0]).then(|| ChartBand::of_x(BEFORE, [self.ends[0], first]))
    }

    /// Mean of a column with its error, or one or two words on why there is none.
    pub(super) fn brief_text(&self, name: &str) -> String {
        self.of_column(name).map_or_else(String::new, mean_or_reason)
    }

    /// Explanations of the words of [`brief_text`](Self::brief_text) for some columns.
    pub(super) fn reasons(&self, names: &[&str]) -> Vec<&'static str> {
        reasons(self.averages.iter().filter(|average| names.contains(&average.quantity)))
    }

    /// Short description of a column's mean.
    pub(super) fn mean_text(&self, name: &str) -> Option<String> {
        let average = self.of_column(name)?;
        let rate = if average.of == "rate" { "rate " } else { "" };
        // Non-breaking blanks keep a mean and its error bar on one line.
        let whole = |text: String| text.replace(' ', "\u{a0}");
        Some(match &average.outcome {
            AverageOutcome::Mean(Estimate { mean, bar, .. }) => {
                format!("{rate}{}", whole(with_error_bar(*mean, *bar)))
            }
            AverageOutcome::Constant { mean } => format!("{rate}always {}", significant(*mean, 6)),
            AverageOutcome::TooShort { enough_at, .. } => {
                format!("run too short for a mean, needs time {}", significant(*enough_at, 2))
            }
            AverageOutcome::Changing { .. } => "still changing, no mean".to_owned(),
            AverageOutcome::Undefined => "undefined in some rows, no mean".to_owned(),
            AverageOutcome::Kept { .. } => return None,
        })
    }
}
