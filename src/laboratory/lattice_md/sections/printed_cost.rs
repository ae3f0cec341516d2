//! The printed text on a host: NOP·(n + D) against wall time, and what thirty years made of it.

use crate::laboratory::lattice_md::study::density_cost::CEILING;
use crate::laboratory::lattice_md::study::printed_cost::{
    CELLS, Fitted, HOLDS, OCCUPANCY, PrintedCost, Timed,
};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};

/// What came out.
pub fn section(data: &PrintedCost) -> Section {
    Section::new("printed", "The printed text against the clock")
        .asks("Does NOP·(n + D) hold on this host for the source's own program, run the CRAY's way?")
        .expects(format!(
            "BP93, section 3: a part of the step takes NOP·(n + D) clock periods, whatever n; it assumes D = 20 and shows no measurement. The \
             line holds here where it is within {:.0} %.",
            100.0 * HOLDS
        ))
        .answers(answer(data))
        .verdict(verdict(data))
        .details(details(data))
        .figures([against_the_clock(data), prices_drawn(data)])
        .tables([fits(data), densities(data), prices(data)])
        .seeds([1])
        .depends_on_host()
}

/// The line holds for short vectors, and the source's holds for all.
fn verdict(data: &PrintedCost) -> Verdict {
    let holds = forces(data).is_some_and(|it| it.worst <= HOLDS);
    let everywhere = forces(data).is_some_and(|it| it.beyond <= 1.0 + HOLDS);
    Verdict::of_claims(&[holds, holds && everywhere])
}

fn kilobytes(bytes: f64) -> String {
    if bytes < 1e6 { format!("{:.0} kB", bytes / 1e3) } else { format!("{:.1} MB", bytes / 1e6) }
}

fn forces(data: &PrintedCost) -> Option<&Fitted> {
    data.fitted.iter().find(|fitted| fitted.part == "forces")
}

fn answer(data: &PrintedCost) -> String {
    let Some(Fitted { depth, holds_to, worst, beyond, .. }) = forces(data) else {
        return "Nothing was measured.".to_owned();
    };
    let longest = data.timed.iter().filter(|timed| timed.part == "forces").map(|timed| timed.n).max();
    let holds = match *worst <= HOLDS {
        true => format!(
            "The line holds within {:.0} % up to n = {holds_to} for the forces, and not beyond",
            100.0 * HOLDS,
        ),
        false => format!(
            "The line does not hold for the forces: up to n = {holds_to} it is {:.0} % off",
            100.0 * worst
        ),
    };
    format!(
        "{holds}, with D = {:.0} ({:.0} to {:.0}) where the source assumes 20; at n = {} a step takes {beyond:.1} times the line.",
        depth[1],
        depth[0],
        depth[2],
        longest.unwrap_or(0)
    )
}

fn details(data: &PrintedCost) -> Vec<String> {
    let last = data.prices.last().zip(data.prices.first()).map_or(1.0, |(last, first)| first.ns / last.ns);
    let fitted = forces(data).map(|Fitted { nop, period_ns, holds_to, bytes, .. }| {
        format!(
            "A clock period of the forces' {nop} operations is {:.3} ns an element and operation ({:.3} to {:.3}); at n = {holds_to} their registers \
             and arrays take {}. The fast lattice runs a scene {last:.0} times as fast as the printed text the CRAY's way.",
            period_ns[1],
            period_ns[0],
            period_ns[2],
            kilobytes(*bytes)
        )
    });
    let more = [
        format!(
            "One thread, {}, double precision. Eager: every instruction is a pass over all elements. Discs stand one a cell at random places and \
             all but rest: an eager text has no branch, so its time does not depend on what moves. Fits by least squares of the relative \
             differences; intervals are the range over four parts of the samples and over fits that leave out one length, on this host in this process.",
            data.instruction_set
        ),
        format!(
            "Eager at {CELLS} cells, ρ = {OCCUPANCY}, the four parts of the source's table: printed text {:.0} µs, ours {:.0} µs: {:.2} times.",
            data.printed_eager_ns / 1e3,
            data.ours_eager_ns / 1e3,
            data.printed_eager_ns / data.ours_eager_ns
        ),
    ];
    fitted.into_iter().chain(more).collect()
}

