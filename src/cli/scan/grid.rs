//! Keys of a scan with their values, and the points of their grid.

use std::collections::BTreeSet;
use stripmine_physics::scene::{MistakeKind, SceneError, SceneErrors, Spot};
use toml::Value;

/// Largest number of points.
const MOST_POINTS: usize = 10_000;
/// Significant digits of the values of a range, so that 0.1 + 2·0.1 is 0.3.
const DIGITS: usize = 12;
/// Longest name of a folder (characters), without its number.
const LONGEST_NAME: usize = 120;

/// Key of a scan with its values as texts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScanKey {
    /// Section and name, as `--set` takes them.
    pub(super) path: String,
    values: Vec<String>,
}

/// Point of a grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScanPoint {
    /// Name of its folder.
    pub(super) name: String,
    /// Override of each key.
    pub(super) overrides: Vec<String>,
    /// Value of each key.
    pub(super) values: Vec<Value>,
}

/// Parses the options `--over`.
///
/// # Errors
/// Every mistake of all of them.
pub(super) fn scan_keys(options: &[String]) -> Result<Vec<ScanKey>, SceneErrors> {
    let (mut keys, mut mistakes): (Vec<ScanKey>, Vec<SceneError>) = (vec![], vec![]);
    for option in options {
        match scan_key(option) {
            Ok(key) if keys.iter().any(|known| known.path == key.path) => {
                let message = format!("the key `{}` is given twice", key.path);
                mistakes.push(mistake(option, message, "each key once, with all its values"));
            }
            Ok(key) => keys.push(key),
            Err(error) => mistakes.push(error),
        }
    }
    let count = keys.iter().try_fold(1_usize, |count, key| count.checked_mul(key.values.len()));
    if count.is_none_or(|count| count > MOST_POINTS) {
        let message = format!("the grid of {} has more than {MOST_POINTS} points", options.join(" and "));
        mistakes.push(mistake(&options.join(" "), message, "fewer values"));
    }
    SceneErrors::ok_if_empty(mistakes).map(|()| keys)
}

fn mistake(option: &str, message: String, expected: &str) -> SceneError {
    let spot = Spot { file: format!("--over {option}"), place: None };
    SceneError { expected: Some(expected.to_owned()), ..spot.error(MistakeKind::Override, message) }
}

fn scan_key(option: &str) -> Result<ScanKey, SceneError> {
    const FORM: &str = "section.key=a,b,c or section.key=a:b:n";
    let Some((path, list)) = option.split_once('=') else {
        return Err(mistake(option, "a scan needs a key and its values".to_owned(), FORM));
    };
    let path = path.trim().to_owned();
    if list.trim().is_empty() {
        return Err(mistake(option, format!("`{path}` has no values"), FORM));
    }
    let mut values: Vec<String> = vec![];
    for item in items(list) {
        match values_of(item.trim()) {
            Ok(some) => values.extend(some),
            Err([message, expected]) => return Err(mistake(option, message, &expected)),
        }
    }
    let twice = (1..values.len()).find(|&at| values[..at].iter().any(|it| is_same(it, &values[at])));
    match twice {
        Some(at) => {
            let message = format!("`{path}` has the value {} twice", values[at]);
            Err(mistake(option, message, "each value once"))
        }
        None => Ok(ScanKey { path, values }),
    }
}

