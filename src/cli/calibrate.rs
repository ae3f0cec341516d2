//! `stripmine calibrate`: how long this host's operations take.

use super::{Common, Failure, print, print_json};
use crate::report;
use crate::report::origin::host;
use crate::study::calibration::{Effort, TOO_NOISY, calibrate};
use clap::Args;
use std::path::PathBuf;
use stripmine_kernels::InstructionSet;

/// Measures this host's operations and caches, and writes a host file for validate-model; about a minute
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
        let effort = Effort { sweeps: self.sweeps.into(), ..Effort::default() };
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
        let spread = model.measured.spread;
        if spread > TOO_NOISY && !self.force {
            return Err(Failure::TooNoisy { percent: 100.0 * spread });
        }
        if spread > TOO_NOISY && !common.quiet {
            eprintln!(
                "warning: the median repeat was {:.0} % slower than the best: the machine is busy",
                100.0 * spread
            );
        }
        std::fs::write(&self.out, model.to_toml())
            .map_err(Failure::writing(self.out.display().to_string()))?;
        if !common.quiet {
            eprintln!("written: {}", self.out.display());
        }
        Ok(())
    }
}
