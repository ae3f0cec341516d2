//! Pressure of hard discs beside published values, as `tests/rivals/historic_discs.py` measured it.

use super::fluid::virial_value;
use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::provenance::RepeatedMeasurement;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::statistics::MeanWithBar;
use serde::Deserialize;
use std::f64::consts::PI;

/// Results of the script, and their provenance.
const PRESSURES: &str = include_str!("../../../study/rivals/measured/pressures/pressures.json");
const SOURCE: &str = include_str!("../../../study/rivals/measured/pressures/provenance.json");

/// Packing fraction, βp(2σ)² and its standard error of 870 discs in a periodic square (Li et al. 2022).
const SMALL: [[f64; 3]; 10] = [
    [0.670, 7.986_779, 0.000_025],
    [0.674, 8.199_729, 0.000_025],
    [0.680, 8.513_249, 0.000_037],
    [0.686, 8.804_458, 0.000_052],
    [0.690, 8.969_898, 0.000_075],
    [0.694, 9.089_054, 0.000_083],
    [0.698, 9.134_14, 0.000_22],
    [0.700, 9.129_66, 0.000_15],
    [0.710, 9.064_69, 0.000_43],
    [0.718, 9.050_7, 0.004_0],
];
/// Packing fraction, βp(2σ)² and its standard error of 512² discs, between fluid and crystal.
const LARGE: [[f64; 3]; 4] = [
    [0.698, 9.169_588, 0.000_091],
    [0.700, 9.186_40, 0.000_47],
    [0.710, 9.182_87, 0.000_35],
    [0.716, 9.182_82, 0.000_72],
];

#[derive(Deserialize)]
struct MeasuredPressures {
    rows: Vec<MeasuredPressure>,
}

/// Z of all runs of a system; no mean if the runs are too short for one.
#[derive(Clone, Debug, Deserialize)]
struct MeasuredPressure {
    packing_fraction: f64,
    discs: u64,
    start: String,
    runs: u64,
    collisions: u64,
    mean: Option<f64>,
    /// Half-width of the 95 % interval, and the standard error.
    bar: Option<f64>,
    standard_error: Option<f64>,
}

impl MeasuredPressure {
    /// Mean with its 95 % half-width, and the standard error, of Z times a factor.
    fn scaled(&self, factor: f64) -> Option<(MeanWithBar, f64)> {
        let mean = MeanWithBar { value: factor * self.mean?, bar: factor * self.bar? };
        Some((mean, factor * self.standard_error?))
    }

    /// βp(2σ)², which is 4ν/π times Z.
    fn pressure(&self) -> Option<(MeanWithBar, f64)> {
        self.scaled(4.0 * self.packing_fraction / PI)
    }
}

/// Difference in standard errors of both.
fn difference((mean, error): (MeanWithBar, f64), [known, known_error]: [f64; 2]) -> f64 {
    (mean.value - known) / error.hypot(known_error)
}

/// Mean of the squared differences, of those that are known.
fn reduced_chi_squared(differences: &[Option<f64>]) -> f64 {
    let squares = differences.iter().flatten().map(|it| it * it);
    squares.sum::<f64>() / differences.iter().flatten().count().max(1) as f64
}

