//! Soft against hard.

use crate::laboratory::hard_disks::study::soft_hard::{Mean, Model, SoftHard};
use crate::report::figure::{Axis, Chart, Figure, Point, Series, Style};
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
    Section::new("soft-hard", "Soft against hard discs", Part::Physics)
        .asks("From which stiffness on do soft discs behave as hard ones, and what does that cost?")
        .expects("Hard discs are the limit of stiff ones; soft discs press as hard ones of their effective diameter do (Barker and Henderson).")
        .answers(format!(
            "From a stiffness of {} to {} the pressure comes from {first:.1} % to {last:.1} % of that of hard discs, and the stiffest discs cost \
             {dearer:.0} times as much as hard ones.",
            in_tens(soft.first().and_then(|model| model.stiffness).unwrap_or(f64::NAN), 2),
            in_tens(soft.last().and_then(|model| model.stiffness).unwrap_or(f64::NAN), 2),
        ))
        .verdict(Verdict::reproduced(last.abs() < first.abs() && last.abs() < 2.0))
        .details([format!("{} discs at ν = {}.", data.discs, data.question.packing_fraction)])
        .figures([
            over_stiffness(
                data,
                "pressure",
                "Compressibility of the elastic fluid",
                "compressibility Z",
                |model| model.compressibility,
            ),
            over_stiffness(
                data,
                "cooled",
                &format!(
                    "Temperature after a time of {:.2}, restitution {}",
                    data.cooling_time, data.question.restitution
                ),
                "temperature over that at the start",
                |model| model.cooled,
            ),
            cost(data),
        ])
        .tables([table(data)])
        .again(again)
        .seeds(1..=data.question.seeds)
        .depends_on_host()
}

fn stiffness_axis() -> Axis {
    Axis::logarithmic("stiffness of a contact", Some("reduced"))
}

/// An observable of the soft discs, and that of the hard ones as a line.
fn over_stiffness(data: &SoftHard, name: &str, title: &str, label: &str, of: fn(&Model) -> Mean) -> Figure {
    let soft = || data.models.iter().filter_map(|model| Some((model.stiffness?, model)));
    let ends: Vec<f64> =
        [soft().next(), soft().next_back()].into_iter().flatten().map(|(stiffness, _)| stiffness).collect();
    let mut series = vec![Series::new(
        "soft discs",
        Style::Points,
        0,
        soft().map(|(x, model)| {
            let [y, error] = of(model);
            Point { x, y, spread: Some([y - 2.0 * error, y + 2.0 * error]) }
        }),
    )];
    if let Some(hard) = data.hard() {
        let [mean, _] = of(hard);
        let points = ends.iter().map(|&x| Point::at(x, mean)).collect();
        series.push(Series::new("hard discs", Style::Dashed, 1, points));
    }
    if name == "pressure" {
        series.push(Series::new(
            "hard discs of the effective diameter",
            Style::Line,
            2,
            soft().map(|(x, model)| Point::at(x, model.effective)),
        ));
    }
    Chart::of(stiffness_axis(), Axis::linear(label, None))
        .with(series)
        .figure(name, title)
        .caption(format!("{} seeds; bars are two standard errors.", data.question.seeds))
}

fn cost(data: &SoftHard) -> Figure {
    let soft = || data.models.iter().filter_map(|model| Some((model.stiffness?, model)));
    let ends: Vec<f64> =
        [soft().next(), soft().next_back()].into_iter().flatten().map(|(stiffness, _)| stiffness).collect();
    let mut series = vec![Series::new(
        "soft discs, 40 steps a contact",
        Style::Joined,
        0,
        soft().map(|(x, model)| Point::at(x, model.cost)),
    )];
    if let Some(hard) = data.hard() {
        series.push(Series::new(
            "hard discs",
            Style::Dashed,
            1,
            ends.iter().map(|&x| Point::at(x, hard.cost)),
        ));
    }
    Chart::of(stiffness_axis(), Axis::logarithmic("processor time for a unit of simulated time", Some("s")))
        .with(series)
        .figure("cost", "What a unit of time costs")
        .caption("Processor seconds of the elastic fluid, looks included; the median of the seeds.")
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
