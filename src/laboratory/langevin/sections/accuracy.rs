//! The error of the step in a Lennard-Jones fluid.

use super::point;
use crate::laboratory::langevin::study::accuracy::{Accuracy, Fluid, line};
use crate::laboratory::langevin::study::{Mean, PARTS};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};
use crate::statistics::student;

/// Errors that an order is fitted through, at least.
const LEAST: usize = 3;
/// By how much a fitted order may be off, and how well it is to be known.
const ORDER_WITHIN: f64 = 0.5;
/// Standard errors that theory and measurement may differ by.
const STANDARD_ERRORS: f64 = 3.0;

/// The order with which a scheme's error falls; none where fewer than three errors are larger than what they are known to, or where the
/// order is hardly known.
fn order(data: &Accuracy, scheme: &str) -> Option<Mean> {
    let of = data.fluids.iter().filter(|it| it.scheme == scheme && it.is_whole);
    let seen = of.map(|it| (it.dt, error(data, it))).filter(|(_, error)| error.value.abs() > error.bar);
    let logarithm = |Mean { value, bar }: Mean| Mean { value: value.abs().ln(), bar: bar / value.abs() };
    let points: Vec<(f64, Mean)> = seen.map(|(dt, error)| (dt.ln(), logarithm(error))).collect();
    let [_, slope] = (points.len() >= LEAST).then(|| line(&points))?;
    (slope.bar < ORDER_WITHIN).then_some(slope)
}

/// The longest step at which both schemes came to their end, by BAOAB and by the source's.
fn longest(data: &Accuracy) -> Option<[&Fluid; 2]> {
    let of = |scheme: &'static str| data.fluids.iter().filter(move |it| it.scheme == scheme && it.is_whole);
    let pairs = of("baoab").filter_map(|ours| Some([ours, of("stochastic").find(|it| it.dt == ours.dt)?]));
    pairs.max_by(|a, b| a[0].dt.total_cmp(&b[0].dt))
}

/// How many standard errors the cooling at the end of BAOAB's step is off what theory has; none by the source's scheme, which has none.
fn off_theory(it: &Fluid) -> Option<f64> {
    let error = it.cooling.bar.hypot(it.foreseen().bar) / student(0.95, PARTS - 1);
    (it.foreseen().value > 0.0).then(|| (it.cooling.value - it.foreseen().value) / error)
}

fn with_bar(mean: Mean) -> String {
    format!("{:+.4} ± {:.4}", mean.value, mean.bar)
}

/// What came out.
pub fn section(data: &Accuracy) -> Section {
    let fitted = order(data, "baoab");
    let said = match fitted {
        Some(Mean { value, bar }) => {
            format!("By BAOAB the error falls with the step to the power {value:.1} ± {bar:.1}")
        }
        None => "The order of BAOAB's error is not seen: it stays within its scatter up to the longest step"
            .to_owned(),
    };
    let of_source = match order(data, "stochastic") {
        Some(Mean { value, bar }) => format!("to the power {value:.1} ± {bar:.1}"),
        None => "too few errors are beyond their bars for an order".to_owned(),
    };
    // Smaller beyond the bars of both.
    let is_smaller =
        |[ours, source]: [Mean; 2]| source.value.abs() - ours.value.abs() > ours.bar.hypot(source.bar);
    let errors = longest(data).map(|both| both.map(|it| error(data, it)));
    let compared = longest(data).map_or(String::new(), |both| {
        let [ours, source] = both.map(|it| with_bar(error(data, it)));
        format!(
            "At dt = {} the energy, {:.4}, is off by {ours} and by {source}.",
            both[0].dt, data.limit.value
        )
    });
    let kinetic = longest(data).map_or(String::new(), |[ours, source]| {
        format!(
            "There BAOAB's velocities are {:.4} ± {:.4} kT colder at the end of the step than after the bath; theory, dt²⟨∇²U⟩/8m, has {:.4} \
             ({:.1} standard errors away). By the source's scheme velocities have {:.3} kT and places, by ⟨F²⟩/⟨∇²U⟩, {:.3} ± {:.3}.",
            ours.cooling.value,
            ours.cooling.bar,
            ours.foreseen().value,
            off_theory(ours).unwrap_or(f64::NAN).abs(),
            source.at_end.value,
            source.configurational.value,
            source.configurational.bar
        )
    });
    Section::new("langevin-accuracy", "Langevin: the error of the step")
        .asks("How far off are averages for a given step?")
        .expects("Leimkuhler and Matthews: over positions by BAOAB of order dt², far less than by velocity Verlet with noise.")
        .answers(format!("{said}, by the source's scheme {of_source}. {compared}"))
        .verdict(Verdict::of_claims(&[
            errors.is_some_and(is_smaller),
            fitted.is_some_and(|order| (order.value - 2.0).abs() < ORDER_WITHIN),
            longest(data).and_then(|[ours, _]| off_theory(ours)).is_some_and(|off| off.abs() < STANDARD_ERRORS),
        ]))
        .details([kinetic])
        .figures([
            figure(data, "error-over-step", "time step", |it| it.dt),
            temperatures(data),
            figure(data, "error-over-cost", "wall time of a unit of time", |it| it.cost),
        ])
        .tables([table(data)])
        .seeds([1])
        .depends_on_host()
}

