//! What is measured of particles in a bath.

use super::laws::PairLaw;
use super::quantities::QUANTITIES;
use crate::method::entry::bench_options;
use crate::method::{Bench, Until};
use crate::words::Words;

/// The benchmark: the source's system.
pub(super) const BENCHES: &[Bench] = &[Bench {
    name: "langevin",
    doc: "LAN17's particles in a bath",
    preset: "langevin-report",
    rate: "particle_steps_per_second",
    until: Until::Steps,
    amount: |particles| (40_000_000 / particles.max(1)).clamp(20, 20_000),
    defaults: &[("particles", "40000")],
    options: bench_options! {
        // The source's density, 4 particles in a unit of area.
        "particles" Count [], |count| {
            let side = count.parse::<f64>().map_or(100.0, |count| (count / 4.0).sqrt());
            vec![format!("particles.count={count}"), format!("domain.sides=[{side:?}, {side:?}]")]
        }, "Number of particles, at least";
        "law" Word PairLaw::WORDS, |law| vec![format!("law.kind={law}")], "Pair law of particles in a bath, a word of law.kind";
        "search" Word ["auto", "lattice", "sectors", "neighbor-list"], |by| vec![format!("search.by={by}")], "How pairs of particles in a bath are found: auto, lattice, sectors or neighbor-list";
        "sectors" Count [], |count| vec!["search.by=sectors".to_owned(), format!("search.sectors={count}")], "Sectors along each side";
        "sort" Word ["auto", "when-needed", "every-step"], |sort| {
            vec!["search.by=sectors".to_owned(), format!("search.sort={sort}")]
        }, "When particles in a bath are put in the order of their sectors: auto, when-needed or every-step";
        "skin" Number [], |skin| vec!["search.by=neighbor-list".to_owned(), format!("search.skin={skin}")], "How much farther than the cut-off listed pairs may be";
        "integrator" Word ["baoab", "stochastic", "as-printed"], |kind| vec![format!("integrator.kind={kind}")], "Integrator, such as gear4, gear5, gear6, velocity-verlet, baoab or stochastic";
        "precision" Word [], |precision| vec![format!("machine.precision={precision}")], "Precision of state and forces: f64, f32 or mixed";
        "instruction-set" Word [], |set| vec![format!("machine.instruction_set={set}")], "scalar, avx2, avx512, wide, or auto for the widest there is";
    },
    overrides: &["integrator.dt=0.001"],
    quantities: QUANTITIES,
    compared: &["temperature"],
    at_end: &["pressure"],
}];
