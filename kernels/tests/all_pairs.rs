//! All-pairs sweep compared with the formula evaluated pair by pair.

use rand::RngExt;
use std::sync::atomic::{AtomicUsize, Ordering};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::gravity::Gravity;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::sweep::all_pairs::{
    AllPairs, AllPairsOptions, Arithmetic, BANDS, BodyColumns, padded_length, padding_position,
};

fn never() -> bool {
    false
}

/// Options that observe everything and never stop.
fn manner(arithmetic: Arithmetic, set: InstructionSet) -> AllPairsOptions<'static> {
    AllPairsOptions { observed: true, arithmetic, set, interrupted: &never }
}

/// Bodies at random positions in a cube, with velocities and masses; padding behind them.
struct System<P> {
    count: usize,
    position: [Vec<P>; 3],
    /// Rounding residues of the positions in single precision.
    rest: [Vec<P>; 3],
    velocity: [Vec<P>; 3],
    mass: Vec<P>,
}

impl<P: Precision> System<P> {
    fn random(count: usize, seed: u64) -> Self {
        let mut random = Stream::new(seed, RandomPurpose::Test, 0);
        let entries = padded_length(count);
        let mut column = |from: f64, to: f64| -> Vec<P> {
            let bodies = (0..count).map(|_| P::from_f64(random.random_range(from..to)));
            let mut column: Vec<P> = bodies.collect();
            column.resize(entries, P::default());
            column
        };
        let mut position = [0, 1, 2].map(|_| column(-1.0, 1.0));
        position[0][count..].iter_mut().enumerate().for_each(|(n, x)| *x = padding_position(n));
        System {
            count,
            position,
            rest: std::array::from_fn(|_| vec![P::default(); entries]),
            velocity: [0, 1, 2].map(|_| column(-1.0, 1.0)),
            mass: column(0.5 / count as f64, 1.5 / count as f64),
        }
    }

    /// Sums, energy and virial of the sweep.
    fn swept<const RATE: bool, const SUMS: usize>(
        &self,
        softening: f64,
        arithmetic: Arithmetic,
        set: InstructionSet,
    ) -> ([Vec<P>; SUMS], [f64; 2]) {
        let bodies = BodyColumns {
            position: self.position.each_ref().map(Vec::as_slice),
            rest: self.rest.each_ref().map(Vec::as_slice),
            velocity: self.velocity.each_ref().map(Vec::as_slice),
            mass: &self.mass,
        };
        let mut sums: [Vec<P>; SUMS] = std::array::from_fn(|_| vec![P::default(); self.mass.len()]);
        let law = Gravity::<RATE> { softening };
        let into = sums.each_mut().map(Vec::as_mut_slice);
        let energy = AllPairs::<P, SUMS>::new(self.count)
            .sweep(&law, &bodies, into, &manner(arithmetic, set))
            .expect("the processor has the set");
        (sums, energy)
    }

    fn vector(column: &[Vec<P>; 3], body: usize) -> [f64; 3] {
        column.each_ref().map(|axis| axis[body].to_f64())
    }

    /// Displaced copy of the bodies, with positions rounded to single precision and their residues.
    fn moved(mut self, by: f64) -> Self {
        for (column, rest) in self.position.iter_mut().zip(&mut self.rest) {
            for (x, rest) in column.iter_mut().zip(rest).take(self.count) {
                let exact = x.to_f64() + by;
                *x = P::from_f64(exact);
                *rest = P::from_f64(exact - x.to_f64());
            }
        }
        self
    }

    /// Copy of the bodies, `times` as far from the origin.
    fn spread(mut self, times: f64) -> Self {
        for column in &mut self.position {
            column[..self.count].iter_mut().for_each(|x| *x = P::from_f64(times * x.to_f64()));
        }
        self
    }

    fn place(&self, body: usize) -> [f64; 3] {
        let [place, rest] = [&self.position, &self.rest].map(|columns| Self::vector(columns, body));
        [0, 1, 2].map(|axis| place[axis] + rest[axis])
    }

