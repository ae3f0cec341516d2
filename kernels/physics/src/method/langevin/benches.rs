//! Benchmark of Langevin dynamics.

use super::laws::PairLaw;
use super::quantities::QUANTITIES;
use crate::method::entry::bench_options;
use crate::method::{Bench, Until};
use crate::words::Words;

/// Benchmark with the system of LAN17.
pub(super) const BENCHES: &[Bench] = &[Bench {
    name: "langevin",
    doc: "LAN17's particles in a bath",
    preset: "langevin-report",
    rate: "particle_steps_per_second",
    until: Until::Steps,
    amount: |particles| (40_000_000 / particles.max(1)).clamp(20, 20_000),
    least_warm_up: 200,
    defaults: &[("particles", "40000")],
    options: bench_options! {
        // LAN17's density: 4 particles per unit of area.
        "particles" [], |count| {
            let side = count.parse::<f64>().map_or(100.0, |count| (count / 4.0).sqrt());
            vec![format!("particles.count={count}"), format!("domain.sides=[{side:?}, {side:?}]")]
        };
        "law" PairLaw::WORDS, |law| vec![format!("law.kind={law}")];
        "search" ["auto", "lattice", "sectors", "neighbor-list"], |by| vec![format!("search.by={by}")];
        "sectors" [], |count| vec!["search.by=sectors".to_owned(), format!("search.sectors={count}")];
        "sort" ["auto", "when-needed", "every-step"], |sort| {
            vec!["search.by=sectors".to_owned(), format!("search.sort={sort}")]
        };
        "skin" [], |skin| vec!["search.by=neighbor-list".to_owned(), format!("search.skin={skin}")];
        "integrator" ["baoab", "stochastic", "as-printed"], |kind| vec![format!("integrator.kind={kind}")];
        "precision" [], |precision| vec![format!("machine.precision={precision}")];
        "instruction-set" [], |set| vec![format!("machine.instruction_set={set}")];
    },
    overrides: &["integrator.dt=0.001"],
    quantities: QUANTITIES,
    compared: &["temperature"],
    at_end: &["pressure"],
}];