/// Returns the pressures as the script measured them.
///
/// # Errors
/// Fails if a shipped file is not in the format of the script.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let wrong =
        |cause: serde_json::Error| CommandFailure::writing("pressures of historic_discs.py")(cause.into());
    let MeasuredPressures { rows } = serde_json::from_str(PRESSURES).map_err(wrong)?;
    let source: RepeatedMeasurement = serde_json::from_str(SOURCE).map_err(wrong)?;
    let row = |nu: f64, discs: u64, start: &str| {
        rows.iter().find(|it| it.packing_fraction == nu && it.discs == discs && it.start == start)
    };
    let gases = rows.iter().filter_map(|it| Some((it, virial_value(it.packing_fraction)?)));
    let gases: Vec<_> = gases.filter(|(it, _)| it.discs > 870).collect();
    let off = |(it, known): &(&MeasuredPressure, f64)| Some(difference(it.scaled(1.0)?, [*known, 0.0]));
    let dense: Vec<_> =
        SMALL.iter().map(|known| (known, row(known[0], 870, "compressed").cloned())).collect();
    let pressure = |it: &Option<MeasuredPressure>| it.as_ref().and_then(MeasuredPressure::pressure);
    let apart = |(known, it): &(&[f64; 3], Option<MeasuredPressure>)| {
        Some(difference(pressure(it)?, [known[1], known[2]]))
    };
    let sides = |nu: f64| {
        ["compressed", "hexagonal"].map(|start| {
            let found =
                rows.iter().find(|it| it.packing_fraction == nu && it.start == start && it.discs > 200_000);
            found.and_then(MeasuredPressure::pressure).map(|(mean, _)| mean)
        })
    };
    let largest = dense.iter().filter_map(|(_, it)| it.as_ref()?.standard_error).fold(0.0, f64::max);
    let frames = [
        FrameBuilder::of(&gases)
            .number("ν", 2, |(it, _)| it.packing_fraction)
            .count("discs", |(it, _)| it.discs)
            .mean("Z", 5, |(it, _)| it.scaled(1.0).map(|(mean, _)| mean))
            .number("Z of the virial series", 5, |(_, known)| *known)
            .number("difference over the standard error", 1, |it| off(it))
            .frame("gases", "Dilute gases beside the virial series"),
        FrameBuilder::of(&dense)
            .number("ν", 3, |(known, _)| known[0])
            .number("published", 5, |(known, _)| known[1])
            .short("its standard error", |(known, _)| known[2])
            .mean("ours", 4, |(_, it)| pressure(it).map(|(mean, _)| mean))
            .short("standard error of Z", |(_, it)| it.as_ref().and_then(|it| it.standard_error))
            .number("difference over the standard error", 1, |it| apart(it))
            .number("collisions (10⁹)", 2, |(_, it)| it.as_ref().map(|it| 1e-9 * it.collisions as f64))
            .number("runs", 0, |(_, it)| it.as_ref().map(|it| it.runs as f64))
            .frame("dense", "βp(2σ)² of 870 discs"),
        FrameBuilder::of(LARGE)
            .number("ν", 3, |known| known[0])
            .number("published", 5, |known| known[1])
            .mean("from a fluid", 4, |known| sides(known[0])[0])
            .mean("from a crystal", 4, |known| sides(known[0])[1])
            .text("between both", |known| match sides(known[0]) {
                [Some(fluid), Some(crystal)]
                    if crystal.value - crystal.bar <= known[1] && known[1] <= fluid.value + fluid.bar =>
                {
                    "yes"
                }
                _ => "no",
            })
            .frame("melting", "βp(2σ)² of 512² discs between fluid and crystal, from both sides"),
        FrameBuilder::of([()])
            .number("chi squared of the gases over their number", 2, |()| {
                reduced_chi_squared(&gases.iter().map(off).collect::<Vec<_>>())
            })
            .number("chi squared of the dense discs over their number", 2, |()| {
                reduced_chi_squared(&dense.iter().map(apart).collect::<Vec<_>>())
            })
            .count("densities with a mean", |()| dense.iter().filter_map(apart).count())
            .short("largest standard error of Z", |()| largest)
            .frame("summary", "Agreement with the published values"),
    ];
    Ok(FinishedItem { repeated: vec![source], ..FinishedItem::of(frames) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: Z = 10.2 at ν = π/4 is a pressure of 10.2; it differs from 10 ± 0.03 by 0.2/0.05 with an error of 0.04.
    #[test]
    fn pressures_are_compared_in_standard_errors() {
        let row = MeasuredPressure {
            packing_fraction: PI / 4.0,
            discs: 870,
            start: String::new(),
            runs: 8,
            collisions: 1,
            mean: Some(10.2),
            bar: Some(0.1),
            standard_error: Some(0.04),
        };
        let off = difference(row.pressure().unwrap(), [10.0, 0.03]);
        assert!((off - 4.0).abs() < 1e-12, "{off}");
        assert!((reduced_chi_squared(&[Some(off), Some(0.0)]) - 8.0).abs() < 1e-12);
        assert!((reduced_chi_squared(&[Some(off), None]) - 16.0).abs() < 1e-12);
    }
}