    /// Sums of a body from the formula, one partner after the other in double precision, and half of its pairs' energy.
    fn written_down(&self, body: usize, softening: f64) -> ([f64; 6], f64) {
        let (r, v, m) = (self.place(body), Self::vector(&self.velocity, body), self.mass[body].to_f64());
        let (mut sums, mut energy) = ([0.0; 6], 0.0);
        for other in (0..self.count).filter(|&other| other != body) {
            let (there, velocity) = (self.place(other), Self::vector(&self.velocity, other));
            let d = [0, 1, 2].map(|axis| r[axis] - there[axis]);
            let change = [0, 1, 2].map(|axis| v[axis] - velocity[axis]);
            let square = d.iter().map(|d| d * d).sum::<f64>() + softening * softening;
            let along = (0..3).map(|axis| d[axis] * change[axis]).sum::<f64>();
            let masses = m * self.mass[other].to_f64();
            for axis in 0..3 {
                sums[axis] -= masses * d[axis] / square.powf(1.5);
                let rate = change[axis] / square.powf(1.5) - 3.0 * along * d[axis] / square.powf(2.5);
                sums[3 + axis] -= masses * rate;
            }
            energy -= 0.5 * masses / square.sqrt();
        }
        (sums, energy)
    }
}

/// Largest deviation from the formula, relative to the largest sum of its kind.
fn error<P: Precision, const RATE: bool, const SUMS: usize>(
    count: usize,
    softening: f64,
    arithmetic: Arithmetic,
    set: InstructionSet,
) -> f64 {
    error_of::<P, RATE, SUMS>(&System::random(count, 5), softening, arithmetic, set)
}

fn error_of<P: Precision, const RATE: bool, const SUMS: usize>(
    system: &System<P>,
    softening: f64,
    arithmetic: Arithmetic,
    set: InstructionSet,
) -> f64 {
    let count = system.count;
    let (sums, [energy, virial]) = system.swept::<RATE, SUMS>(softening, arithmetic, set);
    let (mut largest, mut worst, mut potential) = ([0.0_f64; 2], [0.0_f64; 2], 0.0);
    for body in 0..count {
        let (expected, share) = system.written_down(body, softening);
        potential += share;
        for (number, sum) in sums.iter().enumerate() {
            let kind = number / 3;
            largest[kind] = largest[kind].max(expected[number].abs());
            worst[kind] = worst[kind].max((sum[body].to_f64() - expected[number]).abs());
        }
    }
    let relative = (energy / potential - 1.0).abs();
    assert!(
        arithmetic == Arithmetic::Raw || relative < 20.0 * if P::BYTES == 4 { 1e-6 } else { 1e-14 },
        "energy of {count}: {energy} {potential}"
    );
    if softening == 0.0 {
        assert!(
            (virial / energy - 1.0).abs() < 1e-5,
            "the virial of 1/r must be its energy: {virial} {energy}"
        );
    }
    (0..SUMS / 3).map(|kind| worst[kind] / largest[kind]).fold(0.0, f64::max)
}

#[test]
fn sums_match_the_pair_formula() {
    for count in [2, 3, 16, 17, 100, 301] {
        for softening in [0.0, 0.05] {
            for set in InstructionSet::available() {
                for (arithmetic, [single, double]) in
                    [(Arithmetic::Exact, [3e-6, 3e-15]), (Arithmetic::Estimated, [3e-6, 4e-15])]
                {
                    let found = [
                        error::<f32, false, 3>(count, softening, arithmetic, set),
                        error::<f64, false, 3>(count, softening, arithmetic, set),
                        error::<f64, true, 6>(count, softening, arithmetic, set),
                    ];
                    let here =
                        format!("{count} bodies, softening {softening}, {arithmetic:?}, {}", set.name());
                    assert!(
                        found[0] < single && found[1] < double && found[2] < 10.0 * double,
                        "{here}: {found:?}"
                    );
                }
            }
        }
    }
}

