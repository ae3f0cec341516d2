//! Haff's law, and inelastic collapse.

use crate::laboratory::hard_disks::study::cooling::{Cooling, haff};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};

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
    Section::new("hard-disks-cooling", "Hard discs: a granular gas cools")
        .asks("Does a granular gas cool by Haff's law, and what becomes of one that dissipates too much?")
        .expects("Haff: T = T₀/(1 + t/t₀)², t₀ = 4/((1 − e²) ω₀), as long as the gas is even. Too dissipative ones collapse: collisions without \
                  end in a finite time.")
        .answers(format!(
            "After {last:.0} collisions of each disc the temperature is within {:.1} % of Haff's law for every restitution shown.",
            100.0 * worst
        ))
        .verdict(Verdict::reproduced(worst < 0.05))
        .details([format!(
            "Collapse is found, with its pair, for {}; a contact duration of {} cures each.",
            if collapsed.is_empty() { "none".to_owned() } else { collapsed.join(", ") },
            data.contact_duration
        )])
        .figures([figure(data)])
        .tables([gases(data), fates(data)])
        .seeds([1])
}

fn figure(data: &Cooling) -> Figure {
    let curves = data.gases.iter().enumerate().flat_map(|(hue, gas)| {
        let later = || gas.times.iter().copied().enumerate().skip(1);
        let haff = later().map(|(_, time)| (time, haff(time, gas.haff_time)));
        let measured = later().step_by(2).map(|(at, time)| (time, gas.temperatures[at]));
        [
            Series::new(format!("e = {}, Haff", gas.restitution), Style::Line, hue, haff),
            Series::new(format!("e = {}, measured", gas.restitution), Style::Points, hue, measured),
        ]
    });
    Chart::of(
        Axis::logarithmic("time since the first look", Some("reduced")),
        Axis::logarithmic("temperature over that of the first look", None),
    )
    .with(curves)
    .figure("haff", "Haff's law")
    .caption(format!(
        "{} discs at ν = 0.25; t₀ from the collision rate of an elastic gas, nothing is fitted.",
        Cell::Number(data.discs as f64, 0).for_reading()
    ))
}

fn gases(data: &Cooling) -> Table {
    Rows::of(&data.gases)
        .number("restitution", 2, |gas| gas.restitution)
        .number("collisions of a disc", 1, |gas| gas.collisions.last().copied().unwrap_or(0.0))
        .number("t₀", 3, |gas| gas.haff_time)
        .number("T/T₀ at the end", 4, |gas| gas.temperatures.last().copied().unwrap_or(f64::NAN))
        .number("off Haff by time (%)", 2, |gas| 100.0 * gas.off[0])
        .number("off Haff by collisions (%)", 2, |gas| 100.0 * gas.off[1])
        .table("gases", "Temperatures beside Haff's law")
        .note("By collisions: T = T₀ exp(−(1 − e²) collisions/N).")
}

fn fates(data: &Cooling) -> Table {
    Rows::of(&data.fates)
        .number("restitution", 2, |fate| fate.restitution)
        .number("collisions of a disc", 1, |fate| fate.collisions)
        .text("what was found", |fate| fate.collapse.clone().unwrap_or_else(|| "no collapse".into()))
        .number("made elastic by the contact duration (%)", 3, |fate| {
            fate.made_elastic.map(|share| 100.0 * share)
        })
        .table("collapse", "What becomes of very dissipative gases in 200 collisions of a disc")
}
