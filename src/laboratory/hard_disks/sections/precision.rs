//! The error of Z over its cost.

use crate::laboratory::hard_disks::study::precision::{KNOWN_TO, Precision, STATE, Way};
use crate::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};

/// What came out.
pub fn section(data: &Precision) -> Section {
    let [packing, known] = STATE;
    let best = |engine: &str| {
        let ways = data.ways.iter().filter(|way| way.engine == engine);
        ways.filter_map(|way| Some((way, way.looks.last()?))).min_by(|a, b| a.1.error.total_cmp(&b.1.error))
    };
    let said = |engine: &str| {
        best(engine).map_or(String::new(), |(way, look)| {
            format!("{:.2} % in {:.1} s with {} discs", 100.0 * look.error, look.seconds, way.discs)
        })
    };
    Section {
        name: "hard-disks-precision".into(),
        title: "Hard discs: error of Z against processor time".into(),
        part: Part::Host,
        question: "What does an accuracy of the pressure cost in processor time?".into(),
        expected: format!(
            "Z = {known} at ν = {packing}, known to {} %. A method without a time step has two errors of a mean: chance, which falls as one \
             over the root of the time, and the finite number of discs.",
            100.0 * KNOWN_TO
        ),
        answer: format!(
            "The fast engine comes to {}, the source's way to {}; Z itself is known to {} % only.",
            said("fast"),
            said("reference"),
            100.0 * KNOWN_TO
        ),
        details: vec![],
        verdict: Verdict::Measured,
        again: "stripmine reproduce --only hard-disks-precision".into(),
        figures: vec![figure(data)],
        tables: vec![table(data)],
        excerpt: None,
        film: None,
        seeds: (1..=data.seeds).collect(),
        depends_on_host: true,
        provenance: None,
    }
}

fn named(way: &Way) -> String {
    format!("{}, N = {}", way.engine, way.discs)
}

fn figure(data: &Precision) -> Figure {
    let series = data.ways.iter().enumerate().map(|(hue, way)| Series {
        name: named(way),
        style: if way.engine == "fast" { Style::Joined } else { Style::Dashed },
        hue: hue / 2,
        points: way.looks.iter().map(|look| Point::at(look.seconds, look.error)).collect(),
    });
    let mut series: Vec<Series> = series.collect();
    let seconds = || data.ways.iter().flat_map(|way| way.looks.iter().map(|look| look.seconds));
    let ends = [seconds().fold(f64::INFINITY, f64::min), seconds().fold(0.0, f64::max)];
    series.push(Series {
        name: "to this Z is known".into(),
        style: Style::Line,
        hue: 6,
        points: ends.map(|at| Point::at(at, KNOWN_TO)).to_vec(),
    });
    Figure {
        name: "error-over-cost".into(),
        title: "Few discs soon err by their number, many by chance".into(),
        caption: format!(
            "Root mean square of the errors of {} seeds; processor time of one run.",
            data.seeds
        ),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("processor time", Some("s")),
            y: Axis::logarithmic("relative error of Z", None),
            series,
            bands: vec![],
        }),
    }
}

fn table(data: &Precision) -> Table {
    let rows = data.ways.iter().flat_map(|way| {
        way.looks.iter().map(move |look| {
            vec![
                Cell::Text(named(way)),
                Cell::Count(look.collisions),
                Cell::Number(look.seconds, 3),
                Cell::Number(1e-6 * way.rate, 3),
                Cell::Number(100.0 * look.error, 3),
                Cell::Number(100.0 * look.bias[0], 3),
                Cell::Number(100.0 * look.bias[1], 3),
            ]
        })
    });
    let columns = [
        "engine and discs",
        "collisions",
        "processor time (s)",
        "million collisions/s",
        "error of Z (%)",
        "mean error (%)",
        "its standard error (%)",
    ];
    Table {
        name: "precision".into(),
        title: "Errors of Z after growing numbers of collisions".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![],
    }
}
