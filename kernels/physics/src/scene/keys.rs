//! Keys of scenes: name, type, range, unit, default and documentation.

use super::target::{MeanTarget, Width};
use crate::input::{MistakeKind, MistakeList};
use crate::quoted::quoted;
use crate::words::nearest;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeInteger, DeValue};

/// Value of a key, read and in range.
#[derive(Clone, Debug, PartialEq)]
pub enum KeyValue {
    /// A number.
    Number(f64),
    /// A whole number.
    Whole(u64),
    /// Yes or no.
    Switch(bool),
    /// One of the words to choose from, or free text.
    Word(String),
    /// A vector.
    Pair([f64; 2]),
    /// Yes or no for each axis.
    Switches([bool; 2]),
    /// List of vectors.
    Pairs(Vec<[f64; 2]>),
    /// List of numbers.
    Numbers(Vec<f64>),
    /// List of rows of numbers.
    Rows(Vec<Vec<f64>>),
    /// Target error of a mean.
    Target(MeanTarget),
    /// Some of the words to choose from.
    Words(Vec<String>),
    /// List of tables, each with the values of some of its keys.
    Tables(Vec<TableRow>),
}

/// Values of a table of a list, each with the name of its key, in the order of the keys.
pub type TableRow = Vec<(&'static str, KeyValue)>;

impl KeyValue {
    /// Text in TOML; numbers have the shortest form that reads back to the same bits.
    pub fn to_toml(&self) -> String {
        let list = |items: Vec<String>| format!("[{}]", items.join(", "));
        let pair = |pair: &[f64; 2]| format!("[{:?}, {:?}]", pair[0], pair[1]);
        match self {
            KeyValue::Number(value) => format!("{value:?}"),
            KeyValue::Whole(value) => value.to_string(),
            KeyValue::Switch(value) => value.to_string(),
            KeyValue::Word(word) => toml::Value::String(word.clone()).to_string(),
            KeyValue::Pair(value) => pair(value),
            KeyValue::Target(target) => target.to_toml(),
            KeyValue::Words(words) => {
                list(words.iter().map(|word| toml::Value::String(word.clone()).to_string()).collect())
            }
            KeyValue::Switches([x, y]) => format!("[{x}, {y}]"),
            KeyValue::Pairs(values) => list(values.iter().map(pair).collect()),
            KeyValue::Rows(rows) => list(
                rows.iter().map(|row| list(row.iter().map(|value| format!("{value:?}")).collect())).collect(),
            ),
            KeyValue::Tables(rows) => list(rows.iter().map(inline_table).collect()),
            KeyValue::Numbers(values) => list(values.iter().map(|value| format!("{value:?}")).collect()),
        }
    }
}

/// Table in one line.
fn inline_table(row: &TableRow) -> String {
    let entries: Vec<String> =
        row.iter().map(|(name, value)| format!("{name} = {}", value.to_toml())).collect();
    format!("{{ {} }}", entries.join(", "))
}

/// Range of a number; every number must be finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NumberRange {
    /// Any finite number.
    Finite,
    /// Above zero.
    Positive,
    /// Zero or more.
    NonNegative,
    /// Above zero and below the bound.
    Within(f64),
    /// Zero or more, below the bound.
    UpTo(f64),
    /// Above zero, at most a bound.
    AtMost(f64),
}

impl NumberRange {
    /// True if a number is in the range.
    pub(crate) fn admit(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                NumberRange::Finite => true,
                NumberRange::Positive => value > 0.0,
                NumberRange::NonNegative => value >= 0.0,
                NumberRange::Within(bound) => 0.0 < value && value < bound,
                NumberRange::UpTo(bound) => (0.0..bound).contains(&value),
                NumberRange::AtMost(bound) => 0.0 < value && value <= bound,
            }
    }

    fn words(self) -> String {
        match self {
            NumberRange::Finite => "finite".to_owned(),
            NumberRange::Positive => "above 0".to_owned(),
            NumberRange::NonNegative => "0 or more".to_owned(),
            NumberRange::Within(bound) => format!("above 0 and below {bound}"),
            NumberRange::UpTo(bound) => format!("0 or more and below {bound}"),
            NumberRange::AtMost(bound) => format!("above 0 and at most {bound}"),
        }
    }
}

