//! Bench scene of the precision studies.

use crate::laboratory::lattice_md::study::StudyError;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_physics::method::lattice_md::GranularDocument;
use stripmine_physics::method::lattice_md::SteppedGrains;
use stripmine_physics::method::lattice_md::keys::{ENGINE, INTEGRATOR, SEARCH};
use stripmine_physics::method::lattice_md::options::{EngineChoice, IntegratorKind, SearchKind};
use stripmine_physics::method::lattice_md::{assemble, model};
use stripmine_physics::observe::SceneProperties;
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, SEED};

/// Packing fractions of a near solid and of a gas.
pub(super) const PACKING_FRACTIONS: [f64; 2] = [0.84, 0.3];
/// Seeds of the averages.
pub(super) const SEEDS: [u64; 3] = [1, 2, 3];
/// Steps in f64 before comparisons, because the start on a lattice has no contacts.
pub(super) const EQUILIBRATION: u64 = 1000;

/// Running bench scene.
pub(super) struct BenchGas {
    pub(super) method: SteppedGrains,
    pub(super) scenery: SceneProperties,
}

impl BenchGas {
    /// Starts the bench scene with overrides, from `discs` if given.
    pub(super) fn begin(overrides: &Overrides, discs: Option<&Particles>) -> Result<BenchGas, StudyError> {
        BenchGas::with_coordinates(Coordinates::CellRelative, overrides, discs)
    }

    /// Starts with positions relative to the cell or to the corner of the box, even if `scene check` rejects single precision because
    /// particles would stop moving.
    pub(super) fn with_coordinates(
        coordinates: Coordinates,
        overrides: &Overrides,
        discs: Option<&Particles>,
    ) -> Result<BenchGas, StudyError> {
        let mut checked = GranularDocument::load("bench", &overrides.texts())?.check()?;
        checked.scene.machine.coordinates = coordinates;
        if let Some(discs) = discs {
            checked.particles = discs.clone();
        }
        Ok(BenchGas { method: assemble(&checked)?, scenery: SceneProperties::of(&model(&checked)) })
    }

    /// State after [`EQUILIBRATION`] steps in f64 with velocity Verlet.
    pub(super) fn equilibrated(overrides: &Overrides) -> Result<Particles, StudyError> {
        let fast = overrides.clone().set(&ENGINE, EngineChoice::Fast);
        let mut gas = BenchGas::begin(&fast.set(&INTEGRATOR, IntegratorKind::VelocityVerlet), None)?;
        gas.advance(EQUILIBRATION)?;
        Ok(gas.method.particles())
    }

    pub(super) fn advance(&mut self, steps: u64) -> Result<(), StudyError> {
        Ok((0..steps).try_for_each(|_| self.method.step())?)
    }
}

/// Overrides for the number of discs, the packing fraction and the seed.
pub(super) fn bench_overrides(count: usize, packing_fraction: f64, seed: u64) -> Overrides {
    let scene = Overrides::new().set(&COUNT, count).set(&PACKING_FRACTION, packing_fraction);
    scene.set(&SEED, seed).set(&SEARCH, SearchKind::Lattice)
}
