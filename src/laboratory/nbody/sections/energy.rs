//! The energy of an orbit.

use crate::laboratory::nbody::study::energy::{Energies, KNOWN, STEPS};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};
use stripmine_physics::method::nbody::schemes::SchemeName;
use stripmine_physics::method::nbody::starts::ORBIT;
use stripmine_physics::number::in_tens;
use stripmine_physics::words::Words;

/// Below this an error is rounding.
const ROUNDING: f64 = 1e-12;

/// What came out.
pub fn section(data: &Energies) -> Section {
    let ratios = || {
        data.errors
            .iter()
            .filter(|it| it.error.is_some_and(|error| error > ROUNDING))
            .filter_map(|it| it.off())
    };
    let (least, most) = (ratios().fold(f64::INFINITY, f64::min), ratios().fold(0.0, f64::max));
    let momentum = data.errors.iter().map(|it| it.drift[0]).fold(0.0, f64::max);
    let [long, short] = [&data.damped[0], &data.damped[2]];
    let times = |energy: Option<f64>| energy.map_or("endless".to_owned(), |energy| format!("{energy:.2}"));
    // From the longest to the shortest step.
    let of = |scheme: SchemeName| {
        let own = data.errors.iter().filter(|it| it.scheme == scheme.word());
        let said = own.map(|it| it.error.map_or("lost".to_owned(), |error| in_tens(error, 2)));
        said.collect::<Vec<_>>().join(", ")
    };
    Section::new("nbody-energy", "Bodies: what integrators do to an orbit")
        .asks("How well does each integrator keep the energy of an orbit, and what do the source's missing ½ and its damping do?")
        .expects(format!(
            "The largest |ΔE/E| of {} schemes along 100 orbits of eccentricity 0.5, as other programs have it. PWP says that its scheme keeps \
             the conservation laws and that damping makes orbits stable; the specification calls both wrong.",
            KNOWN.len()
        ))
        .answers(format!("Every error is {least:.2} to {most:.2} times the known one."))
        .verdict(Verdict::reproduced(least > 0.5 && most < 2.0))
        .details([
            format!(
                "The source's scheme has errors of {} (from the longest step to the shortest); with the ½ that it lacks, {}. The largest \
                 momentum on the way is {}.",
                of(SchemeName::DampedEuler),
                of(SchemeName::EulerWithHalf),
                in_tens(momentum, 1),
            ),
            format!(
                "Damping acts once a step, so what it does depends on the step: 0.9999 makes the orbit's energy {} times as large in ten orbits \
                 of {} steps, and {} times in ten of {}.",
                times(long.energy),
                long.steps,
                times(short.energy),
                short.steps
            ),
        ])
        .figures([cost(data), lost(data)])
        .tables([table(data), damped(data)])
}

fn schemes(data: &Energies) -> Vec<&'static str> {
    let mut names = vec![];
    for orbit in &data.errors {
        if !names.contains(&orbit.scheme) {
            names.push(orbit.scheme);
        }
    }
    names
}

/// The schemes of pictures, with their hues: those between two of one family, and Euler's, are in the table alone.
fn drawn(data: &Energies) -> impl Iterator<Item = (usize, &'static str)> {
    let left_out = [SchemeName::Yoshida6, SchemeName::Euler, SchemeName::EulerWithHalf].map(Words::word);
    schemes(data).into_iter().filter(move |scheme| !left_out.contains(scheme)).enumerate()
}

fn cost(data: &Energies) -> Figure {
    let series = drawn(data).map(|(hue, scheme)| {
        let of = data.errors.iter().filter(|it| it.scheme == scheme);
        let of = of.filter_map(|it| Some((it.evaluations, it.error.filter(|error| *error > 0.0)?)));
        let mut points: Vec<_> = of.collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series::new(scheme, Style::Joined, hue, points)
    });
    Chart::of(
        Axis::logarithmic("evaluations of the forces an orbit", None),
        Axis::logarithmic("largest |ΔE/E|", None),
    )
    .with(series.filter(|series| !series.points.is_empty()))
    .figure("error-over-cost", "Energy error over cost: two bodies, e = 0.5, 100 orbits")
    .caption("Largest error on the way. Schemes that lost the orbit are not drawn at those steps; Yoshida's of order 6 and Euler's are in the table.")
}

fn lost(data: &Energies) -> Figure {
    let series = drawn(data).map(|(hue, scheme)| {
        let of = data.edges.iter().filter(|it| it.scheme == scheme);
        let points = of.filter_map(|it| Some((it.eccentricity, it.steps? as f64)));
        Series::new(scheme, Style::Joined, hue, points)
    });
    Chart::of(Axis::linear("eccentricity", None), Axis::logarithmic("steps of an orbit", None))
        .with(series.filter(|series| !series.points.is_empty()))
        .figure("orbits-lost", "Fewest steps that keep an orbit for 100 turns")
        .caption("Kept: the energy stays within half of itself. Both schemes of Euler are off by more at every step of the table; Yoshida's of order 6 lies between its neighbours.")
}

fn table(data: &Energies) -> Table {
    let of = |scheme: &str, steps: u64| {
        data.errors.iter().find(|it| it.scheme == scheme && it.steps == steps).and_then(|it| it.error)
    };
    let known = |scheme: &str, place: usize| {
        let known = KNOWN.iter().find(|(name, _)| name.word() == scheme);
        known.map_or(Cell::Nothing, |(_, errors)| match errors[place] {
            known if known.is_finite() => Cell::Short(known),
            _ => Cell::from("rounding"),
        })
    };
    // Between the shortest steps whose errors are no rounding.
    let order = |scheme: &str| {
        let errors = STEPS.iter().filter_map(|&steps| of(scheme, steps));
        let errors: Vec<f64> = errors.filter(|error| (ROUNDING..0.5).contains(error)).collect();
        match errors.as_slice() {
            [.., a, b] => Cell::Number((a / b).log2() / 2.0, 2),
            _ => Cell::Nothing,
        }
    };
    let mut rows = Rows::of(schemes(data)).text("scheme", |scheme| *scheme);
    for (place, steps) in STEPS.into_iter().enumerate() {
        rows = rows
            .cell(format!("{steps} steps"), |scheme| {
                of(scheme, steps).map_or(Cell::from("lost"), Cell::Short)
            })
            .cell("known", |scheme| known(scheme, place));
    }
    rows.cell("order", |scheme| order(scheme))
        .table("errors", "Largest |ΔE/E| along 100 orbits, by steps of an orbit")
}

fn damped(data: &Energies) -> Table {
    Rows::of(&data.damped)
        .count("steps of an orbit", |it| it.steps)
        .number("friction −ln(damping)/dt", 4, |it| -it.damping.ln() * it.steps as f64 / ORBIT)
        .cell("energy over that of the start", |it| {
            it.energy.map_or(Cell::from("lost"), |energy| Cell::Number(energy, 3))
        })
        .table("damped", "The source's scheme with a damping of 0.9999, after ten orbits")
        .note("A bound orbit that loses energy shrinks: its energy grows in magnitude.")
}
