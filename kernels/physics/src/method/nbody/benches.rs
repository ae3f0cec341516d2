//! Benchmark of all-pairs gravity.

use super::quantities::QUANTITIES;
use crate::method::entry::bench_options;
use crate::method::{Bench, Until};

/// Overrides that select an engine; only the fast one has estimated roots.
fn of_engine(engine: &str, mut more: Vec<String>) -> Vec<String> {
    if engine != "fast" {
        more.push("machine.arithmetic=exact".to_owned());
    }
    more.push(format!("machine.engine={engine}"));
    more
}

/// Benchmarks of the method.
pub(super) const BENCHES: &[Bench] = &[Bench {
    name: "nbody",
    doc: "PWP's all-pairs gravity",
    preset: "plummer",
    rate: "interactions_per_second",
    until: Until::Steps,
    // Two thousand million directed interactions.
    amount: |bodies| (2_000_000_000 / (bodies * bodies).max(1)).clamp(5, 20_000),
    // Every step visits all pairs, wherever the bodies are.
    least_warm_up: 1,
    defaults: &[("particles", "4096")],
    options: bench_options! {
        "particles" [], |count| vec![format!("particles.count={count}")];
        "precision" ["f64", "mixed"], |precision| vec![format!("machine.precision={precision}")];
        "integrator" [], |kind| vec![format!("integrator.kind={kind}")];
        "engine" ["fast", "programs", "reference"], |engine| of_engine(engine, vec![]);
        "execution" [], |execution| of_engine("programs", vec![format!("machine.execution={execution}")]);
        "arithmetic" ["exact", "estimated", "raw"], |kind| vec![format!("machine.arithmetic={kind}")];
        "instruction-set" [], |set| vec![format!("machine.instruction_set={set}")];
    },
    overrides: &["machine.engine=fast", "machine.arithmetic=estimated"],
    quantities: QUANTITIES,
    compared: &["virial_ratio"],
    at_end: &["energy_error"],
}];
