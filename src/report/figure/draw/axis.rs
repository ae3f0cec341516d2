//! Where numbers lie on an axis, and how they are written there.

use super::super::xml::escaped;
use super::super::{Axis, Fault, Scale};
use kuva::prelude::TickFormat;
use std::sync::Arc;
use stripmine_physics::number::ten_to;

/// Part of an axis' length that is left free at each of its ends when they are taken from the data.
const FREE: f64 = 0.04;
/// The library marks no decade below this number: smaller ones are multiplied by a power of ten, and written without it.
const LEAST: f64 = 1e-8;
/// A logarithmic axis with fewer decades is marked like a linear one, and is one: it would have no two marks.
const FEWEST_DECADES: f64 = 0.7;

/// Where fewer powers of ten are marked, numbers between them are as well.
const FEWEST_MARKS: usize = 3;

/// An axis with its ends, in the numbers that the library is given.
#[derive(Clone, Debug)]
pub struct Span {
    /// What stands along it.
    pub heading: String,
    /// How numbers lie on it.
    pub scale: Scale,
    /// Its ends.
    pub ends: [f64; 2],
    /// The power of ten that its numbers are multiplied by.
    power: i32,
}

impl Span {
    /// The axis for these values.
    ///
    /// # Errors
    /// [`Fault`] if there are no values.
    pub fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Result<Span, Fault> {
        let span = Span::exact(axis, values)?;
        let few = span.is_logarithmic() && span.decades() < FEWEST_DECADES;
        let ends = span.ends.map(|end| end / span.number(1.0));
        Ok(if few { Span { scale: Scale::Linear, ends, power: 0, ..span } } else { span })
    }

    /// The axis for these values, however few marks it will have: for a map, whose rows and columns lie as the axis says.
    ///
    /// # Errors
    /// [`Fault`] if there are no values.
    pub fn exact(axis: &Axis, values: impl Iterator<Item = f64>) -> Result<Span, Fault> {
        let (ends, scale) = (ends(axis, values)?, axis.scale);
        let small = scale == Scale::Logarithmic && ends[0] < LEAST;
        let power = if small { -exponent(ends[0]) } else { 0 };
        let mut span = Span { heading: axis.heading(), scale, ends, power };
        span.ends = ends.map(|end| span.number(end));
        Ok(span)
    }

    /// What the library is given for a value.
    pub fn number(&self, value: f64) -> f64 {
        value * libm::pow(10.0, f64::from(self.power))
    }

    /// Where its numbers lie between two places of a picture, for who reads values from it: the scale, the places of its ends,
    /// its ends, and its heading.
    pub fn scale_between(&self, low: f64, high: f64) -> String {
        let scale = if self.is_logarithmic() { "log" } else { "linear" };
        let [first, last] = self.ends.map(|end| end / self.number(1.0));
        format!("{scale} {low:.2} {high:.2} {first:.6e} {last:.6e} {}", escaped(&self.heading))
    }

    /// Whether values have equal ratios at equal distances.
    pub fn is_logarithmic(&self) -> bool {
        self.scale == Scale::Logarithmic
    }

    /// How many decades it has.
    pub fn decades(&self) -> f64 {
        libm::log10(self.ends[1] / self.ends[0])
    }

    /// How its numbers are written, at most about `most` of them.
    pub fn format(&self, most: f64) -> TickFormat {
        match self.scale {
            Scale::Linear => linear(self.ends),
            Scale::Logarithmic => self.logarithmic(most),
        }
    }

    fn logarithmic(&self, most: f64) -> TickFormat {
        let (power, decades) = (self.power, self.decades());
        let [low, high] = self.ends.map(|end| exponent(end) - power);
        // Powers of ten are spelled out only where none of them is long.
        let spelled = low >= -3 && high <= 4;
        let stride = (decades / most).ceil().max(1.0) as i32;
        let first = libm::log10(self.ends[0]).ceil() as i32 - power;
        let last = libm::log10(self.ends[1]).floor() as i32 - power;
        let marked = (first..=last).filter(|raised| raised.rem_euclid(stride) == 0).count();
        TickFormat::Custom(Arc::new(move |number| {
            let raised = exponent(number);
            let factor = (number / libm::pow(10.0, f64::from(raised))).round() as i32;
            let raised = raised - power;
            if marked >= FEWEST_MARKS && (factor != 1 || raised.rem_euclid(stride) != 0) {
                return String::new();
            }
            match factor {
                _ if spelled => plain(f64::from(factor) * libm::pow(10.0, f64::from(raised))),
                1 => ten_to(raised),
                _ => format!("{factor}×{}", ten_to(raised)),
            }
        }))
    }
}

/// Numbers between two ends: spelled out where that is short, otherwise all with one power of ten.
pub fn linear([low, high]: [f64; 2]) -> TickFormat {
    let largest = low.abs().max(high.abs());
    let common = if (1e-3..1e6).contains(&largest) { 0 } else { exponent(largest) };
    TickFormat::Custom(Arc::new(move |number| match common {
        0 => plain(number),
        _ if number == 0.0 => "0".to_owned(),
        _ => format!("{}×{}", plain(number / libm::pow(10.0, f64::from(common))), ten_to(common)),
    }))
}

