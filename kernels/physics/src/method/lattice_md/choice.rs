//! Choice of engine and search for `auto`: the fastest contact search that a scene allows, by measured timings.
//!
//! The choice depends on the scene alone, never on the machine or its threads, so that a run is reproducible everywhere.

use super::OnConflict;
use super::scene::{EngineChoice, GranularScene, ProgramVersion, SearchKind};
use crate::domain::Domain;
use crate::particles::Particles;
use crate::scene::Precision;
use crate::words::Words;
use stripmine_kernels::Execution;
use stripmine_kernels::sweep::lattice::Coordinates;

/// Measured rates of both searches, with their provenance.
const MEASURED: &str = include_str!("choice.csv");

/// Rates of both searches in one scene on one processor (million particle-steps a second).
#[derive(Clone, Copy, Debug, PartialEq)]
struct MeasuredRates {
    processor: &'static str,
    precision: Precision,
    discs: f64,
    packing_fraction: f64,
    lattice: f64,
    lists: f64,
}

/// Returns the rows of the table; lines that begin with # state their provenance.
fn measured_rates() -> Vec<MeasuredRates> {
    let rows = MEASURED.lines().filter(|line| !line.starts_with('#')).skip(1);
    let row = |line: &'static str| {
        let mut fields = line.split(',');
        Some(MeasuredRates {
            processor: fields.next()?,
            precision: Precision::parse(fields.next()?)?,
            discs: fields.next()?.parse().ok()?,
            packing_fraction: fields.next()?.parse().ok()?,
            lattice: fields.next()?.parse().ok()?,
            lists: fields.next()?.parse().ok()?,
        })
    };
    rows.filter_map(row).collect()
}

/// Time with the search that a crossing selects, over that with the faster one.
fn regret(it: &MeasuredRates, crossing: f64) -> f64 {
    let chosen = if it.packing_fraction > crossing { it.lattice } else { it.lists };
    it.lattice.max(it.lists) / chosen
}

/// Packing fraction above which the lattice is chosen. For a measured number of discs it is halfway between two measured packing fractions, those at
/// which the largest regret over all processors is least; between two such numbers it follows the logarithm of the number, and beyond them it is that
/// of the nearest.
fn crossing(precision: Precision, discs: usize) -> f64 {
    let rates = measured_rates();
    let of_precision = || rates.iter().filter(|it| it.precision == precision);
    let crossings = rising(of_precision().map(|it| it.discs)).into_iter().map(|discs| {
        let measured = || of_precision().filter(|it| it.discs == discs);
        let worst = |crossing: f64| measured().map(|it| regret(it, crossing)).fold(1.0, f64::max);
        let fractions = rising(measured().map(|it| it.packing_fraction));
        let halfway = fractions.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let best = halfway.min_by(|a, b| worst(*a).total_cmp(&worst(*b)));
        (discs.ln(), best.unwrap_or(1.0))
    });
    interpolated(&crossings.collect::<Vec<_>>(), (discs.max(1) as f64).ln())
}

/// Numbers in rising order, each once.
fn rising(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = numbers.collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Value of a broken line through points of rising arguments, constant beyond both ends; 1 without points.
fn interpolated(points: &[(f64, f64)], x: f64) -> f64 {
    let behind = points.partition_point(|point| point.0 < x);
    match (behind.checked_sub(1).and_then(|at| points.get(at)), points.get(behind)) {
        (Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some((_, y)), None) | (None, Some((_, y))) => *y,
        (None, None) => 1.0,
    }
}

/// Contact search with the reason for it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SearchChoice {
    pub(super) by: SearchKind,
    pub(super) reason: String,
}

