//! Numbers as people read them.

/// A number with so many significant digits, without zeros at the end; with an exponent only where it is below a thousandth or
/// has more than six digits before the point.
pub fn significant(value: f64, digits: usize) -> String {
    let last = digits.saturating_sub(1);
    let scientific = format!("{value:.last$e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    let Ok(exponent) = exponent.parse::<i32>() else { return scientific };
    if value != 0.0 && !(-3..=6).contains(&exponent) {
        return format!("{}e{exponent}", trimmed(mantissa));
    }
    let decimals = (last as i32 - exponent).max(0) as usize;
    trimmed(&format!("{value:.decimals$}")).to_owned()
}

/// Without zeros behind the last digit of a fraction.
fn trimmed(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_stand_only_where_they_are_shorter() {
        for (value, digits, text) in [
            (0.57914, 4, "0.5791"),
            (1.07, 4, "1.07"),
            (3180.4, 4, "3180"),
            (123456.7, 3, "123457"),
            (2e9, 5, "2e9"),
            (1.05264e-4, 5, "1.0526e-4"),
            (0.0, 3, "0"),
            (-0.0123, 2, "-0.012"),
            (1.0, 5, "1"),
            (9.9999, 3, "10"),
            (f64::INFINITY, 3, "inf"),
            (f64::NAN, 3, "NaN"),
        ] {
            assert_eq!(significant(value, digits), text);
        }
    }
}
