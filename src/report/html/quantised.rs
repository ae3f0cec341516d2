//! Compact encoding of many numbers: one or two bytes each, in base 64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// Numbers quantised between two ends. Codes from 0 to the last but one are evenly spaced from `low` to `high`; the last code is NaN.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(crate) struct Quantised {
    low: f64,
    high: f64,
    /// Bytes per code, 1 or 2.
    bytes: u32,
    /// Codes in base 64, little-endian.
    codes: String,
}

/// Highest code of a number; the next code is NaN.
fn highest(bytes: u32) -> u16 {
    (u16::MAX >> (16 - 8 * bytes)) - 1
}

impl Quantised {
    /// Encodes numbers with an error of at most 1/131 068 of their range. Infinite numbers become NaN.
    pub(super) fn of(numbers: &[f64]) -> Quantised {
        Quantised::in_bytes(numbers, 2)
    }

    /// Encodes numbers in one byte each if the error is at most `tolerance`, otherwise like [`of`](Self::of).
    pub(super) fn within(numbers: &[f64], tolerance: f64) -> Quantised {
        let [low, high] =
            ends(numbers.iter().copied().filter(|number| number.is_finite())).unwrap_or_default();
        let step = (high - low) / f64::from(highest(1));
        Quantised::in_bytes(numbers, if 0.5 * step <= tolerance { 1 } else { 2 })
    }

    fn in_bytes(numbers: &[f64], bytes: u32) -> Quantised {
        let finite = || numbers.iter().copied().filter(|number| number.is_finite());
        let [low, high] = ends(finite()).unwrap_or([0.0, 1.0]);
        let width = if high > low { high - low } else { 1.0 };
        let code = |&number: &f64| match number.is_finite() {
            true => ((number - low) / width * f64::from(highest(bytes))).round() as u16,
            false => highest(bytes) + 1,
        };
        let codes =
            numbers.iter().map(code).flat_map(|code| code.to_le_bytes().into_iter().take(bytes as usize));
        Quantised { low, high: low + width, bytes, codes: STANDARD.encode(codes.collect::<Vec<u8>>()) }
    }
}

/// Smallest and largest number; `None` without numbers.
fn ends(numbers: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    numbers.fold(None, |ends, number| match ends {
        None => Some([number; 2]),
        Some([low, high]) => Some([low.min(number), high.max(number)]),
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Decodes numbers like `numbers` in `strips.js`.
    pub(crate) fn read(quantised: &Quantised) -> Vec<f64> {
        let Quantised { low, high, bytes, codes } = quantised;
        let codes = STANDARD.decode(codes).unwrap();
        let whole = |code: &[u8]| code.iter().rev().fold(0, |code, &byte| 256 * code + u16::from(byte));
        let number = |code| low + f64::from(code) / f64::from(highest(*bytes)) * (high - low);
        let read = |code| if code > highest(*bytes) { f64::NAN } else { number(code) };
        codes.chunks_exact(*bytes as usize).map(whole).map(read).collect()
    }

    #[test]
    fn numbers_are_recovered_within_half_a_step() {
        let numbers: Vec<f64> = (0..1000).map(|i| f64::from(i).sin() * 8.1 - 3.0).collect();
        let back = read(&Quantised::of(&numbers));
        let step = 2.0 * 8.1 / 65534.0;
        for (number, back) in numbers.iter().zip(back) {
            assert!((number - back).abs() <= 0.5001 * step, "{number} became {back}");
        }
    }

    #[test]
    fn one_byte_is_used_if_sufficient() {
        let numbers: Vec<f64> = (0..=254).map(f64::from).chain([f64::NAN]).collect();
        for (tolerance, bytes) in [(0.5, 1), (0.49, 2)] {
            let quantised = Quantised::within(&numbers, tolerance);
            assert_eq!(quantised.bytes, bytes);
            let back = read(&quantised);
            assert!(
                numbers.iter().zip(&back).take(255).all(|(number, back)| (number - back).abs() <= tolerance)
            );
            assert!(back[255].is_nan());
        }
    }

    #[test]
    fn ends_are_exact_and_nan_is_preserved() {
        let back = read(&Quantised::of(&[2.5, f64::NAN, -1.25, f64::INFINITY]));
        assert_eq!((back[0], back[2]), (2.5, -1.25));
        assert!(back[1].is_nan() && back[3].is_nan());
    }

    #[test]
    fn equal_numbers_and_empty_input_are_encoded() {
        assert_eq!(read(&Quantised::of(&[7.0, 7.0])), [7.0, 7.0]);
        assert!(read(&Quantised::of(&[])).is_empty());
        assert!(read(&Quantised::of(&[f64::NAN]))[0].is_nan());
    }
}
