//! Shortened messages and numbers, as studies quote them.

use stripmine_physics::number::significant;

/// Significant digits of a number in a quoted message.
const DIGITS: usize = 4;

/// Returns the first line of a failure message, with shortened numbers and without its advice.
pub(crate) fn first_line(message: &str) -> String {
    shortened(message.lines().next().unwrap_or_default())
}

/// Rounds a number to the digits it is printed with.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    significant(value, digits).parse().unwrap_or(value)
}

/// Shortens the decimal numbers of a text to four significant digits. Whole numbers (steps, discs) and versions stay.
fn shortened(text: &str) -> String {
    let mut short = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(|it: char| it.is_ascii_digit()) {
        // A number ends at the first character that is neither a digit nor a point.
        let length = number_length(&rest[at..]);
        let (before, number) = (&rest[..at], &rest[at..at + length]);
        let is_part_of_a_name = before.ends_with(|it: char| it.is_alphanumeric() || it == '_');
        short.push_str(before);
        match number.parse::<f64>() {
            Ok(value) if is_long(number) && !is_part_of_a_name => short.push_str(&significant(value, DIGITS)),
            _ => short.push_str(number),
        }
        rest = &rest[at + length..];
    }
    short + rest
}

/// Length in bytes of the number at the beginning of a text, with its exponent.
fn number_length(text: &str) -> usize {
    let digits = |text: &str| text.find(|it: char| !it.is_ascii_digit() && it != '.').unwrap_or(text.len());
    // A point that ends a sentence does not belong to the number.
    let length = text[..digits(text)].trim_end_matches('.').len();
    let Some(exponent) = text[length..].strip_prefix('e') else { return length };
    let sign = usize::from(exponent.starts_with(['-', '+']));
    match digits(&exponent[sign..]) {
        0 => length,
        more => length + 1 + sign + exponent[sign..][..more].trim_end_matches('.').len(),
    }
}

fn is_long(number: &str) -> bool {
    let mantissa = number.split('e').next().unwrap_or_default();
    let digits = mantissa.chars().filter(char::is_ascii_digit).collect::<String>();
    mantissa.contains('.') && digits.trim_start_matches('0').len() > DIGITS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_numbers_have_four_digits() {
        for (message, line) in [
            (
                "disc 14 at (4.525396839, 1.860290058) with velocity (-0.89126, -16.263) is gone\n  help: lower dt",
                "disc 14 at (4.525, 1.86) with velocity (-0.8913, -16.26) is gone",
            ),
            ("step 140600: moved farther than 0.007846018.", "step 140600: moved farther than 0.007846."),
            ("1.2345678e-12 and 1234567.25, 5×5", "1.235e-12 and 1234567, 5×5"),
            ("stripmine 0.2.0 at 1.2800 of x1.23456", "stripmine 0.2.0 at 1.28 of x1.23456"),
            ("ends with 1e and 2.5e-", "ends with 1e and 2.5e-"),
            ("", ""),
        ] {
            assert_eq!(first_line(message), line);
        }
    }
}
