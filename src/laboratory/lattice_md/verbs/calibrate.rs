//! `stripmine calibrate`: how long this host's operations take.

use crate::console::{Common, Failure, clear_progress, print, print_json, progress, say, warn};
use crate::laboratory::lattice_md::study::calibration::calibrate;
use clap::Args;
use std::io::Write;
use std::path::PathBuf;
use stripmine_physics::io::replace::{folder_of, temporary, written_beside};
use stripmine_physics::quoted;
use stripmine_physics::reported::{Class, FilePlace, Reported};
use stripmine_physics::signals;

/// Measures this host's operations and caches, in whatever state it is, and writes a host file that says which
#[derive(Args)]
pub(super) struct CalibrateVerb {
    /// The host file
    #[arg(long, default_value = "host.toml")]
    out: PathBuf,
    /// Write over a file that is there
    #[arg(long)]
    force: bool,
    /// Seconds that it takes, about
    #[arg(long, default_value_t = SECONDS, value_parser = clap::value_parser!(u16).range(10..=3600))]
    seconds: u16,
}

/// Seconds that a calibration takes, about.
pub(super) const SECONDS: u16 = 75;

/// There is a host file already.
#[derive(Debug, thiserror::Error)]
#[error("{} is there already: {ELSEWHERE}", quoted::path(.0))]
struct Exists(PathBuf);

const ELSEWHERE: &str = "--force writes over it, --out elsewhere";

impl Reported for Exists {
    fn class(&self) -> Class {
        Class::Usage
    }

    fn place(&self) -> Option<FilePlace> {
        Some(FilePlace::at(&self.0))
    }

    fn remedy(&self) -> Option<String> {
        Some(ELSEWHERE.to_owned())
    }
}

impl CalibrateVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        if self.out.exists() && !self.force {
            return Err(Exists(self.out.clone()).into());
        }
        // A place that cannot be written is found before minutes of measuring.
        drop(temporary().tempfile_in(folder_of(&self.out)).map_err(self.failed())?);
        let bar = progress(common, "calibrate");
        let model = calibrate(self.seconds.into(), |share| bar.set_position((1e3 * share) as u64))?;
        clear_progress();
        if !model.measured.was_quiet() {
            warn(format_args!("the machine was {}; the host file says so", model.measured.state));
        }
        // Before anything is printed: the reader of that may close the pipe.
        signals::whole(|| self.write(&model.to_toml()))?;
        if !common.quiet {
            say(format_args!("written: {}", self.out.display()));
        }
        if common.json {
            return print_json(&model);
        }
        let measured = &model.measured;
        print(&format!(
            "{}, {}: measured in {:.0} s on a machine that was {}. Programs deviate from their prices by {:.1} % (the median).\n",
            model.title,
            model.instruction_set,
            measured.seconds,
            measured.state,
            100.0 * measured.residual
        ))
    }

    /// Writes the whole file, or leaves what was there.
    fn write(&self, text: &str) -> Result<(), Failure> {
        let file = written_beside(&self.out, |out| out.write_all(text.as_bytes())).map_err(self.failed())?;
        let placed = if self.force { file.persist(&self.out) } else { file.persist_noclobber(&self.out) };
        placed.map(drop).map_err(|refused| self.failed()(refused.error))
    }

    fn failed(&self) -> impl FnOnce(std::io::Error) -> Failure {
        Failure::writing(self.out.display().to_string())
    }
}
