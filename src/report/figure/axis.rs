//! Axes: ends, positions of numbers, and tick marks.

use super::check::interval_error;
use super::writer::escaped;
use super::{ChartAxis, Scale};
use libm::{log10, pow};
use stripmine_physics::number::power_of_ten;

/// Share of an axis left free at each end when its ends are fitted to the data.
const FREE: f64 = 0.04;
/// Maximum number of decades with marks in between.
const MOST_DECADES: i32 = 5;
/// Minimum number of decades for logarithmic marks; a shorter axis is marked like a linear one.
const FEWEST_DECADES: f64 = 0.7;
/// Distances between labelled decades, from many labels to few. 0 also labels numbers between decades; -1, for a short axis with one
/// decade, also labels 3 times that decade.
const STRIDES: [i32; 10] = [0, 1, 2, 3, 5, 10, 20, 50, 100, -1];
/// Maximum numbers of labels for steps of 1, 2 or 5 times a power of ten.
const PARTS: [f64; 6] = [10.0, 5.0, 2.0, 1.0, 0.5, 0.2];

/// Axis with its ends.
#[derive(Clone, Debug)]
pub(crate) struct AxisRange {
    /// Quantity with its unit.
    pub heading: String,
    /// Scale of the axis.
    pub scale: Scale,
    /// First and last number.
    pub ends: [f64; 2],
}

/// Tick mark: position as a fraction of the axis, and label, empty for a small mark.
pub(crate) type TickMark = (f64, String);

impl AxisRange {
    /// Fits the ends of an axis to values, unless it has limits.
    pub(super) fn new(axis: &ChartAxis, values: impl Iterator<Item = f64>) -> Result<AxisRange, String> {
        let ends = match (&axis.scale, axis.limits) {
            (Scale::Names(names), _) => [-0.5, names.len() as f64 - 0.5],
            (_, Some(limits)) => limits,
            _ => fitted_ends(axis, values)?,
        };
        Ok(AxisRange { heading: axis.heading(), scale: axis.scale.clone(), ends })
    }

    fn is_logarithmic(&self) -> bool {
        self.scale == Scale::Logarithmic
    }

    /// Ends of the axis on a linear scale, logarithms if the axis is logarithmic.
    fn even_ends(&self) -> [f64; 2] {
        if self.is_logarithmic() { self.ends.map(log10) } else { self.ends }
    }

    /// Returns the position of a value as a fraction of the axis. Non-positive values are infinitely far below a logarithmic axis.
    pub(super) fn fraction_of(&self, value: f64) -> f64 {
        let [low, high] = self.even_ends();
        ((if self.is_logarithmic() { log10(value.max(0.0)) } else { value }) - low) / (high - low)
    }

    /// Returns the value at a fraction of the axis.
    pub(super) fn value(&self, part: f64) -> f64 {
        let [low, high] = self.even_ends();
        let value = low + part * (high - low);
        if self.is_logarithmic() { pow(10.0, value) } else { value }
    }

    /// Describes the axis between two positions of a picture for scripts: scale, positions of its ends, ends, heading and names.
    pub(crate) fn described(&self, from: f64, to: f64) -> String {
        let (scale, names) = match &self.scale {
            Scale::Linear => ("linear", String::new()),
            Scale::Logarithmic => ("log", String::new()),
            Scale::Names(names) => ("names", names.iter().map(|name| format!("|{name}")).collect()),
        };
        let [low, high] = self.ends;
        escaped(&format!("{scale} {from:.2} {to:.2} {low:.6e} {high:.6e} {}{names}", self.heading))
    }

    /// Returns the marks of the axis with as many labels as fit. `room` returns the length that a label needs.
    pub(crate) fn tick_marks(&self, length: f64, room: impl Fn(&str) -> f64) -> Vec<TickMark> {
        if let Scale::Names(names) = &self.scale {
            return (0..)
                .zip(names)
                .map(|(i, name)| (self.fraction_of(f64::from(i)), name.clone()))
                .collect();
        }
        let decades = log10(self.ends[1]) - log10(self.ends[0]);
        let strides = STRIDES
            .iter()
            .filter(|_| self.is_logarithmic() && decades > FEWEST_DECADES)
            .map(|&stride| self.decade_marks(stride));
        let steps = PARTS.iter().map(|&parts| self.step_marks(parts));
        let fits = |marks: &Vec<TickMark>| {
            let labelled: Vec<_> = marks.iter().filter(|mark| !mark.1.is_empty()).collect();
            let apart = |a: &TickMark, b: &TickMark| (b.0 - a.0) * length >= 0.5 * (room(&a.1) + room(&b.1));
            labelled.len() > 1 && labelled.windows(2).all(|pair| apart(pair[0], pair[1]))
        };
        let inside = |mut marks: Vec<TickMark>| {
            marks.retain(|(part, _)| (-1e-9..=1.0 + 1e-9).contains(part));
            marks
        };
        strides.chain(steps).map(inside).find(fits).unwrap_or_default()
    }