/// The ends of an axis in the data's own numbers: its limits, or those of the data and a little more.
///
/// # Errors
/// [`Fault`] if there is no data.
pub fn ends(axis: &Axis, values: impl Iterator<Item = f64>) -> Result<[f64; 2], Fault> {
    if let Some(limits) = axis.limits {
        return Ok(limits);
    }
    let [low, high] = values
        .map(|value| if axis.scale == Scale::Linear { value } else { libm::log10(value) })
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    let length = high - low;
    if !length.is_finite() {
        return Err(Fault::NotAnInterval { place: format!("the axis `{}`", axis.label), ends: [low, high] });
    }
    let free = match axis.scale {
        // A distance that the numbers can tell apart.
        _ if length > 1e-12 * low.abs().max(high.abs()) => FREE * length,
        Scale::Logarithmic => libm::log10(2.0),
        Scale::Linear if low == 0.0 => 1.0,
        Scale::Linear => 0.1 * low.abs(),
    };
    Ok(match axis.scale {
        // A quantity that is positive keeps a positive axis.
        Scale::Linear if low > 0.0 => [(low - free).max(0.0), high + free],
        Scale::Linear => [low - free, high + free],
        Scale::Logarithmic => [low - free, high + free].map(|end| libm::pow(10.0, end)),
    })
}

/// The decade a number lies in; one that is a power of ten but for its last digits lies at its beginning.
fn exponent(number: f64) -> i32 {
    (libm::log10(number.abs()) + 1e-9).floor() as i32
}

/// A number in full, without the noise of its last digits.
fn plain(number: f64) -> String {
    let size = libm::pow(10.0, f64::from(10 - exponent(number).max(-300)));
    let rounded = if number == 0.0 { 0.0 } else { (number * size).round() / size };
    rounded.to_string().replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(scale: Scale, limits: Option<[f64; 2]>) -> Axis {
        Axis { scale, limits, ..Axis::linear("time", Some("s")) }
    }

    fn written(scale: Scale, limits: [f64; 2], values: &[f64]) -> Vec<String> {
        let span = Span::new(&axis(scale, Some(limits)), std::iter::empty()).unwrap();
        let format = span.format(6.0);
        values.iter().map(|&value| format.format(span.number(value))).collect()
    }

    #[test]
    fn ends_leave_some_room() {
        let of = |scale, values: &[f64]| ends(&axis(scale, None), values.iter().copied()).unwrap();
        assert_eq!(of(Scale::Linear, &[0.0, 100.0]), [-4.0, 104.0]);
        assert_eq!(of(Scale::Linear, &[1.0, 101.0]), [0.0, 105.0]);
        assert_eq!(of(Scale::Linear, &[0.0]), [-1.0, 1.0]);
        assert_eq!(of(Scale::Linear, &[-20.0, -20.0]), [-22.0, -18.0]);
        let [low, high] = of(Scale::Logarithmic, &[1e-14, 1.0]).map(f64::log10);
        assert!((low + 14.56).abs() < 1e-9 && (high - 0.56).abs() < 1e-9);
        assert!(ends(&axis(Scale::Linear, None), [-1e308, 1e308].into_iter()).is_err());
    }

    #[test]
    fn numbers_on_an_axis_are_short() {
        let linear = |limits, values: &[f64]| written(Scale::Linear, limits, values);
        assert_eq!(linear([0.0, 1.0], &[0.0, 0.1 + 0.2, 0.6000000000000001]), ["0", "0.3", "0.6"]);
        assert_eq!(linear([-12.0, 12.0], &[-10.0, 5.0]), ["−10", "5"]);
        assert_eq!(linear([0.0, 2.5e-9], &[0.0, 5e-10, 2e-9]), ["0", "0.5×10⁻⁹", "2×10⁻⁹"]);
        assert_eq!(linear([0.0, 4e6], &[3e6]), ["3×10⁶"]);
        let logarithmic = |limits, values: &[f64]| written(Scale::Logarithmic, limits, values);
        assert_eq!(logarithmic([0.01, 1e4], &[0.01, 0.02, 1000.0]), ["0.01", "", "1000"]);
        assert_eq!(logarithmic([1e-5, 1.0], &[1e-4, 1.0, 2e-3]), ["10⁻⁴", "1", ""]);
        assert_eq!(logarithmic([1e6, 5e7], &[1e6, 2e6, 1e7]), ["10⁶", "2×10⁶", "10⁷"]);
        assert_eq!(logarithmic([1.0, 20.0], &[1.0, 2.0, 5.0, 10.0]), ["1", "2", "5", "10"]);
        // Of many decades every third is written.
        assert_eq!(
            logarithmic([1e-16, 1.0], &[1e-15, 1e-14, 1e-12, 1e-6, 1.0]),
            ["10⁻¹⁵", "", "10⁻¹²", "10⁻⁶", "1"]
        );
    }

    #[test]
    fn few_decades_are_marked_as_on_a_linear_axis() {
        let span = Span::new(&axis(Scale::Logarithmic, Some([1.0, 1.8])), std::iter::empty()).unwrap();
        assert!(!span.is_logarithmic());
    }
}
