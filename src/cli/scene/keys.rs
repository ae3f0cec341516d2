//! `stripmine scene keys`: keys of a method, or keys of all methods that have some words.

use crate::console::{CommandFailure, Common, print_json, print_text};
use serde::Serialize;
use stripmine_physics::method::{MethodEntry, Methods, method};
use stripmine_physics::number::count_with_noun;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::scene::{Fallback, Key, KeyValueKind, SECTIONS};

/// Key as data.
#[derive(PartialEq, Serialize)]
struct KeyLine {
    section: &'static str,
    key: &'static str,
    r#type: String,
    unit: &'static str,
    default: Option<&'static str>,
    required: bool,
    used_with: Vec<&'static str>,
    meaning: &'static str,
}

impl KeyLine {
    fn of(key: &Key) -> KeyLine {
        KeyLine {
            section: key.section,
            key: key.name,
            r#type: key.kind.words(),
            unit: key.unit,
            default: match key.fallback {
                Fallback::Required => None,
                Fallback::Is(text) | Fallback::Otherwise(text) => Some(text),
            },
            required: key.fallback == Fallback::Required,
            used_with: key.used.map_or(Vec::new(), |(_, choices)| choices.to_vec()),
            meaning: key.doc,
        }
    }

    /// Path of the key, as `--set` takes it.
    fn path(&self) -> String {
        if self.section.is_empty() { self.key.to_owned() } else { format!("{}.{}", self.section, self.key) }
    }

    /// Returns true if the key has a word, in lower case, in its section, name or meaning.
    fn has(&self, word: &str) -> bool {
        self.path().contains(word) || self.meaning.to_lowercase().contains(word)
    }

    /// Entry of a list: the key with its values and default, then its meaning, indented.
    fn text(&self, methods: &str) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        let default = self.default.map_or("required".to_owned(), |default| format!("default: {default}"));
        let used = match self.used_with.as_slice() {
            [] => String::new(),
            choices => format!(" Used with {}.", choices.join(", ")),
        };
        let (path, values, meaning) = (self.path(), &self.r#type, self.meaning);
        format!("{path}{unit}: {values}; {default}\n    {meaning}{used}{methods}\n")
    }
}

/// Keys of a method, those of the tables of a list after all others.
fn key_lines(entry: &MethodEntry) -> Vec<KeyLine> {
    entry.vocabulary.keys.keys_and_fields().map(KeyLine::of).collect()
}

/// A key of some methods.
#[derive(Serialize)]
struct MatchingKey {
    methods: Vec<&'static str>,
    #[serde(flatten)]
    line: KeyLine,
}

/// No key has all of these words.
#[derive(Debug, thiserror::Error)]
#[error(
    "no method is called `{0}`, and no key has it in its name or meaning; `stripmine scene keys` lists the keys of a method"
)]
struct NoSuchKey(String);

impl Reported for NoSuchKey {
    fn class(&self) -> ErrorClass {
        ErrorClass::Usage
    }
}

/// Lists the keys of a method, of the first if there are no words, or keys of all methods; of these, the ones that have all other words.
pub(super) fn keys(what: &[String], common: &Common, methods: Methods) -> Result<(), CommandFailure> {
    let (entry, words) = match what.split_first() {
        None => (methods.first().copied(), what),
        Some((first, rest)) => match method(methods, first) {
            Some(entry) => (Some(entry), rest),
            None => (None, what),
        },
    };
    let words: Vec<String> = words.iter().map(|word| word.to_lowercase()).collect();
    let has_words = |line: &KeyLine| words.iter().all(|word| line.has(word));
    let Some(entry) = entry else { return matching_keys(&what.join(" "), &has_words, common, methods) };
    let lines: Vec<KeyLine> = key_lines(entry).into_iter().filter(has_words).collect();
    if lines.is_empty() {
        return Err(NoSuchKey(what.join(" ")).into());
    }
    if common.json {
        return print_json(&lines);
    }
    let mut text = format!("Keys of {}\n", entry.vocabulary.keys.method);
    let sections = std::iter::once(("", "at the top of the file")).chain(SECTIONS);
    let headings = sections.map(|(section, holds)| match section {
        "" => (section, holds.to_owned()),
        _ => (section, format!("[{section}]: {holds}")),
    });
    let lists = entry.vocabulary.keys.keys().filter(|key| matches!(key.kind, KeyValueKind::Tables(_)));
    let headings = headings.chain(lists.map(|key| (key.name, format!("[[{}]]: each", key.name))));
    for (section, heading) in headings {
        let of_section: Vec<&KeyLine> = lines.iter().filter(|line| line.section == section).collect();
        if !of_section.is_empty() {
            text += &format!("\n{heading}\n\n");
        }
        of_section.iter().for_each(|line| text += &line.text(""));
    }
    let count = count_with_noun(lines.len(), "key", "keys");
    print_text(&format!("{text}\n{count}; `stripmine scene keys WORD` searches the keys of all methods.\n"))
}

/// Lists keys of all methods, equal ones once.
fn matching_keys(
    what: &str,
    is_wanted: &dyn Fn(&KeyLine) -> bool,
    common: &Common,
    methods: Methods,
) -> Result<(), CommandFailure> {
    let mut found: Vec<MatchingKey> = vec![];
    for entry in methods {
        for line in key_lines(entry).into_iter().filter(is_wanted) {
            let is_same = |known: &&mut MatchingKey| known.line == line;
            match found.iter_mut().find(is_same) {
                Some(known) => known.methods.push(entry.vocabulary.keys.method),
                None => found.push(MatchingKey { methods: vec![entry.vocabulary.keys.method], line }),
            }
        }
    }
    if found.is_empty() {
        return Err(NoSuchKey(what.to_owned()).into());
    }
    if common.json {
        return print_json(&found);
    }
    let text = |it: &MatchingKey| {
        let all = it.methods.len() == methods.len();
        it.line.text(&format!(" Methods: {}.", if all { "all".to_owned() } else { it.methods.join(", ") }))
    };
    let texts: String = found.iter().map(text).collect();
    print_text(&format!("Keys with `{what}` in their name or meaning\n\n{texts}"))
}
