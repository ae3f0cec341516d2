//! How long a step takes, before a scene is run in full.

use super::clock::Until;
use super::entry::{Prepared, Purpose};
use super::failure::Failure;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Steps are timed over at least this long.
const LONG_ENOUGH: Duration = Duration::from_millis(2);

/// Processor seconds of a step, from the first few.
///
/// # Errors
/// [`Failure`] if it breaks.
pub fn probed(prepared: &Prepared, most: u64) -> Result<f64, Failure> {
    let mut simulation = prepared.start(Purpose::Measurement)?;
    let before = cpu_time::ProcessTime::now();
    let mut steps = 1;
    loop {
        simulation.advance(&[Until::Steps(steps)], &AtomicBool::new(false))?;
        let spent = before.elapsed();
        if spent > LONG_ENOUGH || steps >= most {
            return Ok(spent.as_secs_f64() / steps as f64);
        }
        steps = (2 * steps).min(most);
    }
}
