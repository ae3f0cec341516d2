//! Interactions a second.

use crate::laboratory::nbody::study::rates::Rates;
use crate::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};
use stripmine_physics::number::{counted, in_tens};

/// What came out.
pub fn section(data: &Rates) -> Section {
    let best = |precision: &str| {
        let of = data.rates.iter().filter(|it| it.precision == precision && it.arithmetic != "raw");
        of.max_by(|a, b| a.rates[0].total_cmp(&b.rates[0]))
    };
    let said = |precision: &str| {
        best(precision).map_or(String::new(), |it| {
            format!("{:.1}·10⁹ at a force error of {}", it.rates[0], in_tens(it.error[0], 2))
        })
    };
    let reached = |precision: &str, aim: f64, error: f64| {
        best(precision).is_some_and(|it| it.rates[0] >= aim && it.error[0] <= error)
    };
    let largest = data.rates.last().map_or(0, |it| it.bodies);
    let scaling = data.rates.iter().filter(|it| it.bodies == largest).map(|it| it.rates[1] / it.rates[0]);
    Section {
        name: "nbody-rates".into(),
        title: "Bodies: interactions a second".into(),
        part: Part::Host,
        question: "How many interactions a second, at which error of the forces?".into(),
        expected: "Our aim: 13·10⁹ directed interactions a second (N² counted) in single precision at a force error of 10⁻⁶, 5·10⁹ in \
                   double at 4·10⁻¹⁵, on a core of 4.1 GHz with AVX-512. Best published kernels there: 7.3·10⁹ at 9·10⁻⁷ and 2.8·10⁹ at \
                   2·10⁻¹⁵."
            .into(),
        answer: format!(
            "Directed interactions a second (N² a step) on one core, {}: with forces in single precision {}, in double {}.",
            data.instruction_set,
            said("mixed"),
            said("f64"),
        ),
        details: vec![format!(
            "Two threads are {:.2} times as fast at {largest} bodies, with {} bits.",
            scaling.fold(0.0, f64::max),
            if data.same_bits { "the same" } else { "other" }
        )],
        verdict: Verdict::aim(reached("mixed", 13.0, 1e-6) && reached("f64", 5.0, 4e-15)),
        again: "stripmine reproduce --only nbody-rates".into(),
        figures: vec![figure(data)],
        tables: vec![table(data), conserving(data)],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: true,
        provenance: None,
    }
}

fn figure(data: &Rates) -> Figure {
    let mut series: Vec<Series> = vec![];
    // An error of 0 has no place on a logarithmic axis.
    let (seen, exact): (Vec<_>, Vec<_>) = data.rates.iter().partition(|it| it.error[0] > 0.0);
    for it in seen {
        let name = format!("{}, {}", it.precision, it.arithmetic);
        let point = Point::at(it.rates[0], it.error[0]);
        match series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => {
                let hue = series.len();
                series.push(Series { name, style: Style::Points, hue, points: vec![point] });
            }
        }
    }
    Figure {
        name: "error-over-rate".into(),
        title: "Error of the forces over speed, one thread".into(),
        caption: format!(
            "A point for each number of bodies. Largest error of an acceleration over the largest acceleration. Errors of 0 have no \
             place on this axis: {}.",
            counted(exact.len(), "point is absent", "points are absent")
        ),
        picture: Picture::Chart(Chart {
            x: Axis::linear("directed interactions", Some("10⁹/s")),
            y: Axis::logarithmic("force error", None),
            series,
            bands: vec![],
        }),
    }
}

fn table(data: &Rates) -> Table {
    let rows = data.rates.iter().map(|it| {
        vec![
            Cell::Count(it.bodies as u64),
            Cell::Text(it.precision.into()),
            Cell::Text(it.arithmetic.into()),
            Cell::Number(it.rates[0], 2),
            Cell::Number(it.rates[1], 2),
            Cell::Number(it.rates[1] / it.rates[0], 2),
            Cell::Text(format!("{:.1e}", it.error[0])),
            Cell::Text(format!("{:.1e}", it.error[1])),
        ]
    });
    let columns = [
        "bodies",
        "forces",
        "arithmetic",
        "1 thread (10⁹/s)",
        "2 threads (10⁹/s)",
        "ratio",
        "force error",
        "with rounded masses",
    ];
    Table {
        name: "rates".into(),
        title: "Directed interactions a second, N² counted".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![
            "Medians of alternating repeats; the time of a whole evaluation with all conversions. Force error: that of the kernel, for \
             positions as it sees them, of 512 bodies."
                .into(),
        ],
    }
}

fn conserving(data: &Rates) -> Table {
    let rows = data.conserving.iter().map(|it| {
        vec![
            Cell::Text(it.precision.into()),
            Cell::Text(it.arithmetic.into()),
            Cell::Count(it.steps),
            Cell::Text(format!("{:.1e}", it.error)),
        ]
    });
    Table {
        name: "conserving".into(),
        title: "Energy error of a Plummer sphere of 1024 bodies after two units of time, leapfrog".into(),
        columns: ["forces", "arithmetic", "steps of a unit of time", "|ΔE/E|"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![
            "State and energies are in double precision; ε = 0.05. Raw estimates have no correction: what they spoil is seen here.".into(),
        ],
    }
}
