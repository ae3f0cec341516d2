//! Gear's schemes: orders, stability limits, and exact solutions.

use stripmine_kernels::integrator::Inertia;
use stripmine_kernels::integrator::gear::{Acceleration, GearCorrector, GearPredictor, STATE, coefficients};
use stripmine_kernels::isa::{Array, Memory, Slot};
use stripmine_kernels::{Execution, InstructionSet, Program};

/// Discs driven by the kernels alone, with forces given by the test.
struct Discs {
    dt: f64,
    count: usize,
    state: [[Vec<f64>; 6]; 3],
    velocity: [Vec<f64>; 3],
    force: [Vec<f64>; 3],
    cell: Vec<u32>,
    set: InstructionSet,
}

impl Discs {
    /// Initial state: `derivatives(disc, freedom, k)` is the k-th time derivative.
    fn new(dt: f64, count: usize, derivatives: impl Fn(usize, usize, usize) -> f64) -> Discs {
        let scale = |k: usize| (1..=k).fold(1.0, |scale, m| scale * dt / m as f64);
        let column = |freedom, k| (0..count).map(|disc| scale(k) * derivatives(disc, freedom, k)).collect();
        Discs {
            dt,
            count,
            state: std::array::from_fn(|freedom| std::array::from_fn(|k| column(freedom, k))),
            velocity: std::array::from_fn(|_| vec![0.0; count]),
            force: std::array::from_fn(|_| vec![0.0; count]),
            cell: (1..=count as u32).collect(),
            set: InstructionSet::best(),
        }
    }

    fn memory(&mut self) -> Memory<'_> {
        let mut memory = Memory::new();
        for (arrays, row) in STATE.into_iter().zip(&mut self.state) {
            for (array, q) in arrays.into_iter().zip(row) {
                memory = memory.write(Slot::<f64>::new(array), q);
            }
        }
        let velocities = [Array::DiscVx, Array::DiscVy, Array::DiscOmega].into_iter().zip(&mut self.velocity);
        for (array, column) in velocities {
            memory = memory.write(Slot::<f64>::new(array), column);
        }
        for (array, column) in [Array::Fx, Array::Fy, Array::Torque].into_iter().zip(&self.force) {
            memory = memory.read(Slot::<f64>::new(array), column);
        }
        memory.read(Slot::new(Array::DiscCell), &self.cell)
    }

    /// Runs steps of the scheme with `force(disc, freedom, r, v)`; masses and moments of inertia are 1.
    fn run<const VALUES: usize, const FREEDOMS: usize>(
        &mut self,
        steps: usize,
        acceleration: Acceleration,
        gravity: [f64; 2],
        force: impl Fn(usize, usize, f64, f64) -> f64,
    ) {
        let (count, set, execution) = (self.count, self.set, Execution::Chained);
        let predictor = Program::new(GearPredictor::<f64, f64, VALUES, FREEDOMS>::new(self.dt));
        let inertia = Inertia::Equal { inverse_mass: 1.0, inverse_inertia: 1.0 };
        let corrector = Program::new(GearCorrector::<f64, f64, VALUES, FREEDOMS>::new(
            self.dt,
            acceleration,
            inertia,
            gravity,
        ));
        for _ in 0..steps {
            predictor.run(&self.memory(), 0..count, execution, set).unwrap();
            for freedom in 0..FREEDOMS {
                for disc in 0..count {
                    let (r, v) = (self.state[freedom][0][disc], self.velocity[freedom][disc]);
                    self.force[freedom][disc] = force(disc, freedom, r, v);
                }
            }
            corrector.run(&self.memory(), 0..count, execution, set).unwrap();
        }
    }
}

/// Damped oscillator r'' = −ω² r − 2βr' from r = 1, r' = −β: r = e^(−βt) cos(νt), ν² = ω² − β². Each disc and direction has its
/// own.
#[derive(Clone, Copy)]
struct Oscillator {
    nu: f64,
    beta: f64,
}

