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

/// Measured packing fractions at which the lattice and the lists are equally fast, with their provenance.
const MEASURED: &str = include_str!("choice.csv");

/// Measured crossing of the timings.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Crossing {
    precision: Precision,
    discs: f64,
    packing_fraction: f64,
}

/// Returns the rows of the table; lines that begin with # state their provenance.
fn crossings() -> Vec<Crossing> {
    let rows = MEASURED.lines().filter(|line| !line.starts_with('#')).skip(1);
    let row = |line: &str| {
        let mut fields = line.split(',');
        Some(Crossing {
            precision: Precision::parse(fields.next()?)?,
            discs: fields.next()?.parse().ok()?,
            packing_fraction: fields.next()?.parse().ok()?,
        })
    };
    rows.filter_map(row).collect()
}

/// Packing fraction above which the lattice is faster: that of the measured number of discs closest in its logarithm.
fn crossing(precision: Precision, discs: usize) -> f64 {
    let away = |crossing: &Crossing| (crossing.discs / discs.max(1) as f64).ln().abs();
    let of_precision = crossings().into_iter().filter(|crossing| crossing.precision == precision);
    of_precision.min_by(|a, b| away(a).total_cmp(&away(b))).map_or(1.0, |crossing| crossing.packing_fraction)
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
            "the packing fraction {packing_fraction:.3} is above {crossing:.3}, where lists are equally fast"
        )
    });
    let by_lists = choice(SearchKind::NeighborList, {
        format!(
            "the packing fraction {packing_fraction:.3} is at most {crossing:.3}, where the lattice is equally fast"
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
    fn every_precision_has_crossings_between_thin_and_dense() {
        for (precision, _) in Precision::ALL {
            for discs in [1, 10_000, 100_000, 10_000_000] {
                assert!((0.5..0.85).contains(&crossing(*precision, discs)), "{precision:?}");
            }
        }
        assert_eq!(
            crossings().len(),
            MEASURED.lines().filter(|line| line.starts_with('f') || line.starts_with('m')).count()
        );
    }
}