/// Type of a key's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeyValueKind {
    /// A number.
    Number(NumberRange),
    /// A whole number of at least the first and at most the second bound.
    Whole(u64, u64),
    /// One of some whole numbers.
    OneOf(&'static [u64]),
    /// `true` or `false`.
    Switch,
    /// One of some words; `word:N` stands for the word, a colon and a whole number of at least 1.
    Choice(&'static [&'static str]),
    /// Text that is not empty, of one line.
    Text,
    /// `[x, y]`, both in the range.
    Pair(NumberRange),
    /// `[x, y]`, each `true` or `false`.
    Switches,
    /// `[[x, y], …]`.
    Pairs,
    /// `[a, b, …]`, all in the range.
    Numbers(NumberRange),
    /// `[[a, b, …], …]`, each row with this number of finite numbers.
    Rows(usize),
    /// `{ quantity = "…", error = "…%" }`, or a number as the error.
    Target,
    /// `["…", …]`, each one of some words.
    Words(&'static [&'static str]),
    /// `[[name]]`, any number of tables with these keys.
    Tables(&'static [&'static Key]),
}

/// Reason why a value cannot be read, with its location in the text.
pub(super) struct ValueFault {
    pub(super) span: Range<usize>,
    pub(super) reason: MistakeKind,
    pub(super) found: String,
    pub(super) nearest: Option<&'static str>,
}

impl ValueFault {
    fn new(value: &Spanned<DeValue<'_>>, reason: MistakeKind, found: impl Into<String>) -> Self {
        ValueFault { span: value.span(), reason, found: found.into(), nearest: None }
    }
}

type FaultsOr<T> = Result<T, Vec<ValueFault>>;

impl KeyValueKind {
    /// Description of the values of this type.
    pub fn words(self) -> String {
        let joined = |words: Vec<String>| match words.split_last() {
            Some((last, [])) => last.clone(),
            Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
            None => String::new(),
        };
        match self {
            KeyValueKind::Number(bounds) => format!("a number, {}", bounds.words()),
            KeyValueKind::Whole(least, u64::MAX) => format!("a whole number, {least} or more"),
            KeyValueKind::Whole(least, most) => format!("a whole number, {least} to {most}"),
            KeyValueKind::OneOf(values) => joined(values.iter().map(ToString::to_string).collect()),
            KeyValueKind::Switch => "true or false".to_owned(),
            KeyValueKind::Choice(words) => joined(words.iter().map(|word| format!("\"{word}\"")).collect()),
            KeyValueKind::Text => "text in quotes, one line".to_owned(),
            KeyValueKind::Pair(bounds) => format!("[x, y], two numbers, {}", bounds.words()),
            KeyValueKind::Target => {
                "{ quantity = \"NAME\", error = \"0.1%\" }, or an error above 0 in its unit".to_owned()
            }
            KeyValueKind::Switches => "[x, y], each true or false".to_owned(),
            KeyValueKind::Words(words) => {
                format!("a list of {}", joined(words.iter().map(|word| format!("\"{word}\"")).collect()))
            }
            KeyValueKind::Tables(keys) => {
                let names: Vec<&str> = keys.iter().map(|key| key.name).collect();
                format!("tables with the keys {}", names.join(", "))
            }
            KeyValueKind::Pairs => "[[x, y], …], finite numbers".to_owned(),
            KeyValueKind::Rows(numbers) => format!("[[…], …], each of {numbers} finite numbers"),
            KeyValueKind::Numbers(bounds) => format!("[a, b, …], numbers, {}", bounds.words()),
        }
    }

    /// True if a word is admitted. Types other than a choice of words admit any.
    pub(super) fn admits(self, word: &str) -> bool {
        match self {
            KeyValueKind::Choice(words) => words.iter().any(|choice| is_choice(choice, word)),
            _ => true,
        }
    }