/// Without correction, estimates are accurate to four digits if there is such an instruction, and no more.
#[test]
fn raw_estimates_are_coarse() {
    let set = InstructionSet::best();
    let [raw, corrected] = [Arithmetic::Raw, Arithmetic::Estimated]
        .map(|arithmetic| error::<f32, false, 3>(301, 0.05, arithmetic, set));
    assert!(raw < 1e-3 && corrected < 3e-6, "{raw} {corrected}");
    if matches!(set, InstructionSet::Avx2 | InstructionSet::Avx512) {
        assert!(raw > 10.0 * corrected, "{raw} {corrected}");
    }
}

/// Single precision resolves distances between bodies as well a thousand lengths from the origin as near it.
#[test]
fn single_precision_forces_ignore_the_origin() {
    for arithmetic in [Arithmetic::Exact, Arithmetic::Estimated] {
        for set in InstructionSet::available() {
            let of = |by| System::<f32>::random(65, 9).moved(by);
            let far = error_of::<f32, false, 3>(&of(1000.0), 0.0, arithmetic, set);
            let rates = error_of::<f32, true, 6>(&of(1000.0), 0.0, arithmetic, set);
            assert!(far < 3e-6 && rates < 3e-5, "{far} {rates} by {}", set.name());
        }
    }
}

/// Bodies at positions where numbers are coarser than 1 attract each other as others do, with and without padding behind them.
#[test]
fn far_bodies_attract_each_other_without_softening() {
    for (count, double, single) in [(16, 1e16, 1e8), (17, 1e16, 1e8), (37, 1e40, 3e7), (5, 1e55, 1e6)] {
        for set in InstructionSet::available() {
            for arithmetic in [Arithmetic::Exact, Arithmetic::Estimated] {
                let found = [
                    error_of::<f64, false, 3>(&System::random(count, 5).spread(double), 0.0, arithmetic, set),
                    error_of::<f64, true, 6>(&System::random(count, 5).spread(double), 0.0, arithmetic, set),
                    error_of::<f32, false, 3>(&System::random(count, 5).spread(single), 0.0, arithmetic, set),
                ];
                let here = format!("{count} bodies, {arithmetic:?}, {}: {found:?}", set.name());
                assert!(found[0] < 4e-15 && found[1] < 4e-14 && found[2] < 4e-6, "{here}");
            }
        }
    }
}

/// Bits of sums, energy and virial.
fn bits<P: Precision, const SUMS: usize>((sums, observed): ([Vec<P>; SUMS], [f64; 2])) -> Vec<u64> {
    sums.iter().flatten().map(|sum| sum.to_f64()).chain(observed).map(f64::to_bits).collect()
}

/// Bits of exact sums, energy and virial depend neither on the instruction set nor on the number of threads. Bits of estimates do
/// not depend on the number of threads.
#[test]
fn bits_depend_on_the_bodies_alone() {
    let system = System::<f64>::random(777, 2);
    let single = System::<f32>::random(777, 2);
    let on = |threads: usize, work: &(dyn Fn() -> Vec<u64> + Sync)| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
    };
    let exact = |set| {
        let double = bits(system.swept::<true, 6>(0.01, Arithmetic::Exact, set));
        [double, bits(single.swept::<false, 3>(0.01, Arithmetic::Exact, set))].concat()
    };
    let oracle = on(1, &|| exact(InstructionSet::Scalar));
    for set in InstructionSet::available() {
        for threads in [1, 3, 4] {
            assert!(on(threads, &|| exact(set)) == oracle, "{} on {threads} threads", set.name());
        }
        let estimated = || bits(system.swept::<false, 3>(0.01, Arithmetic::Estimated, set));
        assert!(on(1, &estimated) == on(4, &estimated), "estimates by {}", set.name());
    }
}

