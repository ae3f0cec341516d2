//! Numbers formatted for people.

/// Formats a number with a number of significant digits, without trailing zeros. It has an exponent only below a thousandth or with more than seven
/// digits before the point.
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

/// Formats a mean with the half-width of its confidence interval, which has two digits: `0.675 ± 0.060`.
pub fn with_error_bar(mean: f64, bar: f64) -> String {
    let scientific = format!("{bar:.1e}");
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    let Some(exponent) = exponent.filter(|_| bar > 0.0 && bar.is_finite()) else {
        return format!("{} ± {}", significant(mean, 6), significant(bar, 2));
    };
    let magnitude = mean.abs().max(bar);
    if (1e-3..1e7).contains(&magnitude) {
        let decimals = (1 - exponent).max(0) as usize;
        return format!("{mean:.decimals$} ± {bar:.decimals$}");
    }
    // Both are in units of the larger one's power of ten.
    let power = libm::floor(libm::log10(magnitude)) as i32;
    let unit = 10f64.powi(power);
    let decimals = (power + 1 - exponent).max(0) as usize;
    format!("({:.decimals$} ± {:.decimals$})e{power}", mean / unit, bar / unit)
}

/// Formats a number for sentences, with a number of significant digits: `8.2·10⁻⁸` where it is small or large.
pub fn with_power_of_ten(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let Ok(exponent) = exponent.parse() else { return text };
    match mantissa {
        "1" => power_of_ten(exponent),
        mantissa => format!("{mantissa}·{}", power_of_ten(exponent)),
    }
}

/// Formats the range of some numbers for sentences; one number if both ends agree in these digits.
pub fn range(values: impl IntoIterator<Item = f64>, digits: usize) -> String {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let [Some(low), Some(high)] =
        [values.first(), values.last()].map(|end| end.map(|end| with_power_of_ten(*end, digits)))
    else {
        return "nothing".to_owned();
    };
    if low == high { low } else { format!("{low} to {high}") }
}

/// Formats a count with its noun: `1 scene`, `3 scenes`.
pub fn count_with_noun(count: impl std::fmt::Display, one: &str, many: &str) -> String {
    let count = count.to_string();
    format!("{count} {}", if count == "1" { one } else { many })
}

/// Formats a number in parts of its limit, or as a multiple of it, for "the limit" to follow: `8.04 % of`, `18 times`.
pub fn of_limit(share: f64) -> String {
    match share > 1.0 {
        true => format!("{} times", significant(share, 3)),
        false => format!("{} % of", significant(100.0 * share, 3)),
    }
}

/// Formats a power of ten.
pub fn power_of_ten(power: i32) -> String {
    match power {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        _ => {
            let raised = |digit: char| match digit.to_digit(10) {
                Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
                None => '⁻',
            };
            format!("10{}", power.to_string().chars().map(raised).collect::<String>())
        }
    }
}

/// Number without trailing zeros of its fraction.
fn trimmed(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_rise_and_words_have_their_number() {
        assert_eq!(range([3.3e-6, 2.7e-6], 2), "2.7·10⁻⁶ to 3.3·10⁻⁶");
        assert_eq!(range([0.1201, 0.1204], 2), "0.12");
        assert_eq!(range([], 2), "nothing");
        assert_eq!([1, 3].map(|count| count_with_noun(count, "run", "runs")), ["1 run", "3 runs"]);
    }

    #[test]
    fn numbers_above_a_limit_are_multiples() {
        assert_eq!([0.0804, 1.0, 18.04].map(of_limit), ["8.04 % of", "100 % of", "18 times"]);
    }

    #[test]
    fn sentences_have_powers_of_ten() {
        let texts = [8.2e-8, 1e-12, 0.25, 3e9].map(|value| with_power_of_ten(value, 2));
        assert_eq!(texts, ["8.2·10⁻⁸", "10⁻¹²", "0.25", "3·10⁹"]);
    }

    #[test]
    fn error_bars_have_two_digits() {
        for (mean, bar, text) in [
            (0.6749, 0.0601, "0.675 ± 0.060"),
            (1234.56, 78.9, "1235 ± 79"),
            (-3.0, 0.25, "-3.00 ± 0.25"),
            (0.001, 2.0, "0.0 ± 2.0"),
            (6.3412e-5, 1.2e-6, "(6.34 ± 0.12)e-5"),
            (2.5e9, 3.1e7, "(2.500 ± 0.031)e9"),
            (1.5, 0.0, "1.5 ± 0"),
            (1.5, f64::INFINITY, "1.5 ± inf"),
        ] {
            assert_eq!(with_error_bar(mean, bar), text);
        }
    }

    #[test]
    fn exponents_appear_only_where_shorter() {
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
