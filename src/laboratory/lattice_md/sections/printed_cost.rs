//! The printed text on a host: NOP·(n + D) against wall time, and what thirty years made of it.

use crate::laboratory::lattice_md::study::density_cost::CEILING;
use crate::laboratory::lattice_md::study::printed_cost::{
    CELLS, Fitted, HOLDS, OCCUPANCY, PrintedCost, Timed,
};
use crate::report::figure::{Axis, Chart, Figure, Point, Series, Style};
use crate::report::{Cell, Part, Rows, Section, Table};

/// What came out.
pub fn section(data: &PrintedCost) -> Section {
    Section::new("printed", "The printed text against the clock", Part::Host)
        .asks("Does NOP·(n + D) hold on this host for the source's own program, run the CRAY's way?")
        .expects(format!(
            "BP93, section 3: a part of the step takes NOP·(n + D) clock periods, whatever n; it assumes D = 20 and shows no measurement. The \
             line holds here where it is within {:.0} %.",
            100.0 * HOLDS
        ))
        .answers(answer(data))
        .details(details(data))
        .figures([against_the_clock(data), prices_drawn(data)])
        .tables([fits(data), densities(data), prices(data)])
        .seeds([1])
        .depends_on_host()
}

fn kilobytes(bytes: f64) -> String {
    if bytes < 1e6 { format!("{:.0} kB", bytes / 1e3) } else { format!("{:.1} MB", bytes / 1e6) }
}

fn forces(data: &PrintedCost) -> Option<&Fitted> {
    data.fitted.iter().find(|fitted| fitted.part == "forces")
}

fn answer(data: &PrintedCost) -> String {
    let Some(Fitted { nop, period_ns, depth, holds_to, bytes, worst, beyond, .. }) = forces(data) else {
        return "Nothing was measured.".to_owned();
    };
    let longest = data.timed.iter().filter(|timed| timed.part == "forces").map(|timed| timed.n).max();
    let last = data.prices.last().zip(data.prices.first()).map_or(1.0, |(last, first)| first.ns / last.ns);
    let holds = match *worst <= HOLDS {
        true => format!(
            "The straight line holds within {:.0} % up to n = {holds_to} for the forces ({nop} operations; there their registers and arrays take \
             {})",
            100.0 * HOLDS,
            kilobytes(*bytes)
        ),
        false => format!(
            "The straight line does not hold for the forces ({nop} operations): up to n = {holds_to}, where their registers and arrays take {}, \
             it is {:.0} % off",
            kilobytes(*bytes),
            100.0 * worst
        ),
    };
    format!(
        "{holds}: a clock period of {:.3} ns an element and operation ({:.3} to {:.3}) and D = {:.0} ({:.0} to {:.0}), where the source assumes \
         20. At n = {} a step takes {beyond:.1} times the line. The fast lattice runs a scene {last:.0} times as fast as the printed text the \
         CRAY's way.",
        period_ns[1],
        period_ns[0],
        period_ns[2],
        depth[1],
        depth[0],
        depth[2],
        longest.unwrap_or(0)
    )
}

fn details(data: &PrintedCost) -> Vec<String> {
    vec![
        format!(
            "One thread, {}, double precision. Eager: every instruction is a pass over all elements. Discs stand one a cell at random places and \
             all but rest: an eager text has no branch, so its time does not depend on what moves. Fits by least squares of the relative \
             differences; intervals are the range over four parts of the samples, each spread over the measurement.",
            data.instruction_set
        ),
        format!(
            "Eager at {CELLS} cells, ρ = {OCCUPANCY}, the four parts of the source's table: printed text {:.0} µs, ours {:.0} µs: {:.2} times.",
            data.printed_eager_ns / 1e3,
            data.ours_eager_ns / 1e3,
            data.printed_eager_ns / data.ours_eager_ns
        ),
    ]
}

/// Nanoseconds an element and operation, at ρ of the fits.
fn over_n<'d>(data: &'d PrintedCost, part: &'d str) -> impl Iterator<Item = &'d Timed> {
    data.timed.iter().filter(move |timed| timed.part == part && timed.occupancy == OCCUPANCY)
}

fn against_the_clock(data: &PrintedCost) -> Figure {
    let mut series = vec![];
    for (hue, fitted) in data.fitted.iter().enumerate() {
        let each = |timed: &Timed, ns: f64| ns / (timed.nop as f64 * timed.n as f64);
        let points = over_n(data, fitted.part).map(|timed| (timed.n as f64, each(timed, timed.ns), timed.quartiles.map(|ns| each(timed, ns))));
        series.push(Series::new(fitted.part, Style::Points, hue, points));
        let line = over_n(data, fitted.part).filter(|timed| timed.n <= fitted.holds_to).map(|timed| {
            let n = timed.n as f64;
            Point::at(n, fitted.period_ns[1] * (n + fitted.depth[1]) / n)
        });
        let name = format!("{:.2} ns, D = {:.0}", fitted.period_ns[1], fitted.depth[1]);
        series.push(Series::new(name, Style::Line, hue, line));
    }
    Chart::of(
        Axis::logarithmic("length of the vectors n", None),
        Axis::logarithmic("time an element and operation", Some("ns")),
    )
    .with(series)
    .figure("against_the_clock", "Time an element and operation of the printed text, eager")
    .caption(format!(
        "ρ = {OCCUPANCY}. Points: median and quartiles. Lines: NOP·(n + D) with its clock period and D, as far as it holds within {:.0} % \
         (fitted to the three shortest where it does not).",
        100.0 * HOLDS
    ))
}

