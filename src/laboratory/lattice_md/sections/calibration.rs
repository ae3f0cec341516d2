//! A host model, as tables.

use crate::model::host::{Amounts, Estimate, HostModel, Measured, Transfer};
use crate::report::{Cell, Table};

/// The tables of a host model.
pub fn tables(model: &HostModel) -> Vec<Table> {
    vec![operations(model), loops(model), levels(model), rates(model)]
}

fn with(estimate: Estimate, decimals: usize) -> [Cell; 2] {
    [Cell::Number(estimate.value, decimals), Cell::Number(estimate.interval, decimals)]
}

fn headings(words: &[&str]) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).collect()
}

/// What takes less (ns an element) takes nothing that was measured.
const LEAST: f64 = 1e-3;

/// The row of something that starts and goes on, with Hockney's pair.
fn hockney(names: [&str; 2], element: Estimate, start: Estimate) -> Vec<Cell> {
    let mut row: Vec<Cell> = names.map(|name| Cell::Text(name.to_owned())).to_vec();
    row.extend(with(element, 4));
    row.extend(with(start, 1));
    let rate = |value: f64| if element.value < LEAST { Cell::Nothing } else { Cell::Number(value, 0) };
    row.push(rate(1e3 / element.value));
    row.push(rate(start.value / element.value));
    row
}

const TIMES: [&str; 6] = ["tau (ns)", "± 95 %", "t0 (ns)", "± 95 %", "r_inf (million/s)", "n_half"];

fn operations(model: &HostModel) -> Table {
    let rows = model.lanes.iter().flat_map(|(lane, costs)| {
        costs.passes.iter().map(move |(op, cost)| hockney([lane, op], cost.element, cost.start))
    });
    let Measured { state, seconds, timer, spread, low, disagreement, shortest, longest, .. } =
        &model.measured;
    let changes = model.lanes.iter().map(|(lane, costs)| {
        let each =
            costs.change.iter().map(|change| format!("{:.1} ns in {} passes", change.ns, change.passes));
        format!("{lane}: {}", each.collect::<Vec<_>>().join(", "))
    });
    Table {
        name: "operations".into(),
        title: format!("Operations of {}, {}", model.title, model.instruction_set),
        columns: headings(&[&["lanes", "operation"], TIMES.as_slice()].concat()),
        rows: rows.collect(),
        notes: vec![
            format!(
                "Passes over vectors in the first-level cache: t = t0 + n tau. Vectors of {shortest} to {longest} elements; timer steps \
                 of {timer} ns. Measured in {seconds:.0} s on a machine that was {state}: what counts is the middle of the samples. Half of \
                 them lie within {:.1} % of it, their lowest tenth {:.1} % below; the two halves of the measurement differ by {:.1} %.",
                100.0 * spread,
                100.0 * low,
                100.0 * disagreement
            ),
            format!(
                "A pass before one of another kind takes longer. {}.",
                changes.collect::<Vec<_>>().join("; ")
            ),
        ],
    }
}

fn loops(model: &HostModel) -> Table {
    let rows = model.loops.classes.iter().flat_map(|(lane, classes)| {
        classes.iter().map(move |(class, &ns)| {
            vec![Cell::Text(lane.clone()), Cell::Text(class.clone()), Cell::Number(ns, 4)]
        })
    });
    Table {
        name: "loops".into(),
        title: "Compiled loops, by classes of operations".into(),
        columns: headings(&["lanes", "operations of the class", "ns an element"]),
        rows: rows.collect(),
        notes: vec![format!(
            "Fitted to the programs of the lattice method, which deviate from it by {:.0} % (the median). A run takes {:.1} ns in addition, \
             an element beyond whole registers {:.1} times as long. Of the shorter of computing and waiting for streams {:.0} % hide behind \
             the longer. In the interpreter a pass among others takes {:.2} times as long to begin as in a drill of nothing but itself.",
            100.0 * model.loops.residual,
            model.loops.start.value,
            model.loops.left.value,
            100.0 * model.loops.overlap,
            model.begin,
        )],
    }
}

fn rates(model: &HostModel) -> Table {
    let mut rows = vec![];
    let mut notes = vec![];
    for (method, rates) in &model.rates {
        for (phase, rate) in &rates.phases {
            let slower = rates.discs.iter().zip(&rate.slower);
            let slower: Vec<String> =
                slower.map(|(discs, slower)| format!("{slower:.2} at {discs}")).collect();
            notes.push(format!("{method}, {phase}: times {}.", slower.join(", ")));
            for (precision, units) in &rate.ns {
                let mut row: Vec<Cell> =
                    [method, precision, phase].map(|name| Cell::Text(name.clone())).to_vec();
                let unit = |name: &&str| units.get(*name).map_or(Cell::Nothing, |&ns| Cell::Number(ns, 2));
                row.extend(Amounts::NAMES.iter().map(unit));
                rows.push(row);
            }
        }
    }
    let units = Amounts::NAMES.map(|name| format!("ns a {name}"));
    Table {
        name: "rates".into(),
        title: "Work whose amount depends on the data".into(),
        columns: headings(&["method", "precision", "phase"]).into_iter().chain(units).collect(),
        rows,
        notes,
    }
}

fn levels(model: &HostModel) -> Table {
    let rows = model.levels.iter().flat_map(|level| {
        [("passes", level.passes), ("chained loops", level.loops)].map(|(what, transfer)| {
            let Transfer { fetch, fetch_array, write_back, first, line } = transfer;
            vec![
                Cell::Text(level.name.clone()),
                level.capacity.map_or(Cell::Nothing, |bytes| Cell::Number(bytes / 1024.0, 0)),
                Cell::Text(what.to_owned()),
                Cell::Number(fetch, 5),
                Cell::Number(fetch_array, 5),
                Cell::Number(write_back, 5),
                Cell::Number(first, 2),
                Cell::Number(line, 2),
            ]
        })
    });
    Table {
        name: "levels".into(),
        title: "Levels of memory".into(),
        columns: headings(&[
            "level",
            "up to a reuse distance of (KiB)",
            "for",
            "ns a byte fetched",
            "ns a byte of an array fetched",
            "ns a byte written back",
            "ns the first of an array",
            "ns a line through an index",
        ]),
        rows: rows.collect(),
        notes: vec![format!(
            "A pass whose operands come from beyond the nearest level waits {:.3} ns an element in addition. The passes and \
             programs that this was fitted to deviate by {:.0} % (the median).",
            model.operand,
            100.0 * model.measured.residual
        )],
    }
}