/// The forces of every pair are opposite: the sum over all bodies is rounding error.
#[test]
fn total_momentum_is_conserved() {
    let system = System::<f64>::random(1000, 3);
    for arithmetic in [Arithmetic::Exact, Arithmetic::Estimated] {
        let (forces, _) = system.swept::<false, 3>(0.01, arithmetic, InstructionSet::best());
        for axis in forces {
            let magnitude: f64 = axis.iter().map(|force| force.abs()).sum();
            assert!(axis.iter().sum::<f64>().abs() < 1e-15 * magnitude);
        }
    }
}

#[test]
fn too_short_columns_are_rejected() {
    let (short, zeros) = (vec![0.0_f64; 16], vec![0.0_f64; 32]);
    let law = Gravity::<true> { softening: 0.1 };
    let mut sums: [Vec<f64>; 6] = std::array::from_fn(|_| zeros.clone());
    let mut sweep = |position: &[f64], velocity: &[f64]| {
        let bodies =
            BodyColumns { position: [position; 3], rest: [&[]; 3], velocity: [velocity; 3], mass: &zeros };
        let into = sums.each_mut().map(Vec::as_mut_slice);
        AllPairs::<f64, 6>::new(20).sweep(
            &law,
            &bodies,
            into,
            &manner(Arithmetic::Exact, InstructionSet::Scalar),
        )
    };
    assert!(matches!(sweep(&short, &zeros), Err(ProgramError::TooShort { .. })));
    assert!(matches!(sweep(&zeros, &[]), Err(ProgramError::TooShort { .. })));
    assert!(sweep(&zeros, &zeros).is_ok());
    let mut three: [Vec<f64>; 3] = std::array::from_fn(|_| zeros.clone());
    let bodies = BodyColumns { position: [&zeros; 3], rest: [&[]; 3], velocity: [&zeros; 3], mass: &zeros };
    let into = three.each_mut().map(Vec::as_mut_slice);
    let manner = manner(Arithmetic::Exact, InstructionSet::Scalar);
    let rates = AllPairs::<f64, 3>::new(20).sweep(&law, &bodies, into, &manner);
    assert!(
        matches!(rates, Err(ProgramError::Unstated(_))),
        "a law with rates was accepted without columns for them"
    );
}

/// A sweep checks between groups of bodies for an interruption and reports it; the next sweep has the bits of an uninterrupted
/// one.
#[test]
fn a_sweep_stops_between_groups() {
    let system = System::<f64>::random(1000, 4);
    let whole = bits(system.swept::<false, 3>(0.01, Arithmetic::Exact, InstructionSet::best()));
    let groups = padded_length(1000) / 16;
    let mut sweep = AllPairs::<f64, 3>::new(1000);
    for threads in [1, 4] {
        for (most, stops) in [(0, true), (1, true), (groups - 1, true), (groups, false)] {
            let asked = AtomicUsize::new(0);
            let interrupted = || asked.fetch_add(1, Ordering::Relaxed) >= most;
            let manner = AllPairsOptions {
                interrupted: &interrupted,
                ..manner(Arithmetic::Exact, InstructionSet::best())
            };
            let mut sums: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; system.mass.len()]);
            let bodies = BodyColumns {
                position: system.position.each_ref().map(Vec::as_slice),
                rest: [&[]; 3],
                velocity: [&[]; 3],
                mass: &system.mass,
            };
            let law = Gravity::<false> { softening: 0.01 };
            let into = sums.each_mut().map(Vec::as_mut_slice);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let done = pool.install(|| sweep.sweep(&law, &bodies, into, &manner));
            // No band continues after the interruption.
            assert!(asked.into_inner() <= most + BANDS);
            match (stops, done) {
                (true, done) => assert_eq!(done, Err(ProgramError::Interrupted), "{most}"),
                (false, done) => assert_eq!(bits((sums, done.expect("not stopped"))), whole),
            }
        }
    }
}