/// Splits a list at commas outside brackets and quotes.
fn items(list: &str) -> Vec<&str> {
    let (mut depth, mut quote, mut from, mut items) = (0_i32, None, 0, vec![]);
    for (at, c) in list.char_indices() {
        match (quote, c) {
            (Some(open), c) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            (None, ',') if depth == 0 => {
                items.push(&list[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    items.push(&list[from..]);
    items
}

/// Values of an item: its own text, or those of a range `a:b:n`. The error has the mistake and the expectation.
fn values_of(item: &str) -> Result<Vec<String>, [String; 2]> {
    if item.is_empty() {
        return Err(["a value between two commas is empty", "a,b,c or a:b:n"].map(str::to_owned));
    }
    let parts: Vec<&str> = item.split(':').map(str::trim).collect();
    let is_range = parts.len() > 1 && !item.starts_with(['"', '\'', '[', '{']);
    // Words of a scene may have one colon: `strip:64`.
    if !is_range || parts.len() == 2 && parts[0].parse::<f64>().is_err() {
        return Ok(vec![item.to_owned()]);
    }
    let wrong = || [format!("{item} is no range"), range_form()];
    let [from, to, count] = parts[..] else { return Err(wrong()) };
    let end = |text: &str| text.parse::<f64>().ok().filter(|end| end.is_finite()).ok_or_else(wrong);
    let (from, to) = (end(from)?, end(to)?);
    let count =
        count.parse::<usize>().ok().filter(|count| (2..=MOST_POINTS).contains(count)).ok_or_else(wrong)?;
    if from == to {
        return Err(wrong());
    }
    let value = |at: usize| {
        let part = at as f64 / (count - 1) as f64;
        let value = if at + 1 == count { to } else { from + part * (to - from) };
        let digits = DIGITS - 1;
        number_text(format!("{value:.digits$e}").parse().unwrap_or(value))
    };
    Ok((0..count).map(value).collect())
}

fn range_form() -> String {
    format!("a:b:n, n points evenly from the number a to another number b, n from 2 to {MOST_POINTS}")
}

/// Shortest text of a number, without a point if it is whole.
fn number_text(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}

/// Value as a scene reads it; a word needs no quotes.
fn value(text: &str) -> Value {
    let table = format!("value = {text}").parse::<toml::Table>();
    let parsed = table.ok().filter(|table| table.len() == 1).and_then(|mut table| table.remove("value"));
    parsed.unwrap_or_else(|| Value::String(text.to_owned()))
}

fn is_same(a: &str, b: &str) -> bool {
    match [a, b].map(|text| number(&value(text))) {
        [Some(a), Some(b)] => a == b,
        _ => value(a) == value(b),
    }
}

/// Number of a value; none for other values.
pub(super) fn number(value: &Value) -> Option<f64> {
    value.as_float().or(value.as_integer().map(|number| number as f64))
}

/// Text of a value for people: words without quotes, numbers as short as possible.
pub(super) fn value_text(value: &Value) -> String {
    match (number(value), value) {
        (Some(number), _) => number_text(number),
        (None, Value::String(word)) => word.clone(),
        (None, other) => other.to_string(),
    }
}

/// Points of the grid; the values of the last key vary fastest.
pub(super) fn grid(keys: &[ScanKey]) -> Vec<ScanPoint> {
    let mut points: Vec<Vec<&str>> = vec![vec![]];
    for key in keys {
        let mut extended = vec![];
        for point in &points {
            extended.extend(key.values.iter().map(|text| [point.as_slice(), &[text.as_str()]].concat()));
        }
        points = extended;
    }
    let labels = labels(&keys.iter().map(|key| key.path.as_str()).collect::<Vec<_>>());
    let mut taken = BTreeSet::new();
    let point = |texts: Vec<&str>| {
        let values: Vec<Value> = texts.iter().map(|text| value(text)).collect();
        let parts = labels.iter().zip(&values).map(|(label, value)| format!("{label}={}", value_text(value)));
        let overrides = keys.iter().zip(texts).map(|(key, text)| format!("{}={text}", key.path)).collect();
        ScanPoint { name: folder_name(&parts.collect::<Vec<_>>().join(","), &mut taken), overrides, values }
    };
    points.into_iter().map(point).collect()
}

/// Short names of keys: without the section where that is unique.
pub(super) fn labels(paths: &[&str]) -> Vec<String> {
    let name = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
    let is_unique = |path: &str| paths.iter().filter(|other| name(other) == name(path)).count() == 1;
    paths.iter().map(|path| if is_unique(path) { name(path) } else { (*path).to_owned() }).collect()
}

/// Unique name of a folder on any file system, whatever the case of its letters.
fn folder_name(text: &str, taken: &mut BTreeSet<String>) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._+-=,".contains(c);
    let short: String = text.chars().map(|c| if is_plain(c) { c } else { '-' }).take(LONGEST_NAME).collect();
    let numbered = (2_u32..).map(|number| format!("{short}-{number}"));
    let free =
        std::iter::once(short.clone()).chain(numbered).find(|name| !taken.contains(&name.to_lowercase()));
    let free = free.unwrap_or(short);
    taken.insert(free.to_lowercase());
    free
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(options: &[&str]) -> Result<Vec<ScanKey>, SceneErrors> {
        scan_keys(&options.iter().map(|option| (*option).to_owned()).collect::<Vec<_>>())
    }

    fn values(option: &str) -> Vec<String> {
        keys(&[option]).unwrap().remove(0).values
    }

    #[test]
    fn ranges_are_even_and_include_both_ends() {
        assert_eq!(values("a.b=0.1:0.5:5"), ["0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(values("a.b=100:400:4"), ["100", "200", "300", "400"]);
        assert_eq!(values("a.b=1e-9:3e-9:3, 1"), ["1e-9", "2e-9", "3e-9", "1"]);
        assert_eq!(values("a.b=3:1:3"), ["3", "2", "1"]);
    }

    #[test]
    fn words_and_lists_are_single_values() {
        assert_eq!(values("a.b=strip:64,chained"), ["strip:64", "chained"]);
        assert_eq!(values("a.b=[1, 2],[3, 4]"), ["[1, 2]", "[3, 4]"]);
        assert_eq!(values("a.b=\"x,y\",{ a = 1, b = 2 }"), ["\"x,y\"", "{ a = 1, b = 2 }"]);
    }

    #[test]
    fn malformed_options_are_refused_by_name() {
        for (option, words) in [
            ("a.b", "a scan needs a key"),
            ("a.b=", "`a.b` has no values"),
            ("a.b=1,,2", "is empty"),
            ("a.b=1:2", "1:2 is no range"),
            ("a.b=1:2:1", "1:2:1 is no range"),
            ("a.b=1:1:3", "1:1:3 is no range"),
            ("a.b=1:2:3:4", "is no range"),
            ("a.b=1:x:3", "is no range"),
            ("a.b=1:inf:3", "is no range"),
            ("a.b=1:2:1e9", "is no range"),
            ("a.b=0.3,0.30", "the value 0.30 twice"),
            ("a.b=1,1.0", "the value 1.0 twice"),
        ] {
            let said = keys(&[option]).unwrap_err().to_string();
            assert!(said.contains(words) && said.contains(&format!("--over {option}")), "{said}");
        }
        let said = keys(&["a.b=1", "a.b=2", "c.d="]).unwrap_err().to_string();
        assert!(said.contains("`a.b` is given twice") && said.contains("`c.d` has no values"), "{said}");
        assert!(keys(&["a.b=1:2:101", "a.c=1:2:100"]).unwrap_err().to_string().contains("10000 points"));
    }

    #[test]
    fn folders_have_unique_safe_names() {
        let names = |options: &[&str]| -> Vec<String> {
            grid(&keys(options).unwrap()).into_iter().map(|point| point.name).collect()
        };
        assert_eq!(
            names(&["particles.packing_fraction=0.30,5e-1", "law.restitution=1,0.9"]),
            [
                "packing_fraction=0.3,restitution=1",
                "packing_fraction=0.3,restitution=0.9",
                "packing_fraction=0.5,restitution=1",
                "packing_fraction=0.5,restitution=0.9"
            ]
        );
        assert_eq!(names(&["a.kind=x/../y,X/../Y"]), ["kind=x-..-y", "kind=X-..-Y-2"]);
        assert_eq!(names(&["a.kind=1", "b.kind=2"]), ["a.kind=1,b.kind=2"]);
    }
}