    /// Reads a value and returns all its faults.
    pub(super) fn read(self, value: &Spanned<DeValue<'_>>) -> FaultsOr<KeyValue> {
        Ok(match self {
            KeyValueKind::Number(bounds) => KeyValue::Number(number(value, bounds)?),
            KeyValueKind::Whole(least, most) => {
                KeyValue::Whole(whole(value, |count| (least..=most).contains(&count))?)
            }
            KeyValueKind::OneOf(values) => KeyValue::Whole(whole(value, |count| values.contains(&count))?),
            KeyValueKind::Switch => KeyValue::Switch(switch(value)?),
            KeyValueKind::Choice(words) => KeyValue::Word(choice(value, words)?),
            KeyValueKind::Text => KeyValue::Word(text(value)?),
            KeyValueKind::Pair(bounds) => KeyValue::Pair(pair(value, |item| number(item, bounds))?),
            KeyValueKind::Target => KeyValue::Target(target(value)?),
            KeyValueKind::Words(words) => KeyValue::Words(list(value, |item| choice(item, words))?),
            KeyValueKind::Switches => KeyValue::Switches(pair(value, switch)?),
            KeyValueKind::Pairs => {
                KeyValue::Pairs(list(value, |item| pair(item, |item| number(item, NumberRange::Finite)))?)
            }
            KeyValueKind::Rows(numbers) => KeyValue::Rows(list(value, |row| {
                let row_of = list(row, |item| number(item, NumberRange::Finite))?;
                if row_of.len() == numbers { Ok(row_of) } else { wrong_type(row) }
            })?),
            KeyValueKind::Numbers(bounds) => KeyValue::Numbers(list(value, |item| number(item, bounds))?),
            KeyValueKind::Tables(keys) => KeyValue::Tables(list(value, |item| table(item, keys))?),
        })
    }
}

/// Description of a value; short values are quoted.
fn found(value: &DeValue<'_>) -> String {
    let short = |text: &str| quoted(&text.chars().take(40).collect::<String>());
    match value {
        DeValue::String(text) => format!("the text \"{}\"", short(text)),
        DeValue::Integer(number) => format!("the number {}", short(number.as_str())),
        DeValue::Float(number) => format!("the number {}", short(number.as_str())),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(items) => match items.len() {
            1 => "a list of 1 item".to_owned(),
            count => format!("a list of {count} items"),
        },
        DeValue::Table(_) => "a table".to_owned(),
    }
}

fn wrong_type<T>(value: &Spanned<DeValue<'_>>) -> FaultsOr<T> {
    Err(vec![ValueFault::new(value, MistakeKind::Type, found(value.get_ref()))])
}

fn out_of_range<T>(value: &Spanned<DeValue<'_>>) -> FaultsOr<T> {
    Err(vec![ValueFault::new(value, MistakeKind::Range, found(value.get_ref()))])
}

fn magnitude(integer: &DeInteger<'_>) -> Option<f64> {
    match integer.radix() {
        10 => integer.as_str().parse().ok(),
        radix => u64::from_str_radix(integer.as_str(), radix).ok().map(|value| value as f64),
    }
}

fn number(value: &Spanned<DeValue<'_>>, bounds: NumberRange) -> FaultsOr<f64> {
    let number = match value.get_ref() {
        DeValue::Integer(integer) => magnitude(integer),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => return wrong_type(value),
    };
    match number {
        // Negative zero becomes zero, so that a written value reads back equal.
        Some(number) if bounds.admit(number) => Ok(number + 0.0),
        _ => out_of_range(value),
    }
}

