//! Sample figures of each kind, for tests.

use super::super::{
    Chart, ChartAxis, ChartBand, Drawing, DrawnShape, Figure, Guide, HeatMap, Picture, Series, SeriesPoint,
    Style, Tint,
};

/// All samples.
pub(crate) fn all() -> Vec<Figure> {
    vec![
        logarithmic(),
        linear(),
        map(),
        mask(),
        pipe(),
        long_pipe(),
        panels(),
        names(),
        named_rows(),
        few_cells(),
    ]
}

fn figure(name: &str, title: &str, picture: Picture) -> Figure {
    picture.figure(name, title).caption("What a reader must also know.")
}

fn single(chart: Chart) -> Picture {
    Picture::Charts(vec![(String::new(), chart)])
}

/// Models and measurements over decades, and a band.
pub(crate) fn logarithmic() -> Figure {
    let models = ["clock of the paper: n + D", "clock with strips of 64", "chained, by level of memory"];
    let measured = ["CRAY's way, measured", "strip-mined, measured", "chained, measured (AVX-512, one core)"];
    let time = |kind: usize, length: f64| {
        [2e-8 * (length + 120.0), 1.1e-8 * (length + 14.0), 1.4e-9 * (length + 40.0)][kind]
    };
    let all = (0..3).flat_map(|kind| {
        let curve = (0..=60).map(|i| 10f64.powf(f64::from(i) * 0.1)).map(|x| (x, time(kind, x)));
        let dots = (0..12).map(|i| 10f64.powf(0.2 + 0.5 * f64::from(i))).filter(|x| *x < 1e6).map(|x| {
            let y = time(kind, x) * [0.8, 1.15, 1.3, 0.95][x as usize % 4];
            (x, y, [y * 0.6, y * 1.7])
        });
        [
            Series::new(models[kind], Style::Line, kind, curve),
            Series::new(measured[kind], Style::Points, kind, dots),
        ]
    });
    let chart = Chart::of(
        ChartAxis::logarithmic("Vector length", None),
        ChartAxis::logarithmic("Time of a vector instruction", Some("s")),
    )
    .with(all)
    .band(ChartBand::of_x("beyond the caches", [2e5, f64::INFINITY]))
    .band(ChartBand::of_y("within 15 %", [0.85, 1.15]));
    figure(
        "logarithmic",
        "Time of a vector instruction by its length: models and measurements",
        single(chart),
    )
}

/// Three curves with linear axes.
pub(crate) fn linear() -> Figure {
    let grid = |count: u32| (0..=count).map(move |i| 0.9 * f64::from(i) / f64::from(count));
    let friction = grid(90).map(|x| (x, (6.0 * x).sin() * 20.0 + 22.0 * x));
    let rival = grid(90).map(|x| (x, 18.0 * x * x - 4.0));
    let seen = grid(14).map(|x| (x, (6.0 * x).sin() * 18.0 + 24.0 * x));
    let chart =
        Chart::of(ChartAxis::linear("Packing fraction ν", None), ChartAxis::linear("Flow", Some("kg/s")))
            .series("with friction", Style::Line, 0, friction)
            .series("what a neighbour list would need", Style::Dashed, 1, rival)
            .series("seen", Style::Joined, 2, seen)
            .series(
                "mean of what is seen",
                Style::Ribbon,
                2,
                [(0.3, 9.0, [7.0, 11.0]), (0.9, 9.0, [7.0, 11.0])],
            )
            .band(ChartBand::of_x("no configuration is denser", [0.84, 0.9]));
    figure("linear", "Flow through the pipe", single(chart))
}

/// Map of density waves.
pub(crate) fn map() -> Figure {
    let value = |i: usize, j: usize| {
        let (x, t) = (i as f64 / 120.0, j as f64 / 80.0);
        let wave = ((x * 14.0 - t * 9.0).sin() + 0.6 * (x * 31.0 + t * 7.0).cos()).max(-0.9);
        0.12 + 0.25 * (wave + 0.9) * (0.3 + 0.7 * t)
    };
    let limited =
        |label, unit, limits| ChartAxis { limits: Some(limits), ..ChartAxis::linear(label, Some(unit)) };
    let picture = HeatMap {
        x: limited("Place along the pipe", "m", [0.0, 1.0]),
        y: limited("Time", "s", [0.0, 4.0]),
        value: ChartAxis::linear("Packing fraction of the grains in a slice of the pipe", None),
        rows: (0..80).map(|j| (0..120).map(|i| value(i, j)).collect()).collect(),
    };
    figure("map", "Grains bunch up: density over place and time", Picture::Map(picture))
}

/// Panels with common axes and lines that mark values.
pub(crate) fn panels() -> Figure {
    let chart = |factor: f64| {
        let curve = |power: f64| {
            (0..=40)
                .map(move |i| 10f64.powf(1.0 + f64::from(i) * 0.1))
                .map(move |x| (x, factor * x.powf(power)))
        };
        Chart::of(
            ChartAxis::logarithmic("discs", None),
            ChartAxis::logarithmic("Time of a collision", Some("µs")),
        )
        .series("list and queue", Style::Joined, 0, curve(0.1).step_by(5))
        .series("grid and tournament", Style::Joined, 1, curve(0.3).step_by(5))
        .series("n log n", Style::Dashed, 6, curve(0.2))
        .band(ChartBand::of_x("L1", [300.0; 2]))
        .band(ChartBand::of_x("L2", [9000.0; 2]))
        .band(ChartBand::of_x("L3", [11000.0; 2]))
        .band(ChartBand::of_y("as it stands", [3.0; 2]))
    };
    let all = [("5×5", 1.0), ("7×7", 2.0), ("round, 24 places", 0.4)]
        .map(|(name, factor)| (name.to_owned(), chart(factor)));
    figure("panels", "Time of a collision by mask", Picture::Charts(all.to_vec()))
}

