//! Velocity Verlet: state, order and exact solutions; kernels and the fast pass give the same bits.

use stripmine_kernels::integrator::gear::STATE;
use stripmine_kernels::integrator::velocity_verlet::{VelocityVerlet, VerletDrift, VerletKick};
use stripmine_kernels::integrator::{Inertia, Scheme};
use stripmine_kernels::isa::{Array, Memory, Slot};
use stripmine_kernels::noise::NoiseSource;
use stripmine_kernels::sweep::fast::{
    Advance, DisplacementLimit, EquationOfMotion, ForceRecords, RecordEntry, StateRecords,
};
use stripmine_kernels::{Execution, InstructionSet, Program};

const INERTIA: Inertia = Inertia::Equal { inverse_mass: 0.5, inverse_inertia: 4.0 };
const FREEDOMS: usize = 3;

/// One row of position, velocity and acceleration for each degree of freedom, one entry per disc.
type State = [[Vec<f64>; 3]; FREEDOMS];

/// Discs of different speeds, without acceleration.
fn start(discs: usize) -> State {
    let column = |freedom: usize, k: usize| match k {
        2 => vec![0.0; discs],
        _ => (0..discs).map(|disc| 0.3 + (disc + 2 * freedom + k) as f64 / 7.0).collect(),
    };
    std::array::from_fn(|freedom| std::array::from_fn(|k| column(freedom, k)))
}

/// A spring force with drag.
fn force(r: f64, v: f64) -> f64 {
    -2.0 * r - 0.25 * v
}

/// Runs the kernels; the initial accelerations are given.
fn by_programs(state: &mut State, dt: f64, gravity: [f64; 2], steps: usize, force: impl Fn(f64, f64) -> f64) {
    let discs = state[0][0].len();
    let (execution, set) = (Execution::Chained, InstructionSet::best());
    let drift = Program::new(VerletDrift::<f64, f64, FREEDOMS>::new(dt));
    let kick = Program::new(VerletKick::<f64, f64, FREEDOMS>::new(dt, INERTIA, gravity));
    let cell: Vec<u32> = (1..=discs as u32).collect();
    for _ in 0..steps {
        let mut velocity: [Vec<f64>; FREEDOMS] = std::array::from_fn(|_| vec![0.0; discs]);
        {
            let mut memory = Memory::new();
            for (arrays, row) in STATE.into_iter().zip(&mut *state) {
                for (array, q) in arrays.into_iter().zip(row) {
                    memory = memory.write(Slot::<f64>::new(array), q);
                }
            }
            let velocities = [Array::DiscVx, Array::DiscVy, Array::DiscOmega].into_iter().zip(&mut velocity);
            for (array, column) in velocities {
                memory = memory.write(Slot::<f64>::new(array), column);
            }
            drift.run(&memory, 0..discs, execution, set).unwrap();
        }
        let on = |freedom: usize| (0..discs).map(move |disc| (freedom, disc));
        let forces = [0, 1, 2].map(|freedom| {
            let at = on(freedom).map(|(freedom, disc)| (state[freedom][0][disc], velocity[freedom][disc]));
            at.map(|(r, v)| force(r, v)).collect::<Vec<f64>>()
        });
        let mut memory = Memory::new();
        for (arrays, row) in STATE.into_iter().zip(&mut *state) {
            for (array, q) in arrays.into_iter().zip(row) {
                memory = memory.write(Slot::<f64>::new(array), q);
            }
        }
        for (array, column) in [Array::Fx, Array::Fy, Array::Torque].into_iter().zip(&forces) {
            memory = memory.read(Slot::<f64>::new(array), column);
        }
        let memory = memory.read(Slot::new(Array::DiscCell), &cell);
        kick.run(&memory, 0..discs, execution, set).unwrap();
    }
}

