//! From numbers to pixels.

use super::super::{Axis, Fault, Scale};

/// Part of an axis' length that is left free at each of its ends when they are taken from the data.
const FREE: f64 = 0.04;

/// An axis laid along pixels. What it measures in is the value, or the decimal logarithm of the value.
#[derive(Clone, Debug)]
pub struct Ruler {
    scale: Scale,
    ends: [f64; 2],
    pixels: [f64; 2],
}

impl Ruler {
    /// Lays an axis between two pixels.
    pub fn new(scale: Scale, ends: [f64; 2], pixels: [f64; 2]) -> Ruler {
        Ruler { scale, ends, pixels }
    }

    /// The pixel of a value.
    pub fn place(&self, value: f64) -> f64 {
        self.pixel(measure(self.scale, value))
    }

    /// The pixel of a value, or of its logarithm on a logarithmic axis.
    pub fn pixel(&self, measure: f64) -> f64 {
        let part = (measure - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.pixels[0] + part * (self.pixels[1] - self.pixels[0])
    }

    /// The pixels it is laid between.
    pub fn pixels(&self) -> [f64; 2] {
        self.pixels
    }
}

/// A value, or its logarithm: what a ruler measures in.
pub fn measure(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear => value,
        Scale::Logarithmic => libm::log10(value),
    }
}

/// The ends of an axis in what its ruler measures in: its limits, or those of the data and a little more.
pub fn ends(axis: &Axis, values: impl Iterator<Item = f64>) -> Result<[f64; 2], Fault> {
    let of = |value| measure(axis.scale, value);
    if let Some(limits) = axis.limits {
        return Ok(limits.map(of));
    }
    let [low, high] = values
        .map(of)
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
    // A quantity that is positive keeps a positive axis.
    let positive = axis.scale == Scale::Linear && low > 0.0;
    Ok([if positive { (low - free).max(0.0) } else { low - free }, high + free])
}

/// The ends of an axis in the data's own numbers: its limits, or those of the data and a little more.
///
/// # Errors
/// [`Fault`] if there is no data.
pub fn data_ends(axis: &Axis, values: impl Iterator<Item = f64>) -> Result<[f64; 2], Fault> {
    if let Some(limits) = axis.limits {
        return Ok(limits);
    }
    Ok(ends(axis, values)?.map(|end| match axis.scale {
        Scale::Linear => end,
        Scale::Logarithmic => libm::pow(10.0, end),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(scale: Scale) -> Axis {
        Axis { scale, ..Axis::linear("time", Some("s")) }
    }

    #[test]
    fn a_very_small_number_lands_where_its_logarithm_is() {
        let limited = Axis { limits: Some([1e-16, 1e-6]), ..axis(Scale::Logarithmic) };
        let ruler =
            Ruler::new(Scale::Logarithmic, ends(&limited, std::iter::empty()).unwrap(), [100.0, 1100.0]);
        for (value, pixel) in
            [(1e-16, 100.0), (1e-14, 300.0), (1e-10, 700.0), (3e-9, 847.712_125), (1e-6, 1100.0)]
        {
            assert!((ruler.place(value) - pixel).abs() < 1e-6, "{value}: {}", ruler.place(value));
        }
    }

    #[test]
    fn ends_leave_some_room() {
        let of = |scale, values: &[f64]| ends(&axis(scale), values.iter().copied()).unwrap();
        assert_eq!(of(Scale::Linear, &[0.0, 100.0]), [-4.0, 104.0]);
        assert_eq!(of(Scale::Linear, &[1.0, 101.0]), [0.0, 105.0]);
        assert_eq!(of(Scale::Linear, &[0.0]), [-1.0, 1.0]);
        assert_eq!(of(Scale::Linear, &[-20.0, -20.0]), [-22.0, -18.0]);
        let [low, high] = of(Scale::Logarithmic, &[1e-14, 1.0]);
        assert!((low + 14.56).abs() < 1e-9 && (high - 0.56).abs() < 1e-9);
        assert!(ends(&axis(Scale::Linear), [-1e308, 1e308].into_iter()).is_err());
    }
}