    /// Marks at 1 to 9 times powers of ten. Numbers are written in full only if all of them are short.
    fn decade_marks(&self, stride: i32) -> Vec<TickMark> {
        let [low, high] = self.ends.map(exponent);
        let mut marks = vec![];
        for raised in low..=high {
            for factor in 1..=if high - low > MOST_DECADES { 1 } else { 9 } {
                let value = f64::from(factor) * pow(10.0, f64::from(raised));
                let is_labelled = match stride {
                    0 => [1, 2, 5].contains(&factor),
                    -1 => [1, 3].contains(&factor),
                    _ => factor == 1 && raised % stride == 0,
                };
                let label = match factor {
                    _ if !is_labelled => String::new(),
                    _ if low >= -3 && high <= 4 => plain(value),
                    1 => power_of_ten(raised),
                    _ => format!("{factor}×{}", power_of_ten(raised)),
                };
                marks.push((self.fraction_of(value), label));
            }
        }
        marks
    }

    /// Marks at multiples of a power of ten over `parts`, with small marks in between.
    fn step_marks(&self, parts: f64) -> Vec<TickMark> {
        let unit = pow(10.0, log10(self.ends[1] - self.ends[0]).floor()) / parts;
        let small = if [5.0, 0.5].contains(&parts) { 4.0 } else { 5.0 };
        let [first, last] = self.ends.map(|end| end / unit * small);
        // The ends of a very short axis may not be distinguishable in floating point.
        let most = if last - first < 1000.0 { usize::MAX } else { 0 };
        let all = (first - 1e-9).ceil() as i64..=(last + 1e-9).floor() as i64;
        let mark = |i: f64| {
            let value = i * unit / small;
            (self.fraction_of(value), if i % small == 0.0 { self.number_label(value) } else { String::new() })
        };
        all.take(most).map(|i| mark(i as f64)).collect()
    }

    /// Label of a number: written in full if short, otherwise with a common power of ten.
    fn number_label(&self, number: f64) -> String {
        let largest = self.ends[0].abs().max(self.ends[1].abs());
        let common = if (1e-3..1e6).contains(&largest) { 0 } else { exponent(largest) };
        match common {
            0 => plain(number),
            _ if number == 0.0 => "0".to_owned(),
            _ => format!("{}×{}", plain(number / pow(10.0, f64::from(common))), power_of_ten(common)),
        }
    }
}

/// Returns the range of the data with a margin.
fn fitted_ends(axis: &ChartAxis, values: impl Iterator<Item = f64>) -> Result<[f64; 2], String> {
    let is_logarithmic = axis.scale == Scale::Logarithmic;
    let [low, high] = values
        .map(|value| if is_logarithmic { log10(value) } else { value })
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    let length = high - low;
    if !length.is_finite() {
        return Err(interval_error(&format!("the axis `{}`", axis.label), [low, high]));
    }
    let free = match is_logarithmic {
        // The range is resolved in floating point.
        _ if length > 1e-12 * low.abs().max(high.abs()) => FREE * length,
        true => log10(2.0),
        false if low == 0.0 => 1.0,
        false => 0.1 * low.abs(),
    };
    let ends = match [low - free, high + free] {
        // The margin may overflow.
        ends if is_logarithmic => ends.map(|end| pow(10.0, end).clamp(f64::MIN_POSITIVE, f64::MAX)),
        // The axis of a positive quantity stays positive.
        [below, above] => [if low > 0.0 { below.max(0.0) } else { below }, above],
    };
    if !(ends[1] - ends[0]).is_finite() {
        return Err(interval_error(&format!("the axis `{}`", axis.label), ends));
    }
    Ok(ends)
}

/// Returns the decade of a number. Rounding errors just below a power of ten are tolerated.
fn exponent(number: f64) -> i32 {
    (log10(number.abs()) + 1e-9).floor() as i32
}

