//! Soft against hard.

use crate::laboratory::hard_disks::study::soft_hard::{Model, SoftHard};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};
use crate::statistics::{Claim, Mean};
use stripmine_physics::number::in_tens;

/// How near the pressure of the stiffest discs is to come to that of hard ones (%).
const WITHIN: f64 = 2.0;
/// Where there is no model.
const NOWHERE: Mean = Mean { value: f64::NAN, bar: f64::NAN };

/// What came out.
pub fn section(data: &SoftHard, again: String) -> Section {
    let hard = data.hard();
    let off = |model: &Model| {
        let Some(Mean { value, bar }) = hard.map(|hard| hard.compressibility) else { return NOWHERE };
        let off = model.compressibility.off(value);
        Mean { bar: off.bar.hypot(bar / value), ..off }.percent()
    };
    let soft: Vec<&Model> = data.models.iter().filter(|model| model.stiffness.is_some()).collect();
    let first = soft.first().map_or(NOWHERE, |model| off(model));
    let last = soft.last().map_or(NOWHERE, |model| off(model));
    let dearer = soft.last().map_or(f64::NAN, |model| model.cost) / hard.map_or(f64::NAN, |hard| hard.cost);
    Section::new("soft-hard", "Soft against hard discs")
        .asks("From which stiffness on do soft discs behave as hard ones, and what does that cost?")
        .expects("Hard discs are the limit of stiff ones; soft discs press as hard ones of their effective diameter do (Barker and Henderson).")
        .answers(format!(
            "From a stiffness of {} to {} the pressure comes from {first} % to {last} % off that of hard discs, and the stiffest \
             discs cost {dearer:.0} times as much as hard ones.",
            in_tens(soft.first().and_then(|model| model.stiffness).unwrap_or(f64::NAN), 2),
            in_tens(soft.last().and_then(|model| model.stiffness).unwrap_or(f64::NAN), 2),
        ))
        .verdict(Verdict::of_claims(&[Claim::from(last.value.abs() < first.value.abs()), last.vanishes(WITHIN)]))
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
    let bars = soft(data).map(|(stiffness, model)| {
        let Mean { value, bar } = of(model);
        (stiffness, value, [value - bar, value + bar])
    });
    let effective = soft(data).map(|(stiffness, model)| (stiffness, model.effective));
    let effective = Series::new("hard discs of the effective diameter", Style::Line, 2, effective);
    Chart::of(stiffness_axis(), Axis::linear(label, None))
        .series("soft discs", Style::Points, 0, bars)
        .with(hard_discs(data, |hard| of(hard).value))
        .with((name == "pressure").then_some(effective))
        .figure(name, title)
        .caption(format!("{} seeds; bars hold the mean in 95 of 100 studies.", data.question.seeds))
}

fn soft(data: &SoftHard) -> impl DoubleEndedIterator<Item = (f64, &Model)> {
    data.models.iter().filter_map(|model| Some((model.stiffness?, model)))
}

/// What hard discs have, as a line from the softest to the stiffest of the soft ones.
fn hard_discs(data: &SoftHard, of: impl Fn(&Model) -> f64) -> Option<Series> {
    let level = of(data.hard()?);
    let ends = [soft(data).next(), soft(data).next_back()].into_iter().flatten();
    Some(Series::new("hard discs", Style::Dashed, 1, ends.map(|(stiffness, _)| (stiffness, level))))
}

fn cost(data: &SoftHard) -> Figure {
    let own = soft(data).map(|(stiffness, model)| (stiffness, model.cost));
    Chart::of(stiffness_axis(), Axis::logarithmic("processor time for a unit of simulated time", Some("s")))
        .series("soft discs, 40 steps a contact", Style::Joined, 0, own)
        .with(hard_discs(data, |hard| hard.cost))
        .figure("cost", "What a unit of time costs")
        .caption("Processor seconds of the elastic fluid, looks included; the median of the seeds.")
}

fn table(data: &SoftHard) -> Table {
    Rows::of(&data.models)
        .cell("stiffness of a contact", |model| model.stiffness.map_or(Cell::from("hard"), Cell::Short))
        .number("damping γ_N", 3, |model| model.damping)
        .number("step", 6, |model| model.step)
        .number("depth of a contact of kT (%)", 2, |model| 100.0 * model.depth)
        .number("Z", 4, |model| model.compressibility.value)
        .number("± (95 %)", 4, |model| model.compressibility.bar)
        .number("Z of the effective diameter", 4, |model| model.effective)
        .number("T/T₀ cooled", 4, |model| model.cooled.value)
        .number("± (95 %)", 4, |model| model.cooled.bar)
        .number("cost (ms for a unit of time)", 2, |model| 1e3 * model.cost)
        .table("soft_hard", "Soft discs and hard ones")
        .note(format!(
            "The damping gives a restitution of {} at a normal speed of {:.2}, the mean of impacts at kT = m = 1.",
            data.question.restitution, data.impact_speed
        ))
}
