//! Figures 3 and 4 of the source, by the model.

use crate::laboratory::lattice_md::study::density_cost::{CEILING, Curve, DensityCost};
use crate::report::figure::{Axis, Band, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};
use crate::statistics;

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
    let differ = by_density(data);
    let power = break_even_power(data);
    let claims = [
        flat,
        steep,
        differ.is_some_and(|differ| differ < ALIKE),
        power.is_some_and(|power| (power + 1.0).abs() < POWER_WITHIN),
    ];
    let differences = differ.zip(power).map_or(String::new(), |(differ, power)| {
        format!(
            "A particle's share by the lists {} on the density, up to {differ:.2} times at the same NP (by the source not at all); the NP from \
             which the lattice wins falls as ρ to the power {power:.1} (by the source −1). ",
            if differ < ALIKE { "hardly depends" } else { "depends" }
        )
    });
    Section::new("cost", "Cost over particles and density (figures 3 and 4)")
        .asks("When is a vector step shorter than one by scalar lists?")
        .expects("BP93, figures 3 and 4: a vector step is nearly flat over NP, scalar lists rise as NP²; a particle's share falls with the density for \
                  the lattice and not for the lists; the break-even NP grows as 1/ρ.")
        .answers(format!(
            "{differences}The vector step is the shorter one from NP = {} on.",
            crossings.join(", ")
        ))
        .verdict(Verdict::of_claims(&claims))
        .details([format!(
            "Counted operations in the source's formula: the vector step rises by at most {:.1} % from the emptiest to the fullest lattice, the \
             lists at last with NP to the power {:.2}. The source prints no formula for its lists: theirs is counted from ours in the same way, \
             every scalar operation at D periods.",
            100.0 * (data.vector.iter().filter_map(rise).fold(1.0, f64::max) - 1.0),
            slope(&data.list).unwrap_or(f64::NAN),
        )])
        .figures([figure_3(data), figure_4(data), over_density(data)])
        .tables([lists(data)])
        .seeds([1])
}

/// Costs that differ by less than this factor are alike.
const ALIKE: f64 = 1.1;
/// By how much a power may be off.
const POWER_WITHIN: f64 = 0.25;

/// The largest ratio of the costs of lists of different densities at the same number of particles.
fn by_density(data: &DensityCost) -> Option<f64> {
    let first = data.list_densities.first()?;
    let ratios = (0..first.costs.len()).filter_map(|at| {
        let costs = || data.list_densities.iter().filter_map(move |curve| Some(curve.costs.get(at)?.counted));
        Some(costs().reduce(f64::max)? / costs().reduce(f64::min)?)
    });
    ratios.reduce(f64::max)
}

