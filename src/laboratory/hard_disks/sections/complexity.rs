//! What a collision costs over the number of discs.

use crate::laboratory::hard_disks::study::complexity::{COUNTED, Complexity, Cost};
use crate::laboratory::hard_disks::study::rates::ENGINES;
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};

/// A logarithm fits where it is off by no more than this factor anywhere.
const FITS: f64 = 1.25;

/// What came out.
pub fn section(data: &Complexity) -> Section {
    let spread = |of: &dyn Fn(&Cost) -> f64, engine: &str, packing_fraction: f64| {
        let own =
            data.costs.iter().filter(|it| (it.engine, it.packing_fraction) == (engine, packing_fraction));
        let (low, high) =
            own.map(of).fold((f64::INFINITY, 0.0_f64), |(low, high), it| (low.min(it), high.max(it)));
        high / low
    };
    let growth = |of: &dyn Fn(&Cost) -> f64| {
        data.fits.iter().map(|fit| spread(of, fit.engine, fit.packing_fraction)).fold(1.0, f64::max)
    };
    let operations = growth(&|it| it.operations[0]).max(growth(&|it| it.operations[3]));
    let off = data.fits.iter().map(|fit| fit.off).fold(1.0, f64::max);
    let sizes = || data.costs.iter().map(|it| it.discs as f64);
    let ends = [sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max)];
    Section::new("hard-disks-complexity", "Hard discs: the cost of a collision over the number of discs")
        .asks("Does the cost of a collision grow with the logarithm of the number of discs?")
        .expects("ISO99: O(log N) an event, for the queue; all else is of a disc and its surroundings.")
        .answers(format!(
            "From {} to {} discs a collision has at most {operations:.2} times as many predictions and moves in the queue, but takes up to {:.1} \
             times as long: discs no longer lie in the caches. A logarithm of the number is off the time by up to {off:.1} times.",
            Cell::Number(ends[0], 0).for_reading(),
            Cell::Number(ends[1], 0).for_reading(),
            growth(&|it| it.seconds),
        ))
        .verdict(Verdict::of_claims(&[operations < ends[1].ln() / ends[0].ln(), off < FITS]))
        .figures([figure(data, ends)])
        .tables([table(data)])
        .seeds([1])
        .depends_on_host()
}

fn figure(data: &Complexity, ends: [f64; 2]) -> Figure {
    let curves = data.fits.iter().enumerate().flat_map(|(hue, fit)| {
        let own = data
            .costs
            .iter()
            .filter(|it| (it.engine, it.packing_fraction) == (fit.engine, fit.packing_fraction));
        let name = format!("{}, ν = {}", fit.engine, fit.packing_fraction);
        [
            Series::new(name, Style::Joined, hue, own.map(|it| (it.discs as f64, 1e6 * it.seconds))),
            Series::new(String::new(), Style::Dashed, hue, ends.map(|discs| (discs, 1e6 * fit.at(discs)))),
        ]
    });
    Chart::of(Axis::logarithmic("discs", None), Axis::logarithmic("processor time of a collision", Some("µs")))
        .with(curves)
        .figure("complexity", "The cost of a collision over the number of discs")
        .caption(
            "Dashed: a + b log₂ N, fitted to all sizes. One thread, f64; medians of rounds in which the engines take turns.",
        )
}

fn table(data: &Complexity) -> Table {
    let mut rows =
        Rows::of(ENGINES.iter().flat_map(|engine| data.costs.iter().filter(move |it| it.engine == *engine)))
            .text("engine", |it| it.engine)
            .number("ν", 2, |it| it.packing_fraction)
            .count("discs", |it| it.discs)
            .number("time (µs)", 3, |it| 1e6 * it.seconds);
    for (kind, (_, name)) in COUNTED.into_iter().enumerate() {
        rows = rows.number(name, 3, move |it| it.operations[kind]);
    }
    rows.table("complexity", "Of a collision: processor time and counted operations").note(
        "The source's way predicts for two discs and all in their masks, and puts all discs into cells at every filling, which the fastest \
         disc asks for: the more discs, the faster it is. Lists of each disc's own are renewed one at a time.",
    )
}