/// Nanoseconds an element and operation, at ρ of the fits.
fn over_n<'d>(data: &'d PrintedCost, part: &'d str) -> impl Iterator<Item = &'d Timed> {
    data.timed.iter().filter(move |timed| timed.part == part && timed.occupancy == OCCUPANCY)
}

fn against_the_clock(data: &PrintedCost) -> Figure {
    let curves = data.fitted.iter().enumerate().flat_map(|(hue, fitted)| {
        let timed = || over_n(data, fitted.part);
        let each = |timed: &Timed, ns: f64| ns / (timed.nop as f64 * timed.n as f64);
        let measured = timed().map(|it| (it.n as f64, each(it, it.ns), it.quartiles.map(|ns| each(it, ns))));
        let lengths = timed().map(|it| it.n).filter(|n| *n <= fitted.holds_to).map(|n| n as f64);
        let line = lengths.map(|n| (n, fitted.period_ns[1] * (n + fitted.depth[1]) / n));
        let name = format!("{}: {:.2} ns, D = {:.0}", fitted.part, fitted.period_ns[1], fitted.depth[1]);
        [Series::new(name, Style::Points, hue, measured), Series::new("", Style::Line, hue, line)]
    });
    Chart::of(
        Axis::logarithmic("length of the vectors n", None),
        Axis::logarithmic("time an element and operation", Some("ns")),
    )
    .with(curves)
    .figure("against_the_clock", "Time an element and operation of the printed text, eager")
    .caption(format!(
        "ρ = {OCCUPANCY}. Points: median and quartiles. Lines: NOP·(n + D) with its clock period and D, as far as it holds within {:.0} % \
         (fitted to the three shortest where it does not).",
        100.0 * HOLDS
    ))
}

fn prices_drawn(data: &PrintedCost) -> Figure {
    let ways = data.prices.iter().enumerate().map(|(at, price)| {
        let point = ((at + 1) as f64, price.ns, price.ends);
        Series::new(format!("{} {}", at + 1, price.way.name), Style::Points, at, [point])
    });
    let last = data.prices.len() as f64;
    Chart::of(
        Axis::linear("step of the development", None).between([0.5, last + 0.5]),
        Axis::logarithmic("processor time a disc and step", Some("ns")),
    )
    .with(ways)
    .figure("price_of_faithfulness", "One scene from the CRAY's way to today's")
    .caption(format!(
        "{} discs at packing fraction {:.2}, one thread, {}. Median, lowest and highest of {} rounds.",
        data.particles, data.packing_fraction, data.instruction_set, data.rounds
    ))
}

fn fits(data: &PrintedCost) -> Table {
    Rows::of(&data.fitted)
        .text("part", |fitted| fitted.part)
        .count("NOP", |fitted| fitted.nop)
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
        let n = if part == "forces" { CELLS } else { (occupancy * CELLS as f64) as usize };
        let of = data.timed.iter().filter(|timed| timed.occupancy == occupancy && timed.part == part);
        of.min_by_key(|timed| timed.n.abs_diff(n)).map(|timed| timed.ns / 1e3)
    };
    let mut rows = Rows::of(occupancies).number("occupancy ρ", 2, |occupancy| *occupancy);
    for fitted in &data.fitted {
        rows = rows.number(format!("{} (µs)", fitted.part), 2, |occupancy| at(*occupancy, fitted.part));
    }
    rows.text("reachable", |occupancy| if *occupancy > CEILING { "no packing of discs" } else { "" })
        .table("densities", format!("The eager step over the occupancy, on {CELLS} cells"))
        .note("The forces take as long whatever the occupancy: the source's n is LMAX.")
}

fn prices(data: &PrintedCost) -> Table {
    let first = data.prices.first().map_or(1.0, |price| price.ns);
    let before = std::iter::once(first).chain(data.prices.iter().map(|price| price.ns));
    Rows::of(data.prices.iter().zip(before).enumerate())
        .count("step", |(at, _)| at + 1)
        .text("way", |(_, (price, _))| price.way.name)
        .number("ns a disc and step", 1, |(_, (price, _))| price.ns)
        .number("lowest", 1, |(_, (price, _))| price.ends[0])
        .number("highest", 1, |(_, (price, _))| price.ends[1])
        .number("times faster than the one before", 2, |(_, (price, before))| before / price.ns)
        .number("times faster than the first", 1, |(_, (price, _))| first / price.ns)
        .text("what changes", |(_, (price, _))| price.way.change)
        .table("prices", "What each step of the development made of one scene")
}