/// The power of the density with which the number of particles falls from which on the lattice is the cheaper one: the slope of a
/// line through the logarithms.
fn break_even_power(data: &DensityCost) -> Option<f64> {
    let of = |lists: &Curve| data.densities.iter().find(|curve| curve.occupancy == lists.occupancy);
    let pairs = data.list_densities.iter().filter_map(|lists| {
        let particles = crossing(of(lists)?, lists)?;
        Some((lists.occupancy?.ln(), particles.ln()))
    });
    let (densities, particles): (Vec<f64>, Vec<f64>) = pairs.unzip();
    (densities.len() > 1).then(|| statistics::slope(&densities, &particles))
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

fn points(curve: &Curve, each: bool, printed: bool) -> Vec<(f64, f64)> {
    let costs = curve.costs.iter().filter_map(|cost| {
        let clocks = if printed { cost.printed? } else { cost.counted };
        Some((cost.particles as f64, if each { clocks / cost.particles as f64 } else { clocks }))
    });
    costs.collect()
}

fn figure_3(data: &DensityCost) -> Figure {
    let vector = data.vector.iter().enumerate().map(|(hue, curve)| {
        let cells = rounded(curve.cells.unwrap_or(0) as f64);
        Series::new(format!("vector, LMAX = {cells}"), Style::Line, hue, points(curve, false, false))
    });
    let lists = points(&data.list, false, false);
    Chart::of(
        Axis::logarithmic("number of particles NP", None),
        Axis::logarithmic("time of a step", Some("clock periods")),
    )
    .with(vector)
    .series("neighbour lists, scalar", Style::Dashed, data.vector.len(), lists)
    .figure("figure_3", "Clock periods of a step over the number of particles")
    .caption(format!(
        "Model: {}, counted operations. A vector curve ends where its lattice is full: ρ = {CEILING:.3}, touching discs in hexagonal order on \
         cells as wide as the radius.",
        data.machine
    ))
}

fn figure_4(data: &DensityCost) -> Figure {
    let named = |curve: &Curve| format!("ρ = {:.2}", curve.occupancy.unwrap_or(f64::NAN));
    let unreachable: Vec<String> =
        data.densities.iter().filter(|curve| !curve.reachable).map(named).collect();
    let vector = data.densities.iter().enumerate().map(|(hue, curve)| {
        // Those out of reach are one kind of points, named once.
        let (name, style) = match curve.reachable {
            true => (named(curve), Style::Line),
            false if unreachable.first() == Some(&named(curve)) => {
                (format!("out of reach: {}", unreachable.join(", ")), Style::Points)
            }
            false => (String::new(), Style::Points),
        };
        Series::new(name, style, hue, points(curve, true, false))
    });
    // The lists of the thinnest and of the densest are the farthest apart.
    let last = data.list_densities.len().saturating_sub(1);
    let ends = data.list_densities.iter().enumerate().filter(|(i, _)| *i == 0 || *i == last);
    let lists = ends.map(|(hue, curve)| {
        Series::new(format!("lists, {}", named(curve)), Style::Dashed, hue, points(curve, true, false))
    });
    Chart::of(
        Axis::logarithmic("number of particles NP", None),
        Axis::logarithmic("time of a particle and step", Some("clock periods")),
    )
    .with(vector)
    .with(lists)
    .figure("figure_4", "Clock periods of a particle and step over the number of particles")
    .caption(format!(
        "Model: {}, counted operations. Lines: vector algorithm; dashed: scalar neighbour lists; points: occupancies that discs on cells as wide \
         as their radius cannot reach (above {CEILING:.3}).",
        data.machine
    ))
}

fn over_density(data: &DensityCost) -> Figure {
    // Of the most particles that a density has.
    let last = |curve: &Curve, printed| Some((curve.occupancy?, points(curve, true, printed).last()?.1));
    let over = |curves, printed| {
        let curves: &[Curve] = curves;
        curves.iter().filter_map(move |curve| last(curve, printed))
    };
    let largest = data.densities.iter().flat_map(|curve| &curve.costs).map(|cost| cost.particles).max();
    Chart::of(
        Axis::linear("occupancy ρ = NP/LMAX", None).between([0.0, 0.55]),
        Axis::logarithmic("time of a particle and step", Some("clock periods")),
    )
    .series("vector, counted", Style::Joined, 0, over(&data.densities, false))
    .series("vector, as printed", Style::Dashed, 1, over(&data.densities, true))
    .series("lists, scalar", Style::Joined, 2, over(&data.list_densities, false))
    .band(Band::of_x("out of reach", [CEILING, 0.55]))
    .figure("figure_4_density", "Clock periods of a particle and step over the density")
    .caption(format!(
        "NP = {}. Hatched: occupancies that discs on cells as wide as their radius cannot reach.",
        rounded(largest.unwrap_or(0) as f64)
    ))
}

fn lists(data: &DensityCost) -> Table {
    Rows::of(&data.lists)
        .number("occupancy ρ", 2, |figures| figures.occupancy)
        .number("candidates a disc", 2, |figures| figures.candidates)
        .number("contacts a disc", 3, |figures| figures.contacts)
        .number("steps a list serves", 1, |figures| figures.steps_a_list)
        .table("lists", "What the lists hold")
        .note(format!(
            "Measured in the bench scene with 1024 discs over 1000 steps; each pair is in both lists. Making the lists tests NP(NP − 1)/2 pairs \
             with the law's own {} operations for distance and contact.",
            data.test_operations
        ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::lattice_md::study::density_cost::Cost;

    fn curve(occupancy: f64, cost: impl Fn(f64) -> f64) -> Curve {
        let particles = [10_usize, 100, 1000, 10_000, 100_000];
        let costs = particles.map(|particles| {
            let counted = cost(particles as f64);
            Cost { particles, printed: None, counted }
        });
        Curve { cells: Some(1000), occupancy: Some(occupancy), reachable: true, costs: costs.to_vec() }
    }

    /// A lattice whose step takes NP/ρ, and lists that take NP² times what `at` makes of the density.
    fn section_of(at: fn(f64) -> f64) -> Section {
        let densities = [0.05, 0.1, 0.2];
        section(&DensityCost {
            machine: "a".into(),
            vector: vec![curve(0.1, |_| 1e5)],
            list: curve(0.1, |np| np * np),
            densities: densities.map(|rho| curve(rho, move |np| 50.0 * np / rho)).to_vec(),
            list_densities: densities.map(|rho| curve(rho, move |np| np * np * at(rho))).to_vec(),
            lists: vec![],
            test_operations: 1,
        })
    }

    #[test]
    fn every_claim_of_the_figures_counts() {
        assert_eq!(section_of(|_| 1.0).verdict, Verdict::Reproduced);
        let dense = section_of(|rho| 10.0 * rho);
        assert_eq!(dense.verdict, Verdict::Partly);
        assert!(dense.answer.contains("depends on the density, up to 4.00 times"), "{}", dense.answer);
        assert!(dense.answer.contains("ρ to the power -2.0"), "{}", dense.answer);
    }
}
