//! The models whose programs are drilled: that of the bench scene, and what leaves something out or has something more.

use crate::laboratory::lattice_md::study::phase_times::Run;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_physics::method::lattice_md::{Discs, Model};

/// The drill scene: discs at rest that do not touch, as no validation runs them.
pub(super) const DRILL: Run = Run { particles: 300, occupancy: 0.13, precision: "f64", execution: "chained" };

/// What is drilled of the drill scene.
pub(super) struct Variant {
    /// How it differs.
    pub(super) change: fn(&mut Model),
}

/// The bench scene's own first, which larger scenes have too; then what leaves something out, or has something more.
pub(super) const VARIANTS: [Variant; 4] = [
    Variant { change: |_| () },
    Variant {
        change: |model| {
            model.friction = false;
            model.contact.shear_damping = 0.0;
        },
    },
    Variant { change: |model| model.discs = Discs::Varying },
    Variant {
        change: |model| {
            model.discs = Discs::Varying;
            model.coordinates = Coordinates::Absolute;
            model.gravity = [9.81, 0.0];
            // It does not check itself, as runs do.
            model.watch = None;
        },
    },
];

/// Discs at rest: no drill depends on what the one before has left.
pub(super) const AT_REST: [&str; 2] = ["particles.temperature=0", "particles.seed=7"];
