//! The ladder of clocks: tables, figures and what came out.

use crate::laboratory::lattice_md::study::host_ladder::HostLadder;
use crate::laboratory::lattice_md::study::ladder::Ladder;
use crate::report::{Rows, Section, Table, Verdict};
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
    Section::new("ladder", "What each refinement of the clock adds")
        .asks("How many clock periods does a step take by finer clocks than the source's?")
        .expects("BP93 charges n + D for every operation and no chaining.")
        .verdict(Verdict::Computed)
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
    let mut rows = Rows::of(&data.rungs).text("clock", |rung| rung.clock);
    for (place, part) in data.parts.iter().enumerate() {
        rows = rows.number(*part, 0, |rung| rung.parts[place]);
    }
    let assumed = (!data.assumed.is_empty())
        .then(|| format!("Assumed numbers of this machine: {}.", data.assumed.join(", ")));
    rows.number("step", 0, |rung| rung.clocks)
        .number("of the rung before", 3, |rung| rung.relative)
        .number("a disc", 0, |rung| rung.clocks / data.particles as f64)
        .number("ms", 3, |rung| 1e3 * rung.seconds)
        .table("ladder", format!("Clock periods of one step by every clock: {}", data.machine))
        .notes(data.rungs.iter().map(|rung| format!("{}: {}", rung.clock, rung.meaning)))
        .note(format!(
            "NP = {} discs on LMAX = {} cells; {} ns a clock period. Of the last rung {:.1} % depend on assumed start-ups.",
            data.particles,
            data.cells,
            significant(data.clock_period_ns, 4),
            100.0 * data.assumed_share
        ))
        .notes(assumed)
}

fn convoys(data: &Ladder) -> Table {
    Rows::of(&data.convoys)
        .text("part", |row| row.part)
        .count("instructions", |row| row.instructions)
        .count("convoys, memory never busy", |row| row.chained)
        .count("convoys with memory ports", |row| row.with_ports)
        .table("convoys", "Convoys: instructions that run at once")
        .note("Instructions include the steps of operations that the machine has to put together. Nothing is said where the machine's file names \
               no functional units: then every instruction runs alone.")
}

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
