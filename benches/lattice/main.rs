//! Benches of the lattice method, one file per question. They are one program, because every bench that steps compiles the
//! kernels for every instruction set.

mod forces;
mod intrinsics;
mod phases;
mod scenery;
mod search;
mod step;

use criterion::{Criterion, criterion_group, criterion_main};

/// Uses one core for all benches, as the hand-written loop does.
fn alone(_: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first pool");
}

criterion_group!(benches, alone, forces::forces, step::step, phases::phases, search::search);
criterion_main!(benches);
