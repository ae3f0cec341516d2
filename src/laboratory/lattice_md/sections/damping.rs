//! Waves over dissipation: tables, figures and what came out.

use crate::laboratory::lattice_md::study::damping::{Case, Damping};
use crate::report::figure::{Axis, Chart, Figure, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};
use crate::statistics::Spread;

/// The Fano factor above which there are waves.
const EVEN: f64 = 1.0;

/// What came out.
pub fn section(data: &Damping) -> Section {
    let scan: Vec<&Case> = data.scan().collect();
    let waves = |case: &Case| case.fano.mean > EVEN;
    let strongest = scan.last().map_or(f64::NAN, |case| case.fano.mean);
    let weakest = scan.first().map_or(f64::NAN, |case| case.fano.mean);
    let controls: Vec<&Case> = data.cases.iter().filter(|case| case.overrides.len() > 1).collect();
    let found = scan.last().is_some_and(|case| waves(case));
    let even = scan.first().is_some_and(|case| !waves(case)) && controls.iter().all(|case| !waves(case));
    Section::new("waves", "Density waves over dissipation")
        .asks("Does damping in contacts make the density waves?")
        .expects("BP93, section 4: grains that start evenly spread form density waves. A Fano factor (variance over mean of the grains in a bin) \
                  above 1 tells waves from none; weakly damped grains and an elastic gas must show none.")
        .answers(format!(
            "The Fano factor is {weakest:.2} at the weakest and {strongest:.2} at the strongest damping; controls: {}.",
            controls
                .iter()
                .map(|case| format!("{} {:.2}", case.name, case.fano.mean))
                .collect::<Vec<_>>()
                .join(", ")
        ))
        .verdict(match (found, even) {
            (true, true) => Verdict::Reproduced,
            (false, false) => Verdict::NotReproduced,
            _ => Verdict::Partly,
        })
        .figures([figure(&scan)])
        .tables([table(data)])
        .seeds(data.seeds.clone())
}

fn figure(scan: &[&Case]) -> Figure {
    let point = |case: &&Case, spread: &Spread| {
        let error = spread.error.unwrap_or(0.0);
        (case.normal_damping, spread.mean, [(spread.mean - error).max(spread.lowest), spread.mean + error])
    };
    let ends = [scan.first(), scan.last()].into_iter().flatten();
    Chart::of(Axis::logarithmic("normal damping γ", Some("1/s")), Axis::logarithmic("Fano factor", None))
        .series("late", Style::Joined, 0, scan.iter().map(|case| point(case, &case.fano)))
        .series("at the start", Style::Points, 1, scan.iter().map(|case| point(case, &case.fano_start)))
        .series("waves above this", Style::Dashed, 2, ends.map(|case| (case.normal_damping, EVEN)))
        .figure("fano_over_damping", "Variance over mean of the grains in a bin, over the damping")
        .caption("Bins of 20 mean radii; the last half of two seconds. Bars: standard error over the seeds.")
}

fn table(data: &Damping) -> Table {
    let with_error = |it: &Spread, decimals: usize| Cell::with_error(it.mean, it.error, decimals);
    Rows::of(&data.cases)
        .text("case", |case| &case.name)
        .cell("Fano at the start", |case| with_error(&case.fano_start, 2))
        .cell("Fano late", |case| with_error(&case.fano, 2))
        .cell("single seeds", |case| Cell::Range([case.fano.lowest, case.fano.highest], 2))
        .cell("strongest mode at the start", |case| with_error(&case.mode_start, 3))
        .cell("strongest mode late", |case| with_error(&case.mode, 3))
        .cell("mean velocity late (m/s)", |case| with_error(&case.flow, 3))
        .table("cases", "Every case")
        .note(format!(
            "Means over {} seeds with their standard errors. Strongest Fourier mode at wavelengths from 80 mean radii on, as a fraction of the \
             grains.",
            data.seeds.len()
        ))
}
