//! Force errors on one configuration of discs, against the size of the box.

use super::gas::{BenchGas, PACKING_FRACTIONS, bench_overrides};
use crate::frame::{FrameBuilder, ResultFrame};
use crate::laboratory::lattice_md::study::StudyError;
use stripmine_kernels::sweep::lattice::Coordinates::{self, Absolute, CellRelative};
use stripmine_physics::method::lattice_md::keys::ENGINE;
use stripmine_physics::observe::contacts;
use stripmine_physics::scene::PRECISION;

/// Name, `machine.precision`, `machine.engine` and the origin of positions.
type ForceVariant = (&'static str, &'static str, &'static str, Coordinates);

/// Variants compared with the fast engine in f64; programs are chained.
const VARIANTS: [ForceVariant; 7] = [
    ("mixed, fast", "mixed", "fast", CellRelative),
    ("f32, fast", "f32", "fast", CellRelative),
    ("mixed, programs, from the cell", "mixed", "programs", CellRelative),
    ("f32, programs, from the cell", "f32", "programs", CellRelative),
    ("mixed, programs, absolute", "mixed", "programs", Absolute),
    ("f32, programs, absolute", "f32", "programs", Absolute),
    ("f64, programs, absolute", "f64", "programs", Absolute),
];

/// Numbers of discs.
const PARTICLES: [usize; 3] = [1000, 10_000, 100_000];

/// Force errors of the variants on one configuration of discs.
struct ForceErrors {
    packing_fraction: f64,
    discs: usize,
    /// Longer side of the box (diameters).
    side: f64,
    contacts: f64,
    /// RMS error and largest error of the force on a disc, over the RMS force.
    errors: [[f64; 2]; VARIANTS.len()],
}

/// Frame of every variant on every configuration. `progress` receives the completed share.
pub(super) fn frame(progress: impl Fn(f64)) -> Result<ResultFrame, StudyError> {
    let mut all = Vec::new();
    for packing_fraction in PACKING_FRACTIONS {
        for particles in PARTICLES {
            all.push(compare_forces(packing_fraction, particles)?);
            progress(all.len() as f64 / (PACKING_FRACTIONS.len() * PARTICLES.len()) as f64);
        }
    }
    let each = all.iter().flat_map(|it| VARIANTS.iter().zip(&it.errors).map(move |found| (it, found)));
    Ok(FrameBuilder::of(each)
        .number("packing fraction", 2, |(it, _)| it.packing_fraction)
        .count("discs", |(it, _)| it.discs)
        .number("side (diameters)", 0, |(it, _)| it.side)
        .number("contacts a disc", 3, |(it, _)| it.contacts)
        .text("variant", |(_, ((name, ..), _))| *name)
        .short("rms error", |(_, (_, errors))| errors[0])
        .short("largest error", |(_, (_, errors))| errors[1])
        .frame("forces", "Errors of the forces on one configuration"))
}

fn compare_forces(packing_fraction: f64, count: usize) -> Result<ForceErrors, StudyError> {
    let place = bench_overrides(count, packing_fraction, 1);
    let discs = BenchGas::equilibrated(&place)?;
    let computed = |(_, precision, engine, coordinates): ForceVariant| {
        let overrides = place.clone().set(&PRECISION, precision).set(&ENGINE, engine);
        BenchGas::with_coordinates(coordinates, &overrides, Some(&discs))
    };
    let reference = computed(("f64, fast", "f64", "fast", CellRelative))?;
    let (exact, domain) = (reference.method.forces(), reference.scenery.domain);
    let mut found = [[0.0; 2]; VARIANTS.len()];
    for (found, variant) in found.iter_mut().zip(VARIANTS) {
        *found = errors(&exact, &computed(variant)?.method.forces());
    }
    Ok(ForceErrors {
        packing_fraction,
        discs: discs.len(),
        side: domain.length(0).max(domain.length(1)),
        contacts: contacts(&discs, &domain).len() as f64 / discs.len() as f64,
        errors: found,
    })
}

/// RMS error and largest error of forces, over the RMS exact force.
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
    fn errors_are_relative_to_the_rms_force() {
        let exact = [[3.0, 4.0, 9.0], [0.0, -5.0, 9.0]];
        let [rms, largest] = errors(&exact, &[[3.0, 4.0, 0.0], [0.3, -5.4, 0.0]]);
        assert!((largest - 0.1).abs() < 1e-15 && (rms - 0.1 / 2f64.sqrt()).abs() < 1e-15, "{rms} {largest}");
    }

    /// In lower precision errors do not depend on the size of the box, unless positions are relative to its corner.
    #[test]
    fn cell_relative_errors_are_independent_of_the_box() {
        let [small, large] = [400, 6400].map(|count| compare_forces(0.84, count).unwrap());
        let rms = |it: &ForceErrors, name: &str| {
            it.errors[VARIANTS.iter().position(|(variant, ..)| *variant == name).unwrap()][0]
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
