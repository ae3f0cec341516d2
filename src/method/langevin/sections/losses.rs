//! Particles lost over the step.

use crate::method::langevin::study::losses::{LossTable, SCHEMES};
use crate::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};
use crate::words::Words;

/// What came out.
pub fn section(data: &LossTable) -> Section {
    let at = |dt: f64| data.rows.iter().find(|row| row.dt == dt).map_or([0; 2], |row| row.lost);
    let [long, short] = [at(0.01), at(0.001)];
    let falls = data.rows.windows(2).all(|pair| pair[0].lost[0] >= pair[1].lost[0]);
    let ratios = || data.boundaries.iter().map(|boundary| boundary.dt / boundary.bounds[0]);
    let (least, most) = (ratios().fold(f64::INFINITY, f64::min), ratios().fold(0.0, f64::max));
    let by_limit = || data.boundaries.iter().map(|boundary| boundary.dt / boundary.bounds[1]);
    Section {
        name: "langevin-losses".into(),
        title: "Langevin: particles lost to a long step".into(),
        part: Part::Physics,
        question: "From which step on are particles lost, and does the source's bound on the step prevent it?".into(),
        expected: "LAN17: of 40 000 particles 19 200 are lost in 100 steps of 1, 6393 of 0.1, 754 of 0.01 and none of 0.001; steps below \
                   √(2 m r_c/F) should do."
            .into(),
        answer: format!(
            "Losses grow with the step ({} at 0.01, {} at 0.001), and the bound does not suffice: the longest step without a loss is \
             {least:.2} to {most:.2} of it.",
            long[0], short[0],
        ),
        details: vec![format!(
            "The boundary was found by bisection over four strengths and three temperatures. Beside the limit by the spring that a pair \
             is in its hardest collisions it lies at {:.2} to {:.2}.",
            by_limit().fold(f64::INFINITY, f64::min),
            by_limit().fold(0.0, f64::max)
        )],
        verdict: Verdict::reproduced(falls && short == [0, 0]),
        again: "stripmine reproduce --only langevin-losses".into(),
        figures: vec![losses(data), boundaries(data)],
        tables: vec![loss_table(data), boundary_table(data)],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: false,
        provenance: None,
    }
}

fn losses(data: &LossTable) -> Figure {
    let source = data.rows.iter().rev().filter_map(|row| Some((row.dt, row.source? as f64)));
    let source = source.filter(|(_, lost)| *lost > 0.0).map(|(dt, lost)| Point::at(dt, lost));
    let ours = SCHEMES.iter().enumerate().map(|(which, scheme)| Series {
        name: scheme.word().into(),
        style: Style::Joined,
        hue: which,
        points: data
            .rows
            .iter()
            .rev()
            .filter(|row| row.lost[which] > 0)
            .map(|row| Point::at(row.dt, row.lost[which] as f64))
            .collect(),
    });
    Figure {
        name: "losses".into(),
        title: "Particles lost in 100 steps".into(),
        caption: format!(
            "Of {}. Steps without a loss are not drawn. In the source's table fewer are lost at long steps: no strength and \
             temperature gave its counts.",
            data.particles
        ),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("time step", Some("reduced")),
            y: Axis::logarithmic("particles lost", None),
            series: ours
                .chain([Series {
                    name: "source".into(),
                    style: Style::Points,
                    hue: 6,
                    points: source.collect(),
                }])
                .collect(),
            bands: vec![],
        }),
    }
}

fn boundaries(data: &LossTable) -> Figure {
    let points = |of: &dyn Fn(usize) -> f64| -> Vec<Point> {
        let mut points: Vec<Point> =
            (0..data.boundaries.len()).map(|at| Point::at(data.boundaries[at].bounds[0], of(at))).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        points
    };
    let series = |name: &str, style, hue, points| Series { name: name.into(), style, hue, points };
    Figure {
        name: "boundaries".into(),
        title: "Longest step without a loss beside two bounds".into(),
        caption: "For ε of 0.1 to 100 and kT of 0.1 to 10. The source's bound knows no temperature: where particles meet hard, the \
                  spring between them is far stiffer than at the distance σ."
            .into(),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("the source's bound on the step", Some("reduced")),
            y: Axis::logarithmic("time step", Some("reduced")),
            series: vec![
                series("the source's bound", Style::Line, 6, points(&|at| data.boundaries[at].bounds[0])),
                series("by the hardest collisions", Style::Points, 1, points(&|at| data.boundaries[at].bounds[1])),
                series("measured", Style::Points, 0, points(&|at| data.boundaries[at].dt)),
            ],
            bands: vec![],
        }),
    }
}

fn loss_table(data: &LossTable) -> Table {
    let rows = data.rows.iter().map(|row| {
        vec![
            Cell::Number(row.dt, 3),
            Cell::Count(row.lost[0]),
            Cell::Count(row.lost[1]),
            row.source.map_or(Cell::Text(String::new()), Cell::Count),
        ]
    });
    Table {
        name: "losses".into(),
        title: format!("Particles lost in 100 steps, of {}", data.particles),
        columns: ["dt", "stochastic", "baoab", "source"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec!["ε = kT = γ = m = 1, σ = 0.1, four particles in a unit of area.".into()],
    }
}

fn boundary_table(data: &LossTable) -> Table {
    let rows = data.boundaries.iter().map(|it| {
        vec![
            Cell::Number(it.strength, 1),
            Cell::Number(it.temperature, 1),
            Cell::Number(it.dt, 5),
            Cell::Number(it.bounds[0], 5),
            Cell::Number(it.dt / it.bounds[0], 3),
            Cell::Number(it.bounds[1], 5),
            Cell::Number(it.dt / it.bounds[1], 3),
        ]
    });
    let columns = ["ε", "kT", "longest step", "source's bound", "of it", "by hardest collisions", "of it"];
    Table {
        name: "boundaries".into(),
        title: "Longest step without a loss in 100 steps, BAOAB, to 5 %".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![],
    }
}
