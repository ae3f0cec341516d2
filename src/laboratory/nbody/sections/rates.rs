//! Interactions a second.

use crate::laboratory::nbody::study::rates::{Rate, Rates};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};
use stripmine_physics::number::{counted, in_tens};

/// What came out.
pub fn section(data: &Rates) -> Section {
    let best = |precision: &str| {
        let of = data.rates.iter().filter(|it| it.precision == precision && it.arithmetic != "raw");
        of.max_by(|a, b| a.rates[0].total_cmp(&b.rates[0]))
    };
    let said = |precision: &str| {
        best(precision).map_or(String::new(), |it| {
            format!("{:.1}·10⁹ at a force error of {}", it.rates[0], in_tens(it.error[0], 2))
        })
    };
    let reached = |precision: &str, aim: f64, error: f64| {
        best(precision).is_some_and(|it| it.rates[0] >= aim && it.error[0] <= error)
    };
    let largest = data.rates.last().map_or(0, |it| it.bodies);
    let scaling = data.rates.iter().filter(|it| it.bodies == largest).map(|it| it.rates[1] / it.rates[0]);
    Section::new("nbody-rates", "Bodies: interactions a second")
        .asks("How many interactions a second, at which error of the forces?")
        .expects("Our aim: 13·10⁹ directed interactions a second (N² counted) in single precision at a force error of 10⁻⁶, 5·10⁹ in double at \
                  4·10⁻¹⁵, on a core of 4.1 GHz with AVX-512. Best published kernels there: 7.3·10⁹ at 9·10⁻⁷ and 2.8·10⁹ at 2·10⁻¹⁵.")
        .answers(format!(
            "Directed interactions a second (N² a step) on one core, {}: with forces in single precision {}, in double {}.",
            data.instruction_set,
            said("mixed"),
            said("f64"),
        ))
        .verdict(Verdict::aim(reached("mixed", 13.0, 1e-6) && reached("f64", 5.0, 4e-15)))
        .details([format!(
            "Two threads are {:.2} times as fast at {largest} bodies, with {} bits.",
            scaling.fold(0.0, f64::max),
            if data.same_bits { "the same" } else { "other" }
        )])
        .figures([figure(data)])
        .tables([table(data), conserving(data)])
        .seeds([1])
        .depends_on_host()
}

fn figure(data: &Rates) -> Figure {
    // An error of 0 has no place on a logarithmic axis.
    let (seen, exact): (Vec<_>, Vec<_>) = data.rates.iter().partition(|it| it.error[0] > 0.0);
    let named = |it: &Rate| (format!("{}, {}", it.precision, it.arithmetic), (it.rates[0], it.error[0]));
    Chart::of(Axis::linear("directed interactions", Some("10⁹/s")), Axis::logarithmic("force error", None))
        .with(Series::by_name(Style::Points, seen.into_iter().map(named)))
        .figure("error-over-rate", "Error of the forces over speed, one thread")
        .caption(format!(
            "A point for each number of bodies. Largest error of an acceleration over the largest acceleration. Errors of 0 have no place on \
             this axis: {}.",
            counted(exact.len(), "point is absent", "points are absent")
        ))
}

fn table(data: &Rates) -> Table {
    Rows::of(&data.rates)
        .count("bodies", |it| it.bodies)
        .text("forces", |it| it.precision)
        .text("arithmetic", |it| it.arithmetic)
        .number("1 thread (10⁹/s)", 2, |it| it.rates[0])
        .number("2 threads (10⁹/s)", 2, |it| it.rates[1])
        .number("ratio", 2, |it| it.rates[1] / it.rates[0])
        .short("force error", |it| it.error[0])
        .short("with rounded masses", |it| it.error[1])
        .table("rates", "Directed interactions a second, N² counted")
        .note("Medians of alternating repeats; the time of a whole evaluation with all conversions. Force error: that of the kernel, for \
               positions as it sees them, of 512 bodies.")
}

fn conserving(data: &Rates) -> Table {
    Rows::of(&data.conserving)
        .text("forces", |it| it.precision)
        .text("arithmetic", |it| it.arithmetic)
        .count("steps of a unit of time", |it| it.steps)
        .short("|ΔE/E|", |it| it.error)
        .table(
            "conserving",
            "Energy error of a Plummer sphere of 1024 bodies after two units of time, leapfrog",
        )
        .note("State and energies are in double precision; ε = 0.05. Raw estimates have no correction: what they spoil is seen here.")
}
