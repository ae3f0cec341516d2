//! `stripmine calibrate`: times of this host's operations.

use crate::console::{
    CommandFailure, Common, clear_progress, print_json, print_message, print_text, progress, warn,
};
use crate::laboratory::lattice_md::study::calibration::calibrate;
use clap::Args;
use std::io;
use std::path::PathBuf;
use stripmine_physics::io::replace::{check_folder_writable, check_may_write, write_atomically_new};
use stripmine_physics::signals;

/// Measures this host's operations and caches, and writes a host file that also records the state of the machine
#[derive(Args)]
pub(super) struct CalibrateVerb {
    /// Host file to write
    #[arg(long, default_value = "host.toml")]
    out: PathBuf,
    /// Overwrite an existing file
    #[arg(long)]
    force: bool,
    /// Approximate duration in seconds
    #[arg(long, default_value_t = SECONDS, value_parser = clap::value_parser!(u16).range(10..=3600))]
    seconds: u16,
}

/// Approximate duration of a calibration in seconds.
pub(super) const SECONDS: u16 = 75;

impl CalibrateVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), CommandFailure> {
        check_may_write(&self.out, self.force, "--force writes over it, --out elsewhere")?;
        // An unwritable location is found before minutes of measuring.
        check_folder_writable(&self.out).map_err(self.failed())?;
        let bar = progress(common, "calibrate");
        let model = calibrate(self.seconds.into(), |share| bar.set_position((1e3 * share) as u64))?;
        clear_progress();
        if !model.measured.was_quiet() {
            warn(format_args!("the machine was {}; the host file records this", model.measured.state));
        }
        let text = model.to_toml().map_err(io::Error::other).map_err(self.failed())?;
        // Written before anything is printed: the reader of the output may close the pipe.
        signals::run_protected(|| write_atomically_new(&self.out, &text, self.force))
            .map_err(self.failed())?;
        if !common.quiet {
            print_message(format_args!("written: {}", self.out.display()));
        }
        if common.json {
            return print_json(&model);
        }
        let measured = &model.measured;
        print_text(&format!(
            "{}, {}: measured in {:.0} s on a machine that was {}. The median deviation of programs from the model is {:.1} %.\n",
            model.title,
            model.instruction_set,
            measured.seconds,
            measured.state,
            100.0 * measured.residual
        ))
    }

    fn failed(&self) -> impl FnOnce(io::Error) -> CommandFailure {
        CommandFailure::writing(self.out.display().to_string())
    }
}
