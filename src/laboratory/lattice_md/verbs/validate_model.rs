//! `stripmine validate-model`: the host model against wall time.

use super::print_made;
use crate::console::{Common, Failure, clear_progress, progress, say, warn};
use crate::laboratory::lattice_md::study::calibration;
use crate::laboratory::lattice_md::study::model_validation::{Calibrated, Effort, model_validation};
use crate::laboratory::lattice_md::study::rounds::Bound;
use crate::model::host::{HostModel, default_model};
use crate::provenance::Provenance;
use crate::results::{Folder, Made};
use clap::Args;
use clap::builder::RangedU64ValueParser;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use stripmine_kernels::InstructionSet;
use stripmine_physics::origin;
use stripmine_physics::signals;

/// Predicts runs that nothing was fitted to, measures them as users run them, and says how far off each prediction was
#[derive(Args)]
pub(super) struct ValidateModel {
    /// Host file of `calibrate`; without one, the model that comes with the program
    #[arg(long)]
    host: Option<PathBuf>,
    /// Calibrate just before; the host file lies in the folder of the result
    #[arg(long, conflicts_with = "host")]
    calibrate: bool,
    /// Numbers of particles
    #[arg(long, value_delimiter = ',', default_values_t = [560, 2050, 9500],
          value_parser = RangedU64ValueParser::<usize>::new().range(1..))]
    particles: Vec<usize>,
    /// Occupancies, on cells as wide as the radius
    #[arg(long, value_delimiter = ',', default_values_t = [0.072, 0.168], value_parser = occupancy)]
    occupancies: Vec<f64>,
    /// Seconds that the runs take, about; each is made once at least
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u16).range(1..))]
    seconds: u16,
    /// Folder for the result as data, tables and figures
    #[arg(long)]
    out: Option<PathBuf>,
}

/// An occupancy that discs which touch can have on cells as wide as their radius.
fn occupancy(text: &str) -> Result<f64, String> {
    let most = DENSEST / std::f64::consts::PI;
    match text.parse() {
        Ok(occupancy) if occupancy > 0.0 && occupancy < most => Ok(occupancy),
        _ => Err(format!("a number above 0 and below {most:.3}, where discs fill the plane")),
    }
}

/// Packing fraction beyond which the scenes of the test cannot be made.
const DENSEST: f64 = 0.907;

/// Rounds over all runs at most.
const ROUNDS: usize = 12;

/// The model of a host file, or the one that comes with the program; which of them it is.
pub(super) fn host_model(file: Option<&Path>, common: &Common) -> Result<(HostModel, Calibrated), Failure> {
    let Some(file) = file else {
        let model = default_model()?;
        if !common.quiet {
            say(format_args!(
                "no --host: using the model that comes with the program, of {}; see calibrate",
                model.title
            ));
        }
        return Ok((model, Calibrated::Shipped));
    };
    let model = HostModel::load(file)?;
    if !model.measured.was_quiet() && !common.quiet {
        warn(format_args!(
            "the machine of {} was {} when it was calibrated",
            file.display(),
            model.measured.state
        ));
    }
    let Some(difference) = model.differs_from(&origin::host(), InstructionSet::best().name()) else {
        return Ok((model, Calibrated::Before));
    };
    if !common.quiet {
        warn(format_args!("{}: {difference}", file.display()));
    }
    Ok((model, Calibrated::Elsewhere))
}

impl ValidateModel {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let effort = Effort {
            particles: self.particles.clone(),
            occupancies: self.occupancies.clone(),
            rounds: Bound { most: ROUNDS, within: Some(Duration::from_secs(self.seconds.into())) },
            particle_steps: 10_000,
        };
        // Before anything takes its time.
        let folder = match &self.out {
            Some(out) => Some(Folder::open(out, &["validation"], false)?),
            None => None,
        };
        let start = Instant::now();
        let made = self.validated(&effort, common)?;
        if let Some(folder) = folder {
            let provenance = Provenance::here(common.command.clone(), start.elapsed().as_secs_f64());
            let (folder, _) = signals::whole(|| folder.write("validation", &made, &provenance))?;
            if !common.quiet {
                say(format_args!("written: {}", folder.display()));
            }
        }
        print_made(&made, common)
    }

    /// The result, with the host file if the model was calibrated here.
    fn validated(&self, effort: &Effort, common: &Common) -> Result<Made, Failure> {
        let bar = progress(common, "validate-model");
        let show = |share: f64| bar.set_position((1e3 * share) as u64);
        let (model, calibrated) = if self.calibrate {
            let effort = calibration::Effort::default();
            let model = calibration::calibrate(origin::host(), InstructionSet::best(), effort, |share| {
                show(0.4 * share)
            })?;
            (model, Calibrated::Now)
        } else {
            host_model(self.host.as_deref(), common)?
        };
        let begun = if self.calibrate { 0.4 } else { 0.0 };
        let mut made =
            model_validation(&model, calibrated, effort, |share| show(begun + (1.0 - begun) * share))?;
        clear_progress();
        made.files.extend(self.calibrate.then(|| ("host.toml".to_owned(), model.to_toml())));
        Ok(made)
    }
}
