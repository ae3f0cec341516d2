//! `stripmine calibrate`: how long this host's operations take.

use crate::console::{Common, Failure, clear_progress, print, print_json, progress, say, warn};
use crate::method::lattice_md::sections;
use crate::method::lattice_md::study::calibration::{Effort, TOO_DIFFERENT, TOO_NOISY, TOO_RARE, calibrate};
use crate::model::host::Measured;
use crate::origin::host;
use crate::report::terminal;
use crate::reported::{Class, FilePlace, Reported};
use crate::signals;
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};
use stripmine_kernels::InstructionSet;
use tempfile::NamedTempFile;

/// Measures this host's operations and caches, and writes a host file for validate-model; one to two minutes
#[derive(Args)]
pub(super) struct CalibrateVerb {
    /// The host file
    #[arg(long, default_value = "host.toml")]
    out: PathBuf,
    /// Write the file even if the machine was too busy to be measured, or over one that is there
    #[arg(long)]
    force: bool,
    /// Sweeps over all points: with more of them, more points are measured undisturbed
    #[arg(long, default_value_t = Effort::default().sweeps as u16, value_parser = clap::value_parser!(u16).range(1..=100))]
    sweeps: u16,
}

/// Why no host file is written.
#[derive(Debug, thiserror::Error)]
enum Refusal {
    /// There is one.
    #[error("{} is there already: --force writes over it, --out elsewhere", .0.display())]
    Exists(PathBuf),
    /// The machine is too busy.
    #[error(
        "{0}: the machine is too busy to be measured; nothing is written, try again when it is quiet, with more \
         --sweeps, or --force"
    )]
    TooNoisy(String),
}

impl Reported for Refusal {
    fn class(&self) -> Class {
        match self {
            Refusal::Exists(_) => Class::Usage,
            Refusal::TooNoisy(_) => Class::Precondition,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            Refusal::Exists(file) => Some(FilePlace::at(file)),
            Refusal::TooNoisy(_) => None,
        }
    }

    fn remedy(&self) -> Option<String> {
        let words = match self {
            Refusal::Exists(_) => "--force writes over it, --out elsewhere",
            Refusal::TooNoisy(_) => "try again when the machine is quiet, with more --sweeps, or --force",
        };
        Some(words.to_owned())
    }
}

impl CalibrateVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        if self.out.exists() && !self.force {
            return Err(Refusal::Exists(self.out.clone()).into());
        }
        // A place that cannot be written is found before minutes of measuring.
        drop(self.beginning()?);
        let bar = progress(common, "calibrate");
        let effort = Effort { sweeps: self.sweeps.into() };
        let model = calibrate(host(), InstructionSet::best(), effort, |share| {
            bar.set_position((1e3 * share) as u64)
        })?;
        clear_progress();
        let drawn: Vec<String> = sections::calibration::tables(&model).iter().map(terminal::render).collect();
        let drawn = drawn.join("\n");
        if let Some(noise) = noise(&model.measured) {
            if !self.force {
                if !common.json {
                    print(&drawn)?;
                }
                return Err(Refusal::TooNoisy(noise).into());
            }
            warn(format_args!("{noise}: the machine is busy"));
        }
        // Before anything is printed: the reader of that may close the pipe.
        signals::whole(|| self.write(&model.to_toml()))?;
        if !common.quiet {
            say(format_args!("written: {}", self.out.display()));
        }
        if common.json { print_json(&model) } else { print(&drawn) }
    }

    /// A file without a name of its own yet, beside the one that is to be written.
    fn beginning(&self) -> Result<NamedTempFile, Failure> {
        let folder = self.out.parent().filter(|folder| !folder.as_os_str().is_empty());
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        {
            // As for any file: what the user's mask leaves of it.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        builder.tempfile_in(folder.unwrap_or(Path::new("."))).map_err(self.failed())
    }

    /// Writes the whole file, or leaves what was there.
    fn write(&self, text: &str) -> Result<(), Failure> {
        let mut file = self.beginning()?;
        file.write_all(text.as_bytes()).and_then(|()| file.as_file().sync_all()).map_err(self.failed())?;
        let placed = if self.force { file.persist(&self.out) } else { file.persist_noclobber(&self.out) };
        placed.map(drop).map_err(|refused| self.failed()(refused.error))
    }

    fn failed(&self) -> impl FnOnce(std::io::Error) -> Failure {
        Failure::writing(self.out.display().to_string())
    }
}

/// What shows that the machine was too busy, if it was.
pub(super) fn noise(measured: &Measured) -> Option<String> {
    let Measured { spread, disagreement, slowdown, quiet, .. } = *measured;
    (spread > TOO_NOISY || disagreement > TOO_DIFFERENT || quiet < TOO_RARE).then(|| {
        format!(
            "half of the samples lie within {:.0} % of the median one, the two halves of the measurement differ by {:.1} %, \
             and {:.0} % of the points were measured undisturbed: in the median the machine was {slowdown:.2} times as slow",
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
            reference_loop: 3000.0,
            slowdown: 1.3,
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
