//! The error of the step in a Lennard-Jones fluid.

use super::point;
use crate::method::langevin::study::Mean;
use crate::method::langevin::study::accuracy::{Accuracy, Fluid};
use crate::report::figure::{Axis, Chart, Figure, Picture, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};

/// What came out.
pub fn section(data: &Accuracy) -> Section {
    let at = |scheme: &str, dt: f64| data.fluids.iter().find(|it| it.scheme == scheme && it.dt == dt);
    let off = |scheme: &str| at(scheme, 0.01).map_or(f64::NAN, |it| error(data, it).value);
    Section {
        name: "langevin-accuracy".into(),
        title: "Langevin: the error of the step".into(),
        part: Part::Physics,
        question: "How far off are averages over positions for a given step, by either scheme?".into(),
        expected: "Leimkuhler and Matthews: by BAOAB the error is of order dt² and far smaller than by velocity Verlet with noise in the \
                   acceleration."
            .into(),
        answer: format!(
            "At dt = 0.01 the energy of the pairs is off by {:+.4} by BAOAB and by {:+.4} by the source's scheme, of {:.4} a particle.",
            off("baoab"),
            off("stochastic"),
            data.limit.value
        ),
        details: vec![],
        verdict: Verdict::reproduced(off("baoab").abs() < off("stochastic").abs()),
        again: "stripmine reproduce --only langevin-accuracy".into(),
        figures: vec![
            figure(data, "error-over-step", "time step", |it| it.dt),
            figure(data, "error-over-cost", "wall time of a unit of time", |it| it.cost),
        ],
        tables: vec![table(data)],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: true,
        provenance: None,
    }
}

fn error(data: &Accuracy, it: &Fluid) -> Mean {
    Mean { value: it.potential.value - data.limit.value, bar: it.potential.bar }
}

fn figure(data: &Accuracy, name: &str, axis: &str, x: fn(&Fluid) -> f64) -> Figure {
    let series = ["stochastic", "baoab"].into_iter().enumerate().map(|(hue, scheme)| {
        let of = data.fluids.iter().filter(|it| it.scheme == scheme && it.is_whole);
        let mut points: Vec<_> = of.map(|it| point(x(it), error(data, it))).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        Series { name: scheme.into(), style: Style::Joined, hue, points }
    });
    let unit = if name.ends_with("cost") { "s" } else { "reduced" };
    Figure {
        name: name.into(),
        title: format!("Energy of the pairs: error over the {}", if unit == "s" { "cost" } else { "step" }),
        caption: format!(
            "{} Lennard-Jones particles, density 0.7, kT = 1; a time of {} at each point. Bars hold the mean in 95 of 100 studies; the \
             energy at short steps itself is known to ± {:.4}.",
            data.particles, data.time, data.limit.bar
        ),
        picture: Picture::Chart(Chart {
            x: Axis::linear(axis, Some(unit)),
            y: Axis::linear("error of the energy a particle", Some("ε")),
            series: series.collect(),
            bands: vec![],
        }),
    }
}

fn table(data: &Accuracy) -> Table {
    let rows = data.fluids.iter().map(|it| {
        vec![
            Cell::Text(it.scheme.into()),
            Cell::Number(it.dt, 4),
            Cell::Number(it.potential.value, 4),
            Cell::Number(it.potential.bar, 4),
            Cell::Number(it.pressure.value, 4),
            Cell::Number(it.pressure.bar, 4),
            Cell::Number(it.temperature.value, 4),
            Cell::Number(it.temperature.bar, 4),
            Cell::Number(1e3 * it.cost, 1),
        ]
    });
    let columns = [
        "scheme",
        "dt",
        "energy",
        "± (95 %)",
        "pressure",
        "± (95 %)",
        "temperature",
        "± (95 %)",
        "ms a unit of time",
    ];
    Table {
        name: "accuracy".into(),
        title: "Energy of the pairs a particle, pressure and temperature".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![
            "Errors from the scatter of 20 parts of each run. Two runs at a time shared the machine.".into(),
        ],
    }
}
