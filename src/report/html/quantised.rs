//! Many numbers in few letters: 16 bits each, in base 64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// The highest code; the numbers lie evenly between 0 and it.
const HIGHEST: u16 = u16::MAX - 1;
/// The code of what is no number.
const MISSING: u16 = u16::MAX;

/// Numbers between two ends: code `c` stands for `low + c / 65534 · (high − low)`, code 65535 for no number.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub struct Quantised {
    low: f64,
    high: f64,
    /// Two bytes each, the low one first.
    codes: String,
}

impl Quantised {
    /// The numbers, each off by no more than a 131 068th of their range. What is not finite becomes no number.
    pub fn of(numbers: &[f64]) -> Quantised {
        let finite = || numbers.iter().copied().filter(|number| number.is_finite());
        let [low, high] = ends(finite()).unwrap_or([0.0, 1.0]);
        let width = if high > low { high - low } else { 1.0 };
        let code = |&number: &f64| match number.is_finite() {
            true => ((number - low) / width * f64::from(HIGHEST)).round() as u16,
            false => MISSING,
        };
        let bytes: Vec<u8> = numbers.iter().map(code).flat_map(u16::to_le_bytes).collect();
        Quantised { low, high: low + width, codes: STANDARD.encode(bytes) }
    }
}

/// The lowest and the highest of some numbers; none if there are none.
pub fn ends(numbers: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    numbers.fold(None, |ends, number| match ends {
        None => Some([number; 2]),
        Some([low, high]) => Some([low.min(number), high.max(number)]),
    })
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// What the scripts read: the twin of `numbers` in `page.js`.
    pub fn read(quantised: &Quantised) -> Vec<f64> {
        let Quantised { low, high, codes } = quantised;
        let bytes = STANDARD.decode(codes).unwrap();
        let codes = bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
        let number = |code| low + f64::from(code) / f64::from(HIGHEST) * (high - low);
        codes.map(|code| if code == MISSING { f64::NAN } else { number(code) }).collect()
    }

    #[test]
    fn numbers_come_back_within_half_a_step() {
        let numbers: Vec<f64> = (0..1000).map(|i| f64::from(i).sin() * 8.1 - 3.0).collect();
        let back = read(&Quantised::of(&numbers));
        let step = 2.0 * 8.1 / 65534.0;
        for (number, back) in numbers.iter().zip(back) {
            assert!((number - back).abs() <= 0.5001 * step, "{number} became {back}");
        }
    }

    #[test]
    fn ends_are_kept_and_what_is_no_number_stays_none() {
        let back = read(&Quantised::of(&[2.5, f64::NAN, -1.25, f64::INFINITY]));
        assert_eq!((back[0], back[2]), (2.5, -1.25));
        assert!(back[1].is_nan() && back[3].is_nan());
    }

    #[test]
    fn equal_numbers_and_none_at_all_are_no_trouble() {
        assert_eq!(read(&Quantised::of(&[7.0, 7.0])), [7.0, 7.0]);
        assert!(read(&Quantised::of(&[])).is_empty());
        assert!(read(&Quantised::of(&[f64::NAN]))[0].is_nan());
    }
}
