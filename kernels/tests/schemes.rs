//! Custom schemes: their context beside the state. Noise depends on seed, disc and step alone.

use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Registers;
use stripmine_kernels::integrator::langevin::{Baoab, Bath, Stochastic};
use stripmine_kernels::integrator::{Context, DERIVATIVES, Draws, Inertia, Scheme};
use stripmine_kernels::noise::{NoiseSource, RandomPurpose, draw};
use stripmine_kernels::sweep::fast::{
    Advance, DisplacementLimit, EquationOfMotion, ForceRecords, StateRecords,
};

/// Moves discs by dt times noise, along x by the first number and along y by the second.
#[derive(Clone, Copy, Debug)]
struct Diffusion;

impl Scheme for Diffusion {
    const CARRIED: usize = 2;
    const DRAWS: Draws = Draws::InPredictor;

    fn scales(_: f64) -> [f64; DERIVATIVES] {
        [1.0; DERIVATIVES]
    }

    fn begin<R: Registers>(&self, _: &Context<R>, _: &mut [R::V; DERIVATIVES], _: R::V) {}

    fn correct<R: Registers>(&self, _: &Context<R>, _: &mut [R::V; DERIVATIVES], _: R::V) {}

    fn predict<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES]) {
        row[0] = row[0] + context.uniform(context.dt()) * context.normal();
    }
}

const DT: f64 = 0.125;
const SEED: u64 = 11;
const STEPS: u64 = 3;
const INVERSE_MASS: f64 = 2.0;

/// The two numbers of a disc in a step.
fn normals(id: u32, step: u64) -> [f64; 2] {
    let (mut x, mut y) = ([0.0], [0.0]);
    draw(SEED, RandomPurpose::Thermostat, step, &[id], [&mut x, &mut y]);
    [x[0], y[0]]
}

/// Positions of the discs after some steps, by id; `force` is a function of the position along each axis.
fn places<C: Scheme>(
    motion: &EquationOfMotion<C>,
    force: impl Fn(f64) -> f64,
    (ids, steps): (&[u32], u64),
    set: InstructionSet,
) -> Vec<[f64; 2]> {
    let n = ids.len();
    let mut records = StateRecords::<f64>::zeros(0, n, [false; 2], 1.0);
    let mut sums = ForceRecords::<f64>::zeros(0, n);
    let mut higher = vec![vec![vec![0.0; n]; C::CARRIED - 2]; 2];
    for step in 0..steps {
        let advance = Advance {
            motion,
            freedoms: 2,
            records: &mut records,
            higher: higher.iter_mut().map(|row| row.iter_mut().map(Vec::as_mut_slice).collect()).collect(),
            sums: &mut sums,
            inverse_inertia: &[],
            discs: 0..n,
            step,
            ids,
            corrected: step == 0,
            longest_step: f64::INFINITY,
        };
        advance.run(DisplacementLimit::Cell([1e9, 1e9]), None, set).unwrap();
        for disc in 0..n {
            let place = records.position(disc);
            (0..2).for_each(|axis| sums.set(axis, disc, force(place[axis])));
        }
    }
    let mut places = vec![[0.0; 2]; n];
    for (disc, &id) in ids.iter().enumerate() {
        places[id as usize] = records.position(disc);
    }
    places
}

fn motion<C>(scheme: C, dt: f64) -> EquationOfMotion<C> {
    let inertia = Inertia::Equal { inverse_mass: INVERSE_MASS, inverse_inertia: 1.0 };
    EquationOfMotion { scheme, dt, inertia, gravity: [0.0; 2], noise: NoiseSource::new(SEED) }
}

#[test]
fn noise_depends_on_seed_disc_and_step_alone() {
    let n = 3001;
    let in_order: Vec<u32> = (0..n).collect();
    let backwards: Vec<u32> = (0..n).rev().collect();
    let mut expected = vec![[0.0; 2]; n as usize];
    for (id, place) in expected.iter_mut().enumerate() {
        for step in 1..=STEPS {
            let drawn = normals(id as u32, step);
            (0..2).for_each(|axis| place[axis] += DT * drawn[axis]);
        }
    }
    for set in InstructionSet::available() {
        for ids in [&in_order, &backwards] {
            let found = places(&motion(Diffusion, DT), |_| 0.0, (ids, STEPS), set);
            assert!(found == expected, "{}", set.name());
        }
    }
}

