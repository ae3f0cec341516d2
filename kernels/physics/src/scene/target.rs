//! Target errors of means.

use crate::number::significant;

/// Target error of the mean of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanTarget {
    /// Name of the quantity.
    pub quantity: String,
    /// Half-width of the 95 % confidence interval.
    pub error: Width,
}

/// Half-width of a confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Width {
    /// Percentage of the mean.
    Percent(f64),
    /// Value in the unit of the quantity.
    Absolute(f64),
}

impl Width {
    /// Parses a text such as `0.1%`, or a number; none if it is neither, or not above 0.
    pub fn parse(text: &str) -> Option<Width> {
        let (number, of): (&str, fn(f64) -> Width) = match text.strip_suffix('%') {
            Some(number) => (number, Width::Percent),
            None => (text, Width::Absolute),
        };
        let value: f64 = number.trim().parse().ok()?;
        (value.is_finite() && value > 0.0).then(|| of(value))
    }

    /// True if a half-width is at most this one.
    pub(crate) fn admits_half_width(self, mean: f64, bar: f64) -> bool {
        match self {
            Width::Percent(percent) => bar <= 0.01 * percent * mean.abs(),
            Width::Absolute(width) => bar <= width,
        }
    }

    /// Half-width in the same terms.
    pub(crate) fn in_same_terms(self, mean: f64, bar: f64) -> Width {
        match self {
            Width::Percent(_) => Width::Percent(100.0 * bar / mean.abs()),
            Width::Absolute(_) => Width::Absolute(bar),
        }
    }
}

impl std::fmt::Display for Width {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Width::Percent(percent) => write!(f, "{} %", significant(*percent, 2)),
            Width::Absolute(width) => f.write_str(&significant(*width, 2)),
        }
    }
}

impl MeanTarget {
    /// Text in TOML, in the shortest form that reads back to the same bits.
    pub fn to_toml(&self) -> String {
        let error = match self.error {
            Width::Percent(percent) => format!("\"{percent:?}%\""),
            Width::Absolute(width) => format!("{width:?}"),
        };
        format!("{{ quantity = {}, error = {error} }}", toml::Value::String(self.quantity.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_absolute_or_parts_of_the_mean() {
        assert_eq!(
            ["0.1%", " 2 %", "0.5"].map(Width::parse),
            [Width::Percent(0.1), Width::Percent(2.0), Width::Absolute(0.5)].map(Some)
        );
        assert!(["0%", "-1%", "nan%", "inf", "", "%"].iter().all(|text| Width::parse(text).is_none()));
        assert!(
            Width::Percent(1.0).admits_half_width(-4.0, 0.04)
                && !Width::Percent(1.0).admits_half_width(4.0, 0.05)
        );
        assert!(
            Width::Absolute(0.1).admits_half_width(4.0, 0.1)
                && !Width::Absolute(0.1).admits_half_width(4.0, 0.2)
        );
    }
}
