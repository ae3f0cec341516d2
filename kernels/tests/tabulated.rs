//! Tables of pair potentials: errors against formulas, rows that are refused, sweeps below and beyond the rows.

use stripmine_kernels::law::lennard_jones::LennardJones;
use stripmine_kernels::law::potential::{CutOff, PairPotential};
use stripmine_kernels::law::tabulated::{Tabulated, TabulatedError};
use stripmine_kernels::sweep::pair::{Pair, PairBody};

/// Rows of Lennard-Jones with ε = σ = 1 at some distances.
fn rows(distances: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
    let potential = LennardJones::new(1.0, 1.0);
    distances.map(|r| [r, potential.energy(r)]).collect()
}

/// Largest errors of U and F against the formulas from 1 to 2.5.
fn errors(table: &Tabulated) -> [f64; 2] {
    let exact = CutOff::new(LennardJones::new(1.0, 1.0), 2.5);
    let distances = (0..15_000).map(|step| 1.0 + 1e-4 * f64::from(step) + 3e-5);
    distances.fold([0.0; 2], |[energy, force]: [f64; 2], r| {
        [
            energy.max((table.energy(r) - exact.energy(r)).abs()),
            force.max((table.force(r) - exact.force(r)).abs()),
        ]
    })
}

/// With rows twice as dense, the error of U falls by 2⁴ and that of F by 2³, also with rows at unequal distances.
#[test]
fn errors_fall_with_the_fourth_power() {
    let even = |count: u32| (0..=count).map(move |row| 0.9 + 1.6 * f64::from(row) / f64::from(count));
    let squares =
        |count: u32| (0..=count).map(move |row| (0.81 + 5.44 * f64::from(row) / f64::from(count)).sqrt());
    let of = |rows: Vec<[f64; 2]>| errors(&Tabulated::new(&rows).unwrap());
    for [coarse, fine] in [
        [of(rows(even(1000))), of(rows(even(2000)))],
        [of(rows(even(2000))), of(rows(even(4000)))],
        [of(rows(squares(3000))), of(rows(squares(6000)))],
    ] {
        let [energy, force] = [0, 1].map(|of| (coarse[of] / fine[of]).log2());
        println!("{coarse:?} {fine:?} orders {energy} {force}");
        assert!((energy - 4.0).abs() < 0.3 && (force - 3.0).abs() < 0.3, "{energy} {force}");
    }
    assert!(of(rows(even(640)))[0] < 2e-6);
}

/// Polynomials up to the third order are met to rounding, whatever the distances of the rows.
#[test]
fn cubics_are_exact() {
    let cubic = |r: f64| (3.0 - r) * (1.0 + r * (0.5 - 2.0 * r));
    let slope = |r: f64| -(1.0 + r * (0.5 - 2.0 * r)) + (3.0 - r) * (0.5 - 4.0 * r);
    for power in [1.0, 1.7] {
        let points: Vec<[f64; 2]> = (0..=30)
            .map(|row| 3.0 * (f64::from(row) / 30.0_f64).powf(power))
            .map(|r| [r, cubic(r)])
            .collect();
        let table = Tabulated::new(&points).unwrap();
        for step in 0..300 {
            let r = 0.01 * f64::from(step);
            assert!((table.energy(r) - cubic(r)).abs() < 1e-11, "{r}: {} {}", table.energy(r), cubic(r));
            assert!((table.force(r) + slope(r)).abs() < 1e-9, "{r}: {} {}", table.force(r), slope(r));
        }
    }
}

/// A swept pair has the energy and force of the formulas; below the first row it has NaN, beyond the last one 0.
#[test]
fn sweeps_end_at_the_rows() {
    let table = Tabulated::new(&rows((0..=100).map(|row| 0.9 + 0.016 * f64::from(row)))).unwrap();
    let law = CutOff::new(table.clone(), table.ends()[1]);
    let at = |distance: f64| Pair { bodies: [PairBody::at(distance, 0.0), PairBody::at(0.0, 0.0)] };
    for distance in [0.9, 0.95, 1.7, 2.49] {
        let ([[force, ..], _], [energy, virial]) =
            (at(distance).sums(&law), at(distance).energy_and_virial(&law));
        assert!((force - table.force(distance)).abs() < 1e-11 * force.abs().max(1.0), "{distance}: {force}");
        assert!((energy - table.energy(distance)).abs() < 1e-12, "{distance}: {energy}");
        assert!((virial - force * distance).abs() < 1e-12 * virial.abs().max(1.0), "{distance}: {virial}");
    }
    for (distance, is_there) in [(0.899, true), (0.001, true), (2.5, false), (1e30, false)] {
        let [force, ..] = at(distance).sums(&law)[0];
        assert!(if is_there { force.is_nan() } else { force == 0.0 }, "{distance}: {force}");
    }
    assert_eq!((table.energy(0.5), table.closest(1e9), table.energy(2.5)), (f64::INFINITY, 0.9, 0.0));
}

#[test]
fn unfit_rows_are_named() {
    let refused = |change: fn(&mut Vec<[f64; 2]>)| {
        let mut points = rows((0..=20).map(|row| 1.0 + 0.1 * f64::from(row)));
        change(&mut points);
        Tabulated::new(&points).unwrap_err()
    };
    assert_eq!(refused(|points| points.truncate(4)), TabulatedError::TooFew(4));
    let swapped = refused(|points| points.swap(3, 4));
    assert!(matches!(swapped, TabulatedError::NotIncreasing { row: 4, .. }), "{swapped}");
    assert!(matches!(refused(|points| points[7][1] = f64::NAN), TabulatedError::NotFinite { row: 7, .. }));
    assert!(matches!(refused(|points| points[0][0] = -1.0), TabulatedError::NotFinite { row: 0, .. }));
    let close = refused(|points| points[5][0] = points[4][0] + 1e-9);
    assert!(matches!(close, TabulatedError::TooUneven { row: 5, .. }), "{close}");
}
