//! What is measured of bodies.

use super::quantities::QUANTITIES;
use crate::method::entry::bench_options;
use crate::method::{Bench, Until};

/// What makes a bench of an engine: only the fast one has estimated roots.
fn of_engine(engine: &str, mut more: Vec<String>) -> Vec<String> {
    if engine != "fast" {
        more.push("machine.arithmetic=exact".to_owned());
    }
    more.push(format!("machine.engine={engine}"));
    more
}

/// The benchmark.
pub(super) const BENCHES: &[Bench] = &[Bench {
    name: "nbody",
    doc: "PWP's all-pairs gravity",
    preset: "plummer",
    rate: "interactions_per_second",
    until: Until::Steps,
    // Two thousand million directed interactions.
    amount: |bodies| (2_000_000_000 / (bodies * bodies).max(1)).clamp(5, 20_000),
    defaults: &[("particles", "4096")],
    options: bench_options! {
        "particles" Count [], |count| vec![format!("particles.count={count}")], "Number of particles, at least";
        "precision" Word ["f64", "mixed"], |precision| vec![format!("machine.precision={precision}")], "Precision of state and forces: f64, f32 or mixed";
        "integrator" Word [], |kind| vec![format!("integrator.kind={kind}")], "Integrator, such as gear4, gear5, gear6, velocity-verlet, baoab or stochastic";
        "engine" Word ["fast", "programs", "reference"], |engine| of_engine(engine, vec![]), "What moves the particles: auto, fast, or programs of lattice MD, reference of hard discs; the fastest by default";
        "execution" Word [], |execution| of_engine("programs", vec![format!("machine.execution={execution}")]), "How programs are executed: eager, strip:N or chained; implies programs";
        "arithmetic" Word ["exact", "estimated", "raw"], |kind| vec![format!("machine.arithmetic={kind}")], "How products and roots of bodies are formed: exact, estimated or raw";
        "instruction-set" Word [], |set| vec![format!("machine.instruction_set={set}")], "scalar, avx2, avx512, wide, or auto for the widest there is";
    },
    overrides: &["machine.engine=fast", "machine.arithmetic=estimated"],
    quantities: QUANTITIES,
    compared: &["virial_ratio"],
    at_end: &["energy_error"],
}];
