//! Pressure and collision rate of the fluid.

use crate::laboratory::hard_disks::study::fluid::{Fluids, Mean, henderson, luding};
use crate::report::figure::{Axis, Chart, Figure, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};
use stripmine_physics::number::in_tens;

/// By how much Z and the rate may be off what is known (relative).
const WITHIN: f64 = 0.002;

/// What came out.
pub fn section(data: &Fluids) -> Section {
    let worst = |which: usize| {
        let off = data.states.iter().map(|state| state.off()[which].abs());
        100.0 * off.fold(0.0, f64::max)
    };
    let energy = data.states.iter().map(|state| state.energy_error.abs()).fold(0.0, f64::max);
    let agrees = data.states.iter().all(|state| state.off().iter().all(|off| off.abs() <= WITHIN));
    Section::new("hard-disks-fluid", "Hard discs: the pressure of the fluid", Part::Physics)
        .asks("Are the pressure and the collision rate of the hard-disc fluid right?")
        .expects("Z(ν) and the collision rate ω of two independent programs with 250 000 discs, good to about 0.1 %; Henderson's and Luding's \
                  equations of state.")
        .answers(format!(
            "Z is within {:.2} % and ω within {:.2} % of theirs up to ν = 0.65.",
            worst(0),
            worst(1)
        ))
        .verdict(Verdict::reproduced(agrees))
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
    let points = (1..=68).map(|at| 0.01 * f64::from(at)).map(|nu| Point::at(nu, of(nu)));
    Series::new(name, style, hue, points)
}

fn pressure(data: &Fluids) -> Figure {
    let measured =
        data.states.iter().map(|state| Point::at(state.packing_fraction, state.compressibility.value));
    Chart::of(Axis::linear("packing fraction ν", None), Axis::logarithmic("compressibility Z", None))
        .with([curve("Luding", 0, Style::Line, luding), Series::new("measured", Style::Points, 1, measured)])
        .figure("pressure", "Compressibility of the fluid")
        .caption("Z = p A/(N kT) from the virial of the collisions; error bars are smaller than the points.")
}

fn differences(data: &Fluids) -> Figure {
    let relative = |mean: Mean, known: f64| {
        let off = |value: f64| 100.0 * (value / known - 1.0);
        (off(mean.value), [off(mean.value - mean.bar), off(mean.value + mean.bar)])
    };
    let series = |name: &str, hue: usize, shift: f64, of: &dyn Fn(usize) -> (f64, [f64; 2])| {
        Series::new(
            name,
            Style::Points,
            hue,
            (0..data.states.len()).map(|at| {
                let (y, spread) = of(at);
                // Side by side, so that bars do not hide each other.
                Point { x: data.states[at].packing_fraction + shift, y, spread: Some(spread) }
            }),
        )
    };
    let known =
        |nu: f64| data.states.iter().find(|state| state.packing_fraction == nu).map(|state| state.known[0]);
    let of_law = |name: &str, hue: usize, law: fn(f64) -> f64| {
        Series::new(
            name,
            Style::Dashed,
            hue,
            data.states
                .iter()
                .filter_map(|state| Some((state.packing_fraction, known(state.packing_fraction)?)))
                .map(|(nu, known)| Point::at(nu, 100.0 * (law(nu) / known - 1.0))),
        )
    };
    Chart::of(Axis::linear("packing fraction ν", None), Axis::linear("difference", Some("%")))
        .with([
            of_law("Henderson's Z", 2, henderson),
            of_law("Luding's Z", 3, luding),
            series("Z", 0, -0.003, &|at| relative(data.states[at].compressibility, data.states[at].known[0])),
            series("ω", 1, 0.003, &|at| relative(data.states[at].rate, data.states[at].known[1])),
        ])
        .figure("differences", "How far from what other programs have measured")
        .caption("Bars hold the mean in 95 of 100 studies. What is known is itself good to about 0.1 %.")
}

fn table(data: &Fluids) -> Table {
    let rows = data.states.iter().map(|state| {
        let [z, rate] = state.off();
        vec![
            Cell::Number(state.packing_fraction, 2),
            Cell::Number(state.compressibility.value, 4),
            Cell::Number(state.compressibility.bar, 4),
            Cell::Number(state.known[0], 4),
            Cell::Number(100.0 * z, 2),
            Cell::Number(state.rate.value, 4),
            Cell::Number(state.rate.bar, 4),
            Cell::Number(state.known[1], 4),
            Cell::Number(100.0 * rate, 2),
            Cell::Text(format!("{:.1e}", state.energy_error)),
        ]
    });
    let columns =
        ["ν", "Z", "± (95 %)", "Z known", "off (%)", "ω", "± (95 %)", "ω known", "off (%)", "energy error"];
    Table {
        name: "fluid".into(),
        title: "Compressibility and collisions of a disc in a unit of time (diameter = m = kT = 1)".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec!["Errors from the scatter of 20 parts of each run.".into()],
    }
}
