//! Cost of a whole step beside its force sweep, and of its checks.
//!
//! The discs move: every iteration is a step. Throughput is in discs; `cargo bench --bench lattice step`.

use crate::scenery::dense;
use criterion::{Criterion, Throughput};
use std::time::Duration;
use stripmine_kernels::ledger::VectorLength;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::{
    ContactWatch, GranularModel, Part, ProgramArrays, StepProgram, execute, programs,
};
use stripmine_physics::scene::Precision;

/// Programs without the check for lost discs: the last kernel of the Index that runs over discs.
fn without_check(mut programs: Vec<StepProgram>) -> Vec<StepProgram> {
    let check =
        programs.iter().rposition(|step| step.part == Part::Index && step.length == VectorLength::Discs);
    programs.remove(check.expect("a step has an Index"));
    programs
}

pub fn step(criterion: &mut Criterion) {
    let (model, particles, _) = dense::<f64>(100_000, true);
    let watched = GranularModel { watch: Some(ContactWatch::new(0.1, 0.3, 0.5)), ..model.clone() };
    let cases = [
        ("with the checks", &watched, programs(&watched, Precision::F64), Part::ALL),
        ("without the checks", &model, without_check(programs(&model, Precision::F64)), Part::ALL),
        ("forces alone, without the checks", &model, programs(&model, Precision::F64), &[Part::Forces]),
    ];
    let mut group = criterion.benchmark_group("step/f64/friction/100000");
    group.throughput(Throughput::Elements(particles.len() as u64)).sample_size(20);
    group.measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    for (name, model, programs, parts) in &cases {
        let mut arrays = ProgramArrays::<f64, f64>::new(model, &particles);
        let mut run = |parts: &[Part]| {
            let (memory, lengths) = arrays.memory();
            execute(programs, parts, &memory, lengths, Execution::Chained, InstructionSet::best())
                .expect("bound");
        };
        run(Part::ALL);
        group.bench_function(*name, |bencher| bencher.iter(|| run(parts)));
    }
    group.finish();
}
