//! Errors of the forces on one configuration, over the size of the box.

use super::gas::{Gas, PACKING_FRACTIONS, place};
use crate::laboratory::lattice_md::study::StudyError;
use serde::Serialize;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_physics::method::lattice_md::keys::ENGINE;
use stripmine_physics::observe::contacts;
use stripmine_physics::scene::PRECISION;

/// A precision, engine and choice of coordinates that forces are computed with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Variant {
    /// Its name in a legend.
    pub name: &'static str,
    /// `machine.precision`.
    pub precision: &'static str,
    /// `machine.engine`; programs are chained.
    pub engine: &'static str,
    /// `machine.coordinates`.
    pub coordinates: &'static str,
}

/// The variants that are compared with the fast engine in f64.
pub const VARIANTS: [Variant; 7] = [
    Variant { name: "mixed, fast", precision: "mixed", engine: "fast", coordinates: "cell-relative" },
    Variant { name: "f32, fast", precision: "f32", engine: "fast", coordinates: "cell-relative" },
    Variant {
        name: "mixed, programs, from the cell",
        precision: "mixed",
        engine: "programs",
        coordinates: "cell-relative",
    },
    Variant {
        name: "f32, programs, from the cell",
        precision: "f32",
        engine: "programs",
        coordinates: "cell-relative",
    },
    Variant {
        name: "mixed, programs, absolute",
        precision: "mixed",
        engine: "programs",
        coordinates: "absolute",
    },
    Variant {
        name: "f32, programs, absolute",
        precision: "f32",
        engine: "programs",
        coordinates: "absolute",
    },
    Variant {
        name: "f64, programs, absolute",
        precision: "f64",
        engine: "programs",
        coordinates: "absolute",
    },
];

/// Numbers of discs.
pub const PARTICLES: [usize; 3] = [1000, 10_000, 100_000];

/// Errors on one configuration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ForceError {
    /// How the forces were computed.
    pub variant: Variant,
    /// Packing fraction.
    pub packing_fraction: f64,
    /// Discs.
    pub particles: usize,
    /// The longer side of the box (length).
    pub side: f64,
    /// Contacts a disc.
    pub contacts: f64,
    /// Root of the mean square error of a disc's force, over that of the forces.
    pub rms: f64,
    /// Largest error of a disc's force, over the root of the mean square of the forces.
    pub largest: f64,
}

/// Every variant on every configuration. `progress` gets the share that is done.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn force_errors(progress: impl Fn(f64)) -> Result<Vec<ForceError>, StudyError> {
    let mut errors = Vec::new();
    let cases = PACKING_FRACTIONS.len() * PARTICLES.len();
    for packing_fraction in PACKING_FRACTIONS {
        for particles in PARTICLES {
            errors.extend(on_one_configuration(packing_fraction, particles)?);
            progress(errors.len() as f64 / (cases * VARIANTS.len()) as f64);
        }
    }
    Ok(errors)
}

fn on_one_configuration(packing_fraction: f64, count: usize) -> Result<Vec<ForceError>, StudyError> {
    let place = place(count, packing_fraction, 1);
    let discs = Gas::equilibrated(&place)?;
    let computed = |variant: Variant| -> Result<Gas, StudyError> {
        let Variant { precision, engine, .. } = variant;
        let overrides = place.clone().set(&PRECISION, precision).set(&ENGINE, engine);
        let coordinates = match variant.coordinates {
            "absolute" => Coordinates::Absolute,
            _ => Coordinates::CellRelative,
        };
        Gas::seen_from(coordinates, &overrides, Some(&discs))
    };
    let reference = computed(Variant { precision: "f64", ..VARIANTS[0] })?;
    let exact = reference.method.forces();
    let domain = reference.scenery.domain;
    let contacts = contacts(&discs, &domain).len() as f64 / discs.len() as f64;
    let variants = VARIANTS.into_iter().map(|variant| {
        let [rms, largest] = errors(&exact, &computed(variant)?.method.forces());
        let side = domain.length(0).max(domain.length(1));
        Ok(ForceError { variant, packing_fraction, particles: discs.len(), side, contacts, rms, largest })
    });
    variants.collect()
}

/// Root of the mean square of the errors of forces, and the largest, over that of the exact ones.
fn errors(exact: &[[f64; 3]], approximate: &[[f64; 3]]) -> [f64; 2] {
    let square = |[x, y, _]: [f64; 3]| x * x + y * y;
    let squares = exact.iter().map(|&force| square(force)).sum::<f64>();
    let of_errors = || exact.iter().zip(approximate).map(|(a, b)| square([a[0] - b[0], a[1] - b[1], 0.0]));
    let largest = of_errors().fold(0.0, f64::max) * exact.len() as f64;
    [of_errors().sum::<f64>(), largest].map(|sum| (sum / squares).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_relative_to_the_mean_square_of_the_forces() {
        let exact = [[3.0, 4.0, 9.0], [0.0, -5.0, 9.0]];
        let [rms, largest] = errors(&exact, &[[3.0, 4.0, 0.0], [0.3, -5.4, 0.0]]);
        assert!((largest - 0.1).abs() < 1e-15 && (rms - 0.1 / 2f64.sqrt()).abs() < 1e-15, "{rms} {largest}");
    }

    /// In fewer digits the errors are those of the digits, in any box; from the box's corner they grow with it.
    #[test]
    fn errors_do_not_depend_on_the_box_but_from_its_corner() {
        let [small, large] = [400, 6400].map(|count| on_one_configuration(0.84, count).unwrap());
        let rms = |errors: &[ForceError], name: &str| {
            errors.iter().find(|error| error.variant.name == name).map(|error| error.rms).unwrap()
        };
        for name in ["mixed, fast", "f32, fast", "mixed, programs, from the cell"] {
            let ratio = rms(&large, name) / rms(&small, name);
            assert!(rms(&large, name) < 1e-5 && (0.5..2.0).contains(&ratio), "{name}: {ratio}");
        }
        let absolute = "mixed, programs, absolute";
        assert!(rms(&large, absolute) > 2.0 * rms(&small, absolute));
        assert!(rms(&large, "f64, programs, absolute") < 1e-11);
    }
}
