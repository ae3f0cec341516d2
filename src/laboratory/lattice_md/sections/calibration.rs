//! A host model, as tables.

use crate::model::host::{Amounts, Estimate, HostModel, Measured};
use crate::report::{Rows, Table};

/// The tables of a host model.
pub fn tables(model: &HostModel) -> Vec<Table> {
    vec![operations(model), loops(model), levels(model), rates(model)]
}

/// What takes less (ns an element) takes nothing that was measured.
const LEAST: f64 = 1e-3;

fn operations(model: &HostModel) -> Table {
    let passes = model.lanes.iter().flat_map(|(lane, costs)| {
        costs.passes.iter().map(move |(operation, cost)| (lane, operation, cost.element, cost.start))
    });
    let rate = |element: &Estimate, value| if element.value < LEAST { None } else { Some(value) };
    let Measured { state, seconds, timer, spread, low, disagreement, shortest, longest, .. } =
        &model.measured;
    let changes = model.lanes.iter().map(|(lane, costs)| {
        let each =
            costs.change.iter().map(|change| format!("{:.1} ns in {} passes", change.ns, change.passes));
        format!("{lane}: {}", each.collect::<Vec<_>>().join(", "))
    });
    // With Hockney's pair: the rate of endless vectors, and the length at which half of it is reached.
    Rows::of(passes)
        .text("lanes", |(lane, ..)| *lane)
        .text("operation", |(_, operation, ..)| *operation)
        .number("tau (ns)", 4, |(.., element, _)| element.value)
        .number("± 95 %", 4, |(.., element, _)| element.interval)
        .number("t0 (ns)", 1, |(.., start)| start.value)
        .number("± 95 %", 1, |(.., start)| start.interval)
        .number("r_inf (million/s)", 0, |(.., element, _)| rate(element, 1e3 / element.value))
        .number("n_half", 0, |(.., element, start)| rate(element, start.value / element.value))
        .table("operations", format!("Operations of {}, {}", model.title, model.instruction_set))
        .note(format!(
            "Passes over vectors in the first-level cache: t = t0 + n tau. Vectors of {shortest} to {longest} elements; timer steps of {timer} \
             ns. Measured in {seconds:.0} s on a machine that was {state}: what counts is the middle of the samples. Half of them lie within \
             {:.1} % of it, their lowest tenth {:.1} % below; the two halves of the measurement differ by {:.1} %.",
            100.0 * spread,
            100.0 * low,
            100.0 * disagreement
        ))
        .note(format!(
            "A pass before one of another kind takes longer. {}.",
            changes.collect::<Vec<_>>().join("; ")
        ))
}

fn loops(model: &HostModel) -> Table {
    let classes = model.loops.classes.iter();
    Rows::of(classes.flat_map(|(lane, classes)| classes.iter().map(move |(class, ns)| (lane, class, *ns))))
        .text("lanes", |(lane, ..)| *lane)
        .text("operations of the class", |(_, class, _)| *class)
        .number("ns an element", 4, |(.., ns)| *ns)
        .table("loops", "Compiled loops, by classes of operations")
        .note(format!(
            "Fitted to the programs of the lattice method, which deviate from it by {:.0} % (the median). A run takes {:.1} ns in addition, an \
             element beyond whole registers {:.1} times as long. Of the shorter of computing and waiting for streams {:.0} % hide behind the \
             longer. In the interpreter a pass among others takes {:.2} times as long to begin as in a drill of nothing but itself.",
            100.0 * model.loops.residual,
            model.loops.start.value,
            model.loops.left.value,
            100.0 * model.loops.overlap,
            model.begin,
        ))
}

fn rates(model: &HostModel) -> Table {
    let phases = model.rates.iter().flat_map(|(method, rates)| {
        rates.phases.iter().map(move |(phase, rate)| (method, phase, rate, &rates.discs))
    });
    let notes = phases.clone().map(|(method, phase, rate, discs)| {
        let slower = discs.iter().zip(&rate.slower);
        let slower: Vec<String> = slower.map(|(discs, slower)| format!("{slower:.2} at {discs}")).collect();
        format!("{method}, {phase}: times {}.", slower.join(", "))
    });
    let rows = phases.flat_map(|(method, phase, rate, _)| {
        rate.ns.iter().map(move |(precision, units)| (method, precision, phase, units))
    });
    let mut rows = Rows::of(rows)
        .text("method", |(method, ..)| *method)
        .text("precision", |(_, precision, ..)| *precision)
        .text("phase", |(_, _, phase, _)| *phase);
    for name in Amounts::NAMES {
        rows = rows.number(format!("ns a {name}"), 2, |(.., units)| units.get(name).copied());
    }
    rows.table("rates", "Work whose amount depends on the data").notes(notes)
}

fn levels(model: &HostModel) -> Table {
    let transfers = model.levels.iter().flat_map(|level| {
        [("passes", &level.passes), ("chained loops", &level.loops)]
            .map(|(what, transfer)| (level, what, transfer))
    });
    Rows::of(transfers)
        .text("level", |(level, ..)| &level.name)
        .number("up to a reuse distance of (KiB)", 0, |(level, ..)| {
            level.capacity.map(|bytes| bytes / 1024.0)
        })
        .text("for", |(_, what, _)| *what)
        .number("ns a byte fetched", 5, |(.., it)| it.fetch)
        .number("ns a byte of an array fetched", 5, |(.., it)| it.fetch_array)
        .number("ns a byte written back", 5, |(.., it)| it.write_back)
        .number("ns the first of an array", 2, |(.., it)| it.first)
        .number("ns a line through an index", 2, |(.., it)| it.line)
        .table("levels", "Levels of memory")
        .note(format!(
            "A pass whose operands come from beyond the nearest level waits {:.3} ns an element in addition. The passes and programs that this \
             was fitted to deviate by {:.0} % (the median).",
            model.operand,
            100.0 * model.measured.residual
        ))
}
