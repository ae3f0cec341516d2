//! What is measured of particles in a bath beside a run: each study a file, its section of the report in `sections`.

pub mod accuracy;
pub mod diffusion;
pub mod losses;
pub mod sectors;

use super::benches::QUANTITIES;
use super::keys::VOCABULARY;
use super::prepared::prepare;
use crate::console::Failure;
use crate::method::observed::{UnknownName, observed};
use crate::method::{self, Prepared, Purpose, Simulation, Until};
use crate::scene::Values;
use serde::Serialize;
use std::sync::atomic::AtomicBool;

/// Parts of a run, each a measurement; their scatter gives the error.
const PARTS: usize = 20;
/// Student's t of 19 degrees of freedom, for 95 of 100.
const STUDENT: f64 = 2.093;

/// A mean with half the width of the interval that holds it in 95 of 100 studies.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// Half the width.
    pub bar: f64,
}

impl Mean {
    /// Of parts of a run.
    fn of(parts: &[f64]) -> Mean {
        let count = parts.len() as f64;
        let value = parts.iter().sum::<f64>() / count;
        let square = parts.iter().map(|it| (it - value).powi(2)).sum::<f64>() / (count - 1.0);
        Mean { value, bar: STUDENT * (square / count).sqrt() }
    }
}

/// A preset with overrides.
pub(super) fn prepared(preset: &str, overrides: &[String]) -> Result<Box<dyn Prepared>, Failure> {
    Ok(prepare(Values::load(preset, overrides, &[&VOCABULARY])?)?)
}

/// A scene that runs.
struct Running(Box<dyn Simulation>);

impl Running {
    fn begin(preset: &str, overrides: &[String], purpose: Purpose) -> Result<Running, Failure> {
        Ok(Running(prepared(preset, overrides)?.start(purpose)?))
    }

    /// Goes on for some steps.
    fn steps(&mut self, steps: u64) -> Result<(), method::Failure> {
        let moment = Until::Steps(steps).after(&self.0.clock());
        self.0.advance(&[moment], &AtomicBool::new(false))
    }

    /// What is observed now, by its name.
    ///
    /// # Errors
    /// [`UnknownName`] if it is not observed.
    fn observed<const N: usize>(&self, names: [&str; N]) -> Result<[f64; N], UnknownName> {
        observed(QUANTITIES, &self.0.observe(), names)
    }
}
