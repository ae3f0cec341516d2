//! Figures 3 and 4 of the source, by the model.

use crate::method::lattice_md::study::density_cost::{CEILING, Curve, DensityCost};
use crate::report::figure::{Axis, Band, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};

/// What came out.
pub fn section(data: &DensityCost) -> Section {
    let crossing = data.vector.iter().map(|curve| (curve, crossing(curve, &data.list)));
    let crossings: Vec<_> = crossing
        .filter_map(|(curve, particles)| {
            Some(format!("{} for LMAX = {}", rounded(particles?), rounded(curve.cells? as f64)))
        })
        .collect();
    // Figure 3's two claims: the one hardly rises with NP, the other goes over into NP².
    let flat = data.vector.iter().all(|curve| rise(curve).is_some_and(|rise| rise < 1.5));
    let steep = slope(&data.list).is_some_and(|slope| slope > 1.8);
    Section {
        name: "cost".into(),
        title: "Cost over particles and density (figures 3 and 4)".into(),
        part: Part::Machine,
        question: "From how many particles on is a vector step shorter than one by scalar neighbour lists?".into(),
        expected: "BP93, figures 3 and 4: with D = 20 a vector step is nearly as long for few particles as for many, scalar neighbour lists \
                   rise with the square of their number; a particle's share falls with the density."
            .into(),
        answer: format!("The vector step is the shorter one from NP = {} on.", crossings.join(", ")),
        details: vec![format!(
            "Counted operations in the source's formula: the vector step rises by at most {:.1} % from the emptiest to the fullest lattice, \
             the lists at last with NP to the power {:.2}. The source prints no formula for its lists: theirs is counted from ours in the \
             same way, every scalar operation at D periods.",
            100.0 * (data.vector.iter().filter_map(rise).fold(1.0, f64::max) - 1.0),
            slope(&data.list).unwrap_or(f64::NAN),
        )],
        verdict: Verdict::reproduced(flat && steep),
        again: "stripmine reproduce --only cost".into(),
        figures: vec![figure_3(data), figure_4(data), over_density(data)],
        tables: vec![lists(data)],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: false,
        provenance: None,
    }
}

fn rounded(value: f64) -> String {
    Cell::Number(value, 0).for_reading()
}

/// The longest step over the shortest.
fn rise(curve: &Curve) -> Option<f64> {
    let costs = || curve.costs.iter().map(|cost| cost.counted);
    Some(costs().reduce(f64::max)? / costs().reduce(f64::min)?)
}

/// The power of NP with which the last two points of a curve rise.
fn slope(curve: &Curve) -> Option<f64> {
    let [.., before, last] = curve.costs.as_slice() else { return None };
    let particles = last.particles as f64 / before.particles as f64;
    Some((last.counted / before.counted).ln() / particles.ln())
}

/// NP from which on the first curve is below the second, between two of its points.
fn crossing(vector: &Curve, list: &Curve) -> Option<f64> {
    let ratios: Vec<(f64, f64)> = vector
        .costs
        .iter()
        .filter_map(|cost| {
            let rival = list.costs.iter().find(|rival| rival.particles == cost.particles)?;
            Some(((cost.particles as f64).ln(), (cost.counted / rival.counted).ln()))
        })
        .collect();
    ratios.windows(2).find(|pair| pair[0].1 > 0.0 && pair[1].1 <= 0.0).map(|pair| {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        (x0 + (x1 - x0) * y0 / (y0 - y1)).exp()
    })
}

fn points(curve: &Curve, each: bool, printed: bool) -> Vec<Point> {
    let costs = curve.costs.iter().filter_map(|cost| {
        let clocks = if printed { cost.printed? } else { cost.counted };
        Some(Point::at(cost.particles as f64, if each { clocks / cost.particles as f64 } else { clocks }))
    });
    costs.collect()
}