impl Oscillator {
    fn of(disc: usize, freedom: usize, damped: bool) -> Oscillator {
        let nu = 1.0 + 0.125 * disc as f64 + 0.0625 * freedom as f64;
        Oscillator { nu, beta: if damped { 0.25 } else { 0.0 } }
    }

    /// k-th derivative at time t: the real part of λ^k e^(λt), λ = −β + iν.
    fn derivative(self, k: usize, t: f64) -> f64 {
        let (mut re, mut im) = ((self.nu * t).cos(), (self.nu * t).sin());
        for _ in 0..k {
            (re, im) = (-self.beta * re - self.nu * im, -self.beta * im + self.nu * re);
        }
        (-self.beta * t).exp() * re
    }

    fn force(self, r: f64, v: f64) -> f64 {
        -(self.nu * self.nu + self.beta * self.beta) * r - 2.0 * self.beta * v
    }
}

const TIME: f64 = 4.0;

/// Largest error of position and velocity of five oscillators after [`TIME`].
fn error<const VALUES: usize>(
    steps: usize,
    acceleration: Acceleration,
    damped: bool,
    exact_start: bool,
) -> f64 {
    let dt = TIME / steps as f64;
    let mut discs = Discs::new(dt, 5, |disc, freedom, k| {
        let started = exact_start || k < 2;
        if started { Oscillator::of(disc, freedom, damped).derivative(k, 0.0) } else { 0.0 }
    });
    discs.run::<VALUES, 2>(steps, acceleration, [0.0; 2], |disc, freedom, r, v| {
        Oscillator::of(disc, freedom, damped).force(r, v)
    });
    let mut largest = 0.0f64;
    for freedom in 0..2 {
        for disc in 0..discs.count {
            let exact = Oscillator::of(disc, freedom, damped);
            let r = discs.state[freedom][0][disc] - exact.derivative(0, TIME);
            let v = discs.state[freedom][1][disc] / dt - exact.derivative(1, TIME);
            largest = largest.max(r.abs()).max(v.abs());
        }
    }
    largest
}

/// Slopes of the error between halvings of dt.
fn slopes<const VALUES: usize>(acceleration: Acceleration, damped: bool, exact_start: bool) -> [f64; 2] {
    let errors = [160, 320, 640].map(|steps| error::<VALUES>(steps, acceleration, damped, exact_start));
    let slopes = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
    println!(
        "{VALUES} values, {acceleration:?}, damped {damped}, exact {exact_start}: {errors:?}, {slopes:.2?}"
    );
    slopes
}

fn of_order(order: f64, slopes: [f64; 2]) {
    assert!(slopes.iter().all(|slope| (slope - order).abs() < 0.3), "slopes {slopes:?}, expected {order}");
}

/// Coefficients of Allen & Tildesley's table. Other first coefficients would pass the tests of order and stability.
#[test]
fn coefficients_match_the_table() {
    for (values, first, first_of_velocities, rest) in [
        (4, (1, 6), (1, 6), vec![(5, 6), (1, 1), (1, 3)]),
        (5, (19, 120), (19, 90), vec![(3, 4), (1, 1), (1, 2), (1, 12)]),
        (6, (3, 20), (3, 16), vec![(251, 360), (1, 1), (11, 18), (1, 6), (1, 60)]),
    ] {
        for (acceleration, first) in
            [(Acceleration::OfPositions, first), (Acceleration::OfVelocities, first_of_velocities)]
        {
            let expected = [first].into_iter().chain(rest.clone()).map(|(p, q)| f64::from(p) / f64::from(q));
            let found = coefficients(values, acceleration);
            assert_eq!(found[..values], expected.collect::<Vec<_>>());
            assert!(found[values..].iter().all(|&c| c == 0.0));
        }
    }
}

