//! Cost of each phase of a fast step: corrector and predictor, update of the Index, contacts and their forces.
//!
//! The discs move: every iteration is a whole step of the bench scene, whose phases the method itself times. A frozen
//! configuration would favour branch prediction. Throughput is in discs; `cargo bench --bench lattice phases`.

use criterion::{Criterion, SamplingMode, Throughput};
use std::time::Duration;
use stripmine_physics::method::lattice_md::assemble;
use stripmine_physics::method::lattice_md::{CheckedGranularScene, GranularDocument};
use stripmine_physics::method::lattice_md::{Phase, SteppedGrains};

/// Steps before the timing: the initial lattice has no contacts.
pub const EQUILIBRATION: u64 = 400;
/// Phases with the time to measure each (ms). The rest of a step comes on top, so a short phase gets little.
const PHASES: [(Phase, u64); 3] = [(Phase::CorrectPredict, 300), (Phase::Index, 50), (Phase::Forces, 1000)];

pub fn advance(gas: &mut SteppedGrains, steps: u64) {
    (0..steps).for_each(|_| gas.step().expect("the bench scene runs on"));
}

/// Scene of a gas with friction, velocity Verlet, in the fast engine.
pub fn scene(packing_fraction: f64, count: usize, precision: &str) -> CheckedGranularScene {
    let overrides = [
        format!("particles.count={count}"),
        format!("particles.packing_fraction={packing_fraction}"),
        format!("machine.precision=\"{precision}\""),
        "machine.engine=fast".to_owned(),
        "search.by=lattice".to_owned(),
        "integrator.kind=\"velocity-verlet\"".to_owned(),
    ];
    GranularDocument::load("bench", &overrides).expect("a preset").check().expect("a good scene")
}

fn of_one_gas(criterion: &mut Criterion, packing_fraction: f64, count: usize, precision: &str) {
    let scene = scene(packing_fraction, count, precision);
    // Created on first use: most calls run few of the benches.
    let mut moving: Option<SteppedGrains> = None;
    let mut group = criterion.benchmark_group(format!("phases/{precision}/{packing_fraction}/{count}"));
    group.throughput(Throughput::Elements(scene.particles.grain_count() as u64));
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for (phase, milliseconds) in PHASES {
        let time = Duration::from_millis(milliseconds);
        group.measurement_time(time).warm_up_time(time / 10);
        group.bench_function(phase.name(), |bencher| {
            let gas = moving.get_or_insert_with(|| {
                let mut gas = assemble(&scene).expect("a start without conflicts");
                advance(&mut gas, EQUILIBRATION);
                gas
            });
            bencher.iter_custom(|steps| {
                gas.reset_timings();
                advance(gas, steps);
                Duration::from_secs_f64(gas.timings().seconds(phase))
            });
        });
    }
    group.finish();
}

pub fn phases(criterion: &mut Criterion) {
    for precision in ["f64", "f32", "mixed"] {
        for packing_fraction in [0.84, 0.3, 0.03] {
            for count in [10_000, 100_000] {
                of_one_gas(criterion, packing_fraction, count, precision);
            }
        }
    }
}
