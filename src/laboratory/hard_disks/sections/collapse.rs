//! Inelastic collapse over restitution and number of discs.

use crate::laboratory::hard_disks::study::collapse::{Collapses, PACKING, Row, of_a_row};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};

/// The estimate for more than three discs holds where it is off by no more than this.
const ESTIMATED: f64 = 0.02;

/// What came out.
pub fn section(data: &Collapses) -> Section {
    let off = |row: &Row| (0.5 * (row.edge[0] + row.edge[1]) - row.theory).abs();
    let three = data.rows.iter().find(|row| row.discs == 3);
    let worst = data.rows.iter().max_by(|a, b| off(a).total_cmp(&off(b)));
    let rises = data.rows.windows(2).all(|pair| pair[0].edge[0] < pair[1].edge[0]);
    let largest = data.gases.last();
    let edge = |share: f64| {
        let collapses = largest.map(|it| it.collapsed.iter().zip(&data.restitutions));
        collapses.into_iter().flatten().filter(|(got, _)| **got >= share).map(|(_, e)| *e).fold(0.0, f64::max)
    };
    Section::new(
        "hard-disks-collapse",
        "Hard discs: where the method fails, inelastic collapse"
    )
    .asks("At which restitution do collisions become infinitely many in a finite time?")
    .expects("Three discs in a row collapse where e < 7 − 4√3 = 0.0718; the more discs, the nearer to 1 (McNamara and Young 1992, Bernu and \
              Mazighi 1990).")
    .answers(data.rows.first().zip(worst).map_or(String::new(), |(first, worst)| {
        format!(
            "{} discs in a row collapse up to e = {:.3}, where the estimate tan²(π/4 (1 − 2/N)) has {:.3}, the farthest off of {} rows; {} discs \
             up to {:.4}, where it is exact with {:.4}.",
            worst.discs,
            worst.edge[0],
            worst.theory,
            data.rows.len(),
            first.discs,
            first.edge[0],
            first.theory,
        )
    }))
    .verdict(Verdict::of_claims(&[
        three.is_some_and(|row| off(row) < 2e-3),
        rises,
        worst.is_some_and(|row| off(row) < ESTIMATED),
    ]))
    .details([format!(
        "In the plane at ν = {PACKING}, {} discs collapse within {:.0} collisions of a disc up to e = {:.1}; no run hangs.",
        largest.map_or(0, |it| it.discs),
        data.collisions,
        edge(0.5)
    )])
    .figures([rows(data), plane(data)])
    .tables([row_table(data), plane_table(data)])
    .seeds(1..=data.seeds)
}

fn rows(data: &Collapses) -> Figure {
    let most = data.rows.last().map_or(3, |row| row.discs);
    let theory = (30..=10 * most).step_by(5).map(|tenths| f64::from(tenths) / 10.0);
    let measured = data.rows.iter().map(|row| {
        let [low, high] = row.edge;
        (f64::from(row.discs), 0.5 * (low + high), row.edge)
    });
    Chart::of(Axis::logarithmic("discs in the row", None), Axis::linear("restitution", None))
        .series("theory", Style::Line, 6, theory.map(|discs| (discs, of_a_row(discs))))
        .series("measured", Style::Points, 0, measured)
        .figure("rows", "Discs in a row collapse below this restitution")
        .caption("The largest restitution at which one of 24 starts collapses. The line is tan²(π/4 (1 − 2/N)): exact for three, an estimate for \
                  more.")
}

/// Which share of the seeds collapses, as kinds of points.
fn plane(data: &Collapses) -> Figure {
    type Kind = (&'static str, usize, fn(f64) -> bool);
    let kinds: [Kind; 3] = [
        ("every seed collapses", 1, |share| share >= 1.0),
        ("some do", 3, |share| share > 0.0 && share < 1.0),
        ("none does", 2, |share| share <= 0.0),
    ];
    let places = || {
        data.gases.iter().flat_map(|gases| {
            let shares = gases.collapsed.iter().zip(&data.restitutions);
            shares.map(|(&share, &restitution)| (share, (gases.discs as f64, restitution)))
        })
    };
    let kinds = kinds.into_iter().map(|(name, hue, is_it)| {
        let of_kind = places().filter(|(share, _)| is_it(*share)).map(|(_, place)| place);
        Series::new(name, Style::Points, hue, of_kind)
    });
    let theory = data.gases.iter().map(|gases| (gases.discs as f64, gases.theory));
    Chart::of(Axis::logarithmic("discs", None), Axis::linear("restitution", None))
        .with(kinds)
        .series("a row of N d/L discs", Style::Line, 6, theory)
        .figure("plane", "Gases in the plane: the more discs, the less dissipation they bear")
        .caption(format!(
            "ν = {PACKING}, {} seeds each, {:.0} collisions of a disc. The line is the criterion of a row of as many discs as lie across the \
             box; it holds in one dimension only.",
            data.seeds, data.collisions
        ))
}

fn row_table(data: &Collapses) -> Table {
    Rows::of(&data.rows)
        .count("discs in the row", |row| row.discs)
        .number("collapses at", 4, |row| row.edge[0])
        .number("does not at", 4, |row| row.edge[1])
        .number("theory", 4, |row| row.theory)
        .table("rows", "Discs in a row")
}

fn plane_table(data: &Collapses) -> Table {
    let shares = data.restitutions.iter().map(|restitution| format!("e = {restitution}"));
    Rows::of(&data.gases)
        .count("discs", |gases| gases.discs)
        .number("N d/L", 1, |gases| gases.across)
        .number("theory of a row", 3, |gases| gases.theory)
        .cells(shares, |gases| gases.collapsed.iter().map(|&share| Cell::Number(share, 2)))
        .table("plane", "Share of the seeds that collapse")
}
