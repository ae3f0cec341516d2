//! The ladder of clocks: tables, figures and what came out.

use crate::method::lattice_md::Phase;
use crate::method::lattice_md::study::host_ladder::HostLadder;
use crate::method::lattice_md::study::ladder::Ladder;
use crate::report::{Cell, Section, Table, Verdict};

/// What came out, for several machines.
pub fn section(ladders: &[Ladder]) -> Section {
    let said = ladders.iter().map(|data| {
        let [.., first, last] = data.rungs.as_slice() else { return String::new() };
        let paper = data.rungs.iter().find(|rung| rung.clock == "paper").map_or(f64::NAN, |rung| rung.clocks);
        format!(
            "{}: {:.2} of the paper's clock chained, {:.2} with memory ports ({:.0} % of that depends on assumed start-ups)",
            data.machine,
            first.clocks / paper,
            last.clocks / paper,
            100.0 * data.assumed_share
        )
    });
    Section {
        name: "ladder".into(),
        title: "What each refinement of the clock adds".into(),
        says: "BP93 charges n + D for every operation and no chaining.".into(),
        came_out: format!("{}.", said.collect::<Vec<_>>().join("; ")),
        verdict: Verdict::Shown,
        again: "stripmine table --ladder --machine cray-y-mp-el".into(),
        figures: vec![],
        tables: ladders.iter().enumerate().map(|(at, data)| numbered(at, rungs(data))).collect(),
        excerpt: None,
        film: None,
        seeds: vec![],
        depends_on_host: false,
        provenance: None,
    }
}

fn numbered(at: usize, table: Table) -> Table {
    Table { name: format!("{}_{}", table.name, at + 1), ..table }
}

/// The tables of one machine.
pub fn tables(data: &Ladder) -> Vec<Table> {
    vec![rungs(data), convoys(data)]
}

fn rungs(data: &Ladder) -> Table {
    let mut columns = vec!["clock".to_owned()];
    columns.extend(data.parts.iter().map(|&part| part.to_owned()));
    columns.extend([
        "step".to_owned(),
        "of the rung before".to_owned(),
        "a disc".to_owned(),
        "ms".to_owned(),
    ]);
    let rows = data.rungs.iter().map(|rung| {
        let mut cells = vec![rung.clock.into()];
        cells.extend(rung.parts.iter().map(|&clocks| Cell::Number(clocks, 0)));
        cells.extend([
            Cell::Number(rung.clocks, 0),
            rung.relative.map_or(Cell::Nothing, |relative| Cell::Number(relative, 3)),
            Cell::Number(rung.clocks / data.particles as f64, 0),
            Cell::Number(1e3 * rung.seconds, 3),
        ]);
        cells
    });
    let mut notes: Vec<String> =
        data.rungs.iter().map(|rung| format!("{}: {}", rung.clock, rung.meaning)).collect();
    notes.push(format!(
        "NP = {} discs on LMAX = {} cells; {} ns a clock period. Of the last rung {:.1} % depend on assumed start-ups.",
        data.particles,
        data.cells,
        data.clock_period_ns,
        100.0 * data.assumed_share
    ));
    if !data.assumed.is_empty() {
        notes.push(format!("Assumed numbers of this machine: {}.", data.assumed.join(", ")));
    }
    Table {
        name: "ladder".into(),
        title: format!("Clock periods of one step by every clock: {}", data.machine),
        columns,
        rows: rows.collect(),
        notes,
    }
}

fn convoys(data: &Ladder) -> Table {
    let rows = data.convoys.iter().map(|row| {
        let count = |number: usize| Cell::Count(number as u64);
        vec![row.part.into(), count(row.instructions), count(row.chained), count(row.with_ports)]
    });
    Table {
        name: "convoys".into(),
        title: "Convoys: instructions that run at once".into(),
        columns: ["part", "instructions", "convoys, memory never busy", "convoys with memory ports"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
        notes: vec![
            "Instructions include the steps of operations that the machine has to put together. Nothing is said where the \
             machine's file names no functional units: then every instruction runs alone."
                .to_owned(),
        ],
    }
}

/// The table of a host.
pub fn of_host(data: &HostLadder) -> Table {
    let mut columns = vec!["model".to_owned()];
    columns.extend(Phase::ALL.iter().map(|phase| format!("{} (µs)", phase.name())));
    columns.extend(["step (µs)".to_owned(), "a disc (ns)".to_owned()]);
    let rows = data.rungs.iter().map(|rung| {
        let mut cells = vec![rung.name.into()];
        cells.extend(rung.phases.iter().map(|ns| Cell::Number(1e-3 * ns, 2)));
        cells.extend([Cell::Number(1e-3 * rung.ns, 2), Cell::Number(rung.ns / data.particles as f64, 1)]);
        cells
    });
    let mut notes: Vec<String> =
        data.rungs.iter().map(|rung| format!("{}: {}", rung.name, rung.meaning)).collect();
    notes.push(format!(
        "NP = {} discs on LMAX = {} cells, double precision, one thread.",
        data.particles, data.cells
    ));
    Table {
        name: "host_ladder".into(),
        title: format!("One step as the host model predicts it: {}", data.host),
        columns,
        rows: rows.collect(),
        notes,
    }
}
