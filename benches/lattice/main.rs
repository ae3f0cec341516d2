//! Benches of the lattice method, one file a question. One program, because every bench that steps compiles the texts for
//! every instruction set again.

mod forces;
mod intrinsics;
mod phases;
mod scenery;
mod search;
mod step;

use criterion::{Criterion, criterion_group, criterion_main};

/// One core for all: the loop by hand uses one.
fn alone(_: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first pool");
}

criterion_group!(benches, alone, forces::forces, step::step, phases::phases, search::search);
criterion_main!(benches);