fn error(data: &Accuracy, it: &Fluid) -> Mean {
    // The limit is known to its own bar only.
    Mean { value: it.potential.value - data.limit.value, bar: it.potential.bar.hypot(data.limit.bar) }
}

fn figure(data: &Accuracy, name: &str, axis: &str, x: fn(&Fluid) -> f64) -> Figure {
    let series = ["stochastic", "baoab"].into_iter().enumerate().map(|(hue, scheme)| {
        let of = data.fluids.iter().filter(|it| it.scheme == scheme && it.is_whole);
        let mut points: Vec<_> = of.map(|it| point(x(it), error(data, it))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series::new(scheme, Style::Joined, hue, points)
    });
    let unit = if name.ends_with("cost") { "s" } else { "reduced" };
    Chart::of(Axis::linear(axis, Some(unit)), Axis::linear("error of the energy a particle", Some("ε")))
        .with(series)
        .figure(
            name,
            format!("Energy of the pairs: error over the {}", if unit == "s" { "cost" } else { "step" }),
        )
        .caption(format!(
            "{} Lennard-Jones particles, density 0.7, kT = 1; a time of {} at each point. Bars hold the mean in 95 of 100 studies; the energy at \
             short steps itself is known to ± {:.4}.",
            data.particles, data.time, data.limit.bar
        ))
}

/// The temperature at the end of the step by theory.
fn cold(it: &Fluid) -> Mean {
    Mean { value: 1.0 - it.foreseen().value, ..it.foreseen() }
}

fn temperatures(data: &Accuracy) -> Figure {
    let of = |scheme: &'static str| data.fluids.iter().filter(move |it| it.scheme == scheme && it.is_whole);
    let series = |name: &str, style, hue, scheme, mean: fn(&Fluid) -> Mean| {
        Series::new(name, style, hue, of(scheme).map(|it| point(it.dt, mean(it))))
    };
    Chart::of(Axis::linear("time step", Some("reduced")), Axis::linear("temperature over that of the bath", None))
        .with([
            series("baoab, end of step", Style::Points, 1, "baoab", |it| it.at_end),
            series("1 − dt²⟨∇²U⟩/8m", Style::Line, 6, "baoab", cold),
            series("baoab, after the bath", Style::Joined, 2, "baoab", |it| it.temperature),
            series("stochastic, end of step", Style::Joined, 0, "stochastic", |it| it.at_end),
            series("stochastic, ⟨F²⟩/⟨∇²U⟩", Style::Joined, 3, "stochastic", |it| it.configurational),
        ])
        .figure("temperatures", "Temperatures of velocities and of places")
        .caption("Bars hold the mean in 95 of 100 studies. By the source's scheme velocities have kT, and places are too hot.")
}

fn table(data: &Accuracy) -> Table {
    Rows::of(&data.fluids)
        .text("scheme", |it| it.scheme)
        .number("dt", 4, |it| it.dt)
        .number("energy", 4, |it| it.potential.value)
        .number("± (95 %)", 4, |it| it.potential.bar)
        .number("pressure", 4, |it| it.pressure.value)
        .number("± (95 %)", 4, |it| it.pressure.bar)
        .number("temperature", 4, |it| it.temperature.value)
        .number("± (95 %)", 4, |it| it.temperature.bar)
        .number("at the end of the step", 4, |it| it.at_end.value)
        .number("by theory", 4, |it| cold(it).value)
        .number("colder by", 4, |it| it.cooling.value)
        .number("± (95 %)", 4, |it| it.cooling.bar)
        .number("by theory", 4, |it| it.foreseen().value)
        .number("standard errors off", 1, |it| off_theory(it))
        .number("⟨F²⟩/⟨∇²U⟩", 3, |it| it.configurational.value)
        .number("± (95 %)", 3, |it| it.configurational.bar)
        .number("⟨∇²U⟩/2", 1, |it| it.curvature.value)
        .number("ms a unit of time", 1, |it| 1e3 * it.cost)
        .table("accuracy", "Energy of the pairs a particle, pressure and temperatures")
        .note("Errors from the scatter of 20 parts of each run. Two runs at a time shared the machine.")
        .note(
            "Colder at the end of the step than as observed, by baoab after the bath: dt²⟨∇²U⟩/8m by theory, exact in a harmonic trap, where the \
             velocities of stochastic have kT at the end of the step.",
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Energies that err as `factor` dt², known to `bar`, and velocities at the end of the step that are colder than theory has them by `off`.
    fn section_of(factor: f64, bar: f64, off: f64) -> Section {
        let mean = |value: f64| Mean { value, bar };
        let fluid = |scheme: &'static str, factor: f64, dt: f64| Fluid {
            scheme,
            dt,
            potential: mean(-1.0 + factor * dt * dt),
            pressure: mean(1.0),
            temperature: mean(1.0),
            at_end: mean(1.0),
            cooling: mean(if scheme == "baoab" { 100.0 * dt * dt + off } else { 0.0 }),
            configurational: mean(1.0),
            curvature: mean(400.0),
            cost: 1.0,
            is_whole: true,
        };
        let steps = [0.0025, 0.005, 0.01, 0.02];
        let fluids = steps.iter().flat_map(|&dt| [fluid("baoab", factor, dt), fluid("stochastic", 1e3, dt)]);
        section(&Accuracy { particles: 1, time: 1.0, fluids: fluids.collect(), limit: mean(-1.0) })
    }

    #[test]
    fn an_order_that_is_lost_in_the_scatter_is_not_reproduced() {
        let seen = section_of(100.0, 1e-5, 0.0);
        assert_eq!(seen.verdict, Verdict::Reproduced);
        assert!(
            seen.answer.contains("to the power 2.0 ± 0.0, by the source's scheme to the power 2.0"),
            "{}",
            seen.answer
        );
        let lost = section_of(1.0, 1e-3, 0.0);
        assert_eq!(lost.verdict, Verdict::Partly);
        assert!(lost.answer.starts_with("The order of BAOAB's error is not seen"), "{}", lost.answer);
    }

    /// Velocities at the end of BAOAB's step are colder than the bath by what theory says, or it is not reproduced.
    #[test]
    fn the_temperature_at_the_end_of_the_step_is_held_against_theory() {
        let cold = section_of(100.0, 1e-5, 0.0).details.concat();
        assert!(cold.contains("0.0400 ± 0.0000 kT colder"), "{cold}");
        assert!(cold.contains("has 0.0400 (0.0 standard"), "{cold}");
        assert_eq!(section_of(100.0, 1e-5, 0.001).verdict, Verdict::Partly);
    }
}
