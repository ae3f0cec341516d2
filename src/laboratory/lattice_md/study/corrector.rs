//! Gear's corrector as printed in BP93, appendix A, and as corrected: an undamped oscillation over ten periods.

use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use std::f64::consts::TAU;
use stripmine_kernels::integrator::gear::{Acceleration, coefficients};

/// Steps per period.
const STEPS: [u32; 7] = [16, 32, 64, 128, 256, 512, 1024];
/// Number of periods.
const PERIODS: u32 = 10;
/// Relative energy error above which an oscillation is lost.
const LOST: f64 = 0.5;

/// Integrates the oscillation with both correctors.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let runs = ["printed", "difference"].into_iter().flat_map(|corrector| {
        let of = move |values| {
            STEPS.map(|steps| (corrector, values, steps, energy_error_of_corrector(corrector, values, steps)))
        };
        (4..=6).flat_map(of)
    });
    let order = |values: usize| {
        let error = |steps| energy_error_of_corrector("difference", values, steps).unwrap_or(f64::NAN);
        libm::log2(error(512) / error(1024))
    };
    Ok(FinishedItem::of([
        FrameBuilder::of(runs)
            .text("corrector", |(corrector, ..)| *corrector)
            .count("values", |(_, values, ..)| *values)
            .count("steps of a period", |(.., steps, _)| *steps)
            .short("largest |ΔE/E|", |(.., run)| run.ok())
            .cell("lost after steps", |(.., run)| run.err())
            .frame("runs", "Energy along ten periods of an undamped oscillation"),
        FrameBuilder::of(4..=6_usize)
            .count("values", |values| *values)
            .number("order", 2, |values| order(*values))
            .frame("orders", "Power of the step in the energy error, from 512 to 1024 steps of a period"),
    ]))
}

/// Largest |ΔE/E| during the run, or the step at which the oscillation is lost.
fn energy_error_of_corrector(corrector: &str, values: usize, steps: u32) -> Result<f64, u64> {
    let dt = TAU / f64::from(steps);
    let coefficients = coefficients(values, Acceleration::OfPositions);
    // Scaled derivatives dt^k/k! of cos t.
    let mut q = [1.0, 0.0, -dt.powi(2) / 2.0, 0.0, dt.powi(4) / 24.0, 0.0];
    let mut largest: f64 = 0.0;
    for step in 1..=PERIODS * steps {
        for lowest in 0..values - 1 {
            (lowest..values - 1).rev().for_each(|k| q[k] += q[k + 1]);
        }
        let acceleration = -q[0] * dt * dt / 2.0;
        let change = if corrector == "printed" { acceleration } else { acceleration - q[2] };
        (0..values).for_each(|k| q[k] += coefficients[k] * change);
        largest = largest.max((q[0].powi(2) + (q[1] / dt).powi(2) - 1.0).abs());
        if largest > LOST {
            return Err(step.into());
        }
    }
    Ok(largest)
}
