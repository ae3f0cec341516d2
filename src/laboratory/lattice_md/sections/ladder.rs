//! The ladder of a host: its table.

use crate::laboratory::lattice_md::study::host_ladder::HostLadder;
use crate::report::{Rows, Table};
use stripmine_physics::method::lattice_md::Phase;

/// The table of a host.
pub fn of_host(data: &HostLadder) -> Table {
    let mut rows = Rows::of(&data.rungs).text("model", |rung| rung.name);
    for (place, phase) in Phase::ALL.iter().enumerate() {
        rows = rows.number(format!("{} (µs)", phase.name()), 2, |rung| 1e-3 * rung.phases[place]);
    }
    rows.number("step (µs)", 2, |rung| 1e-3 * rung.ns)
        .number("a disc (ns)", 1, |rung| rung.ns / data.particles as f64)
        .table("host_ladder", format!("One step by {}", data.model))
        .notes(data.rungs.iter().map(|rung| format!("{}: {}", rung.name, rung.meaning)))
        .note(format!(
            "NP = {} discs on LMAX = {} cells, double precision, one thread.",
            data.particles, data.cells
        ))
}
