//! A host model, as tables.

use crate::model::host::{Amounts, HostModel, Measured};
use crate::report::{Cell, Table};
use std::collections::BTreeMap;
use stripmine_kernels::isa::OpClass;

/// The tables of a host model.
pub fn tables(model: &HostModel) -> Vec<Table> {
    vec![operations(model), levels(model), rates(model)]
}

fn table(name: &str, title: String, columns: &[&str], rows: Vec<Vec<Cell>>, notes: Vec<String>) -> Table {
    let columns = columns.iter().map(|&word| word.to_owned()).collect();
    Table { name: name.into(), title, columns, rows, notes }
}

fn named(names: &[&str], numbers: impl IntoIterator<Item = (f64, usize)>) -> Vec<Cell> {
    let names = names.iter().map(|&name| name.into());
    names.chain(numbers.into_iter().map(|(number, decimals)| Cell::Number(number, decimals))).collect()
}

fn operations(model: &HostModel) -> Table {
    let rows = model.lanes.iter().flat_map(|(lane, costs)| {
        OpClass::ALL.iter().filter_map(move |class| {
            let of = |classes: &BTreeMap<String, f64>| classes.get(class.name()).copied();
            let both = [of(&costs.interpreted), of(&costs.chained)];
            let cell = |ns: Option<f64>| ns.map_or(Cell::Nothing, |ns| Cell::Number(ns, 4));
            let names = [lane.as_str(), class.name()].map(Cell::from);
            both.iter().any(Option::is_some).then(|| names.into_iter().chain(both.map(cell)).collect())
        })
    });
    let Measured { state, seconds, spread, disagreement, shortest, longest, residuals } = &model.measured;
    let starts = model.lanes.iter().map(|(lane, costs)| format!("{:.1} ns on {lane} lanes", costs.start));
    let notes = vec![
        format!(
            "Vectors of {shortest} to {longest} elements. Measured in {seconds:.0} s on a machine that was {state}: half of the samples \
             lie within {:.1} % of the middle, the two halves of the measurement differ by {:.1} %.",
            100.0 * spread,
            100.0 * disagreement
        ),
        format!(
            "Fitted, with the levels, to the programs of the lattice method, which deviate by {:.0} % (the median; compiled loops by \
             {:.0} %). `add` is any operation, what the others take is in addition to it. A run takes {:.0} ns in addition (a compiled \
             loop {:.0} ns), a pass {} to begin.",
            100.0 * residuals[0],
            100.0 * residuals[1],
            model.run[0],
            model.run[1],
            starts.collect::<Vec<_>>().join(", "),
        ),
    ];
    let columns = ["lanes", "class", "interpreted (ns an element)", "chained (ns an element)"];
    let title = format!("Operations of {}, {}", model.title, model.instruction_set);
    table("operations", title, &columns, rows.collect(), notes)
}

fn levels(model: &HostModel) -> Table {
    let row = |level: &crate::model::host::Level| {
        named(&[], [(level.footprint / 1024.0, 0), (level.interpreted, 5), (level.chained, 5)])
    };
    let columns = ["footprint (KiB)", "ns a byte, interpreted", "ns a byte, chained"];
    let notes = vec!["Between two footprints a byte takes what is in between, by the logarithm.".to_owned()];
    let rows = model.levels.iter().map(row).collect();
    table("levels", "Levels of memory".into(), &columns, rows, notes)
}

fn rates(model: &HostModel) -> Table {
    let (mut rows, mut notes) = (vec![], vec![]);
    for (method, rates) in &model.rates {
        for (phase, rate) in &rates.phases {
            let slower = rates.discs.iter().zip(&rate.slower);
            let slower: Vec<String> =
                slower.map(|(discs, slower)| format!("{slower:.2} at {discs}")).collect();
            notes.push(format!("{method}, {phase}: times {}.", slower.join(", ")));
            let row = |(precision, ns): (&String, &[f64; Amounts::NAMES.len()])| {
                named(&[method, precision, phase], ns.map(|ns| (ns, 2)))
            };
            rows.extend(rate.ns.iter().map(row));
        }
    }
    let units = Amounts::NAMES.map(|name| format!("ns a {name}"));
    let columns = ["method", "precision", "phase"].into_iter().chain(units.iter().map(String::as_str));
    let title = "Work whose amount depends on the data".to_owned();
    table("rates", title, &columns.collect::<Vec<_>>(), rows, notes)
}
