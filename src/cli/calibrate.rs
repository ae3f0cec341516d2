//! `stripmine calibrate`: how long this host's operations take.

use super::{Common, Failure, print, print_json};
use crate::model::host::Measured;
use crate::report;
use crate::report::origin::host;
use crate::study::calibration::{Effort, TOO_DIFFERENT, TOO_NOISY, TOO_RARE, calibrate};
use clap::Args;
use std::path::PathBuf;
use stripmine_kernels::InstructionSet;

/// Measures this host's operations and caches, and writes a host file for validate-model; one to two minutes
#[derive(Args)]
pub(super) struct CalibrateVerb {
    /// The host file
    #[arg(long, default_value = "host.toml")]
    out: PathBuf,
    /// Write the file even if the machine was too busy to be measured, or over one that is there
    #[arg(long)]
    force: bool,
    /// Sweeps over all points: more of them find quiet moments
    #[arg(long, default_value_t = Effort::default().sweeps as u16, value_parser = clap::value_parser!(u16).range(1..=100))]
    sweeps: u16,
}

impl CalibrateVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        if self.out.exists() && !self.force {
            return Err(Failure::HostFileExists(self.out.clone()));
        }
        let bar = super::progress(common, "calibrate");
        let effort = Effort { sweeps: self.sweeps.into() };
        let model = calibrate(host(), InstructionSet::best(), effort, |share| {
            bar.set_position((1e3 * share) as u64)
        })?;
        bar.finish_and_clear();
        if common.json {
            print_json(&model)?;
        } else {
            let drawn: Vec<String> =
                report::calibration::tables(&model).iter().map(report::terminal::render).collect();
            print(&drawn.join("\n"))?;
        }
        if let Some(noise) = noise(&model.measured) {
            if !self.force {
                return Err(Failure::TooNoisy(noise));
            }
            eprintln!("warning: {noise}: the machine is busy");
        }
        std::fs::write(&self.out, model.to_toml())
            .map_err(Failure::writing(self.out.display().to_string()))?;
        if !common.quiet {
            eprintln!("written: {}", self.out.display());
        }
        Ok(())
    }
}

/// What shows that the machine was too busy, if it was.
pub(super) fn noise(measured: &Measured) -> Option<String> {
    let Measured { spread, disagreement, pace, quiet, .. } = *measured;
    (spread > TOO_NOISY || disagreement > TOO_DIFFERENT || quiet < TOO_RARE).then(|| {
        format!(
            "half of the samples lie within {:.0} % of the median one, the two halves of the measurement differ by {:.1} %, \
             and {:.0} % of the points were measured in quiet moments: mostly the machine was {pace:.2} times as slow",
            100.0 * spread,
            100.0 * disagreement,
            100.0 * quiet
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_busy_machine_is_told_from_a_quiet_one() {
        let measured = |spread, disagreement, quiet| Measured {
            timer: 20.0,
            yardstick: 3000.0,
            pace: 1.3,
            quiet,
            spread,
            disagreement,
            shortest: 8,
            longest: 100,
            residual: 0.0,
        };
        assert_eq!(noise(&measured(0.05, 0.01, 0.9)), None);
        assert!(noise(&measured(2.0 * TOO_NOISY, 0.01, 0.9)).unwrap().contains("within 20 %"));
        assert!(noise(&measured(0.05, 2.0 * TOO_DIFFERENT, 0.9)).unwrap().contains("differ by 10.0 %"));
        assert!(noise(&measured(0.05, 0.01, 0.5 * TOO_RARE)).unwrap().contains("25 % of the points"));
    }
}
