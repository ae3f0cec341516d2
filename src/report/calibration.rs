//! A host model as a reader wants it.

use super::{Cell, Table};
use crate::model::host::{Estimate, HostModel};

/// The tables of a host model.
pub fn tables(model: &HostModel) -> Vec<Table> {
    vec![operations(model), levels(model)]
}

fn operations(model: &HostModel) -> Table {
    let with = |estimate: Estimate, decimals: usize| {
        [Cell::Number(estimate.value, decimals), Cell::Number(estimate.interval, decimals)]
    };
    let mut rows = vec![];
    for (lane, costs) in &model.lanes {
        for (op, cost) in &costs.passes {
            let mut row = vec![Cell::Text(lane.clone()), Cell::Text(op.clone())];
            row.extend(with(cost.element, 4));
            row.extend(with(cost.start, 1));
            // Hockney's pair.
            row.push(Cell::Number(1e3 / cost.element.value.max(1e-6), 0));
            row.push(Cell::Number(cost.start.value / cost.element.value.max(1e-6), 0));
            row.extend(
                costs.chained.get(op).map_or(vec![Cell::Nothing; 2], |&chained| with(chained, 4).to_vec()),
            );
            rows.push(row);
        }
    }
    Table {
        name: "operations".into(),
        title: format!("Operations of {}, {}", model.title, model.instruction_set),
        columns: [
            "lanes",
            "operation",
            "tau (ns)",
            "± 95 %",
            "t0 (ns)",
            "± 95 %",
            "r_inf (million/s)",
            "n_half",
            "chained (ns)",
            "±",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        notes: vec![
            format!(
                "Passes over vectors in the first-level cache: t = t0 + n tau. Vectors of {} to {} elements; timer steps of {} \
                 ns; the median repeat was {:.1} % slower than the best.",
                model.measured.shortest,
                model.measured.longest,
                model.measured.timer,
                100.0 * model.measured.spread
            ),
            "Chained: what the operation adds to an element of compiled code; ± is the difference of two vector lengths."
                .to_owned(),
        ],
    }
}

fn levels(model: &HostModel) -> Table {
    let rows = model.levels.iter().map(|level| {
        vec![
            Cell::Text(level.name.clone()),
            level.capacity.map_or(Cell::Nothing, |bytes| Cell::Number(bytes / 1024.0, 0)),
            Cell::Number(level.byte, 5),
            Cell::Number(8.0 * level.byte, 3),
        ]
    });
    Table {
        name: "levels".into(),
        title: "Levels of memory".into(),
        columns: ["level", "up to a reuse distance of (KiB)", "ns a byte", "ns an operand of 8 bytes"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
        notes: vec![format!(
            "A pass bound by memory takes {:.3} ns an element and the sum over its operands. The fitted passes deviate by \
             {:.0} % on average.",
            model.operand,
            100.0 * model.measured.residual
        )],
    }
}
