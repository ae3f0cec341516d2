//! `stripmine validate-model`: comparison of the host model with wall time.

use super::calibrate::SECONDS;
use super::print_result;
use crate::console::{CommandFailure, Common, clear_progress, print_message, progress, warn};
use crate::laboratory::lattice_md::study::calibration::calibrate;
use crate::laboratory::lattice_md::study::model_validation::{
    ValidationSize, fresh_model_title, model_validation,
};
use crate::laboratory::write_result;
use crate::model::host::{HostModel, MeasurementConditions, default_model};
use crate::results::Folder;
use clap::Args;
use clap::builder::RangedU64ValueParser;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;
use stripmine_kernels::InstructionSet;
use stripmine_physics::origin;

/// Predicts runs that the model was not fitted to, measures them as users run them, and reports the error of each prediction
#[derive(Args)]
pub(super) struct ValidateModelVerb {
    /// Host file of `calibrate` (default: the model shipped with the program)
    #[arg(long)]
    host: Option<PathBuf>,
    /// Calibrates first; the host file is written to the folder of the result
    #[arg(long, conflicts_with = "host")]
    calibrate: bool,
    /// Numbers of particles
    #[arg(long, value_delimiter = ',', default_values_t = [560, 2050, 9500],
          value_parser = RangedU64ValueParser::<usize>::new().range(1..))]
    particles: Vec<usize>,
    /// Occupancies, on cells as wide as the radius
    #[arg(long, value_delimiter = ',', default_values_t = [0.072, 0.168], value_parser = occupancy)]
    occupancies: Vec<f64>,
    /// Approximate duration of the runs in seconds; each runs at least once
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u16).range(1..))]
    seconds: u16,
    /// Folder for the result as data, tables and figures
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Parses an occupancy that touching discs can reach on cells as wide as their radius.
fn occupancy(text: &str) -> Result<f64, String> {
    let most = DENSEST / std::f64::consts::PI;
    match text.parse() {
        Ok(occupancy) if occupancy > 0.0 && occupancy < most => Ok(occupancy),
        _ => Err(format!("expected a number above 0 and below {most:.3}, the closest packing of discs")),
    }
}

/// Packing fraction above which the scenes cannot be generated.
const DENSEST: f64 = 0.907;

/// Maximum number of rounds over all runs.
const ROUNDS: usize = 12;
/// Share of the progress for a preceding calibration.
const CALIBRATION: f64 = 0.4;

/// Model of a host file, or the model shipped with the program; and a description of its origin.
pub(super) fn host_model(
    file: Option<&Path>,
    common: &Common,
) -> Result<(HostModel, String), CommandFailure> {
    let note = |warns: bool, words: fmt::Arguments<'_>| match common.quiet {
        true => (),
        false if warns => warn(words),
        false => print_message(words),
    };
    let Some(file) = file else {
        let model = default_model()?;
        let title = &model.title;
        note(
            false,
            format_args!(
                "using the model shipped with the program, of {title}; `stripmine calibrate` makes one for this host"
            ),
        );
        let whose = format!("the shipped model of {title}");
        return Ok((model, whose));
    };
    let (model, name) = (HostModel::load(file)?, file.display());
    let MeasurementConditions { state, .. } = &model.measured;
    if !model.measured.was_quiet() {
        note(true, format_args!("the machine of {name} was {state} when it was calibrated"));
    }
    let whose = match model.differs_from(&origin::host(), InstructionSet::best().name()) {
        None => format!("the model of {} from a host file", model.title),
        Some(difference) => {
            note(true, format_args!("{name}: {difference}"));
            format!("the model of another host, {}, from a host file", model.title)
        }
    };
    Ok((model, whose))
}

impl ValidateModelVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), CommandFailure> {
        let effort = ValidationSize {
            particles: self.particles.clone(),
            occupancies: self.occupancies.clone(),
            rounds: ROUNDS,
            seconds: self.seconds.into(),
        };
        // Checked before the long computation.
        let folder = self.out.as_ref().map(|out| Folder::open(out, &["validation"], false)).transpose()?;
        let (start, bar) = (Instant::now(), progress(common, "validate-model"));
        let show = |share: f64| bar.set_position((1e3 * share) as u64);
        let begun = if self.calibrate { CALIBRATION } else { 0.0 };
        let (model, whose) = if self.calibrate {
            let model = calibrate(SECONDS.into(), |share| show(begun * share))?;
            let whose = fresh_model_title(&model);
            (model, whose)
        } else {
            host_model(self.host.as_deref(), common)?
        };
        let mut made = model_validation(&model, whose, &effort, |share| show(begun + (1.0 - begun) * share))?;
        clear_progress();
        if self.calibrate {
            let text = model
                .to_toml()
                .map_err(|cause| CommandFailure::writing("host.toml")(io::Error::other(cause)))?;
            made.files.push(("host.toml".to_owned(), text));
        }
        if let Some(folder) = folder {
            write_result(&folder, ("validation", &made), start, common)?;
        }
        print_result(&made, common)
    }
}
