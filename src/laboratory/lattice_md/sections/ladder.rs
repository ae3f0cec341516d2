//! The ladder of clocks: tables, figures and what came out.

use crate::laboratory::lattice_md::study::host_ladder::HostLadder;
use crate::laboratory::lattice_md::study::ladder::Ladder;
use crate::report::{Cell, Part, Section, Table};
use stripmine_physics::method::lattice_md::Phase;
use stripmine_physics::number::significant;

/// Clock periods of the last two clocks, chained and with memory ports, over those of the source's.
fn of_paper(data: &Ladder) -> [f64; 2] {
    let [.., chained, ports] = data.rungs.as_slice() else { return [f64::NAN; 2] };
    let paper = data.rungs.iter().find(|rung| rung.clock == "paper").map_or(f64::NAN, |rung| rung.clocks);
    [chained.clocks / paper, ports.clocks / paper]
}

/// What came out, for several machines.
pub fn section(ladders: &[Ladder]) -> Section {
    let said = ladders.iter().map(|data| {
        format!(
            "{} {:.2} of the source's, {:.0} % of which depends on start-up times that we had to assume",
            data.machine,
            of_paper(data)[1],
            100.0 * data.assumed_share
        )
    });
    let chained = ladders.first().map(|first| {
        let others = ladders[1..].iter().map(|data| format!("{:.2} on {}", of_paper(data)[0], data.machine));
        format!(
            "With chaining a step on a {} takes {:.2} of the time by the source's clock ({}).",
            first.machine,
            of_paper(first)[0],
            others.collect::<Vec<_>>().join(", ")
        )
    });
    Section::new("ladder", "What each refinement of the clock adds", Part::Machine)
        .asks("How many clock periods does a step take by finer clocks than the source's?")
        .expects("BP93 charges n + D for every operation and no chaining.")
        .answers(chained.unwrap_or_default())
        .details([format!("With memory ports as well: {}.", said.collect::<Vec<_>>().join("; "))])
        .tables(ladders.iter().enumerate().map(|(at, data)| numbered(at, rungs(data))))
        .again("stripmine table --ladder --machine cray-y-mp-el")
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
        significant(data.clock_period_ns, 4),
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
            "Instructions include the steps of operations that the machine has to put together. Nothing is said where the machine's file names \
             no functional units: then every instruction runs alone.".to_owned(),
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
        title: format!("One step by {}", data.model),
        columns,
        rows: rows.collect(),
        notes,
    }
}