fn prices_drawn(data: &PrintedCost) -> Figure {
    let series = data.prices.iter().enumerate().map(|(at, price)| {
        Series::new(
            format!("{} {}", at + 1, price.way.name),
            Style::Points,
            at,
            [((at + 1) as f64, price.ns, price.ends)],
        )
    });
    let ways = data.prices.len() as f64;
    Chart::of(
        Axis::linear("step of the development", None).between([0.5, ways + 0.5]),
        Axis::logarithmic("processor time a disc and step", Some("ns")),
    )
    .with(series)
    .figure("price_of_faithfulness", "One scene from the CRAY's way to today's")
    .caption(format!(
        "{} discs at packing fraction {:.2}, one thread, {}. Median, lowest and highest of {} rounds.",
        data.particles, data.packing_fraction, data.instruction_set, data.rounds
    ))
}

fn headings(words: &[&str]) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).collect()
}

fn fits(data: &PrintedCost) -> Table {
    Rows::of(&data.fitted)
        .text("part", |fitted| fitted.part)
        .text("NOP", |fitted| fitted.nop)
        .number("clock period (ns)", 3, |fitted| fitted.period_ns[1])
        .number("lowest", 3, |fitted| fitted.period_ns[0])
        .number("highest", 3, |fitted| fitted.period_ns[2])
        .number("D", 0, |fitted| fitted.depth[1])
        .number("D lowest", 0, |fitted| fitted.depth[0])
        .number("D highest", 0, |fitted| fitted.depth[2])
        .count("holds to n", |fitted| fitted.holds_to)
        .number("registers and arrays there (kB)", 0, |fitted| fitted.bytes / 1e3)
        .number("largest difference (%)", 1, |fitted| 100.0 * fitted.worst)
        .number("times the line at the longest n", 2, |fitted| fitted.beyond)
        .table("fits", "NOP·(n + D) on this host, part by part")
        .note("n of predictor and corrector is NP, of the index the number of discs too, though it also clears LMAX cells.")
}

fn densities(data: &PrintedCost) -> Table {
    let mut occupancies: Vec<f64> = data.timed.iter().map(|timed| timed.occupancy).collect();
    occupancies.sort_by(f64::total_cmp);
    occupancies.dedup();
    let at = |occupancy: f64, part: &str| {
        data.timed
            .iter()
            .filter(|timed| timed.occupancy == occupancy && timed.part == part)
            .min_by_key(|timed| {
                timed.n.abs_diff(if part == "forces" { CELLS } else { (occupancy * CELLS as f64) as usize })
            })
            .map_or(Cell::Nothing, |timed| Cell::Number(timed.ns / 1e3, 2))
    };
    let rows = occupancies.iter().map(|&occupancy| {
        let mut cells = vec![Cell::Number(occupancy, 2)];
        cells.extend(data.fitted.iter().map(|fitted| at(occupancy, fitted.part)));
        cells.push(if occupancy > CEILING { "no packing of discs" } else { "" }.into());
        cells
    });
    let mut columns = vec!["occupancy ρ".to_owned()];
    columns.extend(data.fitted.iter().map(|fitted| format!("{} (µs)", fitted.part)));
    columns.push("reachable".to_owned());
    Table {
        name: "densities".into(),
        title: format!("The eager step over the occupancy, on {CELLS} cells"),
        columns,
        rows: rows.collect(),
        notes: vec!["The forces take as long whatever the occupancy: the source's n is LMAX.".to_owned()],
    }
}

fn prices(data: &PrintedCost) -> Table {
    let first = data.prices.first().map_or(1.0, |price| price.ns);
    let mut before = first;
    let rows = data.prices.iter().enumerate().map(|(at, price)| {
        let gain = before / price.ns;
        before = price.ns;
        vec![
            Cell::Count(at as u64 + 1),
            price.way.name.into(),
            Cell::Number(price.ns, 1),
            Cell::Number(price.ends[0], 1),
            Cell::Number(price.ends[1], 1),
            Cell::Number(gain, 2),
            Cell::Number(first / price.ns, 1),
            price.way.change.into(),
        ]
    });
    Table {
        name: "prices".into(),
        title: "What each step of the development made of one scene".to_owned(),
        columns: headings(&[
            "step",
            "way",
            "ns a disc and step",
            "lowest",
            "highest",
            "times faster than the one before",
            "times faster than the first",
            "what changes",
        ]),
        rows: rows.collect(),
        notes: vec![],
    }
}
