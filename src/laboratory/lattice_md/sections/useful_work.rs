//! Useful work over density.

use crate::laboratory::lattice_md::study::density_cost::CEILING;
use crate::laboratory::lattice_md::study::useful_work::{Share, UsefulWork};
use crate::report::figure::{Axis, Band, Chart, Figure, Point, Series, Style};
use crate::report::{Cell, Part, Rows, Section, Table};

/// What came out.
pub fn section(data: &UsefulWork) -> Section {
    let said = data.shares.last().map_or(String::new(), |share| {
        format!(
            "At ρ = {:.2} only {:.1} % of the lattice's force operations act on a real contact, and {:.0} % of the lists'; at ρ = {:.2} {} of \
             the lattice's.",
            share.figures.occupancy,
            100.0 * share.lattice_forces,
            100.0 * share.list_forces,
            data.shares[0].figures.occupancy,
            match 100.0 * data.shares[0].lattice_forces {
                few if few < 0.005 => "practically none".to_owned(),
                some => format!("{some:.2} %"),
            }
        )
    });
    Section::new("useful-work", "Useful work: operations on real contacts", Part::Machine)
        .asks("How many of the counted operations act on a real contact?")
        .expects("BP93 counts operations, not how many of them meet a contact.")
        .answers(said)
        .figures([figure(data)])
        .tables([table(data)])
        .seeds([1])
}

fn figure(data: &UsefulWork) -> Figure {
    let series = |name: &str, style, hue, value: fn(&Share) -> f64| {
        Series::new(
            name,
            style,
            hue,
            data.shares
                .iter()
                .filter(|share| value(share) > 0.0)
                .map(|share| (share.figures.occupancy, 100.0 * value(share))),
        )
    };
    Chart::of(
        Axis::linear("occupancy ρ = NP/LMAX", None).between([0.0, 0.35]),
        Axis::logarithmic("share of the operations", Some("%")),
    )
    .with([
        series("lattice, forces", Style::Joined, 0, |share| share.lattice_forces),
        series("lattice, step", Style::Dashed, 0, |share| share.lattice_step),
        series("lists, forces", Style::Joined, 1, |share| share.list_forces),
        series("lists, step", Style::Dashed, 1, |share| share.list_step),
    ])
    .band(Band::of_x("out of reach", [CEILING, 0.35]))
    .figure("useful_work", "Operations that act on real contacts")
    .caption("Counted operations; contacts as measured in a warm gas. Every execution of the lattice meets every place.")
}

fn table(data: &UsefulWork) -> Table {
    let percent = |share: f64| Cell::Number(100.0 * share, 3);
    Rows::of(&data.shares)
        .number("ρ", 3, |share| share.figures.occupancy)
        .number("contacts a disc, each from both sides", 3, |share| share.figures.contacts)
        .number("candidates a disc", 2, |share| share.figures.candidates)
        .cell("lattice, forces", |share| percent(share.lattice_forces))
        .cell("lattice, step", |share| percent(share.lattice_step))
        .cell("lists, forces", |share| percent(share.list_forces))
        .cell("lists, step", |share| percent(share.list_step))
        .table("useful_work", "Share of the operations that act on real contacts (%)")
        .note("Eager, strip-mined and chained executions of the lattice execute the same operations. Making the lists is not counted.")
}