fn whole(value: &Spanned<DeValue<'_>>, admit: impl Fn(u64) -> bool) -> FaultsOr<u64> {
    let whole = match value.get_ref() {
        DeValue::Integer(integer) => {
            let digits = integer.as_str().trim_start_matches('+');
            u64::from_str_radix(digits, integer.radix()).ok()
        }
        // Counts may be written as 1e6.
        DeValue::Float(float) => match float.as_str().parse::<f64>() {
            Ok(number) if (0.0..=2f64.powi(53)).contains(&number) && number.fract() == 0.0 => {
                Some(number as u64)
            }
            _ => None,
        },
        _ => return wrong_type(value),
    };
    match whole {
        Some(count) if admit(count) => Ok(count),
        _ => out_of_range(value),
    }
}

fn switch(value: &Spanned<DeValue<'_>>) -> FaultsOr<bool> {
    value.get_ref().as_bool().map_or_else(|| wrong_type(value), Ok)
}

/// Longest text that is a value (bytes): longer than any path.
const LONGEST_TEXT: usize = 4096;

fn text(value: &Spanned<DeValue<'_>>) -> FaultsOr<String> {
    match value.get_ref().as_str() {
        Some(text) if text.trim().is_empty() || text.chars().any(char::is_control) => out_of_range(value),
        Some(text) if text.len() > LONGEST_TEXT => out_of_range(value),
        Some(text) => Ok(text.to_owned()),
        None => wrong_type(value),
    }
}

/// True if a text is one of the choices that a word stands for.
fn is_choice(word: &str, text: &str) -> bool {
    match word.strip_suffix("N") {
        Some(stem) if stem.ends_with(':') => {
            text.strip_prefix(stem).is_some_and(|count| matches!(count.parse::<u32>(), Ok(1..)))
        }
        _ => word == text,
    }
}

