//! Useful work over density.

use crate::laboratory::lattice_md::study::density_cost::CEILING;
use crate::laboratory::lattice_md::study::useful_work::{Share, UsefulWork};
use crate::report::figure::{Axis, Band, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};

/// What came out.
pub fn section(data: &UsefulWork) -> Section {
    let said = data.shares.last().map_or(String::new(), |share| {
        format!(
            "At ρ = {:.2} only {:.1} % of the lattice's force operations act on a real contact, and {:.0} % of the lists'; at ρ = {:.2} \
             {} of the lattice's.",
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
    Section {
        name: "useful-work".into(),
        title: "Useful work: operations on real contacts".into(),
        part: Part::Machine,
        question: "How many of the counted operations act on a real contact?".into(),
        expected: "BP93 counts operations, not how many of them meet a contact.".into(),
        answer: said,
        details: vec![],
        verdict: Verdict::Measured,
        again: "stripmine reproduce --only useful-work".into(),
        figures: vec![figure(data)],
        tables: vec![table(data)],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: false,
        provenance: None,
    }
}

fn figure(data: &UsefulWork) -> Figure {
    let series = |name: &str, style, hue, value: fn(&Share) -> f64| Series {
        name: name.into(),
        style,
        hue,
        points: data
            .shares
            .iter()
            .filter(|share| value(share) > 0.0)
            .map(|share| Point::at(share.figures.occupancy, 100.0 * value(share)))
            .collect(),
    };
    Figure {
        name: "useful_work".into(),
        title: "Operations that act on real contacts".into(),
        caption: "Counted operations; contacts as measured in a warm gas. Every execution of the lattice meets every place."
            .into(),
        picture: Picture::Chart(Chart {
            x: Axis { limits: Some([0.0, 0.35]), ..Axis::linear("occupancy ρ = NP/LMAX", None) },
            y: Axis::logarithmic("share of the operations", Some("%")),
            series: vec![
                series("lattice, forces", Style::Joined, 0, |share| share.lattice_forces),
                series("lattice, step", Style::Dashed, 0, |share| share.lattice_step),
                series("lists, forces", Style::Joined, 1, |share| share.list_forces),
                series("lists, step", Style::Dashed, 1, |share| share.list_step),
            ],
            bands: vec![Band::of_x("out of reach", [CEILING, 0.35])],
        }),
    }
}

fn table(data: &UsefulWork) -> Table {
    let percent = |share: f64| Cell::Number(100.0 * share, 3);
    let rows = data.shares.iter().map(|share| {
        vec![
            Cell::Number(share.figures.occupancy, 3),
            Cell::Number(share.figures.contacts, 3),
            Cell::Number(share.figures.candidates, 2),
            percent(share.lattice_forces),
            percent(share.lattice_step),
            percent(share.list_forces),
            percent(share.list_step),
        ]
    });
    Table {
        name: "useful_work".into(),
        title: "Share of the operations that act on real contacts (%)".into(),
        columns: [
            "ρ",
            "contacts a disc, each from both sides",
            "candidates a disc",
            "lattice, forces",
            "lattice, step",
            "lists, forces",
            "lists, step",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
        notes: vec![
            "Eager, strip-mined and chained executions of the lattice execute the same operations. Making the lists is not \
             counted."
                .to_owned(),
        ],
    }
}
