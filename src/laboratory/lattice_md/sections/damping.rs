//! Waves over dissipation: tables, figures and what came out.

use crate::laboratory::lattice_md::study::damping::{Case, Damping};
use crate::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};
use crate::statistics::Spread;

/// The Fano factor above which there are waves.
const EVEN: f64 = 1.0;

/// What came out.
pub fn section(data: &Damping) -> Section {
    let scan: Vec<&Case> = data.scan().collect();
    let waves = |case: &Case| case.fano.mean > EVEN;
    let strongest = scan.last().map_or(f64::NAN, |case| case.fano.mean);
    let weakest = scan.first().map_or(f64::NAN, |case| case.fano.mean);
    let controls: Vec<&Case> = data.cases.iter().filter(|case| case.overrides.len() > 1).collect();
    let found = scan.last().is_some_and(|case| waves(case));
    let even = scan.first().is_some_and(|case| !waves(case)) && controls.iter().all(|case| !waves(case));
    Section {
        name: "waves".into(),
        title: "Density waves over dissipation".into(),
        part: Part::Physics,
        question: "Does damping in contacts make the density waves?".into(),
        expected: "BP93, section 4: grains that start evenly spread form density waves. A Fano factor (variance over mean of the grains in \
                   a bin) above 1 tells waves from none; weakly damped grains and an elastic gas must show none."
            .into(),
        answer: format!(
            "The Fano factor is {weakest:.2} at the weakest and {strongest:.2} at the strongest damping; controls: {}.",
            controls.iter().map(|case| format!("{} {:.2}", case.name, case.fano.mean)).collect::<Vec<_>>().join(", ")
        ),
        details: vec![],
        verdict: match (found, even) {
            (true, true) => Verdict::Reproduced,
            (false, false) => Verdict::NotReproduced,
            _ => Verdict::Partly,
        },
        again: "stripmine reproduce --only waves".into(),
        figures: vec![figure(&scan)],
        tables: vec![table(data)],
        excerpt: None,
        film: None,
        seeds: data.seeds.clone(),
        depends_on_host: false,
        provenance: None,
    }
}

fn figure(scan: &[&Case]) -> Figure {
    let point = |case: &&Case, spread: &Spread| {
        let error = spread.error.unwrap_or(0.0);
        Point {
            x: case.normal_damping,
            y: spread.mean,
            spread: Some([(spread.mean - error).max(spread.lowest), spread.mean + error]),
        }
    };
    let ends = [scan.first(), scan.last()].into_iter().flatten();
    Figure {
        name: "fano_over_damping".into(),
        title: "Variance over mean of the grains in a bin, over the damping".into(),
        caption: "Bins of 20 mean radii; the last half of two seconds. Bars: standard error over the seeds."
            .into(),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("normal damping γ", Some("1/s")),
            y: Axis::logarithmic("Fano factor", None),
            series: vec![
                Series {
                    name: "late".into(),
                    style: Style::Joined,
                    hue: 0,
                    points: scan.iter().map(|case| point(case, &case.fano)).collect(),
                },
                Series {
                    name: "at the start".into(),
                    style: Style::Points,
                    hue: 1,
                    points: scan.iter().map(|case| point(case, &case.fano_start)).collect(),
                },
                Series {
                    name: "waves above this".into(),
                    style: Style::Dashed,
                    hue: 2,
                    points: ends.map(|case| Point::at(case.normal_damping, EVEN)).collect(),
                },
            ],
            bands: vec![],
        }),
    }
}

fn table(data: &Damping) -> Table {
    let spread = |spread: &Spread, decimals: usize| -> Cell {
        let error = spread.error.map_or(String::new(), |error| format!(" ± {error:.decimals$}"));
        Cell::Text(format!("{:.decimals$}{error}", spread.mean))
    };
    let range = |spread: &Spread| Cell::Text(format!("{:.2}–{:.2}", spread.lowest, spread.highest));
    let rows = data.cases.iter().map(|case| {
        vec![
            case.name.as_str().into(),
            spread(&case.fano_start, 2),
            spread(&case.fano, 2),
            range(&case.fano),
            spread(&case.mode_start, 3),
            spread(&case.mode, 3),
            spread(&case.flow, 3),
        ]
    });
    Table {
        name: "cases".into(),
        title: "Every case".into(),
        columns: [
            "case",
            "Fano at the start",
            "Fano late",
            "single seeds",
            "strongest mode at the start",
            "strongest mode late",
            "mean velocity late (m/s)",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
        notes: vec![format!(
            "Means over {} seeds with their standard errors. Strongest Fourier mode at wavelengths from 80 mean radii on, as a \
             fraction of the grains.",
            data.seeds.len()
        )],
    }
}