/// On harmonic oscillators with exact initial derivatives, the schemes of 4, 5, 6 values are of order 3, 4, 5.
#[test]
fn orders_are_one_below_the_values() {
    of_order(3.0, slopes::<4>(Acceleration::OfPositions, false, true));
    of_order(4.0, slopes::<5>(Acceleration::OfPositions, false, true));
    of_order(5.0, slopes::<6>(Acceleration::OfPositions, false, true));
}

/// On damped oscillators, both first coefficients give these orders: the one for velocity-dependent forces and the other.
#[test]
fn both_first_coefficients_keep_the_damped_order() {
    for acceleration in [Acceleration::OfVelocities, Acceleration::OfPositions] {
        of_order(3.0, slopes::<4>(acceleration, true, true));
        of_order(4.0, slopes::<5>(acceleration, true, true));
        of_order(5.0, slopes::<6>(acceleration, true, true));
    }
}

/// With zeros for the initial derivatives beyond the velocity, every scheme is of first order.
#[test]
fn zero_starting_derivatives_spoil_the_order() {
    of_order(1.0, slopes::<4>(Acceleration::OfPositions, false, false));
    of_order(1.0, slopes::<5>(Acceleration::OfPositions, false, false));
    of_order(1.0, slopes::<6>(Acceleration::OfPositions, false, false));
}

/// Speed after 4000 steps of pure drag, a = −γ v, from speed 1; γ dt = `drag`.
fn speed<const VALUES: usize>(drag: f64, acceleration: Acceleration) -> f64 {
    let mut discs = Discs::new(1.0, 1, |_, _, k| if k == 0 { 0.0 } else { (-drag).powi(k as i32 - 1) });
    discs.run::<VALUES, 2>(4000, acceleration, [0.0; 2], |_, _, _, v| -drag * v);
    discs.state[0][1][0].abs()
}

/// Checks that a scheme is stable at 0.9 of the limit and diverges at 1.15 of it, and the limit itself to 0.01, with both first
/// coefficients.
fn stable_below<const VALUES: usize>(limit: f64) {
    for acceleration in [Acceleration::OfVelocities, Acceleration::OfPositions] {
        assert!(speed::<VALUES>(0.9 * limit, acceleration) < 1e-9);
        let beyond = speed::<VALUES>(1.15 * limit, acceleration);
        assert!(beyond.is_nan() || beyond > 1e9, "{beyond}");
        let (mut stable, mut unstable) = (0.9 * limit, 1.15 * limit);
        for _ in 0..20 {
            let middle = 0.5 * (stable + unstable);
            *(if speed::<VALUES>(middle, acceleration) < 1.0 { &mut stable } else { &mut unstable }) = middle;
        }
        println!("{VALUES} values, {acceleration:?}: stable below gamma dt = {stable:.4}");
        assert!((stable - limit).abs() < 0.01, "stable below {stable}, expected {limit}");
    }
}

/// Pure drag is stable for γ dt below 0.55, 0.31, 0.17 with 4, 5, 6 values.
#[test]
fn pure_drag_is_stable_below_stated_limits() {
    stable_below::<4>(0.55);
    stable_below::<5>(0.31);
    stable_below::<6>(0.17);
}

/// x and y do not depend on rotation; the angle changes with rotation only.
#[test]
fn rotation_changes_no_bit_of_x_and_y() {
    let start =
        || Discs::new(0.01, 7, |disc, freedom, k| Oscillator::of(disc, freedom, true).derivative(k, 0.3));
    let force = |disc, freedom, r, v| Oscillator::of(disc, freedom, true).force(r, v);
    let gravity = [0.25, -9.81];
    let (mut with, mut without, before) = (start(), start(), start());
    with.run::<4, 3>(50, Acceleration::OfVelocities, gravity, force);
    without.run::<4, 2>(50, Acceleration::OfVelocities, gravity, force);
    let bits = |discs: &Discs, freedom: usize| {
        let numbers = discs.state[freedom].iter().chain([&discs.velocity[freedom]]);
        numbers.flatten().map(|x| x.to_bits()).collect::<Vec<_>>()
    };
    for freedom in 0..2 {
        assert_eq!(bits(&with, freedom), bits(&without, freedom));
        assert_ne!(bits(&with, freedom), bits(&before, freedom));
    }
    assert_ne!(bits(&with, 2), bits(&before, 2));
    assert_eq!(bits(&without, 2), bits(&before, 2));
}

