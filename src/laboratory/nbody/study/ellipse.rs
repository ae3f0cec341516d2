//! Two bodies on an ellipse: the energy error of the leapfrog by the eccentricity.

use crate::console::Failure;
use crate::frame::Rows;
use crate::laboratory::running::Running;
use crate::results::{Lab, Made, Meter, Size};
use crate::study::StudyError;
use stripmine_physics::method::nbody::keys::ECCENTRICITY;
use stripmine_physics::scene::Overrides;

/// Eccentricities.
const ECCENTRICITIES: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 0.9];
/// Steps of a run, and steps between two looks.
const STEPS: u64 = 20_000;
const BETWEEN: u64 = 20;

/// Follows each ellipse.
pub(crate) fn made(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let all = Meter::new(ECCENTRICITIES.len() as f64, lab.progress)
        .each(&ECCENTRICITIES, |&eccentricity| Ok::<_, StudyError>((eccentricity, largest(eccentricity)?)))?;
    Ok(Made::of([Rows::of(all)
        .number("eccentricity", 1, |it| it.0)
        .short("|ΔE/E|", |it| it.1)
        .frame("ellipses", "Largest energy error of the leapfrog on an ellipse, by its eccentricity")]))
}

/// The largest energy error of a run.
fn largest(eccentricity: f64) -> Result<f64, StudyError> {
    let mut run = Running::begin("kepler", &Overrides::new().set(&ECCENTRICITY, eccentricity))?;
    let mut largest = 0.0_f64;
    for _ in 0..STEPS / BETWEEN {
        run.steps(BETWEEN)?;
        let [error] = run.observed(["energy_error"])?;
        largest = largest.max(error.abs());
    }
    Ok(largest)
}
