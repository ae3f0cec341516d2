//! What is measured of bodies beside a run: each study a file, its section of the report in `sections`.

pub mod collapse;
pub mod energy;
pub mod rates;

use super::benches::QUANTITIES;
use super::keys::VOCABULARY;
use super::prepared::prepare;
use crate::console::Failure;
use crate::method::observed::{UnknownName, observed};
use crate::method::{self, Purpose, Simulation, Until};
use crate::scene::Values;
use std::sync::atomic::AtomicBool;

/// A scene that runs.
struct Running(Box<dyn Simulation>);

impl Running {
    fn begin(preset: &str, overrides: &[String]) -> Result<Running, Failure> {
        Ok(Running(prepare(Values::load(preset, overrides, &[&VOCABULARY])?)?.start(Purpose::Measurement)?))
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
