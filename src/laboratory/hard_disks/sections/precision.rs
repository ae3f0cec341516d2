//! The error of Z over its cost.

use crate::laboratory::hard_disks::study::precision::{KNOWN_TO, Precision, STATE, Way};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table};

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
    Section::new("hard-disks-precision", "Hard discs: error of Z against processor time")
        .asks("What does an accuracy of the pressure cost in processor time?")
        .expects(format!(
            "Z = {known} at ν = {packing}, known to {} %. A method without a time step has two errors of a mean: chance, which falls as one over \
             the root of the time, and the finite number of discs.",
            100.0 * KNOWN_TO
        ))
        .answers(format!(
            "The fast engine comes to {}, the source's way to {}; Z itself is known to {} % only.",
            said("fast"),
            said("reference"),
            100.0 * KNOWN_TO
        ))
        .figures([figure(data)])
        .tables([table(data)])
        .seeds(1..=data.seeds)
        .depends_on_host()
}

fn named(way: &Way) -> String {
    format!("{}, N = {}", way.engine, way.discs)
}

fn figure(data: &Precision) -> Figure {
    let ways = data.ways.iter().enumerate().map(|(hue, way)| {
        let style = if way.engine == "fast" { Style::Joined } else { Style::Dashed };
        Series::new(named(way), style, hue / 2, way.looks.iter().map(|look| (look.seconds, look.error)))
    });
    let seconds = || data.ways.iter().flat_map(|way| way.looks.iter().map(|look| look.seconds));
    let ends = [seconds().fold(f64::INFINITY, f64::min), seconds().fold(0.0, f64::max)];
    Chart::of(Axis::logarithmic("processor time", Some("s")), Axis::logarithmic("relative error of Z", None))
        .with(ways)
        .series("to this Z is known", Style::Line, 6, ends.map(|at| (at, KNOWN_TO)))
        .figure("error-over-cost", "Few discs soon err by their number, many by chance")
        .caption(format!(
            "Root mean square of the errors of {} seeds; processor time of one run.",
            data.seeds
        ))
}

fn table(data: &Precision) -> Table {
    Rows::of(data.ways.iter().flat_map(|way| way.looks.iter().map(move |look| (way, look))))
        .text("engine and discs", |(way, _)| named(way))
        .count("collisions", |(_, look)| look.collisions)
        .number("processor time (s)", 3, |(_, look)| look.seconds)
        .number("million collisions/s", 3, |(way, _)| 1e-6 * way.rate)
        .number("error of Z (%)", 3, |(_, look)| 100.0 * look.error)
        .number("mean error (%)", 3, |(_, look)| 100.0 * look.bias[0])
        .number("its standard error (%)", 3, |(_, look)| 100.0 * look.bias[1])
        .table("precision", "Errors of Z after growing numbers of collisions")
}
