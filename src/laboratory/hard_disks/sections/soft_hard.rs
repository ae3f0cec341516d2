//! Soft against hard.

use crate::laboratory::hard_disks::study::soft_hard::{Mean, Model, SoftHard};
use crate::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};
use stripmine_physics::number::in_tens;

/// What came out.
pub fn section(data: &SoftHard, again: String) -> Section {
    let hard = data.hard();
    let off = |model: &Model| {
        let hard = hard.map_or(f64::NAN, |hard| hard.compressibility[0]);
        100.0 * (model.compressibility[0] / hard - 1.0)
    };
    let soft: Vec<&Model> = data.models.iter().filter(|model| model.stiffness.is_some()).collect();
    let first = soft.first().map_or(f64::NAN, |model| off(model));
    let last = soft.last().map_or(f64::NAN, |model| off(model));
    let dearer = soft.last().map_or(f64::NAN, |model| model.cost) / hard.map_or(f64::NAN, |hard| hard.cost);
    Section {
        name: "soft-hard".into(),
        title: "Soft against hard discs".into(),
        part: Part::Physics,
        question: "From which stiffness on do soft discs behave as hard ones, and what does that cost?".into(),
        expected: "Hard discs are the limit of stiff ones; soft discs press as hard ones of their effective diameter do (Barker and \
                   Henderson)."
            .into(),
        answer: format!(
            "From a stiffness of {} to {} the pressure comes from {first:.1} % to {last:.1} % of that of hard discs, and the stiffest discs cost \
             {dearer:.0} times as much as hard ones.",
            in_tens(soft.first().and_then(|model| model.stiffness).unwrap_or(f64::NAN), 2),
            in_tens(soft.last().and_then(|model| model.stiffness).unwrap_or(f64::NAN), 2),
        ),
        details: vec![format!("{} discs at ν = {}.", data.discs, data.question.packing_fraction)],
        verdict: Verdict::reproduced(last.abs() < first.abs() && last.abs() < 2.0),
        again,
        figures: vec![
            over_stiffness(data, "pressure", "Compressibility of the elastic fluid", "compressibility Z", |model| {
                model.compressibility
            }),
            over_stiffness(
                data,
                "cooled",
                &format!("Temperature after a time of {:.2}, restitution {}", data.cooling_time, data.question.restitution),
                "temperature over that at the start",
                |model| model.cooled,
            ),
            cost(data),
        ],
        tables: vec![table(data)],
        excerpt: None,
        film: None,
        seeds: (1..=data.question.seeds).collect(),
        depends_on_host: true,
        provenance: None,
    }
}

fn stiffness_axis() -> Axis {
    Axis::logarithmic("stiffness of a contact", Some("reduced"))
}

/// An observable of the soft discs, and that of the hard ones as a line.
fn over_stiffness(data: &SoftHard, name: &str, title: &str, label: &str, of: fn(&Model) -> Mean) -> Figure {
    let soft = || data.models.iter().filter_map(|model| Some((model.stiffness?, model)));
    let ends: Vec<f64> =
        [soft().next(), soft().next_back()].into_iter().flatten().map(|(stiffness, _)| stiffness).collect();
    let mut series = vec![Series {
        name: "soft discs".into(),
        style: Style::Points,
        hue: 0,
        points: soft()
            .map(|(x, model)| {
                let [y, error] = of(model);
                Point { x, y, spread: Some([y - 2.0 * error, y + 2.0 * error]) }
            })
            .collect(),
    }];
    if let Some(hard) = data.hard() {
        let [mean, _] = of(hard);
        let points = ends.iter().map(|&x| Point::at(x, mean)).collect();
        series.push(Series { name: "hard discs".into(), style: Style::Dashed, hue: 1, points });
    }
    if name == "pressure" {
        series.push(Series {
            name: "hard discs of the effective diameter".into(),
            style: Style::Line,
            hue: 2,
            points: soft().map(|(x, model)| Point::at(x, model.effective)).collect(),
        });
    }
    Figure {
        name: name.into(),
        title: title.into(),
        caption: format!("{} seeds; bars are two standard errors.", data.question.seeds),
        picture: Picture::Chart(Chart {
            x: stiffness_axis(),
            y: Axis::linear(label, None),
            series,
            bands: vec![],
        }),
    }
}

fn cost(data: &SoftHard) -> Figure {
    let soft = || data.models.iter().filter_map(|model| Some((model.stiffness?, model)));
    let ends: Vec<f64> =
        [soft().next(), soft().next_back()].into_iter().flatten().map(|(stiffness, _)| stiffness).collect();
    let mut series = vec![Series {
        name: "soft discs, 40 steps a contact".into(),
        style: Style::Joined,
        hue: 0,
        points: soft().map(|(x, model)| Point::at(x, model.cost)).collect(),
    }];
    if let Some(hard) = data.hard() {
        series.push(Series {
            name: "hard discs".into(),
            style: Style::Dashed,
            hue: 1,
            points: ends.iter().map(|&x| Point::at(x, hard.cost)).collect(),
        });
    }
    Figure {
        name: "cost".into(),
        title: "What a unit of time costs".into(),
        caption: "Processor seconds of the elastic fluid, looks included; the median of the seeds.".into(),
        picture: Picture::Chart(Chart {
            x: stiffness_axis(),
            y: Axis::logarithmic("processor time for a unit of simulated time", Some("s")),
            series,
            bands: vec![],
        }),
    }
}

fn table(data: &SoftHard) -> Table {
    let rows = data.models.iter().map(|model| {
        let number =
            |value: Option<f64>, digits| value.map_or(Cell::Nothing, |value| Cell::Number(value, digits));
        vec![
            model.stiffness.map_or(Cell::from("hard"), |stiffness| Cell::Text(format!("{stiffness:e}"))),
            number(model.damping, 3),
            number(model.step, 6),
            Cell::Number(100.0 * model.depth, 2),
            Cell::Number(model.compressibility[0], 4),
            Cell::Number(model.compressibility[1], 4),
            Cell::Number(model.effective, 4),
            Cell::Number(model.cooled[0], 4),
            Cell::Number(model.cooled[1], 4),
            Cell::Number(1e3 * model.cost, 2),
        ]
    });
    let columns = [
        "stiffness of a contact",
        "damping γ_N",
        "step",
        "depth of a contact of kT (%)",
        "Z",
        "± (standard error)",
        "Z of the effective diameter",
        "T/T₀ cooled",
        "± (standard error)",
        "cost (ms for a unit of time)",
    ];
    Table {
        name: "soft_hard".into(),
        title: "Soft discs and hard ones".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![format!(
            "The damping gives a restitution of {} at a normal speed of {:.2}, the mean of impacts at kT = m = 1.",
            data.question.restitution, data.impact_speed
        )],
    }
}
