//! Pressure and collision rate of the fluid.

use crate::laboratory::hard_disks::study::fluid::{Fluids, Mean, State, henderson, luding};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};
use crate::statistics::Claim;
use stripmine_physics::number::in_tens;

/// By how much Z and the rate may be off what is known (relative).
const WITHIN: f64 = 0.002;

/// What came out.
pub fn section(data: &Fluids) -> Section {
    let worst = |which: usize| {
        let off = data.states.iter().map(|state| state.off()[which]);
        off.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))
            .map_or(String::new(), |off| format!("{} %", off.percent()))
    };
    let energy = data.states.iter().map(|state| state.energy_error.abs()).fold(0.0, f64::max);
    let claims: Vec<Claim> =
        data.states.iter().flat_map(State::off).map(|off| off.vanishes(WITHIN)).collect();
    Section::new("hard-disks-fluid", "Hard discs: the pressure of the fluid")
        .asks("Are the pressure and the collision rate of the hard-disc fluid right?")
        .expects("Z(ν) and the collision rate ω of two independent programs with 250 000 discs, good to about 0.1 %; Henderson's and Luding's \
                  equations of state.")
        .answers(format!(
            "Up to ν = 0.65 Z is off theirs by {} at most, and ω by {} (95 %).",
            worst(0),
            worst(1)
        ))
        .verdict(Verdict::of_claims(&claims))
        .details([format!(
            "{} discs and {} collisions at each packing fraction; the energy is off by {} of itself.",
            Cell::Number(data.discs as f64, 0).for_reading(),
            Cell::Number(data.collisions as f64, 0).for_reading(),
            in_tens(energy, 2)
        )])
        .figures([pressure(data), differences(data)])
        .tables([table(data)])
        .seeds([1])
}

fn curve(name: &str, hue: usize, style: Style, of: impl Fn(f64) -> f64) -> Series {
    let points = (1..=68).map(|at| 0.01 * f64::from(at)).map(|nu| (nu, of(nu)));
    Series::new(name, style, hue, points)
}

fn pressure(data: &Fluids) -> Figure {
    let measured = data.states.iter().map(|state| (state.packing_fraction, state.compressibility.value));
    Chart::of(Axis::linear("packing fraction ν", None), Axis::logarithmic("compressibility Z", None))
        .with([curve("Luding", 0, Style::Line, luding)])
        .series("measured", Style::Points, 1, measured)
        .figure("pressure", "Compressibility of the fluid")
        .caption("Z = p A/(N kT) from the virial of the collisions; error bars are smaller than the points.")
}

fn differences(data: &Fluids) -> Figure {
    let off = |value: f64, known: f64| 100.0 * (value / known - 1.0);
    let measured = |name: &str, hue: usize, shift: f64, of: fn(&State) -> (Mean, f64)| {
        let points = data.states.iter().map(|state| {
            let (Mean { value, bar }, known) = of(state);
            let ends = [off(value - bar, known), off(value + bar, known)];
            // Side by side, so that bars do not hide each other.
            (state.packing_fraction + shift, off(value, known), ends)
        });
        Series::new(name, Style::Points, hue, points)
    };
    let of_law = |name: &str, hue: usize, law: fn(f64) -> f64| {
        let points = data.states.iter().map(|state| {
            let nu = state.packing_fraction;
            (nu, off(law(nu), state.known[0]))
        });
        Series::new(name, Style::Dashed, hue, points)
    };
    Chart::of(Axis::linear("packing fraction ν", None), Axis::linear("difference", Some("%")))
        .with([
            of_law("Henderson's Z", 2, henderson),
            of_law("Luding's Z", 3, luding),
            measured("Z", 0, -0.003, |state| (state.compressibility, state.known[0])),
            measured("ω", 1, 0.003, |state| (state.rate, state.known[1])),
        ])
        .figure("differences", "How far from what other programs have measured")
        .caption("Bars hold the mean in 95 of 100 studies. What is known is itself good to about 0.1 %.")
}

fn table(data: &Fluids) -> Table {
    Rows::of(&data.states)
        .number("ν", 2, |state| state.packing_fraction)
        .number("Z", 4, |state| state.compressibility.value)
        .number("± (95 %)", 4, |state| state.compressibility.bar)
        .number("Z known", 4, |state| state.known[0])
        .number("off (%)", 2, |state| 100.0 * state.off()[0].value)
        .number("ω", 4, |state| state.rate.value)
        .number("± (95 %)", 4, |state| state.rate.bar)
        .number("ω known", 4, |state| state.known[1])
        .number("off (%)", 2, |state| 100.0 * state.off()[1].value)
        .short("energy error", |state| state.energy_error)
        .table("fluid", "Compressibility and collisions of a disc in a unit of time (diameter = m = kT = 1)")
        .note("Errors from the scatter and the correlation of 200 parts of each run.")
}
