//! What a scheme of one's own gets beside the state: noise that depends on seed, disc and step alone.

use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Registers;
use stripmine_kernels::integrator::{Context, DERIVATIVES, Inertia, Scheme};
use stripmine_kernels::noise::{Purpose, normals};
use stripmine_kernels::sweep::fast::{Advance, DisplacementLimit, Motion};

/// Moves discs by dt times noise, along x by the first number and along y by the second.
#[derive(Clone, Copy, Debug)]
struct Diffusion;

impl Scheme for Diffusion {
    const CARRIED: usize = 2;
    const DRAWS: bool = true;

    fn scales(_: f64) -> [f64; DERIVATIVES] {
        [1.0; DERIVATIVES]
    }

    fn begin<R: Registers>(&self, _: &Context<'_, R>, _: &mut [R::V; DERIVATIVES], _: R::V) {}

    fn correct<R: Registers>(&self, _: &Context<'_, R>, _: &mut [R::V; DERIVATIVES], _: R::V) {}

    fn predict<R: Registers>(&self, context: &Context<'_, R>, row: &mut [R::V; DERIVATIVES]) {
        let noise = context.normals(Purpose::Test)[context.freedom()];
        row[0] = row[0] + context.uniform(context.dt()) * noise;
    }
}

const DT: f64 = 0.125;
const SEED: u64 = 11;
const STEPS: u64 = 3;

/// Places of the discs after some steps, by id.
fn places(ids: &[u32], set: InstructionSet) -> Vec<[f64; 2]> {
    let n = ids.len();
    let inertia = Inertia::Equal { inverse_mass: 1.0, inverse_inertia: 1.0 };
    let motion = Motion { scheme: Diffusion, dt: DT, inertia, gravity: [0.0; 2], seed: SEED };
    let mut columns = vec![vec![vec![0.0; n]; 2]; 2];
    let mut sums = vec![vec![0.0; n]; 2];
    for step in 0..STEPS {
        let advance = Advance {
            motion: &motion,
            state: columns.iter_mut().map(|row| row.iter_mut().map(Vec::as_mut_slice).collect()).collect(),
            sums: sums.iter_mut().map(Vec::as_mut_slice).collect::<Vec<&mut [f64]>>(),
            inverse: [&[], &[]],
            discs: n,
            step,
            ids,
            corrected: false,
            longest_step: f64::INFINITY,
        };
        advance.run(DisplacementLimit::Cell([1e9, 1e9]), None, set).unwrap();
    }
    let mut places = vec![[0.0; 2]; n];
    for (disc, &id) in ids.iter().enumerate() {
        places[id as usize] = [columns[0][0][disc], columns[1][0][disc]];
    }
    places
}

#[test]
fn noise_depends_on_seed_disc_and_step_alone() {
    let n = 3001;
    let in_order: Vec<u32> = (0..n).collect();
    let backwards: Vec<u32> = (0..n).rev().collect();
    let mut expected = vec![[0.0; 2]; n as usize];
    for (id, place) in expected.iter_mut().enumerate() {
        for step in 1..=STEPS {
            let drawn = normals(SEED, Purpose::Test, id as u32, step);
            (0..2).for_each(|axis| place[axis] += DT * drawn[axis]);
        }
    }
    for set in InstructionSet::available() {
        assert!(places(&in_order, set) == expected, "{}", set.name());
        assert!(places(&backwards, set) == expected, "{}", set.name());
    }
}