/// Chooses the engine if the scene leaves it open; returns the reason.
pub(super) fn engine(scene: &mut GranularScene) -> Option<String> {
    if scene.machine.engine != EngineChoice::Auto {
        return None;
    }
    let machine = &scene.machine;
    let of_programs = machine.text == ProgramVersion::Printed
        || machine.execution != Execution::Chained
        || machine.coordinates != Coordinates::CellRelative
        || scene.search.rebuild == super::Rebuild::AllPairs;
    let (engine, reason) = match of_programs {
        true => (EngineChoice::Programs, "a key that only programs have is given"),
        false => {
            (EngineChoice::Fast, "exact, and several times as fast as programs wherever both were measured")
        }
    };
    scene.machine.engine = engine;
    Some(format!("machine.engine = \"{}\": {reason}", engine.word()))
}

/// Returns the contact searches to try for a scene, the fastest first.
pub(super) fn searches(scene: &GranularScene, domain: &Domain, particles: &Particles) -> Vec<SearchChoice> {
    let choice = |by: SearchKind, reason: String| SearchChoice { by, reason };
    if !scene.machine.is_fast() {
        return vec![choice(SearchKind::Lattice, "BP93's programs need it".to_owned())];
    }
    let search = &scene.search;
    if search.cell_edge.is_some() || search.mask.is_some() || search.on_conflict == OnConflict::Resolve {
        return vec![choice(SearchKind::Lattice, "a key that only the lattice has is given".to_owned())];
    }
    let area: f64 = particles.all().iter().map(|disc| std::f64::consts::PI * disc.radius * disc.radius).sum();
    let (packing_fraction, discs) = (area / (domain.area()), particles.len());
    let crossing = crossing(scene.machine.precision, discs);
    let on_lattice = choice(SearchKind::Lattice, {
        format!(
            "the packing fraction {packing_fraction:.3} is above {crossing:.3}, up to which lists are chosen"
        )
    });
    let by_lists = choice(SearchKind::NeighborList, {
        format!(
            "the packing fraction {packing_fraction:.3} is at most {crossing:.3}, beyond which the lattice is chosen"
        )
    });
    let in_sectors =
        choice(SearchKind::Sectors, "neither the lattice nor lists suit these discs in this box".to_owned());
    let lists_instead =
        choice(SearchKind::NeighborList, "no lattice suits these discs in this box".to_owned());
    let lattice_instead = choice(SearchKind::Lattice, "the box is too small for lists".to_owned());
    if packing_fraction > crossing {
        vec![on_lattice, lists_instead, in_sectors]
    } else {
        vec![by_lists, lattice_instead, in_sectors]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_interpolated_between_measured_numbers() {
        let points = [(1.0, 0.2), (3.0, 0.6)];
        let at = |x: f64| interpolated(&points, x);
        assert_eq!((at(0.0), at(1.0), at(3.0), at(9.0)), (0.2, 0.2, 0.6, 0.6));
        assert!((at(1.5) - 0.3).abs() < 1e-12);
        assert_eq!(rising([3.0, 1.0, 3.0].into_iter()), [1.0, 3.0]);
    }

    #[test]
    fn every_precision_has_crossings_between_thin_and_dense() {
        for (precision, _) in Precision::ALL {
            for discs in [1, 10_000, 100_000, 1_000_000, 10_000_000] {
                assert!((0.5..0.85).contains(&crossing(*precision, discs)), "{precision:?} {discs}");
            }
        }
        let rows = MEASURED.lines().filter(|line| !line.starts_with('#')).count() - 1;
        assert_eq!(measured_rates().len(), rows);
    }

    /// Time with the chosen search over that with the better one, over all measured scenes of all processors: at most 1.05 in the median, and 1.15.
    #[test]
    fn choice_costs_little_on_every_processor() {
        let of = |it: &MeasuredRates| regret(it, crossing(it.precision, it.discs as usize));
        let mut regrets: Vec<(f64, MeasuredRates)> =
            measured_rates().into_iter().map(|it| (of(&it), it)).collect();
        regrets.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!(regrets[regrets.len() / 2].0 <= 1.05);
        let (largest, where_it_is) = regrets[regrets.len() - 1];
        assert!(largest <= 1.15, "{largest} {where_it_is:?}");
    }
}
