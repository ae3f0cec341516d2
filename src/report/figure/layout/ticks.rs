//! Where an axis is marked, and with what.

use super::super::Scale;

/// A mark on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Its value, or the logarithm of it on a logarithmic axis.
    pub at: f64,
    /// What is written there; none for a small mark between others.
    pub label: Option<String>,
}

/// Marks between two ends, in what the axis' ruler measures in; at most one label more than `most`.
pub fn ticks(scale: Scale, ends: [f64; 2], most: usize) -> Vec<Tick> {
    match scale {
        Scale::Linear => linear(ends, most),
        Scale::Logarithmic => logarithmic(ends, most),
    }
}

/// What counts as on the axis beyond its end, in steps between marks.
const SLACK: f64 = 1e-9;

/// Steps of 1, 2 or 5 times a power of ten.
fn linear([low, high]: [f64; 2], most: usize) -> Vec<Tick> {
    let least = (high - low) / most as f64;
    if least == 0.0 {
        return Vec::new();
    }
    let power = libm::log10(least).floor() as i32;
    let factor = [1, 2, 5].into_iter().find(|&factor| steps(factor, power) >= least * (1.0 - SLACK));
    let (factor, power) = factor.map_or((1, power + 1), |factor| (factor, power));
    let step = steps(factor, power);
    let [first, last] = [(low / step - SLACK).ceil(), (high / step + SLACK).floor()];
    // Beyond this, neighbouring steps are the same number.
    if first.is_nan() || last.is_nan() || first.abs().max(last.abs()) > 1e15 {
        return Vec::new();
    }
    let largest = low.abs().max(high.abs());
    (first as i64..=last as i64)
        .map(|i| Tick { at: steps(i * factor, power), label: Some(number(i * factor, power, largest)) })
        .collect()
}

/// Decades; some of them where there are many, parts of them where there are few.
fn logarithmic([low, high]: [f64; 2], most: usize) -> Vec<Tick> {
    let [first, last] = [(low - SLACK).ceil() as i32, (high + SLACK).floor() as i32];
    let decades = first..=last;
    // Powers of ten are spelled out only where none of them is long.
    let spelled_out = low >= -2.0 - SLACK && high <= 4.0 - SLACK;
    if high - low < 0.7 {
        let values = linear([low, high].map(|end| libm::pow(10.0, end)), most);
        return values.into_iter().map(|tick| Tick { at: libm::log10(tick.at), ..tick }).collect();
    }
    let inside = |at: f64| (low - SLACK..=high + SLACK).contains(&at);
    let multiples = |labelled: &[i64]| -> Vec<Tick> {
        let all = (first - 1..=last).flat_map(|power| (1..10).map(move |factor| (factor, power)));
        all.map(|(factor, power)| Tick {
            at: f64::from(power) + libm::log10(factor as f64),
            label: labelled.contains(&factor).then(|| decimal(factor, power, spelled_out)),
        })
        .filter(|tick| inside(tick.at))
        .collect()
    };
    let labels = |ticks: &[Tick]| ticks.iter().filter(|tick| tick.label.is_some()).count();
    let by_decades = decades.clone().count() >= 3;
    for labelled in [[1, 2, 5].as_slice(), &[1, 3], &[1]] {
        let ticks = multiples(labelled);
        if (!by_decades || labelled.len() == 1) && labels(&ticks) <= most + 1 {
            return ticks;
        }
    }
    let stride = [2, 3, 4, 5, 10, 20, 50].into_iter().find(|&stride| count_of(&decades, stride) <= most + 1);
    let stride = stride.unwrap_or(100);
    decades
        .map(|power| Tick {
            at: f64::from(power),
            label: (power.rem_euclid(stride) == 0).then(|| decimal(1, power, spelled_out)),
        })
        .collect()
}

fn count_of(decades: &std::ops::RangeInclusive<i32>, stride: i32) -> usize {
    decades.clone().filter(|power| power.rem_euclid(stride) == 0).count()
}

/// A multiple of a power of ten.
fn steps(count: i64, power: i32) -> f64 {
    let size = libm::pow(10.0, f64::from(power.abs()));
    if power < 0 { count as f64 / size } else { count as f64 * size }
}

/// A number on a linear axis whose largest is known: spelled out where that is short, otherwise all numbers of the
/// axis with the same power of ten.
fn number(digits: i64, power: i32, largest: f64) -> String {
    if (1e-3..1e6).contains(&largest) {
        return spelled(digits, power);
    }
    if digits == 0 {
        return "0".to_owned();
    }
    let common = libm::log10(largest).floor() as i32;
    format!("{}×{}", spelled(digits, power - common), ten_to(common))
}

