//! The source's comparison of masks.

use crate::laboratory::hard_disks::study::masks::{Cost, Masks, TERMS};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};

/// The formula fits where it is off by no more than this factor anywhere.
const FITS: f64 = 1.25;

/// What came out.
pub fn section(data: &Masks) -> Section {
    let slower = data.best.iter().map(|(packing_fraction, best, auto)| {
        let seconds = |mask: &str| {
            let own = data.costs.iter();
            own.clone()
                .find(|cost| cost.mask == mask && cost.packing_fraction == *packing_fraction)
                .map(|cost| cost.seconds)
        };
        Some(seconds(auto)? / seconds(best)? - 1.0)
    });
    // A choice that was not measured may be as bad as any.
    let worst = slower.fold(0.0, |worst: f64, slower| slower.map_or(f64::INFINITY, |it| worst.max(it)));
    let off = |cost: &&Cost| (cost.fitted / cost.seconds).max(cost.seconds / cost.fitted);
    let farthest = data.costs.iter().max_by(|a, b| off(a).total_cmp(&off(b)));
    let densest = data.best.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let dilutest = data.best.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let dense_wants_the_smallest =
        densest.is_some_and(|it| it.1 == "min") && dilutest.is_some_and(|it| it.1 != "min");
    Section::new("hard-disks-masks", "Hard discs: which mask")
        .asks("Which mask makes a collision the cheapest, and does the program choose it?")
        .expects("ISO99, section 4: dense systems want the smallest mask, dilute ones a larger one, which is filled less often; its formula of \
                  the cost.")
        .answers(format!(
            "{} Cheapest: {}; what `mask = \"auto\"` chooses costs at most {:.0} % more.",
            farthest.map_or(String::new(), |cost| format!(
                "The source's formula of the cost is off by up to {:.1} times, at ν = {} with {}.",
                off(&cost),
                cost.packing_fraction,
                cost.mask
            )),
            data.best
                .iter()
                .map(|(nu, best, _)| format!("{best} at ν = {nu}"))
                .collect::<Vec<_>>()
                .join(", "),
            100.0 * worst,
        ))
        .verdict(Verdict::of_claims(&[
            dense_wants_the_smallest,
            farthest.is_none_or(|cost| off(&cost) < FITS),
        ]))
        .details([format!(
            "With four constants fitted, the formula is off by {:.0} % over all masks and densities (root of the mean square).",
            100.0 * data.error
        )])
        .figures([figure(data)])
        .tables([table(data), constants(data)])
        .seeds([1])
        .depends_on_host()
}

fn figure(data: &Masks) -> Figure {
    let curves = data.best.iter().enumerate().flat_map(|(hue, (packing_fraction, ..))| {
        let drawn = |name: String, style, of: fn(&Cost) -> f64| {
            let own = data.costs.iter().filter(|cost| cost.packing_fraction == *packing_fraction);
            Series::new(name, style, hue, own.map(|cost| (cost.places as f64, 1e6 * of(cost))))
        };
        [
            drawn(format!("ν = {packing_fraction}"), Style::Points, |cost| cost.seconds),
            drawn(String::new(), Style::Dashed, |cost| cost.fitted),
        ]
    });
    Chart::of(
        Axis::logarithmic("places of the mask", None),
        Axis::logarithmic("processor time of a collision", Some("µs")),
    )
    .with(curves)
    .figure("masks", "The cost of a collision over the mask")
    .caption(format!(
        "Dashed: the source's formula. {} discs, the source's way, one thread; medians of rounds in which the masks take turns.",
        Cell::Number(data.discs as f64, 0).for_reading()
    ))
}

fn table(data: &Masks) -> Table {
    Rows::of(&data.costs)
        .number("ν", 2, |cost| cost.packing_fraction)
        .text("mask", |cost| cost.mask)
        .count("places", |cost| cost.places)
        .number("collision (µs)", 2, |cost| 1e6 * cost.seconds)
        .number("by the formula (µs)", 2, |cost| 1e6 * cost.fitted)
        .number("fillings in a thousand collisions", 3, |cost| 1e3 * cost.fillings)
        .table("masks", "Processor time of a collision")
}

fn constants(data: &Masks) -> Table {
    Rows::of(TERMS.into_iter().zip(data.constants))
        .text("of what", |(term, _)| *term)
        .number("nanoseconds", 2, |(_, constant)| 1e9 * constant)
        .table("constants", "The source's formula of the cost, fitted")
        .note("The source's k_MVS, k_CBT and k_UPDATE grow alike with the collisions and are the first constant here, for nothing in these runs \
               sets them apart; 2 k_PP N_g is the second; k_EEPGM is the third and, for the predictions, the fourth.")
}
