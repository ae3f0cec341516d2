//! Haff's law, and inelastic collapse.

use crate::laboratory::hard_disks::study::cooling::{Cooling, haff};
use crate::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};

/// What came out.
pub fn section(data: &Cooling) -> Section {
    let worst = data.gases.iter().map(|gas| gas.off[0].abs()).fold(0.0, f64::max);
    let collapsed: Vec<String> = data
        .fates
        .iter()
        .filter(|fate| fate.collapse.is_some())
        .map(|fate| format!("e = {}", fate.restitution))
        .collect();
    let last = data.gases.first().and_then(|gas| gas.collisions.last()).copied().unwrap_or(0.0);
    Section {
        name: "hard-disks-cooling".into(),
        title: "Hard discs: a granular gas cools".into(),
        part: Part::Physics,
        question: "Does a granular gas cool by Haff's law, and what becomes of one that dissipates too much?".into(),
        expected: "Haff: T = T₀/(1 + t/t₀)², t₀ = 4/((1 − e²) ω₀), as long as the gas is even. Too dissipative ones collapse: collisions \
                   without end in a finite time."
            .into(),
        answer: format!(
            "After {last:.0} collisions of each disc the temperature is within {:.1} % of Haff's law for every restitution shown.",
            100.0 * worst
        ),
        details: vec![format!(
            "Collapse is found, with its pair, for {}; a contact duration of {} cures each.",
            if collapsed.is_empty() { "none".to_owned() } else { collapsed.join(", ") },
            data.contact_duration
        )],
        verdict: Verdict::reproduced(worst < 0.05),
        again: "stripmine reproduce --only hard-disks-cooling".into(),
        figures: vec![figure(data)],
        tables: vec![gases(data), fates(data)],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: false,
        provenance: None,
    }
}

fn figure(data: &Cooling) -> Figure {
    let mut series = vec![];
    for (hue, gas) in data.gases.iter().enumerate() {
        let later = || gas.times.iter().copied().enumerate().skip(1);
        series.push(Series {
            name: format!("e = {}, Haff", gas.restitution),
            style: Style::Line,
            hue,
            points: later().map(|(_, time)| Point::at(time, haff(time, gas.haff_time))).collect(),
        });
        series.push(Series {
            name: format!("e = {}, measured", gas.restitution),
            style: Style::Points,
            hue,
            points: later().step_by(2).map(|(at, time)| Point::at(time, gas.temperatures[at])).collect(),
        });
    }
    Figure {
        name: "haff".into(),
        title: "Haff's law".into(),
        caption: format!(
            "{} discs at ν = 0.25; t₀ from the collision rate of an elastic gas, nothing is fitted.",
            Cell::Number(data.discs as f64, 0).for_reading()
        ),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("time since the first look", Some("reduced")),
            y: Axis::logarithmic("temperature over that of the first look", None),
            series,
            bands: vec![],
        }),
    }
}

fn gases(data: &Cooling) -> Table {
    let rows = data.gases.iter().map(|gas| {
        vec![
            Cell::Number(gas.restitution, 2),
            Cell::Number(gas.collisions.last().copied().unwrap_or(0.0), 1),
            Cell::Number(gas.haff_time, 3),
            Cell::Number(gas.temperatures.last().copied().unwrap_or(f64::NAN), 4),
            Cell::Number(100.0 * gas.off[0], 2),
            Cell::Number(100.0 * gas.off[1], 2),
        ]
    });
    let columns = [
        "restitution",
        "collisions of a disc",
        "t₀",
        "T/T₀ at the end",
        "off Haff by time (%)",
        "off Haff by collisions (%)",
    ];
    Table {
        name: "gases".into(),
        title: "Temperatures beside Haff's law".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec!["By collisions: T = T₀ exp(−(1 − e²) collisions/N).".into()],
    }
}

fn fates(data: &Cooling) -> Table {
    let rows = data.fates.iter().map(|fate| {
        vec![
            Cell::Number(fate.restitution, 2),
            Cell::Number(fate.collisions, 1),
            Cell::Text(fate.collapse.clone().unwrap_or_else(|| "no collapse".into())),
            fate.made_elastic.map_or(Cell::Nothing, |share| Cell::Number(100.0 * share, 3)),
        ]
    });
    let columns =
        ["restitution", "collisions of a disc", "what was found", "made elastic by the contact duration (%)"];
    Table {
        name: "collapse".into(),
        title: "What becomes of very dissipative gases in 200 collisions of a disc".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![],
    }
}