/// Points on a horizontal axis of names.
pub(crate) fn names() -> Figure {
    let maps = [
        "two-discs",
        "dense-gas",
        "pipe-small",
        "shaken-box",
        "langevin-strength",
        "langevin-friction",
        "kepler",
    ];
    let points = (0..7).map(|i| (f64::from(i), 1.0 + 0.2 * f64::from(i % 3), [0.7, 1.9]));
    let chart = Chart::of(
        ChartAxis::names("map", maps),
        ChartAxis::linear("edge of what works over the step of theory", None),
    )
    .series("measured", Style::Points, 0, points)
    .band(ChartBand::of_y("theory", [1.0; 2]));
    figure("names", "Edge over theory", single(chart))
}

/// Points on a vertical axis of names.
pub(crate) fn named_rows() -> Figure {
    let Picture::Charts(mut charts) = names().picture else { unreachable!() };
    let Chart { x, y, mut series, .. } = charts.remove(0).1;
    for point in &mut series[0].points {
        *point = SeriesPoint::at(point.y, point.x);
    }
    let chart = Chart { x: y, y: x, series, bands: vec![ChartBand::of_x("theory", [1.0; 2])] };
    figure("named-rows", "Edge over theory", single(chart))
}

/// Map of a few cells, one of them empty.
pub(crate) fn few_cells() -> Figure {
    let rows = (0..5).map(|j| {
        (0..6).map(|i| if i + j == 9 { f64::NAN } else { 1.03 * f64::from(1 + i * j * j) }).collect()
    });
    let map = HeatMap {
        x: ChartAxis::names("search", ["lists", "lattice", "sectors", "fast", "faithful", "pairs"]),
        y: ChartAxis::logarithmic("number of particles", None).between([31.6, 3.16e6]),
        value: ChartAxis::logarithmic("Time over that of the cheapest", None),
        rows: rows.collect(),
    };
    figure("few-cells", "Time lost by the wrong choice", Picture::Map(map))
}

/// Neighbourhood with numbers in its cells.
pub(crate) fn mask() -> Figure {
    let mut shapes = Vec::new();
    let mut number = 0;
    for j in (-2..=2).rev() {
        for i in -2..=2_i32 {
            let [x, y] = [f64::from(i), f64::from(j)];
            let (tint, words) = match (i, j) {
                (0, 0) => (Tint::Hue(0), "own".to_owned()),
                _ => {
                    number += 1;
                    (if number > 12 { Tint::Still } else { Tint::Clear }, number.to_string())
                }
            };
            let corners = [[x - 0.5, y - 0.5], [x + 0.5, y + 0.5]];
            shapes.push(DrawnShape::Rectangle { corners, tint });
            shapes.push(DrawnShape::Text { centre: [x, y], height: 0.26, words });
        }
    }
    let picture =
        Drawing { window: [[-2.5, -2.5], [2.5, 2.5]], width: 420.0, shapes, shades: None, guide: None };
    figure("mask", "The 24 neighbours of a cell, in the order of their turn", Picture::Drawing(picture))
}

/// Piece of a pipe, with walls of discs and spinning grains.
pub(crate) fn pipe() -> Figure {
    pipe_of("pipe", 30, 900.0, "Grains in a piece of the pipe")
}

/// Whole pipe, a hundred times as long as wide.
pub(crate) fn long_pipe() -> Figure {
    pipe_of("long-pipe", 1000, 3600.0, "The whole pipe, a hundred times as long as wide")
}

fn pipe_of(name: &str, columns: u32, width: f64, title: &str) -> Figure {
    let mut shapes = Vec::new();
    let length = f64::from(columns);
    for i in 0..=columns {
        for y in [0.0, 10.0] {
            shapes.push(DrawnShape::Disc { centre: [f64::from(i), y], radius: 0.5, tint: Tint::Still });
        }
    }
    for i in 0..columns {
        for j in 0..10 {
            // Arbitrary repeating numbers between 0 and 1.
            let [a, b, c] = [7, 11, 13].map(|k| f64::from((i * 37 + j * 101 + 17) * k % 97) / 96.0);
            let centre = [f64::from(i) + 0.5 + 0.1 * a, 0.95 + 0.85 * f64::from(j) + 0.1 * b];
            shapes.push(DrawnShape::Disc { centre, radius: 0.32 + 0.1 * c, tint: Tint::Shade(a) });
        }
    }
    let window = [[0.0, -0.5], [length, 10.5]];
    let guide = Some(Guide { unit: "diameters".into(), gravity: Some([1.0, -0.5]) });
    let shades = Some((-40.0, 40.0, "Spin (1/s)".into()));
    figure(name, title, Picture::Drawing(Drawing { window, width, shapes, shades, guide }))
}