/// Returns a number in full, without rounding noise.
fn plain(number: f64) -> String {
    let rounded: f64 = format!("{number:.9e}").parse().unwrap_or(number);
    rounded.to_string().replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(scale: Scale, limits: Option<[f64; 2]>) -> ChartAxis {
        ChartAxis { scale, limits, ..ChartAxis::linear("time", Some("s")) }
    }

    /// Labels of an axis with space for about six.
    fn labels(scale: Scale, limits: [f64; 2]) -> Vec<String> {
        let span = AxisRange::new(&axis(scale, Some(limits)), std::iter::empty()).unwrap();
        let marks = span.tick_marks(6.0, |_| 1.0);
        assert!(marks.iter().all(|mark| (-1e-9..=1.0 + 1e-9).contains(&mark.0)));
        marks.into_iter().map(|mark| mark.1).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn fitted_ends_have_a_margin() {
        let of = |scale, values: &[f64]| fitted_ends(&axis(scale, None), values.iter().copied()).unwrap();
        assert_eq!(of(Scale::Linear, &[0.0, 100.0]), [-4.0, 104.0]);
        assert_eq!(of(Scale::Linear, &[1.0, 101.0]), [0.0, 105.0]);
        assert_eq!(of(Scale::Linear, &[0.0]), [-1.0, 1.0]);
        assert_eq!(of(Scale::Linear, &[-20.0, -20.0]), [-22.0, -18.0]);
        let [low, high] = of(Scale::Logarithmic, &[1e-14, 1.0]).map(f64::log10);
        assert!((low + 14.56).abs() < 1e-9 && (high - 0.56).abs() < 1e-9);
        assert!(fitted_ends(&axis(Scale::Linear, None), [-1e308, 1e308].into_iter()).is_err());
    }

    #[test]
    fn numbers_on_an_axis_are_short_and_round() {
        let linear = |limits| labels(Scale::Linear, limits);
        assert_eq!(linear([0.0, 1.0]), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(linear([-12.0, 12.0]), ["−10", "−5", "0", "5", "10"]);
        assert_eq!(linear([0.0, 2.5e-9]), ["0", "0.5×10⁻⁹", "1×10⁻⁹", "1.5×10⁻⁹", "2×10⁻⁹", "2.5×10⁻⁹"]);
        assert_eq!(linear([0.0, 4e6]), ["0", "1×10⁶", "2×10⁶", "3×10⁶", "4×10⁶"]);
        let logarithmic = |limits| labels(Scale::Logarithmic, limits);
        let short =
            AxisRange::new(&axis(Scale::Logarithmic, Some([22.0, 380.0])), std::iter::empty()).unwrap();
        let short = short.tick_marks(3.0, |_| 1.0).into_iter().map(|mark| mark.1);
        assert_eq!(short.filter(|label| !label.is_empty()).collect::<Vec<_>>(), ["30", "100", "300"]);
        assert_eq!(logarithmic([0.01, 1e3]), ["0.01", "0.1", "1", "10", "100", "1000"]);
        assert_eq!(logarithmic([1e-5, 1.0]), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "1"]);
        assert_eq!(logarithmic([1e6, 5e7]), ["10⁶", "2×10⁶", "5×10⁶", "10⁷", "2×10⁷", "5×10⁷"]);
        assert_eq!(logarithmic([1.0, 20.0]), ["1", "2", "5", "10", "20"]);
        // With many decades every third has a label.
        assert_eq!(logarithmic([1e-16, 1.0]), ["10⁻¹⁵", "10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "1"]);
    }

    #[test]
    fn unresolved_ends_have_no_marks() {
        for limits in [[0.0, 5e-324], [1e300, 1.000_000_000_000_001e300], [-1e308, 1e-308]] {
            assert!(labels(Scale::Linear, limits).len() < 9, "{limits:?}");
        }
    }

    /// A margin beyond 1e-305 and 1e305 would give 0 and infinity.
    #[test]
    fn fitted_ends_are_finite() {
        let of = |scale, data: [f64; 2]| AxisRange::new(&axis(scale, None), data.into_iter());
        let wide = of(Scale::Logarithmic, [1e-305, 1e305]).unwrap();
        assert!(wide.ends[0] > 0.0 && wide.ends[1].is_finite(), "{wide:?}");
        assert!(!wide.tick_marks(10.0, |_| 1.0).is_empty());
        assert!(of(Scale::Linear, [-8.9e307, 8.9e307]).is_err());
    }

    #[test]
    fn few_decades_have_linear_marks() {
        assert_eq!(labels(Scale::Logarithmic, [1.0, 1.8]), ["1", "1.2", "1.4", "1.6", "1.8"]);
    }

    #[test]
    fn there_are_small_marks_between_numbers() {
        let span = AxisRange::new(&axis(Scale::Linear, Some([0.0, 1.0])), std::iter::empty()).unwrap();
        assert_eq!(span.tick_marks(6.0, |_| 1.0).len(), 21);
        let span =
            AxisRange::new(&axis(Scale::Logarithmic, Some([1.0, 1000.0])), std::iter::empty()).unwrap();
        assert_eq!(span.tick_marks(3.0, |_| 1.0).len(), 28);
    }
}
