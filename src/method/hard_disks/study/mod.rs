//! What is measured of hard discs beside a run: each study a file, its section of the report in `sections`.

pub mod atmosphere;
pub mod collapse;
pub mod cooling;
pub mod fluid;
pub mod masks;
pub mod precision;
pub mod rates;
pub mod soft_hard;
pub mod structure;

use super::benches::QUANTITIES;
use super::keys::VOCABULARY;
use super::prepared::prepare;
use crate::console::Failure;
use crate::method::observed::{UnknownName, observed};
use crate::method::{Prepared, Purpose, Simulation, Until};
use crate::scene::Values;
use std::sync::atomic::AtomicBool;

/// A preset with overrides.
pub(super) fn prepared(preset: &str, overrides: &[String]) -> Result<Box<dyn Prepared>, Failure> {
    Ok(prepare(Values::load(preset, overrides, &[&VOCABULARY])?)?)
}

/// A scene that runs.
pub(super) struct Running(Box<dyn Simulation>);

impl Running {
    fn begin(preset: &str, overrides: &[String]) -> Result<Running, Failure> {
        Ok(Running(prepared(preset, overrides)?.start(Purpose::Run)?))
    }

    /// Lets so many events happen.
    fn events(&mut self, events: u64) -> Result<(), Failure> {
        self.until(Until::Events(events).after(&self.0.clock()))
    }

    fn until(&mut self, moment: Until) -> Result<(), Failure> {
        Ok(self.0.advance(&[moment], &AtomicBool::new(false))?)
    }

    /// What is observed now, by its name.
    ///
    /// # Errors
    /// [`UnknownName`] if it is not observed.
    fn observed<const N: usize>(&self, names: [&str; N]) -> Result<[f64; N], UnknownName> {
        observed(QUANTITIES, &self.0.observe(), names)
    }
}