fn choice(value: &Spanned<DeValue<'_>>, words: &'static [&'static str]) -> FaultsOr<String> {
    let Some(text) = value.get_ref().as_str() else { return wrong_type(value) };
    if words.iter().any(|choice| is_choice(choice, text)) {
        return Ok(text.to_owned());
    }
    let nearest = nearest(text, words.iter().copied());
    Err(vec![ValueFault { nearest, ..ValueFault::new(value, MistakeKind::Type, found(value.get_ref())) }])
}

fn list<T>(
    value: &Spanned<DeValue<'_>>,
    item: impl Fn(&Spanned<DeValue<'_>>) -> FaultsOr<T>,
) -> FaultsOr<Vec<T>> {
    let Some(items) = value.get_ref().as_array() else { return wrong_type(value) };
    let (mut good, mut faults) = (Vec::new(), Vec::new());
    for (number, value) in items.iter().enumerate() {
        match item(value) {
            Ok(value) => good.push(value),
            Err(more) => faults.extend(more),
        }
        let rest = items.len() - number - 1;
        if faults.len() >= MistakeList::NAMED / 2 && rest > 0 {
            let found = format!("wrong in too many items; the {rest} items after this one are not checked");
            faults.push(ValueFault::new(value, MistakeKind::Type, found));
            break;
        }
    }
    if faults.is_empty() { Ok(good) } else { Err(faults) }
}

fn pair<T>(
    value: &Spanned<DeValue<'_>>,
    item: impl Fn(&Spanned<DeValue<'_>>) -> FaultsOr<T>,
) -> FaultsOr<[T; 2]> {
    let items = list(value, item)?;
    items.try_into().or_else(|_| wrong_type(value))
}

/// Reads a table of a list.
fn table(value: &Spanned<DeValue<'_>>, keys: &'static [&'static Key]) -> FaultsOr<TableRow> {
    let Some(entries) = value.get_ref().as_table() else { return wrong_type(value) };
    let mut faults = vec![];
    for (name, entry) in entries {
        if !keys.iter().any(|key| key.name == name.get_ref()) {
            let found = format!("a table with the unknown key `{}`", quoted(name.get_ref()));
            let nearest = nearest(name.get_ref(), keys.iter().map(|key| key.name));
            let fault = ValueFault::new(entry, MistakeKind::Unknown, found);
            faults.push(ValueFault { nearest, span: name.span(), ..fault });
        }
    }
    let mut row = vec![];
    for key in keys {
        match entries.get(key.name) {
            Some(entry) => match key.kind.read(entry) {
                Ok(read) => row.push((key.name, read)),
                Err(more) => faults.extend(more.into_iter().map(|fault| {
                    let found = format!(
                        "a table whose `{}` is {}; {} is expected",
                        key.name,
                        fault.found,
                        key.kind.words()
                    );
                    ValueFault { found, reason: MistakeKind::Type, ..fault }
                })),
            },
            None if key.fallback == Fallback::Required => {
                let found = format!("a table without `{}`", key.name);
                faults.push(ValueFault::new(value, MistakeKind::Missing, found));
            }
            None => {}
        }
    }
    if faults.is_empty() { Ok(row) } else { Err(faults) }
}

fn target(value: &Spanned<DeValue<'_>>) -> FaultsOr<MeanTarget> {
    let Some(table) = value.get_ref().as_table() else { return wrong_type(value) };
    let (Some(quantity), Some(error), 2) = (table.get("quantity"), table.get("error"), table.len()) else {
        let names = "a table whose keys are not just `quantity` and `error`";
        return Err(vec![ValueFault::new(value, MistakeKind::Type, names)]);
    };
    let width = match error.get_ref() {
        DeValue::String(text) => Width::parse(text),
        _ => Some(Width::Absolute(number(error, NumberRange::Positive)?)),
    };
    match width {
        Some(error) => Ok(MeanTarget { quantity: text(quantity)?, error }),
        None => out_of_range(error),
    }
}

/// Default of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fallback {
    /// Required: the key must be given wherever it is used.
    Required,
    /// Value in TOML.
    Is(&'static str),
    /// Default described in words.
    Otherwise(&'static str),
}

/// Condition of a key: always, or with some choices of another key.
pub(crate) type Use = Option<(&'static Key, &'static [&'static str])>;

/// Key of a scene file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Section; empty for the head of the file.
    pub section: &'static str,
    /// Name within the section.
    pub name: &'static str,
    /// Type of the value.
    pub kind: KeyValueKind,
    /// Unit; empty for pure numbers and words.
    pub unit: &'static str,
    /// Default.
    pub fallback: Fallback,
    /// Condition under which it is used.
    pub used: Use,
    /// Choice of another key that this key implies when given.
    pub(crate) implies: Option<(&'static Key, &'static str)>,
    /// Documentation.
    pub doc: &'static str,
}

impl Key {
    /// Section and name, as `--set` takes them.
    pub fn path(&self) -> String {
        if self.section.is_empty() { self.name.to_owned() } else { format!("{}.{}", self.section, self.name) }
    }

    /// Expected value with its unit.
    pub fn expected(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        format!("{} = {}{unit}", self.name, self.kind.words())
    }

    /// Section and name.
    pub fn id(&self) -> (&'static str, &'static str) {
        (self.section, self.name)
    }
}

/// Defines keys as statics, each with its documentation, and their list in the order in which they are written.
macro_rules! define_keys {
    (
        $(#[$meta:meta])* $vis:vis static $list:ident;
        $($constant:ident = $section:literal $name:literal, $kind:expr, $unit:literal, $fallback:expr, $used:expr, $doc:literal
            $(, implies $implied:expr)?;)*
    ) => {
        $(
            #[doc = $doc]
            #[allow(unreachable_pub, reason = "keys of some sections are public")]
            pub static $constant: $crate::scene::Key = $crate::scene::Key {
                section: $section,
                name: $name,
                kind: $kind,
                unit: $unit,
                fallback: $fallback,
                used: $used,
                implies: $crate::scene::keys::implied!($($implied)?),
                doc: $doc,
            };
        )*

        $(#[$meta])*
        $vis static $list: &[&$crate::scene::Key] = &[$(&$constant),*];
    };
}

macro_rules! implied {
    () => {
        None
    };
    ($implied:expr) => {
        Some($implied)
    };
}

pub(crate) use {define_keys, implied};
