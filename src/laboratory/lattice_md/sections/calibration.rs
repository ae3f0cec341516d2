//! A host model, as tables.

use crate::model::host::{Amounts, HostModel, Measured};
use crate::report::{Cell, Rows, Table};
use std::collections::BTreeMap;
use stripmine_kernels::isa::OpClass;

/// The tables of a host model.
pub fn tables(model: &HostModel) -> Vec<Table> {
    vec![operations(model), levels(model), rates(model)]
}

fn operations(model: &HostModel) -> Table {
    let measured = model.lanes.iter().flat_map(|(lane, costs)| {
        OpClass::ALL.iter().filter_map(move |class| {
            let of = |classes: &BTreeMap<String, f64>| classes.get(class.name()).copied();
            let both = [of(&costs.interpreted), of(&costs.chained)];
            both.iter().any(Option::is_some).then_some((lane, class, both))
        })
    });
    let Measured { state, seconds, spread, disagreement, shortest, longest, residuals, .. } = &model.measured;
    let share = |value: &Option<f64>| value.map(|value| format!("{:.1} %", 100.0 * value));
    let scatter = match (share(spread), share(disagreement)) {
        (Some(spread), Some(apart)) => {
            format!(
                ": half of the samples lie within {spread} of the middle, the two halves of the measurement differ by {apart}"
            )
        }
        _ => String::new(),
    };
    let starts = model.lanes.iter().map(|(lane, costs)| format!("{:.1} ns on {lane} lanes", costs.start));
    Rows::of(measured)
        .text("lanes", |(lane, ..)| *lane)
        .text("class", |(_, class, _)| class.name())
        .number("interpreted (ns an element)", 4, |(.., [interpreted, _])| *interpreted)
        .number("chained (ns an element)", 4, |(.., [_, chained])| *chained)
        .table("operations", format!("Operations of {}, {}", model.title, model.instruction_set))
        .note(format!(
            "Vectors of {shortest} to {longest} elements. Measured in {seconds:.0} s on a machine that was {state}{scatter}."
        ))
        .note(format!(
            "Fitted, with the levels, to the programs of the lattice method, which deviate by {:.0} % (the median; compiled loops by \
             {:.0} %). `add` is any operation, what the others take is in addition to it. A run takes {:.0} ns in addition (a compiled \
             loop {:.0} ns), a pass {} to begin.",
            100.0 * residuals[0],
            100.0 * residuals[1],
            model.run[0],
            model.run[1],
            starts.collect::<Vec<_>>().join(", "),
        ))
}

fn levels(model: &HostModel) -> Table {
    Rows::of(&model.levels)
        .number("footprint (KiB)", 0, |level| level.footprint / 1024.0)
        .number("ns a byte, interpreted", 5, |level| level.interpreted)
        .number("ns a byte, chained", 5, |level| level.chained)
        .table("levels", "Levels of memory")
        .note("Between two footprints a byte takes what is in between, by the logarithm.")
}

fn rates(model: &HostModel) -> Table {
    let phases = || {
        model.rates.iter().flat_map(|(method, of)| of.phases.iter().map(move |it| (method, &of.discs, it)))
    };
    let slower = phases().map(|(method, discs, (phase, rate))| {
        let slower = discs.iter().zip(&rate.slower).map(|(discs, slower)| format!("{slower:.2} at {discs}"));
        format!("{method}, {phase}: times {}.", slower.collect::<Vec<_>>().join(", "))
    });
    let rows = phases().flat_map(|(method, _, (phase, rate))| {
        rate.ns.iter().map(move |(precision, ns)| (method, precision, phase, ns))
    });
    Rows::of(rows)
        .text("method", |(method, ..)| *method)
        .text("precision", |(_, precision, ..)| *precision)
        .text("phase", |(_, _, phase, _)| *phase)
        .cells(Amounts::NAMES.map(|name| format!("ns a {name}")), |(.., ns)| ns.map(|ns| Cell::Number(ns, 2)))
        .table("rates", "Work whose amount depends on the data")
        .notes(slower)
}
