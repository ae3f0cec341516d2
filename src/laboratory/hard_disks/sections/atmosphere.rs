//! Discs above a hot floor, without a ceiling.

use crate::laboratory::hard_disks::study::atmosphere::{Atmosphere, Profile};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};
use stripmine_physics::number::counted;

/// What is this near to 1 is as the law has it.
const WITHIN: f64 = 0.03;

/// What came out.
pub fn section(data: &Atmosphere) -> Section {
    let dilute = &data.profiles[0];
    let claims = [dilute.mean_height, dilute.temperature].map(|ratio| ratio.off(1.0).vanishes(WITHIN));
    Section::new("hard-disks-atmosphere", "Hard discs: above a hot floor, without a ceiling")
        .asks("Does a gas above a hot floor, without a ceiling, follow the barometric law?")
        .expects("ISO99, section 3, has a system that is open above: discs under gravity over a source of energy. In the dilute limit the \
                  density falls with the height as exp(−m g y/kT).")
        .answers(format!(
            "{} discs in {} have a mean height of {} kT/(m g), where the law has 1, and a temperature of {} \
             of the floor's (95 %).",
            dilute.discs,
            layers(dilute.layers),
            dilute.mean_height,
            dilute.temperature,
        ))
        .verdict(Verdict::of_claims(&claims))
        .details([format!(
            "With {} the room that the discs take lifts the mean height to {}. With restitution {} the gas above cools to {}.",
            layers(data.profiles[2].layers),
            data.profiles[2].mean_height,
            data.restitution,
            data.granular.temperature
        )])
        .figures([figure(data)])
        .tables([table(data), look_ups(data)])
        .seeds([1])
}

fn layers(count: f64) -> String {
    counted(count, "layer", "layers")
}

fn named(data: &Atmosphere) -> impl Iterator<Item = (String, &Profile)> {
    let elastic = data.profiles.iter().map(|profile| (layers(profile.layers), profile));
    elastic.chain([(format!("{}, e = {}", layers(data.granular.layers), data.restitution), &data.granular)])
}

fn figure(data: &Atmosphere) -> Figure {
    let barometric = data.profiles[0].heights.iter().map(|&height| (height, (-height).exp()));
    let measured = named(data).enumerate().map(|(hue, (name, profile))| {
        let seen = profile.heights.iter().zip(&profile.densities);
        let seen = seen.filter(|(_, mean)| mean.value > mean.bar);
        let points =
            seen.map(|(&height, mean)| (height, mean.value, [mean.value - mean.bar, mean.value + mean.bar]));
        Series::new(name, Style::Points, hue, points)
    });
    Chart::of(
        Axis::linear("height over kT/(m g)", None),
        Axis::logarithmic("density over the barometric one at the floor", None),
    )
    .series("barometric law", Style::Line, 6, barometric)
    .with(measured)
    .figure("profiles", "Density over the height")
    .caption(format!(
        "Means of {} looks; bars hold the mean in 95 of 100 studies, with the looks' correlation.",
        data.looks
    ))
}

fn table(data: &Atmosphere) -> Table {
    Rows::of(named(data))
        .text("discs", |(name, _)| name.clone())
        .count("how many", |(_, profile)| profile.discs)
        .number("mean height over kT/(m g)", 3, |(_, profile)| profile.mean_height.value)
        .number("± (95 %)", 3, |(_, profile)| profile.mean_height.bar)
        .number("temperature over the floor's", 3, |(_, profile)| profile.temperature.value)
        .number("± (95 %)", 3, |(_, profile)| profile.temperature.bar)
        .number("highest seen", 1, |(_, profile)| profile.highest)
        .table("atmosphere", "Discs above a hot floor")
}

fn look_ups(data: &Atmosphere) -> Table {
    Rows::of(&data.look_ups)
        .text("scene", |it| it.scene)
        .count("discs (entries of A, BX, BY)", |it| it.discs)
        .number("entries of C and D", 0, |it| it.entries)
        .count("events", |it| it.events)
        .text("same bits by the fast engine", |it| if it.agrees { "yes" } else { "no" })
        .table("look-up", "The source's look-up of occupied cells, as printed")
        .note("The source says that C and D are fewer than the discs. They grow with the height of the highest one; the default, a hash, does \
               not.")
}
