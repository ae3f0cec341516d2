//! A host model, as tables.

use crate::model::host::{Amounts, HostModel, Measured};
use crate::report::{Cell, Table};

/// The tables of a host model.
pub fn tables(model: &HostModel) -> Vec<Table> {
    vec![operations(model), loops(model), levels(model), rates(model)]
}

fn table(name: &str, title: String, columns: &[&str], rows: Vec<Vec<Cell>>, notes: Vec<String>) -> Table {
    let columns = columns.iter().map(|&word| word.to_owned()).collect();
    Table { name: name.into(), title, columns, rows, notes }
}

fn named(names: &[&str], numbers: impl IntoIterator<Item = (f64, usize)>) -> Vec<Cell> {
    let names = names.iter().map(|&name| name.into());
    names.chain(numbers.into_iter().map(|(number, decimals)| Cell::Number(number, decimals))).collect()
}

/// Operations of the interpreter, with Hockney's pair.
fn operations(model: &HostModel) -> Table {
    let of = |(lane, op, [element, start]): (&str, &str, [f64; 2])| {
        let least = element.max(1e-4);
        named(&[lane, op], [(element, 4), (start, 1), (1e3 / least, 0), (start / least, 0)])
    };
    let all = model.lanes.iter().flat_map(|(lane, costs)| {
        costs.passes.iter().map(move |(op, cost)| (lane.as_str(), op.as_str(), *cost))
    });
    let Measured { state, seconds, spread, disagreement, shortest, longest, .. } = &model.measured;
    let notes = vec![format!(
        "Passes over vectors in the first-level cache: t = t0 + n tau. Vectors of {shortest} to {longest} elements. Measured in \
         {seconds:.0} s on a machine that was {state}: half of the samples lie within {:.1} % of the middle, the two halves of the \
         measurement differ by {:.1} %.",
        100.0 * spread,
        100.0 * disagreement
    )];
    let columns = ["lanes", "operation", "tau (ns)", "t0 (ns)", "r_inf (million/s)", "n_half"];
    let title = format!("Operations of {}, {}", model.title, model.instruction_set);
    table("operations", title, &columns, all.map(of).collect(), notes)
}

fn loops(model: &HostModel) -> Table {
    let rows = model.lanes.iter().flat_map(|(lane, costs)| {
        costs.loops.iter().map(move |(class, &ns)| named(&[lane, class], [(ns, 4)]))
    });
    let [run, of_loop] = model.run;
    let [interpreted, chained] = model.measured.residuals;
    let notes = vec![format!(
        "Fitted, with the levels and starts, to the programs of the lattice method, which deviate from it by {:.0} % (the median; \
         interpreted by {:.0} %). A run takes {of_loop:.1} ns in addition (interpreted {run:.1} ns). In the interpreter a pass among \
         others takes {:.2} times as long to begin as in a drill of nothing but itself.",
        100.0 * chained,
        100.0 * interpreted,
        model.begin,
    )];
    let columns = ["lanes", "operations of the class", "ns an element"];
    table("loops", "Compiled loops, by classes of operations".into(), &columns, rows.collect(), notes)
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