/// Under gravity alone the path is a parabola: to the bit if all numbers have few bits, else to rounding.
fn parabola<const VALUES: usize>() {
    let velocity = [0.75, 3.5];
    let path = |gravity: [f64; 2], dt: f64| {
        let start = [1.25, -2.5];
        let derivatives = |_: usize, freedom: usize, k: usize| match (freedom, k) {
            (2, _) => 0.0,
            (_, 0) => start[freedom],
            (_, 1) => velocity[freedom],
            (_, 2) => gravity[freedom],
            _ => 0.0,
        };
        let mut discs = Discs::new(dt, 3, derivatives);
        discs.run::<VALUES, 2>(1000, Acceleration::OfVelocities, gravity, |_, _, _, _| 0.0);
        let t = 1000.0 * dt;
        let expected = [0, 1].map(|axis| start[axis] + velocity[axis] * t + 0.5 * gravity[axis] * t * t);
        ([discs.state[0][0][2], discs.state[1][0][2]], expected)
    };
    let (found, expected) = path([0.5, -8.0], 1.0 / 1024.0);
    assert_eq!(found, expected);
    let (found, expected) = path([0.0, -9.81], 1e-3);
    for axis in 0..2 {
        assert!((found[axis] - expected[axis]).abs() < 1e-12, "{found:?}, expected {expected:?}");
    }
}

/// Free fall is exact for every number of values.
#[test]
fn free_fall_is_the_exact_parabola() {
    parabola::<4>();
    parabola::<5>();
    parabola::<6>();
}

/// A zero component of gravity costs no operation, a non-zero one costs one sum.
#[test]
fn gravity_costs_one_sum_a_component() {
    let inertia = Inertia::Equal { inverse_mass: 1.0, inverse_inertia: 1.0 };
    let sums = |gravity: [f64; 2]| {
        let text = GearCorrector::<f64, f64, 4, 2>::new(1e-3, Acceleration::OfVelocities, inertia, gravity);
        let tally = Program::new(text).tape().tally();
        tally.iter().map(|(_, counts)| counts.total()).sum::<u64>()
    };
    assert_eq!(sums([0.0, -9.81]), sums([0.0, 0.0]) + 1);
    assert_eq!(sums([1.0, -9.81]), sums([0.0, 0.0]) + 2);
}

/// A disc in no cell (a stray) is subject to gravity and no force; it gets no other disc's force.
#[test]
fn a_disc_in_no_cell_feels_no_force() {
    let mut discs = Discs::new(1e-2, 5, |_, _, _| 0.0);
    discs.cell = vec![5, 0, 4, 1, 2];
    discs.force[0] = vec![1.0, 2.0, 3.0, 4.0, 5.0];
    let inertia = Inertia::Equal { inverse_mass: 1.0, inverse_inertia: 1.0 };
    let corrector = Program::new(GearCorrector::<f64, f64, 4, 2>::new(
        1e-2,
        Acceleration::OfPositions,
        inertia,
        [0.0, -2.0],
    ));
    corrector.run(&discs.memory(), 0..5, Execution::Chained, InstructionSet::best()).unwrap();
    let found =
        |freedom: usize| discs.state[freedom][2].iter().map(|q| q / (0.5 * 1e-2 * 1e-2)).collect::<Vec<_>>();
    for (found, expected) in found(0).into_iter().zip([5.0, 0.0, 4.0, 1.0, 2.0]) {
        assert!((found - expected).abs() < 1e-12, "{found}, expected {expected}");
    }
    assert!(found(1).iter().all(|a| (a + 2.0).abs() < 1e-12));
}