/// Runs the fast pass, which leaves predicted states; the last one is corrected as an observer does it.
fn by_passes(state: &State, dt: f64, gravity: [f64; 2], steps: u64) -> [[Vec<f64>; 2]; FREEDOMS] {
    let discs = state[0][0].len();
    let motion = EquationOfMotion {
        scheme: VelocityVerlet,
        dt,
        inertia: INERTIA,
        gravity,
        noise: NoiseSource::new(0),
    };
    let mut records = StateRecords::<f64>::zeros(0, discs, [true, false], 1.0);
    // Forces that give the initial accelerations, without gravity.
    let mut sums = ForceRecords::<f64>::zeros(0, discs);
    for (freedom, row) in state.iter().enumerate() {
        let inverse = INERTIA.inverse(freedom, |value| value, || f64::NAN);
        let gravity = gravity.get(freedom).copied().unwrap_or(0.0);
        for (k, column) in row[..2].iter().enumerate() {
            records.fill(RecordEntry::of(freedom, k), |disc| column.get(disc).copied().unwrap_or(0.0));
        }
        for (disc, acceleration) in row[2].iter().enumerate() {
            sums.set(freedom, disc, (acceleration - gravity) / inverse);
        }
    }
    let entry =
        |records: &StateRecords<f64>, freedom, k, disc| records.get(RecordEntry::of(freedom, k), disc);
    for step in 0..steps {
        let advance = Advance {
            motion: &motion,
            freedoms: FREEDOMS,
            records: &mut records,
            higher: (0..FREEDOMS).map(|_| vec![]).collect(),
            sums: &mut sums,
            inverse_inertia: &[],
            discs: 0..discs,
            step,
            ids: &[],
            corrected: step == 0,
            longest_step: f64::INFINITY,
        };
        advance.run(DisplacementLimit::Cell([1e9, 1e9]), None, InstructionSet::best()).unwrap();
        for (freedom, disc) in (0..FREEDOMS).flat_map(|freedom| (0..discs).map(move |disc| (freedom, disc))) {
            let [r, v] = [0, 1].map(|k| entry(&records, freedom, k, disc));
            sums.set(freedom, disc, force(r, v));
        }
    }
    std::array::from_fn(|freedom| {
        let inverse = INERTIA.inverse(freedom, |value| value, || f64::NAN);
        let corrected = |disc: usize| {
            let [r, v] = [0, 1].map(|k| entry(&records, freedom, k, disc));
            let predicted = [r, v, 0.0, 0.0, 0.0, 0.0];
            motion.corrected(freedom, predicted, sums.of(disc)[freedom], inverse, f64::NAN)
        };
        [0, 1].map(|k| (0..discs).map(|disc| corrected(disc)[k]).collect())
    })
}

#[test]
fn the_state_is_in_scene_units() {
    assert_eq!(VelocityVerlet::scales(1e-3)[..3], [1.0; 3]);
    // Without forces a disc keeps its velocity to the bit, for any dt.
    let mut state = start(5);
    let before = state.clone();
    by_programs(&mut state, 1e-3, [0.0; 2], 7, |_, _| 0.0);
    for (row, before) in state.iter().zip(&before) {
        assert_eq!(row[1], before[1]);
        for (r, (r0, v)) in row[0].iter().zip(before[0].iter().zip(&before[1])) {
            assert!((r - (r0 + 7e-3 * v)).abs() < 1e-14, "{r}");
        }
    }
}

#[test]
fn programs_and_passes_give_the_same_bits() {
    for gravity in [[0.0, 0.0], [0.25, -1.5]] {
        let begin = start(37);
        let mut state = begin.clone();
        for row in state.iter_mut().take(2) {
            row[2].fill(0.0);
        }
        let passes = by_passes(&state, 0.0625, gravity, 20);
        by_programs(&mut state, 0.0625, gravity, 20, force);
        for (row, passed) in state.iter().zip(&passes) {
            assert_eq!(row[..2], passed[..]);
        }
        assert_ne!(state[0][0], begin[0][0]);
    }
}

/// Second order on a harmonic oscillator.
#[test]
fn velocity_verlet_is_of_second_order() {
    let error = |steps: usize| {
        let dt = 4.0 / steps as f64;
        let mut state = start(1);
        // a = F/2 = −r: r = cos t.
        (state[0][0][0], state[0][1][0], state[0][2][0]) = (1.0, 0.0, -1.0);
        by_programs(&mut state, dt, [0.0; 2], steps, |r, _| -2.0 * r);
        (state[0][0][0] - 4.0f64.cos()).abs().max((state[0][1][0] + 4.0f64.sin()).abs())
    };
    let errors = [50, 100, 200].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.1, "{order}");
    }
}

/// With numbers of few bits, the parabola is exact to the bit.
#[test]
fn free_fall_is_the_exact_parabola() {
    let (gravity, dt) = ([0.5, -8.0], 1.0 / 1024.0);
    let mut state = start(1);
    for (axis, g) in gravity.into_iter().enumerate() {
        (state[axis][0][0], state[axis][1][0], state[axis][2][0]) = (1.25, 3.5, g);
    }
    by_programs(&mut state, dt, gravity, 1000, |_, _| 0.0);
    let t = 1000.0 * dt;
    for (axis, g) in gravity.into_iter().enumerate() {
        assert_eq!(state[axis][0][0], 1.25 + 3.5 * t + 0.5 * g * t * t);
        assert_eq!(state[axis][1][0], 3.5 + g * t);
    }
}