fn figure_3(data: &DensityCost) -> Figure {
    let mut series = vec![];
    for (hue, curve) in data.vector.iter().enumerate() {
        let cells = rounded(curve.cells.unwrap_or(0) as f64);
        series.push(Series {
            name: format!("vector, LMAX = {cells}"),
            style: Style::Line,
            hue,
            points: points(curve, false, false),
        });
    }
    series.push(Series {
        name: "neighbour lists, scalar".into(),
        style: Style::Dashed,
        hue: data.vector.len(),
        points: points(&data.list, false, false),
    });
    Figure {
        name: "figure_3".into(),
        title: "Clock periods of a step over the number of particles".into(),
        caption: format!(
            "Model: {}, counted operations. A vector curve ends where its lattice is full: ρ = {CEILING:.3}, touching discs \
             in hexagonal order on cells as wide as the radius.",
            data.machine
        ),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("number of particles NP", None),
            y: Axis::logarithmic("time of a step", Some("clock periods")),
            series,
            bands: vec![],
        }),
    }
}

fn figure_4(data: &DensityCost) -> Figure {
    let named = |curve: &Curve| format!("ρ = {:.2}", curve.occupancy.unwrap_or(f64::NAN));
    let vector = data.densities.iter().enumerate().map(|(hue, curve)| Series {
        name: if curve.reachable { named(curve) } else { format!("{}, out of reach", named(curve)) },
        style: if curve.reachable { Style::Line } else { Style::Points },
        hue,
        points: points(curve, true, false),
    });
    // The lists hardly depend on the density: the thinnest and the densest say it.
    let last = data.list_densities.len().saturating_sub(1);
    let ends = data.list_densities.iter().enumerate().filter(|(i, _)| *i == 0 || *i == last);
    let lists = ends.map(|(hue, curve)| Series {
        name: format!("lists, {}", named(curve)),
        style: Style::Dashed,
        hue,
        points: points(curve, true, false),
    });
    Figure {
        name: "figure_4".into(),
        title: "Clock periods of a particle and step over the number of particles".into(),
        caption: format!(
            "Model: {}, counted operations. Lines: vector algorithm; dashed: scalar neighbour lists; points: occupancies that \
             discs on cells as wide as their radius cannot reach (above {CEILING:.3}).",
            data.machine
        ),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("number of particles NP", None),
            y: Axis::logarithmic("time of a particle and step", Some("clock periods")),
            series: vector.chain(lists).collect(),
            bands: vec![],
        }),
    }
}

fn over_density(data: &DensityCost) -> Figure {
    let last = |curve: &Curve, printed: bool| {
        let point = *points(curve, true, printed).last()?;
        Some(Point::at(curve.occupancy?, point.y))
    };
    let curve = |curves: &[Curve], printed| curves.iter().filter_map(|curve| last(curve, printed)).collect();
    let largest = data.densities.iter().flat_map(|curve| &curve.costs).map(|cost| cost.particles).max();
    let series = |name: &str, style, hue, points| Series { name: name.into(), style, hue, points };
    Figure {
        name: "figure_4_density".into(),
        title: "Clock periods of a particle and step over the density".into(),
        caption: format!(
            "NP = {}. Hatched: occupancies that discs on cells as wide as their radius cannot reach.",
            rounded(largest.unwrap_or(0) as f64)
        ),
        picture: Picture::Chart(Chart {
            x: Axis { limits: Some([0.0, 0.55]), ..Axis::linear("occupancy ρ = NP/LMAX", None) },
            y: Axis::logarithmic("time of a particle and step", Some("clock periods")),
            series: vec![
                series("vector, counted", Style::Joined, 0, curve(&data.densities, false)),
                series("vector, as printed", Style::Dashed, 1, curve(&data.densities, true)),
                series("lists, scalar", Style::Joined, 2, curve(&data.list_densities, false)),
            ],
            bands: vec![Band::of_x("out of reach", [CEILING, 0.55])],
        }),
    }
}

fn lists(data: &DensityCost) -> Table {
    let rows = data.lists.iter().map(|figures| {
        [figures.occupancy, figures.candidates, figures.contacts, figures.steps_a_list]
            .iter()
            .zip([2, 2, 3, 1])
            .map(|(&value, decimals)| Cell::Number(value, decimals))
            .collect()
    });
    Table {
        name: "lists".into(),
        title: "What the lists hold".into(),
        columns: ["occupancy ρ", "candidates a disc", "contacts a disc", "steps a list serves"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
        notes: vec![format!(
            "Measured in the bench scene with 1024 discs over 1000 steps; each pair is in both lists. Making the lists tests \
             NP(NP − 1)/2 pairs with the law's own {} operations for distance and contact.",
            data.test_operations
        )],
    }
}
