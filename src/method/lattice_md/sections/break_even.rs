//! The break-even atlas: who wins where.

use crate::method::lattice_md::study::break_even::{Atlas, Sheet};
use crate::method::lattice_md::study::density_cost::CEILING;
use crate::report::figure::{Axis, Band, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Section, Table, Verdict};

/// A lead below this is a draw in the words.
const DRAW: f64 = 1.1;

/// What came out.
pub fn section(data: &Atlas, again: &str) -> Section {
    let (right, asked) = data.agreement();
    let wins = data.sheets.iter().map(|sheet| format!("{}: {}", sheet.title, wins(sheet)));
    Section {
        name: "atlas".into(),
        title: "Who wins where: the break-even atlas".into(),
        says: "BP93, section 3: on a vector machine the lattice wins for many particles and dense packings, scalar neighbour \
               lists for few."
            .into(),
        came_out: format!(
            "{}. The host's model names the winner, or a method at most a tenth slower, at {right} of {asked} measured places.",
            wins.collect::<Vec<_>>().join(". ")
        ),
        verdict: Verdict::Shown,
        again: again.into(),
        figures: data.sheets.iter().map(figure).collect(),
        tables: vec![places(data)],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: true,
        provenance: None,
    }
}

/// At how many places each method wins.
fn wins(sheet: &Sheet) -> String {
    let winners: Vec<(usize, f64)> = sheet.places.iter().filter_map(|place| place.winner()).collect();
    let of_method = sheet.methods.iter().enumerate().filter_map(|(method, name)| {
        let places = winners.iter().filter(|(winner, _)| *winner == method).count();
        (places > 0).then(|| format!("{name} at {places} of {} places", winners.len()))
    });
    of_method.collect::<Vec<_>>().join(", ")
}

fn figure(sheet: &Sheet) -> Figure {
    let series = sheet.methods.iter().enumerate().map(|(hue, name)| {
        let won = sheet.places.iter().filter(|place| place.winner().is_some_and(|(winner, _)| winner == hue));
        let points = won.map(|place| Point::at(place.occupancy, place.particles as f64)).collect();
        Series { name: name.clone(), style: Style::Points, hue, points }
    });
    let narrow =
        sheet.places.iter().filter(|place| place.winner().is_some_and(|(_, lead)| lead < DRAW)).count();
    let estimated = if sheet.measured {
        "Moving discs, one thread, double precision; the sum over all phases of what the lowest tenth of the samples take."
    } else {
        "Candidates and contacts a disc as measured in a run of about a thousand discs of the same density."
    };
    Figure {
        name: sheet.name.clone(),
        title: format!("The cheapest method: {}", sheet.title),
        caption: format!(
            "{estimated} At {narrow} of {} places the next method costs less than a tenth more. Hatched: occupancies that \
             discs on cells as wide as their radius cannot reach.",
            sheet.places.len()
        ),
        picture: Picture::Chart(Chart {
            x: Axis { limits: Some([0.0, 0.35]), ..Axis::linear("occupancy ρ = NP/LMAX", None) },
            y: Axis { limits: Some([50.0, 100_000.0]), ..Axis::logarithmic("number of particles NP", None) },
            series: series.filter(|series| !series.points.is_empty()).collect(),
            bands: vec![Band { label: "out of reach".into(), x: [CEILING, 0.35] }],
        }),
    }
}

fn places(data: &Atlas) -> Table {
    let rows = data.sheets.iter().flat_map(|sheet| {
        sheet.places.iter().filter_map(move |place| {
            let (winner, lead) = place.winner()?;
            Some(vec![
                Cell::Text(sheet.title.clone()),
                Cell::Number(place.occupancy, 2),
                Cell::Count(place.particles as u64),
                Cell::Text(sheet.methods.get(winner)?.clone()),
                Cell::Number(lead, 2),
                Cell::Number(place.costs[winner] / place.particles as f64, 1),
                Cell::Text(sheet.unit.to_owned()),
            ])
        })
    });
    Table {
        name: "atlas".into(),
        title: "The cheapest method at each place".into(),
        columns: [
            "machine",
            "occupancy ρ",
            "NP",
            "cheapest",
            "the next costs (times)",
            "a disc and step",
            "unit",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
        notes: vec![],
    }
}
