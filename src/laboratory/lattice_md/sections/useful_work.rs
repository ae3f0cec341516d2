//! Useful work over density.

use crate::laboratory::lattice_md::study::density_cost::CEILING;
use crate::laboratory::lattice_md::study::useful_work::{Share, UsefulWork};
use crate::report::figure::{Axis, Band, Chart, Figure, Style};
use crate::report::{Rows, Section, Table, Verdict};

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
    Section::new("useful-work", "Useful work: operations on real contacts")
        .asks("How many of the counted operations act on a real contact?")
        .expects("BP93 counts operations, not how many of them meet a contact.")
        .verdict(Verdict::Computed)
        .answers(said)
        .figures([figure(data)])
        .tables([table(data)])
        .seeds([1])
}

fn figure(data: &UsefulWork) -> Figure {
    let curve = |value: fn(&Share) -> f64| {
        let points = data.shares.iter().map(move |share| (share.figures.occupancy, 100.0 * value(share)));
        points.filter(|(_, share)| *share > 0.0)
    };
    Chart::of(
        Axis::linear("occupancy ρ = NP/LMAX", None).between([0.0, 0.35]),
        Axis::logarithmic("share of the operations", Some("%")),
    )
    .series("lattice, forces", Style::Joined, 0, curve(|share| share.lattice_forces))
    .series("lattice, step", Style::Dashed, 0, curve(|share| share.lattice_step))
    .series("lists, forces", Style::Joined, 1, curve(|share| share.list_forces))
    .series("lists, step", Style::Dashed, 1, curve(|share| share.list_step))
    .band(Band::of_x("out of reach", [CEILING, 0.35]))
    .figure("useful_work", "Operations that act on real contacts")
    .caption("Counted operations; contacts as measured in a warm gas. Every execution of the lattice meets every place.")
}

fn table(data: &UsefulWork) -> Table {
    Rows::of(&data.shares)
        .number("ρ", 3, |share| share.figures.occupancy)
        .number("contacts a disc, each from both sides", 3, |share| share.figures.contacts)
        .number("candidates a disc", 2, |share| share.figures.candidates)
        .number("lattice, forces", 3, |share| 100.0 * share.lattice_forces)
        .number("lattice, step", 3, |share| 100.0 * share.lattice_step)
        .number("lists, forces", 3, |share| 100.0 * share.list_forces)
        .number("lists, step", 3, |share| 100.0 * share.list_step)
        .table("useful_work", "Share of the operations that act on real contacts (%)")
        .note("Eager, strip-mined and chained executions of the lattice execute the same operations. Making the lists is not counted.")
}
