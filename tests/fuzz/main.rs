//! Readers under mutated inputs: any bytes give a result or a typed error, in bounded memory and work.
//!
//! Each case is a seed (a valid input, or one of `corpus/`) with some mutations; a failing case is reduced to the
//! fewest mutations that fail and printed. Cases are the same in every run. `STRIPMINE_FUZZ_CASES` sets their number.
//! Inputs of fixed failures are kept in `corpus/` and also read without mutations.

mod allocations;
mod edges;
mod mutation;
mod readers;
mod runs;
mod snapshots;

use mutation::Mutation;
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, TestRng, TestRunner};

/// Inputs of earlier failures.
pub(crate) fn corpus(kind: &str) -> Vec<Vec<u8>> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(kind);
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    files.sort();
    files.into_iter().map(|file| std::fs::read(file).unwrap()).collect()
}

/// Reads every seed and `cases` mutated ones; none may request more than `most` bytes of memory in total.
pub(crate) fn fuzz(seeds: &[Vec<u8>], cases: u32, most: u64, read: impl Fn(&[u8])) {
    fuzz_with(mutation::some(), seeds, cases, most, read);
}

/// Like [`fuzz`], with mutations of a given kind.
pub(crate) fn fuzz_with(
    mutations: impl Strategy<Value = Vec<Mutation>>,
    seeds: &[Vec<u8>],
    cases: u32,
    most: u64,
    read: impl Fn(&[u8]),
) {
    assert!(!seeds.is_empty());
    let bounded = |input: &[u8]| {
        let taken = allocations::counted(|| read(input));
        assert!(taken <= most, "{taken} bytes were allocated for an input of {}", input.len());
    };
    seeds.iter().for_each(|seed| bounded(seed));
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 2000, ..Config::default() };
    let rng = TestRng::from_seed(proptest::test_runner::RngAlgorithm::ChaCha, &[7; 32]);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let case = (0..seeds.len(), mutations);
    let outcome = runner.run(&case, |(seed, mutations): (usize, Vec<Mutation>)| {
        let mut input = seeds[seed].clone();
        mutations.iter().for_each(|mutation| mutation.apply(&mut input, seeds));
        bounded(&input);
        Ok(())
    });
    if let Err(failure) = outcome {
        panic!("{failure}");
    }
}

/// Number of cases: `few` in ordinary test runs, `STRIPMINE_FUZZ_CASES` in long ones.
pub(crate) fn cases(few: u32) -> u32 {
    std::env::var("STRIPMINE_FUZZ_CASES").map_or(few, |text| text.parse().unwrap())
}
