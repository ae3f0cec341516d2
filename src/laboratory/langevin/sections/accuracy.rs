//! The error of the step in a Lennard-Jones fluid.

use super::point;
use crate::laboratory::langevin::study::Mean;
use crate::laboratory::langevin::study::accuracy::{Accuracy, Fluid};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};
use crate::statistics::slope;

/// Errors that an order is fitted through, at least.
const LEAST: usize = 3;
/// By how much a fitted order may be off.
const ORDER_WITHIN: f64 = 0.5;

/// The order with which a scheme's error falls; none where fewer than three errors are larger than what they are known to.
fn order(data: &Accuracy, scheme: &str) -> Option<f64> {
    let of = data.fluids.iter().filter(|it| it.scheme == scheme && it.is_whole);
    let seen = of.map(|it| (it.dt, error(data, it))).filter(|(_, error)| error.value.abs() > error.bar);
    let (steps, errors): (Vec<f64>, Vec<f64>) =
        seen.map(|(dt, error)| (dt.ln(), error.value.abs().ln())).unzip();
    (steps.len() >= LEAST).then(|| slope(&steps, &errors))
}

/// What came out.
pub fn section(data: &Accuracy) -> Section {
    let at = |scheme: &str| data.fluids.iter().find(|it| it.scheme == scheme && it.dt == 0.01);
    let off = |scheme: &str| at(scheme).map_or(Mean { value: f64::NAN, bar: f64::NAN }, |it| error(data, it));
    let [ours, source] = ["baoab", "stochastic"].map(off);
    let fitted = order(data, "baoab");
    let said = match fitted {
        Some(order) => format!("By BAOAB the error falls with the step to the power {order:.1}."),
        None => "The order of BAOAB's error is not seen: it is lost in the scatter at all steps but a few."
            .to_owned(),
    };
    // Smaller beyond the bars of both.
    let is_smaller = source.value.abs() - ours.value.abs() > ours.bar.hypot(source.bar);
    let with_bar = |mean: Mean| format!("{:+.4} ± {:.4}", mean.value, mean.bar);
    Section::new("langevin-accuracy", "Langevin: the error of the step")
        .asks("How far off are averages over positions for a given step, by either scheme?")
        .expects("Leimkuhler and Matthews: by BAOAB the error is of order dt² and far smaller than by velocity Verlet with noise in the \
                  acceleration.")
        .answers(format!(
            "{said} At dt = 0.01 the energy of the pairs is off by {} by BAOAB and by {} by the source's scheme, of {:.4} a particle.",
            with_bar(ours),
            with_bar(source),
            data.limit.value
        ))
        .verdict(Verdict::of_claims(&[
            is_smaller,
            fitted.is_some_and(|order| (order - 2.0).abs() < ORDER_WITHIN),
        ]))
        .figures([
            figure(data, "error-over-step", "time step", |it| it.dt),
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
        .number("ms a unit of time", 1, |it| 1e3 * it.cost)
        .table("accuracy", "Energy of the pairs a particle, pressure and temperature")
        .note("Errors from the scatter of 20 parts of each run. Two runs at a time shared the machine.")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Energies that err as `factor` dt², known to `bar`.
    fn section_of(factor: f64, bar: f64) -> Section {
        let mean = |value: f64| Mean { value, bar };
        let fluid = |scheme: &'static str, factor: f64, dt: f64| Fluid {
            scheme,
            dt,
            potential: mean(-1.0 + factor * dt * dt),
            pressure: mean(1.0),
            temperature: mean(1.0),
            cost: 1.0,
            is_whole: true,
        };
        let steps = [0.0025, 0.005, 0.01, 0.02];
        let fluids = steps.iter().flat_map(|&dt| [fluid("baoab", factor, dt), fluid("stochastic", 1e3, dt)]);
        section(&Accuracy { particles: 1, time: 1.0, fluids: fluids.collect(), limit: mean(-1.0) })
    }

    #[test]
    fn an_order_that_is_lost_in_the_scatter_is_not_reproduced() {
        let seen = section_of(100.0, 1e-5);
        assert_eq!(seen.verdict, Verdict::Reproduced);
        assert!(seen.answer.contains("to the power 2.0"), "{}", seen.answer);
        let lost = section_of(1.0, 1e-3);
        assert_eq!(lost.verdict, Verdict::Partly);
        assert!(lost.answer.starts_with("The order of BAOAB's error is not seen"), "{}", lost.answer);
    }
}
