//! The misprints of the contact law as a reader wants them.

use crate::laboratory::lattice_md::study::misprints::{CoulombRatio, Energy, Finding, Misprints, Right};
use crate::report::figure::{Axis, Chart, Figure, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};

/// What came out.
pub fn section(data: &Misprints) -> Section {
    Section::new("misprints", "What the misprints of the contact law do")
        .asks("Which equations of the contact law cannot be right as printed?")
        .expects(expected(data))
        .answers(answer(data))
        .verdict(verdict(data))
        .details([details(data)])
        .figures([energies(data), ratios(data)])
        .tables([table(data)])
        .seeds([data.seed])
}

/// Reproduced where every misprint is seen to fail and ours holds.
fn verdict(data: &Misprints) -> Verdict {
    let failing = data.findings.iter().filter(|finding| tells(finding)).count();
    match failing {
        0 => Verdict::NotReproduced,
        all if all == data.findings.len() => Verdict::Reproduced,
        _ => Verdict::Partly,
    }
}

/// Whether the quantity tells the printed form from ours.
fn tells(finding: &Finding) -> bool {
    finding.printed_fails() && finding.ours_holds()
}

fn expected(data: &Misprints) -> String {
    let mut forms: Vec<String> =
        data.findings.iter().map(|finding| format!("{} `{}`", finding.equation, finding.printed)).collect();
    forms.dedup();
    format!(
        "BP93 prints: {}. Conservation of energy and angular momentum says what is right.",
        forms.join("; ")
    )
}

fn answer(data: &Misprints) -> String {
    let failing = data.findings.iter().filter(|finding| tells(finding)).count();
    format!("In {failing} of {} comparisons the printed form fails where ours holds.", data.findings.len())
}

fn details(data: &Misprints) -> String {
    let values: Vec<String> = data
        .findings
        .iter()
        .map(|finding| {
            format!(
                "{} {} {} as printed, {} with ours (right: {})",
                finding.equation,
                finding.quantity,
                number(finding.by_printed).for_reading(),
                number(finding.by_ours).for_reading(),
                right(finding.right)
            )
        })
        .collect();
    let kept = match (data.head_on.first(), data.head_on.last()) {
        (Some(first), Some(last)) => format!(
            " Without damping the head-on collision begins with energy {:.6} and ends with {:.6}.",
            first.undamped, last.undamped
        ),
        _ => String::new(),
    };
    format!("{}.{kept}", values.join("; "))
}

fn number(value: f64) -> Cell {
    Cell::Number(value, 3)
}

fn right(right: Right) -> String {
    match right {
        Right::Equal(value) => number(value).for_reading(),
        Right::AtMost(value) => format!("≤ {}", number(value).for_reading()),
    }
}

fn table(data: &Misprints) -> Table {
    Rows::of(&data.findings)
        .text("equation", |finding| finding.equation)
        .text("as printed", |finding| finding.printed)
        .text("as it runs", |finding| finding.ours)
        .text("what shows it", |finding| finding.quantity)
        .text("with", |finding| &finding.setting)
        .text("right is", |finding| match finding.right {
            Right::Equal(_) => "equal to",
            Right::AtMost(_) => "at most",
        })
        .cell("right", |finding| match finding.right {
            Right::Equal(value) | Right::AtMost(value) => number(value),
        })
        .cell("printed gives", |finding| number(finding.by_printed))
        .cell("ours gives", |finding| number(finding.by_ours))
        .table("misprints", "Equations that do not work as printed")
        .note("Where a vector is printed beside a scalar, its component along n (14) or s (16) is taken: else there is nothing to compute. n \
               points from disc j to disc i, s = (−n_y, n_x), ξ is the depth of the contact, Ω an angular velocity.")
        .note("Units: radius and mass of the discs, those of random pairs being about so; and a time in which the law's parameters have the \
               values given.")
}

fn energies(data: &Misprints) -> Figure {
    let curve = |energy: fn(&Energy) -> f64| data.head_on.iter().map(move |at| (at.time, energy(at)));
    Chart::of(Axis::linear("time", Some("reduced")), Axis::linear("energy", Some("reduced")))
        .series("(14) as printed", Style::Dashed, 1, curve(|at| at.printed))
        .series("ours, undamped", Style::Line, 2, curve(|at| at.undamped))
        .series("ours", Style::Line, 0, curve(|at| at.ours))
        .figure("head_on_energy", "Energy through a frictionless head-on collision")
        .caption("Kinetic and elastic energy of two discs of radius and mass 1. With the sign of (14) as printed the damping feeds energy in.")
}

fn ratios(data: &Misprints) -> Figure {
    let curve = |ratio: fn(&CoulombRatio) -> f64| data.sliding.iter().map(move |at| (at.slip, ratio(at)));
    Chart::of(
        Axis::linear("slip velocity", Some("reduced")),
        Axis::linear("shear force over its bound μ|F|", None),
    )
    .series("ours", Style::Line, 0, curve(|at| at.ours))
    .series("(15) as printed", Style::Dashed, 1, curve(|at| at.printed))
    .figure("coulomb_ratio", "Shear force over its Coulomb bound, by slip velocity")
    .caption("Two discs in contact, one sliding past the other. (15) as printed has a bound for one direction only; for the other the two curves \
              are one.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::lattice_md::study::misprints::misprints;
    use crate::report::figure::Picture;

    #[test]
    fn the_verdict_follows_from_the_values() {
        let mut data = misprints();
        assert_eq!(verdict(&data), Verdict::Reproduced);
        let (printed, ours) = (data.findings[0].by_printed, data.findings[0].by_ours);
        data.findings[0].by_printed = ours;
        assert_eq!(verdict(&data), Verdict::Partly);
        data.findings[0].by_printed = printed;
        data.findings[0].by_ours = printed;
        assert_eq!(verdict(&data), Verdict::Partly);
        data.findings.iter_mut().for_each(|finding| finding.by_ours = f64::NAN);
        assert_eq!(verdict(&data), Verdict::NotReproduced);
    }

    #[test]
    fn the_words_say_each_equation_once_and_each_value() {
        let mut data = misprints();
        data.findings[1].by_printed = 12.25;
        let section = section(&data);
        let details = section.details.concat();
        for finding in &data.findings {
            assert_eq!(section.expected.matches(finding.printed).count(), 1, "{}", section.expected);
            assert!(details.contains(finding.quantity), "{details}");
        }
        assert!(details.contains("12.250 as printed"), "{details}");
        let table = &section.tables[0];
        assert!(table.rows.iter().all(|row| row.len() == table.columns.len()));
        assert_eq!(table.rows[1][7], Cell::Number(12.25, 3));
    }

    #[test]
    fn every_point_of_the_curves_is_drawn() {
        let data = misprints();
        let section = section(&data);
        let lengths: Vec<Vec<usize>> = section
            .figures
            .iter()
            .map(|figure| match &figure.picture {
                Picture::Chart(chart) => chart.series.iter().map(|series| series.points.len()).collect(),
                _ => vec![],
            })
            .collect();
        assert_eq!(lengths, [vec![data.head_on.len(); 3], vec![data.sliding.len(); 2]]);
    }
}
