//! Discs above a hot floor, without a ceiling.

use crate::laboratory::hard_disks::study::atmosphere::{Atmosphere, Profile};
use crate::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};
use stripmine_physics::number::counted;

/// What is this near to 1 is as the law has it.
const WITHIN: f64 = 0.03;

/// What came out.
pub fn section(data: &Atmosphere) -> Section {
    let dilute = &data.profiles[0];
    let agrees = [dilute.mean_height, dilute.temperature].iter().all(|ratio| (ratio - 1.0).abs() < WITHIN);
    Section {
        name: "hard-disks-atmosphere".into(),
        title: "Hard discs: above a hot floor, without a ceiling".into(),
        part: Part::Physics,
        question: "Does a gas above a hot floor, without a ceiling, follow the barometric law?".into(),
        expected: "ISO99, section 3, has a system that is open above: discs under gravity over a source of energy. In the dilute limit the \
                   density falls with the height as exp(−m g y/kT)."
            .into(),
        answer: format!(
            "{} discs in {} have a mean height of {:.3} kT/(m g), where the law has 1, and a temperature of {:.3} of the floor's.",
            dilute.discs, layers(dilute.layers), dilute.mean_height, dilute.temperature,
        ),
        details: vec![format!(
            "With {} the room that the discs take lifts the mean height to {:.2}. With restitution {} the gas above cools to {:.3}.",
            layers(data.profiles[2].layers), data.profiles[2].mean_height, data.restitution, data.granular.temperature
        )],
        verdict: Verdict::reproduced(agrees),
        again: "stripmine reproduce --only hard-disks-atmosphere".into(),
        figures: vec![figure(data)],
        tables: vec![table(data), look_ups(data)],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: false,
        provenance: None,
    }
}

fn layers(count: f64) -> String {
    counted(count, "layer", "layers")
}

fn named(data: &Atmosphere) -> impl Iterator<Item = (String, &Profile)> {
    let elastic = data.profiles.iter().map(|profile| (layers(profile.layers), profile));
    elastic.chain([(format!("{}, e = {}", layers(data.granular.layers), data.restitution), &data.granular)])
}

fn figure(data: &Atmosphere) -> Figure {
    let heights = &data.profiles[0].heights;
    let barometric = heights.iter().map(|&height| Point::at(height, (-height).exp()));
    let mut series = vec![Series {
        name: "barometric law".into(),
        style: Style::Line,
        hue: 6,
        points: barometric.collect(),
    }];
    series.extend(named(data).enumerate().map(|(hue, (name, profile))| {
        Series {
            name,
            style: Style::Points,
            hue,
            points: profile
                .heights
                .iter()
                .zip(&profile.densities)
                .filter(|(_, [mean, error])| *mean > 2.0 * error)
                .map(|(&x, &[mean, error])| Point { x, y: mean, spread: Some([mean - error, mean + error]) })
                .collect(),
        }
    }));
    Figure {
        name: "profiles".into(),
        title: "Density over the height".into(),
        caption: format!(
            "Means of {} looks; bars are standard errors, as if looks were independent.",
            data.looks
        ),
        picture: Picture::Chart(Chart {
            x: Axis::linear("height over kT/(m g)", None),
            y: Axis::logarithmic("density over the barometric one at the floor", None),
            series,
            bands: vec![],
        }),
    }
}

fn table(data: &Atmosphere) -> Table {
    let rows = named(data).map(|(name, profile)| {
        vec![
            Cell::Text(name),
            Cell::Count(profile.discs as u64),
            Cell::Number(profile.mean_height, 3),
            Cell::Number(profile.temperature, 3),
            Cell::Number(profile.highest, 1),
        ]
    });
    let columns =
        ["discs", "how many", "mean height over kT/(m g)", "temperature over the floor's", "highest seen"];
    Table {
        name: "atmosphere".into(),
        title: "Discs above a hot floor".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![],
    }
}

fn look_ups(data: &Atmosphere) -> Table {
    let rows = data.look_ups.iter().map(|it| {
        vec![
            Cell::Text(it.scene.into()),
            Cell::Count(it.discs as u64),
            Cell::Number(it.entries, 0),
            Cell::Count(it.events),
            Cell::Text(if it.agrees { "yes" } else { "no" }.into()),
        ]
    });
    let columns = [
        "scene",
        "discs (entries of A, BX, BY)",
        "entries of C and D",
        "events",
        "same bits by the fast engine",
    ];
    Table {
        name: "look-up".into(),
        title: "The source's look-up of occupied cells, as printed".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![
            "The source says that C and D are fewer than the discs. They grow with the height of the highest one; the default, a hash, \
             does not."
                .into(),
        ],
    }
}
