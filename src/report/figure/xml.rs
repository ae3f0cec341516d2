//! Words, numbers and paths as a vector picture has them: escaped, and no longer than what can be seen.

use std::fmt::Write;

/// Farther from the corner nothing is drawn (pixels); readers count in small numbers.
const FARTHEST: f64 = 1e6;

/// What can be seen of a line's place (pixels).
const SEEN: f64 = 0.05;

/// Words with the signs that mean something in XML spelled out; those it has no place for are blanks.
pub fn escaped(words: &str) -> String {
    let mut all = String::new();
    for letter in words.chars() {
        match letter {
            '&' => all.push_str("&amp;"),
            '<' => all.push_str("&lt;"),
            '>' => all.push_str("&gt;"),
            '"' => all.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => all.push(' '),
            control if control.is_control() => all.push(' '),
            other => all.push(other),
        }
    }
    all
}

/// A length to a tenth of a pixel.
pub fn tenths(pixels: f64) -> String {
    hundredths((pixels * 10.0).round() as i64 * 10)
}

/// A path through places, to a hundredth of a pixel: a reader of the page gets values back from it. One place is a line of
/// length 0, for programs draw no markers on less.
pub fn through(places: &[[f64; 2]]) -> String {
    let whole = |pixels: f64| (pixels.clamp(-FARTHEST, FARTHEST) * 100.0).round() as i64;
    let mut path = String::new();
    let mut before = [0; 2];
    for (i, place) in places.iter().enumerate() {
        let here = place.map(whole);
        let [right, down] = [0, 1].map(|side| hundredths(here[side] - before[side]));
        // After the first place, each is a step from the one before it.
        path.push_str(["M", "l", " "][i.min(2)]);
        let between = if down.starts_with('-') { "" } else { " " };
        let _ = write!(path, "{right}{between}{down}");
        before = here;
    }
    if places.len() == 1 {
        path.push_str("l0 0");
    }
    path
}

/// The places of a line without those that its straight pieces pass by no farther than can be seen.
pub fn bends(places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [first, .., last] = places else { return places.to_vec() };
    let [right, down] = [last[0] - first[0], last[1] - first[1]];
    let length = right.hypot(down);
    // How far a place lies from the piece between both ends; from one of them where they are the same.
    let off = |[x, y]: [f64; 2]| {
        let [x, y] = [x - first[0], y - first[1]];
        if length > 0.0 { (right * y - down * x).abs() / length } else { x.hypot(y) }
    };
    let within = &places[1..places.len() - 1];
    let farthest = (1..).zip(within).max_by(|a, b| off(*a.1).total_cmp(&off(*b.1)));
    match farthest {
        Some((at, &place)) if off(place) > SEEN || off(place).is_nan() => {
            let mut all = bends(&places[..=at]);
            all.pop();
            all.extend(bends(&places[at..]));
            all
        }
        _ => vec![*first, *last],
    }
}

/// A number of hundredths, without what says nothing.
fn hundredths(number: i64) -> String {
    let text = format!("{:.2}", number as f64 / 100.0);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match (text.strip_prefix("0."), text.strip_prefix("-0.")) {
        (Some(part), _) => format!(".{part}"),
        (_, Some(part)) => format!("-.{part}"),
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let written = [50.120000000000005, 0.0, -0.26, 500.0, 0.04].map(tenths);
        assert_eq!(written, ["50.1", "0", "-.3", "500", "0"]);
    }

    #[test]
    fn lines_keep_their_bends() {
        let straight: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i), 2.0 * f64::from(i)]).collect();
        assert_eq!(bends(&straight), [[0.0, 0.0], [8.0, 16.0]]);
        let bent = [&straight[..], &[[9.0, 0.0], [10.0, -16.0]]].concat();
        assert_eq!(bends(&bent), [[0.0, 0.0], [8.0, 16.0], [10.0, -16.0]]);
        assert_eq!(bends(&[[1.0, 1.0], [5.0, 5.0], [1.0, 1.0]]).len(), 3);
    }

    #[test]
    fn paths_go_from_place_to_place() {
        assert_eq!(through(&[[1.0, 2.0], [1.5, 1.0], [3.004, 1.25]]), "M1 2l.5-1 1.5 .25");
        assert_eq!(through(&[[1.0, 2.0]]), "M1 2l0 0");
        assert!(through(&[[1e300, 0.0]]).starts_with("M1000000 0"));
    }
}