/// A number on a logarithmic axis.
fn decimal(factor: i64, power: i32, spelled_out: bool) -> String {
    match (factor, power) {
        _ if spelled_out => spelled(factor, power),
        (1, power) => ten_to(power),
        (factor, 0 | 1) => spelled(factor, power),
        (factor, power) => format!("{factor}×{}", ten_to(power)),
    }
}

/// Digits times a power of ten, without a power.
fn spelled(digits: i64, power: i32) -> String {
    let sign = if digits < 0 { "−" } else { "" };
    let digits = digits.unsigned_abs();
    if power >= 0 {
        let zeros = if digits == 0 { 0 } else { power as usize };
        return format!("{sign}{digits}{}", "0".repeat(zeros));
    }
    let decimals = power.unsigned_abs() as usize;
    let text = format!("{digits:0width$}", width = decimals + 1);
    let (whole, part) = text.split_at(text.len() - decimals);
    format!("{sign}{whole}.{part}")
}

/// A power of ten in short.
fn ten_to(power: i32) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, ends: [f64; 2], most: usize) -> Vec<String> {
        ticks(scale, ends, most).into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn linear_steps_are_one_two_or_five() {
        let of = |ends| labels(Scale::Linear, ends, 5);
        assert_eq!(of([0.0, 1.0]), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(of([-3.0, 104.0]), ["0", "50", "100"]);
        assert_eq!(of([-12.0, 12.0]), ["−10", "−5", "0", "5", "10"]);
        assert_eq!(of([1.0, 1.00004]), ["1.00000", "1.00001", "1.00002", "1.00003", "1.00004"]);
        assert_eq!(of([0.0, 2.5e-9]), ["0", "0.5×10⁻⁹", "1.0×10⁻⁹", "1.5×10⁻⁹", "2.0×10⁻⁹", "2.5×10⁻⁹"]);
        assert_eq!(of([0.0, 4e6]), ["0", "1×10⁶", "2×10⁶", "3×10⁶", "4×10⁶"]);
        assert_eq!(ticks(Scale::Linear, [0.0, 1.0], 5)[3].at, 0.6);
    }

    #[test]
    fn decades_are_marked_as_powers() {
        let of = |ends, most| labels(Scale::Logarithmic, ends, most);
        assert_eq!(of([-3.2, 1.4], 6), ["10⁻³", "10⁻²", "10⁻¹", "1", "10"]);
        assert_eq!(of([0.0, 3.0], 6), ["1", "10", "100", "1000"]);
        assert_eq!(of([-14.5, 0.5], 5), ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "1"]);
        assert_eq!(of([0.0, 1.2], 6), ["1", "2", "5", "10"]);
        assert_eq!(of([6.0, 7.2], 6), ["10⁶", "2×10⁶", "5×10⁶", "10⁷"]);
        assert_eq!(of([0.0, 0.25], 4), ["1.0", "1.2", "1.4", "1.6"]);
    }

    #[test]
    fn small_marks_stand_between_decades() {
        let ticks = ticks(Scale::Logarithmic, [-14.0, -11.0], 5);
        assert_eq!(ticks.len(), 28);
        let two = ticks.iter().find(|tick| tick.at > -14.0).unwrap();
        assert!((two.at + 13.698_970_004).abs() < 1e-9 && two.label.is_none());
    }

    #[test]
    fn any_axis_has_few_labels_and_none_outside() {
        for power in -300..300 {
            for (low, high) in [(0.0, 1.0), (0.13, 7.7), (-2.0, 5.5), (99.9, 100.0)] {
                let ends = [low, high].map(|end: f64| end * libm::pow(10.0, f64::from(power)));
                for most in 1..8 {
                    let ticks = linear(ends, most);
                    assert!(ticks.len() <= most + 1, "{ends:?} {most}");
                    let slack = (ends[1] - ends[0]) * 1e-6;
                    assert!(ticks.iter().all(|tick| tick.at > ends[0] - slack && tick.at < ends[1] + slack));
                }
            }
        }
        for ends in [[-320.0, 300.0], [1e15, 1e15 + 2.0], [5e-324, 1e-323]] {
            assert!(
                linear(ends, 5).len() <= 6 && logarithmic([-320.0, ends[1].min(308.0)], 5).len() < 10_000
            );
        }
    }
}