/// For free discs with steps three times as long, each number combines three. They are compared with the recursion v' = c v + s
/// ξ.
#[test]
fn long_steps_combine_noise_of_parts() {
    const PARTS: u32 = 3;
    let ids: Vec<u32> = (0..600).collect();
    let noise = NoiseSource { seed: SEED, parts: PARTS };
    let numbers = |id: u32, step: u64| [3 * step - 2, 3 * step - 1, 3 * step].map(|part| normals(id, part));
    for set in InstructionSet::available() {
        let sums = EquationOfMotion { noise, ..motion(Diffusion, DT) };
        let exact = EquationOfMotion { noise, ..motion(Baoab::new(BATH, DT, 1.0 / INVERSE_MASS), DT) };
        let [sums, exact] =
            [places(&sums, |_| 0.0, (&ids, STEPS), set), places(&exact, |_| 0.0, (&ids, STEPS), set)];
        for &id in &ids {
            let [decay, long] = [DT / 3.0, DT].map(|time| (-BATH.friction * INVERSE_MASS * time).exp());
            let spread = |decay: f64| (BATH.temperature * INVERSE_MASS * (1.0 - decay * decay)).sqrt();
            for axis in 0..2 {
                let (mut place, mut r, mut v) = (0.0, 0.0, 0.0);
                for step in 1..=STEPS {
                    let [a, b, c] = numbers(id, step).map(|pair| pair[axis]);
                    place += DT * (a + b + c) / 3f64.sqrt();
                    r += 0.5 * DT * v;
                    let of_parts = spread(decay) * (decay * decay * a + decay * b + c);
                    v = long * v + of_parts;
                    r += 0.5 * DT * v;
                }
                let (found, by_hand) = ([sums[id as usize][axis], exact[id as usize][axis]], [place, r]);
                let is_near = |(found, by_hand): (f64, f64)| (found - by_hand).abs() < 1e-13;
                assert!(found.into_iter().zip(by_hand).all(is_near), "{}: {found:?} {by_hand:?}", set.name());
            }
        }
    }
}

const BATH: Bath = Bath { friction: 0.75, temperature: 0.75 };

/// BAOAB in plain numbers, disc by disc.
fn naive_baoab(id: u32, steps: u64, stiffness: f64) -> [f64; 2] {
    let (mut r, mut v) = ([0.0; 2], [0.0; 2]);
    let kept = libm::exp(-BATH.friction * INVERSE_MASS * DT);
    let spread = (BATH.temperature * (1.0 - kept * kept) * INVERSE_MASS).sqrt();
    for step in 1..=steps {
        let noise = normals(id, step);
        for axis in 0..2 {
            let pull = |r: f64| -stiffness * r * INVERSE_MASS;
            v[axis] += 0.5 * DT * pull(r[axis]);
            r[axis] += 0.5 * DT * v[axis];
            v[axis] = kept * v[axis] + spread * noise[axis];
            r[axis] += 0.5 * DT * v[axis];
            v[axis] += 0.5 * DT * pull(r[axis]);
        }
    }
    r
}

/// Scheme of LAN17 in plain numbers, with friction from the velocity after half a kick or, as printed, from that of the previous
/// step.
fn naive_stochastic(id: u32, steps: u64, stiffness: f64, old: bool) -> [f64; 2] {
    let strength = (2.0 * BATH.friction * BATH.temperature / DT).sqrt();
    let (mut r, mut v) = ([0.0; 2], [0.0; 2]);
    let noise = normals(id, 0);
    let mut a = noise.map(|noise| (strength * noise - BATH.friction * 0.0) * INVERSE_MASS);
    for step in 1..=steps {
        let noise = normals(id, step);
        for axis in 0..2 {
            v[axis] += 0.5 * DT * a[axis];
            r[axis] += DT * v[axis];
            if step == steps {
                continue;
            }
            let slowed = if old { v[axis] - 0.5 * DT * a[axis] } else { v[axis] };
            let pull = -stiffness * r[axis] * INVERSE_MASS;
            a[axis] = pull + (strength * noise[axis] - BATH.friction * slowed) * INVERSE_MASS;
            v[axis] += 0.5 * DT * a[axis];
        }
    }
    r
}

/// Schemes with friction and noise receive force, mass and noise, and move discs as plain numbers do.
#[test]
fn langevin_schemes_match_plain_numbers() {
    fn hold<C: Scheme>(scheme: C, expected: impl Fn(u32) -> [f64; 2]) {
        let ids: Vec<u32> = (0..1003).rev().collect();
        let expected: Vec<[f64; 2]> = (0..1003).map(expected).collect();
        for set in InstructionSet::available() {
            let found = places(&motion(scheme, DT), |r| -3.0 * r, (&ids, 40), set);
            for (found, expected) in found.iter().zip(&expected) {
                assert!((0..2).all(|axis| (found[axis] - expected[axis]).abs() < 1e-12), "{}", set.name());
            }
        }
    }
    hold(Baoab::new(BATH, DT, 1.0 / INVERSE_MASS), |id| naive_baoab(id, 40, 3.0));
    hold(Stochastic::<false> { bath: BATH }, |id| naive_stochastic(id, 40, 3.0, false));
    hold(Stochastic::<true> { bath: BATH }, |id| naive_stochastic(id, 40, 3.0, true));
}

/// In a harmonic trap BAOAB has ⟨r²⟩ = kT/k for every step, here with ω dt = 0.7.
#[test]
fn baoab_has_the_boltzmann_width() {
    let bath = Bath { friction: 0.5, temperature: 0.5 };
    let ids: Vec<u32> = (0..8000).collect();
    let scheme = Baoab::new(bath, 0.5, 0.5);
    let found = places(&motion(scheme, 0.5), |r| -r, (&ids, 60), InstructionSet::best());
    let width = found.as_flattened().iter().map(|r| r * r).sum::<f64>() / 16_000.0;
    // The mean of 16 000 squares has a standard error of 1.1 %.
    assert!((width / 0.5 - 1.0).abs() < 0.04, "{width}");
}
